//! Positions of the protocol, in lines and UTF-16 units, and byte offsets.

use crate::io::json::Json;

/// A text and the starts of its lines, which all positions in it share.
pub struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    /// The lines of a text.
    pub fn of(text: &'t str) -> Lines<'t> {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at + 1);
        Lines { text, starts: std::iter::once(0).chain(ends).collect() }
    }

    /// The text.
    pub fn text(&self) -> &'t str {
        self.text
    }

    /// The byte offset of a position; the end of its line or of the text if it is beyond them.
    pub fn offset(&self, line: usize, character: usize) -> usize {
        let Some(&start) = self.starts.get(line) else { return self.text.len() };
        let end = self.starts.get(line + 1).map_or(self.text.len(), |next| next - 1);
        let own = &self.text[start..end];
        // A line does not hold its end, of whichever form.
        let own = own.strip_suffix('\r').filter(|_| end < self.text.len()).unwrap_or(own);
        let mut units = 0;
        for (at, c) in own.char_indices() {
            if units >= character {
                return start + at;
            }
            units += c.len_utf16();
        }
        start + own.len()
    }

    /// The offset of the position in a JSON object.
    pub fn offset_of(&self, position: &Json) -> usize {
        let of = |key| position.count_at(&[key]).unwrap_or(0);
        self.offset(of("line"), of("character"))
    }

    /// Line and UTF-16 units of a byte offset.
    pub fn line_character(&self, offset: usize) -> (usize, usize) {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.starts.partition_point(|start| *start <= offset) - 1;
        (line, self.text[self.starts[line]..offset].encode_utf16().count())
    }

    /// A position as the protocol writes it.
    pub fn position(&self, offset: usize) -> Json {
        let (line, character) = self.line_character(offset);
        Json::object([("line", Json::count(line)), ("character", Json::count(character))])
    }

    /// The range of bytes `start..end`.
    pub fn range(&self, start: usize, end: usize) -> Json {
        let (start, end) = (self.position(start), self.position(end.max(start)));
        Json::object([("start", start), ("end", end)])
    }

    /// The range of a place in bytes.
    pub fn place(&self, (start, end): (u32, u32)) -> Json {
        self.range(start as usize, end as usize)
    }
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
        let text = "aä\n😀x\r\nend";
        let lines = Lines::of(text);
        assert_eq!(lines.offset(1, 2), text.find('x').unwrap());
        assert_eq!(lines.line_character(text.find('x').unwrap()), (1, 2));
        assert_eq!(lines.offset(0, 99), 3);
        assert_eq!(lines.offset(1, 99), text.find('\r').unwrap());
        assert_eq!(lines.offset(9, 0), text.len());
        assert_eq!(lines.line_character(text.len()), (2, 3));
        assert_eq!(Lines::of("").line_character(0), (0, 0));
        assert_eq!(Lines::of("").offset(0, 1), 0);
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
