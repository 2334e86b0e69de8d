//! The roles of components in the animation of moving parts, as libraries declare them.
//!
//! A package declares them in its annotation `__mocc(view = "...")`: entries `role = names`, separated by
//! `;`. Without declared roles there is no animation, so the page depends on no name of any library.
//!
//! | role | names |
//! |---|---|
//! | `body.position` | position of the moving body |
//! | `body.stops` | its lower and upper stop, two parameters |
//! | `spring.stiffness` | the parameter of a spring |
//! | `piston.area` | the parameter of a piston |
//! | `piston.pressure` | its pressure, the first variable that exists |
//! | `piston.direction` | the parameter that is -1 for a piston on the right |
//! | `port.pressure` | pressure in a fluid connector |
//! | `seal.contact` | the parameter of a seal whose literal says where it touches |
//! | `seal.never` `seal.always` `seal.below` `seal.above` | its literals: never, everywhere, below or above the control edge |
//! | `seal.edge` | the parameter with the stroke at its control edge |
//! | `seal.closed` `seal.opening` `seal.flow` | variables: whether it touches, the open share of its flow path, its flow |

use crate::base::index::FastMap;

/// All roles.
const ROLES: [&str; 16] = [
    "body.position",
    "body.stops",
    "spring.stiffness",
    "piston.area",
    "piston.pressure",
    "piston.direction",
    "port.pressure",
    "seal.contact",
    "seal.never",
    "seal.always",
    "seal.below",
    "seal.above",
    "seal.edge",
    "seal.closed",
    "seal.opening",
    "seal.flow",
];

/// The part of the stroke over which a seal touches the housing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Contact {
    /// Nowhere.
    Never,
    /// Over the whole stroke.
    Always,
    /// Below the control edge.
    Below,
    /// Above the control edge.
    Above,
}

impl Contact {
    /// All of them, with the roles of their literals.
    const ALL: [(Contact, &'static str); 4] = [
        (Contact::Never, "seal.never"),
        (Contact::Always, "seal.always"),
        (Contact::Below, "seal.below"),
        (Contact::Above, "seal.above"),
    ];

    /// Its name in the page.
    pub fn name(self) -> &'static str {
        match self {
            Contact::Never => "never",
            Contact::Always => "always",
            Contact::Below => "below",
            Contact::Above => "above",
        }
    }
}

/// The names that play the roles.
#[derive(Clone, Debug, Default)]
pub struct View {
    roles: FastMap<String, Vec<String>>,
}

impl View {
    /// Adds the roles of an annotation; the error says what is wrong with it.
    pub fn add(&mut self, text: &str) -> Result<(), String> {
        for entry in text.split(';').map(str::trim).filter(|e| !e.is_empty()) {
            let (role, names) =
                entry.split_once('=').ok_or_else(|| format!("the entry `{entry}` has no `=`"))?;
            let role = role.trim();
            if !ROLES.contains(&role) {
                return Err(format!("unknown role `{role}`"));
            }
            let names = names.split([',', '|']).map(|n| n.trim().to_owned()).collect();
            self.roles.insert(role.to_owned(), names);
        }
        Ok(())
    }

    /// The names of a role; none if it is not declared.
    pub fn names(&self, role: &str) -> &[String] {
        self.roles.get(role).map_or(&[], Vec::as_slice)
    }

    /// The first name of a role.
    pub fn name(&self, role: &str) -> Option<&str> {
        self.names(role).first().map(String::as_str)
    }

    /// The contact that a literal means.
    pub fn contact(&self, literal: &str) -> Option<Contact> {
        let found = Contact::ALL.iter().find(|(_, role)| self.name(role) == Some(literal));
        found.map(|(contact, _)| *contact)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_read() {
        let mut view = View::default();
        view.add("seal.below = CloseToOpen; body.stops = s_min, s_max").unwrap();
        view.add("piston.pressure = p|port.p;").unwrap();
        assert_eq!(view.names("body.stops"), ["s_min", "s_max"]);
        assert_eq!(view.name("piston.pressure"), Some("p"));
        assert_eq!(view.contact("CloseToOpen"), Some(Contact::Below));
        assert_eq!(view.contact("Free"), None);
        assert_eq!(view.add("seal.shape = round"), Err("unknown role `seal.shape`".to_owned()));
        assert_eq!(view.add("seal.edge"), Err("the entry `seal.edge` has no `=`".to_owned()));
    }
}
