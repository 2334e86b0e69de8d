//! An FMU as the text of a model whose surroundings are equations: what comes to its inputs and what becomes of its
//! outputs can be extended, its inside cannot.
//!
//! The FMU steps from one communication point to the next, as in a [`block`](super::block), but more closely: a step gets
//! the means of its inputs at both ends, and between two points outputs continue on the line through the last two. So
//! the error of the coupling falls with the square of the step, and outputs can be differentiated by time. At a point an
//! output jumps a little, from the line to its value, which sensors with short time constants would see as a fast change.
//! So the first step is half as long as the others: rows at multiples of the step lie between points.
//!
//! In: the interface, and which of its variables the model has. Out: a text that needs no other library.

use crate::ir::foreign::{ForeignInterface, ForeignRole, ForeignType, ForeignVariable};

use super::block::{FUNCTIONS, attribute_list, number, set, type_name};
use super::text::{comment, identifier, literal, quoted};

/// What the model has besides the parameters and inputs of the FMU.
#[derive(Clone, PartialEq, Debug)]
pub struct Whole<'a> {
    /// The name of the model, an identifier.
    pub class: &'a str,
    /// The file of the FMU, and its token.
    pub file: &'a str,
    /// See `file`.
    pub token: &'a str,
    /// The distance of communication points, s.
    pub step: f64,
    /// Every step has that length, the first one too.
    pub is_even: bool,
    /// Variables that the FMU computes and that are not its outputs.
    pub shown: &'a [String],
    /// Variables whose start values are parameters of the model, named `x.start`.
    pub starts: &'a [String],
    /// Parameters that are passed at each communication point: they may change while the FMU runs.
    pub passed: &'a [String],
}

/// The name of the parameter for the start value of a variable.
pub fn start_name(variable: &str) -> String {
    format!("{variable}.start")
}

/// The text of the model.
pub fn model(interface: &ForeignInterface, whole: &Whole<'_>) -> String {
    Writer::new(interface, whole).text()
}

/// A variable of the FMU and the names of what the model keeps for it.
struct Kept<'a> {
    variable: &'a ForeignVariable,
    /// Its name as an identifier.
    name: String,
    /// Its value at the last communication point.
    held: String,
}

/// Names that no variable of the FMU has.
struct Own {
    /// The distance of communication points.
    step: String,
    /// The FMU.
    fmu: String,
    /// Its state.
    state: String,
    /// Its state one step before.
    before: String,
    /// Its state after the initialization.
    start: String,
    /// The instant at which it starts.
    begin: String,
    /// The number of steps.
    steps: String,
    /// The last communication point.
    point: String,
    /// The length of the step to it.
    size: String,
}

struct Writer<'a> {
    whole: &'a Whole<'a>,
    interface: &'a ForeignInterface,
    parameters: Vec<Kept<'a>>,
    starts: Vec<&'a ForeignVariable>,
    inputs: Vec<Kept<'a>>,
    outputs: Vec<Kept<'a>>,
    own: Own,
}

impl<'a> Writer<'a> {
    fn new(interface: &'a ForeignInterface, whole: &'a Whole<'a>) -> Self {
        let all = &interface.variables;
        let own = |name: &str| {
            let mut name = name.to_owned();
            while all.iter().any(|v| v.name == name) {
                name.push('_');
            }
            name
        };
        let kept = |what: &str, wanted: &dyn Fn(&ForeignVariable) -> bool| -> Vec<Kept<'a>> {
            let found = all.iter().filter(|v| wanted(v)).enumerate();
            let one = |(k, variable): (usize, &'a ForeignVariable)| Kept {
                variable,
                name: identifier(&variable.name),
                held: own(&format!("fmu{what}{}", k + 1)),
            };
            found.map(one).collect()
        };
        let is_shown = |v: &ForeignVariable| match v.role {
            ForeignRole::Output => true,
            ForeignRole::Computed => whole.shown.contains(&v.name),
            _ => false,
        };
        Writer {
            whole,
            interface,
            parameters: kept("Parameter", &|v| v.role == ForeignRole::Parameter),
            starts: all.iter().filter(|v| whole.starts.contains(&v.name)).collect(),
            inputs: kept("Input", &|v| v.role == ForeignRole::Input),
            outputs: kept("Output", &is_shown),
            own: Own {
                step: own("communicationStep"),
                fmu: own("fmu"),
                state: own("fmuState"),
                before: own("fmuBefore"),
                start: own("fmuStart"),
                begin: own("fmuBegin"),
                steps: own("fmuSteps"),
                point: own("fmuPoint"),
                size: own("fmuStepSize"),
            },
        }
    }

    fn text(&self) -> String {
        let mut out =
            format!("model {}{}\n", self.whole.class, comment(&self.interface.description));
        self.declare(&mut out);
        out.push_str(FUNCTIONS);
        self.keep(&mut out);
        self.begin(&mut out);
        self.step(&mut out);
        let [start, stop, ..] = self.interface.experiment;
        let entries = [("StartTime", start), ("StopTime", stop)];
        let entries: Vec<String> =
            entries.iter().filter_map(|(key, x)| Some(format!("{key}={:e}", (*x)?))).collect();
        if !entries.is_empty() {
            out.push_str(&format!("  annotation(experiment({}));\n", entries.join(", ")));
        }
        out.push_str(&format!("end {};\n", self.whole.class));
        out
    }

    fn is_passed(&self, kept: &Kept<'_>) -> bool {
        let v = kept.variable;
        v.ty == ForeignType::Real && v.is_tunable && self.whole.passed.contains(&v.name)
    }

    /// The parameters, inputs and outputs.
    fn declare(&self, out: &mut String) {
        let mut add = |prefix: &str,
                       v: &ForeignVariable,
                       name: &str,
                       attributes: Vec<String>,
                       value: &str| {
            let attributes = match attributes.as_slice() {
                [] => String::new(),
                list => format!("({})", list.join(", ")),
            };
            let (ty, text) = (type_name(v.ty), comment(&v.description));
            out.push_str(&format!("  {prefix}{ty} {name}{attributes}{value}{text};\n"));
        };
        for Kept { variable: v, name, .. } in &self.parameters {
            let value = format!(" = {}", literal(v.ty, v.start.unwrap_or(0.0)));
            add("parameter ", v, name, attribute_list(v, true), &value);
        }
        for v in &self.starts {
            let value = format!(" = {}", literal(v.ty, v.start.unwrap_or(0.0)));
            add(
                "parameter ",
                v,
                &identifier(&start_name(&v.name)),
                attribute_list(v, false),
                &value,
            );
        }
        for Kept { variable: v, name, .. } in &self.inputs {
            let mut attributes = attribute_list(v, false);
            attributes.push(format!("start={}", literal(v.ty, v.start.unwrap_or(0.0))));
            add("input ", v, name, attributes, "");
        }
        for Kept { variable: v, name, .. } in &self.outputs {
            add("output ", v, name, attribute_list(v, false), "");
        }
        out.push_str(&format!(
            "  parameter Real {}(unit=\"s\", min=0) = {:e} \"Distance of communication points\";\n",
            self.own.step, self.whole.step
        ));
    }

    /// What is kept from one communication point to the next.
    fn keep(&self, out: &mut String) {
        let Own { fmu, state, before, start, begin, steps, point, size, .. } = &self.own;
        let (file, token) = (quoted(self.whole.file), quoted(self.whole.token));
        out.push_str(&format!("  parameter FMU {fmu} = FMU({file}, {token});\n"));
        let mut add = |declaration: String, what: &str| {
            out.push_str(&format!("  {declaration} \"{what}\";\n"));
        };
        add(format!("discrete Integer {state}"), "State of the FMU");
        add(format!("discrete Integer {before}"), "State of the FMU one step before");
        add(
            format!("parameter Integer {start}(fixed=false)"),
            "State of the FMU after its initialization",
        );
        add(
            format!("parameter Real {begin}(unit=\"s\", fixed=false)"),
            "Instant at which it starts",
        );
        add(format!("discrete Integer {steps}(start=0, fixed=true)"), "Number of steps");
        add(format!("discrete Real {point}(unit=\"s\")"), "Last communication point");
        add(format!("discrete Real {size}(unit=\"s\")"), "Length of the last step");
        for kept in self.parameters.iter().filter(|kept| self.is_passed(kept)) {
            add(
                format!("discrete Real {}(start={}, fixed=true)", kept.held, kept.name),
                &last(kept.variable),
            );
        }
        for Kept { variable, held, .. } in &self.inputs {
            add(format!("discrete {} {held}", type_name(variable.ty)), &last(variable));
        }
        for Kept { variable, held, .. } in &self.outputs {
            add(format!("{} {held}", type_name(variable.ty)), &last(variable));
        }
    }

    /// The initialization.
    fn begin(&self, out: &mut String) {
        let Own { step, fmu, state, before, start, begin, point, size, .. } = &self.own;
        out.push_str("initial equation\n");
        out.push_str(&format!("  {begin} = time;\n  {point} = time;\n  {size} = {step};\n"));
        let mut chain = "0".to_owned();
        for kept in &self.parameters {
            let value = match self.is_passed(kept) {
                true => format!("pre({})", kept.held),
                false => kept.name.clone(),
            };
            chain = set(fmu, kept.variable, &chain, &number(kept.variable.ty, &value));
        }
        for v in &self.starts {
            chain = set(fmu, v, &chain, &number(v.ty, &identifier(&start_name(&v.name))));
        }
        for kept in &self.inputs {
            chain = set(fmu, kept.variable, &chain, &number(kept.variable.ty, &kept.name));
        }
        out.push_str(&format!("  {start} = begin({fmu}, {chain}, {begin});\n"));
        out.push_str(&format!("  {state} = {start};\n  {before} = {start};\n"));
        for kept in &self.inputs {
            out.push_str(&format!("  {} = {};\n", kept.held, kept.name));
        }
    }

    /// A value of the FMU in a state.
    fn got(&self, kept: &Kept<'_>, state: &str) -> String {
        let value = format!("getValue({}, {}, {state})", self.own.fmu, quoted(&kept.variable.name));
        match kept.variable.ty {
            ForeignType::Real => value,
            ForeignType::Integer => format!("integer({value} + 0.5)"),
            ForeignType::Boolean => format!("{value} > 0.5"),
        }
    }

    /// A communication point, and the outputs between two of them. Outputs are read outside of the when-clause: there
    /// they would also be read in states that the run never comes to.
    fn step(&self, out: &mut String) {
        let Own { step, fmu, state, before, begin, steps, point, size, .. } = &self.own;
        let first = if self.whole.is_even { 1.0 } else { 0.5 };
        out.push_str("equation\n");
        out.push_str(&format!("  when time >= {begin} + (pre({steps}) + {first:?})*{step} then\n"));
        out.push_str(&format!("    {steps} = pre({steps}) + 1;\n    {point} = time;\n"));
        out.push_str(&format!(
            "    {size} = (if pre({steps}) == 0 then {first:?} else 1.0)*{step};\n"
        ));
        let mut chain = format!("pre({state})");
        for kept in self.parameters.iter().filter(|kept| self.is_passed(kept)) {
            out.push_str(&format!("    {} = {};\n", kept.held, kept.name));
            chain = set(fmu, kept.variable, &chain, &format!("pre({})", kept.held));
        }
        for kept in &self.inputs {
            out.push_str(&format!("    {} = {};\n", kept.held, kept.name));
            let value = match kept.variable.ty {
                ForeignType::Real => format!("0.5*(pre({}) + {})", kept.held, kept.name),
                ty => number(ty, &format!("pre({})", kept.held)),
            };
            chain = set(fmu, kept.variable, &chain, &value);
        }
        out.push_str(&format!("    {state} = doStep({fmu}, {chain}, {size});\n"));
        out.push_str(&format!("    {before} = pre({state});\n  end when;\n"));
        for kept in &self.outputs {
            let Kept { variable, name, held } = kept;
            out.push_str(&format!("  {held} = {};\n", self.got(kept, state)));
            let value = match variable.ty {
                ForeignType::Real => {
                    let last = self.got(kept, before);
                    format!("{held} + ({held} - {last})/{size}*(time - {point})")
                }
                _ => held.clone(),
            };
            out.push_str(&format!("  {name} = {value};\n"));
        }
    }
}

/// The description of what is kept of a variable.
fn last(v: &ForeignVariable) -> String {
    format!("Last value of {}", v.name.replace('"', "'"))
}
