//! Recordings that begin in other states than the model: no effect, but a plan that takes their starts for granted.
//!
//! If the search leaves the misfit unexplained, the model without effects is fitted once more with starts of its own for each
//! recording, as `[free.each]` asks for.

use crate::base::source::Span;
use crate::calibrate::fit::search as local_search;
use crate::calibrate::plan::{Free, Plan};
use crate::calibrate::problem::Problem;

use super::hypothesis::Hypothesis;
use super::search::Search;
use super::study::Study;

/// States whose starts explain the misfit if each recording has its own.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparateStarts {
    /// The states.
    pub states: Vec<String>,
    /// Reduced chi-square of the fitted recordings with these starts.
    pub train: f64,
    /// The same of the validation recordings, whose starts are fitted to them alone.
    pub validation: f64,
}

/// Most states that are tried, each alone and all together.
const MAX_STATES: usize = 4;

/// The states whose starts, free for each recording, explain the misfit best without any effect. `None` if they do not explain
/// most of it, or if the plan frees something for each recording already.
pub fn separate_starts(search: &Search<'_>, before: &Hypothesis) -> Option<SeparateStarts> {
    let study = search.study;
    let states: Vec<String> = study.fixed_starts.iter().take(MAX_STATES).cloned().collect();
    if states.is_empty() || !study.plan.each.is_empty() || study.plan.fmu.is_some() {
        return None;
    }
    let mut sets: Vec<Vec<String>> = states.iter().map(|state| vec![state.clone()]).collect();
    if states.len() > 1 {
        sets.push(states);
    }
    let excess = |chi2: f64| (chi2 - 1.0).max(0.0);
    let left = 1.0 - search.policy().explained_share;
    let explains = |h: &Hypothesis| {
        excess(h.chi2_train()) < left * excess(before.chi2_train())
            && excess(h.chi2_validation()) < left * excess(before.chi2_validation())
    };
    let fitted = |states: Vec<String>| {
        if search.is_cancelled() {
            return None;
        }
        let plan = with_starts(study, before, &states);
        let fit = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            let stopping = &search.policy().fit.quick;
            local_search(p, &start, stopping, &mut |_, _| search.on_step())
        };
        let h = Hypothesis::fitted(study, Vec::new(), plan, fit).ok().filter(explains)?;
        let (train, validation) = (h.chi2_train(), h.chi2_validation());
        Some((h.total_criterion(), SeparateStarts { states, train, validation }))
    };
    let all = sets.into_iter().filter_map(fitted);
    all.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, starts)| starts)
}

/// The plan of a hypothesis with a start of its own for each recording.
fn with_starts(study: &Study, before: &Hypothesis, states: &[String]) -> Plan {
    let mut plan = before.plan.clone();
    plan.each = states
        .iter()
        .map(|state| format!("start({state})"))
        .map(|name| Free {
            targets: vec![name.clone()],
            name,
            start: None,
            min: None,
            max: None,
            around: None,
            acts_on: None,
            only: None,
            span: Span::NONE,
        })
        .collect();
    plan.free_each(&study.data);
    plan
}
