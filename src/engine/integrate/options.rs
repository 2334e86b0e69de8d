//! Options of the integrator and their defaults.

/// Default relative tolerance.
pub const DEFAULT_RTOL: f64 = 1e-6;
/// Smallest relative tolerance: some ten times the spacing of doubles.
pub const MIN_RTOL: f64 = 1e-14;
/// Default limit of accepted and rejected steps of a stepper.
pub const DEFAULT_MAX_STEPS: u64 = 10_000_000;
/// Default limit of consecutive reductions of one step: 60 halvings span the digits of a double.
pub const DEFAULT_MAX_CUTS: u32 = 60;

/// Options of one integration. All times are in the unit of `t`.
#[derive(Clone, PartialEq, Debug)]
pub struct Options {
    /// Tolerated error of a step relative to `|y_i|`, dimensionless, at least [`MIN_RTOL`] and
    /// below 1. The step size is proportional to its fourth root (Radau) or fifth root
    /// (Dormand-Prince).
    pub rtol: f64,
    /// Tolerated absolute error of a step per component, in its unit, positive. It dominates where
    /// `|y_i|` is less than `atol_i / rtol`.
    pub atol: Vec<f64>,
    /// Maximum step, positive; infinite by default. A bound keeps short pulses in `f` from being
    /// stepped over.
    pub max_step: f64,
    /// Minimum step: if a shorter one is needed, the integration fails. 0 by default, so that the
    /// spacing of doubles at `t` is the limit.
    pub min_step: f64,
    /// First step after every restart; chosen from the slope of `f` if `None`.
    pub initial_step: Option<f64>,
    /// Maximum number of accepted and rejected steps of the stepper, at least 1.
    pub max_steps: u64,
    /// Maximum number of consecutive reductions of one step, at least 1.
    pub max_cuts: u32,
}

impl Options {
    /// Defaults for `n` components of nominal value one.
    pub fn new(n: usize) -> Self {
        Self::with_nominals(DEFAULT_RTOL, &vec![1.0; n])
    }

    /// Defaults for components with these nominal magnitudes: `atol_i = rtol * |nominal_i|`.
    pub fn with_nominals(rtol: f64, nominals: &[f64]) -> Self {
        Options {
            rtol,
            atol: nominals.iter().map(|nominal| rtol * nominal.abs()).collect(),
            max_step: f64::INFINITY,
            min_step: 0.0,
            initial_step: None,
            max_steps: DEFAULT_MAX_STEPS,
            max_cuts: DEFAULT_MAX_CUTS,
        }
    }

    /// Rejects values out of range; nothing is silently replaced.
    pub fn validate(&self, n: usize) -> Result<(), OptionError> {
        check_rtol(self.rtol)?;
        if self.atol.len() != n {
            return Err(OptionError::AbsoluteToleranceCount { given: self.atol.len(), needed: n });
        }
        if let Some(component) = self.atol.iter().position(|a| !(*a > 0.0 && a.is_finite())) {
            let atol = self.atol[component];
            return Err(OptionError::AbsoluteTolerance { component, atol });
        }
        if !(self.max_step > 0.0) {
            return Err(OptionError::MaxStep { max_step: self.max_step });
        }
        if !(self.min_step >= 0.0 && self.min_step <= self.max_step) {
            return Err(OptionError::MinStep { min_step: self.min_step });
        }
        if let Some(h) = self.initial_step
            && !(h > 0.0 && h >= self.min_step && h <= self.max_step && h.is_finite())
        {
            return Err(OptionError::InitialStep { initial_step: h });
        }
        if self.max_steps == 0 || self.max_cuts == 0 {
            return Err(OptionError::ZeroLimit);
        }
        Ok(())
    }
}

/// Rejects a relative tolerance out of range.
pub fn check_rtol(rtol: f64) -> Result<(), OptionError> {
    match (MIN_RTOL..1.0).contains(&rtol) {
        true => Ok(()),
        false => Err(OptionError::RelativeTolerance { rtol }),
    }
}

/// An option out of its range.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum OptionError {
    /// See [`Options::rtol`].
    #[error("the relative tolerance {rtol} is not between {MIN_RTOL:e} and 1")]
    RelativeTolerance {
        /// The value given.
        rtol: f64,
    },
    /// See [`Options::atol`].
    #[error("{given} absolute tolerances were given for {needed} components")]
    AbsoluteToleranceCount {
        /// Tolerances given.
        given: usize,
        /// Components of the system.
        needed: usize,
    },
    /// See [`Options::atol`].
    #[error("the absolute tolerance {atol} of component {component} is not positive and finite")]
    AbsoluteTolerance {
        /// Index of the component.
        component: usize,
        /// The value given.
        atol: f64,
    },
    /// See [`Options::max_step`].
    #[error("the longest step {max_step} is not positive")]
    MaxStep {
        /// The value given.
        max_step: f64,
    },
    /// See [`Options::min_step`].
    #[error("the shortest step {min_step} is negative or longer than the longest")]
    MinStep {
        /// The value given.
        min_step: f64,
    },
    /// See [`Options::initial_step`].
    #[error("the initial step {initial_step} is not between the shortest and the longest step")]
    InitialStep {
        /// The value given.
        initial_step: f64,
    },
    /// See [`Options::max_steps`] and [`Options::max_cuts`].
    #[error("a limit of zero steps or reductions allows no integration")]
    ZeroLimit,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_scale_with_nominals() {
        let options = Options::with_nominals(1e-4, &[1.0, -1e5]);
        assert_eq!(options.validate(2), Ok(()));
        assert!((options.atol[1] - 10.0).abs() < 1e-12);
    }

    #[test]
    fn every_option_out_of_range_is_rejected() {
        let good = Options::new(1);
        let bad = |change: &dyn Fn(&mut Options)| {
            let mut options = good.clone();
            change(&mut options);
            options.validate(1).unwrap_err().to_string()
        };
        assert!(bad(&|o| o.rtol = 0.0).contains("relative tolerance 0"));
        assert!(bad(&|o| o.rtol = f64::NAN).contains("NaN"));
        assert!(bad(&|o| o.rtol = 0.99 * MIN_RTOL).contains("between 1e-14 and 1"));
        assert_eq!(check_rtol(MIN_RTOL), Ok(()));
        assert!(bad(&|o| o.atol = vec![]).contains("0 absolute tolerances"));
        assert!(bad(&|o| o.atol = vec![0.0]).contains("component 0"));
        assert!(bad(&|o| o.max_step = -1.0).contains("longest step -1"));
        assert!(bad(&|o| o.min_step = -1.0).contains("shortest step -1"));
        assert!(bad(&|o| o.initial_step = Some(0.0)).contains("initial step 0"));
        assert!(bad(&|o| o.max_cuts = 0).contains("zero"));
    }
}
