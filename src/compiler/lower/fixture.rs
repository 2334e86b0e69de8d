//! Flat models for tests in a line-based syntax: one scalar declaration or equation per line.
//!
//! ```text
//! parameter Real R = 10;
//! Real x(start = 1, fixed = true, stateSelect = prefer);
//! equation
//! der(x) = -x / R;
//! when {x < 0.5, sample(0, 1)} then
//! reinit(x, 1);
//! end when;
//! ```

use crate::base::source::{SourceMap, Span};
use crate::ir::expr::{Binary, ExprId, FunctionId, Node, Type, Unary, VarId};
use crate::ir::flat::*;

/// Parses a model; the source map holds its source for diagnostics.
pub fn model(text: &str) -> (FlatModel, SourceMap) {
    let mut sources = SourceMap::default();
    let file = sources.add("model.mo", text);
    let mut parser =
        FixtureParser { flat: FlatModel::new("M", Span::new(file, 0, 0)), tokens: vec![], at: 0 };
    // Names first: values may refer to later declarations.
    let declarations =
        text.split_inclusive('\n').take_while(|line| !line.trim().ends_with("equation"));
    let mut offset = 0;
    for line in declarations {
        parser.tokens = tokens(line.split("//").next().unwrap().trim().trim_end_matches(';'));
        parser.at = 0;
        let start = offset + line.len() - line.trim_start().len();
        offset += line.len();
        if !parser.tokens.is_empty() {
            let end = start + line.trim().trim_end_matches(';').len();
            parser.declare(Span::new(file, start, end));
        }
    }
    let (mut initial, mut declarations) = (false, true);
    let mut branches: Option<(Vec<WhenBranch>, Span)> = None;
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        let start = offset + line.len() - line.trim_start().len();
        offset += line.len();
        let span = Span::new(file, start, start + line.trim().trim_end_matches(';').len());
        let line = line.split("//").next().unwrap().trim().trim_end_matches(';');
        parser.tokens = tokens(line);
        parser.at = 0;
        match line {
            "" => {}
            "equation" => (declarations, initial) = (false, false),
            "initial equation" => (declarations, initial) = (false, true),
            "end when" => {
                let (branches, span) = branches.take().unwrap();
                parser.push(EquationKind::When(branches), span, false);
            }
            _ if declarations => parser.attributes(span),
            _ if line.starts_with("when ") || line.starts_with("elsewhen ") => {
                parser.at = 1;
                let (list, _) = branches.get_or_insert((vec![], span));
                let conditions = parser.conditions();
                list.push(WhenBranch { conditions, actions: vec![] });
            }
            _ => match &mut branches {
                Some((list, _)) => {
                    let action = parser.action();
                    list.last_mut().unwrap().actions.push(action);
                }
                None => {
                    let kind = parser.equation();
                    parser.push(kind, span, initial);
                }
            },
        }
    }
    (parser.flat, sources)
}

struct FixtureParser {
    flat: FlatModel,
    tokens: Vec<String>,
    at: usize,
}

impl FixtureParser {
    fn push(&mut self, kind: EquationKind, span: Span, initial: bool) {
        let equation = Equation { kind, origin: Origin { span, component: "".into() } };
        if initial {
            self.flat.initial_equations.push(equation);
        } else {
            self.flat.equations.push(equation);
        }
    }

    fn peek(&self) -> &str {
        self.tokens.get(self.at).map_or("", |t| t)
    }

    fn next(&mut self) -> String {
        self.at += 1;
        self.tokens[self.at - 1].clone()
    }

    fn accept(&mut self, token: &str) -> bool {
        let found = self.peek() == token;
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, token: &str) {
        assert!(self.accept(token), "expected {token} in {:?} at {}", self.tokens, self.at);
    }

    fn declare(&mut self, span: Span) {
        let (mut variability, mut causality) = (Variability::Continuous, None);
        let ty = loop {
            match self.next().as_str() {
                "parameter" => variability = Variability::Parameter,
                "constant" => variability = Variability::Constant,
                "discrete" => variability = Variability::Discrete,
                "input" => causality = Some(Causality::Input),
                "output" => causality = Some(Causality::Output),
                "Real" => break Type::Real,
                "Integer" => break Type::Integer,
                "Boolean" => break Type::Boolean,
                other => panic!("{other}"),
            }
        };
        if ty != Type::Real {
            variability = variability.min(Variability::Discrete);
        }
        let name = self.next();
        let variable = Variable::bare(name, ty, variability, span);
        self.flat.variables.push(Variable { causality, ..variable });
    }

    /// Parses the attributes and the binding of the variable declared at `span`.
    fn attributes(&mut self, span: Span) {
        let found = self.flat.variables.enumerate().find(|(_, v)| v.span == span);
        let (id, name) = found.map(|(id, v)| (id, v.name.clone())).unwrap();
        while self.next() != name {}
        if self.accept("(") {
            while !self.accept(")") {
                let attribute = self.next();
                self.expect("=");
                if attribute == "stateSelect" {
                    self.flat.variables[id].state_select = match self.next().as_str() {
                        "never" => StateSelect::Never,
                        "avoid" => StateSelect::Avoid,
                        "prefer" => StateSelect::Prefer,
                        "always" => StateSelect::Always,
                        other => panic!("{other}"),
                    };
                } else if attribute == "fixed" {
                    self.flat.variables[id].fixed = Some(self.next() == "true");
                } else {
                    let value = Some(self.expression(0));
                    let v = &mut self.flat.variables[id];
                    match attribute.as_str() {
                        "start" => v.start = value,
                        "min" => v.min = value,
                        "max" => v.max = value,
                        "nominal" => v.nominal = value,
                        other => panic!("{other}"),
                    }
                }
                self.accept(",");
            }
        }
        if self.accept("=") {
            self.flat.variables[id].binding = Some(self.expression(0));
        }
    }

    fn conditions(&mut self) -> Vec<ExprId> {
        if !self.accept("{") {
            return vec![self.expression(0)];
        }
        let mut list = vec![];
        while !self.accept("}") {
            list.push(self.expression(0));
            self.accept(",");
        }
        list
    }

    fn equation(&mut self) -> EquationKind {
        if self.accept("assert") {
            return EquationKind::Assert(self.assert());
        }
        let lhs = self.expression(0);
        self.expect("=");
        EquationKind::Equal(lhs, self.expression(0))
    }

    fn action(&mut self) -> Action {
        if self.accept("assert") {
            return Action::Assert(self.assert());
        }
        if self.accept("terminate") {
            self.expect("(");
            return Action::Terminate { message: self.expression(0), guard: None };
        }
        if self.accept("reinit") {
            self.expect("(");
            let state = self.variable();
            self.expect(",");
            return Action::Reinit { state, value: self.expression(0), guard: None };
        }
        let v = self.variable();
        self.expect("=");
        Action::Assign(v, self.expression(0))
    }

    fn assert(&mut self) -> Assert {
        self.expect("(");
        let condition = self.expression(0);
        self.expect(",");
        let message = self.expression(0);
        Assert { condition, message, level: AssertionLevel::Error }
    }

    fn variable(&mut self) -> VarId {
        let name = self.next();
        let found = self.flat.variables.enumerate().find(|(_, v)| v.name == name);
        found.unwrap_or_else(|| panic!("no variable {name}")).0
    }

    fn expression(&mut self, least: u8) -> ExprId {
        let mut left = self.prefix();
        loop {
            let (op, strength) = match self.peek() {
                "or" => (Binary::Or, 1),
                "and" => (Binary::And, 2),
                "<" => (Binary::Less, 4),
                "<=" => (Binary::LessEqual, 4),
                ">" => (Binary::Greater, 4),
                ">=" => (Binary::GreaterEqual, 4),
                "==" => (Binary::Equal, 4),
                "<>" => (Binary::NotEqual, 4),
                "+" => (Binary::Add, 5),
                "-" => (Binary::Sub, 5),
                "*" => (Binary::Mul, 6),
                "/" => (Binary::Div, 6),
                "^" => (Binary::Pow, 7),
                _ => return left,
            };
            if strength <= least {
                return left;
            }
            self.at += 1;
            let right = self.expression(strength);
            left = self.flat.graph.binary(op, left, right);
        }
    }

    fn prefix(&mut self) -> ExprId {
        let token = self.next();
        match token.as_str() {
            "-" => {
                let e = self.expression(5);
                self.flat.graph.neg(e)
            }
            "not" => {
                let e = self.expression(3);
                self.flat.graph.not(e)
            }
            "(" => {
                let e = self.expression(0);
                self.expect(")");
                e
            }
            "if" => {
                let c = self.expression(0);
                self.expect("then");
                let a = self.expression(0);
                self.expect("else");
                let b = self.expression(0);
                self.flat.graph.if_then_else(c, a, b)
            }
            "true" | "false" => self.flat.graph.boolean(token == "true"),
            "time" => self.flat.graph.time(),
            "der" | "pre" => {
                self.expect("(");
                let v = self.variable();
                self.expect(")");
                let ty = self.flat.variables[v].ty;
                let g = &mut self.flat.graph;
                if token == "der" { g.der(v) } else { g.pre(v, ty) }
            }
            _ if token.starts_with('"') => self.flat.graph.string(token.trim_matches('"')),
            _ if token.as_bytes()[0].is_ascii_digit() => match token.parse::<i64>() {
                Ok(i) => self.flat.graph.integer(i),
                Err(_) => self.flat.graph.real(token.parse().unwrap()),
            },
            _ if self.peek() == "(" => self.call(&token),
            _ => {
                self.at -= 1;
                let v = self.variable();
                self.flat.read(v)
            }
        }
    }

    fn call(&mut self, function: &str) -> ExprId {
        self.expect("(");
        let mut args = vec![];
        while !self.accept(")") {
            args.push(self.expression(0));
            self.accept(",");
        }
        let g = &mut self.flat.graph;
        match (function, &args[..]) {
            ("noEvent", &[a]) => g.no_event(a),
            ("sample", &[a, b]) => g.intern(Node::Sample(a, b), Type::Boolean),
            ("f", args) => {
                let args = g.intern_list(args);
                let function = FunctionId(0);
                g.intern(Node::Call { function, output: 0, args }, Type::Real)
            }
            ("initial", []) => g.intern(Node::Initial, Type::Boolean),
            ("terminal", []) => g.intern(Node::Terminal, Type::Boolean),
            (name, &[a]) => g.unary(Unary::called(name).expect(name), a),
            other => panic!("{other:?}"),
        }
    }
}

fn tokens(line: &str) -> Vec<String> {
    let chars: Vec<char> = line.chars().collect();
    let mut list = vec![];
    let mut i = 0;
    while i < chars.len() {
        let start = i;
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        match chars[i] {
            c if c.is_whitespace() => {
                i += 1;
                continue;
            }
            '"' => {
                i += 1;
                while chars[i] != '"' {
                    i += 1;
                }
                i += 1;
            }
            c if is_word(c) => {
                while i < chars.len() && is_word(chars[i]) {
                    i += 1;
                }
            }
            '<' | '>' | '=' if chars.get(i + 1).is_some_and(|c| "=>".contains(*c)) => i += 2,
            _ => i += 1,
        }
        list.push(chars[start..i].iter().collect());
    }
    list
}
