//! Instants at which the model's expressions of time alone have an extremum, a zero or a jump.
//!
//! In: the tapes of the derivatives and of the zero-crossing indicators. Out: instants that become
//! ends of steps, and the largest step that resolves the oscillations that relations depend on.
//!
//! The error estimate of a step sees only the points at which the step evaluates the model, so a
//! pulse between them goes unnoticed. Its expression gives it away: the argument of
//! `exp(-((time - 0.5)/1e-4)^2)` has its extremum at the pulse, and is wide where the pulse is
//! narrow. So the expressions of time and parameters are evaluated over the whole run on a grid,
//! and a step ends at each of their extrema; if there is a pulse, the error estimate sees it and
//! the steps shrink to its width.

use std::f64::consts::FRAC_PI_2;

use crate::ir::expr::{Binary, Unary};
use crate::ir::program::{Instr, Op, Program, RelationTrigger, Slot};
use crate::numeric::brent::maximum;
use crate::runtime::machine::{Machine, compute};

use super::settings::Settings;

/// Minimum number of intervals of the grid.
const MIN_INTERVALS: f64 = 200.0;
/// Maximum number of intervals of the grid.
const MAX_INTERVALS: f64 = 1000.0;
/// Maximum number of instructions that one look over the run executes: some milliseconds.
const MAX_INSTRUCTIONS: f64 = 2e6;
/// Instants closer than this, as a fraction of the run, are one.
const RESOLUTION: f64 = 1e-9;
/// Accuracy of the location of an extremum, as a fraction of the run.
const LOCATION_TOLERANCE: f64 = 1e-12;
/// Bisections that locate a jump to the spacing of doubles.
const BISECTIONS: u32 = 60;
/// Maximum number of steps that oscillations in relations may ask for.
const MAX_OSCILLATION_STEPS: f64 = 1e6;

/// The features of a run's expressions of time.
#[derive(Debug)]
pub struct TimeFeatures {
    /// Ascending, s.
    instants: Vec<f64>,
    next: usize,
    resolution: f64,
    /// A quarter of the shortest period of a sine or cosine of time that a relation depends on, s;
    /// infinity if there is none.
    pub max_step: f64,
}

/// What a slot depends on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Dependence {
    /// Parameters and literals only.
    Constant,
    /// Time, parameters and literals.
    Time,
    /// States, discrete variables, relations, solutions of loops.
    Other,
}

impl TimeFeatures {
    /// Looks over the run of an initialized machine.
    pub fn new(machine: &mut Machine<'_>, settings: &Settings) -> TimeFeatures {
        let (start, stop) = (settings.start, settings.stop);
        let resolution = RESOLUTION * (stop - start);
        let none = TimeFeatures { instants: vec![], next: 0, resolution, max_step: f64::INFINITY };
        let program = machine.program;
        let (code, depends) = instructions_of_time(program);
        if code.is_empty() || stop <= start {
            return none;
        }
        let in_relations = if code.iter().any(|i| is_oscillation(i.op)) {
            slots_of_relations(program)
        } else {
            Vec::new()
        };
        let interval = settings.spacing.unwrap_or(settings.interval);
        let intervals = ((stop - start) / interval)
            .clamp(MIN_INTERVALS, MAX_INTERVALS)
            .min(MAX_INSTRUCTIONS / code.len() as f64)
            .floor();
        let mut look = Look {
            program,
            memory: machine.snapshot(),
            budget: MAX_INSTRUCTIONS,
            watched: watched(&code, &depends),
            rates: vec![0.0; code.len()],
            found: Vec::new(),
            code,
        };
        look.scan(start, stop, intervals as usize);
        let Look { memory, code, rates, mut found, .. } = look;
        machine.recycle(memory);
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| *a - *b <= resolution);
        let oscillations = code.iter().zip(&rates).filter(|(i, _)| {
            is_oscillation(i.op) && in_relations.get(i.dst as usize).is_some_and(|read| *read)
        });
        let fastest = oscillations.map(|(_, rate)| *rate).fold(0.0, f64::max);
        let shortest = (stop - start) / MAX_OSCILLATION_STEPS;
        TimeFeatures { instants: found, max_step: (FRAC_PI_2 / fastest).max(shortest), ..none }
    }

    /// The end of a step that starts at `t` and must not pass `t_stop`, s: the first instant
    /// between them, if there is one. `t` must not decrease.
    pub fn end_of_step(&mut self, t: f64, t_stop: f64) -> f64 {
        while self.instants.get(self.next).is_some_and(|at| *at <= t + self.resolution) {
            self.next += 1;
        }
        // Just before another stop it would only add a tiny step.
        let is_apart = |at: &f64| *at < t_stop - self.resolution;
        self.instants.get(self.next).copied().filter(is_apart).unwrap_or(t_stop)
    }
}

/// The scan of a run.
struct Look<'p> {
    program: &'p Program,
    memory: Vec<f64>,
    /// Instructions that may still be executed.
    budget: f64,
    code: Vec<Instr>,
    watched: Vec<Watched>,
    /// For each instruction, the largest rate of its first operand, 1/s.
    rates: Vec<f64>,
    found: Vec<f64>,
}

/// A slot whose features count.
#[derive(Clone, Copy)]
struct Watched {
    slot: Slot,
    /// It is the result of a comparison, or of rounding: its jumps count.
    jumps: bool,
    /// It is the argument of a function that may have a feature at zero.
    crosses: bool,
}

impl Look<'_> {
    fn evaluate(&mut self, t: f64) {
        self.budget -= self.code.len() as f64;
        self.memory[self.program.layout.time as usize] = t;
        for i in &self.code {
            compute::<false>(&mut self.memory, i, self.program.externals());
        }
    }

    fn scan(&mut self, start: f64, stop: f64, intervals: usize) {
        let width = self.watched.len();
        let at = |k: usize| start + (stop - start) * (k as f64 / intervals as f64);
        let spacing = (stop - start) / intervals as f64;
        // The values at the last three points of the grid, and the operands at the last.
        let mut rows = [vec![0.0; width], vec![0.0; width], vec![0.0; width]];
        let mut operands = vec![0.0; self.code.len()];
        for k in 0..=intervals {
            self.evaluate(at(k));
            rows.rotate_left(1);
            for (value, w) in rows[2].iter_mut().zip(&self.watched) {
                *value = self.memory[w.slot as usize];
            }
            for (n, i) in self.code.iter().enumerate() {
                let operand = self.memory[i.a as usize];
                if k > 0 {
                    self.rates[n] = self.rates[n].max((operand - operands[n]).abs() / spacing);
                }
                operands[n] = operand;
            }
            for n in 0..width {
                let [a, b, c] = rows.each_ref().map(|row| row[n]);
                let w = self.watched[n];
                if k > 0 && ((w.jumps && b != c) || (w.crosses && b * c < 0.0)) {
                    self.bisect(w, at(k - 1), at(k), b);
                }
                if k > 1 && !w.jumps && (b - a) * (c - b) < 0.0 {
                    self.refine(w.slot, at(k - 2), at(k), b > a, stop - start);
                }
                if self.budget < 0.0 {
                    return;
                }
            }
        }
    }

    /// The instant at which a value departs from `before`, or its sign does.
    fn bisect(&mut self, w: Watched, mut low: f64, mut high: f64, before: f64) {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            self.evaluate(middle);
            let value = self.memory[w.slot as usize];
            let same = if w.jumps { value == before } else { value * before > 0.0 };
            if same { low = middle } else { high = middle }
        }
        self.found.push(high);
    }

    fn refine(&mut self, slot: Slot, low: f64, high: f64, is_maximum: bool, span: f64) {
        let sign = if is_maximum { 1.0 } else { -1.0 };
        let value = |t: f64| {
            self.evaluate(t);
            sign * self.memory[slot as usize]
        };
        let (t, _) = maximum(value, low, high, LOCATION_TOLERANCE * span);
        self.found.push(t);
    }
}

/// The instructions of the derivatives and indicators that compute expressions of time alone, and
/// the dependence of every slot.
fn instructions_of_time(program: &Program) -> (Vec<Instr>, Vec<Dependence>) {
    use Dependence::{Constant, Other, Time};
    let mut depends = vec![Other; program.image.len()];
    for slot in &program.literals {
        depends[*slot as usize] = Constant;
    }
    for i in program.tapes.parameters.iter().filter(|i| is_plain(i.op)) {
        depends[i.dst as usize] = Constant;
    }
    depends[program.layout.time as usize] = Time;
    let mut code = Vec::new();
    for i in program.tapes.rhs.iter().chain(program.tapes.roots.iter()) {
        if !is_plain(i.op) {
            // The slots that it writes depend on other things from the start.
            continue;
        }
        let mut operands = operands_of(i);
        if i.op == Op::CopyIf {
            operands[2] = Some(i.dst);
        }
        let of = |slot: &Slot| depends[*slot as usize];
        let read = operands.iter().flatten().map(of);
        let result = read.fold(Constant, |a, b| match (a, b) {
            (Other, _) | (_, Other) => Other,
            (Time, _) | (_, Time) => Time,
            _ => Constant,
        });
        depends[i.dst as usize] = result;
        // Constants are computed too: the tape of the derivatives may not have run yet.
        if result != Other {
            code.push(*i);
        }
    }
    if !code.iter().any(|i| depends[i.dst as usize] == Time) {
        code.clear();
    }
    (code, depends)
}

/// The slots that an instruction reads, with a free place.
fn operands_of(i: &Instr) -> [Option<Slot>; 3] {
    let unary = matches!(i.op, Op::Copy | Op::Neg | Op::Unary(_));
    [Some(i.a), (!unary).then_some(i.b), None]
}

/// True if an instruction computes its slot from its operands and nothing else.
fn is_plain(op: Op) -> bool {
    use Op::*;
    match op {
        Copy | CopyIf | Input | Add | Sub | Mul | Div | Neg | Unary(_) | Binary(_) => true,
        Solve | Differentiate | Iterate | Call | Jump | JumpUnless | Assert => false,
    }
}

fn is_oscillation(op: Op) -> bool {
    matches!(op, Op::Unary(Unary::Sin | Unary::Cos))
}

/// The slots to watch: the results of all instructions that are not constant, and the arguments of
/// functions.
fn watched(code: &[Instr], depends: &[Dependence]) -> Vec<Watched> {
    let of_time = |slot: Slot| depends[slot as usize] == Dependence::Time;
    let mut argument = vec![false; depends.len()];
    for i in code {
        match i.op {
            Op::Unary(_) | Op::Binary(_) if !is_oscillation(i.op) => {
                argument[i.a as usize] = true;
                argument[i.b as usize] = true;
            }
            Op::Div => argument[i.b as usize] = true,
            _ => {}
        }
    }
    let mut out = Vec::new();
    for i in code.iter().filter(|i| of_time(i.dst) && i.op != Op::Copy) {
        let jumps = matches!(i.op, Op::Binary(op) if is_comparison(op));
        out.push(Watched { slot: i.dst, jumps, crosses: argument[i.dst as usize] });
    }
    out
}

fn is_comparison(op: Binary) -> bool {
    use Binary::*;
    matches!(op, Less | LessEqual | Greater | GreaterEqual | Equal | NotEqual)
}

/// For each slot, whether the indicator of a state-dependent relation may depend on it within one
/// evaluation.
fn slots_of_relations(program: &Program) -> Vec<bool> {
    let mut read = vec![false; program.image.len()];
    for (k, trigger) in program.events.relation_triggers.iter().enumerate() {
        read[program.layout.indicators as usize + k] = *trigger == RelationTrigger::State;
    }
    for i in program.tapes.rhs.iter().chain(program.tapes.roots.iter()).rev() {
        if !is_plain(i.op) {
            // The unknowns of a loop may depend on everything before it.
            read.fill(true);
        } else if read[i.dst as usize] {
            for slot in operands_of(i).into_iter().flatten() {
                read[slot as usize] = true;
            }
        }
    }
    read
}
