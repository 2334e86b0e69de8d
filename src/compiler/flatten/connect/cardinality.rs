//! Number of connections of each connector, for `cardinality` (Modelica 3.6, section 3.7.4.3).
//!
//! Counted before equations are expanded, and only if a source file uses the operator.

use crate::base::index::FastMap;
use crate::evaluate::Evaluator;
use crate::ir::instance::{InstanceId, InstanceKind};

use super::expandable::connection_ends::EndTarget;
use super::written::{self, pairs};

/// Counts the connections below `root`.
pub(crate) fn count(cx: &mut Evaluator<'_>, root: InstanceId) {
    if !cx.sources.contents().any(|text| text.contains("cardinality(")) {
        return;
    }
    let written = written::below(cx, root).connects;
    let mut counts: FastMap<InstanceId, usize> = FastMap::default();
    for connect in &written {
        for (a, b) in pairs(cx, connect) {
            // Connections to disabled conditional components do not count.
            if let (EndTarget::Instance(a), EndTarget::Instance(b)) = (a.at, b.at) {
                increment(cx, a, &mut counts);
                increment(cx, b, &mut counts);
            }
        }
    }
    cx.builtins.cardinality = Some(counts);
}

fn increment(cx: &Evaluator<'_>, id: InstanceId, counts: &mut FastMap<InstanceId, usize>) {
    match &cx.instances[id].kind {
        InstanceKind::Array { elements, .. } => {
            elements.iter().for_each(|e| increment(cx, *e, counts));
        }
        _ => *counts.entry(id).or_default() += 1,
    }
}
