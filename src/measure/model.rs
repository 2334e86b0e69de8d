//! The model that extends the user's model with the variables that measures need.
//!
//! Its frame is generated source; the expressions of the measures are inserted as syntax trees, so that
//! diagnostics about them show the user's source.

use std::sync::Arc;

use super::error;
use super::text::{Function, Measures, reference};
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::ir::ast::{BinaryOp, Class, ClassBody, ElementKind, Expr, ExprKind, File, Modification};
use crate::ir::expr::{ExprId, Graph, Node, VarId};
use crate::ir::flat::{FlatModel, Variability};
use crate::parse::grammar::parse;

/// Name of the extended model.
pub const MODEL: &str = "'model with measures'";

/// Name of the variable that is an expression.
pub fn expression(e: usize) -> String {
    format!("'measure: expression {e}'")
}

/// Name of the Boolean that is a condition.
fn condition(c: usize) -> String {
    format!("'measure: condition {c}'")
}

/// Name of the Boolean that stays true once a condition was.
pub fn happened(c: usize) -> String {
    format!("'measure: happened {c}'")
}

/// Name of the integral of an expression.
pub fn integral(e: usize) -> String {
    format!("'measure: integral {e}'")
}

/// Name of the state whose final value is the time at which a condition becomes true, after the start.
pub fn stopwatch(c: usize) -> String {
    format!("'measure: stopwatch {c}'")
}

/// Name of the variable that keeps the value that an expression has when a condition becomes true.
pub fn held(e: usize, c: usize) -> String {
    format!("'measure: held {e} {c}'")
}

/// Name of the variable that keeps the value that the integral of an expression has then.
pub fn held_integral(e: usize, c: usize) -> String {
    format!("'measure: held integral {e} {c}'")
}

/// Name of the parameter that is 1 once the values of functions are known.
pub const KNOWN: &str = "'measure: known'";

/// The value of a measure once it is known, and 0 before, to avoid divisions by unknown values.
fn guarded(value: &Expr) -> Expr {
    let of = |kind| Expr { kind, span: value.span };
    // Not a Boolean: that would be a structural parameter.
    let known = Box::new(of(reference(KNOWN, value.span)));
    let half = Box::new(of(ExprKind::Real(0.5)));
    let condition = of(ExprKind::Binary(BinaryOp::Greater, known, half));
    let otherwise = Box::new(of(ExprKind::Real(0.0)));
    of(ExprKind::If { branches: vec![(condition, value.clone())], otherwise })
}

/// Whether a variable belongs to measures, and not to the user's model.
pub fn is_internal(name: &str) -> bool {
    name.starts_with("'measure: ") || name.starts_with("der('measure: ")
}

/// The extended model of the model `base` with its annotation.
pub fn file(
    measures: &Measures,
    base: &str,
    annotation: Option<Arc<Modification>>,
    sources: &mut SourceMap,
) -> File {
    let mut text = format!("model {MODEL}\n  extends {base};\n");
    let mut equations = String::new();
    if !measures.list.is_empty() {
        text.push_str(&format!("  parameter Real {KNOWN} = 0;\n"));
    }
    for e in 0..measures.expressions.len() {
        text.push_str(&format!("  Real {} = 0;\n", expression(e)));
    }
    for c in 0..measures.conditions.len() {
        let (now, ever) = (condition(c), happened(c));
        text.push_str(&format!("  Boolean {now} = true;\n"));
        text.push_str(&format!("  Boolean {ever}(start = false, fixed = true);\n"));
        equations.push_str(&format!("  {ever} = pre({ever}) or {now};\n"));
    }
    for (k, function) in measures.functions.iter().enumerate() {
        text.push_str(&format!("  parameter Real {} = 0;\n", Measures::value_name(k)));
        if let Function::Integral { of, .. } = function {
            let sum = integral(*of);
            text.push_str(&format!("  Real {sum}(start = 0, fixed = true);\n"));
            equations.push_str(&format!("  der({sum}) = {};\n", expression(*of)));
        }
    }
    if measures.has_slopes {
        add_slopes(measures, &mut text, &mut equations);
    }
    for measure in &measures.list {
        text.push_str(&format!("  parameter Real {} = 0;\n", measure.name));
    }
    text.push_str(&format!("equation\n{equations}end {MODEL};\n"));

    let id = sources.add("measures.mo", text.as_str());
    let mut file = parse(id, &text, &mut Problems::new());
    for class in &mut file.classes {
        let mut whole = Class::clone(class);
        whole.annotation.clone_from(&annotation);
        bind(&mut whole, &|name| {
            let of = |list: &[Expr], called: fn(usize) -> String| {
                (0..list.len()).find(|k| called(*k) == name).map(|k| Arc::new(list[k].clone()))
            };
            let of_measure = || measures.list.iter().find(|m| m.name == name);
            of(&measures.expressions, expression)
                .or_else(|| of(&measures.conditions, condition))
                .or_else(|| of_measure().map(|m| Arc::new(guarded(&m.value))))
        });
        // A measure that collides with a component is reported at the user's source.
        for measure in &measures.list {
            place(&mut whole, measure);
        }
        *class = Arc::new(whole);
    }
    file
}

/// Adds variables whose derivatives are those of measures, also where instants of events move: the sensitivities of a
/// run are exact for states and discrete variables.
fn add_slopes(measures: &Measures, text: &mut String, equations: &mut String) {
    for c in 0..measures.conditions.len() {
        let (watch, ever) = (stopwatch(c), happened(c));
        text.push_str(&format!("  Real {watch}(start = 0, fixed = true);\n"));
        equations.push_str(&format!("  der({watch}) = if {ever} then 0 else 1;\n"));
    }
    let mut known: Vec<String> = Vec::new();
    let mut hold = |name: String, value: String, c: usize| {
        if known.contains(&name) {
            return;
        }
        text.push_str(&format!("  discrete Real {name}(start = 0, fixed = true);\n"));
        let ever = happened(c);
        equations.push_str(&format!("  when {ever} then\n    {name} = {value};\n  end when;\n"));
        known.push(name);
    };
    for function in &measures.functions {
        match function {
            Function::At(e, c) => hold(held(*e, *c), expression(*e), *c),
            Function::Integral { of, range, .. } => {
                for c in range.from.iter().chain(&range.until) {
                    hold(held_integral(*of, *c), integral(*of), *c);
                }
            }
            _ => {}
        }
    }
}

/// Reports measures that depend on variables outside their functions.
pub fn check(flat: &FlatModel, measures: &Measures, problems: &mut Problems) {
    for measure in &measures.list {
        let declared = flat.variables.iter().find(|v| v.name == measure.name);
        let Some(binding) = declared.and_then(|v| v.binding) else { continue };
        let moves = |v: &VarId| flat.variables[*v].variability > Variability::Parameter;
        let variables = flat.graph.variables(binding);
        if variables.iter().any(moves) || reads_time(&flat.graph, binding) {
            problems.push(error::moves(measure.value.span, &measure.name));
        }
    }
}

fn reads_time(graph: &Graph, e: ExprId) -> bool {
    graph.any([e], |_, node| node == Node::Time)
}

/// Gives components their bindings.
fn bind(class: &mut Class, value: &dyn Fn(&str) -> Option<Arc<Expr>>) {
    let ClassBody::Long(composition) = &mut class.body else { return };
    for element in &mut composition.elements {
        let ElementKind::Components(clause) = &mut element.kind else { continue };
        for component in &mut clause.components {
            let Some(found) = value(&component.name.name) else { continue };
            if let Some(modification) = &component.modification {
                let mut own = Modification::clone(modification);
                own.binding = Some(found);
                component.modification = Some(Arc::new(own));
            }
        }
    }
}

/// Gives the declaration of a measure the place of its source.
fn place(class: &mut Class, measure: &super::text::Measure) {
    let ClassBody::Long(composition) = &mut class.body else { return };
    for element in &mut composition.elements {
        let ElementKind::Components(clause) = &mut element.kind else { continue };
        for component in &mut clause.components {
            if *component.name.name == *measure.name {
                component.name.span = measure.value.span;
                element.span = measure.value.span;
            }
        }
    }
}
