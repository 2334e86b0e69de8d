//! Prints the block graph of a model in the DOT language of Graphviz.

use std::fmt::Write;

use super::plot::layout::shortened;
use crate::ir::diagram::{Diagram, DiagramBlock, SolutionMethod};

/// Maximum number of equations in the label of a node.
const MAX_LINES: usize = 12;
/// Maximum width of an equation in a node, px at [`SIZE`].
const MAX_TEXT_WIDTH: f64 = 420.0;
const SIZE: f64 = 12.0;

/// Prints a node for each block with its equations, numbered in order, and an edge from each block
/// to those that read it.
pub fn dot(diagram: &Diagram) -> String {
    let mut out = String::from("digraph blocks {\n");
    let title = format!("{}, {}", diagram.model, diagram.phase);
    let _ =
        writeln!(out, "  graph [label={}, labelloc=t, fontname=\"sans-serif\"];", quoted(&title));
    let _ = writeln!(
        out,
        "  node [shape=box, style=filled, fontname=\"sans-serif\", fontsize={SIZE}];"
    );
    for (k, part) in diagram.parts.iter().enumerate() {
        let _ = writeln!(
            out,
            "  b{} [fillcolor=\"{}\", label={}];",
            k + 1,
            fill(part.method),
            label(diagram, k, part)
        );
    }
    for k in 0..diagram.parts.len() {
        for from in diagram.dependencies(k) {
            let _ = writeln!(out, "  b{} -> b{};", from + 1, k + 1);
        }
    }
    out.push_str("}\n");
    out
}

/// Number, method, and the equations, left-aligned.
fn label(diagram: &Diagram, k: usize, part: &DiagramBlock) -> String {
    let lines = &diagram.lines[part.first..part.first + part.size];
    let torn = lines.iter().filter(|l| l.torn).count();
    let mut text = match part.method {
        SolutionMethod::Explicit => format!("{}. ", k + 1),
        method => format!("{}. {}, {} unknowns, torn to {torn}\n", k + 1, method.name(), part.size),
    };
    for line in lines.iter().take(MAX_LINES) {
        if line.torn {
            text.push_str(&line.unknown);
            text.push_str(": ");
        }
        text.push_str(&shortened(&line.equation, SIZE, MAX_TEXT_WIDTH));
        text.push('\n');
    }
    if lines.len() > MAX_LINES {
        let _ = writeln!(text, "and {} more", lines.len() - MAX_LINES);
    }
    quoted(&text)
}

fn fill(method: SolutionMethod) -> &'static str {
    match method {
        SolutionMethod::Explicit => "#f2f2f2",
        SolutionMethod::Linear => "#cfe3f2",
        SolutionMethod::Nonlinear => "#f8dcc6",
        SolutionMethod::Mixed => "#cdebe1",
    }
}

/// A quoted string; line ends align to the left.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\l"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::diagram::DiagramLine;

    #[test]
    fn blocks_are_nodes_and_dependencies_are_edges() {
        let line = |unknown: &str, equation: &str, torn, reads: &[usize]| DiagramLine {
            unknown: unknown.into(),
            equation: equation.into(),
            torn,
            reads: reads.to_vec(),
        };
        let diagram = Diagram {
            model: "M".into(),
            phase: "between events",
            lines: vec![
                line("a", "a := x", false, &[]),
                line("b", "b := a + c", false, &[0, 2]),
                line("c", "0 = \"b\" - c", true, &[1]),
                line("d", "d := b", false, &[1]),
            ],
            parts: vec![
                DiagramBlock { method: SolutionMethod::Explicit, first: 0, size: 1 },
                DiagramBlock { method: SolutionMethod::Linear, first: 1, size: 2 },
                DiagramBlock { method: SolutionMethod::Explicit, first: 3, size: 1 },
            ],
        };
        insta::assert_snapshot!(dot(&diagram), @r##"
        digraph blocks {
          graph [label="M, between events", labelloc=t, fontname="sans-serif"];
          node [shape=box, style=filled, fontname="sans-serif", fontsize=12];
          b1 [fillcolor="#f2f2f2", label="1. a := x\l"];
          b2 [fillcolor="#cfe3f2", label="2. linear, 2 unknowns, torn to 1\lb := a + c\lc: 0 = \"b\" - c\l"];
          b3 [fillcolor="#f2f2f2", label="3. d := b\l"];
          b1 -> b2;
          b2 -> b3;
        }
        "##);
    }
}
