//! Tables as functions of Reals with derivatives.

use std::sync::Arc;

use super::curve::Curve;
use super::surface::Surface;
use super::time_table::TimeTable;
use crate::external::{External, Signature, same_if_equal};

/// The polynomials are cubic: higher derivatives are 0.
const MAX_ORDER: u8 = 3;

fn signature(name: &'static str, arity: usize, is_differentiable: bool) -> Signature {
    Signature { name, arity, is_integer: false, is_differentiable }
}

/// The name of a table, or of a derivative of it.
fn name(order: u8) -> &'static str {
    if order == 0 { "table" } else { "derivativeOfTable" }
}

/// The derivative of order `order` of a curve.
#[derive(Clone, PartialEq, Debug)]
pub struct CurveValue {
    /// The curve.
    pub curve: Arc<Curve>,
    /// 0 for the curve itself.
    pub order: u8,
}

impl External for CurveValue {
    fn signature(&self) -> Signature {
        signature(name(self.order), 1, true)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        self.curve.at(args[0], self.order)
    }

    fn derivative(&self, _argument: usize) -> Option<Arc<dyn External>> {
        let order = self.order + 1;
        (order <= MAX_ORDER).then(|| Arc::new(CurveValue { curve: self.curve.clone(), order }) as _)
    }

    fn slope(&self, _argument: usize, args: &[f64]) -> f64 {
        self.curve.at(args[0], self.order + 1)
    }

    fn modelica(&self, name: &str) -> Option<String> {
        Some(self.curve.modelica(name, self.order))
    }

    same_if_equal!();
}

/// The derivative of order `order` of a function of time; its arguments are time and the time of the
/// next event.
#[derive(Clone, PartialEq, Debug)]
pub struct TimeTableValue {
    /// The table.
    pub table: Arc<TimeTable>,
    /// 0 for the table itself.
    pub order: u8,
}

impl External for TimeTableValue {
    fn signature(&self) -> Signature {
        signature(name(self.order), 2, true)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        self.table.at(args[0], args[1], self.order)
    }

    fn derivative(&self, argument: usize) -> Option<Arc<dyn External>> {
        let order = self.order + 1;
        let table = || Arc::new(TimeTableValue { table: self.table.clone(), order }) as _;
        (argument == 0 && order <= MAX_ORDER).then(table)
    }

    fn slope(&self, argument: usize, args: &[f64]) -> f64 {
        match argument {
            0 => self.table.at(args[0], args[1], self.order + 1),
            _ => 0.0,
        }
    }

    same_if_equal!();
}

/// The time of the next event of a function of time.
#[derive(Clone, PartialEq, Debug)]
pub struct NextTimeEvent(pub Arc<TimeTable>);

impl External for NextTimeEvent {
    fn signature(&self) -> Signature {
        signature("nextTimeEvent", 1, false)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        self.0.next_stop(args[0])
    }

    same_if_equal!();
}

/// The partial derivative of orders `orders` of a function of two arguments.
#[derive(Clone, PartialEq, Debug)]
pub struct SurfaceValue {
    /// The function.
    pub surface: Arc<Surface>,
    /// (0, 0) for the function itself.
    pub orders: (u8, u8),
}

impl SurfaceValue {
    fn raised(&self, argument: usize) -> (u8, u8) {
        let (k, l) = self.orders;
        if argument == 0 { (k + 1, l) } else { (k, l + 1) }
    }
}

impl External for SurfaceValue {
    fn signature(&self) -> Signature {
        signature(name(self.orders.0.max(self.orders.1)), 2, true)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        self.surface.at(args[0], args[1], self.orders)
    }

    fn derivative(&self, argument: usize) -> Option<Arc<dyn External>> {
        let orders = self.raised(argument);
        let surface = || Arc::new(SurfaceValue { surface: self.surface.clone(), orders }) as _;
        (orders.0.max(orders.1) <= MAX_ORDER).then(surface)
    }

    fn slope(&self, argument: usize, args: &[f64]) -> f64 {
        self.surface.at(args[0], args[1], self.raised(argument))
    }

    same_if_equal!();
}

#[cfg(test)]
mod tests {
    use super::super::Extrapolation;
    use super::*;
    use crate::numeric::hermite::Smoothness;

    /// Every derivative of `f` agrees with its slopes and with central differences.
    fn check(f: &dyn External, args: &[f64]) {
        for k in 0..args.len() {
            let Some(d) = f.derivative(k) else { continue };
            let h = 1e-5;
            let moved = |by: f64| {
                let mut moved = args.to_vec();
                moved[k] += by;
                f.eval(&moved)
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((d.eval(args) - difference).abs() < 1e-6, "{f:?} by {k}");
            assert_eq!(d.eval(args), f.slope(k, args));
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (x, y) = ([0.0, 1.0, 2.0, 4.0], [0.0, 2.0, 1.0, 3.0]);
        let curve = Curve::new(&x, &y, Smoothness::Akima, Extrapolation::Hold).expect("a curve");
        let value = CurveValue { curve: Arc::new(curve), order: 0 };
        check(&value, &[1.3]);
        check(&CurveValue { order: 1, ..value.clone() }, &[1.3]);
        let third = CurveValue { order: 3, ..value };
        assert!(third.derivative(0).is_none());
    }
}
