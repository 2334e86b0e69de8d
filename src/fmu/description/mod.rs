//! `modelDescription.xml` of FMI 2.0.5 and FMI 3.0.2.
//!
//! In: a [`Description`]. Out: the text of the file. Order of elements and attributes as in the schemas.

mod second;
mod third;
mod units;
pub(super) mod xml;

use crate::ir::expr::{Enumeration, Type};

use self::second::second;
use self::third::third;
use self::units::{convertible, units};
use self::xml::Xml;
use super::interface::{Initial, Role, Scalar, Start, Varies};

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
        Varies::Tunable => "tunable",
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
