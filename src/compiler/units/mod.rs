//! Unit checking: dimensional analysis with inference (Modelica 3.6, chapter 19).
//!
//! *In:* an [`ir::flat`](crate::ir::flat) model. *Out:* a warning for each unknown unit, and for
//! each equation or binding whose two sides, or two terms, have different units: of another
//! dimension, or of another size or zero, such as bar and Pa, or degC and K; likewise for each
//! argument of a function and the input that it is given for. Variables without a
//! unit get the one that the equations require; units that remain unknown are not compared. Each
//! iteration makes two passes over the graph; the number of iterations is the length of the longest
//! chain of inferences, at most [`MAX_ITERATIONS`].
//!
//! A literal counts as a dimensionless factor only if it is obviously one, such as 2 or 0.5: others
//! may be physical constants, whose units are lost by constant folding, or convert units.
//! *Wand and O'Keefe, Automatic dimensional inference, 1991; Kennedy 1996.*

pub mod cause;
pub mod dimension;
mod quantity;
pub mod unit;

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::builtin::{BinaryUnit, UnaryUnit};
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::{Action, EquationKind, FlatModel, UnitOfArgument};
use cause::UnitCause;
use quantity::{Difference, Quantity};
use unit::Unit;

/// Maximum number of iterations of the inference.
const MAX_ITERATIONS: usize = 40;

/// Bytes between the name of a variable and a call in its binding.
const FARTHEST_BINDING: u32 = 500;

/// Two expressions that must have the same unit.
struct ComparedPair {
    left: ExprId,
    right: ExprId,
    span: Span,
}

/// The units that are known.
struct Inference<'a> {
    flat: &'a FlatModel,
    /// Units of variables, declared or inferred.
    variables: IndexVec<VarId, Option<Quantity>>,
    /// Units of expressions in this iteration.
    expressions: IndexVec<ExprId, Option<Quantity>>,
    changed: bool,
}

/// Adds a warning for each mismatch.
pub fn check(flat: &mut FlatModel, problems: &mut Problems) {
    let mut pairs = pairs(flat);
    // Equations with a constant that has lost its unit cannot be checked.
    pairs.retain(|p| !flat.unitless_literals.contains(&p.span));
    let units = declared(flat, problems);
    let variables = flat.variables.iter().map(|v| match v.ty {
        Type::Real => units.get(&v.unit).copied().flatten().map(Quantity::declared),
        _ => None,
    });
    let variables = variables.collect();
    let mut inference = Inference { flat, variables, expressions: IndexVec::new(), changed: true };
    for _ in 0..MAX_ITERATIONS {
        if !std::mem::take(&mut inference.changed) {
            break;
        }
        inference.evaluate();
        for pair in &pairs {
            inference.infer(pair);
        }
    }
    inference.evaluate();
    // Elements of an array and instances of a component share the place of their equation.
    let mut reported: FastSet<Span> = FastSet::default();
    let mut wrong = Vec::new();
    for argument in &flat.argument_units {
        if let Some(d) = inference.wrong_argument(argument)
            && reported.insert(d.primary.0)
        {
            wrong.push(argument);
            problems.push(d);
        }
    }
    for pair in &pairs {
        if let Some(d) = inference.mismatch(pair)
            && !wrong.iter().any(|argument| inference.follows_from(pair, argument))
            && reported.insert(d.primary.0)
        {
            problems.push(d);
        }
    }
}

/// The declared units of Real variables. Each unknown one is reported once.
fn declared(flat: &FlatModel, problems: &mut Problems) -> FastMap<Name, Option<Unit>> {
    let mut units: FastMap<Name, Option<Unit>> = FastMap::default();
    for v in flat.variables.iter().filter(|v| v.ty == Type::Real && !v.unit.is_empty()) {
        units.entry(v.unit).or_insert_with(|| {
            let unit = Unit::of(&v.unit);
            if unit.is_none() {
                let near = did_you_mean(&v.unit, Unit::symbols()).map(str::to_owned);
                let cause = UnitCause::UnknownUnit { unit: v.unit.to_string(), near };
                problems.push(Diagnostic::new(cause, v.span));
            }
            unit
        });
    }
    units
}

/// The two sides of all equations, bindings and assignments.
fn pairs(flat: &mut FlatModel) -> Vec<ComparedPair> {
    let mut out = Vec::new();
    for v in flat.variables.ids() {
        let variable = &flat.variables[v];
        if variable.ty == Type::Real
            && let Some(right) = variable.binding
        {
            let span = variable.span;
            out.push(ComparedPair { left: flat.read(v), right, span });
        }
        let variable = &flat.variables[v];
        if variable.ty == Type::Real
            && variable.binding.is_none()
            && let Some(right) = variable.start
        {
            let span = variable.span;
            out.push(ComparedPair { left: flat.read(v), right, span });
        }
    }
    let mut assigned = Vec::new();
    for equation in flat.equations.iter().chain(&flat.initial_equations) {
        let span = equation.origin.span;
        match &equation.kind {
            EquationKind::Equal(left, right) => {
                residuals(&flat.graph, *left, *right, span, &mut out);
            }
            EquationKind::When(branches) => {
                for action in branches.iter().flat_map(|b| &b.actions) {
                    match action {
                        Action::Assign(v, e) | Action::Reinit { state: v, value: e, .. } => {
                            assigned.push((*v, *e, span));
                        }
                        Action::Assert(_) | Action::Terminate { .. } => {}
                    }
                }
            }
            EquationKind::Algorithm { outputs, values } => {
                assigned.extend(outputs.iter().zip(values).map(|(v, e)| (*v, *e, span)));
            }
            EquationKind::Assert(a) => {
                out.push(ComparedPair { left: a.condition, right: a.condition, span });
            }
        }
    }
    for (v, right, span) in assigned {
        out.push(ComparedPair { left: flat.read(v), right, span });
    }
    out
}

/// Splits `0 = if c then a - b else d - e` into the two equations that it was merged from, whose
/// units are independent.
fn residuals(g: &Graph, left: ExprId, right: ExprId, span: Span, out: &mut Vec<ComparedPair>) {
    let mut open = vec![right];
    if g.as_number(left) != Some(0.0) {
        out.push(ComparedPair { left, right, span });
        return;
    }
    while let Some(e) = open.pop() {
        match g.node(e) {
            Node::If(_, a, b) => open.extend([b, a]),
            Node::Binary(Binary::Sub, a, b) => out.push(ComparedPair { left: a, right: b, span }),
            _ => out.push(ComparedPair { left, right: e, span }),
        }
    }
}

impl Inference<'_> {
    fn graph(&self) -> &Graph {
        &self.flat.graph
    }

    /// The units of all expressions; operands have lower numbers than their users.
    fn evaluate(&mut self) {
        let count = self.flat.graph.len();
        self.expressions = IndexVec::new();
        self.expressions.reserve_exact(count);
        for e in self.flat.graph.ids() {
            let d = self.of(e);
            self.expressions.push(d);
        }
    }

    fn of(&self, e: ExprId) -> Option<Quantity> {
        let known = |e: ExprId| self.expressions[e];
        match self.graph().node(e) {
            Node::Time => Some(Quantity::TIME),
            Node::Var(v) | Node::Pre(v) => self.of_variable(v),
            Node::Der(v) => self.of_variable(v).map(|q| q.over(Quantity::TIME)),
            Node::Unary(op, a) => match of_unary(op) {
                UnaryUnit::Same if op == Unary::Neg => known(a).map(|q| q.scaled_by(-1.0)),
                UnaryUnit::Same => known(a),
                UnaryUnit::Root => known(a)?.power(0.5),
                UnaryUnit::Number | UnaryUnit::FromAny => Some(Quantity::NUMBER),
                UnaryUnit::Unknown => None,
            },
            Node::Binary(op, a, b) => match of_binary(op) {
                BinaryUnit::Sum => self.of_sum(op, a, b),
                BinaryUnit::Product => self.of_product(a, b),
                BinaryUnit::Quotient => match self.graph().as_number(b) {
                    Some(literal) if is_plain(literal) => Some(known(a)?.scaled_by(1.0 / literal)),
                    _ => Some(self.factor(a)?.over(self.factor(b)?)),
                },
                BinaryUnit::Power => match known(a)? {
                    Quantity::NUMBER => Some(Quantity::NUMBER),
                    base => base.power(self.graph().as_number(b)?),
                },
                BinaryUnit::Angle => Some(Quantity::NUMBER),
                BinaryUnit::Alike | BinaryUnit::Unknown => None,
            },
            Node::If(_, a, b) | Node::Homotopy(a, b) => {
                // A literal in one branch may have the unit of the other branch.
                let literal = |e| self.graph().as_number(e).is_some();
                if literal(a) || literal(b) { None } else { known(a).or(known(b)) }
            }
            Node::NoEvent(a) | Node::Smooth(_, a) => known(a),
            _ => None,
        }
    }

    fn of_sum(&self, op: Binary, a: ExprId, b: ExprId) -> Option<Quantity> {
        let literals = [a, b].map(|e| self.graph().as_number(e));
        match (self.expressions[a], self.expressions[b]) {
            (Some(x), Some(y)) if literals == [None; 2] => Some(x.plus(y, op == Binary::Sub)),
            (Some(x), _) if literals[0].is_none() => Some(match literals[1] {
                Some(literal) => x.shifted_by(literal),
                None => x.of_terms(),
            }),
            (_, Some(y)) if literals[1].is_none() => Some(match literals[0] {
                Some(literal) => y.shifted_by(literal),
                None => y.of_terms(),
            }),
            (x, y) => x.or(y),
        }
    }

    fn of_product(&self, a: ExprId, b: ExprId) -> Option<Quantity> {
        let literal = |e| self.graph().as_number(e).filter(|x| is_plain(*x));
        match (literal(a), literal(b)) {
            (Some(x), None) => Some(self.expressions[b]?.scaled_by(x)),
            (None, Some(x)) => Some(self.expressions[a]?.scaled_by(x)),
            _ => Some(self.factor(a)?.times(self.factor(b)?)),
        }
    }

    /// The unit of a variable; unknown for locals of functions that are called at run time.
    fn of_variable(&self, v: VarId) -> Option<Quantity> {
        self.variables.get(v).copied().flatten()
    }

    /// The unit of a factor: simple literals are numbers as factors, but may have any unit as
    /// terms.
    fn factor(&self, e: ExprId) -> Option<Quantity> {
        match self.graph().as_number(e) {
            Some(value) => is_plain(value).then(|| Quantity::NUMBER.scaled_by(value)),
            None => self.expressions[e],
        }
    }

    /// Infers the unit of one side from the other one.
    fn infer(&mut self, pair: &ComparedPair) {
        match (self.expressions[pair.left], self.expressions[pair.right]) {
            (Some(d), None) => self.impose(pair.right, d),
            (None, Some(d)) => self.impose(pair.left, d),
            (Some(_), Some(_)) => {
                // Operands may still be unknown.
                self.impose_inside(pair.left);
                self.impose_inside(pair.right);
            }
            (None, None) => {}
        }
    }

    fn impose_inside(&mut self, e: ExprId) {
        if let Some(d) = self.expressions[e] {
            self.impose(e, d);
        }
    }

    /// Propagates the unit `d` of `e` to its operands.
    fn impose(&mut self, e: ExprId, d: Quantity) {
        let mut open = vec![(e, d)];
        let mut steps = 0;
        while let Some((e, d)) = open.pop() {
            steps += 1;
            if steps > 1000 {
                return;
            }
            match self.graph().node(e) {
                Node::Var(v) | Node::Pre(v) => self.set(v, d),
                Node::Der(v) => self.set(v, d.times(Quantity::TIME).of_terms()),
                Node::NoEvent(a) | Node::Smooth(_, a) => open.push((a, d)),
                Node::Unary(op, a) => match of_unary(op) {
                    UnaryUnit::Same => open.push((a, d)),
                    UnaryUnit::Root => open.extend(d.power(2.0).map(|d| (a, d))),
                    UnaryUnit::Number | UnaryUnit::FromAny | UnaryUnit::Unknown => {}
                },
                Node::If(_, a, b) | Node::Homotopy(a, b) => open.extend([(a, d), (b, d)]),
                Node::Binary(op, a, b) => match (of_binary(op), self.factor(a), self.factor(b)) {
                    (BinaryUnit::Sum, ..) => open.extend([(a, d.of_terms()), (b, d.of_terms())]),
                    (BinaryUnit::Product, Some(x), None) => open.push((b, d.over(x))),
                    (BinaryUnit::Product, None, Some(x)) => open.push((a, d.over(x))),
                    (BinaryUnit::Quotient, Some(x), None) => open.push((b, x.over(d))),
                    (BinaryUnit::Quotient, None, Some(x)) => open.push((a, d.times(x))),
                    _ => {}
                },
                _ => {}
            }
        }
    }

    fn set(&mut self, v: VarId, d: Quantity) {
        // A declared unit that is not understood is not overwritten.
        let Some(variable) = self.flat.variables.get(v) else { return };
        if self.variables[v].is_none() && variable.unit.is_empty() && variable.ty == Type::Real {
            self.variables[v] = Some(d);
            self.changed = true;
        }
    }

    /// The first mismatch within the two sides, or between them.
    fn mismatch(&self, pair: &ComparedPair) -> Option<Diagnostic> {
        let g = self.graph();
        let between = |difference: Difference, a, b| self.different(difference, a, b, pair.span);
        for e in g.postorder([pair.left, pair.right]) {
            match g.node(e) {
                Node::Binary(op, a, b) => {
                    let found = match of_binary(op) {
                        BinaryUnit::Sum if op == Binary::Add => {
                            self.compare(a, b, Quantity::difference_in_sum)
                        }
                        BinaryUnit::Sum | BinaryUnit::Angle | BinaryUnit::Alike => {
                            self.differ(a, b)
                        }
                        _ => None,
                    };
                    if let Some(difference) = found {
                        return Some(between(difference, a, b));
                    }
                    if of_binary(op) == BinaryUnit::Power && self.is_not_a_number(b) {
                        return Some(self.not_dimensionless(
                            b,
                            "an exponent".to_owned(),
                            pair.span,
                        ));
                    }
                }
                Node::If(_, a, b) | Node::Homotopy(a, b) => {
                    if let Some(difference) = self.differ(a, b) {
                        return Some(between(difference, a, b));
                    }
                }
                Node::Unary(op, a)
                    if of_unary(op) == UnaryUnit::Number && self.is_not_a_number(a) =>
                {
                    let role = format!("the argument of `{}`", op.name());
                    return Some(self.not_dimensionless(a, role, pair.span));
                }
                _ => {}
            }
        }
        let difference = self.differ(pair.left, pair.right)?;
        Some(between(difference, pair.left, pair.right))
    }

    /// Whether a call in a pair, whose body is part of it, has an argument in a wrong unit.
    fn follows_from(&self, pair: &ComparedPair, argument: &UnitOfArgument) -> bool {
        let (here, call) = (pair.span, argument.span);
        // The place of a binding is the name before it.
        let is_near = here.file == call.file
            && here.start <= call.start
            && call.start <= here.end.saturating_add(FARTHEST_BINDING);
        let is_argument = |e, _| e == argument.value;
        is_near && self.graph().any([pair.left, pair.right], is_argument)
    }

    /// The difference between an argument of a call and the input of the function, if it is known.
    fn wrong_argument(&self, argument: &UnitOfArgument) -> Option<Diagnostic> {
        let declared = Quantity::declared(Unit::of(&argument.unit)?);
        let found = self.expressions.get(argument.value).copied().flatten()?;
        found.difference(declared)?;
        let cause = UnitCause::OtherUnitOfArgument {
            function: argument.function.to_string(),
            input: argument.input.to_string(),
            unit: argument.unit.to_string(),
            text: self.text(argument.value),
            text_unit: self.unit(argument.value),
        };
        let d = Diagnostic::new(cause, argument.span);
        Some(self.with_places(d, [argument.value, argument.value]))
    }

    fn is_not_a_number(&self, e: ExprId) -> bool {
        self.expressions[e].is_some_and(Quantity::is_not_a_number)
    }

    fn differ(&self, a: ExprId, b: ExprId) -> Option<Difference> {
        self.compare(a, b, Quantity::difference)
    }

    /// Compares two expressions whose units are known; a literal may have any unit.
    fn compare(
        &self,
        a: ExprId,
        b: ExprId,
        difference: fn(Quantity, Quantity) -> Option<Difference>,
    ) -> Option<Difference> {
        if [a, b].iter().any(|e| self.graph().as_number(*e).is_some()) {
            return None;
        }
        difference(self.expressions[a]?, self.expressions[b]?)
    }

    fn different(&self, difference: Difference, a: ExprId, b: ExprId, span: Span) -> Diagnostic {
        let [left, right] = [a, b].map(|e| self.text(e));
        let [left_unit, right_unit] = [a, b].map(|e| self.unit(e));
        let cause = match difference {
            Difference::Dimension => UnitCause::Mismatch { left, left_unit, right, right_unit },
            Difference::Scale => UnitCause::OtherScale { left, left_unit, right, right_unit },
        };
        self.with_places(Diagnostic::new(cause, span), [a, b])
    }

    fn not_dimensionless(&self, e: ExprId, role: String, span: Span) -> Diagnostic {
        let cause = UnitCause::NotDimensionless { role, text: self.text(e), unit: self.unit(e) };
        self.with_places(Diagnostic::new(cause, span), [e, e])
    }

    /// Shows where the units come from: the first variable with a declared unit in each expression.
    fn with_places(&self, mut d: Diagnostic, sides: [ExprId; 2]) -> Diagnostic {
        let mut shown = Vec::new();
        for side in sides {
            let declared = self.graph().postorder([side]).into_iter().find_map(|e| {
                match self.graph().node(e) {
                    Node::Var(v) | Node::Der(v) | Node::Pre(v)
                        if self.flat.variables.get(v).is_some_and(|x| !x.unit.is_empty()) =>
                    {
                        Some(v)
                    }
                    _ => None,
                }
            });
            let Some(v) = declared.filter(|v| !shown.contains(v)) else { continue };
            shown.push(v);
            let variable = &self.flat.variables[v];
            d = d.also(variable.span, format!("`{}` is in `{}`", variable.name, variable.unit));
        }
        d
    }

    fn text(&self, e: ExprId) -> String {
        let names =
            |v: VarId| self.flat.variables.get(v).map_or_else(String::new, |x| x.name.clone());
        let text = crate::symbolic::print::print(self.graph(), e, &names);
        match text.char_indices().nth(60) {
            Some((end, _)) => format!("{}...", &text[..end]),
            None => text,
        }
    }

    /// The declared unit if the expression is a variable, else the inferred one.
    fn unit(&self, e: ExprId) -> String {
        if let Node::Var(v) = self.graph().node(e) {
            let unit = self.flat.variables.get(v).map(|x| x.unit);
            if let Some(unit) = unit.filter(|u| !u.is_empty()) {
                return format!("`{unit}`");
            }
        }
        self.expressions[e].map_or_else(String::new, |d| format!("`{d}`"))
    }
}

/// The rule of a unary operator; functions defined by data are dimensionless.
fn of_unary(op: Unary) -> UnaryUnit {
    op.facts().map_or(UnaryUnit::FromAny, |row| row.unit)
}

/// The rule of a binary operator.
fn of_binary(op: Binary) -> BinaryUnit {
    op.facts().map_or(BinaryUnit::Unknown, |row| row.unit)
}

/// True for numbers that are factors rather than physical constants: small integers, halves,
/// quarters, tenths, and multiples of pi.
fn is_plain(value: f64) -> bool {
    let whole = |x: f64| (x - x.round()).abs() < 1e-12 * x.abs().max(1.0) && x.abs() <= 1000.0;
    value != 0.0
        && (whole(value * 4.0) || whole(value * 10.0) || whole(1.0 / value) || {
            let half_turns = value / std::f64::consts::PI;
            whole(half_turns * 4.0) || whole(1.0 / half_turns)
        })
}
