//! Sorted systems by hand.

use crate::base::index::IndexVec;
use crate::base::name::name;
use crate::base::source::{SourceMap, Span};
use crate::codegen::compile;
use crate::ir::blocks::{Assignment, Block, Blocks, Residual, Source, State, Torn};
use crate::ir::dae::{
    Dae, DiscreteEquation, EqId, Equation, Reinit, Relation, Stated, Trigger, Variable,
    VariableKind,
};
use crate::ir::expr::{Binary, ExprId, Graph, Type, VarId};
use crate::ir::flat::{Experiment, Origin, StateSelect};
use crate::ir::program::Program;
use mocc_engine::simulate::failure::Failure;
use mocc_engine::simulate::run::{Run, simulate};
use mocc_engine::simulate::settings::Settings;

/// A system under construction. Blocks are in the order in which they are added.
pub struct Builder {
    pub blocks: Blocks,
    pub sources: SourceMap,
}

impl Builder {
    pub fn new() -> Self {
        let dae = Dae {
            name: "Test".into(),
            graph: Graph::new(),
            variables: IndexVec::new(),
            parameters: Vec::new(),
            equations: IndexVec::new(),
            discrete: Vec::new(),
            initial: Vec::new(),
            relations: Vec::new(),
            samples: Vec::new(),
            reinits: Vec::new(),
            asserts: Vec::new(),
            terminates: Vec::new(),
            eliminated: Vec::new(),
            functions: IndexVec::new(),
            delays: Vec::new(),
            transports: Vec::new(),
            stated: Stated::default(),
            experiment: Experiment::default(),
        };
        let blocks = Blocks {
            dae,
            states: Vec::new(),
            dummies: Vec::new(),
            state_sets: Vec::new(),
            initial: Vec::new(),
            initial_by_states: Vec::new(),
            event: Vec::new(),
            continuous: Vec::new(),
            assumed_starts: Vec::new(),
            undetermined: Vec::new(),
        };
        Builder { blocks, sources: SourceMap::default() }
    }

    pub fn g(&mut self) -> &mut Graph {
        &mut self.blocks.dae.graph
    }

    pub fn real(&mut self, x: f64) -> ExprId {
        self.g().real(x)
    }

    pub fn variable(
        &mut self,
        text: &str,
        ty: Type,
        kind: VariableKind,
        start: Option<f64>,
    ) -> VarId {
        let start = start.map(|s| match ty {
            Type::Boolean => self.g().boolean(s != 0.0),
            Type::Integer => self.g().integer(s as i64),
            _ => self.g().real(s),
        });
        self.blocks.dae.variables.push(Variable {
            name: text.into(),
            ty,
            kind,
            derivative_of: None,
            start,
            fixed: None,
            min: None,
            max: None,
            nominal: None,
            state_select: StateSelect::Default,
            unit: name(""),
            display_unit: name(""),
            description: None,
            vanishes: false,
            hidden: false,
            structural: false,
            protected: false,
            span: Span::NONE,
        })
    }

    pub fn read(&mut self, v: VarId) -> ExprId {
        let ty = self.blocks.dae.variables[v].ty;
        self.g().var(v, ty)
    }

    /// A parameter with a literal value; the expression that reads it.
    pub fn parameter(&mut self, text: &str, value: f64) -> (VarId, ExprId) {
        let v = self.variable(text, Type::Real, VariableKind::Parameter, None);
        let value = self.real(value);
        self.blocks.dae.parameters.push((v, value));
        (v, self.read(v))
    }

    /// A state with fixed start: state, the expression that reads it, and its derivative.
    pub fn state(&mut self, text: &str, start: f64) -> (VarId, ExprId, VarId) {
        let x = self.variable(text, Type::Real, VariableKind::Algebraic, Some(start));
        let d = self.variable(&format!("der({text})"), Type::Real, VariableKind::Algebraic, None);
        self.blocks.dae.variables[x].kind = VariableKind::Differentiated { derivative: d };
        self.blocks.dae.variables[d].derivative_of = Some(x);
        self.blocks.states.push(State { variable: x, derivative: d });
        let value = self.blocks.dae.variables[x].start.unwrap();
        let source = Source::Start(x);
        self.blocks.initial.push(Block::Assign(Assignment { variable: x, value, source }));
        (x, self.read(x), d)
    }

    pub fn algebraic(&mut self, text: &str) -> (VarId, ExprId) {
        let v = self.variable(text, Type::Real, VariableKind::Algebraic, None);
        (v, self.read(v))
    }

    pub fn discrete(&mut self, text: &str, ty: Type, start: f64) -> (VarId, ExprId) {
        let v = self.variable(text, ty, VariableKind::Discrete, Some(start));
        (v, self.read(v))
    }

    pub fn origin(&mut self, text: &str) -> Origin {
        let file = self.sources.add("model.mo", text);
        Origin { span: Span::new(file, 0, text.len()), component: "".into() }
    }

    /// A continuous equation `lhs = rhs`; its source.
    pub fn equation(&mut self, lhs: ExprId, rhs: ExprId) -> (Source, ExprId) {
        let residual = self.g().sub(lhs, rhs);
        let origin = self.origin("lhs = rhs;");
        let id: EqId = self.blocks.dae.equations.push(Equation {
            lhs,
            rhs,
            residual,
            origin,
            derivative_of: None,
        });
        (Source::Continuous(id), residual)
    }

    /// `v = value` as an assignment.
    pub fn assignment(&mut self, variable: VarId, value: ExprId) -> Assignment {
        let lhs = self.read(variable);
        let (source, _) = self.equation(lhs, value);
        Assignment { variable, value, source }
    }

    /// Adds `v = value` to all sequences.
    pub fn assign(&mut self, v: VarId, value: ExprId) {
        let a = self.assignment(v, value);
        self.add(Block::Assign(a));
    }

    /// Adds a block to all sequences.
    pub fn add(&mut self, block: Block) {
        self.blocks.initial.push(block.clone());
        self.blocks.event.push(block.clone());
        self.blocks.continuous.push(block);
    }

    /// Adds a torn block with the residuals `lhs - rhs`.
    pub fn torn(
        &mut self,
        unknowns: &[VarId],
        explicit: Vec<Assignment>,
        equations: &[(ExprId, ExprId)],
        linear: bool,
    ) {
        let residuals = equations
            .iter()
            .map(|&(lhs, rhs)| {
                let (source, value) = self.equation(lhs, rhs);
                Residual { value, source }
            })
            .collect();
        self.add(Block::Torn(Torn { unknowns: unknowns.to_vec(), explicit, residuals, linear }));
    }

    /// Adds the discrete equation `v := value`.
    pub fn discrete_equation(&mut self, variable: VarId, value: ExprId) -> Assignment {
        let origin = self.origin("when ... then");
        self.blocks.dae.discrete.push(DiscreteEquation { variable, value, origin });
        let source = Source::Discrete(self.blocks.dae.discrete.len() - 1);
        Assignment { variable, value, source }
    }

    /// Adds `v := value` to the initial and the event sequence.
    pub fn at_events(&mut self, v: VarId, value: ExprId) {
        let a = self.discrete_equation(v, value);
        self.blocks.initial.push(Block::Assign(a));
        self.blocks.event.push(Block::Assign(a));
    }

    /// A held relation; the expression that reads it.
    pub fn relation(&mut self, lhs: ExprId, op: Binary, rhs: ExprId, trigger: Trigger) -> ExprId {
        let origin = self.origin("if lhs < rhs then");
        let k = self.blocks.dae.relations.len() as u32;
        self.blocks.dae.relations.push(Relation { op, lhs, rhs, trigger, origin });
        self.g().intern(crate::ir::expr::Node::Relation(k), Type::Boolean)
    }

    /// A Boolean variable `c = condition` and the expression of its edge.
    pub fn edge(&mut self, text: &str, condition: ExprId) -> ExprId {
        let (c, read) = self.discrete(text, Type::Boolean, 0.0);
        self.at_events(c, condition);
        let pre = self.g().pre(c, Type::Boolean);
        let not_before = self.g().not(pre);
        self.g().and(read, not_before)
    }

    pub fn reinit(&mut self, active: ExprId, state: VarId, value: ExprId) {
        let origin = self.origin("reinit(x, value);");
        self.blocks.dae.reinits.push(Reinit { active, state, value, origin });
    }

    pub fn program(&self) -> Program {
        let program = match compile(self.blocks.clone()) {
            Ok(program) => program,
            Err(problems) => panic!("{problems:?}"),
        };
        assert_eq!(program.verify(), Ok(()));
        program
    }

    pub fn run(&self, stop: f64, tolerance: f64) -> Result<Run, Failure> {
        let settings = Settings {
            stop,
            interval: stop / 100.0,
            tolerance,
            ..Settings::of(&Experiment::default())
        };
        let run = simulate(&self.program(), &settings, &self.sources)?;
        assert_eq!(run.trajectory.verify(), Ok(()));
        Ok(run)
    }
}
