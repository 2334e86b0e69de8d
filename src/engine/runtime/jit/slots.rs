//! Generates code instruction by instruction, keeping the values of slots in registers.
//!
//! Every result is also stored in its slot, because other code may read it; repeated reads use the
//! register. Operators are those of IEEE 754, one machine instruction each, in the order of the
//! tape, never contracted or reordered, so results equal those of the interpreter bit for bit.
//!
//! An elementary function costs as much as a dozen products, and is often called with the same
//! argument again: constant variables do not change from one evaluation to the next, and identical
//! components call it with equal arguments in succession. So each call site memoizes its last
//! arguments and result, and also checks the memo of the preceding site.

use cranelift::codegen::ir::{BlockArg, FuncRef, SigRef};
use cranelift::prelude::*;

use crate::base::index::FastMap;

use crate::ir::builtin::Code;
use crate::ir::expr::{Binary, Unary};
use crate::ir::external::Externals;
use crate::ir::program::{Instr, Op, Slot};
use crate::symbolic::eval;

use super::external;

/// Powers up to this exponent are expanded into products.
const MAX_UNROLLED_POWER: f64 = 16.0;

/// Registers that hold slots at the current point of a function; reused for all functions.
pub struct RegisterState {
    /// The value of each slot.
    values: Vec<Option<Value>>,
    /// Its Boolean value, if it was computed by a comparison.
    truths: Vec<Option<Value>>,
    /// The slots that have entries.
    touched: Vec<Slot>,
    /// The values of literals, which tapes never write.
    literals: Vec<Option<f64>>,
    /// Initial memo of the call sites of elementary functions: arguments, then the result.
    pub memo: Vec<f64>,
    /// The preceding call site of each function, by address.
    places: FastMap<usize, i32>,
}

impl RegisterState {
    /// For a memory of this many slots.
    pub fn new(fragment: usize, literals: &[(Slot, f64)]) -> Self {
        let mut registers = RegisterState {
            values: vec![None; fragment],
            truths: vec![None; fragment],
            touched: Vec::new(),
            literals: vec![None; fragment],
            memo: Vec::new(),
            places: FastMap::default(),
        };
        for &(slot, value) in literals {
            registers.literals[slot as usize] = Some(value);
        }
        registers
    }

    fn invalidate(&mut self) {
        for slot in self.touched.drain(..) {
            self.values[slot as usize] = None;
            self.truths[slot as usize] = None;
        }
    }
}

/// A function under construction, `fn(memory: *mut f64, memo: *mut f64) -> u32`.
pub struct FragmentBuilder<'a, 'k> {
    /// Its instructions.
    pub build: FunctionBuilder<'a>,
    registers: &'k mut RegisterState,
    memory: Value,
    memo: Value,
    externals: &'k Externals,
    call_conv: isa::CallConv,
    signatures: [Option<SigRef>; 3],
}

impl<'a, 'k> FragmentBuilder<'a, 'k> {
    /// Starts the function with its entry block.
    pub fn begin(
        mut build: FunctionBuilder<'a>,
        registers: &'k mut RegisterState,
        externals: &'k Externals,
        call_conv: isa::CallConv,
    ) -> Self {
        let entry = build.create_block();
        build.append_block_params_for_function_params(entry);
        build.switch_to_block(entry);
        let parameters = build.block_params(entry);
        let (memory, memo) = (parameters[0], parameters[1]);
        registers.invalidate();
        let signatures = [None; 3];
        FragmentBuilder { build, registers, memory, memo, externals, call_conv, signatures }
    }

    /// Invalidates all registers: at joins of control flow, and after code that may write to the
    /// memory.
    pub fn invalidate(&mut self) {
        self.registers.invalidate();
    }

    /// The value of a slot.
    pub fn get(&mut self, slot: Slot) -> Value {
        if let Some(value) = self.registers.values[slot as usize] {
            return value;
        }
        let mut flags = MemFlagsData::trusted();
        if self.registers.literals[slot as usize].is_some() {
            flags = flags.with_readonly();
        }
        let value = self.build.ins().load(types::F64, flags, self.memory, offset(slot));
        self.registers.values[slot as usize] = Some(value);
        self.registers.touched.push(slot);
        value
    }

    /// Sets a slot.
    pub fn set(&mut self, slot: Slot, value: Value) {
        self.build.ins().store(MemFlagsData::trusted(), value, self.memory, offset(slot));
        self.registers.values[slot as usize] = Some(value);
        self.registers.truths[slot as usize] = None;
        self.registers.touched.push(slot);
    }

    /// True if the slots of each pair hold the same bits; there is at least one pair.
    pub fn are_identical(&mut self, pairs: &[(Slot, Slot)]) -> Value {
        let mut all = None;
        for &(a, b) in pairs {
            let [a, b] = [a, b].map(|slot| {
                let value = self.get(slot);
                self.bits(value)
            });
            let equal = self.build.ins().icmp(IntCC::Equal, a, b);
            all = Some(match all {
                Some(others) => self.build.ins().band(others, equal),
                None => equal,
            });
        }
        all.unwrap_or_else(|| self.build.ins().iconst(types::I8, 1))
    }

    /// A constant.
    pub fn number(&mut self, value: f64) -> Value {
        self.build.ins().f64const(value)
    }

    /// True if a slot is not zero; NaN is not zero.
    pub fn truth(&mut self, slot: Slot) -> Value {
        if let Some(truth) = self.registers.truths[slot as usize] {
            return truth;
        }
        let value = self.get(slot);
        let zero = self.number(0.0);
        let truth = self.build.ins().fcmp(FloatCC::NotEqual, value, zero);
        self.registers.truths[slot as usize] = Some(truth);
        truth
    }

    /// Calls a function of the module; returns its status.
    pub fn call(&mut self, function: FuncRef) -> Value {
        let call = self.build.ins().call(function, &[self.memory, self.memo]);
        self.invalidate();
        self.build.inst_results(call)[0]
    }

    /// Returns a status from the function.
    pub fn return_status(&mut self, status: u32) {
        let status = self.build.ins().iconst(types::I32, i64::from(status));
        self.build.ins().return_(&[status]);
    }

    /// Returns `status` from the function if it is not zero; otherwise continues in a new block.
    pub fn return_on_fault(&mut self, status: Value) {
        let (failed, fine) = (self.build.create_block(), self.build.create_block());
        self.build.set_cold_block(failed);
        self.build.ins().brif(status, failed, &[], fine, &[]);
        self.build.switch_to_block(failed);
        self.build.ins().return_(&[status]);
        self.build.switch_to_block(fine);
    }

    /// Returns `status` from the function unless `truth` holds; otherwise continues in a new block.
    pub fn return_unless(&mut self, truth: Value, status: u32) {
        let (failed, fine) = (self.build.create_block(), self.build.create_block());
        self.build.set_cold_block(failed);
        self.build.ins().brif(truth, fine, &[], failed, &[]);
        self.build.switch_to_block(failed);
        self.return_status(status);
        self.build.switch_to_block(fine);
    }

    /// Emits an instruction without control flow or calls; ignores others.
    pub fn compute(&mut self, i: &Instr) {
        match i.op {
            Op::Copy => {
                let (value, truth) = (self.get(i.a), self.registers.truths[i.a as usize]);
                self.set(i.dst, value);
                self.registers.truths[i.dst as usize] = truth;
            }
            Op::CopyIf => {
                let truth = self.truth(i.a);
                let (old, new) = (self.get(i.dst), self.get(i.b));
                let value = self.build.ins().select(truth, new, old);
                self.set(i.dst, value);
            }
            Op::Input => {
                let (a, b) = (self.get(i.a), self.get(i.b));
                let missing = self.build.ins().fcmp(FloatCC::Unordered, b, b);
                let value = self.build.ins().select(missing, a, b);
                self.set(i.dst, value);
            }
            Op::Add => self.binary(Binary::Add, i),
            Op::Sub => self.binary(Binary::Sub, i),
            Op::Mul => self.binary(Binary::Mul, i),
            Op::Div => self.binary(Binary::Div, i),
            Op::Neg => self.unary(Unary::Neg, i),
            Op::Unary(op) => self.unary(op, i),
            Op::Binary(op) => self.binary(op, i),
            Op::Solve | Op::Differentiate | Op::Iterate | Op::Call => {}
            Op::Jump | Op::JumpUnless | Op::Assert => {}
        }
    }

    fn unary(&mut self, op: Unary, i: &Instr) {
        let value = match op {
            Unary::Not => {
                // NaN is true.
                let truth = self.truth(i.a);
                let not = self.build.ins().bxor_imm_u(truth, 1);
                return self.set_truth(i.dst, not);
            }
            Unary::Neg => {
                let a = self.get(i.a);
                self.build.ins().fneg(a)
            }
            Unary::Abs => {
                let a = self.get(i.a);
                self.build.ins().fabs(a)
            }
            Unary::Sqrt => {
                let a = self.get(i.a);
                self.build.ins().sqrt(a)
            }
            Unary::Ordinal => self.get(i.a),
            Unary::External(f) => {
                let handle = external::handle(self.externals.get(f));
                let (handle, a) = (self.number(handle), self.get(i.a));
                self.external(external::external_unary(), &[handle, a])
            }
            _ => {
                let a = self.get(i.a);
                match op.facts().map(|row| row.code) {
                    Some(Code::Memo) => self.memoized(
                        external::unary(op),
                        &[a],
                        eval::unary(op, 0.0, &Externals::EMPTY),
                    ),
                    _ => self.external(external::unary(op), &[a]),
                }
            }
        };
        self.set(i.dst, value);
    }

    fn binary(&mut self, op: Binary, i: &Instr) {
        let compared = match op {
            Binary::Less => Some(FloatCC::LessThan),
            Binary::LessEqual => Some(FloatCC::LessThanOrEqual),
            Binary::Greater => Some(FloatCC::GreaterThan),
            Binary::GreaterEqual => Some(FloatCC::GreaterThanOrEqual),
            Binary::Equal => Some(FloatCC::Equal),
            Binary::NotEqual => Some(FloatCC::NotEqual),
            _ => None,
        };
        if let Some(how) = compared {
            let (a, b) = (self.get(i.a), self.get(i.b));
            let truth = self.build.ins().fcmp(how, a, b);
            return self.set_truth(i.dst, truth);
        }
        if matches!(op, Binary::And | Binary::Or) {
            let (a, b) = (self.truth(i.a), self.truth(i.b));
            let both = match op {
                Binary::And => self.build.ins().band(a, b),
                _ => self.build.ins().bor(a, b),
            };
            return self.set_truth(i.dst, both);
        }
        let (a, b) = (self.get(i.a), self.get(i.b));
        let value = match op {
            Binary::External(f) => {
                let handle = self.number(external::handle(self.externals.get(f)));
                self.external(external::external_binary(), &[handle, a, b])
            }
            Binary::Add => self.build.ins().fadd(a, b),
            Binary::Sub => self.build.ins().fsub(a, b),
            Binary::Mul => self.build.ins().fmul(a, b),
            Binary::Div => self.build.ins().fdiv(a, b),
            Binary::Min => self.extreme(FloatCC::LessThan, a, b),
            Binary::Max => self.extreme(FloatCC::GreaterThan, a, b),
            Binary::Pow if let Some(n) = self.short_exponent(i.b) => self.product(a, n),
            _ => match op.facts().map(|row| row.code) {
                Some(Code::Memo) => self.memoized(
                    external::binary(op),
                    &[a, b],
                    eval::binary(op, 0.0, 0.0, &Externals::EMPTY),
                ),
                _ => self.external(external::binary(op), &[a, b]),
            },
        };
        self.set(i.dst, value);
    }

    /// The exponent, if it is a literal that is multiplied out.
    fn short_exponent(&self, slot: Slot) -> Option<f64> {
        self.registers.literals[slot as usize]
            .filter(|n| n.fract() == 0.0 && n.abs() <= MAX_UNROLLED_POWER)
    }

    /// `b` if it is beyond `a` or NaN, else `a`: NaN if one of them is.
    fn extreme(&mut self, beyond: FloatCC, a: Value, b: Value) -> Value {
        let further = self.build.ins().fcmp(beyond, b, a);
        let missing = self.build.ins().fcmp(FloatCC::Unordered, b, b);
        let other = self.build.ins().bor(further, missing);
        self.build.ins().select(other, b, a)
    }

    /// A power by repeated squaring, in the order in which `f64::powi` multiplies.
    fn product(&mut self, a: Value, exponent: f64) -> Value {
        let mut left = exponent.abs() as u32;
        let (mut square, mut product) = (a, None);
        loop {
            if left & 1 == 1 {
                product = Some(match product {
                    None => square,
                    Some(so_far) => self.build.ins().fmul(so_far, square),
                });
            }
            left >>= 1;
            if left == 0 {
                break;
            }
            square = self.build.ins().fmul(square, square);
        }
        let product = product.unwrap_or_else(|| self.number(1.0));
        if exponent < 0.0 {
            let one = self.number(1.0);
            self.build.ins().fdiv(one, product)
        } else {
            product
        }
    }

    /// Sets a slot to one or zero.
    fn set_truth(&mut self, slot: Slot, truth: Value) {
        let one = self.build.ins().iconst(types::I64, 1.0_f64.to_bits() as i64);
        let zero = self.build.ins().iconst(types::I64, 0);
        let bits = self.build.ins().select(truth, one, zero);
        let value = self.build.ins().bitcast(types::F64, MemFlagsData::new(), bits);
        self.set(slot, value);
        self.registers.truths[slot as usize] = Some(truth);
    }

    /// Calls a Rust function and invalidates all registers: reloading from the memory costs no more
    /// than spilling to the stack.
    fn external(&mut self, address: usize, arguments: &[Value]) -> Value {
        let result = self.call_address(address, arguments);
        self.invalidate();
        result
    }

    /// As `external`, but skips the call if the arguments equal those of the last call here, or of
    /// the last call at the preceding site of the same function. `at_zero` is the result for zero
    /// arguments.
    fn memoized(&mut self, address: usize, arguments: &[Value], at_zero: f64) -> Value {
        let size = size_of::<f64>() as i32;
        let place = self.registers.memo.len() as i32 * size;
        self.registers.memo.extend(std::iter::repeat_n(0.0, arguments.len()));
        self.registers.memo.push(at_zero);
        let before = self.registers.places.insert(address, place);

        let keys: Vec<Value> = arguments.iter().map(|a| self.bits(*a)).collect();
        let (same, other, done) =
            (self.build.create_block(), self.build.create_block(), self.build.create_block());
        let result = self.build.append_block_param(done, types::F64);
        let result_of = |place: i32| place + arguments.len() as i32 * size;
        let trusted = MemFlagsData::trusted();

        let unchanged = self.holds(place, &keys);
        self.build.ins().brif(unchanged, same, &[], other, &[]);
        self.build.switch_to_block(same);
        let known = self.build.ins().load(types::F64, trusted, self.memo, result_of(place));
        self.build.ins().jump(done, &[BlockArg::Value(known)]);

        self.build.switch_to_block(other);
        for (k, key) in keys.iter().enumerate() {
            self.build.ins().store(trusted, *key, self.memo, place + k as i32 * size);
        }
        let found = match before {
            None => self.call_address(address, arguments),
            Some(before) => {
                let (equal, new, found) = (
                    self.build.create_block(),
                    self.build.create_block(),
                    self.build.create_block(),
                );
                let result = self.build.append_block_param(found, types::F64);
                let as_before = self.holds(before, &keys);
                self.build.ins().brif(as_before, equal, &[], new, &[]);
                self.build.switch_to_block(equal);
                let known =
                    self.build.ins().load(types::F64, trusted, self.memo, result_of(before));
                self.build.ins().jump(found, &[BlockArg::Value(known)]);
                self.build.switch_to_block(new);
                let computed = self.call_address(address, arguments);
                self.build.ins().jump(found, &[BlockArg::Value(computed)]);
                self.build.switch_to_block(found);
                result
            }
        };
        self.build.ins().store(trusted, found, self.memo, result_of(place));
        self.build.ins().jump(done, &[BlockArg::Value(found)]);
        self.build.switch_to_block(done);
        self.invalidate();
        result
    }

    fn bits(&mut self, value: Value) -> Value {
        self.build.ins().bitcast(types::I64, MemFlagsData::new(), value)
    }

    /// True if a memo holds exactly these arguments, bit for bit.
    fn holds(&mut self, place: i32, keys: &[Value]) -> Value {
        let mut all = None;
        for (k, key) in keys.iter().enumerate() {
            let at = place + k as i32 * size_of::<f64>() as i32;
            let flags = MemFlagsData::trusted();
            let known = self.build.ins().load(types::I64, flags, self.memo, at);
            let equal = self.build.ins().icmp(IntCC::Equal, known, *key);
            all = Some(match all {
                None => equal,
                Some(so_far) => self.build.ins().band(so_far, equal),
            });
        }
        all.unwrap_or_else(|| self.build.ins().iconst(types::I8, 0))
    }

    fn call_address(&mut self, address: usize, arguments: &[Value]) -> Value {
        let signature = self.signature(arguments.len());
        let address = self.build.ins().iconst(types::I64, address as i64);
        let call = self.build.ins().call_indirect(signature, address, arguments);
        self.build.inst_results(call)[0]
    }

    fn signature(&mut self, arguments: usize) -> SigRef {
        if let Some(known) = self.signatures[arguments - 1] {
            return known;
        }
        let mut signature = Signature::new(self.call_conv);
        signature.params = vec![AbiParam::new(types::F64); arguments];
        signature.returns = vec![AbiParam::new(types::F64)];
        let imported = self.build.import_signature(signature);
        self.signatures[arguments - 1] = Some(imported);
        imported
    }
}

fn offset(slot: Slot) -> i32 {
    // Checked by `translate`: the memory is smaller than 2 GiB.
    (slot * size_of::<f64>() as Slot) as i32
}
