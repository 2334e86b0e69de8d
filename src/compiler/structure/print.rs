//! Prints the sorted system for `mocc structure`.

use std::fmt::Write;

use crate::base::index::IndexVec;
use crate::base::source::SourceMap;
use crate::ir::blocks::{Assignment, Block, Blocks, Source, Torn};
use crate::ir::dae::{Dae, EqId};
use crate::ir::expr::{ExprId, VarId};
use crate::symbolic::print::Printer;

/// Prints states, differentiated equations, dummy derivatives, and the blocks of each phase in
/// order.
pub fn print(blocks: &Blocks, sources: &SourceMap) -> String {
    let mut out = String::new();
    let dae = &blocks.dae;
    let _ = writeln!(out, "{}", dae.name);
    let selected = |v: &VarId| blocks.state_sets.iter().any(|set| set.states.contains(v));
    let states: Vec<VarId> =
        blocks.states.iter().map(|s| s.variable).filter(|v| !selected(v)).collect();
    names(&mut out, "states", dae, &states);
    for set in &blocks.state_sets {
        let title = format!("selected while running, {} of", set.states.len());
        names(&mut out, &title, dae, &set.candidates);
    }
    let dummies: Vec<VarId> = blocks.dummies.clone();
    names(&mut out, "differentiated but not states", dae, &dummies);
    differentiated(&mut out, dae, sources);
    names(&mut out, "starts assumed", dae, &blocks.assumed_starts);
    for (title, sequence) in [
        ("initialisation", &blocks.initial),
        ("at events", &blocks.event),
        ("between events", &blocks.continuous),
    ] {
        let _ = writeln!(out, "\n{title}: {}", summary(sequence));
        for (i, block) in sequence.iter().enumerate() {
            write_block(&mut out, dae, block, &(i + 1).to_string(), 1);
        }
    }
    out
}

fn names(out: &mut String, title: &str, dae: &Dae, variables: &[VarId]) {
    if !variables.is_empty() {
        let list: Vec<&str> = variables.iter().map(|v| dae.variables[*v].name.as_str()).collect();
        let _ = writeln!(out, "  {title} ({}): {}", list.len(), list.join(", "));
    }
}

fn differentiated(out: &mut String, dae: &Dae, sources: &SourceMap) {
    let mut times: IndexVec<EqId, u32> = IndexVec::filled(0, dae.equations.len());
    let mut first: IndexVec<EqId, EqId> = dae.equations.ids().collect();
    for (id, e) in dae.equations.enumerate() {
        // A differentiated equation has a higher number than its origin.
        if let Some(of) = e.derivative_of {
            first[id] = first[of];
            times[first[id]] += 1;
        }
    }
    for (id, &n) in times.enumerate().filter(|(_, n)| **n > 0) {
        let e = &dae.equations[id];
        let often = match n {
            1 => "once".to_string(),
            2 => "twice".to_string(),
            n => format!("{n} times"),
        };
        let text = format!("{} = {}", printed(dae, e.lhs), printed(dae, e.rhs));
        let place = sources.place(e.origin.span).map_or(String::new(), |p| format!("  [{p}]"));
        let _ = writeln!(out, "  differentiated {often}: {text}{place}");
    }
}

fn summary(sequence: &[Block]) -> String {
    let mut counts = [0_usize; 4];
    for block in sequence {
        counts[match block {
            Block::Assign(_) => 0,
            Block::Torn(Torn { linear: true, .. }) => 1,
            Block::Torn(_) => 2,
            Block::Mixed(_) => 3,
        }] += 1;
    }
    let kinds = ["explicit", "linear", "nonlinear", "mixed"];
    let parts: Vec<String> = counts
        .iter()
        .zip(kinds)
        .filter(|(n, _)| **n > 0)
        .map(|(n, k)| format!("{n} {k}"))
        .collect();
    let n = sequence.len();
    let blocks = if n == 1 { "1 block".to_string() } else { format!("{n} blocks") };
    if parts.is_empty() { blocks } else { format!("{blocks} ({})", parts.join(", ")) }
}

fn write_block(out: &mut String, dae: &Dae, block: &Block, number: &str, depth: usize) {
    let indent = "  ".repeat(depth);
    match block {
        Block::Assign(a) => {
            let _ = writeln!(out, "{indent}{number}. {}", assignment(dae, a));
        }
        Block::Torn(t) => {
            let kind = if t.linear { "linear" } else { "nonlinear" };
            let size = t.unknowns.len() + t.explicit.len();
            let torn: Vec<&str> =
                t.unknowns.iter().map(|v| dae.variables[*v].name.as_str()).collect();
            let _ = writeln!(
                out,
                "{indent}{number}. {kind} system of {size}, torn to {}: {}",
                torn.len(),
                torn.join(", ")
            );
            for a in &t.explicit {
                let _ = writeln!(out, "{indent}     {}", assignment(dae, a));
            }
            for r in &t.residuals {
                let _ = writeln!(out, "{indent}     0 = {}", printed(dae, r.value));
            }
        }
        Block::Mixed(parts) => {
            let _ = writeln!(out, "{indent}{number}. mixed: repeated until nothing changes");
            for (i, part) in parts.iter().enumerate() {
                write_block(out, dae, part, &format!("{number}.{}", i + 1), depth + 1);
            }
        }
    }
}

fn assignment(dae: &Dae, a: &Assignment) -> String {
    let name = &dae.variables[a.variable].name;
    let note = match a.source {
        Source::Start(_) => "  (start)",
        Source::Initial(_) => "  (initial equation)",
        _ => "",
    };
    format!("{name} := {}{note}", printed(dae, a.value))
}

/// An expression with its relations spelled out, truncated if it is long.
pub(super) fn printed(dae: &Dae, e: ExprId) -> String {
    const LONGEST: usize = 160;
    let relation = |k: u32| dae.relations.get(k as usize).map(|r| (r.op, r.lhs, r.rhs));
    let text = Printer {
        graph: &dae.graph,
        variable: &|v: VarId, out: &mut String| out.push_str(&dae.variables[v].name),
        enumeration: &|name: &str| name.to_string(),
        relation: &relation,
        special: &|_, _| false,
        longest: LONGEST,
    }
    .print(e);
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text,
    }
}
