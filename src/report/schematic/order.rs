//! Orders the nodes within layers to reduce crossings.

use super::layers::{Graph, Node};

/// Number of passes over all layers.
const PASSES: usize = 24;
/// Number of segments from which on only an eighth of the passes is made: crossings matter less in
/// pictures that large.
const LARGE_PICTURE: usize = 250;
/// Length of layers up to which every position is tried for every node; in longer layers only
/// adjacent ones.
const SHORT_LAYER: usize = 24;
/// Cost of a crossing, in positions of displacement.
const CROSSING: f64 = 6.0;
/// Cost of each position between two connected nodes of a layer.
const DISTANCE: f64 = 1.5;

/// Orders the nodes of each layer.
pub fn order(graph: &mut Graph) {
    begin(graph);
    // Keep the order of chains on a bar at the bottom: it is the order of the machine.
    let pinned = graph.layers.first().is_some_and(|l| l.iter().any(|&n| graph.nodes[n].bar));
    let is_free = |layer: usize| layer != 1 || !pinned;
    let first = graph.layers.clone();
    let count = graph.layers.len();
    let passes = if graph.segments.len() > LARGE_PICTURE { PASSES / 8 } else { PASSES };
    for pass in 0..passes {
        let mut better = false;
        let layers: Vec<usize> =
            if pass % 2 == 0 { (0..count).collect() } else { (0..count).rev().collect() };
        for layer in layers.into_iter().filter(|l| is_free(*l)) {
            better |= improve(graph, layer);
        }
        if !better {
            break;
        }
    }
    exchange(graph, &is_free);
    if pinned {
        return;
    }
    // Of a picture and its mirror image, keep the one closer to the order of declaration.
    let turned: isize = graph.layers.iter().zip(&first).map(|(a, b)| inversions(a, b)).sum();
    if turned > 0 {
        graph.layers.iter_mut().for_each(|layer| layer.reverse());
    }
}

/// Number of inverted pairs of a layer minus the number of others.
fn inversions(after: &[usize], before: &[usize]) -> isize {
    let place = |n: &usize| before.iter().position(|m| m == n);
    let places: Vec<Option<usize>> = after.iter().map(place).collect();
    let mut sum = 0;
    for (i, a) in places.iter().enumerate() {
        for b in &places[i + 1..] {
            sum += if a > b { 1 } else { -1 };
        }
    }
    sum
}

/// Swaps adjacent nodes and reorders the layers around: improvements that moving single nodes
/// misses.
fn exchange(graph: &mut Graph, is_free: &dyn Fn(usize) -> bool) {
    let count = graph.layers.len();
    if graph.layers.iter().any(|l| l.len() > SHORT_LAYER) {
        return;
    }
    let total = |graph: &Graph| (0..count).map(|l| cost(graph, l)).sum::<f64>();
    let mut best = total(graph);
    for layer in (1..count).filter(|l| is_free(*l)) {
        for i in 1..graph.layers[layer].len() {
            let before = graph.layers.clone();
            graph.layers[layer].swap(i - 1, i);
            for follower in [layer + 1, layer.wrapping_sub(1), layer] {
                if follower < count
                    && is_free(follower)
                    && (follower != layer || total(graph) < best)
                {
                    improve(graph, follower);
                }
            }
            let new = total(graph);
            if new < best - 1e-9 {
                best = new;
            } else {
                graph.layers = before;
            }
        }
    }
}

/// Initial order: neighbours at a connector of a bar with many of them in the middle of the row,
/// those of its other connectors alternately to the left and right; other layers by the position of
/// their neighbours.
fn begin(graph: &mut Graph) {
    let hub = graph.layers.first().and_then(|l| l.first()).copied();
    if let Some(hub) = hub.filter(|h| graph.nodes[*h].bar && graph.layers.len() > 1) {
        let port = |node: usize| {
            let at = |p: &&super::layers::Segment| p.nodes == [hub, node];
            graph.segments.iter().find(at).map(|p| p.ports[0].clone()).unwrap_or_default()
        };
        let row: Vec<(usize, String)> = graph.layers[1].iter().map(|n| (*n, port(*n))).collect();
        let size = |port: &str| row.iter().filter(|(_, p)| p == port).count();
        let most = row.iter().map(|(_, p)| size(p)).max().unwrap_or(0);
        let main = row.iter().find(|(_, p)| size(p) == most).map(|(_, p)| p.clone());
        let (middle, others): (Vec<_>, Vec<_>) =
            row.iter().partition(|(_, p)| Some(p) == main.as_ref());
        // Nodes connected to others of the row come first and closer to them: the piston on the
        // left, the spring on the right.
        let shares = |node: usize| {
            row.iter().any(|(other, _)| *other != node && near(graph, hub, node, *other) > 0)
        };
        let (mut others, alone): (Vec<_>, Vec<_>) =
            others.into_iter().partition(|(n, _)| shares(*n));
        others.extend(alone);
        let mut new: Vec<usize> = others.iter().step_by(2).rev().map(|(n, _)| *n).collect();
        new.extend(middle.iter().map(|(n, _)| *n));
        new.extend(others.iter().skip(1).step_by(2).map(|(n, _)| *n));
        graph.layers[1] = chained(graph, &new);
    }
    for layer in 1..graph.layers.len() {
        let place = places(graph);
        let mean = |node: usize| {
            let below = graph.segments.iter().filter(|p| p.nodes[1] == node && !graph.is_level(p));
            let below: Vec<f64> =
                below.filter(|p| !graph.nodes[p.nodes[0]].bar).map(|p| place[p.nodes[0]]).collect();
            (!below.is_empty()).then(|| below.iter().sum::<f64>() / below.len() as f64)
        };
        let mut keyed: Vec<(f64, usize)> =
            graph.layers[layer].iter().map(|&n| (mean(n).unwrap_or(place[n]), n)).collect();
        if layer > 1 || !graph.nodes[graph.layers[0][0]].bar {
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        graph.layers[layer] = keyed.into_iter().map(|(_, n)| n).collect();
    }
}

/// Orders a row so that nodes that share a neighbour are adjacent, like seals that share a chamber:
/// heaviest pairs first, as long as they form chains. Chains take the positions of their nodes.
fn chained(graph: &Graph, row: &[usize]) -> Vec<usize> {
    let hub = graph.layers[0][0];
    let mut pairs: Vec<(usize, usize, usize)> = Vec::new();
    for i in 0..row.len() {
        for j in i + 1..row.len() {
            let weight = near(graph, hub, row[i], row[j]);
            if weight > 0 {
                pairs.push((weight, i, j));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut chains: Vec<Vec<usize>> = (0..row.len()).map(|i| vec![i]).collect();
    for (_, i, j) in pairs {
        let of = |k: usize| chains.iter().position(|c| c.contains(&k));
        let (Some(a), Some(b)) = (of(i), of(j)) else { continue };
        let end = |c: &[usize], k: usize| c.first() == Some(&k) || c.last() == Some(&k);
        if a == b || !end(&chains[a], i) || !end(&chains[b], j) {
            continue;
        }
        let mut second = chains[b].clone();
        let first = &mut chains[a];
        if first.last() != Some(&i) {
            first.reverse();
        }
        if second.first() != Some(&j) {
            second.reverse();
        }
        first.extend(second);
        chains.remove(b);
    }
    for chain in &mut chains {
        if inversions(chain, &(0..row.len()).collect::<Vec<usize>>()) > 0 {
            chain.reverse();
        }
    }
    let middle = |c: &[usize]| c.iter().sum::<usize>() as f64 / c.len() as f64;
    chains.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    chains.into_iter().flatten().map(|i| row[i]).collect()
}

/// Affinity of two nodes in the row of the hub: by a line between them, and by common neighbours,
/// weighted less if many nodes share them.
fn near(graph: &Graph, hub: usize, a: usize, b: usize) -> usize {
    let around = |node: usize| {
        let other = |p: &super::layers::Segment| match p.nodes {
            [x, y] if x == node => Some(y),
            [x, y] if y == node => Some(x),
            _ => None,
        };
        // Follow a long line to its end.
        let end = |n: usize| {
            if graph.nodes[n].part.is_some() {
                return n;
            }
            let wire = graph.segments.iter().find(|p| p.nodes[1] == n).map(|p| p.wire);
            let last = graph.segments.iter().rfind(|p| Some(p.wire) == wire);
            last.map_or(n, |p| p.nodes[1])
        };
        let all = graph.segments.iter().filter_map(other).filter(|n| *n != hub);
        all.map(end).collect::<Vec<usize>>()
    };
    let (of_a, of_b) = (around(a), around(b));
    let weight = |n: &usize| if graph.nodes[*n].bar { 1 } else { 8 };
    let shared: usize = of_a.iter().filter(|n| of_b.contains(n)).map(weight).sum();
    shared + 16 * of_a.iter().filter(|n| **n == b).count()
}

/// The position of each node in its layer, from the middle.
fn places(graph: &Graph) -> Vec<f64> {
    let mut place = vec![0.0; graph.nodes.len()];
    for layer in &graph.layers {
        for (i, &n) in layer.iter().enumerate() {
            place[n] = i as f64 - 0.5 * (layer.len() as f64 - 1.0);
        }
    }
    place
}

/// Moves nodes of a layer while this reduces the cost.
fn improve(graph: &mut Graph, layer: usize) -> bool {
    let count = graph.layers[layer].len();
    let mut best = cost(graph, layer);
    let mut better = false;
    for from in 0..count {
        let reach = if count <= SHORT_LAYER { count } else { 2 };
        for to in from.saturating_sub(reach)..(from + reach + 1).min(count) {
            let before = graph.layers[layer].clone();
            let node = graph.layers[layer].remove(from);
            graph.layers[layer].insert(to, node);
            let new = cost(graph, layer);
            if new < best - 1e-9 {
                (best, better) = (new, true);
            } else {
                graph.layers[layer] = before;
            }
        }
    }
    better
}

/// Cost of a layer: crossings in the adjacent channels, and distances of connected nodes.
fn cost(graph: &Graph, layer: usize) -> f64 {
    let place = places(graph);
    let bar = |n: usize| graph.nodes[n].bar;
    let free = |n: &Node| !n.bar;
    let mut sum = 0.0;
    for low in layer.saturating_sub(1)..=layer {
        let between: Vec<(f64, f64)> = graph
            .segments
            .iter()
            .filter(|p| graph.nodes[p.nodes[0]].layer == low && !graph.is_level(p))
            .filter(|p| free(&graph.nodes[p.nodes[0]]) && free(&graph.nodes[p.nodes[1]]))
            .map(|p| (place[p.nodes[0]], place[p.nodes[1]]))
            .collect();
        for (i, a) in between.iter().enumerate() {
            sum += 0.1 * (a.0 - a.1).abs();
            let crossing = |b: &&(f64, f64)| (a.0 - b.0) * (a.1 - b.1) < 0.0;
            sum += CROSSING * between[i + 1..].iter().filter(crossing).count() as f64;
        }
    }
    for p in graph.segments.iter().filter(|p| graph.nodes[p.nodes[0]].layer == layer) {
        let [a, b] = p.nodes;
        if !graph.is_level(p) || bar(a) || bar(b) {
            continue;
        }
        let (left, right) = (place[a].min(place[b]), place[a].max(place[b]));
        sum += DISTANCE * (right - left);
        // Lines that rise between the two cross their connection.
        let rising = graph.segments.iter().filter(|q| {
            let at = place[q.nodes[0]];
            graph.nodes[q.nodes[0]].layer == layer && !graph.is_level(q) && left < at && at < right
        });
        sum += CROSSING * rising.count() as f64;
    }
    sum
}
