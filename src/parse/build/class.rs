//! Classes, elements and modifications.

use std::sync::Arc;

use super::{Builder, MAX_BLOCKS, OpenClass, too_deep};
use crate::base::source::Span;
use crate::ir::ast::*;
use crate::parse::error::SyntaxError;
use crate::parse::grammar::Failure;
use crate::parse::token::Kind;

/// A description string and an annotation.
pub type Description = (Option<Arc<str>>, Option<Arc<Modification>>);

/// The prefix keywords, in the order in which they must be written.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[allow(missing_docs)]
pub enum Prefix {
    Redeclare,
    Each,
    Final,
    Inner,
    Outer,
    Replaceable,
    Encapsulated,
    Partial,
    Flow,
    Stream,
    Discrete,
    Parameter,
    Constant,
    Input,
    Output,
}

impl Prefix {
    const ALL: [(Prefix, Kind); 15] = [
        (Prefix::Redeclare, Kind::Redeclare),
        (Prefix::Each, Kind::Each),
        (Prefix::Final, Kind::Final),
        (Prefix::Inner, Kind::Inner),
        (Prefix::Outer, Kind::Outer),
        (Prefix::Replaceable, Kind::Replaceable),
        (Prefix::Encapsulated, Kind::Encapsulated),
        (Prefix::Partial, Kind::Partial),
        (Prefix::Flow, Kind::Flow),
        (Prefix::Stream, Kind::Stream),
        (Prefix::Discrete, Kind::Discrete),
        (Prefix::Parameter, Kind::Parameter),
        (Prefix::Constant, Kind::Constant),
        (Prefix::Input, Kind::Input),
        (Prefix::Output, Kind::Output),
    ];
    /// Prefixes of one place exclude each other.
    fn place(self) -> u8 {
        match self {
            Prefix::Flow | Prefix::Stream => 8,
            Prefix::Discrete | Prefix::Parameter | Prefix::Constant => 9,
            Prefix::Input | Prefix::Output => 10,
            other => other as u8,
        }
    }
}

/// Prefixes of an element or modification argument.
#[derive(Clone, Copy, Debug)]
pub struct Prefixes {
    start: u32,
    set: u32,
    last: Option<Prefix>,
}

const ELEMENT: &[Prefix] =
    &[Prefix::Redeclare, Prefix::Final, Prefix::Inner, Prefix::Outer, Prefix::Replaceable];
const ARGUMENT: &[Prefix] = &[Prefix::Redeclare, Prefix::Each, Prefix::Final, Prefix::Replaceable];
const CLASS: &[Prefix] = &[Prefix::Encapsulated, Prefix::Partial];
const TYPE: &[Prefix] = &[
    Prefix::Flow,
    Prefix::Stream,
    Prefix::Discrete,
    Prefix::Parameter,
    Prefix::Constant,
    Prefix::Input,
    Prefix::Output,
];

impl Prefixes {
    /// None yet; they would start here.
    pub fn at(start: u32) -> Self {
        Prefixes { start, set: 0, last: None }
    }
    /// Where the first one starts, or what follows.
    pub fn start(self) -> u32 {
        self.start
    }
    fn has(self, prefix: Prefix) -> bool {
        self.set & (1 << prefix as u32) != 0
    }
    fn type_prefix(self) -> TypePrefix {
        let first = |list: &[Prefix]| list.iter().copied().find(|p| self.has(*p));
        TypePrefix {
            connection: first(&[Prefix::Flow, Prefix::Stream]).map(|p| match p {
                Prefix::Flow => ConnectionPrefix::Flow,
                _ => ConnectionPrefix::Stream,
            }),
            variability: first(&[Prefix::Discrete, Prefix::Parameter, Prefix::Constant]).map(|p| {
                match p {
                    Prefix::Discrete => Variability::Discrete,
                    Prefix::Parameter => Variability::Parameter,
                    _ => Variability::Constant,
                }
            }),
            causality: first(&[Prefix::Input, Prefix::Output]).map(|p| match p {
                Prefix::Input => Causality::Input,
                _ => Causality::Output,
            }),
        }
    }
}

/// What stands before the body of a class.
#[derive(Clone, Copy, Debug)]
pub struct Head {
    prefixes: Prefixes,
    kind: ClassKind,
    name: Ident,
}

/// A class with the prefixes of the element or argument it will become.
#[derive(Debug)]
pub struct Draft {
    prefixes: Prefixes,
    class: Class,
}

/// The body of a long class.
#[derive(Debug, Default)]
pub struct Parts {
    composition: Composition,
    annotation: Option<Arc<Modification>>,
}

/// Something with the description that follows it.
#[derive(Debug)]
pub struct Described<T> {
    node: T,
    span: Span,
    description: Option<Arc<str>>,
    annotation: Option<Arc<Modification>>,
}

type Constraint = Option<Box<Described<Replaceable>>>;

impl Builder<'_> {
    /// `within A.B;`
    pub fn within(&mut self, path: Option<Path>, start: u32, end: u32) {
        let span = self.span(start, end);
        self.within = Some(path.unwrap_or(Path { global: false, parts: Vec::new(), span }));
    }
    /// A class of the file itself.
    pub fn top_class(&mut self, draft: Box<Draft>) {
        self.allow(draft.prefixes, &[&[Prefix::Final], CLASS], "a class of the file");
        self.classes.push(Arc::new(draft.class));
    }

    // ---- Prefixes ----

    /// Adds a prefix; reports one that is doubled or out of order.
    pub fn prefix(&mut self, mut list: Prefixes, prefix: Prefix, start: u32, end: u32) -> Prefixes {
        let span = self.span(start, end);
        if let Some(last) = list.last {
            let error = if list.has(prefix) {
                Some(SyntaxError::DoubledPrefix { span })
            } else if prefix.place() == last.place() {
                Some(SyntaxError::ExclusivePrefix { span, other: Prefix::text(last) })
            } else if prefix.place() < last.place() {
                let (prefix, later) = (Prefix::text(prefix), Prefix::text(last));
                Some(SyntaxError::PrefixOrder { span, prefix, later })
            } else {
                None
            };
            error.into_iter().for_each(|e| self.report(e));
        }
        list.set |= 1 << prefix as u32;
        list.last = Some(prefix);
        list
    }
    /// Reports prefixes that do not belong to `what`.
    fn allow(&mut self, prefixes: Prefixes, allowed: &[&[Prefix]], what: &'static str) {
        for (prefix, kind) in Prefix::ALL {
            if prefixes.has(prefix) && !allowed.iter().any(|list| list.contains(&prefix)) {
                let span = self.first_of(kind, prefixes.start);
                self.report(SyntaxError::MisplacedPrefix { span, prefix: kind.text(), what });
            }
        }
    }

    // ---- Classes ----

    /// `encapsulated partial model A`.
    pub fn class_head(
        &mut self,
        prefixes: Prefixes,
        kind: ClassKind,
        name: Ident,
    ) -> Result<Box<Head>, Failure> {
        self.blocks = 0;
        if self.open.len() >= MAX_BLOCKS {
            return Err(too_deep(name.span.start));
        }
        self.open.push(OpenClass { start: prefixes.start, name });
        Ok(Box::new(Head { prefixes, kind, name }))
    }
    /// Everything up to `end A`.
    pub fn long_class(
        &mut self,
        head: Box<Head>,
        class_extends: Option<Option<Arc<Modification>>>,
        description: Option<Arc<str>>,
        parts: Box<Parts>,
        end: Ident,
    ) -> Box<Draft> {
        self.close_class(&head, Some(end));
        let mut composition = parts.composition;
        composition.class_extends = class_extends;
        let body = ClassBody::Long(composition);
        self.draft(&head, body, (description, parts.annotation), end.span.end)
    }
    /// A class that the end of the file cut short.
    pub fn unclosed_class(
        &mut self,
        head: Box<Head>,
        description: Option<Arc<str>>,
        parts: Box<Parts>,
        end: u32,
    ) {
        if !self.unclosed_reported {
            self.report(SyntaxError::UnclosedClass { class: head.name, found: None });
        }
        self.close_class(&head, None);
        let body = ClassBody::Long(parts.composition);
        let draft = self.draft(&head, body, (description, parts.annotation), end);
        self.top_class(draft);
    }
    /// `type A = B[3](x = 1)`
    #[allow(clippy::too_many_arguments)] // one for each part of the rule
    pub fn short_class(
        &mut self,
        head: Box<Head>,
        prefixes: Prefixes,
        base: Path,
        dims: Vec<Subscript>,
        modification: Option<Arc<Modification>>,
        description: Description,
        end: u32,
    ) -> Box<Draft> {
        self.close_class(&head, None);
        self.allow(prefixes, &[TYPE], "the base of a short class");
        let prefix = prefixes.type_prefix();
        let body = ClassBody::Short(ShortClass { prefix, base, dims, modification });
        self.draft(&head, body, description, end)
    }
    /// `type A = enumeration(...)`
    pub fn enumeration(
        &mut self,
        head: Box<Head>,
        literals: Option<Vec<EnumLiteral>>,
        description: Description,
        end: u32,
    ) -> Box<Draft> {
        self.close_class(&head, None);
        self.draft(&head, ClassBody::Enumeration(literals), description, end)
    }
    /// One literal of an enumeration.
    pub fn enum_literal(&mut self, name: Ident, description: Description) -> EnumLiteral {
        EnumLiteral { name, description: description.0, annotation: description.1 }
    }
    /// `function A = der(f, x)`
    pub fn partial_derivative(
        &mut self,
        head: Box<Head>,
        function: Path,
        variables: Vec<Ident>,
        description: Description,
        end: u32,
    ) -> Box<Draft> {
        self.close_class(&head, None);
        let body = ClassBody::PartialDerivative { function, variables };
        self.draft(&head, body, description, end)
    }
    fn draft(
        &mut self,
        head: &Head,
        body: ClassBody,
        description: Description,
        end: u32,
    ) -> Box<Draft> {
        let class = Class {
            name: head.name,
            span: self.span(head.prefixes.start, end),
            kind: head.kind,
            encapsulated: head.prefixes.has(Prefix::Encapsulated),
            partial: head.prefixes.has(Prefix::Partial),
            body,
            description: description.0,
            annotation: description.1,
        };
        Box::new(Draft { prefixes: head.prefixes, class })
    }
    /// Takes the class off the list of open ones and checks the name after `end`.
    fn close_class(&mut self, head: &Head, end: Option<Ident>) {
        let start = head.prefixes.start;
        self.open.retain(|open| open.start < start);
        self.blocks = 0;
        let Some(end) = end else { return };
        if end.name == head.name.name {
            return;
        }
        if self.open.iter().any(|open| open.name.name == end.name) {
            self.unclosed_reported = true;
            self.report(SyntaxError::UnclosedClass { class: head.name, found: Some(end) });
        } else {
            self.report(SyntaxError::WrongEndName { class: head.name, found: end });
        }
    }
    /// The innermost class that is open.
    pub(in crate::parse) fn innermost_class(&self) -> Option<Ident> {
        self.open.last().map(|open| open.name)
    }

    // ---- Sections ----

    /// The elements before any section.
    pub fn parts(&mut self, elements: Vec<Box<Element>>) -> Box<Parts> {
        let parts = Box::<Parts>::default();
        self.elements(parts, false, elements)
    }
    /// A `public` or `protected` section.
    pub fn elements(
        &mut self,
        mut parts: Box<Parts>,
        protected: bool,
        elements: Vec<Box<Element>>,
    ) -> Box<Parts> {
        let elements = elements.into_iter().map(|e| Element { protected, ..*e });
        parts.composition.elements.extend(elements);
        parts
    }
    /// An `equation` section.
    pub fn equations(
        &mut self,
        mut parts: Box<Parts>,
        initial: bool,
        equations: Vec<Equation>,
    ) -> Box<Parts> {
        self.blocks = 0;
        let section = EquationSection { initial, equations: equations.into() };
        parts.composition.equations.push(section);
        parts
    }
    /// An `algorithm` section.
    pub fn algorithm(
        &mut self,
        mut parts: Box<Parts>,
        initial: bool,
        statements: Vec<Statement>,
        start: u32,
        end: u32,
    ) -> Box<Parts> {
        self.blocks = 0;
        let span = self.span(start, end);
        let section = AlgorithmSection { initial, statements: statements.into(), span };
        parts.composition.algorithms.push(section);
        parts
    }
    /// The `external` clause.
    pub fn external(&mut self, mut parts: Box<Parts>, external: Box<External>) -> Box<Parts> {
        if let Some(first) = &parts.composition.external {
            let (span, first) = (external.span, first.span);
            self.report(SyntaxError::Doubled { span, first, what: "`external` clause" });
        }
        parts.composition.external = Some(*external);
        parts
    }
    /// The contents of an `external` clause.
    #[allow(clippy::too_many_arguments)] // one for each part of the rule
    pub fn external_clause(
        &mut self,
        language: Option<Arc<str>>,
        output: Option<ComponentRef>,
        function: Option<Ident>,
        args: Vec<Box<Expr>>,
        annotation: Option<Arc<Modification>>,
        start: u32,
        end: u32,
    ) -> Box<External> {
        let args = self.unbox(args);
        let span = self.span(start, end);
        Box::new(External { language, output, function, args, annotation, span })
    }
    /// The annotation of the class.
    pub fn class_annotation(
        &mut self,
        mut parts: Box<Parts>,
        annotation: Arc<Modification>,
    ) -> Box<Parts> {
        if let Some(first) = &parts.annotation {
            let (span, first) = (annotation.span, first.span);
            self.report(SyntaxError::Doubled { span, first, what: "annotation of the class" });
        }
        parts.annotation = Some(annotation);
        parts
    }

    // ---- Elements ----

    /// What an import clause names.
    pub fn import_of(&mut self, parts: Vec<Ident>, form: ImportForm) -> Box<Import> {
        Box::new(Import { path: self.path(parts), form })
    }
    /// An import clause.
    pub fn import(&mut self, import: Box<Import>, start: u32, end: u32) -> Box<Element> {
        let span = self.span(start, end);
        self.element(Prefixes::at(start), None, ElementKind::Import(*import), span)
    }
    /// An extends clause.
    pub fn extends(
        &mut self,
        base: Path,
        modification: Option<Arc<Modification>>,
        annotation: Option<Arc<Modification>>,
        start: u32,
        end: u32,
    ) -> Box<Element> {
        let span = self.span(start, end);
        let kind = ElementKind::Extends(Extends { base, modification, annotation });
        self.element(Prefixes::at(start), None, kind, span)
    }
    /// A nested class.
    pub fn class_element(
        &mut self,
        draft: Box<Draft>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        self.allow(draft.prefixes, &[ELEMENT, CLASS], "a class");
        self.class_in(draft, constraint, end)
    }
    /// Components of one type.
    pub fn components(
        &mut self,
        prefixes: Prefixes,
        type_name: Path,
        type_dims: Vec<Subscript>,
        components: Vec<Box<Component>>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        self.allow(prefixes, &[ELEMENT, TYPE], "a component");
        self.components_in(prefixes, type_name, type_dims, components, constraint, end)
    }
    /// One declared name.
    pub fn component(
        &mut self,
        name: Ident,
        dims: Vec<Subscript>,
        modification: Option<Arc<Modification>>,
        condition: Option<Box<Expr>>,
        (description, annotation): Description,
    ) -> Box<Component> {
        let condition = condition.map(Arc::from);
        Box::new(Component { name, dims, modification, condition, description, annotation })
    }
    /// `constrainedby A(...) "..."`
    pub fn constraint(
        &mut self,
        start: u32,
        path: Path,
        modification: Option<Arc<Modification>>,
        (description, annotation): Description,
    ) -> Box<Described<Replaceable>> {
        let span = self.span(start, path.span.end);
        let node = Replaceable { constraint: Some(path), modification };
        Box::new(Described { node, span, description, annotation })
    }

    fn class_in(&mut self, draft: Box<Draft>, constraint: Constraint, end: u32) -> Box<Element> {
        let Draft { prefixes, mut class } = *draft;
        let constraint = constraint.map(|mut c| {
            class.description = class.description.take().or(c.description.take());
            class.annotation = class.annotation.take().or(c.annotation.take());
            c
        });
        let span = self.span(prefixes.start, end);
        self.element(prefixes, constraint, ElementKind::Class(Arc::new(class)), span)
    }
    fn components_in(
        &mut self,
        prefixes: Prefixes,
        type_name: Path,
        type_dims: Vec<Subscript>,
        components: Vec<Box<Component>>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        let mut components = self.unbox(components);
        let constraint = constraint.map(|mut c| {
            // Written after the constraint, the description is that of the declared component.
            if let Some(last) = components.last_mut() {
                last.description = last.description.take().or(c.description.take());
                last.annotation = last.annotation.take().or(c.annotation.take());
            }
            c
        });
        let span = self.span(prefixes.start, end);
        let prefix = prefixes.type_prefix();
        let clause = ComponentClause { prefix, type_name, type_dims, components };
        self.element(prefixes, constraint, ElementKind::Components(clause), span)
    }
    fn element(
        &mut self,
        prefixes: Prefixes,
        constraint: Constraint,
        kind: ElementKind,
        span: Span,
    ) -> Box<Element> {
        let replaceable = prefixes.has(Prefix::Replaceable);
        if let Some(constraint) = &constraint
            && !replaceable
            && !prefixes.has(Prefix::Redeclare)
        {
            self.report(SyntaxError::IdleConstraint { span: constraint.span });
        }
        let constraint = constraint.map(|c| c.node);
        Box::new(Element {
            protected: false,
            redeclare: prefixes.has(Prefix::Redeclare),
            is_final: prefixes.has(Prefix::Final),
            inner: prefixes.has(Prefix::Inner),
            outer: prefixes.has(Prefix::Outer),
            replaceable: if replaceable {
                Some(constraint.unwrap_or_default())
            } else {
                constraint
            },
            kind,
            span,
        })
    }

    // ---- Modifications ----

    /// `(...) = e`
    pub fn modification(
        &mut self,
        args: Vec<Box<Argument>>,
        binding: Option<Box<Expr>>,
        start: u32,
        end: u32,
    ) -> Arc<Modification> {
        let args = self.unbox(args);
        Arc::new(Modification {
            args,
            binding: binding.map(Arc::from),
            span: self.span(start, end),
        })
    }
    /// `each final a.b(...) = e "..."`
    pub fn modify(
        &mut self,
        prefixes: Prefixes,
        path: Path,
        modification: Option<Arc<Modification>>,
        (description, _): Description,
        end: u32,
    ) -> Box<Argument> {
        self.allow(prefixes, &[&[Prefix::Each, Prefix::Final]], "a modification");
        let kind = ArgumentKind::Element { path, modification, description };
        self.argument(prefixes, kind, end)
    }
    /// `redeclare model A = B`
    pub fn redeclare_class(
        &mut self,
        draft: Box<Draft>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Argument> {
        let prefixes = draft.prefixes;
        self.allow(prefixes, &[ARGUMENT, CLASS], "the class of a modification");
        self.check_redeclares(prefixes, draft.class.name);
        if matches!(draft.class.body, ClassBody::Long(_)) {
            self.report(SyntaxError::LongRedeclaration { class: draft.class.name });
        }
        let element = self.class_in(draft, constraint, end);
        self.argument(prefixes, ArgumentKind::Redeclare(Arc::from(element)), end)
    }
    /// `redeclare A a(...)`
    pub fn redeclare_component(
        &mut self,
        prefixes: Prefixes,
        type_name: Path,
        type_dims: Vec<Subscript>,
        component: Box<Component>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Argument> {
        self.allow(prefixes, &[ARGUMENT, TYPE], "the component of a modification");
        self.check_redeclares(prefixes, component.name);
        let element =
            self.components_in(prefixes, type_name, type_dims, vec![component], constraint, end);
        self.argument(prefixes, ArgumentKind::Redeclare(Arc::from(element)), end)
    }
    /// `break a`
    pub fn removal(&mut self, removal: Removal, start: u32, end: u32) -> Box<Argument> {
        self.argument(Prefixes::at(start), ArgumentKind::Removal(removal), end)
    }
    fn check_redeclares(&mut self, prefixes: Prefixes, name: Ident) {
        if !prefixes.has(Prefix::Redeclare) && !prefixes.has(Prefix::Replaceable) {
            let at = self.span(prefixes.start, prefixes.start);
            self.report(SyntaxError::MissingRedeclare { at, name });
        }
    }
    fn argument(&mut self, prefixes: Prefixes, kind: ArgumentKind, end: u32) -> Box<Argument> {
        Box::new(Argument {
            each: prefixes.has(Prefix::Each),
            is_final: prefixes.has(Prefix::Final),
            kind,
            span: self.span(prefixes.start, end),
        })
    }
}

impl Prefix {
    fn text(prefix: Prefix) -> &'static str {
        Prefix::ALL[prefix as usize].1.text()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::diag::Problems;
    use crate::base::source::FileId;
    use crate::parse::grammar::parse;

    fn file(text: &str) -> (File, Vec<&'static str>) {
        let mut problems = Problems::new();
        let file = parse(FileId(0), text, &mut problems);
        (file, problems.iter().map(|p| p.code).collect())
    }
    fn body(text: &str) -> Composition {
        let (file, codes) = file(text);
        assert!(codes.is_empty(), "{text}: {codes:?}");
        match &file.classes[0].body {
            ClassBody::Long(body) => body.clone(),
            other => panic!("not a long class: {other:?}"),
        }
    }

    #[test]
    fn kinds_of_classes() {
        let function = |operator, pure| ClassKind::Function { operator, pure };
        for (text, kind) in [
            ("operator record", ClassKind::OperatorRecord),
            ("expandable connector", ClassKind::ExpandableConnector),
            ("operator", ClassKind::Operator),
            ("operator function", function(true, None)),
            ("pure function", function(false, Some(true))),
            ("impure operator function", function(true, Some(false))),
        ] {
            let (file, codes) = file(&format!("within P.Q; encapsulated partial {text} A end A;"));
            assert_eq!((file.classes[0].kind, codes.len()), (kind, 0), "{text}");
            assert!(file.classes[0].partial && file.classes[0].encapsulated);
            assert_eq!(file.within.unwrap().to_string(), "P.Q");
        }
    }
    #[test]
    fn forms_of_class_bodies() {
        let (file, codes) = file(
            "type T = flow B[3, :](x = 1) \"d\"; type E = enumeration(a \"A\", b); \
             type O = enumeration(:); function d = der(f, x, y);",
        );
        assert_eq!(codes.len(), 0);
        let ClassBody::Short(short) = &file.classes[0].body else { panic!("short") };
        assert_eq!(short.prefix.connection, Some(ConnectionPrefix::Flow));
        assert_eq!((short.dims.len(), file.classes[0].description.as_deref()), (2, Some("d")));
        let ClassBody::Enumeration(Some(literals)) = &file.classes[1].body else { panic!("list") };
        assert_eq!(literals[0].description.as_deref(), Some("A"));
        assert!(matches!(file.classes[2].body, ClassBody::Enumeration(None)));
        let ClassBody::PartialDerivative { variables, .. } = &file.classes[3].body else {
            panic!("der")
        };
        assert_eq!(variables.len(), 2);
        let inner = body("model M redeclare model extends A(x = 1) Real y; end A; end M;");
        let ElementKind::Class(class) = &inner.elements[0].kind else { panic!("class") };
        let ClassBody::Long(long) = &class.body else { panic!("long") };
        assert!(matches!(&long.class_extends, Some(Some(m)) if m.args.len() == 1));
    }
    #[test]
    fn elements_with_their_prefixes() {
        let c = body(
            "model A import B = C.D; import C.*; import C.{D, E}; extends F(g = 1); protected \
             redeclare final inner outer replaceable parameter input Real[3] \
             x[2](start = 1) = y if z \"x\" + \"y\", w constrainedby G(h = 2) \"w\"; end A;",
        );
        assert!(matches!(
            &c.elements[2].kind,
            ElementKind::Import(Import { form: ImportForm::List(names), .. }) if names.len() == 2
        ));
        let e = &c.elements[4];
        assert!(e.protected && e.redeclare && e.is_final && e.inner && e.outer);
        assert_eq!(e.replaceable.as_ref().unwrap().constraint.as_ref().unwrap().to_string(), "G");
        let ElementKind::Components(clause) = &e.kind else { panic!("components") };
        assert_eq!(clause.prefix.variability, Some(Variability::Parameter));
        assert_eq!(clause.prefix.causality, Some(Causality::Input));
        assert_eq!(clause.components[0].description.as_deref(), Some("xy"));
        assert!(clause.components[0].condition.is_some());
        assert_eq!(clause.components[1].description.as_deref(), Some("w"));
    }
    #[test]
    fn arguments_of_modifications() {
        let c = body(
            "model A extends B(each final a.b(c = 1) = 2 \"d\", redeclare replaceable model M = N \
             constrainedby O, replaceable Real x = 1, y = break, break z, break connect(p, q)); \
             Real r := 1; end A;",
        );
        let ElementKind::Extends(extends) = &c.elements[0].kind else { panic!("extends") };
        let args = &extends.modification.as_ref().unwrap().args;
        assert!(args[0].each && args[0].is_final);
        let redeclares: Vec<bool> =
            args.iter().map(|a| matches!(a.kind, ArgumentKind::Redeclare(_))).collect();
        assert_eq!(redeclares, [false, true, true, false, false, false]);
        assert!(matches!(args[4].kind, ArgumentKind::Removal(Removal::Element(_))));
        assert!(matches!(args[5].kind, ArgumentKind::Removal(Removal::Connection(..))));
    }
    #[test]
    fn prefixes_are_checked() {
        for (text, code) in [
            ("flow flow Real x;", "MO0015"),
            ("flow stream Real x;", "MO0015"),
            ("parameter flow Real x;", "MO0015"),
            ("encapsulated Real x;", "MO0016"),
            ("Real x(Real y = 1);", "MO0026"),
            ("Real x constrainedby Real;", "MO0024"),
        ] {
            assert_eq!(file(&format!("model A {text} end A;")).1, [code], "{text}");
        }
    }
    #[test]
    fn what_is_not_broken_is_kept() {
        let (file, codes) =
            file("model A Real x; Real 3; Real y; equation x = ; y = 1; end A; model B end B;");
        assert_eq!((codes, file.classes.len()), (vec!["MO0001", "MO0001"], 2));
        let ClassBody::Long(c) = &file.classes[0].body else { panic!("long") };
        assert_eq!((c.elements.len(), c.equations[0].equations.len()), (2, 1));
    }
}
