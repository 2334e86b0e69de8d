//! Classifies variables by their role in the solution and equations by form.

use super::Equal;
use super::error;
use super::rewriting::Rewriting;
use crate::base::diag::Problems;
use crate::base::index::{FastSet, IndexVec};
use crate::ir::dae::{self, DiscreteEquation, VariableKind};
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{
    Action, Assert, Causality, EquationKind, FlatModel, Origin, Variability, Variable, WhenBranch,
};

/// The equations of a flat model by form.
pub struct Sections {
    /// `a = b`: from equation sections, declarations and algorithms.
    pub equal: Vec<Equal>,
    /// When-clauses.
    pub whens: Vec<(Vec<WhenBranch>, Origin)>,
    /// Assertions outside when-clauses.
    pub asserts: Vec<(Assert, Origin)>,
    /// Every expression that occurs in an equation of any kind.
    pub roots: Vec<ExprId>,
}

/// The variables, all continuous ones as `Algebraic` for now. A variable that is assigned in a
/// when-clause is discrete regardless of its declaration (Modelica 3.6, section 3.8.4).
pub fn variables(flat: &FlatModel, problems: &mut Problems) -> IndexVec<VarId, dae::Variable> {
    let by_when = assigned_in_when(flat);
    let mut all: IndexVec<VarId, dae::Variable> =
        flat.variables.enumerate().map(|(id, v)| classify(id, v, &by_when, problems)).collect();
    for &id in &flat.recorded {
        all[id].kind = VariableKind::Algebraic;
    }
    for equation in &flat.equations {
        let EquationKind::Algorithm { outputs, .. } = &equation.kind else { continue };
        for v in outputs.iter().map(|v| &flat.variables[*v]) {
            if v.variability <= Variability::Parameter {
                problems.push(error::assigned_by_algorithm(v, &equation.origin));
            }
        }
    }
    all
}

/// Removes the equations from the model and sorts them by form; declarations `Real x = e` and
/// assignments of algorithms become equations.
pub fn sections(flat: &mut FlatModel) -> Sections {
    let mut s = Sections { equal: vec![], whens: vec![], asserts: vec![], roots: vec![] };
    for (id, v) in flat.variables.enumerate() {
        if let Some(rhs) = v.binding.filter(|_| v.variability > Variability::Parameter) {
            let lhs = flat.graph.var(id, v.ty);
            s.equal.push(Equal { lhs, rhs, origin: declaration_origin(v) });
        }
    }
    for id in flat.recorded.clone() {
        let lhs = flat.graph.var(id, Type::Real);
        let rhs = flat.graph.intern(Node::Recorded(id, 0), Type::Real);
        s.equal.push(Equal { lhs, rhs, origin: declaration_origin(&flat.variables[id]) });
    }
    for equation in std::mem::take(&mut flat.equations) {
        let origin = equation.origin;
        match equation.kind {
            EquationKind::Equal(lhs, rhs) => s.equal.push(Equal { lhs, rhs, origin }),
            EquationKind::When(branches) => s.whens.push((branches, origin)),
            EquationKind::Assert(assert) => s.asserts.push((assert, origin)),
            EquationKind::Algorithm { outputs, values } => {
                for (variable, rhs) in outputs.into_iter().zip(values) {
                    let lhs = flat.read(variable);
                    s.equal.push(Equal { lhs, rhs, origin: origin.clone() });
                }
            }
        }
    }
    s.roots = roots(flat, &s);
    s
}

/// Reports `pre` of continuous variables outside of when-clauses, where no event has a value before
/// it (section 3.7.5).
pub fn check_pre(
    graph: &Graph,
    variables: &IndexVec<VarId, dae::Variable>,
    equal: &[Equal],
    problems: &mut Problems,
) {
    let is_continuous =
        |v: VarId| variables[v].ty == Type::Real && variables[v].kind == VariableKind::Algebraic;
    let is_wrong = |node: Node| matches!(node, Node::Pre(v) if is_continuous(v));
    if !graph.any(equal.iter().flat_map(|e| [e.lhs, e.rhs]), |_, node| is_wrong(node)) {
        return;
    }
    for e in equal {
        let nodes = graph.postorder([e.lhs, e.rhs]).into_iter().map(|n| graph.node(n));
        let found = nodes.filter_map(|node| match node {
            Node::Pre(v) if is_continuous(v) => Some(v),
            _ => None,
        });
        for v in found {
            problems.push(error::pre_of_continuous(&variables[v], &e.origin));
        }
    }
}

/// Reports discrete variables without an equation.
pub fn check_discrete_equations(discrete: &[DiscreteEquation], r: &mut Rewriting<'_>) {
    let mut determined: FastSet<VarId> = discrete.iter().map(|d| d.variable).collect();
    determined.extend(r.sample_flags());
    for (id, v) in r.variables.enumerate() {
        if v.kind == VariableKind::Discrete && !determined.contains(&id) {
            r.problems.push(error::no_discrete_equation(v));
        }
    }
}

/// The declaration of a variable as the origin of its binding equation.
pub fn declaration_origin(v: &Variable) -> Origin {
    let component = v.name.rsplit_once('.').map_or("", |(component, _)| component);
    Origin { span: v.span, component: component.into() }
}

fn roots(flat: &FlatModel, s: &Sections) -> Vec<ExprId> {
    let mut roots = Vec::new();
    for equation in &s.equal {
        roots.extend([equation.lhs, equation.rhs]);
    }
    for (assert, _) in &s.asserts {
        roots.push(assert.condition);
    }
    for branch in s.whens.iter().flat_map(|(branches, _)| branches) {
        roots.extend(&branch.conditions);
        for action in &branch.actions {
            match action {
                Action::Assign(_, value) => roots.push(*value),
                Action::Reinit { value, guard, .. } => {
                    roots.push(*value);
                    roots.extend(guard);
                }
                Action::Assert(assert) => roots.push(assert.condition),
                Action::Terminate { guard, .. } => roots.extend(guard),
            }
        }
    }
    for equation in &flat.initial_equations {
        match &equation.kind {
            EquationKind::Equal(a, b) => roots.extend([a, b]),
            EquationKind::Algorithm { values, .. } => roots.extend(values),
            EquationKind::Assert(assert) => roots.push(assert.condition),
            EquationKind::When(_) => {}
        }
    }
    roots
}

fn assigned_in_when(flat: &FlatModel) -> FastSet<VarId> {
    let mut assigned = FastSet::default();
    for equation in &flat.equations {
        if let EquationKind::When(branches) = &equation.kind {
            add_assigned(branches, &mut assigned);
        }
    }
    assigned
}

/// The variables that when-clauses assign.
pub fn assigned_in(whens: &[(Vec<WhenBranch>, Origin)]) -> FastSet<VarId> {
    let mut assigned = FastSet::default();
    for (branches, _) in whens {
        add_assigned(branches, &mut assigned);
    }
    assigned
}

fn add_assigned(branches: &[WhenBranch], assigned: &mut FastSet<VarId>) {
    for action in branches.iter().flat_map(|b| &b.actions) {
        if let Action::Assign(v, _) = action {
            assigned.insert(*v);
        }
    }
}

/// A parameter of discrete type with `fixed = false`.
pub fn is_determined_by_initialization(v: &Variable) -> bool {
    v.variability == Variability::Parameter
        && v.fixed == Some(false)
        && matches!(v.ty, Type::Boolean | Type::Integer | Type::Enumeration(_))
}

fn classify(
    id: VarId,
    v: &Variable,
    by_when: &FastSet<VarId>,
    problems: &mut Problems,
) -> dae::Variable {
    let kind = match v.variability {
        Variability::Constant => VariableKind::Parameter,
        Variability::Parameter if is_determined_by_initialization(v) => VariableKind::Discrete,
        Variability::Parameter if v.fixed == Some(false) => VariableKind::InitialParameter,
        Variability::Parameter => VariableKind::Parameter,
        _ if v.causality == Some(Causality::Input) && v.binding.is_none() => VariableKind::Input,
        Variability::Discrete => VariableKind::Discrete,
        Variability::Continuous if by_when.contains(&id) => VariableKind::Discrete,
        Variability::Continuous => VariableKind::Algebraic,
    };
    let is_free = v.variability == Variability::Parameter && v.fixed == Some(false);
    if is_free && v.binding.is_some() {
        problems.push(error::guess_of_parameter(v));
    }
    if by_when.contains(&id) && kind != VariableKind::Discrete {
        problems.push(error::assigned_parameter(v));
    }
    dae::Variable {
        name: v.name.clone(),
        ty: v.ty,
        kind,
        derivative_of: None,
        start: v.binding.filter(|_| kind == VariableKind::InitialParameter).or(v.start),
        fixed: v.fixed,
        min: v.min,
        max: v.max,
        nominal: v.nominal,
        state_select: v.state_select,
        unit: v.unit,
        display_unit: v.display_unit,
        description: v.description.clone(),
        vanishes: false,
        hidden: false,
        protected: v.protected,
        structural: v.structural || v.variability == Variability::Constant,
        span: v.span,
    }
}
