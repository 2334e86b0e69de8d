//! Layout by `Placement` annotations.

use super::layers::HEIGHT;
use super::route::{framed, straightened};
use super::{Line, Picture, Shape};
use crate::ir::assembly::Assembly;

/// Width of the narrowest icon in the picture, px.
const MIN_ICON_WIDTH: f64 = 84.0;

/// The picture, if every component of a level has a `Placement`.
pub fn picture(assembly: &Assembly, level: usize, children: &[usize]) -> Option<Picture> {
    let placements: Vec<[f64; 4]> =
        children.iter().map(|&c| assembly.parts[c].placement).collect::<Option<_>>()?;
    let narrowest = placements.iter().map(|p| p[2] - p[0]).fold(f64::INFINITY, f64::min);
    let lowest = placements.iter().map(|p| p[3] - p[1]).fold(f64::INFINITY, f64::min);
    let is_area = narrowest > 0.0 && lowest > 0.0 && narrowest.is_finite();
    if !is_area {
        return None;
    }
    let scale = (MIN_ICON_WIDTH / narrowest).max(HEIGHT / lowest);
    let area = |[x1, y1, x2, y2]: [f64; 4]| {
        [scale * x1, -scale * y2, scale * (x2 - x1), scale * (y2 - y1)].map(f64::round)
    };
    let mut shapes: Vec<Shape> = children
        .iter()
        .zip(&placements)
        .map(|(&part, p)| Shape { part, pin: None, area: area(*p) })
        .collect();
    // Connectors of the enclosing component have no placement: arrange them in a row below.
    let floor = shapes.iter().map(|s| s.area[1] + s.area[3]).fold(f64::NEG_INFINITY, f64::max);
    let left = shapes.iter().map(|s| s.area[0]).fold(f64::INFINITY, f64::min);
    let mut lines = Vec::new();
    for (k, link) in assembly.links.iter().enumerate().filter(|(_, l)| l.holder == level) {
        let ends = [0, 1].map(|i| {
            let end = &link.ends[i];
            let pin = (end.part == level).then(|| end.port.clone());
            let known = shapes.iter().position(|s| s.part == end.part && s.pin == pin);
            known.unwrap_or_else(|| {
                let row = shapes.iter().filter(|s| s.pin.is_some()).count() as f64;
                let area = [left + 104.0 * row, floor + 50.0, MIN_ICON_WIDTH, 24.0];
                shapes.push(Shape { part: end.part, pin, area });
                shapes.len() - 1
            })
        });
        let points = straightened(elbow(shapes[ends[0]].area, shapes[ends[1]].area));
        lines.push(Line { links: vec![k], points });
    }
    Some(framed(shapes, lines, Vec::new()))
}

/// A line with at most two bends between the facing sides of two boxes.
fn elbow(a: [f64; 4], b: [f64; 4]) -> Vec<[f64; 2]> {
    let middle = |s: [f64; 4]| [s[0] + 0.5 * s[2], s[1] + 0.5 * s[3]];
    let (p, q) = (middle(a), middle(b));
    let gap_x = (p[0] - q[0]).abs() - 0.5 * (a[2] + b[2]);
    let gap_y = (p[1] - q[1]).abs() - 0.5 * (a[3] + b[3]);
    if gap_x >= gap_y {
        let side = |s: [f64; 4], right: bool| s[0] + if right { s[2] } else { 0.0 };
        let (x1, x2) = (side(a, q[0] > p[0]), side(b, p[0] > q[0]));
        let bend = (0.5 * (x1 + x2)).round();
        vec![[x1, p[1]], [bend, p[1]], [bend, q[1]], [x2, q[1]]]
    } else {
        let side = |s: [f64; 4], below: bool| s[1] + if below { s[3] } else { 0.0 };
        let (y1, y2) = (side(a, q[1] > p[1]), side(b, p[1] > q[1]));
        let bend = (0.5 * (y1 + y2)).round();
        vec![[p[0], y1], [p[0], bend], [q[0], bend], [q[0], y2]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_connect_facing_sides() {
        let right = elbow([0.0, 0.0, 10.0, 10.0], [30.0, 20.0, 10.0, 10.0]);
        assert_eq!(right, [[10.0, 5.0], [20.0, 5.0], [20.0, 25.0], [30.0, 25.0]]);
        let above = elbow([0.0, 50.0, 10.0, 10.0], [2.0, 0.0, 10.0, 10.0]);
        assert_eq!(above, [[5.0, 50.0], [5.0, 30.0], [7.0, 30.0], [7.0, 10.0]]);
    }
}
