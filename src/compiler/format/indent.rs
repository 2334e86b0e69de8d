//! Indentation: two columns for each enclosing class, clause and loop.

use super::Item;
use crate::parse::token::TokenKind;

/// Columns of one level.
const LEVEL: usize = 2;

/// Tracks the structure of the source line by line.
#[derive(Default)]
pub(super) struct Indenter {
    /// Open classes, clauses and loops.
    open: usize,
    /// Open brackets.
    depth: usize,
    /// Number of open brackets before each item of the line.
    depths: Vec<usize>,
    /// The statement or element that is being read; `None` between two.
    statement: Option<OpenStatement>,
    /// True inside an equation or algorithm section.
    in_section: bool,
    /// `in_section` of the enclosing classes.
    enclosing: Vec<bool>,
}

#[derive(Clone, Copy)]
struct OpenStatement {
    /// The column of its first line in the output and in the source.
    indent: usize,
    written: usize,
    /// How it starts, ignoring the prefixes of classes.
    head: StatementStart,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum StatementStart {
    Other,
    /// `model` and the like.
    Class,
    /// A class whose name has been read: it is a long class unless `=` follows.
    Named,
    /// `if`, `for`, `when`, `while` as a statement, until `then` or `loop`.
    Clause,
}

impl Indenter {
    /// The indentation of a line whose first item is at column `written` in the source.
    pub(super) fn line(&mut self, line: &[Item<'_>], written: usize) -> usize {
        let first = line.iter().find_map(|i| i.kind);
        let indent = match self.statement {
            Some(OpenStatement { head: StatementStart::Named, .. }) if first.is_none() => {
                LEVEL * (self.open + 1)
            }
            Some(OpenStatement { head: StatementStart::Named, .. })
                if !first.is_some_and(in_header) =>
            {
                self.enter();
                self.first_line(line)
            }
            Some(s) => self.continuation_line(s, line, written),
            None => self.first_line(line),
        };
        self.depths.clear();
        for item in line {
            self.depths.push(self.depth);
            self.take(item, indent, written);
        }
        indent
    }

    /// Open brackets before item `k` of the line.
    pub(super) fn depth_at(&self, k: usize) -> usize {
        self.depths[k]
    }

    /// A continuation line keeps its column relative to the first line of the statement, but is
    /// indented by at least one level.
    fn continuation_line(&self, s: OpenStatement, line: &[Item<'_>], written: usize) -> usize {
        let closes = matches!(
            line[0].kind,
            Some(
                TokenKind::RightParen
                    | TokenKind::RightBracket
                    | TokenKind::RightBrace
                    | TokenKind::Then
                    | TokenKind::Loop
            )
        );
        let least = if closes { 0 } else { LEVEL };
        s.indent + written.saturating_sub(s.written).max(least)
    }

    fn first_line(&self, line: &[Item<'_>]) -> usize {
        use TokenKind as K;
        // A comment belongs to the next token of its line; without one it follows the open blocks.
        let first = line.iter().find_map(|i| i.kind);
        let back = match first {
            Some(
                K::End
                | K::EndIf
                | K::EndFor
                | K::EndWhen
                | K::EndWhile
                | K::Else
                | K::ElseIf
                | K::ElseWhen,
            ) => 1,
            Some(
                K::Equation
                | K::Algorithm
                | K::InitialEquation
                | K::InitialAlgorithm
                | K::Public
                | K::Protected,
            ) => 1,
            _ => 0,
        };
        LEVEL * (self.open.saturating_sub(back))
    }

    fn take(&mut self, item: &Item<'_>, indent: usize, written: usize) {
        use TokenKind as K;
        let Some(kind) = item.kind else { return };
        match kind {
            K::LeftParen | K::LeftBracket | K::LeftBrace => self.depth += 1,
            K::RightParen | K::RightBracket | K::RightBrace => {
                self.depth = self.depth.saturating_sub(1);
            }
            _ => {}
        }
        if self.depth > 0 && kind != K::LeftParen && kind != K::LeftBracket && kind != K::LeftBrace
        {
            return;
        }
        match self.statement {
            None => self.begin(kind, indent, written),
            Some(s) => self.advance(s, kind),
        }
    }

    fn begin(&mut self, kind: TokenKind, indent: usize, written: usize) {
        use TokenKind as K;
        let mut head = StatementStart::Other;
        match kind {
            K::Semicolon => return,
            K::Equation | K::Algorithm | K::InitialEquation | K::InitialAlgorithm => {
                self.in_section = true;
                return;
            }
            K::Public | K::Protected => {
                self.in_section = false;
                return;
            }
            K::Else => return,
            K::If | K::For | K::When | K::While if self.in_section => {
                self.open += 1;
                head = StatementStart::Clause;
            }
            K::ElseIf | K::ElseWhen => head = StatementStart::Clause,
            K::EndIf | K::EndFor | K::EndWhen | K::EndWhile => {
                self.open = self.open.saturating_sub(1);
            }
            K::End => {
                self.open = self.open.saturating_sub(1);
                self.in_section = self.enclosing.pop().unwrap_or(false);
            }
            kind if is_class(kind) => head = StatementStart::Class,
            _ => {}
        }
        self.statement = Some(OpenStatement { indent, written, head });
    }

    fn advance(&mut self, s: OpenStatement, kind: TokenKind) {
        use TokenKind as K;
        match (s.head, kind) {
            (_, K::Semicolon) => self.statement = None,
            (StatementStart::Clause, K::Then | K::Loop) => self.statement = None,
            // A prefix came first.
            (StatementStart::Other, kind) if is_class(kind) && !self.in_section => {
                self.statement = Some(OpenStatement { head: StatementStart::Class, ..s });
            }
            (StatementStart::Class, K::Ident) => {
                self.statement = Some(OpenStatement { head: StatementStart::Named, ..s })
            }
            (StatementStart::Named, K::Equals) => {
                self.statement = Some(OpenStatement { head: StatementStart::Other, ..s });
            }
            (StatementStart::Named, kind) if !in_header(kind) => {
                self.enter();
                self.begin(kind, s.indent, s.written);
            }
            _ => {}
        }
    }

    /// Enters a long class.
    fn enter(&mut self) {
        self.statement = None;
        self.open += 1;
        self.enclosing.push(self.in_section);
        self.in_section = false;
    }
}

/// Tokens that may occur between the name of a class and its first element: its description, the
/// modification of an inherited class that it extends, or the `=` of a short class.
fn in_header(kind: TokenKind) -> bool {
    use TokenKind as K;
    matches!(kind, K::String | K::Plus | K::Equals | K::LeftParen | K::RightParen)
}

fn is_class(kind: TokenKind) -> bool {
    use TokenKind as K;
    matches!(
        kind,
        K::Class
            | K::Model
            | K::Record
            | K::Block
            | K::Connector
            | K::Type
            | K::Package
            | K::Function
            | K::Operator
    )
}
