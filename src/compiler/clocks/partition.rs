//! Base-clock and sub-clock partitions: the connected components of equations and variables (Modelica 3.6, sections
//! 16.7.3 and 16.7.4).

use super::Item;
use super::error::ClockCause;
use super::expression::{clocked, is_unknown, variable};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Action, Equation, EquationKind, FlatModel, Origin};

/// A conversion between two sub-clock partitions, given by one node of each.
pub struct Conversion {
    pub from: usize,
    pub to: usize,
    pub op: ClockOperator,
    /// Factor, or counter and resolution.
    pub counters: [i64; 2],
    pub origin: Origin,
}

/// The partitions of a model. Nodes are the variables by number, then the items.
pub struct Partitions {
    variables: usize,
    sub: Union,
    base: Union,
    pub conversions: Vec<Conversion>,
    /// Clock constructors with a node of their partition.
    pub definitions: Vec<(usize, ExprId, Origin)>,
    /// Solver methods with a node of their partition.
    pub solvers: Vec<(usize, Name, Origin)>,
    /// A place in each clocked base partition, by its representative.
    clocked: FastMap<usize, Origin>,
}

impl Partitions {
    pub fn node_of_item(&self, item: usize) -> usize {
        self.variables + item
    }

    /// The sub-clock partition of a node.
    pub fn sub(&self, node: usize) -> usize {
        self.sub.find(node)
    }

    /// The base-clock partition of a node.
    pub fn base(&self, node: usize) -> usize {
        self.base.find(node)
    }

    /// A place in the base partition of a node, if it is clocked.
    pub fn clock_of(&self, node: usize) -> Option<&Origin> {
        self.clocked.get(&self.base(node))
    }

    pub fn is_clocked(&self, node: usize) -> bool {
        self.clock_of(node).is_some()
    }

    /// The clocked sub-clock partitions, ascending.
    pub fn subs(&self) -> Vec<usize> {
        let all = 0..self.sub.parent.len();
        all.filter(|n| self.sub(*n) == *n && self.is_clocked(*n)).collect()
    }
}

/// Partitions the variables and equations of a model.
pub fn of(flat: &FlatModel, items: &[Item], problems: &mut Vec<Diagnostic>) -> Partitions {
    let variables = flat.variables.len();
    let count = variables + items.len();
    let mut found = Finding {
        flat,
        sub: Union::new(count),
        conversions: Vec::new(),
        definitions: Vec::new(),
        solvers: Vec::new(),
        clocked: Vec::new(),
        continuous: Vec::new(),
    };
    for (v, x) in flat.variables.enumerate() {
        if x.ty == Type::Clock {
            let origin = Origin { span: x.span, component: "".into() };
            found.clocked.push((v.0 as usize, origin));
        }
    }
    for (k, item) in items.iter().enumerate() {
        found.item(variables + k, &item.equation);
    }
    for delay in &flat.delays {
        let origin = Origin { span: delay.span, component: "".into() };
        let why = "`delay` is used in a clocked partition";
        found.continuous.push((delay.variable.0 as usize, origin, why));
    }
    let Finding { sub, conversions, definitions, solvers, clocked, continuous, .. } = found;
    let mut base = sub.clone();
    for c in &conversions {
        base.join(c.from, c.to);
    }
    let mut places: FastMap<usize, Origin> = FastMap::default();
    for (node, origin) in clocked {
        places.entry(base.find(node)).or_insert(origin);
    }
    let parts =
        Partitions { variables, sub, base, conversions, definitions, solvers, clocked: places };
    let mut reported = Vec::new();
    for (node, origin, why) in continuous {
        let base = parts.base(node);
        if let Some(other) = parts.clock_of(node)
            && !reported.contains(&base)
        {
            reported.push(base);
            let cause = ClockCause::MixedPartition { why: why.to_owned() };
            problems.push(
                Diagnostic::new(cause, origin.span).also(other.span, "makes the partition clocked"),
            );
        }
    }
    parts
}

struct Finding<'a> {
    flat: &'a FlatModel,
    sub: Union,
    conversions: Vec<Conversion>,
    definitions: Vec<(usize, ExprId, Origin)>,
    solvers: Vec<(usize, Name, Origin)>,
    /// Nodes of clocked partitions.
    clocked: Vec<(usize, Origin)>,
    /// Nodes of the continuous-time partition, and why they are.
    continuous: Vec<(usize, Origin, &'static str)>,
}

impl Finding<'_> {
    fn item(&mut self, node: usize, equation: &Equation) {
        let origin = &equation.origin;
        match &equation.kind {
            EquationKind::Equal(lhs, rhs) => {
                self.visit(*lhs, node, origin);
                self.visit(*rhs, node, origin);
            }
            EquationKind::Assert(assert) => {
                self.visit(assert.condition, node, origin);
                self.visit(assert.message, node, origin);
            }
            EquationKind::Algorithm { outputs, values } => {
                for v in outputs {
                    self.sub.join(v.0 as usize, node);
                }
                for value in values {
                    self.visit(*value, node, origin);
                }
            }
            EquationKind::When(branches) => {
                let why = "a when-clause with a Boolean condition is in a clocked partition";
                self.continuous.push((node, origin.clone(), why));
                for branch in branches {
                    for condition in &branch.conditions {
                        self.visit(*condition, node, origin);
                    }
                    for action in &branch.actions {
                        self.action(action, node, origin);
                    }
                }
            }
        }
    }

    fn action(&mut self, action: &Action, node: usize, origin: &Origin) {
        match action {
            Action::Assign(v, value) => {
                self.sub.join(v.0 as usize, node);
                self.visit(*value, node, origin);
            }
            Action::Reinit { state, value, guard } => {
                self.sub.join(state.0 as usize, node);
                self.visit(*value, node, origin);
                guard.iter().for_each(|g| self.visit(*g, node, origin));
            }
            Action::Assert(assert) => self.visit(assert.condition, node, origin),
            Action::Terminate { message, guard } => {
                self.visit(*message, node, origin);
                guard.iter().for_each(|g| self.visit(*g, node, origin));
            }
        }
    }

    fn visit(&mut self, root: ExprId, node: usize, origin: &Origin) {
        let flat = self.flat;
        flat.graph.descend([root], |e, pending| match flat.graph.node(e) {
            Node::Var(v) | Node::Der(v) | Node::Pre(v) => {
                if is_unknown(flat, v) {
                    self.sub.join(v.0 as usize, node);
                }
                false
            }
            Node::Sample(..) => {
                let why = "`sample(start, interval)` is used in a clocked partition";
                self.continuous.push((node, origin.clone(), why));
                false
            }
            Node::Clocked(..) => {
                if let Some((op, args)) = clocked(&flat.graph, e) {
                    self.operator(e, op, &args, node, origin, pending);
                }
                false
            }
            _ => true,
        });
    }

    fn operator(
        &mut self,
        e: ExprId,
        op: ClockOperator,
        args: &[ExprId],
        node: usize,
        origin: &Origin,
        pending: &mut Vec<ExprId>,
    ) {
        let graph = &self.flat.graph;
        let argument = args.first().and_then(|a| variable(graph, *a)).map(|v| v.0 as usize);
        if op != ClockOperator::Hold {
            self.clocked.push((node, origin.clone()));
        }
        match op {
            ClockOperator::Sample => {
                let why = "the argument of `sample` is clocked";
                self.continuous.extend(argument.map(|v| (v, origin.clone(), why)));
                pending.extend(&args[1..]);
            }
            ClockOperator::Hold => {
                self.continuous.push((
                    node,
                    origin.clone(),
                    "`hold` is used with a clocked variable",
                ));
                self.clocked.extend(argument.map(|v| (v, origin.clone())));
            }
            ClockOperator::Event => {
                self.definitions.push((node, e, origin.clone()));
                let why = "the condition of an event clock is clocked";
                for v in graph.variables(args[0]) {
                    if is_unknown(self.flat, v) {
                        self.continuous.push((v.0 as usize, origin.clone(), why));
                    }
                }
            }
            ClockOperator::Rational | ClockOperator::Interval => {
                self.definitions.push((node, e, origin.clone()));
                pending.extend(args);
            }
            ClockOperator::Solver => {
                if let Some(Const::String(method)) = args.get(1).and_then(|m| graph.as_const(*m))
                    && !method.is_empty()
                {
                    self.solvers.push((node, method, origin.clone()));
                }
                self.convert(argument, node, op, args, origin);
            }
            _ if op.converts() => self.convert(argument, node, op, args, origin),
            _ => pending.extend(args),
        }
    }

    fn convert(
        &mut self,
        argument: Option<usize>,
        to: usize,
        op: ClockOperator,
        args: &[ExprId],
        origin: &Origin,
    ) {
        let Some(from) = argument else { return };
        let counter = |k: usize| match args.get(k).and_then(|a| self.flat.graph.as_const(*a)) {
            Some(Const::Integer(n)) => n,
            _ => 1,
        };
        let counters = [counter(1), counter(2)];
        self.conversions.push(Conversion { from, to, op, counters, origin: origin.clone() });
    }
}

/// Disjoint sets of nodes.
#[derive(Clone)]
struct Union {
    parent: Vec<usize>,
}

impl Union {
    fn new(count: usize) -> Union {
        Union { parent: (0..count).collect() }
    }

    fn find(&self, mut node: usize) -> usize {
        while self.parent[node] != node {
            node = self.parent[node];
        }
        node
    }

    /// The lower representative stays, so paths are compressed on the way.
    fn join(&mut self, a: usize, b: usize) {
        let [low, high] = {
            let (a, b) = (self.find(a), self.find(b));
            [a.min(b), a.max(b)]
        };
        self.parent[high] = low;
        for mut node in [a, b] {
            while self.parent[node] != node {
                node = std::mem::replace(&mut self.parent[node], low);
            }
        }
    }
}

/// The number of a variable as a node.
pub fn node_of(v: VarId) -> usize {
    v.0 as usize
}
