//! A compiled program as bytes.
//!
//! In: a [`Program`] without the expressions of the model (an export removes them). Out: bytes, and an equal
//! program. A slot or reference beyond the program is an error of [`Program::verify`], which the reader calls.

use crate::base::index::{Id, IndexVec};
use crate::base::name::{Name, name, string_id, string_of_id};
use crate::base::source::Span;
use crate::base::wire::{Damaged, Reader, Wire, wire_enum, wire_struct};
use crate::external::transfer;
use crate::ir::blocks::{Blocks, State, StateSet};
use crate::ir::dae::{
    Dae, EqId, GuardedAssert, Relation, Sample, Stated, Terminate, Trigger, Variable, VariableKind,
};
use crate::ir::expr::{
    Binary, Carried, Const, EnumId, Enumeration, ExprId, Form, FormId, FunctionId, Graph, ListId,
    Node, Type, Unary, VarId,
};
use crate::ir::external::ExternalId;
use crate::ir::flat::{Assert, AssertionLevel, Experiment, Origin, StateSelect};
use crate::ir::program::{
    AlgebraicUnknown, AssertSlots, BlockDerivative, BlockPosition, Bounds, CallSite, Clock,
    Continuation, DelaySlots, DiscreteUnknown, Entry, Events, FunctionCode, Instr, Layout,
    MixedBlock, Op, Program, ReaderSlots, ReinitSlots, RelationStart, RelationTrigger, Routines,
    Sequence, StateSetSlots, Tape, Tapes, TornBlock, TransportSlots,
};

macro_rules! wire_id {
    ($($ty:ident),*) => {
        $(impl Wire for $ty {
            fn write(&self, out: &mut Vec<u8>) {
                self.0.write(out);
            }
            fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
                Ok($ty(u32::read(from)?))
            }
        })*
    };
}
wire_id!(VarId, ExprId, EqId, EnumId, FormId, FunctionId, ExternalId, ListId);

impl Wire for Name {
    fn write(&self, out: &mut Vec<u8>) {
        self.as_str().to_owned().write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(name(&String::read(from)?))
    }
}

/// Places in the source do not leave the process.
impl Wire for Span {
    fn write(&self, _: &mut Vec<u8>) {}
    fn read(_: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(Span::NONE)
    }
}

impl Wire for Tape {
    fn write(&self, out: &mut Vec<u8>) {
        let code: &Vec<Instr> = self;
        code.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(Vec::<Instr>::read(from)?.into())
    }
}

impl Wire for std::ops::Range<u32> {
    fn write(&self, out: &mut Vec<u8>) {
        (self.start, self.end).write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (start, end) = Wire::read(from)?;
        Ok(start..end)
    }
}

/// The number of an operator in its table follows the operators that carry data.
const CARRYING: usize = 3;

impl Wire for Unary {
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Unary::External(id) => (0_u8, *id).write(out),
            Unary::Carried(carried) => (1_u8, *carried).write(out),
            Unary::Text(form) => (2_u8, *form).write(out),
            op => {
                let at = Unary::TABLE.iter().position(|row| row == op).unwrap_or_default();
                (at + CARRYING).write(out);
            }
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(match usize::read(from)? {
            0 => Unary::External(Wire::read(from)?),
            1 => Unary::Carried(Wire::read(from)?),
            2 => Unary::Text(Wire::read(from)?),
            at => *at.checked_sub(CARRYING).and_then(|k| Unary::TABLE.get(k)).ok_or(Damaged)?,
        })
    }
}

impl Wire for Binary {
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Binary::External(id) => (0_u8, *id).write(out),
            op => {
                let at = Binary::TABLE.iter().position(|row| row == op).unwrap_or_default();
                (at + CARRYING).write(out);
            }
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(match usize::read(from)? {
            0 => Binary::External(Wire::read(from)?),
            at => *at.checked_sub(CARRYING).and_then(|k| Binary::TABLE.get(k)).ok_or(Damaged)?,
        })
    }
}

wire_struct!(Carried { line, reader, order });
wire_enum!(Op {
    Copy = 0, CopyIf = 1, Input = 2, Add = 3, Sub = 4, Mul = 5, Div = 6, Neg = 7, Unary(op) = 8,
    Binary(op) = 9, Solve = 10, Differentiate = 11, Iterate = 12, Call = 13, Jump = 14,
    JumpUnless = 15, Assert = 16,
});
wire_struct!(Instr { op, dst, a, b });
wire_struct!(Entry { row, column, slot });
wire_enum!(Sequence { Initial = 0, Event = 1, Continuous = 2, InitialByStates = 3 });
wire_struct!(BlockPosition { sequence, index });
wire_struct!(TornBlock {
    unknowns,
    slots,
    residual_tape,
    residuals,
    jacobian_tape,
    jacobian,
    nominals,
    bounds,
    linear,
    place
});
wire_struct!(BlockDerivative { torn_block, order, jacobian, seeds, results });
wire_enum!(DiscreteUnknown { Variable(v, slot) = 0, Relation(k, slot) = 1 });
wire_struct!(MixedBlock { decisions, tape, discrete_unknowns, edges, place });
wire_struct!(CallSite { function, args, results, partial, condition, memo });
wire_struct!(FunctionCode { tape, inputs, outputs, locals, messages, frame, is_recursive });
wire_enum!(RelationTrigger { State = 0, Time(slot) = 1, Discrete = 2 });
wire_struct!(Clock { start, interval, flag });
wire_struct!(ReinitSlots { active, state, value });
wire_struct!(AssertSlots { active, condition, at_events });
wire_struct!(Bounds { variable, value, min, max, nominal });
wire_struct!(StateSetSlots { candidates, nominals, states, selection, jacobian });
wire_struct!(DelaySlots { variable, source, delay, input, moves });
wire_struct!(ReaderSlots { place, from, to });
wire_struct!(TransportSlots { ends, entering, initial, readers });
wire_struct!(Layout {
    time,
    initial,
    terminal,
    variables,
    states,
    derivatives,
    nominals,
    pre,
    relations,
    candidates,
    indicators,
    parameter_inputs,
    signals,
    delays,
    transports,
    starts,
    parameters,
});
wire_struct!(Tapes {
    parameters,
    initial,
    initial_by_states,
    event,
    decided,
    discrete,
    rhs,
    roots,
    outputs,
    jacobian,
    state_selection
});
wire_struct!(Routines { torn_blocks, block_derivatives, mixed_blocks, calls, functions });
wire_struct!(RelationStart { relation, tape });
wire_struct!(Events {
    relation_triggers,
    relation_starts,
    lagged_initial,
    lagged_by_states,
    lagged_event,
    clocks,
    reinits,
    asserts,
    terminates,
    reads_terminal,
});
wire_struct!(Continuation { program, lambda, slots });
wire_struct!(State { variable, derivative });
wire_struct!(StateSet { candidates, dependent, wishes, states, selection, constraints, jacobian });
wire_struct!(Experiment { start, stop, interval, tolerance });
wire_enum!(AssertionLevel { Error = 0, Warning = 1, Print(file) = 2 });
wire_struct!(Assert { condition, message, level });
wire_enum!(Type { Real = 0, Integer = 1, Boolean = 2, String = 3, Enumeration(id) = 4, Clock = 5 });
wire_enum!(Const { Real(bits) = 0, Integer(i) = 1, Boolean(b) = 2, String(s) = 3, Enumeration(id, k) = 4 });
wire_struct!(Enumeration { name, literals });

/// The nodes that messages consist of; [`super::disclosure`] keeps no others.
impl Wire for Node {
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Node::Const(value) => (0_u8, *value).write(out),
            Node::Var(v) => (1_u8, *v).write(out),
            Node::Unary(op, a) => (2_u8, *op, *a).write(out),
            Node::Binary(op, a, b) => (3_u8, *op, (*a, *b)).write(out),
            Node::If(c, a, b) => (4_u8, *c, (*a, *b)).write(out),
            Node::Call { function, output, args } => (5_u8, *function, (*output, *args)).write(out),
            _ => 6_u8.write(out),
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(match from.byte()? {
            0 => Node::Const(Wire::read(from)?),
            1 => Node::Var(Wire::read(from)?),
            2 => Node::Unary(Wire::read(from)?, Wire::read(from)?),
            3 => Node::Binary(Wire::read(from)?, Wire::read(from)?, Wire::read(from)?),
            4 => Node::If(Wire::read(from)?, Wire::read(from)?, Wire::read(from)?),
            5 => Node::Call {
                function: Wire::read(from)?,
                output: Wire::read(from)?,
                args: Wire::read(from)?,
            },
            6 => Node::Time,
            _ => return Err(Damaged),
        })
    }
}

/// Nodes come after their operands, so ids below that of a node exist when it is read.
impl Wire for Graph {
    fn write(&self, out: &mut Vec<u8>) {
        self.enumerations.as_slice().to_vec().write(out);
        self.forms.as_slice().to_vec().write(out);
        let externals = self.externals().all();
        externals.len().write(out);
        for function in externals {
            transfer::write(&**function, out);
        }
        self.len().write(out);
        for id in self.ids() {
            (self.node(id), self.ty(id)).write(out);
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let mut graph = Graph::new();
        for enumeration in Vec::<Enumeration>::read(from)? {
            graph.enumerations.push(enumeration);
        }
        for form in Vec::<Form>::read(from)? {
            graph.forms.push(form);
        }
        for k in 0..usize::read(from)? {
            if graph.add_external(transfer::read(from)?).idx() != k {
                return Err(Damaged);
            }
        }
        for k in 0..usize::read(from)? {
            let (node, ty): (Node, Type) = Wire::read(from)?;
            let known = |e: ExprId| e.idx() < k;
            let is_sound = match node {
                Node::Unary(Unary::Text(form), _) if form.idx() >= graph.forms.len() => false,
                Node::Unary(_, a) => known(a),
                Node::Binary(_, a, b) => known(a) && known(b),
                Node::If(c, a, b) => known(c) && known(a) && known(b),
                _ => true,
            };
            if !is_sound || graph.intern(node, ty).idx() != k {
                return Err(Damaged);
            }
        }
        Ok(graph)
    }
}

/// What the simulation reads of a variable: its name, its type and its role.
impl Wire for Variable {
    fn write(&self, out: &mut Vec<u8>) {
        self.name.write(out);
        self.ty.write(out);
        let (kind, derivative) = match self.kind {
            VariableKind::Parameter => (0_u8, None),
            VariableKind::InitialParameter => (1, None),
            VariableKind::Differentiated { derivative } => (2, Some(derivative)),
            VariableKind::Algebraic => (3, None),
            VariableKind::Discrete => (4, None),
            VariableKind::Input => (5, None),
            VariableKind::Eliminated => (6, None),
        };
        (kind, derivative, self.fixed).write(out);
        [self.hidden, self.protected, self.structural].write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (name, ty) = (String::read(from)?, Type::read(from)?);
        let (kind, derivative, fixed): (u8, Option<VarId>, Option<bool>) = Wire::read(from)?;
        let kind = match (kind, derivative) {
            (0, _) => VariableKind::Parameter,
            (1, _) => VariableKind::InitialParameter,
            (2, Some(derivative)) => VariableKind::Differentiated { derivative },
            (3, _) => VariableKind::Algebraic,
            (4, _) => VariableKind::Discrete,
            (5, _) => VariableKind::Input,
            (6, _) => VariableKind::Eliminated,
            _ => return Err(Damaged),
        };
        let [hidden, protected, structural] = Wire::read(from)?;
        let state_select = StateSelect::Default;
        let bare = Variable::new(name, ty, kind, Span::NONE);
        Ok(Variable { fixed, hidden, protected, structural, state_select, ..bare })
    }
}

/// A relation by its operands, for messages; how it is triggered is in the program.
impl Wire for Relation {
    fn write(&self, out: &mut Vec<u8>) {
        (self.op, self.lhs, self.rhs).write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (op, lhs, rhs) = Wire::read(from)?;
        Ok(Relation { op, lhs, rhs, trigger: Trigger::State, origin: nowhere() })
    }
}

impl Wire for GuardedAssert {
    fn write(&self, out: &mut Vec<u8>) {
        self.assert.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(GuardedAssert { active: None, assert: Wire::read(from)?, origin: nowhere() })
    }
}

impl Wire for Terminate {
    fn write(&self, out: &mut Vec<u8>) {
        self.message.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let message = Wire::read(from)?;
        Ok(Terminate { active: message, message, origin: nowhere() })
    }
}

wire_struct!(Sample { start, interval, flag });

fn nowhere() -> Origin {
    Origin { span: Span::NONE, component: "".into() }
}

impl Wire for Dae {
    fn write(&self, out: &mut Vec<u8>) {
        self.name.write(out);
        self.graph.write(out);
        self.variables.as_slice().to_vec().write(out);
        self.relations.write(out);
        self.samples.write(out);
        self.asserts.write(out);
        self.terminates.write(out);
        self.experiment.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (name, graph) = (String::read(from)?, Graph::read(from)?);
        let mut variables = IndexVec::new();
        for variable in Vec::<Variable>::read(from)? {
            variables.push(variable);
        }
        let dae = Dae {
            name,
            graph,
            variables,
            parameters: Vec::new(),
            equations: IndexVec::new(),
            discrete: Vec::new(),
            initial: Vec::new(),
            relations: Wire::read(from)?,
            samples: Wire::read(from)?,
            reinits: Vec::new(),
            asserts: Wire::read(from)?,
            terminates: Wire::read(from)?,
            eliminated: Vec::new(),
            functions: IndexVec::new(),
            delays: Vec::new(),
            transports: Vec::new(),
            stated: Stated::default(),
            experiment: Wire::read(from)?,
        };
        let nodes = dae.graph.len();
        let relations = dae.relations.iter().flat_map(|r| [r.lhs, r.rhs]);
        let asserts = dae.asserts.iter().flat_map(|a| [a.assert.condition, a.assert.message]);
        let terminates = dae.terminates.iter().map(|t| t.message);
        let sound = relations.chain(asserts).chain(terminates).all(|e| e.idx() < nodes);
        let sampled = dae.samples.iter().all(|s| s.flag.idx() < dae.variables.len());
        if sound && sampled { Ok(dae) } else { Err(Damaged) }
    }
}

impl Wire for Program {
    fn write(&self, out: &mut Vec<u8>) {
        let blocks = &self.blocks;
        blocks.dae.write(out);
        blocks.states.write(out);
        blocks.state_sets.write(out);
        blocks.undetermined.write(out);
        strings(self).write(out);
        self.image.write(out);
        self.literals.write(out);
        self.layout.write(out);
        self.tapes.write(out);
        self.jacobian_entries.write(out);
        self.state_sets.write(out);
        self.routines.write(out);
        self.events.write(out);
        self.bounds.write(out);
        self.continuation.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let blocks = Blocks {
            dae: Wire::read(from)?,
            states: Wire::read(from)?,
            dummies: Vec::new(),
            state_sets: Wire::read(from)?,
            initial: Vec::new(),
            initial_by_states: Vec::new(),
            event: Vec::new(),
            continuous: Vec::new(),
            assumed_starts: Vec::new(),
            undetermined: Wire::read(from)?,
        };
        for (id, text) in Vec::<(u32, String)>::read(from)? {
            // Equal strings have equal ids in all processes, unless ids collide.
            if string_id(name(&text)) != id {
                return Err(Damaged);
            }
        }
        let mut program = Program {
            blocks,
            image: Wire::read(from)?,
            literals: Wire::read(from)?,
            layout: Wire::read(from)?,
            recorded: Vec::new(),
            constants: Vec::new(),
            tapes: Wire::read(from)?,
            rows: None,
            algebraics: Vec::<AlgebraicUnknown>::new(),
            jacobian_entries: Wire::read(from)?,
            forcing: None,
            state_sets: Wire::read(from)?,
            routines: Wire::read(from)?,
            events: Wire::read(from)?,
            bounds: Wire::read(from)?,
            continuation: Wire::read(from)?,
            foreign: None,
        };
        program.number_tapes();
        program.verify().map_err(|_| Damaged)?;
        Ok(program)
    }
}

/// The strings whose ids are values of the program.
fn strings(program: &Program) -> Vec<(u32, String)> {
    let mut found: Vec<(u32, String)> = Vec::new();
    for value in &program.image {
        let id = *value as u32;
        if id == 0 || f64::from(id) != *value || found.iter().any(|(known, _)| *known == id) {
            continue;
        }
        let text = string_of_id(id);
        if !text.is_empty() {
            found.push((id, text.to_string()));
        }
    }
    found
}
