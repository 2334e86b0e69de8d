//! The instructions of a program that compute expressions of time, and which of their results count.

use crate::base::index::{FastSet, Id};
use crate::ir::dae::VariableKind;
use crate::ir::expr::{Binary, Unary};
use crate::ir::program::{Instr, Op, Program, RelationTrigger, Slot};

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

/// The expressions of time of a program.
pub struct Expressions {
    /// The instructions of the derivatives and indicators that compute them.
    pub code: Vec<Instr>,
    depends: Vec<Dependence>,
}

impl Expressions {
    /// Those of time and parameters alone.
    pub fn of_time(program: &Program) -> Expressions {
        Expressions::among(program, &[])
    }

    /// Those of time, parameters and variables that change at events only.
    pub fn between_events(program: &Program) -> Expressions {
        let layout = &program.layout;
        let relations = program.events.relation_triggers.len() as Slot;
        let mut held: Vec<Slot> = (layout.relations..layout.relations + relations).collect();
        held.extend(layout.pre.iter().flat_map(|(_, own, pre)| [*own, *pre]));
        let variables = program.blocks.dae.variables.enumerate();
        let discrete = variables.filter(|(_, x)| x.kind == VariableKind::Discrete);
        held.extend(discrete.map(|(v, _)| layout.variables[v.idx()]));
        held.extend(program.tapes.discrete.iter().map(|i| i.dst));
        Expressions::among(program, &held)
    }

    /// Those of time, parameters and the slots `held`.
    fn among(program: &Program, held: &[Slot]) -> Expressions {
        use Dependence::{Constant, Other, Time};
        let mut depends = vec![Other; program.image.len()];
        for slot in program.literals.iter().chain(held) {
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
        Expressions { code, depends }
    }

    /// The slots to watch: the results of all instructions that are not constant, and the arguments of functions.
    pub fn watched(&self) -> Vec<Watched> {
        let mut argument = vec![false; self.depends.len()];
        for i in &self.code {
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
        for i in self.code.iter().filter(|i| self.is_of_time(i.dst) && i.op != Op::Copy) {
            let jumps = matches!(i.op, Op::Binary(op) if is_comparison(op));
            out.push(Watched { slot: i.dst, jumps, crosses: argument[i.dst as usize] });
        }
        out
    }

    /// The same, without those that `others` has as well and those that no function can turn into a pulse.
    pub fn watched_besides(&self, others: &Expressions) -> Vec<Watched> {
        let sharpened = self.sharpened();
        let mut all = self.watched();
        all.retain(|w| sharpened[w.slot as usize] && !others.is_of_time(w.slot) && !w.jumps);
        all
    }

    /// The slots that the instructions read and none of them writes.
    pub fn inputs(&self) -> Vec<Slot> {
        let mut inputs: Vec<Slot> = self.code.iter().flat_map(operands_of).flatten().collect();
        inputs.sort_unstable();
        inputs.dedup();
        let written: FastSet<Slot> = self.code.iter().map(|i| i.dst).collect();
        inputs.retain(|slot| !written.contains(slot));
        inputs
    }

    /// For each slot, whether a function that can turn small changes into a pulse or a kink depends on it, or is computed
    /// in it.
    pub fn sharpened(&self) -> Vec<bool> {
        let mut sharpened = vec![false; self.depends.len()];
        for i in self.code.iter().rev() {
            let is_sharp = match i.op {
                Op::Unary(_) => !is_oscillation(i.op),
                Op::Binary(_) => true,
                _ => false,
            };
            if is_sharp {
                sharpened[i.dst as usize] = true;
            }
            if i.op == Op::Div {
                sharpened[i.b as usize] = true;
            }
            if sharpened[i.dst as usize] {
                for slot in operands_of(i).into_iter().flatten() {
                    sharpened[slot as usize] = true;
                }
            }
        }
        sharpened
    }

    fn is_of_time(&self, slot: Slot) -> bool {
        self.depends[slot as usize] == Dependence::Time
    }
}

/// A slot whose features count.
#[derive(Clone, Copy)]
pub struct Watched {
    /// Its position.
    pub slot: Slot,
    /// It is the result of a comparison, or of rounding: its jumps count.
    pub jumps: bool,
    /// It is the argument of a function that may have a feature at zero.
    pub crosses: bool,
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

/// True for a sine or cosine.
pub fn is_oscillation(op: Op) -> bool {
    matches!(op, Op::Unary(Unary::Sin | Unary::Cos))
}

fn is_comparison(op: Binary) -> bool {
    use Binary::*;
    matches!(op, Less | LessEqual | Greater | GreaterEqual | Equal | NotEqual)
}

/// For each slot, whether the indicator of a state-dependent relation may depend on it within one
/// evaluation.
pub fn slots_of_relations(program: &Program) -> Vec<bool> {
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
