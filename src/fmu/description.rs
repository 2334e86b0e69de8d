//! `modelDescription.xml` of FMI 2.0.5 and FMI 3.0.2.
//!
//! In: a [`Description`]. Out: the text of the file. Order of elements and attributes as in the schemas.

use crate::ir::expr::{Enumeration, Type};
use crate::units::unit::Unit;

use super::interface::{FIRST_INDICATOR, Initial, Role, Scalar, Start, Varies};

/// A version of FMI.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Version {
    /// FMI 2.0.5.
    Two,
    /// FMI 3.0.2.
    Three,
}

/// What the file says.
pub struct Description<'a> {
    /// The version of FMI.
    pub version: Version,
    /// Full name of the model.
    pub model: &'a str,
    /// Name of the shared library without its extension.
    pub identifier: &'a str,
    /// The token that the library checks.
    pub token: &'a str,
    /// Model Exchange is offered.
    pub exchange: bool,
    /// Co-Simulation is offered.
    pub stepping: bool,
    /// The variables.
    pub scalars: &'a [Scalar],
    /// The enumeration types of the model, by their number.
    pub enumerations: &'a [Enumeration],
    /// Number of event indicators.
    pub indicators: usize,
    /// For outputs and derivatives, by value reference, the value references that they depend on.
    pub dependencies: &'a [(u32, Vec<u32>)],
    /// The same for unknowns of the initialization.
    pub initial_dependencies: &'a [(u32, Vec<u32>)],
    /// Start, stop and step of the default run, s.
    pub experiment: [f64; 3],
    /// Relative tolerance of the default run.
    pub tolerance: f64,
    /// Derivatives exist between events.
    pub differentiable: bool,
}

/// The text of `modelDescription.xml`.
pub fn text(d: &Description<'_>) -> String {
    let mut x = Xml::default();
    let numbering = match d.scalars.iter().all(|s| is_structured(&s.name)) {
        true => "structured",
        false => "flat",
    };
    let tool = concat!("mocc ", env!("CARGO_PKG_VERSION"));
    x.out.push_str("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    match d.version {
        Version::Two => {
            let indicators = d.indicators.to_string();
            x.open(
                "fmiModelDescription",
                &[
                    ("fmiVersion", "2.0"),
                    ("modelName", d.model),
                    ("guid", d.token),
                    ("generationTool", tool),
                    ("variableNamingConvention", numbering),
                    ("numberOfEventIndicators", &indicators),
                ],
            );
        }
        Version::Three => x.open(
            "fmiModelDescription",
            &[
                ("fmiVersion", "3.0"),
                ("modelName", d.model),
                ("instantiationToken", d.token),
                ("generationTool", tool),
                ("variableNamingConvention", numbering),
            ],
        ),
    }
    interfaces(&mut x, d);
    units(&mut x, d);
    types(&mut x, d);
    x.open("LogCategories", &[]);
    for (name, what) in CATEGORIES {
        x.empty("Category", &[("name", name), ("description", what)]);
    }
    x.close("LogCategories");
    let [start, stop, step] = d.experiment.map(number);
    let tolerance = number(d.tolerance);
    x.empty(
        "DefaultExperiment",
        &[
            ("startTime", &start),
            ("stopTime", &stop),
            ("tolerance", &tolerance),
            ("stepSize", &step),
        ],
    );
    match d.version {
        Version::Two => second(&mut x, d),
        Version::Three => third(&mut x, d),
    }
    x.close("fmiModelDescription");
    x.out
}

/// The categories of the logger.
pub const CATEGORIES: [(&str, &str); 4] = [
    ("logEvents", "events and the ends of runs"),
    ("logStatusWarning", "warnings of the model"),
    ("logStatusDiscard", "points at which the model has no value"),
    ("logStatusError", "errors"),
];

fn interfaces(x: &mut Xml, d: &Description<'_>) {
    let third = d.version == Version::Three;
    let state = if third { "canGetAndSetFMUState" } else { "canGetAndSetFMUstate" };
    let serialize = if third { "canSerializeFMUState" } else { "canSerializeFMUstate" };
    let derivative =
        if third { "providesDirectionalDerivatives" } else { "providesDirectionalDerivative" };
    let common = |with_derivatives: bool| {
        let mut list = vec![("modelIdentifier", d.identifier)];
        if !third {
            list.push(("canNotUseMemoryManagementFunctions", "true"));
        }
        list.extend([(state, "true"), (serialize, "true")]);
        if with_derivatives {
            list.push((derivative, "true"));
            if third {
                list.push(("providesAdjointDerivatives", "true"));
            }
        }
        list
    };
    if d.exchange {
        let mut list = common(d.differentiable);
        if third {
            list.push(("needsCompletedIntegratorStep", "true"));
        }
        x.empty("ModelExchange", &list);
    }
    if d.stepping {
        let mut list = common(false);
        list.push(("canHandleVariableCommunicationStepSize", "true"));
        if third {
            list.push(("hasEventMode", "true"));
            list.push(("mightReturnEarlyFromDoStep", "true"));
        }
        x.empty("CoSimulation", &list);
    }
}

fn units(x: &mut Xml, d: &Description<'_>) {
    let mut known: Vec<(&str, Vec<&str>)> = Vec::new();
    for s in d.scalars.iter().filter(|s| s.ty == Type::Real && !s.unit.is_empty()) {
        let displays = s.aliases.iter().map(|a| a.display_unit.as_str()).chain([&*s.display_unit]);
        let at = known.iter().position(|(unit, _)| *unit == s.unit).unwrap_or_else(|| {
            known.push((&s.unit, Vec::new()));
            known.len() - 1
        });
        for display in displays {
            if convertible(&s.unit, display).is_some() && !known[at].1.contains(&display) {
                known[at].1.push(display);
            }
        }
    }
    if known.is_empty() {
        return;
    }
    x.open("UnitDefinitions", &[]);
    for (unit, displays) in known {
        x.open("Unit", &[("name", unit)]);
        if let Some(found) = Unit::of(unit)
            && let (Some(scale), Some(exponents)) = (found.scale, found.dimension.exponents())
        {
            let names = ["kg", "m", "s", "A", "K", "mol", "cd"];
            let mut list: Vec<(&str, String)> = Vec::new();
            for (name, exponent) in names.iter().zip(exponents).filter(|(_, e)| *e != 0) {
                list.push((name, exponent.to_string()));
            }
            if scale.factor != 1.0 {
                list.push(("factor", number(scale.factor)));
            }
            if scale.offset != 0.0 {
                list.push(("offset", number(scale.offset)));
            }
            let list: Vec<(&str, &str)> = list.iter().map(|(n, v)| (*n, v.as_str())).collect();
            x.empty("BaseUnit", &list);
        }
        for display in displays {
            let Some((factor, offset)) = convertible(unit, display) else { continue };
            let (factor, offset) = (number(factor), number(offset));
            x.empty("DisplayUnit", &[("name", display), ("factor", &factor), ("offset", &offset)]);
        }
        x.close("Unit");
    }
    x.close("UnitDefinitions");
}

/// Factor and offset that turn values of a unit into values of another one; `None` if there are none, or if the
/// units are the same.
fn convertible(unit: &str, display: &str) -> Option<(f64, f64)> {
    if display.is_empty() || display == unit {
        return None;
    }
    let (a, b) = (Unit::of(unit)?, Unit::of(display)?);
    let (from, to) = (a.scale?, b.scale?);
    (a.dimension == b.dimension)
        .then(|| (from.factor / to.factor, (from.offset - to.offset) / to.factor))
}

fn types(x: &mut Xml, d: &Description<'_>) {
    let is_used = |k: usize| {
        d.scalars.iter().any(|s| matches!(s.ty, Type::Enumeration(id) if id.0 as usize == k))
    };
    let used: Vec<&Enumeration> =
        d.enumerations.iter().enumerate().filter(|(k, _)| is_used(*k)).map(|(_, e)| e).collect();
    if used.is_empty() {
        return;
    }
    x.open("TypeDefinitions", &[]);
    for e in used {
        let outer = if d.version == Version::Two { "SimpleType" } else { "EnumerationType" };
        x.open(outer, &[("name", &e.name)]);
        if d.version == Version::Two {
            x.open("Enumeration", &[]);
        }
        for (k, literal) in e.literals.iter().enumerate() {
            let value = (k + 1).to_string();
            x.empty("Item", &[("name", literal.as_str()), ("value", &value)]);
        }
        if d.version == Version::Two {
            x.close("Enumeration");
        }
        x.close(outer);
    }
    x.close("TypeDefinitions");
}

/// The attributes of a variable that both versions share: those that come first, and those of its type.
fn attributes(s: &Scalar) -> Vec<(&'static str, String)> {
    let mut list = Vec::new();
    let role = match s.role {
        Role::Parameter => "parameter",
        Role::CalculatedParameter => "calculatedParameter",
        Role::Input => "input",
        Role::Output => "output",
        Role::Local => "local",
    };
    list.push(("causality", role.to_owned()));
    let varies = match s.varies {
        Varies::Constant => "constant",
        Varies::Fixed => "fixed",
        Varies::Discrete => "discrete",
        Varies::Continuous => "continuous",
    };
    list.push(("variability", varies.to_owned()));
    if let Some(initial) = s.initial {
        let initial = match initial {
            Initial::Exact => "exact",
            Initial::Approx => "approx",
            Initial::Calculated => "calculated",
        };
        list.push(("initial", initial.to_owned()));
    }
    list
}

fn of_type(s: &Scalar, d: &Description<'_>) -> Vec<(&'static str, String)> {
    let mut list = Vec::new();
    let real = s.ty == Type::Real;
    if let Type::Enumeration(id) = s.ty
        && let Some(e) = d.enumerations.get(id.0 as usize)
    {
        list.push(("declaredType", e.name.clone()));
    }
    if real && !s.unit.is_empty() {
        list.push(("unit", s.unit.clone()));
        if convertible(&s.unit, &s.display_unit).is_some() {
            list.push(("displayUnit", s.display_unit.clone()));
        }
    }
    let whole = |value: f64| if real { number(value) } else { format!("{value:.0}") };
    if real || s.ty == Type::Integer {
        for (name, value) in [("min", s.min), ("max", s.max)] {
            if let Some(value) = value {
                list.push((name, whole(value)));
            }
        }
    }
    if real && let Some(nominal) = s.nominal {
        list.push(("nominal", number(nominal)));
    }
    match (&s.start, s.ty) {
        (Some(Start::Number(value)), Type::Boolean) => {
            list.push(("start", (*value != 0.0).to_string()));
        }
        (Some(Start::Number(value)), _) => list.push(("start", whole(*value))),
        (Some(Start::Text(value)), _) => list.push(("start", value.clone())),
        (None, _) => {}
    }
    list
}

fn second(x: &mut Xml, d: &Description<'_>) {
    // Positions count from 1. Time is not listed: FMI 2 does not ask for it, and some importers ask it for a start
    // value.
    let mut position = 0;
    let mut positions: Vec<(u32, usize)> = Vec::new();
    for s in d.scalars {
        position += 1;
        positions.push((s.reference, position));
        position += s.aliases.len();
    }
    let positions: std::collections::BTreeMap<u32, usize> = positions.into_iter().collect();
    let at = |reference: u32| positions.get(&reference).copied().unwrap_or(0).to_string();
    x.open("ModelVariables", &[]);
    for s in d.scalars {
        let reference = s.reference.to_string();
        let element = match s.ty {
            Type::Real => "Real",
            Type::Integer => "Integer",
            Type::Boolean | Type::Clock => "Boolean",
            Type::String => "String",
            Type::Enumeration(_) => "Enumeration",
        };
        let shared = attributes(s);
        let mut typed = of_type(s, d);
        if let Some(of) = s.derivative_of {
            typed.push(("derivative", at(of)));
        }
        let description = s.description.clone();
        x.scalar(&s.name, &reference, description.as_deref(), &shared, element, &typed);
        for alias in &s.aliases {
            // Only one of the names has a start value.
            let typed: Vec<_> = of_type(s, d)
                .into_iter()
                .filter(|(name, _)| *name != "start" && *name != "displayUnit")
                .chain(
                    convertible(&s.unit, &alias.display_unit)
                        .map(|_| ("displayUnit", alias.display_unit.clone())),
                )
                .collect();
            let shared = [
                ("causality", "local".to_owned()),
                ("variability", shared[1].1.clone()),
                ("initial", "calculated".to_owned()),
            ];
            let description = alias.description.as_deref();
            x.scalar(&alias.name, &reference, description, &shared, element, &typed);
        }
    }
    x.close("ModelVariables");
    x.open("ModelStructure", &[]);
    let unknown = |x: &mut Xml, reference: u32, dependencies: &[(u32, Vec<u32>)]| {
        let index = at(reference);
        match dependencies.iter().find(|(r, _)| *r == reference) {
            Some((_, on)) => {
                let mut on: Vec<usize> =
                    on.iter().filter_map(|r| positions.get(r).copied()).collect();
                on.sort_unstable();
                let on = joined(&on);
                x.empty("Unknown", &[("index", &index), ("dependencies", &on)]);
            }
            None => x.empty("Unknown", &[("index", &index)]),
        }
    };
    x.list("Outputs", outputs(d), |x, s| unknown(x, s.reference, d.dependencies));
    x.list("Derivatives", derivatives(d), |x, s| unknown(x, s.reference, d.dependencies));
    x.list("InitialUnknowns", initial_unknowns(d.scalars), |x, s| {
        unknown(x, s.reference, d.initial_dependencies);
    });
    x.close("ModelStructure");
}

fn outputs<'a>(d: &Description<'a>) -> Vec<&'a Scalar> {
    d.scalars.iter().filter(|s| s.role == Role::Output).collect()
}

fn derivatives<'a>(d: &Description<'a>) -> Vec<&'a Scalar> {
    d.scalars.iter().filter(|s| s.derivative_of.is_some()).collect()
}

/// The unknowns of the initialization.
pub fn initial_unknowns(all: &[Scalar]) -> Vec<&Scalar> {
    let is_open = |s: &Scalar| matches!(s.initial, Some(Initial::Approx | Initial::Calculated));
    let is_listed = |s: &Scalar| {
        s.role == Role::Output
            || s.role == Role::CalculatedParameter
            || s.is_state
            || s.derivative_of.is_some()
    };
    all.iter().filter(|s| is_open(s) && is_listed(s)).collect()
}

fn third(x: &mut Xml, d: &Description<'_>) {
    x.open("ModelVariables", &[]);
    x.empty(
        "Float64",
        &[
            ("name", "time"),
            ("valueReference", "0"),
            ("causality", "independent"),
            ("variability", "continuous"),
        ],
    );
    for s in d.scalars {
        let reference = s.reference.to_string();
        let element = match s.ty {
            Type::Real => "Float64",
            Type::Integer => "Int32",
            Type::Boolean | Type::Clock => "Boolean",
            Type::String => "String",
            Type::Enumeration(_) => "Enumeration",
        };
        let mut list = vec![("name", s.name.clone()), ("valueReference", reference)];
        list.extend(s.description.iter().map(|text| ("description", text.clone())));
        list.extend(attributes(s));
        let mut typed = of_type(s, d);
        let text = match (&s.start, s.ty) {
            (Some(Start::Text(text)), _) => {
                typed.retain(|(name, _)| *name != "start");
                Some(text)
            }
            _ => None,
        };
        list.extend(typed);
        list.extend(s.derivative_of.map(|of| ("derivative", of.to_string())));
        let list: Vec<(&str, &str)> = list.iter().map(|(n, v)| (*n, v.as_str())).collect();
        if s.aliases.is_empty() && text.is_none() {
            x.empty(element, &list);
            continue;
        }
        x.open(element, &list);
        if let Some(text) = text {
            x.empty("Start", &[("value", text)]);
        }
        for alias in &s.aliases {
            let mut list = vec![("name", alias.name.as_str())];
            list.extend(alias.description.as_deref().map(|text| ("description", text)));
            if convertible(&s.unit, &alias.display_unit).is_some() {
                list.push(("displayUnit", &alias.display_unit));
            }
            x.empty("Alias", &list);
        }
        x.close(element);
    }
    for k in 0..d.indicators {
        let (name, reference) = (indicator_name(d, k), (FIRST_INDICATOR + k as u32).to_string());
        x.empty(
            "Float64",
            &[
                ("name", &name),
                ("valueReference", &reference),
                ("causality", "local"),
                ("variability", "continuous"),
                ("initial", "calculated"),
            ],
        );
    }
    x.close("ModelVariables");
    x.open("ModelStructure", &[]);
    let unknown = |x: &mut Xml, element: &str, reference: u32, all: &[(u32, Vec<u32>)]| {
        let own = reference.to_string();
        match all.iter().find(|(r, _)| *r == reference) {
            Some((_, on)) => {
                let on: Vec<usize> = on.iter().map(|r| *r as usize).collect();
                let on = joined(&on);
                x.empty(element, &[("valueReference", &own), ("dependencies", &on)]);
            }
            None => x.empty(element, &[("valueReference", &own)]),
        }
    };
    for s in outputs(d) {
        unknown(x, "Output", s.reference, d.dependencies);
    }
    for s in derivatives(d) {
        unknown(x, "ContinuousStateDerivative", s.reference, d.dependencies);
    }
    for s in initial_unknowns(d.scalars) {
        unknown(x, "InitialUnknown", s.reference, d.initial_dependencies);
    }
    for k in 0..d.indicators {
        let reference = (FIRST_INDICATOR + k as u32).to_string();
        x.empty("EventIndicator", &[("valueReference", &reference)]);
    }
    x.close("ModelStructure");
}

/// A name that no variable of the model has.
fn indicator_name(d: &Description<'_>, k: usize) -> String {
    let mut base = "event_indicator".to_owned();
    while d.scalars.iter().any(|s| s.name.starts_with(&base)) {
        base.push('_');
    }
    format!("{base}[{}]", k + 1)
}

fn joined(numbers: &[usize]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// True for names that the structured naming convention allows.
fn is_structured(name: &str) -> bool {
    let inner = name.strip_prefix("der(").and_then(|n| n.strip_suffix(')')).unwrap_or(name);
    let begins = inner.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_' || c == '\'');
    let allowed = |c: char| c.is_ascii_alphanumeric() || "_.[],'".contains(c);
    begins && inner.chars().all(allowed)
}

/// The shortest decimal text that reads back as the same number.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A text with elements.
#[derive(Default)]
struct Xml {
    out: String,
    depth: usize,
}

impl Xml {
    fn begin(&mut self, element: &str, attributes: &[(&str, &str)]) {
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
        self.out.push('<');
        self.out.push_str(element);
        for (name, value) in attributes {
            self.out.push_str(&format!(" {name}=\"{}\"", escaped(value)));
        }
    }

    fn open(&mut self, element: &str, attributes: &[(&str, &str)]) {
        self.begin(element, attributes);
        self.out.push_str(">\n");
        self.depth += 1;
    }

    fn empty(&mut self, element: &str, attributes: &[(&str, &str)]) {
        self.begin(element, attributes);
        self.out.push_str("/>\n");
    }

    fn close(&mut self, element: &str) {
        self.depth -= 1;
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
        self.out.push_str(&format!("</{element}>\n"));
    }

    /// An element around others; nothing if there are none.
    fn list<T>(&mut self, element: &str, items: Vec<T>, each: impl Fn(&mut Xml, T)) {
        if items.is_empty() {
            return;
        }
        self.open(element, &[]);
        for item in items {
            each(self, item);
        }
        self.close(element);
    }

    fn scalar(
        &mut self,
        name: &str,
        reference: &str,
        description: Option<&str>,
        shared: &[(&'static str, String)],
        element: &str,
        typed: &[(&'static str, String)],
    ) {
        let mut list = vec![("name", name), ("valueReference", reference)];
        list.extend(description.map(|text| ("description", text)));
        list.extend(shared.iter().map(|(n, v)| (*n, v.as_str())));
        self.open("ScalarVariable", &list);
        let typed: Vec<(&str, &str)> = typed.iter().map(|(n, v)| (*n, v.as_str())).collect();
        self.empty(element, &typed);
        self.close("ScalarVariable");
    }
}

/// A text as the value of an attribute; characters that XML does not allow are left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            '\t' => out.push_str("&#9;"),
            c if c < ' ' || c == '\u{fffe}' || c == '\u{ffff}' => {}
            c => out.push(c),
        }
    }
    out
}
