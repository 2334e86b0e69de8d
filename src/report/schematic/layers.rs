//! Assigns parts to layers by breadth-first search from the part with most lines.

use crate::ir::assembly::{Assembly, Link};
use crate::report::plot::layout::text_width;

/// Number of lines at one connector from which on its part is a bar.
const BAR: usize = 4;
/// Height of a box, of a connector of the enclosing component, and of a bar, px.
pub const HEIGHT: f64 = 40.0;
const PIN_HEIGHT: f64 = 24.0;
const BAR_HEIGHT: f64 = 30.0;
/// Minimum and maximum width of a box, px.
const MIN_WIDTH: f64 = 66.0;
const MAX_WIDTH: f64 = 132.0;
/// Size of the name in a box.
pub const NAME_SIZE: f64 = 12.5;
/// Size of the class in a box.
pub const CLASS_SIZE: f64 = 10.5;

/// A part, a connector of the enclosing component, or a dummy node where a long line passes a
/// layer.
#[derive(Clone, Debug)]
pub struct Node {
    /// The component; `None` for a dummy node.
    pub part: Option<usize>,
    /// The connector of the enclosing component.
    pub pin: Option<String>,
    /// A bar that spans all its lines.
    pub bar: bool,
    /// Layer, counted from the hub.
    pub layer: usize,
    /// Size along the layer and across it.
    pub size: [f64; 2],
    /// Position of its middle along the layer.
    pub at: f64,
}

/// A segment of a line between adjacent layers or within one.
#[derive(Clone, Debug)]
pub struct Segment {
    /// The line.
    pub wire: usize,
    /// Nodes, the lower layer first.
    pub nodes: [usize; 2],
    /// Connectors at these nodes; empty for dummy nodes.
    pub ports: [String; 2],
}

/// A line.
#[derive(Clone, Debug)]
pub struct Wire {
    /// The links that it represents.
    pub links: Vec<usize>,
    /// Its segments from the first end on; true if it runs upwards through a segment.
    pub segments: Vec<(usize, bool)>,
}

/// The contents of a component in layers.
#[derive(Clone, Debug)]
pub struct Graph {
    /// All nodes.
    pub nodes: Vec<Node>,
    /// All lines.
    pub wires: Vec<Wire>,
    /// Their segments.
    pub segments: Vec<Segment>,
    /// Nodes of each layer in order.
    pub layers: Vec<Vec<usize>>,
    /// Layers are side by side, for chains; otherwise the first one is at the bottom.
    pub sideways: bool,
}

/// A line between nodes, before it is split into segments.
struct Edge {
    links: Vec<usize>,
    nodes: [usize; 2],
    ports: [String; 2],
}

impl Graph {
    /// Assigns the parts to layers, each in order of declaration.
    pub fn new(assembly: &Assembly, level: usize, children: &[usize]) -> Graph {
        let mut nodes: Vec<Node> = children
            .iter()
            .map(|&part| Node {
                part: Some(part),
                pin: None,
                bar: false,
                layer: 0,
                size: [width(assembly, part), HEIGHT],
                at: 0.0,
            })
            .collect();
        let edges = edges(assembly, level, &mut nodes);
        let most = mark_bars(&mut nodes, &edges);
        let sideways = !nodes.iter().any(|n| n.bar);
        let root = if sideways { far_end(&nodes, &edges, most) } else { most };
        assign(&mut nodes, &edges, root);
        if sideways {
            nodes.iter_mut().for_each(|n| n.size.reverse());
        }
        let mut graph =
            Graph { nodes, wires: Vec::new(), segments: Vec::new(), layers: Vec::new(), sideways };
        edges.into_iter().for_each(|edge| graph.split(edge));
        let count = graph.nodes.iter().map(|n| n.layer + 1).max().unwrap_or(0);
        graph.layers = vec![Vec::new(); count];
        for (k, node) in graph.nodes.iter().enumerate() {
            graph.layers[node.layer].push(k);
        }
        graph
    }

    /// Adds a line, with a dummy node in each layer that it passes.
    fn split(&mut self, edge: Edge) {
        let Edge { links, nodes: [a, b], ports: [port_a, port_b] } = edge;
        let wire = self.wires.len();
        let rises = self.nodes[a].layer <= self.nodes[b].layer;
        let (low, high) = if rises { (a, b) } else { (b, a) };
        let (port_low, port_high) = if rises { (port_a, port_b) } else { (port_b, port_a) };
        let (from, to) = (self.nodes[low].layer, self.nodes[high].layer);
        let mut chain = vec![(low, port_low)];
        for layer in from + 1..to {
            let at = 0.0;
            let size = [0.0, 0.0];
            self.nodes.push(Node { part: None, pin: None, bar: false, layer, size, at });
            chain.push((self.nodes.len() - 1, String::new()));
        }
        chain.push((high, port_high));
        let first = self.segments.len();
        for pair in chain.windows(2) {
            let nodes = [pair[0].0, pair[1].0];
            let ports = [pair[0].1.clone(), pair[1].1.clone()];
            self.segments.push(Segment { wire, nodes, ports });
        }
        let mut segments: Vec<(usize, bool)> =
            (first..self.segments.len()).map(|k| (k, rises)).collect();
        if !rises {
            segments.reverse();
        }
        self.wires.push(Wire { links, segments });
    }

    /// True if a segment is within one layer.
    pub fn is_level(&self, segment: &Segment) -> bool {
        self.nodes[segment.nodes[0]].layer == self.nodes[segment.nodes[1]].layer
    }
}

fn width(assembly: &Assembly, part: usize) -> f64 {
    let class = class_name(&assembly.parts[part].class);
    let name = text_width(assembly.short(part), NAME_SIZE) * 1.06;
    (name.max(text_width(class, CLASS_SIZE)) + 16.0).clamp(MIN_WIDTH, MAX_WIDTH).round()
}

/// The last identifier of the full name of a class.
pub fn class_name(full: &str) -> &str {
    full.rsplit('.').next().unwrap_or(full)
}

/// The lines of a level; adds the connectors of the enclosing component to the nodes.
fn edges(assembly: &Assembly, level: usize, nodes: &mut Vec<Node>) -> Vec<Edge> {
    let mut edges: Vec<Edge> = Vec::new();
    for (k, link) in assembly.links.iter().enumerate().filter(|(_, l)| l.holder == level) {
        let ends = [0, 1].map(|i| node_of(link, i, level, nodes));
        let ports = [0, 1].map(|i| link.ends[i].port.clone());
        // All inputs that one part reads from another are one line.
        let same = edges
            .iter_mut()
            .find(|e| !link.connect && e.nodes == ends && !assembly.links[e.links[0]].connect);
        match same {
            Some(edge) => edge.links.push(k),
            None => edges.push(Edge { links: vec![k], nodes: ends, ports }),
        }
    }
    edges
}

fn node_of(link: &Link, end: usize, level: usize, nodes: &mut Vec<Node>) -> usize {
    let end = &link.ends[end];
    let pin = (end.part == level).then_some(&end.port);
    let same = |n: &Node| n.part == Some(end.part) && n.pin.as_ref() == pin;
    nodes.iter().position(same).unwrap_or_else(|| {
        let size = [(text_width(&end.port, NAME_SIZE) + 18.0).round(), PIN_HEIGHT];
        let (part, pin) = (Some(end.part), pin.cloned());
        nodes.push(Node { part, pin, bar: false, layer: 0, size, at: 0.0 });
        nodes.len() - 1
    })
}

/// Turns parts with many lines at one connector into bars; returns the part with most lines.
fn mark_bars(nodes: &mut [Node], edges: &[Edge]) -> usize {
    let mut most = (0, 0);
    for (k, node) in nodes.iter_mut().enumerate() {
        let at =
            |e: &Edge| [0, 1].into_iter().find(|i| e.nodes[*i] == k).map(|i| e.ports[i].clone());
        let mut ports: Vec<String> = edges.iter().filter_map(at).collect();
        let lines = ports.len();
        ports.sort();
        let busiest = ports.chunk_by(|a, b| a == b).map(<[String]>::len).max().unwrap_or(0);
        node.bar = busiest >= BAR;
        let weight = lines + if node.bar { edges.len() } else { 0 };
        if weight > most.1 {
            most = (k, weight);
        }
        if node.bar {
            node.size[1] = BAR_HEIGHT;
        }
    }
    most.0
}

fn distances(count: usize, edges: &[Edge], root: usize, closed: &[bool]) -> Vec<Option<usize>> {
    let mut found = vec![None; count];
    found[root] = Some(0);
    let mut queue = std::collections::VecDeque::from([root]);
    while let Some(k) = queue.pop_front() {
        for edge in edges {
            let other = match edge.nodes {
                [a, b] if a == k => b,
                [a, b] if b == k => a,
                _ => continue,
            };
            if found[other].is_none() && !closed[other] {
                found[other] = found[k].map(|d| d + 1);
                queue.push_back(other);
            }
        }
    }
    found
}

/// The end of a chain: the first node that is farthest from its middle.
fn far_end(nodes: &[Node], edges: &[Edge], middle: usize) -> usize {
    let far = distances(nodes.len(), edges, middle, &vec![false; nodes.len()]);
    let farthest = far.iter().flatten().max().copied();
    far.iter().position(|d| *d == farthest && d.is_some()).unwrap_or(middle)
}

fn assign(nodes: &mut [Node], edges: &[Edge], root: usize) {
    let closed: Vec<bool> = nodes.iter().enumerate().map(|(k, n)| n.bar && k != root).collect();
    let mut layer = distances(nodes.len(), edges, root, &closed);
    // Components that are not connected to the hub start next to its neighbours.
    let first = usize::from(nodes[root].bar);
    while let Some(k) = (0..nodes.len()).find(|&k| layer[k].is_none() && !closed[k]) {
        let own = distances(nodes.len(), edges, k, &closed);
        for (l, d) in layer.iter_mut().zip(own) {
            *l = l.or(d.map(|d| d + first));
        }
    }
    for (node, l) in nodes.iter_mut().zip(&layer) {
        node.layer = l.unwrap_or(0);
    }
    let riders = usize::from(nodes[root].bar);
    let neighbours = |k: usize, nodes: &[Node]| -> Vec<usize> {
        let other = |e: &Edge| match e.nodes {
            [a, b] if a == k && b != k => Some(b),
            [a, b] if b == k && a != k => Some(a),
            _ => None,
        };
        edges.iter().filter_map(other).filter(|&o| !closed[o]).map(|o| nodes[o].layer).collect()
    };
    // Move a part up that is in the layer of its neighbour with nothing above: lines within a layer
    // are harder to follow.
    for _ in 0..3 {
        for k in (0..nodes.len()).filter(|&k| !closed[k]) {
            let (own, around) = (nodes[k].layer, neighbours(k, nodes));
            if own > riders && around.contains(&own) && around.iter().all(|l| *l <= own) {
                nodes[k].layer += 1;
            }
        }
    }
    let mut top = (0..nodes.len()).filter(|k| !closed[*k]).map(|k| nodes[k].layer).max();
    for k in (0..nodes.len()).filter(|k| closed[*k]) {
        top = top.map(|t| t + 1);
        nodes[k].layer = top.unwrap_or(0);
    }
}
