//! A figure of curves whose panels are known beforehand, as data for the script of charts.

use super::columns::Arrays;
use super::frame::embedded;
use crate::io::json::Json;
use crate::report::scale;

/// How a curve is drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stroke {
    /// A line.
    Line,
    /// Dots, for measurements.
    Points,
}

/// A curve; SI units.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Abscissae, not decreasing.
    pub x: Vec<f64>,
    /// Ordinates; NaN where there is none.
    pub y: Vec<f64>,
    /// Line or dots.
    pub stroke: Stroke,
    /// Position in the list of colours.
    pub colour: usize,
}

/// Curves over one vertical axis.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The label of its axis.
    pub label: String,
    /// SI unit.
    pub unit: String,
    /// Display unit of the model, if any.
    pub display_unit: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Height of the area of its curves, px; a default if not given.
    pub height: Option<u32>,
}

/// The element of a figure over time, found by the script by its class. `id` is unique in the page.
pub fn figure(id: &str, panels: &[Panel]) -> String {
    figure_over(id, ("time", "s"), panels)
}

/// The same over another abscissa, given by its name and SI unit.
pub fn figure_over(id: &str, (abscissa, unit): (&str, &str), panels: &[Panel]) -> String {
    let mut arrays = Arrays::default();
    let mut known: Vec<(&[f64], usize)> = Vec::new();
    let xs = panels.iter().flat_map(|p| p.curves.iter().flat_map(|c| &c.x));
    let longest = xs.fold(0.0_f64, |a, x| a.max(x.abs()));
    let time = scale::choose(unit, "", longest);
    let mut list = Vec::new();
    for panel in panels {
        let values = panel.curves.iter().flat_map(|c| &c.y).filter(|y| y.is_finite());
        let largest = values.fold(0.0_f64, |a, y| a.max(y.abs()));
        let scale = scale::choose(&panel.unit, &panel.display_unit, largest);
        let mut curves = Vec::new();
        for c in &panel.curves {
            let x = match known.iter().find(|(x, _)| *x == c.x.as_slice()) {
                Some((_, k)) => *k,
                None => {
                    let k = arrays.doubles(&c.x);
                    known.push((&c.x, k));
                    k
                }
            };
            curves.push(Json::object([
                ("name", Json::text(c.name.as_str())),
                ("x", Json::count(x)),
                ("y", Json::count(arrays.singles(&c.y))),
                ("points", Json::flag(c.stroke == Stroke::Points)),
                ("colour", Json::count(c.colour)),
            ]));
        }
        let mut members = vec![
            ("label", Json::text(panel.label.as_str())),
            ("scale", scale_of(&scale)),
            ("curves", Json::list(curves)),
        ];
        if let Some(height) = panel.height {
            members.push(("height", Json::count(height as usize)));
        }
        list.push(Json::object(members));
    }
    let spec = Json::object([
        ("time", scale_of(&time)),
        ("abscissa", Json::text(abscissa)),
        ("arrays", arrays.json()),
        ("panels", Json::list(list)),
    ]);
    let data = format!("{id}-data");
    format!(
        "<div class=\"figure\" id=\"{id}\" data-figure=\"{data}\"></div>\n{}",
        embedded(&data, &spec)
    )
}

/// A scale as the scripts know it.
pub fn scale_of(scale: &scale::Scale) -> Json {
    Json::object([
        ("size", Json::number(scale.size)),
        ("zero", Json::number(scale.zero)),
        ("unit", Json::text(scale.unit.as_str())),
    ])
}
