//! Turns a parser error (an unexpected token and the set of expected ones) into its likely cause:
//! an unclosed bracket, a missing semicolon, a misspelled keyword.

mod expectation;
mod surroundings;

use crate::base::diag::{Diagnostic, did_you_mean};
use crate::parse::build::Builder;
use crate::parse::error::{
    SyntaxCause, SyntaxContext, too_deep, unclosed_block, unclosed_bracket, unclosed_class,
    unterminated,
};
use crate::parse::grammar::ParseError;
use crate::parse::token::{Token, TokenKind};

/// Number of preceding tokens that are searched for a cause.
const HORIZON: usize = 5000;

/// Number of tokens before an error among which a string over lines is its cause.
const STRING_HORIZON: usize = 4;

/// Keywords that begin a line of a class: the candidates for "did you mean".
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

/// The token at which the parser failed.
struct Obstacle<'e> {
    /// Its index; the number of tokens at the end of the file.
    at: usize,
    kind: Option<TokenKind>,
    expected: &'e [TokenKind],
    context: SyntaxContext,
}

impl Obstacle<'_> {
    fn expects(&self, kind: TokenKind) -> bool {
        self.expected.contains(&kind)
    }
    /// Only the token set of an expression contains both numbers and parentheses.
    fn expects_expression(&self) -> bool {
        self.expects(TokenKind::LeftParen) && self.expects(TokenKind::Integer)
    }
}

impl Builder<'_> {
    /// Reports an error of the parser unless it is a consequence of one already reported.
    pub(super) fn syntax_error(&mut self, failure: ParseError, context: SyntaxContext) {
        let (start, kind, expected) = match failure {
            ParseError::UnrecognizedToken { token: (start, kind, _), expected } => {
                (start, Some(kind), expected)
            }
            ParseError::UnrecognizedEof { expected, .. } => {
                (self.text.len() as u32, None, expected)
            }
            ParseError::User { error: (at, limit) } => {
                let span = self.span(at, at);
                self.report(too_deep(limit, span));
                return;
            }
            // LALRPOP returns neither: it has no lexer of its own, and `$` follows the start
            // symbol.
            ParseError::InvalidToken { .. } | ParseError::ExtraToken { .. } => return,
        };
        if start < self.quiet_until || self.exhausted() {
            return;
        }
        let at = self.tokens.partition_point(|t| t.start < start);
        self.quiet_until = match context {
            SyntaxContext::Class => self.next_class(at),
            _ => self.resume_after(start),
        };
        if let Some(string) = self.string_over_lines(at) {
            self.report_string(string);
            return;
        }
        if self.lexer_reported_near(at) {
            return;
        }
        let expected: Vec<TokenKind> =
            expected.iter().filter_map(|t| TokenKind::of_terminal(t)).collect();
        let obstacle = Obstacle { at, kind, expected: &expected, context };
        let error = self
            .decimal_comma(&obstacle)
            .or_else(|| self.keyword_as_name(&obstacle))
            .or_else(|| self.misspelled(&obstacle))
            .or_else(|| self.unclosed_at_end(&obstacle))
            .or_else(|| self.bracket(&obstacle))
            .or_else(|| self.unclosed_block(&obstacle));
        let error = match error {
            Some(error) => error,
            None if obstacle.kind.is_none() && self.unclosed_reported => return,
            None => self.semicolon(&obstacle).unwrap_or_else(|| self.unexpected(&obstacle)),
        };
        if error.is(|cause: &SyntaxCause| matches!(cause, SyntaxCause::KeywordAsName { .. })) {
            // What the parser makes of the class after an `end` that is none follows from it.
            if obstacle.kind == Some(TokenKind::End) {
                self.quiet_until = u32::MAX;
            }
        }
        self.report(error);
    }

    /// The offset at which parsing resumes after an error at `offset`.
    pub(super) fn resume_after(&self, offset: u32) -> u32 {
        let from = self.tokens.partition_point(|t| t.start < offset);
        self.tokens[from..]
            .iter()
            .find(|t| t.kind == TokenKind::Semicolon || t.kind.starts_section())
            .map_or(u32::MAX, |t| if t.kind == TokenKind::Semicolon { t.end } else { t.start })
    }
    /// The offset at which the next top-level class begins.
    fn next_class(&self, at: usize) -> u32 {
        let class = |kind| {
            use TokenKind::*;
            matches!(kind, Class | Model | Block | Record | Connector | Type | Package | Function)
        };
        self.tokens[at.min(self.tokens.len())..]
            .windows(2)
            .find(|w| w[0].kind == TokenKind::Semicolon && class(w[1].kind))
            .map_or(u32::MAX, |w| w[1].start)
    }

    /// True if the lexer has already reported something at this token or just before it.
    fn lexer_reported_near(&self, at: usize) -> bool {
        let begin = self.before(at).map_or(0, |t| t.start);
        let end = self.tokens.get(at).map_or(self.text.len() as u32, |t| t.end);
        self.problems.iter().any(|p| {
            let place = p.primary.0;
            p.is(is_lexical) && place.file == self.file && (begin..=end).contains(&place.start)
        })
    }

    // ---- Causes, most specific first ----

    /// A string just before this token that extends over lines, if a later one has no end: then it
    /// is this one that is not closed, and all quotes after it are taken for the opposite.
    fn string_over_lines(&self, at: usize) -> Option<Token> {
        let is_unclosed = |p: &Diagnostic| {
            p.primary.0.file == self.file
                && p.is(|cause: &SyntaxCause| matches!(cause, SyntaxCause::UnterminatedString))
        };
        let near = self.tokens.get(at.saturating_sub(STRING_HORIZON)..at.min(self.tokens.len()))?;
        let over_lines =
            |t: &&Token| t.kind == TokenKind::String && self.text(t.start, t.end).contains('\n');
        let string = near.iter().rev().find(over_lines)?;
        self.problems.iter().any(is_unclosed).then_some(*string)
    }

    /// Reports a string that is not closed on its line, and nothing else of the file after it.
    fn report_string(&mut self, string: Token) {
        let file = self.file;
        self.problems.remove(|p| p.primary.0.file == file && p.is(is_lexical));
        let first_line = self.text(string.start, string.end).lines().next().map_or(0, str::len);
        let span = self.span(string.start, string.start + first_line as u32);
        self.report(unterminated(SyntaxCause::UnterminatedString, span, 1));
        self.quiet_until = u32::MAX;
        self.unclosed_reported = true;
    }

    /// `12,5`
    fn decimal_comma(&self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        let [whole, comma, fraction] = *self.tokens.get(o.at.checked_sub(2)?..=o.at)? else {
            return None;
        };
        let adjacent = whole.end == comma.start && comma.end == fraction.start;
        let is_number = |t: Token| matches!(t.kind, TokenKind::Integer | TokenKind::Real);
        if !adjacent || comma.kind != TokenKind::Comma || !is_number(whole) || !is_number(fraction)
        {
            return None;
        }
        let written = self.text(whole.start, fraction.end).to_owned();
        let wanted = written.replacen(',', ".", 1);
        let span = self.span(whole.start, fraction.end);
        let cause = SyntaxCause::DecimalComma { written, wanted };
        Some(Diagnostic::new(cause, span).label("the comma separates two values"))
    }

    /// `Real model;`
    fn keyword_as_name(&self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        let (token, before) = (*self.tokens.get(o.at)?, *self.before(o.at)?);
        let keyword = token.kind.text();
        let wants_name = o.expects(TokenKind::Ident)
            && !o.expects_expression()
            && !o.expects(TokenKind::Parameter);
        let after_type = matches!(before.kind, TokenKind::Ident | TokenKind::RightBracket);
        let next = self.tokens.get(o.at + 1).map(|t| t.kind);
        let is_declared = matches!(
            next,
            Some(
                TokenKind::Semicolon
                    | TokenKind::Equals
                    | TokenKind::LeftParen
                    | TokenKind::LeftBracket
                    | TokenKind::Comma
                    | TokenKind::String
            )
        );
        let is_keyword = TokenKind::KEYWORDS.contains(&keyword);
        let same_line = !self.lines_between(&before, &token);
        (is_keyword && wants_name && after_type && is_declared && same_line).then(|| {
            let span = self.span(token.start, token.end);
            Diagnostic::new(SyntaxCause::KeywordAsName { keyword }, span).label("a keyword")
        })
    }

    fn misspelled(&self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        let suggest = |token: &Token, keywords: &[&'static str]| {
            let written = self.text(token.start, token.end);
            let keyword = did_you_mean(written, keywords.iter().copied())?;
            let span = self.span(token.start, token.end);
            (token.kind == TokenKind::Ident && written.len() >= 3).then(|| {
                Diagnostic::new(SyntaxCause::Misspelled { written: written.into() }, span)
                    .label(format!("did you mean `{keyword}`?"))
            })
        };
        if let Some(token) = self.tokens.get(o.at) {
            let words: Vec<&'static str> = o
                .expected
                .iter()
                .map(|k| k.text())
                .filter(|t| TokenKind::KEYWORDS.contains(t))
                .collect();
            if let Some(error) = suggest(token, &words) {
                return Some(error);
            }
        }
        // The first word of the line with the error, followed by another word.
        let first = self.line_start(o.at);
        let words = &self.tokens[first..o.at.min(self.tokens.len())];
        if let [word, ..] = words
            && self.tokens.get(first + 1).is_some_and(|next| is_word(next.kind))
            && let Some(error) = suggest(word, LINE_KEYWORDS)
        {
            return Some(error);
        }
        // A section keyword some lines above: `equaton` was parsed as a type.
        let above = self.tokens[o.at.saturating_sub(HORIZON)..self.tokens.len().min(o.at + 1)]
            .windows(3)
            .rev()
            .take_while(|w| !w[1].kind.starts_section());
        above
            .filter(|w| w[1].kind == TokenKind::Ident)
            .filter(|w| self.lines_between(&w[0], &w[1]) && self.lines_between(&w[1], &w[2]))
            .find_map(|w| suggest(&w[1], SECTION_KEYWORDS))
    }

    fn unclosed_at_end(&mut self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        if o.kind.is_some() {
            return None;
        }
        let class = self.innermost_class()?;
        let first = !std::mem::replace(&mut self.unclosed_reported, true);
        first.then(|| unclosed_class(class, None))
    }

    fn bracket(&self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        let open = self.open_bracket(o.at);
        match (open, o.kind) {
            (None, Some(kind)) if kind.closes() => {
                let token = self.tokens.get(o.at)?;
                let span = self.span(token.start, token.end);
                let cause = SyntaxCause::StrayBracket { bracket: kind.text() };
                Some(Diagnostic::new(cause, span).label("nothing is open here"))
            }
            (Some(open), kind) => {
                let close = open.kind.partner()?;
                let outside = kind.is_none_or(|k| {
                    k == TokenKind::Semicolon || k.closes() || k.starts_section() || is_outside(k)
                });
                (outside && o.expects(close)).then(|| {
                    let place = self.span(open.start, open.end);
                    unclosed_bracket(self.gap_before(o.at), place, open.kind)
                })
            }
            _ => None,
        }
    }

    fn unclosed_block(&self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        let found = o.kind?;
        if !found.starts_section() {
            return None;
        }
        let ends = [TokenKind::EndIf, TokenKind::EndFor, TokenKind::EndWhen, TokenKind::EndWhile];
        let keyword = ends.into_iter().find(|end| o.expects(*end))?;
        let open = self.open_block(o.at, keyword)?;
        let at = self.tokens.get(o.at)?;
        let else_if = self.tokens[open..o.at]
            .windows(2)
            .any(|w| w[0].kind == TokenKind::Else && w[1].kind == TokenKind::If);
        let advice = (keyword == TokenKind::EndIf && else_if)
            .then_some("`else if` opens another `if` with an `end if` of its own; write `elseif`");
        let open = self.tokens[open];
        let open = self.span(open.start, open.end);
        Some(unclosed_block(self.span(at.start, at.end), open, keyword, advice))
    }

    fn semicolon(&mut self, o: &Obstacle<'_>) -> Option<Diagnostic> {
        let before = *self.before(o.at)?;
        let incomplete = matches!(o.context, SyntaxContext::Equation if o.expects(TokenKind::Equals))
            || matches!(o.context, SyntaxContext::Statement if o.expects(TokenKind::Assign));
        let complete = !incomplete || before.kind == TokenKind::RightParen;
        if !o.expects(TokenKind::Semicolon) || !complete {
            return None;
        }
        let next = self.tokens.get(o.at).copied();
        let new_line = next.is_none_or(|t| self.lines_between(&before, &t));
        if !new_line && !next.is_some_and(|t| t.kind.starts_section()) {
            return None;
        }
        // The following tokens form a line of their own and may have errors of their own.
        self.quiet_until = next.map_or(u32::MAX, |t| t.start);
        let is_class = before.kind == TokenKind::Ident && self.ends_class(o.at);
        let after = if is_class { SyntaxContext::Class } else { o.context };
        let cause = SyntaxCause::MissingSemicolon { after, found: self.found(o.at) };
        Some(Diagnostic::new(cause, self.gap_before(o.at)).label("`;` is missing here"))
    }

    fn unexpected(&self, o: &Obstacle<'_>) -> Diagnostic {
        let expected = self.expectation(o);
        let Some(token) = self.tokens.get(o.at) else {
            let end = self.text.len() as u32;
            return Diagnostic::new(SyntaxCause::UnexpectedEnd { expected }, self.span(end, end));
        };
        let omitted = !o.expects_expression()
            && self.before(o.at).is_some_and(|before| {
                before.kind != TokenKind::Semicolon && self.lines_between(before, token)
            });
        if omitted {
            let cause =
                SyntaxCause::UnexpectedToken { expected, found: self.found(o.at), advice: None };
            return Diagnostic::new(cause, self.gap_before(o.at))
                .label("something is missing here");
        }
        let advice = self.remedy(o, token.kind);
        let cause = SyntaxCause::UnexpectedToken { expected, found: self.found(o.at), advice };
        Diagnostic::new(cause, self.span(token.start, token.end)).label("not expected here")
    }

    /// Advice for common mistakes.
    fn remedy(&self, o: &Obstacle<'_>, found: TokenKind) -> Option<&'static str> {
        let before = self.before(o.at)?.kind;
        let sign = matches!(
            found,
            TokenKind::Plus | TokenKind::Minus | TokenKind::DotPlus | TokenKind::DotMinus
        );
        if o.expects_expression() && sign && before.is_arithmetic() {
            return Some("a sign after an operator needs parentheses, as in `a*(-b)`");
        }
        if found == TokenKind::Not && o.expects_expression() {
            return Some("put the negation in parentheses: `(not a)`");
        }
        if found == TokenKind::If && o.expects_expression() {
            return Some("put the if-expression in parentheses");
        }
        if o.expects_expression() {
            return None;
        }
        if matches!(found, TokenKind::Caret | TokenKind::DotCaret) && !o.expects(found) {
            return Some("powers do not chain: write `(a^b)^c` or `a^(b^c)`");
        }
        if found.is_relation() && !o.expects(found) {
            return Some("relations do not chain: write `a < b and b < c`");
        }
        if found == TokenKind::Equals && o.expects(TokenKind::Then) {
            return Some("`==` compares");
        }
        if found == TokenKind::Assign && o.expects(TokenKind::Then) {
            return Some("`==` compares, `:=` assigns");
        }
        (found == TokenKind::Else
            && before == TokenKind::Semicolon
            && o.expects(TokenKind::ElseWhen))
        .then_some("a `when` has `elsewhen`, but no `else`")
    }
}

/// Found by the lexer, which has already skipped or repaired it.
fn is_lexical(cause: &SyntaxCause) -> bool {
    use SyntaxCause::*;
    matches!(
        cause,
        InvalidCharacter { .. }
            | NonAsciiName { .. }
            | ForeignOperator { .. }
            | UnterminatedString
            | UnterminatedName
            | UnterminatedComment
    )
}

fn is_word(kind: TokenKind) -> bool {
    kind == TokenKind::Ident || TokenKind::KEYWORDS.contains(&kind.text())
}

/// Keywords that cannot occur inside brackets.
fn is_outside(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Then | TokenKind::Loop | TokenKind::Annotation)
}

#[cfg(test)]
mod tests {
    use crate::base::diag::Problems;
    use crate::base::render::{Style, render_all};
    use crate::base::source::SourceMap;
    use crate::parse::grammar::parse;

    /// The codes of the errors in order, and the source followed by its rendered errors.
    fn check(text: &str) -> (Vec<&'static str>, String) {
        let mut sources = SourceMap::default();
        let file = sources.add("a.mo", text);
        let mut problems = Problems::new();
        parse(file, text, &mut problems);
        let codes = problems.sorted().iter().map(|p| p.code).collect();
        (codes, format!("{text}\n----\n{}", render_all(&problems, &sources, Style::Plain)))
    }
    macro_rules! check_messages {
        ($name:literal, $codes:expr, $text:expr) => {
            let (codes, page) = check($text);
            assert_eq!(codes, $codes, "{page}");
            insta::assert_snapshot!($name, page);
        };
    }

    #[test]
    fn semicolons() {
        check_messages!(
            "semicolons",
            ["MO0003", "MO0003", "MO0003"],
            "model A\n  Real x\n  Real y;\nequation\n  x = 1\n  y = 2;\nend A\nmodel B end B;"
        );
    }
    #[test]
    fn brackets() {
        check_messages!(
            "brackets",
            ["MO0004", "MO0004", "MO0030", "MO0004"],
            "model A\n  Real x(start = 1;\nequation\n  x = (1 + 2*(y - 3);\n  y = sin(x));\n  x = {1, 2;\nend A;"
        );
    }
    #[test]
    fn misspelled_keywords() {
        check_messages!(
            "misspelled_keywords",
            ["MO0020", "MO0020", "MO0020"],
            "model A\n  paramter Real x = 1;\nequaton\n  der(y) = x;\n  whenn x > 1 then\n    y = 2;\n  end when;\nend A;"
        );
        assert_eq!(check("modle A\n  Real x;\nend A;").0, ["MO0020"]);
    }
    #[test]
    fn ends() {
        check_messages!(
            "ends",
            ["MO0005", "MO0006"],
            "package P\n  model A\n  end B;\n  model C\n    Real y;\nend P;"
        );
        assert_eq!(check("package P\n  model A\n    Real x;").0, ["MO0006"]);
    }
    #[test]
    fn equality_and_assignment() {
        check_messages!(
            "equality",
            ["MO0007", "MO0032", "MO0009", "MO0001", "MO0008", "MO0008", "MO0018"],
            "model A\nequation\n  x := 1;\n  x == y;\n  x + y;\n  if a = b then\n    x = 1;\n  end if;\n\
             algorithm\n  x = 2;\n  x == 2;\n  x + 1 := 3;\nend A;"
        );
    }
    #[test]
    fn else_if() {
        check_messages!(
            "else_if",
            ["MO0031"],
            "model A\nequation\n  if a then\n    x = 1;\n  else if b then\n    x = 2;\n  end if;\nend A;"
        );
    }
    #[test]
    fn operators() {
        check_messages!(
            "operators",
            ["MO0011", "MO0011", "MO0001", "MO0001", "MO0001"],
            "model A\n  Boolean c = a != b && d;\nequation\n  x = a * -b;\n  x = a^b^c;\n  c = a < b < d;\nend A;"
        );
    }
    #[test]
    fn one_message_for_each_broken_line() {
        check_messages!(
            "broken_lines",
            ["MO0001"; 6],
            "model A\n  Real 3x;\n  Real x y;\nequation\n  x = ;\n  x y = 2;\n  connect(a, );\nalgorithm\n  \
             while x > 1 then\n    x := 2;\n  end while;\nend A;"
        );
    }
    #[test]
    fn unterminated_strings_and_comments_are_reported_once() {
        for (text, code) in [
            ("model A \"text\n  Real x;\nend A;", "MO0012"),
            ("model A\n  Real x; /* c\nend A;", "MO0013"),
        ] {
            assert_eq!(check(text).0, [code]);
        }
    }
}
