//! The normal equations of a hypothesis with candidates attached at amplitude zero: what score tests are
//! computed from, at the cost of one differentiated run per recording.

use crate::base::diag::Problems;
use crate::calibrate::data::Split;
use crate::calibrate::parallel;
use crate::calibrate::problem::Problem;
use crate::calibrate::statistics::at_bound;
use crate::numeric::least_squares::NormalEquations;

use super::hypothesis::{Hypothesis, amplitude, attached};
use super::model_source::Attached;
use super::rank::Candidate;
use super::score::{Score, full_step, projected, score};
use super::study::Study;

/// How many times as many steps as usual a run with more candidates than a batch has may take: each adds changes of its own that
/// are resolved.
const STEPS_OF_MANY: u64 = 4;

/// A hypothesis and the candidates that may be attached to it.
pub struct Linearisation<'a> {
    study: &'a Study,
    hypothesis: &'a Hypothesis,
    candidates: &'a [Candidate],
    /// Approximate number of instants of recordings to use.
    instants: usize,
    /// The hypothesis without effects, if candidates are to replace those of `hypothesis`.
    replaced: Option<&'a Hypothesis>,
    /// The recordings that were never fitted are linearised as well.
    is_validated: bool,
    /// Threads for the recordings of a batch.
    jobs: usize,
}

/// The normal equations with some of the candidates.
pub struct Linearised {
    normal: NormalEquations,
    /// Those of the recordings that were never fitted.
    validation: Option<NormalEquations>,
    /// Number of parameters of the hypothesis, which come first.
    free: usize,
    /// Position of the first amplitude of each candidate.
    first: Vec<Option<usize>>,
    /// Candidates whose amplitudes may have either sign.
    is_signed: Vec<bool>,
    /// Share of the sum of squares in the recordings used.
    share: f64,
}

impl Linearised {
    /// The joint score of effects, each given by its position in the catalogue and its candidates.
    pub fn score(&self, study: &Study, all: &[(usize, &[usize])]) -> Option<Score> {
        let (mut group, mut positive) = (Vec::new(), Vec::new());
        for (effect, members) in all {
            let amplitudes = &study.effects[*effect].amplitudes;
            for member in *members {
                let start = self.first[*member]?;
                group.extend(start..start + amplitudes.len());
                let is_signed = self.is_signed[*member];
                positive.extend(amplitudes.iter().map(|a| a.positive && !is_signed));
            }
        }
        let mut found = score(&self.normal, self.free, &group, &positive)?;
        found.columns = group;
        // The same share is assumed to be explained in the recordings that were not used.
        if self.share.is_normal() {
            found.gain /= self.share;
        }
        Some(found)
    }
}

impl Linearised {
    /// The same without what the parameters of the hypothesis absorb, so that many scores cost little.
    pub fn projected(&self) -> Linearised {
        let Linearised { free, first, is_signed, share, .. } = self;
        let normal = projected(&self.normal, *free);
        let first = first.iter().map(|k| k.map(|k| k - free)).collect();
        let is_signed = is_signed.clone();
        Linearised { normal, validation: None, free: 0, first, is_signed, share: *share }
    }

    /// Decrease of the sum of squares of the recordings that were never fitted, if the amplitudes of a score
    /// and the parameters follow the fitted ones.
    pub fn validation_gain(&self, score: &Score) -> Option<f64> {
        let validation = self.validation.as_ref()?;
        let step = full_step(&self.normal, self.free, score)?;
        Some(validation.cost - validation.after(&step))
    }
}

impl<'a> Linearisation<'a> {
    /// Candidates beside the effects of a hypothesis, with about `instants` instants of recordings.
    pub fn new(
        study: &'a Study,
        hypothesis: &'a Hypothesis,
        candidates: &'a [Candidate],
        instants: usize,
    ) -> Self {
        let (replaced, is_validated, jobs) = (None, false, parallel::cores());
        Linearisation { study, hypothesis, candidates, instants, replaced, is_validated, jobs }
    }

    /// Candidates in place of the effects of the hypothesis; `replaced` is the hypothesis without any.
    pub fn instead(self, replaced: Option<&'a Hypothesis>) -> Self {
        Linearisation { replaced, ..self }
    }

    /// Linearises the recordings that were never fitted as well.
    pub fn validated(self) -> Self {
        Linearisation { is_validated: true, ..self }
    }

    /// Uses at most so many threads for a batch: where several batches run at once.
    pub fn on_threads(self, jobs: usize) -> Self {
        Linearisation { jobs, ..self }
    }

    /// The largest gain that a score can mean: the whole sum of squares, unless candidates replace effects.
    pub fn max_gain(&self) -> f64 {
        self.replaced.map_or(self.hypothesis.train.total(), |_| f64::INFINITY)
    }

    /// The normal equations with a batch of candidates; `None` if they cannot be simulated together.
    pub fn with(&self, batch: &[usize]) -> Option<Linearised> {
        let Linearisation { study, hypothesis, candidates, replaced, .. } = *self;
        let free = hypothesis.plan.free.len();
        self.attached(batch, |problem, first| {
            let mut normal = problem.normal(&problem.start()).ok()?;
            let is_validated = self.is_validated && replaced.is_none();
            let validation =
                is_validated.then(|| problem.normal_of_split(Split::Validation, &problem.start()));
            let share = match replaced {
                None => normal.cost / hypothesis.train.total(),
                Some(replaced) => {
                    let of = |(k, s): (usize, &Vec<f64>)| match problem.trimmed.contains(&k) {
                        true => 0.0,
                        false => s.iter().sum(),
                    };
                    let used = replaced.train.squares.iter().enumerate().map(of).sum::<f64>();
                    used / replaced.train.total()
                }
            };
            if replaced.is_some() {
                remove_contributions(&mut normal, &contributions(study, hypothesis, problem));
            }
            // A parameter that is pushed against its bound absorbs nothing.
            let x = problem.start();
            let at_bound = at_bound(&normal, &problem.parameters[..free], &x[..free]);
            (0..free).filter(|k| at_bound[*k]).for_each(|k| remove_column(&mut normal, k));
            let validation = validation.and_then(Result::ok).filter(NormalEquations::is_finite);
            let is_signed = candidates.iter().map(|c| c.place.is_signed).collect();
            Some(Linearised { normal, validation, free, first, is_signed, share })
        })
    }

    /// The normal equations with the candidates of all batches, from runs of one batch each: candidates with states of their
    /// own make the steps of all others in a run cost more. Batches that cannot be simulated are split. `None` if nothing can.
    pub fn together(
        &self,
        batches: &[Vec<usize>],
        may_continue: impl Fn() -> bool,
    ) -> Option<Linearised> {
        let cores = parallel::cores();
        let with = Linearisation { jobs: cores.div_ceil(batches.len().max(1)), ..*self };
        let of_batch = |k: usize| with.columns(&batches[k]);
        let all = parallel::map_while(cores, batches.len(), may_continue, of_batch);
        let mut parts: Vec<Columns> = all.into_iter().flatten().flatten().collect();
        let rows = parts.first()?.residuals.len();
        parts.retain(|part| part.residuals.len() == rows);
        let free = self.hypothesis.plan.free.len();
        let mut first = vec![None; self.candidates.len()];
        let mut count = free;
        for part in &parts {
            for (candidate, at) in &part.members {
                first[*candidate] = Some(count + at - free);
            }
            count += part.width - free;
        }
        let of_rows = |chunk: usize| {
            let mut normal = NormalEquations::new(count);
            let mut row = Vec::with_capacity(count);
            for k in (chunk * rows / cores)..((chunk + 1) * rows / cores) {
                row.clear();
                row.extend_from_slice(&parts[0].slopes[k * parts[0].width..][..free]);
                let own = |part: &Columns| k * part.width + free..(k + 1) * part.width;
                parts.iter().for_each(|part| row.extend_from_slice(&part.slopes[own(part)]));
                normal.add(parts[0].residuals[k], &row);
            }
            normal
        };
        let mut normal = NormalEquations::new(count);
        parallel::map(cores, cores, of_rows).iter().for_each(|part| normal.merge(part));
        let at_bound = &parts[0].at_bound;
        (0..free).filter(|k| at_bound[*k]).for_each(|k| remove_column(&mut normal, k));
        let share = normal.cost / self.hypothesis.train.total();
        let is_signed = self.candidates.iter().map(|c| c.place.is_signed).collect();
        Some(Linearised { normal, validation: None, free, first, is_signed, share })
    }

    /// The derivatives of the residuals with a batch of candidates; if these cannot be simulated together, those of each half.
    fn columns(&self, batch: &[usize]) -> Vec<Columns> {
        let free = self.hypothesis.plan.free.len();
        let found = self.attached(batch, |problem, first| {
            let (x, width) = (problem.start(), problem.parameters.len());
            let (mut residuals, mut slopes) = (Vec::new(), Vec::new());
            let mut own = NormalEquations::new(free);
            let rows = problem.each_row(&x, |residual, row| {
                residuals.push(residual);
                slopes.extend_from_slice(row);
                own.add(residual, &row[..free]);
            });
            rows.ok()?;
            let at_bound = at_bound(&own, &problem.parameters[..free], &x[..free]);
            let members = batch.iter().filter_map(|i| Some((*i, first[*i]?))).collect();
            let is_finite = slopes.iter().all(|s: &f64| s.is_finite());
            is_finite.then_some(Columns { residuals, slopes, width, members, at_bound })
        });
        match (found, batch.len()) {
            (Some(columns), _) => vec![columns],
            (None, 0 | 1) => Vec::new(),
            (None, count) => {
                let (left, right) = batch.split_at(count / 2);
                [left, right].into_iter().flat_map(|half| self.columns(half)).collect()
            }
        }
    }

    /// Calls `of` with the problem that has a batch of candidates attached, and the position of the first amplitude of each.
    fn attached<T>(
        &self,
        batch: &[usize],
        of: impl FnOnce(&Problem<'_>, Vec<Option<usize>>) -> Option<T>,
    ) -> Option<T> {
        let Linearisation { study, hypothesis, candidates, instants, replaced, .. } = *self;
        let mut all = attached(study, &hypothesis.effects);
        let mut plan = hypothesis.plan.clone();
        if batch.len() > study.policy.batch {
            plan.allowance = STEPS_OF_MANY;
        }
        let mut first = vec![None; candidates.len()];
        for i in batch {
            let Candidate { effect, place, shape, .. } = &candidates[*i];
            let effect = &study.effects[*effect];
            let name = if effect.built_in { place.at[0].clone() } else { format!("trial_{i}") };
            first[*i] = Some(plan.free.len());
            for a in &effect.amplitudes {
                plan.free.push(amplitude(&format!("{name}.{}", a.name), 0.0, None, place, &name));
            }
            all.push(Attached::new(effect, place, name, shape.clone()));
        }
        let (session, program) = study.compile(&plan, &all, &[]).ok()?;
        let mut problems = Problems::new();
        let problem = Problem::new(&program, &session.sources, &plan, &study.data, &mut problems);
        let mut problem = problem?;
        problem.jobs = self.jobs;
        problem.trimmed = surplus(&problem, replaced.unwrap_or(hypothesis), instants);
        of(&problem, first)
    }
}

/// The residuals of a hypothesis and their derivatives by its parameters and by the amplitudes of some candidates.
struct Columns {
    residuals: Vec<f64>,
    /// Residual by residual.
    slopes: Vec<f64>,
    /// Derivatives of a residual.
    width: usize,
    /// The candidates, each with the position of its first amplitude.
    members: Vec<(usize, usize)>,
    /// The parameters of the hypothesis that are pushed against a bound.
    at_bound: Vec<bool>,
}

/// The columns of the effects of a hypothesis, and the distance of each from having no effect.
fn contributions(
    study: &Study,
    hypothesis: &Hypothesis,
    problem: &Problem<'_>,
) -> Vec<(usize, f64)> {
    let mut columns = Vec::new();
    for (k, p) in problem.parameters.iter().enumerate().take(hypothesis.plan.free.len()) {
        let targets = &hypothesis.plan.free[k].targets;
        for c in &hypothesis.effects {
            let own = |name: &str| targets.iter().any(|t| *t == c.full_name(name));
            let amplitudes = &study.effects[c.effect].amplitudes;
            if amplitudes.iter().any(|a| own(&a.name)) {
                columns.push((k, p.start / p.scale.slope(p.start)));
            } else if c.fitted.iter().any(|name| own(name)) {
                columns.push((k, 0.0));
            } else {
                continue;
            }
            break;
        }
    }
    columns
}

/// Removes columns and their contributions to the residuals from the normal equations.
fn remove_contributions(normal: &mut NormalEquations, columns: &[(usize, f64)]) {
    let n = normal.n;
    for (c, amount) in columns {
        let own = normal.gram[c + n * c];
        normal.cost += amount * (amount * own - 2.0 * normal.gradient[*c]);
        for i in 0..n {
            normal.gradient[i] -= amount * normal.gram[i + n * c];
        }
    }
    columns.iter().for_each(|(c, _)| remove_column(normal, *c));
}

/// Removes a column from the normal equations.
fn remove_column(normal: &mut NormalEquations, column: usize) {
    let n = normal.n;
    for i in 0..n {
        normal.gram[i + n * column] = 0.0;
        normal.gram[column + n * i] = 0.0;
    }
    normal.gradient[column] = 0.0;
}

/// Recordings that are not needed for about `instants` instants: those that fit best, since they contribute
/// least.
pub fn surplus(problem: &Problem<'_>, hypothesis: &Hypothesis, instants: usize) -> Vec<usize> {
    let mut trimmed = problem.surplus(instants);
    let each: Vec<f64> = hypothesis.train.squares.iter().map(|s| s.iter().sum()).collect();
    if each.len() == problem.recordings(Split::Train).len() {
        let mut order: Vec<usize> = (0..each.len()).collect();
        order.sort_by(|a, b| each[*a].total_cmp(&each[*b]));
        order.truncate(trimmed.len());
        trimmed = order;
    }
    trimmed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y = 2 + 3 t + 0.5 t^2` fitted in full: without the slope, a parallel direction explains the same.
    #[test]
    fn a_removed_contribution_can_be_explained_again() {
        let mut normal = NormalEquations::new(4);
        let mut whole = 0.0;
        for i in 0..11 {
            let t = 0.1 * f64::from(i);
            normal.add(0.0, &[1.0, t, t * t, 2.0 * t]);
            whole += (3.0 * t).powi(2);
        }
        remove_contributions(&mut normal, &[(1, 3.0)]);
        assert!((normal.cost - whole).abs() < 1e-9);
        let same = score(&normal, 3, &[3], &[false]).unwrap();
        assert!((same.amplitudes[0] - 1.5).abs() < 1e-6);
        assert_eq!(score(&normal, 3, &[1], &[false]), None);
    }
}
