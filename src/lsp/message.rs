//! Messages: a header with the length, an empty line, and JSON.

use std::io::{self, BufRead, Write};

use crate::io::json::Json;

/// Bytes of a message at most.
const MOST: usize = 1 << 30;

/// The next message; none at the end of the input.
pub fn read(input: &mut impl BufRead) -> io::Result<Option<Json>> {
    let broken = |why: String| io::Error::new(io::ErrorKind::InvalidData, why);
    let mut length = None;
    let mut line = String::new();
    loop {
        line.clear();
        if input.read_line(&mut line)? == 0 {
            return Ok(None);
        }
        let header = line.trim();
        if header.is_empty() {
            break;
        }
        if let Some((name, value)) = header.split_once(':')
            && name.eq_ignore_ascii_case("Content-Length")
        {
            length = value.trim().parse::<usize>().ok().filter(|n| *n <= MOST);
        }
    }
    let length = length.ok_or_else(|| broken("a message without `Content-Length`".into()))?;
    let mut bytes = vec![0; length];
    input.read_exact(&mut bytes)?;
    let text = String::from_utf8(bytes).map_err(|e| broken(e.to_string()))?;
    Json::parse(&text).map(Some).map_err(broken)
}

/// Writes a message.
pub fn write(out: &mut impl Write, message: &Json) -> io::Result<()> {
    let text = message.compact();
    write!(out, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    out.flush()
}

/// An answer to a request.
pub fn answer(id: Json, result: Json) -> Json {
    Json::object([("jsonrpc", Json::text("2.0")), ("id", id), ("result", result)])
}

/// A refusal of a request.
pub fn refusal(id: Json, code: f64, why: &str) -> Json {
    let error = Json::object([("code", Json::integer(code as i64)), ("message", Json::text(why))]);
    Json::object([("jsonrpc", Json::text("2.0")), ("id", id), ("error", error)])
}

/// A message that expects no answer.
pub fn notification(method: &str, parameters: Json) -> Json {
    Json::object([
        ("jsonrpc", Json::text("2.0")),
        ("method", Json::text(method)),
        ("params", parameters),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_back() {
        let mut bytes = Vec::new();
        let first = notification("initialized", Json::text("ä"));
        write(&mut bytes, &first).unwrap();
        write(&mut bytes, &answer(Json::count(1), Json::null())).unwrap();
        let mut input = bytes.as_slice();
        assert_eq!(read(&mut input).unwrap(), Some(first));
        assert_eq!(read(&mut input).unwrap().unwrap().count_at(&["id"]), Some(1));
        assert_eq!(read(&mut input).unwrap(), None);
        assert!(read(&mut &b"x: 1\r\n\r\n{}"[..]).is_err());
    }
}
