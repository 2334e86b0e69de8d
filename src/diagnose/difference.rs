//! Differences of two variables that an effect may depend on: a loss over the difference to the surroundings, a joint over
//! that of two angles.

use crate::base::index::FastSet;
use crate::ir::expr::{Binary, ExprId, Node, Type, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Variability};

use super::variation::states;

/// Differences that are looked at.
const MAX_DIFFERENCES: usize = 6;
/// Of these, differences of two states that no equation contains.
const MAX_OF_STATES: usize = 4;
/// Between the two variables of a difference.
const MINUS: &str = " - ";

/// The two variables of a difference.
pub fn as_difference(text: &str) -> Option<(&str, &str)> {
    let is_name = |text: &&str| !text.contains([' ', '*', '/', '+', '^', '(', ')']);
    text.split_once(MINUS).filter(|(a, b)| [a, b].into_iter().all(is_name))
}

/// The differences of two variables of one unit that the equations of the model's own source contain, then those of two
/// states, or of a state and an input of its declared unit; without those that are variables of the model. A parameter counts
/// as a variable if it differs between the recordings, as `conditions` do.
pub fn differences(flat: &FlatModel, conditions: &[String], inputs: &[String]) -> Vec<String> {
    let difference = |e: ExprId| {
        let Node::Binary(Binary::Sub, a, b) = flat.graph.node(e) else { return None };
        match (flat.graph.node(a), flat.graph.node(b)) {
            (Node::Var(a), Node::Var(b)) => Some((a, b)),
            _ => None,
        }
    };
    let sides = flat.equations.iter().filter_map(|equation| match equation.kind {
        EquationKind::Equal(left, right) => Some((equation.origin.span, [left, right])),
        _ => None,
    });
    let sides: Vec<_> = sides.collect();
    let bindings = flat.variables.iter().filter_map(|v| v.binding);
    // A difference that is a function of one variable of the model.
    let whole = sides.iter().flat_map(|(_, [left, right])| [(*left, *right), (*right, *left)]);
    let whole = whole.filter_map(|(other, side)| Some((other, difference(side)?)));
    let whole = whole.filter(|(other, _)| is_of_one_variable(flat, *other)).map(|(_, pair)| pair);
    let whole = whole.chain(bindings.filter_map(difference));
    let ordered = |(a, b): (VarId, VarId)| (a.min(b), a.max(b));
    // Those that are known already, or variables of the model.
    let mut known: FastSet<(VarId, VarId)> = whole.map(ordered).collect();
    let mut found = Vec::new();
    let own = sides.iter().filter(|(span, _)| span.file == flat.span.file);
    let below = flat.graph.postorder(own.flat_map(|(_, sides)| *sides));
    for pair in below.into_iter().filter_map(difference) {
        if varies(flat, pair, conditions) && known.insert(ordered(pair)) {
            found.push(pair);
        }
    }
    let states = states(flat);
    let pairs =
        states.iter().enumerate().flat_map(|(k, a)| states[k + 1..].iter().map(move |b| (*a, *b)));
    let is_input = |v: VarId| inputs.contains(&flat.variables[v].name);
    let inputs: Vec<VarId> = flat.variables.ids().filter(|v| is_input(*v)).collect();
    let of_inputs = states.iter().flat_map(|a| inputs.iter().map(move |b| (*a, *b)));
    let has_unit = |pair: &(VarId, VarId)| !flat.variables[pair.0].unit.is_empty();
    let mut is_new =
        |pair: &(VarId, VarId)| varies(flat, *pair, conditions) && known.insert(ordered(*pair));
    found.truncate(MAX_DIFFERENCES);
    let left = MAX_DIFFERENCES - found.len();
    found.extend(pairs.filter(&mut is_new).take(left.min(MAX_OF_STATES)));
    let left = MAX_DIFFERENCES - found.len();
    found.extend(of_inputs.filter(has_unit).filter(&mut is_new).take(left));
    let name = |v: VarId| &flat.variables[v].name;
    found.into_iter().map(|(a, b)| format!("{}{MINUS}{}", name(a), name(b))).collect()
}

/// True for an expression of one variable, without rates.
fn is_of_one_variable(flat: &FlatModel, e: ExprId) -> bool {
    let mut variables: FastSet<VarId> = FastSet::default();
    for n in flat.graph.postorder([e]) {
        match flat.graph.node(n) {
            Node::Var(v) => {
                let own = flat.variables.get(v);
                if own.is_some_and(|v| v.variability == Variability::Continuous) {
                    variables.insert(v);
                }
            }
            Node::Der(_) => return false,
            _ => {}
        }
    }
    variables.len() == 1
}

/// True for two numbers of one unit of which one varies during a run, and the other at least between the recordings.
fn varies(flat: &FlatModel, (a, b): (VarId, VarId), conditions: &[String]) -> bool {
    let (x, y) = (&flat.variables[a], &flat.variables[b]);
    let is_alike = x.ty == Type::Real && y.ty == Type::Real && x.unit == y.unit;
    let is_continuous = [x, y].map(|v| v.variability == Variability::Continuous);
    let may_vary = [x, y].map(|v| conditions.contains(&v.name));
    let each = (0..2).all(|k| is_continuous[k] || may_vary[k]);
    is_alike && each && is_continuous.contains(&true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_has_two_names() {
        assert_eq!(as_difference("p1 - tank.p"), Some(("p1", "tank.p")));
        for other in ["p1", "a*w - b", "-(c) - d - e"] {
            assert_eq!(as_difference(other), None, "{other}");
        }
    }
}
