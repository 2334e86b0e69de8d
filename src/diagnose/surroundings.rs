//! Diagnosis of an FMU: the plan of its surroundings.
//!
//! The FMU becomes a component of a generated model, whose inputs, outputs and parameters are those of the FMU. Sensors,
//! actuators and parameters that vary are attached to this model as to any other; there is no connector to which anything
//! else could be. In: a plan whose model is an FMU. Out: the same plan for the generated model.

use std::sync::Arc;

use crate::calibrate::data::Data;
use crate::calibrate::plan::{Plan, WholeFmu};
use crate::driver::compile::{CompileError, Session};
use crate::driver::foreign::is_fmu;
use crate::driver::surrounded::{Surrounded, Wanted};

/// Communication points between two rows of a recording.
const POINTS_PER_ROW: f64 = 4.0;
/// Distance of communication points without recordings that tell it, s.
const STEP: f64 = 0.01;

/// About a diagnosis of an FMU.
pub const INSIDE: &str = "inside an FMU nothing can be added, so the search is among its sensors, its inputs and its \
                          parameters";

/// Replaces the FMU of a plan by a model that runs it.
pub(super) fn surround(
    session: &mut Session,
    plan: &mut Plan,
    data: &Data,
) -> Result<(), CompileError> {
    if !is_fmu(&plan.model) {
        return Ok(());
    }
    let fmu = Surrounded::open(session, &plan.model)?;
    let free = plan.free.iter().chain(&plan.each).flat_map(|f| &f.targets);
    let targets: Vec<&String> = free.chain(plan.starts.iter().map(|s| &s.target)).collect();
    let started = |name: &&String| {
        let variable = name.trim().strip_prefix("start(")?.strip_suffix(')')?;
        Some(variable.trim().to_owned())
    };
    let wanted = Wanted {
        step: spacing(data).map_or(STEP, |spacing| spacing / POINTS_PER_ROW),
        shown: plan.signals.iter().map(|s| s.variable.clone()).collect(),
        starts: targets.iter().filter_map(started).collect(),
        passed: targets.iter().map(|t| t.trim().to_owned()).collect(),
    };
    let text = fmu.text(&wanted);
    let file = plan.model.clone();
    plan.model = file.with_extension("mo");
    plan.name = None;
    let mut memory = (*plan.memory).clone();
    memory.model = Some(text);
    plan.memory = memory.into();
    rename(plan, &fmu);
    plan.fmu = Some(WholeFmu { file, fixed: fmu.fixed_parameters(), open: Arc::new(fmu) });
    Ok(())
}

/// Gives everything that the plan names its name in the model.
fn rename(plan: &mut Plan, fmu: &Surrounded) {
    let rename = |name: &mut String| *name = fmu.name(name);
    plan.signals.iter_mut().for_each(|s| rename(&mut s.variable));
    plan.inputs.iter_mut().for_each(|i| rename(&mut i.input));
    plan.conditions.iter_mut().for_each(|c| rename(&mut c.parameter));
    plan.starts.iter_mut().for_each(|s| rename(&mut s.target));
    for free in plan.free.iter_mut().chain(&mut plan.each) {
        free.targets.iter_mut().for_each(rename);
    }
    plan.fixed = fmu.settings(&plan.fixed);
}

/// The usual distance of rows in the recording with the closest ones, s.
fn spacing(data: &Data) -> Option<f64> {
    let of = |time: &[f64]| {
        let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied()
    };
    let all = data.recordings.iter().filter_map(|r| of(&r.time));
    all.filter(|step| *step > 0.0).min_by(f64::total_cmp)
}
