//! From what the parser knows (a token it can not use, the tokens it could) to what a person wants
//! to hear: which bracket, which semicolon, which keyword.

use super::build::Builder;
use super::error::{Context, SyntaxError};
use super::grammar::Failure;
use super::token::{Kind, Token};
use crate::base::diag::did_you_mean;

/// How far back an explanation is looked for, in tokens.
const HORIZON: usize = 5000;

/// Keywords that begin a line of a class, and so are worth a "did you mean".
const LINE_KEYWORDS: &[&str] = &[
    "algorithm",
    "annotation",
    "block",
    "class",
    "connector",
    "constant",
    "discrete",
    "elseif",
    "elsewhen",
    "else",
    "encapsulated",
    "end",
    "equation",
    "extends",
    "external",
    "final",
    "flow",
    "function",
    "import",
    "initial",
    "inner",
    "input",
    "model",
    "outer",
    "output",
    "package",
    "parameter",
    "partial",
    "protected",
    "public",
    "record",
    "redeclare",
    "replaceable",
    "return",
    "stream",
    "type",
    "when",
    "while",
    "within",
];
/// Keywords that stand alone on their line.
const SECTION_KEYWORDS: &[&str] = &["algorithm", "else", "equation", "protected", "public"];

/// A token where the parser could not go on.
struct Obstacle<'e> {
    /// Its index; the number of tokens at the end of the file.
    at: usize,
    kind: Option<Kind>,
    expected: &'e [Kind],
    context: Context,
}

impl Obstacle<'_> {
    fn expects(&self, kind: Kind) -> bool {
        self.expected.contains(&kind)
    }
    /// No other token set contains numbers and parentheses.
    fn expects_expression(&self) -> bool {
        self.expects(Kind::LeftParen) && self.expects(Kind::Integer)
    }
}

impl Builder<'_> {
    /// Reports an error of the parser, unless it follows from one already reported.
    pub(super) fn syntax_error(&mut self, failure: Failure, context: Context) {
        let (start, kind, expected) = match failure {
            Failure::UnrecognizedToken { token: (start, kind, _), expected } => {
                (start, Some(kind), expected)
            }
            Failure::UnrecognizedEof { expected, .. } => (self.text.len() as u32, None, expected),
            Failure::User { error: (at, bound) } => {
                let span = self.span(at, at);
                self.report(SyntaxError::TooDeep { span, bound });
                return;
            }
            // Without a lexer of its own and with `$` after the start symbol, LALRPOP makes neither.
            Failure::InvalidToken { .. } | Failure::ExtraToken { .. } => return,
        };
        if start < self.quiet_until || self.exhausted() {
            return;
        }
        let at = self.tokens.partition_point(|t| t.start < start);
        self.quiet_until = match context {
            Context::Class => self.next_class(at),
            _ => self.resume_after(start),
        };
        if self.lexer_spoke_near(at) {
            return;
        }
        let expected: Vec<Kind> = expected.iter().filter_map(|t| Kind::of_terminal(t)).collect();
        let obstacle = Obstacle { at, kind, expected: &expected, context };
        let error = self
            .misspelt(&obstacle)
            .or_else(|| self.unclosed_at_end(&obstacle))
            .or_else(|| self.bracket(&obstacle))
            .or_else(|| self.unclosed_block(&obstacle));
        let error = match error {
            Some(error) => error,
            None if obstacle.kind.is_none() && self.unclosed_reported => return,
            None => self.semicolon(&obstacle).unwrap_or_else(|| self.unexpected(&obstacle)),
        };
        self.report(error);
    }

    /// Where reading resumes after an error at `offset`.
    pub(super) fn resume_after(&self, offset: u32) -> u32 {
        let from = self.tokens.partition_point(|t| t.start < offset);
        self.tokens[from..]
            .iter()
            .find(|t| t.kind == Kind::Semicolon || t.kind.starts_section())
            .map_or(u32::MAX, |t| if t.kind == Kind::Semicolon { t.end } else { t.start })
    }
    /// Where the next class begins: what stands before it is no class of the file.
    fn next_class(&self, at: usize) -> u32 {
        let class = |kind| {
            use Kind::*;
            matches!(kind, Class | Model | Block | Record | Connector | Type | Package | Function)
        };
        self.tokens[at.min(self.tokens.len())..]
            .windows(2)
            .find(|w| w[0].kind == Kind::Semicolon && class(w[1].kind))
            .map_or(u32::MAX, |w| w[1].start)
    }

    /// True if the lexer has already reported something at this token or just before it.
    fn lexer_spoke_near(&self, at: usize) -> bool {
        let begin = self.before(at).map_or(0, |t| t.start);
        let end = self.tokens.get(at).map_or(self.text.len() as u32, |t| t.end);
        let lexical = ["MO0010", "MO0011", "MO0012", "MO0013"];
        self.problems.iter().any(|p| {
            let place = p.primary.0;
            lexical.contains(&p.code)
                && place.file == self.file
                && (begin..=end).contains(&place.start)
        })
    }

    // ---- Causes, most telling first ----

    fn misspelt(&self, o: &Obstacle<'_>) -> Option<SyntaxError> {
        let suggest = |token: &Token, keywords: &[&'static str]| {
            let written = self.text(token.start, token.end);
            let keyword = did_you_mean(written, keywords.iter().copied())?;
            let span = self.span(token.start, token.end);
            (token.kind == Kind::Ident && written.len() >= 3).then(|| SyntaxError::Misspelt {
                span,
                written: written.into(),
                keyword,
            })
        };
        if let Some(token) = self.tokens.get(o.at) {
            let words: Vec<&'static str> = o
                .expected
                .iter()
                .map(|k| k.text())
                .filter(|t| Kind::KEYWORDS.contains(t))
                .collect();
            if let Some(error) = suggest(token, &words) {
                return Some(error);
            }
        }
        // The first word of the line that does not parse, followed by another word.
        let first = self.line_start(o.at);
        let words = &self.tokens[first..o.at.min(self.tokens.len())];
        if let [word, ..] = words
            && self.tokens.get(first + 1).is_some_and(|next| is_word(next.kind))
            && let Some(error) = suggest(word, LINE_KEYWORDS)
        {
            return Some(error);
        }
        // A section keyword some lines above: `equaton` was taken for a type.
        let above = self.tokens[o.at.saturating_sub(HORIZON)..self.tokens.len().min(o.at + 1)]
            .windows(3)
            .rev()
            .take_while(|w| !w[1].kind.starts_section());
        above
            .filter(|w| w[1].kind == Kind::Ident)
            .filter(|w| self.lines_between(&w[0], &w[1]) && self.lines_between(&w[1], &w[2]))
            .find_map(|w| suggest(&w[1], SECTION_KEYWORDS))
    }

    fn unclosed_at_end(&mut self, o: &Obstacle<'_>) -> Option<SyntaxError> {
        if o.kind.is_some() {
            return None;
        }
        let class = self.innermost_class()?;
        let first = !std::mem::replace(&mut self.unclosed_reported, true);
        first.then_some(SyntaxError::UnclosedClass { class, found: None })
    }

    fn bracket(&self, o: &Obstacle<'_>) -> Option<SyntaxError> {
        let open = self.open_bracket(o.at);
        match (open, o.kind) {
            (None, Some(kind)) if kind.closes() => {
                let token = self.tokens.get(o.at)?;
                let span = self.span(token.start, token.end);
                Some(SyntaxError::StrayBracket { span, bracket: kind })
            }
            (Some(open), kind) => {
                let close = open.kind.partner()?;
                let outside = kind.is_none_or(|k| {
                    k == Kind::Semicolon || k.closes() || k.starts_section() || is_outside(k)
                });
                (outside && o.expects(close)).then(|| SyntaxError::UnclosedBracket {
                    at: self.gap_before(o.at),
                    open: self.span(open.start, open.end),
                    bracket: open.kind,
                })
            }
            _ => None,
        }
    }

    fn unclosed_block(&self, o: &Obstacle<'_>) -> Option<SyntaxError> {
        let found = o.kind?;
        if !found.starts_section() {
            return None;
        }
        let ends = [Kind::EndIf, Kind::EndFor, Kind::EndWhen, Kind::EndWhile];
        let keyword = ends.into_iter().find(|end| o.expects(*end))?;
        let open = self.open_block(o.at, keyword)?;
        let at = self.tokens.get(o.at)?;
        let else_if = self.tokens[open..o.at]
            .windows(2)
            .any(|w| w[0].kind == Kind::Else && w[1].kind == Kind::If);
        let help = (keyword == Kind::EndIf && else_if)
            .then_some("`else if` opens another `if` with an `end if` of its own; write `elseif`");
        let open = self.tokens[open];
        Some(SyntaxError::UnclosedBlock {
            span: self.span(at.start, at.end),
            open: self.span(open.start, open.end),
            keyword,
            help: help.map(String::from),
        })
    }

    fn semicolon(&mut self, o: &Obstacle<'_>) -> Option<SyntaxError> {
        let before = *self.before(o.at)?;
        let incomplete = matches!(o.context, Context::Equation if o.expects(Kind::Equals))
            || matches!(o.context, Context::Statement if o.expects(Kind::Assign));
        let complete = !incomplete || before.kind == Kind::RightParen;
        if !o.expects(Kind::Semicolon) || !complete {
            return None;
        }
        let next = self.tokens.get(o.at).copied();
        let new_line = next.is_none_or(|t| self.lines_between(&before, &t));
        if !new_line && !next.is_some_and(|t| t.kind.starts_section()) {
            return None;
        }
        // What follows is read as a line of its own, and deserves its own messages.
        self.quiet_until = next.map_or(u32::MAX, |t| t.start);
        Some(SyntaxError::MissingSemicolon {
            at: self.gap_before(o.at),
            after: if before.kind == Kind::Ident && self.ends_class(o.at) {
                Context::Class
            } else {
                o.context
            },
            found: self.found(o.at),
        })
    }

    fn unexpected(&self, o: &Obstacle<'_>) -> SyntaxError {
        let expected = self.wanted(o);
        let Some(token) = self.tokens.get(o.at) else {
            let end = self.text.len() as u32;
            return SyntaxError::UnexpectedEnd { span: self.span(end, end), expected };
        };
        let forgotten = !o.expects_expression()
            && self.before(o.at).is_some_and(|before| {
                before.kind != Kind::Semicolon && self.lines_between(before, token)
            });
        if forgotten {
            let at = self.gap_before(o.at);
            return SyntaxError::Missing { at, expected, found: self.found(o.at) };
        }
        SyntaxError::Unexpected {
            span: self.span(token.start, token.end),
            expected,
            found: self.found(o.at),
            help: self.remedy(o, token.kind).map(String::from),
        }
    }

    /// Advice for well-known slips.
    fn remedy(&self, o: &Obstacle<'_>, found: Kind) -> Option<&'static str> {
        let before = self.before(o.at)?.kind;
        let sign = matches!(found, Kind::Plus | Kind::Minus | Kind::DotPlus | Kind::DotMinus);
        if o.expects_expression() && sign && before.is_arithmetic() {
            return Some("a sign after an operator needs parentheses, as in `a*(-b)`");
        }
        if found == Kind::Not && o.expects_expression() {
            return Some("put the negation in parentheses: `(not a)`");
        }
        if found == Kind::If && o.expects_expression() {
            return Some("put the if-expression in parentheses");
        }
        if o.expects_expression() {
            return None;
        }
        if matches!(found, Kind::Caret | Kind::DotCaret) && !o.expects(found) {
            return Some("powers do not chain: write `(a^b)^c` or `a^(b^c)`");
        }
        if found.is_relation() && !o.expects(found) {
            return Some("relations do not chain: write `a < b and b < c`");
        }
        if found == Kind::Equals && o.expects(Kind::Then) {
            return Some("`==` compares");
        }
        if found == Kind::Assign && o.expects(Kind::Then) {
            return Some("`==` compares, `:=` assigns");
        }
        (found == Kind::Else && before == Kind::Semicolon && o.expects(Kind::ElseWhen))
            .then_some("a `when` has `elsewhen`, but no `else`")
    }

    // ---- Words ----

    /// What could stand here, in at most three alternatives.
    fn wanted(&self, o: &Obstacle<'_>) -> String {
        let line_start = o.expects(Kind::End) || o.expects(Kind::EndIf) || o.expects(Kind::EndFor);
        let line_start = line_start || o.expects(Kind::EndWhen) || o.expects(Kind::EndWhile);
        let mut words: Vec<String> = Vec::new();
        let quoted = |k: Kind| format!("`{}`", k.text());
        if line_start && o.expects(Kind::Ident) {
            words.push(match o.context {
                Context::Class | Context::Element | Context::Head => "a declaration".into(),
                Context::Equation => "an equation".into(),
                Context::Statement => "a statement".into(),
            });
            let ends = [Kind::EndIf, Kind::EndFor, Kind::EndWhen, Kind::EndWhile, Kind::End];
            words.extend(ends.into_iter().filter(|k| o.expects(*k)).take(1).map(quoted));
            return words.join(" or ");
        }
        if o.expects(Kind::Model) && o.expects(Kind::Package) && !o.expects(Kind::Ident) {
            return "a class, such as `model` or `package`".into();
        }
        if o.expects_expression() {
            words.push("an expression".into());
        } else if o.expects(Kind::Ident) {
            let name = match () {
                () if o.expects(Kind::Each) && self.open_bracket(o.at).is_some() => {
                    "a modification"
                }
                () if o.expects(Kind::Parameter) => "a declaration",
                () => "a name",
            };
            words.push(name.into());
        }
        let structural = [
            Kind::Then,
            Kind::Loop,
            Kind::Semicolon,
            Kind::Assign,
            Kind::Equals,
            Kind::RightParen,
            Kind::RightBracket,
            Kind::RightBrace,
            Kind::In,
            Kind::Comma,
        ];
        let incomplete = o.context == Context::Equation && o.expects(Kind::Equals)
            || o.context == Context::Statement && o.expects(Kind::Assign);
        let fitting = structural.into_iter().filter(|k| o.expects(*k));
        // `=` says more than `;` where an equation is not yet one; not both.
        let fitting = fitting
            .filter(|k| !incomplete || *k != Kind::Semicolon)
            .filter(|k| {
                *k != Kind::Equals || !matches!(o.context, Context::Statement | Context::Element)
            })
            .filter(|k| *k != Kind::Assign || o.context == Context::Statement);
        words.extend(fitting.take(3 - words.len()).map(quoted));
        let operators = o.expects(Kind::Plus) && !o.expects_expression();
        if operators && words.len() < 3 && o.kind.is_some_and(starts_operand) {
            words.push("an operator".into());
        }
        if words.is_empty() {
            words.extend(o.expected.iter().take(3).map(|k| phrase(*k)));
        }
        match words.as_slice() {
            [] => "something else".into(),
            [one] => one.clone(),
            [init @ .., last] => format!("{} or {last}", init.join(", ")),
        }
    }

    /// The token as the user wrote it.
    fn found(&self, at: usize) -> String {
        match self.tokens.get(at) {
            None => "the end of the file".into(),
            Some(t) if t.kind == Kind::String => "a string".into(),
            Some(t) if t.kind == Kind::Ident && t.end - t.start > 40 => "a name".into(),
            Some(t) => {
                let text = self.text(t.start, t.end);
                format!("`{}`", text.split_whitespace().collect::<Vec<_>>().join(" "))
            }
        }
    }

    // ---- Looking around ----

    fn before(&self, at: usize) -> Option<&Token> {
        self.tokens.get(at.checked_sub(1)?)
    }
    /// The place right after the token before this one.
    fn gap_before(&self, at: usize) -> crate::base::source::Span {
        let end = self.before(at).map_or(0, |t| t.end);
        self.span(end, end)
    }
    fn lines_between(&self, left: &Token, right: &Token) -> bool {
        self.text(left.end, right.start).contains('\n')
    }
    /// Index of the first token of the line or statement this token belongs to.
    fn line_start(&self, at: usize) -> usize {
        let at = at.min(self.tokens.len());
        (1..=at.min(self.tokens.len().saturating_sub(1)))
            .rev()
            .find(|&i| {
                let before = &self.tokens[i - 1];
                before.kind == Kind::Semicolon || self.lines_between(before, &self.tokens[i])
            })
            .unwrap_or(0)
    }
    /// True if the tokens before are `end A`.
    fn ends_class(&self, at: usize) -> bool {
        at >= 2 && self.tokens[at - 2].kind == Kind::End
    }
    /// The innermost bracket that is open before this token.
    fn open_bracket(&self, at: usize) -> Option<Token> {
        let mut depth = 0;
        let mut matrix = false;
        let from = at.saturating_sub(HORIZON);
        for token in self.tokens[from..at.min(self.tokens.len())].iter().rev() {
            if token.kind.closes() {
                depth += 1;
            } else if token.kind.opens() {
                if depth == 0 {
                    return (!matrix || token.kind == Kind::LeftBracket).then_some(*token);
                }
                depth -= 1;
            } else if token.kind.starts_section() {
                return None;
            } else if token.kind == Kind::Semicolon && depth == 0 {
                // Only matrices contain semicolons.
                matrix = true;
            }
        }
        None
    }
    /// Index of the keyword that opened the innermost open block with this end.
    fn open_block(&self, at: usize, end: Kind) -> Option<usize> {
        let opener = match end {
            Kind::EndIf => Kind::If,
            Kind::EndFor => Kind::For,
            Kind::EndWhen => Kind::When,
            _ => Kind::While,
        };
        let mut depth = 0;
        for i in (1..at.min(self.tokens.len())).rev().take(HORIZON) {
            let (kind, before) = (self.tokens[i].kind, self.tokens[i - 1].kind);
            let begins_line = before == Kind::Semicolon
                || before.starts_section()
                || matches!(before, Kind::Then | Kind::Else | Kind::Loop);
            if kind == end {
                depth += 1;
            } else if kind == opener && begins_line {
                if depth == 0 {
                    return Some(i);
                }
                depth -= 1;
            }
        }
        None
    }
}

fn is_word(kind: Kind) -> bool {
    kind == Kind::Ident || Kind::KEYWORDS.contains(&kind.text())
}

/// Keywords that no bracket contains.
fn is_outside(kind: Kind) -> bool {
    matches!(kind, Kind::Then | Kind::Loop | Kind::Annotation)
}

/// Tokens with which an operand begins: before them an operator may be missing.
fn starts_operand(kind: Kind) -> bool {
    matches!(kind, Kind::Ident | Kind::Integer | Kind::Real | Kind::LeftParen | Kind::LeftBrace)
}

fn phrase(kind: Kind) -> String {
    match kind {
        Kind::Ident => "a name".into(),
        Kind::Integer | Kind::Real => "a number".into(),
        Kind::String => "a string".into(),
        Kind::EndValue => "`end`".into(),
        other => format!("`{}`", other.text()),
    }
}

#[cfg(test)]
mod tests {
    use crate::base::diag::Problems;
    use crate::base::render::{Style, render_all};
    use crate::base::source::SourceMap;
    use crate::parse::grammar::parse;

    /// The codes of the errors in order, and the text with its rendered errors.
    fn check(text: &str) -> (Vec<&'static str>, String) {
        let mut sources = SourceMap::default();
        let file = sources.add("a.mo", text);
        let mut problems = Problems::new();
        parse(file, text, &mut problems);
        let codes = problems.sorted().iter().map(|p| p.code).collect();
        (codes, format!("{text}\n----\n{}", render_all(&problems, &sources, Style::Plain)))
    }
    macro_rules! said {
        ($name:literal, $codes:expr, $text:expr) => {
            let (codes, page) = check($text);
            assert_eq!(codes, $codes, "{page}");
            insta::assert_snapshot!($name, page);
        };
    }

    #[test]
    fn semicolons() {
        said!(
            "semicolons",
            ["MO0003", "MO0003", "MO0003"],
            "model A\n  Real x\n  Real y;\nequation\n  x = 1\n  y = 2;\nend A\nmodel B end B;"
        );
    }
    #[test]
    fn brackets() {
        said!(
            "brackets",
            ["MO0004", "MO0004", "MO0004", "MO0004"],
            "model A\n  Real x(start = 1;\nequation\n  x = (1 + 2*(y - 3);\n  y = sin(x));\n  x = {1, 2;\nend A;"
        );
    }
    #[test]
    fn misspelt_keywords() {
        said!(
            "misspelt_keywords",
            ["MO0020", "MO0020", "MO0020"],
            "model A\n  paramter Real x = 1;\nequaton\n  der(y) = x;\n  whenn x > 1 then\n    y = 2;\n  end when;\nend A;"
        );
        assert_eq!(check("modle A\n  Real x;\nend A;").0, ["MO0020"]);
    }
    #[test]
    fn ends() {
        said!(
            "ends",
            ["MO0005", "MO0006"],
            "package P\n  model A\n  end B;\n  model C\n    Real y;\nend P;"
        );
        assert_eq!(check("package P\n  model A\n    Real x;").0, ["MO0006"]);
    }
    #[test]
    fn equality_and_assignment() {
        said!(
            "equality",
            ["MO0007", "MO0007", "MO0009", "MO0001", "MO0008", "MO0008", "MO0018"],
            "model A\nequation\n  x := 1;\n  x == y;\n  x + y;\n  if a = b then\n    x = 1;\n  end if;\n\
             algorithm\n  x = 2;\n  x == 2;\n  x + 1 := 3;\nend A;"
        );
    }
    #[test]
    fn else_if() {
        said!(
            "else_if",
            ["MO0006"],
            "model A\nequation\n  if a then\n    x = 1;\n  else if b then\n    x = 2;\n  end if;\nend A;"
        );
    }
    #[test]
    fn operators() {
        said!(
            "operators",
            ["MO0011", "MO0011", "MO0001", "MO0001", "MO0001"],
            "model A\n  Boolean c = a != b && d;\nequation\n  x = a * -b;\n  x = a^b^c;\n  c = a < b < d;\nend A;"
        );
    }
    #[test]
    fn one_message_for_each_broken_line() {
        said!(
            "broken_lines",
            ["MO0001"; 6],
            "model A\n  Real 3x;\n  Real x y;\nequation\n  x = ;\n  x y = 2;\n  connect(a, );\nalgorithm\n  \
             while x > 1 then\n    x := 2;\n  end while;\nend A;"
        );
    }
    #[test]
    fn unterminated_text_is_said_once() {
        for (text, code) in [
            ("model A \"text\n  Real x;\nend A;", "MO0012"),
            ("model A\n  Real x; /* c\nend A;", "MO0013"),
        ] {
            assert_eq!(check(text).0, [code]);
        }
    }
}
