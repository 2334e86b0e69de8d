//! The places at which an effect can be attached, from the compiler's inventory of connectors and
//! connections.

use crate::base::index::FastSet;
use crate::calibrate::plan::Plan;
use crate::flatten::inventory::{Inventory, InventoryConnector, InventoryPart};

use super::catalogue::Effect;

/// A way to attach an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The components that it is attached to.
    pub at: Vec<String>,
    /// Connectors of the effect, and those of the model to connect them with.
    pub connections: Vec<(String, String)>,
    /// Inputs of the effect, and the variables that they are bound to.
    pub binds: Vec<(String, String)>,
    /// The signal that it modifies, by position in the plan.
    pub signal: Option<usize>,
    /// Further hosts of the same effect: one phenomenon at several places.
    pub others: Vec<Place>,
}

impl Place {
    /// Components, without anything to connect or to bind.
    pub fn at(components: &[String]) -> Place {
        Place {
            at: components.to_vec(),
            connections: Vec::new(),
            binds: Vec::new(),
            signal: None,
            others: Vec::new(),
        }
    }

    /// The single places.
    pub fn members(&self) -> Vec<Place> {
        if self.others.is_empty() {
            return vec![self.clone()];
        }
        let own = Place {
            at: self.at.iter().take(1).cloned().collect(),
            others: Vec::new(),
            ..self.clone()
        };
        std::iter::once(own).chain(self.others.iter().cloned()).collect()
    }
}

/// Largest number of hosts that have an effect together.
const MAX_HOSTS: usize = 8;

/// All places for an effect.
pub fn places(
    effect: &Effect,
    inventory: &Inventory,
    variables: &FastSet<&str>,
    plan: &Plan,
) -> Vec<Place> {
    if effect.of_signal {
        return signals(plan);
    }
    if effect.built_in || !effect.host.is_empty() {
        let mut all: Vec<Place> = match effect.built_in {
            true => inventory.parts.iter().filter_map(|p| built_in(effect, p)).collect(),
            false => inventory.parts.iter().filter_map(|p| hosted(effect, p, variables)).collect(),
        };
        if effect.amplitudes.len() == 1 && (2..=MAX_HOSTS).contains(&all.len()) {
            let at = all.iter().flat_map(|p| p.at.iter().cloned()).collect();
            let others = all[1..].to_vec();
            all.push(Place { at, others, ..all[0].clone() });
        }
        return all;
    }
    if !effect.binds.is_empty() {
        return Vec::new();
    }
    match effect.connectors.as_slice() {
        [only] => nodes(only, inventory),
        [a, b] if a.class == b.class => pairs(a, b, inventory),
        _ => Vec::new(),
    }
}

fn signals(plan: &Plan) -> Vec<Place> {
    let place = |(k, s): (usize, &crate::calibrate::plan::Signal)| Place {
        at: vec![s.column.clone()],
        connections: Vec::new(),
        binds: vec![("u".to_owned(), s.variable.clone())],
        signal: Some(k),
        others: Vec::new(),
    };
    plan.signals.iter().enumerate().map(place).collect()
}

fn built_in(effect: &Effect, part: &InventoryPart) -> Option<Place> {
    (part.class == effect.class).then(|| Place {
        at: vec![part.name.clone()],
        connections: Vec::new(),
        binds: Vec::new(),
        signal: None,
        others: Vec::new(),
    })
}

fn hosted(effect: &Effect, part: &InventoryPart, variables: &FastSet<&str>) -> Option<Place> {
    if part.name.is_empty() {
        return None;
    }
    let mut connections = Vec::new();
    for end in &effect.connectors {
        let namesake = part.connectors.iter().find(|c| c.name == end.name);
        let fits = effect.host.contains(&end.name) && namesake?.class == end.class;
        fits.then_some(())?;
        connections.push((end.name.clone(), format!("{}.{}", part.name, end.name)));
    }
    let mut binds = Vec::new();
    for (input, choices) in &effect.binds {
        let full = choices.iter().map(|c| format!("{}.{c}", part.name));
        binds.push((input.clone(), full.into_iter().find(|v| variables.contains(v.as_str()))?));
    }
    let at = vec![part.name.clone()];
    Some(Place { at, connections, binds, signal: None, others: Vec::new() })
}

/// One place for each connection set of the class. It is named after the component that has the fewest
/// connectors of the class: a volume rather than the restriction that leads to it.
fn nodes(end: &InventoryConnector, inventory: &Inventory) -> Vec<Place> {
    let mut found: Vec<(usize, &InventoryPart, &InventoryConnector)> = Vec::new();
    for (part, connector) in ends(inventory, &end.class) {
        let rank = |p: &InventoryPart| {
            (p.connectors.iter().filter(|c| c.class == end.class).count(), p.name.len())
        };
        match found.iter_mut().find(|(node, ..)| *node == connector.node) {
            None => found.push((connector.node, part, connector)),
            Some(entry) if rank(part) < rank(entry.1) => *entry = (connector.node, part, connector),
            Some(_) => {}
        }
    }
    let place = |(_, part, connector): (usize, &InventoryPart, &InventoryConnector)| Place {
        at: vec![part.name.clone()],
        connections: vec![(end.name.clone(), format!("{}.{}", part.name, connector.name))],
        binds: Vec::new(),
        signal: None,
        others: Vec::new(),
    };
    found.into_iter().map(place).collect()
}

/// Pairs of connection sets that a component with two connectors of the class bridges, and every volume with
/// ambient. If several components bridge a pair, it is named after the one with most connectors: a seal
/// rather than a line.
fn pairs(a: &InventoryConnector, b: &InventoryConnector, inventory: &Inventory) -> Vec<Place> {
    let mut parts: Vec<&InventoryPart> =
        inventory.parts.iter().filter(|p| !p.name.is_empty()).collect();
    parts.sort_by_key(|p| std::cmp::Reverse(p.connectors.len()));
    let mut known: Vec<(usize, usize)> = Vec::new();
    let mut out = Vec::new();
    let mut add = |at: &str, x: (String, usize), y: (String, usize)| {
        let pair = (x.1.min(y.1), x.1.max(y.1));
        if pair.0 == pair.1 || known.contains(&pair) {
            return;
        }
        known.push(pair);
        let connections = vec![(a.name.clone(), x.0), (b.name.clone(), y.0)];
        out.push(Place {
            at: vec![at.to_owned()],
            connections,
            binds: Vec::new(),
            signal: None,
            others: Vec::new(),
        });
    };
    let path =
        |p: &InventoryPart, c: &InventoryConnector| (format!("{}.{}", p.name, c.name), c.node);
    for part in &parts {
        let own: Vec<&InventoryConnector> =
            part.connectors.iter().filter(|c| c.class == a.class).collect();
        if let [x, y] = own.as_slice() {
            add(&part.name, path(part, x), path(part, y));
        }
    }
    let ambient = ends(inventory, &a.class).find(|(p, _)| p.class.ends_with("Ambient"));
    if let Some((ambient, end)) = ambient {
        for (part, connector) in ends(inventory, &a.class) {
            let alone = part.connectors.iter().filter(|c| c.class == a.class).count() == 1;
            if alone && part.name != ambient.name {
                add(&part.name, path(part, connector), path(ambient, end));
            }
        }
    }
    out
}

fn ends<'a>(
    inventory: &'a Inventory,
    class: &'a str,
) -> impl Iterator<Item = (&'a InventoryPart, &'a InventoryConnector)> {
    let parts = inventory.parts.iter().filter(|p| !p.name.is_empty());
    parts
        .flat_map(|p| p.connectors.iter().map(move |c| (p, c)))
        .filter(move |(_, c)| c.class == class)
}
