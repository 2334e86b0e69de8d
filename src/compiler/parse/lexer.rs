//! Source text to tokens (Modelica 3.6, chapter 2). Sole user of `logos`.
//!
//! Besides splitting the text, the lexer handles everything that depends on the next token or on
//! open brackets: it joins `end if` and `initial equation`, distinguishes the `end` of a subscript
//! from the `end` of a class, and bounds the depth of the syntax tree so that no input can overflow
//! the stack of a later stage.

use logos::Logos;

use super::error::{NestingLimit, SyntaxCause, too_deep, unterminated};
use super::token::{Token, TokenKind};
use crate::base::diag::{Diagnostic, Problems};
use crate::base::source::{FileId, Span};
use crate::ir::ast::Comment;

/// Brackets nested deeper than this are rejected.
pub const MAX_BRACKETS: usize = 500;
/// Expressions whose tree may be higher than this are rejected. Later stages recurse over
/// expressions on a thread with a stack large enough for it.
pub const MAX_HEIGHT: u32 = 10_000;

/// After this many errors the file is assumed not to be Modelica.
const MAX_REPORTS: usize = 100;

/// The output of the lexer.
#[derive(Debug, Default)]
pub struct Lexed {
    /// The tokens, up to the point where a limit was exceeded.
    pub tokens: Vec<Token>,
    /// The comments.
    pub comments: Vec<Comment>,
    /// True if the tokens end early.
    pub cut_off: bool,
    /// True if an unterminated comment or string swallowed the rest of the file.
    pub swallowed_end: bool,
}

/// Splits `text` into tokens; invalid characters are reported and skipped or repaired.
pub fn lex(file: FileId, text: &str, problems: &mut Problems) -> Lexed {
    let mut lexed = Lexed::default();
    let mut pending = Joiner::default();
    let bom = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let mut lexemes = Lexeme::lexer(text);
    lexemes.bump(bom);
    let earlier = problems.iter().count();
    while let Some(lexeme) = lexemes.next() {
        if problems.iter().count() - earlier > MAX_REPORTS {
            lexed.cut_off = true;
            return lexed;
        }
        let range = lexemes.span();
        let span = Span::new(file, range.start, range.end);
        let kind = match lexeme {
            Ok(Lexeme::Symbol(kind)) => kind,
            Ok(Lexeme::Word) => TokenKind::keyword(lexemes.slice()).unwrap_or(TokenKind::Ident),
            Ok(Lexeme::LineComment) => {
                lexed.comments.push(Comment { span, block: false });
                continue;
            }
            Ok(Lexeme::BlockComment(closed)) => {
                lexed.comments.push(Comment { span, block: true });
                if !closed {
                    lexed.swallowed_end = true;
                    problems.push(unterminated(SyntaxCause::UnterminatedComment, span, 2));
                }
                continue;
            }
            Ok(Lexeme::ForeignWord) => {
                let cause = SyntaxCause::NonAsciiName { text: lexemes.slice().into() };
                problems.push(Diagnostic::new(cause, span));
                TokenKind::Ident
            }
            Ok(Lexeme::OpenString) => {
                lexed.swallowed_end = true;
                problems.push(unterminated(SyntaxCause::UnterminatedString, span, 1));
                TokenKind::String
            }
            Ok(Lexeme::OpenQuoted) => {
                problems.push(unterminated(SyntaxCause::UnterminatedName, span, 1));
                TokenKind::Ident
            }
            Ok(Lexeme::Foreign(kind)) => {
                let cause = SyntaxCause::ForeignOperator { written: lexemes.slice().into() };
                let label = format!("should be `{}`", kind.text());
                problems.push(Diagnostic::new(cause, span).label(label));
                kind
            }
            Err(()) => {
                let cause = SyntaxCause::InvalidCharacter { text: lexemes.slice().into() };
                problems.push(Diagnostic::new(cause, span));
                continue;
            }
        };
        let token = Token { kind, start: span.start, end: span.end };
        if let Err(limit) = pending.push(token, &mut lexed.tokens) {
            problems.push(too_deep(limit, span));
            lexed.cut_off = true;
            return lexed;
        }
    }
    lexed
}

/// The lexemes that `logos` distinguishes.
#[derive(Logos, Debug)]
#[logos(skip r"[ \t\r\n\f\u{a0}]+")]
enum Lexeme {
    #[regex(r"[A-Za-z_][A-Za-z0-9_]*")]
    Word,
    #[regex(r"[A-Za-z_\p{L}][A-Za-z0-9_\p{L}\p{M}\p{N}]*", priority = 1)]
    ForeignWord,
    #[regex(r"//[^\n]*", allow_greedy = true)]
    LineComment,
    /// True if it is closed.
    #[token("/*", block_comment)]
    BlockComment(bool),
    #[regex(r#""([^"\\]|\\(?s:.))*"#, allow_greedy = true, priority = 3)]
    OpenString,
    #[regex(r"'([^'\\\n]|\\.)*", allow_greedy = true, priority = 3)]
    OpenQuoted,
    /// Operators of other languages, with their equivalents in Modelica.
    #[token("!=", |_| TokenKind::NotEqual)]
    #[token("~=", |_| TokenKind::NotEqual)]
    #[token("&&", |_| TokenKind::And)]
    #[token("||", |_| TokenKind::Or)]
    #[token("!", |_| TokenKind::Not)]
    #[token("**", |_| TokenKind::Caret)]
    Foreign(TokenKind),
    #[regex(r#""([^"\\]|\\(?s:.))*""#, |_| TokenKind::String)]
    #[regex(r"'([^'\\\n]|\\.)*'", |_| TokenKind::Ident)]
    #[regex(r"[0-9]+", |_| TokenKind::Integer)]
    #[regex(r"[0-9]+\.[0-9]*([eE][+-]?[0-9]+)?", |_| TokenKind::Real)]
    #[regex(r"[0-9]+[eE][+-]?[0-9]+", |_| TokenKind::Real)]
    #[regex(r"\.[0-9]+([eE][+-]?[0-9]+)?", |_| TokenKind::Real)]
    #[token("(", |_| TokenKind::LeftParen)]
    #[token(")", |_| TokenKind::RightParen)]
    #[token("[", |_| TokenKind::LeftBracket)]
    #[token("]", |_| TokenKind::RightBracket)]
    #[token("{", |_| TokenKind::LeftBrace)]
    #[token("}", |_| TokenKind::RightBrace)]
    #[token(",", |_| TokenKind::Comma)]
    #[token(";", |_| TokenKind::Semicolon)]
    #[token(":", |_| TokenKind::Colon)]
    #[token(".", |_| TokenKind::Dot)]
    #[token("=", |_| TokenKind::Equals)]
    #[token(":=", |_| TokenKind::Assign)]
    #[token("+", |_| TokenKind::Plus)]
    #[token("-", |_| TokenKind::Minus)]
    #[token("*", |_| TokenKind::Star)]
    #[token("/", |_| TokenKind::Slash)]
    #[token("^", |_| TokenKind::Caret)]
    #[token(".+", |_| TokenKind::DotPlus)]
    #[token(".-", |_| TokenKind::DotMinus)]
    #[token(".*", |_| TokenKind::DotStar)]
    #[token("./", |_| TokenKind::DotSlash)]
    #[token(".^", |_| TokenKind::DotCaret)]
    #[token("<", |_| TokenKind::Less)]
    #[token("<=", |_| TokenKind::LessEqual)]
    #[token(">", |_| TokenKind::Greater)]
    #[token(">=", |_| TokenKind::GreaterEqual)]
    #[token("==", |_| TokenKind::EqualEqual)]
    #[token("<>", |_| TokenKind::NotEqual)]
    Symbol(TokenKind),
}

/// Advances to the end of the comment or of the file; true if the comment is closed.
fn block_comment(lexer: &mut logos::Lexer<'_, Lexeme>) -> bool {
    match lexer.remainder().find("*/") {
        Some(at) => {
            lexer.bump(at + 2);
            true
        }
        None => {
            lexer.bump(lexer.remainder().len());
            false
        }
    }
}

/// Joins two-word tokens and tracks open brackets.
#[derive(Default)]
struct Joiner {
    open: Vec<BracketScope>,
    outermost: BracketScope,
}

/// An open bracket, or the level outside of all brackets. The height of its expressions is at most
/// the number of operators since the last separator plus the height of the highest bracket closed
/// since then.
#[derive(Clone, Copy, Default)]
struct BracketScope {
    bracket: Option<TokenKind>,
    operators: u32,
    inner: u32,
    highest: u32,
}

impl BracketScope {
    fn height(&self) -> u32 {
        self.operators + self.inner
    }
    /// A comma or semicolon: the next expression starts.
    fn separate(&mut self) {
        self.highest = self.highest.max(self.height());
        self.operators = 0;
        self.inner = 0;
    }
}

impl Joiner {
    /// Appends `token`, or joins it with the previous one into a two-word token.
    fn push(&mut self, mut token: Token, tokens: &mut Vec<Token>) -> Result<(), NestingLimit> {
        if let Some(last) = tokens.last_mut() {
            let joined = match (last.kind, token.kind) {
                (TokenKind::Initial, TokenKind::Equation) => Some(TokenKind::InitialEquation),
                (TokenKind::Initial, TokenKind::Algorithm) => Some(TokenKind::InitialAlgorithm),
                (TokenKind::End | TokenKind::EndValue, TokenKind::If) => Some(TokenKind::EndIf),
                (TokenKind::End | TokenKind::EndValue, TokenKind::For) => Some(TokenKind::EndFor),
                (TokenKind::End | TokenKind::EndValue, TokenKind::When) => Some(TokenKind::EndWhen),
                (TokenKind::End | TokenKind::EndValue, TokenKind::While) => {
                    Some(TokenKind::EndWhile)
                }
                // `end A` in brackets: a bracket is missing.
                (TokenKind::EndValue, TokenKind::Ident) => {
                    last.kind = TokenKind::End;
                    self.abandon();
                    None
                }
                _ => None,
            };
            if let Some(kind) = joined {
                *last = Token { kind, end: token.end, ..*last };
                self.abandon();
                return Ok(());
            }
        }
        if token.kind == TokenKind::End && !self.open.is_empty() {
            token.kind = TokenKind::EndValue;
        }
        tokens.push(token);
        self.account(token.kind)
    }

    /// Discards brackets that were never closed.
    fn abandon(&mut self) {
        self.open.clear();
        self.outermost = BracketScope::default();
    }

    fn account(&mut self, kind: TokenKind) -> Result<(), NestingLimit> {
        if kind.opens() {
            if self.open.len() >= MAX_BRACKETS {
                return Err(NestingLimit::Brackets);
            }
            self.open.push(BracketScope { bracket: Some(kind), ..BracketScope::default() });
        } else if kind.closes() {
            if let Some(mut closed) = self.open.pop() {
                closed.separate();
                let level = self.level();
                level.inner = level.inner.max(closed.highest + 1);
            }
        } else if kind == TokenKind::Comma {
            self.level().separate();
        } else if kind == TokenKind::Semicolon {
            match self.open.last_mut() {
                Some(level) if level.bracket == Some(TokenKind::LeftBracket) => level.separate(),
                _ => self.abandon(),
            }
        } else if kind.starts_section() {
            self.abandon();
        } else if kind.is_operator() || matches!(kind, TokenKind::If | TokenKind::Colon) {
            self.level().operators += 1;
        }
        if self.level().height() > MAX_HEIGHT { Err(NestingLimit::Height) } else { Ok(()) }
    }

    fn level(&mut self) -> &mut BracketScope {
        self.open.last_mut().unwrap_or(&mut self.outermost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> (Vec<&'static str>, Problems) {
        let mut problems = Problems::new();
        let lexed = lex(FileId(0), text, &mut problems);
        (lexed.tokens.iter().map(|t| t.kind.text()).collect(), problems)
    }
    fn clean(text: &str) -> Vec<&'static str> {
        let (kinds, problems) = kinds(text);
        assert!(problems.is_empty(), "{problems:?}");
        kinds
    }

    #[test]
    fn numbers_follow_the_longest_match() {
        assert_eq!(clean("1 1. .5 1e5 1.5E-3 1.e2"), {
            ["INTEGER", "REAL", "REAL", "REAL", "REAL", "REAL"]
        });
        assert_eq!(clean("2.*x"), ["REAL", "*", "IDENT"]);
        assert_eq!(clean("2 .*x"), ["INTEGER", ".*", "IDENT"]);
        assert_eq!(clean("a.b"), ["IDENT", ".", "IDENT"]);
    }

    #[test]
    fn joins_words_and_distinguishes_the_two_ends() {
        assert_eq!(clean("end if end A"), ["end if", "end", "IDENT"]);
        assert_eq!(clean("initial equation initial()"), ["initial equation", "initial", "(", ")"]);
        assert_eq!(clean("x[end] end"), ["IDENT", "[", "end value", "]", "end"]);
        assert_eq!(clean("x[1 end A"), ["IDENT", "[", "INTEGER", "end", "IDENT"]);
    }

    #[test]
    fn quoted_names_strings_and_comments() {
        assert_eq!(clean(r#"'a b\'' "x\"y" "X\X""#), ["IDENT", "STRING", "STRING"]);
        assert_eq!(clean("\u{feff}a // b\n/* c ** / */ d"), ["IDENT", "IDENT"]);
        let mut problems = Problems::new();
        let lexed = lex(FileId(0), "/* a */ b // c", &mut problems);
        let places: Vec<_> = lexed.comments.iter().map(|c| (c.span.start, c.block)).collect();
        assert_eq!(places, [(0, true), (10, false)]);
    }

    #[test]
    fn reports_and_continues() {
        for (text, tokens, code) in [
            ("a != b", vec!["IDENT", "<>", "IDENT"], "MO0011"),
            ("a && b", vec!["IDENT", "and", "IDENT"], "MO0011"),
            ("a # b", vec!["IDENT", "IDENT"], "MO0010"),
            ("Größe x", vec!["IDENT", "IDENT"], "MO0033"),
            ("\"abc", vec!["STRING"], "MO0012"),
            ("a /* b", vec!["IDENT"], "MO0013"),
        ] {
            let (kinds, problems) = kinds(text);
            assert_eq!(kinds, tokens);
            assert_eq!(problems.iter().map(|p| p.code).collect::<Vec<_>>(), [code], "{text}");
        }
    }

    #[test]
    fn bounds_depth_but_not_length() {
        let cut = |text: String| {
            let mut problems = Problems::new();
            lex(FileId(0), &text, &mut problems).cut_off
        };
        assert!(cut("(".repeat(501)));
        assert!(!cut("(".repeat(500)));
        assert!(cut("a".to_string() + &"+a".repeat(10_001)));
        assert!(cut("(".to_string() + &"+a".repeat(6000) + ")" + &"+a".repeat(6000)));
        assert!(!cut("{".to_string() + &"-1,".repeat(100_000) + "1}"));
        assert!(!cut("(a+b)*c;".repeat(100_000)));
    }
}
