//! Parses a single expression from outside a model, such as a parameter override or a measure.
//!
//! The expression is parsed as the binding of a declaration that puts it at the same column as in
//! the user's input, so every span is valid in both and diagnostics show the input as it was given.

use std::sync::Arc;

use super::grammar::parse;
use super::lexer::lex;
use super::token::{Token, TokenKind};
use crate::base::diag::Problems;
use crate::base::source::{FileId, SourceMap};
use crate::ir::ast::{ClassBody, ElementKind, Expr};

/// The declaration that precedes the expression while it is parsed.
const DECLARATION: &str = "model S Real x";

/// Parses `whole` from byte `place` on, which follows an `=`. If `parsed` is given, the parser
/// reads it instead; it must have the same length. `whole` is added to the sources under the name
/// `label`. `None` if it is not an expression.
pub fn binding(
    label: &str,
    whole: &str,
    place: usize,
    parsed: Option<&str>,
    sources: &mut SourceMap,
) -> Option<Expr> {
    let shown_from = (DECLARATION.len() + 1).saturating_sub(place);
    let id = sources.add(label, format!("{:shown_from$}{whole}", ""));
    let width = place + shown_from - 1;
    let value = parsed.unwrap_or(&whole[place..]);
    let file = format!("{DECLARATION:width$}={value}; end S;");
    let mut own = Problems::new();
    let parsed = parse(id, &file, &mut own);
    let ClassBody::Long(composition) = &parsed.classes.first()?.body else { return None };
    let [element] = composition.elements.as_slice() else { return None };
    let ElementKind::Components(clause) = &element.kind else { return None };
    let found: Option<Arc<Expr>> =
        clause.components.first()?.modification.as_ref().and_then(|m| m.binding.clone());
    found.filter(|_| !own.has_errors()).map(|e| (*e).clone())
}

/// Replaces keywords that are followed by a parenthesis by words of the same length: functions of a
/// measure may have the names of keywords.
pub fn replace_keywords(text: &str, words: &[(TokenKind, &str)]) -> String {
    let mut own = Problems::new();
    let tokens: Vec<Token> = lex(FileId(u32::MAX), text, &mut own).tokens;
    let mut out = text.to_owned();
    for pair in tokens.windows(2) {
        let word = words.iter().find(|(kind, _)| *kind == pair[0].kind);
        if let (Some((_, word)), TokenKind::LeftParen) = (word, pair[1].kind) {
            out.replace_range(pair[0].start as usize..pair[0].end as usize, word);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::ast::ExprKind;

    #[test]
    fn spans_are_valid_in_the_displayed_source() {
        for whole in ["y=a + b", "a_rather_long_name = a + b"] {
            let mut sources = SourceMap::default();
            let place = whole.find('=').unwrap() + 1;
            let sum = binding("--set", whole, place, None, &mut sources).unwrap();
            let ExprKind::Binary(_, a, b) = &sum.kind else { panic!("{sum:?}") };
            let text = |e: &Expr| sources.text(e.span).map(str::trim);
            assert_eq!((text(a), text(b)), (Some("a"), Some("b")));
        }
        let mut sources = SourceMap::default();
        for whole in ["y=a +", "y=", "y=1; Real z"] {
            assert!(binding("--set", whole, 2, None, &mut sources).is_none(), "{whole}");
        }
    }

    #[test]
    fn only_keywords_before_a_parenthesis_are_replaced() {
        let words = [(TokenKind::When, "_hen"), (TokenKind::Final, "_inal")];
        let text = "when(x) + final (y) - 'when(z)' + when_ever(w)";
        let expected = "_hen(x) + _inal (y) - 'when(z)' + when_ever(w)";
        assert_eq!(replace_keywords(text, &words), expected);
    }
}
