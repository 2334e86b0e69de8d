//! The dotted name at a place in a text that may be unfinished.

/// A dotted name around a place: its parts up to the one that is there.
pub(super) struct DottedName {
    /// Its parts.
    pub parts: Vec<String>,
}

/// The dotted name at an offset, up to the part that is there. Subscripts between its parts are skipped.
pub(super) fn at(text: &str, offset: u32) -> Option<DottedName> {
    let bytes = text.as_bytes();
    let is_letter = |k: usize| {
        bytes.get(k).is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80)
    };
    let mut start = offset as usize;
    while start > 0 && is_letter(start - 1) {
        start -= 1;
    }
    let mut end = offset as usize;
    while is_letter(end) {
        end += 1;
    }
    if start == end || bytes[start].is_ascii_digit() {
        return None;
    }
    let mut parts = vec![text.get(start..end)?.to_owned()];
    while start > 0 && bytes[start - 1] == b'.' {
        let mut at = start - 1;
        if at > 0 && bytes[at - 1] == b']' {
            at = text[..at].rfind('[')?;
        }
        let end = at;
        while at > 0 && is_letter(at - 1) {
            at -= 1;
        }
        if at == end {
            break;
        }
        parts.insert(0, text.get(at..end)?.to_owned());
        start = at;
    }
    Some(DottedName { parts })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_ends_with_the_part_at_the_place() {
        let text = "x = a.b[2].c + ä1;";
        let of = |part: &str, shift: usize| {
            at(text, (text.find(part).unwrap() + shift) as u32).map(|name| name.parts.join("."))
        };
        assert_eq!(of("a.b", 0).as_deref(), Some("a"));
        assert_eq!(of("a.b", 2).as_deref(), Some("a.b"));
        assert_eq!(of("c +", 0).as_deref(), Some("a.b.c"));
        assert_eq!(of("c +", 1).as_deref(), Some("a.b.c"), "the end of a name belongs to it");
        assert_eq!(of("ä1", 0).as_deref(), Some("ä1"));
        assert_eq!(of("2]", 0), None);
        assert_eq!(of("= a", 0), None);
    }
}
