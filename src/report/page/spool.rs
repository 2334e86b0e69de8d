//! The animation of moving parts: a body between its stops, the seals on it and the chambers that they
//! separate, found from the roles that libraries declare ([`View`]) and from the connections.
//!
//! A seal is a component with a contact and a control edge. The body is the component that most seals are
//! connected to; without seals, the first component with a position between two stops. Seals stand in the
//! order of the diagram, which is the order of the chambers between them.

use crate::base::index::FastMap;
use crate::io::json::Json;
use crate::ir::assembly::{Assembly, Domain};
use crate::report::schematic::{picture, sequence};

use super::view::{Contact, View};

/// The variables and parameters of a model by name, and the roles that they play.
pub struct Known<'a> {
    /// The declared roles.
    pub view: &'a View,
    /// Position of each recorded variable.
    pub variables: &'a FastMap<&'a str, usize>,
    /// Value of each numeric parameter, SI.
    pub numbers: &'a FastMap<&'a str, f64>,
    /// Literal of each parameter that is an enumeration, such as `CloseToOpen`.
    pub literals: &'a FastMap<&'a str, String>,
    /// The least and the greatest value of a recorded variable over all runs.
    pub range: &'a dyn Fn(usize) -> (f64, f64),
}

impl Known<'_> {
    fn variable(&self, part: &str, name: &str) -> Option<usize> {
        self.variables.get(join(part, name).as_str()).copied()
    }

    fn number(&self, part: &str, name: &str) -> Option<f64> {
        self.numbers.get(join(part, name).as_str()).copied()
    }

    /// The parameter with a role.
    fn parameter(&self, part: &str, role: &str) -> Option<f64> {
        self.number(part, self.view.name(role)?)
    }

    /// The stops of a body.
    fn stops(&self, part: &str) -> Option<[f64; 2]> {
        let [low, high] = self.view.names("body.stops") else { return None };
        Some([self.number(part, low)?, self.number(part, high)?])
    }

    /// The contact of a seal, with its literal.
    fn contact(&self, part: &str) -> Option<(Contact, &str)> {
        let name = join(part, self.view.name("seal.contact")?);
        let literal = self.literals.get(name.as_str())?;
        Some((self.view.contact(literal)?, literal))
    }
}

fn join(part: &str, name: &str) -> String {
    if part.is_empty() { name.to_owned() } else { format!("{part}.{name}") }
}

/// A body that moves along its axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Spool {
    /// The component.
    pub name: String,
    /// Its position, as the index of a recorded variable.
    pub s: usize,
    /// Its stops or, without any, the range of its motion, m.
    pub stops: [f64; 2],
    /// From left to right.
    pub seals: Vec<Seal>,
    /// The chambers between the seals.
    pub chambers: Vec<Chamber>,
    /// Pistons and springs that drive it.
    pub drives: Vec<Drive>,
}

/// A seal.
#[derive(Clone, PartialEq, Debug)]
pub struct Seal {
    /// The component.
    pub name: String,
    /// Its description.
    pub description: String,
    /// The literal of its contact, as the library calls it.
    pub contact: String,
    /// Where it touches the housing.
    pub touches: Contact,
    /// Stroke at its control edge, m.
    pub edge: f64,
    /// Whether it touches the housing.
    pub closed: Option<usize>,
    /// Share of its flow path that is open.
    pub opening: Option<usize>,
    /// Flow from its first port to its second.
    pub flow: Option<usize>,
    /// The chambers to its left and right.
    pub sides: [Option<usize>; 2],
    /// Its first port lies on the right.
    pub turned: bool,
}

/// A chamber between seals.
#[derive(Clone, PartialEq, Debug)]
pub struct Chamber {
    /// The component that holds the fluid.
    pub name: String,
    /// Its pressure.
    pub p: Option<usize>,
    /// Components connected to it.
    pub ports: Vec<String>,
}

/// A piston or a spring that drives the body.
#[derive(Clone, PartialEq, Debug)]
pub struct Drive {
    /// The component.
    pub name: String,
    /// A piston, otherwise a spring.
    pub piston: bool,
    /// It is on the right.
    pub right: bool,
    /// The pressure in front of the piston.
    pub p: Option<usize>,
    /// The chamber that it is, if seals separate it from others.
    pub chamber: Option<usize>,
}

/// The spool of a model, if it has one.
pub fn spool(assembly: &Assembly, known: &Known<'_>) -> Option<Spool> {
    let seals: Vec<usize> = (0..assembly.parts.len())
        .filter(|&k| {
            let name = &assembly.parts[k].name;
            known.contact(name).is_some() && known.parameter(name, "seal.edge").is_some()
        })
        .collect();
    let level = seals.first().and_then(|s| assembly.parts[*s].parent);
    let seals: Vec<usize> =
        seals.into_iter().filter(|s| assembly.parts[*s].parent == level).collect();
    let (body, s) = body(assembly, known, &seals)?;
    let level = level.or(assembly.parts[body].parent)?;
    let body_name = &assembly.parts[body].name;
    let order = match picture(assembly, level) {
        Some(picture) => sequence(&picture, &seals),
        None => seals,
    };
    let nodes = Nodes::new(assembly, level);
    let mut spool = Spool {
        name: body_name.clone(),
        s,
        stops: stops(assembly, known, body, s)?,
        seals: Vec::new(),
        chambers: Vec::new(),
        drives: Vec::new(),
    };
    let mut chamber_of: FastMap<usize, usize> = FastMap::default();
    let sides: Vec<[Option<usize>; 2]> = order.iter().map(|&k| nodes.sides(k)).collect();
    let mut left_end = None;
    for (i, &k) in order.iter().enumerate() {
        let part = &assembly.parts[k];
        let [a, b] = sides[i];
        // A node shared with the seal before is on its left, one shared with the next seal on its right.
        let shared = |other: Option<&[Option<usize>; 2]>, n: Option<usize>| {
            n.is_some() && other.is_some_and(|o| o.contains(&n))
        };
        let after = sides.get(i + 1);
        let turned = if left_end.is_some() && left_end == b {
            a != b
        } else if left_end.is_some() && left_end == a {
            false
        } else {
            shared(after, a) && !shared(after, b)
        };
        let ordered = if turned { [b, a] } else { [a, b] };
        left_end = ordered[1];
        let mut chamber = |node: Option<usize>| {
            let node = node?;
            Some(*chamber_of.entry(node).or_insert_with(|| {
                spool.chambers.push(nodes.chamber(node, assembly, known, &order));
                spool.chambers.len() - 1
            }))
        };
        let sides = ordered.map(&mut chamber);
        let inside = |role: &str| inside(assembly, known, k, known.view.name(role)?);
        let (touches, contact) = known.contact(&part.name)?;
        spool.seals.push(Seal {
            name: assembly.short(k).to_owned(),
            description: part.description.clone(),
            contact: contact.to_owned(),
            touches,
            edge: known.parameter(&part.name, "seal.edge")?,
            closed: known.view.name("seal.closed").and_then(|n| known.variable(&part.name, n)),
            opening: inside("seal.opening"),
            flow: inside("seal.flow"),
            sides,
            turned,
        });
    }
    drives(assembly, known, (level, body), &nodes, &chamber_of, &mut spool);
    Some(spool)
}

/// The body and its position.
fn body(assembly: &Assembly, known: &Known<'_>, seals: &[usize]) -> Option<(usize, usize)> {
    let position = known.view.name("body.position")?;
    let parts = 0..assembly.parts.len();
    if seals.is_empty() {
        let between = |k: usize| {
            let name = &assembly.parts[k].name;
            known.stops(name)?;
            let s = known.variable(name, position).filter(|_| !name.is_empty())?;
            Some((k, s))
        };
        return parts.into_iter().find_map(between);
    }
    let mut riders = vec![0; assembly.parts.len()];
    for link in assembly.links.iter().filter(|l| l.domain != Domain::Fluid) {
        let [a, b] = [link.ends[0].part, link.ends[1].part];
        riders[a] += usize::from(seals.contains(&b));
        riders[b] += usize::from(seals.contains(&a));
    }
    let counted: Vec<(usize, usize)> =
        parts.filter(|k| !seals.contains(k)).map(|k| (k, riders[k])).collect();
    let most = counted.iter().map(|c| c.1).max().filter(|m| *m > 0)?;
    let (body, _) = *counted.iter().find(|c| c.1 == most)?;
    Some((body, inside(assembly, known, body, position)?))
}

/// A variable of a component or of the first of its components that has it.
fn inside(assembly: &Assembly, known: &Known<'_>, part: usize, name: &str) -> Option<usize> {
    let parts = (0..assembly.parts.len()).filter(|&k| assembly.within(k, part));
    parts.into_iter().find_map(|k| known.variable(&assembly.parts[k].name, name))
}

fn stops(assembly: &Assembly, known: &Known<'_>, body: usize, s: usize) -> Option<[f64; 2]> {
    let parts = (0..assembly.parts.len()).filter(|&k| assembly.within(k, body));
    let declared = parts.into_iter().find_map(|k| known.stops(&assembly.parts[k].name));
    let (low, high) = (known.range)(s);
    let [low, high] = declared.unwrap_or([low, high]);
    (high > low).then_some([low, high])
}

/// Sets of connected fluid ports.
struct Nodes {
    /// Component, connector, node.
    ports: Vec<(usize, String, usize)>,
}

impl Nodes {
    fn new(assembly: &Assembly, level: usize) -> Nodes {
        let mut ports: Vec<(usize, String, usize)> = Vec::new();
        let links = assembly.links.iter();
        for link in links.filter(|l| l.holder == level && l.connect && l.domain == Domain::Fluid) {
            let at = [0, 1].map(|i| {
                let end = &link.ends[i];
                let known = ports.iter().position(|(p, n, _)| *p == end.part && *n == end.port);
                known.unwrap_or_else(|| {
                    ports.push((end.part, end.port.clone(), ports.len()));
                    ports.len() - 1
                })
            });
            let (keep, drop) = (ports[at[0]].2, ports[at[1]].2);
            ports.iter_mut().filter(|p| p.2 == drop).for_each(|p| p.2 = keep);
        }
        Nodes { ports }
    }

    /// The nodes at the first two ports of a component, in order of declaration.
    fn sides(&self, part: usize) -> [Option<usize>; 2] {
        let mut own: Vec<(&str, usize)> =
            self.ports.iter().filter(|p| p.0 == part).map(|p| (p.1.as_str(), p.2)).collect();
        own.sort_unstable();
        [own.first().map(|p| p.1), own.get(1).map(|p| p.1)]
    }

    /// A node as a chamber, named after a component with one port, such as a volume or a source.
    fn chamber(
        &self,
        node: usize,
        assembly: &Assembly,
        known: &Known<'_>,
        seals: &[usize],
    ) -> Chamber {
        let members: Vec<usize> = self.ports.iter().filter(|p| p.2 == node).map(|p| p.0).collect();
        let count = |part: usize| self.ports.iter().filter(|p| p.0 == part).count();
        let vessel = members.iter().copied().find(|m| count(*m) == 1);
        let others = members.iter().filter(|m| !seals.contains(m) && Some(**m) != vessel);
        let ports: Vec<String> = others.map(|m| assembly.short(*m).to_owned()).collect();
        let named = vessel.or(members.first().copied());
        let pressure = self.ports.iter().filter(|p| p.2 == node).find_map(|(part, port, _)| {
            let name = &assembly.parts[*part].name;
            known.variable(name, &format!("{port}.{}", known.view.name("port.pressure")?))
        });
        Chamber {
            name: named.map_or_else(String::new, |m| assembly.short(m).to_owned()),
            p: pressure,
            // The surroundings have too many to be informative.
            ports: if ports.len() > 2 { Vec::new() } else { ports },
        }
    }
}

fn drives(
    assembly: &Assembly,
    known: &Known<'_>,
    (level, body): (usize, usize),
    nodes: &Nodes,
    chamber_of: &FastMap<usize, usize>,
    spool: &mut Spool,
) {
    let links = assembly.links.iter();
    for link in links.filter(|l| l.holder == level && l.domain == Domain::Mechanical) {
        let [a, b] = [link.ends[0].part, link.ends[1].part];
        let other = if a == body { b } else { a };
        if (a != body && b != body)
            || other == level
            || spool.seals.iter().any(|s| s.name == assembly.short(other))
        {
            continue;
        }
        let within: Vec<&str> = (0..assembly.parts.len())
            .filter(|&k| assembly.within(k, other))
            .map(|k| assembly.parts[k].name.as_str())
            .collect();
        let number = |role: &str| within.iter().find_map(|p| known.parameter(p, role));
        let pressures = known.view.names("piston.pressure");
        let p = within
            .iter()
            .find_map(|part| pressures.iter().find_map(|name| known.variable(part, name)));
        let piston = number("piston.area").is_some() && p.is_some();
        let is_spring = number("spring.stiffness").is_some();
        if !piston && !is_spring {
            continue;
        }
        let right = if piston { number("piston.direction") == Some(-1.0) } else { true };
        let name = assembly.short(other).to_owned();
        let chamber = nodes.sides(other)[0].and_then(|n| chamber_of.get(&n).copied());
        spool.drives.push(Drive { name, piston, right, p, chamber });
    }
}

impl Spool {
    /// As data for the script.
    pub fn json(&self) -> Json {
        let place = |k: Option<usize>| k.map_or_else(Json::null, Json::count);
        let seals = self.seals.iter().map(|s| {
            Json::object([
                ("name", Json::text(s.name.as_str())),
                ("description", Json::text(s.description.as_str())),
                ("contact", Json::text(s.contact.as_str())),
                ("touches", Json::text(s.touches.name())),
                ("edge", Json::number(s.edge)),
                ("closed", place(s.closed)),
                ("opening", place(s.opening)),
                ("flow", place(s.flow)),
                ("left", place(s.sides[0])),
                ("right", place(s.sides[1])),
                ("turned", Json::flag(s.turned)),
            ])
        });
        let chambers = self.chambers.iter().map(|c| {
            Json::object([
                ("name", Json::text(c.name.as_str())),
                ("p", place(c.p)),
                ("ports", Json::list(c.ports.iter().map(Json::text))),
            ])
        });
        let drives = self.drives.iter().map(|d| {
            Json::object([
                ("name", Json::text(d.name.as_str())),
                ("piston", Json::flag(d.piston)),
                ("right", Json::flag(d.right)),
                ("p", place(d.p)),
                ("chamber", place(d.chamber)),
            ])
        });
        Json::object([
            ("name", Json::text(self.name.as_str())),
            ("s", Json::count(self.s)),
            ("stops", Json::numbers(&self.stops)),
            ("seals", Json::list(seals)),
            ("chambers", Json::list(chambers)),
            ("drives", Json::list(drives)),
        ])
    }
}
