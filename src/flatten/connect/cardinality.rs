//! How many connections each connector is in, for `cardinality` (Modelica specification, section
//! 3.7.2.3).
//!
//! Counted before any equation is written, and only if a text that was read uses the operator.

use crate::base::index::FastMap;
use crate::instantiate::Context;
use crate::ir::instance::{InstanceId, InstanceKind, Scope, SectionKind};

use super::expandable::connection_ends::At;
use super::expandable::{Written, collect, pairs};

/// Counts the connections below `root`.
pub(crate) fn count(cx: &mut Context<'_>, root: InstanceId) {
    if !cx.sources.contents().any(|text| text.contains("cardinality(")) {
        return;
    }
    let mut written: Vec<Written> = Vec::new();
    for object in crate::flatten::objects(cx, root) {
        let table = cx.table_of(object);
        for section in table.sections.iter().filter(|s| !s.initial) {
            if let SectionKind::Equations(list) = &section.kind {
                collect(cx, list, Scope { instance: object, class: section.class }, &mut written);
            }
        }
    }
    let mut counts: FastMap<InstanceId, usize> = FastMap::default();
    for connect in &written {
        for (a, b) in pairs(cx, connect) {
            // A connection to a component that is switched off is none.
            if let (At::Instance(a), At::Instance(b)) = (a.at, b.at) {
                raise(cx, a, &mut counts);
                raise(cx, b, &mut counts);
            }
        }
    }
    cx.evaluation.cardinality = Some(counts);
}

fn raise(cx: &Context<'_>, id: InstanceId, counts: &mut FastMap<InstanceId, usize>) {
    match &cx.instances[id].kind {
        InstanceKind::Array { elements, .. } => {
            elements.iter().for_each(|e| raise(cx, *e, counts));
        }
        _ => *counts.entry(id).or_default() += 1,
    }
}
