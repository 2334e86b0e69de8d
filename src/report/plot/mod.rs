//! Plots of a run as SVG or PNG: stacked panels over a common time axis.
//!
//! Sole user of `plotters`, as a drawing surface: its charts support neither stacked panels nor
//! units. Its coordinates are integers, so one unit is a tenth of a px here.

pub mod axis;
pub mod choice;
pub mod decimate;
pub mod figure;
pub mod layout;
pub mod ticks;

use std::ffi::OsStr;
use std::path::Path;

use plotters::prelude::{
    DrawingBackend, FontDesc, FontFamily, FontStyle, RGBColor, SVGBackend, ShapeStyle, TextStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use self::axis::{Axis, PanelAxis};
use self::decimate::{PER_COLUMN, decimate, merge_straight};
use self::figure::{PlotError, PlotSpec};
use self::layout::{Layout, PanelPlace, PanelText, text_width};
use self::ticks::Ticks;
use super::raster;
use crate::io::atomic_file::write_file;
use crate::ir::trajectory::{Kind, Trajectory};

/// Pixels of a PNG per px, for high-resolution screens.
const PNG_SCALE: u32 = 2;
/// Maximum width of labels and legend entries, as a fraction of the width.
const MAX_TEXT_WIDTH: f64 = 0.75;

/// Draws `spec` to `path` atomically, as SVG or PNG by its extension.
pub fn plot(
    trajectory: &Trajectory,
    spec: &PlotSpec,
    path: impl AsRef<Path>,
) -> Result<(), PlotError> {
    write(path.as_ref(), (spec.width, spec.height), || svg(trajectory, spec))
}

/// Writes a picture of this size in px atomically, as SVG or PNG by the extension.
pub(super) fn write(
    path: &Path,
    (width, height): (u32, u32),
    svg: impl FnOnce() -> Result<String, PlotError>,
) -> Result<(), PlotError> {
    let extension = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    let bytes = match extension.as_deref() {
        Some("svg") => svg()?.into_bytes(),
        Some("png") => {
            if u64::from(width) * u64::from(height) > MAX_AREA {
                return Err(PlotError::TooLarge { width, height });
            }
            raster::png(&svg()?, PNG_SCALE).map_err(PlotError::Drawing)?
        }
        _ => return Err(PlotError::Extension { path: path.to_path_buf() }),
    };
    Ok(write_file(path, &bytes)?)
}

/// Draws the plot as SVG. Text remains text; curves are decimated to the visible resolution, so the
/// size is bounded.
pub fn svg(trajectory: &Trajectory, spec: &PlotSpec) -> Result<String, PlotError> {
    trajectory.verify()?;
    if trajectory.rows() == 0 {
        return Err(PlotError::Empty("the result has no rows"));
    }
    if spec.panels.is_empty() {
        return Err(PlotError::Empty("no variable was chosen"));
    }
    if spec.width.max(spec.height) > MAX_LENGTH {
        return Err(PlotError::TooLarge { width: spec.width, height: spec.height });
    }
    let times = Axis::of_time(&trajectory.time);
    let axes: Vec<PanelAxis<'_>> =
        spec.panels.iter().map(|p| PanelAxis::new(trajectory, p)).collect::<Result<_, _>>()?;
    let titled = !spec.title.is_empty();
    let size = (f64::from(spec.width), f64::from(spec.height));
    let mut texts: Vec<PanelText> = axes.iter().map(PanelAxis::text).collect();
    for text in texts.iter_mut().flat_map(|t| t.legend.iter_mut().chain([&mut t.axis])) {
        *text = layout::shortened(text, layout::TEXT_SIZE, MAX_TEXT_WIDTH * size.0);
    }
    let too_small = |needed: f64| PlotError::TooSmall {
        width: spec.width,
        height: spec.height,
        needed: needed as u32,
    };
    let (layout, marks) = arrange(size, titled, &axes, &texts).map_err(too_small)?;
    if layout.right - layout.left < MIN_WIDTH {
        return Err(too_small(size.1));
    }

    on_canvas((spec.width, spec.height), |canvas| {
        if titled {
            let title =
                layout::shortened(&spec.title, layout::TITLE_SIZE, layout.right - layout.left);
            canvas.text(&title, (layout.left, layout.title), &TITLE)?;
        }
        let frame = Frame { trajectory, times: &times, layout: &layout };
        let time_marks = times.time_ticks(layout.right - layout.left);
        let instants = if spec.events { frame.instants() } else { Vec::new() };
        let points = POINTS / axes.iter().map(|a| a.curves.len()).sum::<usize>();
        for ((axis, place), (marks, text)) in
            axes.iter().zip(&layout.panels).zip(marks.iter().zip(&texts))
        {
            frame.grid(canvas, axis, place, marks, &time_marks, &instants)?;
            frame.curves(canvas, axis, place, points)?;
            canvas.text(&text.axis, (layout.left, place.axis), &AXIS)?;
            frame.legend(canvas, text, place)?;
        }
        frame.time_axis(canvas, &time_marks)
    })
}

/// Calls `draw` with a white canvas of this size in px; returns the SVG.
pub(super) fn on_canvas(
    (width, height): (u32, u32),
    draw: impl FnOnce(&mut Canvas<'_>) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let mut drawing = String::new();
    let extent = (width * TENTHS as u32, height * TENTHS as u32);
    let mut canvas = Canvas { svg: SVGBackend::with_string(&mut drawing, extent) };
    canvas.background(extent)?;
    draw(&mut canvas)?;
    drop(canvas);
    // The inner drawing is in tenths of a px; the outer frame scales it.
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
         viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n{drawing}</svg>\n",
        width, height, extent.0, extent.1
    ))
}

/// Units of the drawing per px.
pub(super) const TENTHS: f64 = 10.0;
/// Maximum width and height, px.
const MAX_LENGTH: u32 = 20_000;
/// Maximum area of a PNG, px: a quarter of a gigabyte during drawing.
const MAX_AREA: u64 = 16_000_000;
/// Minimum width of the plot area, px.
const MIN_WIDTH: f64 = 150.0;
/// Maximum number of points of all curves; at about ten bytes each a plot is smaller than 300 kB.
const POINTS: usize = 20_000;
/// Average distance of event lines below which they are omitted, because they would hide the
/// curves, px.
const EVENT_SPACING: f64 = 12.0;

/// The colours of Okabe and Ito (2008), which colour-blind readers can distinguish; those that
/// differ most first, the pale yellow last.
pub(super) const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(240, 228, 66),
];
pub(super) const GRID: Stroke = Stroke { colour: RGBColor(232, 232, 232), width: 0.8 };
pub(super) const BASE: Stroke = Stroke { colour: RGBColor(140, 140, 140), width: 1.0 };
const EVENT: Stroke = Stroke { colour: RGBColor(190, 205, 222), width: 1.0 };
const CURVE_WIDTH: f64 = 1.8;
/// Vertical offset between the Boolean curves of a panel, px.
const BOOLEAN_STEP: f64 = 2.4;
/// Width of the curves when colours are reused.
const REPEATED_WIDTH: f64 = 1.0;

pub(super) const TITLE: Lettering = Lettering {
    size: layout::TITLE_SIZE,
    colour: RGBColor(26, 26, 26),
    bold: true,
    at: HPos::Left,
};
pub(super) const AXIS: Lettering = Lettering {
    size: layout::TEXT_SIZE,
    colour: RGBColor(51, 51, 51),
    bold: false,
    at: HPos::Left,
};
pub(super) const NUMBER: Lettering = Lettering {
    size: layout::NUMBER_SIZE,
    colour: RGBColor(100, 100, 100),
    bold: false,
    at: HPos::Right,
};

/// The layout and the tick marks of each vertical axis. The width of the numbers depends on the
/// heights of the panels but not vice versa, so a first layout determines the heights.
fn arrange(
    size: (f64, f64),
    titled: bool,
    axes: &[PanelAxis<'_>],
    texts: &[PanelText],
) -> Result<(Layout, Vec<Ticks>), f64> {
    let first = layout::layout(size, titled, 0.0, texts)?;
    let marks: Vec<Ticks> =
        axes.iter().zip(&first.panels).map(|(a, p)| a.ticks(p.bottom - p.top)).collect();
    let numbers = marks
        .iter()
        .flat_map(|m| &m.labels)
        .map(|label| text_width(label, layout::NUMBER_SIZE))
        .fold(0.0, f64::max);
    Ok((layout::layout(size, titled, numbers, texts)?, marks))
}

/// Common properties of all panels.
struct Frame<'a> {
    trajectory: &'a Trajectory,
    times: &'a Axis,
    layout: &'a Layout,
}

impl Frame<'_> {
    fn x(&self, time: f64) -> f64 {
        self.layout.left + self.times.part(time) * (self.layout.right - self.layout.left)
    }
    /// Position of a tick mark of the time axis.
    fn mark(&self, shown: f64) -> f64 {
        let part = self.times.part_of_shown(shown);
        self.layout.left + part * (self.layout.right - self.layout.left)
    }
    /// Positions of the event lines; none if they would hide the curves.
    fn instants(&self) -> Vec<f64> {
        let inside = 0.0..=1.0;
        let events = self.trajectory.events.iter();
        let mut places: Vec<f64> = events
            .filter(|e| inside.contains(&self.times.part(e.time)))
            .map(|e| self.x(e.time))
            .collect();
        places.dedup_by(|b, a| *b - *a < 1.0);
        let room = (self.layout.right - self.layout.left) / EVENT_SPACING;
        if places.len() as f64 > room { Vec::new() } else { places }
    }
    fn grid(
        &self,
        canvas: &mut Canvas<'_>,
        panel: &PanelAxis<'_>,
        place: &PanelPlace,
        marks: &Ticks,
        time_marks: &Ticks,
        instants: &[f64],
    ) -> Result<(), PlotError> {
        let (left, right) = (self.layout.left, self.layout.right);
        for &mark in &time_marks.values {
            let x = self.mark(mark);
            canvas.line(&[(x, place.top), (x, place.bottom)], &GRID)?;
        }
        for (&mark, label) in marks.values.iter().zip(&marks.labels) {
            let y = place.bottom - panel.axis.part_of_shown(mark) * (place.bottom - place.top);
            canvas.line(&[(left, y), (right, y)], &GRID)?;
            canvas.text(label, (left - 8.0, y), &NUMBER)?;
        }
        for &x in instants {
            canvas.line(&[(x, place.top), (x, place.bottom)], &EVENT)?;
        }
        canvas.line(&[(left, place.bottom), (right, place.bottom)], &BASE)
    }
    fn curves(
        &self,
        canvas: &mut Canvas<'_>,
        panel: &PanelAxis<'_>,
        place: &PanelPlace,
        points: usize,
    ) -> Result<(), PlotError> {
        let time = &self.trajectory.time;
        let columns =
            (points / PER_COLUMN).clamp(8, (self.layout.right - self.layout.left) as usize);
        let height = place.bottom - place.top;
        for (i, (_, values)) in panel.curves.iter().enumerate() {
            // Booleans have only two values: an offset keeps them from hiding each other.
            let beside = if panel.kind == Kind::Boolean { i as f64 * BOOLEAN_STEP } else { 0.0 };
            let kept = decimate(time, values, columns).into_iter();
            let path = merge_straight(kept.map(|row| {
                let y = place.bottom - panel.axis.part(values[row]) * height;
                tenths((self.x(time[row]), y - beside))
            }));
            canvas.path(path, &curve_stroke(i))?;
        }
        Ok(())
    }
    fn legend(
        &self,
        canvas: &mut Canvas<'_>,
        text: &PanelText,
        place: &PanelPlace,
    ) -> Result<(), PlotError> {
        for (i, (&(x, y), name)) in place.legend.iter().zip(&text.legend).enumerate() {
            canvas.line(&[(x, y), (x + layout::SWATCH, y)], &curve_stroke(i))?;
            canvas.text(name, (x + layout::SWATCH + layout::SWATCH_GAP, y), &AXIS)?;
        }
        Ok(())
    }
    fn time_axis(&self, canvas: &mut Canvas<'_>, marks: &Ticks) -> Result<(), PlotError> {
        let Some(last) = self.layout.panels.last() else { return Ok(()) };
        let centred = NUMBER.centred();
        for (&mark, label) in marks.values.iter().zip(&marks.labels) {
            let x = self.mark(mark);
            canvas.line(&[(x, last.bottom), (x, last.bottom + 4.0)], &BASE)?;
            canvas.text(label, (x, self.layout.time_numbers), &centred)?;
        }
        let text = format!("time in {}", self.times.scale.unit);
        let middle = (self.layout.left + self.layout.right) / 2.0;
        let centred = AXIS.centred();
        canvas.text(&text, (middle, self.layout.time_axis), &centred)
    }
}

/// The stroke of the curve at this position in its panel.
pub(super) fn curve_stroke(i: usize) -> Stroke {
    let width = if i < PALETTE.len() { CURVE_WIDTH } else { REPEATED_WIDTH };
    Stroke { colour: PALETTE[i % PALETTE.len()], width }
}

/// Colour and width of a line, px.
pub(super) struct Stroke {
    pub(super) colour: RGBColor,
    pub(super) width: f64,
}

/// Font size in px, colour, weight and anchor of a text.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    size: f64,
    colour: RGBColor,
    bold: bool,
    at: HPos,
}

/// The drawing surface: converts px to tenths of a px.
pub(super) struct Canvas<'a> {
    svg: SVGBackend<'a>,
}

impl Lettering {
    /// The same, anchored at its middle.
    pub(super) fn centred(self) -> Self {
        Lettering { at: HPos::Center, ..self }
    }
}

impl Canvas<'_> {
    fn background(&mut self, (width, height): (u32, u32)) -> Result<(), PlotError> {
        let corner = (width as i32, height as i32);
        self.svg.draw_rect((0, 0), corner, &RGBColor(255, 255, 255), true).map_err(undrawn)
    }
    pub(super) fn line(
        &mut self,
        points: &[(f64, f64); 2],
        stroke: &Stroke,
    ) -> Result<(), PlotError> {
        self.path(points.iter().copied().map(tenths).collect(), stroke)
    }
    pub(super) fn path(
        &mut self,
        points: Vec<(i32, i32)>,
        stroke: &Stroke,
    ) -> Result<(), PlotError> {
        let stroke_width = (stroke.width * TENTHS).round() as u32;
        let style = ShapeStyle { color: stroke.colour.into(), filled: false, stroke_width };
        self.svg.draw_path(points, &style).map_err(undrawn)
    }
    pub(super) fn text(
        &mut self,
        text: &str,
        place: (f64, f64),
        lettering: &Lettering,
    ) -> Result<(), PlotError> {
        // XML cannot represent control characters.
        let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        // `plotters` divides the given size by this.
        let size = lettering.size * TENTHS * 1.24;
        let weight = if lettering.bold { FontStyle::Bold } else { FontStyle::Normal };
        let font = FontDesc::new(FontFamily::Name(FAMILIES), size, weight);
        let style = TextStyle::from(font)
            .color(&lettering.colour)
            .pos(Pos::new(lettering.at, VPos::Center));
        self.svg.draw_text(&text, &style, tenths(place)).map_err(undrawn)
    }
}

/// The embedded typeface if it is installed or the picture is rendered to PNG, else a similar one.
const FAMILIES: &str = "Inter, Helvetica, Arial, sans-serif";

/// Coordinates of the surface.
pub(super) fn tenths((x, y): (f64, f64)) -> (i32, i32) {
    ((x * TENTHS).round() as i32, (y * TENTHS).round() as i32)
}

fn undrawn(error: impl std::fmt::Display) -> PlotError {
    PlotError::Drawing(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::figure::{Panel, panels_for};
    use super::*;
    use crate::ir::trajectory::{Column, Event};

    /// A damped oscillation of a piston that hits a stop, with `rows` rows and an event in the
    /// middle.
    fn run(rows: usize) -> Trajectory {
        let open = Column { kind: Kind::Boolean, ..Column::new("valve.open", "") };
        let columns = vec![Column::new("chamber[1,2].p", "Pa"), Column::new("piston.s", "m"), open];
        let mut run = Trajectory::new(columns);
        for i in 0..rows {
            let t = 0.12 * i as f64 / (rows - 1) as f64;
            let swing = (-20.0 * t).exp() * (900.0 * t).sin();
            let after = f64::from(i >= rows / 2);
            run.push(t, &[4e5 + 3e5 * swing, 3.5e-3 * after, after]);
        }
        run.time[rows / 2] = run.time[rows / 2 - 1];
        let time = run.time[rows / 2];
        run.events.push(Event { time, what: "stop".into(), place: String::new() });
        run
    }

    fn spec(run: &Trajectory) -> PlotSpec {
        let names: Vec<&str> = run.columns.iter().map(|c| c.name.as_str()).collect();
        PlotSpec::new("A <valve> & more", panels_for(&names, &run.columns).unwrap())
    }

    /// The points of each polyline in the colour of a first curve, without legend strokes.
    fn first_curves(svg: &str) -> Vec<Vec<(i32, i32)>> {
        let colour = "stroke=\"#0072B2\"";
        let points = |line: &str| -> Vec<(i32, i32)> {
            let list = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
            let number = |n: &str| n.parse::<i32>().unwrap();
            list.split_whitespace()
                .map(|pair| pair.split_once(',').map(|(x, y)| (number(x), number(y))).unwrap())
                .collect()
        };
        let curves = svg.lines().filter(|l| l.contains(colour)).map(points);
        curves.filter(|p| p.len() > 2).collect()
    }

    #[test]
    fn a_picture_names_curves_and_units_as_text() {
        let run = run(1201);
        let svg = svg(&run, &spec(&run)).unwrap();
        for text in [
            "A &lt;valve&gt; &amp; more",
            "chamber[1,2].p",
            "piston.s",
            "valve.open",
            "pressure in bar",
            "length in mm",
            "time in ms",
            "true",
            "120",
        ] {
            assert!(svg.contains(&format!(">\n{text}\n</text>")), "{text}");
        }
        assert!(svg.starts_with("<svg ") && svg.contains("width=\"960\" height=\"680\""));
        assert!(raster::png(&svg, 1).is_ok(), "well-formed");
    }

    #[test]
    fn a_long_run_makes_a_small_picture_with_its_peaks() {
        let long = run(400_001);
        let thin = svg(&long, &spec(&long)).unwrap();
        assert!(thin.len() < 300_000, "{}", thin.len());
        let full = run(2001);
        let full = svg(&full, &spec(&full)).unwrap();
        let heights = |svg: &str| {
            let pressure = first_curves(svg).swap_remove(0);
            (pressure.iter().map(|p| p.1).min(), pressure.iter().map(|p| p.1).max())
        };
        assert_eq!(heights(&thin), heights(&full));
        // Noise and many curves are the worst case.
        let columns = (0..400).map(|i| Column::new(format!("a[{i}]"), "V")).collect();
        let mut noise = Trajectory::new(columns);
        let mut row = vec![0.0; 400];
        for i in 0..3000_u32 {
            for (k, cell) in row.iter_mut().enumerate() {
                *cell = f64::from((i * 7919 + k as u32 * 104_729) % 1009);
            }
            noise.push(f64::from(i), &row);
        }
        let crowded = PlotSpec { height: 2400, ..spec(&noise) };
        let svg = svg(&noise, &crowded).unwrap();
        let legend = 400 * 500;
        assert!(svg.len() < 300_000 + legend, "{}", svg.len());
    }

    #[test]
    fn a_jump_is_vertical() {
        let run = run(1201);
        let stroke = first_curves(&svg(&run, &spec(&run)).unwrap()).swap_remove(1);
        let [start, before, after, end] = stroke[..] else { panic!("{stroke:?}") };
        assert_eq!((start.1, before.0, after.1), (before.1, after.0, end.1));
        assert!(after.1 < before.1, "upwards");
    }

    #[test]
    fn event_lines_are_drawn_on_request_and_never_too_many() {
        let mut run = run(1201);
        let lines = |run: &Trajectory, events| {
            let spec = PlotSpec { events, ..spec(run) };
            svg(run, &spec).unwrap().matches("#BECDDE").count()
        };
        assert_eq!(lines(&run, false), 0);
        assert_eq!(lines(&run, true), 3, "one in each panel");
        run.events = (0..1000)
            .map(|i| Event {
                time: 1.2e-4 * f64::from(i),
                what: String::new(),
                place: String::new(),
            })
            .collect();
        assert_eq!(lines(&run, true), 0);
    }

    #[test]
    fn files_are_chosen_by_extension() {
        let folder = std::env::temp_dir().join(format!("mocc-plot-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = |file: &str| folder.join(file);
        let run = run(100);
        let spec = PlotSpec { width: 500, height: 400, ..spec(&run) };
        plot(&run, &spec, path("a.PNG")).unwrap();
        plot(&run, &spec, path("a.svg")).unwrap();
        let png = std::fs::read(path("a.PNG")).unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        assert_eq!((side(16), side(20)), (500 * PNG_SCALE, 400 * PNG_SCALE));
        let error = plot(&run, &spec, path("a.jpg")).unwrap_err().to_string();
        assert!(error.ends_with("a.jpg: a picture's name ends in .svg or .png"), "{error}");
        let large = PlotSpec { width: 5000, height: 5000, ..spec };
        let error = plot(&run, &large, path("b.png")).unwrap_err().to_string();
        assert_eq!(error, "5000 x 5000 px is too large for a picture");
        let files = std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name());
        let mut files: Vec<_> = files.collect();
        files.sort();
        assert_eq!(files, ["a.PNG", "a.svg"]);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let run = run(100);
        let panel = |names: &[&str]| Panel {
            curves: names.iter().map(|&n| n.into()).collect(),
            label: String::new(),
        };
        let message = |panels: Vec<Panel>| {
            svg(&run, &PlotSpec::new("", panels)).map(|_| ()).unwrap_err().to_string()
        };
        assert_eq!(
            message(vec![panel(&["piston.s", "chamber[1, 2].p"])]),
            "`piston.s` in m and `chamber[1,2].p` in Pa cannot share one axis"
        );
        assert_eq!(
            message(vec![panel(&["piston.v"])]),
            "there is no variable `piston.v` in the result; did you mean `piston.s`?"
        );
        assert_eq!(message(vec![]), "nothing to plot: no variable was chosen");
        assert_eq!(message(vec![panel(&[])]), "nothing to plot: a panel has no curves");
        let small = PlotSpec { height: 100, ..spec(&run) };
        let error = svg(&run, &small).unwrap_err();
        let PlotError::TooSmall { needed, .. } = error else { panic!("{error}") };
        assert!(svg(&run, &PlotSpec { height: needed, ..small.clone() }).is_ok());
        let narrow = PlotSpec { width: 150, ..spec(&run) };
        assert!(matches!(svg(&run, &narrow), Err(PlotError::TooSmall { .. })));
        let large = PlotSpec { height: u32::MAX, ..spec(&run) };
        assert!(matches!(svg(&run, &large), Err(PlotError::TooLarge { .. })));
        let empty = Trajectory::new(run.columns.clone());
        let error = svg(&empty, &small).unwrap_err().to_string();
        assert_eq!(error, "nothing to plot: the result has no rows");
    }

    #[test]
    fn constants_and_single_instants_have_pictures() {
        let mut still = Trajectory::new(vec![Column::new("p", "Pa"), Column::new("z", "m")]);
        still.push(0.0, &[101_325.0, 0.0]);
        assert!(svg(&still, &spec(&still)).is_ok());
        still.push(1.0, &[101_325.0, 0.0]);
        assert!(svg(&still, &spec(&still)).unwrap().contains("pressure in bar"));
    }
}
