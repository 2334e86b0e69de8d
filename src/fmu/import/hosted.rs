//! An instance of an FMU in this process, which is the child process, as what integrates it sees it.

use super::description::{Group, Passing};
use super::library::{Instance, Trouble, messages};
use super::message::Load;
use crate::ir::foreign::{AfterEvent, AfterStep, At, ForeignInstance, ForeignShape, InstanceFault};

/// Displacement of a state for a difference quotient, relative to its size.
const DISPLACEMENT: f64 = 1.5e-8;

/// A call that failed.
#[derive(Debug)]
pub struct CallFault {
    /// The call.
    pub trouble: Trouble,
    /// The messages of the FMU.
    pub messages: Vec<String>,
    /// What it was called for.
    pub doing: String,
}

impl InstanceFault for CallFault {
    fn is_avoidable(&self) -> bool {
        matches!(self.trouble, Trouble::Failed { status: "discard", .. })
    }
}

/// The fault of a call at an instant, s.
fn at_time(t: f64) -> impl Fn(Trouble) -> CallFault {
    move |trouble| CallFault { trouble, messages: messages(), doing: format!("at time {t} s") }
}

/// An instance with what orders refer to.
pub struct Hosted {
    instance: Instance,
    load: Load,
    /// The groups of the watched values by type, and for each watched value its place among those that are fetched.
    fetched: Vec<(Passing, Vec<Group>)>,
    places: Vec<usize>,
    /// Memory for those values.
    all: Vec<f64>,
    /// Directional derivatives failed: take differences.
    no_derivatives: bool,
    nominals: Vec<f64>,
}

impl Hosted {
    /// Loads the FMU and makes an instance.
    pub fn new(load: Load) -> Result<Hosted, Trouble> {
        let instance = Instance::new(&load)?;
        let of = |value: usize| {
            let next = load.groups.partition_point(|g| g.first <= value);
            load.groups.get(next.wrapping_sub(1)).copied()
        };
        let mut wanted: Vec<Group> = load.watched.iter().filter_map(|v| of(*v)).collect();
        wanted.sort_by_key(|g| (g.passing as u8, g.first));
        wanted.dedup();
        let mut fetched: Vec<(Passing, Vec<Group>)> = Vec::new();
        let mut starts = Vec::new();
        let mut total = 0;
        for group in wanted {
            match fetched.last_mut().filter(|(passing, _)| *passing == group.passing) {
                Some((_, list)) => list.push(group),
                None => fetched.push((group.passing, vec![group])),
            }
            starts.push((group.first, total));
            total += group.count;
        }
        starts.sort_unstable();
        let place = |value: &usize| {
            let next = starts.partition_point(|(first, _)| first <= value);
            starts.get(next.wrapping_sub(1)).map_or(0, |(first, at)| at + value - first)
        };
        let places = load.watched.iter().map(place).collect();
        let nominals = vec![1.0; load.shape.states];
        let all = Vec::with_capacity(total);
        Ok(Hosted { instance, load, fetched, places, all, no_derivatives: false, nominals })
    }

    fn initialised(
        &mut self,
        [start, stop]: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<AfterEvent, Trouble> {
        self.set(values)?;
        self.instance.enter_initialization([start, stop, tolerance])?;
        self.instance.exit_initialization()?;
        match self.load.shape.steps_itself {
            true => Ok(AfterEvent::default()),
            false => self.after_event(),
        }
    }

    fn evaluated(
        &mut self,
        at: &At<'_>,
        derivatives: &mut [f64],
        indicators: &mut [f64],
    ) -> Result<(), Trouble> {
        self.place(at)?;
        self.instance.derivatives(&mut derivatives[..self.load.shape.states])?;
        self.instance.indicators(indicators)
    }

    /// Its numbers.
    pub fn shape(&self) -> ForeignShape {
        self.load.shape
    }

    /// The numbers of the values that are inputs.
    pub fn inputs(&self) -> &[usize] {
        &self.load.inputs
    }

    /// The number of watched values.
    pub fn watched_count(&self) -> usize {
        self.places.len()
    }

    /// Gets the watched values.
    fn watched(&mut self, values: &mut [f64]) -> Result<(), Trouble> {
        self.all.clear();
        for (passing, groups) in &self.fetched {
            self.instance.get(*passing, groups, &mut self.all)?;
        }
        for (value, at) in values.iter_mut().zip(&self.places) {
            *value = self.all[*at];
        }
        Ok(())
    }

    /// Sets time, states, and the inputs that may change between events.
    fn place(&self, point: &At<'_>) -> Result<(), Trouble> {
        self.instance.set_time(point.t)?;
        self.instance.set_states(point.states)?;
        let groups = &self.load.groups;
        let is_real = |(value, _): &&(usize, f64)| {
            let next = groups.partition_point(|g| g.first <= *value);
            let group = groups.get(next.wrapping_sub(1));
            group.is_some_and(|g| matches!(g.passing, Passing::Float64 | Passing::Float32))
        };
        let inputs: Vec<(usize, f64)> = point.inputs.iter().filter(is_real).copied().collect();
        self.set(&inputs)
    }

    /// From event mode to continuous-time mode.
    fn after_event(&mut self) -> Result<AfterEvent, Trouble> {
        let updated = self.instance.update()?;
        let n = self.load.shape.states;
        let (mut states, mut nominals) = (vec![0.0; n], vec![1.0; n]);
        let mut indicators = vec![0.0; self.load.shape.indicators];
        if !updated.ends {
            self.instance.enter_continuous_mode()?;
        }
        self.instance.states(&mut states)?;
        self.instance.nominals(&mut nominals)?;
        if !updated.ends {
            self.instance.indicators(&mut indicators)?;
        }
        self.nominals.clone_from(&nominals);
        Ok(AfterEvent { states, nominals, indicators, next: updated.next, ends: updated.ends })
    }

    /// Sets values; elements of an array with the others of their group.
    fn set(&self, values: &[(usize, f64)]) -> Result<(), Trouble> {
        let groups = &self.load.groups;
        let mut rest = values;
        while let Some((value, _)) = rest.first() {
            let next = groups.partition_point(|g| g.first <= *value);
            let Some(group) = groups.get(next.wrapping_sub(1)) else { break };
            let own = |(v, _): &(usize, f64)| (group.first..group.first + group.count).contains(v);
            let count = rest.iter().take_while(|pair| own(pair)).count().max(1);
            let mut new = Vec::with_capacity(group.count);
            if count < group.count {
                self.instance.get(group.passing, std::slice::from_ref(group), &mut new)?;
            }
            new.resize(group.count, 0.0);
            for (v, x) in &rest[..count] {
                new[v - group.first] = *x;
            }
            self.instance.set(group, &new)?;
            rest = &rest[count..];
        }
        Ok(())
    }

    /// Derivatives by states, column by column.
    fn differentiated(&mut self, point: &At<'_>, out: &mut [f64]) -> Result<(), Trouble> {
        let n = self.load.shape.states;
        self.place(point)?;
        if !self.load.states.is_empty() && !self.no_derivatives {
            let unknowns: Vec<u32> = self.load.states.iter().map(|s| s.0).collect();
            let columns = out.chunks_mut(n.max(1)).zip(&self.load.states);
            let mut ok = true;
            for (column, (_, state)) in columns {
                ok &= self.instance.directional(&unknowns, *state, column).is_ok();
                if !ok {
                    break;
                }
            }
            if ok {
                return Ok(());
            }
            messages();
            self.no_derivatives = true;
        }
        let mut base = vec![0.0; n];
        let mut moved = vec![0.0; n];
        let mut x = point.states.to_vec();
        self.instance.derivatives(&mut base)?;
        for j in 0..n {
            let size = x[j].abs().max(self.nominals[j].abs());
            let before = x[j];
            x[j] += DISPLACEMENT * size;
            let step = x[j] - before;
            self.instance.set_states(&x)?;
            self.instance.derivatives(&mut moved)?;
            x[j] = before;
            let column = &mut out[j * n..(j + 1) * n];
            for ((entry, moved), base) in column.iter_mut().zip(&moved).zip(&base) {
                *entry = (moved - base) / step;
            }
        }
        self.instance.set_states(&x)
    }
}

impl Drop for Hosted {
    fn drop(&mut self) {
        self.instance.end();
    }
}

impl ForeignInstance for Hosted {
    type Fault = CallFault;

    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<AfterEvent, CallFault> {
        self.initialised(span, tolerance, values).map_err(|trouble| CallFault {
            trouble,
            messages: messages(),
            doing: "during initialization".to_owned(),
        })
    }

    fn evaluate(
        &mut self,
        at: &At<'_>,
        derivatives: &mut [f64],
        indicators: &mut [f64],
    ) -> Result<(), CallFault> {
        self.evaluated(at, derivatives, indicators).map_err(at_time(at.t))
    }

    fn jacobian(&mut self, at: &At<'_>, entries: &mut [f64]) -> Result<(), CallFault> {
        self.differentiated(at, entries).map_err(at_time(at.t))
    }

    fn values(&mut self, at: Option<&At<'_>>, values: &mut [f64]) -> Result<(), CallFault> {
        let placed = at.map_or(Ok(()), |at| self.place(at));
        placed.and_then(|()| self.watched(values)).map_err(|trouble| match at {
            Some(at) => at_time(at.t)(trouble),
            None => {
                let doing = "between steps".to_owned();
                CallFault { trouble, messages: messages(), doing }
            }
        })
    }

    fn complete(&mut self, at: &At<'_>) -> Result<AfterStep, CallFault> {
        let completed = self.place(at).and_then(|()| self.instance.complete_step());
        let (asks_for_event, ends) = completed.map_err(at_time(at.t))?;
        Ok(AfterStep { reached: at.t, asks_for_event, ends })
    }

    fn event(&mut self, at: &At<'_>) -> Result<AfterEvent, CallFault> {
        let set = |own: &mut Self| {
            own.instance.set_time(at.t)?;
            own.instance.set_states(at.states)?;
            own.instance.enter_event_mode()?;
            own.set(at.inputs)?;
            own.after_event()
        };
        set(self).map_err(|trouble| CallFault {
            trouble,
            messages: messages(),
            doing: format!("in the event at time {} s", at.t),
        })
    }

    fn step(&mut self, t: f64, size: f64, inputs: &[(usize, f64)]) -> Result<AfterStep, CallFault> {
        let stepped = self.set(inputs).and_then(|()| self.instance.step(t, size));
        let (reached, ends) = stepped.map_err(at_time(t))?;
        Ok(AfterStep { reached, asks_for_event: false, ends })
    }
}
