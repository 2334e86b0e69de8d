//! How far each line stands to the right: two columns for each class, clause and loop around it.

use super::Item;
use crate::parse::token::Kind;

/// Columns of one level.
const LEVEL: usize = 2;

/// The structure of the text so far.
#[derive(Default)]
pub(super) struct Structure {
    /// Open classes, clauses and loops.
    open: usize,
    /// Open brackets.
    depth: usize,
    /// Brackets that are open before each item of the line.
    depths: Vec<usize>,
    /// The statement or element that is being read; `None` between two.
    statement: Option<Statement>,
    /// In a section of equations or statements.
    acting: bool,
    /// Of the classes around, whether they were in such a section.
    around: Vec<bool>,
}

#[derive(Clone, Copy)]
struct Statement {
    /// Where its first line stands now, and stood.
    indent: usize,
    written: usize,
    /// What it began with, prefixes of classes left out.
    head: Head,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Head {
    Other,
    /// `model` and the like.
    Class,
    /// Its name has been read: the class is long unless `=` follows.
    Named,
    /// `if`, `for`, `when`, `while` as a statement, until `then` or `loop`.
    Clause,
}

impl Structure {
    /// The column at which a line is to stand whose first item stood at `written`.
    pub(super) fn line(&mut self, line: &[Item<'_>], written: usize) -> usize {
        let first = line.iter().find_map(|i| i.kind);
        let indent = match self.statement {
            Some(Statement { head: Head::Named, .. }) if first.is_none() => LEVEL * (self.open + 1),
            Some(Statement { head: Head::Named, .. }) if !first.is_some_and(in_header) => {
                self.enter();
                self.begun(line)
            }
            Some(s) => self.continued(s, line, written),
            None => self.begun(line),
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

    /// A further line of a statement keeps its place relative to the first, but not left of the next
    /// level.
    fn continued(&self, s: Statement, line: &[Item<'_>], written: usize) -> usize {
        let closes = matches!(
            line[0].kind,
            Some(
                Kind::RightParen | Kind::RightBracket | Kind::RightBrace | Kind::Then | Kind::Loop
            )
        );
        let least = if closes { 0 } else { LEVEL };
        s.indent + written.saturating_sub(s.written).max(least)
    }

    fn begun(&self, line: &[Item<'_>]) -> usize {
        use Kind as K;
        // Comments belong to the token after them; without one they stand with what is open.
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
        use Kind as K;
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
            Some(s) => self.go_on(s, kind),
        }
    }

    fn begin(&mut self, kind: Kind, indent: usize, written: usize) {
        use Kind as K;
        let mut head = Head::Other;
        match kind {
            K::Semicolon => return,
            K::Equation | K::Algorithm | K::InitialEquation | K::InitialAlgorithm => {
                self.acting = true;
                return;
            }
            K::Public | K::Protected => {
                self.acting = false;
                return;
            }
            K::Else => return,
            K::If | K::For | K::When | K::While if self.acting => {
                self.open += 1;
                head = Head::Clause;
            }
            K::ElseIf | K::ElseWhen => head = Head::Clause,
            K::EndIf | K::EndFor | K::EndWhen | K::EndWhile => {
                self.open = self.open.saturating_sub(1);
            }
            K::End => {
                self.open = self.open.saturating_sub(1);
                self.acting = self.around.pop().unwrap_or(false);
            }
            kind if is_class(kind) => head = Head::Class,
            _ => {}
        }
        self.statement = Some(Statement { indent, written, head });
    }

    fn go_on(&mut self, s: Statement, kind: Kind) {
        use Kind as K;
        match (s.head, kind) {
            (_, K::Semicolon) => self.statement = None,
            (Head::Clause, K::Then | K::Loop) => self.statement = None,
            // A prefix came first.
            (Head::Other, kind) if is_class(kind) && !self.acting => {
                self.statement = Some(Statement { head: Head::Class, ..s });
            }
            (Head::Class, K::Ident) => self.statement = Some(Statement { head: Head::Named, ..s }),
            (Head::Named, K::Equals) => {
                self.statement = Some(Statement { head: Head::Other, ..s });
            }
            (Head::Named, kind) if !in_header(kind) => {
                self.enter();
                self.begin(kind, s.indent, s.written);
            }
            _ => {}
        }
    }

    /// A long class begins.
    fn enter(&mut self) {
        self.statement = None;
        self.open += 1;
        self.around.push(self.acting);
        self.acting = false;
    }
}

/// What may stand between the name of a class and its first element: its description, the
/// modification of an inherited class that it extends, or the `=` of a short class.
fn in_header(kind: Kind) -> bool {
    use Kind as K;
    matches!(kind, K::String | K::Plus | K::Equals | K::LeftParen | K::RightParen)
}

fn is_class(kind: Kind) -> bool {
    use Kind as K;
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
