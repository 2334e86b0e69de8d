//! Sensitivities of a run with respect to parameters and start values, exact across events.
//!
//! Between events the derivatives `S` of the states obey `S' = J S + df/dp`, which is integrated
//! together with the solution. The instant of an event on the surface `g(t, x, p) = 0` shifts by
//!
//! `dt/dp = -(dg/dp) / (dg/dt)`,
//!
//! both derivatives taken along the trajectory. The event is differentiated at the shifting
//! instant: the states arrive with `S + f dt/dp`, the event sequence propagates these derivatives
//! through `reinit` and every discrete equation, and `S` departs as `X - f dt/dp` with the `f`
//! after the event (S. Galán, W. F. Feehery, P. I. Barton, *Parametric sensitivity functions for
//! hybrid discrete/ continuous systems*, Applied Numerical Mathematics 31, 1999). The instant of a
//! time event shifts with the parameters that determine it. During sliding the equations of
//! [`sliding`] apply.

mod at_events;
mod forcing;
pub mod sliding;

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::integrate::radau::Radau;
use crate::integrate::radau::variation::{NoVariation, Variation};
use crate::integrate::system::{EvalError, System};
use crate::integrate::variational::Variational;
use crate::ir::expr::VarId;
use crate::ir::program::{Instr, Program, RelationTrigger, Slot};
use crate::numeric::pattern::Pattern;
use crate::runtime::machine::{Fault, Machine};
use crate::runtime::tangent::Tangents;
use crate::runtime::tangent::outputs::{needed, read_first};

use self::at_events::AtEvents;
use self::forcing::InputDerivatives;
use self::sliding::{Surface, SurfaceEquations};
use super::cause::RunCause;
use super::event::instant::Cause;
use super::event::sliding::Sliding;
use super::event::time_events::Clocks;
use super::failure::{Failure, of_fault};
use super::run::Simulation;
use super::settings::Settings;
use super::system::{HybridSystem, is_domain_fault};

/// A quantity with respect to which a run is differentiated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// A parameter that is an input of the program.
    Parameter(VarId),
    /// The start value of a variable.
    Start(VarId),
}

impl Input {
    /// The parameter, or the variable that starts.
    pub fn variable(self) -> VarId {
        match self {
            Input::Parameter(v) | Input::Start(v) => v,
        }
    }
}

/// The sensitivities of a run at the current instant.
pub struct Sensitivity {
    count: usize,
    /// One direction for each input, and an additional one along the trajectory.
    tangents: Option<Box<Tangents>>,
    variation: Variation,
    linearization: Linearization,
    /// Derivatives of the right side with respect to the inputs at constant states.
    forcing: InputDerivatives,
    /// The instructions that the recorded variables depend on.
    outputs: Vec<Instr>,
    /// The states that these instructions read, or that are recorded.
    output_states: Vec<usize>,
    at_events: AtEvents,
    /// A panel of derivatives, with room for one more component during sliding.
    s: Vec<f64>,
    /// Shift of the instant of the current event with each input.
    shift: Vec<f64>,
    recorded: Vec<Slot>,
    slopes: Vec<f64>,
    /// Replaces `variation` during sliding.
    surface: Option<Box<Surface>>,
    /// Derivatives of the states on arrival at an event that ends sliding, where they differ from
    /// those in the memory.
    arrival: Option<Vec<f64>>,
}

/// The variational equations at the stages of a step.
struct Linearization {
    width: usize,
    jacobian: [Vec<f64>; 3],
    /// `df/dp`, as panels with the columns of the variation.
    forcing: [Vec<f64>; 3],
    pattern: Pattern,
}

/// Sets every input explicitly, so that it can be differentiated; `None` if one is not an input of
/// the program.
pub fn with_inputs(program: &Program, settings: &Settings, inputs: &[Input]) -> Option<Settings> {
    let mut settings = settings.clone();
    let mut machine = Machine::new(program);
    settings.parameters.iter().all(|&(v, x)| machine.set_parameter(v, x)).then_some(())?;
    settings.starts.iter().all(|&(v, x)| machine.set_start(v, x)).then_some(())?;
    machine.run(&program.tapes.parameters).ok()?;
    for input in inputs {
        let slot = input_slot(program, *input)?;
        if !machine.get(slot).is_nan() {
            continue;
        }
        match *input {
            Input::Parameter(v) => settings.parameters.push((v, machine.value(v))),
            Input::Start(v) => {
                let (.., start) = program.layout.starts.iter().find(|(s, ..)| *s == v)?;
                settings.starts.push((v, machine.get(*start)));
            }
        }
    }
    Some(settings)
}

fn input_slot(program: &Program, input: Input) -> Option<Slot> {
    let layout = &program.layout;
    match input {
        Input::Parameter(v) => {
            layout.parameter_inputs.iter().find(|(p, _)| *p == v).map(|(_, slot)| *slot)
        }
        Input::Start(v) => layout.starts.iter().find(|(s, ..)| *s == v).map(|(_, slot, _)| *slot),
    }
}

/// The states that instructions read before they write them, and those that are recorded.
fn output_states(program: &Program, code: &[Instr], recorded: &[Slot]) -> Vec<usize> {
    let mut read = read_first(program, &[code]);
    recorded.iter().for_each(|slot| read[*slot as usize] = true);
    let first = program.layout.states as usize;
    (0..program.order()).filter(|i| read[first + i]).collect()
}

impl Sensitivity {
    /// Sensitivities before the start of a run; `None` if one of `inputs` is not an input of the
    /// program.
    pub fn new(system: &HybridSystem<'_>, inputs: &[Input]) -> Option<Self> {
        let program = system.machine.program;
        let count = inputs.len();
        let mut tangents = Tangents::new(program.image.len(), count + 1);
        for (direction, input) in inputs.iter().enumerate() {
            tangents.of_mut(input_slot(program, *input)?)[direction] = 1.0;
        }
        let n = system.dim();
        let pattern = system.pattern()?;
        let entries = || std::array::from_fn(|_| vec![0.0; pattern.entries()]);
        let variation = Variation::with_pattern(pattern, count);
        let width = variation.width();
        let linearization = Linearization {
            width,
            jacobian: entries(),
            forcing: std::array::from_fn(|_| vec![0.0; n * width]),
            pattern: pattern.clone(),
        };
        let recorded: Vec<Slot> = program.recorded.iter().map(|v| program.slot(*v)).collect();
        let outputs = needed(
            program,
            &[&program.tapes.rhs, &program.tapes.roots, &program.tapes.outputs],
            &recorded,
        );
        let at_events = AtEvents::new(program, &recorded, &mut tangents);
        Some(Sensitivity {
            count,
            tangents: Some(Box::new(tangents)),
            variation,
            linearization,
            forcing: InputDerivatives::new(program, inputs),
            output_states: output_states(program, &outputs, &recorded),
            outputs,
            at_events,
            s: vec![0.0; (n + 1) * width],
            shift: vec![0.0; count + 1],
            slopes: vec![0.0; recorded.len() * count],
            recorded,
            surface: None,
            arrival: None,
        })
    }

    /// Lets the machine propagate derivatives from now on.
    pub fn attach(&mut self, machine: &mut Machine<'_>) {
        machine.tangents = self.tangents.take();
        self.forcing.forget();
    }

    /// Reverts [`Sensitivity::attach`].
    pub fn detach(&mut self, machine: &mut Machine<'_>) {
        self.tangents = machine.tangents.take().or(self.tangents.take());
    }

    /// Remembers the derivatives that an event iteration changes.
    fn keep(&mut self) {
        if let Some(tangents) = &self.tangents {
            self.at_events.keep(tangents);
        }
    }

    /// Restores them.
    pub fn restore(&mut self) {
        if let Some(tangents) = &mut self.tangents {
            self.at_events.restore(tangents);
            self.forcing.forget();
        }
    }

    /// Derivatives of the recorded variables at the last evaluated instant: variable by variable,
    /// input by input.
    pub fn slopes(&self) -> &[f64] {
        &self.slopes
    }

    /// The inputs by which derivatives are not known, by position: what they move reaches functions outside of the
    /// program.
    pub fn hidden(&self) -> Vec<usize> {
        let own = self.tangents.as_ref().map_or(&[][..], |t| t.hidden());
        let is_hidden = |k: &usize| own.get(*k) == Some(&true) || self.forcing.hides(*k);
        (0..self.count).filter(is_hidden).collect()
    }

    /// Advances the derivatives over the last step.
    pub fn advance(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &mut Radau,
    ) -> Result<(), NoVariation> {
        let Some(tangents) = self.tangents.take() else { return Ok(()) };
        if let (Some(surface), true) = (&mut self.surface, system.sliding.is_some()) {
            let Surface { variation, equations, .. } = &mut **surface;
            let mut equations = SurfaceEquations { system, tangents: Some(tangents), equations };
            let outcome = stepper.advance_variation(&mut equations, variation);
            self.tangents = equations.tangents.take();
            return outcome;
        }
        let (forcing, memory) = (&mut self.forcing, &mut self.linearization);
        let mut equations = TrajectoryEquations { system, forcing, memory, tangents: &tangents };
        let outcome = stepper.advance_variation(&mut equations, &mut self.variation);
        self.tangents = Some(tangents);
        outcome
    }

    /// Computes the derivatives that events need at `t` within the last step, where all variables have
    /// been evaluated.
    pub fn evaluate(&mut self, machine: &mut Machine<'_>, t: f64) -> Result<(), Fault> {
        let program = machine.program;
        let layout = &program.layout;
        self.place(machine, t, 0..program.order());
        let Some(tangents) = &mut self.tangents else { return Ok(()) };
        // The last direction is along the trajectory.
        for i in 0..program.order() {
            let rate = match &self.arrival {
                Some(rates) => rates[i],
                None => machine.get(layout.derivatives[i]),
            };
            tangents.of_mut(layout.states + i as Slot)[self.count] = rate;
        }
        tangents.of_mut(layout.time)[self.count] = 1.0;
        machine.input_signals.rates(&machine.memory, |slot, rate| {
            tangents.of_mut(slot)[self.count] = rate;
        });
        tangents.propagate(machine, &self.at_events.arriving)?;
        self.read_slopes();
        Ok(())
    }

    /// Computes the derivatives of the recorded variables at `t` within the last step, where all
    /// variables have been evaluated.
    pub fn evaluate_row(&mut self, machine: &mut Machine<'_>, t: f64) -> Result<(), Fault> {
        let states = std::mem::take(&mut self.output_states);
        self.place(machine, t, states.iter().copied());
        self.output_states = states;
        if let Some(tangents) = &mut self.tangents {
            tangents.propagate(machine, &self.outputs)?;
        }
        self.read_slopes();
        Ok(())
    }

    /// Sets the derivatives of some states and of delayed signals at `t` within the last step, at constant time.
    fn place(&mut self, machine: &Machine<'_>, t: f64, states: impl Iterator<Item = usize>) {
        let Some(tangents) = &mut self.tangents else { return };
        let layout = &machine.program.layout;
        let variation = self.surface.as_ref().map_or(&self.variation, |s| &s.variation);
        let row = &mut self.s[..variation.width()];
        for i in states {
            variation.interpolate_component(i, t, row);
            let slot = layout.states + i as Slot;
            tangents.of_mut(slot)[..self.count].copy_from_slice(&row[..self.count]);
        }
        tangents.of_mut(layout.time).fill(0.0);
        tangents.hold_signals(layout, &machine.input_signals, &machine.memory);
    }

    fn read_slopes(&mut self) {
        let Some(tangents) = &self.tangents else { return };
        for (slopes, slot) in self.slopes.chunks_exact_mut(self.count.max(1)).zip(&self.recorded) {
            slopes.copy_from_slice(&tangents.of(*slot)[..self.count]);
        }
    }

    /// Shifts all derivatives to the instant at which a relation changes, as last evaluated.
    pub fn arrive_by_relation(&mut self, program: &Program, relation: Option<u32>) {
        let Some(tangents) = &mut self.tangents else { return };
        self.shift.fill(0.0);
        if let Some(k) = relation {
            let indicator = tangents.of(program.layout.indicators + k);
            let rate = indicator[self.count];
            for (shift, g) in self.shift.iter_mut().zip(&indicator[..self.count]) {
                let moved = -g / rate;
                *shift = if moved.is_finite() { moved } else { 0.0 };
            }
        }
        self.at_events.shift(program, tangents, &self.shift[..self.count]);
    }

    /// Shifts all derivatives to the instant `t` of a clock, a comparison with time, or the delayed jump of an input.
    pub fn arrive_by_clock(&mut self, machine: &Machine<'_>, clocks: &Clocks, t: f64) {
        let program = machine.program;
        let Some(tangents) = &mut self.tangents else { return };
        self.shift.fill(0.0);
        let near = |at: f64| (at - t).abs() <= 8.0 * f64::EPSILON * t.abs().max(at.abs());
        let comparison = program.events.relation_triggers.iter().find_map(|w| match w {
            RelationTrigger::Time(slot) if near(machine.get(*slot)) => Some(*slot),
            _ => None,
        });
        if let Some(slot) = comparison {
            self.shift[..self.count].copy_from_slice(&tangents.of(slot)[..self.count]);
        } else if let Some((k, tick)) = clocks.ticking(machine, near) {
            let clock = &program.events.clocks[k];
            let (start, interval) = (tangents.of(clock.start), tangents.of(clock.interval));
            for (j, shift) in self.shift[..self.count].iter_mut().enumerate() {
                *shift = start[j] + tick * interval[j];
            }
        } else if let Some(slot) = machine.input_signals.delay_of_jump(t, &machine.memory) {
            self.shift[..self.count].copy_from_slice(&tangents.of(slot)[..self.count]);
        }
        self.at_events.shift(program, tangents, &self.shift[..self.count]);
    }

    /// Departs from the event at `t`; the derivatives of the states after it are in the memory.
    pub fn depart(&mut self, machine: &Machine<'_>, t: f64) {
        let layout = &machine.program.layout;
        let order = machine.program.order();
        let Some(tangents) = &self.tangents else { return };
        let s = &mut self.s[..self.variation.at_end().len()];
        s.fill(0.0);
        let rows = s.chunks_exact_mut(self.variation.width()).take(order);
        for (i, row) in rows.enumerate() {
            let arrived = tangents.of(layout.states + i as Slot);
            let rate = machine.get(layout.derivatives[i]);
            for ((s, arrived), shift) in row.iter_mut().zip(&arrived[..self.count]).zip(&self.shift)
            {
                *s = arrived - rate * shift;
            }
        }
        self.variation.restart(t, s);
        (self.surface, self.arrival) = (None, None);
    }

    /// Restarts at `t` with the derivatives of the states in the memory.
    pub fn restart_from_memory(&mut self, program: &Program, t: f64) {
        let Some(tangents) = &self.tangents else { return };
        let s = &mut self.s[..self.variation.at_end().len()];
        s.fill(0.0);
        let rows = s.chunks_exact_mut(self.variation.width()).take(program.order());
        for (i, row) in rows.enumerate() {
            let own = tangents.of(program.layout.states + i as Slot);
            row[..self.count].copy_from_slice(&own[..self.count]);
        }
        self.variation.restart(t, s);
        self.surface = None;
    }

    /// The curvature of the derivatives may jump at the end of the last step.
    pub fn pass_kink(&mut self) {
        match &mut self.surface {
            Some(surface) => surface.variation.pass_kink(),
            None => self.variation.pass_kink(),
        }
    }

    /// Restarts at `t`, the end of the last step.
    pub fn restart(&mut self, t: f64) {
        match &mut self.surface {
            Some(surface) => surface.variation.restart_here(t),
            None => self.variation.restart_here(t),
        }
    }
}

impl Sensitivity {
    /// Computes the derivatives of the recorded variables at `t` during sliding; their values are
    /// in the memory.
    fn evaluate_on_surface(&mut self, system: &mut HybridSystem<'_>, t: f64) -> Result<(), Fault> {
        let (Some(surface), Some(sliding)) = (&mut self.surface, &mut system.sliding) else {
            return Ok(());
        };
        let (machine, tangents) = (&mut system.machine, &mut self.tangents);
        surface.evaluate(machine, sliding, tangents, t, &self.recorded, &mut self.slopes)
    }

    /// Enters the surface of `system.sliding` at `(t, y)`, from the side on which its relation is
    /// `truth`.
    fn enter_surface(
        &mut self,
        system: &mut HybridSystem<'_>,
        t: f64,
        y: &[f64],
        truth: bool,
    ) -> Result<(), EvalError> {
        let program = system.machine.program;
        let (slots, n) = (program.image.len(), program.order());
        let mut surface = Box::new(Surface::new(slots, n, self.count, self.recorded.len()));
        surface.enter(system, &mut self.tangents, (t, y), truth, self.variation.at_end())?;
        self.surface = Some(surface);
        Ok(())
    }

    /// Leaves the surface smoothly at `t` within the last step.
    fn leave_surface(&mut self, t: f64) {
        let Some(surface) = self.surface.take() else { return };
        // The last component, the weight of a side, is not needed any more.
        surface.variation.interpolate(t, &mut self.s);
        self.variation.restart(t, &self.s[..self.variation.at_end().len()]);
    }
}

impl Simulation<'_, '_> {
    /// Updates the sensitivities at the start of sliding, if requested.
    pub(super) fn enter_surface(&mut self, t: f64, truth: bool) -> Result<(), Failure> {
        let Some(s) = &mut self.sensitivity else { return Ok(()) };
        let entered = s.enter_surface(&mut self.system, t, &self.y, truth);
        entered.map_err(|error| sensitivity_failure(NoVariation::Eval(error), t))
    }

    /// Ends sliding towards the side of `truth`, and updates the sensitivities if requested.
    pub(super) fn leave_surface(
        &mut self,
        sliding: &Sliding,
        t: f64,
        truth: bool,
    ) -> Result<(), Failure> {
        let machine = &mut self.system.machine;
        if let Some(s) = &mut self.sensitivity {
            s.attach(machine);
        }
        let left = sliding.switch(machine, usize::from(truth));
        if let Some(s) = &mut self.sensitivity {
            s.detach(machine);
            s.leave_surface(t);
        }
        left.map_err(|f| of_fault(&self.system.machine, f, t))
    }

    /// Ends sliding at `t` by an unrelated event: the states arrive with the derivatives of the
    /// sliding motion.
    pub(super) fn arrive_from_surface(&mut self, sliding: &mut Sliding, t: f64) {
        let Some(s) = &mut self.sensitivity else { return };
        let n = self.program.order();
        let mut rates = vec![0.0; n];
        self.stepper.interpolate(t, &mut self.y);
        let slid = sliding.derivatives(&mut self.system.machine, t, &self.y[..n], &mut rates);
        s.arrival = slid.is_ok().then_some(rates);
    }

    /// Advances the sensitivities over the last step, if requested.
    pub(super) fn advance_sensitivities(&mut self) -> Result<(), Failure> {
        let Some(s) = &mut self.sensitivity else { return Ok(()) };
        let t = self.stepper.t();
        let Some(radau) = self.stepper.radau() else { return Ok(()) };
        s.advance(&mut self.system, radau).map_err(|why| sensitivity_failure(why, t))
    }

    /// Computes the sensitivities of all slots at `t` in the last step, if requested.
    pub(super) fn evaluate_sensitivities(&mut self, t: f64) -> Result<(), Failure> {
        let Some(s) = &mut self.sensitivity else { return Ok(()) };
        let evaluated = if self.system.sliding.is_some() {
            s.evaluate_on_surface(&mut self.system, t)
        } else {
            s.evaluate(&mut self.system.machine, t)
        };
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))
    }

    /// Computes the sensitivities of the recorded variables at `t` in the last step, if requested.
    pub(super) fn evaluate_row_sensitivities(&mut self, t: f64) -> Result<(), Failure> {
        let Some(s) = &mut self.sensitivity else { return Ok(()) };
        let evaluated = if self.system.sliding.is_some() {
            s.evaluate_on_surface(&mut self.system, t)
        } else {
            s.evaluate_row(&mut self.system.machine, t)
        };
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))
    }

    /// Shifts the sensitivities to an event and lets the machine propagate them.
    pub(super) fn arrive(&mut self, t: f64, cause: Cause) {
        let Some(s) = &mut self.sensitivity else { return };
        let machine = &mut self.system.machine;
        s.keep();
        match cause {
            Cause::State => {
                let relation = self.locator.switched(machine).next();
                s.arrive_by_relation(self.program, relation);
            }
            Cause::Time => s.arrive_by_clock(machine, &self.clocks, t),
        }
        s.attach(machine);
    }

    /// Departs from an event with the sensitivities of the states after it.
    pub(super) fn depart(&mut self, t: f64) -> Result<(), Failure> {
        let Some(s) = &mut self.sensitivity else { return Ok(()) };
        let evaluated = self.system.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
        s.depart(&self.system.machine, t);
        Ok(())
    }
}

fn sensitivity_failure(why: NoVariation, t: f64) -> Failure {
    let why = match why {
        NoVariation::Eval(_) => "a derivative of the model does not exist",
        NoVariation::Singular { .. } => "their equations are singular",
    };
    let cause = RunCause::NoSensitivities { time: t, why };
    Failure::numerics(t, Diagnostic::new(cause, Span::NONE))
}

/// The variational equations along a run.
struct TrajectoryEquations<'a, 'p> {
    system: &'a mut HybridSystem<'p>,
    forcing: &'a mut InputDerivatives,
    memory: &'a mut Linearization,
    /// Those of the memory.
    tangents: &'a Tangents,
}

impl Variational for TrajectoryEquations<'_, '_> {
    fn linearise(&mut self, stage: usize, t: f64, y: &[f64]) -> Result<(), EvalError> {
        let TrajectoryEquations { system, forcing, memory, tangents } = self;
        let evaluated = system.linearise(t, y, &mut memory.jacobian[stage])?;
        let machine = &mut system.machine;
        let program = machine.program;
        let mut outcome = Ok(());
        if !evaluated {
            machine.set_point(t, &y[..program.order()]);
            outcome = machine.run(&program.tapes.rhs);
            machine.clamp_domain = outcome.is_err_and(is_domain_fault);
            if machine.clamp_domain {
                outcome = machine.run(&program.tapes.rhs);
            }
        }
        let (panel, width) = (&mut memory.forcing[stage], memory.width);
        let outcome =
            outcome.and_then(|()| forcing.write(machine, tangents, evaluated, panel, width));
        machine.clamp_domain = false;
        outcome.map_err(|_| EvalError::Recoverable(0))
    }

    fn slopes(&self, stage: usize, width: usize, s: &[f64], out: &mut [f64]) {
        let Linearization { jacobian, forcing, pattern, .. } = &*self.memory;
        let (starts, rows) = (pattern.column_starts(), pattern.row_indices());
        out.copy_from_slice(&forcing[stage]);
        for (j, s) in s.chunks_exact(width).enumerate() {
            for k in starts[j]..starts[j + 1] {
                let entry = jacobian[stage][k];
                if entry != 0.0 {
                    let row = &mut out[rows[k] * width..(rows[k] + 1) * width];
                    row.iter_mut().zip(s).for_each(|(out, s)| *out += entry * s);
                }
            }
        }
    }

    fn jacobian(&self, stage: usize) -> Option<&[f64]> {
        Some(&self.memory.jacobian[stage])
    }
}
