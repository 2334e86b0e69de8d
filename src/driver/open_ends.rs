//! Connectors and components that nobody has connected, as the likely reason for a structurally singular model.

use crate::base::diag::Problems;
use crate::flatten::connect::cause::ConnectCause;
use crate::structure::error::StructureCause;

/// Most of them that are named.
const MOST_NAMED: usize = 4;

/// Notes in errors about the numbers of equations and unknowns which of the connectors and components with these unknowns
/// are not connected.
pub fn note(problems: &mut Problems) {
    let mut open: Vec<String> = Vec::new();
    for problem in problems.iter() {
        problem.is(|cause: &ConnectCause| {
            match cause {
                ConnectCause::OpenEnd { connector: name, .. }
                | ConnectCause::IsolatedComponent { path: name } => open.push(name.clone()),
                _ => {}
            }
            true
        });
    }
    if !open.is_empty() {
        problems.add_note(|cause: &StructureCause| text(cause, &open));
    }
}

/// The note for an error, if it is about such unknowns.
fn text(cause: &StructureCause, open: &[String]) -> Option<String> {
    let (StructureCause::TooFewEquations { names, .. }
    | StructureCause::TooManyEquations { names, .. }) = cause
    else {
        return None;
    };
    let has_unknown = |open: &&String| names.contains(&format!("`{open}."));
    let mut found: Vec<String> =
        open.iter().filter(has_unknown).map(|name| format!("`{name}`")).collect();
    let others = found.len().saturating_sub(MOST_NAMED);
    found.truncate(MOST_NAMED);
    Some(match found.as_slice() {
        [] => return None,
        [one] => format!("{one} is not connected"),
        all if others > 0 => format!("{} and {others} others are not connected", all.join(", ")),
        [first @ .., last] => format!("{} and {last} are not connected", first.join(", ")),
    })
}
