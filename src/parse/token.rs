//! The kinds of tokens and their texts. The text of a terminal in `grammar/modelica.lalrpop` is
//! [`Kind::text`], so that the names LALRPOP reports lead back to a kind.

/// A token: its kind and its place; its text is in the source.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Token {
    /// What it is.
    pub kind: Kind,
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
        /// What a token is. Two-word tokens (`end if`, `initial equation`) and the `end` of a
        /// subscript are made by the lexer: they keep the grammar LALR(1) and give recovery
        /// unmistakable places to stop at.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Kind {
            $(#[doc = concat!("`", $keyword_text, "`")] $keyword,)*
            $(#[doc = concat!("`", $other_text, "`")] $other,)*
        }

        impl Kind {
            /// All kinds.
            pub const ALL: &[Kind] = &[$(Kind::$keyword,)* $(Kind::$other,)*];
            /// Keywords of Modelica 3.6, section 2.3.3.
            pub const KEYWORDS: &[&str] = &[$($keyword_text,)*];

            /// The keyword of this text.
            pub fn keyword(text: &str) -> Option<Kind> {
                match text {
                    $($keyword_text => Some(Kind::$keyword),)*
                    _ => None,
                }
            }
            /// The text; for tokens with many texts, the name of the terminal.
            pub fn text(self) -> &'static str {
                match self {
                    $(Kind::$keyword => $keyword_text,)*
                    $(Kind::$other => $other_text,)*
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

impl Kind {
    /// The kind behind a terminal as LALRPOP names it: quoted, or the name of a pattern.
    pub fn of_terminal(terminal: &str) -> Option<Kind> {
        let text = terminal.trim_matches('"');
        Kind::ALL.iter().copied().find(|k| k.text() == text)
    }
    /// True for `(`, `[`, `{`.
    pub fn opens(self) -> bool {
        matches!(self, Kind::LeftParen | Kind::LeftBracket | Kind::LeftBrace)
    }
    /// True for `)`, `]`, `}`.
    pub fn closes(self) -> bool {
        matches!(self, Kind::RightParen | Kind::RightBracket | Kind::RightBrace)
    }
    /// True for the operators of expressions, with a place on one side or on both.
    pub fn is_operator(self) -> bool {
        matches!(self, Kind::And | Kind::Or | Kind::Not)
            || self.is_arithmetic()
            || self.is_relation()
    }
    /// True for `+`, `.*`...
    pub fn is_arithmetic(self) -> bool {
        use Kind::*;
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
        use Kind::*;
        matches!(self, Less | LessEqual | Greater | GreaterEqual | EqualEqual | NotEqual)
    }
    /// The bracket that closes this one.
    pub fn partner(self) -> Option<Kind> {
        match self {
            Kind::LeftParen => Some(Kind::RightParen),
            Kind::LeftBracket => Some(Kind::RightBracket),
            Kind::LeftBrace => Some(Kind::RightBrace),
            _ => None,
        }
    }
    /// True where a part of a class begins or ends: no expression reaches across.
    pub fn starts_section(self) -> bool {
        matches!(
            self,
            Kind::Equation
                | Kind::Algorithm
                | Kind::InitialEquation
                | Kind::InitialAlgorithm
                | Kind::Public
                | Kind::Protected
                | Kind::End
                | Kind::EndIf
                | Kind::EndFor
                | Kind::EndWhen
                | Kind::EndWhile
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_terminal_name_leads_back_to_its_kind() {
        for &kind in Kind::ALL {
            assert_eq!(Kind::of_terminal(&format!("{:?}", kind.text())), Some(kind));
        }
        assert_eq!(Kind::KEYWORDS.len(), 59, "Modelica 3.6, section 2.3.3");
        assert_eq!(Kind::of_terminal("error"), None);
    }
}
