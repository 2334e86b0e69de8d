//! The contract of [`Trajectory`]: monotone times, finite values, columns of one length, names of their own.

use crate::ir::trajectory::Trajectory;

/// The first violation, which makes the rest unreadable.
pub fn check(trajectory: &Trajectory) -> Vec<String> {
    trajectory.verify().err().map(|fault| fault.to_string()).into_iter().collect()
}
