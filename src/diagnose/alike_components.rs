//! Components of one class whose parameters vary by one law, each with a variable of its own component: the discharge of
//! every vessel of a cascade over its own level, the resistance of every cell of a battery over its own charge.

use crate::base::index::FastSet;
use crate::calibrate::plan::Plan;
use crate::flatten::inventory::{Inventory, InventoryConnector, InventoryPart};
use crate::ir::expr::{Node, Type, VarId};
use crate::ir::flat::{FlatModel, Variability, Variable};

use super::place::{MAX_HOSTS, Place};
use super::variation::{circular, states};

/// Variables of a component that its parameter may vary with.
const MAX_VARIABLES: usize = 3;

/// A parameter that several components of one class have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlikeParameter {
    /// Full names of what the plan frees, component by component.
    parameters: Vec<String>,
    /// For each variable of the class, its full names, component by component.
    variables: Vec<Vec<String>>,
}

impl AlikeParameter {
    /// Every variable with all parameters, each with that of its own component, for an effect whose input is named `input`.
    pub fn places(&self, input: &str) -> Vec<Place> {
        let member = |(parameter, variable): (&String, &String)| Place {
            binds: vec![(input.to_owned(), variable.clone())],
            ..Place::at(std::slice::from_ref(parameter))
        };
        let place = |variables: &Vec<String>| {
            let mut members = self.parameters.iter().zip(variables).map(member);
            let first = members.next()?;
            Some(Place { at: self.parameters.clone(), others: members.collect(), ..first })
        };
        self.variables.iter().filter_map(place).collect()
    }
}

/// The free parameters of a plan that components of one class share by name.
pub fn alike_parameters(
    flat: &FlatModel,
    plan: &Plan,
    inventory: &Inventory,
) -> Vec<AlikeParameter> {
    let mut found: Vec<(&str, &str, Vec<(&InventoryPart, String)>)> = Vec::new();
    for target in plan.free.iter().flat_map(|free| &free.targets) {
        let Some((part, member)) = owner(flat, inventory, target) else { continue };
        let is_alike =
            |(class, own, _): &&mut (&str, &str, _)| *class == part.class && *own == member;
        match found.iter_mut().find(is_alike) {
            Some((.., all)) => all.push((part, target.clone())),
            None => found.push((&part.class, member, vec![(part, target.clone())])),
        }
    }
    let is_several = |(.., all): &(&str, &str, Vec<_>)| (2..=MAX_HOSTS).contains(&all.len());
    let of = |(_, member, all): (&str, &str, Vec<(&InventoryPart, String)>)| {
        let parameters: Vec<String> = all.iter().map(|(_, target)| target.clone()).collect();
        let parts: Vec<&str> = all.iter().map(|(part, _)| part.name.as_str()).collect();
        let potentials: Vec<String> = all.first().map_or(Vec::new(), |(part, _)| potentials(part));
        let variables = variables(flat, &parts, member, &potentials);
        AlikeParameter { parameters, variables }
    };
    found.into_iter().filter(is_several).map(of).collect()
}

/// The component whose parameter a free one is or, alone, determines, and its name there.
fn owner<'a>(
    flat: &'a FlatModel,
    inventory: &'a Inventory,
    target: &str,
) -> Option<(&'a InventoryPart, &'a str)> {
    let of_part = |full: &'a str| {
        let parts = inventory.parts.iter().filter(|part| !part.name.is_empty());
        let mut own = parts.filter_map(|part| {
            let member = full.strip_prefix(&part.name)?.strip_prefix('.')?;
            (!member.contains('.')).then_some((part, member))
        });
        own.next()
    };
    let (id, variable) = flat.variables.enumerate().find(|(_, v)| v.name == target)?;
    if variable.ty != Type::Real || variable.structural {
        return None;
    }
    if let Some(own) = of_part(&variable.name) {
        return Some(own);
    }
    let is_bound = |v: &&Variable| v.binding.is_some_and(|e| flat.graph.node(e) == Node::Var(id));
    let mut bound = flat.variables.iter().filter(is_bound).map(|v| of_part(&v.name));
    match (bound.next(), bound.next()) {
        (Some(only), None) => only,
        _ => None,
    }
}

/// The potentials of the connectors of a component, by their names there.
fn potentials(part: &InventoryPart) -> Vec<String> {
    let of =
        |c: &InventoryConnector| Some(format!("{}.{}", c.name, c.pair.as_ref()?.potential.name));
    part.connectors.iter().filter_map(of).collect()
}

/// The variables that all components have and that no equation determines from their parameter `own` directly; states first,
/// potentials last.
fn variables(
    flat: &FlatModel,
    parts: &[&str],
    own: &str,
    potentials: &[String],
) -> Vec<Vec<String>> {
    let states: FastSet<VarId> = states(flat).into_iter().collect();
    let named = |name: &str| flat.variables.enumerate().find(|(_, v)| v.name == name);
    let varies = |v: &Variable| {
        v.ty == Type::Real && v.variability == Variability::Continuous && !v.protected
    };
    let of_first = flat.variables.enumerate().filter_map(|(id, v)| {
        let member = v.name.strip_prefix(parts[0])?.strip_prefix('.')?;
        (varies(v) && !member.contains(['.', '['])).then_some((!states.contains(&id), member))
    });
    let mut members: Vec<(bool, &str)> = of_first.collect();
    members.sort_by_key(|(is_no_state, _)| *is_no_state);
    let parameters = [parts.iter().map(|part| format!("{part}.{own}")).collect()];
    let of_all = |member: &str| -> Option<Vec<String>> {
        let full: Vec<String> = parts.iter().map(|part| format!("{part}.{member}")).collect();
        let are_there = full.iter().all(|name| named(name).is_some_and(|(_, v)| varies(v)));
        (are_there && circular(flat, &parameters, &full).is_empty()).then_some(full)
    };
    let members = members.into_iter().map(|(_, member)| member);
    let all = members.chain(potentials.iter().map(String::as_str));
    all.filter_map(of_all).take(MAX_VARIABLES).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_component_has_its_own_variable() {
        let text = |all: &[&str]| all.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
        let alike = AlikeParameter {
            parameters: text(&["k1", "k2"]),
            variables: vec![text(&["v1.h", "v2.h"])],
        };
        let places = alike.places("x");
        assert_eq!(places.len(), 1);
        assert_eq!(places[0].at, ["k1", "k2"]);
        let pairs: Vec<(String, String)> = places[0]
            .members()
            .into_iter()
            .map(|p| (p.at[0].clone(), p.binds[0].1.clone()))
            .collect();
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(pairs, [pair("k1", "v1.h"), pair("k2", "v2.h")]);
    }
}
