//! The flat model as text that is itself valid Modelica: dotted names are written as quoted
//! identifiers (section 2.3.1 of the specification), so that any Modelica tool reads it.

pub mod common_subexpressions;
pub(crate) mod function;
pub(crate) mod function_locals;

use crate::base::index::FastSet;
use crate::ir::ast::{Causality, Variability};
use crate::ir::expr::{Binary, EnumId, ExprId, Graph, Node, Type, Unary, VarId};
use crate::ir::flat::{
    Action, Assert, Equation, EquationKind, FlatModel, Level, StateSelect, Transport, Variable,
    WhenBranch,
};
use crate::ir::native::Native;
use crate::symbolic::print::{Printer, real_literal, type_name};
use common_subexpressions::TooLong;

/// Variables and equations of a model whose text is long.
const LONG: usize = 50_000;

/// Prints the model. What a long text would write again and again has a variable of its own there; some is
/// too long even so.
pub fn print(flat: &FlatModel) -> Result<String, TooLong> {
    pieces(flat).map(|pieces| pieces.concat())
}

/// As [`print`], in pieces that follow each other: a long text is written by two threads.
pub fn pieces(flat: &FlatModel) -> Result<Vec<String>, TooLong> {
    let shared = common_subexpressions::shared(flat)?;
    let flat = shared.as_ref().unwrap_or(flat);
    let (unsaid, tables) = (unsaid(flat), tables(flat));
    let write = |act: &dyn Fn(&mut Text<'_>)| {
        let mut text = Text { flat, unsaid: &unsaid, tables: &tables, out: String::new() };
        act(&mut text);
        text.out
    };
    if flat.variables.len() + flat.equations.len() < LONG {
        return Ok(vec![write(&|text| {
            text.declarations();
            text.equations(&flat.equations);
            text.end();
        })]);
    }
    // A declaration is about as long as an equation.
    let (near, far) = flat.equations.split_at(flat.equations.len() / 4);
    std::thread::scope(|scope| {
        let rest = scope.spawn(|| {
            write(&|text| {
                text.list(far);
                text.end();
            })
        });
        let first = write(&|text| {
            text.declarations();
            text.equations(near);
        });
        match rest.join() {
            Ok(rest) => Ok(vec![first, rest]),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// The variables that calls of `delay` and `spatialDistribution` say without words.
fn unsaid(flat: &FlatModel) -> FastSet<VarId> {
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

/// The tables whose elements are chosen while the model runs.
fn tables(flat: &FlatModel) -> Vec<Native> {
    let mut found = Vec::new();
    for e in flat.graph.ids() {
        if let Node::Unary(Unary::Native(f), _) = flat.graph.node(e)
            && f.elements().is_some()
            && !found.contains(&f)
        {
            found.push(f);
        }
    }
    found
}

/// The function that compares real numbers: an equality of them stands in functions only (section 3.5).
const EQUAL: &str = "'$equal'";

fn is_equality(graph: &Graph, op: Binary, a: ExprId, b: ExprId) -> bool {
    let numbers = [a, b].map(|e| graph.ty(e));
    matches!(op, Binary::Equal | Binary::NotEqual)
        && numbers.contains(&Type::Real)
        && numbers.iter().all(|ty| matches!(ty, Type::Real | Type::Integer))
}

/// Whether real numbers are compared that are not in functions.
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
    flat.graph.postorder(roots).into_iter().any(found)
}

/// The constant of the text that is a table.
fn table(k: usize) -> String {
    format!("'$table{}'", k + 1)
}

/// The variable of the text that has what a reader of a line reads.
fn reading(line: usize, reader: usize) -> String {
    format!("'$line{}.reader{}.value'", line + 1, reader + 1)
}

/// An identifier, quoted if it is none by itself.
pub fn quoted(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 2);
    push_quoted(name, &mut out);
    out
}

pub(super) fn push_quoted(name: &str, out: &mut String) {
    let plain = name.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_')
        && name.bytes().next().is_some_and(|c| !c.is_ascii_digit());
    let already = name.starts_with('\'')
        && name.ends_with('\'')
        && name.len() > 1
        && !name[1..name.len() - 1].contains('\'');
    if plain || already {
        out.push_str(name);
        return;
    }
    out.push('\'');
    if !name.contains('\'') {
        out.push_str(name);
        out.push('\'');
        return;
    }
    for (k, part) in name.split('\'').enumerate() {
        if k > 0 {
            out.push_str("\\'");
        }
        out.push_str(part);
    }
    out.push('\'');
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

/// The text so far.
struct Text<'a> {
    flat: &'a FlatModel,
    unsaid: &'a FastSet<VarId>,
    tables: &'a [Native],
    out: String,
}

/// Writes an element of a table, by a printer of its subscript.
pub(super) fn element(
    tables: &[Native],
    node: Node,
    out: &mut String,
    subscript: &mut dyn FnMut(ExprId, &mut String),
) -> bool {
    let Node::Unary(Unary::Native(f), a) = node else { return false };
    let Some(k) = tables.iter().position(|t| *t == f) else { return false };
    out.push_str(&table(k));
    out.push('[');
    subscript(a, out);
    out.push(']');
    true
}

impl Text<'_> {
    /// Everything before the equations.
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
        for (k, f) in self.tables.iter().enumerate() {
            let Some((all, whole)) = f.elements() else { continue };
            let literal = |x: &f64| if whole { format!("{x}") } else { real_literal(*x) };
            let ty = if whole { "Integer" } else { "Real" };
            let list: Vec<String> = all.iter().map(literal).collect();
            let (size, list) = (all.len().to_string(), list.join(", "));
            self.push(&["  constant ", ty, " ", &table(k), "[", &size, "] = {", &list, "};\n"]);
        }
        if has_equalities(flat) {
            self.push(&["  function ", EQUAL, "\n    input Real a;\n    input Real b;\n"]);
            self.push(&["    output Boolean c = a == b;\n  end ", EQUAL, ";\n"]);
        }
        self.out.push_str(&function::functions(flat, self.tables));
        for (id, v) in flat.variables.enumerate() {
            if !self.unsaid.contains(&id) {
                self.declaration(v);
            }
        }
        for (k, line) in flat.transports.iter().enumerate() {
            for reader in 0..line.readers.len() {
                self.push(&["  Real ", &reading(k, reader), ";\n"]);
            }
        }
        if !flat.initial_equations.is_empty() {
            self.out.push_str("initial equation\n");
            self.list(&flat.initial_equations);
        }
    }

    /// The first equations.
    fn equations(&mut self, list: &[Equation]) {
        if !self.flat.equations.is_empty() {
            self.out.push_str("equation\n");
            self.list(list);
        }
    }

    /// Everything after the equations.
    fn end(&mut self) {
        let flat = self.flat;
        for (k, line) in flat.transports.iter().enumerate() {
            for reader in 0..line.readers.len() {
                self.reader(line, &reading(k, reader), reader);
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
        let (flat, unsaid, tables) = (self.flat, self.unsaid, self.tables);
        Printer {
            graph: &flat.graph,
            variable: &|v: VarId, out: &mut String| push_quoted(&flat.variables[v].name, out),
            enumeration: &quoted,
            relation: &|_| None,
            special: &|node: Node, out: &mut String| match node {
                Node::Recorded(v, 0) => {
                    // They stand in the order of their variables.
                    let Ok(k) = flat.delays.binary_search_by_key(&v, |d| d.variable) else {
                        return false;
                    };
                    let delay = &flat.delays[k];
                    let mut call = Text { flat, unsaid, tables, out: String::new() };
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
                    let mut call = Text { flat, unsaid, tables, out: String::new() };
                    call.push(&[if op == Binary::Equal { "" } else { "not " }, EQUAL, "("]);
                    call.expression(a);
                    call.out.push_str(", ");
                    call.expression(b);
                    out.push_str(&call.out);
                    out.push(')');
                    true
                }
                Node::Unary(Unary::Carried(what), _) if what.order == 0 => {
                    out.push_str(&reading(usize::from(what.line), usize::from(what.reader)));
                    true
                }
                _ => element(tables, node, out, &mut |e, out: &mut String| {
                    let mut subscript = Text { flat, unsaid, tables, out: String::new() };
                    subscript.expression(e);
                    out.push_str(&subscript.out);
                }),
            },
            longest: usize::MAX,
        }
        .print_to(e, &mut self.out);
    }

    /// The equation that gives what a reader of a line reads.
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
        // Before the first stands a parenthesis, before the others a comma.
        let begun = self.out.len();
        let next = |text: &mut Self, parts: &[&str]| {
            text.out.push_str(if text.out.len() == begun { "(" } else { ", " });
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
        if self.out.len() > begun {
            self.out.push(')');
        }
    }

    fn list(&mut self, list: &[Equation]) {
        for e in list {
            match &e.kind {
                EquationKind::Equal(a, _) if matches!(self.flat.graph.node(*a), Node::Var(v) if self.unsaid.contains(&v)) =>
                    {}
                EquationKind::Equal(a, b) => self.equality(*a, *b),
                EquationKind::When(branches) => self.when(branches),
                EquationKind::Assert(a) => {
                    self.out.push_str("  ");
                    self.assertion(a);
                    self.out.push_str(";\n");
                }
                EquationKind::Algorithm { outputs, values } => {
                    for (v, e) in outputs.iter().zip(values) {
                        self.out.push_str("  ");
                        self.assignment(*v, *e);
                        self.out.push_str(";\n");
                    }
                }
            }
        }
    }

    /// An `if` on the left side must stand in parentheses.
    fn equality(&mut self, a: ExprId, b: ExprId) {
        self.out.push_str("  ");
        let chosen = matches!(self.flat.graph.node(a), Node::If(..));
        self.out.push_str(if chosen { "(" } else { "" });
        self.expression(a);
        self.out.push_str(if chosen { ") = " } else { " = " });
        self.expression(b);
        self.out.push_str(";\n");
    }

    fn assignment(&mut self, v: VarId, e: ExprId) {
        self.name(v);
        self.out.push_str(" = ");
        self.expression(e);
    }

    fn when(&mut self, branches: &[WhenBranch]) {
        for (k, branch) in branches.iter().enumerate() {
            self.out.push_str(if k == 0 { "  when " } else { "  elsewhen " });
            let several = branch.conditions.len() != 1;
            self.out.push_str(if several { "{" } else { "" });
            for (k, c) in branch.conditions.iter().enumerate() {
                self.out.push_str(if k > 0 { ", " } else { "" });
                self.expression(*c);
            }
            self.out.push_str(if several { "} then\n" } else { " then\n" });
            for a in &branch.actions {
                self.out.push_str("    ");
                self.action(a);
                self.out.push_str(";\n");
            }
        }
        self.out.push_str("  end when;\n");
    }

    fn action(&mut self, action: &Action) {
        match action {
            Action::Assign(v, e) => self.assignment(*v, *e),
            Action::Reinit { state, value, guard } => {
                if let Some(guard) = guard {
                    self.out.push_str("if ");
                    self.expression(*guard);
                    self.out.push_str(" then ");
                }
                self.out.push_str("reinit(");
                self.name(*state);
                self.out.push_str(", ");
                self.expression(*value);
                self.out.push_str(if guard.is_some() { "); end if" } else { ")" });
            }
            Action::Assert(a) => self.assertion(a),
            Action::Terminate(message) => {
                self.out.push_str("terminate(");
                self.expression(*message);
                self.out.push(')');
            }
        }
    }

    fn assertion(&mut self, a: &Assert) {
        self.out.push_str("assert(");
        self.expression(a.condition);
        self.out.push_str(", ");
        self.expression(a.message);
        let level = if a.level == Level::Error { ")" } else { ", AssertionLevel.warning)" };
        self.out.push_str(level);
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
