//! Parameter overrides: `NAME=VALUE` on the command line as a modification of the model.

use std::rc::Rc;
use std::sync::Arc;

use super::cause::{OverrideCause, WrongOverride};
use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::name::{dotted_parts, name, split_unquoted};
use crate::base::source::{SETTING, SourceMap, Span};
use crate::evaluate::Evaluator;
use crate::ir::ast::{Expr, Variability};
use crate::ir::instance::{InstanceId, InstanceKind};
use crate::ir::modification::ParameterOverride;
use crate::parse::fragment::binding;

/// Parses `NAME=VALUE`; the value is a Modelica expression.
pub fn read(
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Rc<ParameterOverride>> {
    let malformed = |problems: &mut Problems, why| {
        let cause = OverrideCause::Malformed { text: text.to_string(), why };
        problems.push(Diagnostic::new(cause, Span::NONE));
    };
    let Some((left, right)) = split_unquoted(text, '=') else {
        malformed(problems, WrongOverride::NoValue);
        return None;
    };
    let Some(parts) =
        dotted_parts(left.trim()).into_iter().map(name_part).collect::<Option<Vec<_>>>()
    else {
        malformed(problems, WrongOverride::NoName);
        return None;
    };
    let value = expression(right, text, sources, problems)?;
    Some(Rc::new(ParameterOverride {
        parts,
        value: Arc::new(value),
        text: left.trim().to_string(),
        used: std::cell::Cell::new(false),
    }))
}

/// `name` or `name[1,2]`
fn name_part(text: &str) -> Option<(crate::base::name::Name, Vec<usize>)> {
    let (word, rest) = split_unquoted(text, '[').unwrap_or((text, "]"));
    let list = rest.strip_suffix(']')?;
    let subscripts = if list.is_empty() {
        Vec::new()
    } else {
        list.split(',').map(|k| k.trim().parse().ok()).collect::<Option<Vec<usize>>>()?
    };
    let word = word.trim();
    let plain = word.chars().all(|c| c.is_alphanumeric() || c == '_') && !word.is_empty();
    let quoted = word.len() > 2 && word.starts_with('\'') && word.ends_with('\'');
    (plain || quoted).then(|| (name(word), subscripts))
}

/// Parses the value of an override.
fn expression(
    value: &str,
    whole: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Expr> {
    let found = binding(SETTING, whole, whole.len() - value.len(), None, sources);
    if found.is_none() {
        let (text, why) = (whole.to_string(), WrongOverride::NoExpression);
        problems.push(Diagnostic::new(OverrideCause::Malformed { text, why }, Span::NONE));
    }
    found
}

/// Reports overrides that no component matches, and overrides of variables that are not parameters.
pub(super) fn report_unused(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    overrides: &[Rc<ParameterOverride>],
) {
    let mut parameters: Option<Vec<(String, bool)>> = None;
    for s in overrides {
        if s.used.get() && is_parameter(cx, root, s) != Some(false) {
            continue;
        }
        let all = parameters.get_or_insert_with(|| scalar_names(cx, root));
        let plain = s.text.replace(' ', "");
        let cause = if all.iter().any(|(n, _)| *n == plain) {
            OverrideCause::OverriddenVariable { name: plain }
        } else {
            let names = all.iter().filter(|(_, p)| *p).map(|(n, _)| n.as_str());
            let last = plain.rsplit('.').next().unwrap_or_default();
            let same_end = all.iter().find(|(n, p)| *p && n.rsplit('.').next() == Some(last));
            let near = did_you_mean(&plain, names).or(same_end.map(|(near, _)| near.as_str()));
            let near = near.map(str::to_string);
            OverrideCause::UnknownParameter { name: plain, near }
        };
        cx.report(cause, Span::NONE);
    }
}

/// Whether the variable with exactly this name is a parameter; `None` if it does not exist.
fn is_parameter(cx: &mut Evaluator<'_>, root: InstanceId, s: &ParameterOverride) -> Option<bool> {
    let mut at = root;
    for (part, subscripts) in &s.parts {
        if !matches!(cx.instances[at].kind, InstanceKind::Object(_)) {
            return None;
        }
        at = cx.child(at, *part)?;
        if let InstanceKind::Array { elements, .. } = &cx.instances[at].kind {
            let mut elements = elements.iter();
            at = *elements.find(|e| *cx.instances[**e].subscripts == **subscripts)?;
        } else if !subscripts.is_empty() {
            return None;
        }
    }
    let instance = &cx.instances[at];
    matches!(instance.kind, InstanceKind::Variable { .. })
        .then_some(instance.prefix.variability == Some(Variability::Parameter))
}

/// The names of all variables, each with a flag that is true for parameters.
fn scalar_names(cx: &Evaluator<'_>, root: InstanceId) -> Vec<(String, bool)> {
    let mut out = Vec::new();
    let mut stack = vec![root];
    while let Some(id) = stack.pop() {
        match &cx.instances[id].kind {
            InstanceKind::Object(children) => stack.extend(children.iter().rev()),
            InstanceKind::Array { elements, .. } => stack.extend(elements.iter().rev()),
            InstanceKind::Variable { .. } => {
                let variability = cx.instances[id].prefix.variability;
                out.push((cx.path(id), variability == Some(Variability::Parameter)));
            }
            _ => {}
        }
    }
    out
}
