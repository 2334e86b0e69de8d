//! An FMU as the text of a block: a class of Modelica with its parameters, inputs and outputs, which runs the FMU as a
//! sampled system.
//!
//! At each communication point the FMU has stepped with the inputs of the point before, so outputs never depend on
//! inputs of the same instant. In: the interface. Out: a text that needs no other library.

use std::path::Path;

use crate::ir::foreign::{ForeignInterface, ForeignRole, ForeignType, ForeignVariable};

use super::text::{comment, identifier, literal, quoted};

/// The distance of communication points if the FMU says nothing about it, s.
const STEP: f64 = 0.01;
/// Communication points in the default experiment of an FMU without a step.
const STEPS: f64 = 500.0;
/// Distance of the connectors in the icon.
const PITCH: i64 = 40;

/// The functions that the runtime computes; `FMU` is an external object.
pub(super) const FUNCTIONS: &str = r#"protected
  class FMU "The unpacked FMU"
    extends ExternalObject;
    function constructor
      input String file;
      input String token;
      output FMU fmu;
      external "C" fmu = mocc_fmu_open(file, token);
    end constructor;
    function destructor
      input FMU fmu;
      external "C" mocc_fmu_close(fmu);
    end destructor;
  end FMU;
  function setValue "The state after a value is set"
    input FMU fmu;
    input String name;
    input Integer before;
    input Real value;
    output Integer after;
    external "C" after = mocc_fmu_set(fmu, name, before, value);
  end setValue;
  function begin "The state after initialization"
    input FMU fmu;
    input Integer before;
    input Real startTime(unit="s");
    output Integer after;
    external "C" after = mocc_fmu_begin(fmu, before, startTime);
  end begin;
  function doStep "The state after a step"
    input FMU fmu;
    input Integer before;
    input Real size(unit="s");
    output Integer after;
    external "C" after = mocc_fmu_step(fmu, before, size);
  end doStep;
  function getValue "A value in a state"
    input FMU fmu;
    input String name;
    input Integer state;
    output Real value;
    external "C" value = mocc_fmu_get(fmu, name, state);
  end getValue;
"#;

/// The text of the block, for the FMU in `file` with this token.
pub fn block(interface: &ForeignInterface, class: &str, file: &str, token: &str) -> String {
    let of = |role| interface.variables.iter().filter(move |v| v.role == role);
    let parameters: Vec<&ForeignVariable> = of(ForeignRole::Parameter).collect();
    let inputs: Vec<&ForeignVariable> = of(ForeignRole::Input).collect();
    let outputs: Vec<&ForeignVariable> = of(ForeignRole::Output).collect();
    let own = |name: &str| {
        let mut name = name.to_owned();
        while interface.variables.iter().any(|v| v.name == name) {
            name.push('_');
        }
        name
    };
    let (size, start) = (own("communicationStep"), own("startTime"));
    let (fmu, state, told) = (own("fmu"), own("fmuState"), own("fmuStart"));
    let name = identifier(class);
    let mut out = format!("block {name}{}\n", comment(&interface.description));
    for ty in ["Real", "Integer", "Boolean"] {
        for (prefix, word) in [("input", "Input"), ("output", "Output")] {
            out.push_str(&format!("  connector {ty}{word} = {prefix} {ty} \"Signal\";\n"));
        }
    }
    for v in &parameters {
        let value = literal(v.ty, v.start.unwrap_or(0.0));
        let (ty, text) = (type_name(v.ty), comment(&v.description));
        let name = identifier(&v.name);
        out.push_str(&format!("  parameter {ty} {name}{} = {value}{text};\n", attributes(v, true)));
    }
    out.push_str(&format!(
        "  parameter Real {size}(unit=\"s\", min=0) = {:e} \"Distance of communication points\";\n",
        step_of(interface)
    ));
    out.push_str(&format!(
        "  parameter Real {start}(unit=\"s\") = {:e} \"Instant at which the FMU starts\";\n",
        interface.experiment[0].unwrap_or(0.0)
    ));
    for (list, word, x) in [(&inputs, "Input", -120), (&outputs, "Output", 100)] {
        for (k, v) in list.iter().enumerate() {
            let y = PITCH / 2 * (list.len() as i64 - 1) - PITCH * k as i64;
            let placement = format!(
                "annotation(Placement(transformation(extent={{{{{x},{}}},{{{},{}}}}})))",
                y - 10,
                x + 20,
                y + 10
            );
            let (ty, text) = (type_name(v.ty), comment(&v.description));
            let name = identifier(&v.name);
            out.push_str(&format!(
                "  {ty}{word} {name}{}{text} {placement};\n",
                attributes(v, false)
            ));
        }
    }
    out.push_str(FUNCTIONS);
    let (file, token) = (quoted(file), quoted(token));
    out.push_str(&format!("  parameter FMU {fmu} = FMU({file}, {token});\n"));
    out.push_str(&format!("  discrete Integer {state}(start=0) \"State of the FMU\";\n"));
    out.push_str(&format!("  Integer {told} \"State of the FMU after its initialization\";\n"));
    let held = |k: usize| own(&format!("fmuInput{}", k + 1));
    for (k, v) in inputs.iter().enumerate() {
        let (ty, name) = (type_name(v.ty), held(k));
        let of = quoted(&v.name).replace('"', "");
        out.push_str(&format!(
            "  discrete {ty} {name} \"Input {of} at the last communication point\";\n"
        ));
    }
    out.push_str("initial equation\n");
    out.push_str(&format!("  pre({state}) = {told};\nequation\n"));
    let mut chain = "0".to_owned();
    for v in &parameters {
        chain = set(&fmu, v, &chain, &number(v.ty, &identifier(&v.name)));
    }
    out.push_str(&format!("  {told} = begin({fmu}, {chain}, {start});\n"));
    if !inputs.is_empty() {
        out.push_str(&format!("  when {{initial(), sample({start} + {size}, {size})}} then\n"));
        for (k, v) in inputs.iter().enumerate() {
            out.push_str(&format!("    {} = {};\n", held(k), identifier(&v.name)));
        }
        out.push_str("  end when;\n");
    }
    let mut chain = format!("pre({state})");
    for (k, v) in inputs.iter().enumerate() {
        chain = set(&fmu, v, &chain, &number(v.ty, &format!("pre({})", held(k))));
    }
    out.push_str(&format!("  when sample({start} + {size}, {size}) then\n"));
    out.push_str(&format!("    {state} = doStep({fmu}, {chain}, {size});\n  end when;\n"));
    for v in &outputs {
        let value = format!("getValue({fmu}, {}, {state})", quoted(&v.name));
        let value = match v.ty {
            ForeignType::Real => value,
            ForeignType::Integer => format!("integer({value} + 0.5)"),
            ForeignType::Boolean => format!("{value} > 0.5"),
        };
        out.push_str(&format!("  {} = {value};\n", identifier(&v.name)));
    }
    out.push_str(
        "  annotation(Icon(graphics={Rectangle(extent={{-100,-100},{100,100}}, lineColor={0,0,127}, \
         fillColor={255,255,255}, fillPattern=FillPattern.Solid), Text(extent={{-100,20},{100,-20}}, \
         textString=\"FMU\"), Text(extent={{-150,140},{150,110}}, textString=\"%name\", \
         textColor={0,0,255})}));\n",
    );
    out.push_str(&format!("end {name};\n"));
    out
}

/// True for a file that holds no block of an FMU, such as the model from which an FMU of the same name was exported.
pub fn is_of_others(path: &Path) -> bool {
    match std::fs::read_to_string(path) {
        Ok(text) => !text.contains("mocc_fmu_open"),
        Err(why) => why.kind() != std::io::ErrorKind::NotFound,
    }
}

/// The distance of communication points that suits the FMU, s.
fn step_of(interface: &ForeignInterface) -> f64 {
    let [start, stop, step, _] = interface.experiment;
    let of_span = stop.map(|stop| (stop - start.unwrap_or(0.0)) / STEPS);
    step.or(of_span).filter(|step| *step > 0.0).unwrap_or(STEP)
}

pub(super) fn set(fmu: &str, v: &ForeignVariable, before: &str, value: &str) -> String {
    format!("setValue({fmu}, {}, {before}, {value})", quoted(&v.name))
}

/// A value as a Real.
pub(super) fn number(ty: ForeignType, value: &str) -> String {
    match ty {
        ForeignType::Boolean => format!("(if {value} then 1.0 else 0.0)"),
        _ => value.to_owned(),
    }
}

pub(super) fn type_name(ty: ForeignType) -> &'static str {
    match ty {
        ForeignType::Real => "Real",
        ForeignType::Integer => "Integer",
        ForeignType::Boolean => "Boolean",
    }
}

/// Units, and the bounds of parameters.
fn attributes(v: &ForeignVariable, with_bounds: bool) -> String {
    let list = attribute_list(v, with_bounds);
    if list.is_empty() { String::new() } else { format!("({})", list.join(", ")) }
}

/// The same one by one.
pub(super) fn attribute_list(v: &ForeignVariable, with_bounds: bool) -> Vec<String> {
    let mut list = Vec::new();
    if v.ty == ForeignType::Real {
        for (key, text) in [("unit", &v.unit), ("displayUnit", &v.display_unit)] {
            if !text.is_empty() {
                list.push(format!("{key}={}", quoted(text)));
            }
        }
    }
    if with_bounds && v.ty != ForeignType::Boolean {
        for (key, x) in [("min", v.range.0), ("max", v.range.1)] {
            list.extend(x.map(|x| format!("{key}={}", literal(v.ty, x))));
        }
    }
    list
}
