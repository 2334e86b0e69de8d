//! Repairs that follow from the remedies of diagnostics.

use crate::base::diag::did_you_mean;
use crate::io::json::Json;

use super::diagnostics::Placed;
use super::position::Lines;

/// The repairs of the diagnostics at some bytes of a text.
pub fn actions(all: &[Placed], text: &str, address: &str, (start, end): (usize, usize)) -> Json {
    let lines = Lines::of(text);
    let near = all.iter().filter(|placed| placed.start <= end && start <= placed.end);
    Json::list(near.filter_map(|placed| {
        let (from, to, new) = repair(placed, text)?;
        let edit =
            Json::object([("range", lines.range(from, to)), ("newText", Json::text(new.as_str()))]);
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
        let (from, to) = misspelled(&placed.diagnostic.message, written, name)?;
        return Some((placed.start + from, placed.start + to, name.to_owned()));
    }
    None
}

/// The bytes of a place that a suggested name replaces: the name there that is most like it, of those that the message
/// quotes. Without such a name there is no repair.
fn misspelled(message: &str, written: &str, suggested: &str) -> Option<(usize, usize)> {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    // A dotted name replaces a dotted name.
    let is_part = |c: char| is_letter(c) || suggested.contains('.') && matches!(c, '.' | '[' | ']');
    let names = |text: &str| -> Vec<(usize, usize)> {
        let mut out: Vec<(usize, usize)> = Vec::new();
        for (at, c) in text.char_indices().filter(|(_, c)| is_part(*c)) {
            match out.last_mut().filter(|(_, end)| *end == at) {
                Some((_, end)) => *end = at + c.len_utf8(),
                None => out.push((at, at + c.len_utf8())),
            }
        }
        out
    };
    let of = |text: &str| -> Vec<String> {
        names(text).into_iter().map(|(from, to)| text[from..to].to_owned()).collect()
    };
    let quoted: Vec<String> = message.split('`').skip(1).step_by(2).flat_map(of).collect();
    let here = of(written);
    let known = here.iter().filter(|word| quoted.contains(word)).map(String::as_str);
    match did_you_mean(suggested, known) {
        Some(word) => names(written).into_iter().rfind(|(from, to)| &written[*from..*to] == word),
        // A place that is one name is what the message is about.
        None => (here.len() == 1 && here[0] == written).then_some((0, written.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::misspelled;

    #[test]
    fn only_whole_words_are_replaced() {
        let of = |message: &str, written: &str, suggested: &str| {
            let place = misspelled(message, written, suggested);
            place.map(|(from, to)| written[from..to].to_owned()).unwrap_or_default()
        };
        assert_eq!(of("`x` has no attribute `fixd`", "fixd", "fixed"), "fixd");
        assert_eq!(of("`x` has no attribute `fixd`", "fixd = true", "fixed"), "fixd");
        assert_eq!(of("`magnt` is not declared", "magnt.flange", "magnet"), "magnt");
        assert_eq!(of("`spool` has no `flang`", "spool.flang", "flange"), "flang");
        assert_eq!(of("`A.Bdy` is not declared", "A.Bdy", "A.Body"), "A.Bdy");
        assert_eq!(of("`A.Bdy` is not declared", "A.Bdy", "Body"), "Bdy");
        assert_eq!(of("`x` is wrong", "fixd = 1", "fixed"), "");
    }
}
