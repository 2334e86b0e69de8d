//! Exact Jacobians by forward accumulation over the blocks (Griewank & Walther, ch. 3), with the
//! implicit function theorem at torn blocks.
//!
//! The derivative of a variable is a *row*: one expression for each seed (a state, or a tearing
//! variable within its block) that it depends on. The row of an assignment follows from the
//! gradient of its right side by the chain rule. Selections are differentiated branch by branch, so
//! that an infinite derivative in the branch not taken does not affect the other.

use std::collections::BTreeMap;

use crate::base::index::{FastMap, FastSet};
use crate::ir::blocks::{Block, Torn};
use crate::ir::expr::{Binary, ExprId, FunctionId, ListId, Node, Type, VarId};
use crate::ir::program::{BlockDerivative, Entry, Op};
use crate::symbolic::gradient::{Leaf, gradient};
use crate::symbolic::rewrite::Rewriter;

use super::emit::Emitter;
use super::{SortedBlocks, algebraic};

/// The derivatives of one value with respect to the seeds, in order of seed.
pub type Row = Vec<(u32, ExprId)>;

/// The rows of all variables differentiated so far.
#[derive(Default)]
pub struct Rows {
    variables: FastMap<VarId, Row>,
    lifted: FastMap<ExprId, VarId>,
    /// Variables that got a row since the last torn block began.
    recent: Vec<VarId>,
}

impl Rows {
    /// Makes `v` the seed `seed`.
    pub fn seed(&mut self, e: &mut Emitter, v: VarId, seed: u32) {
        let one = e.dae.graph.real(1.0);
        self.set(v, vec![(seed, one)]);
    }

    /// Sets the row of a variable.
    pub fn set(&mut self, v: VarId, row: Row) {
        self.variables.insert(v, row);
        self.recent.push(v);
    }

    /// The row of an expression.
    pub fn of(&mut self, e: &mut Emitter, value: ExprId) -> Row {
        if !self.depends(e, value) {
            return Row::new();
        }
        match e.dae.graph.node(value) {
            Node::If(c, a, b) => return self.select(e, c, a, b),
            Node::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
                let relation =
                    if op == Binary::Min { Binary::LessEqual } else { Binary::GreaterEqual };
                let c = e.dae.graph.binary(relation, a, b);
                return self.select(e, c, a, b);
            }
            Node::Call { function, output, args } => return self.call(e, function, output, args),
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => return self.of(e, a),
            _ => {}
        }
        let smooth = self.lift(e, value);
        let variables = &self.variables;
        let parts = gradient(&mut e.dae.graph, smooth, |leaf| match leaf {
            Leaf::Var(v) => variables.get(&v).is_some_and(|row| !row.is_empty()),
            _ => false,
        });
        let mut sum: BTreeMap<u32, ExprId> = BTreeMap::new();
        for (leaf, partial) in parts {
            let Leaf::Var(v) = leaf else { continue };
            for &(seed, inner) in &self.variables[&v] {
                let term = e.dae.graph.mul(partial, inner);
                accumulate(e, &mut sum, seed, term);
            }
        }
        sum.into_iter().collect()
    }

    /// True if `value` depends on a seed; computes the rows of eliminated variables on the way.
    fn depends(&mut self, e: &mut Emitter, value: ExprId) -> bool {
        let mut any = false;
        for v in e.dae.graph.variables(value) {
            if let (Some(&r), None) = (e.substitutions.get(v), self.variables.get(&v)) {
                let row = self.of(e, r);
                self.set(v, row);
            }
            any |= self.variables.get(&v).is_some_and(|row| !row.is_empty());
        }
        any
    }

    /// Replaces the outermost selections and calls of `value` by auxiliary variables with rows.
    fn lift(&mut self, e: &mut Emitter, value: ExprId) -> ExprId {
        let special: FastSet<ExprId> =
            e.dae.graph.postorder([value]).into_iter().filter(|n| is_special(e, *n)).collect();
        if special.is_empty() {
            return value;
        }
        let mut outermost = Vec::new();
        let mut rewriter = Rewriter::new();
        rewriter.apply(&mut e.dae.graph, value, &mut |_, n| {
            special.contains(&n).then(|| {
                outermost.push(n);
                n
            })
        });
        for n in outermost {
            if !self.lifted.contains_key(&n) {
                let row = self.of(e, n);
                let name = e.auxiliary(None);
                e.substitutions.insert(name, n);
                self.set(name, row);
                self.lifted.insert(n, name);
            }
        }
        let lifted = &self.lifted;
        Rewriter::new().apply(&mut e.dae.graph, value, &mut |graph, n| {
            let name = special.contains(&n).then(|| lifted.get(&n)).flatten()?;
            let ty = graph.ty(n);
            Some(graph.var(*name, ty))
        })
    }

    fn select(&mut self, e: &mut Emitter, c: ExprId, a: ExprId, b: ExprId) -> Row {
        let (when_true, when_false) = (self.of(e, a), self.of(e, b));
        let zero = e.dae.graph.real(0.0);
        let mut both: BTreeMap<u32, (ExprId, ExprId)> = BTreeMap::new();
        for (seed, d) in when_true {
            both.insert(seed, (d, zero));
        }
        for (seed, d) in when_false {
            both.entry(seed).or_insert((zero, zero)).1 = d;
        }
        let graph = &mut e.dae.graph;
        both.into_iter().map(|(seed, (a, b))| (seed, graph.if_then_else(c, a, b))).collect()
    }

    fn call(&mut self, e: &mut Emitter, f: FunctionId, output: u32, args: ListId) -> Row {
        let mut sum: BTreeMap<u32, ExprId> = BTreeMap::new();
        for (i, arg) in e.dae.graph.list(args).to_vec().into_iter().enumerate() {
            let inner = self.of(e, arg);
            if inner.is_empty() {
                continue;
            }
            let key = (f, output, i as u32);
            let partial = e.derivatives.of_call(&mut e.dae.graph, key, args);
            let Some(partial) = partial else { continue };
            for (seed, d) in inner {
                let term = e.dae.graph.mul(partial, d);
                accumulate(e, &mut sum, seed, term);
            }
        }
        sum.into_iter().collect()
    }
}

fn is_special(e: &Emitter, n: ExprId) -> bool {
    matches!(
        e.dae.graph.node(n),
        Node::If(..) | Node::Call { .. } | Node::Binary(Binary::Min | Binary::Max, ..)
    )
}

fn accumulate(e: &mut Emitter, sum: &mut BTreeMap<u32, ExprId>, seed: u32, term: ExprId) {
    let total = match sum.get(&seed) {
        Some(&so_far) => e.dae.graph.add(so_far, term),
        None => term,
    };
    sum.insert(seed, total);
}

/// The Jacobian of the residuals of a torn block with respect to its unknowns, through the explicit
/// part: row, column, value.
pub fn of_torn(e: &mut Emitter, torn: &Torn) -> Vec<(u32, u32, ExprId)> {
    let mut rows = Rows::default();
    for (j, &z) in torn.unknowns.iter().enumerate() {
        rows.seed(e, z, j as u32);
    }
    for a in &torn.explicit {
        let row = rows.of(e, a.value);
        rows.set(a.variable, row);
    }
    let mut entries = Vec::new();
    for (i, r) in torn.residuals.iter().enumerate() {
        for (j, value) in rows.of(e, r.value) {
            if e.dae.graph.as_number(value) != Some(0.0) {
                entries.push((i as u32, j, value));
            }
        }
    }
    entries
}

/// Emits the Jacobian of the derivatives and residuals with respect to the variables `seeds` to the top layer: the
/// states and algebraic unknowns, or variables that are constant between events. `needed` are the continuous blocks that derivatives depend on, in
/// order; `torn_blocks` the number of each torn block that is solved within an evaluation.
pub fn of_system(
    e: &mut Emitter,
    blocks: &SortedBlocks,
    needed: &[usize],
    torn_blocks: &FastMap<usize, u32>,
    seeds: &[VarId],
) -> Vec<Entry> {
    let mut rows = Rows::default();
    for (j, v) in seeds.iter().enumerate() {
        rows.seed(e, *v, j as u32);
    }
    for &i in needed {
        match &blocks.continuous[i] {
            Block::Assign(a) => {
                let row = rows.of(e, a.value);
                rows.set(a.variable, row);
            }
            Block::Torn(t) if algebraic::position(&blocks.algebraics, t).is_some() => {
                for a in &t.explicit {
                    let row = rows.of(e, a.value);
                    rows.set(a.variable, row);
                }
            }
            Block::Torn(t) => {
                let torn_block = torn_blocks.get(&i).copied().unwrap_or(0);
                through_torn(e, &mut rows, t, torn_block, seeds.len() as u32);
            }
            // Nothing discrete is determined between events.
            Block::Mixed(_) => {}
        }
    }
    let mut entries = Vec::new();
    let mut results: Vec<ExprId> = blocks.states.iter().map(|s| e.read(s.derivative)).collect();
    results.extend(blocks.algebraics.iter().map(|a| a.residual));
    for (i, result) in results.into_iter().enumerate() {
        for (j, value) in rows.of(e, result) {
            if e.dae.graph.as_number(value) != Some(0.0) {
                let (slot, _) = e.emit(value);
                entries.push(Entry { row: i as u32, column: j, slot });
            }
        }
    }
    entries
}

/// Computes the rows of the variables of a torn block from `J dz = -B`, where `B` is the derivative
/// of the residuals at constant `z`.
fn through_torn(e: &mut Emitter, rows: &mut Rows, torn: &Torn, torn_block: u32, first_seed: u32) {
    rows.recent.clear();
    for (k, &z) in torn.unknowns.iter().enumerate() {
        rows.seed(e, z, first_seed + k as u32);
    }
    let mut explicit = Vec::new();
    for a in &torn.explicit {
        let row = rows.of(e, a.value);
        rows.set(a.variable, row.clone());
        explicit.push((a.variable, row));
    }
    let (mut jacobian, mut outer) = (Vec::new(), Vec::new());
    for (i, r) in torn.residuals.iter().enumerate() {
        for (seed, value) in rows.of(e, r.value) {
            match seed.checked_sub(first_seed) {
                Some(k) => jacobian.push((i as u32, k, value)),
                None => outer.push((i as u32, seed, value)),
            }
        }
    }
    let unknowns = implicit_rows(e, torn, torn_block, &jacobian, &outer);
    // The rows of the explicit part still hold the unknowns as seeds.
    for (v, row) in explicit {
        let mut sum: BTreeMap<u32, ExprId> = BTreeMap::new();
        for (seed, value) in row {
            match seed.checked_sub(first_seed) {
                None => accumulate(e, &mut sum, seed, value),
                Some(k) => {
                    for &(outer_seed, dz) in &unknowns[k as usize] {
                        let term = e.dae.graph.mul(value, dz);
                        accumulate(e, &mut sum, outer_seed, term);
                    }
                }
            }
        }
        rows.set(v, sum.into_iter().collect());
    }
    for (&z, row) in torn.unknowns.iter().zip(unknowns) {
        rows.set(z, row);
    }
    // Auxiliary variables within the block have rows with respect to its unknowns: do not reuse
    // them.
    rows.lifted.clear();
    for v in std::mem::take(&mut rows.recent) {
        let inside = |row: &Row| row.iter().any(|(seed, _)| *seed >= first_seed);
        if rows.variables.get(&v).is_some_and(inside) {
            rows.variables.remove(&v);
        }
    }
}

/// The derivatives of the unknowns; solved at run time unless there is only one unknown.
fn implicit_rows(
    e: &mut Emitter,
    torn: &Torn,
    torn_block: u32,
    jacobian: &[(u32, u32, ExprId)],
    outer: &[(u32, u32, ExprId)],
) -> Vec<Row> {
    let order = torn.unknowns.len();
    if order == 1 {
        let Some(&(_, _, pivot)) = jacobian.first() else { return vec![Row::new()] };
        let mut row = Row::new();
        for &(_, seed, value) in outer {
            let quotient = e.dae.graph.div(value, pivot);
            row.push((seed, e.dae.graph.neg(quotient)));
        }
        row.sort_by_key(|(seed, _)| *seed);
        return vec![row];
    }
    let mut columns: Vec<u32> = outer.iter().map(|o| o.1).collect();
    columns.sort_unstable();
    columns.dedup();
    let mut rows = vec![Row::new(); order];
    if columns.is_empty() {
        return rows;
    }
    let mut entry = |row: u32, column: u32, value| Entry { row, column, slot: e.emit(value).0 };
    let jacobian = jacobian.iter().map(|&(i, j, v)| entry(i, j, v)).collect();
    let position = |seed| columns.binary_search(&seed).unwrap_or(0) as u32;
    let seeds = outer.iter().map(|&(i, seed, v)| entry(i, position(seed), v)).collect();
    let top = e.layers.len() - 1;
    let mut results = Vec::new();
    for &seed in &columns {
        for row in rows.iter_mut() {
            let name = e.auxiliary(Some(top));
            results.push(e.slot(name));
            row.push((seed, e.dae.graph.var(name, Type::Real)));
        }
    }
    e.routines.block_derivatives.push(BlockDerivative {
        torn_block,
        order,
        jacobian,
        seeds,
        results,
    });
    e.push(top, Op::Differentiate, 0, (e.routines.block_derivatives.len() - 1) as u32, 0);
    rows
}
