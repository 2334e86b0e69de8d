//! Operators that ask for the connections of the whole model: `Connections.isRoot` and `rooted`
//! (Modelica 3.6, section 9.4.1), `inStream` and `actualStream` (sections 15.2 and 15.3).
//!
//! The roots are known before equations are expanded. The value that `inStream` stands for is known
//! only when all connections are: until then it is a variable, whose equation `flatten` adds.

use super::Evaluator;
use super::cause::builtin::BuiltinCause;
use super::history::Synthetic;
use super::reference::Selection;
use super::value::Value;
use crate::base::index::{FastMap, FastSet};
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{ClassKind, ComponentRef, ConnectionPrefix, Expr, ExprKind, Variability};
use crate::ir::expr::{Binary, ExprId, Node, Type, VarId};
use crate::ir::instance::{InstanceId, InstanceKind, Scope};

/// The roots of the graph of overconstrained connections.
#[derive(Clone, Default, Debug)]
pub struct GraphRoots {
    /// The roots of the trees.
    pub roots: FastSet<InstanceId>,
    /// For each node with one branch, whether it is closer to the root than the other end.
    pub rooted: FastMap<InstanceId, bool>,
}

/// The name of the function that makes a type or record an overdetermined one.
pub(crate) fn equality_constraint() -> Name {
    name("equalityConstraint")
}

impl Evaluator<'_> {
    /// True for a variable or record whose type has a function `equalityConstraint`.
    pub(crate) fn is_overdetermined(&mut self, id: InstanceId) -> bool {
        let kind = &self.instances[id].kind;
        let has_type = matches!(kind, InstanceKind::Variable { .. } | InstanceKind::Object(_));
        has_type && self.table_of(id).index.contains_key(&equality_constraint())
    }

    /// `Connections.isRoot(a)`, `Connections.rooted(a)`, and `rooted(a)` of older libraries; `None`
    /// for any other function.
    pub(super) fn graph_query(
        &mut self,
        function: &ComponentRef,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Option<Value>> {
        let is_root = match function.parts.as_slice() {
            [package, operator] if package.name.name == "Connections" => {
                match operator.name.name.as_str() {
                    "isRoot" => true,
                    "rooted" => false,
                    _ => return None,
                }
            }
            [operator] if operator.name.name == "rooted" => false,
            _ => return None,
        };
        Some(self.answer_of_graph(is_root, args, span, scope))
    }

    fn answer_of_graph(
        &mut self,
        is_root: bool,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let [Expr { kind: ExprKind::Ref(r), .. }] = args else {
            self.wrong_arguments(span, "an overdetermined variable of a connector");
            return None;
        };
        let answer = match self.select(r, scope)? {
            Selection::Absent => false,
            Selection::Whole(mut id) => {
                while let InstanceKind::Outer(inner) = self.instances[id].kind {
                    id = inner;
                }
                if !self.is_overdetermined(id) {
                    self.report(BuiltinCause::NotAGraphNode, r.span);
                    return None;
                }
                let Some(graph) = &self.builtins.graph_roots else {
                    self.report(BuiltinCause::RootOutsideEquations, span);
                    return None;
                };
                if is_root {
                    graph.roots.contains(&id)
                } else {
                    let Some(rooted) = graph.rooted.get(&id).copied() else {
                        self.report(BuiltinCause::RootedWithoutBranch, span);
                        return None;
                    };
                    rooted
                }
            }
            Selection::Element(..) | Selection::Many(..) | Selection::Dynamic(..) => {
                self.wrong_arguments(span, "an overdetermined variable of a connector");
                return None;
            }
        };
        Some(Value::Scalar(self.graph.boolean(answer)))
    }

    /// `inStream(v)`: the value of `v` that flows in from what is connected.
    pub(super) fn in_stream_call(
        &mut self,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        self.of_stream(args, span, scope, |cx, v, _| Some(cx.in_stream(v)))
    }

    /// `actualStream(v) = if flow > 0 then inStream(v) else v`.
    pub(super) fn actual_stream_call(
        &mut self,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        self.of_stream(args, span, scope, |cx, v, ty| {
            let outflow = cx.graph.var(v, ty);
            let inflow = cx.in_stream(v);
            let flow = cx.flow_of_stream(cx.instance_of[v.0 as usize].0)?;
            let flow = cx.graph.var(flow, Type::Real);
            let zero = cx.graph.real(0.0);
            let inwards = cx.graph.binary(Binary::Greater, flow, zero);
            Some(cx.graph.if_then_else(inwards, inflow, outflow))
        })
    }

    /// Applies an operator to each scalar of stream variables.
    fn of_stream(
        &mut self,
        args: &[Expr],
        span: Span,
        scope: Scope,
        act: impl Fn(&mut Self, VarId, Type) -> Option<ExprId>,
    ) -> Option<Value> {
        let [argument] = args else {
            self.wrong_arguments(span, "one argument");
            return None;
        };
        let mode = self.mode.unassigned();
        let value = self.with_mode(mode, |cx| cx.evaluate(argument, scope))?;
        if self.mode.sizes {
            return Some(value);
        }
        value.map(|v| {
            let e = self.scalar_of(v.clone(), argument.span)?;
            if let Node::Var(v) = self.graph.node(e)
                && let Some((id, _)) = self.instance_of.get(v.0 as usize).copied()
                && self.instances[id].prefix.connection == Some(ConnectionPrefix::Stream)
            {
                let ty = self.graph.ty(e);
                return act(self, v, ty).map(Value::Scalar);
            }
            self.report(BuiltinCause::NotAStream, argument.span);
            None
        })
    }

    /// The variable that stands for `inStream` of a stream variable.
    pub(crate) fn in_stream(&mut self, v: VarId) -> ExprId {
        let made = match self.builtins.in_stream.get(&v) {
            Some(made) => *made,
            None => {
                let made = self.make(Synthetic::InStream(v));
                self.builtins.in_stream.insert(v, made);
                made
            }
        };
        self.graph.var(made, Type::Real)
    }

    /// The flow that transports a stream variable.
    pub(crate) fn flow_of_stream(&mut self, stream: InstanceId) -> Option<VarId> {
        let mut holder = self.instances[stream].parent;
        while let Some(id) = holder {
            let class = self.instances[id].class;
            let is_connector = class.is_some_and(|c| self.kind(c) == ClassKind::Connector)
                && matches!(self.instances[id].kind, InstanceKind::Object(_));
            if is_connector && let Some(flow) = self.flow_below(id) {
                return Some(flow);
            }
            holder = self.instances[id].parent;
        }
        None
    }

    fn flow_below(&self, id: InstanceId) -> Option<VarId> {
        let instance = &self.instances[id];
        match &instance.kind {
            InstanceKind::Object(children) => {
                children.iter().find_map(|child| self.flow_below(*child))
            }
            InstanceKind::Variable { first, .. } => first.filter(|_| {
                instance.prefix.connection == Some(ConnectionPrefix::Flow)
                    && !matches!(
                        instance.prefix.variability,
                        Some(Variability::Parameter | Variability::Constant)
                    )
            }),
            _ => None,
        }
    }

    /// True for a call of `actualStream`, whose product with the flow is continuous.
    pub(super) fn is_actual_stream(&self, e: &Expr) -> bool {
        let named = |name: Option<Name>| name.is_some_and(|n| n == "actualStream");
        match &e.kind {
            ExprKind::Call { function, .. } => named(function.simple()),
            ExprKind::Parenthesised(inner) => self.is_actual_stream(inner),
            _ => false,
        }
    }
}
