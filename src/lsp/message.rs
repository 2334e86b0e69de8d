//! Messages: a header with the length, an empty line, and JSON.

use std::io::{self, BufRead, Write};

use crate::io::json::Json;

/// Bytes of a message at most.
const MOST: usize = 1 << 30;
/// The header that each message has.
const LENGTH: &str = "content-length:";

/// What the next bytes of a client are.
#[derive(Clone, PartialEq, Debug)]
pub enum Received {
    /// A message.
    Message(Json),
    /// No message, and why.
    Broken(String),
    /// The end of the input.
    End,
}

/// The next message. Broken contents end with their length, so the message after them is read again.
pub fn read(input: &mut impl BufRead) -> io::Result<Received> {
    let mut length = None;
    let mut is_empty = true;
    loop {
        let mut bytes = Vec::new();
        if input.read_until(b'\n', &mut bytes)? == 0 {
            return Ok(Received::End);
        }
        let line = String::from_utf8_lossy(&bytes);
        let header = line.trim();
        if header.is_empty() {
            // Empty lines between messages.
            if is_empty {
                continue;
            }
            break;
        }
        is_empty = false;
        // The rest of a message without a length may stand before the header of the next one.
        let lower = header.to_ascii_lowercase();
        if let Some(at) = lower.rfind(LENGTH) {
            let value = &lower[at + LENGTH.len()..];
            length = value.trim().parse::<usize>().ok().filter(|n| *n <= MOST);
        }
    }
    let Some(length) = length else {
        return Ok(Received::Broken("a message without `Content-Length`".to_owned()));
    };
    let mut bytes = vec![0; length];
    input.read_exact(&mut bytes)?;
    let text = String::from_utf8(bytes).map_err(|e| e.to_string());
    Ok(match text.and_then(|text| Json::parse(&text)) {
        Ok(message) => Received::Message(message),
        Err(why) => Received::Broken(why),
    })
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
        assert_eq!(read(&mut input).unwrap(), Received::Message(first));
        let second = answer(Json::count(1), Json::null());
        assert_eq!(read(&mut input).unwrap(), Received::Message(second));
        assert_eq!(read(&mut input).unwrap(), Received::End);
    }

    #[test]
    fn the_message_after_a_broken_one_is_read() {
        let next = "Content-Length: 2\r\n\r\n[]";
        for broken in
            ["Content-Length: 5\r\n\r\n{bad}", "x: 1\r\n\r\n", "Content-Length: 1\n\n\u{0}"]
        {
            let text = format!("{broken}{next}");
            let mut input = text.as_bytes();
            assert!(matches!(read(&mut input).unwrap(), Received::Broken(_)), "{broken:?}");
            assert_eq!(read(&mut input).unwrap(), Received::Message(Json::list([])), "{broken:?}");
        }
        let mut input = "x: 1\r\n\r\n{}Content-Length: 2\r\n\r\n[]".as_bytes();
        assert!(matches!(read(&mut input).unwrap(), Received::Broken(_)));
        assert_eq!(read(&mut input).unwrap(), Received::Message(Json::list([])));
    }
}
