//! Sizes that depend on each other: `A[:, size(A, 1)]` reads a dimension of the component whose
//! sizes are being found.

use super::Evaluator;
use super::function::Components;
use super::implicit_ranges::in_values;
use super::mode::Mode;
use crate::base::name::Name;
use crate::ir::ast::{Causality, ClassKind, Expr, ExprKind, Subscript};
use crate::ir::expr::Type;
use crate::ir::instance::{ClassId, Declaration, InstanceId, Scope};

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
    /// The mode for the arguments of a call. Where only sizes are wanted, real numbers count as zero, unless sizes of
    /// the outputs depend on their values, as in `output Real y[integer(max(x))]`.
    pub(super) fn mode_of_arguments(&mut self, class: ClassId) -> Mode {
        if self.mode.sizes && self.sizes_depend_on_reals(class) {
            return self.mode.of_parameter(None);
        }
        self.mode
    }

    fn sizes_depend_on_reals(&mut self, class: ClassId) -> bool {
        if !matches!(self.kind(class), ClassKind::Function { .. }) {
            return false;
        }
        let components = self.components(class);
        let mut read = Vec::new();
        for (entry, declaration) in &components {
            if self.causality(entry, declaration) == Some(Causality::Output) {
                read_by_dimensions(declaration, &mut read);
            }
        }
        self.reaches_real_input(&components, read)
    }

    /// Whether variables of a function are real inputs, or are computed from some where they are declared.
    fn reaches_real_input(&mut self, components: &Components, mut open: Vec<Name>) -> bool {
        let mut met: Vec<Name> = Vec::new();
        while let Some(name) = open.pop() {
            let found = components.iter().find(|(entry, _)| entry.name.name == name);
            let Some((entry, declaration)) = found.filter(|_| !met.contains(&name)) else {
                continue;
            };
            met.push(name);
            if self.causality(entry, declaration) != Some(Causality::Input) {
                if let Some((binding, _)) = self.declared_value(entry, declaration) {
                    in_values(&binding, &mut |r| open.push(r.parts[0].name.name));
                }
                continue;
            }
            let scope = self.declaration_scope(entry);
            let class = self.find_class(&declaration.clause().type_name, scope);
            if class.is_some_and(|class| self.table(class).scalar == Some(Type::Real)) {
                return true;
            }
        }
        false
    }
}

/// The names whose values decide the sizes of a declaration.
fn read_by_dimensions(declaration: &Declaration, read: &mut Vec<Name>) {
    for s in declaration.component().dims.iter().chain(&declaration.clause().type_dims) {
        if let Subscript::Expr(e) = s {
            in_values(e, &mut |r| read.push(r.parts[0].name.name));
        }
    }
}
