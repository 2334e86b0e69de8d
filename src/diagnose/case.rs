//! What is examined, and how it is compiled with what is attached to it.

use crate::calibrate::data::Data;
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::record_also;
use crate::driver::compile::{Request, Session, Wrong};
use crate::flatten::inventory::Inventory;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;

use super::effect::Effect;
use super::place::Place;
use super::text::{Attached, model};

/// What is examined.
pub struct Case<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// How its model is compiled.
    pub request: Request,
    /// The recordings.
    pub data: &'a Data,
    /// Full name of the model.
    pub base: String,
    /// What its annotation asks for.
    pub experiment: Experiment,
    /// The catalogue.
    pub effects: &'a [Effect],
    /// What the model is made of.
    pub inventory: &'a Inventory,
    /// Names of its variables.
    pub variables: &'a [String],
    /// Told what is being done.
    pub say: &'a dyn Fn(&str),
}

impl Case<'_> {
    /// An effect at a place, in words.
    pub fn named(&self, effect: usize, place: &Place) -> String {
        format!("{} at {}", self.effects[effect].class, place.at.join(", "))
    }
}

/// Why there is no diagnosis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Nothing {
    /// The model can not be compiled.
    Model(Wrong),
    /// It can not be run under the conditions of the recordings.
    Run,
}

/// Compiles the model with what is attached, recording the signals and `others`.
pub fn compile(
    case: &Case<'_>,
    plan: &Plan,
    attached: &[Attached<'_>],
    others: &[String],
) -> Result<(Session, Program), Nothing> {
    let mut session = Session::default();
    let mut request = case.request.clone();
    if !attached.is_empty() {
        let name = "Trial";
        request.appended = Some(model(name, &case.base, "", None, &[], attached, &[]));
        request.model = Some(name.to_owned());
    }
    let mut program = session.compile(&request).map_err(Nothing::Model)?;
    if !attached.is_empty() {
        // What the annotation of the model says is not inherited.
        program.blocks.dae.experiment = case.experiment;
    }
    record_also(&mut program, plan, others);
    Ok((session, program))
}
