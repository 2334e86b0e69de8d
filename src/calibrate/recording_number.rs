//! The number of a recording as one of its conditions, for wear and drift.

use super::data::Data;
use super::plan::{Condition, Plan, RECORDING_NUMBER};
use super::unit::Unit;
use crate::base::source::Span;
use crate::ir::program::Program;

/// Adds the number of the recording to the conditions of a plan; windows of one recording have the same number.
pub fn number_recordings(plan: &mut Plan, data: &mut Data) {
    plan.conditions.push(Condition {
        column: RECORDING_NUMBER.to_owned(),
        parameter: RECORDING_NUMBER.to_owned(),
        unit: Unit::of("1").unwrap_or(Unit::SECOND),
        unit_name: "1".to_owned(),
        span: Span::NONE,
    });
    let mut known: Vec<String> = Vec::new();
    for recording in &mut data.recordings {
        let position = known.iter().position(|of| *of == recording.of);
        let number = position.unwrap_or_else(|| {
            known.push(recording.of.clone());
            known.len() - 1
        });
        recording.conditions.push((number + 1) as f64);
    }
}

/// The same where the model has a parameter for it, as a diagnosis adds one, and the plan does not set it.
pub fn number_where_declared(program: &Program, plan: &mut Plan, data: &mut Data) {
    let mut parameters = program.layout.parameter_inputs.iter();
    let is_declared = parameters.any(|(v, _)| program.name(*v) == RECORDING_NUMBER);
    let is_set = plan.conditions.iter().any(|c| c.parameter == RECORDING_NUMBER)
        || plan.free.iter().any(|f| f.targets.iter().any(|t| t == RECORDING_NUMBER));
    if is_declared && !is_set {
        number_recordings(plan, data);
    }
}

/// True if the number of the recording was added to the conditions of a plan.
pub fn is_numbered(plan: &Plan) -> bool {
    let is_added = |c: &Condition| c.parameter == RECORDING_NUMBER && c.span == Span::NONE;
    plan.conditions.iter().any(is_added)
}
