//! Errors of the lexer and the parser: codes MO0001 to MO0059.

use std::fmt;

use crate::base::cause::causes;
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

impl fmt::Display for SyntaxContext {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SyntaxContext::Class => "the class",
            SyntaxContext::Element => "the declaration",
            SyntaxContext::Equation => "the equation",
            SyntaxContext::Statement => "the statement",
            SyntaxContext::Condition => "the condition",
        })
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

impl fmt::Display for NestingLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NestingLimit::Brackets => "brackets are nested too deeply",
            NestingLimit::Height => "the expression is nested too deeply",
            NestingLimit::Blocks => "classes or equations are nested too deeply",
        })
    }
}

causes! {
    /// Causes found by the lexer and the parser.
    pub enum SyntaxCause {
        /// Another token is expected here.
        error MO0001 UnexpectedToken { expected: String, found: String, advice: Option<&'static str> }
            => ("expected {expected}, found {found}"), remedy(advice.map(str::to_owned));
        /// The file ends too early.
        error MO0002 UnexpectedEnd { expected: String }
            => ("expected {expected}, found the end of the file");
        /// A semicolon is missing.
        error MO0003 MissingSemicolon { after: SyntaxContext, found: String }
            => ("expected `;` after {after}, found {found}");
        /// An opening bracket has no closing one.
        error MO0004 UnclosedBracket { bracket: &'static str }
            => ("`{bracket}` is not closed");
        /// The name after `end` is not that of the class.
        error MO0005 WrongEndName { name: String, found: String }
            => ("expected `end {name}`, found `end {found}`");
        /// A class has no `end`.
        error MO0006 UnclosedClass { name: String }
            => ("class `{name}` is not closed"), help("add `end {name};`");
        /// An equation section contains an assignment.
        error MO0007 AssignmentAsEquation
            => ("expected `=` in an equation, found `:=`"),
            help("`=` states an equation; `:=` assigns and belongs to an `algorithm` section");
        /// An algorithm section contains an equation or a comparison.
        error MO0008 EqualsAsAssignment { found: &'static str }
            => ("expected `:=` in a statement, found `{found}`");
        /// An expression is neither an equation nor a statement.
        error MO0009 LoneExpression { wanted: &'static str }
            => ("expected {wanted}, found an expression");
        /// A character does not belong to the language.
        error MO0010 InvalidCharacter { text: String }
            => ("unknown character `{text}`"),
            remedy((text == "?").then(|| "write `if condition then a else b`".to_owned()));
        /// An operator of another programming language.
        error MO0011 ForeignOperator { written: String }
            => ("`{written}` is not an operator of Modelica");
        /// A string is not closed.
        error MO0012 UnterminatedString
            => ("unterminated string"), help("close it with `\"`");
        /// A comment is not closed.
        error MO0013 UnterminatedComment
            => ("unterminated comment"), help("close it with `*/`");
        /// Brackets, expressions, classes or equations are nested too deeply.
        error MO0014 TooDeep { limit: NestingLimit }
            => ("{limit}");
        /// The prefixes of a declaration are in the wrong order.
        error MO0015 PrefixOrder { prefix: &'static str, later: &'static str } (section "A.2.4")
            => ("`{prefix}` must precede `{later}`");
        /// A prefix is not allowed for this kind of element.
        error MO0016 MisplacedPrefix { prefix: &'static str, element: &'static str }
            => ("`{prefix}` cannot be a prefix of {element}");
        /// A positional argument follows a named one.
        error MO0017 PositionalAfterNamed (section "12.4.1")
            => ("a positional argument follows a named one");
        /// The left side of an assignment is not a variable.
        error MO0018 NotAssignable
            => ("cannot assign to an expression"), help("write a variable to the left of `:=`");
        /// A string contains an unknown escape sequence.
        error MO0019 UnknownEscape { escaped: char } (section "2.4.4")
            => ("unknown escape `\\{escaped}` in a string"), help("write `\\\\` for a backslash");
        /// A keyword is misspelled.
        error MO0020 Misspelled { written: String }
            => ("unknown keyword `{written}`");
        /// A number exceeds the range of a `Real`.
        error MO0021 NumberTooLarge
            => ("the number is too large");
        /// A file is too large to be read.
        error MO0022 FileTooLarge
            => ("the file is larger than 4 GB");
        /// A clause of a class occurs twice.
        error MO0023 DuplicateClause { clause: &'static str }
            => ("duplicate {clause}");
        /// An element has a constraining type, but cannot be redeclared.
        error MO0024 IneffectiveConstraint (section "7.3.2")
            => ("`constrainedby` requires `replaceable` or `redeclare`"),
            help("add `replaceable`, or remove the constraining type");
        /// A modification contains a class with a body.
        error MO0025 LongRedeclaration (section "7.2.1")
            => ("a modification cannot contain a class with a body"),
            help("declare the class elsewhere and write `redeclare ... = ...`");
        /// A modification contains a declaration that redeclares nothing.
        error MO0026 MissingRedeclare { name: String } (section "7.2.1")
            => ("cannot declare `{name}` inside a modification");
        /// A closing bracket has no opening one.
        error MO0030 StrayBracket { bracket: &'static str }
            => ("unmatched `{bracket}`");
        /// An `if`, `for`, `when` or `while` has no `end`.
        error MO0031 UnclosedBlock { keyword: &'static str, advice: Option<&'static str> }
            => ("`{keyword}` is not closed"), remedy(advice.map(str::to_owned));
        /// An equation section contains a comparison.
        error MO0032 ComparisonAsEquation
            => ("expected `=` in an equation, found `==`"),
            help("`=` states an equation; `==` compares two values");
        /// A name contains letters other than a to z.
        error MO0033 NonAsciiName { text: String } (section "2.3.1")
            => ("name `{text}` contains letters outside of ASCII"),
            help("use letters a to z, or quote the name: `'{text}'`");
        /// A quoted name is not closed.
        error MO0034 UnterminatedName
            => ("unterminated quoted name"), help("close it with `'` on the same line");
        /// A declaration has the same prefix twice.
        error MO0035 DuplicatePrefix { prefix: &'static str }
            => ("duplicate prefix `{prefix}`"), help("remove one of them");
        /// A declaration has two prefixes that exclude each other.
        error MO0036 ExclusivePrefixes { prefix: &'static str, other: &'static str } (section "A.2.4")
            => ("cannot combine `{prefix}` with `{other}`"), help("remove one of them");
        /// A number has a decimal comma.
        error MO0037 DecimalComma { written: String, wanted: String } (section "2.4.1")
            => ("`{written}` has a decimal comma"), help("write `{wanted}`");
        /// A keyword stands where a declaration needs a name.
        error MO0038 KeywordAsName { keyword: &'static str } (section "2.3.3")
            => ("`{keyword}` is a keyword, and cannot be the name of a component"),
            help("choose another name, such as `{keyword}_1`, or quote it: `'{keyword}'`");
    }
}

/// A bracket opened at `open` should have been closed at `at`.
pub fn unclosed_bracket(at: Span, open: Span, bracket: TokenKind) -> Diagnostic {
    let close = bracket.partner().unwrap_or(bracket).text();
    Diagnostic::new(SyntaxCause::UnclosedBracket { bracket: bracket.text() }, at)
        .label(format!("`{close}` is missing here"))
        .also(open, "opened here")
}

/// A class without an `end`; `found` is the name after the `end` of another class.
pub fn unclosed_class(class: Ident, found: Option<Ident>) -> Diagnostic {
    let cause = SyntaxCause::UnclosedClass { name: class.name.to_string() };
    match found {
        Some(end) => Diagnostic::new(cause, end.span)
            .label(format!("`end {};` is missing before this", class.name))
            .also(class.span, "the class that is not closed"),
        None => Diagnostic::new(cause, class.span).label("begins here"),
    }
}

/// `end B` at the end of class `A`.
pub fn wrong_end_name(class: Ident, found: Ident) -> Diagnostic {
    let (name, written) = (class.name.to_string(), found.name.to_string());
    Diagnostic::new(SyntaxCause::WrongEndName { name, found: written }, found.span)
        .label(format!("should be `{}`", class.name))
        .also(class.span, "the class that ends here")
}

/// A block opened at `open` whose `end` should precede `at`.
pub fn unclosed_block(
    at: Span,
    open: Span,
    end: TokenKind,
    advice: Option<&'static str>,
) -> Diagnostic {
    let end = end.text();
    let keyword = end.strip_prefix("end ").unwrap_or(end);
    Diagnostic::new(SyntaxCause::UnclosedBlock { keyword, advice }, at)
        .label(format!("`{end};` expected before this"))
        .also(open, "opened here")
}

/// `=` or `==` in a statement that should assign.
pub fn equals_as_assignment(found: &'static str, operator: Span) -> Diagnostic {
    Diagnostic::new(SyntaxCause::EqualsAsAssignment { found }, operator).label("should be `:=`")
}

/// A limit of the syntax tree is exceeded.
pub fn too_deep(limit: NestingLimit, span: Span) -> Diagnostic {
    Diagnostic::new(SyntaxCause::TooDeep { limit }, span).note("the rest of the file is not read")
}

/// Something that begins at `span` and has no end.
pub fn unterminated(cause: SyntaxCause, span: Span, opening: u32) -> Diagnostic {
    Diagnostic::new(cause, Span { end: span.start + opening, ..span }).label("begins here")
}
