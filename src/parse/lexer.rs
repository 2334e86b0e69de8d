//! Text to tokens (Modelica 3.6, section 2). Sole user of `logos`.
//!
//! Beside cutting the text, the lexer does what needs a look at the next token or at the open
//! brackets: it joins `end if` and `initial equation`, tells the `end` of a subscript from the `end`
//! of a class, and bounds the depth of the syntax tree, so that no later stage can be made to
//! overflow its stack by a text.

use logos::Logos;

use super::error::{Bound, SyntaxError};
use super::token::{Kind, Token};
use crate::base::diag::Problems;
use crate::base::source::{FileId, Span};
use crate::ir::ast::Comment;

/// Brackets deeper than this are refused.
pub const MAX_BRACKETS: usize = 500;
/// Expressions whose tree may be higher than this are refused. Later stages recurse over
/// expressions on a thread with a stack large enough for it.
pub const MAX_HEIGHT: u32 = 10_000;

/// After this many errors the text is taken for something other than Modelica.
const MAX_REPORTS: usize = 100;

/// What the lexer makes of a text.
#[derive(Debug, Default)]
pub struct Lexed {
    /// The tokens, up to the place where a bound was exceeded.
    pub tokens: Vec<Token>,
    /// The comments.
    pub comments: Vec<Comment>,
    /// True if the tokens end early.
    pub cut_off: bool,
    /// True if an unterminated comment or string took the rest of the text with it.
    pub swallowed_end: bool,
}

/// Cuts `text` into tokens; what is no token is reported and left out or repaired.
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
            Ok(Lexeme::Word) => Kind::keyword(lexemes.slice()).unwrap_or(Kind::Ident),
            Ok(Lexeme::LineComment) => {
                lexed.comments.push(Comment { span, block: false });
                continue;
            }
            Ok(Lexeme::BlockComment(closed)) => {
                lexed.comments.push(Comment { span, block: true });
                if !closed {
                    lexed.swallowed_end = true;
                    problems.push(SyntaxError::UnterminatedComment { span }.into());
                }
                continue;
            }
            Ok(Lexeme::ForeignWord) => {
                problems.push(SyntaxError::NonAscii { span, text: lexemes.slice().into() }.into());
                Kind::Ident
            }
            Ok(Lexeme::OpenString) => {
                lexed.swallowed_end = true;
                problems.push(SyntaxError::UnterminatedString { span }.into());
                Kind::String
            }
            Ok(Lexeme::OpenQuoted) => {
                problems.push(SyntaxError::UnterminatedName { span }.into());
                Kind::Ident
            }
            Ok(Lexeme::Foreign(kind)) => {
                let written = lexemes.slice().into();
                problems.push(SyntaxError::ForeignOperator { span, written, kind }.into());
                kind
            }
            Err(()) => {
                let text = lexemes.slice().into();
                problems.push(SyntaxError::InvalidCharacter { span, text }.into());
                continue;
            }
        };
        let token = Token { kind, start: span.start, end: span.end };
        if let Err(bound) = pending.push(token, &mut lexed.tokens) {
            problems.push(SyntaxError::TooDeep { span, bound }.into());
            lexed.cut_off = true;
            return lexed;
        }
    }
    lexed
}

/// What `logos` tells apart.
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
    /// Operators of other languages, with what they mean in Modelica.
    #[token("!=", |_| Kind::NotEqual)]
    #[token("~=", |_| Kind::NotEqual)]
    #[token("&&", |_| Kind::And)]
    #[token("||", |_| Kind::Or)]
    #[token("!", |_| Kind::Not)]
    #[token("**", |_| Kind::Caret)]
    Foreign(Kind),
    #[regex(r#""([^"\\]|\\(?s:.))*""#, |_| Kind::String)]
    #[regex(r"'([^'\\\n]|\\.)*'", |_| Kind::Ident)]
    #[regex(r"[0-9]+", |_| Kind::Integer)]
    #[regex(r"[0-9]+\.[0-9]*([eE][+-]?[0-9]+)?", |_| Kind::Real)]
    #[regex(r"[0-9]+[eE][+-]?[0-9]+", |_| Kind::Real)]
    #[regex(r"\.[0-9]+([eE][+-]?[0-9]+)?", |_| Kind::Real)]
    #[token("(", |_| Kind::LeftParen)]
    #[token(")", |_| Kind::RightParen)]
    #[token("[", |_| Kind::LeftBracket)]
    #[token("]", |_| Kind::RightBracket)]
    #[token("{", |_| Kind::LeftBrace)]
    #[token("}", |_| Kind::RightBrace)]
    #[token(",", |_| Kind::Comma)]
    #[token(";", |_| Kind::Semicolon)]
    #[token(":", |_| Kind::Colon)]
    #[token(".", |_| Kind::Dot)]
    #[token("=", |_| Kind::Equals)]
    #[token(":=", |_| Kind::Assign)]
    #[token("+", |_| Kind::Plus)]
    #[token("-", |_| Kind::Minus)]
    #[token("*", |_| Kind::Star)]
    #[token("/", |_| Kind::Slash)]
    #[token("^", |_| Kind::Caret)]
    #[token(".+", |_| Kind::DotPlus)]
    #[token(".-", |_| Kind::DotMinus)]
    #[token(".*", |_| Kind::DotStar)]
    #[token("./", |_| Kind::DotSlash)]
    #[token(".^", |_| Kind::DotCaret)]
    #[token("<", |_| Kind::Less)]
    #[token("<=", |_| Kind::LessEqual)]
    #[token(">", |_| Kind::Greater)]
    #[token(">=", |_| Kind::GreaterEqual)]
    #[token("==", |_| Kind::EqualEqual)]
    #[token("<>", |_| Kind::NotEqual)]
    Symbol(Kind),
}

/// Runs to the end of the comment, or of the text.
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

/// Joins two-word tokens and keeps account of the brackets.
#[derive(Default)]
struct Joiner {
    open: Vec<Level>,
    outermost: Level,
}

/// An open bracket. The height of the expressions in it is at most the number of operators since
/// the last separator, plus the height of the highest bracket closed since then.
#[derive(Clone, Copy, Default)]
struct Level {
    bracket: Option<Kind>,
    operators: u32,
    inner: u32,
    highest: u32,
}

impl Level {
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
    /// Appends `token`, joined with the one before it where the two are one.
    fn push(&mut self, mut token: Token, tokens: &mut Vec<Token>) -> Result<(), Bound> {
        if let Some(last) = tokens.last_mut() {
            let joined = match (last.kind, token.kind) {
                (Kind::Initial, Kind::Equation) => Some(Kind::InitialEquation),
                (Kind::Initial, Kind::Algorithm) => Some(Kind::InitialAlgorithm),
                (Kind::End | Kind::EndValue, Kind::If) => Some(Kind::EndIf),
                (Kind::End | Kind::EndValue, Kind::For) => Some(Kind::EndFor),
                (Kind::End | Kind::EndValue, Kind::When) => Some(Kind::EndWhen),
                (Kind::End | Kind::EndValue, Kind::While) => Some(Kind::EndWhile),
                // `end A` in brackets: a bracket is missing.
                (Kind::EndValue, Kind::Ident) => {
                    last.kind = Kind::End;
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
        if token.kind == Kind::End && !self.open.is_empty() {
            token.kind = Kind::EndValue;
        }
        tokens.push(token);
        self.account(token.kind)
    }

    /// Forgets brackets that were never closed.
    fn abandon(&mut self) {
        self.open.clear();
        self.outermost = Level::default();
    }

    fn account(&mut self, kind: Kind) -> Result<(), Bound> {
        if kind.opens() {
            if self.open.len() >= MAX_BRACKETS {
                return Err(Bound::Brackets);
            }
            self.open.push(Level { bracket: Some(kind), ..Level::default() });
        } else if kind.closes() {
            if let Some(mut closed) = self.open.pop() {
                closed.separate();
                let level = self.level();
                level.inner = level.inner.max(closed.highest + 1);
            }
        } else if kind == Kind::Comma {
            self.level().separate();
        } else if kind == Kind::Semicolon {
            match self.open.last_mut() {
                Some(level) if level.bracket == Some(Kind::LeftBracket) => level.separate(),
                _ => self.abandon(),
            }
        } else if kind.starts_section() {
            self.abandon();
        } else if kind.is_operator() || matches!(kind, Kind::If | Kind::Colon) {
            self.level().operators += 1;
        }
        if self.level().height() > MAX_HEIGHT { Err(Bound::Height) } else { Ok(()) }
    }

    fn level(&mut self) -> &mut Level {
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
    fn joins_words_and_tells_the_two_ends_apart() {
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
    fn reports_and_goes_on() {
        for (text, tokens, code) in [
            ("a != b", vec!["IDENT", "<>", "IDENT"], "MO0011"),
            ("a && b", vec!["IDENT", "and", "IDENT"], "MO0011"),
            ("a # b", vec!["IDENT", "IDENT"], "MO0010"),
            ("Größe x", vec!["IDENT", "IDENT"], "MO0010"),
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
