//! Charts of tables as SVG or PNG: curves over any column, several runs in one panel, and groups of
//! runs side by side with common axes, such as measurements and simulations.

use std::path::Path;

use super::plot::figure::PlotError;
use super::plot::layout::{NUMBER_SIZE, SWATCH, SWATCH_GAP, TEXT_SIZE, shortened, text_width};
use super::plot::ticks::{Ticks, decades, ticks};
use super::plot::{
    AXIS, BASE, Canvas, GRID, NUMBER, TITLE, curve_stroke, on_canvas, tenths, write,
};

/// A chart.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// Groups from left to right, with common axes.
    pub groups: Vec<Group>,
    /// Labels of the vertical axes with units, from top to bottom.
    pub panels: Vec<String>,
    /// Label of the horizontal axis with unit.
    pub across: String,
    /// The horizontal axis is logarithmic; points at nonpositive positions are omitted.
    pub logarithmic: bool,
}

/// A group of curves.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Group {
    /// Heading.
    pub heading: String,
    /// The runs, each with the same colour in all panels.
    pub series: Vec<Series>,
}

/// One run.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Series {
    /// Legend entry.
    pub label: String,
    /// Positions on the horizontal axis.
    pub x: Vec<f64>,
    /// For each panel the values at these positions, if the run has any; NaN for missing values.
    pub y: Vec<Option<Vec<f64>>>,
}

const WIDTH: u32 = 960;
const MARGIN: f64 = 20.0;
const HEAD: f64 = 40.0;
const LINE: f64 = 19.0;
const PANEL: f64 = 170.0;
const FOOT: f64 = 48.0;
const GAP: f64 = 26.0;
/// Padding above and below the curves, as a fraction of their extent.
const ROOM: f64 = 0.05;
/// Maximum number of points that are marked on a curve.
const MAX_MARKED_POINTS: usize = 40;
/// Half the width of a marked point.
const POINT: f64 = 2.2;

/// Draws a chart to `path` atomically.
pub fn chart(chart: &Chart, path: &Path) -> Result<(), PlotError> {
    let size = (WIDTH, chart.height());
    write(path, size, || on_canvas(size, |canvas| Drawing::new(chart)?.draw(canvas)))
}

/// Draws a chart as SVG.
pub fn svg(chart: &Chart) -> Result<String, PlotError> {
    on_canvas((WIDTH, chart.height()), |canvas| Drawing::new(chart)?.draw(canvas))
}

impl Chart {
    fn height(&self) -> u32 {
        let panels = self.panels.len() as f64 * (PANEL + LINE + 14.0);
        (HEAD + self.head() + panels + FOOT) as u32
    }

    /// Height of headings and legends, px.
    fn head(&self) -> f64 {
        let lines = self.groups.iter().map(|g| legend(g, self.width_of_group()).1).max();
        LINE * (self.headings() + lines.unwrap_or(0) as f64) + 8.0
    }

    /// Number of lines for headings.
    fn headings(&self) -> f64 {
        if self.groups.iter().any(|g| !g.heading.is_empty()) { 1.0 } else { 0.0 }
    }

    fn width_of_group(&self) -> f64 {
        let n = self.groups.len().max(1) as f64;
        (f64::from(WIDTH) - 2.0 * MARGIN - 44.0 - GAP * (n - 1.0)) / n
    }

    fn place(&self, x: f64) -> f64 {
        if self.logarithmic { x.log10() } else { x }
    }
}

/// Positions of the legend entries from the left end (x, line), and the number of lines.
fn legend(group: &Group, width: f64) -> (Vec<(f64, usize)>, usize) {
    let (mut x, mut line) = (0.0, 0);
    let mut places = Vec::new();
    if group.series.len() < 2 && group.series.iter().all(|s| s.label.is_empty()) {
        return (places, 0);
    }
    for series in &group.series {
        let needed = SWATCH + SWATCH_GAP + text_width(&series.label, TEXT_SIZE);
        if x > 0.0 && x + needed > width {
            (x, line) = (0.0, line + 1);
        }
        places.push((x, line));
        x += needed + 16.0;
    }
    (places, line + 1)
}

struct Drawing<'a> {
    chart: &'a Chart,
    /// Range of the horizontal axis, in drawn coordinates.
    across: (f64, f64),
    /// Ranges of the vertical axes.
    up: Vec<(f64, f64)>,
}

impl<'a> Drawing<'a> {
    fn new(chart: &'a Chart) -> Result<Self, PlotError> {
        let all = || chart.groups.iter().flat_map(|g| &g.series);
        let finite = |x: &f64| x.is_finite();
        let places = all().flat_map(|s| s.x.iter().map(|x| chart.place(*x)));
        let across = ends(places.filter(finite))
            .ok_or(PlotError::Empty("no table has the columns of the horizontal axis"))?;
        let mut up = Vec::new();
        for panel in 0..chart.panels.len() {
            // Ignore points outside of the horizontal axis.
            let of = |s: &'a Series| {
                let places = s.x.iter().map(|x| chart.place(*x));
                places.zip(s.y[panel].iter().flatten()).filter(|(x, _)| x.is_finite())
            };
            let values = all().flat_map(of).map(|(_, y)| *y);
            let (low, high) = ends(values.filter(finite))
                .ok_or(PlotError::Empty("no table has the columns of a panel"))?;
            let room = ROOM * (high - low);
            up.push((low - room, high + room));
        }
        if up.is_empty() {
            return Err(PlotError::Empty("no panel was chosen"));
        }
        Ok(Drawing { chart, across, up })
    }

    fn draw(&self, canvas: &mut Canvas<'_>) -> Result<(), PlotError> {
        let chart = self.chart;
        let width = chart.width_of_group();
        let room = f64::from(WIDTH) - 2.0 * MARGIN;
        canvas.text(&shortened(&chart.title, 17.0, room), (MARGIN, 24.0), &TITLE)?;
        for (g, group) in chart.groups.iter().enumerate() {
            let left = MARGIN + 44.0 + g as f64 * (width + GAP);
            canvas.text(&group.heading, (left, HEAD + 8.0), &AXIS)?;
            for (k, (x, line)) in legend(group, width).0.into_iter().enumerate() {
                let (x, y) = (left + x, HEAD + 8.0 + LINE * (chart.headings() + line as f64));
                canvas.line(&[(x, y), (x + SWATCH, y)], &curve_stroke(k))?;
                canvas.text(&group.series[k].label, (x + SWATCH + SWATCH_GAP, y), &AXIS)?;
            }
            for panel in 0..chart.panels.len() {
                self.panel(canvas, group, panel, (left, left + width), g == 0)?;
            }
            let bottom = f64::from(chart.height()) - FOOT;
            let middle = left + width / 2.0;
            canvas.text(&chart.across, (middle, bottom + 33.0), &AXIS.centred())?;
        }
        Ok(())
    }

    fn panel(
        &self,
        canvas: &mut Canvas<'_>,
        group: &Group,
        panel: usize,
        (left, right): (f64, f64),
        first: bool,
    ) -> Result<(), PlotError> {
        let chart = self.chart;
        let top = HEAD + chart.head() + panel as f64 * (PANEL + LINE + 14.0) + LINE;
        let bottom = top + PANEL;
        let (x_low, x_high) = self.across;
        let (y_low, y_high) = self.up[panel];
        let x_of = |x: f64| left + (x - x_low) / (x_high - x_low) * (right - left);
        let y_of = |y: f64| bottom - (y - y_low) / (y_high - y_low) * (bottom - top);
        canvas.text(&chart.panels[panel], (left, top - LINE / 2.0), &AXIS)?;
        let marks: Ticks = if chart.logarithmic {
            decades(x_low, x_high)
        } else {
            ticks(x_low, x_high, ((right - left) / 80.0) as usize)
        };
        for (mark, label) in marks.values.iter().zip(&marks.labels) {
            canvas.line(&[(x_of(*mark), top), (x_of(*mark), bottom)], &GRID)?;
            if panel + 1 == chart.panels.len() {
                canvas.text(label, (x_of(*mark), bottom + 14.0), &NUMBER.centred())?;
            }
        }
        let marks = ticks(y_low, y_high, (PANEL / 34.0) as usize);
        for (mark, label) in marks.values.iter().zip(&marks.labels) {
            canvas.line(&[(left, y_of(*mark)), (right, y_of(*mark))], &GRID)?;
            if first {
                let label = shortened(label, NUMBER_SIZE, 54.0);
                canvas.text(&label, (left - 6.0, y_of(*mark)), &NUMBER)?;
            }
        }
        canvas.line(&[(left, bottom), (right, bottom)], &BASE)?;
        for (k, series) in group.series.iter().enumerate() {
            let Some(y) = &series.y[panel] else { continue };
            let points = series.x.iter().map(|x| chart.place(*x)).zip(y.iter().copied());
            let points: Vec<(f64, f64)> = points
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .map(|(x, y)| (x_of(x), y_of(y)))
                .collect();
            if points.len() <= MAX_MARKED_POINTS {
                for (x, y) in &points {
                    let mut stroke = curve_stroke(k);
                    stroke.width = 2.0 * POINT;
                    canvas.line(&[(x - POINT, *y), (x + POINT, *y)], &stroke)?;
                }
            }
            canvas.path(thinned(&points), &curve_stroke(k))?;
        }
        Ok(())
    }
}

/// Minimum and maximum; for a constant, the range from zero.
fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let size = low.abs().max(high.abs());
    match high - low {
        extent if extent > 1e-9 * size => Some((low, high)),
        extent if extent >= 0.0 && size > 0.0 => Some((low.min(0.0), high.max(0.0))),
        extent if extent >= 0.0 => Some((-1.0, 1.0)),
        _ => None,
    }
}

/// Simplifies a curve: drops points that are visually on the line through their neighbours.
///
/// U. Ramer 1972, D. H. Douglas and T. K. Peucker 1973.
fn thinned(points: &[(f64, f64)]) -> Vec<(i32, i32)> {
    /// Invisible distance, px.
    const UNSEEN: f64 = 0.15;
    let mut kept = vec![false; points.len()];
    let mut open = vec![(0, points.len().saturating_sub(1))];
    while let Some((a, b)) = open.pop() {
        let (Some(from), Some(to)) = (points.get(a), points.get(b)) else { continue };
        (kept[a], kept[b]) = (true, true);
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        let distance = |p: &(f64, f64)| {
            let (px, py) = (p.0 - from.0, p.1 - from.1);
            // A closed curve starts and ends at the same point.
            let along = if length > 0.0 { (px * dx + py * dy) / (length * length) } else { 0.0 };
            let along = along.clamp(0.0, 1.0);
            (px - along * dx).hypot(py - along * dy)
        };
        let inner = (a + 1..b).map(|i| (i, distance(&points[i])));
        let far = inner.max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((i, d)) = far
            && d > UNSEEN
        {
            open.push((a, i));
            open.push((i, b));
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| tenths(*p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_groups() -> Chart {
        let series = |label: &str, factor: f64| Series {
            label: label.into(),
            x: (0..200).map(|i| f64::from(i) / 10.0).collect(),
            y: vec![Some((0..200).map(|i| factor * (f64::from(i) / 10.0).sin()).collect()), None],
        };
        let mut other = series("b", 2.0);
        other.y[1] = Some(vec![f64::NAN; 199].into_iter().chain([1.0]).collect());
        let group = |heading: &str, series| Group { heading: heading.into(), series };
        Chart {
            title: "Two <groups>".into(),
            groups: vec![group("measured", vec![series("a", 1.0)]), group("model", vec![other])],
            panels: vec!["stroke in mm".into(), "force in N".into()],
            across: "time in ms".into(),
            logarithmic: false,
        }
    }

    #[test]
    fn groups_share_their_axes() {
        let chart = two_groups();
        let drawing = Drawing::new(&chart).unwrap();
        assert_eq!(drawing.across, (0.0, 19.9));
        let (low, high) = drawing.up[0];
        assert!(low < -1.99 && high > 1.99);
        let svg = on_canvas((WIDTH, chart.height()), |c| drawing.draw(c)).unwrap();
        for text in ["Two &lt;groups&gt;", "measured", "model", "stroke in mm", "time in ms"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn a_logarithmic_axis_has_decades() {
        let mut chart = two_groups();
        chart.logarithmic = true;
        let drawing = Drawing::new(&chart).unwrap();
        assert!((drawing.across.0 + 1.0).abs() < 1e-12, "the place 0 is left out");
        let marks = decades(-1.0, 5.3);
        assert_eq!(marks.labels, ["0.1", "1", "10", "100", "1000", "10000", "10⁵"]);
    }

    #[test]
    fn empty_charts_are_errors() {
        let mut chart = two_groups();
        chart.groups[1].series.clear();
        assert!(matches!(Drawing::new(&chart), Err(PlotError::Empty(_))));
    }

    #[test]
    fn straight_segments_keep_two_points_and_corners_remain() {
        let points: Vec<(f64, f64)> = (0..100)
            .map(|i| (f64::from(i), if i < 50 { 0.0 } else { f64::from(i - 49) }))
            .collect();
        assert_eq!(thinned(&points), [(0, 0), (490, 0), (990, 500)]);
        assert!(thinned(&[]).is_empty());
    }
}
