//! The order of a solution as something to draw: which line solves which unknown and reads which.
//!
//! *Holds:* one line per unknown, in the order in which they are solved; blocks of neighbouring lines
//! that cover all lines. Lines read lines before them, and within a block any.
//! *Never holds:* known quantities: states, parameters, time.
//! *Made by:* `structure::diagram`. *Read by:* `report`.

/// One phase of a model.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagram {
    /// Name of the model.
    pub model: String,
    /// Which phase, such as `between events`.
    pub phase: &'static str,
    /// The unknowns with their equations.
    pub lines: Vec<DiagramLine>,
    /// Which lines are solved together.
    pub parts: Vec<DiagramBlock>,
}

/// An unknown with the equation that it is solved from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DiagramLine {
    /// Name of the unknown.
    pub unknown: String,
    /// The printed equation.
    pub equation: String,
    /// A tearing variable; its equation is a residual.
    pub torn: bool,
    /// Positions of the lines whose unknowns the equation reads, ascending, without its own.
    pub reads: Vec<usize>,
}

/// A block.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DiagramBlock {
    /// How it is solved.
    pub method: SolutionMethod,
    /// Its first line.
    pub first: usize,
    /// Number of its lines.
    pub size: usize,
}

/// How a block is solved.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum SolutionMethod {
    /// One assignment.
    Explicit,
    /// A linear system.
    Linear,
    /// A nonlinear system, by iteration.
    Nonlinear,
    /// Discrete and continuous equations, repeated until nothing changes.
    Mixed,
}

impl SolutionMethod {
    /// All of them, from simple to hard.
    pub const ALL: [SolutionMethod; 4] = [
        SolutionMethod::Explicit,
        SolutionMethod::Linear,
        SolutionMethod::Nonlinear,
        SolutionMethod::Mixed,
    ];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            SolutionMethod::Explicit => "explicit",
            SolutionMethod::Linear => "linear",
            SolutionMethod::Nonlinear => "nonlinear",
            SolutionMethod::Mixed => "mixed",
        }
    }
}

impl Diagram {
    /// The blocks that a block reads, by their positions, ascending.
    pub fn dependencies(&self, part: usize) -> Vec<usize> {
        let DiagramBlock { first, size, .. } = self.parts[part];
        let lines = self.lines[first..first + size].iter();
        let read = lines.flat_map(|line| &line.reads).filter(|&&line| line < first);
        let mut found: Vec<usize> =
            read.map(|line| self.parts.partition_point(|p| p.first <= *line) - 1).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}
