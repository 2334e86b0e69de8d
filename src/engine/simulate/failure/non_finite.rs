//! Explains why a value is not finite: traces it back to the first subexpression that is not.

use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::name::string_of_id;
use crate::base::source::Span;
use crate::ir::blocks::{Block, Source};
use crate::ir::builtin::Domain;
use crate::ir::dae::{ROUNDED, VariableKind};
use crate::ir::expr::{Binary, Const, ExprId, Graph, Node, Unary, VarId};
use crate::ir::program::{BlockPosition, Program, Sequence, Slot, source_span};
use crate::symbolic::eval;
use crate::symbolic::print::print;
use crate::symbolic::rewrite::Rewriter;
use crate::symbolic::string;

use crate::simulate::cause::{NonFinite, RunCause};

/// Access to values and expressions of a run in the user's names.
pub struct Explainer<'a> {
    program: &'a Program,
    memory: &'a [f64],
}

/// The outermost block at a place.
pub fn block(program: &Program, place: BlockPosition) -> Option<&Block> {
    blocks_of(program, place.sequence).get(place.index)
}

/// The first equation of a block.
pub fn first_source(block: &Block) -> Option<Source> {
    match block {
        Block::Assign(a) => Some(a.source),
        Block::Torn(t) => t.residuals.first().map(|r| r.source),
        Block::Mixed(parts) => parts.iter().find_map(first_source),
    }
}

/// The equation that determines a variable between events.
pub fn source_of(program: &Program, v: VarId) -> Option<Source> {
    definitions(&program.blocks.continuous).remove(&v).map(|(_, source)| source)
}

impl<'a> Explainer<'a> {
    /// Reads the values of `memory`.
    pub fn new(program: &'a Program, memory: &'a [f64]) -> Self {
        Explainer { program, memory }
    }

    /// The value of a variable.
    pub fn value(&self, v: VarId) -> f64 {
        self.memory[self.program.layout.variables[v.idx()] as usize]
    }

    /// The value of an expression; NaN if it is not known.
    pub fn number(&self, e: ExprId) -> f64 {
        self.evaluate(e).get(&e).copied().unwrap_or(f64::NAN)
    }

    /// The value in a slot.
    pub fn at(&self, slot: Slot) -> f64 {
        self.memory[slot as usize]
    }

    /// Source position of an equation.
    pub fn span(&self, source: Source) -> Span {
        source_span(&self.program.blocks.dae, source)
    }

    /// Prints an expression, with relations expanded.
    pub fn text(&self, e: ExprId) -> String {
        let dae = &self.program.blocks.dae;
        // Events print many expressions, and cloning a graph is expensive.
        if !dae.graph.any([e], |_, node| matches!(node, Node::Relation(_))) {
            return print(&dae.graph, e, &|v| self.name(v));
        }
        let mut graph = dae.graph.clone();
        let e = written_out(self.program, &mut graph, e);
        print(&graph, e, &|v| self.name(v))
    }

    /// The value of a `String` expression; parts whose value is unknown are printed as expressions.
    pub fn message(&self, e: ExprId) -> String {
        let dae = &self.program.blocks.dae;
        let graph = &dae.graph;
        let value = |e: ExprId| self.evaluate(e).get(&e).copied().filter(|v| !v.is_nan());
        match graph.node(e) {
            Node::Const(Const::String(text)) => text.to_string(),
            Node::Binary(Binary::Add, a, b) => self.message(a) + &self.message(b),
            Node::If(c, a, b) => match value(c) {
                Some(c) => self.message(if c != 0.0 { a } else { b }),
                None => self.text(e),
            },
            Node::NoEvent(a) => self.message(a),
            Node::Unary(Unary::Text(form), a) => {
                let known = value(a).map(|x| Const::of_type(graph.ty(a), x));
                let text = known.and_then(|x| string::text(graph, x, graph.forms[form]));
                text.unwrap_or_else(|| self.text(a))
            }
            Node::Var(v) => match dae.eliminated.iter().find(|(p, _)| *p == v) {
                Some((_, definition)) => self.message(*definition),
                None => string_of_id(self.value(v) as u32).to_string(),
            },
            _ => self.text(e),
        }
    }

    /// Prints a relation.
    pub fn relation(&self, k: u32) -> String {
        relation_text(self.program, k)
    }

    /// Prints an equation.
    pub fn equation(&self, source: Source) -> String {
        let dae = &self.program.blocks.dae;
        match source {
            Source::Continuous(i) => {
                let q = &dae.equations[i];
                format!("{} = {}", self.text(q.lhs), self.text(q.rhs))
            }
            Source::Discrete(i) => {
                let q = &dae.discrete[i];
                format!("{} := {}", self.name(q.variable), self.text(q.value))
            }
            Source::Initial(i) => {
                let q = &dae.initial[i];
                format!("{} = {}", self.text(q.lhs), self.text(q.rhs))
            }
            Source::Start(v) => format!("{} = its start value", self.name(v)),
        }
    }

    /// Explains a variable that is not finite.
    pub fn not_finite(&self, v: VarId, sequence: Sequence, time: f64) -> Diagnostic {
        let definitions = definitions(blocks_of(self.program, sequence));
        let dae = &self.program.blocks.dae;
        let eliminated = dae.eliminated.iter().find(|(w, _)| *w == v).map(|(_, value)| *value);
        match definitions.get(&v) {
            Some(&(value, source)) => self.expression_not_finite(value, source, sequence, time),
            None => match (eliminated, self.discrete(v)) {
                (Some(value), _) => {
                    self.expression_not_finite(value, Source::Start(v), sequence, time)
                }
                (None, Some((value, source))) => {
                    self.expression_not_finite(value, source, sequence, time)
                }
                (None, None) => {
                    let value = NonFinite::Given { name: self.name(v), value: self.value(v) };
                    not_finite(value, time)
                }
            },
        }
    }

    /// Explains an expression that is not finite by following the variables it reads.
    pub fn expression_not_finite(
        &self,
        root: ExprId,
        source: Source,
        sequence: Sequence,
        time: f64,
    ) -> Diagnostic {
        let definitions = definitions(blocks_of(self.program, sequence));
        let (mut root, mut source) = (root, source);
        let mut visited: FastSet<VarId> = FastSet::default();
        loop {
            let values = self.evaluate(root);
            let culprit = self.descend(root, &values);
            if let Node::Var(v) = self.program.blocks.dae.graph.node(culprit)
                && visited.insert(v)
                && let Some((value, from)) =
                    definitions.get(&v).copied().or_else(|| self.discrete(v))
            {
                (root, source) = (value, from);
                continue;
            }
            return self.broken(culprit, &values, source, time);
        }
    }

    /// The message about the operation that produced the first value that is not finite.
    fn broken(
        &self,
        culprit: ExprId,
        values: &FastMap<ExprId, f64>,
        source: Source,
        time: f64,
    ) -> Diagnostic {
        let graph = &self.program.blocks.dae.graph;
        let text = self.text(culprit);
        let value = |e: ExprId| values.get(&e).copied().unwrap_or(f64::NAN);
        let found = match graph.node(culprit) {
            Node::Binary(Binary::Div, _, b) if value(b) == 0.0 => {
                NonFinite::Quotient { text, divisor: self.text(b) }
            }
            Node::Unary(op, a) if let Some(domain) = left_domain(op, value(a)) => {
                let (argument, value) = (self.text(a), value(a));
                match domain {
                    Domain::NotNegative => NonFinite::Root { argument, value },
                    Domain::Positive => NonFinite::Logarithm { argument, value },
                    Domain::UnitInterval | Domain::Everywhere => {
                        NonFinite::OutsideUnitInterval { text, argument, value }
                    }
                }
            }
            Node::Binary(Binary::Pow, a, b) => {
                NonFinite::Power { text, base: value(a), exponent: value(b) }
            }
            Node::Var(v) => NonFinite::Unknown { name: self.name(v), value: self.value(v) },
            _ => NonFinite::Expression { text, value: value(culprit) },
        };
        let cause = RunCause::NotFinite { time, value: found };
        let mut diagnostic = Diagnostic::new(cause, self.span(source))
            .label(format!("in `{}`", self.equation(source)));
        for v in graph.variables(culprit).into_iter().take(6) {
            diagnostic = diagnostic.note(format!("`{}` = {}", self.name(v), self.value(v)));
        }
        diagnostic
    }

    /// Descends from an expression that is not finite to one whose operands are.
    fn descend(&self, root: ExprId, values: &FastMap<ExprId, f64>) -> ExprId {
        let graph = &self.program.blocks.dae.graph;
        let broken = |e: ExprId| values.get(&e).is_some_and(|v| !v.is_finite());
        let mut at = root;
        loop {
            let mut next = None;
            if let Node::If(c, a, b) = graph.node(at) {
                let taken = if values.get(&c).is_some_and(|v| *v != 0.0) { a } else { b };
                next = broken(taken).then_some(taken);
            } else {
                graph.for_each_operand(at, |a| {
                    if next.is_none() && broken(a) {
                        next = Some(a);
                    }
                });
            }
            match next {
                Some(e) => at = e,
                None => return at,
            }
        }
    }

    /// The values of all nodes below `root`; NaN for calls.
    fn evaluate(&self, root: ExprId) -> FastMap<ExprId, f64> {
        let graph = &self.program.blocks.dae.graph;
        let layout = &self.program.layout;
        let at = |slot: u32| self.memory[slot as usize];
        let mut values: FastMap<ExprId, f64> = FastMap::default();
        for e in graph.postorder([root]) {
            let of = |a: &ExprId| values.get(a).copied().unwrap_or(f64::NAN);
            let value = match graph.node(e) {
                Node::Const(c) => c.register(),
                Node::Time => at(layout.time),
                Node::Var(v) | Node::Der(v) => self.value(v),
                Node::Pre(v) => {
                    let pre = layout.pre.iter().find(|(w, ..)| *w == v);
                    pre.map_or_else(|| self.value(v), |(_, _, slot)| at(*slot))
                }
                Node::Unary(op, a) => eval::unary(op, of(&a), graph.externals()),
                Node::Binary(op, a, b) => eval::binary(op, of(&a), of(&b), graph.externals()),
                Node::If(c, a, b) => {
                    if of(&c) != 0.0 {
                        of(&a)
                    } else {
                        of(&b)
                    }
                }
                Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => of(&a),
                Node::Initial => at(layout.initial),
                Node::Terminal => at(layout.terminal),
                Node::Relation(k) => at(layout.relations + k),
                Node::Recorded(v, order) => {
                    let known = layout.signals.iter().find(|r| (r.0, r.1) == (v, order));
                    known.map_or(f64::NAN, |(.., slot)| at(*slot))
                }
                Node::Call { .. } | Node::Sample(..) | Node::Clocked(..) => f64::NAN,
            };
            values.insert(e, value);
        }
        values
    }

    /// The value of a discrete variable, and its equation.
    fn discrete(&self, v: VarId) -> Option<(ExprId, Source)> {
        let all = &self.program.blocks.dae.discrete;
        let k = all.iter().position(|d| d.variable == v)?;
        Some((all[k].value, Source::Discrete(k)))
    }

    /// The name of a variable; the rounded values that lowering introduces have none, and are shown
    /// as they are computed.
    fn name(&self, v: VarId) -> String {
        let dae = &self.program.blocks.dae;
        let Some(variable) = dae.variables.get(v) else { return "a derivative".to_owned() };
        if variable.hidden
            && variable.kind == VariableKind::Discrete
            && variable.name.starts_with(ROUNDED)
            && let Some((value, _)) = self.discrete(v)
        {
            // What rounds time reads the value before: its first value shows the function.
            return match dae.graph.node(value) {
                Node::If(c, first, _) if dae.graph.node(c) == Node::Initial => self.text(first),
                _ => self.text(value),
            };
        }
        variable.name.clone()
    }
}

/// Reports a value that is not finite, without a source position.
pub fn not_finite(value: NonFinite, time: f64) -> Diagnostic {
    Diagnostic::new(RunCause::NotFinite { time, value }, Span::NONE)
}

/// The domain of a function, if the argument lies outside.
fn left_domain(op: Unary, a: f64) -> Option<Domain> {
    let domain = op.facts()?.domain;
    (!a.is_nan() && !domain.contains(a)).then_some(domain)
}

/// Prints a relation in the user's names.
pub fn relation_text(program: &Program, k: u32) -> String {
    let dae = &program.blocks.dae;
    let relation = &dae.relations[k as usize];
    let explainer = Explainer::new(program, &[]);
    format!(
        "{} {} {}",
        explainer.text(relation.lhs),
        relation.op.name(),
        explainer.text(relation.rhs)
    )
}

fn written_out(program: &Program, graph: &mut Graph, e: ExprId) -> ExprId {
    let relations = &program.blocks.dae.relations;
    Rewriter::new().apply(graph, e, &mut |graph, n| match graph.node(n) {
        Node::Relation(k) => {
            let r = relations.get(k as usize)?;
            Some(graph.binary(r.op, r.lhs, r.rhs))
        }
        _ => None,
    })
}

fn blocks_of(program: &Program, sequence: Sequence) -> &[Block] {
    match sequence {
        Sequence::Initial => &program.blocks.initial,
        Sequence::InitialByStates => &program.blocks.initial_by_states,
        Sequence::Event => &program.blocks.event,
        Sequence::Continuous => &program.blocks.continuous,
    }
}

/// The defining expression of each variable; for tearing variables, a residual of their block.
fn definitions(blocks: &[Block]) -> FastMap<VarId, (ExprId, Source)> {
    let mut found = FastMap::default();
    let mut pending: Vec<&Block> = blocks.iter().collect();
    while let Some(block) = pending.pop() {
        match block {
            Block::Assign(a) => {
                found.insert(a.variable, (a.value, a.source));
            }
            Block::Torn(t) => {
                for a in &t.explicit {
                    found.insert(a.variable, (a.value, a.source));
                }
                for (z, r) in t.unknowns.iter().zip(&t.residuals) {
                    found.insert(*z, (r.value, r.source));
                }
            }
            Block::Mixed(parts) => pending.extend(parts),
        }
    }
    found
}
