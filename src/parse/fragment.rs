//! An expression that stands by itself in a text from outside, such as a setting or a measure.
//!
//! The text is shown in messages as it was given. It is parsed as the binding of a declaration, at the
//! same place of its line, so that every span of the expression fits both.

use std::sync::Arc;

use super::grammar::parse;
use super::lexer::lex;
use super::token::{Kind, Token};
use crate::base::diag::Problems;
use crate::base::source::{FileId, SourceMap};
use crate::ir::ast::{ClassBody, ElementKind, Expr};

/// What stands before the expression while it is parsed.
const DECLARATION: &str = "model S Real x";

/// Parses the end of `whole` from byte `place` on, which follows a `=`. `parsed` is what is given to the
/// parser instead of it, if it is not the same; it has its length. The text is added to the sources under the
/// name `label`. None if it is no expression.
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

/// The text with other words of the same length for keywords that open a bracket: functions of a measure
/// may be called like keywords.
pub fn without_keywords(text: &str, words: &[(Kind, &str)]) -> String {
    let mut own = Problems::new();
    let tokens: Vec<Token> = lex(FileId(u32::MAX), text, &mut own).tokens;
    let mut out = text.to_owned();
    for pair in tokens.windows(2) {
        let word = words.iter().find(|(kind, _)| *kind == pair[0].kind);
        if let (Some((_, word)), Kind::LeftParen) = (word, pair[1].kind) {
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
    fn spans_fit_the_text_that_is_shown() {
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
    fn only_words_before_a_bracket_are_exchanged() {
        let words = [(Kind::When, "_hen"), (Kind::Final, "_inal")];
        let text = "when(x) + final (y) - 'when(z)' + when_ever(w)";
        let expected = "_hen(x) + _inal (y) - 'when(z)' + when_ever(w)";
        assert_eq!(without_keywords(text, &words), expected);
    }
}
