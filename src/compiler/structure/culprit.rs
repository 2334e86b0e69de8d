//! Finds the equation that is too many, or the unknown that nothing determines, on the flat system as
//! it is written: aliases and connections are equations there, and the wrong one is often among them.
//!
//! In: the stated equations. Out: the equations and unknowns to blame, most likely ones first. A
//! system that is singular as a whole has many equations of which any could be removed (Dulmage and
//! Mendelsohn 1958). The guilty one is found in the component that is not balanced: of its own
//! equations and the unknowns that it must determine, the decomposition leaves few.
//! *Bunus and Fritzson, "Methods for structural analysis and debugging of Modelica models", 2002;
//! Nilsson, "Type-based structural analysis for modular systems of equations", 2008.*

use crate::base::index::{FastMap, Id, IndexVec};
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::dulmage_mendelsohn::{self, Decomposition, Subsystem};
use crate::graph::matching::{self, Matching};
use crate::ir::dae::{Dae, Stated, VariableKind};
use crate::ir::expr::{Node, VarId};

/// What is to blame in a singular system.
#[derive(Default)]
pub struct Blame {
    /// Equations too many, by their number among the stated ones.
    pub over: Part,
    /// Unknowns without an equation.
    pub under: Part,
    /// Equations and unknowns of the unbalanced components.
    pub counts: Vec<ComponentCount>,
}

/// Equations and the unknowns that only they determine.
#[derive(Default)]
pub struct Part {
    /// Numbers of the equations among the stated ones.
    pub equations: Vec<usize>,
    /// The unknowns.
    pub unknowns: Vec<VarId>,
    /// Further equations of the system that is over-determined with them.
    pub context: Vec<usize>,
}

impl Part {
    /// Whether anything is to blame.
    pub fn is_found(&self) -> bool {
        !self.equations.is_empty() || !self.unknowns.is_empty()
    }
}

/// The balance of a component.
pub struct ComponentCount {
    /// Its dotted name, empty for the model itself.
    pub component: String,
    /// Its equations, and those of its connections.
    pub equations: usize,
    /// The unknowns that it must determine.
    pub unknowns: usize,
}

/// The whole flat system with its graph.
struct Whole {
    /// The variable of each column.
    unknowns: Vec<VarId>,
    col: FastMap<VarId, Col>,
    graph: Bipartite,
    /// The component of each equation.
    component: Vec<u32>,
}

/// Who is to blame for a singular system; `None` if the stated equations are not known.
pub fn find(dae: &Dae, stated: &Stated) -> Option<Blame> {
    if stated.equations.is_empty() {
        return None;
    }
    let whole = whole(dae, stated);
    let global = decompose(&whole.graph);
    let mut blame = Blame::default();
    let mut by_component: FastMap<u32, (Vec<Row>, Vec<Col>)> = FastMap::default();
    for (row, component) in whole.graph.rows().zip(&whole.component) {
        by_component.entry(*component).or_default().0.push(row);
    }
    for (col, v) in whole.unknowns.iter().enumerate() {
        let owner = owner(stated, *v);
        by_component.entry(owner).or_default().1.push(Col::from_usize(col));
    }
    let partners = partners(dae, stated);
    let mut excess = (0, 0);
    let mut components: Vec<u32> = by_component.keys().copied().collect();
    components.sort_unstable();
    for component in components {
        let (rows, cols) = &by_component[&component];
        let mut local_col: IndexVec<Col, Option<Col>> =
            IndexVec::filled(None, whole.graph.col_count());
        for (k, col) in cols.iter().enumerate() {
            local_col[*col] = Some(Col::from_usize(k));
        }
        let graph = Bipartite::from_rows(
            cols.len(),
            rows.iter().map(|row| {
                let mut all: Vec<Col> = Vec::new();
                for c in whole.graph.cols(*row) {
                    all.extend(local_col[*c]);
                    let v = whole.unknowns[c.0 as usize];
                    let of_connector = partners.get(&v).into_iter().flatten();
                    let own = of_connector.filter_map(|w| local_col[*whole.col.get(w)?]);
                    all.extend(own.filter(|_| local_col[*c].is_none()));
                }
                all.sort_unstable();
                all.dedup();
                all
            }),
        );
        let local = decompose(&graph);
        let over = &local.over_determined;
        let blamed = |row: &Row| global.over_determined.rows.binary_search(row).is_ok();
        let mut is_to_blame = false;
        if over.rows.iter().any(|row| blamed(&rows[row.0 as usize])) {
            blame.over.equations.extend(over.rows.iter().map(|r| rows[r.0 as usize].0 as usize));
            let own = over.cols.iter().map(|c| whole.unknowns[cols[c.0 as usize].0 as usize]);
            blame.over.unknowns.extend(own);
            excess.0 += over.rows.len() - over.cols.len();
            is_to_blame = true;
        }
        let under = &local.under_determined;
        let missing = |col: &Col| global.under_determined.cols.binary_search(col).is_ok();
        if under.cols.iter().any(|col| missing(&cols[col.0 as usize])) {
            blame.under.equations.extend(under.rows.iter().map(|r| rows[r.0 as usize].0 as usize));
            let own = under.cols.iter().map(|c| whole.unknowns[cols[c.0 as usize].0 as usize]);
            blame.under.unknowns.extend(own);
            excess.1 += under.cols.len() - under.rows.len();
            is_to_blame = true;
        }
        if is_to_blame && rows.len() != cols.len() {
            let name = stated.ownership.components.get(component as usize);
            blame.counts.push(ComponentCount {
                component: name.map_or_else(String::new, |n| n.to_string()),
                equations: rows.len(),
                unknowns: cols.len(),
            });
        }
    }
    // Where the components do not add up, they explain nothing.
    let all = (&global.over_determined, &global.under_determined);
    if excess.0 != all.0.rows.len() - all.0.cols.len() {
        blame.over = Part::default();
    }
    if excess.1 != all.1.cols.len() - all.1.rows.len() {
        blame.under = Part::default();
    }
    whole.complete(&mut blame.over, &global.over_determined);
    whole.complete(&mut blame.under, &global.under_determined);
    put_rivals_first(dae, stated, &mut blame.over.equations);
    Some(blame)
}

/// Of the equations too many, those come first of which two give the same variable.
fn put_rivals_first(dae: &Dae, stated: &Stated, equations: &mut [usize]) {
    let names_derivative = |k: usize| {
        let e = &stated.equations[k];
        [e.lhs, e.rhs].into_iter().any(|side| matches!(dae.graph.node(side), Node::Der(_)))
            && [e.lhs, e.rhs].into_iter().any(|side| matches!(dae.graph.node(side), Node::Var(_)))
    };
    let given = |k: usize| -> Vec<VarId> {
        let e = &stated.equations[k];
        if names_derivative(k) {
            return Vec::new();
        }
        let alone = |side| match dae.graph.node(side) {
            Node::Var(v) => Some(v),
            _ => None,
        };
        [e.lhs, e.rhs].into_iter().filter_map(alone).collect()
    };
    let mut count: FastMap<VarId, usize> = FastMap::default();
    for v in equations.iter().flat_map(|k| given(*k)) {
        *count.entry(v).or_default() += 1;
    }
    // What only names a derivative is seldom wrong.
    equations.sort_by_key(|k| {
        let is_rival = given(*k).iter().any(|v| count[v] > 1);
        if names_derivative(*k) { 2 } else { u8::from(!is_rival) }
    });
}

/// For each variable of a connector with flows, the others: a connection determines the flow where it
/// equates the potential, and a component the potential where it gives the flow.
fn partners<'a>(dae: &'a Dae, stated: &Stated) -> FastMap<VarId, Vec<VarId>> {
    let connector = |v: VarId| -> &'a str {
        dae.variables[v].name.rsplit_once('.').map_or("", |(connector, _)| connector)
    };
    let flows = stated.ownership.is_flow.iter().enumerate().filter(|(_, is_flow)| **is_flow);
    let mut members: FastMap<&str, (Vec<VarId>, Vec<VarId>)> = FastMap::default();
    for (k, _) in flows {
        let v = VarId(k as u32);
        members.entry(connector(v)).or_default().0.push(v);
    }
    for (k, is_flow) in stated.ownership.is_flow.iter().enumerate() {
        let v = VarId(k as u32);
        if !*is_flow && let Some((_, others)) = members.get_mut(connector(v)) {
            others.push(v);
        }
    }
    let mut found: FastMap<VarId, Vec<VarId>> = FastMap::default();
    for (flows, others) in members.values() {
        for (own, partners) in [(flows, others), (others, flows)] {
            found.extend(own.iter().map(|v| (*v, partners.clone())));
        }
    }
    found
}

impl Whole {
    /// Without an unbalanced component the whole part is to blame; with one, the equations that share
    /// its variables are its context.
    fn complete(&self, part: &mut Part, global: &Subsystem) {
        let variable = |c: &Col| self.unknowns[c.0 as usize];
        if part.equations.is_empty() && part.unknowns.is_empty() {
            part.equations = global.rows.iter().map(|r| r.0 as usize).collect();
            part.unknowns = global.cols.iter().map(variable).collect();
            return;
        }
        let own: Vec<Col> = part
            .equations
            .iter()
            .flat_map(|e| self.graph.cols(Row::from_usize(*e)).iter().copied())
            .collect();
        let related = |row: &&Row| {
            !part.equations.contains(&(row.0 as usize))
                && self.graph.cols(**row).iter().any(|c| own.contains(c))
        };
        part.context = global.rows.iter().filter(related).map(|r| r.0 as usize).collect();
    }
}

fn decompose(graph: &Bipartite) -> Decomposition {
    let matched = matching::maximum(graph, |_, _| true, Matching::empty(graph));
    dulmage_mendelsohn::decompose(graph, &matched)
}

/// The component that must determine a variable; those that `flatten` has added belong to the model.
fn owner(stated: &Stated, v: VarId) -> u32 {
    stated.ownership.owner.get(v.0 as usize).copied().unwrap_or(0)
}

fn whole(dae: &Dae, stated: &Stated) -> Whole {
    // Derivatives and flags that lowering has added come after the variables of the flat model.
    let declared = stated.ownership.owner.len();
    let count = if declared == 0 { dae.variables.len() } else { declared };
    let is_unknown = |v: VarId| {
        let kind = dae.variables[v].kind;
        let is_known = matches!(
            kind,
            VariableKind::Parameter | VariableKind::InitialParameter | VariableKind::Input
        );
        // A variable of the model may be the name of a derivative.
        let is_added = declared == 0 || v.0 as usize >= declared;
        let is_derivative = is_added && dae.variables[v].name.starts_with("der(");
        !is_known && !is_derivative && !stated.by_when.contains(&v)
    };
    let mut col: FastMap<VarId, Col> = FastMap::default();
    let mut unknowns = Vec::new();
    let read = |e: &crate::ir::dae::StatedEquation| -> Vec<VarId> {
        let nodes = dae.graph.postorder([e.lhs, e.rhs]).into_iter();
        let variable = |id| match dae.graph.node(id) {
            Node::Var(v) | Node::Der(v) => Some(v),
            _ => None,
        };
        nodes.filter_map(variable).collect()
    };
    let rows: Vec<Vec<VarId>> = stated.equations.iter().map(read).collect();
    let in_rows = rows.iter().flatten().copied().filter(|v| v.0 as usize >= count);
    for v in dae.variables.ids().take(count).chain(in_rows) {
        if is_unknown(v) && !col.contains_key(&v) {
            col.insert(v, Col::from_usize(unknowns.len()));
            unknowns.push(v);
        }
    }
    let graph = Bipartite::from_rows(
        unknowns.len(),
        rows.iter().map(|read| read.iter().filter_map(|v| col.get(v).copied())),
    );
    let numbers: FastMap<&str, u32> =
        (0..).zip(&stated.ownership.components).map(|(k, name)| (&**name, k)).collect();
    let component = stated.equations.iter().map(|e| {
        // Declarations and zero flows are given by the component that must determine the variable.
        let declared = match dae.graph.node(e.lhs) {
            Node::Var(v) if dae.variables[v].span == e.origin.span => Some(owner(stated, v)),
            _ => None,
        };
        declared.or_else(|| numbers.get(&*e.origin.component).copied()).unwrap_or(0)
    });
    let component = component.collect();
    Whole { unknowns, col, graph, component }
}
