//! The `experiment` annotation of a model (Modelica 3.6, section 18.4).

use crate::evaluate::Evaluator;
use crate::ir::expr::Const;
use crate::ir::flat::Experiment;
use crate::ir::instance::{ClassId, InstanceId};

use super::annotation;

/// The experiment of a class, or else that of the first base class that has one.
pub(super) fn inherited(cx: &mut Evaluator<'_>, class: ClassId, root: InstanceId) -> Experiment {
    let mut experiment = Experiment::default();
    annotation::inherited(cx, (class, root), "experiment", &mut |cx, entries| {
        for entry in &entries {
            let slot = match entry.key.as_str() {
                "StartTime" => &mut experiment.start,
                "StopTime" => &mut experiment.stop,
                "Interval" => &mut experiment.interval,
                "Tolerance" => &mut experiment.tolerance,
                _ => continue,
            };
            *slot = entry.constant(cx).and_then(Const::number);
        }
        experiment == Experiment::default()
    });
    experiment
}
