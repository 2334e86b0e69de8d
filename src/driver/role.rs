//! The role of a word, by the syntax around it: a declaration, a reference, an element that is modified, an argument.
//!
//! *In:* the syntax tree of a file and the first byte of the word. *Out:* its role with the names that it depends on, none
//! of which is resolved here.

use super::target::enclosing;

use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{
    Argument, ArgumentKind, Class, ClassBody, Component, ComponentRef, Composition, Element,
    ElementKind, Equation, EquationKind, Expr, ExprKind, File, Ident, ImportForm, Iterator,
    Modification, Path, Removal, Statement, StatementKind, Subscript,
};

/// The role of a word.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Role {
    /// The innermost class around the place, where it is declared.
    Class,
    /// A component of that class, where it is declared.
    Component(Name),
    /// A literal of that enumeration, where it is declared.
    Literal(Name),
    /// A reference, up to the word.
    Reference {
        /// Its parts; the last is the word.
        parts: Vec<Name>,
        /// It begins with a dot, or is that of an import clause.
        global: bool,
        /// A tool may have given the name a meaning of its own: it is in an annotation.
        loose: bool,
    },
    /// An element, up to the word, of a class.
    Element {
        /// The class.
        of: Of,
        /// The parts of the name; the last is the word.
        parts: Vec<Name>,
    },
    /// Another name for something, in this class alone: an index, or the name that an import clause introduces.
    Local,
    /// A name that nothing in a model declares, such as one in an annotation.
    Foreign,
}

/// A class: that of a reference or, if it names nothing, the innermost around the place; then that of an element of it.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Of {
    /// The reference.
    pub parts: Vec<Name>,
    /// It begins with a dot.
    pub global: bool,
    /// The element.
    pub element: Vec<Name>,
}

impl Of {
    fn path(path: &Path) -> Of {
        Of { parts: names(&path.parts), global: path.global, element: Vec::new() }
    }

    fn innermost() -> Of {
        Of { parts: Vec::new(), global: false, element: Vec::new() }
    }

    fn element(&self, path: &Path) -> Of {
        let mut of = self.clone();
        of.element.extend(names(&path.parts));
        of
    }
}

fn names(parts: &[Ident]) -> Vec<Name> {
    parts.iter().map(|part| part.name).collect()
}

/// The role of the word that begins at a byte; none where the text is broken, or if there is no word.
pub(super) fn role(file: &File, at: u32) -> Option<Role> {
    let search = Search { at, locals: Vec::new(), annotated: false };
    let within = file.within.as_ref().and_then(|within| search.path(within)).map(as_global);
    within.or_else(|| search.class(enclosing(file, at)?.0.last()?))
}

fn as_global(role: Role) -> Role {
    match role {
        Role::Reference { parts, loose, .. } => Role::Reference { parts, global: true, loose },
        role => role,
    }
}

struct Search {
    at: u32,
    /// Indices whose loops are around the place.
    locals: Vec<Name>,
    annotated: bool,
}

impl Search {
    fn is(&self, ident: &Ident) -> bool {
        ident.span.start == self.at && ident.span.end > self.at
    }

    fn within(&self, span: Span) -> bool {
        span.start <= self.at && self.at < span.end
    }

    fn class(&self, class: &Class) -> Option<Role> {
        if self.is(&class.name) {
            return Some(Role::Class);
        }
        self.body(class).or_else(|| self.annotation(class.annotation.as_deref()))
    }

    fn body(&self, class: &Class) -> Option<Role> {
        match &class.body {
            ClassBody::Short(short) => self.path(&short.base).or_else(|| {
                let dims = self.subscripts(&short.dims);
                dims.or_else(|| {
                    self.modification(short.modification.as_deref(), &Of::path(&short.base))
                })
            }),
            ClassBody::Enumeration(literals) => literals.iter().flatten().find_map(|literal| {
                let own = self.is(&literal.name).then_some(Role::Literal(literal.name.name));
                own.or_else(|| self.annotation(literal.annotation.as_deref()))
            }),
            ClassBody::PartialDerivative { function, variables } => {
                self.path(function).or_else(|| {
                    let found = variables.iter().find(|v| self.is(v))?;
                    Some(Role::Element { of: Of::path(function), parts: vec![found.name] })
                })
            }
            ClassBody::Long(composition) => self.composition(composition),
        }
    }

    fn composition(&self, own: &Composition) -> Option<Role> {
        let extended = own.class_extends.as_ref().and_then(Option::as_deref);
        self.modification(extended, &Of::innermost())
            .or_else(|| {
                let mut elements = own.elements.iter().filter(|e| self.within(e.span));
                elements.find_map(|e| self.element(e))
            })
            .or_else(|| own.equations.iter().find_map(|s| self.equations(&s.equations)))
            .or_else(|| own.algorithms.iter().find_map(|s| self.statements(&s.statements)))
            .or_else(|| {
                let external = own.external.as_ref()?;
                let output = external.output.as_ref().and_then(|output| self.reference(output));
                output
                    .or_else(|| external.args.iter().find_map(|e| self.expr(e)))
                    .or_else(|| {
                        let is_name = external.function.as_ref().is_some_and(|f| self.is(f));
                        is_name.then_some(Role::Foreign)
                    })
                    .or_else(|| self.annotation(external.annotation.as_deref()))
            })
    }

    fn element(&self, element: &Element) -> Option<Role> {
        let own = match &element.kind {
            ElementKind::Import(import) => {
                self.path(&import.path).map(as_global).or_else(|| match &import.form {
                    ImportForm::Renamed(alias) => self.is(alias).then_some(Role::Local),
                    ImportForm::List(all) => {
                        let found = all.iter().find(|ident| self.is(ident))?;
                        let parts = [names(&import.path.parts), vec![found.name]].concat();
                        Some(Role::Reference { parts, global: true, loose: false })
                    }
                    ImportForm::Qualified | ImportForm::All => None,
                })
            }
            ElementKind::Extends(extends) => self.path(&extends.base).or_else(|| {
                self.modification(extends.modification.as_deref(), &Of::path(&extends.base))
                    .or_else(|| self.annotation(extends.annotation.as_deref()))
            }),
            ElementKind::Components(clause) => {
                let typed = self.path(&clause.type_name);
                typed.or_else(|| self.subscripts(&clause.type_dims)).or_else(|| {
                    let mut all = clause.components.iter();
                    all.find_map(|component| {
                        if self.is(&component.name) {
                            return Some(Role::Component(component.name.name));
                        }
                        self.component(component, &clause.type_name)
                    })
                })
            }
            // The innermost class around the place is searched.
            ElementKind::Class(_) => None,
        };
        own.or_else(|| self.constraint(element))
    }

    fn constraint(&self, element: &Element) -> Option<Role> {
        let replaceable = element.replaceable.as_ref()?;
        let constraint = replaceable.constraint.as_ref()?;
        self.path(constraint).or_else(|| {
            self.modification(replaceable.modification.as_deref(), &Of::path(constraint))
        })
    }

    /// A component without its name.
    fn component(&self, component: &Component, type_name: &Path) -> Option<Role> {
        self.subscripts(&component.dims)
            .or_else(|| self.modification(component.modification.as_deref(), &Of::path(type_name)))
            .or_else(|| component.condition.as_deref().and_then(|e| self.expr(e)))
            .or_else(|| self.annotation(component.annotation.as_deref()))
    }

    fn modification(&self, modification: Option<&Modification>, of: &Of) -> Option<Role> {
        let modification = modification?;
        let argument = modification.args.iter().find_map(|argument| self.argument(argument, of));
        argument.or_else(|| modification.binding.as_deref().and_then(|e| self.expr(e)))
    }

    fn argument(&self, argument: &Argument, of: &Of) -> Option<Role> {
        match &argument.kind {
            ArgumentKind::Element { path, modification, .. } => {
                let own = path.parts.iter().position(|part| self.is(part));
                own.map(|k| Role::Element { of: of.clone(), parts: names(&path.parts[..=k]) })
                    .or_else(|| self.modification(modification.as_deref(), &of.element(path)))
            }
            ArgumentKind::Redeclare(element) => self.redeclared(element, of),
            ArgumentKind::Removal(Removal::Element(ident)) => {
                self.is(ident).then(|| Role::Element { of: of.clone(), parts: vec![ident.name] })
            }
            ArgumentKind::Removal(Removal::Connection(a, b)) => {
                [a, b].into_iter().find_map(|side| {
                    let k = side.parts.iter().position(|part| self.is(&part.name))?;
                    let parts = side.parts[..=k].iter().map(|part| part.name.name).collect();
                    Some(Role::Element { of: of.clone(), parts })
                })
            }
        }
    }

    /// `redeclare T a(...)`, `redeclare model M = N(...)`.
    fn redeclared(&self, element: &Element, of: &Of) -> Option<Role> {
        let named = |ident: &Ident| {
            let role = || Role::Element { of: of.clone(), parts: vec![ident.name] };
            self.is(ident).then(role)
        };
        let own = match &element.kind {
            ElementKind::Class(class) => named(&class.name).or_else(|| match &class.body {
                // The elements of a whole class are not those of the class around the place.
                ClassBody::Long(_) => None,
                _ => self.body(class),
            }),
            ElementKind::Components(clause) => self.path(&clause.type_name).or_else(|| {
                let dims = self.subscripts(&clause.type_dims);
                dims.or_else(|| {
                    let mut all = clause.components.iter();
                    all.find_map(|c| {
                        named(&c.name).or_else(|| self.component(c, &clause.type_name))
                    })
                })
            }),
            ElementKind::Import(_) | ElementKind::Extends(_) => None,
        };
        own.or_else(|| self.constraint(element))
    }

    fn annotation(&self, annotation: Option<&Modification>) -> Option<Role> {
        let inside = Search { at: self.at, locals: self.locals.clone(), annotated: true };
        inside.annotated(annotation?)
    }

    fn annotated(&self, annotation: &Modification) -> Option<Role> {
        let argument = annotation.args.iter().find_map(|argument| match &argument.kind {
            ArgumentKind::Element { path, modification, .. } => {
                if path.parts.iter().any(|part| self.is(part)) {
                    return Some(Role::Foreign);
                }
                let modification = modification.as_deref()?;
                // `inverse(u = f(y))`: `u` is an input of the function.
                let is_inverse = path.parts.last().is_some_and(|part| &*part.name == "inverse");
                match is_inverse {
                    true => self.modification(Some(modification), &Of::innermost()),
                    false => self.annotated(modification),
                }
            }
            ArgumentKind::Redeclare(element) => self.redeclared(element, &Of::innermost()),
            ArgumentKind::Removal(_) => None,
        });
        argument.or_else(|| annotation.binding.as_deref().and_then(|e| self.expr(e)))
    }

    fn path(&self, path: &Path) -> Option<Role> {
        let k = path.parts.iter().position(|part| self.is(part))?;
        let parts = names(&path.parts[..=k]);
        Some(Role::Reference { parts, global: path.global, loose: self.annotated })
    }

    fn reference(&self, reference: &ComponentRef) -> Option<Role> {
        for (k, part) in reference.parts.iter().enumerate() {
            if self.is(&part.name) {
                let parts: Vec<Name> =
                    reference.parts[..=k].iter().map(|part| part.name.name).collect();
                if !reference.global && self.locals.contains(&parts[0]) {
                    return Some(if k == 0 { Role::Local } else { Role::Foreign });
                }
                let (global, loose) = (reference.global, self.annotated);
                return Some(Role::Reference { parts, global, loose });
            }
            if let Some(found) = self.subscripts(&part.subscripts) {
                return Some(found);
            }
        }
        None
    }

    fn subscripts(&self, subscripts: &[Subscript]) -> Option<Role> {
        subscripts.iter().find_map(|subscript| match subscript {
            Subscript::Expr(e) => self.expr(e),
            Subscript::Colon(_) => None,
        })
    }

    /// The search in the body of a loop; or the role of a word in its head.
    fn iterated(&self, iterators: &[Iterator]) -> Result<Search, Role> {
        let mut inner =
            Search { at: self.at, locals: self.locals.clone(), annotated: self.annotated };
        for iterator in iterators {
            if inner.is(&iterator.name) {
                return Err(Role::Local);
            }
            if let Some(found) = iterator.range.as_ref().and_then(|e| inner.expr(e)) {
                return Err(found);
            }
            inner.locals.push(iterator.name.name);
        }
        Ok(inner)
    }

    fn expr(&self, e: &Expr) -> Option<Role> {
        match &e.kind {
            ExprKind::Ref(reference) => self.reference(reference),
            ExprKind::Unary(_, a) | ExprKind::Parenthesised(a) => self.expr(a),
            ExprKind::Binary(_, a, b) => self.expr(a).or_else(|| self.expr(b)),
            ExprKind::If { branches, otherwise } => {
                let mut all = branches.iter().flat_map(|(condition, value)| [condition, value]);
                all.find_map(|e| self.expr(e)).or_else(|| self.expr(otherwise))
            }
            ExprKind::Call { function, args, named } => {
                let parts: Vec<Name> = function.parts.iter().map(|part| part.name.name).collect();
                let of = Of { parts, global: function.global, element: Vec::new() };
                let own = self.reference(function);
                own.or_else(|| args.iter().find_map(|e| self.expr(e)))
                    .or_else(|| self.named(named, &of))
            }
            ExprKind::PartialFunction { function, named } => {
                self.path(function).or_else(|| self.named(named, &Of::path(function)))
            }
            ExprKind::Reduction { function, body, iterators } => {
                self.reference(function).or_else(|| self.comprehension(body, iterators))
            }
            ExprKind::Comprehension { body, iterators } => self.comprehension(body, iterators),
            ExprKind::Array(all) => all.iter().find_map(|e| self.expr(e)),
            ExprKind::Matrix(rows) => rows.iter().flatten().find_map(|e| self.expr(e)),
            ExprKind::Range { start, step, stop } => {
                let step = || step.as_deref().and_then(|e| self.expr(e));
                self.expr(start).or_else(step).or_else(|| self.expr(stop))
            }
            ExprKind::Tuple(all) => all.iter().flatten().find_map(|e| self.expr(e)),
            ExprKind::Indexed(inner, subscripts) => {
                self.expr(inner).or_else(|| self.subscripts(subscripts))
            }
            ExprKind::Real(_)
            | ExprKind::Integer(_)
            | ExprKind::String(_)
            | ExprKind::Boolean(_)
            | ExprKind::End
            | ExprKind::Break
            | ExprKind::Broken => None,
        }
    }

    fn comprehension(&self, body: &Expr, iterators: &[Iterator]) -> Option<Role> {
        match self.iterated(iterators) {
            Ok(inner) => inner.expr(body),
            Err(found) => Some(found),
        }
    }

    /// Named arguments.
    fn named(&self, named: &[(Ident, Expr)], function: &Of) -> Option<Role> {
        named.iter().find_map(|(ident, value)| match self.is(ident) {
            true if self.annotated => Some(Role::Foreign),
            true => Some(Role::Element { of: function.clone(), parts: vec![ident.name] }),
            false => self.expr(value),
        })
    }

    fn equations(&self, equations: &[Equation]) -> Option<Role> {
        let mut near = equations.iter().filter(|equation| self.within(equation.span));
        near.find_map(|equation| match &equation.kind {
            EquationKind::Equal(a, b) => self.expr(a).or_else(|| self.expr(b)),
            EquationKind::If { branches, otherwise } => {
                self.equation_branches(branches).or_else(|| self.equations(otherwise))
            }
            EquationKind::For { iterators, body } => match self.iterated(iterators) {
                Ok(inner) => inner.equations(body),
                Err(found) => Some(found),
            },
            EquationKind::When { branches } => self.equation_branches(branches),
            EquationKind::Connect(a, b) => self.reference(a).or_else(|| self.reference(b)),
            EquationKind::Call(e) => self.expr(e),
            EquationKind::Broken => None,
        })
    }

    fn equation_branches(&self, branches: &[(Expr, Vec<Equation>)]) -> Option<Role> {
        branches.iter().find_map(|(e, body)| self.expr(e).or_else(|| self.equations(body)))
    }

    fn statements(&self, statements: &[Statement]) -> Option<Role> {
        let mut near = statements.iter().filter(|statement| self.within(statement.span));
        near.find_map(|statement| match &statement.kind {
            StatementKind::Assign(target, e) => self.reference(target).or_else(|| self.expr(e)),
            StatementKind::AssignTuple(targets, e) => {
                let mut all = targets.iter().flatten();
                all.find_map(|target| self.reference(target)).or_else(|| self.expr(e))
            }
            StatementKind::Call(e) => self.expr(e),
            StatementKind::If { branches, otherwise } => {
                self.statement_branches(branches).or_else(|| self.statements(otherwise))
            }
            StatementKind::For { iterators, body } => match self.iterated(iterators) {
                Ok(inner) => inner.statements(body),
                Err(found) => Some(found),
            },
            StatementKind::While { condition, body } => {
                self.expr(condition).or_else(|| self.statements(body))
            }
            StatementKind::When { branches } => self.statement_branches(branches),
            StatementKind::Break | StatementKind::Return | StatementKind::Broken => None,
        })
    }

    fn statement_branches(&self, branches: &[(Expr, Vec<Statement>)]) -> Option<Role> {
        branches.iter().find_map(|(e, body)| self.expr(e).or_else(|| self.statements(body)))
    }
}
