//! Syntax with spans: Modelica 3.6, appendix A, as written by the user.
//!
//! *Holds:* one tree per file, every node with its place, comments kept in a list of their own.
//! *Never holds:* resolved names, types, evaluated values.
//! *Made by:* `parse`. *Read by:* `resolve`, `instantiate`, `flatten`.
//!
//! Parts that later stages keep (classes, sections, modifier expressions) stand behind [`Arc`], so
//! that an instance refers to its text without copying it.

use std::sync::Arc;

use crate::base::name::Name;
use crate::base::source::{FileId, Span};

/// One `stored_definition`.
#[derive(Clone, Debug)]
pub struct File {
    /// The file it was read from.
    pub id: FileId,
    /// `within A.B;`: `None` without the clause, an empty path for `within;`.
    pub within: Option<Path>,
    /// Top-level classes in order.
    pub classes: Vec<Arc<Class>>,
    /// `//` and `/* */` comments in order of place.
    pub comments: Vec<Comment>,
}

impl File {
    /// The package that the file declares with `within`; `None` at the top.
    pub fn package(&self) -> Option<&Path> {
        self.within.as_ref().filter(|within| !within.parts.is_empty())
    }
}

/// A comment, kept for the formatter.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Comment {
    /// With its delimiters.
    pub span: Span,
    /// `/* */` rather than `//`.
    pub block: bool,
}

/// An identifier at its place.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Ident {
    /// The text.
    pub name: Name,
    /// Where it stands.
    pub span: Span,
}

/// A dotted name without subscripts, such as a type name.
#[derive(Clone, Debug)]
pub struct Path {
    /// Starts with a dot: looked up from the top.
    pub global: bool,
    /// At least one, except in `within;`.
    pub parts: Vec<Ident>,
    /// The whole name.
    pub span: Span,
}

/// A class definition, long or short.
#[derive(Clone, Debug)]
pub struct Class {
    /// Its name (for `model extends A`, the name A).
    pub name: Ident,
    /// From the first prefix to the end of the `end` clause or short definition.
    pub span: Span,
    /// `model`, `connector`...
    pub kind: ClassKind,
    /// `encapsulated`.
    pub encapsulated: bool,
    /// `partial`.
    pub partial: bool,
    /// What it is made of.
    pub body: ClassBody,
    /// The description string.
    pub description: Option<Arc<str>>,
    /// `annotation(...)` of the class.
    pub annotation: Option<Arc<Modification>>,
}

/// The specialised class.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClassKind {
    /// `class`
    Class,
    /// `model`
    Model,
    /// `block`
    Block,
    /// `record`
    Record,
    /// `operator record`
    OperatorRecord,
    /// `connector`
    Connector,
    /// `expandable connector`
    ExpandableConnector,
    /// `type`
    Type,
    /// `package`
    Package,
    /// `function`, `operator function`, with `pure`/`impure` if written
    Function {
        /// `operator function`.
        operator: bool,
        /// `Some(true)` for `pure`, `Some(false)` for `impure`.
        pure: Option<bool>,
    },
    /// `operator`
    Operator,
}

/// The right side of a class definition.
#[derive(Clone, Debug)]
pub enum ClassBody {
    /// `model A ... end A`, or `model extends A(...) ... end A` (then with `extends`).
    Long(Composition),
    /// `type A = flow B[3](x = 1)`.
    Short(ShortClass),
    /// `type A = enumeration(a, b)`; `None` for `enumeration(:)`.
    Enumeration(Option<Vec<EnumLiteral>>),
    /// `function df = der(f, x, y)`.
    PartialDerivative {
        /// The function.
        function: Path,
        /// The inputs it is differentiated by.
        variables: Vec<Ident>,
    },
}

/// `type A = PREFIX B[DIMS](MODIFICATION)`.
#[derive(Clone, Debug)]
pub struct ShortClass {
    /// `input`, `output`, `flow`... as written before the base.
    pub prefix: TypePrefix,
    /// The base class.
    pub base: Path,
    /// Array dimensions.
    pub dims: Vec<Subscript>,
    /// Modification of the base.
    pub modification: Option<Arc<Modification>>,
}

/// An enumeration literal.
#[derive(Clone, Debug)]
pub struct EnumLiteral {
    /// Its name.
    pub name: Ident,
    /// Its description.
    pub description: Option<Arc<str>>,
    /// Its annotation.
    pub annotation: Option<Arc<Modification>>,
}

/// The contents of a long class.
#[derive(Clone, Debug, Default)]
pub struct Composition {
    /// Modification of `model extends A(...)`; `Some` marks that form, even if it is empty.
    pub class_extends: Option<Option<Arc<Modification>>>,
    /// Declarations in order.
    pub elements: Vec<Element>,
    /// Equation sections in order.
    pub equations: Vec<EquationSection>,
    /// Algorithm sections in order.
    pub algorithms: Vec<AlgorithmSection>,
    /// `external ...`.
    pub external: Option<External>,
}

/// A declaration with the prefixes that stand before it.
#[derive(Clone, Debug)]
pub struct Element {
    /// Stands after `protected`.
    pub protected: bool,
    /// `redeclare`.
    pub redeclare: bool,
    /// `final`.
    pub is_final: bool,
    /// `inner`.
    pub inner: bool,
    /// `outer`.
    pub outer: bool,
    /// `replaceable`, with its constraint.
    pub replaceable: Option<Replaceable>,
    /// What is declared.
    pub kind: ElementKind,
    /// The whole element.
    pub span: Span,
}

impl Element {
    /// What it declares, with the places of the names.
    pub fn names(&self) -> Vec<(Name, Span)> {
        match &self.kind {
            ElementKind::Class(c) => vec![(c.name.name, c.name.span)],
            ElementKind::Components(clause) => {
                clause.components.iter().map(|c| (c.name.name, c.name.span)).collect()
            }
            ElementKind::Import(_) | ElementKind::Extends(_) => Vec::new(),
        }
    }
}

/// `replaceable ... constrainedby PATH(...)`.
#[derive(Clone, Debug, Default)]
pub struct Replaceable {
    /// The constraining class.
    pub constraint: Option<Path>,
    /// Its modification.
    pub modification: Option<Arc<Modification>>,
}

/// What an element declares.
#[derive(Clone, Debug)]
pub enum ElementKind {
    /// `import ...`
    Import(Import),
    /// `extends ...`
    Extends(Extends),
    /// One or more components of one type.
    Components(ComponentClause),
    /// A nested class.
    Class(Arc<Class>),
}

/// An import clause.
#[derive(Clone, Debug)]
pub struct Import {
    /// What is imported.
    pub path: Path,
    /// How.
    pub form: ImportForm,
}

/// The forms of import clauses.
#[derive(Clone, Debug)]
pub enum ImportForm {
    /// `import A.B;`
    Qualified,
    /// `import C = A.B;`
    Renamed(Ident),
    /// `import A.{B, C};`
    List(Vec<Ident>),
    /// `import A.*;`
    All,
}

/// An extends clause.
#[derive(Clone, Debug)]
pub struct Extends {
    /// The base class.
    pub base: Path,
    /// Its modification.
    pub modification: Option<Arc<Modification>>,
    /// Annotation.
    pub annotation: Option<Arc<Modification>>,
}

/// `parameter Real[3] a(start = 1) = 2 "..." if c, b;`
#[derive(Clone, Debug)]
pub struct ComponentClause {
    /// `parameter`, `flow`, `input`...
    pub prefix: TypePrefix,
    /// The type.
    pub type_name: Path,
    /// Dimensions written on the type: they come after those of the component.
    pub type_dims: Vec<Subscript>,
    /// The declared components.
    pub components: Vec<Component>,
}

/// One declared name.
#[derive(Clone, Debug)]
pub struct Component {
    /// Its name.
    pub name: Ident,
    /// Dimensions written on the name.
    pub dims: Vec<Subscript>,
    /// Modification and binding.
    pub modification: Option<Arc<Modification>>,
    /// `if CONDITION`.
    pub condition: Option<Arc<Expr>>,
    /// The description string.
    pub description: Option<Arc<str>>,
    /// Annotation.
    pub annotation: Option<Arc<Modification>>,
}

/// Prefixes of a type.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct TypePrefix {
    /// `flow` or `stream`.
    pub connection: Option<ConnectionPrefix>,
    /// `constant`, `parameter`, `discrete`.
    pub variability: Option<Variability>,
    /// `input` or `output`.
    pub causality: Option<Causality>,
}

/// `flow` or `stream`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ConnectionPrefix {
    /// `flow`
    Flow,
    /// `stream`
    Stream,
}

/// How fast a thing may change.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Variability {
    /// `constant`
    Constant,
    /// `parameter`
    Parameter,
    /// `discrete`
    Discrete,
    /// Without prefix.
    Continuous,
}

/// `input` or `output`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Causality {
    /// `input`
    Input,
    /// `output`
    Output,
}

/// `(args) = binding`; also the contents of `annotation(...)`.
#[derive(Clone, Debug)]
pub struct Modification {
    /// In parentheses.
    pub args: Vec<Argument>,
    /// After `=` (or `:=`, accepted in old code).
    pub binding: Option<Arc<Expr>>,
    /// The whole modification.
    pub span: Span,
}

impl Modification {
    /// The names of the elements that it modifies.
    pub fn names(&self) -> impl std::iter::Iterator<Item = &Ident> {
        self.args.iter().filter_map(|arg| match &arg.kind {
            ArgumentKind::Element { path, .. } => path.parts.first(),
            ArgumentKind::Redeclare(_) | ArgumentKind::Removal(_) => None,
        })
    }
}

/// One argument of a modification.
#[derive(Clone, Debug)]
pub struct Argument {
    /// `each`.
    pub each: bool,
    /// `final`.
    pub is_final: bool,
    /// What it does.
    pub kind: ArgumentKind,
    /// The whole argument.
    pub span: Span,
}

/// The forms of modification arguments.
#[derive(Clone, Debug)]
pub enum ArgumentKind {
    /// `a.b(...) = 1 "..."`.
    Element {
        /// The name, possibly dotted, without subscripts.
        path: Path,
        /// What is done to it.
        modification: Option<Arc<Modification>>,
        /// Description string.
        description: Option<Arc<str>>,
    },
    /// `redeclare T a(...)`, `replaceable T a(...)`, `redeclare model M = N(...)`.
    Redeclare(Arc<Element>),
    /// `break ...` in the modification of an extends clause.
    Removal(Removal),
}

/// What `break` leaves out of a base class (selective model extension, section 7.4).
#[derive(Clone, Debug)]
pub enum Removal {
    /// `break a`
    Element(Ident),
    /// `break connect(a, b)`
    Connection(ComponentRef, ComponentRef),
}

/// `equation` or `initial equation`.
#[derive(Clone, Debug)]
pub struct EquationSection {
    /// `initial equation`.
    pub initial: bool,
    /// In order.
    pub equations: Arc<[Equation]>,
}

/// `algorithm` or `initial algorithm`.
#[derive(Clone, Debug)]
pub struct AlgorithmSection {
    /// `initial algorithm`.
    pub initial: bool,
    /// In order.
    pub statements: Arc<[Statement]>,
    /// The whole section.
    pub span: Span,
}

/// `external "C" y = f(x) annotation(...)`.
#[derive(Clone, Debug)]
pub struct External {
    /// `"C"`, `"builtin"`...
    pub language: Option<Arc<str>>,
    /// The result.
    pub output: Option<ComponentRef>,
    /// The name called.
    pub function: Option<Ident>,
    /// Its arguments.
    pub args: Vec<Expr>,
    /// Annotation.
    pub annotation: Option<Arc<Modification>>,
    /// The clause.
    pub span: Span,
}

/// An equation.
#[derive(Clone, Debug)]
pub struct Equation {
    /// What it says.
    pub kind: EquationKind,
    /// The whole equation without the semicolon.
    pub span: Span,
    /// Description string.
    pub description: Option<Arc<str>>,
}

/// The forms of equations.
#[derive(Clone, Debug)]
pub enum EquationKind {
    /// `a = b`
    Equal(Expr, Expr),
    /// `if ... then ... elseif ... else ... end if`
    If {
        /// Conditions with their equations.
        branches: Vec<(Expr, Vec<Equation>)>,
        /// After `else`.
        otherwise: Vec<Equation>,
    },
    /// `for i in 1:3, j loop ... end for`
    For {
        /// Outermost first.
        iterators: Vec<Iterator>,
        /// The body.
        body: Vec<Equation>,
    },
    /// `when ... then ... elsewhen ... end when`
    When {
        /// Conditions with their equations.
        branches: Vec<(Expr, Vec<Equation>)>,
    },
    /// `connect(a, b)`
    Connect(ComponentRef, ComponentRef),
    /// `assert(...)`, `reinit(...)`, `terminate(...)`, `Connections.root(...)`...
    Call(Expr),
    /// Did not parse; already reported.
    Broken,
}

/// A statement of an algorithm.
#[derive(Clone, Debug)]
pub struct Statement {
    /// What it does.
    pub kind: StatementKind,
    /// The whole statement without the semicolon.
    pub span: Span,
}

/// The forms of statements.
#[derive(Clone, Debug)]
pub enum StatementKind {
    /// `a := b`
    Assign(ComponentRef, Expr),
    /// `(a, , b) := f(x)`
    AssignTuple(Vec<Option<ComponentRef>>, Expr),
    /// `f(x)`
    Call(Expr),
    /// `if`
    If {
        /// Conditions with their statements.
        branches: Vec<(Expr, Vec<Statement>)>,
        /// After `else`.
        otherwise: Vec<Statement>,
    },
    /// `for`
    For {
        /// Outermost first.
        iterators: Vec<Iterator>,
        /// The body.
        body: Vec<Statement>,
    },
    /// `while`
    While {
        /// Condition.
        condition: Expr,
        /// The body.
        body: Vec<Statement>,
    },
    /// `when`
    When {
        /// Conditions with their statements.
        branches: Vec<(Expr, Vec<Statement>)>,
    },
    /// `break`
    Break,
    /// `return`
    Return,
    /// Did not parse; already reported.
    Broken,
}

/// `i in 1:3`, or `i` alone.
#[derive(Clone, Debug)]
pub struct Iterator {
    /// The loop variable.
    pub name: Ident,
    /// What it runs over; without it the range is deduced from use.
    pub range: Option<Expr>,
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The forms of expressions.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// `1.5`
    Real(f64),
    /// `3`
    Integer(i64),
    /// `"text"`, escapes resolved
    String(Arc<str>),
    /// `true`, `false`
    Boolean(bool),
    /// `a.b[2].c`; also the name of `time`
    Ref(ComponentRef),
    /// `-a`, `not a`
    Unary(UnaryOp, Box<Expr>),
    /// `a + b`
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `if a then b elseif c then d else e`
    If {
        /// Conditions with their values.
        branches: Vec<(Expr, Expr)>,
        /// The value after `else`.
        otherwise: Box<Expr>,
    },
    /// `f(a, b = c)`; `der`, `initial`, `pre`... are calls as well
    Call {
        /// The function's name.
        function: ComponentRef,
        /// Positional arguments, in order.
        args: Vec<Expr>,
        /// Named arguments, in order.
        named: Vec<(Ident, Expr)>,
    },
    /// `f(e for i in r)`, a reduction
    Reduction {
        /// `sum`, `product`, `min`, `max`, `array`.
        function: ComponentRef,
        /// The reduced expression.
        body: Box<Expr>,
        /// Iterators, as written.
        iterators: Vec<Iterator>,
    },
    /// `{a, b}`
    Array(Vec<Expr>),
    /// `{e for i in r}`
    Comprehension {
        /// The element.
        body: Box<Expr>,
        /// Iterators, as written.
        iterators: Vec<Iterator>,
    },
    /// `[a, b; c, d]`
    Matrix(Vec<Vec<Expr>>),
    /// `a : b` or `a : step : b`
    Range {
        /// First value.
        start: Box<Expr>,
        /// Step, if written.
        step: Option<Box<Expr>>,
        /// Bound.
        stop: Box<Expr>,
    },
    /// `(a, , b)` with other than one entry, as on the left of a call
    Tuple(Vec<Option<Expr>>),
    /// `(a)`: kept so that the text can be printed as it was written
    Parenthesised(Box<Expr>),
    /// `(a)[1]`
    Indexed(Box<Expr>, Vec<Subscript>),
    /// `function f(a = 1)` as an argument
    PartialFunction {
        /// The function.
        function: Path,
        /// The bound arguments.
        named: Vec<(Ident, Expr)>,
    },
    /// `end` in a subscript
    End,
    /// `break` as the binding of a modification, `a = break`: the binding is removed (section 7.2.7)
    Break,
    /// Did not parse; already reported
    Broken,
}

/// `a.b[2].c`
#[derive(Clone, Debug)]
pub struct ComponentRef {
    /// Starts with a dot.
    pub global: bool,
    /// At least one.
    pub parts: Vec<RefPart>,
    /// The whole reference.
    pub span: Span,
}

/// One part of a component reference.
#[derive(Clone, Debug)]
pub struct RefPart {
    /// The name.
    pub name: Ident,
    /// Subscripts, if written.
    pub subscripts: Vec<Subscript>,
}

/// A subscript or a declared dimension.
#[derive(Clone, Debug)]
pub enum Subscript {
    /// `:`
    Colon(Span),
    /// An index, a range, a size; a type name such as `Boolean` is an expression as well.
    Expr(Expr),
}

/// Unary operators.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UnaryOp {
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `.+`
    ElementPlus,
    /// `.-`
    ElementMinus,
    /// `not`
    Not,
}

/// Binary operators.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `^`
    Pow,
    /// `.+`
    ElementAdd,
    /// `.-`
    ElementSub,
    /// `.*`
    ElementMul,
    /// `./`
    ElementDiv,
    /// `.^`
    ElementPow,
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `<>`
    NotEqual,
    /// `and`
    And,
    /// `or`
    Or,
}

impl ComponentRef {
    /// The name, if it is one identifier without subscripts and without a leading dot.
    pub fn simple(&self) -> Option<Name> {
        match self.parts.as_slice() {
            [one] if !self.global && one.subscripts.is_empty() => Some(one.name.name),
            _ => None,
        }
    }
}

impl std::fmt::Display for Path {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, part) in self.parts.iter().enumerate() {
            if i > 0 || self.global {
                f.write_str(".")?;
            }
            f.write_str(&part.name)?;
        }
        Ok(())
    }
}
