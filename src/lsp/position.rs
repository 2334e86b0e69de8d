//! Positions of the protocol, in lines and UTF-16 units, and byte offsets.

use crate::io::json::Json;

/// The byte offset of a position; the end of its line or of the text if it is beyond them.
pub fn offset(text: &str, line: usize, character: usize) -> usize {
    let mut start = 0;
    for _ in 0..line {
        match text[start..].find('\n') {
            Some(at) => start += at + 1,
            None => return text.len(),
        }
    }
    let mut units = 0;
    for (at, c) in text[start..].char_indices() {
        if units >= character || c == '\n' {
            return start + at;
        }
        units += c.len_utf16();
    }
    text.len()
}

/// The offset of the position in a JSON object.
pub fn offset_of(text: &str, position: &Json) -> usize {
    let of = |key| position.count_at(&[key]).unwrap_or(0);
    offset(text, of("line"), of("character"))
}

/// Line and UTF-16 units of a byte offset.
pub fn line_character(text: &str, offset: usize) -> (usize, usize) {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    let before = &text[..offset];
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    (before.matches('\n').count(), before[start..].encode_utf16().count())
}

/// The range of bytes `start..end`.
pub fn range(text: &str, start: usize, end: usize) -> Json {
    let position = |offset| {
        let (line, character) = line_character(text, offset);
        Json::object([("line", Json::count(line)), ("character", Json::count(character))])
    };
    Json::object([("start", position(start)), ("end", position(end.max(start)))])
}

/// The path of a `file:` address; none for other addresses.
pub fn path_of(address: &str) -> Option<std::path::PathBuf> {
    let rest = address.strip_prefix("file://")?;
    let bytes = rest.as_bytes();
    let mut out = Vec::new();
    let mut k = 0;
    while k < bytes.len() {
        let code = (bytes[k] == b'%').then(|| rest.get(k + 1..k + 3)).flatten();
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                k += 3;
            }
            None => {
                out.push(bytes[k]);
                k += 1;
            }
        }
    }
    let path = String::from_utf8(out).ok()?;
    // `file:///C:/x` on Windows.
    let is_drive = path.as_bytes().get(2) == Some(&b':');
    Some(if is_drive { path[1..].into() } else { path.into() })
}

/// The `file:` address of an absolute path.
pub fn address_of(path: &std::path::Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let mut out = String::from(if text.starts_with('/') { "file://" } else { "file:///" });
    for byte in text.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' => {
                out.push(char::from(byte));
            }
            _ => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_utf16_units() {
        let text = "aä\n😀x\nend";
        assert_eq!(offset(text, 1, 2), text.find('x').unwrap());
        assert_eq!(line_character(text, text.find('x').unwrap()), (1, 2));
        assert_eq!(offset(text, 0, 99), 3);
        assert_eq!(offset(text, 9, 0), text.len());
        assert_eq!(line_character(text, text.len()), (2, 3));
    }

    #[test]
    fn addresses_are_paths() {
        let path = std::path::Path::new("/home/me/a b/ä.mo");
        let address = address_of(path);
        assert_eq!(address, "file:///home/me/a%20b/%C3%A4.mo");
        assert_eq!(path_of(&address).as_deref(), Some(path));
        assert_eq!(path_of("untitled:x"), None);
    }
}
