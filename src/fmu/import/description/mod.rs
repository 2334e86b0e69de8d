//! `modelDescription.xml` of a foreign FMU. Sole user of `roxmltree`, which refuses document types, and with them
//! entities.
//!
//! In: the text. Out: a [`Described`] FMU, with its variables as scalars.

mod types;

use roxmltree::{Document, Node, ParsingOptions};

pub use self::types::Passing;
use self::types::{Types, passing};

use crate::base::index::FastMap;
use crate::fmu::description::Version;
use crate::ir::foreign::{ForeignRole, ForeignType, ForeignVariable};

/// Most elements and attributes of a description.
const MOST_NODES: u32 = 20_000_000;
/// Most values of all variables together.
const MOST_VALUES: usize = 10_000_000;

/// A value reference and its values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Group {
    /// The value reference.
    pub reference: u32,
    /// The type.
    pub passing: Passing,
    /// Number of its first value.
    pub first: usize,
    /// Number of values: 1 for a scalar.
    pub count: usize,
}

/// One kind of simulation.
#[derive(Clone, PartialEq, Debug)]
pub struct Kind {
    /// Name of the shared library without its extension.
    pub identifier: String,
    /// Directional derivatives are provided.
    pub differentiates: bool,
    /// Model Exchange: the end of each step must be reported.
    pub needs_completed_steps: bool,
    /// Co-Simulation: communication points may have any distance.
    pub steps_vary: bool,
    /// Co-Simulation: the step that the FMU takes internally, s.
    pub own_step: Option<f64>,
}

/// What the description says.
#[derive(Clone, PartialEq, Debug)]
pub struct Described {
    /// The version of FMI.
    pub version: Version,
    /// The name of the model.
    pub name: String,
    /// Its description; may be empty.
    pub text: String,
    /// The token that the library checks.
    pub token: String,
    /// Model Exchange, if it is offered.
    pub exchange: Option<Kind>,
    /// Co-Simulation, if it is offered.
    pub stepping: Option<Kind>,
    /// Start, stop, step and tolerance of the default experiment.
    pub experiment: [Option<f64>; 4],
    /// The values by their references.
    pub groups: Vec<Group>,
    /// The scalar variables.
    pub variables: Vec<ForeignVariable>,
    /// Number of values.
    pub values: usize,
    /// Value references of the derivatives and of their states; empty if some are arrays.
    pub states: Vec<(u32, u32)>,
    /// Number of continuous states.
    pub state_count: usize,
    /// Number of event indicators.
    pub indicators: usize,
}

/// Why a description cannot be used.
#[derive(Clone, PartialEq, Debug)]
pub enum Unusable {
    /// It is wrong, for this reason.
    Wrong(String),
    /// It is of this version.
    Version(String),
}

impl From<String> for Unusable {
    fn from(why: String) -> Self {
        Unusable::Wrong(why)
    }
}

/// Reads a description.
pub fn read(text: &str) -> Result<Described, Unusable> {
    let options =
        ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..Default::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| e.to_string())?;
    let root = document.root_element();
    if root.tag_name().name() != "fmiModelDescription" {
        return Err(format!("the root element is `{}`", root.tag_name().name()).into());
    }
    let version = root.attribute("fmiVersion").unwrap_or_default();
    let version = match version.split('.').next() {
        Some("2") => Version::Two,
        Some("3") => Version::Three,
        _ => return Err(Unusable::Version(version.to_owned())),
    };
    let kind = |name: &str| -> Result<Option<Kind>, String> {
        let Some(e) = child(root, name) else { return Ok(None) };
        let identifier = e.attribute("modelIdentifier").unwrap_or_default().to_owned();
        let is_plain = |c: char| c.is_alphanumeric() || c == '_';
        if identifier.is_empty() || !identifier.chars().all(is_plain) {
            return Err(format!("the model identifier of {name} is not a C identifier"));
        }
        let differentiates =
            flag(e, "providesDirectionalDerivative") || flag(e, "providesDirectionalDerivatives");
        let needs_completed_steps = match version {
            Version::Two => !flag(e, "completedIntegratorStepNotNeeded"),
            Version::Three => flag(e, "needsCompletedIntegratorStep"),
        };
        let steps_vary = flag(e, "canHandleVariableCommunicationStepSize");
        let own_step = number(e, "fixedInternalStepSize")?;
        Ok(Some(Kind { identifier, differentiates, needs_completed_steps, steps_vary, own_step }))
    };
    let (exchange, stepping) = (kind("ModelExchange")?, kind("CoSimulation")?);
    if exchange.is_none() && stepping.is_none() {
        return Err("it offers neither Model Exchange nor Co-Simulation".to_owned().into());
    }
    let mut experiment = [None; 4];
    if let Some(e) = child(root, "DefaultExperiment") {
        for (x, name) in
            experiment.iter_mut().zip(["startTime", "stopTime", "stepSize", "tolerance"])
        {
            *x = number(e, name)?;
        }
    }
    let token = match version {
        Version::Two => root.attribute("guid"),
        Version::Three => root.attribute("instantiationToken"),
    };
    let mut out = Described {
        version,
        name: root.attribute("modelName").unwrap_or("FMU").to_owned(),
        text: root.attribute("description").unwrap_or_default().to_owned(),
        token: token.ok_or_else(|| "it has no token".to_owned())?.to_owned(),
        exchange,
        stepping,
        experiment,
        groups: Vec::new(),
        variables: Vec::new(),
        values: 0,
        states: Vec::new(),
        state_count: 0,
        indicators: 0,
    };
    let elements = variables(root, &mut out)?;
    structure(root, &elements, &mut out)?;
    Ok(out)
}

/// A variable as the file lists it, for references from elsewhere.
struct Listed {
    reference: u32,
    count: usize,
    /// Reference of the state whose derivative it is, or in FMI 2 its number in the list, from 1.
    derivative: Option<u32>,
}

fn variables(root: Node<'_, '_>, out: &mut Described) -> Result<Vec<Listed>, String> {
    let list = child(root, "ModelVariables").ok_or("it has no variables")?;
    let types = Types::of(root);
    let elements: Vec<Node<'_, '_>> = list.children().filter(Node::is_element).collect();
    let mut known = FastMap::default();
    let mut listed = Vec::with_capacity(elements.len());
    for e in &elements {
        let name = e.attribute("name").ok_or("a variable has no name")?;
        let reference = whole(*e, "valueReference")?
            .ok_or_else(|| format!("`{name}` has no value reference"))?;
        let typed = match out.version {
            Version::Two => e.children().find(Node::is_element),
            Version::Three => Some(*e),
        };
        let typed = typed.ok_or_else(|| format!("`{name}` has no type"))?;
        let count = dimensions(*e, &elements)?;
        let derivative = whole(typed, "derivative")?;
        listed.push(Listed { reference, count: count.iter().product(), derivative });
        let Some(passing) = passing(out.version, typed.tag_name().name()) else { continue };
        if e.attribute("causality") == Some("independent") {
            continue;
        }
        scalars(*e, typed, reference, passing, &count, &types, &mut known, out);
        if out.values > MOST_VALUES {
            return Err(format!("it declares more than {MOST_VALUES} values"));
        }
    }
    Ok(listed)
}

/// Adds the scalars of a variable and of its aliases.
#[allow(clippy::too_many_arguments)]
fn scalars(
    e: Node<'_, '_>,
    typed: Node<'_, '_>,
    reference: u32,
    passing: Passing,
    dimensions: &[usize],
    types: &Types<'_, '_>,
    known: &mut FastMap<(u32, u8), usize>,
    out: &mut Described,
) {
    let name = e.attribute("name").unwrap_or_default();
    let count: usize = dimensions.iter().product();
    // Variables with the same reference are aliases.
    let first = *known.entry((reference, passing as u8)).or_insert_with(|| {
        let first = out.values;
        out.groups.push(Group { reference, passing, first, count });
        out.values += count;
        first
    });
    let count = count.min(out.values - first);
    let starts = start(e, typed).unwrap_or_default();
    let starts: Vec<f64> = starts.split_whitespace().filter_map(literal).collect();
    let causality = e.attribute("causality").unwrap_or("local");
    let variability = e.attribute("variability").unwrap_or("continuous");
    let initial = e.attribute("initial");
    let role = match (causality, variability) {
        (_, "constant") | ("structuralParameter", _) => ForeignRole::Constant,
        ("parameter", _) => ForeignRole::Parameter,
        ("input", _) => ForeignRole::Input,
        ("output", _) => ForeignRole::Output,
        _ => ForeignRole::Computed,
    };
    let may_be_set = match role {
        ForeignRole::Constant => false,
        ForeignRole::Parameter | ForeignRole::Input => true,
        ForeignRole::Computed | ForeignRole::Output => {
            matches!(initial, Some("exact" | "approx")) && !starts.is_empty()
        }
    };
    let ty = match passing {
        Passing::Float64 | Passing::Float32 => ForeignType::Real,
        Passing::Boolean => ForeignType::Boolean,
        _ => ForeignType::Integer,
    };
    let attribute = |key: &str| types.attribute(typed, key);
    let bound = |key: &str| attribute(key).and_then(literal);
    let (least, most) = passing.bounds().unzip();
    let text = |key: &str| attribute(key).unwrap_or_default().to_owned();
    let description = e.attribute("description").unwrap_or_default();
    let mut names = vec![(name, description)];
    for alias in e.children().filter(|c| c.tag_name().name() == "Alias") {
        let text = alias.attribute("description").unwrap_or(description);
        names.push((alias.attribute("name").unwrap_or_default(), text));
    }
    for (name, description) in names {
        for k in 0..count {
            // One value may stand for all elements.
            let start = starts.get(k).or(starts.first().filter(|_| starts.len() == 1)).copied();
            out.variables.push(ForeignVariable {
                name: format!("{name}{}", subscripts(dimensions, k)),
                role,
                ty,
                value: first + k,
                start,
                may_be_set,
                is_tunable: role == ForeignRole::Parameter && variability == "tunable",
                unit: text("unit"),
                display_unit: text("displayUnit"),
                description: description.to_owned(),
                range: (bound("min").or(least), bound("max").or(most)),
            });
        }
    }
}

/// The states, their derivatives and the event indicators.
fn structure(root: Node<'_, '_>, listed: &[Listed], out: &mut Described) -> Result<(), String> {
    let Some(structure) = child(root, "ModelStructure") else { return Ok(()) };
    let by_index = |k: u32| listed.get((k as usize).wrapping_sub(1));
    let numbered: FastMap<u32, &Listed> = listed.iter().map(|l| (l.reference, l)).collect();
    let by_reference = |r: u32| numbered.get(&r).copied();
    let mut derivatives = Vec::new();
    match out.version {
        Version::Two => {
            let unknowns = child(structure, "Derivatives");
            for e in unknowns.iter().flat_map(|d| d.children().filter(Node::is_element)) {
                derivatives.extend(whole(e, "index")?.and_then(by_index));
            }
            let indicators = whole(root, "numberOfEventIndicators")?;
            out.indicators = indicators.unwrap_or(0) as usize;
        }
        Version::Three => {
            for e in structure.children().filter(Node::is_element) {
                let reference = whole(e, "valueReference")?;
                let found = reference.and_then(by_reference);
                match e.tag_name().name() {
                    "ContinuousStateDerivative" => derivatives.extend(found),
                    "EventIndicator" => out.indicators += found.map_or(1, |l| l.count),
                    _ => {}
                }
            }
        }
    }
    out.state_count = derivatives.iter().map(|d| d.count).sum();
    let of = |d: &&Listed| {
        let state = match out.version {
            Version::Two => by_index(d.derivative?)?,
            Version::Three => by_reference(d.derivative?)?,
        };
        (d.count == 1 && state.count == 1).then_some((d.reference, state.reference))
    };
    out.states = derivatives.iter().map(of).collect::<Option<_>>().unwrap_or_default();
    Ok(())
}

/// The sizes of an array variable; none for a scalar. Structural parameters keep their start values.
fn dimensions(e: Node<'_, '_>, all: &[Node<'_, '_>]) -> Result<Vec<usize>, String> {
    let mut out = Vec::new();
    for d in e.children().filter(|c| c.tag_name().name() == "Dimension") {
        let size = match (whole(d, "start")?, d.attribute("valueReference")) {
            (Some(size), _) => Some(size as usize),
            (None, Some(reference)) => {
                let of = all.iter().find(|v| v.attribute("valueReference") == Some(reference));
                of.and_then(|v| v.attribute("start")?.trim().parse().ok())
            }
            (None, None) => None,
        };
        let name = e.attribute("name").unwrap_or_default();
        out.push(size.ok_or_else(|| format!("a dimension of `{name}` has no size"))?);
    }
    let total = out.iter().try_fold(1_usize, |a, b| a.checked_mul(*b));
    if total.is_none_or(|n| n > MOST_VALUES) {
        return Err(format!("it declares more than {MOST_VALUES} values"));
    }
    Ok(out)
}

/// `[2,1]` for an element by its number in row-major order.
fn subscripts(dimensions: &[usize], k: usize) -> String {
    if dimensions.is_empty() {
        return String::new();
    }
    let mut rest = k;
    let mut parts: Vec<String> = Vec::new();
    for size in dimensions.iter().rev() {
        parts.push((rest % size + 1).to_string());
        rest /= size;
    }
    parts.reverse();
    format!("[{}]", parts.join(","))
}

fn child<'a, 'i>(e: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    e.children().find(|c| c.is_element() && c.tag_name().name() == name)
}

fn flag(e: Node<'_, '_>, name: &str) -> bool {
    matches!(e.attribute(name), Some("true" | "1"))
}

fn number(e: Node<'_, '_>, name: &str) -> Result<Option<f64>, String> {
    let Some(text) = e.attribute(name) else { return Ok(None) };
    let found = text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    found.map(Some).ok_or_else(|| format!("`{name}` is `{text}`, which is not a number"))
}

fn whole(e: Node<'_, '_>, name: &str) -> Result<Option<u32>, String> {
    let Some(text) = e.attribute(name) else { return Ok(None) };
    let found = text.trim().parse::<u32>();
    found.map(Some).map_err(|_| format!("`{name}` is `{text}`, which is not an Integer"))
}

fn start<'a>(e: Node<'a, '_>, typed: Node<'a, '_>) -> Option<&'a str> {
    typed.attribute("start").or_else(|| e.attribute("start"))
}

fn literal(text: &str) -> Option<f64> {
    match text {
        "true" => Some(1.0),
        "false" => Some(0.0),
        _ => text.trim().parse::<f64>().ok().filter(|x| x.is_finite()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_scalars_and_sizes_come_from_structural_parameters() {
        let text = r#"<fmiModelDescription fmiVersion="3.0" modelName="A" instantiationToken="t">
          <ModelExchange modelIdentifier="A"/>
          <ModelVariables>
            <UInt64 name="n" valueReference="1" causality="structuralParameter" variability="tunable" start="2"/>
            <Float64 name="x" valueReference="5" start="1 2 3 4"><Dimension valueReference="1"/><Dimension start="2"/></Float64>
            <Float64 name="dx" valueReference="6" derivative="5"><Dimension valueReference="1"/><Dimension start="2"/></Float64>
          </ModelVariables>
          <ModelStructure><ContinuousStateDerivative valueReference="6"/></ModelStructure>
        </fmiModelDescription>"#;
        let found = read(text).unwrap();
        let names: Vec<&str> = found.variables.iter().map(|v| v.name.as_str()).collect();
        assert_eq!(names[..5], ["n", "x[1,1]", "x[1,2]", "x[2,1]", "x[2,2]"]);
        assert_eq!(found.variables[3].start, Some(3.0));
        assert_eq!((found.state_count, found.values), (4, 9));
    }

    #[test]
    fn entities_and_other_roots_are_refused() {
        let bomb = "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]><x>&b;</x>";
        let Err(Unusable::Wrong(why)) = read(bomb) else { panic!("must be refused") };
        assert!(why.contains("DTD"), "{why}");
        assert!(matches!(read("<x/>"), Err(Unusable::Wrong(_))));
        let one = "<fmiModelDescription fmiVersion=\"1.0\"/>";
        assert_eq!(read(one), Err(Unusable::Version("1.0".to_owned())));
    }
}
