//! The sorted system as a diagram, for `mocc structure --svg` and `--dot`.

use super::print::printed;
use crate::base::index::FastMap;
use crate::ir::blocks::{Assignment, Block, Blocks};
use crate::ir::dae::Dae;
use crate::ir::diagram::{Diagram, DiagramBlock, DiagramLine, SolutionMethod};
use crate::ir::expr::{ExprId, VarId};

/// The diagram of the phase between events; that of the phase at events if the former is empty.
pub fn diagram(blocks: &Blocks) -> Diagram {
    let (phase, sequence) = match blocks.continuous.as_slice() {
        [] => ("at events", &blocks.event),
        _ => ("between events", &blocks.continuous),
    };
    let dae = &blocks.dae;
    let mut solved = Vec::new();
    let mut parts = Vec::with_capacity(sequence.len());
    for block in sequence {
        let first = solved.len();
        collect(block, dae, &mut solved);
        parts.push(DiagramBlock { method: method(block), first, size: solved.len() - first });
    }
    let at: FastMap<VarId, usize> =
        solved.iter().enumerate().map(|(line, s)| (s.unknown, line)).collect();
    let line = |(own, s): (usize, &Solved)| {
        let mut reads: Vec<usize> =
            dae.graph.variables(s.value).iter().filter_map(|v| at.get(v).copied()).collect();
        reads.retain(|line| *line != own);
        reads.sort_unstable();
        reads.dedup();
        let unknown = dae.variables[s.unknown].name.clone();
        DiagramLine { unknown, equation: s.equation.clone(), torn: s.torn, reads }
    };
    let lines = solved.iter().enumerate().map(line).collect();
    Diagram { model: dae.name.clone(), phase, lines, parts }
}

/// An unknown with the expression that determines it.
struct Solved {
    unknown: VarId,
    value: ExprId,
    equation: String,
    torn: bool,
}

fn collect(block: &Block, dae: &Dae, out: &mut Vec<Solved>) {
    let mut assign = |a: &Assignment| {
        let name = &dae.variables[a.variable].name;
        let equation = format!("{name} := {}", printed(dae, a.value));
        out.push(Solved { unknown: a.variable, value: a.value, equation, torn: false });
    };
    match block {
        Block::Assign(a) => assign(a),
        Block::Torn(t) => {
            t.explicit.iter().for_each(assign);
            for (v, r) in t.unknowns.iter().zip(&t.residuals) {
                let equation = format!("0 = {}", printed(dae, r.value));
                out.push(Solved { unknown: *v, value: r.value, equation, torn: true });
            }
        }
        Block::Mixed(parts) => parts.iter().for_each(|part| collect(part, dae, out)),
    }
}

fn method(block: &Block) -> SolutionMethod {
    match block {
        Block::Assign(_) => SolutionMethod::Explicit,
        Block::Torn(t) if t.linear => SolutionMethod::Linear,
        Block::Torn(_) => SolutionMethod::Nonlinear,
        Block::Mixed(_) => SolutionMethod::Mixed,
    }
}
