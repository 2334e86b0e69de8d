//! Equations of components: loops written out, `if` on parameters decided, arrays and records taken
//! apart (chapter 8 of the specification).

use std::sync::Arc;

use super::connect::Connections;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::evaluate::builtin::argument;
use crate::evaluate::draw::Place;
use crate::evaluate::external::{Asserted, level_of};
use crate::evaluate::implicit_ranges::Body;
use crate::evaluate::value::Value;
use crate::instantiate::Context;
use crate::ir::ast::{self, Expr, ExprKind, StatementKind};
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Assert, Equation, EquationKind, FlatModel, Level, Origin};
use crate::ir::instance::{InstanceId, Scope, SectionKind};

/// Where equations go, and where they come from.
pub(super) struct Target<'f> {
    pub(super) flat: &'f mut FlatModel,
    pub(super) connections: &'f mut Connections,
    pub(super) component: Arc<str>,
    pub(super) initial: bool,
}

impl Target<'_> {
    pub(super) fn origin(&self, span: Span) -> Origin {
        Origin { span, component: self.component.clone() }
    }

    fn push(&mut self, kind: EquationKind, span: Span) {
        let equation = Equation { kind, origin: self.origin(span) };
        self.list().push(equation);
    }

    /// The equations of the model, or those of its start.
    fn list(&mut self) -> &mut Vec<Equation> {
        if self.initial { &mut self.flat.initial_equations } else { &mut self.flat.equations }
    }
}

/// Adds the equations of one component.
pub fn of_object(
    cx: &mut Context<'_>,
    object: InstanceId,
    flat: &mut FlatModel,
    connections: &mut Connections,
) {
    let table = cx.table_of(object);
    if table.sections.is_empty() {
        return;
    }
    let component: Arc<str> = cx.path(object).into();
    for section in &table.sections {
        let scope = Scope { instance: object, class: section.class };
        let mut target =
            Target { flat, connections, component: component.clone(), initial: section.initial };
        let place = if section.initial { Place::Start } else { Place::Always };
        cx.in_place(place, |cx| match &section.kind {
            SectionKind::Equations(list) => expand_all(cx, list, scope, &mut target),
            SectionKind::Algorithm(list, span) => algorithm(cx, list, *span, scope, &mut target),
        });
        asserted(cx, &mut target);
    }
}

fn expand_all(cx: &mut Context<'_>, list: &[ast::Equation], scope: Scope, target: &mut Target<'_>) {
    for e in list {
        let outside = std::mem::take(&mut cx.evaluation.lost_unit);
        expand(cx, e, scope, target);
        if std::mem::replace(&mut cx.evaluation.lost_unit, outside) {
            target.flat.lost_units.insert(e.span);
        }
        asserted(cx, target);
    }
}

/// Adds what the functions that were called assert.
fn asserted(cx: &mut Context<'_>, target: &mut Target<'_>) {
    for a in std::mem::take(&mut cx.evaluation.asserts) {
        let Asserted { condition, message, level, span } = a;
        target.push(EquationKind::Assert(Assert { condition, message, level }), span);
    }
}

/// Expands one equation; `None` after an error, so that others go on.
fn expand(
    cx: &mut Context<'_>,
    e: &ast::Equation,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    match &e.kind {
        ast::EquationKind::Equal(lhs, rhs) => equal(cx, lhs, rhs, e.span, scope, target),
        ast::EquationKind::If { branches, otherwise } => {
            if_equation(cx, branches, otherwise, e.span, scope, target)
        }
        ast::EquationKind::For { iterators, body } => {
            let iterators = cx.with_ranges(iterators, Body::Equations(body), scope)?;
            for_each(cx, &iterators, scope, &mut |cx| expand_all(cx, body, scope, target))
        }
        ast::EquationKind::When { branches } => {
            if target.initial {
                cx.error("MO0231", e.span, "`when` cannot stand in an initial section");
                return None;
            }
            let branches = cx.in_when(|cx| super::when::branches(cx, branches, scope))?;
            target.push(EquationKind::When(branches), e.span);
            Some(())
        }
        ast::EquationKind::Connect(a, b) => {
            if !cx.evaluation.path.is_empty() {
                cx.problems.push(
                    Diagnostic::error(
                        "MO0231",
                        e.span,
                        "`connect` under a condition that changes while the model runs",
                    )
                    .help("decide it by parameters, or switch by equations")
                    .note("section 9.1 of the specification"),
                );
                return None;
            }
            target.connections.connect(cx, a, b, e.span, scope, &target.component)
        }
        ast::EquationKind::Call(call) => call_equation(cx, call, scope, target),
        ast::EquationKind::Broken => None,
    }
}

/// Runs `body` for every combination of iterators, which are visible as names.
pub(super) fn for_each(
    cx: &mut Context<'_>,
    iterators: &[ast::Iterator],
    scope: Scope,
    body: &mut dyn FnMut(&mut Context<'_>),
) -> Option<()> {
    let Some((first, rest)) = iterators.split_first() else {
        body(cx);
        return Some(());
    };
    for value in cx.fold_range(first, scope)? {
        cx.evaluation.locals.push((first.name.name, value));
        let done = for_each(cx, rest, scope, body);
        cx.evaluation.locals.pop();
        done?;
    }
    Some(())
}

fn equal(
    cx: &mut Context<'_>,
    lhs: &Expr,
    rhs: &Expr,
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    if let ExprKind::Tuple(items) = &lhs.kind {
        let Value::Tuple(values) = cx.evaluate_outputs(rhs, scope)? else {
            cx.error("MO0219", rhs.span, "a function with several outputs is needed here");
            return None;
        };
        if items.len() > values.len() {
            let message = format!(
                "{} values are wanted, and the function gives {}",
                items.len(),
                values.len()
            );
            cx.error("MO0219", span, message);
            return None;
        }
        for (item, value) in items.iter().zip(values.iter()) {
            if let Some(item) = item {
                let left = cx.evaluate(item, scope)?;
                equate(cx, &left, value, span, target)?;
            }
        }
        return Some(());
    }
    let (left, right) = (cx.evaluate(lhs, scope), cx.evaluate(rhs, scope));
    equate(cx, &left?, &right?, span, target)
}

fn equate(
    cx: &mut Context<'_>,
    left: &Value,
    right: &Value,
    span: Span,
    target: &mut Target<'_>,
) -> Option<()> {
    match (left, right) {
        (Value::Scalar(a), Value::Scalar(b)) => {
            let (s, t) = (cx.graph.ty(*a), cx.graph.ty(*b));
            let kind = |t| if t == Type::Integer { Type::Real } else { t };
            if kind(s) != kind(t) {
                cx.report_types(span, "equal", s, t);
                return None;
            }
            let discrete = |t: Type| !matches!(t, Type::Real | Type::String);
            // At the start there is nothing between events.
            if discrete(s) && discrete(t) && !target.initial {
                for e in [*a, *b] {
                    if cx.changes_between_events(e) {
                        cx.report_continuous(s, span);
                        return None;
                    }
                }
            }
            let (a, b) = (real_literal(cx, *a, t), real_literal(cx, *b, s));
            target.push(EquationKind::Equal(a, b), span);
            Some(())
        }
        (Value::Array(_), Value::Array(_)) => {
            if left.dims() != right.dims() {
                let message =
                    format!("the two sides have sizes {:?} and {:?}", left.dims(), right.dims());
                cx.error("MO0215", span, message);
                return None;
            }
            for (a, b) in left.elements().iter().zip(right.elements()) {
                equate(cx, a, b, span, target)?;
            }
            Some(())
        }
        (Value::Record(r), Value::Record(s)) => {
            for (name, a) in &r.fields {
                match s.fields.iter().find(|(n, _)| n == name) {
                    Some((_, b)) => equate(cx, a, b, span, target)?,
                    None => {
                        let message = format!("the right side has no field `{name}`");
                        cx.error("MO0212", span, message);
                        return None;
                    }
                }
            }
            Some(())
        }
        _ => {
            let message =
                format!("the two sides have sizes {:?} and {:?}", left.dims(), right.dims());
            cx.error("MO0215", span, message);
            None
        }
    }
}

fn real_literal(cx: &mut Context<'_>, e: ExprId, other: Type) -> ExprId {
    match cx.graph.as_const(e) {
        Some(Const::Integer(i)) if other == Type::Real => cx.graph.real(i as f64),
        _ => e,
    }
}

fn if_equation(
    cx: &mut Context<'_>,
    branches: &[(Expr, Vec<ast::Equation>)],
    otherwise: &[ast::Equation],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    let Some(((condition, body), rest)) = branches.split_first() else {
        expand_all(cx, otherwise, scope, target);
        return Some(());
    };
    let c = cx.evaluate(condition, scope)?;
    let c = cx.truth(&c, condition.span)?;
    // Connections are part of the structure: so is what they depend on.
    let structural = branches.iter().any(|(_, body)| connects(body)) || connects(otherwise);
    match cx.parameter_expression(c, structural) {
        Some(Const::Boolean(true)) => {
            expand_all(cx, body, scope, target);
            return Some(());
        }
        Some(Const::Boolean(false)) => {
            return if_equation(cx, rest, otherwise, span, scope, target);
        }
        _ => {}
    }
    let not_c = cx.graph.not(c);
    let first = collected(target, |t| cx.under(c, |cx| expand_all(cx, body, scope, t)));
    let mut done = None;
    let second = collected(target, |t| {
        done = cx.under(not_c, |cx| if_equation(cx, rest, otherwise, span, scope, t));
    });
    done?;
    // Where the branches relate different unknowns, the condition is part of the structure, as soon
    // as its parameters have values (with `v = 0` for `R = 0`, say).
    if unknowns(cx, &first) != unknowns(cx, &second)
        && let Some(Const::Boolean(chosen)) = cx.parameter_expression(c, true)
    {
        target.list().extend(if chosen { first } else { second });
        return Some(());
    }
    // A parameter that has no value yet decides by its start value, where one of the branches has to be chosen.
    if count(&first) != count(&second) && cx.variability(c) <= ast::Variability::Parameter {
        let known = cx.fold(condition, scope)?;
        let known = cx.truth(&known, condition.span)?;
        if let Some(Const::Boolean(chosen)) = cx.graph.as_const(known) {
            target.list().extend(if chosen { first } else { second });
            return Some(());
        }
    }
    merge(cx, c, first, second, span, target)
}

/// How many equations there are, without assertions.
fn count(list: &[Equation]) -> usize {
    list.iter().filter(|e| matches!(e.kind, EquationKind::Equal(..))).count()
}

/// Whether there is a `connect` among equations.
fn connects(list: &[ast::Equation]) -> bool {
    list.iter().any(|e| match &e.kind {
        ast::EquationKind::Connect(..) => true,
        ast::EquationKind::If { branches, otherwise } => {
            branches.iter().any(|(_, body)| connects(body)) || connects(otherwise)
        }
        ast::EquationKind::For { body, .. } => connects(body),
        _ => false,
    })
}

/// The variables, other than parameters, and the derivatives that equations relate, in order.
fn unknowns(cx: &mut Context<'_>, equations: &[Equation]) -> Vec<(VarId, bool)> {
    let sides = equations.iter().filter_map(|e| match e.kind {
        EquationKind::Equal(a, b) => Some([a, b]),
        _ => None,
    });
    let nodes = cx.graph.postorder(sides.flatten());
    let mut found = Vec::new();
    for n in nodes {
        match cx.graph.node(n) {
            Node::Var(v) if cx.variability(n) > ast::Variability::Parameter => {
                found.push((v, false));
            }
            Node::Der(v) => found.push((v, true)),
            _ => {}
        }
    }
    found.sort_unstable();
    found
}

/// The equations that `act` adds, taken out again.
fn collected(target: &mut Target<'_>, act: impl FnOnce(&mut Target<'_>)) -> Vec<Equation> {
    let before = target.list().len();
    act(target);
    target.list().split_off(before)
}

/// `if c then first else second`, equation by equation (section 8.3.4).
fn merge(
    cx: &mut Context<'_>,
    c: ExprId,
    first: Vec<Equation>,
    second: Vec<Equation>,
    span: Span,
    target: &mut Target<'_>,
) -> Option<()> {
    let not_c = cx.graph.not(c);
    let mut sides = [Vec::new(), Vec::new()];
    for (k, (list, applies)) in [(first, c), (second, not_c)].into_iter().enumerate() {
        for e in list {
            match e.kind {
                EquationKind::Equal(a, b) => sides[k].push((a, b, e.origin)),
                EquationKind::Assert(a) => {
                    let off = cx.graph.not(applies);
                    let condition = cx.graph.or(off, a.condition);
                    let kind = EquationKind::Assert(Assert { condition, ..a });
                    target.push(kind, e.origin.span);
                }
                EquationKind::When(_) | EquationKind::Algorithm { .. } => {
                    cx.error(
                        "MO0231",
                        e.origin.span,
                        "`when` under a condition that only a run knows; put the condition inside",
                    );
                    return None;
                }
            }
        }
    }
    let [first, second] = sides;
    if first.len() != second.len() {
        cx.problems.push(
            Diagnostic::error(
                "MO0232",
                span,
                format!(
                    "the branches have {} and {} equations, and their condition changes while the model runs",
                    first.len(),
                    second.len()
                ),
            )
            .help("give each branch, `else` included, the same number of equations (section 8.3.4)"),
        );
        return None;
    }
    for ((a, b, origin), (a2, b2, _)) in first.into_iter().zip(second) {
        let kind = if a == a2 {
            EquationKind::Equal(a, cx.graph.if_then_else(c, b, b2))
        } else if cx.graph.ty(a) == Type::Real || cx.graph.ty(b) == Type::Real {
            let (r, r2) = (cx.graph.sub(a, b), cx.graph.sub(a2, b2));
            let zero = cx.graph.real(0.0);
            EquationKind::Equal(zero, cx.graph.if_then_else(c, r, r2))
        } else {
            cx.error(
                "MO0231",
                origin.span,
                "branches must define the same discrete variable in the same order",
            );
            return None;
        };
        target.push(kind, origin.span);
    }
    Some(())
}

fn call_equation(
    cx: &mut Context<'_>,
    call: &Expr,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    let ExprKind::Call { function, args, named } = &call.kind else {
        cx.error("MO0231", call.span, "this is no equation");
        return None;
    };
    let simple = function.simple();
    match simple.as_ref().map(|n| n.as_str()) {
        Some("assert") => {
            let assert = assertion(cx, args, named, call.span, scope)?;
            if cx.graph.as_const(assert.condition) == Some(Const::Boolean(true)) {
                return Some(());
            }
            if let Some(Const::Boolean(false)) = cx.structural_value(assert.condition)
                && assert.level == Level::Error
            {
                let text = match cx.graph.as_const(assert.message) {
                    Some(Const::String(s)) => s.to_string(),
                    _ => "assertion failed".into(),
                };
                cx.problems.push(
                    Diagnostic::error("MO0233", call.span, format!("assertion failed: {text}"))
                        .label("false for these parameters"),
                );
                return None;
            }
            target.push(EquationKind::Assert(assert), call.span);
            Some(())
        }
        Some("reinit" | "terminate") => {
            let name = function.parts[0].name.name;
            cx.problems.push(
                Diagnostic::error("MO0231", call.span, format!("`{name}` stands outside `when`"))
                    .help("put it into a when-clause that says when it acts"),
            );
            None
        }
        _ if function.parts[0].name.name == "Connections" => {
            cx.unsupported(call.span, "over-constrained connection graphs");
            None
        }
        _ => cx.evaluate_outputs(call, scope).map(|_| ()),
    }
}

/// `assert(condition, message, level)`
pub(super) fn assertion(
    cx: &mut Context<'_>,
    args: &[Expr],
    named: &[(ast::Ident, Expr)],
    span: Span,
    scope: Scope,
) -> Option<Assert> {
    let find = |k: usize, name: &str| argument(args, named, k, name);
    let (Some(condition), Some(message)) = (find(0, "condition"), find(1, "message")) else {
        cx.error("MO0219", span, "`assert` takes a condition and a message");
        return None;
    };
    let c = cx.evaluate(condition, scope)?;
    let c = cx.truth(&c, condition.span)?;
    if cx.graph.as_const(c) == Some(Const::Boolean(true)) {
        // What would never be said is not even read.
        let nothing = cx.graph.string("");
        return Some(Assert { condition: c, message: nothing, level: Level::Error });
    }
    let violated = cx.graph.not(c);
    let text = cx.under(violated, |cx| cx.evaluate_scalar(message, scope))?;
    if cx.graph.ty(text) != Type::String {
        cx.error("MO0212", message.span, "the message must be a String");
        return None;
    }
    let level = match find(2, "level") {
        Some(level) => {
            let value = cx.fold(level, scope)?.scalar()?;
            level_of(cx.graph.as_const(value))
        }
        None => Level::Error,
    };
    Some(Assert { condition: c, message: text, level })
}

/// An algorithm section of a model: statements are run on symbols; when-statements become
/// when-clauses of their own.
fn algorithm(
    cx: &mut Context<'_>,
    list: &[ast::Statement],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) {
    cx.evaluation.lost_unit = false;
    cx.evaluation.assigned.clear();
    let plain: Vec<ast::Statement> =
        list.iter().filter(|s| !matches!(s.kind, StatementKind::When { .. })).cloned().collect();
    let mut outputs = Vec::new();
    let asserted_before = cx.evaluation.asserts.len();
    let started = start_values(cx, &plain, scope, target, &mut outputs);
    // The subscripts that were read are read once more where the statements are run.
    cx.evaluation.asserts.truncate(asserted_before);
    if started.is_some() && cx.run_statements(&plain, scope).is_some() && !outputs.is_empty() {
        let values = outputs.iter().map(|v| cx.evaluation.assigned[v]).collect();
        target.push(EquationKind::Algorithm { outputs, values }, span);
    }
    cx.evaluation.assigned.clear();
    asserted(cx, target);
    let mut whens = Vec::new();
    for s in list {
        if let StatementKind::When { branches } = &s.kind
            && let Some(branches) =
                cx.in_when(|cx| super::when::statement_branches(cx, branches, scope))
        {
            target.flat.lost_units.extend(cx.evaluation.lost_unit.then_some(s.span));
            whens.push((branches, s.span));
        }
    }
    for (branches, span) in super::when::last_wins(whens) {
        target.push(EquationKind::When(branches), span);
    }
    target.flat.lost_units.extend(cx.evaluation.lost_unit.then_some(span));
    cx.evaluation.lost_unit = false;
}

/// What assigned variables hold before the section: discrete ones their `pre` value, others their
/// start value (section 11.1.2).
fn start_values(
    cx: &mut Context<'_>,
    list: &[ast::Statement],
    scope: Scope,
    target: &Target<'_>,
    outputs: &mut Vec<VarId>,
) -> Option<()> {
    for s in list {
        match &s.kind {
            StatementKind::Assign(to, _) => start_value(cx, to, scope, target, outputs)?,
            StatementKind::AssignTuple(all, _) => {
                for to in all.iter().flatten() {
                    start_value(cx, to, scope, target, outputs)?;
                }
            }
            StatementKind::If { branches, otherwise } => {
                for (_, body) in branches {
                    start_values(cx, body, scope, target, outputs)?;
                }
                start_values(cx, otherwise, scope, target, outputs)?;
            }
            StatementKind::For { iterators, body } => {
                let iterators = cx.with_ranges(iterators, Body::Statements(body), scope)?;
                start_values_of_loop(cx, &iterators, body, scope, target, outputs)?;
            }
            StatementKind::While { body, .. } => start_values(cx, body, scope, target, outputs)?,
            _ => {}
        }
    }
    Some(())
}

fn start_values_of_loop(
    cx: &mut Context<'_>,
    iterators: &[ast::Iterator],
    body: &[ast::Statement],
    scope: Scope,
    target: &Target<'_>,
    outputs: &mut Vec<VarId>,
) -> Option<()> {
    let Some((first, rest)) = iterators.split_first() else {
        return start_values(cx, body, scope, target, outputs);
    };
    let values = match cx.unknown_turn(first, scope)? {
        Some(value) => vec![value],
        None => cx.values_of(first, scope)?,
    };
    for value in values {
        cx.evaluation.locals.push((first.name.name, value));
        let done = start_values_of_loop(cx, rest, body, scope, target, outputs);
        cx.evaluation.locals.pop();
        done?;
    }
    Some(())
}

fn start_value(
    cx: &mut Context<'_>,
    to: &ast::ComponentRef,
    scope: Scope,
    target: &Target<'_>,
    outputs: &mut Vec<VarId>,
) -> Option<()> {
    let selection = cx.select_target(to, scope)?;
    for v in cx.selected_variables(&selection, to.span)? {
        if cx.evaluation.assigned.contains_key(&v) {
            continue;
        }
        let variable = &target.flat.variables[v];
        let value = if variable.variability == ast::Variability::Continuous {
            match variable.start {
                Some(start) => start,
                None => cx.graph.real(0.0),
            }
        } else {
            cx.graph.intern(Node::Pre(v), variable.ty)
        };
        cx.evaluation.assigned.insert(v, value);
        outputs.push(v);
    }
    Some(())
}
