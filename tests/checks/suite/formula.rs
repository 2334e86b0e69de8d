//! Formulas of expectations. Closed forms are evaluated here, independently of mocc.

use std::collections::BTreeMap;

/// An arithmetic or logical expression; Booleans are 0 and 1.
#[derive(Clone, PartialEq, Debug)]
pub enum Formula {
    Number(f64),
    /// A local name, `time`, `pi`, or a column of the run.
    Name(String),
    Call(String, Vec<Formula>),
    Negative(Box<Formula>),
    Not(Box<Formula>),
    Binary(&'static str, Box<Formula>, Box<Formula>),
    If(Box<[Formula; 3]>),
    /// The sum of a term for a name that runs over integers.
    Sum {
        name: String,
        range: Box<[Formula; 2]>,
        term: Box<Formula>,
    },
}

/// A function that a case defines: its parameters and its body.
#[derive(Clone, PartialEq, Debug)]
pub struct Function {
    pub parameters: Vec<String>,
    pub body: Formula,
}

/// Where names get their values.
#[derive(Clone, Copy)]
pub struct Scope<'a> {
    pub functions: &'a BTreeMap<String, Function>,
    pub columns: &'a dyn Fn(&str) -> Option<f64>,
    /// Innermost last.
    locals: &'a [(&'a str, f64)],
}

impl<'a> Scope<'a> {
    pub fn new(
        functions: &'a BTreeMap<String, Function>,
        columns: &'a dyn Fn(&str) -> Option<f64>,
    ) -> Scope<'a> {
        Scope { functions, columns, locals: &[] }
    }
    /// The same with local names.
    pub fn with<'b>(self, locals: &'b [(&'b str, f64)]) -> Scope<'b>
    where
        'a: 'b,
    {
        Scope { locals, ..self }
    }

    fn value(&self, name: &str) -> Result<f64, String> {
        let local = self.locals.iter().rev().find(|(n, _)| *n == name).map(|(_, v)| *v);
        let constant = || match self.functions.get(name) {
            Some(f) if f.parameters.is_empty() => Some(f.body.evaluate(self.with(&[]))),
            _ => None,
        };
        let known = || match name {
            "pi" => Some(std::f64::consts::PI),
            "true" => Some(1.0),
            "false" => Some(0.0),
            _ => None,
        };
        match local {
            Some(value) => Ok(value),
            None => constant()
                .or_else(|| (self.columns)(name).or_else(known).map(Ok))
                .unwrap_or_else(|| Err(format!("the run has no column `{name}`"))),
        }
    }

    fn call(&self, name: &str, arguments: &[f64]) -> Result<f64, String> {
        if let Some(function) = self.functions.get(name) {
            if function.parameters.len() != arguments.len() {
                return Err(format!("`{name}` has {} parameters", function.parameters.len()));
            }
            let names = function.parameters.iter().map(String::as_str);
            let locals: Vec<(&str, f64)> = names.zip(arguments.iter().copied()).collect();
            return function.body.evaluate(self.with(&locals));
        }
        Ok(match (name, arguments) {
            ("sqrt", [x]) => x.sqrt(),
            ("exp", [x]) => x.exp(),
            ("log", [x]) => x.ln(),
            ("sin", [x]) => x.sin(),
            ("cos", [x]) => x.cos(),
            ("tan", [x]) => x.tan(),
            ("asin", [x]) => x.asin(),
            ("acos", [x]) => x.acos(),
            ("atan", [x]) => x.atan(),
            ("sinh", [x]) => x.sinh(),
            ("cosh", [x]) => x.cosh(),
            ("tanh", [x]) => x.tanh(),
            ("cbrt", [x]) => x.cbrt(),
            ("abs", [x]) => x.abs(),
            ("floor", [x]) => x.floor(),
            ("ceil", [x]) => x.ceil(),
            ("mod", [x, y]) => x - y * (x / y).floor(),
            ("min", [x, y]) => x.min(*y),
            ("max", [x, y]) => x.max(*y),
            _ => return Err(format!("there is no function `{name}` of {}", arguments.len())),
        })
    }
}

impl Formula {
    /// The value; an error names what is missing.
    pub fn evaluate(&self, scope: Scope<'_>) -> Result<f64, String> {
        let truth = |b: bool| f64::from(u8::from(b));
        Ok(match self {
            Formula::Number(value) => *value,
            Formula::Name(name) => scope.value(name)?,
            Formula::Call(name, arguments) => {
                let values: Result<Vec<f64>, String> =
                    arguments.iter().map(|a| a.evaluate(scope)).collect();
                scope.call(name, &values?)?
            }
            Formula::Negative(x) => -x.evaluate(scope)?,
            Formula::Not(x) => truth(x.evaluate(scope)? == 0.0),
            Formula::If(parts) => {
                let [condition, yes, no] = &**parts;
                let branch = if condition.evaluate(scope)? != 0.0 { yes } else { no };
                branch.evaluate(scope)?
            }
            Formula::Sum { name, range, term } => {
                let (from, to) = (range[0].evaluate(scope)?, range[1].evaluate(scope)?);
                let mut sum = 0.0;
                let mut k = from;
                while k <= to {
                    let mut locals = scope.locals.to_vec();
                    locals.push((name, k));
                    sum += term.evaluate(scope.with(&locals))?;
                    k += 1.0;
                }
                sum
            }
            Formula::Binary("and", x, y) => {
                truth(x.evaluate(scope)? != 0.0 && y.evaluate(scope)? != 0.0)
            }
            Formula::Binary("or", x, y) => {
                truth(x.evaluate(scope)? != 0.0 || y.evaluate(scope)? != 0.0)
            }
            Formula::Binary(operator, x, y) => {
                let (x, y) = (x.evaluate(scope)?, y.evaluate(scope)?);
                match *operator {
                    "+" => x + y,
                    "-" => x - y,
                    "*" => x * y,
                    "/" => x / y,
                    // As in Rust, a power with an integer is a product.
                    "^" if y.fract() == 0.0 && y.abs() < 1e9 => x.powi(y as i32),
                    "^" => x.powf(y),
                    relation => truth(holds(relation, x, y)),
                }
            }
        })
    }
}

/// Whether a relation holds between two numbers.
pub fn holds(relation: &str, x: f64, y: f64) -> bool {
    match relation {
        "=" | "==" => x == y,
        "<>" => x != y,
        "<" => x < y,
        "<=" => x <= y,
        ">" => x > y,
        ">=" => x >= y,
        _ => unreachable!("`{relation}` is a relation"),
    }
}

/// A word of a directive.
#[derive(Clone, PartialEq, Debug)]
pub enum Token {
    Number(f64),
    /// Between double quotes.
    Text(String),
    /// A component reference, `der(x)` included.
    Name(String),
    Sign(&'static str),
}

const SIGNS: [&str; 18] =
    ["==", "<>", "<=", ">=", "<", ">", "=", "+", "-", "*", "/", "^", "(", ")", ",", ":", "[", "]"];

/// Takes a directive apart.
pub fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut out = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if first.is_ascii_digit() {
            let length = number(rest);
            out.push(Token::Number(
                rest[..length]
                    .parse()
                    .map_err(|_| format!("`{}` is not a number", &rest[..length]))?,
            ));
            length
        } else if first == '"' {
            let end = rest[1..].find('"').ok_or("a string has no end")? + 1;
            out.push(Token::Text(rest[1..end].to_string()));
            end + 1
        } else if first.is_alphabetic() || "_'$".contains(first) {
            let length = reference(rest)?;
            out.push(Token::Name(rest[..length].replace(' ', "")));
            length
        } else if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
            out.push(Token::Sign(sign));
            sign.len()
        } else {
            return Err(format!("`{first}` is out of place"));
        };
        rest = rest[length..].trim_start();
    }
    Ok(out)
}

fn number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut end = 0;
    while let Some(b) = bytes.get(end) {
        let sign = matches!(b, b'+' | b'-') && matches!(bytes[end - 1], b'e' | b'E');
        if !(b.is_ascii_digit() || matches!(b, b'.' | b'e' | b'E') || sign) {
            break;
        }
        end += 1;
    }
    end
}

/// The length of `a.b[1, 2].c`, `'a.b'` or `der(a.b)`.
fn reference(text: &str) -> Result<usize, String> {
    let mut end = 0;
    loop {
        let rest = &text[end..];
        if let Some(quoted) = rest.strip_prefix('\'') {
            end += quoted.find('\'').ok_or("a quoted name has no end")? + 2;
        } else {
            let part = |c: char| !(c.is_alphanumeric() || "_$".contains(c));
            end += rest.find(part).unwrap_or(rest.len());
        }
        if &text[..end] == "der" && text[end..].starts_with('(') {
            return Ok(end + text[end..].find(')').ok_or("`der(` has no end")? + 1);
        }
        if text[end..].starts_with('[') {
            end += text[end..].find(']').ok_or("a subscript has no end")? + 1;
        }
        let more = |c: char| c.is_alphabetic() || "_'$".contains(c);
        match text[end..].strip_prefix('.') {
            Some(rest) if rest.starts_with(more) => end += 1,
            _ => return Ok(end),
        }
    }
}

/// Reads tokens from the left.
pub struct Parser {
    tokens: Vec<Token>,
    at: usize,
}

impl Parser {
    pub fn new(text: &str) -> Result<Parser, String> {
        Ok(Parser { tokens: tokens(text)?, at: 0 })
    }
    pub fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }
    pub fn next(&mut self) -> Option<Token> {
        self.at += 1;
        self.tokens.get(self.at - 1).cloned()
    }
    /// Whether the next word is this one, which is then read.
    pub fn word(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), Some(Token::Name(n)) if n == word);
        self.at += usize::from(found);
        found
    }
    pub fn sign(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Some(Token::Sign(s)) if *s == sign);
        self.at += usize::from(found);
        found
    }
    /// A text between quotes.
    pub fn text(&mut self) -> Option<String> {
        let Some(Token::Text(text)) = self.peek().cloned() else { return None };
        self.at += 1;
        Some(text)
    }
    pub fn number(&mut self) -> Option<f64> {
        let Some(Token::Number(value)) = self.peek().cloned() else { return None };
        self.at += 1;
        Some(value)
    }
    /// Nothing may be left.
    pub fn end(&self) -> Result<(), String> {
        match self.peek() {
            None => Ok(()),
            Some(token) => Err(format!("{token:?} is out of place")),
        }
    }
    fn expect(&mut self, sign: &str) -> Result<(), String> {
        if self.sign(sign) { Ok(()) } else { Err(format!("`{sign}` is missing")) }
    }
    /// Formulas between commas, without relations.
    pub fn sums(&mut self) -> Result<Vec<Formula>, String> {
        let mut out = vec![self.sum()?];
        while self.sign(",") {
            out.push(self.sum()?);
        }
        Ok(out)
    }
    /// Formulas between commas.
    pub fn formulas(&mut self) -> Result<Vec<Formula>, String> {
        let mut out = vec![self.formula()?];
        while self.sign(",") {
            out.push(self.formula()?);
        }
        Ok(out)
    }
    pub fn formula(&mut self) -> Result<Formula, String> {
        if self.word("if") {
            let condition = self.formula()?;
            if !self.word("then") {
                return Err("`then` is missing".to_string());
            }
            let yes = self.formula()?;
            if !self.word("else") {
                return Err("`else` is missing".to_string());
            }
            let no = self.formula()?;
            return Ok(Formula::If(Box::new([condition, yes, no])));
        }
        let mut left = self.conjunction()?;
        while self.word("or") {
            left = Formula::Binary("or", Box::new(left), Box::new(self.conjunction()?));
        }
        Ok(left)
    }
    fn conjunction(&mut self) -> Result<Formula, String> {
        let mut left = self.relation()?;
        while self.word("and") {
            left = Formula::Binary("and", Box::new(left), Box::new(self.relation()?));
        }
        Ok(left)
    }
    fn relation(&mut self) -> Result<Formula, String> {
        if self.word("not") {
            return Ok(Formula::Not(Box::new(self.relation()?)));
        }
        let left = self.sum()?;
        for sign in ["==", "<>", "<=", ">=", "<", ">"] {
            if self.sign(sign) {
                return Ok(Formula::Binary(sign, Box::new(left), Box::new(self.sum()?)));
            }
        }
        Ok(left)
    }
    /// Terms with `+` and `-`.
    pub fn sum(&mut self) -> Result<Formula, String> {
        let mut left = match self.sign("-") {
            true => Formula::Negative(Box::new(self.product()?)),
            false => self.product()?,
        };
        loop {
            let sign = match self.peek() {
                Some(Token::Sign(s @ ("+" | "-"))) => *s,
                _ => return Ok(left),
            };
            self.at += 1;
            left = Formula::Binary(sign, Box::new(left), Box::new(self.product()?));
        }
    }
    fn product(&mut self) -> Result<Formula, String> {
        let mut left = self.power()?;
        loop {
            let sign = match self.peek() {
                Some(Token::Sign(s @ ("*" | "/"))) => *s,
                _ => return Ok(left),
            };
            self.at += 1;
            left = Formula::Binary(sign, Box::new(left), Box::new(self.power()?));
        }
    }
    fn power(&mut self) -> Result<Formula, String> {
        let base = self.primary()?;
        match self.sign("^") {
            true => Ok(Formula::Binary("^", Box::new(base), Box::new(self.primary()?))),
            false => Ok(base),
        }
    }
    fn primary(&mut self) -> Result<Formula, String> {
        match self.next() {
            Some(Token::Number(value)) => Ok(Formula::Number(value)),
            Some(Token::Sign("-")) => Ok(Formula::Negative(Box::new(self.power()?))),
            Some(Token::Sign("(")) => {
                let inner = self.formula()?;
                self.expect(")")?;
                Ok(inner)
            }
            Some(Token::Name(name)) if self.sign("(") => {
                let mut arguments = self.formulas()?;
                if name == "sum" && self.word("for") {
                    let (Some(Token::Name(name)), true) = (self.next(), self.word("in")) else {
                        return Err("write `sum(TERM for NAME in FROM:TO)`".to_string());
                    };
                    let from = self.sum()?;
                    self.expect(":")?;
                    let range = Box::new([from, self.sum()?]);
                    self.expect(")")?;
                    let term = Box::new(arguments.remove(0));
                    return Ok(Formula::Sum { name, range, term });
                }
                self.expect(")")?;
                Ok(Formula::Call(name, arguments))
            }
            Some(Token::Name(name)) => Ok(Formula::Name(name)),
            Some(token) => Err(format!("{token:?} is out of place")),
            None => Err("the end comes too early".to_string()),
        }
    }
}

#[test]
fn formulas_have_the_values_of_arithmetic() {
    let mut functions = BTreeMap::new();
    let body = Parser::new("if n < 2 then n else f(n - 1) + f(n - 2)").unwrap().formula().unwrap();
    functions.insert("f".to_string(), Function { parameters: vec!["n".to_string()], body });
    let columns = |name: &str| (name == "a.b[1,2]").then_some(7.0);
    for (text, expected) in [
        ("1 + 2*3^2/2 - -4", 14.0),
        ("-2^2", -4.0),
        ("a.b[1, 2] - 2e-1", 6.8),
        ("f(10)", 55.0),
        ("sum(k^2 for k in 1:3)", 14.0),
        ("sin(pi/6)*2", 1.0),
        ("if not 1 > 2 and true then max(1, 2) else 0", 2.0),
        ("mod(-1, 3)", 2.0),
    ] {
        let mut parser = Parser::new(text).expect(text);
        let formula = parser.formula().expect(text);
        parser.end().expect(text);
        let found = formula.evaluate(Scope::new(&functions, &columns)).expect(text);
        assert!((found - expected).abs() < 1e-14, "{text}: {found}");
    }
    for wrong in ["1 +", "(1", "f(1", "1 2", "der(x", "#"] {
        let read = Parser::new(wrong).and_then(|mut p| p.formula().and_then(|_| p.end()));
        assert!(read.is_err(), "{wrong}");
    }
}
