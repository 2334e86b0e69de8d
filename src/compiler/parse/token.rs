//! The kinds of tokens and their spellings. The spelling of a terminal in
//! `grammar/modelica.lalrpop` is [`TokenKind::text`], so the names that LALRPOP reports map back to
//! a kind.

/// A token: its kind and its position; its spelling is in the source.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Token {
    /// The kind.
    pub kind: TokenKind,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

macro_rules! kinds {
    (
        keywords { $($keyword:ident $keyword_text:literal)* }
        others { $($other:ident $other_text:literal)* }
    ) => {
        /// The kind of a token. The lexer creates two-word tokens (`end if`, `initial equation`)
        /// and the `end` of a subscript: they keep the grammar LALR(1) and give error recovery
        /// unambiguous points to stop at.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum TokenKind {
            $(#[doc = concat!("`", $keyword_text, "`")] $keyword,)*
            $(#[doc = concat!("`", $other_text, "`")] $other,)*
        }

        impl TokenKind {
            /// All kinds.
            pub const ALL: &[TokenKind] = &[$(TokenKind::$keyword,)* $(TokenKind::$other,)*];
            /// Keywords of Modelica 3.6, section 2.3.3.
            pub const KEYWORDS: &[&str] = &[$($keyword_text,)*];

            /// The keyword with this spelling.
            pub fn keyword(text: &str) -> Option<TokenKind> {
                match text {
                    $($keyword_text => Some(TokenKind::$keyword),)*
                    _ => None,
                }
            }
            /// The spelling; for tokens with many spellings, the name of the terminal.
            pub fn text(self) -> &'static str {
                match self {
                    $(TokenKind::$keyword => $keyword_text,)*
                    $(TokenKind::$other => $other_text,)*
                }
            }
        }
    };
}

kinds! {
    keywords {
        Algorithm "algorithm" And "and" Annotation "annotation" Block "block" Break "break"
        Class "class" Connect "connect" Connector "connector" Constant "constant"
        ConstrainedBy "constrainedby" Der "der" Discrete "discrete" Each "each" Else "else"
        ElseIf "elseif" ElseWhen "elsewhen" Encapsulated "encapsulated" End "end"
        Enumeration "enumeration" Equation "equation" Expandable "expandable" Extends "extends"
        External "external" False "false" Final "final" Flow "flow" For "for" Function "function"
        If "if" Import "import" Impure "impure" In "in" Initial "initial" Inner "inner"
        Input "input" Loop "loop" Model "model" Not "not" Operator "operator" Or "or"
        Outer "outer" Output "output" Package "package" Parameter "parameter" Partial "partial"
        Protected "protected" Public "public" Pure "pure" Record "record" Redeclare "redeclare"
        Replaceable "replaceable" Return "return" Stream "stream" Then "then" True "true"
        Type "type" When "when" While "while" Within "within"
    }
    others {
        InitialEquation "initial equation" InitialAlgorithm "initial algorithm"
        EndIf "end if" EndFor "end for" EndWhen "end when" EndWhile "end while"
        EndValue "end value"
        Ident "IDENT" Integer "INTEGER" Real "REAL" String "STRING"
        LeftParen "(" RightParen ")" LeftBracket "[" RightBracket "]" LeftBrace "{" RightBrace "}"
        Comma "," Semicolon ";" Colon ":" Dot "." Equals "=" Assign ":="
        Plus "+" Minus "-" Star "*" Slash "/" Caret "^"
        DotPlus ".+" DotMinus ".-" DotStar ".*" DotSlash "./" DotCaret ".^"
        Less "<" LessEqual "<=" Greater ">" GreaterEqual ">=" EqualEqual "==" NotEqual "<>"
    }
}

impl TokenKind {
    /// The kind of a terminal as LALRPOP names it: quoted, or the name of a pattern.
    pub fn of_terminal(terminal: &str) -> Option<TokenKind> {
        let text = terminal.trim_matches('"');
        TokenKind::ALL.iter().copied().find(|k| k.text() == text)
    }
    /// True for `(`, `[`, `{`.
    pub fn opens(self) -> bool {
        matches!(self, TokenKind::LeftParen | TokenKind::LeftBracket | TokenKind::LeftBrace)
    }
    /// True for `)`, `]`, `}`.
    pub fn closes(self) -> bool {
        matches!(self, TokenKind::RightParen | TokenKind::RightBracket | TokenKind::RightBrace)
    }
    /// True for the unary and binary operators of expressions.
    pub fn is_operator(self) -> bool {
        matches!(self, TokenKind::And | TokenKind::Or | TokenKind::Not)
            || self.is_arithmetic()
            || self.is_relation()
    }
    /// True for `+`, `.*`...
    pub fn is_arithmetic(self) -> bool {
        use TokenKind::*;
        matches!(
            self,
            Plus | Minus
                | Star
                | Slash
                | Caret
                | DotPlus
                | DotMinus
                | DotStar
                | DotSlash
                | DotCaret
        )
    }
    /// True for `<`, `==`...
    pub fn is_relation(self) -> bool {
        use TokenKind::*;
        matches!(self, Less | LessEqual | Greater | GreaterEqual | EqualEqual | NotEqual)
    }
    /// The bracket that closes this one.
    pub fn partner(self) -> Option<TokenKind> {
        match self {
            TokenKind::LeftParen => Some(TokenKind::RightParen),
            TokenKind::LeftBracket => Some(TokenKind::RightBracket),
            TokenKind::LeftBrace => Some(TokenKind::RightBrace),
            _ => None,
        }
    }
    /// True for keywords that begin or end a section or block: no expression spans them.
    pub fn starts_section(self) -> bool {
        matches!(
            self,
            TokenKind::Equation
                | TokenKind::Algorithm
                | TokenKind::InitialEquation
                | TokenKind::InitialAlgorithm
                | TokenKind::Public
                | TokenKind::Protected
                | TokenKind::End
                | TokenKind::EndIf
                | TokenKind::EndFor
                | TokenKind::EndWhen
                | TokenKind::EndWhile
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_terminal_name_maps_back_to_its_kind() {
        for &kind in TokenKind::ALL {
            assert_eq!(TokenKind::of_terminal(&format!("{:?}", kind.text())), Some(kind));
        }
        assert_eq!(TokenKind::KEYWORDS.len(), 59, "Modelica 3.6, section 2.3.3");
        assert_eq!(TokenKind::of_terminal("error"), None);
    }
}
