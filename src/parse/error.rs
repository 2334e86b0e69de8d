//! Errors of the lexer and the parser: codes MO0001 to MO0099.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::ast::Ident;
use crate::parse::token::TokenKind;

/// The construct that was being parsed when an error was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SyntaxContext {
    /// Classes of a file.
    Class,
    /// Elements of a class.
    Element,
    /// An equation section.
    Equation,
    /// An algorithm section.
    Statement,
    /// The condition between `if` and `then`, `for` and `loop`...
    Condition,
}

impl SyntaxContext {
    /// The construct as a noun phrase with its article.
    pub fn phrase(self) -> &'static str {
        match self {
            SyntaxContext::Class => "the class",
            SyntaxContext::Element => "the declaration",
            SyntaxContext::Equation => "the equation",
            SyntaxContext::Statement => "the statement",
            SyntaxContext::Condition => "the condition",
        }
    }
}

/// Limits that keep the syntax tree shallow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NestingLimit {
    /// Nesting of brackets.
    Brackets,
    /// Number of operators in one expression.
    Height,
    /// Nesting of classes, and of equations.
    Blocks,
}

/// Everything that can be wrong with a source file. Spans show where to repair it.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // the codes and messages below are the documentation
pub enum SyntaxError {
    Unexpected { span: Span, expected: String, found: String, help: Option<String> },
    Missing { at: Span, expected: String, found: String },
    UnexpectedEnd { span: Span, expected: String },
    MissingSemicolon { at: Span, after: SyntaxContext, found: String },
    UnclosedBracket { at: Span, open: Span, bracket: TokenKind },
    StrayBracket { span: Span, bracket: TokenKind },
    WrongEndName { class: Ident, found: Ident },
    UnclosedClass { class: Ident, found: Option<Ident> },
    UnclosedBlock { span: Span, open: Span, keyword: TokenKind, help: Option<String> },
    AssignmentAsEquation { operator: Span },
    ComparisonAsEquation { operator: Span },
    EqualsAsAssignment { operator: Span },
    LoneExpression { span: Span, wanted: &'static str },
    InvalidCharacter { span: Span, text: String },
    NonAscii { span: Span, text: String },
    ForeignOperator { span: Span, written: String, kind: TokenKind },
    UnterminatedString { span: Span },
    UnterminatedName { span: Span },
    UnterminatedComment { span: Span },
    TooDeep { span: Span, bound: NestingLimit },
    DoubledPrefix { span: Span },
    ExclusivePrefix { span: Span, other: &'static str },
    PrefixOrder { span: Span, prefix: &'static str, later: &'static str },
    MisplacedPrefix { span: Span, prefix: &'static str, what: &'static str },
    PositionalAfterNamed { span: Span, named: Ident },
    NotAssignable { span: Span },
    UnknownEscape { span: Span },
    Misspelt { span: Span, written: String, keyword: &'static str },
    NumberTooLarge { span: Span },
    FileTooLarge { span: Span },
    Doubled { span: Span, first: Span, what: &'static str },
    IdleConstraint { span: Span },
    LongRedeclaration { class: Ident },
    MissingRedeclare { at: Span, name: Ident },
}

fn err(code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(code, span, message)
}

impl From<SyntaxError> for Diagnostic {
    fn from(error: SyntaxError) -> Diagnostic {
        use SyntaxError::*;
        match error {
            Unexpected { span, expected, found, help } => {
                let d = err("MO0001", span, format!("expected {expected}, found {found}"));
                with_help(d.label("not expected here"), help)
            }
            Missing { at, expected, found } => {
                err("MO0001", at, format!("expected {expected}, found {found}"))
                    .label("something is missing here")
            }
            UnexpectedEnd { span, expected } => {
                err("MO0002", span, format!("expected {expected}, found the end of the file"))
            }
            MissingSemicolon { at, after, found } => {
                let after = after.phrase();
                err("MO0003", at, format!("expected `;` after {after}, found {found}"))
                    .label("`;` is missing here")
            }
            UnclosedBracket { at, open, bracket } => {
                let close = bracket.partner().unwrap_or(bracket).text();
                err("MO0004", at, format!("`{}` is not closed", bracket.text()))
                    .label(format!("`{close}` is missing here"))
                    .also(open, "opened here")
            }
            StrayBracket { span, bracket } => {
                err("MO0004", span, format!("`{}` closes nothing", bracket.text()))
                    .label("nothing is open here")
            }
            WrongEndName { class, found } => {
                let name = class.name;
                let message = format!("expected `end {name}`, found `end {}`", found.name);
                err("MO0005", found.span, message)
                    .label(format!("should be `{name}`"))
                    .also(class.span, "the class that ends here")
            }
            UnclosedClass { class, found } => {
                let name = class.name;
                let message = format!("class `{name}` is not closed");
                let d = match found {
                    Some(end) => err("MO0006", end.span, message)
                        .label(format!("`end {name};` is missing before this"))
                        .also(class.span, "the class that is not closed"),
                    None => err("MO0006", class.span, message).label("begins here"),
                };
                d.help(format!("add `end {name};`"))
            }
            UnclosedBlock { span, open, keyword, help } => {
                let end = keyword.text();
                let begin = end.strip_prefix("end ").unwrap_or(end);
                let d = err("MO0006", span, format!("`{begin}` is not closed"))
                    .label(format!("`{end};` expected before this"))
                    .also(open, "opened here");
                with_help(d, help)
            }
            AssignmentAsEquation { operator } => {
                err("MO0007", operator, "`:=` in an equation section").label("should be `=`").help(
                    "`=` states an equation; `:=` assigns and belongs to an `algorithm` section",
                )
            }
            ComparisonAsEquation { operator } => {
                err("MO0007", operator, "`==` compares; it does not state an equation")
                    .label("should be `=`")
            }
            EqualsAsAssignment { operator } => {
                err("MO0008", operator, "a statement of an algorithm assigns with `:=`")
                    .label("should be `:=`")
            }
            LoneExpression { span, wanted } => {
                err("MO0009", span, format!("expected {wanted}, found an expression"))
                    .label(format!("this alone is not {wanted}"))
            }
            InvalidCharacter { span, text } => {
                err("MO0010", span, format!("`{text}` has no meaning in Modelica"))
            }
            NonAscii { span, text } => {
                err("MO0010", span, format!("`{text}` has letters that names may not have"))
                    .help(format!("use letters a to z, or quote the name: `'{text}'`"))
            }
            ForeignOperator { span, written, kind } => {
                err("MO0011", span, format!("`{written}` is not an operator of Modelica"))
                    .label(format!("should be `{}`", kind.text()))
            }
            UnterminatedString { span } => err("MO0012", first_byte(span), "the string has no end")
                .label("begins here")
                .help("close it with `\"`"),
            UnterminatedName { span } => {
                err("MO0012", first_byte(span), "the quoted name has no end")
                    .label("begins here")
                    .help("close it with `'` on the same line")
            }
            UnterminatedComment { span } => {
                let begin = Span { end: span.start + 2, ..span };
                err("MO0013", begin, "the comment has no end")
                    .label("begins here")
                    .help("close it with `*/`")
            }
            TooDeep { span, bound } => {
                let what = match bound {
                    NestingLimit::Brackets => "brackets are nested too deeply",
                    NestingLimit::Height => "the expression is nested too deeply",
                    NestingLimit::Blocks => "classes or equations are nested too deeply",
                };
                err("MO0014", span, what).note("the rest of the file is not read")
            }
            DoubledPrefix { span } => err("MO0015", span, "the prefix is written twice"),
            ExclusivePrefix { span, other } => {
                err("MO0015", span, format!("the prefix excludes `{other}`"))
            }
            PrefixOrder { span, prefix, later } => {
                err("MO0015", span, format!("`{prefix}` must stand before `{later}`"))
            }
            MisplacedPrefix { span, prefix, what } => {
                err("MO0016", span, format!("`{prefix}` is not a prefix of {what}"))
            }
            PositionalAfterNamed { span, named } => {
                err("MO0017", span, "a positional argument stands after a named one")
                    .also(named.span, "the named argument")
            }
            NotAssignable { span } => err("MO0018", span, "only variables can be assigned to")
                .label("this is not a variable"),
            UnknownEscape { span } => err("MO0019", span, "unknown escape in a string")
                .help("write `\\\\` for a backslash"),
            Misspelt { span, written, keyword } => {
                err("MO0020", span, format!("`{written}` is not a keyword"))
                    .label(format!("did you mean `{keyword}`?"))
            }
            NumberTooLarge { span } => err("MO0021", span, "the number is too large")
                .note("the largest real number is about 1.8e308"),
            FileTooLarge { span } => err("MO0022", span, "the file is larger than 4 GB"),
            Doubled { span, first, what } => {
                err("MO0023", span, format!("a second {what}")).also(first, "the first")
            }
            IdleConstraint { span } => {
                err("MO0024", span, "`constrainedby` belongs to `replaceable` elements")
            }
            LongRedeclaration { class } => {
                err("MO0025", class.span, "a modification can not contain a whole class")
                    .help("declare the class elsewhere and write `redeclare ... = ...`")
            }
            MissingRedeclare { at, name } => {
                let message = format!("`{}` is declared inside a modification", name.name);
                err("MO0026", at, message)
                    .label("`redeclare` or `replaceable` is missing here")
                    .also(name.span, "declared here")
            }
        }
    }
}

fn with_help(diagnostic: Diagnostic, help: Option<String>) -> Diagnostic {
    match help {
        Some(text) => diagnostic.help(text),
        None => diagnostic,
    }
}

fn first_byte(span: Span) -> Span {
    Span { end: span.start + 1, ..span }
}
