//! The external functions of a model: tables, random numbers, operators on strings.
//!
//! *Holds:* each function once, with its id; expressions and instructions refer to it by the id.
//! *Never holds:* anything that changes during simulation.
//! *Made by:* `evaluate`, from external objects and functions; `symbolic`, which adds derivatives.
//! *Read by:* `symbolic::eval` and `runtime`, which call the functions.

use std::sync::Arc;

use crate::base::index::Id;
use crate::external::External;

crate::define_id!(
    /// An external function of a model. Equal functions have equal ids.
    pub struct ExternalId
);

/// The external functions of a model or program.
#[derive(Clone, Default, Debug)]
pub struct Externals {
    functions: Vec<Arc<dyn External>>,
}

impl Externals {
    /// No functions.
    pub const EMPTY: Externals = Externals { functions: Vec::new() };

    /// The id of a function, which is added unless an equal one exists.
    pub fn add(&mut self, function: Arc<dyn External>) -> ExternalId {
        let known = self.functions.iter().position(|f| f.is_same(&*function));
        let at = known.unwrap_or_else(|| {
            self.functions.push(function);
            self.functions.len() - 1
        });
        ExternalId::from_usize(at)
    }

    /// All functions, in the order of their ids.
    pub fn all(&self) -> &[Arc<dyn External>] {
        &self.functions
    }

    /// The function with this id.
    pub fn get(&self, id: ExternalId) -> &Arc<dyn External> {
        &self.functions[id.idx()]
    }
}

impl PartialEq for Externals {
    fn eq(&self, other: &Self) -> bool {
        let pairs = || self.functions.iter().zip(&other.functions);
        self.functions.len() == other.functions.len() && pairs().all(|(f, g)| f.is_same(&**g))
    }
}
