//! Draws the incidence matrix of a model in block lower triangular form as SVG.
//!
//! Rows are equations, columns are unknowns, both in the order of solution; a mark means that the
//! equation reads the unknown. Blocks are on the diagonal, and there are no marks above them: I. S.
//! Duff, A. M. Erisman, J. K. Reid, *Direct Methods for Sparse Matrices*, 2nd ed. 2017, chapter 6.
//! Within a block the tearing variables come last, so that their border is right and below.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::plot::layout::{shortened, text_width};
use super::raster::FAMILY;
use crate::ir::diagram::{Diagram, DiagramBlock, SolutionMethod};

/// Size of a cell in a small system, and maximum size of the matrix, px.
const CELL: f64 = 18.0;
const MAX_SIZE: f64 = 1600.0;
/// Number of rows or columns between two guide lines.
const GUIDE: usize = 5;
/// Maximum number of rows for which equations are printed next to the matrix.
const MAX_EQUATIONS: usize = 60;
/// Line height and font size of names, px.
const LINE: f64 = 12.5;
const TEXT: f64 = 11.0;
const TITLE: f64 = 17.0;
/// Maximum width of names and equations, px.
const MAX_NAME_WIDTH: f64 = 190.0;
const MAX_EQUATION_WIDTH: f64 = 420.0;
const MARGIN: f64 = 20.0;
const GAP: f64 = 8.0;
const HEAD: f64 = 66.0;
/// Angle of the names above the matrix, degrees.
const LEAN: f64 = 55.0;

const INK: &str = "#333333";
const READ: &str = "#8a8f96";
const TORN: &str = "#b3003c";

/// Colours of a solution method: area and diagonal of its blocks.
fn colours(method: SolutionMethod) -> (&'static str, &'static str) {
    match method {
        SolutionMethod::Explicit => ("#f2f2f2", "#5b6470"),
        SolutionMethod::Linear => ("#cfe3f2", "#0072b2"),
        SolutionMethod::Nonlinear => ("#f8dcc6", "#d55e00"),
        SolutionMethod::Mixed => ("#cdebe1", "#009e73"),
    }
}

/// Draws the picture.
pub fn svg(diagram: &Diagram) -> String {
    let picture = Picture::of(diagram);
    let mut out = String::new();
    picture.head(&mut out);
    picture.areas(&mut out);
    picture.marks(&mut out);
    picture.names(&mut out);
    out.push_str("</svg>\n");
    out
}

/// The layout; lengths in px.
struct Picture<'a> {
    diagram: &'a Diagram,
    cell: f64,
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    /// Labelled rows: all, or as many as fit.
    named: Vec<usize>,
    equations: bool,
}

impl<'a> Picture<'a> {
    fn of(diagram: &'a Diagram) -> Self {
        let n = diagram.lines.len();
        let cell = CELL.min(MAX_SIZE / n.max(1) as f64);
        let side = cell * n as f64;
        let named = named(diagram, cell);
        let widest =
            |texts: &mut dyn Iterator<Item = f64>, most: f64| texts.fold(0.0, f64::max).min(most);
        let names = &mut named.iter().map(|&k| text_width(&diagram.lines[k].unknown, TEXT));
        // The mark of a tearing variable precedes its name.
        let name = widest(names, MAX_NAME_WIDTH) + TEXT;
        let (sine, cosine) = LEAN.to_radians().sin_cos();
        let equations = n <= MAX_EQUATIONS;
        let equation = if equations {
            let texts = &mut diagram.lines.iter().map(|l| text_width(&l.equation, TEXT));
            widest(texts, MAX_EQUATION_WIDTH) + 2.0 * GAP
        } else {
            0.0
        };
        let left = MARGIN + name + GAP;
        let top = HEAD + name * sine + GAP;
        // The last slanted name extends beyond the matrix.
        let right = equation.max(name * cosine);
        Picture {
            diagram,
            cell,
            left,
            top,
            width: (left + side + right + MARGIN).max(520.0).ceil(),
            height: (top + side + MARGIN).ceil(),
            named,
            equations,
        }
    }

    /// Start of row `k`.
    fn at(&self, k: usize) -> f64 {
        self.cell * k as f64
    }

    /// Draws title and legend.
    fn head(&self, out: &mut String) {
        let (width, height) = (self.width, self.height);
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILY}, Helvetica, Arial, sans-serif\" \
             font-size=\"{TEXT}\" fill=\"{INK}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
        );
        let Diagram { model, phase, lines, parts } = self.diagram;
        let counted = |n: usize, what: &str| match n {
            1 => format!("1 {what}"),
            n => format!("{n} {what}s"),
        };
        let title = format!(
            "{model}, {phase}: {} in {}",
            counted(lines.len(), "unknown"),
            counted(parts.len(), "block")
        );
        let title = shortened(&title, TITLE, width - 2.0 * MARGIN);
        let _ = writeln!(
            out,
            "<text x=\"{MARGIN}\" y=\"30\" font-size=\"{TITLE}\" font-weight=\"600\">{}</text>",
            escaped(&title)
        );
        let mut x = MARGIN;
        let y = 50.0;
        let mut entry = |out: &mut String, mark: &dyn Fn(f64) -> String, text: &str| {
            let _ = writeln!(
                out,
                "{}<text x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
                mark(x),
                x + 16.0,
                y + 4.0
            );
            x += 16.0 + text_width(text, TEXT) + 18.0;
        };
        for method in SolutionMethod::ALL {
            let of_method = || parts.iter().filter(|p| p.method == method);
            let number = of_method().count();
            if number == 0 {
                continue;
            }
            let (area, diagonal) = colours(method);
            let text = match (method, of_method().map(|p| p.size).max()) {
                (SolutionMethod::Explicit, _) | (_, None) => format!("{number} {}", method.name()),
                (_, Some(size)) if number == 1 || size == 1 => {
                    format!("{number} {} of {size}", method.name())
                }
                (_, Some(size)) => format!("{number} {}, up to {size}", method.name()),
            };
            let mark = |x: f64| {
                format!(
                    "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"11\" height=\"11\" fill=\"{area}\"/>\
                     <rect x=\"{:.1}\" y=\"{:.1}\" width=\"5\" height=\"5\" fill=\"{diagonal}\"/>",
                    y - 5.5,
                    x + 3.0,
                    y - 2.5
                )
            };
            entry(out, &mark, &text);
        }
        let torn = lines.iter().filter(|l| l.torn).count();
        if torn > 0 {
            entry(out, &|x| diamond(x + 5.5, y, 4.5), &format!("{torn} torn"));
        }
        let read = |x: f64| {
            let y = y - 2.5;
            format!(
                "<rect x=\"{:.1}\" y=\"{y:.1}\" width=\"5\" height=\"5\" fill=\"{READ}\"/>",
                x + 3.0
            )
        };
        entry(out, &read, "reads");
    }

    /// Draws the frame and the areas of the blocks.
    fn areas(&self, out: &mut String) {
        let (left, top) = (self.left, self.top);
        let side = self.at(self.diagram.lines.len());
        let _ = writeln!(
            out,
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{side:.2}\" height=\"{side:.2}\" \
             fill=\"none\" stroke=\"#d9d9d9\"/>"
        );
        if self.cell >= 6.0 {
            let mut guides = String::new();
            for k in (GUIDE..self.diagram.lines.len()).step_by(GUIDE) {
                let at = self.at(k);
                let _ = write!(guides, "M{left:.1} {:.1}h{side:.1}", top + at);
                let _ = write!(guides, "M{:.1} {top:.1}v{side:.1}", left + at);
            }
            let _ = writeln!(out, "<path d=\"{guides}\" fill=\"none\" stroke=\"#ececec\"/>");
        }
        for (k, part) in self.diagram.parts.iter().enumerate() {
            // In a large system a single equation is only a mark on the diagonal.
            if part.size == 1 && self.cell < 4.0 {
                continue;
            }
            let (area, _) = colours(part.method);
            let (from, side) = (self.at(part.first), self.at(part.size));
            let _ = writeln!(
                out,
                "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{side:.2}\" height=\"{side:.2}\" fill=\"{area}\">\
                 <title>{}</title></rect>",
                left + from,
                top + from,
                escaped(&self.about(k, part))
            );
        }
        // Rows and columns of tearing variables within their block.
        for part in self.diagram.parts.iter().filter(|p| p.method != SolutionMethod::Explicit) {
            let (from, side) = (self.at(part.first), self.at(part.size));
            for k in part.first..part.first + part.size {
                if self.diagram.lines[k].torn {
                    let (at, cell) = (self.at(k), self.cell);
                    let _ = writeln!(
                        out,
                        "<path d=\"M{:.2} {:.2}h{side:.2}v{cell:.2}h-{side:.2}zM{:.2} {:.2}h{cell:.2}v{side:.2}h-{cell:.2}z\" \
                         fill=\"{TORN}\" fill-opacity=\"0.13\"/>",
                        left + from,
                        top + at,
                        left + at,
                        top + from
                    );
                }
            }
        }
    }

    /// The tooltip of a block.
    fn about(&self, k: usize, part: &DiagramBlock) -> String {
        let lines = &self.diagram.lines[part.first..part.first + part.size];
        match (part.method, lines) {
            (SolutionMethod::Explicit, [line]) => format!("{}. {}", k + 1, line.equation),
            (method, _) => {
                let torn: Vec<&str> =
                    lines.iter().filter(|l| l.torn).map(|l| l.unknown.as_str()).take(20).collect();
                let (name, size) = (method.name(), part.size);
                format!("{}. {name} system of {size}, torn: {}", k + 1, torn.join(", "))
            }
        }
    }

    /// Draws the marks and the diagonal.
    fn marks(&self, out: &mut String) {
        // Draw at most one mark per pixel.
        let grain = self.cell.max(1.0);
        let place = |k: usize| ((self.at(k) + 0.5 * self.cell) / grain) as u32;
        let side = if self.cell >= 6.0 { 0.45 * self.cell } else { (0.8 * self.cell).max(1.0) };
        let mut read: BTreeSet<(u32, u32)> = BTreeSet::new();
        for (k, line) in self.diagram.lines.iter().enumerate() {
            read.extend(line.reads.iter().map(|&j| (place(k), place(j))));
        }
        let cells = |places: &BTreeSet<(u32, u32)>| {
            let mut path = String::new();
            for (row, column) in places {
                let middle = |p: u32| (f64::from(p) + 0.5) * grain - 0.5 * side;
                let (x, y) = (self.left + middle(*column), self.top + middle(*row));
                let _ = write!(path, "M{x:.1} {y:.1}h{side:.1}v{side:.1}h-{side:.1}z");
            }
            path
        };
        let _ = writeln!(out, "<path d=\"{}\" fill=\"{READ}\"/>", cells(&read));
        for method in SolutionMethod::ALL {
            let parts = self.diagram.parts.iter().filter(|p| p.method == method);
            let lines = parts.flat_map(|p| p.first..p.first + p.size);
            let untorn = lines.filter(|&k| !self.diagram.lines[k].torn || self.cell < 6.0);
            let places: BTreeSet<(u32, u32)> = untorn.map(|k| (place(k), place(k))).collect();
            if !places.is_empty() {
                let (_, diagonal) = colours(method);
                let _ = writeln!(out, "<path d=\"{}\" fill=\"{diagonal}\"/>", cells(&places));
            }
        }
        if self.cell >= 6.0 {
            for (k, _) in self.diagram.lines.iter().enumerate().filter(|(_, l)| l.torn) {
                let middle = self.at(k) + 0.5 * self.cell;
                let mark = diamond(self.left + middle, self.top + middle, 0.36 * self.cell);
                let _ = writeln!(out, "{mark}");
            }
        }
    }

    /// Draws names left of the rows and above the columns, and equations right of the rows.
    fn names(&self, out: &mut String) {
        let side = self.at(self.diagram.lines.len());
        for &k in &self.named {
            let line = &self.diagram.lines[k];
            let name = escaped(&shortened(&line.unknown, TEXT, MAX_NAME_WIDTH));
            let colour = if line.torn { format!(" fill=\"{TORN}\"") } else { String::new() };
            let tip = escaped(&line.equation);
            let middle = self.at(k) + 0.5 * self.cell;
            let (x, y) = (self.left - GAP, self.top + middle);
            let _ = writeln!(
                out,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"end\"{colour}>{name}<title>{tip}</title></text>",
                y + 0.36 * TEXT
            );
            if line.torn {
                let width = text_width(&shortened(&line.unknown, TEXT, MAX_NAME_WIDTH), TEXT);
                let _ = writeln!(out, "{}", diamond(x - width - 0.55 * TEXT, y, 3.2));
            }
            let (x, y) = (self.left + middle, self.top - GAP);
            let _ = writeln!(
                out,
                "<text transform=\"translate({:.1} {y:.1}) rotate(-{LEAN})\"{colour}>{name}</text>",
                x + 0.3 * TEXT
            );
            if self.equations {
                let text = escaped(&shortened(&line.equation, TEXT, MAX_EQUATION_WIDTH));
                let (x, y) = (self.left + side + 2.0 * GAP, self.top + middle + 0.36 * TEXT);
                let _ =
                    writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"#666666\">{text}</text>");
            }
        }
    }
}

/// The labelled rows. If not all fit: first the tearing variables, then the first rows of
/// simultaneous blocks, then the others, each if its neighbours leave enough space.
fn named(diagram: &Diagram, cell: f64) -> Vec<usize> {
    let n = diagram.lines.len();
    if cell >= LINE {
        return (0..n).collect();
    }
    let apart = (LINE / cell).ceil() as usize;
    let torn = (0..n).filter(|&k| diagram.lines[k].torn);
    let joint = diagram.parts.iter().filter(|p| p.size > 1).map(|p| p.first);
    let mut chosen: BTreeSet<usize> = BTreeSet::new();
    for k in torn.chain(joint).chain(0..n) {
        let near = k.saturating_sub(apart - 1)..k + apart;
        if chosen.range(near).next().is_none() {
            chosen.insert(k);
        }
    }
    chosen.into_iter().collect()
}

/// The mark of a tearing variable around a point.
fn diamond(x: f64, y: f64, radius: f64) -> String {
    format!(
        "<path d=\"M{x:.1} {:.1}l{radius:.1} {radius:.1}l-{radius:.1} {radius:.1}l-{radius:.1} -{radius:.1}z\" fill=\"{TORN}\"/>",
        y - radius
    )
}

/// Escapes a string for XML, which cannot represent control characters.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::diagram::DiagramLine;

    /// A chain of explicit equations with a system of three at the end.
    fn chain(n: usize) -> Diagram {
        let line = |k: usize| DiagramLine {
            unknown: format!("part[{k}].x<&>"),
            equation: format!("part[{k}].x := 1"),
            torn: k + 1 == n,
            reads: if k == 0 { vec![] } else { vec![k - 1] },
        };
        let mut parts: Vec<DiagramBlock> = (0..n - 3)
            .map(|first| DiagramBlock { method: SolutionMethod::Explicit, first, size: 1 })
            .collect();
        parts.push(DiagramBlock { method: SolutionMethod::Nonlinear, first: n - 3, size: 3 });
        Diagram {
            model: "Chain".into(),
            phase: "between events",
            lines: (0..n).map(line).collect(),
            parts,
        }
    }

    #[test]
    fn a_small_system_labels_every_row() {
        let picture = svg(&chain(10));
        assert_eq!(picture.matches("part[4].x&lt;&amp;&gt;").count(), 2);
        assert!(picture.contains("Chain, between events: 10 unknowns in 8 blocks"));
        assert!(picture.contains("7 explicit") && picture.contains("1 nonlinear of 3"));
        assert!(picture.contains("1 torn") && picture.contains("torn: part[9]"));
        assert!(super::super::raster::png(&picture, 1).is_ok());
    }

    #[test]
    fn names_of_a_large_system_do_not_touch_and_torn_ones_come_first() {
        let diagram = chain(5000);
        let cell = MAX_SIZE / 5000.0;
        let named = named(&diagram, cell);
        assert!(named.windows(2).all(|w| (w[1] - w[0]) as f64 * cell >= LINE));
        assert!(named.contains(&4999) && named.len() > 60, "{}", named.len());
        let picture = svg(&diagram);
        assert!(picture.len() < 200_000, "{}", picture.len());
        assert!(super::super::raster::png(&picture, 1).is_ok());
    }
}
