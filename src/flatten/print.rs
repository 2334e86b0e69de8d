//! The flat model as text that is itself valid Modelica: dotted names are written as quoted
//! identifiers (section 2.3.1 of the specification), so that any Modelica tool reads it.

use crate::base::index::FastSet;
use crate::ir::ast::{Causality, Variability};
use crate::ir::expr::{EnumId, ExprId, Type, VarId};
use crate::ir::flat::{
    Action, Assert, Equation, EquationKind, FlatModel, StateSelect, Variable, WhenBranch,
};
use crate::symbolic::print::{Printer, type_name};

/// Prints the model.
pub fn print(flat: &FlatModel) -> String {
    let mut out = String::new();
    let title = quoted(&flat.name);
    out.push_str(&format!("model {title}{}\n", description(flat.description.as_deref())));
    for e in used_enumerations(flat) {
        let ty = &flat.graph.enumerations[e];
        let literals: Vec<&str> = ty.literals.iter().map(|l| l.as_str()).collect();
        out.push_str(&format!(
            "  type {} = enumeration({});\n",
            quoted(&ty.name),
            literals.join(", ")
        ));
    }
    for v in flat.variables.iter() {
        out.push_str(&declaration(flat, v));
    }
    section(flat, &mut out, "initial equation", &flat.initial_equations);
    section(flat, &mut out, "equation", &flat.equations);
    if let Some(text) = experiment(flat) {
        out.push_str(&format!("  annotation(experiment({text}));\n"));
    }
    out.push_str(&format!("end {title};\n"));
    out
}

/// An identifier, quoted if it is none by itself.
pub fn quoted(name: &str) -> String {
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name.chars().next().is_some_and(|c| !c.is_ascii_digit());
    let already = name.starts_with('\'')
        && name.ends_with('\'')
        && name.len() > 1
        && !name[1..name.len() - 1].contains('\'');
    if plain || already {
        return name.to_string();
    }
    let mut text = String::with_capacity(name.len() + 2);
    text.push('\'');
    if name.contains('\'') {
        text.push_str(&name.replace('\'', "\\'"));
    } else {
        text.push_str(name);
    }
    text.push('\'');
    text
}

fn description(text: Option<&str>) -> String {
    match text {
        Some(t) if !t.is_empty() => {
            format!(" \"{}\"", t.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
        }
        _ => String::new(),
    }
}

fn used_enumerations(flat: &FlatModel) -> Vec<EnumId> {
    let mut seen = FastSet::default();
    let mut out = Vec::new();
    for v in flat.variables.iter() {
        if let Type::Enumeration(e) = v.ty
            && !matches!(flat.graph.enumerations[e].name.as_str(), "StateSelect" | "AssertionLevel")
            && seen.insert(e)
        {
            out.push(e);
        }
    }
    out.sort();
    out
}

fn expression(flat: &FlatModel, e: ExprId) -> String {
    Printer {
        graph: &flat.graph,
        variable: &|v: VarId| quoted(&flat.variables[v].name),
        enumeration: &quoted,
        relation: &|_| None,
    }
    .print(e)
}

fn declaration(flat: &FlatModel, v: &Variable) -> String {
    let mut words = Vec::new();
    if v.variability <= Variability::Parameter
        && v.structural
        && v.variability == Variability::Parameter
    {
        words.push("final".to_string());
    }
    match v.variability {
        Variability::Constant => words.push("constant".into()),
        Variability::Parameter => words.push("parameter".into()),
        Variability::Discrete if v.ty == Type::Real => words.push("discrete".into()),
        _ => {}
    }
    match v.causality {
        Some(Causality::Input) => words.push("input".into()),
        Some(Causality::Output) => words.push("output".into()),
        None => {}
    }
    words.push(match v.ty {
        Type::Enumeration(_) => quoted(&type_name(&flat.graph, v.ty)),
        _ => type_name(&flat.graph, v.ty),
    });
    let mut attributes = Vec::new();
    if !v.unit.is_empty() {
        attributes.push(format!("unit = \"{}\"", v.unit));
    }
    if !v.display_unit.is_empty() {
        attributes.push(format!("displayUnit = \"{}\"", v.display_unit));
    }
    let numbers = [("min", v.min), ("max", v.max), ("start", v.start), ("nominal", v.nominal)];
    for (text, e) in numbers {
        if let Some(e) = e {
            attributes.push(format!("{text} = {}", expression(flat, e)));
        }
    }
    if let Some(fixed) = v.fixed {
        attributes.push(format!("fixed = {fixed}"));
    }
    if v.state_select != StateSelect::Default {
        let text = format!("{:?}", v.state_select).to_lowercase();
        attributes.push(format!("stateSelect = StateSelect.{text}"));
    }
    let attributes =
        if attributes.is_empty() { String::new() } else { format!("({})", attributes.join(", ")) };
    let binding = v.binding.map_or(String::new(), |e| format!(" = {}", expression(flat, e)));
    let text = description(v.description.as_deref());
    format!("  {} {}{attributes}{binding}{text};\n", words.join(" "), quoted(&v.name))
}

fn section(flat: &FlatModel, out: &mut String, title: &str, list: &[Equation]) {
    if list.is_empty() {
        return;
    }
    out.push_str(title);
    out.push('\n');
    for e in list {
        match &e.kind {
            EquationKind::Equal(a, b) => out.push_str(&equality(flat, *a, *b)),
            EquationKind::When(branches) => when(flat, out, branches),
            EquationKind::Assert(a) => out.push_str(&format!("  {};\n", assertion(flat, a))),
            EquationKind::Algorithm { outputs, values } => {
                for (v, e) in outputs.iter().zip(values) {
                    let name = quoted(&flat.variables[*v].name);
                    out.push_str(&format!("  {name} = {};\n", expression(flat, *e)));
                }
            }
        }
    }
}

/// An `if` on the left side must stand in parentheses.
fn equality(flat: &FlatModel, a: ExprId, b: ExprId) -> String {
    let left = expression(flat, a);
    let left = if left.starts_with("if ") { format!("({left})") } else { left };
    format!("  {left} = {};\n", expression(flat, b))
}

fn when(flat: &FlatModel, out: &mut String, branches: &[WhenBranch]) {
    for (k, branch) in branches.iter().enumerate() {
        let conditions: Vec<String> =
            branch.conditions.iter().map(|c| expression(flat, *c)).collect();
        let condition = match conditions.as_slice() {
            [one] => one.clone(),
            many => format!("{{{}}}", many.join(", ")),
        };
        let word = if k == 0 { "when" } else { "elsewhen" };
        out.push_str(&format!("  {word} {condition} then\n"));
        for a in &branch.actions {
            let text = match a {
                Action::Assign(v, e) => {
                    format!("{} = {}", quoted(&flat.variables[*v].name), expression(flat, *e))
                }
                Action::Reinit { state, value, guard } => {
                    let text = format!(
                        "reinit({}, {})",
                        quoted(&flat.variables[*state].name),
                        expression(flat, *value)
                    );
                    match guard {
                        Some(g) => format!("if {} then {text}; end if", expression(flat, *g)),
                        None => text,
                    }
                }
                Action::Assert(a) => assertion(flat, a),
                Action::Terminate(m) => format!("terminate({})", expression(flat, *m)),
            };
            out.push_str(&format!("    {text};\n"));
        }
    }
    out.push_str("  end when;\n");
}

fn assertion(flat: &FlatModel, a: &Assert) -> String {
    let level = if a.warning { ", AssertionLevel.warning" } else { "" };
    format!("assert({}, {}{level})", expression(flat, a.condition), expression(flat, a.message))
}

fn experiment(flat: &FlatModel) -> Option<String> {
    let e = flat.experiment;
    let entries = [
        ("StartTime", e.start),
        ("StopTime", e.stop),
        ("Interval", e.interval),
        ("Tolerance", e.tolerance),
    ];
    let list: Vec<String> = entries
        .iter()
        .filter_map(|(n, v)| {
            v.map(|v| format!("{n} = {}", crate::symbolic::print::real_literal(v)))
        })
        .collect();
    (!list.is_empty()).then(|| list.join(", "))
}
