//! Axes: chooses unit, range and tick marks for the curves.

use super::figure::{Panel, PlotError, find};
use super::layout::PanelText;
use super::ticks::{Ticks, ticks};
use crate::ir::trajectory::{Column, Kind, Trajectory};
use crate::report::scale::{self, Scale};

/// A range in display units.
pub struct Axis {
    /// Conversion from SI to the display unit.
    pub scale: Scale,
    /// Lower end in display units.
    pub low: f64,
    /// Upper end in display units.
    pub high: f64,
}

impl Axis {
    /// The time axis from the first to the last time, s; from 0 to 0 without rows.
    pub fn of_time(time: &[f64]) -> Self {
        let (first, last) =
            (time.first().copied().unwrap_or(0.0), time.last().copied().unwrap_or(0.0));
        let scale = scale::choose("s", "", first.abs().max(last.abs()));
        let (low, high) = widened(scale.shown(first), scale.shown(last));
        Axis { scale, low, high }
    }
    /// The relative position of an SI value between the ends.
    pub fn part(&self, si: f64) -> f64 {
        self.part_of_shown(self.scale.shown(si))
    }
    /// The relative position of a displayed value between the ends.
    pub fn part_of_shown(&self, shown: f64) -> f64 {
        (shown - self.low) / (self.high - self.low)
    }
    /// Tick marks of a time axis of this length, px.
    pub fn time_ticks(&self, length: f64) -> Ticks {
        ticks(self.low, self.high, (length / TIME_SPACING) as usize)
    }
}

/// The vertical axis of a panel and its curves.
pub struct PanelAxis<'a> {
    /// The range.
    pub axis: Axis,
    /// Boolean or Integer if all curves are, otherwise continuous.
    pub kind: Kind,
    /// The quantity; may be empty.
    pub label: &'a str,
    /// Names and SI values.
    pub curves: Vec<(&'a str, &'a [f64])>,
}

impl<'a> PanelAxis<'a> {
    /// Chooses the unit and range for the curves of `panel`.
    pub fn new(trajectory: &'a Trajectory, panel: &'a Panel) -> Result<Self, PlotError> {
        let columns = &trajectory.columns;
        let chosen: Vec<&Column> =
            panel.curves.iter().map(|n| find(n, columns)).collect::<Result<_, _>>()?;
        let first = *chosen.first().ok_or(PlotError::Empty("a panel has no curves"))?;
        if let Some(other) = chosen.iter().find(|c| c.unit != first.unit) {
            let named = |c: &Column| (c.name.clone(), c.unit.clone());
            return Err(PlotError::MixedUnits { first: named(first), second: named(other) });
        }
        let curves: Vec<(&str, &[f64])> = chosen
            .iter()
            .filter_map(|c| Some((c.name.as_str(), trajectory.values(&c.name)?)))
            .collect();
        let values = || curves.iter().flat_map(|(_, values)| values.iter().copied());
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        // If the curves have different display units, choose one by the numbers.
        let agreed = chosen.iter().all(|c| c.display_unit == first.display_unit);
        let declared = if agreed { first.display_unit.as_str() } else { "" };
        let scale = scale::choose(&first.unit, declared, low.abs().max(high.abs()));
        let all = |kind| chosen.iter().all(|c| c.kind == kind);
        let kind = if all(Kind::Boolean) {
            Kind::Boolean
        } else if all(Kind::Integer) {
            Kind::Integer
        } else {
            Kind::Continuous
        };
        let (low, high) = match kind {
            Kind::Boolean => (0.0, 1.0),
            _ => widened(scale.shown(low), scale.shown(high)),
        };
        let room = (high - low) * if kind == Kind::Boolean { 3.0 * ROOM } else { ROOM };
        let axis = Axis { scale, low: low - room, high: high + room };
        Ok(PanelAxis { axis, kind, label: &panel.label, curves })
    }
    /// The label of the panel.
    pub fn text(&self) -> PanelText {
        let axis = match (self.label, self.axis.scale.unit.as_str()) {
            ("", "") => if self.kind == Kind::Boolean { "state" } else { "value" }.to_owned(),
            ("", unit) => format!("in {unit}"),
            (label, "") => label.to_owned(),
            (label, unit) => format!("{label} in {unit}"),
        };
        PanelText {
            axis,
            legend: self.curves.iter().map(|(name, _)| (*name).to_owned()).collect(),
            low: self.kind == Kind::Boolean,
        }
    }
    /// Tick marks of an axis of this height, px.
    pub fn ticks(&self, height: f64) -> Ticks {
        match self.kind {
            Kind::Boolean => Ticks {
                values: vec![0.0, 1.0],
                labels: vec!["false".to_owned(), "true".to_owned()],
            },
            Kind::Integer => {
                let wanted = (height / VALUE_SPACING).min(self.axis.high - self.axis.low);
                ticks(self.axis.low, self.axis.high, wanted as usize)
            }
            _ => ticks(self.axis.low, self.axis.high, (height / VALUE_SPACING) as usize),
        }
    }
}

/// Bounds with a positive extent, also for a constant; variation of the size of solver errors is
/// ignored.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let largest = low.abs().max(high.abs());
    if high - low > 1e-9 * largest {
        (low, high)
    } else if largest == 0.0 {
        (-1.0, 1.0)
    } else {
        (low - 0.1 * largest, high + 0.1 * largest)
    }
}

/// Approximate distance of tick marks of the time axis, px.
const TIME_SPACING: f64 = 90.0;
/// Approximate distance of tick marks of a vertical axis, px.
const VALUE_SPACING: f64 = 36.0;
/// Padding above and below the curves, as a fraction of their extent.
const ROOM: f64 = 0.06;

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(columns: Vec<Column>, rows: &[&[f64]]) -> (String, f64, f64) {
        let panel = Panel {
            curves: columns.iter().map(|c| c.name.clone()).collect(),
            label: scale::quantity(&columns[0].unit).to_owned(),
        };
        let mut run = Trajectory::new(columns);
        for (i, row) in rows.iter().enumerate() {
            run.push(i as f64, row);
        }
        let axis = PanelAxis::new(&run, &panel).unwrap();
        (axis.text().axis, axis.axis.low, axis.axis.high)
    }

    #[test]
    fn unit_and_range_hold_all_curves() {
        let declared = |name: &str, display_unit: &str| Column {
            display_unit: display_unit.into(),
            ..Column::new(name, "Pa")
        };
        let rows: [&[f64]; 2] = [&[1e5, 2e5], &[4e5, 6e5]];
        let (text, low, high) = axis(vec![declared("a", ""), declared("b", "")], &rows);
        assert_eq!(text, "pressure in bar");
        assert!((low - 0.7).abs() < 1e-12 && (high - 6.3).abs() < 1e-12, "5 bar and 6 % of it");
        let text = |a, b| axis(vec![declared("a", a), declared("b", b)], &rows).0;
        assert_eq!(text("kPa", "kPa"), "pressure in kPa");
        assert_eq!(text("kPa", "mbar"), "pressure in bar");
        assert_eq!(axis(vec![Column::new("x", "")], &[&[1.0]]).0, "value");
        assert_eq!(axis(vec![Column::new("x", "J/kg")], &[&[1.0]]).0, "in J/kg");
    }

    #[test]
    fn a_constant_stands_in_the_middle() {
        let (_, low, high) = axis(vec![Column::new("p", "Pa")], &[&[1e5], &[1e5 + 1e-6]]);
        assert!((low + high - 2.0).abs() < 1e-9 && high - low > 0.2);
        assert_eq!(widened(0.0, 0.0), (-1.0, 1.0));
    }
}
