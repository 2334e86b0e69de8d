//! Sizes that depend on each other: `A[:, size(A, 1)]` reads a dimension of the component whose
//! sizes are being found.

use super::Evaluator;
use crate::ir::ast::{Expr, ExprKind};
use crate::ir::instance::{InstanceId, Scope};

/// Components whose sizes are being found, innermost last, with those that are known already.
#[derive(Default, Debug)]
pub struct Sizing {
    open: Vec<(InstanceId, Vec<Option<usize>>)>,
}

impl Sizing {
    /// Notes dimension `k`, from 0, of the innermost component.
    pub(crate) fn note(&mut self, k: usize, size: usize) {
        if let Some((_, known)) = self.open.last_mut() {
            known[k] = Some(size);
        }
    }
}

impl Evaluator<'_> {
    /// Finds the sizes of a component with `rank` dimensions.
    pub(crate) fn with_sizing<T>(
        &mut self,
        id: InstanceId,
        rank: usize,
        act: impl FnOnce(&mut Self) -> T,
    ) -> T {
        self.sizing.open.push((id, vec![None; rank]));
        let result = act(self);
        self.sizing.open.pop();
        result
    }

    /// Dimension `k`, from 1, of a component whose sizes are being found, if it is known already.
    pub(super) fn known_size(&mut self, e: &Expr, k: usize, scope: Scope) -> Option<usize> {
        let ExprKind::Ref(r) = &e.kind else { return None };
        let [part] = r.parts.as_slice() else { return None };
        let elsewhere = self.sizing.open.is_empty() || self.frames.in_function();
        if elsewhere || r.global || !part.subscripts.is_empty() {
            return None;
        }
        let id = self.child(scope.instance, part.name.name)?;
        let (_, known) = self.sizing.open.iter().rev().find(|(own, _)| *own == id)?;
        *known.get(k.checked_sub(1)?)?
    }
}
