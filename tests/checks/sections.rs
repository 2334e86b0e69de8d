//! Algorithm sections with when-statements against an interpreter that does what Modelica 3.6 says in
//! sections 8.3.5 and 11.1: at each iteration of an event, all variables begin with their values before it,
//! the statements are executed in order, and a branch is entered if one of its conditions has become true.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::door::{Case, Reading};

const VARIABLES: usize = 4;
const NAMES: [&str; VARIABLES] = ["a", "b", "c", "d"];
const SECTIONS: u64 = 60;
/// Iterations of an event after which a section is taken not to settle.
const MOST_ITERATIONS: usize = 60;
/// Larger values are set to zero.
const LARGEST: i64 = 40;

type Values = [i64; VARIABLES];

/// Random numbers (Knuth, The Art of Computer Programming 2, section 3.3.4).
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn between(&mut self, a: i64, b: i64) -> i64 {
        a + self.below((b - a + 1) as u64) as i64
    }

    fn variable(&mut self) -> usize {
        self.below(VARIABLES as u64) as usize
    }
}

enum Expression {
    Number(i64),
    Sum(usize, i64),
    Difference(usize, usize),
    Before(usize),
    Greater(usize, usize),
}

enum Condition {
    /// `sample(start, interval)`
    Ticks(i64, i64),
    /// `variable > number`
    Above(usize, i64),
}

enum Statement {
    Assign(usize, Expression),
    If(Condition, Vec<Statement>, Vec<Statement>),
    When(Vec<(Vec<Condition>, Vec<Statement>)>),
}

fn expression(r: &mut Random) -> Expression {
    match r.below(5) {
        0 => Expression::Number(r.between(-3, 6)),
        1 => Expression::Sum(r.variable(), r.between(-2, 3)),
        2 => Expression::Difference(r.variable(), r.variable()),
        3 => Expression::Before(r.variable()),
        _ => Expression::Greater(r.variable(), r.variable()),
    }
}

fn condition(r: &mut Random) -> Condition {
    match r.below(3) {
        0 => Condition::Above(r.variable(), r.between(0, 6)),
        _ => Condition::Ticks(r.between(1, 4), r.between(1, 4)),
    }
}

fn body(r: &mut Random, nested: bool) -> Vec<Statement> {
    let statement = |r: &mut Random| match r.below(4) {
        0 if !nested => {
            let condition = Condition::Above(r.variable(), r.between(-2, 5));
            Statement::If(condition, body(r, true), body(r, true))
        }
        _ => Statement::Assign(r.variable(), expression(r)),
    };
    (0..=r.below(3)).map(|_| statement(r)).collect()
}

fn section(r: &mut Random) -> Vec<Statement> {
    let branch = |r: &mut Random| {
        let conditions = (0..=r.below(2)).map(|_| condition(r)).collect();
        (conditions, body(r, false))
    };
    let statement = |r: &mut Random| match r.below(4) {
        0 => {
            let (v, most) = (r.variable(), r.between(15, 25));
            let reset = Statement::Assign(v, Expression::Number(r.between(0, 3)));
            Statement::If(Condition::Above(v, most), vec![reset], Vec::new())
        }
        _ => Statement::When((0..=r.below(2)).map(|_| branch(r)).collect()),
    };
    let mut all: Vec<Statement> = (0..2 + r.below(4)).map(|_| statement(r)).collect();
    for v in 0..VARIABLES {
        // Every other one is assigned by when-statements alone.
        if r.below(2) == 0 {
            let zero = vec![Statement::Assign(v, Expression::Number(0))];
            all.push(Statement::If(Condition::Above(v, LARGEST), zero, Vec::new()));
        }
    }
    all
}

fn written(e: &Expression) -> String {
    match e {
        Expression::Number(n) => n.to_string(),
        Expression::Sum(v, n) => format!("{} + ({n})", NAMES[*v]),
        Expression::Difference(v, w) => format!("{} - {}", NAMES[*v], NAMES[*w]),
        Expression::Before(v) => format!("pre({}) + 1", NAMES[*v]),
        Expression::Greater(v, w) => {
            let (v, w) = (NAMES[*v], NAMES[*w]);
            format!("if {v} > {w} then {v} else {w} + 1")
        }
    }
}

fn written_condition(c: &Condition) -> String {
    match c {
        Condition::Ticks(start, interval) => format!("sample({start}, {interval})"),
        Condition::Above(v, n) => format!("{} > {n}", NAMES[*v]),
    }
}

fn write_all(list: &[Statement], out: &mut String) {
    for s in list {
        match s {
            Statement::Assign(v, e) => writeln!(out, "{} := {};", NAMES[*v], written(e)).unwrap(),
            Statement::If(c, yes, no) => {
                writeln!(out, "if {} then", written_condition(c)).unwrap();
                write_all(yes, out);
                out.push_str("else\n");
                write_all(no, out);
                out.push_str("end if;\n");
            }
            Statement::When(branches) => {
                for (k, (conditions, body)) in branches.iter().enumerate() {
                    let all: Vec<String> = conditions.iter().map(written_condition).collect();
                    let word = if k == 0 { "when" } else { "elsewhen" };
                    writeln!(out, "{word} {{{}}} then", all.join(", ")).unwrap();
                    write_all(body, out);
                }
                out.push_str("end when;\n");
            }
        }
    }
}

fn assigns(list: &[Statement], v: usize) -> bool {
    list.iter().any(|s| match s {
        Statement::Assign(w, _) => *w == v,
        Statement::If(_, yes, no) => assigns(yes, v) || assigns(no, v),
        Statement::When(branches) => branches.iter().any(|(_, body)| assigns(body, v)),
    })
}

/// The conditions of when-statements by their place of appearance.
type Conditions = BTreeMap<*const Condition, bool>;

/// One iteration of an event.
struct Pass<'a> {
    now: Values,
    before: Values,
    conditions: Conditions,
    conditions_before: &'a Conditions,
    /// The time, if it is the first iteration at a tick.
    tick: Option<i64>,
    initial: bool,
}

impl Pass<'_> {
    fn value(&self, e: &Expression) -> i64 {
        match *e {
            Expression::Number(n) => n,
            Expression::Sum(v, n) => self.now[v] + n,
            Expression::Difference(v, w) => self.now[v] - self.now[w],
            Expression::Before(v) => self.before[v] + 1,
            Expression::Greater(v, w) if self.now[v] > self.now[w] => self.now[v],
            Expression::Greater(_, w) => self.now[w] + 1,
        }
    }

    fn holds(&self, c: &Condition) -> bool {
        match *c {
            Condition::Above(v, n) => self.now[v] > n,
            Condition::Ticks(start, interval) => {
                self.tick.is_some_and(|t| t >= start && (t - start) % interval == 0)
            }
        }
    }

    fn execute(&mut self, list: &[Statement]) {
        for s in list {
            match s {
                Statement::Assign(v, e) => self.now[*v] = self.value(e),
                Statement::If(c, yes, _) if self.holds(c) => self.execute(yes),
                Statement::If(_, _, no) => self.execute(no),
                Statement::When(branches) => self.execute_when(branches),
            }
        }
    }

    fn execute_when(&mut self, branches: &[(Vec<Condition>, Vec<Statement>)]) {
        let mut entered = None;
        for (conditions, body) in branches {
            for c in conditions {
                let holds = self.holds(c);
                let held = self.conditions_before.get(&std::ptr::from_ref(c)).copied();
                self.conditions.insert(c, holds);
                if holds && held != Some(true) && entered.is_none() {
                    entered = Some(body);
                }
            }
        }
        if let Some(body) = entered.filter(|_| !self.initial) {
            self.execute(body);
        }
    }
}

/// Iterates an event until nothing changes; `None` if it does not settle.
fn event(
    list: &[Statement],
    (mut values, mut conditions): (Values, Conditions),
    time: Option<i64>,
) -> Option<(Values, Conditions)> {
    for k in 0..MOST_ITERATIONS {
        let first = k == 0;
        let mut pass = Pass {
            now: values,
            before: values,
            conditions: Conditions::new(),
            conditions_before: &conditions,
            tick: time.filter(|_| first),
            initial: first && time.is_none(),
        };
        pass.execute(list);
        let settled = pass.now == values && pass.conditions == conditions;
        (values, conditions) = (pass.now, pass.conditions);
        if settled {
            return Some((values, conditions));
        }
    }
    None
}

#[test]
fn sections_are_executed_in_order() {
    let mut compared = 0;
    for seed in 0..SECTIONS {
        let mut r = Random(seed);
        let list = section(&mut r);
        let start: Values = std::array::from_fn(|_| r.between(-1, 2));
        let mut model = "model M\n".to_string();
        for (name, start) in NAMES.iter().zip(start) {
            writeln!(model, "Integer {name}(start = {start}, fixed = true);").unwrap();
        }
        model.push_str("algorithm\n");
        write_all(&list, &mut model);
        for (v, name) in NAMES.iter().enumerate() {
            if !assigns(&list, v) {
                writeln!(model, "{name} := {name};").unwrap();
            }
        }
        model.push_str("end M;\n");
        let run = Case::text(&model).stop(10.5).interval(0.5).run();
        let mut state = event(&list, (start, Conditions::new()), None);
        for t in 1..=10 {
            state = state.and_then(|s| event(&list, s, Some(t)));
            let Some((expected, _)) = &state else { break };
            for (name, expected) in NAMES.iter().zip(expected) {
                let found = run.at(name, t as f64 + 0.25);
                assert_eq!(found, *expected as f64, "{name} at {t} in section {seed}:\n{model}");
                compared += 1;
            }
        }
    }
    assert!(compared > 2000, "{compared} values were compared");
}
