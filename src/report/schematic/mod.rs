//! Draws components and their connections as SVG.
//!
//! In: an [`Assembly`] and one of its components. Out: a picture of the contents of that component.
//! If every part has an `annotation(Placement(...))`, it determines the layout. Otherwise parts are
//! arranged in layers around the part with most connections, such as the spool of a valve: K.
//! Sugiyama, S. Tagawa, M. Toda, "Methods for visual understanding of hierarchical system
//! structures", IEEE Trans. SMC 11 (1981) 109-125, with orthogonal lines in the channels between
//! the layers: D. N. Deutsch, "A dogleg channel router", DAC 1976. A part with many lines at one
//! connector becomes a bar that spans them. Ties are broken by declaration order, so equal models
//! give equal pictures.

pub mod draw;
pub mod layers;
pub mod order;
pub mod place;
pub mod placed;
pub mod route;

use crate::ir::assembly::Assembly;

/// Maximum number of parts in a picture; more would be unreadable.
pub const MAX_PARTS: usize = 250;

/// A box.
#[derive(Clone, PartialEq, Debug)]
pub struct Shape {
    /// The component, or the enclosing component for one of its own connectors.
    pub part: usize,
    /// The connector of the enclosing component, if it is one.
    pub pin: Option<String>,
    /// Left, top, width, height, px.
    pub area: [f64; 4],
}

/// A line; its corners in px.
#[derive(Clone, PartialEq, Debug)]
pub struct Line {
    /// Positions of the links that it represents: one, or all inputs that one part reads from
    /// another.
    pub links: Vec<usize>,
    /// The corners.
    pub points: Vec<[f64; 2]>,
}

/// A complete layout, px from the upper left corner.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Picture {
    /// Width and height.
    pub size: [f64; 2],
    /// The boxes.
    pub shapes: Vec<Shape>,
    /// The lines.
    pub lines: Vec<Line>,
    /// Junctions of the lines of one connector.
    pub dots: Vec<(usize, [f64; 2])>,
}

/// Lays out the components in `level` with their connections; `None` if there are none or too many.
pub fn picture(assembly: &Assembly, level: usize) -> Option<Picture> {
    let children = assembly.children(level);
    if children.is_empty() || children.len() > MAX_PARTS {
        return None;
    }
    if let Some(picture) = placed::picture(assembly, level, &children) {
        return Some(picture);
    }
    let mut graph = layers::Graph::new(assembly, level, &children);
    order::order(&mut graph);
    place::place(&mut graph);
    Some(route::route(&graph))
}

/// The order of parts from left to right, such as seals along a spool.
pub fn sequence(picture: &Picture, parts: &[usize]) -> Vec<usize> {
    let centre = |part: usize| {
        let shape = picture.shapes.iter().find(|s| s.part == part && s.pin.is_none());
        shape.map_or([0.0, 0.0], |s| [s.area[0] + 0.5 * s.area[2], s.area[1] + 0.5 * s.area[3]])
    };
    let mut sorted = parts.to_vec();
    sorted.sort_by(|a, b| {
        let (a, b) = (centre(*a), centre(*b));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    sorted
}
