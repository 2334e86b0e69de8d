//! Prints a flat model as valid Modelica: dotted names become quoted identifiers (Modelica 3.6,
//! section 2.3.1), so that any Modelica tool can read it.

pub mod common_subexpressions;
mod equation;
pub(crate) mod function;
pub(crate) mod function_locals;
mod identifier;

use crate::base::index::FastSet;
use crate::ir::ast::{Causality, Variability};
use crate::ir::expr::{Binary, EnumId, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::external::ExternalId;
use crate::ir::flat::{Equation, FlatModel, StateSelect, Transport, Variable};
use crate::symbolic::print::{Printer, real_literal, type_name};
use common_subexpressions::TooLong;
use identifier::{push_quoted, quoted};

/// Models with at least this many variables and equations are printed by two threads.
const PARALLEL_THRESHOLD: usize = 50_000;
/// Stack of the second thread, bytes; only what is used is allocated. A sum of many terms is nested as deeply.
const STACK: usize = 1 << 30;

/// Prints the model, with variables for common subexpressions if it is large. Fails if it is too
/// large even so.
pub fn print(flat: &FlatModel) -> Result<String, TooLong> {
    fragments(flat).map(|fragments| fragments.concat())
}

/// Like [`print`], as consecutive fragments: large models are printed by two threads.
pub fn fragments(flat: &FlatModel) -> Result<Vec<String>, TooLong> {
    let shared = common_subexpressions::extract(flat)?;
    let flat = shared.as_ref().unwrap_or(flat);
    let (implicit, tables) = (implicit(flat), tables(flat));
    let write = |act: &dyn Fn(&mut ModelPrinter<'_>)| {
        let mut text =
            ModelPrinter { flat, implicit: &implicit, tables: &tables, out: String::new() };
        act(&mut text);
        text.out
    };
    if flat.variables.len() + flat.equations.len() < PARALLEL_THRESHOLD {
        return Ok(vec![write(&|text| {
            text.declarations();
            text.equations(&flat.equations);
            text.end();
        })]);
    }
    // A declaration is about as long as an equation.
    let (near, far) = flat.equations.split_at(flat.equations.len() / 4);
    let print_rest = || {
        write(&|text| {
            text.list(far);
            text.end();
        })
    };
    std::thread::scope(|scope| {
        let builder = std::thread::Builder::new().stack_size(STACK);
        let rest = builder.spawn_scoped(scope, print_rest);
        let first = write(&|text| {
            text.declarations();
            text.equations(near);
        });
        match rest.map(std::thread::ScopedJoinHandle::join) {
            Ok(Ok(rest)) => Ok(vec![first, rest]),
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            // Without a second thread, this one prints the rest.
            Err(_) => Ok(vec![first, print_rest()]),
        }
    })
}

/// The variables that are implicit in calls of `delay` and `spatialDistribution`.
fn implicit(flat: &FlatModel) -> FastSet<VarId> {
    let mut found = FastSet::default();
    for line in &flat.transports {
        found.insert(line.ends[1]);
        if line.longest.is_some() {
            found.insert(line.ends[0]);
        }
        for reader in &line.readers {
            found.extend([reader.from, reader.to, reader.arrives]);
            if line.longest.is_none() {
                found.insert(reader.place);
            }
        }
    }
    found
}

/// A table that is declared before it is used.
#[derive(Clone, Copy)]
pub(crate) struct Table {
    id: ExternalId,
    /// It is a function, rather than an array.
    is_function: bool,
}

/// The tables whose subscripts or arguments vary during simulation.
fn tables(flat: &FlatModel) -> Vec<Table> {
    let mut found: Vec<Table> = Vec::new();
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    flat.functions.iter().for_each(|function| roots.extend(function.values()));
    let used: FastSet<ExprId> = flat.graph.postorder(roots).into_iter().collect();
    for e in flat.graph.ids().filter(|e| used.contains(e)) {
        let Node::Unary(Unary::External(id), _) = flat.graph.node(e) else { continue };
        let external = flat.graph.externals().get(id);
        let is_function = external.elements().is_none();
        let is_known = found.iter().any(|table| table.id == id);
        if !is_known && (!is_function || external.modelica("f").is_some()) {
            found.push(Table { id, is_function });
        }
    }
    found
}

/// The function that compares Real values: `==` on Reals is only allowed in functions (Modelica
/// 3.6, section 3.5).
const EQUAL: &str = "'$equal'";

fn is_equality(graph: &Graph, op: Binary, a: ExprId, b: ExprId) -> bool {
    let numbers = [a, b].map(|e| graph.ty(e));
    matches!(op, Binary::Equal | Binary::NotEqual)
        && numbers.contains(&Type::Real)
        && numbers.iter().all(|ty| matches!(ty, Type::Real | Type::Integer))
}

/// True if Real values are compared for equality outside functions.
fn has_equalities(flat: &FlatModel) -> bool {
    let found = |e: ExprId| match flat.graph.node(e) {
        Node::Binary(op, a, b) => is_equality(&flat.graph, op, a, b),
        _ => false,
    };
    if !flat.graph.ids().any(found) {
        return false;
    }
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    flat.graph.any(roots, |e, _| found(e))
}

/// The function whose value is its first argument, and whose derivative is the second one.
const WITH_DERIVATIVE: &str = "'$with_derivative'";

fn with_derivative() -> String {
    let of_derivative = "'$derivative'";
    [
        ["  function ", of_derivative, "\n    input Real x;\n    input Real rate;\n"].concat(),
        "    input Real t;\n    input Real t_rate;\n    output Real y = rate;\n".to_owned(),
        ["  end ", of_derivative, ";\n"].concat(),
        ["  function ", WITH_DERIVATIVE, "\n    input Real x;\n    input Real rate;\n"].concat(),
        "    input Real t;\n    output Real y = x;\n".to_owned(),
        "    annotation(derivative(noDerivative = x, noDerivative = rate) = ".to_owned(),
        [of_derivative, ");\n  end ", WITH_DERIVATIVE, ";\n"].concat(),
    ]
    .concat()
}

/// The name of the constant that holds a table, or of the function that it is.
fn table_name(k: usize) -> String {
    format!("'$table{}'", k + 1)
}

/// The name of the variable that holds the value at a reader of a transport line.
fn reader_value(line: usize, reader: usize) -> String {
    format!("'$line{}.reader{}.value'", line + 1, reader + 1)
}

/// The enumerations of variables, and of literals that expressions name.
fn used_enumerations(flat: &FlatModel) -> Vec<EnumId> {
    let is_predefined = |e: EnumId| {
        let name = &flat.graph.enumerations[e].name;
        matches!(name.as_str(), "StateSelect" | "AssertionLevel")
    };
    let mut all = Vec::new();
    flat.for_each_expression(&mut |e| all.push(e));
    all.extend(flat.functions.iter().flat_map(|f| f.values()));
    let of_expressions = flat.graph.postorder(all).into_iter();
    let types = flat.variables.iter().map(|v| v.ty).chain(of_expressions.map(|e| flat.graph.ty(e)));
    let mut seen = FastSet::default();
    let used = types.filter_map(|ty| match ty {
        Type::Enumeration(e) if !is_predefined(e) && seen.insert(e) => Some(e),
        _ => None,
    });
    let mut out: Vec<EnumId> = used.collect();
    out.sort();
    out
}

/// Prints the parts of a model to `out`.
struct ModelPrinter<'a> {
    flat: &'a FlatModel,
    implicit: &'a FastSet<VarId>,
    tables: &'a [Table],
    out: String,
}

/// Prints an element of a table, given a printer for its subscript or argument.
pub(super) fn element(
    tables: &[Table],
    node: Node,
    out: &mut String,
    subscript: &mut dyn FnMut(ExprId, &mut String),
) -> bool {
    let Node::Unary(Unary::External(f), a) = node else { return false };
    let Some(k) = tables.iter().position(|t| t.id == f) else { return false };
    let [open, close] = if tables[k].is_function { ['(', ')'] } else { ['[', ']'] };
    out.push_str(&table_name(k));
    out.push(open);
    subscript(a, out);
    out.push(close);
    true
}

impl ModelPrinter<'_> {
    /// Prints everything before the equations.
    fn declarations(&mut self) {
        let flat = self.flat;
        let title = quoted(&flat.name);
        self.push(&["model ", &title]);
        self.description(flat.description.as_deref());
        self.out.push('\n');
        for e in used_enumerations(flat) {
            let ty = &flat.graph.enumerations[e];
            let literals: Vec<&str> = ty.literals.iter().map(|l| l.as_str()).collect();
            let literals = literals.join(", ");
            self.push(&["  type ", &quoted(&ty.name), " = enumeration(", &literals, ");\n"]);
        }
        for (k, table) in self.tables.iter().enumerate() {
            let external = flat.graph.externals().get(table.id);
            let Some((all, whole)) = external.elements() else {
                external.modelica(&table_name(k)).iter().for_each(|text| self.push(&[text]));
                continue;
            };
            let literal = |x: &f64| if whole { format!("{x}") } else { real_literal(*x) };
            let ty = if whole { "Integer" } else { "Real" };
            let list: Vec<String> = all.iter().map(literal).collect();
            let (size, list) = (all.len().to_string(), list.join(", "));
            self.push(&[
                "  constant ",
                ty,
                " ",
                &table_name(k),
                "[",
                &size,
                "] = {",
                &list,
                "};\n",
            ]);
        }
        if has_equalities(flat) {
            self.push(&["  function ", EQUAL, "\n    input Real a;\n    input Real b;\n"]);
            self.push(&["    output Boolean c = a == b;\n  end ", EQUAL, ";\n"]);
        }
        if flat.given_derivatives.iter().any(|g| g.derivative.is_some()) {
            self.push(&[&with_derivative()]);
        }
        self.out.push_str(&function::functions(flat, self.tables));
        for (id, v) in flat.variables.enumerate() {
            if !self.implicit.contains(&id) {
                self.declaration(v);
            }
        }
        for (k, line) in flat.transports.iter().enumerate() {
            for reader in 0..line.readers.len() {
                self.push(&["  Real ", &reader_value(k, reader), ";\n"]);
            }
        }
        if !flat.initial_equations.is_empty() {
            self.out.push_str("initial equation\n");
            self.list(&flat.initial_equations);
        }
    }

    /// Prints the equation section with the given first equations.
    fn equations(&mut self, list: &[Equation]) {
        if !self.flat.equations.is_empty() {
            self.out.push_str("equation\n");
            self.list(list);
        }
    }

    /// Prints everything after the equations.
    fn end(&mut self) {
        let flat = self.flat;
        for (k, line) in flat.transports.iter().enumerate() {
            for reader in 0..line.readers.len() {
                self.reader(line, &reader_value(k, reader), reader);
            }
        }
        if let Some(text) = experiment(flat) {
            self.push(&["  annotation(experiment(", &text, "));\n"]);
        }
        self.push(&["end ", &quoted(&flat.name), ";\n"]);
    }

    fn push(&mut self, parts: &[&str]) {
        parts.iter().for_each(|part| self.out.push_str(part));
    }

    fn name(&mut self, v: VarId) {
        push_quoted(&self.flat.variables[v].name, &mut self.out);
    }

    fn description(&mut self, text: Option<&str>) {
        let Some(text) = text.filter(|t| !t.is_empty()) else { return };
        let text = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
        self.push(&[" \"", &text, "\""]);
    }

    fn expression(&mut self, e: ExprId) {
        let (flat, implicit, tables) = (self.flat, self.implicit, self.tables);
        Printer {
            graph: &flat.graph,
            variable: &|v: VarId, out: &mut String| push_quoted(&flat.variables[v].name, out),
            enumeration: &quoted,
            relation: &|_| None,
            special: &|node: Node, out: &mut String| match node {
                Node::Recorded(v, 0) => {
                    // Delays are sorted by variable.
                    let Ok(k) = flat.delays.binary_search_by_key(&v, |d| d.variable) else {
                        return false;
                    };
                    let delay = &flat.delays[k];
                    let mut call = ModelPrinter { flat, implicit, tables, out: String::new() };
                    call.out.push_str("delay(");
                    call.name(v);
                    call.out.push_str(", ");
                    call.expression(delay.time);
                    out.push_str(&call.out);
                    out.push(')');
                    true
                }
                Node::Binary(op @ (Binary::Equal | Binary::NotEqual), a, b)
                    if is_equality(&flat.graph, op, a, b) =>
                {
                    let mut call = ModelPrinter { flat, implicit, tables, out: String::new() };
                    call.push(&[if op == Binary::Equal { "" } else { "not " }, EQUAL, "("]);
                    call.expression(a);
                    call.out.push_str(", ");
                    call.expression(b);
                    out.push_str(&call.out);
                    out.push(')');
                    true
                }
                Node::Unary(Unary::Carried(what), _) if what.order == 0 => {
                    out.push_str(&reader_value(usize::from(what.line), usize::from(what.reader)));
                    true
                }
                _ => element(tables, node, out, &mut |e, out: &mut String| {
                    let mut subscript = ModelPrinter { flat, implicit, tables, out: String::new() };
                    subscript.expression(e);
                    out.push_str(&subscript.out);
                }),
            },
            longest: usize::MAX,
        }
        .print_to(e, &mut self.out);
    }

    /// Prints the equation for the value at a reader of a transport line.
    fn reader(&mut self, line: &Transport, value: &str, reader: usize) {
        let entering = line.entering.map(|v| v.map(|v| quoted(&self.flat.variables[v].name)));
        let [low, high] = entering.map(Option::unwrap_or_default);
        if let Some(longest) = line.longest {
            let place = quoted(&self.flat.variables[line.readers[reader].place].name);
            self.push(&["  ", value, " = delay(", &high, ", time - ", &place, ", "]);
            self.expression(longest);
            self.out.push_str(");\n");
            return;
        }
        let moved = quoted(&self.flat.variables[line.ends[0]].name);
        let (before, after, forward) = match reader {
            0 => ("(", ", )", "false"),
            _ => ("(, ", ")", "true"),
        };
        self.push(&["  ", before, value, after, " = spatialDistribution(", &low, ", ", &high]);
        self.push(&[", -", &moved, ", ", forward]);
        for part in [0, 1] {
            self.out.push_str(", {");
            for (k, (place, value)) in line.initial.iter().enumerate() {
                self.out.push_str(if k > 0 { ", " } else { "" });
                self.expression(if part == 0 { *place } else { *value });
            }
            self.out.push('}');
        }
        self.out.push_str(");\n");
    }

    fn declaration(&mut self, v: &Variable) {
        self.out.push_str("  ");
        if v.structural && v.variability == Variability::Parameter {
            self.out.push_str("final ");
        }
        self.out.push_str(match v.variability {
            Variability::Constant => "constant ",
            Variability::Parameter => "parameter ",
            Variability::Discrete if v.ty == Type::Real => "discrete ",
            _ => "",
        });
        self.out.push_str(match v.causality {
            Some(Causality::Input) => "input ",
            Some(Causality::Output) => "output ",
            None => "",
        });
        match v.ty {
            Type::Enumeration(e) => {
                push_quoted(&self.flat.graph.enumerations[e].name, &mut self.out)
            }
            ty => self.out.push_str(&type_name(&self.flat.graph, ty)),
        }
        self.out.push(' ');
        push_quoted(&v.name, &mut self.out);
        self.attributes(v);
        if let Some(e) = v.binding {
            self.out.push_str(" = ");
            self.expression(e);
        }
        self.description(v.description.as_deref());
        self.out.push_str(";\n");
    }

    fn attributes(&mut self, v: &Variable) {
        // A parenthesis precedes the first attribute, a comma the others.
        let start = self.out.len();
        let next = |text: &mut Self, parts: &[&str]| {
            text.out.push_str(if text.out.len() == start { "(" } else { ", " });
            text.push(parts);
        };
        for (attribute, unit) in [("unit", v.unit), ("displayUnit", v.display_unit)] {
            if !unit.is_empty() {
                next(self, &[attribute, " = \"", &unit, "\""]);
            }
        }
        let numbers = [("min", v.min), ("max", v.max), ("start", v.start), ("nominal", v.nominal)];
        for (attribute, e) in numbers {
            if let Some(e) = e {
                next(self, &[attribute, " = "]);
                self.expression(e);
            }
        }
        if let Some(fixed) = v.fixed {
            next(self, &["fixed = ", if fixed { "true" } else { "false" }]);
        }
        if v.state_select != StateSelect::Default {
            let text = format!("{:?}", v.state_select).to_lowercase();
            next(self, &["stateSelect = StateSelect.", &text]);
        }
        if self.out.len() > start {
            self.out.push(')');
        }
    }
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
        .filter_map(|(n, v)| v.map(|v| format!("{n} = {}", real_literal(v))))
        .collect();
    (!list.is_empty()).then(|| list.join(", "))
}
