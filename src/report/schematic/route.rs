//! Routes orthogonal lines in the channels between the layers.

use super::layers::Graph;
use super::place::terminal;
use super::{Line, Picture, Shape};

/// Distance of parallel lines, and of the first from a box, px.
const TRACK: f64 = 10.0;
const CLEAR: f64 = 16.0;
/// Offset below which a line is straight, px.
const STRAIGHT_LIMIT: f64 = 0.75;
/// Margin of the picture, px.
const MARGIN: f64 = 14.0;
/// Distance by which a bar extends beyond its outermost line, px.
const OVERHANG: f64 = 34.0;

/// Lines of one connector in one channel.
struct Net {
    /// Segments with their lower and upper ends; both ends of a segment within the layer below are
    /// lower.
    segments: Vec<(usize, [f64; 2])>,
    /// Positions of lines from below and from above.
    pins: Vec<(f64, bool)>,
    from: f64,
    to: f64,
    track: usize,
}

impl Net {
    fn is_straight(&self) -> bool {
        self.to - self.from < STRAIGHT_LIMIT && self.pins.iter().any(|p| p.1)
    }
}

/// Converts the layers to a picture.
pub fn route(graph: &Graph) -> Picture {
    let count = graph.layers.len();
    let ends: Vec<[f64; 2]> = (0..graph.segments.len()).map(|k| ends(graph, k)).collect();
    let mut channels: Vec<Vec<Net>> = (0..count).map(|layer| nets(graph, layer, &ends)).collect();
    // For each layer: start, end, and position of its tracks.
    let mut across = vec![[0.0; 2]; count];
    let mut at = 0.0;
    for layer in 0..count {
        let depth = |n: &usize| graph.nodes[*n].size[1];
        let depth = graph.layers[layer].iter().map(depth).fold(0.0, f64::max);
        across[layer] = [at, at + depth];
        let tracks = assign_tracks(&mut channels[layer]);
        let last = layer + 1 == count && tracks == 0;
        at +=
            depth + if last { 0.0 } else { 2.0 * CLEAR + TRACK * tracks.saturating_sub(1) as f64 };
    }
    let total = at;
    let track_at = |layer: usize, track: usize| across[layer][1] + CLEAR + TRACK * track as f64;
    let edge = |node: usize, upper: bool| {
        let n = &graph.nodes[node];
        let [low, high] = across[n.layer];
        let half = if n.part.is_none() { 0.5 * (high - low) } else { 0.5 * n.size[1] };
        0.5 * (low + high) + if upper { half } else { -half }
    };
    let mut bends: Vec<Option<f64>> = vec![None; graph.segments.len()];
    let mut raw_dots: Vec<(usize, [f64; 2])> = Vec::new();
    for (layer, nets) in channels.iter().enumerate() {
        for net in nets.iter().filter(|n| !n.is_straight()) {
            let v = track_at(layer, net.track);
            net.segments.iter().for_each(|(k, _)| bends[*k] = Some(v));
            for u in junctions(net) {
                let wire = graph.segments[net.segments[0].0].wire;
                raw_dots.push((graph.wires[wire].links[0], [u, v]));
            }
        }
    }
    let mut lines: Vec<Line> = Vec::new();
    for wire in &graph.wires {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for &(k, rises) in &wire.segments {
            let segment = &graph.segments[k];
            let level = graph.is_level(segment);
            let [a, b] = ends[k];
            let mut part = vec![[a, edge(segment.nodes[0], true)]];
            if let Some(v) = bends[k] {
                part.extend([[a, v], [b, v]]);
            }
            part.push([b, edge(segment.nodes[1], level)]);
            if !rises {
                part.reverse();
            }
            points.extend(part);
        }
        lines.push(Line { links: wire.links.clone(), points: straightened(points) });
    }
    let mut shapes = Vec::new();
    for (k, node) in graph.nodes.iter().enumerate() {
        let Some(part) = node.part else { continue };
        let (mut low, mut high) = (node.at - 0.5 * node.size[0], node.at + 0.5 * node.size[0]);
        if node.bar {
            let at =
                graph.segments.iter().enumerate().flat_map(|(i, p)| {
                    (0..2).filter(move |e| p.nodes[*e] == k).map(move |e| (i, e))
                });
            let at: Vec<f64> = at.map(|(i, e)| ends[i][e]).collect();
            let middle = at.iter().sum::<f64>() / at.len().max(1) as f64;
            (low, high) = (middle - 0.5 * node.size[0], middle + 0.5 * node.size[0]);
            low = at.iter().copied().fold(low, |a, b| a.min(b - OVERHANG));
            high = at.iter().copied().fold(high, |a, b| a.max(b + OVERHANG));
        }
        let (front, back) = (edge(k, false), edge(k, true));
        shapes.push(Shape {
            part,
            pin: node.pin.clone(),
            area: [low, front, high - low, back - front],
        });
    }
    finish(graph.sideways, total, shapes, lines, raw_dots)
}

/// Start and end of a segment along the layers; at a bar it has the position of its other end.
fn ends(graph: &Graph, k: usize) -> [f64; 2] {
    let segment = &graph.segments[k];
    let own = [0, 1].map(|i| graph.nodes[segment.nodes[i]].at + terminal(graph, segment, i));
    match [0, 1].map(|i| graph.nodes[segment.nodes[i]].bar) {
        [true, false] => [own[1]; 2],
        [false, true] => [own[0]; 2],
        _ => own,
    }
}

/// Segments that start above a layer, grouped by connector.
fn nets(graph: &Graph, layer: usize, ends: &[[f64; 2]]) -> Vec<Net> {
    let here: Vec<usize> = (0..graph.segments.len())
        .filter(|&k| graph.nodes[graph.segments[k].nodes[0]].layer == layer)
        .collect();
    // A connector of a node on one side; bars have one for each line.
    let key = |k: usize, i: usize| {
        let p = &graph.segments[k];
        let upper_end = i == 1 && !graph.is_level(p);
        let node = &graph.nodes[p.nodes[i]];
        let own = node.bar || node.part.is_none();
        (p.nodes[i], p.ports[i].as_str(), upper_end, if own { k } else { usize::MAX })
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &k in &here {
        let touching = |g: &Vec<usize>| {
            g.iter().any(|&o| (0..2).any(|i| (0..2).any(|j| key(k, i) == key(o, j))))
        };
        let (mut joined, rest): (Vec<_>, Vec<_>) = groups.into_iter().partition(touching);
        groups = rest;
        let mut group: Vec<usize> = joined.drain(..).flatten().collect();
        group.push(k);
        groups.push(group);
    }
    let net = |group: Vec<usize>| {
        let mut pins: Vec<(f64, bool)> = Vec::new();
        for &k in &group {
            let level = graph.is_level(&graph.segments[k]);
            for (i, &u) in ends[k].iter().enumerate() {
                let pin = (u, i == 1 && !level);
                if !pins.contains(&pin) {
                    pins.push(pin);
                }
            }
        }
        let from = pins.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let to = pins.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
        let segments = group.into_iter().map(|k| (k, ends[k])).collect();
        Net { segments, pins, from, to, track: 0 }
    };
    groups.into_iter().map(net).collect()
}

/// Assigns a track to each net that bends, counted from the lower layer; returns the number of
/// tracks.
fn assign_tracks(nets: &mut [Net]) -> usize {
    let mut order: Vec<usize> = (0..nets.len()).filter(|&k| !nets[k].is_straight()).collect();
    order.sort_by(|a, b| nets[*a].from.total_cmp(&nets[*b].from).then(a.cmp(b)));
    // Cost of `a` below `b`: lines of `b` from below and of `a` from above cross the other net;
    // overlaps cost most.
    let below = |a: &Net, b: &Net| {
        let inside = |n: &Net, u: f64| n.from + STRAIGHT_LIMIT < u && u < n.to - STRAIGHT_LIMIT;
        let mut cost = 0.0;
        for (u, upper) in &b.pins {
            cost += f64::from(u8::from(!upper && inside(a, *u)));
            let over = a.pins.iter().any(|(v, above)| *above && !upper && (u - v).abs() < 4.0);
            cost += if over { 50.0 } else { 0.0 };
        }
        for (u, upper) in &a.pins {
            cost += f64::from(u8::from(*upper && inside(b, *u)));
        }
        cost
    };
    // Preferences may be cyclic: limit the passes to those of a bubble sort.
    for _ in 0..order.len() {
        for i in 1..order.len() {
            let (a, b) = (&nets[order[i - 1]], &nets[order[i]]);
            if below(b, a) + 1e-9 < below(a, b) {
                order.swap(i - 1, i);
            }
        }
    }
    let mut tracks = 0;
    for i in 0..order.len() {
        let k = order[i];
        let clash =
            |o: &&usize| nets[**o].from < nets[k].to + 6.0 && nets[k].from < nets[**o].to + 6.0;
        let above = order[..i].iter().filter(clash).map(|o| nets[*o].track + 1).max().unwrap_or(0);
        nets[k].track = above;
        tracks = tracks.max(above + 1);
    }
    tracks
}

/// Junctions on the track of a net.
fn junctions(net: &Net) -> Vec<f64> {
    let mut at: Vec<f64> = net.pins.iter().map(|p| p.0).collect();
    at.sort_by(f64::total_cmp);
    at.dedup_by(|a, b| (*a - *b).abs() < STRAIGHT_LIMIT);
    let branches = |u: f64| {
        let pins = net.pins.iter().filter(|p| (p.0 - u).abs() < STRAIGHT_LIMIT).count();
        let left = usize::from(u > net.from + STRAIGHT_LIMIT);
        let right = usize::from(u < net.to - STRAIGHT_LIMIT);
        pins + left + right
    };
    at.into_iter().filter(|u| branches(*u) > 2).collect()
}

/// Drops repeated and collinear points.
pub(super) fn straightened(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::new();
    for p in points {
        if out.last().is_some_and(|q| (q[0] - p[0]).abs() < 1e-9 && (q[1] - p[1]).abs() < 1e-9) {
            continue;
        }
        if let [.., a, b] = out[..] {
            let same = |i: usize| (a[i] - b[i]).abs() < 1e-9 && (b[i] - p[i]).abs() < 1e-9;
            if same(0) || same(1) {
                out.pop();
            }
        }
        out.push(p);
    }
    out
}

/// Converts layer coordinates to picture coordinates.
fn finish(
    sideways: bool,
    total: f64,
    mut shapes: Vec<Shape>,
    mut lines: Vec<Line>,
    mut dots: Vec<(usize, [f64; 2])>,
) -> Picture {
    let turned = |p: [f64; 2]| if sideways { [p[1], p[0]] } else { [p[0], total - p[1]] };
    for s in &mut shapes {
        let [u, v, length, depth] = s.area;
        s.area =
            if sideways { [v, u, depth, length] } else { [u, total - v - depth, length, depth] };
    }
    lines.iter_mut().flat_map(|l| &mut l.points).for_each(|p| *p = turned(*p));
    dots.iter_mut().for_each(|(_, p)| *p = turned(*p));
    framed(shapes, lines, dots)
}

/// Moves everything to the upper left corner, with a margin.
pub(super) fn framed(
    mut shapes: Vec<Shape>,
    mut lines: Vec<Line>,
    mut dots: Vec<(usize, [f64; 2])>,
) -> Picture {
    let corners = shapes.iter().flat_map(|s| {
        let [x, y, w, h] = s.area;
        [[x, y], [x + w, y + h]]
    });
    let points: Vec<[f64; 2]> =
        corners.chain(lines.iter().flat_map(|l| l.points.iter().copied())).collect();
    let least = |i: usize| points.iter().map(|p| p[i]).fold(f64::INFINITY, f64::min) - MARGIN;
    let most = |i: usize| points.iter().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max) + MARGIN;
    let [left, top] = [least(0).floor(), least(1).floor()];
    let size = [(most(0) - left).ceil(), (most(1) - top).ceil()];
    for s in &mut shapes {
        (s.area[0], s.area[1]) = (s.area[0] - left, s.area[1] - top);
    }
    let moved = |p: &mut [f64; 2]| (p[0], p[1]) = (p[0] - left, p[1] - top);
    lines.iter_mut().flat_map(|l| &mut l.points).for_each(moved);
    dots.iter_mut().for_each(|(_, p)| moved(p));
    Picture { size, shapes, lines, dots }
}
