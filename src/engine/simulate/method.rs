//! Chooses the integration method of a run.
//!
//! The choice depends on the structure of the program, never on a clock, so equal inputs give equal
//! bits:
//!
//! - Radau if the solution may be non-smooth or is differentiated: relations, state selection,
//!   sensitivities. It restarts at full order, whereas a multistep method restarts with order 1.
//! - BDF for large systems without events, where factorizations dominate: it factorizes one real
//!   matrix instead of a real and a complex one, and does so less often. At equal error it takes
//!   half the time of Radau on a plate of 400 to 3600 cells, and a quarter more on a rod, whose
//!   matrices are cheap to factorize.
//! - Otherwise Dormand-Prince until the system turns out to be stiff, then Radau, and BDF if
//!   Radau's steps are often rejected ([`Switching`]).
//!
//! A system with algebraic equations is never given to an explicit method.
//!
//! The same tolerance should give about the same error with every method: Radau meets it with
//! digits to spare; the others do not and get a tighter one.

use std::ops::{Deref, DerefMut};

use crate::integrate::bdf::Bdf;
use crate::integrate::explicit::DormandPrince;
use crate::integrate::options::{OptionError, Options};
use crate::integrate::radau::Radau;
use crate::integrate::stepper::Stepper;
use crate::integrate::switching::{MethodOptions, Phase, Switching};
use crate::integrate::system::System;
use crate::ir::program::Program;

use super::settings::Method;

/// Number of states from which on BDF is chosen for a system without events.
const MANY_STATES: usize = 150;
/// Factor on the tolerance of Dormand-Prince.
const DOPRI_FACTOR: f64 = 0.1;
/// Factor on the tolerance of BDF: the errors of its many steps add up.
const BDF_FACTOR: f64 = 0.01;
/// Minimum relative tolerance after tightening.
const MIN_RTOL: f64 = 1e-13;

/// The stepper of a run.
pub enum Integrator {
    /// Stiff systems, and systems with events.
    Radau(Box<Radau>),
    /// Large stiff systems that are smooth for long.
    Bdf(Box<Bdf>),
    /// Systems that are not stiff.
    DormandPrince(Box<DormandPrince>),
    /// Systems whose stiffness is unknown.
    Switching(Box<Switching>),
}

/// The chosen method and the reason.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Choice {
    /// Name of the method in use at the end.
    pub method: &'static str,
    /// The reason, if it was chosen automatically.
    pub because: Option<String>,
}

/// Why there is no integrator.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum NoMethod {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] OptionError),
    /// An explicit method cannot solve algebraic equations.
    #[error(
        "dopri is explicit: it cannot find the {unknowns} unknowns of algebraic loops; take radau, bdf or the reduced mode"
    )]
    Explicit {
        /// Their number.
        unknowns: usize,
    },
}

impl Integrator {
    /// The stepper for a program and its right side. `differentiated` requests sensitivities, which
    /// only Radau supports.
    pub fn new(
        wanted: Method,
        program: &Program,
        differentiated: bool,
        system: &dyn System,
        options: Options,
    ) -> Result<(Self, Choice), NoMethod> {
        let (method, because) = match wanted {
            _ if differentiated => (Method::Radau, Some("derivatives by inputs".to_owned())),
            Method::Auto => {
                let (method, because) = choose(program);
                (method, Some(because))
            }
            method => (method, None),
        };
        if method == Method::Dopri && !program.algebraics.is_empty() {
            return Err(NoMethod::Explicit { unknowns: program.algebraics.len() });
        }
        Ok(Integrator::of(method, because, system, options)?)
    }

    /// The stepper of a method, and why it was chosen; [`Method::Auto`] is explicit until the system is stiff.
    pub fn of(
        method: Method,
        because: Option<String>,
        system: &dyn System,
        options: Options,
    ) -> Result<(Self, Choice), OptionError> {
        let integrator = match method {
            Method::Radau => Integrator::Radau(Box::new(Radau::for_system(system, options)?)),
            Method::Bdf => {
                let options = for_bdf(&options);
                Integrator::Bdf(Box::new(Bdf::for_system(system, options)?))
            }
            Method::Dopri => {
                let options = tightened(&options, DOPRI_FACTOR);
                Integrator::DormandPrince(Box::new(DormandPrince::new(system.dim(), options)?))
            }
            Method::Auto => {
                let explicit = tightened(&options, DOPRI_FACTOR);
                let bdf = for_bdf(&options);
                let choices = MethodOptions { explicit, radau: options, bdf };
                Integrator::Switching(Box::new(Switching::for_system(system, choices)?))
            }
        };
        let choice = Choice { method: integrator.name(), because };
        Ok((integrator, choice))
    }

    /// The name of the method in use, as on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Integrator::Radau(_) => "radau",
            Integrator::Bdf(_) => "bdf",
            Integrator::DormandPrince(_) => "dopri",
            Integrator::Switching(s) => match s.phase() {
                Phase::Explicit => "dopri",
                Phase::Radau => "radau",
                Phase::Bdf => "bdf",
            },
        }
    }

    /// The choice after the run, including whether the system was stiff.
    pub fn describe(&self, mut choice: Choice) -> Choice {
        choice.method = self.name();
        if let (Integrator::Switching(s), Some(because)) = (self, &mut choice.because) {
            because.push_str(&match s.stiff_since() {
                Some(t) => format!(", stiff from {t:.3e} s on"),
                None => ", not stiff".to_owned(),
            });
            if let Some(t) = s.rough_since() {
                because.push_str(&format!(", rough from {t:.3e} s on"));
            }
        }
        choice
    }

    /// The stepper, if it supports sensitivities.
    pub fn radau(&mut self) -> Option<&mut Radau> {
        match self {
            Integrator::Radau(radau) => Some(radau),
            _ => None,
        }
    }
}

/// The options of BDF. A component that decays far below its initial size would keep an error of
/// the size of the absolute tolerance, which Radau undercuts by orders of magnitude. With the
/// factor applied twice, Robertson's reaction, whose first concentration falls by eight decades, is
/// correct to five digits.
fn for_bdf(options: &Options) -> Options {
    let mut tightened_options = tightened(options, BDF_FACTOR);
    tightened_options.atol.iter_mut().for_each(|a| *a *= BDF_FACTOR);
    tightened_options
}

/// The same options with tolerances multiplied by `part`.
fn tightened(options: &Options, part: f64) -> Options {
    let mut options = options.clone();
    let part = part.max(MIN_RTOL / options.rtol).min(1.0);
    options.rtol *= part;
    options.atol.iter_mut().for_each(|a| *a *= part);
    options
}

/// The methods that may solve what the automatic choice for a program did not, best first.
pub fn other_methods(program: &Program) -> Vec<Method> {
    let (chosen, _) = choose(program);
    let mut others = vec![Method::Bdf, Method::Radau];
    others.retain(|method| *method != chosen);
    others
}

/// The automatic choice and its reason; [`Method::Auto`] as a result means [`Switching`].
fn choose(program: &Program) -> (Method, String) {
    let (states, algebraics) = (program.order(), program.algebraics.len());
    let mut counted = match states - algebraics {
        1 => "1 state".to_owned(),
        states => format!("{states} states"),
    };
    if algebraics > 0 {
        counted.push_str(&format!(", {algebraics} algebraic"));
    }
    let eventful = !program.events.relation_triggers.is_empty() || !program.state_sets.is_empty();
    if states == 0 || eventful || (algebraics > 0 && states < MANY_STATES) {
        let what = if program.events.relation_triggers.is_empty() { "" } else { ", events" };
        (Method::Radau, counted + what)
    } else if states >= MANY_STATES {
        (Method::Bdf, counted + ", no events")
    } else {
        (Method::Auto, counted + ", no events")
    }
}

impl std::fmt::Display for Choice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.because {
            Some(because) => write!(f, "{} (auto: {because})", self.method),
            None => f.write_str(self.method),
        }
    }
}

/// One additional virtual call per step, compared to many for the right side.
impl Deref for Integrator {
    type Target = dyn Stepper;
    fn deref(&self) -> &(dyn Stepper + 'static) {
        match self {
            Integrator::Radau(s) => &**s,
            Integrator::Bdf(s) => &**s,
            Integrator::DormandPrince(s) => &**s,
            Integrator::Switching(s) => &**s,
        }
    }
}

impl DerefMut for Integrator {
    fn deref_mut(&mut self) -> &mut (dyn Stepper + 'static) {
        match self {
            Integrator::Radau(s) => &mut **s,
            Integrator::Bdf(s) => &mut **s,
            Integrator::DormandPrince(s) => &mut **s,
            Integrator::Switching(s) => &mut **s,
        }
    }
}
