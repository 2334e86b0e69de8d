//! Quoted identifiers (Modelica 3.6, section 2.3.1).

/// The name as an identifier, quoted if necessary.
pub(super) fn quoted(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 2);
    push_quoted(name, &mut out);
    out
}

pub(super) fn push_quoted(name: &str, out: &mut String) {
    let plain = name.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_')
        && name.bytes().next().is_some_and(|c| !c.is_ascii_digit());
    let already = name.starts_with('\'')
        && name.ends_with('\'')
        && name.len() > 1
        && !name[1..name.len() - 1].contains('\'');
    if plain || already {
        out.push_str(name);
        return;
    }
    out.push('\'');
    if !name.contains('\'') {
        out.push_str(name);
        out.push('\'');
        return;
    }
    for (k, part) in name.split('\'').enumerate() {
        if k > 0 {
            out.push_str("\\'");
        }
        out.push_str(part);
    }
    out.push('\'');
}
