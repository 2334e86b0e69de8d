//! What recordings say about inputs, in the cells of the memory: filled in wherever time is set, so that
//! interpreter and machine code read an input as they read a state.

use std::sync::Arc;

use crate::ir::expr::VarId;
use crate::ir::program::{Layout, Slot};
use crate::numeric::time_series::{Interpolation, TimeSeries};

/// The inputs of one run.
#[derive(Clone, Default)]
pub struct Played {
    courses: Vec<Playing>,
}

#[derive(Clone)]
struct Playing {
    course: Arc<TimeSeries>,
    /// The interval between instants of the recording that the last evaluation was in. Where the course
    /// has a corner at the instants it is fixed for a step, which then sees a smooth course to its end.
    interval: usize,
    cornered: bool,
    /// Order of the derivative and its cell, orders rising from 0.
    cells: Vec<Slot>,
}

impl Played {
    /// The courses of inputs from the instant `t` on.
    pub fn new(layout: &Layout, courses: &[(VarId, Arc<TimeSeries>)], t: f64) -> Self {
        let one = |(v, course): &(VarId, Arc<TimeSeries>)| {
            let mut cells: Vec<(u32, Slot)> = layout
                .recorded
                .iter()
                .filter(|r| r.0 == *v)
                .map(|(_, order, slot)| (*order, *slot))
                .collect();
            cells.sort_unstable();
            let cornered =
                matches!(course.interpolation(), Interpolation::Hold | Interpolation::Linear);
            Playing {
                course: Arc::clone(course),
                interval: course.interval(t, 0),
                cornered,
                cells: cells.into_iter().map(|(_, slot)| slot).collect(),
            }
        };
        Played { courses: courses.iter().map(one).collect() }
    }

    /// Writes what the recordings say at `t`.
    #[inline]
    pub fn place(&mut self, t: f64, memory: &mut [f64]) {
        for p in &mut self.courses {
            if !p.cornered {
                p.interval = p.course.interval(t, p.interval);
            }
            for (order, slot) in p.cells.iter().enumerate() {
                memory[*slot as usize] = p.course.at(t, p.interval, order as u8);
            }
        }
    }

    /// The next instant after the current interval at which a course has a corner; infinity if none.
    pub fn next_corner(&self) -> f64 {
        let cornered = self.courses.iter().filter(|p| p.cornered);
        cornered.map(|p| p.course.end_of(p.interval)).fold(f64::INFINITY, f64::min)
    }

    /// Goes on to what holds after the corners up to `t`; true if a cell may jump there, of a value or of
    /// a rate that the program reads.
    pub fn pass(&mut self, t: f64) -> bool {
        let mut jumps = false;
        for p in self.courses.iter_mut().filter(|p| p.cornered) {
            let now = p.course.interval(t, p.interval);
            if now != p.interval {
                p.interval = now;
                // Of the orders that are there, the last one serves events only.
                let read = p.cells.len().saturating_sub(1);
                jumps |= p.course.interpolation() == Interpolation::Hold || read > 1;
            }
        }
        jumps
    }

    /// The usual time between two instants of the recordings; infinity without any.
    pub fn spacing(&self) -> f64 {
        self.courses.iter().map(|p| p.course.spacing()).fold(f64::INFINITY, f64::min)
    }

    /// Calls `take` with each cell and the rate at which it moves.
    pub fn rates(&self, memory: &[f64], mut take: impl FnMut(Slot, f64)) {
        for p in &self.courses {
            for pair in p.cells.windows(2) {
                take(pair[0], memory[pair[1] as usize]);
            }
        }
    }
}
