//! External functions on texts, computed before the model runs, from their documentation.
//!
//! Positions count characters from 1.

use super::Context;
use super::external::Refusal;
use super::value::Value;
use crate::ir::expr::{Const, EnumId};

impl Context<'_> {
    /// A function of the family `ModelicaStrings_`.
    pub(super) fn text_function(
        &mut self,
        what: &str,
        args: &[Value],
    ) -> Result<Vec<Value>, Refusal> {
        let mut known = Vec::new();
        for a in args {
            known.push(self.known(a)?.first().copied().ok_or(Refusal::Unknown)?);
        }
        let text = |k: usize| match known.get(k) {
            Some(Const::String(t)) => Ok(t.chars().collect::<Vec<char>>()),
            _ => Err(Refusal::Unknown),
        };
        let whole = |k: usize| match known.get(k) {
            Some(Const::Integer(i)) => Ok(*i),
            Some(Const::Boolean(b)) => Ok(i64::from(*b)),
            _ => Err(Refusal::Unknown),
        };
        match what {
            "length" => {
                let n = text(0)?.len() as i64;
                Ok(vec![self.whole_number(n)])
            }
            "substring" => {
                let all = text(0)?;
                let (from, to) = (whole(1)?.max(1), whole(2)?.min(all.len() as i64));
                let part: String = if from > to {
                    String::new()
                } else {
                    all[from as usize - 1..to as usize].iter().collect()
                };
                Ok(vec![Value::Scalar(self.graph.string(&part))])
            }
            "compare" => {
                let (mut a, mut b) = (text(0)?, text(1)?);
                if whole(2)? == 0 {
                    a = a.into_iter().flat_map(char::to_lowercase).collect();
                    b = b.into_iter().flat_map(char::to_lowercase).collect();
                }
                let order = a.cmp(&b) as i64 + 2;
                let literal = self
                    .enumeration_of(["Less", "Equal", "Greater"])
                    .map(|t| Const::Enumeration(t, order as u32));
                let literal = literal.unwrap_or(Const::Integer(order));
                Ok(vec![Value::Scalar(self.graph.constant(literal))])
            }
            "skipWhiteSpace" => {
                let (all, start) = (text(0)?, whole(1)?.max(1));
                let blanks =
                    all.iter().skip(start as usize - 1).take_while(|c| c.is_whitespace()).count();
                Ok(vec![self.whole_number(start + blanks as i64)])
            }
            "hashString" => {
                let bytes: String = text(0)?.iter().collect();
                let hash = arash_partow_hash(bytes.as_bytes());
                Ok(vec![self.whole_number(i64::from(hash as i32))])
            }
            "scanInteger" | "scanReal" | "scanIdentifier" | "scanString" => {
                // Of texts and names the third argument is none of them.
                let unsigned = matches!(known.get(2), Some(Const::Boolean(true)));
                self.scan(what, &text(0)?, whole(1)?, unsigned)
            }
            _ => Err(Refusal::Unknown),
        }
    }

    /// What stands at a position: the position after it (the same if there is nothing such), and its value.
    fn scan(
        &mut self,
        what: &str,
        all: &[char],
        start: i64,
        unsigned: bool,
    ) -> Result<Vec<Value>, Refusal> {
        let begin = (start.max(1) as usize - 1).min(all.len());
        let blanks = all[begin..].iter().take_while(|c| c.is_whitespace()).count();
        let rest = &all[begin + blanks..];
        let length = match what {
            "scanIdentifier" => identifier(rest),
            "scanString" => quoted(rest),
            _ if unsigned && matches!(rest.first(), Some('+' | '-')) => 0,
            "scanInteger" => number(rest, false),
            _ => number(rest, true),
        };
        let token: String = rest[..length].iter().collect();
        let next = if length == 0 { start } else { (begin + blanks + length + 1) as i64 };
        let value = match what {
            "scanIdentifier" => Value::Scalar(self.graph.string(&token)),
            "scanString" => {
                let inner = token.trim_matches('"').replace("\\\"", "\"");
                Value::Scalar(self.graph.string(&inner))
            }
            "scanInteger" => self.whole_number(token.parse().unwrap_or(0)),
            _ => Value::Scalar(self.graph.real(token.parse().unwrap_or(0.0))),
        };
        Ok(vec![self.whole_number(next), value])
    }

    fn whole_number(&mut self, n: i64) -> Value {
        Value::Scalar(self.graph.integer(n))
    }

    /// The enumeration with these literals, which an external function gives.
    pub(super) fn enumeration_of<const N: usize>(&self, wanted: [&str; N]) -> Option<EnumId> {
        let is_it = |id: &EnumId| {
            let literals = &self.graph.enumerations[*id].literals;
            literals.iter().map(|l| l.as_str()).eq(wanted)
        };
        self.graph.enumerations.ids().find(is_it)
    }
}

fn identifier(text: &[char]) -> usize {
    let starts = text.first().is_some_and(|c| c.is_ascii_alphabetic());
    let goes_on = |c: &&char| c.is_ascii_alphanumeric() || **c == '_';
    if starts { text.iter().take_while(goes_on).count() } else { 0 }
}

fn quoted(text: &[char]) -> usize {
    if text.first() != Some(&'"') {
        return 0;
    }
    let mut escaped = false;
    for (i, c) in text.iter().enumerate().skip(1) {
        match c {
            '"' if !escaped => return i + 1,
            _ => escaped = *c == '\\' && !escaped,
        }
    }
    0
}

/// The length of a number: a sign, digits, and for a real one a fraction and an exponent.
fn number(text: &[char], real: bool) -> usize {
    let digits = |from: usize| text[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut at = usize::from(matches!(text.first(), Some('+' | '-')));
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if real && text.get(at) == Some(&'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if real && matches!(text.get(at), Some('e' | 'E')) {
        let sign = usize::from(matches!(text.get(at + 1), Some('+' | '-')));
        let exponent = if at + 1 + sign <= text.len() { digits(at + 1 + sign) } else { 0 };
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    // `1.5` is no whole number.
    if !real && matches!(text.get(at), Some('.' | 'e' | 'E')) { 0 } else { at }
}

/// Arash Partow's hash (General Purpose Hash Function Algorithms, 2002), on 32 bits: noise is seeded by
/// that of an instance's name.
fn arash_partow_hash(bytes: &[u8]) -> u32 {
    bytes.iter().enumerate().fold(0xAAAA_AAAA, |hash: u32, (k, byte)| {
        let byte = u32::from(*byte);
        hash ^ match k % 2 {
            0 => (hash << 7) ^ byte.wrapping_mul(hash >> 3),
            _ => !(hash << 11).wrapping_add(byte ^ (hash >> 5)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chars(text: &str) -> Vec<char> {
        text.chars().collect()
    }

    #[test]
    fn lengths_of_what_is_scanned() {
        assert_eq!(number(&chars("-12 x"), false), 3);
        assert_eq!(number(&chars("1.5"), false), 0);
        assert_eq!(number(&chars("1.5e-3kg"), true), 6);
        assert_eq!(number(&chars("1e"), true), 1);
        assert_eq!(number(&chars("."), true), 0);
        assert_eq!(identifier(&chars("a_1.b")), 3);
        assert_eq!(arash_partow_hash(b""), 0xAAAA_AAAA);
        assert_eq!(quoted(&chars(r#""a\"b" c"#)), 6);
    }
}
