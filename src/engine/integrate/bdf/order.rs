//! Selects order and length of the next step.
//!
//! Brown, Byrne & Hindmarsh 1989, sec. 3; Hindmarsh et al. 2005, sec. 2.1. With order `q` the order
//! may change after `q + 1` steps, by one; the candidate that allows the longest step wins.

use crate::integrate::bdf::coefficients::{Coefficients, MAX_ORDER};
use crate::integrate::bdf::nordsieck::Nordsieck;

/// Bias factors of the estimated errors of the lower, the same and the higher order.
const CAUTION_LOWER: f64 = 6.0;
const CAUTION: f64 = 6.0;
const CAUTION_HIGHER: f64 = 10.0;
/// Minimum growth that is worth new coefficients.
const WORTHWHILE: f64 = 1.5;
/// Maximum growth of the step.
const GROWTH: f64 = 10.0;
/// Maximum growth after the first step, whose length was a guess.
const GROWTH_FIRST: f64 = 1e4;

/// State of the control.
pub struct OrderControl {
    /// Steps until the order may change.
    wait: usize,
    /// No step has been accepted since the restart.
    first: bool,
    change: Option<Change>,
    /// Correction and `comparison` of the step preceding a possible change of order.
    earlier: Vec<f64>,
    earlier_comparison: Option<f64>,
}

/// Change of order before the next step.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Change {
    /// Increase by one.
    Raise,
    /// Decrease by one.
    Lower,
}

/// The factor by which a step may grow if its error, of this order in `h`, is `size`.
pub fn growth(size: f64, order: usize) -> f64 {
    1.0 / (size.powf(1.0 / order as f64) + 1e-6)
}

/// [`growth`], or zero if it is not worthwhile, which avoids computing a root.
fn worthwhile_growth(size: f64, order: usize) -> f64 {
    const LARGEST: f64 = 1.0 / WORTHWHILE;
    if size > LARGEST.powi(order as i32) {
        return 0.0;
    }
    let factor = growth(size, order);
    if factor < WORTHWHILE { 0.0 } else { factor }
}

impl OrderControl {
    /// For `n` components.
    pub fn new(n: usize) -> Self {
        let earlier = vec![0.0; n];
        OrderControl { wait: 2, first: true, change: None, earlier, earlier_comparison: None }
    }

    /// Restarts with order 1.
    pub fn restart(&mut self) {
        self.wait = 2;
        self.first = true;
        self.change = None;
        self.earlier_comparison = None;
    }

    /// True until a step is accepted after the restart.
    pub fn is_first(&self) -> bool {
        self.first
    }

    /// Postpones changes of order after a failed or repeated step.
    pub fn postpone_change(&mut self, order: usize) {
        self.wait = order + 1;
        self.change = None;
        self.earlier_comparison = None;
    }

    /// Takes the change of order before the next step.
    pub fn take_change(&mut self) -> Option<Change> {
        self.change.take()
    }

    /// After an accepted step, whose array is corrected: the factor for the next step, and the
    /// change of order with it. `failed`: the step was attempted more than once.
    pub fn plan(
        &mut self,
        formula: &Coefficients,
        error: f64,
        failed: bool,
        array: &Nordsieck,
        corrections: &[f64],
        weights: &[f64],
    ) -> f64 {
        let limit = if self.first { GROWTH_FIRST } else { GROWTH };
        self.first = false;
        self.wait = self.wait.saturating_sub(1);
        if self.wait == 1 && array.order < MAX_ORDER {
            self.earlier.copy_from_slice(corrections);
            self.earlier_comparison = Some(formula.comparison);
        }
        if failed {
            self.wait = self.wait.max(2);
            return 1.0;
        }
        let same = worthwhile_growth(CAUTION * error, array.order + 1);
        if self.wait > 0 {
            return if same > 0.0 { same.min(limit) } else { 1.0 };
        }
        // If nothing changes, try again two steps later.
        self.wait = 2;
        let lower = self.lower(formula, array, weights);
        let higher = self.higher(formula, array, corrections, weights);
        let best = same.max(lower).max(higher);
        if best == 0.0 {
            return 1.0;
        }
        if best != same {
            self.change = Some(if best == lower { Change::Lower } else { Change::Raise });
            self.wait = if best == lower { array.order } else { array.order + 2 };
            self.earlier_comparison = None;
        }
        best.min(limit)
    }

    fn lower(&self, formula: &Coefficients, array: &Nordsieck, weights: &[f64]) -> f64 {
        if array.order == 1 {
            return 0.0;
        }
        let size = rms(array.highest(), weights);
        worthwhile_growth(CAUTION_LOWER * size * formula.error_lower, array.order)
    }

    fn higher(
        &self,
        formula: &Coefficients,
        array: &Nordsieck,
        corrections: &[f64],
        weights: &[f64],
    ) -> f64 {
        let (Some(earlier), true) = (self.earlier_comparison, array.order < MAX_ORDER) else {
            return 0.0;
        };
        let ratio = array.steps[0] / array.steps[1];
        let scale = formula.comparison / earlier * ratio.powi(array.order as i32 + 1);
        let difference = corrections.iter().zip(&self.earlier).map(|(now, e)| now - scale * e);
        let size = rms(difference, weights);
        worthwhile_growth(CAUTION_HIGHER * size * formula.error_higher, array.order + 2)
    }
}

fn rms(values: impl Iterator<Item = f64>, weights: &[f64]) -> f64 {
    let sum: f64 = values.zip(weights).map(|(v, w)| (v * w) * (v * w)).sum();
    (sum / weights.len().max(1) as f64).sqrt()
}
