//! The model under examination, and its programs with effects attached.

use std::sync::OnceLock;

use crate::base::index::{FastMap, FastSet};
use crate::calibrate::data::Data;
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::record_also;
use crate::driver::compile::{CompileError, Request, Session};
use crate::flatten::inventory::Inventory;
use crate::ir::flat::{Experiment, FlatModel};
use crate::ir::program::Program;

use super::catalogue::{Effect, Packages, catalogue};
use super::difference::as_difference;
use super::equation_terms::EquationTerms;
use super::finer_curve::finer_curves;
use super::fixed_value::{self, FixedValue, fixed_starts, fixed_values};
use super::follower::{Follower, MeasuredPotential, measured_potentials};
use super::formula::formulas;
use super::inner_signals::inner_signals;
use super::law_choice::choices;
use super::model_source::{Attached, Extension};
use super::place::{Place, places};
use super::policy::SearchPolicy;
use super::result::unit;
use super::surroundings::INSIDE;
use super::terminal_reading::{TerminalReading, terminal_readings};
use super::variation::{VariationTargets, number_recordings, states, states_with_named_rates};

/// Name of the generated model that has effects attached.
const TRIAL_MODEL: &str = "Trial";

/// About a diagnosis of a model whose connectors have stream variables.
const STREAMS: &str = "no flow can be added at connectors with stream variables, such as those of Modelica.Fluid, so the \
                       search there is among parameters, sensors and inputs";

/// The package of the shipped effects.
const SHIPPED_EFFECTS: &str = "Effects";

/// A model, its recordings and the effects that it may lack.
#[derive(Clone, Debug)]
pub struct Study {
    /// The plan.
    pub plan: Plan,
    /// How its model is compiled.
    pub request: Request,
    /// The recordings.
    pub data: Data,
    /// Factors by which the noise of the signals was corrected; empty if it is as the plan declares.
    pub corrections: Vec<f64>,
    /// Full name of the model.
    pub base: String,
    /// The experiment annotation of the model.
    pub experiment: Experiment,
    /// The catalogue.
    pub effects: Vec<Effect>,
    /// The components of the model and their connections.
    pub inventory: Inventory,
    /// Names of its variables.
    pub variables: Vec<String>,
    /// Their units.
    pub units: FastMap<String, String>,
    /// The parameters that may vary, and what they may vary with.
    pub variations: VariationTargets,
    /// The parameters that the plan takes for granted.
    pub fixed_values: Vec<FixedValue>,
    /// The states whose starts the plan takes for granted.
    pub fixed_starts: Vec<String>,
    /// The equations that may lack a term, and what it may depend on.
    pub terms: EquationTerms,
    /// The signals within the model that actuators may act on.
    pub inner_signals: Vec<String>,
    /// The sensors that read the flow at a connector which an effect may change, in place of the variables that the plan
    /// names.
    pub readings: Vec<TerminalReading>,
    /// The measured signals that are potentials at connectors.
    pub measured_potentials: Vec<MeasuredPotential>,
    /// The parts that pull the model to them.
    pub followers: Vec<Follower>,
    /// Number of states of the model.
    pub states: usize,
    /// Those with a rate that is a variable of its own: what may be an angle where nothing has a unit.
    pub angles: FastSet<String>,
    /// Limits, thresholds and stopping rules.
    pub policy: SearchPolicy,
    /// Steps after which a run of a training recording with effects is abandoned, once the model has been calibrated.
    pub most_steps: OnceLock<u64>,
}

/// Why there is no diagnosis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum DiagnosisError {
    /// The model cannot be compiled.
    #[error(transparent)]
    Model(#[from] CompileError),
    /// The model cannot be simulated under the conditions of the recordings.
    #[error("the model cannot be simulated under the conditions of the recordings")]
    Simulation,
}

impl Study {
    /// The study of a plan whose model is flat, with the shipped effects and those of further classes.
    pub fn new(
        session: &mut Session,
        (request, classes): (Request, &[String]),
        (flat, inventory): (&FlatModel, Inventory),
        (mut plan, mut data): (Plan, Data),
        policy: SearchPolicy,
    ) -> Study {
        number_recordings(flat, &mut plan, &mut data);
        let units: Vec<(String, String)> =
            flat.variables.iter().map(|v| (v.name.clone(), v.unit.to_string())).collect();
        let packages = Study::packages(&request, classes);
        let mut effects = catalogue(session, &packages, &inventory, &units);
        effects.extend(choices(&request, flat));
        effects.extend(finer_curves(&effects));
        effects.extend(formulas(&effects));
        let variations = VariationTargets::new(flat, &inventory, &plan, &data);
        Study {
            base: flat.name.clone(),
            experiment: flat.experiment,
            variables: flat.variables.iter().map(|v| v.name.clone()).collect(),
            terms: EquationTerms::new(flat, &plan, &variations),
            inner_signals: inner_signals(flat, &plan),
            variations,
            readings: terminal_readings(flat, &plan, &inventory),
            measured_potentials: measured_potentials(flat, &plan, &inventory),
            followers: Vec::new(),
            fixed_values: fixed_values(flat, &plan),
            fixed_starts: fixed_starts(flat, &plan),
            units: units.into_iter().collect(),
            corrections: Vec::new(),
            states: states(flat).len(),
            angles: states_with_named_rates(flat)
                .into_iter()
                .map(|v| flat.variables[v].name.clone())
                .collect(),
            plan,
            request,
            data,
            effects,
            inventory,
            policy,
            most_steps: OnceLock::new(),
        }
    }

    /// The packages of effects: the shipped one and further classes.
    pub fn packages<'a>(request: &'a Request, classes: &'a [String]) -> Packages<'a> {
        Packages { request, names: &[SHIPPED_EFFECTS], classes }
    }

    /// Lets the sensors of flows that an effect may change read them at the terminals. From then on, the plan fits the
    /// models that [`Study::compile`] makes, and no longer the model itself.
    pub fn read_at_terminals(&mut self) {
        let in_series = self.effects.iter().filter(|e| e.in_series);
        let places: Vec<Place> = in_series.flat_map(|e| self.places(e, &self.plan)).collect();
        self.readings.retain(|reading| places.iter().any(|place| reading.is_changed_by(place)));
        for reading in &self.readings {
            self.plan.signals[reading.signal].variable.clone_from(&reading.name);
        }
    }

    /// Corrects the noise of the signals by factors.
    pub fn correct_noise(&mut self, factors: Vec<f64>) {
        self.data.sigmas.iter_mut().zip(&factors).for_each(|(sigma, factor)| *sigma *= factor);
        self.corrections = factors;
    }

    /// What the search cannot look at in this model, as sentences without a full stop.
    pub fn limits(&self) -> impl Iterator<Item = String> {
        let connectors = self.inventory.parts.iter().flat_map(|part| &part.connectors);
        let has_streams = connectors.into_iter().any(|connector| connector.has_streams);
        let inside = self.plan.fmu.is_some().then_some(INSIDE);
        let of_model = inside.into_iter().chain(has_streams.then_some(STREAMS)).map(str::to_owned);
        let only = &self.policy.only;
        let asked =
            (!only.is_empty()).then(|| format!("the search was restricted to {}", only.join(", ")));
        of_model.chain(asked)
    }

    /// True for a variable that the plan compares.
    pub fn is_measured(&self, name: &str) -> bool {
        self.plan.signals.iter().any(|s| s.variable == name)
            || self.readings.iter().any(|r| r.variable == name)
    }

    /// The unit of a variable of the model; empty if it has none.
    pub fn unit(&self, variable: &str) -> &str {
        let variable = as_difference(variable).map_or(variable, |(first, _)| first);
        self.units.get(variable).map_or("", String::as_str)
    }

    /// An effect and its place, for messages.
    pub fn label(&self, effect: usize, place: &Place) -> String {
        let (effect, at) = (&self.effects[effect], place.at.join(", "));
        let is_named = |(input, _): &&(String, String)| effect.is_named_in_law(input);
        let over = place.binds.iter().filter(is_named);
        let over: Vec<&str> = over.map(|(_, variable)| variable.as_str()).collect();
        match over.is_empty() {
            true => format!("{} at {at}", effect.name()),
            false => format!("{} at {at} over {}", effect.name(), over.join(", ")),
        }
    }

    /// True for an effect that the search is not restricted from.
    fn is_searched(&self, effect: &Effect) -> bool {
        let only = &self.policy.only;
        only.is_empty() || effect.inflow.is_some() || only.iter().any(|name| effect.is_called(name))
    }

    /// All places for an effect in the model that a plan fits.
    pub fn places(&self, effect: &Effect, plan: &Plan) -> Vec<Place> {
        if !self.is_searched(effect) {
            return Vec::new();
        }
        if let Some(choice) = effect.choice.as_ref().filter(|c| c.is_of_model()) {
            return vec![Place::at(&choice.at)];
        }
        if effect.starts.is_some() {
            let place = |state| Place::at(std::slice::from_ref(state));
            return self.fixed_starts.iter().map(place).collect();
        }
        if effect.has_free_inputs() {
            let mut all = self.free_places(effect);
            all.retain(|place| self.has_fitting_units(effect, place));
            return all;
        }
        let names: FastSet<&str> = self.variables.iter().map(String::as_str).collect();
        places(effect, &self.inventory, &names, (plan, &self.inner_signals))
    }

    /// All places for an effect whose inputs are bound to any variables.
    fn free_places(&self, effect: &Effect) -> Vec<Place> {
        match effect.binds.first() {
            _ if effect.adds.is_some() => self.terms.places(effect),
            Some((input, _)) if effect.curve.is_some() => self.variations.curve_places(input),
            Some((input, _)) if effect.is_of_rate => self.variations.rate_places(input),
            Some((input, _)) if effect.is_of_recording => self.variations.number_places(input),
            Some((input, _)) => {
                let mut all = self.variations.places(input);
                if effect.amplitudes.len() == 1 {
                    all.extend(self.variations.alike_places(input));
                }
                all
            }
            None => fixed_value::places(&self.fixed_values),
        }
    }

    /// Whether each input is bound to a variable of its unit, if it has one and the model declares units.
    fn has_fitting_units(&self, effect: &Effect, place: &Place) -> bool {
        let has_units = self.variations.variables.iter().any(|v| !self.unit(v).is_empty());
        let fits = |(input, variable): &(String, String)| {
            let own = unit(effect, input);
            // A difference of temperatures is no absolute temperature.
            let is_relative = own == "K" && as_difference(variable).is_some();
            own.is_empty() || own == self.unit(variable) && !is_relative
        };
        // Where nothing has a unit, an angle is what has a speed of its own.
        let may_be_angle = |(input, variable): &(String, String)| {
            let (first, second) = as_difference(variable).unwrap_or((variable, variable));
            let are_angles = [first, second].iter().all(|name| self.angles.contains(*name));
            unit(effect, input) != "rad" || are_angles
        };
        match has_units {
            true => place.binds.iter().all(fits),
            false => place.binds.iter().all(may_be_angle),
        }
    }

    /// Candidates in one model of a score test. Each may add states to a small model, and the cost of a step grows with
    /// the number of states times that of the derivatives, so they run in smaller batches there.
    pub fn batch(&self) -> usize {
        let least = self.policy.least_batch.min(self.policy.batch);
        (4 * self.states).clamp(least, self.policy.batch)
    }

    /// True for an effect that is a free curve rather than parametric.
    pub fn is_curve(&self, effect: usize) -> bool {
        self.effects[effect].amplitudes.len() >= self.policy.curve_amplitudes
    }

    /// True for a law with a name: neither a curve nor a product, nor a parameter that varies.
    pub fn is_named(&self, effect: usize) -> bool {
        let own = &self.effects[effect];
        !self.is_curve(effect) && own.varies.is_none() && !own.is_product()
    }

    /// True for an effect of a sensor or an actuator.
    pub fn is_of_instrument(&self, effect: usize, place: &Place) -> bool {
        place.signal.is_some() || self.effects[effect].acts.is_some()
    }

    /// Compiles the model with effects attached; the program records the signals of the plan and `others`.
    pub fn compile(
        &self,
        plan: &Plan,
        attached: &[Attached<'_>],
        others: &[String],
    ) -> Result<(Session, Program), DiagnosisError> {
        let mut session = Session { parameters_vary: true, ..Session::default() };
        let mut request = self.request.clone();
        request.differentiated = plan.targets();
        let is_extended =
            !attached.is_empty() || !self.readings.is_empty() || !self.followers.is_empty();
        if is_extended {
            let (name, base) = (TRIAL_MODEL, self.base.as_str());
            let (readings, followers) = (&self.readings, &self.followers);
            let trial = Extension { name, base, readings, followers, ..Extension::default() };
            request.appended = Some(trial.source(attached));
            request.model = Some(TRIAL_MODEL.to_owned());
        }
        let mut program = session.compile(&request)?;
        if is_extended {
            // The experiment annotation is not inherited.
            program.blocks.dae.experiment = self.experiment;
        }
        record_also(&mut program, plan, others);
        Ok((session, program))
    }
}
