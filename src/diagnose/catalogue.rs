//! The catalogue of effects, from the annotations of the classes in `lib/Effects` and of the user's own.

use std::path::Path;

use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::Span;
use crate::driver::annotation::Annotated;
use crate::driver::compile::{CompileError, Request, Session};
use crate::driver::files;
use crate::flatten::inventory::{Inventory, InventoryConnector};
use crate::ir::flat::{FlatModel, Variability, Variable};

use super::cause::CatalogueCause;
use super::formula::{Formula, FreeCurve};
use super::law_choice::Choice;
use super::variation::states;

/// An effect as its class describes it.
#[derive(Clone, Debug, Default)]
pub struct Effect {
    /// Full name of the class.
    pub class: String,
    /// Parameters that are zero without the effect: array elements one by one.
    pub amplitudes: Vec<Amplitude>,
    /// Shape parameters, with their starts.
    pub shape_parameters: Vec<(String, Vec<Start>)>,
    /// Connectors of a host that it is attached to; empty: attached wherever its connectors fit.
    pub host: Vec<String>,
    /// Inputs, and the variables of the host that they are bound to: the first that exists.
    pub binds: Vec<(String, Vec<String>)>,
    /// A sentence about the effect, with `%at` for the place.
    pub explains: String,
    /// Its connectors.
    pub connectors: Vec<InventoryConnector>,
    /// Its name, where its class says what has the effect rather than what the effect is.
    pub named: Option<String>,
    /// The classes of laws that it becomes at a limit of its parameters.
    pub simpler: Vec<String>,
    /// Its law as a formula.
    pub law: String,
    /// It acts on the sensor, between a variable and its signal.
    pub of_signal: bool,
    /// Units of its parameters.
    pub units: Vec<(String, String)>,
    /// It is built into components of the class, and only set there.
    pub built_in: bool,
    /// Modifications, besides its parameters, that enable it in a component.
    pub with: Vec<(String, String)>,
    /// Of an unknown inflow: the variable that enters the balance.
    pub inflow: Option<String>,
    /// Variables on which its law depends; of an unknown inflow, those over which it is shown.
    pub over: Vec<String>,
    /// Of an effect that lets parameters vary: its output, by which they are multiplied.
    pub varies: Option<String>,
    /// Of such an effect: it is scored only for the parameters that a straight line over some variable suits best, since it
    /// costs more.
    pub follows_line: bool,
    /// Together with its host it is another law of the host, so a sensor of the host's flow reads both.
    pub in_series: bool,
    /// It acts between two connection sets that move, and none of them is fixed in space: an effect with one connector acts there.
    pub between_moving: bool,
    /// Of an effect that is a term of an equation: the variable that is added.
    pub adds: Option<String>,
    /// Of such a term: its input is the state whose rate the equation determines.
    pub is_of_state: bool,
    /// Of such a term: it resists a motion, so its input may be a speed.
    pub is_of_speed: bool,
    /// Of an effect that lets parameters vary: its input is the rate of a state.
    pub is_of_rate: bool,
    /// Of such an effect: its input is the number of the recording.
    pub is_of_recording: bool,
    /// Of such a term: its input is a term that the equation has.
    pub is_of_term: bool,
    /// Of a term of two inputs: exchanged, they make another term.
    pub is_ordered: bool,
    /// Of an effect that moves the start of a state: the parameter that is added to it.
    pub starts: Option<String>,
    /// Of an effect that acts on an input of the model: its output, which the model reads instead.
    pub acts: Option<String>,
    /// Of such an effect: it reads the recording itself, before all others that act on the same input.
    pub is_first: bool,
    /// Of an effect that is another law: how it is chosen.
    pub choice: Option<Choice>,
    /// Of a free curve: how a formula takes its place.
    pub curve: Option<FreeCurve>,
    /// Of a free curve with more knots than its class has by itself: that of the class, by its position in the catalogue. It is
    /// fitted in the place of the other, and no score test tries it.
    pub finer_than: Option<usize>,
    /// Of a formula that may stand for a free curve: the formula.
    pub formula: Option<Formula>,
    /// It has states of its own, which add steps to every run.
    pub has_states: bool,
    /// Its annotation.
    pub span: Option<Span>,
}

impl Effect {
    /// What it is called: its class, unless that says what has the effect rather than what the effect is.
    pub fn name(&self) -> &str {
        self.named.as_ref().unwrap_or(&self.class)
    }

    /// True if it becomes another law at a limit of its parameters.
    pub fn contains(&self, other: &Effect) -> bool {
        self.simpler.contains(&other.class)
    }

    /// True if a shape parameter follows from the length of the recordings: a time constant.
    pub fn depends_on_length(&self) -> bool {
        let starts = self.shape_parameters.iter().flat_map(|(_, starts)| starts);
        starts.flat_map(Start::variables).any(|variable| variable == "t")
    }

    /// True if its inputs are bound to any variables of the model, so that these say what it depends on.
    pub fn has_free_inputs(&self) -> bool {
        self.varies.is_some() || self.adds.is_some()
    }

    /// True for its name, with or without the package; `parameter` is the name of all that let parameters vary.
    pub fn is_called(&self, name: &str) -> bool {
        let short = |full: &str| full.rsplit('.').next() == Some(name);
        let own = [self.name(), &self.class];
        own.iter().any(|full| *full == name || short(full))
            || self.varies.is_some() && name == PARAMETER
    }

    /// The input of a sensor for another quantity than the one that it measures.
    pub fn other_quantity(&self) -> Option<&str> {
        let (input, _) = self.binds.first().filter(|_| self.of_signal)?;
        Some(input.as_str())
    }

    /// True if variables of the model take the place of this input in its law.
    pub fn is_named_in_law(&self, input: &str) -> bool {
        self.has_free_inputs() || self.other_quantity() == Some(input)
    }

    /// True for a parameter that varies with something.
    pub fn is_variation(&self) -> bool {
        self.varies.is_some() && !self.binds.is_empty()
    }

    /// True for a parameter that does not vary, but has another value than the model gives it.
    pub fn is_other_value(&self) -> bool {
        self.varies.is_some() && self.binds.is_empty()
    }

    /// True for a term that is the product of several variables: like a parameter that varies, it describes much and names
    /// nothing.
    pub fn is_product(&self) -> bool {
        self.adds.is_some() && self.binds.len() > 1
    }
}

/// What `diagnosis.json` calls effects that let parameters vary.
pub const PARAMETER: &str = "parameter";

/// An amplitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitude {
    /// Its name, with a subscript for an element.
    pub name: String,
    /// Only positive values make sense.
    pub positive: bool,
}

/// What the zero of the unit of a column is called among the ranges of variables.
pub const UNIT_ZERO: &str = "unit zero";

/// Most values halfway between Integers.
const MOST_BETWEEN: f64 = 40.0;

/// The start of a shape parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// This value.
    Value(f64),
    /// A number of values over the range of a variable.
    Spread(String, usize),
    /// The least value of a variable.
    Least(String),
    /// The greatest value of a variable.
    Greatest(String),
    /// This multiple of a variable's range.
    Multiple(f64, String),
    /// This multiple of the greatest value of a variable.
    MultipleOfGreatest(f64, String),
    /// The values halfway between the Integers that a variable takes.
    Between(String),
    /// The zero of the unit in which the recordings have a variable, in the unit of the model.
    Zero,
    /// This multiple of one variable's range per range of another.
    MultipleOfRate(f64, String, String),
}

impl Start {
    /// The variables whose ranges it depends on.
    pub fn variables(&self) -> impl Iterator<Item = &str> {
        let (first, second) = match self {
            Start::Value(_) => (None, None),
            Start::Zero => (Some(UNIT_ZERO), None),
            Start::Spread(v, _)
            | Start::Between(v)
            | Start::Least(v)
            | Start::Greatest(v)
            | Start::Multiple(_, v)
            | Start::MultipleOfGreatest(_, v) => (Some(v.as_str()), None),
            Start::MultipleOfRate(_, v, per) => (Some(v.as_str()), Some(per.as_str())),
        };
        first.into_iter().chain(second)
    }

    /// Its values if the variables cover these ranges; none where a scale or a place over the range is asked for and
    /// the variable is constant.
    pub fn values(&self, range: impl Fn(&str) -> (f64, f64)) -> Vec<f64> {
        let span = |v: &str| {
            let (low, high) = range(v);
            (high > low).then_some(high - low)
        };
        match self {
            Start::Value(x) => vec![*x],
            Start::Zero => {
                vec![range(UNIT_ZERO).0].into_iter().filter(|zero| *zero != 0.0).collect()
            }
            Start::Between(v) => {
                let (first, last) = (range(v).0.ceil(), range(v).1.floor());
                let count = (last - first).clamp(0.0, MOST_BETWEEN) as u32;
                (0..count).map(|k| first + f64::from(k) + 0.5).collect()
            }
            Start::Least(v) => vec![range(v).0],
            Start::Greatest(v) => vec![range(v).1],
            Start::MultipleOfGreatest(factor, v) => vec![factor * range(v).1],
            Start::Multiple(factor, v) => span(v).map(|span| factor * span).into_iter().collect(),
            Start::MultipleOfRate(factor, v, per) => {
                let rate = span(v).and_then(|span_of_v| Some(span_of_v / span(per)?));
                rate.map(|rate| factor * rate).into_iter().collect()
            }
            // At the centres of equal intervals.
            Start::Spread(v, n) => {
                let place =
                    |span: f64, k| range(v).0 + span * (f64::from(k as u32) + 0.5) / *n as f64;
                span(v).map_or_else(Vec::new, |span| (0..*n).map(|k| place(span, k)).collect())
            }
        }
    }
}

/// Packages of effects.
#[derive(Clone, Copy, Debug)]
pub struct Packages<'a> {
    /// The request that finds their classes.
    pub request: &'a Request,
    /// Their full names.
    pub names: &'a [&'a str],
    /// Full names of further classes.
    pub classes: &'a [String],
}

/// The keys of an annotation `__mocc` that describe an effect.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Role {
    /// A physical effect.
    Effect,
    /// An inflow that is free over time: the question where a balance does not close.
    Unknown,
    /// Another law that is built into the class.
    Choice,
}

impl Role {
    fn key(self) -> &'static str {
        match self {
            Role::Effect => "effect",
            Role::Unknown => "unknown",
            Role::Choice => "choice",
        }
    }

    /// The key of the law's formula.
    fn law(self) -> &'static str {
        match self {
            Role::Effect | Role::Unknown => "law",
            Role::Choice => "chosen",
        }
    }
}

/// All effects of the packages in order of their names, and after them those that are built into components
/// of the model. `units` are those of the model's variables, by name.
///
/// A class whose description cannot be used is skipped with a warning.
pub fn catalogue(
    session: &mut Session,
    packages: &Packages<'_>,
    model: &Inventory,
    units: &[(String, String)],
) -> Vec<Effect> {
    let (mut effects, known) = components(session, packages, Role::Effect);
    let mut hosts: Vec<String> = model.parts.iter().map(|p| p.class.clone()).collect();
    hosts.sort();
    hosts.dedup();
    hosts.retain(|class| !class.is_empty() && !known.contains(class));
    for annotated in session.annotated(packages.request, &hosts) {
        let Some(host) = model.parts.iter().find(|p| p.class == annotated.class) else { continue };
        let prefix = format!("{}.", host.name);
        let own =
            |(n, u): &(String, String)| Some((n.strip_prefix(&prefix)?.to_owned(), u.clone()));
        let units: Vec<(String, String)> = units.iter().filter_map(own).collect();
        for role in [Role::Effect, Role::Choice] {
            let Some(mut effect) = described(session, &annotated, role) else { continue };
            effect.units.clone_from(&units);
            effect.built_in = true;
            effect.choice = (role == Role::Choice).then(Choice::default);
            effects.push(effect);
        }
    }
    effects
}

/// Inflows that are free over time, one for each class of connectors: the questions where a balance does not
/// close.
pub fn unknowns(session: &mut Session, packages: &Packages<'_>) -> Vec<Effect> {
    components(session, packages, Role::Unknown).0
}

/// The classes in a folder of the user's that describe an effect: at its top and in its packages. Errors: the
/// folder cannot be searched.
pub fn of_folder(
    session: &mut Session,
    request: &Request,
    folder: &Path,
) -> Result<Vec<String>, CompileError> {
    let name = folder.display().to_string();
    let mut classes = match files::top_level(folder) {
        Ok(classes) => classes,
        Err(why) => {
            let cause = CatalogueCause::UnreadableEffects { folder: name, why };
            session.problems.push(Diagnostic::new(cause, Span::NONE));
            return Err(CompileError::Request);
        }
    };
    for package in classes.clone() {
        classes.extend(session.members(request, &package));
    }
    let has_role =
        |a: &Annotated| [Role::Effect, Role::Unknown].iter().any(|r| a.entry(r.key()).is_some());
    let annotated = session.annotated(request, &classes).into_iter().filter(has_role);
    let annotated: Vec<String> = annotated.map(|a| a.class).collect();
    if annotated.is_empty() {
        let cause = CatalogueCause::NoEffects { folder: name, searched: classes.len() };
        session.problems.push(Diagnostic::new(cause, Span::NONE));
    }
    Ok(annotated)
}

/// The effects of packages that are components of their own, and the names of all annotated classes.
fn components(
    session: &mut Session,
    packages: &Packages<'_>,
    role: Role,
) -> (Vec<Effect>, Vec<String>) {
    let mut effects = Vec::new();
    let mut known = Vec::new();
    let members = packages.names.iter().map(|p| session.members(packages.request, p));
    let mut groups: Vec<Vec<String>> = members.collect();
    groups.push(packages.classes.to_vec());
    for classes in groups {
        for annotated in session.annotated(packages.request, &classes) {
            known.push(annotated.class.clone());
            let Some(effect) = described(session, &annotated, role) else { continue };
            match component(effect, packages.request) {
                Ok(effect) => effects.push(effect),
                Err(why) => warn(session, &annotated, role, &why),
            }
        }
    }
    (effects, known)
}

/// The effect that an annotation describes, if it has this role.
fn described(session: &mut Session, annotated: &Annotated, role: Role) -> Option<Effect> {
    let entry = annotated.entry(role.key())?;
    match read(&annotated.class, &entry.text, role) {
        Ok(mut effect) => {
            effect.span = Some(entry.span);
            let explains = annotated.entry("explains").map(|e| e.text.as_str());
            effect.explains = explains.unwrap_or("%at has this effect.").to_owned();
            effect.law = annotated.entry(role.law()).map(|e| e.text.clone()).unwrap_or_default();
            let curve = annotated.entry("formula").map(|e| FreeCurve::read(&e.text)).transpose();
            if let Err(why) = &curve {
                warn(session, annotated, role, why);
            }
            effect.curve = curve.ok()?;
            Some(effect)
        }
        Err(why) => {
            warn(session, annotated, role, &why);
            None
        }
    }
}

/// Warns that a class is skipped.
fn warn(session: &mut Session, annotated: &Annotated, role: Role, why: &str) {
    let (class, key) = (&annotated.class, role.key());
    let span = annotated.entry(key).map_or(Span::NONE, |e| e.span);
    let cause = CatalogueCause::UnusableEffect { class: class.clone(), why: why.to_owned() };
    session.problems.push(Diagnostic::new(cause, span));
}

/// An effect that is a component of its own, with the connectors and amplitudes of its class.
fn component(mut effect: Effect, request: &Request) -> Result<Effect, String> {
    let own = Request {
        form: request.form,
        folders: request.folders.clone(),
        modelica_path: request.modelica_path.clone(),
        ..Request::new(None, Some(effect.class.clone()))
    };
    let mut session = Session::default();
    let Ok((flat, inventory)) = session.flatten_with_inventory(&own) else {
        let first = session.problems.iter().find(|d| d.severity == Severity::Error);
        return Err(first.map_or("it cannot be compiled".to_owned(), |d| d.message.clone()));
    };
    complete(&mut effect, &inventory);
    let names: Vec<String> = flat.variables.iter().map(|v| v.name.clone()).collect();
    for a in &effect.amplitudes {
        if elements(a, &names).next().is_none() {
            return Err(format!("it has no parameter `{}`", a.name));
        }
    }
    effect.amplitudes = effect.amplitudes.iter().flat_map(|a| elements(a, &names)).collect();
    let units = flat.variables.iter().map(|v| (v.name.clone(), v.unit.to_string()));
    effect.units = units.collect();
    effect.has_states = !states(&flat).is_empty();
    if effect.over.is_empty() {
        effect.over = variables_of(&effect.law, &flat);
    }
    Ok(effect)
}

/// The input of a sensor: what it measures.
pub const SENSOR_INPUT: &str = "u";

fn complete(effect: &mut Effect, inventory: &Inventory) {
    if let Some(own) = inventory.parts.first() {
        effect.connectors = own.connectors.clone();
    }
    let inside = [&effect.varies, &effect.adds, &effect.acts, &effect.starts];
    let acts_inside = inside.into_iter().any(Option::is_some);
    effect.of_signal = effect.connectors.is_empty() && !acts_inside;
    for input in &inventory.inputs {
        let is_read = effect.of_signal && input == SENSOR_INPUT;
        if !is_read && !effect.binds.iter().any(|(name, _)| name == input) {
            effect.binds.push((input.clone(), vec![input.clone()]));
        }
    }
}

/// The variables of a class that the right side of its law names.
fn variables_of(law: &str, flat: &FlatModel) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let right = law.split_once('=').map_or(law, |(_, right)| right);
    for word in right.split(|c: char| !c.is_alphanumeric() && c != '_') {
        let varies = |v: &&Variable| v.name == word && v.variability > Variability::Parameter;
        let known = found.iter().any(|name| name == word);
        if !known && flat.variables.iter().any(|v| varies(&v)) {
            found.push(word.to_owned());
        }
    }
    found
}

/// The elements of an array amplitude, or the scalar itself.
fn elements<'a>(a: &'a Amplitude, names: &'a [String]) -> impl Iterator<Item = Amplitude> + 'a {
    let prefix = format!("{}[", a.name);
    let own = names.iter().filter(move |n| **n == a.name || n.starts_with(&prefix));
    own.map(|name| Amplitude { name: name.clone(), positive: a.positive })
}

/// Reads `amplitude=F; s_0=s(15); ...`.
fn read(class: &str, text: &str, role: Role) -> Result<Effect, String> {
    let mut effect = Effect { class: class.to_owned(), ..Effect::default() };
    for entry in text.split(';').map(str::trim).filter(|e| !e.is_empty()) {
        let wrong = || format!("cannot read the entry `{entry}`");
        if let Some(bind) = entry.strip_prefix("bind ") {
            let (input, variables) = bind.split_once('=').ok_or_else(wrong)?;
            let variables = variables.split('|').map(|v| v.trim().to_owned()).collect();
            effect.binds.push((input.trim().to_owned(), variables));
            continue;
        }
        if let Some(setting) = entry.strip_prefix("with ") {
            let (name, value) = setting.split_once('=').ok_or_else(wrong)?;
            effect.with.push((name.trim().to_owned(), value.trim().to_owned()));
            continue;
        }
        let (key, value) = entry.split_once('=').ok_or_else(wrong)?;
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
            "inflow" => effect.inflow = Some(value.trim().to_owned()),
            "named" => effect.named = Some(value.trim().to_owned()),
            "simpler" => effect.simpler = items.map(str::to_owned).collect(),
            "starts" => effect.starts = Some(value.trim().to_owned()),
            "varies" => effect.varies = Some(value.trim().to_owned()),
            "acts" => effect.acts = Some(value.trim().to_owned()),
            "order" => effect.is_first = value.trim() == "first",
            "adds" => effect.adds = Some(value.trim().to_owned()),
            "follows" if value.trim() == "line" => effect.follows_line = true,
            "between" if value.trim() == "moving" => effect.between_moving = true,
            "series" => effect.in_series = value.trim() == "true",
            "of" if value.trim() == "state" => effect.is_of_state = true,
            "of" if value.trim() == "speed" => {
                (effect.is_of_state, effect.is_of_speed) = (true, true);
            }
            "of" if value.trim() == "term" => effect.is_of_term = true,
            "pairs" if value.trim() == "ordered" => effect.is_ordered = true,
            "of" if value.trim() == "rate" => effect.is_of_rate = true,
            "of" if value.trim() == "recording" => effect.is_of_recording = true,
            "over" => effect.over = items.map(str::to_owned).collect(),
            shape => {
                let starts: Option<Vec<Start>> = items.map(start).collect();
                effect.shape_parameters.push((shape.to_owned(), starts.ok_or_else(wrong)?));
            }
        }
    }
    if effect.amplitudes.is_empty() && role != Role::Choice {
        return Err("its annotation names no amplitude".to_owned());
    }
    Ok(effect)
}

fn start(item: &str) -> Option<Start> {
    if let Ok(value) = item.parse() {
        return Some(Start::Value(value));
    }
    if let Some((above, below)) = item.split_once('/') {
        let per = below.trim().strip_prefix("span(")?.strip_suffix(')')?.trim().to_owned();
        return match start(above.trim())? {
            Start::Multiple(factor, v) => Some(Start::MultipleOfRate(factor, v, per)),
            _ => None,
        };
    }
    let (head, rest) = item.split_once('(')?;
    let inner = rest.strip_suffix(')')?.trim().to_owned();
    match head.trim() {
        "min" => Some(Start::Least(inner)),
        "between" => Some(Start::Between(inner)),
        "zero" => Some(Start::Zero),
        "max" => Some(Start::Greatest(inner)),
        variable => match inner.parse() {
            Ok(n) => Some(Start::Spread(variable.to_owned(), n)),
            Err(_) => {
                let (factor, function) = variable.split_once('*')?;
                let factor = factor.trim().parse().ok()?;
                match function.trim() {
                    "span" => Some(Start::Multiple(factor, inner)),
                    "max" => Some(Start::MultipleOfGreatest(factor, inner)),
                    _ => None,
                }
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_are_read() {
        let text = "amplitude=c>0,F_0; s_0=s(15); w=0.1e-3,0.02*span(u),0.5*max(u); host=spool,port_a; bind m_flow=gap.m_flow|m_flow; a=min(s)";
        let effect = read("Effects.X", text, Role::Effect).unwrap();
        let amplitude = |name: &str, positive| Amplitude { name: name.into(), positive };
        assert_eq!(effect.amplitudes, [amplitude("c", true), amplitude("F_0", false)]);
        assert_eq!(effect.shape_parameters[0].1, [Start::Spread("s".into(), 15)]);
        assert_eq!(
            effect.shape_parameters[1].1,
            [
                Start::Value(1e-4),
                Start::Multiple(0.02, "u".into()),
                Start::MultipleOfGreatest(0.5, "u".into())
            ]
        );
        assert_eq!(effect.shape_parameters[2].1, [Start::Least("s".into())]);
        assert_eq!(effect.host, ["spool", "port_a"]);
        assert_eq!(effect.binds[0].1, ["gap.m_flow", "m_flow"]);
        let built_in = read("P.Source", "with has_line=true; amplitude=R>0", Role::Effect).unwrap();
        assert_eq!(built_in.with, [("has_line".to_owned(), "true".to_owned())]);
        let unknown = read("Effects.U", "amplitude=F; inflow=f; over=s,v", Role::Unknown).unwrap();
        assert_eq!((unknown.inflow.as_deref(), unknown.over.len()), (Some("f"), 2));
        let why = |text: &str| read("Effects.Y", text, Role::Effect).unwrap_err();
        assert_eq!(why("w=1"), "its annotation names no amplitude");
        assert_eq!(why("amplitude=F; w=max(s"), "cannot read the entry `w=max(s`");
        assert_eq!(why("amplitude=F; bind u"), "cannot read the entry `bind u`");
    }

    #[test]
    fn a_spread_keeps_off_the_ends() {
        let over = |low: f64, high: f64| move |_: &str| (low, high);
        assert_eq!(Start::Spread("s".into(), 2).values(over(0.0, 4.0)), [1.0, 3.0]);
        assert_eq!(Start::Multiple(0.5, "s".into()).values(over(1.0, 4.0)), [1.5]);
        assert_eq!(Start::MultipleOfGreatest(0.5, "s".into()).values(over(1.0, 4.0)), [2.0]);
        assert!(Start::Multiple(0.5, "s".into()).values(over(1.0, 1.0)).is_empty());
        let rate = start("3*span(u)/span(t)").unwrap();
        assert_eq!(rate.variables().collect::<Vec<_>>(), ["u", "t"]);
        let range = |v: &str| if v == "u" { (1.0, 2.0) } else { (0.0, 6.0) };
        assert_eq!(rate.values(range), [0.5]);
        assert_eq!(start("3*max(u)/span(t)"), None);
    }
}
