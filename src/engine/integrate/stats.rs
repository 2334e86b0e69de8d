//! Counters of the work of a stepper, for detecting regressions in efficiency.

/// Work of a stepper since its construction.
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
    /// Decompositions, those of the real and the complex matrix of Radau counted as one.
    pub decompositions: u64,
    /// Newton iterations: of Radau three right sides and two solves each, of BDF one of each.
    pub newton_iterations: u64,
    /// Starts and restarts.
    pub restarts: u64,
}

impl Stats {
    /// The counters in the order of the fields.
    pub fn to_array(self) -> [u64; 9] {
        [
            self.steps,
            self.rejected,
            self.convergence_failures,
            self.evaluation_failures,
            self.rhs,
            self.jacobians,
            self.decompositions,
            self.newton_iterations,
            self.restarts,
        ]
    }
}

impl From<[u64; 9]> for Stats {
    fn from(counters: [u64; 9]) -> Self {
        let [
            steps,
            rejected,
            convergence_failures,
            evaluation_failures,
            rhs,
            jacobians,
            decompositions,
            newton_iterations,
            restarts,
        ] = counters;
        Stats {
            steps,
            rejected,
            convergence_failures,
            evaluation_failures,
            rhs,
            jacobians,
            decompositions,
            newton_iterations,
            restarts,
        }
    }
}

impl std::ops::Add for Stats {
    type Output = Stats;

    fn add(self, other: Stats) -> Stats {
        Stats {
            steps: self.steps + other.steps,
            rejected: self.rejected + other.rejected,
            convergence_failures: self.convergence_failures + other.convergence_failures,
            evaluation_failures: self.evaluation_failures + other.evaluation_failures,
            rhs: self.rhs + other.rhs,
            jacobians: self.jacobians + other.jacobians,
            decompositions: self.decompositions + other.decompositions,
            newton_iterations: self.newton_iterations + other.newton_iterations,
            restarts: self.restarts + other.restarts,
        }
    }
}
