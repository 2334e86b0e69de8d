//! What the text of a class may not say, wherever the class is used: `break` outside of loops, `when`
//! inside of statements, inputs that are assigned, one thing modified twice (sections 7.2.3, 11.2, 12.2
//! and 13.2.1 of the specification).

use std::sync::Arc;

use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::instantiate::Context;
use crate::ir::ast::{
    ArgumentKind, Causality, Class, ClassBody, ClassKind, ComponentRef, Composition, ElementKind,
    ImportForm, Modification, Statement, StatementKind,
};
use crate::ir::instance::{ClassId, EntryKind, Scope};

/// What stands around a statement.
#[derive(Clone, Copy)]
struct Around<'a> {
    function: bool,
    initial: bool,
    in_loop: bool,
    /// The statement that it stands in.
    inside: Option<&'static str>,
    /// Inputs of the function.
    inputs: &'a FastMap<Name, Span>,
}

impl Context<'_> {
    /// Checks the body of a class whose elements are known, once for each text.
    pub(crate) fn check_body(&mut self, class: ClassId, text: &Arc<Class>) {
        match &text.body {
            ClassBody::Short(short) => {
                self.check_duplicates(short.modification.as_ref());
            }
            ClassBody::Long(composition) => {
                self.check_elements(composition);
                let function = matches!(text.kind, ClassKind::Function { .. });
                if composition.algorithms.is_empty() {
                    return;
                }
                let inputs = if function { self.inputs_of(class) } else { FastMap::default() };
                for section in &composition.algorithms {
                    let around = Around {
                        function,
                        initial: section.initial,
                        in_loop: false,
                        inside: None,
                        inputs: &inputs,
                    };
                    self.check_statements(&section.statements, around);
                }
            }
            _ => {}
        }
    }

    fn inputs_of(&mut self, class: ClassId) -> FastMap<Name, Span> {
        let table = self.table(class);
        let mut inputs = FastMap::default();
        for entry in &table.entries {
            let EntryKind::Component(declaration) = &entry.kind else { continue };
            if self.causality(entry, declaration) == Some(Causality::Input) {
                inputs.insert(entry.name.name, entry.name.span);
            }
        }
        inputs
    }

    fn check_elements(&mut self, composition: &Composition) {
        let mut imported: FastMap<Name, Span> = FastMap::default();
        for element in &composition.elements {
            match &element.kind {
                ElementKind::Components(clause) => {
                    for component in &clause.components {
                        self.check_duplicates(component.modification.as_ref());
                    }
                }
                ElementKind::Extends(extends) => {
                    self.check_duplicates(extends.modification.as_ref());
                }
                ElementKind::Import(import) => {
                    let names = match &import.form {
                        ImportForm::Qualified => {
                            import.path.parts.last().copied().into_iter().collect()
                        }
                        ImportForm::Renamed(alias) => vec![*alias],
                        ImportForm::List(names) => names.clone(),
                        ImportForm::All => Vec::new(),
                    };
                    for name in names {
                        if let Some(before) = imported.insert(name.name, name.span) {
                            let message = format!("`{}` is imported twice", name.name);
                            self.problems.push(
                                Diagnostic::error("MO0263", name.span, message)
                                    .label("second import of this name")
                                    .also(before, "first import")
                                    .help("remove one of them, or rename it: `import NAME = ...`")
                                    .note("section 13.2.1 of the specification"),
                            );
                        }
                    }
                }
                ElementKind::Class(_) => {}
            }
        }
    }

    /// One modification may not say two things of the same element.
    fn check_duplicates(&mut self, modification: Option<&Arc<Modification>>) {
        let Some(modification) = modification else { return };
        let mut said = Vec::new();
        values(modification, "", &mut said);
        let mut first: FastMap<(String, bool), Span> = FastMap::default();
        for (names, redeclared, span) in said {
            let what = if redeclared { "redeclared" } else { "modified" };
            let message = format!("`{names}` is {what} twice");
            let before = *first.entry((names, redeclared)).or_insert(span);
            if before != span {
                self.problems.push(
                    Diagnostic::error("MO0264", span, message)
                        .label("second value")
                        .also(before, "first value")
                        .help("remove one of them")
                        .note("section 7.2.3 of the specification"),
                );
            }
        }
    }

    fn check_statements(&mut self, list: &[Statement], around: Around<'_>) {
        for s in list {
            match &s.kind {
                StatementKind::Assign(target, _) => self.check_target(target, around),
                StatementKind::AssignTuple(targets, _) => {
                    for target in targets.iter().flatten() {
                        self.check_target(target, around);
                    }
                }
                StatementKind::If { branches, otherwise } => {
                    let inner = Around { inside: Some("if"), ..around };
                    for (_, body) in branches {
                        self.check_statements(body, inner);
                    }
                    self.check_statements(otherwise, inner);
                }
                StatementKind::For { body, .. } => {
                    let inner = Around { inside: Some("for"), in_loop: true, ..around };
                    self.check_statements(body, inner);
                }
                StatementKind::While { body, .. } => {
                    let inner = Around { inside: Some("while"), in_loop: true, ..around };
                    self.check_statements(body, inner);
                }
                StatementKind::When { branches } => {
                    self.check_when(s.span, around);
                    let inner = Around { inside: Some("when"), in_loop: false, ..around };
                    for (_, body) in branches {
                        self.check_statements(body, inner);
                    }
                }
                StatementKind::Break if !around.in_loop => {
                    self.problems.push(
                        Diagnostic::error("MO0265", s.span, "`break` stands outside of a loop")
                            .help(
                                "write it inside of `for` or `while`, or turn the condition round",
                            )
                            .note("section 11.2.5 of the specification"),
                    );
                }
                StatementKind::Return if !around.function => {
                    self.problems.push(
                        Diagnostic::error(
                            "MO0265",
                            s.span,
                            "`return` stands outside of a function",
                        )
                        .help("put what follows into the `else` branch of an `if`")
                        .note("section 12.1.2 of the specification"),
                    );
                }
                StatementKind::Break
                | StatementKind::Return
                | StatementKind::Call(_)
                | StatementKind::Broken => {}
            }
        }
    }

    fn check_when(&mut self, span: Span, around: Around<'_>) {
        let wrong = match around {
            Around { function: true, .. } => "a function",
            Around { initial: true, .. } => "an initial section",
            Around { inside: Some("when"), .. } => "another `when`",
            Around { inside: Some("if"), .. } => "`if`",
            Around { inside: Some("for"), .. } => "`for`",
            Around { inside: Some(_), .. } => "`while`",
            Around { inside: None, .. } => return,
        };
        let help = match wrong {
            "another `when`" => "write `elsewhen`, or join the conditions with `and`",
            "a function" => "compute it in the model, in a when-clause",
            _ => "put the `when` outside, and this statement into it",
        };
        self.problems.push(
            Diagnostic::error("MO0231", span, format!("`when` stands inside of {wrong}"))
                .help(help)
                .note("section 11.2.7 of the specification"),
        );
    }

    fn check_target(&mut self, target: &ComponentRef, around: Around<'_>) {
        let first = target.parts[0].name;
        let Some(declared) = around.inputs.get(&first.name) else { return };
        let message = format!("input `{}` of a function is assigned", first.name);
        self.problems.push(
            Diagnostic::error("MO0266", first.span, message)
                .also(*declared, "declared `input`")
                .help("copy it to a protected variable, and change that")
                .note("inputs of functions keep their values (section 12.2)"),
        );
    }

    /// What a function may hold, asked for where it is called.
    pub(crate) fn check_function(&mut self, class: ClassId) {
        if !self.checked_functions.insert(class) {
            return;
        }
        let table = self.table(class);
        for entry in &table.entries {
            let EntryKind::Component(declaration) = &entry.kind else { continue };
            let clause = declaration.clause();
            let free = entry.protected || clause.prefix.variability.is_some();
            if !free && self.causality(entry, declaration).is_none() {
                let name = self.classes[class].full_name;
                let name = crate::base::name::name(name.rsplit('.').next().unwrap_or_default());
                self.restrict_formal(name, entry.name);
            }
            if clause.type_name.parts.len() == 1
                && self.predefined.contains_key(&clause.type_name.parts[0].name)
            {
                continue;
            }
            let scope = Scope { instance: self.classes[entry.class].holder, class: entry.class };
            let Some(of) = self.find_class(&clause.type_name, scope) else { continue };
            let kind = self.kind(of);
            if matches!(kind, ClassKind::Model | ClassKind::Block) {
                let what = super::specialized_class::word(kind);
                let message = format!("`{}` of a function is a {what}", entry.name.name);
                self.problems.push(
                    Diagnostic::error("MO0226", entry.name.span, message)
                        .help("use a record, or pass the values that are needed")
                        .note("components of functions are of types, records or functions (section 12.2)"),
                );
            }
        }
    }

    /// Texts whose bodies have been checked already.
    pub(crate) fn is_checked(&mut self, text: &Arc<Class>) -> bool {
        !self.checked.insert(Arc::as_ptr(text) as usize)
    }
}

/// What a modification gives a value to, or redeclares, by its whole name; and where.
fn values(modification: &Modification, around: &str, out: &mut Vec<(String, bool, Span)>) {
    for arg in &modification.args {
        match &arg.kind {
            ArgumentKind::Element { path, modification: Some(inner), .. } => {
                let names = format!("{around}{path}");
                values(inner, &format!("{names}."), out);
                if inner.binding.is_some() {
                    out.push((names, false, arg.span));
                }
            }
            ArgumentKind::Redeclare(element) => {
                for (name, span) in element.names() {
                    out.push((format!("{around}{name}"), true, span));
                }
            }
            ArgumentKind::Element { .. } | ArgumentKind::Removal(_) => {}
        }
    }
}
