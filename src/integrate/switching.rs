//! Dormand-Prince for as long as a system does not turn out to be stiff, then Radau.
//!
//! The first switch is the last: what was stiff once is expected to be so again. The step size of an
//! explicit method falls to what its stability allows before it does harm, and the solution up to
//! there is as accurate as any.

use crate::integrate::explicit::DormandPrince;
use crate::integrate::options::{OptionError, Options};
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::radau::Radau;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::System;

/// The stepper. Only for systems whose components are all differential.
pub struct Switching {
    explicit: DormandPrince,
    implicit: Radau,
    /// Where the explicit method gave up.
    stiff_since: Option<f64>,
    /// The implicit method has made a step of its own, within which to interpolate.
    stands: bool,
    stats: Stats,
}

impl Switching {
    /// A stepper for this system, with the matrices of
    /// [`IterationMatrix::for_system`](crate::integrate::matrix::IterationMatrix::for_system). Each of
    /// the methods has its own options.
    pub fn for_system(
        system: &dyn System,
        explicit: Options,
        implicit: Options,
    ) -> Result<Self, OptionError> {
        Ok(Switching {
            explicit: DormandPrince::new(system.dim(), explicit)?,
            implicit: Radau::for_system(system, implicit)?,
            stiff_since: None,
            stands: false,
            stats: Stats::default(),
        })
    }

    /// True once the system turned out to be stiff.
    pub fn is_stiff(&self) -> bool {
        self.stiff_since.is_some()
    }

    /// When it did.
    pub fn stiff_since(&self) -> Option<f64> {
        self.stiff_since
    }

    fn current(&self) -> &dyn Stepper {
        if self.stands { &self.implicit } else { &self.explicit }
    }

    fn count(&mut self) {
        self.stats = *self.explicit.stats() + *self.implicit.stats();
    }

    fn switch(&mut self, system: &mut dyn System) -> Result<(), Failure> {
        let t = self.explicit.t();
        self.stiff_since = Some(t);
        self.implicit.restart(system, t, self.explicit.y(), JacobianMemory::Forget)
    }
}

impl Stepper for Switching {
    fn restart(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
        jacobian: JacobianMemory,
    ) -> Result<(), Failure> {
        let outcome = if self.is_stiff() {
            self.stands = true;
            self.implicit.restart(system, t, y, jacobian)
        } else {
            self.explicit.restart(system, t, y, jacobian)
        };
        self.count();
        outcome
    }

    fn step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure> {
        if !self.is_stiff() {
            if !self.explicit.is_stiff()
                && let Ok(step) = self.explicit.step(system, t_stop)
            {
                self.count();
                return Ok(step);
            }
            self.switch(system)?;
        }
        let outcome = self.implicit.step(system, t_stop);
        self.stands |= outcome.is_ok();
        self.count();
        outcome
    }

    fn shorten(&mut self, system: &mut dyn System, t: f64) -> Result<(), Failure> {
        let outcome = if self.stands {
            self.implicit.shorten(system, t)
        } else {
            self.explicit.shorten(system, t)
        };
        self.count();
        outcome
    }

    fn t(&self) -> f64 {
        self.current().t()
    }

    fn y(&self) -> &[f64] {
        self.current().y()
    }

    fn t_previous(&self) -> f64 {
        self.current().t_previous()
    }

    fn interpolate(&self, t: f64, out: &mut [f64]) {
        self.current().interpolate(t, out);
    }

    fn next_step(&self) -> f64 {
        if self.is_stiff() { self.implicit.next_step() } else { self.explicit.next_step() }
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::problems::*;

    fn end(system: &mut dyn System, start: &[f64], t_stop: f64) -> (Vec<f64>, Switching) {
        let options = Options::with_nominals(1e-6, &vec![1.0; start.len()]);
        let mut stepper = Switching::for_system(system, options.clone(), options).unwrap();
        let y = run(&mut stepper, system, (0.0, start), t_stop).unwrap();
        (y, stepper)
    }

    /// The limit cycle is stiff on its slow branches.
    #[test]
    fn a_stiff_system_is_handed_over() {
        let (y, stepper) = end(&mut van_der_pol(1e-6), &[2.0, 0.0], 2.0);
        assert!(relative_error(&y, &VAN_DER_POL_END, 0.0) < 1e-6);
        let since = stepper.stiff_since().unwrap();
        // So early that the explicit method cost next to nothing.
        assert!(since < 1e-3 && stepper.explicit.stats().steps < 200, "{since}");
        let (mine, theirs) = (stepper.stats().steps, stepper.implicit.stats().steps);
        assert_eq!(mine, stepper.explicit.stats().steps + theirs);
    }

    #[test]
    fn a_system_that_is_not_stiff_stays() {
        let (y, stepper) = end(&mut oscillator(), &[0.0, 1.0], 50.0);
        assert!(relative_error(&y, &[50.0_f64.sin(), 50.0_f64.cos()], 1.0) < 1e-4);
        assert!(!stepper.is_stiff());
        let (_, stepper) = end(&mut arenstorf(), &ARENSTORF_START, ARENSTORF_PERIOD);
        assert!(!stepper.is_stiff());
    }

    /// At the change of methods the last step of the first one still serves.
    #[test]
    fn the_solution_is_continuous_across_the_switch() {
        let mut system = van_der_pol(1e-3);
        let options = Options::with_nominals(1e-8, &[1.0; 2]);
        let mut stepper = Switching::for_system(&system, options.clone(), options).unwrap();
        stepper.restart(&mut system, 0.0, &[2.0, 0.0], JacobianMemory::Forget).unwrap();
        let (mut out, mut last) = ([0.0; 2], vec![2.0, 0.0]);
        while !(stepper.is_stiff() && stepper.t() > 0.5) {
            stepper.step(&mut system, 1.0).unwrap();
            stepper.interpolate(stepper.t_previous(), &mut out);
            let jump = relative_error(&out, &last, 1.0);
            assert!(jump < 1e-12, "{jump} at {}", stepper.t_previous());
            last.copy_from_slice(stepper.y());
        }
    }

    #[test]
    fn a_shortened_step_is_as_accurate_as_a_whole_one() {
        let options = Options::with_nominals(1e-8, &[1.0; 2]);
        let mut stepper = Switching::for_system(&oscillator(), options.clone(), options).unwrap();
        check_shortening(&mut stepper, 1e-8);
    }
}
