//! What of a model leaves the process: its program and names, but not its equations.
//!
//! In: a [`Program`]. Out: the same program whose system holds only the expressions of messages. Relations
//! are named by their number, assertions by their message.

use crate::base::index::{FastMap, IndexVec};
use crate::base::source::Span;
use crate::ir::dae::{Variable, VariableKind};
use crate::ir::expr::{Const, ExprId, Graph, Node, Type, VarId};
use crate::ir::program::Program;

/// The program without the equations of the model. `with_relations` keeps the operands of relations.
pub fn disclosed(program: &Program, with_relations: bool) -> Program {
    let mut kept = program.clone();
    let old = &program.blocks.dae;
    let mut copier = Copier::new(&old.graph);
    let variables = old.variables.iter().map(bare);
    let mut all: IndexVec<VarId, Variable> = IndexVec::new();
    variables.for_each(|v| {
        all.push(v);
    });
    let dae = &mut kept.blocks.dae;
    for (k, relation) in dae.relations.iter_mut().enumerate() {
        if with_relations {
            relation.lhs = copier.copy(relation.lhs);
            relation.rhs = copier.copy(relation.rhs);
            continue;
        }
        let name = format!("relation {}", k + 1);
        let stand_in = Variable {
            hidden: true,
            ..Variable::new(name, Type::Real, VariableKind::Eliminated, Span::NONE)
        };
        let v = all.push(stand_in);
        kept.layout.variables.push(kept.layout.time);
        relation.lhs = copier.graph.var(v, Type::Real);
        relation.rhs = copier.graph.real(0.0);
    }
    for sample in &mut dae.samples {
        (sample.start, sample.interval) = (copier.nothing, copier.nothing);
    }
    for guarded in &mut dae.asserts {
        guarded.active = None;
        guarded.assert.message = copier.copy(guarded.assert.message);
        // The program computes the condition itself.
        guarded.assert.condition = copier.graph.boolean(true);
    }
    for terminate in &mut dae.terminates {
        terminate.message = copier.copy(terminate.message);
        terminate.active = terminate.message;
    }
    dae.graph = copier.graph;
    dae.variables = all;
    for set in &mut kept.blocks.state_sets {
        set.jacobian.clear();
    }
    if let Some(continuation) = kept.continuation.as_deref_mut() {
        continuation.program = disclosed(&continuation.program, with_relations);
    }
    kept
}

/// A variable without expressions and texts.
fn bare(v: &Variable) -> Variable {
    Variable {
        fixed: v.fixed,
        hidden: v.hidden,
        protected: v.protected,
        structural: v.structural,
        ..Variable::new(v.name.clone(), v.ty, v.kind, Span::NONE)
    }
}

/// Copies expressions to a new graph.
struct Copier<'a> {
    from: &'a Graph,
    graph: Graph,
    known: FastMap<ExprId, ExprId>,
    nothing: ExprId,
}

impl<'a> Copier<'a> {
    fn new(from: &'a Graph) -> Self {
        let mut graph = Graph::new();
        graph.enumerations = from.enumerations.clone();
        graph.forms = from.forms.clone();
        for function in from.externals().all() {
            graph.add_external(function.clone());
        }
        let nothing = graph.constant(Const::String("".into()));
        Copier { from, graph, known: FastMap::default(), nothing }
    }

    /// The copy of an expression; an empty string for what messages do not consist of.
    fn copy(&mut self, root: ExprId) -> ExprId {
        for e in self.from.postorder([root]) {
            if self.known.contains_key(&e) {
                continue;
            }
            let of = |known: &FastMap<ExprId, ExprId>, a: ExprId| known.get(&a).copied();
            let known = &self.known;
            let nothing = self.nothing;
            let get = |a: ExprId| of(known, a).unwrap_or(nothing);
            let node = match self.from.node(e) {
                node @ (Node::Const(_) | Node::Var(_) | Node::Time) => Some(node),
                Node::Unary(op, a) => Some(Node::Unary(op, get(a))),
                Node::Binary(op, a, b) => Some(Node::Binary(op, get(a), get(b))),
                Node::If(c, a, b) => Some(Node::If(get(c), get(a), get(b))),
                Node::Call { function, output, .. } => {
                    // Messages read the results of the call, not its arguments.
                    let args = self.graph.intern_list(&[]);
                    Some(Node::Call { function, output, args })
                }
                Node::NoEvent(a) | Node::Smooth(_, a) => Some(self.graph.node(get(a))),
                _ => None,
            };
            let copied = match node {
                Some(node) => self.graph.intern(node, self.from.ty(e)),
                None => nothing,
            };
            self.known.insert(e, copied);
        }
        self.known.get(&root).copied().unwrap_or(self.nothing)
    }
}
