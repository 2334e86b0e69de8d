//! Machine code and interpreter leave the same values in every slot.

use std::sync::Arc;

use crate::base::diag::Problems;
use crate::base::source::Span;
use crate::codegen::compile;
use crate::ir::expr::{Binary, Unary};
use crate::ir::program::{CallSite, FunctionCode, Instr, Op, Program, Slot};
use crate::lower::fixture::model;
use crate::lower::lower;
use crate::structure::structure;
use mocc_engine::runtime::jit::tiering::Execution;
use mocc_engine::runtime::jit::{MAX_FRAGMENT_LENGTH, MachineCode, TranslationError};
use mocc_engine::runtime::machine::{Fault, Machine};

/// A program of one state, whose tapes the tests replace.
fn program() -> Program {
    let (flat, _) = model("Real x(start = 1, fixed = true);\nequation\nder(x) = -x;");
    let mut problems = Problems::new();
    let blocks = lower(flat, &mut problems).and_then(|dae| structure(dae, &mut problems));
    compile(blocks.expect("blocks")).unwrap_or_else(|p| panic!("{p:?}"))
}

/// Pseudorandom numbers: Marsaglia, Xorshift RNGs, J. Stat. Software 8 (14), 2003, p. 4.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
    fn value(&mut self) -> f64 {
        const SPECIAL: [f64; 16] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            2.0,
            3.0,
            0.5,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MIN_POSITIVE,
            -5e-324,
            f64::MAX,
            1e-300,
            64.0,
            -7.0,
        ];
        match self.below(3) {
            0 => self.of(&SPECIAL),
            1 => (self.next() as f64 / u64::MAX as f64 - 0.5) * 20.0,
            _ => f64::from_bits(self.next()),
        }
    }
}

const LITERALS: usize = 12;
const CELLS: usize = 60;

/// Appends slots to the memory, the first of which are literals; returns the first one.
fn extend(program: &mut Program, random: &mut Random) -> Slot {
    let first = program.image.len() as Slot;
    for k in 0..CELLS {
        let value = if k < LITERALS {
            [2.0, 3.0, -1.0, 0.0, -0.0, 0.5, 16.0, -5.0, 7.0, 1.0, -2.0, 33.0][k]
        } else {
            random.value()
        };
        program.image.push(value);
    }
    program.literals.extend(first..first + LITERALS as Slot);
    first
}

fn instruction(random: &mut Random, first: Slot) -> Instr {
    let op = match random.below(10) {
        0 => Op::Copy,
        1 => Op::CopyIf,
        2 => random.of(&[Op::Input, Op::Neg]),
        3 => random.of(&[Op::Add, Op::Sub, Op::Mul, Op::Div]),
        4 | 5 => Op::Unary(random.of(Unary::TABLE)),
        6 => Op::Binary(Binary::Pow),
        _ => Op::Binary(random.of(Binary::TABLE)),
    };
    let any = |random: &mut Random| first + random.below(CELLS) as Slot;
    let dst = first + (LITERALS + random.below(CELLS - LITERALS)) as Slot;
    Instr { op, dst, a: any(random), b: any(random) }
}

/// The bits, where all NaN are equal.
pub fn bits(memory: &[f64]) -> Vec<u64> {
    memory.iter().map(|x| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }).collect()
}

fn translated(program: &Program) -> Execution {
    assert_eq!(program.verify(), Ok(()));
    Execution::Compiled(Arc::new(MachineCode::translate(program).expect("machine code")))
}

/// Executes `rhs` several times by both tiers and compares everything; the last outcome.
fn compare(program: &Program) -> Result<(), Fault> {
    let (mut oracle, mut fast) = (Machine::new(program), Machine::new(program));
    fast.set_execution(&translated(program));
    let mut outcome = Ok(());
    for _ in 0..4 {
        outcome = oracle.run(&program.tapes.rhs);
        assert_eq!(fast.run(&program.tapes.rhs), outcome);
        assert_eq!(bits(&fast.memory), bits(&oracle.memory));
        assert_eq!(bits(&fast.fault_memory), bits(&oracle.fault_memory));
    }
    outcome
}

#[test]
fn random_tapes_leave_equal_bits() {
    let whole = program();
    for seed in 1..=150 {
        let mut random = Random(0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(seed));
        let mut program = whole.clone();
        let first = extend(&mut program, &mut random);
        *program.tapes.rhs = (0..120).map(|_| instruction(&mut random, first)).collect();
        assert_eq!(compare(&program), Ok(()), "seed {seed}");
    }
}

/// The whole table of every operator over the special values.
#[test]
fn every_operator_on_every_pair_of_special_values() {
    let mut program = program();
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        2.0,
        3.0,
        -3.0,
        1e300,
        -1e-310,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        std::f64::consts::PI,
    ];
    let first = program.image.len() as Slot;
    program.image.extend(values);
    let cells = values.len() as Slot;
    let mut tape = Vec::new();
    for a in 0..cells {
        let unary = Unary::TABLE.iter().map(|op| (Op::Unary(*op), a));
        let binary = Binary::TABLE.iter().map(|op| Op::Binary(*op)).chain([Op::Input]);
        let binary = binary.flat_map(|op| (0..cells).map(move |b| (op, b)));
        for (op, b) in unary.chain(binary) {
            let dst = program.image.len() as Slot;
            program.image.push(0.0);
            tape.push(Instr { op, dst, a: first + a, b: first + b });
        }
    }
    *program.tapes.rhs = tape;
    assert_eq!(compare(&program), Ok(()));
}

/// Random function bodies with forward jumps and a bounded loop that call each other.
#[test]
fn random_functions_leave_equal_bits() {
    let whole = program();
    let mut failed = 0;
    for seed in 1..=60 {
        let mut random = Random(0xD1B5_4A32_D192_ED03_u64.wrapping_mul(seed));
        let mut program = whole.clone();
        let first = extend(&mut program, &mut random);
        for k in 0..3 {
            let own = extend(&mut program, &mut random);
            let locals: Vec<Slot> = (own + LITERALS as Slot..own + CELLS as Slot).collect();
            let mut tape: Vec<Instr> = Vec::new();
            for _ in 0..40 {
                let at = tape.len() as Slot;
                let cell = own + random.below(CELLS) as Slot;
                tape.push(match random.below(12) {
                    0 => Instr { op: Op::Jump, dst: 0, a: at + 1 + random.below(5) as Slot, b: 0 },
                    1 | 2 => {
                        let b = at + 1 + random.below(5) as Slot;
                        Instr { op: Op::JumpUnless, dst: 0, a: cell, b }
                    }
                    3 if k > 0 => {
                        let function = random.below(k);
                        program.routines.calls.push(site(&mut random, function, own));
                        let a = program.routines.calls.len() as Slot - 1;
                        Instr { op: Op::Call, dst: 0, a, b: 0 }
                    }
                    4 if random.below(6) == 0 => {
                        Instr { op: Op::Assert, dst: 0, a: cell, b: random.below(2) as Slot }
                    }
                    _ => instruction(&mut random, own),
                });
            }
            let end = tape.len() as Slot;
            for i in &mut tape {
                match i.op {
                    Op::Jump => i.a = i.a.min(end),
                    Op::JumpUnless => i.b = i.b.min(end),
                    _ => {}
                }
            }
            program.routines.functions.push(FunctionCode {
                tape: tape.into(),
                inputs: locals[..3].to_vec(),
                outputs: locals[20..22].to_vec(),
                locals,
                messages: vec![(own, Span::NONE); 2],
                ..FunctionCode::default()
            });
        }
        let mut tape = Vec::new();
        for k in 0..40 {
            tape.push(instruction(&mut random, first));
            if k % 8 == 7 {
                let function = random.below(3);
                program.routines.calls.push(site(&mut random, function, first));
                let a = program.routines.calls.len() as Slot - 1;
                tape.push(Instr { op: Op::Call, dst: 0, a, b: 0 });
            }
        }
        *program.tapes.rhs = tape;
        failed += usize::from(compare(&program).is_err());
    }
    assert!((1..60).contains(&failed), "{failed} of 60 failed an assertion");
}

/// A call whose results do not overwrite literals; some are derivatives.
fn site(random: &mut Random, function: usize, first: Slot) -> CallSite {
    let partial = (random.below(3) == 0).then(|| (random.below(2), random.below(3)));
    let args = (0..3).map(|_| first + random.below(CELLS) as Slot).collect();
    let result = |random: &mut Random| first + (LITERALS + random.below(CELLS - LITERALS)) as Slot;
    let results = (0..if partial.is_some() { 1 } else { 2 }).map(|_| result(random)).collect();
    let condition = (random.below(3) == 0).then(|| first + random.below(CELLS) as Slot);
    CallSite { function, args, results, partial, condition, memo: None }
}

/// A sum of a hundred squares by a loop.
#[test]
fn loops_iterate_the_right_number_of_times() {
    let mut program = program();
    let first = program.image.len() as Slot;
    program.image.extend([0.0, 0.0, 0.0, 1.0, 100.0, 0.0]);
    let [k, square, sum, one, limit, more] = std::array::from_fn(|i| first + i as Slot);
    let tape = vec![
        Instr { op: Op::Binary(Binary::Less), dst: more, a: k, b: limit },
        Instr { op: Op::JumpUnless, dst: 0, a: more, b: 6 },
        Instr { op: Op::Add, dst: k, a: k, b: one },
        Instr { op: Op::Mul, dst: square, a: k, b: k },
        Instr { op: Op::Add, dst: sum, a: sum, b: square },
        Instr { op: Op::Jump, dst: 0, a: 0, b: 0 },
    ];
    let locals = vec![k, square, sum, more];
    let outputs = vec![sum];
    let body = FunctionCode { tape: tape.into(), outputs, locals, ..FunctionCode::default() };
    program.routines.functions.push(body);
    let result = program.image.len() as Slot;
    program.image.push(0.0);
    program.routines.calls.push(CallSite {
        function: 0,
        args: Vec::new(),
        results: vec![result],
        partial: None,
        condition: None,
        memo: None,
    });
    *program.tapes.rhs = vec![Instr { op: Op::Call, dst: result, a: 0, b: 0 }];
    assert_eq!(compare(&program), Ok(()));
    let mut machine = Machine::new(&program);
    machine.set_execution(&translated(&program));
    assert_eq!(machine.run(&program.tapes.rhs), Ok(()));
    assert_eq!(machine.get(result), 338_350.0);
}

/// Tapes longer than the maximum fragment.
#[test]
fn long_tapes_are_split() {
    let mut program = program();
    let mut random = Random(7);
    let first = extend(&mut program, &mut random);
    *program.tapes.rhs =
        (0..2 * MAX_FRAGMENT_LENGTH + 1).map(|_| instruction(&mut random, first)).collect();
    assert_eq!(compare(&program), Ok(()));
}

#[test]
fn machine_code_of_another_program_is_not_used() {
    let one = program();
    let mut other = one.clone();
    let code = MachineCode::translate(&one).expect("machine code");
    assert!(code.is_of(&other));
    let last = other.tapes.rhs.pop();
    assert!(last.is_some() && !code.is_of(&other));
    let mut machine = Machine::new(&other);
    machine.set_execution(&Execution::Compiled(Arc::new(code)));
    assert_eq!(machine.run(&other.tapes.rhs), Ok(()));
}

#[test]
fn invalid_references_are_rejected() {
    let mut program = program();
    let beyond = program.image.len() as Slot;
    program.tapes.rhs.push(Instr { op: Op::Neg, dst: beyond, a: 0, b: 0 });
    assert!(matches!(MachineCode::translate(&program), Err(TranslationError::Invalid(_))));
}

/// Machine code replaces the interpreter during a run without changing results.
#[test]
fn interpretation_is_replaced_by_machine_code() {
    let program = program();
    let mut machine = Machine::new(&program);
    machine.set_execution(&Execution::default());
    let mut out = [0.0];
    for k in 0..200_000 {
        let x = f64::from(k);
        assert_eq!(machine.derivatives(0.0, &[x], &mut out), Ok(()));
        assert_eq!(out[0], -x);
        if machine.runs_machine_code() {
            return;
        }
        if k > 50_000 {
            std::thread::sleep(std::time::Duration::from_micros(50));
        }
    }
    panic!("never translated");
}
