//! Fields of records that are bound to other records: `parameter R a = b.r` gives `a.x` the value of
//! `b.r.x`, without the other fields of `b.r`, which may in turn depend on `a`.

use super::Evaluator;
use super::demand::Demand as _;
use crate::base::name::Name;
use crate::ir::ast::ExprKind;
use crate::ir::instance::{InstanceId, InstanceKind};

impl Evaluator<'_> {
    /// The component that field `name` of a record refers to, if values are asked for before simulation
    /// and the binding of the record, or of one around it, is the name of another record.
    pub(super) fn field_referred_to(
        &mut self,
        record: InstanceId,
        name: Name,
    ) -> Option<InstanceId> {
        if !self.mode.fold || self.mode.sizes || self.frames.in_function() {
            return None;
        }
        let other = self.record_referred_to(record)?;
        self.child(other, name).map(|field| self.outer_of(field))
    }

    fn record_referred_to(&mut self, record: InstanceId) -> Option<InstanceId> {
        let Some(binding) = self.binding(record).filter(|_| !self.is_overridden(record)) else {
            let parent = self.instances[record].parent?;
            let is_field = matches!(self.instances[parent].kind, InstanceKind::Object(_));
            if !is_field || !self.bound(parent) {
                return None;
            }
            let field = self.field_referred_to(parent, self.instances[record].name)?;
            return self.as_record(field);
        };
        let ExprKind::Ref(r) = &binding.value.kind else { return None };
        let is_plain = !r.global && r.parts.iter().all(|part| part.subscripts.is_empty());
        if !is_plain || !binding.subscripts.is_empty() || binding.setting {
            return None;
        }
        let (first, rest) = r.parts.split_first()?;
        let mut at = self.visible(binding.scope, first.name.name)?;
        for part in rest {
            let holder = self.as_record(at)?;
            at = self.child(holder, part.name.name)?;
        }
        self.as_record(at)
    }

    /// The instance, or that which it stands for, if it is one of several components.
    fn as_record(&mut self, id: InstanceId) -> Option<InstanceId> {
        let id = self.outer_of(id);
        self.complete(id);
        matches!(self.instances[id].kind, InstanceKind::Object(_)).then_some(id)
    }
}
