//! Tables over time whose start or shift is determined by initialization, such as a period that
//! begins before the simulation does.
//!
//! The table itself stays at time 0; the times at which it is read are moved.

use crate::ir::expr::{Binary, ExprId, Graph, Unary};
use crate::ir::external::ExternalId;

/// The start and the shift of a table over time, s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    /// Before it, the table is 0.
    pub(super) start: ExprId,
    /// The time at which the time of the table is 0.
    pub(super) shift: ExprId,
}

impl Moved {
    /// The value of `f` at time `t`, with the next event at `next`.
    pub(super) fn value(self, g: &mut Graph, f: ExternalId, t: ExprId, next: ExprId) -> ExprId {
        let [early, starts] = [(Binary::Less, t), (Binary::LessEqual, next)]
            .map(|(op, a)| g.binary(op, a, self.start));
        let before = g.binary(Binary::Or, early, starts);
        let before = g.no_event(before);
        let [t, next] = [t, next].map(|time| g.sub(time, self.shift));
        let value = g.binary(Binary::External(f), t, next);
        let zero = g.real(0.0);
        g.if_then_else(before, zero, value)
    }

    /// The time of the first event after `t`, where `f` finds that of the table.
    pub(super) fn next_event(self, g: &mut Graph, f: ExternalId, t: ExprId) -> ExprId {
        let before = g.binary(Binary::Less, t, self.start);
        let before = g.no_event(before);
        let inside = g.sub(t, self.shift);
        let next = g.unary(Unary::External(f), inside);
        let next = g.add(next, self.shift);
        g.if_then_else(before, self.start, next)
    }
}
