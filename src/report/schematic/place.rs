//! Positions nodes along the layers, so that lines are as straight as the order allows.

use super::layers::{Graph, Segment};

/// Minimum distances of boxes and of lines, px.
const GAP: f64 = 22.0;
const GAP_OF_LINES: f64 = 16.0;
/// Offset up to which a line is straightened, px.
const STRAIGHTEN_LIMIT: f64 = 26.0;
/// Number of passes over all layers.
const ROUNDS: usize = 60;
/// Additional weight of the straightness of long lines.
const STRAIGHT: f64 = 3.0;

/// Sets [`Node::at`](super::layers::Node::at) of all nodes except bars.
pub fn place(graph: &mut Graph) {
    for layer in 0..graph.layers.len() {
        let offsets = offsets(graph, layer);
        let middle = 0.5 * offsets.last().copied().unwrap_or(0.0);
        for (k, &n) in graph.layers[layer].clone().iter().enumerate() {
            graph.nodes[n].at = offsets[k] - middle;
        }
    }
    let count = graph.layers.len();
    for round in 0..ROUNDS {
        let layers: Vec<usize> =
            if round % 2 == 0 { (0..count).collect() } else { (0..count).rev().collect() };
        for layer in layers {
            settle(graph, layer);
        }
    }
    graph.nodes.iter_mut().for_each(|n| n.at = n.at.round());
    for layer in 0..count {
        straighten(graph, layer);
    }
}

/// Straightens lines that are nearly straight, if there is space: aligns dummy nodes with their
/// neighbours, and boxes with one line with its other end.
fn straighten(graph: &mut Graph, layer: usize) {
    for k in 0..graph.layers[layer].len() {
        let node = graph.layers[layer][k];
        if graph.nodes[node].bar {
            continue;
        }
        let down: Vec<&Segment> = graph
            .segments
            .iter()
            .filter(|p| p.nodes[1] == node && !graph.is_level(p) && !graph.nodes[p.nodes[0]].bar)
            .collect();
        let [segment] = down[..] else { continue };
        let wanted = graph.nodes[segment.nodes[0]].at + terminal(graph, segment, 0)
            - terminal(graph, segment, 1);
        let by = wanted - graph.nodes[node].at;
        let beside = |other: Option<&usize>| {
            other.is_none_or(|&o| {
                let room = 0.5 * (graph.nodes[o].size[0] + graph.nodes[node].size[0]);
                (graph.nodes[o].at - wanted).abs() >= room + 0.6 * GAP_OF_LINES
                    && (graph.nodes[o].at - wanted) * (graph.nodes[o].at - graph.nodes[node].at)
                        > 0.0
            })
        };
        let row = &graph.layers[layer];
        let free = beside(k.checked_sub(1).and_then(|b| row.get(b))) && beside(row.get(k + 1));
        if by != 0.0 && by.abs() <= STRAIGHTEN_LIMIT && free {
            graph.nodes[node].at = wanted;
        }
    }
}

/// Minimum distance of each node of a layer from the first.
fn offsets(graph: &Graph, layer: usize) -> Vec<f64> {
    let mut at = 0.0;
    let mut out = Vec::new();
    let row = &graph.layers[layer];
    for (k, &n) in row.iter().enumerate() {
        let size = graph.nodes[n].size[0];
        if let Some(&before) = k.checked_sub(1).and_then(|b| row.get(b)) {
            let lines = graph.nodes[n].part.is_none() && graph.nodes[before].part.is_none();
            at += 0.5 * (graph.nodes[before].size[0] + size);
            at += if lines { GAP_OF_LINES } else { GAP };
        }
        out.push(at);
    }
    out
}

/// Moves the nodes of a layer as close to their neighbours as their order allows: isotonic least
/// squares by pooling adjacent violators (Barlow, Bartholomew, Bremner and Brunk 1972).
fn settle(graph: &mut Graph, layer: usize) {
    let row = graph.layers[layer].clone();
    let offsets = offsets(graph, layer);
    let wish: Vec<(f64, f64)> = row.iter().map(|&n| target(graph, n)).collect();
    // Blocks of adjacent nodes: sum of weights, weighted sum of targets, number.
    let mut blocks: Vec<(f64, f64, usize)> = Vec::new();
    for (k, (at, weight)) in wish.iter().enumerate() {
        blocks.push((*weight, weight * (at - offsets[k]), 1));
        while let [.., a, b] = blocks[..] {
            if a.1 / a.0 <= b.1 / b.0 {
                break;
            }
            blocks.pop();
            blocks.pop();
            blocks.push((a.0 + b.0, a.1 + b.1, a.2 + b.2));
        }
    }
    let mut k = 0;
    for (weight, sum, size) in blocks {
        for _ in 0..size {
            graph.nodes[row[k]].at = sum / weight + offsets[k];
            k += 1;
        }
    }
}

/// The preferred position of a node and its weight.
fn target(graph: &Graph, node: usize) -> (f64, f64) {
    let (mut sum, mut weight) = (0.0, 0.0);
    for segment in graph.segments.iter().filter(|p| p.nodes.contains(&node) && !graph.is_level(p)) {
        let me = usize::from(segment.nodes[1] == node);
        let other = segment.nodes[1 - me];
        if graph.nodes[other].bar {
            continue;
        }
        let passing = [node, other].iter().filter(|n| graph.nodes[**n].part.is_none()).count();
        let w = STRAIGHT.powi(passing as i32);
        sum += w
            * (graph.nodes[other].at + terminal(graph, segment, 1 - me)
                - terminal(graph, segment, me));
        weight += w;
    }
    match weight {
        0.0 => (graph.nodes[node].at, 0.05),
        _ => (sum / weight, weight),
    }
}

/// Position where a segment meets its node, from its middle: connectors of one side are
/// equidistant, in the order of their other ends.
pub fn terminal(graph: &Graph, segment: &Segment, end: usize) -> f64 {
    let node = segment.nodes[end];
    if graph.nodes[node].part.is_none() {
        return 0.0;
    }
    let upper = end == 0 || graph.is_level(segment);
    let mut ports: Vec<(&str, f64, f64)> = Vec::new();
    for p in &graph.segments {
        for i in 0..2 {
            if p.nodes[i] != node || (i == 0 || graph.is_level(p)) != upper {
                continue;
            }
            let other = p.nodes[1 - i];
            let at =
                if graph.nodes[other].bar { graph.nodes[node].at } else { graph.nodes[other].at };
            match ports.iter_mut().find(|(name, ..)| *name == p.ports[i]) {
                Some(port) => (port.1, port.2) = (port.1 + at, port.2 + 1.0),
                None => ports.push((&p.ports[i], at, 1.0)),
            }
        }
    }
    ports.sort_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)));
    let k = ports.iter().position(|(name, ..)| *name == segment.ports[end]).unwrap_or(0);
    let size = graph.nodes[node].size[0];
    (size * ((k as f64 + 1.0) / (ports.len() as f64 + 1.0) - 0.5)).round()
}
