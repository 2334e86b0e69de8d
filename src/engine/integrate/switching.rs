//! Switches from Dormand-Prince to Radau when the system turns out to be stiff, and to BDF if
//! Radau's steps are often rejected.
//!
//! A system that was stiff once is expected to become stiff again, so it never switches back. The
//! step size of the explicit method falls to its stability limit before the error grows, so the
//! solution up to the switch is as accurate as any.
//!
//! Radau takes longer steps on a smooth solution. Where fronts, stops and saturations follow each
//! other its steps are rejected repeatedly, by the error test or because the iteration does not
//! converge across a kink. A rejected step costs a dozen right sides and two decompositions,
//! whereas a multistep method loses one or two right sides. `benches/peer.rs` has examples of both:
//! the reactions of Robertson and HIRES, where at most one step in a hundred is rejected, and a
//! valve with one in five.

use crate::integrate::bdf::Bdf;
use crate::integrate::explicit::DormandPrince;
use crate::integrate::options::{OptionError, Options};
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::radau::Radau;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::System;

/// Number of Radau steps before its rejections are considered.
const STEPS_BEFORE_SWITCH: u64 = 100;
/// Rejections are frequent if they exceed one in this number of attempts.
const MAX_REJECTION_RATIO: u64 = 12;

/// The stepper. Only for systems whose components are all differential.
pub struct Switching {
    explicit: DormandPrince,
    radau: Radau,
    bdf: Bdf,
    /// Method of the next step.
    next: Phase,
    /// Method of the last step, which interpolates.
    last: Phase,
    /// Time at which the system was found to be stiff.
    stiff_since: Option<f64>,
    /// Time at which the solution was found to be rough.
    rough_since: Option<f64>,
    stats: Stats,
}

/// The method in use.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Phase {
    /// Dormand-Prince.
    Explicit,
    /// Radau IIA.
    Radau,
    /// Backward differentiation.
    Bdf,
}

/// Options of each method: equal tolerances give different errors.
#[derive(Clone, Debug)]
pub struct MethodOptions {
    /// Options of Dormand-Prince.
    pub explicit: Options,
    /// Options of Radau.
    pub radau: Options,
    /// Options of BDF.
    pub bdf: Options,
}

impl Switching {
    /// A stepper for this system, with the matrices of
    /// [`IterationMatrix::for_system`](crate::integrate::matrix::IterationMatrix::for_system).
    pub fn for_system(system: &dyn System, choices: MethodOptions) -> Result<Self, OptionError> {
        Ok(Switching {
            explicit: DormandPrince::new(system.dim(), choices.explicit)?,
            radau: Radau::for_system(system, choices.radau)?,
            bdf: Bdf::for_system(system, choices.bdf)?,
            next: Phase::Explicit,
            last: Phase::Explicit,
            stiff_since: None,
            rough_since: None,
            stats: Stats::default(),
        })
    }

    /// The method of the next step.
    pub fn phase(&self) -> Phase {
        self.next
    }

    /// Time at which the system was found to be stiff.
    pub fn stiff_since(&self) -> Option<f64> {
        self.stiff_since
    }

    /// Time at which Radau's steps were found to be rejected often.
    pub fn rough_since(&self) -> Option<f64> {
        self.rough_since
    }

    fn of(&self, phase: Phase) -> &dyn Stepper {
        match phase {
            Phase::Explicit => &self.explicit,
            Phase::Radau => &self.radau,
            Phase::Bdf => &self.bdf,
        }
    }

    fn of_mut(&mut self, phase: Phase) -> &mut dyn Stepper {
        match phase {
            Phase::Explicit => &mut self.explicit,
            Phase::Radau => &mut self.radau,
            Phase::Bdf => &mut self.bdf,
        }
    }

    fn count(&mut self) {
        self.stats = *self.explicit.stats() + *self.radau.stats() + *self.bdf.stats();
    }

    /// True if too many of Radau's steps were rejected.
    fn is_rough(&self) -> bool {
        let Stats { steps, rejected, convergence_failures, .. } = *self.radau.stats();
        let refused = rejected + convergence_failures;
        steps >= STEPS_BEFORE_SWITCH && refused * MAX_REJECTION_RATIO > steps + refused
    }

    /// Continues with another method from the current point.
    fn switch(&mut self, system: &mut dyn System, to: Phase) -> Result<(), Failure> {
        let (from, t) = (self.of(self.next), self.of(self.next).t());
        let y = from.y().to_vec();
        self.next = to;
        self.of_mut(to).restart(system, t, &y, JacobianMemory::Forget)
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
        self.last = self.next;
        let outcome = self.of_mut(self.next).restart(system, t, y, jacobian);
        self.count();
        outcome
    }

    fn step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure> {
        if self.next == Phase::Explicit {
            if !self.explicit.is_stiff()
                && let Ok(step) = self.explicit.step(system, t_stop)
            {
                self.count();
                return Ok(step);
            }
            self.stiff_since = Some(self.explicit.t());
            self.switch(system, Phase::Radau)?;
        } else if self.next == Phase::Radau && self.is_rough() {
            self.rough_since = Some(self.radau.t());
            self.switch(system, Phase::Bdf)?;
        }
        let outcome = self.of_mut(self.next).step(system, t_stop);
        if outcome.is_ok() {
            self.last = self.next;
        }
        self.count();
        outcome
    }

    fn shorten(&mut self, system: &mut dyn System, t: f64) -> Result<(), Failure> {
        let outcome = self.of_mut(self.last).shorten(system, t);
        self.count();
        outcome
    }

    fn pass_kink(&mut self) {
        self.of_mut(self.next).pass_kink();
    }

    fn t(&self) -> f64 {
        self.of(self.last).t()
    }

    fn y(&self) -> &[f64] {
        self.of(self.last).y()
    }

    fn t_previous(&self) -> f64 {
        self.of(self.last).t_previous()
    }

    fn interpolate(&self, t: f64, out: &mut [f64]) {
        self.of(self.last).interpolate(t, out);
    }

    fn next_step(&self) -> f64 {
        self.of(self.next).next_step()
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::problems::*;

    fn choices(rtol: f64, n: usize) -> MethodOptions {
        let options = Options::with_nominals(rtol, &vec![1.0; n]);
        MethodOptions { explicit: options.clone(), radau: options.clone(), bdf: options }
    }

    fn end(system: &mut dyn System, start: &[f64], t_stop: f64) -> (Vec<f64>, Switching) {
        let mut stepper = Switching::for_system(system, choices(1e-6, start.len())).unwrap();
        let y = run(&mut stepper, system, (0.0, start), t_stop).unwrap();
        (y, stepper)
    }

    /// The limit cycle is stiff on its slow branches.
    #[test]
    fn a_stiff_system_is_handed_over() {
        let (y, stepper) = end(&mut van_der_pol(1e-6), &[2.0, 0.0], 2.0);
        assert!(relative_error(&y, &VAN_DER_POL_END, 0.0) < 1e-6);
        let since = stepper.stiff_since().unwrap();
        // Early enough that the explicit method cost next to nothing.
        assert!(since < 1e-3 && stepper.explicit.stats().steps < 200, "{since}");
        let theirs = stepper.radau.stats().steps + stepper.bdf.stats().steps;
        assert_eq!(stepper.stats().steps, stepper.explicit.stats().steps + theirs);
    }

    #[test]
    fn a_system_that_is_not_stiff_stays() {
        let (y, stepper) = end(&mut oscillator(), &[0.0, 1.0], 50.0);
        assert!(relative_error(&y, &[50.0_f64.sin(), 50.0_f64.cos()], 1.0) < 1e-4);
        assert_eq!(stepper.phase(), Phase::Explicit);
        let (_, stepper) = end(&mut arenstorf(), &ARENSTORF_START, ARENSTORF_PERIOD);
        assert_eq!(stepper.phase(), Phase::Explicit);
    }

    /// At the switch, interpolation still uses the last step of the first method.
    #[test]
    fn the_solution_is_continuous_across_the_switch() {
        let mut system = van_der_pol(1e-3);
        let mut stepper = Switching::for_system(&system, choices(1e-8, 2)).unwrap();
        stepper.restart(&mut system, 0.0, &[2.0, 0.0], JacobianMemory::Forget).unwrap();
        let (mut out, mut last) = ([0.0; 2], vec![2.0, 0.0]);
        while !(stepper.phase() != Phase::Explicit && stepper.t() > 0.5) {
            stepper.step(&mut system, 1.0).unwrap();
            stepper.interpolate(stepper.t_previous(), &mut out);
            let jump = relative_error(&out, &last, 1.0);
            assert!(jump < 1e-12, "{jump} at {}", stepper.t_previous());
            last.copy_from_slice(stepper.y());
        }
    }

    #[test]
    fn a_shortened_step_is_as_accurate_as_a_whole_one() {
        let mut stepper = Switching::for_system(&oscillator(), choices(1e-8, 2)).unwrap();
        check_shortening(&mut stepper, 1e-8);
    }

    /// `y' = (tanh(50 sin 40 t) - tanh(1000 y)) 1e3`: a front every 80 ms, each met by kinks of the
    /// right side. At the end of the tests both branches rest at `tanh(1000 y) = tanh(50 sin 40
    /// t)`.
    #[test]
    fn a_rough_system_is_handed_on() {
        let mut system = ode(
            1,
            |t: f64, y: &[f64], f: &mut [f64]| {
                f[0] = 1e3 * ((50.0 * (40.0 * t).sin()).tanh() - (1e3 * y[0]).tanh() - y[0]);
                Ok(())
            },
            |_, y: &[f64], j: &mut [f64]| {
                let slope = (1e3 * y[0]).tanh();
                j[0] = -1e3 * (1.0 + 1e3 * (1.0 - slope * slope));
            },
        );
        let (y, stepper) = end(&mut system, &[0.0], 10.0);
        assert_eq!(stepper.phase(), Phase::Bdf);
        assert!(stepper.rough_since() > stepper.stiff_since());
        let mut radau = Radau::new(1, Options::with_nominals(1e-10, &[1.0])).unwrap();
        let fine = run(&mut radau, &mut system, (0.0, &[0.0]), 10.0).unwrap();
        assert!((y[0] - fine[0]).abs() < 1e-5, "{} instead of {}", y[0], fine[0]);
        // Smooth reactions stay with Radau.
        let (_, stepper) = end(&mut hires(), &HIRES_START, HIRES_TIME);
        assert_eq!(stepper.phase(), Phase::Radau);
    }
}
