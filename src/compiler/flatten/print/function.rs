//! Prints the functions of a flat model: one for each output that is used.

use std::collections::hash_map::Entry;

use super::Table;
use super::identifier::{push_quoted, quoted};
use crate::base::index::{FastMap, FastSet, Id};
use crate::ir::expr::{ExprId, FunctionId, Node, Type, VarId};
use crate::ir::flat::{FlatModel, Function, LocalId, Statement};
use crate::symbolic::print::{Printer, type_name};

/// The name of the function for one output, as [`Printer`] writes it in calls.
fn function_name(function: FunctionId, output: u32) -> String {
    format!("function{}_{}", function.0, output + 1)
}

/// The definitions of all functions of the model.
pub(crate) fn functions(flat: &FlatModel, tables: &[Table]) -> String {
    let mut out = String::new();
    if flat.functions.is_empty() {
        return out;
    }
    let mut roots = Vec::new();
    flat.for_each_expression(&mut |e| roots.push(e));
    let mut written: FastMap<(FunctionId, u32), Vec<Type>> = FastMap::default();
    let mut entered: FastSet<FunctionId> = FastSet::default();
    while !roots.is_empty() {
        for e in flat.graph.postorder(std::mem::take(&mut roots)) {
            if let Node::Call { function, output, args } = flat.graph.node(e) {
                let types = flat.graph.list(args).iter().map(|a| flat.graph.ty(*a));
                match written.entry((function, output)) {
                    Entry::Vacant(new) => {
                        new.insert(types.collect());
                    }
                    // An argument may be Integer in one call and Real in another.
                    Entry::Occupied(mut known) => {
                        for (known, ty) in known.get_mut().iter_mut().zip(types) {
                            if ty == Type::Real {
                                *known = ty;
                            }
                        }
                    }
                }
                if entered.insert(function) {
                    roots.extend(flat.functions[function].values());
                }
            }
        }
    }
    let mut all: Vec<_> = written.into_iter().collect();
    all.sort_unstable_by_key(|((function, output), _)| (function.0, *output));
    for ((id, output), inputs) in all {
        let function = &flat.functions[id];
        let types = types(flat, function, &inputs);
        FunctionPrinter { flat, function, tables, types, out: &mut out }
            .write(&function_name(id, output), output);
    }
    out
}

/// The types of the locals: those of the arguments and of the assigned values.
fn types(flat: &FlatModel, function: &Function, inputs: &[Type]) -> Vec<Type> {
    let mut types = vec![Type::Real; function.locals.len()];
    for (local, ty) in function.inputs.iter().zip(inputs) {
        types[local.idx()] = *ty;
    }
    let mut lists = vec![&function.body];
    while let Some(list) = lists.pop() {
        for s in list {
            match s {
                Statement::Assign(local, e) => {
                    let (known, ty) = (&mut types[local.idx()], flat.graph.ty(*e));
                    let is_input = function.inputs.contains(local);
                    // An Integer input becomes Real if a Real is assigned to it.
                    if !is_input || ty == Type::Real && *known == Type::Integer {
                        *known = ty;
                    }
                }
                Statement::If(_, a, b) => lists.extend([a, b]),
                Statement::While(_, body) => lists.push(body),
                Statement::Break | Statement::Return | Statement::Assert(..) => {}
            }
        }
    }
    types
}

struct FunctionPrinter<'a> {
    flat: &'a FlatModel,
    function: &'a Function,
    tables: &'a [Table],
    types: Vec<Type>,
    out: &'a mut String,
}

impl FunctionPrinter<'_> {
    fn write(&mut self, function_name: &str, output: u32) {
        let function = self.function;
        self.line(1, &format!("function {function_name}"));
        // Inputs cannot be assigned, so locals are initialized with their values.
        for local in &function.inputs {
            let declared = self.declared(*local, "in_");
            self.line(2, &format!("input {declared};"));
        }
        let Some(&result) = function.outputs.get(output as usize) else { return };
        let declared = self.declared(result, "out_");
        self.line(2, &format!("output {declared};"));
        self.out.push_str("  protected\n");
        for local in function.locals.ids() {
            let mut declared = self.declared(local, "");
            if function.inputs.contains(&local) {
                declared.push_str(" = in_");
                declared.push_str(&function.locals[local]);
            }
            self.line(2, &format!("{declared};"));
        }
        self.out.push_str("  algorithm\n");
        self.statements(&function.body, 2);
        let name = &function.locals[result];
        self.line(2, &format!("out_{name} := {name};"));
        self.line(1, &format!("end {function_name};"));
    }

    fn line(&mut self, depth: usize, text: &str) {
        self.out.push_str(&"  ".repeat(depth));
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn declared(&self, local: LocalId, prefix: &str) -> String {
        let mut out = match self.types[local.idx()] {
            Type::Enumeration(e) => quoted(&self.flat.graph.enumerations[e].name),
            ty => type_name(&self.flat.graph, ty),
        };
        out.push(' ');
        out.push_str(prefix);
        out.push_str(&self.function.locals[local]);
        out
    }

    fn statements(&mut self, list: &[Statement], depth: usize) {
        for s in list {
            match s {
                Statement::Assign(local, e) => {
                    let text =
                        format!("{} := {};", self.function.locals[*local], self.expression(*e));
                    self.line(depth, &text);
                }
                Statement::If(c, a, b) => {
                    let text = format!("if {} then", self.expression(*c));
                    self.line(depth, &text);
                    self.statements(a, depth + 1);
                    if !b.is_empty() {
                        self.line(depth, "else");
                        self.statements(b, depth + 1);
                    }
                    self.line(depth, "end if;");
                }
                Statement::While(c, body) => {
                    let text = format!("while {} loop", self.expression(*c));
                    self.line(depth, &text);
                    self.statements(body, depth + 1);
                    self.line(depth, "end while;");
                }
                Statement::Break => self.line(depth, "break;"),
                Statement::Return => self.line(depth, "return;"),
                Statement::Assert(a, _) => {
                    let (condition, message) =
                        (self.expression(a.condition), self.expression(a.message));
                    self.line(depth, &format!("assert({condition}, {message});"));
                }
            }
        }
    }

    fn expression(&self, e: ExprId) -> String {
        Printer {
            graph: &self.flat.graph,
            variable: &|v: VarId, out: &mut String| {
                push_quoted(&self.function.locals[LocalId::from_usize(v.idx())], out)
            },
            enumeration: &quoted,
            relation: &|_| None,
            special: &|node, out| {
                super::element(self.tables, node, out, &mut |e, out: &mut String| {
                    out.push_str(&self.expression(e));
                })
            },
            longest: usize::MAX,
        }
        .print(e)
    }
}
