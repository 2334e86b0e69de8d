//! Draws a layout as SVG: boxes, lines coloured by physical domain, and a legend.

use std::fmt::Write;

use super::layers::{CLASS_SIZE, NAME_SIZE, class_name};
use super::{Picture, Shape};
use crate::ir::assembly::{Assembly, Domain};
use crate::report::markup::escaped;
use crate::report::plot::layout::{shortened, text_width};
use crate::report::raster::FAMILY;

const INK: &str = "#1a1a1a";
const FAINT: &str = "#5b6470";
/// Height of the legend, px.
const LEGEND: f64 = 26.0;
/// Half the size of a connector.
const PORT: f64 = 3.5;

/// Colour of lines.
pub fn colour(domain: Domain) -> &'static str {
    match domain {
        Domain::Mechanical => "#00734f",
        Domain::Fluid => "#0072b2",
        Domain::Electrical => "#a8327d",
        Domain::Thermal => "#b3003c",
        Domain::Signal => "#c05200",
        Domain::Other => "#5b6470",
    }
}

/// Draws a picture; `note` gives the tooltip of a component, and `place` the source position of a
/// link. Components with contents are marked.
pub fn svg(
    picture: &Picture,
    assembly: &Assembly,
    note: &dyn Fn(usize) -> Vec<String>,
    place: &dyn Fn(usize) -> String,
) -> String {
    let [width, height] = picture.size;
    let domains: Vec<Domain> = Domain::ALL
        .into_iter()
        .filter(|d| picture.lines.iter().any(|l| assembly.links[l.links[0]].domain == *d))
        .collect();
    let legend = if domains.is_empty() { 0.0 } else { LEGEND };
    let room = domains.iter().map(|d| text_width(d.name(), CLASS_SIZE) + 56.0).sum::<f64>();
    let width = width.max(room.ceil());
    let total = height + legend;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"schematic\" width=\"{width}\" \
         height=\"{total}\" viewBox=\"0 0 {width} {total}\" font-family=\"{FAMILY}, system-ui, sans-serif\">\n\
         <rect width=\"{width}\" height=\"{total}\" fill=\"#ffffff\"/>\n"
    );
    lines(picture, assembly, place, &mut out);
    let holders = assembly.holders();
    for shape in &picture.shapes {
        part(shape, assembly, holders[shape.part], note, &mut out);
    }
    terminals(picture, assembly, &mut out);
    if legend > 0.0 {
        key(&domains, height, &mut out);
    }
    out.push_str("</svg>\n");
    out
}

/// A picture of a model without components: a box with its name.
pub fn named(name: &str) -> String {
    let width = (text_width(name, CLASS_SIZE) + 40.0).max(120.0).ceil();
    let (height, middle) = (80.0, width / 2.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILY}, system-ui, sans-serif\">\n\
         <rect x=\"1\" y=\"1\" width=\"{}\" height=\"{}\" rx=\"4\" fill=\"#ffffff\" stroke=\"#1f2933\"/>\n\
         <text x=\"{middle}\" y=\"44\" text-anchor=\"middle\" font-size=\"{CLASS_SIZE}\">{}</text>\n</svg>\n",
        width - 2.0,
        height - 2.0,
        escaped(name)
    )
}

fn lines(
    picture: &Picture,
    assembly: &Assembly,
    place: &dyn Fn(usize) -> String,
    out: &mut String,
) {
    for line in &picture.lines {
        let first = &assembly.links[line.links[0]];
        let mut path = String::new();
        for (k, [x, y]) in line.points.iter().enumerate() {
            let _ = write!(path, "{}{x} {y}", if k == 0 { "M" } else { "L" });
        }
        let dash = if first.connect { "" } else { " stroke-dasharray=\"5 3\"" };
        let kind = if first.connect { "connect" } else { "reads" };
        let texts: Vec<String> =
            line.links.iter().map(|k| link_tooltip(assembly, *k, place(*k))).collect();
        let _ = writeln!(
            out,
            "<g class=\"wire {kind} {}\"><path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{dash} stroke-linejoin=\"round\"/>\
             <path class=\"grip\" d=\"{path}\" fill=\"none\" stroke=\"#000000\" stroke-opacity=\"0\" stroke-width=\"9\"><title>{}</title></path></g>",
            first.domain.name(),
            colour(first.domain),
            escaped(&texts.join("\n")),
        );
    }
    for (link, [x, y]) in &picture.dots {
        let fill = colour(assembly.links[*link].domain);
        let _ = writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"2.6\" fill=\"{fill}\"/>");
    }
}

/// The tooltip of a link with its source position.
fn link_tooltip(assembly: &Assembly, link: usize, place: String) -> String {
    let l = &assembly.links[link];
    let end = |k: usize| {
        let e = &l.ends[k];
        let own = if e.part == l.holder { "" } else { assembly.short(e.part) };
        if own.is_empty() { e.port.clone() } else { format!("{own}.{}", e.port) }
    };
    let at = if place.is_empty() { String::new() } else { format!("  {place}") };
    match l.connect {
        true => format!("connect({}, {}){at}", end(0), end(1)),
        false => format!("{} reads {}{at}", end(1), end(0)),
    }
}

fn part(
    shape: &Shape,
    assembly: &Assembly,
    opens: bool,
    note: &dyn Fn(usize) -> Vec<String>,
    out: &mut String,
) {
    let [x, y, w, h] = shape.area;
    let p = &assembly.parts[shape.part];
    if let Some(pin) = &shape.pin {
        let _ = writeln!(
            out,
            "<g class=\"pin\"><title>{0}: connector of this component</title>\
             <rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"{1}\" fill=\"#eef1f4\" stroke=\"{FAINT}\" stroke-dasharray=\"3 2\"/>\
             <text x=\"{2}\" y=\"{3}\" font-size=\"{CLASS_SIZE}\" fill=\"{INK}\" text-anchor=\"middle\">{4}</text></g>",
            escaped(pin),
            0.5 * h,
            x + 0.5 * w,
            y + 0.5 * h + 3.8,
            escaped(&shortened(pin, CLASS_SIZE, w - 8.0)),
        );
        return;
    }
    let mut tooltip = vec![format!("{}: {}", p.name, p.class)];
    tooltip
        .extend([&p.description, &p.meaning].into_iter().filter(|t| !t.trim().is_empty()).cloned());
    tooltip.dedup();
    tooltip.extend(note(shape.part));
    let class = class_name(&p.class);
    let _ = write!(
        out,
        "<g class=\"part{}\" data-part=\"{}\"><title>{}</title>\
         <rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"5\" fill=\"#f4f7fa\" stroke=\"#3c4650\" stroke-width=\"1.2\"/>",
        if opens { " opens" } else { "" },
        escaped(&p.name),
        escaped(&tooltip.join("\n")),
    );
    if opens {
        let _ = write!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"3\" fill=\"none\" stroke=\"#b6c0ca\"/>",
            x + 2.5,
            y + 2.5,
            w - 5.0,
            h - 5.0
        );
    }
    let name = escaped(&shortened(assembly.short(shape.part), NAME_SIZE * 1.06, w - 12.0));
    let middle = x + 0.5 * w;
    if h < 34.0 {
        // A bar has one line of text.
        let class = escaped(class);
        let _ = writeln!(
            out,
            "<text x=\"{middle}\" y=\"{}\" font-size=\"{NAME_SIZE}\" fill=\"{INK}\" text-anchor=\"middle\"><tspan font-weight=\"600\">{name}</tspan><tspan dx=\"7\" font-size=\"{CLASS_SIZE}\" fill=\"{FAINT}\">{class}</tspan></text></g>",
            y + 0.5 * h + 4.3
        );
        return;
    }
    let class = escaped(&shortened(class, CLASS_SIZE, w - 10.0));
    let line = |y: f64, size: f64, weight: u32, fill: &str, text: &str| {
        format!(
            "<text x=\"{middle}\" y=\"{y}\" font-size=\"{size}\" font-weight=\"{weight}\" fill=\"{fill}\" text-anchor=\"middle\">{text}</text>"
        )
    };
    out.push_str(&line(y + 0.5 * h - 2.0, NAME_SIZE, 600, INK, &name));
    out.push_str(&line(y + 0.5 * h + 12.0, CLASS_SIZE, 400, FAINT, &class));
    out.push_str("</g>\n");
}

/// Draws squares at connectors, and triangles at inputs.
fn terminals(picture: &Picture, assembly: &Assembly, out: &mut String) {
    for line in &picture.lines {
        let link = &assembly.links[line.links[0]];
        let fill = colour(link.domain);
        let n = line.points.len();
        if n < 2 {
            continue;
        }
        for (end, at, from) in [(0, 0, 1), (1, n - 1, n - 2)] {
            let ([x, y], [px, py]) = (line.points[at], line.points[from]);
            let port = escaped(&link.ends[end].port);
            if !link.connect && end == 1 {
                // The tip touches the box.
                let (dx, dy) = (
                    (x - px).signum() * f64::from((x - px).abs() > 0.1),
                    (y - py).signum() * f64::from((y - py).abs() > 0.1),
                );
                let (bx, by) = (x - 8.0 * dx, y - 8.0 * dy);
                let _ = writeln!(
                    out,
                    "<path d=\"M{x} {y}L{} {}L{} {}Z\" fill=\"{fill}\"><title>{port}</title></path>",
                    bx + 3.6 * dy,
                    by + 3.6 * dx,
                    bx - 3.6 * dy,
                    by - 3.6 * dx
                );
            } else if link.connect {
                let _ = writeln!(
                    out,
                    "<rect x=\"{}\" y=\"{}\" width=\"{2}\" height=\"{2}\" fill=\"{fill}\" stroke=\"#ffffff\" stroke-width=\"0.7\"><title>{port}</title></rect>",
                    x - PORT,
                    y - PORT,
                    2.0 * PORT
                );
            } else {
                let _ = writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"2.8\" fill=\"{fill}\"/>");
            }
        }
    }
}

fn key(domains: &[Domain], top: f64, out: &mut String) {
    let mut x = 14.0;
    let y = top + 0.5 * LEGEND - 4.0;
    out.push_str("<g class=\"key\">");
    for domain in domains {
        let name = domain.name();
        let fill = colour(*domain);
        let _ = write!(
            out,
            "<path d=\"M{x} {y}h24\" stroke=\"{fill}\" stroke-width=\"1.8\"/><rect x=\"{}\" y=\"{}\" width=\"7\" height=\"7\" fill=\"{fill}\"/>\
             <text x=\"{}\" y=\"{}\" font-size=\"{CLASS_SIZE}\" fill=\"{FAINT}\">{name}</text>",
            x + 8.5,
            y - PORT,
            x + 30.0,
            y + 3.8
        );
        x += text_width(name, CLASS_SIZE) + 56.0;
    }
    out.push_str("</g>\n");
}
