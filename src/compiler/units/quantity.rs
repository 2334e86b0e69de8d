//! What is known about the unit of an expression.

use super::dimension::Dimension;
use super::unit::{Scale, Unit};

/// A unit, declared or inferred.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Quantity {
    /// The unit.
    pub unit: Unit,
    /// Some variable that it follows from has a declared unit. A model that declares none is not
    /// compared with `time`.
    pub is_declared: bool,
}

/// How two quantities differ.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Difference {
    /// They measure different things.
    Dimension,
    /// They measure the same thing in units of different size or zero.
    Scale,
}

impl Quantity {
    /// A number.
    pub const NUMBER: Quantity = Quantity { unit: Unit::ONE, is_declared: false };
    /// The time.
    pub const TIME: Quantity = Quantity { unit: Unit::si(Dimension::TIME), is_declared: false };

    /// A quantity with a declared unit.
    pub fn declared(unit: Unit) -> Quantity {
        Quantity { unit, is_declared: true }
    }

    fn with(self, unit: Unit, other: Quantity) -> Quantity {
        Quantity { unit, is_declared: self.is_declared || other.is_declared }
    }

    /// The product of two quantities.
    pub fn times(self, other: Quantity) -> Quantity {
        self.with(self.unit.times(other.unit), other)
    }

    /// The quotient of two quantities.
    pub fn over(self, other: Quantity) -> Quantity {
        self.with(self.unit.over(other.unit), other)
    }

    /// A power.
    pub fn power(self, exponent: f64) -> Option<Quantity> {
        Some(Quantity { unit: self.unit.power(exponent)?, ..self })
    }

    /// The same dimension in an unknown scale.
    pub fn of_any_scale(self) -> Quantity {
        Quantity { unit: Unit { scale: None, ..self.unit }, ..self }
    }

    /// The quantity times a literal, which may convert it to another unit.
    pub fn scaled_by(self, literal: f64) -> Quantity {
        let is_conversion = !keeps_scale(literal) || self.zero() != 0.0;
        if is_conversion { self.of_any_scale() } else { self }
    }

    /// The sum or difference of two quantities of one dimension.
    pub fn plus(self, other: Quantity, is_difference: bool) -> Quantity {
        let scale = match (self.unit.scale, other.unit.scale) {
            // The difference of two temperatures in degC is in K.
            (Some(a), Some(b)) if is_difference && a.is_same(b) => Some(Scale { offset: 0.0, ..a }),
            (Some(a), Some(b)) => Some(if a.offset != 0.0 { a } else { b }),
            _ => None,
        };
        let kind = if self.unit.kind == other.unit.kind { self.unit.kind } else { None };
        self.with(Unit { scale, kind, ..self.unit }, other)
    }

    /// The quantity plus a literal, which may convert degC to K.
    pub fn shifted_by(self, literal: f64) -> Quantity {
        let is_zero_point = [273.15, 459.67, 32.0].contains(&literal.abs());
        let is_temperature = self.unit.dimension == Dimension::TEMPERATURE;
        if is_temperature && is_zero_point { self.of_any_scale() } else { self }
    }

    /// The unit that the terms of a sum must have. It is unknown whether a temperature is a
    /// difference.
    pub fn of_terms(self) -> Quantity {
        if self.unit.dimension == Dimension::TEMPERATURE { self.of_any_scale() } else { self }
    }

    /// How the two differ when they are compared or equated; `None` if they agree, as far as is
    /// known.
    pub fn difference(self, other: Quantity) -> Option<Difference> {
        self.compared(other, Scale::is_same)
    }

    /// How the two differ when they are added: a temperature difference may be added to a
    /// temperature in degC.
    pub fn difference_in_sum(self, other: Quantity) -> Option<Difference> {
        let absolute = [self, other].iter().filter(|q| q.zero() != 0.0).count();
        self.compared(other, if absolute == 1 { Scale::is_of_size } else { Scale::is_same })
    }

    fn compared(self, other: Quantity, is_same: fn(Scale, Scale) -> bool) -> Option<Difference> {
        let (a, b) = (self.unit, other.unit);
        if !self.is_declared && !other.is_declared {
            return None;
        }
        let other_kind = a.kind.is_some() && b.kind.is_some() && a.kind != b.kind;
        if a.dimension != b.dimension || other_kind {
            return Some(Difference::Dimension);
        }
        let scales = a.scale.zip(b.scale);
        scales.filter(|(a, b)| !is_same(*a, *b)).map(|_| Difference::Scale)
    }

    /// True unless it is a number in the unit 1, as far as is known.
    pub fn is_not_a_number(self) -> bool {
        self.is_declared && self.compared(Quantity::NUMBER, Scale::is_same).is_some()
    }

    fn zero(self) -> f64 {
        self.unit.scale.map_or(0.0, |s| s.offset)
    }
}

/// True for factors that occur in laws; others, such as 1000, 60 or pi/180, may convert units.
fn keeps_scale(factor: f64) -> bool {
    let is_whole = |x: f64| x.fract() == 0.0;
    let size = factor.abs();
    size <= 8.0 && (is_whole(4.0 * size) || is_whole(1.0 / size))
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let factor = self.unit.scale.map_or(1.0, |s| s.factor);
        match ((factor - 1.0).abs() > 1e-9, self.unit.dimension == Dimension::ONE) {
            (false, _) => self.unit.dimension.fmt(f),
            (true, true) => factor.fmt(f),
            (true, false) => write!(f, "{factor} {}", self.unit.dimension),
        }
    }
}
