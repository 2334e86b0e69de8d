//! The places at which an effect can be attached, from the compiler's inventory of connectors and
//! connections.

use crate::base::index::FastSet;
use crate::calibrate::plan::Plan;
use crate::flatten::inventory::{Inventory, InventoryConnector, InventoryPart};

use super::adapter::{Adapter, adapter, is_alike, is_compatible};
use super::catalogue::{Effect, SENSOR_INPUT};

/// A way to attach an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The components that it is attached to.
    pub at: Vec<String>,
    /// Connectors of the effect, and those of the model to connect them with.
    pub connections: Vec<(String, String)>,
    /// Adapters for those of the model's connectors that are of another class.
    pub adapters: Vec<Adapter>,
    /// Inputs of the effect, and the variables that they are bound to.
    pub binds: Vec<(String, String)>,
    /// The signal that it modifies, by position in the plan.
    pub signal: Option<usize>,
    /// Of a term: its equation is solved for a variable, so that amplitudes that are positive elsewhere may have either sign.
    pub is_signed: bool,
    /// Further hosts of the same effect: one phenomenon at several places.
    pub others: Vec<Place>,
}

impl Place {
    /// Components, without anything to connect or to bind.
    pub fn at(components: &[String]) -> Place {
        Place {
            at: components.to_vec(),
            connections: Vec::new(),
            adapters: Vec::new(),
            binds: Vec::new(),
            signal: None,
            is_signed: false,
            others: Vec::new(),
        }
    }

    /// True for the same components, connections and signal, and the same variables, whatever the inputs are called that they
    /// are bound to.
    pub fn is_same_over(&self, other: &Place) -> bool {
        let of = |place: &Place, name: &String| place.binds.iter().any(|(_, v)| v == name);
        self.at == other.at
            && self.signal == other.signal
            && self.connections == other.connections
            && self.binds.len() == other.binds.len()
            && self.binds.iter().all(|(_, name)| of(other, name))
    }

    /// True for two components that nothing bridges.
    pub fn is_between(&self) -> bool {
        self.at.len() == 2 && self.connections.len() == 2 && self.others.is_empty()
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
pub const MAX_HOSTS: usize = 8;

/// Most connection sets of a model in which flows between volumes that nothing bridges are hypotheses: their number grows
/// with the square.
const MAX_NODES: usize = 8;

/// Names of classes with one connector whose potential is that of the surroundings.
const SURROUNDINGS: [&str; 4] = ["Ambient", "Ground", "FixedTemperature", "PrescribedTemperature"];

/// The name of classes, of this library and of others, that fix a point in space.
const FIXED: &str = "Fixed";

/// All places for an effect.
pub fn places(
    effect: &Effect,
    inventory: &Inventory,
    variables: &FastSet<&str>,
    (plan, inner_signals): (&Plan, &[String]),
) -> Vec<Place> {
    if effect.of_signal {
        return match effect.other_quantity() {
            Some(input) => cross_talk(input, plan),
            None => signals(plan),
        };
    }
    if effect.acts.is_some() {
        return passages(effect, plan, inner_signals);
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
    match effect.connectors.as_slice() {
        [a, b] if !effect.binds.is_empty() && a.class == b.class => {
            bridged(effect, a, b, (inventory, variables))
        }
        _ if !effect.binds.is_empty() => Vec::new(),
        [only] => nodes(only, inventory),
        [a, b] if a.class == b.class => {
            let fixed = if effect.between_moving { fixed_nodes(a, inventory) } else { Vec::new() };
            pairs(a, b, inventory, &fixed)
        }
        _ => Vec::new(),
    }
}

/// Why there is no place for an effect, as half a sentence.
pub fn why_nowhere(effect: &Effect, inventory: &Inventory) -> String {
    let short = |class: &str| class.rsplit('.').next().unwrap_or(class).to_owned();
    if effect.built_in {
        return "the model has no component of this class".to_owned();
    }
    let missing = effect.connectors.iter().find(|c| ends(inventory, c).next().is_none());
    if let Some(missing) = missing {
        return format!("the model has no connector like `{}`", missing.class);
    }
    if !effect.host.is_empty() {
        let names: Vec<String> =
            effect.connectors.iter().map(|c| format!("`{}`", c.name)).collect();
        let inputs: Vec<String> = effect.binds.iter().map(|(i, _)| format!("`{i}`")).collect();
        let inputs = match inputs.is_empty() {
            true => String::new(),
            false => format!(" and variables for its inputs {}", inputs.join(", ")),
        };
        return format!("no component has the connectors {}{inputs}", names.join(", "));
    }
    match (effect.binds.first(), effect.connectors.as_slice()) {
        (Some((input, _)), _) => {
            format!(
                "nothing says what its input `{input}` is bound to, since it has no entry `host`"
            )
        }
        (None, [a, b]) if a.class == b.class => {
            format!("no component has two connectors like `{}`", short(&a.class))
        }
        _ => "without an entry `host`, it may have one connector, or two of one class".to_owned(),
    }
}

fn signals(plan: &Plan) -> Vec<Place> {
    let place = |(k, s): (usize, &crate::calibrate::plan::Signal)| Place {
        binds: vec![(SENSOR_INPUT.to_owned(), s.variable.clone())],
        signal: Some(k),
        ..Place::at(std::slice::from_ref(&s.column))
    };
    plan.signals.iter().enumerate().map(place).collect()
}

/// Every signal with every other quantity that is known during a run: those of the other signals, and the inputs that
/// recordings drive. An offset for each condition would describe any few recordings.
fn cross_talk(input: &str, plan: &Plan) -> Vec<Place> {
    let others: Vec<&String> = plan
        .signals
        .iter()
        .map(|s| &s.variable)
        .chain(plan.inputs.iter().map(|driven| &driven.input))
        .collect();
    let with_others = |place: Place| {
        let own = place.binds[0].1.clone();
        let another = others.iter().filter(move |name| ***name != own);
        another.map(move |name| {
            let mut place = place.clone();
            place.binds.push((input.to_owned(), (*name).clone()));
            place
        })
    };
    signals(plan).into_iter().flat_map(with_others).collect()
}

/// The signals that an actuator may act on: inputs of the model that recordings drive, and signals within it. What must read
/// the recording itself acts on inputs only: a dead time in a loop would bound the steps.
fn passages(effect: &Effect, plan: &Plan, inner_signals: &[String]) -> Vec<Place> {
    let Some((own, _)) = effect.binds.first() else { return Vec::new() };
    let place = |signal: &String| Place {
        binds: vec![(own.clone(), signal.clone())],
        ..Place::at(std::slice::from_ref(signal))
    };
    let inner_signals = if effect.is_first { &[] } else { inner_signals };
    plan.inputs.iter().map(|driven| &driven.input).chain(inner_signals).map(place).collect()
}

fn built_in(effect: &Effect, part: &InventoryPart) -> Option<Place> {
    let fits = part.class == effect.class && !is_element(part);
    fits.then(|| Place::at(std::slice::from_ref(&part.name)))
}

fn hosted(effect: &Effect, part: &InventoryPart, variables: &FastSet<&str>) -> Option<Place> {
    if part.name.is_empty() || is_element(part) {
        return None;
    }
    let mut connections = Vec::new();
    for end in &effect.connectors {
        let namesake = part.connectors.iter().find(|c| c.name == end.name);
        let fits = effect.host.contains(&end.name) && namesake?.class == end.class;
        fits.then_some(())?;
        connections.push((end.name.clone(), format!("{}.{}", part.name, end.name)));
    }
    let binds = bound(effect, part, variables)?;
    Some(Place { connections, binds, ..Place::at(std::slice::from_ref(&part.name)) })
}

/// The variables of a component that the inputs of an effect are bound to, if it has them all.
fn bound(
    effect: &Effect,
    part: &InventoryPart,
    variables: &FastSet<&str>,
) -> Option<Vec<(String, String)>> {
    let variable = |(input, choices): &(String, Vec<String>)| {
        let mut full = choices.iter().map(|c| format!("{}.{c}", part.name));
        Some((input.clone(), full.find(|v| variables.contains(v.as_str()))?))
    };
    effect.binds.iter().map(variable).collect()
}

/// Every component with two connectors like those of the effect, and with the variables that its inputs are bound to.
fn bridged(
    effect: &Effect,
    a: &InventoryConnector,
    b: &InventoryConnector,
    (inventory, variables): (&Inventory, &FastSet<&str>),
) -> Vec<Place> {
    let of_part = |part: &InventoryPart| {
        let own: Vec<&InventoryConnector> = alike(part, a).collect();
        let [x, y] = own.as_slice() else { return None };
        let fits = !part.name.is_empty() && x.node != y.node && is_alike(a, x, y);
        let binds = bound(effect, part, variables).filter(|_| fits)?;
        Some(Place { binds, ..attached(part, [(a, (part, x)), (b, (part, y))]) })
    };
    inventory.parts.iter().filter_map(of_part).collect()
}

/// True for an element of an array of components.
fn is_element(part: &InventoryPart) -> bool {
    part.name.ends_with(']')
}

/// One place for each connection set with connectors like that of the effect. It is named after the component
/// that has the fewest of them: a volume rather than the restriction that leads to it.
fn nodes(end: &InventoryConnector, inventory: &Inventory) -> Vec<Place> {
    let mut found: Vec<(usize, &InventoryPart, &InventoryConnector)> = Vec::new();
    for (part, connector) in ends(inventory, end) {
        let rank = |p: &InventoryPart| (alike(p, end).count(), p.name.len());
        match found.iter_mut().find(|(node, ..)| *node == connector.node) {
            None => found.push((connector.node, part, connector)),
            Some(entry) if rank(part) < rank(entry.1) => *entry = (connector.node, part, connector),
            Some(_) => {}
        }
    }
    found.into_iter().map(|(_, part, other)| attached(part, [(end, (part, other))])).collect()
}

/// Pairs of connection sets that a component with two connectors like those of the effect bridges, and every
/// volume with the surroundings; in a circuit, every connection set with ground. If several components bridge a
/// pair, it is named after the one with most connectors: a seal rather than a line. In a model with few volumes, also
/// every two of them that nothing bridges. None of them is one of the connection sets `without`.
fn pairs(
    a: &InventoryConnector,
    b: &InventoryConnector,
    inventory: &Inventory,
    without: &[usize],
) -> Vec<Place> {
    type End<'a> = (&'a InventoryPart, &'a InventoryConnector);
    let mut parts: Vec<&InventoryPart> =
        inventory.parts.iter().filter(|p| !p.name.is_empty()).collect();
    parts.sort_by_key(|p| std::cmp::Reverse(p.connectors.len()));
    let mut known: Vec<(usize, usize)> = Vec::new();
    let mut out = Vec::new();
    let is_left_out = |pair: (usize, usize)| {
        pair.0 == pair.1 || [pair.0, pair.1].iter().any(|node| without.contains(node))
    };
    let mut add = |at: &InventoryPart, x: End<'_>, y: End<'_>| {
        let pair = (x.1.node.min(y.1.node), x.1.node.max(y.1.node));
        if is_left_out(pair) || known.contains(&pair) {
            return;
        }
        known.push(pair);
        out.push(attached(at, [(a, x), (b, y)]));
    };
    for part in &parts {
        let own: Vec<&InventoryConnector> = alike(part, a).collect();
        if let [x, y] = own.as_slice()
            && is_alike(a, x, y)
        {
            add(part, (part, x), (part, y));
        }
    }
    let is_surroundings = |p: &InventoryPart| {
        alike(p, a).count() == 1 && SURROUNDINGS.iter().any(|name| p.class.ends_with(*name))
    };
    let surroundings = ends(inventory, a).find(|(p, _)| is_surroundings(p));
    if let Some(surroundings) = surroundings {
        let everywhere = surroundings.0.class.ends_with("Ground");
        let mut others: Vec<End<'_>> =
            ends(inventory, a).filter(|(p, _)| !is_surroundings(p)).collect();
        if everywhere {
            others.sort_by_key(|(p, _)| alike(p, a).count());
        }
        for (part, connector) in others {
            if everywhere || alike(part, a).count() == 1 {
                add(part, (part, connector), surroundings);
            }
        }
    }
    let is_small = nodes(a, inventory).len() <= MAX_NODES;
    let is_volume = |p: &InventoryPart| alike(p, a).count() == 1 && !is_surroundings(p);
    let of_volumes = ends(inventory, a).filter(|(p, _)| is_small && is_volume(p) && !is_element(p));
    let volumes: Vec<End<'_>> = of_volumes.collect();
    for (k, x) in volumes.iter().enumerate() {
        for y in &volumes[k + 1..] {
            let pair = (x.1.node.min(y.1.node), x.1.node.max(y.1.node));
            if !is_left_out(pair) && !known.contains(&pair) {
                known.push(pair);
                let at = [x.0.name.clone(), y.0.name.clone()];
                out.push(Place { at: at.to_vec(), ..attached(x.0, [(a, *x), (b, *y)]) });
            }
        }
    }
    out
}

/// The connection sets of a point that is fixed in space, among those with connectors like that of an effect.
fn fixed_nodes(own: &InventoryConnector, inventory: &Inventory) -> Vec<usize> {
    let is_fixed = |p: &InventoryPart| p.class.rsplit('.').next() == Some(FIXED);
    ends(inventory, own).filter(|(p, _)| is_fixed(p)).map(|(_, end)| end.node).collect()
}

/// The place where connectors of an effect meet connectors of the model.
fn attached<const N: usize>(
    at: &InventoryPart,
    ends: [(&InventoryConnector, (&InventoryPart, &InventoryConnector)); N],
) -> Place {
    let path = |(part, other): (&InventoryPart, &InventoryConnector)| {
        format!("{}.{}", part.name, other.name)
    };
    Place {
        connections: ends.iter().map(|(own, end)| (own.name.clone(), path(*end))).collect(),
        adapters: ends.iter().filter_map(|(own, end)| adapter(own, end.1, path(*end))).collect(),
        ..Place::at(std::slice::from_ref(&at.name))
    }
}

/// The connectors of a component to which one of an effect can be attached.
fn alike<'a>(
    part: &'a InventoryPart,
    own: &'a InventoryConnector,
) -> impl Iterator<Item = &'a InventoryConnector> {
    part.connectors.iter().filter(move |c| is_compatible(own, c))
}

/// The same of all components.
fn ends<'a>(
    inventory: &'a Inventory,
    own: &'a InventoryConnector,
) -> impl Iterator<Item = (&'a InventoryPart, &'a InventoryConnector)> {
    let parts = inventory.parts.iter().filter(|p| !p.name.is_empty());
    parts.flat_map(move |p| alike(p, own).map(move |c| (p, c)))
}
