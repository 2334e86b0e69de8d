//! The catalogue of effects: what a class of `lib/Effects` says about itself in its annotation.

use crate::driver::compile::{Request, Session};
use crate::flatten::inventory::{Inventory, InventoryConnector};

/// An effect as its class describes it.
#[derive(Clone, Debug)]
pub struct Effect {
    /// Full name of the class.
    pub class: String,
    /// Parameters that are zero without the effect: array elements one by one.
    pub amplitudes: Vec<Amplitude>,
    /// Parameters of its shape, with what to start from.
    pub shapes: Vec<(String, Vec<Start>)>,
    /// Connectors of a host that it is attached to; empty: attached wherever its connectors fit.
    pub host: Vec<String>,
    /// Inputs, and the variables of the host that they are bound to: the first that exists.
    pub binds: Vec<(String, Vec<String>)>,
    /// A sentence with `%at` for the place.
    pub explains: String,
    /// Its connectors.
    pub connectors: Vec<InventoryConnector>,
    /// It stands between a signal's variable and the recording.
    pub of_signal: bool,
    /// Units of its parameters.
    pub units: Vec<(String, String)>,
    /// It is built into components of the class, and only set there.
    pub built_in: bool,
    /// Settings, besides its parameters, that make it part of a model.
    pub with: Vec<(String, String)>,
}

/// An amplitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitude {
    /// Its name, with a subscript for an element.
    pub name: String,
    /// Only positive values make sense.
    pub positive: bool,
}

/// What a parameter of the shape starts from.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// This value.
    Value(f64),
    /// So many values over the range of a variable.
    Spread(String, usize),
    /// The least value of a variable.
    Least(String),
    /// The greatest value of a variable.
    Greatest(String),
    /// This multiple of a variable's range.
    Multiple(f64, String),
}

impl Start {
    /// The variable whose range it needs.
    pub fn variable(&self) -> Option<&str> {
        match self {
            Start::Value(_) => None,
            Start::Spread(v, _) | Start::Least(v) | Start::Greatest(v) | Start::Multiple(_, v) => {
                Some(v)
            }
        }
    }

    /// The values that it stands for, where its variable covers this range.
    pub fn values(&self, (low, high): (f64, f64)) -> Vec<f64> {
        match *self {
            Start::Value(x) => vec![x],
            Start::Least(_) => vec![low],
            Start::Greatest(_) => vec![high],
            Start::Multiple(factor, _) => vec![factor * (high - low)],
            // In the middles of equal parts.
            Start::Spread(_, n) => {
                (0..n).map(|k| low + (high - low) * (k as f64 + 0.5) / n as f64).collect()
            }
        }
    }
}

/// All effects of the packages that are found with a request, in order of their names, and after them
/// those that are built into components of the model; classes whose annotation can not be understood are
/// left out. `units` are those of the model's variables, by name.
pub fn catalogue(
    session: &mut Session,
    request: &Request,
    packages: &[String],
    model: &Inventory,
    units: &[(String, String)],
) -> Vec<Effect> {
    let mut effects = Vec::new();
    let mut known = Vec::new();
    for package in packages {
        let classes = session.members(request, package);
        for (class, texts) in session.annotated(request, &classes) {
            known.push(class.clone());
            effects.extend(described(&class, &texts, "effect").and_then(|e| component(e, request)));
        }
    }
    let mut hosts: Vec<String> = model.parts.iter().map(|p| p.class.clone()).collect();
    hosts.sort();
    hosts.dedup();
    hosts.retain(|class| !class.is_empty() && !known.contains(class));
    for (class, texts) in session.annotated(request, &hosts) {
        let Some(mut effect) = described(&class, &texts, "effect") else { continue };
        let Some(host) = model.parts.iter().find(|p| p.class == class) else { continue };
        let prefix = format!("{}.", host.name);
        let own =
            |(n, u): &(String, String)| Some((n.strip_prefix(&prefix)?.to_owned(), u.clone()));
        effect.units = units.iter().filter_map(own).collect();
        effect.built_in = true;
        effects.push(effect);
    }
    effects
}

/// Inflows that are free over time, one for each kind of connector: the questions where a balance does
/// not close.
pub fn unknowns(session: &mut Session, request: &Request, packages: &[String]) -> Vec<Effect> {
    let mut all = Vec::new();
    for package in packages {
        let classes = session.members(request, package);
        for (class, texts) in session.annotated(request, &classes) {
            all.extend(described(&class, &texts, "unknown").and_then(|e| component(e, request)));
        }
    }
    all
}

fn described(class: &str, texts: &[(String, String)], kind: &str) -> Option<Effect> {
    let of = |key: &str| texts.iter().find(|(k, _)| k == key).map(|(_, t)| t.as_str());
    let mut effect = read(class, of(kind)?)?;
    effect.explains = of("explains").unwrap_or("%at has this effect.").to_owned();
    Some(effect)
}

/// An effect that is a component of its own, with what its class says about its connectors.
fn component(mut effect: Effect, request: &Request) -> Option<Effect> {
    let own = Request {
        file: None,
        appended: None,
        settings: Vec::new(),
        model: Some(effect.class.clone()),
        ..request.clone()
    };
    let (flat, inventory) = Session::default().inspect(&own).ok()?;
    complete(&mut effect, &inventory);
    let names: Vec<String> = flat.variables.iter().map(|v| v.name.clone()).collect();
    effect.amplitudes = elements(&effect.amplitudes, &names);
    let units = flat.variables.iter().map(|v| (v.name.clone(), v.unit.to_string()));
    effect.units = units.collect();
    Some(effect)
}

fn complete(effect: &mut Effect, inventory: &Inventory) {
    if let Some(own) = inventory.parts.first() {
        effect.connectors = own.connectors.clone();
    }
    effect.of_signal = effect.connectors.is_empty();
    for input in &inventory.inputs {
        if !effect.of_signal && !effect.binds.iter().any(|(name, _)| name == input) {
            effect.binds.push((input.clone(), vec![input.clone()]));
        }
    }
}

/// Array amplitudes element by element.
fn elements(amplitudes: &[Amplitude], names: &[String]) -> Vec<Amplitude> {
    let mut out = Vec::new();
    for a in amplitudes {
        let prefix = format!("{}[", a.name);
        for name in names.iter().filter(|n| **n == a.name || n.starts_with(&prefix)) {
            out.push(Amplitude { name: name.clone(), positive: a.positive });
        }
    }
    out
}

/// `amplitude=F; s_0=s(15); ...`
fn read(class: &str, text: &str) -> Option<Effect> {
    let mut effect = Effect {
        class: class.to_owned(),
        amplitudes: Vec::new(),
        shapes: Vec::new(),
        host: Vec::new(),
        binds: Vec::new(),
        explains: String::new(),
        connectors: Vec::new(),
        of_signal: false,
        units: Vec::new(),
        built_in: false,
        with: Vec::new(),
    };
    for entry in text.split(';').map(str::trim).filter(|e| !e.is_empty()) {
        if let Some(bind) = entry.strip_prefix("bind ") {
            let (input, variables) = bind.split_once('=')?;
            let variables = variables.split('|').map(|v| v.trim().to_owned()).collect();
            effect.binds.push((input.trim().to_owned(), variables));
            continue;
        }
        if let Some(setting) = entry.strip_prefix("with ") {
            let (name, value) = setting.split_once('=')?;
            effect.with.push((name.trim().to_owned(), value.trim().to_owned()));
            continue;
        }
        let (key, value) = entry.split_once('=')?;
        let items = value.split(',').map(str::trim);
        match key.trim() {
            "amplitude" => {
                effect.amplitudes = items
                    .map(|item| Amplitude {
                        name: item.trim_end_matches(">0").trim().to_owned(),
                        positive: item.ends_with(">0"),
                    })
                    .collect();
            }
            "host" => effect.host = items.map(str::to_owned).collect(),
            shape => {
                let starts: Option<Vec<Start>> = items.map(start).collect();
                effect.shapes.push((shape.to_owned(), starts?));
            }
        }
    }
    (!effect.amplitudes.is_empty()).then_some(effect)
}

fn start(item: &str) -> Option<Start> {
    if let Ok(value) = item.parse() {
        return Some(Start::Value(value));
    }
    let (head, rest) = item.split_once('(')?;
    let inner = rest.strip_suffix(')')?.trim().to_owned();
    match head.trim() {
        "min" => Some(Start::Least(inner)),
        "max" => Some(Start::Greatest(inner)),
        variable => match inner.parse() {
            Ok(n) => Some(Start::Spread(variable.to_owned(), n)),
            Err(_) => {
                let (factor, function) = variable.split_once('*')?;
                let factor = factor.trim().parse().ok()?;
                (function.trim() == "span").then_some(Start::Multiple(factor, inner))
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_are_read() {
        let text = "amplitude=c>0,F_0; s_0=s(15); w=0.1e-3,0.02*span(u); host=spool,port_a; bind m_flow=gap.m_flow|m_flow; a=min(s)";
        let effect = read("Effects.X", text).unwrap();
        let amplitude = |name: &str, positive| Amplitude { name: name.into(), positive };
        assert_eq!(effect.amplitudes, [amplitude("c", true), amplitude("F_0", false)]);
        assert_eq!(effect.shapes[0].1, [Start::Spread("s".into(), 15)]);
        assert_eq!(effect.shapes[1].1, [Start::Value(1e-4), Start::Multiple(0.02, "u".into())]);
        assert_eq!(effect.shapes[2].1, [Start::Least("s".into())]);
        assert_eq!(effect.host, ["spool", "port_a"]);
        assert_eq!(effect.binds[0].1, ["gap.m_flow", "m_flow"]);
        let built_in = read("P.Source", "with has_line=true; amplitude=R>0").unwrap();
        assert_eq!(built_in.with, [("has_line".to_owned(), "true".to_owned())]);
        assert!(read("Effects.Y", "w=1").is_none());
    }

    #[test]
    fn a_spread_keeps_off_the_ends() {
        assert_eq!(Start::Spread("s".into(), 2).values((0.0, 4.0)), [1.0, 3.0]);
        assert_eq!(Start::Multiple(0.5, "s".into()).values((1.0, 4.0)), [1.5]);
    }
}
