//! Expressions: every id exists, operands precede their users, types agree, calls fit their functions.

use crate::base::index::{Id, IndexVec};
use crate::ir::builtin::{Shape, ValueType};
use crate::ir::expr::{ExprId, FunctionId, Graph, Node, Type, VarId};
use crate::ir::flat::Function;

/// What the expressions of a representation may refer to.
pub struct Scope<'a> {
    /// The expressions.
    pub graph: &'a Graph,
    /// The type of a variable, if it exists.
    pub type_of: &'a dyn Fn(VarId) -> Option<Type>,
    /// The functions that calls refer to.
    pub functions: &'a IndexVec<FunctionId, Function>,
    /// Why a node must not occur, if it must not.
    pub forbidden: &'a dyn Fn(Node) -> Option<&'static str>,
}

impl Scope<'_> {
    /// Checks everything below `roots`.
    pub fn check(&self, roots: &[ExprId], found: &mut Vec<String>) {
        let graph = self.graph;
        let mut inside = Vec::with_capacity(roots.len());
        for &e in roots {
            match e.idx() < graph.len() {
                true => inside.push(e),
                false => found.push(format!("there is no expression {}", e.0)),
            }
        }
        for e in graph.postorder(inside) {
            let node = graph.node(e);
            if let Some(why) = (self.forbidden)(node) {
                found.push(format!("expression {} is {node:?}: {why}", e.0));
            }
            graph.for_each_operand(e, |a| {
                if a >= e {
                    found.push(format!(
                        "expression {} reads {}, which does not precede it",
                        e.0, a.0
                    ));
                }
            });
            if let Some(why) = self.mismatch(e, node) {
                found.push(format!("expression {}, {node:?}: {why}", e.0));
            }
        }
    }

    fn mismatch(&self, e: ExprId, node: Node) -> Option<String> {
        let graph = self.graph;
        let ty = graph.ty(e);
        let expect =
            |wanted: Type| (ty != wanted).then(|| format!("it has type {ty:?}, not {wanted:?}"));
        match node {
            Node::Var(v) | Node::Pre(v) => match (self.type_of)(v) {
                None => Some("there is no such variable".to_owned()),
                Some(declared) => expect(declared),
            },
            Node::Der(_) | Node::Recorded(..) | Node::Time => expect(Type::Real),
            Node::Initial | Node::Terminal | Node::Relation(_) | Node::Sample(..) => {
                expect(Type::Boolean)
            }
            Node::Const(_) | Node::Clocked(..) => None,
            Node::Unary(op, a) => match op.facts()?.result {
                ValueType::Operand => expect(graph.ty(a)),
                ValueType::Real => expect(Type::Real),
                ValueType::Integer => expect(Type::Integer),
                ValueType::Boolean => self.boolean(a).or(expect(Type::Boolean)),
            },
            Node::Binary(op, a, b) => {
                let row = op.facts()?;
                let connective = row.shape == Shape::Logic && !op.is_relation();
                if connective {
                    return self.boolean(a).or(self.boolean(b)).or(expect(Type::Boolean));
                }
                let wanted = match row.result {
                    ValueType::Operand => graph.common_type(a, b),
                    ValueType::Real => Type::Real,
                    ValueType::Integer => Type::Integer,
                    ValueType::Boolean => Type::Boolean,
                };
                expect(wanted).or(self.differ(a, b))
            }
            Node::If(c, a, b) => self.boolean(c).or(self.differ(a, b)),
            Node::NoEvent(a) | Node::Smooth(_, a) => expect(graph.ty(a)),
            Node::Homotopy(..) => expect(Type::Real),
            Node::Call { function, output, args } => {
                let Some(f) = self.functions.get(function) else {
                    return Some("there is no such function".to_owned());
                };
                let (given, wanted) = (graph.list(args).len(), f.inputs.len());
                if given != wanted {
                    return Some(format!("`{}` has {wanted} inputs, not {given}", f.name));
                }
                (output as usize >= f.outputs.len())
                    .then(|| format!("`{}` has {} outputs", f.name, f.outputs.len()))
            }
        }
    }

    fn boolean(&self, e: ExprId) -> Option<String> {
        let ty = self.graph.ty(e);
        (ty != Type::Boolean).then(|| format!("a condition has type {ty:?}"))
    }

    /// Numbers go together, and equal types.
    fn differ(&self, a: ExprId, b: ExprId) -> Option<String> {
        let [a, b] = [a, b].map(|e| self.graph.ty(e));
        (!compatible(a, b)).then(|| format!("operands have types {a:?} and {b:?}"))
    }
}

/// Whether values of two types can be compared and assigned.
pub fn compatible(a: Type, b: Type) -> bool {
    let number = |ty| matches!(ty, Type::Real | Type::Integer);
    a == b || number(a) && number(b)
}
