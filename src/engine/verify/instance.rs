//! The contract of the instance tree.

use crate::base::index::{Id, IndexVec};
use crate::ir::instance::{Instance, InstanceId, InstanceKind};

/// Everything in which a tree of instances breaks its contract.
pub fn check(instances: &IndexVec<InstanceId, Instance>) -> Vec<String> {
    let mut found = Vec::new();
    let exists = |id: &InstanceId| id.idx() < instances.len();
    for (id, instance) in instances.enumerate() {
        let mut report =
            |what: &str| found.push(format!("instance {} (`{}`) {what}", id.0, instance.name));
        if instance.parent.is_some_and(|parent| parent >= id) {
            report("precedes its parent");
        }
        if instance.scope.instance.idx() >= instances.len() {
            report("reads names in an instance that does not exist");
        }
        match &instance.kind {
            InstanceKind::Pending | InstanceKind::Absent | InstanceKind::Broken => {}
            InstanceKind::InProgress => report("was left in progress"),
            InstanceKind::Outer(inner) => {
                if !exists(inner) || matches!(instances[*inner].kind, InstanceKind::Outer(_)) {
                    report("is outer, without an inner");
                }
            }
            InstanceKind::Variable { dims, .. } => {
                if dims.iter().try_fold(1_usize, |n, d| n.checked_mul(*d)).is_none() {
                    report("has more elements than can be counted");
                }
            }
            InstanceKind::Object(children) => {
                if !children
                    .iter()
                    .all(|child| exists(child) && instances[*child].parent == Some(id))
                {
                    report("holds a component of another");
                }
            }
            InstanceKind::Array { dims, elements } => {
                if elements.len() != dims.iter().product::<usize>() {
                    report("has more or fewer elements than its sizes ask for");
                }
                if !elements.iter().all(exists) {
                    report("has an element that does not exist");
                }
            }
        }
    }
    found
}
