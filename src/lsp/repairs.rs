//! Repairs that follow from the remedies of diagnostics.

use crate::io::json::Json;

use super::diagnostics::Placed;
use super::position::range;

/// The repairs of the diagnostics at some bytes of a text.
pub fn actions(all: &[Placed], text: &str, address: &str, (start, end): (usize, usize)) -> Json {
    let near = all.iter().filter(|placed| placed.start <= end && start <= placed.end);
    Json::list(near.filter_map(|placed| {
        let (from, to, new) = repair(placed, text)?;
        let edit =
            Json::object([("range", range(text, from, to)), ("newText", Json::text(new.as_str()))]);
        let title = match text.get(from..to).unwrap_or_default() {
            "" => format!("Insert `{}`", new.trim()),
            old => format!("Replace `{old}` by `{}`", new.trim()),
        };
        Some(Json::object([
            ("title", Json::text(title)),
            ("kind", Json::text("quickfix")),
            ("isPreferred", Json::flag(true)),
            ("edit", Json::object([("changes", Json::object([(address, Json::list([edit]))]))])),
        ]))
    }))
}

/// The bytes that a repair replaces, and the new text.
fn repair(placed: &Placed, text: &str) -> Option<(usize, usize, String)> {
    let message = &placed.diagnostic.message;
    let written = text.get(placed.start..placed.end)?;
    if placed.diagnostic.code == "MO0003" && message.starts_with("expected `;` after") {
        return Some((placed.start, placed.start, ";".to_owned()));
    }
    if placed.diagnostic.code == "MO0005" {
        let mut names =
            message.split('`').skip(1).step_by(2).filter_map(|n| n.strip_prefix("end "));
        let (expected, found) = (names.next()?, names.next()?);
        return (written == found).then(|| (placed.start, placed.end, expected.to_owned()));
    }
    let help = placed.diagnostic.help.as_deref()?;
    if let Some(name) = help.strip_prefix("did you mean `").and_then(|rest| rest.split('`').next())
    {
        // The misspelled name may be a part of the place, as in `spool.x`.
        let wrong =
            quoted(&placed.diagnostic.message).filter(|w| written.contains(w)).unwrap_or(written);
        let at = placed.start + written.rfind(wrong)?;
        let is_name =
            wrong.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']'));
        return is_name.then(|| (at, at + wrong.len(), name.to_owned()));
    }
    None
}

/// The first words in backquotes.
fn quoted(message: &str) -> Option<&str> {
    message.split('`').nth(1)
}
