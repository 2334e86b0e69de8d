//! Parameters that vary: the parameters that may do so, and the variables that they may vary with.
//!
//! Every free parameter of the plan is a hypothesis with every measured variable, every condition that differs
//! between the recordings, the number of the recording, every named variable of the model and time; parameters of the same unit are hypotheses
//! together as well, because one phenomenon often changes several of them alike. As a free curve, a parameter varies
//! alone.

use crate::base::index::{FastMap, FastSet};
use crate::calibrate::data::{Data, Split};
use crate::calibrate::plan::{Plan, RECORDING_NUMBER};
use crate::calibrate::recording_number;
use crate::flatten::inventory::Inventory;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Variability};

use super::alike_components::{AlikeParameter, alike_parameters};
use super::difference::differences;
use super::place::Place;

/// Largest number of parameters that vary alike.
const MAX_ALIKE: usize = 3;
/// Largest number of variables that parameters may vary with.
const MAX_VARIABLES: usize = 12;
/// Largest number of states whose rates parameters may vary with.
const MAX_RATES: usize = 6;
/// Number of named variables of the model from which its states are not needed as well.
const ENOUGH_VARIABLES: usize = 4;

/// The parameters of a model that may vary, and what they may vary with.
#[derive(Clone, Debug, Default)]
pub struct VariationTargets {
    /// Sets of parameters, by their full names, that vary alike; those of one parameter of the plan come first.
    pub parameters: Vec<Vec<String>>,
    /// Number of the latter.
    pub single: usize,
    /// Full names of variables: those that are measured, `time`, and others.
    pub variables: Vec<String>,
    /// Differences of two variables.
    pub differences: Vec<String>,
    /// Parameters that differ between the recordings, among them the number of the recording.
    pub conditions: Vec<String>,
    /// Parameters that components of one class share by name.
    pub alike: Vec<AlikeParameter>,
    /// The rates of states, as `der(x)`.
    pub rates: Vec<String>,
    /// Parameters that keep their values during a run, so that they vary from one recording to the next only: those of an
    /// FMU that are not tunable.
    pub fixed: FastSet<String>,
    /// Parameters with variables that they determine directly, as in `F = c*s`: `c` over `F` would be its own cause.
    circular: FastSet<(String, String)>,
}

impl VariationTargets {
    /// Those of a flat model and a plan.
    pub fn new(
        flat: &FlatModel,
        inventory: &Inventory,
        plan: &Plan,
        data: &Data,
    ) -> VariationTargets {
        let (parameters, single) = parameters(flat, plan);
        let (variables, conditions) = (variables(flat, plan), conditions(flat, plan, data));
        let fixed = plan.fmu.iter().flat_map(|fmu| fmu.fixed.iter().cloned()).collect();
        let circular = circular(flat, &parameters[..single], &variables);
        let differences = match plan.fmu.is_some() {
            true => Vec::new(),
            false => {
                let inputs: Vec<String> = plan.inputs.iter().map(|i| i.input.clone()).collect();
                differences(flat, &conditions, &inputs)
            }
        };
        let (alike, rates) = match plan.fmu.is_some() {
            true => (Vec::new(), Vec::new()),
            false => (alike_parameters(flat, plan, inventory), rates(flat)),
        };
        VariationTargets {
            parameters,
            single,
            variables,
            differences,
            conditions,
            alike,
            rates,
            fixed,
            circular,
        }
    }

    /// Every set of parameters with every variable and condition, for an effect whose input is named `input`.
    pub fn places(&self, input: &str) -> Vec<Place> {
        let during_a_run = self.variables.iter().chain(&self.differences);
        let over: Vec<&String> = during_a_run.chain(&self.conditions).collect();
        let mut all = combinations(&self.parameters, &over, input);
        all.retain(|place| self.can_vary(place));
        all
    }

    /// The parameters that components of one class share, each with a variable of its own component.
    pub fn alike_places(&self, input: &str) -> Vec<Place> {
        self.alike.iter().flat_map(|alike| alike.places(input)).collect()
    }

    /// Every set of parameters with the rate of every state.
    pub fn rate_places(&self, input: &str) -> Vec<Place> {
        combinations(&self.parameters, &self.rates.iter().collect::<Vec<_>>(), input)
    }

    /// Every set of parameters with the number of the recording.
    pub fn number_places(&self, input: &str) -> Vec<Place> {
        let mut all = self.places(input);
        all.retain(|place| place.binds.iter().all(|(_, over)| over == RECORDING_NUMBER));
        all
    }

    /// The same for a free curve: parameters one by one, with every variable.
    pub fn curve_places(&self, input: &str) -> Vec<Place> {
        let over: Vec<&String> = self.variables.iter().chain(&self.differences).collect();
        let mut all = combinations(&self.parameters[..self.single], &over, input);
        all.retain(|place| self.can_vary(place));
        all
    }

    /// Whether the parameters of a place may follow its variable.
    fn can_vary(&self, place: &Place) -> bool {
        let during_a_run = place.binds.iter().any(|(_, over)| !self.conditions.contains(over));
        let is_fixed = |parameter| during_a_run && self.fixed.contains(parameter);
        let determines = |parameter: &String| {
            let pair = |over: &String| (parameter.clone(), over.clone());
            place.binds.iter().any(|(_, over)| self.circular.contains(&pair(over)))
        };
        !place.at.iter().any(|parameter| is_fixed(parameter) || determines(parameter))
    }
}

/// The rates of the first states that have names of the model's own.
fn rates(flat: &FlatModel) -> Vec<String> {
    let is_synthetic: FastSet<VarId> = flat.synthetic.iter().copied().collect();
    let of = |v: &VarId| {
        let x = &flat.variables[*v];
        !x.protected && x.ty == Type::Real && !is_synthetic.contains(v)
    };
    let own = states(flat).into_iter().filter(of).take(MAX_RATES);
    own.map(|v| format!("der({})", flat.variables[v].name)).collect()
}

/// The pairs of a parameter and a variable whose own equation, `v = ...`, reads the parameter.
pub fn circular(
    flat: &FlatModel,
    parameters: &[Vec<String>],
    variables: &[String],
) -> FastSet<(String, String)> {
    let mut determined: FastMap<VarId, Vec<ExprId>> = FastMap::default();
    for (v, x) in flat.variables.enumerate() {
        determined.entry(v).or_default().extend(x.binding);
    }
    for equation in &flat.equations {
        let EquationKind::Equal(lhs, rhs) = equation.kind else { continue };
        for (side, other) in [(lhs, rhs), (rhs, lhs)] {
            if let Node::Var(v) = flat.graph.node(side) {
                determined.entry(v).or_default().push(other);
            }
        }
    }
    let named = |name: &String| flat.variables.enumerate().find(|(_, x)| x.name == *name);
    let mut out = FastSet::default();
    for variable in variables {
        let Some((v, _)) = named(variable) else { continue };
        let own = determined.get(&v).into_iter().flatten();
        let read: FastSet<VarId> = own.flat_map(|e| flat.graph.variables(*e)).collect();
        let read = |name: &&String| named(name).is_some_and(|(p, _)| read.contains(&p));
        let pairs = parameters.iter().flatten().filter(read);
        out.extend(pairs.map(|parameter| (parameter.clone(), variable.clone())));
    }
    out
}

/// The states whose rate is a variable of its own, as that of an angle is the speed.
pub fn states_with_named_rates(flat: &FlatModel) -> Vec<VarId> {
    let of = |(a, b): (ExprId, ExprId)| match (flat.graph.node(a), flat.graph.node(b)) {
        (Node::Der(state), Node::Var(_)) => Some(state),
        _ => None,
    };
    let sides = flat.equations.iter().filter_map(|e| match e.kind {
        EquationKind::Equal(lhs, rhs) => of((lhs, rhs)).or_else(|| of((rhs, lhs))),
        _ => None,
    });
    sides.collect()
}

fn combinations(parameters: &[Vec<String>], over: &[&String], input: &str) -> Vec<Place> {
    let place = |at: &[String], variable: &str| Place {
        binds: vec![(input.to_owned(), variable.to_owned())],
        ..Place::at(at)
    };
    parameters.iter().flat_map(|at| over.iter().map(move |v| place(at, v))).collect()
}

/// Number of training recordings from which something may be seen to change from one to the next.
const ENOUGH_RECORDINGS: usize = 3;

/// Adds the number of the recording to the conditions of a plan, for wear and drift. Not if there are few, if they are
/// single windows, or if the model has a variable of that name.
pub fn number_recordings(flat: &FlatModel, plan: &mut Plan, data: &mut Data) {
    let is_taken = flat.variables.iter().any(|v| v.name == RECORDING_NUMBER);
    if is_taken || data.wholes(Split::Train).len() < ENOUGH_RECORDINGS {
        return;
    }
    recording_number::number_recordings(plan, data);
}

/// The parameters that recordings set to different values.
fn conditions(flat: &FlatModel, plan: &Plan, data: &Data) -> Vec<String> {
    let differs = |k: usize| {
        let mut values = data.of(Split::Train).filter_map(|r| r.conditions.get(k)).copied();
        let first = values.next();
        values.any(|v| Some(v) != first && !v.is_nan())
    };
    let is_real = |name: &str| {
        if name == RECORDING_NUMBER {
            return true;
        }
        let found = flat.variables.iter().find(|v| v.name == name);
        found.is_some_and(|v| v.ty == Type::Real && v.variability == Variability::Parameter)
    };
    let all = plan.conditions.iter().enumerate();
    let fit = all.filter(|(k, c)| is_real(&c.parameter) && differs(*k));
    fit.map(|(_, c)| c.parameter.clone()).collect()
}

/// The free parameters of the plan one by one, then those of equal units together; the number of the former.
fn parameters(flat: &FlatModel, plan: &Plan) -> (Vec<Vec<String>>, usize) {
    let mut single: Vec<(Vec<String>, String)> = Vec::new();
    for free in &plan.free {
        let can_vary = |name: &String| {
            let v = flat.variables.iter().find(|v| v.name == *name)?;
            let parameter = v.ty == Type::Real && v.variability == Variability::Parameter;
            (parameter && !v.structural).then(|| v.unit.to_string())
        };
        let units: Option<Vec<String>> = free.targets.iter().map(can_vary).collect();
        if let Some(unit) = units.and_then(|u| u.first().cloned()) {
            single.push((free.targets.clone(), unit));
        }
    }
    let mut sets: Vec<Vec<usize>> = (0..single.len()).map(|k| vec![k]).collect();
    let mut longest = sets.clone();
    for _ in 1..MAX_ALIKE {
        let mut longer = Vec::new();
        for set in &longest {
            let (first, last) = (set[0], set[set.len() - 1]);
            let unit = &single[first].1;
            let alike = |k: &usize| !unit.is_empty() && single[*k].1 == *unit;
            longer
                .extend((last + 1..single.len()).filter(alike).map(|k| [&set[..], &[k]].concat()));
        }
        sets.extend(longer.iter().cloned());
        longest = longer;
    }
    let names = |set: &Vec<usize>| set.iter().flat_map(|k| single[*k].0.clone()).collect();
    (sets.iter().map(names).collect(), single.len())
}

/// The measured variables, those with names of the model's own, and states where these are few.
fn variables(flat: &FlatModel, plan: &Plan) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut add = |name: &str| {
        if out.len() < MAX_VARIABLES && !out.iter().any(|known| known == name) {
            out.push(name.to_owned());
        }
    };
    plan.signals.iter().for_each(|s| add(&s.variable));
    add("time");
    let is_synthetic: FastSet<VarId> = flat.synthetic.iter().copied().collect();
    let continuous = |v: VarId| {
        let x = &flat.variables[v];
        x.ty == Type::Real && x.variability == Variability::Continuous && !is_synthetic.contains(&v)
    };
    let own = flat
        .variables
        .enumerate()
        .filter(|(v, x)| continuous(*v) && !x.protected && !x.name.contains(['.', '[']));
    own.for_each(|(_, x)| add(&x.name));
    if out.len() > ENOUGH_VARIABLES {
        return out;
    }
    for v in states(flat).into_iter().filter(|v| continuous(*v)) {
        let name = &flat.variables[v].name;
        if out.len() < MAX_VARIABLES && !out.contains(name) {
            out.push(name.clone());
        }
    }
    out
}

/// The variables whose derivatives the equations contain.
pub fn states(flat: &FlatModel) -> Vec<VarId> {
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    let of = |e| match flat.graph.node(e) {
        Node::Der(v) => Some(v),
        _ => None,
    };
    let mut states: Vec<VarId> = flat.graph.postorder(roots).into_iter().filter_map(of).collect();
    states.sort_unstable();
    states.dedup();
    states
}
