//! The directives of a case, each a line that begins with `//@`.

use super::formula::{Formula, Function, Parser, Token};

/// One directive.
#[derive(Clone, PartialEq, Debug)]
pub enum Directive {
    Run(Verb, Options),
    Status(i32),
    Problem {
        /// `error[MO0312]`.
        head: String,
        place: Place,
        message: Option<String>,
    },
    Expect(Claim),
    Let(String, Function),
    Snapshot {
        flat: bool,
        structure: bool,
    },
    UsedBy(String),
}

/// How far a case goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verb {
    /// To the end of the simulation.
    Run,
    /// To the flat model.
    Flatten,
    /// As `mocc check` does, all classes of the file.
    Check,
}

/// Where a problem is.
#[derive(Clone, PartialEq, Debug)]
pub enum Place {
    /// In the next line of the model: `6`, `6-8`, or `6-` where it goes on in another line.
    Columns(String),
    /// In another file.
    At(String),
    Nowhere,
}

/// Options of a run.
#[derive(Clone, Default, PartialEq, Debug)]
pub struct Options {
    /// Whether a directive gave them.
    pub given: bool,
    pub model: Option<String>,
    pub settings: Vec<String>,
    pub stop: Option<f64>,
    pub interval: Option<f64>,
    pub tolerance: Option<f64>,
    pub method: Option<String>,
    /// Algebraic loops are left to the integrator.
    pub dae: bool,
    /// The flat model, printed and read again, must fulfil the same claims.
    pub also_flat: bool,
    /// Units that do not match are errors.
    pub strict_units: bool,
}

/// What is expected of a run.
#[derive(Clone, PartialEq, Debug)]
pub enum Claim {
    Accepted,
    Values {
        found: Vec<Formula>,
        rows: Rows,
        relation: &'static str,
        expected: Vec<Formula>,
        tolerance: Tolerance,
    },
    Events {
        /// Part of the description.
        what: String,
        count: Option<(&'static str, usize)>,
        times: Vec<Formula>,
        tolerance: Tolerance,
    },
    /// How many rows there are, where a condition holds if there is one.
    Rows {
        relation: &'static str,
        count: usize,
        condition: Option<Formula>,
    },
    Column {
        name: String,
        present: bool,
    },
    /// The output contains a string, this many times if a number is given.
    Contains {
        what: Printed,
        count: Option<usize>,
        text: String,
    },
}

/// Which rows a claim is about.
#[derive(Clone, PartialEq, Debug)]
pub enum Rows {
    First,
    Last,
    At(Vec<Formula>),
    /// All where a condition holds.
    Each(Option<Formula>),
}

/// How far a number may be from the expected one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Tolerance {
    Exact,
    Absolute(f64),
    Relative(f64),
}

/// A text that mocc makes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Printed {
    Flat,
    Structure,
    Messages,
}

const RELATIONS: [&str; 6] = ["=", "<>", "<", "<=", ">", ">="];

/// Reads a directive without its mark.
pub fn read(text: &str) -> Result<Directive, String> {
    let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
    let rest = rest.trim();
    match word {
        "run" => Ok(Directive::Run(Verb::Run, options(rest)?)),
        "flatten" => Ok(Directive::Run(Verb::Flatten, options(rest)?)),
        "check" => Ok(Directive::Run(Verb::Check, options(rest)?)),
        "status" => match rest.parse() {
            Ok(status @ 0..=3) => Ok(Directive::Status(status)),
            _ => Err(format!("`{rest}` is not an exit status")),
        },
        "expect" => Ok(Directive::Expect(claim(rest)?)),
        "let" => definition(rest),
        "snapshot" => {
            let words: Vec<&str> = rest.split_whitespace().collect();
            match words.iter().find(|w| !["flat", "structure"].contains(w)) {
                None if !words.is_empty() => Ok(Directive::Snapshot {
                    flat: words.contains(&"flat"),
                    structure: words.contains(&"structure"),
                }),
                _ => Err("a snapshot is `flat`, `structure`, or both".to_string()),
            }
        }
        "used" => match rest.strip_prefix("by ").map(str::trim) {
            Some(reader) if reader.ends_with(".rs") => Ok(Directive::UsedBy(reader.to_string())),
            _ => Err("write `used by FILE.rs`".to_string()),
        },
        _ if word.starts_with("error[") || word.starts_with("warning[") => problem(word, rest),
        _ => Err(format!("unknown directive `{word}`")),
    }
}

fn problem(head: &str, rest: &str) -> Result<Directive, String> {
    let code = head.split_once('[').and_then(|(_, code)| code.strip_suffix(']'));
    let digits = code.and_then(|c| c.strip_prefix("MO")).unwrap_or_default();
    if digits.len() != 4 || !digits.chars().all(|c| c.is_ascii_digit()) {
        return Err(format!("`{head}` has no code such as `[MO0201]`"));
    }
    let (place, message) = match rest.split_once(": ") {
        Some((place, message)) => (place.trim(), Some(message.trim().to_string())),
        None => (rest, None),
    };
    let columns = |text: &str| {
        let (from, to) = text.split_once('-').unwrap_or((text, "1"));
        from.parse::<usize>().is_ok() && (to.is_empty() || to.parse::<usize>().is_ok())
    };
    let place = match place {
        "nowhere" => Place::Nowhere,
        _ if columns(place) => Place::Columns(place.to_string()),
        _ => match place.strip_prefix("at ") {
            Some(other) => Place::At(other.trim().to_string()),
            None => {
                return Err(format!(
                    "`{place}` is not a place: write columns as `6-8`, `at FILE:LINE:6-8`, or `nowhere`"
                ));
            }
        },
    };
    Ok(Directive::Problem { head: head.to_string(), place, message })
}

fn options(text: &str) -> Result<Options, String> {
    let mut out = Options { given: true, ..Options::default() };
    for word in words(text)? {
        let (key, value) =
            word.split_once('=').ok_or_else(|| format!("the option `{word}` has no value"))?;
        let number = || value.parse::<f64>().map_err(|_| format!("`{value}` is not a number"));
        match key {
            "model" => out.model = Some(value.to_string()),
            "set" => out.settings.push(value.to_string()),
            "stop" => out.stop = Some(number()?),
            "interval" => out.interval = Some(number()?),
            "tolerance" => out.tolerance = Some(number()?),
            "method" => out.method = Some(value.to_string()),
            "mode" if value == "dae" => out.dae = true,
            "also" if value == "flat" => out.also_flat = true,
            "units" if value == "error" => out.strict_units = true,
            "mode" | "also" | "units" => return Err(format!("`{key}` cannot be `{value}`")),
            _ => return Err(format!("unknown option `{key}`")),
        }
    }
    Ok(out)
}

/// Words between spaces, where quotes keep spaces.
fn words(text: &str) -> Result<Vec<String>, String> {
    let mut out = Vec::new();
    let mut word = String::new();
    let mut quoted = false;
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            ' ' if !quoted => {
                out.push(std::mem::take(&mut word));
            }
            _ => word.push(c),
        }
    }
    if quoted {
        return Err("a quote has no end".to_string());
    }
    out.push(word);
    out.retain(|w| !w.is_empty());
    Ok(out)
}

/// `NAME = FORMULA` or `NAME(A, B) = FORMULA`.
fn definition(text: &str) -> Result<Directive, String> {
    let mut parser = Parser::new(text)?;
    let Some(Token::Name(name)) = parser.next() else {
        return Err("a name is missing".to_string());
    };
    let mut parameters = Vec::new();
    if parser.sign("(") {
        loop {
            match parser.next() {
                Some(Token::Name(name)) => parameters.push(name),
                _ => return Err("the name of a parameter is missing".to_string()),
            }
            if parser.sign(")") {
                break;
            }
            if !parser.sign(",") {
                return Err("`)` is missing".to_string());
            }
        }
    }
    if !parser.sign("=") {
        return Err("`=` is missing".to_string());
    }
    let body = parser.formula()?;
    parser.end()?;
    Ok(Directive::Let(name, Function { parameters, body }))
}

fn claim(text: &str) -> Result<Claim, String> {
    if text == "accepted" {
        return Ok(Claim::Accepted);
    }
    for (present, mark) in [(true, "column "), (false, "no column ")] {
        if let Some(name) = text.strip_prefix(mark) {
            return Ok(Claim::Column { name: name.trim().to_string(), present });
        }
    }
    let mut parser = Parser::new(text)?;
    let made = [
        ("flat", Printed::Flat),
        ("structure", Printed::Structure),
        ("messages", Printed::Messages),
    ];
    for (word, what) in made {
        if text.starts_with(&format!("{word} has ")) || text.starts_with(&format!("{word} lacks "))
        {
            parser.next();
            return contains(what, parser);
        }
    }
    if let Some(claim) = rows(text)? {
        return Ok(claim);
    }
    let events = ["events =", "events <", "events >", "events \"", "events at "];
    if events.iter().any(|e| text.starts_with(e)) {
        parser.next();
        return event(parser);
    }
    values(parser)
}

fn contains(what: Printed, mut parser: Parser) -> Result<Claim, String> {
    let count = match parser.word("lacks") {
        true => Some(0),
        false => {
            parser.next();
            parser.number().map(|n| n as usize)
        }
    };
    let text = parser.text().ok_or("a string between quotes is missing")?;
    parser.end()?;
    Ok(Claim::Contains { what, count, text })
}

/// `rows = 7`, with `where` and a condition.
fn rows(text: &str) -> Result<Option<Claim>, String> {
    let mut parser = Parser::new(text)?;
    if !parser.word("rows") {
        return Ok(None);
    }
    let Some(relation) = relation(&mut parser) else { return Ok(None) };
    let count = parser.number().ok_or("the number of rows is missing")? as usize;
    let condition = if parser.word("where") { Some(parser.formula()?) } else { None };
    parser.end()?;
    Ok(Some(Claim::Rows { relation, count, condition }))
}

fn relation(parser: &mut Parser) -> Option<&'static str> {
    RELATIONS.into_iter().find(|r| parser.sign(r))
}

fn event(mut parser: Parser) -> Result<Claim, String> {
    let what = parser.text().unwrap_or_default();
    let count = match relation(&mut parser) {
        Some(relation) => {
            Some((relation, parser.number().ok_or("the number of events is missing")? as usize))
        }
        None => None,
    };
    let times = if parser.word("at") { parser.sums()? } else { Vec::new() };
    let tolerance = tolerance(&mut parser)?;
    parser.end()?;
    if count.is_none() && times.is_empty() {
        return Err("neither a number of events nor their times".to_string());
    }
    Ok(Claim::Events { what, count, times, tolerance })
}

fn values(mut parser: Parser) -> Result<Claim, String> {
    let each = parser.word("each");
    let mut found = Vec::new();
    for formula in parser.sums()? {
        expand(formula, &mut found)?;
    }
    let mut rows = if each { Rows::Each(None) } else { Rows::Last };
    if !each && parser.word("at") {
        rows = match parser.word("start") {
            true => Rows::First,
            false => Rows::At(parser.sums()?),
        };
    }
    let relation = relation(&mut parser).ok_or("a relation is missing")?;
    let expected = parser.formulas()?;
    if each && parser.word("where") {
        rows = Rows::Each(Some(parser.formula()?));
    }
    let tolerance = tolerance(&mut parser)?;
    parser.end()?;
    let count = match &rows {
        Rows::At(times) if times.len() > 1 => match found.len() {
            1 => times.len(),
            _ => return Err("several values at several times".to_string()),
        },
        _ => found.len(),
    };
    if expected.len() != 1 && expected.len() != count {
        return Err(format!("{} values are expected of {count}", expected.len()));
    }
    if relation != "=" && tolerance != Tolerance::Exact {
        return Err(format!("`{relation}` has no tolerance"));
    }
    Ok(Claim::Values { found, rows, relation, expected, tolerance })
}

/// `x[1:3]` as `x[1]`, `x[2]`, `x[3]`.
fn expand(formula: Formula, out: &mut Vec<Formula>) -> Result<(), String> {
    let range = match &formula {
        Formula::Name(name) => name.find(':').map(|colon| (name.clone(), colon)),
        _ => None,
    };
    let Some((name, colon)) = range else {
        out.push(formula);
        return Ok(());
    };
    let begin = name[..colon].rfind(['[', ',']).ok_or("a range is out of place")? + 1;
    let end = colon + name[colon..].find([']', ',']).ok_or("a range is out of place")?;
    let bound = |text: &str| text.parse::<usize>().map_err(|_| format!("`{text}` is not a bound"));
    for k in bound(&name[begin..colon])?..=bound(&name[colon + 1..end])? {
        expand(Formula::Name(format!("{}{k}{}", &name[..begin], &name[end..])), out)?;
    }
    Ok(())
}

fn tolerance(parser: &mut Parser) -> Result<Tolerance, String> {
    let make = match () {
        () if parser.word("abs") => Tolerance::Absolute,
        () if parser.word("rel") => Tolerance::Relative,
        () => return Ok(Tolerance::Exact),
    };
    parser.number().map(make).ok_or_else(|| "the tolerance is not a number".to_string())
}
