//! Counters of the work done: the oracle of regressions in efficiency.

/// Work done in the life of a stepper.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Stats {
    /// Accepted steps.
    pub steps: u64,
    /// Steps rejected by the error test.
    pub rejected: u64,
    /// Steps cut because the stage equations did not converge.
    pub convergence_failures: u64,
    /// Steps cut because the system could not be evaluated or was not finite.
    pub evaluation_failures: u64,
    /// Evaluations of the right side.
    pub rhs: u64,
    /// Evaluations of the Jacobian.
    pub jacobians: u64,
    /// Decompositions, a real and a complex one counted as one.
    pub decompositions: u64,
    /// Newton iterations, one being three right sides and two solves.
    pub newton_iterations: u64,
    /// Starts and restarts.
    pub restarts: u64,
}
