//! Modifications on their way to the modified component: a layer is a position in a modification
//! together with the scope in which its expressions are read. Nothing is copied or merged; the list
//! of layers is searched from the outermost inwards (section 7.2 of the specification).

use std::rc::Rc;
use std::sync::Arc;

use super::ast::{ArgumentKind, Element, ElementKind, Expr, Modification};
use super::instance::Scope;
use crate::base::name::Name;
use crate::base::source::Span;

/// One modification that applies to a component.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its position.
    pub source: LayerSource,
    /// Where its names are looked up.
    pub scope: Scope,
    /// Subscripts to apply to a binding, collected from the arrays between the modification and the component.
    pub subscripts: Rc<[usize]>,
}

/// A place in a modification.
#[derive(Clone, Debug)]
pub enum LayerSource {
    /// A modification as a whole, such as that of a declaration.
    Whole(Arc<Modification>),
    /// Argument `.1` of a modification, of whose dotted name the first `.2 + 1` parts are matched.
    Argument(Arc<Modification>, usize, usize),
    /// A parameter override, of whose name the first `.1` parts are matched.
    ParameterOverride(Rc<ParameterOverride>, usize),
}

/// `NAME=VALUE` from the command line or a program.
#[derive(Debug)]
pub struct ParameterOverride {
    /// The dotted name with subscripts.
    pub parts: Vec<(Name, Vec<usize>)>,
    /// Its value.
    pub value: Arc<Expr>,
    /// The name as written.
    pub text: String,
    /// Whether a component of this name was found.
    pub used: std::cell::Cell<bool>,
}

impl ParameterOverride {
    /// The number of subscripts in the name.
    pub fn subscript_count(&self) -> usize {
        self.parts.iter().map(|(_, subscripts)| subscripts.len()).sum()
    }
}

/// A binding with its scope.
#[derive(Clone, Debug)]
pub struct Binding {
    /// The expression.
    pub value: Arc<Expr>,
    /// Where its names are looked up.
    pub scope: Scope,
    /// To be applied to the value, unless it has fewer dimensions.
    pub subscripts: Rc<[usize]>,
    /// `final`.
    pub is_final: bool,
    /// From the command line.
    pub setting: bool,
}

impl Layer {
    /// The layers that this one holds for the component or attribute `name`.
    pub fn child(&self, name: Name, out: &mut Vec<Layer>) {
        match &self.source {
            LayerSource::Whole(m) => self.arguments(m, name, out),
            LayerSource::Argument(m, k, depth) => {
                let ArgumentKind::Element { path, modification, .. } = &m.args[*k].kind else {
                    return;
                };
                if let Some(part) = path.parts.get(depth + 1) {
                    if part.name == name {
                        let each = m.args[*k].each && path.parts.len() == depth + 2;
                        out.push(self.at(LayerSource::Argument(m.clone(), *k, depth + 1), each));
                    }
                } else if let Some(inner) = modification {
                    self.arguments(inner, name, out);
                }
            }
            LayerSource::ParameterOverride(s, depth) => {
                if s.parts.get(*depth).is_some_and(|(part, _)| *part == name) {
                    out.push(self.at(LayerSource::ParameterOverride(s.clone(), depth + 1), false));
                }
            }
        }
    }

    fn arguments(&self, m: &Arc<Modification>, name: Name, out: &mut Vec<Layer>) {
        for (k, arg) in m.args.iter().enumerate() {
            if let ArgumentKind::Element { path, .. } = &arg.kind
                && path.parts.first().is_some_and(|p| p.name == name)
            {
                // Of `each a.b`, only `b` is the same in all (section 7.2.4).
                let each = arg.each && path.parts.len() == 1;
                out.push(self.at(LayerSource::Argument(m.clone(), k, 0), each));
            }
        }
    }

    fn at(&self, source: LayerSource, each: bool) -> Layer {
        let subscripts = if each { Rc::from([]) } else { self.subscripts.clone() };
        Layer { source, scope: self.scope, subscripts }
    }

    /// The layer for one element of an array of components.
    pub fn element(&self, subscripts: &[usize]) -> Option<Layer> {
        if let LayerSource::ParameterOverride(s, depth) = &self.source
            && let Some((_, wanted)) = depth.checked_sub(1).and_then(|d| s.parts.get(d))
            && !wanted.is_empty()
        {
            return (wanted == subscripts).then(|| self.clone());
        }
        let all: Vec<usize> = self.subscripts.iter().chain(subscripts).copied().collect();
        Some(Layer { source: self.source.clone(), scope: self.scope, subscripts: all.into() })
    }

    /// The binding that this layer gives to the component itself.
    pub fn binding(&self) -> Option<Binding> {
        let make = |value: &Arc<Expr>, is_final, setting| Binding {
            value: value.clone(),
            scope: self.scope,
            subscripts: self.subscripts.clone(),
            is_final,
            setting,
        };
        match &self.source {
            LayerSource::Whole(m) => m.binding.as_ref().map(|e| make(e, false, false)),
            LayerSource::Argument(m, k, depth) => match &m.args[*k].kind {
                ArgumentKind::Element { path, modification: Some(inner), .. }
                    if path.parts.len() == depth + 1 =>
                {
                    inner.binding.as_ref().map(|e| make(e, m.args[*k].is_final, false))
                }
                _ => None,
            },
            LayerSource::ParameterOverride(s, depth) => {
                (s.parts.len() == *depth).then(|| make(&s.value, false, true))
            }
        }
    }

    /// The subscripts of an override that ends here, as of `a[2]=5`; `None` for one without, and for other layers.
    pub fn part(&self) -> Option<&[usize]> {
        let LayerSource::ParameterOverride(s, depth) = &self.source else { return None };
        let ends = s.parts.len() == *depth;
        let (_, subscripts) = s.parts.get(depth.checked_sub(1)?)?;
        Some(subscripts.as_slice()).filter(|list| ends && !list.is_empty())
    }

    /// The subscripts of the component whose attribute an override sets, as of `a[2].start=5`; `None` for other layers.
    pub fn part_of_holder(&self) -> Option<&[usize]> {
        let LayerSource::ParameterOverride(s, depth) = &self.source else { return None };
        let (_, subscripts) = s.parts.get(depth.checked_sub(2)?)?;
        Some(subscripts.as_slice()).filter(|list| s.parts.len() == *depth && !list.is_empty())
    }

    /// The modification whose arguments this layer holds for the component, if any.
    pub fn inner(&self) -> Option<&Arc<Modification>> {
        match &self.source {
            LayerSource::Whole(m) => Some(m),
            LayerSource::Argument(m, k, depth) => match &m.args[*k].kind {
                ArgumentKind::Element { path, modification, .. }
                    if path.parts.len() == depth + 1 =>
                {
                    modification.as_ref()
                }
                _ => None,
            },
            LayerSource::ParameterOverride(..) => None,
        }
    }

    /// Redeclarations in this layer of elements of the component.
    pub fn redeclarations(&self) -> impl Iterator<Item = (&Arc<Element>, Span)> {
        self.inner().into_iter().flat_map(|m| &m.args).filter_map(|arg| match &arg.kind {
            ArgumentKind::Redeclare(element) => Some((element, arg.span)),
            ArgumentKind::Element { .. } | ArgumentKind::Removal(_) => None,
        })
    }

    /// Redeclarations in this layer of the component `name`: the element, its position in the list of
    /// components, and the subscripts to apply to bindings in it, of which `each` leaves none.
    pub fn component_redeclarations(
        &self,
        name: Name,
    ) -> impl Iterator<Item = (&Arc<Element>, usize, Rc<[usize]>)> {
        self.inner().into_iter().flat_map(|m| &m.args).filter_map(move |arg| {
            let ArgumentKind::Redeclare(element) = &arg.kind else { return None };
            let ElementKind::Components(clause) = &element.kind else { return None };
            let at = clause.components.iter().position(|c| c.name.name == name)?;
            let subscripts = if arg.each { Rc::from([]) } else { self.subscripts.clone() };
            Some((element, at, subscripts))
        })
    }

    /// Whether this layer gives the component itself a binding.
    pub fn binds(&self) -> bool {
        match &self.source {
            LayerSource::ParameterOverride(s, depth) => s.parts.len() == *depth,
            _ => self.inner().is_some_and(|m| m.binding.is_some()),
        }
    }

    /// Names of elements that this layer modifies, with their places; those of settings have none.
    pub fn modified_names(&self) -> impl Iterator<Item = (Name, Span)> {
        let dotted = match &self.source {
            LayerSource::Argument(m, k, depth) => match &m.args[*k].kind {
                ArgumentKind::Element { path, .. } => path.parts.get(depth + 1),
                _ => None,
            },
            _ => None,
        };
        let names = self.inner().into_iter().flat_map(|m| m.names());
        dotted.into_iter().chain(names).map(|part| (part.name, part.span))
    }
}
