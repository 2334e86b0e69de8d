//! Chooses the representative of each class of equal variables, and adds the variables of
//! derivatives.

use super::alias::{AliasClasses, Signed};
use super::error;
use crate::base::diag::Problems;
use crate::base::index::{FastSet, IndexVec};
use crate::ir::dae::{Variable, VariableKind};
use crate::ir::expr::{Binary, ExprId, Graph, Node, VarId};
use crate::ir::flat::StateSelect;

/// The replacement of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Replacement {
    /// The variable itself: it is kept.
    Kept,
    /// Another variable or its negative.
    Alias(Signed),
    /// A parameter expression.
    Value(ExprId),
}

/// Chooses the representatives, gives every differentiated one a derivative variable, and merges
/// attributes. `roots` are all expressions in use, which determine the differentiated variables.
pub fn choose(
    graph: &mut Graph,
    variables: &mut IndexVec<VarId, Variable>,
    mut classes: AliasClasses,
    roots: &[ExprId],
    problems: &mut Problems,
) -> IndexVec<VarId, Replacement> {
    let mut differentiated = FastSet::default();
    let mut written_under_der = IndexVec::filled(false, variables.len());
    for e in graph.postorder(roots.iter().copied()) {
        if let Node::Der(v) = graph.node(e) {
            differentiated.insert(classes.union.find(v).variable);
            written_under_der[v] = true;
        }
    }
    let mut members: Vec<(VarId, Signed)> = Vec::with_capacity(variables.len());
    for (v, variable) in variables.enumerate() {
        if matches!(
            variable.kind,
            VariableKind::Algebraic | VariableKind::Input | VariableKind::Discrete
        ) {
            let Signed { variable: root, negative } = classes.union.find(v);
            members.push((root, Signed { variable: v, negative }));
        }
    }
    members.sort_by_key(|(root, member)| (*root, member.variable));
    variables.reserve_exact(differentiated.len());
    let replacement = IndexVec::filled(Replacement::Kept, variables.len());
    let mut choice =
        RepresentativeChoice { graph, variables, problems, written_under_der, replacement };
    let of_class = |root: VarId| {
        let start = members.partition_point(|(r, _)| *r < root);
        let end = members.partition_point(|(r, _)| *r <= root);
        members[start..end].iter().map(|(_, member)| *member)
    };
    for class in members.chunk_by(|a, b| a.0 == b.0) {
        let root = class[0].0;
        if let Some(&value) = classes.value.get(&root) {
            choice.replace_by_value(value, of_class(root));
        } else if !classes.is_derivative_name.contains(&root) {
            // From a variable to the name of its derivative, to that of its second derivative...
            let mut next = Some((root, None));
            while let Some((root, integral)) = next {
                let chosen = choice.represent(of_class(root), integral);
                next = classes.derivative_name.get(&root).map(|name| {
                    let negative = name.negative ^ chosen.negative;
                    (name.variable, Some(Integral { variable: chosen.variable, negative }))
                });
                // Inputs are constant and discrete variables change only at events.
                let varies = choice.variables[chosen.variable].kind == VariableKind::Algebraic;
                if next.is_none() && varies && differentiated.contains(&root) {
                    choice.add_derivative(chosen.variable, VariableKind::Algebraic);
                }
            }
        }
    }
    choice.replacement
}

/// The variable that a class differentiates: `der(variable)` is the root of the class or its
/// negative.
#[derive(Clone, Copy)]
struct Integral {
    variable: VarId,
    negative: bool,
}

struct RepresentativeChoice<'a> {
    graph: &'a mut Graph,
    variables: &'a mut IndexVec<VarId, Variable>,
    problems: &'a mut Problems,
    /// Variables written under `der`.
    written_under_der: IndexVec<VarId, bool>,
    replacement: IndexVec<VarId, Replacement>,
}

impl RepresentativeChoice<'_> {
    fn replace_by_value(&mut self, value: ExprId, members: impl Iterator<Item = Signed>) {
        for member in members {
            let value = if member.negative { self.graph.neg(value) } else { value };
            self.replacement[member.variable] = Replacement::Value(value);
            self.variables[member.variable].kind = VariableKind::Eliminated;
        }
    }

    /// Chooses the representative, replaces the others by it, and returns it with its sign relative
    /// to the root. A derivative needs a representative with positive sign: if only its negative
    /// has names, it gets a new variable.
    fn represent(
        &mut self,
        members: impl Iterator<Item = Signed> + Clone,
        integral: Option<Integral>,
    ) -> Signed {
        let fits = |m: &Signed| integral.is_none_or(|i| i.negative == m.negative);
        let best = members.clone().filter(fits).max_by_key(|m| self.rank(m.variable));
        let chosen = match (best, integral) {
            (Some(best), None) => best,
            (Some(best), Some(of)) => {
                self.variables[best.variable].derivative_of = Some(of.variable);
                let read = self.add_derivative(of.variable, VariableKind::Eliminated);
                let alias = Signed { variable: best.variable, negative: false };
                self.replacement[read] = Replacement::Alias(alias);
                self.variables[read].derivative_of = None;
                self.variables[of.variable].kind =
                    VariableKind::Differentiated { derivative: best.variable };
                best
            }
            (None, Some(of)) => {
                let variable = self.add_derivative(of.variable, VariableKind::Algebraic);
                Signed { variable, negative: of.negative }
            }
            // Unreachable: every class has members.
            (None, None) => return Signed { variable: VarId(0), negative: false },
        };
        let relative: Vec<Signed> = members
            .filter(|m| m.variable != chosen.variable)
            .map(|m| Signed { variable: m.variable, negative: m.negative ^ chosen.negative })
            .collect();
        if !relative.is_empty() {
            self.merge(chosen.variable, &relative);
        }
        for m in relative {
            let alias = Signed { variable: chosen.variable, negative: m.negative };
            self.replacement[m.variable] = Replacement::Alias(alias);
            self.variables[m.variable].kind = VariableKind::Eliminated;
        }
        chosen
    }

    /// The suitability as representative: preferred states first, then variables that occur under
    /// `der`, variables with a fixed start, and names near the top of the model.
    fn rank(&self, v: VarId) -> impl Ord + use<> {
        use std::cmp::Reverse;
        let variable = &self.variables[v];
        (
            variable.kind == VariableKind::Input,
            variable.state_select,
            self.written_under_der[v],
            variable.fixed == Some(true),
            !variable.protected,
            Reverse(variable.name.bytes().filter(|b| *b == b'.').count()),
            Reverse(variable.name.len()),
            Reverse(v),
        )
    }

    fn add_derivative(&mut self, of: VarId, kind: VariableKind) -> VarId {
        let integral = &self.variables[of];
        let derivative = Variable::derivative(of, integral, kind);
        let id = self.variables.push(derivative);
        self.replacement.push(Replacement::Kept);
        self.variables[of].kind = VariableKind::Differentiated { derivative: id };
        id
    }

    /// Merges the attributes of all members into the representative.
    fn merge(&mut self, chosen: VarId, others: &[Signed]) {
        let own = Signed { variable: chosen, negative: false };
        let all = || std::iter::once(own).chain(others.iter().copied());
        self.merge_start(chosen, all());
        let mut low = None;
        let mut high = None;
        for m in all() {
            let v = &self.variables[m.variable];
            let (min, max) = if m.negative { (v.max, v.min) } else { (v.min, v.max) };
            let min = min.map(|e| self.signed(e, m.negative));
            let max = max.map(|e| self.signed(e, m.negative));
            low = self.tighter(Binary::Max, low, min);
            high = self.tighter(Binary::Min, high, max);
        }
        let nominal = all().find_map(|m| self.variables[m.variable].nominal);
        let preference = all()
            .map(|m| self.variables[m.variable].state_select)
            .filter(|s| *s != StateSelect::Default)
            .max();
        let others_may =
            all().any(|m| self.variables[m.variable].state_select != StateSelect::Never);
        let unit = all().map(|m| self.variables[m.variable].unit).find(|u| !u.is_empty());
        let v = &mut self.variables[chosen];
        v.min = low;
        v.max = high;
        v.nominal = nominal;
        v.state_select = match preference {
            // What excludes one of the variables leaves the others, so that it only is a wish.
            Some(StateSelect::Never) if others_may => StateSelect::Avoid,
            wish => wish.unwrap_or_default(),
        };
        v.unit = unit.unwrap_or(v.unit);
    }

    /// A fixed start takes precedence over a guess, and the representative's over another one.
    /// Fixed starts must agree.
    fn merge_start(&mut self, chosen: VarId, all: impl Iterator<Item = Signed> + Clone) {
        let mut fixed: Option<(VarId, ExprId)> = None;
        for m in all.clone() {
            if self.variables[m.variable].fixed != Some(true) {
                continue;
            }
            let start = self.variables[m.variable].start;
            let start = match start {
                Some(e) => self.signed(e, m.negative),
                None => self.graph.real(0.0),
            };
            match fixed {
                Some((first, value)) if value != start => {
                    let [a, b] = [first, m.variable].map(|v| &self.variables[v]);
                    self.problems.push(error::conflicting_starts(a, b));
                }
                Some(_) => {}
                None => fixed = Some((m.variable, start)),
            }
        }
        let start = match fixed {
            Some((_, start)) => Some(start),
            None => {
                let guess = |m: Signed| Some((self.variables[m.variable].start?, m.negative));
                let first = all.clone().find_map(guess);
                first.map(|(e, negative)| self.signed(e, negative))
            }
        };
        let v = &mut self.variables[chosen];
        v.start = start;
        v.fixed = if fixed.is_some() { Some(true) } else { v.fixed };
    }

    fn signed(&mut self, e: ExprId, negative: bool) -> ExprId {
        if negative { self.graph.neg(e) } else { e }
    }

    fn tighter(&mut self, op: Binary, a: Option<ExprId>, b: Option<ExprId>) -> Option<ExprId> {
        match (a, b) {
            (Some(a), Some(b)) if a != b => Some(self.graph.binary(op, a, b)),
            (a, b) => a.or(b),
        }
    }
}
