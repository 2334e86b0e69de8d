//! The first of two decisions about the call of a function whose body was executed on symbols: whether the
//! body is substituted at once, or called. `flatten::inline` reconsiders the calls that are left when all of
//! them are known, and `structure` inlines what must be differentiated.

use super::Evaluator;
use super::function::Components;
use super::specialization::{FlatFunction, Specialization};
use super::value::Value;
use crate::base::index::{FastMap, Id};
use crate::ir::ast::{ArgumentKind, Causality, ExprKind, Variability};
use crate::ir::expr::{
    Const, ExprId, FIRST_SYMBOL, FunctionId, Graph, ListId, Node, Type, Unary, VarId,
};
use crate::ir::flat::{Assert, AssertionLevel, Function, LocalId, Statement};
use crate::ir::instance::ClassId;
use crate::symbolic::rewrite::Rewriter;

/// Nodes up to which a body is inlined wherever it is called. Formulas are worth more than the code they take:
/// equations are solved for their arguments, differentiated exactly, and share what they have in common.
/// The bodies of the Standard Library's media are below this number, but for some equations of state of water.
const LARGE_BODY: usize = 2_000;

/// Why a call is not one of a function of the flat model, but its body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum WhyInlined {
    /// The body is no larger than [`LARGE_BODY`].
    Small,
    /// `annotation(Inline = true)` or `annotation(LateInline = true)`.
    Annotated,
    /// The value is known before the model runs, and may be asked for.
    ParameterExpression,
    /// It is called by a recursive function, which must know whether it goes on.
    InRecursion,
    /// Assertions that only warn, and printed lines, belong to equations.
    Warns,
    /// The body reads something else than its arguments.
    Open,
}

impl Evaluator<'_> {
    /// Why the body of a function is substituted for a call; `None` if it is called.
    pub(super) fn why_inlined(
        &mut self,
        body: &Specialization,
        components: &Components,
        arguments: &[ExprId],
    ) -> Option<WhyInlined> {
        if body.size <= LARGE_BODY {
            return Some(WhyInlined::Small);
        }
        if self.is_annotated(body.class) {
            return Some(WhyInlined::Annotated);
        }
        if self.recursions.is_being_made() {
            return Some(WhyInlined::InRecursion);
        }
        if body.asserts.iter().any(|a| a.level != AssertionLevel::Error) {
            return Some(WhyInlined::Warns);
        }
        if arguments.iter().all(|e| self.variability(*e) <= Variability::Parameter) {
            return Some(WhyInlined::ParameterExpression);
        }
        let is_made = self.flat_function(body, components).is_some();
        (!is_made).then_some(WhyInlined::Open)
    }

    fn is_annotated(&self, class: ClassId) -> bool {
        let annotation = self.definition(class).and_then(|text| text.annotation.as_ref());
        annotation.is_some_and(|annotation| {
            annotation.args.iter().any(|argument| match &argument.kind {
                ArgumentKind::Element { path, modification: Some(m), .. } => {
                    let wanted = |name: &str| name == "Inline" || name == "LateInline";
                    let binding = m.binding.as_ref().map(|e| &e.kind);
                    matches!(path.parts.as_slice(), [one] if wanted(one.name.as_str()))
                        && matches!(binding, Some(ExprKind::Boolean(true)))
                }
                _ => false,
            })
        })
    }

    /// A call of the flat model's function. An output that is a literal or an argument as it is needs no
    /// call, and a discrete one keeps its formula, which shows that it changes at events only.
    pub(super) fn call_flat(
        &mut self,
        body: &Specialization,
        arguments: &[ExprId],
    ) -> Option<Value> {
        let function = self.specializations.flat.get(&body.first)?.clone()?;
        let mut all = vec![self.active_condition()];
        all.extend(arguments);
        let args = self.graph.intern_list(&all);
        let mut formula = body.formula(&all);
        let mut outputs = (0..).zip(&function.types);
        Some(body.value.each_scalar(&mut |e| match outputs.next() {
            Some((output, ty)) => {
                let is_argument = body.symbols.contains(&e) || self.graph.as_const(e).is_some();
                if is_argument && self.graph.ty(e) == *ty || *ty != Type::Real {
                    return formula(&mut self.class_graph.graph, e);
                }
                self.graph.intern(Node::Call { function: function.id, output, args }, *ty)
            }
            None => e,
        }))
    }

    /// The function of the flat model that a body is.
    fn flat_function(
        &mut self,
        body: &Specialization,
        components: &Components,
    ) -> Option<FlatFunction> {
        if let Some(known) = self.specializations.flat.get(&body.first) {
            return known.clone();
        }
        let made = self.make_flat_function(body, components);
        self.specializations.flat.insert(body.first, made.clone());
        made
    }

    fn make_flat_function(
        &mut self,
        body: &Specialization,
        components: &Components,
    ) -> Option<FlatFunction> {
        let types = self.output_types(body, components)?;
        let name = self.classes[body.class].full_name.to_string();
        let span = self.definition(body.class).map(|text| text.name.span)?;
        let mut made = function_of(&mut self.class_graph.graph, body, &types)?;
        (made.name, made.span) = (name, span);
        let id = FunctionId::from_usize(self.loops.functions.len());
        self.loops.functions.push(made);
        Some(FlatFunction { id, types })
    }

    /// The declared types of the scalars of the outputs.
    fn output_types(
        &mut self,
        body: &Specialization,
        components: &Components,
    ) -> Option<Vec<Type>> {
        let mut outputs = Vec::new();
        for (entry, declaration) in components {
            if self.causality(entry, declaration) == Some(Causality::Output) {
                outputs.push(self.scalar_types(entry, declaration));
            }
        }
        let values = match &body.value {
            Value::Tuple(all) => all.to_vec(),
            one => vec![one.clone()],
        };
        let mut types = Vec::new();
        for (value, declared) in values.iter().zip(&outputs) {
            let first = types.len();
            value.for_each_scalar(&mut |_| types.push(Type::Real));
            if declared.is_empty() || (types.len() - first) % declared.len() != 0 {
                return None;
            }
            for (ty, declared) in types[first..].iter_mut().zip(declared.iter().cycle()) {
                *ty = *declared;
            }
        }
        (values.len() == outputs.len()).then_some(types)
    }

    /// The functions that calls of the model may still be replaced by, with the sizes of their bodies.
    pub(crate) fn specialized_functions(&self) -> FastMap<FunctionId, usize> {
        let made = self.specializations.flat.values().flatten();
        made.map(|f| {
            let values = self.loops.functions[f.id.idx()].values();
            (f.id, self.graph.postorder(values).len())
        })
        .collect()
    }

    /// The outputs of a function that is inlined in the model, without events except those of its arguments.
    pub(crate) fn inlined_results(&mut self, outputs: &[ExprId], args: ListId) -> Vec<ExprId> {
        let arguments = self.graph.list(args).to_vec();
        let given: Vec<_> = arguments[1..].iter().map(|e| Some(Value::Scalar(*e))).collect();
        let events = self.events_of_arguments(&given);
        let outputs = self.graph.with_arguments(outputs, &arguments);
        let closed = self.closed(&Value::vector(outputs), &events);
        closed.elements().iter().filter_map(Value::scalar).collect()
    }
}

/// The function that computes a body from its symbols; `None` if that reads anything else.
fn function_of(graph: &mut Graph, body: &Specialization, types: &[Type]) -> Option<Function> {
    let mut outputs = Vec::new();
    body.value.for_each_scalar(&mut |e| outputs.push(e));
    let conditions: Vec<ExprId> = (body.asserts.iter())
        .map(|a| a.unless[1..].iter().fold(a.bare, |all, off| graph.or(*off, all)))
        .collect();
    let inputs = body.symbols.len();
    let local = |v: VarId| {
        let k = v.0.checked_sub(FIRST_SYMBOL + body.first)?;
        ((k as usize) < inputs).then_some(VarId(k))
    };
    let roots = outputs.iter().chain(&conditions).copied();
    let is_closed =
        graph.all(roots.chain(body.asserts.iter().map(|a| a.message)), |_, node| match node {
            Node::Var(v) => local(v).is_some(),
            Node::Unary(Unary::Carried(_), _) => false,
            Node::Const(_)
            | Node::Unary(..)
            | Node::Binary(..)
            | Node::If(..)
            | Node::NoEvent(_)
            | Node::Smooth(..)
            | Node::Homotopy(..)
            | Node::Call { .. } => true,
            _ => false,
        });
    if !is_closed {
        return None;
    }
    let mut rewriter = Rewriter::new();
    let mut over_locals = |graph: &mut Graph, e: ExprId| {
        rewriter.apply(graph, e, &mut |graph, n| {
            let Node::Var(v) = graph.node(n) else { return None };
            let ty = graph.ty(n);
            local(v).map(|v| graph.var(v, ty))
        })
    };
    let id = LocalId::from_usize;
    let mut statements = Vec::new();
    for (a, condition) in body.asserts.iter().zip(conditions) {
        let condition = over_locals(graph, condition);
        let message = over_locals(graph, a.message);
        let assert = Assert { condition, message, level: a.level };
        statements.push(Statement::Assert(assert, a.span));
    }
    for (k, (e, ty)) in outputs.iter().zip(types).enumerate() {
        let e = over_locals(graph, *e);
        let e = match graph.as_const(e) {
            Some(Const::Integer(n)) if *ty == Type::Real => graph.real(n as f64),
            _ => e,
        };
        statements.push(Statement::Assign(id(inputs + k), e));
    }
    let active = graph.var(VarId(0), Type::Boolean);
    let mut names = vec!["active".to_string()];
    names.extend((1..inputs).map(|k| format!("x{k}")));
    names.extend((1..=outputs.len()).map(|k| format!("y{k}")));
    Some(Function {
        name: String::new(),
        span: crate::base::source::Span::NONE,
        inputs: (0..inputs).map(id).collect(),
        outputs: (inputs..names.len()).map(id).collect(),
        locals: names.into_iter().collect(),
        body: vec![Statement::If(active, statements, Vec::new())],
    })
}
