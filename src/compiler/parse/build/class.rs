//! Classes and the sections of their bodies.

use std::sync::Arc;

use super::prefix::{CLASS, Prefix, Prefixes, TYPE};
use super::{Builder, MAX_BLOCKS, OpenClass, too_deep};
use crate::base::diag::Diagnostic;
use crate::ir::ast::*;
use crate::parse::error::{SyntaxCause, unclosed_class, wrong_end_name};
use crate::parse::grammar::ParseError;

/// A description string and an annotation.
pub type Description = (Option<Arc<str>>, Option<Arc<Modification>>);

/// Everything before the body of a class.
#[derive(Clone, Copy, Debug)]
pub struct ClassHead {
    prefixes: Prefixes,
    kind: ClassKind,
    name: Ident,
}

/// A class with the prefixes of the element or argument it will become.
#[derive(Debug)]
pub struct ClassDraft {
    pub(super) prefixes: Prefixes,
    pub(super) class: Class,
}

/// The body of a long class.
#[derive(Debug, Default)]
pub struct ClassParts {
    composition: Composition,
    annotation: Option<Arc<Modification>>,
}

impl Builder<'_> {
    /// `within A.B;`
    pub fn within(&mut self, path: Option<Path>, start: u32, end: u32) {
        let span = self.span(start, end);
        self.within = Some(path.unwrap_or(Path { global: false, parts: Vec::new(), span }));
    }
    /// A top-level class of the file.
    pub fn top_class(&mut self, draft: Box<ClassDraft>) {
        self.allow(draft.prefixes, &[&[Prefix::Final], CLASS], "a class of the file");
        self.classes.push(Arc::new(draft.class));
    }

    // ---- Classes ----

    /// `encapsulated partial model A`.
    pub fn class_head(
        &mut self,
        prefixes: Prefixes,
        kind: ClassKind,
        name: Ident,
    ) -> Result<Box<ClassHead>, ParseError> {
        self.blocks = 0;
        if self.open.len() >= MAX_BLOCKS {
            return Err(too_deep(name.span.start));
        }
        self.open.push(OpenClass { start: prefixes.start, name });
        Ok(Box::new(ClassHead { prefixes, kind, name }))
    }
    /// Everything up to `end A`.
    pub fn long_class(
        &mut self,
        head: Box<ClassHead>,
        class_extends: Option<Option<Arc<Modification>>>,
        description: Option<Arc<str>>,
        parts: Box<ClassParts>,
        end: Ident,
    ) -> Box<ClassDraft> {
        self.close_class(&head, Some(end));
        let mut composition = parts.composition;
        composition.class_extends = class_extends;
        let body = ClassBody::Long(composition);
        self.draft(&head, body, (description, parts.annotation), end.span.end)
    }
    /// A class that is cut short by the end of the file.
    pub fn unclosed_class(
        &mut self,
        head: Box<ClassHead>,
        description: Option<Arc<str>>,
        parts: Box<ClassParts>,
        end: u32,
    ) {
        if !self.unclosed_reported {
            self.report(unclosed_class(head.name, None));
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
        head: Box<ClassHead>,
        prefixes: Prefixes,
        base: Path,
        dims: Vec<Subscript>,
        modification: Option<Arc<Modification>>,
        description: Description,
        end: u32,
    ) -> Box<ClassDraft> {
        self.close_class(&head, None);
        self.allow(prefixes, &[TYPE], "the base of a short class");
        let prefix = prefixes.type_prefix();
        let body = ClassBody::Short(ShortClass { prefix, base, dims, modification });
        self.draft(&head, body, description, end)
    }
    /// `type A = enumeration(...)`
    pub fn enumeration(
        &mut self,
        head: Box<ClassHead>,
        literals: Option<Vec<EnumLiteral>>,
        description: Description,
        end: u32,
    ) -> Box<ClassDraft> {
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
        head: Box<ClassHead>,
        function: Path,
        variables: Vec<Ident>,
        description: Description,
        end: u32,
    ) -> Box<ClassDraft> {
        self.close_class(&head, None);
        let body = ClassBody::PartialDerivative { function, variables };
        self.draft(&head, body, description, end)
    }
    fn draft(
        &mut self,
        head: &ClassHead,
        body: ClassBody,
        description: Description,
        end: u32,
    ) -> Box<ClassDraft> {
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
        Box::new(ClassDraft { prefixes: head.prefixes, class })
    }
    /// Takes the class off the list of open ones and checks the name after `end`.
    fn close_class(&mut self, head: &ClassHead, end: Option<Ident>) {
        let start = head.prefixes.start;
        self.open.retain(|open| open.start < start);
        self.blocks = 0;
        let Some(end) = end else { return };
        // An empty one was inserted, and reported, where it is missing.
        if end.name == head.name.name || end.span.start == end.span.end {
            return;
        }
        if self.open.iter().any(|open| open.name.name == end.name) {
            self.unclosed_reported = true;
            self.report(unclosed_class(head.name, Some(end)));
        } else {
            self.report(wrong_end_name(head.name, end));
        }
    }
    /// The innermost class that is open.
    pub(in crate::parse) fn innermost_class(&self) -> Option<Ident> {
        self.open.last().map(|open| open.name)
    }

    // ---- Sections ----

    /// The elements before any section.
    pub fn parts(&mut self, elements: Vec<Box<Element>>) -> Box<ClassParts> {
        let parts = Box::<ClassParts>::default();
        self.elements(parts, false, elements)
    }
    /// A `public` or `protected` section.
    pub fn elements(
        &mut self,
        mut parts: Box<ClassParts>,
        protected: bool,
        elements: Vec<Box<Element>>,
    ) -> Box<ClassParts> {
        let elements = elements.into_iter().map(|e| Element { protected, ..*e });
        parts.composition.elements.extend(elements);
        parts
    }
    /// An `equation` section.
    pub fn equations(
        &mut self,
        mut parts: Box<ClassParts>,
        initial: bool,
        equations: Vec<Equation>,
    ) -> Box<ClassParts> {
        self.blocks = 0;
        let section = EquationSection { initial, equations: equations.into() };
        parts.composition.equations.push(section);
        parts
    }
    /// An `algorithm` section.
    pub fn algorithm(
        &mut self,
        mut parts: Box<ClassParts>,
        initial: bool,
        statements: Vec<Statement>,
        start: u32,
        end: u32,
    ) -> Box<ClassParts> {
        self.blocks = 0;
        let span = self.span(start, end);
        let section = AlgorithmSection { initial, statements: statements.into(), span };
        parts.composition.algorithms.push(section);
        parts
    }
    /// The `external` clause.
    pub fn external(
        &mut self,
        mut parts: Box<ClassParts>,
        external: Box<External>,
    ) -> Box<ClassParts> {
        if let Some(first) = &parts.composition.external {
            let cause = SyntaxCause::DuplicateClause { clause: "`external` clause" };
            self.report(Diagnostic::new(cause, external.span).also(first.span, "the first"));
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
        mut parts: Box<ClassParts>,
        annotation: Arc<Modification>,
    ) -> Box<ClassParts> {
        if let Some(first) = &parts.annotation {
            let cause = SyntaxCause::DuplicateClause { clause: "annotation of the class" };
            self.report(Diagnostic::new(cause, annotation.span).also(first.span, "the first"));
        }
        parts.annotation = Some(annotation);
        parts
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
            ("flow flow Real x;", "MO0035"),
            ("flow stream Real x;", "MO0036"),
            ("parameter flow Real x;", "MO0015"),
            ("encapsulated Real x;", "MO0016"),
            ("Real x(Real y = 1);", "MO0026"),
            ("Real x constrainedby Real;", "MO0024"),
        ] {
            assert_eq!(file(&format!("model A {text} end A;")).1, [code], "{text}");
        }
    }
    #[test]
    fn valid_constructs_are_kept() {
        let (file, codes) =
            file("model A Real x; Real 3; Real y; equation x = ; y = 1; end A; model B end B;");
        assert_eq!((codes, file.classes.len()), (vec!["MO0001", "MO0001"], 2));
        let ClassBody::Long(c) = &file.classes[0].body else { panic!("long") };
        assert_eq!((c.elements.len(), c.equations[0].equations.len()), (2, 1));
    }
}
