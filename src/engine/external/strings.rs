//! The functions of `ModelicaStrings`: comparison, substrings, scanners, hashes.
//!
//! In: known arguments. Out: known results. Positions count characters from 1.
//! *Modelica Standard Library 4.1.0, `Modelica.Utilities.Strings`.*

use super::{Data, Fault, integer, string};

/// The literals of `Modelica.Utilities.Types.Compare`.
const ORDER: [&str; 3] = ["Less", "Equal", "Greater"];

/// The functions by their names in C.
pub(super) const FUNCTIONS: [(&str, fn(&[Data]) -> Result<Vec<Data>, Fault>); 9] = [
    ("ModelicaStrings_length", length),
    ("ModelicaStrings_substring", substring),
    ("ModelicaStrings_compare", compare),
    ("ModelicaStrings_skipWhiteSpace", skip_white_space),
    ("ModelicaStrings_hashString", hash),
    ("ModelicaStrings_scanInteger", |args| scan(Token::Integer, args)),
    ("ModelicaStrings_scanReal", |args| scan(Token::Real, args)),
    ("ModelicaStrings_scanIdentifier", |args| scan(Token::Identifier, args)),
    ("ModelicaStrings_scanString", |args| scan(Token::String, args)),
];

/// A token that can be scanned.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Token {
    Integer,
    Real,
    Identifier,
    String,
}

fn characters(args: &[Data], k: usize) -> Result<Vec<char>, Fault> {
    Ok(string(args, k)?.chars().collect())
}

fn length(args: &[Data]) -> Result<Vec<Data>, Fault> {
    Ok(vec![Data::Integer(characters(args, 0)?.len() as i64)])
}

fn substring(args: &[Data]) -> Result<Vec<Data>, Fault> {
    let all = characters(args, 0)?;
    let (from, to) = (integer(args, 1)?.max(1), integer(args, 2)?.min(all.len() as i64));
    let part = if from > to {
        String::new()
    } else {
        all[from as usize - 1..to as usize].iter().collect()
    };
    Ok(vec![Data::String(part)])
}

fn compare(args: &[Data]) -> Result<Vec<Data>, Fault> {
    let (mut a, mut b) = (characters(args, 0)?, characters(args, 1)?);
    let case_sensitive = integer(args, 2)? != 0;
    if !case_sensitive {
        a = a.into_iter().flat_map(char::to_lowercase).collect();
        b = b.into_iter().flat_map(char::to_lowercase).collect();
    }
    Ok(vec![Data::Literal(&ORDER, (a.cmp(&b) as i8 + 2) as u32)])
}

fn skip_white_space(args: &[Data]) -> Result<Vec<Data>, Fault> {
    let (all, start) = (characters(args, 0)?, integer(args, 1)?.max(1));
    let rest = all.iter().skip(start as usize - 1);
    let blanks = rest.take_while(|c| c.is_whitespace()).count();
    Ok(vec![Data::Integer(start + blanks as i64)])
}

fn hash(args: &[Data]) -> Result<Vec<Data>, Fault> {
    let hash = arash_partow_hash(string(args, 0)?.as_bytes());
    Ok(vec![Data::Integer(i64::from(hash as i32))])
}

/// Reads a token at a position: returns the position after it (unchanged if there is none) and its
/// value.
fn scan(token: Token, args: &[Data]) -> Result<Vec<Data>, Fault> {
    let (all, start) = (characters(args, 0)?, integer(args, 1)?);
    // Only the scanners of numbers have this third argument.
    let unsigned = matches!(args.get(2), Some(Data::Boolean(true)));
    let begin = (start.max(1) as usize - 1).min(all.len());
    let blanks = all[begin..].iter().take_while(|c| c.is_whitespace()).count();
    let rest = &all[begin + blanks..];
    let length = match token {
        Token::Identifier => identifier(rest),
        Token::String => quoted(rest),
        _ if unsigned && matches!(rest.first(), Some('+' | '-')) => 0,
        Token::Integer => number(rest, false),
        Token::Real => number(rest, true),
    };
    let found: String = rest[..length].iter().collect();
    let next = if length == 0 { start } else { (begin + blanks + length + 1) as i64 };
    let value = match token {
        Token::Identifier => Data::String(found),
        Token::String => Data::String(found.trim_matches('"').replace("\\\"", "\"")),
        Token::Integer => Data::Integer(found.parse().unwrap_or(0)),
        Token::Real => Data::Real(found.parse().unwrap_or(0.0)),
    };
    Ok(vec![Data::Integer(next), value])
}

/// The length of the identifier at the start of `text`; 0 if there is none.
fn identifier(text: &[char]) -> usize {
    let starts = text.first().is_some_and(|c| c.is_ascii_alphabetic());
    let continues = |c: &&char| c.is_ascii_alphanumeric() || **c == '_';
    if starts { text.iter().take_while(continues).count() } else { 0 }
}

/// The length of the quoted string at the start of `text`, quotes included; 0 if there is none.
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

/// The length of the number at the start of `text`: a sign and digits, for a Real also a fraction
/// and an exponent; 0 if there is none.
fn number(text: &[char], real: bool) -> usize {
    let digits = |from: usize| text[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut at = usize::from(matches!(text.first(), Some('+' | '-')));
    let integer_digits = digits(at);
    at += integer_digits;
    let mut fraction = 0;
    if real && text.get(at) == Some(&'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if integer_digits + fraction == 0 {
        return 0;
    }
    if real && matches!(text.get(at), Some('e' | 'E')) {
        let sign = usize::from(matches!(text.get(at + 1), Some('+' | '-')));
        let exponent = if at + 1 + sign <= text.len() { digits(at + 1 + sign) } else { 0 };
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    // `1.5` is not an Integer.
    if !real && matches!(text.get(at), Some('.' | 'e' | 'E')) { 0 } else { at }
}

/// Arash Partow's hash on 32 bits (General Purpose Hash Function Algorithms, 2002). Noise blocks
/// are seeded with the hash of their instance name.
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
    fn tokens_have_these_lengths() {
        assert_eq!(number(&chars("-12 x"), false), 3);
        assert_eq!(number(&chars("1.5"), false), 0);
        assert_eq!(number(&chars("1.5e-3kg"), true), 6);
        assert_eq!(number(&chars("1e"), true), 1);
        assert_eq!(number(&chars("."), true), 0);
        assert_eq!(identifier(&chars("a_1.b")), 3);
        assert_eq!(arash_partow_hash(b""), 0xAAAA_AAAA);
        assert_eq!(quoted(&chars(r#""a\"b" c"#)), 6);
    }

    fn of(function: &str, args: &[Data]) -> Vec<Data> {
        let name = format!("ModelicaStrings_{function}");
        let (_, f) = FUNCTIONS.iter().find(|(n, _)| *n == name).expect("a known function");
        f(args).expect("a result")
    }

    fn string(s: &str) -> Data {
        Data::String(s.to_owned())
    }

    #[test]
    fn positions_count_characters_from_one() {
        let substring =
            |from, to| of("substring", &[string("spööl"), Data::Integer(from), Data::Integer(to)]);
        assert_eq!(substring(2, 4), [string("pöö")]);
        assert_eq!(substring(4, 99), [string("öl")]);
        assert_eq!(substring(3, 2), [string("")]);
        assert_eq!(of("length", &[string("spööl")]), [Data::Integer(5)]);
        let blanks = of("skipWhiteSpace", &[string("  x"), Data::Integer(1)]);
        assert_eq!(blanks, [Data::Integer(3)]);
    }

    #[test]
    fn scanners_return_the_next_position_and_the_value() {
        let scan = |function, s, start| {
            of(function, &[string(s), Data::Integer(start), Data::Boolean(false)])
        };
        assert_eq!(scan("scanReal", "x = -1.5e2;", 4), [Data::Integer(11), Data::Real(-150.0)]);
        assert_eq!(scan("scanInteger", "1.5", 1), [Data::Integer(1), Data::Integer(0)]);
        assert_eq!(scan("scanIdentifier", " ab_1.c", 1), [Data::Integer(6), string("ab_1")]);
        assert_eq!(scan("scanString", r#""a\"b" c"#, 1), [Data::Integer(7), string("a\"b")]);
    }

    #[test]
    fn comparison_can_ignore_case() {
        let compare = |sensitive| {
            of("compare", &[string("Valve"), string("valve"), Data::Boolean(sensitive)])
        };
        assert_eq!(compare(false), [Data::Literal(&ORDER, 2)]);
        assert_eq!(compare(true), [Data::Literal(&ORDER, 1)]);
    }
}
