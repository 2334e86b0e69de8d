//! Formulas in the place of free curves: the values at the knots select a few, the recordings decide.
//!
//! A curve shows what is missing; a formula says it, with fewer parameters, and holds beyond the range of the
//! recordings that were fitted. For each form the amplitudes follow from the shape parameters by linear least
//! squares (variable projection: Golub and Pereyra 1973), so a grid of shapes suffices for a start.

use crate::base::source::Span;
use crate::calibrate::fit::{refined, search as local_search};
use crate::calibrate::plan::{Free, Plan};
use crate::calibrate::problem::Problem;
use crate::numeric::least_squares::NormalEquations;
use crate::numeric::linear::DenseLu;

use super::catalogue::Effect;
use super::curve_points::{Points, covariance, points_on_curve};
use super::finer_curve::with_finer_knots;
use super::formula::{Form, FreeCurve, middle_name, scale_name};
use super::hypothesis::{ANY_SIGN, ChosenEffect, Hypothesis, RANGE, component_name};
use super::regrid::{ends, moved_range};
use super::result::Diagnosis;
use super::revise::accept_instead;
use super::search::Search;
use super::study::Study;

/// Replaces the free curves of a diagnosis by formulas where the recordings support one.
pub fn replace_curves(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let mut k = 0;
    // With a formula in the place of one effect, others may become needless.
    while k < diagnosis.after.effects.len() {
        let limit = diagnosis.after.total_criterion() + allowance(search, &diagnosis.after, k);
        if let Some(best) = formula_instead(search, &diagnosis.after, k)
            && best.total_criterion() < limit
        {
            accept_instead(search, diagnosis, best);
        }
        k += 1;
    }
}

/// By how much the criterion may rise with a formula in the place of effect `k`: a curve is no law, while a straight line
/// is one until the data support another.
pub fn allowance(search: &Search<'_>, hypothesis: &Hypothesis, k: usize) -> f64 {
    let evidence = search.policy().evidence;
    match search.study.is_curve(hypothesis.effects[k].effect) {
        true => evidence,
        false => -evidence,
    }
}

/// The hypothesis with the best formula in the place of its effect `k`, a free curve or a parameter that varies along a
/// straight line. `None` if it is neither, or if the recordings determine none of the formulas.
pub fn formula_instead(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    k: usize,
) -> Option<Hypothesis> {
    let study = search.study;
    let chosen = hypothesis.effects.get(k)?;
    if hypothesis.effects.iter().filter(|c| c.group == chosen.group).count() > 1 {
        return None;
    }
    curve_of(study, chosen.effect)?;
    let finer = with_finer_knots(search, hypothesis, k);
    let hypothesis = finer.as_ref().unwrap_or(hypothesis);
    let chosen = &hypothesis.effects[k];
    let (own, curve) = curve_of(study, chosen.effect)?;
    let is_curve = study.effects[chosen.effect].curve.is_some();
    let knots = match is_curve {
        true => Knots::of(search, hypothesis, chosen, curve)?,
        false => Knots::on_line(study, hypothesis, chosen, curve)?,
    };
    let forms = study.effects.iter().enumerate().filter_map(|(effect, e)| {
        let formula = e.formula.as_ref().filter(|f| f.curve == own)?;
        Some((effect, formula.form)).filter(|(_, form)| is_curve || form.bends_line())
    });
    let (general, forms): (Vec<_>, Vec<_>) = forms.partition(|(_, form)| form.special().is_some());
    let centred = knots.counted_from_middle();
    let fitted = forms.into_iter().filter_map(|(effect, form)| match form.is_parabola() {
        true => centred.fitted(effect, form),
        false => knots.fitted(effect, form),
    });
    let mut candidates: Vec<Candidate> = fitted.collect();
    candidates.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    let mut best = finer.clone().filter(|finer| finer.is_determined(study));
    let most = search.generosity() * search.policy().fitted_formulas;
    for candidate in candidates.iter().take(most) {
        if !search.may_continue() {
            break;
        }
        let fitted = candidate.hypothesis(search, hypothesis, k, curve);
        best = better_formula(search, k, best, fitted);
    }
    // A general form is fitted from its special one: the curve shows an exponent beyond a place less clearly than the place.
    for (effect, form) in general {
        let Some(special) = best.as_ref() else { break };
        if let Some(candidate) = Candidate::from_special(study, special, k, (effect, form), &knots)
        {
            let fitted = candidate.hypothesis(search, special, k, curve);
            best = better_formula(search, k, best, fitted);
        }
    }
    best
}

/// The better of two hypotheses with formulas in the place of effect `k`, of which the recordings have to determine the second.
fn better_formula(
    search: &Search<'_>,
    k: usize,
    best: Option<Hypothesis>,
    fitted: Option<Hypothesis>,
) -> Option<Hypothesis> {
    let Some(fitted) = fitted else { return best };
    let (train, validation) = (fitted.chi2_train(), fitted.chi2_validation());
    let name = &fitted.effects[k].name;
    search.note(&format!("formula {name}: {train:.4}, validation {validation:.4}"));
    let criterion = fitted.total_criterion();
    let is_better = best.as_ref().is_none_or(|b| criterion < b.total_criterion());
    if is_better && fitted.is_determined(search.study) { Some(fitted) } else { best }
}

/// The free curve that formulas stand for in the place of an effect, and its position in the catalogue: the effect itself
/// or, for a parameter that varies along a straight line, the curve along which it may vary.
pub fn curve_of(study: &Study, effect: usize) -> Option<(usize, &FreeCurve)> {
    let own = &study.effects[effect];
    if let Some(curve) = &own.curve {
        return Some((own.finer_than.unwrap_or(effect), curve));
    }
    let varies = own.varies.is_some() && own.formula.is_none() && own.amplitudes.len() == 1;
    let is_along = |curve: &FreeCurve| {
        own.shape_parameters.iter().any(|(n, _)| curve.from.as_ref() == Some(n))
    };
    let varies_too = |e: &Effect| varies && e.varies.is_some() && e.finer_than.is_none();
    let mut all = study.effects.iter().enumerate().filter(|(_, e)| varies_too(e));
    all.find_map(|(k, e)| Some((k, e.curve.as_ref().filter(|c| is_along(c))?)))
}

/// True for an effect that a formula may take the place of: a free curve, or a parameter that varies along a straight line.
pub fn has_formulas(study: &Study, effect: usize) -> bool {
    curve_of(study, effect).is_some()
}

/// The value at `x` of a fitted formula in the place of a curve.
pub fn value_of_formula(
    study: &Study,
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
    curve: &FreeCurve,
    x: f64,
) -> Option<f64> {
    let effect = &study.effects[chosen.effect];
    let form = effect.formula.as_ref()?.form;
    let fixed = |name: &str| chosen.fixed.iter().find(|(n, _)| n == name).map(|(_, v)| *v);
    let fitted = |name: &str| Some(hypothesis.estimate(&chosen.full_name(name))?.0);
    let u = (x - fixed(&middle_name(curve)).unwrap_or(0.0)) / fixed(&scale_name(curve))?;
    let shapes = form.shapes.iter().map(|s| fitted(s.name)).collect::<Option<Vec<f64>>>()?;
    let terms = effect.amplitudes.iter().zip(form.terms);
    terms.map(|(a, term)| Some(fitted(&a.name)? * (term.value)(u, &shapes))).sum()
}

/// A fitted curve.
#[derive(Clone)]
struct Knots {
    x: Vec<f64>,
    y: Vec<f64>,
    /// What turns the errors of the values into independent ones of size 1, row by row; zero above the diagonal.
    whitening: Vec<f64>,
    /// Other parameters of the model take a share of the curve, which is taken to be proportional to its variable.
    is_shared: bool,
    /// The curve multiplies a parameter, which a constant part belongs to.
    is_anchored: bool,
    /// The value of the variable from which `u` is counted.
    middle: f64,
    /// The value by which it is divided.
    scale: f64,
    /// The curve multiplies a parameter, and its formula may be counted from any value.
    may_be_centred: bool,
}

/// Errors of knots below this share of the greatest value are not trusted.
const LEAST_ERROR: f64 = 0.01;

/// Knots that a formula needs.
const LEAST_KNOTS: usize = 3;

/// Points that stand for a straight line.
const POINTS_ON_LINE: usize = 8;

/// Distance of the values of a variable from a pole, in units of their scale.
const LEAST_DISTANCE: f64 = 0.02;

/// Rounds of the pattern search for the shapes of a form.
const SHAPE_ROUNDS: usize = 40;

/// A difference of information criteria that says nothing.
const NEGLIGIBLE: f64 = 1e-3;

impl Knots {
    /// Points on the straight line along which a parameter varies.
    fn on_line(
        study: &Study,
        hypothesis: &Hypothesis,
        chosen: &ChosenEffect,
        curve: &FreeCurve,
    ) -> Option<Knots> {
        let amplitude = study.effects[chosen.effect].amplitudes.first()?;
        let (slope, _) = hypothesis.estimate(&chosen.full_name(&amplitude.name))?;
        let (low, high) = ends(&chosen.fixed, curve)?;
        let places = curve.places(POINTS_ON_LINE, (low, high));
        let on_line = |x: &f64| (*x, slope * (x - low) / (high - low));
        let points = Points { at: places.iter().map(on_line).collect(), covariance: Vec::new() };
        Knots::through(points, curve, (low, high), false)
    }

    /// The knots of a curve that are determined, or all if none is; `None` if fewer than three. If the variable covers
    /// another range with the curve than without, points of the curve within that range.
    fn of(
        search: &Search<'_>,
        hypothesis: &Hypothesis,
        chosen: &ChosenEffect,
        curve: &FreeCurve,
    ) -> Option<Knots> {
        let effect = &search.study.effects[chosen.effect];
        let (low, high) = ends(&chosen.fixed, curve)?;
        if !curve.is_zero_at_zero
            && let Some(range) = moved_range(search, hypothesis, chosen, curve)
        {
            let points = points_on_curve(search.study, hypothesis, chosen, curve, range)?;
            return Knots::through(points, curve, range, false);
        }
        let places = curve.places(effect.amplitudes.len(), (low, high));
        let estimates =
            effect.amplitudes.iter().map(|a| hypothesis.estimate(&chosen.full_name(&a.name)));
        let known: Vec<(f64, (f64, f64), &str)> = places
            .into_iter()
            .zip(estimates)
            .zip(&effect.amplitudes)
            .filter_map(|((x, estimate), a)| Some((x, estimate?, a.name.as_str())))
            .collect();
        // Where other parameters take a share of the whole curve, no value has an error but those near zero, and all count
        // the same.
        let is_known = |(_, (_, error), _): &&(f64, (f64, f64), &str)| error.is_finite();
        let is_shared = known.iter().filter(is_known).count() < LEAST_KNOTS;
        let (mut at, mut names) = (Vec::new(), Vec::new());
        for (x, (y, _), name) in known.iter().filter(|k| is_shared || k.1.1.is_finite()) {
            at.push((*x, *y));
            names.push(*name);
        }
        let covariance =
            if is_shared { Vec::new() } else { covariance(hypothesis, chosen, &names) };
        let mut points = Points { at, covariance };
        if curve.is_anchored
            && let Some(fixed) = curve.fixed_point(low)
        {
            points.add_known(fixed);
        }
        Knots::through(points, curve, (low, high), is_shared)
    }

    /// Points of a curve; `None` if fewer than three.
    fn through(
        points: Points,
        curve: &FreeCurve,
        (low, high): (f64, f64),
        is_shared: bool,
    ) -> Option<Knots> {
        let greatest = points.at.iter().map(|(_, y)| y.abs()).fold(0.0, f64::max);
        if points.at.len() < LEAST_KNOTS || greatest == 0.0 || high <= low {
            return None;
        }
        let middle = if curve.is_centred() { rounded(0.5 * (low + high)) } else { 0.0 };
        // A range on both sides of zero, or from there, is counted from zero.
        let near_zero =
            low.abs().min(high.abs()) < 0.5 * low.abs().max(high.abs()) || low * high <= 0.0;
        let middle = if near_zero { 0.0 } else { middle };
        let scale = rounded((low - middle).abs().max((high - middle).abs()));
        Some(Knots {
            whitening: points.whitening(LEAST_ERROR * greatest),
            x: points.at.iter().map(|k| k.0).collect(),
            y: points.at.iter().map(|k| k.1).collect(),
            is_shared,
            is_anchored: curve.is_anchored,
            middle,
            scale,
            may_be_centred: curve.is_centred() && curve.is_anchored,
        })
    }

    /// Some values of the variable are greater than the one from which it is counted, and some are less.
    fn has_both_signs(&self) -> bool {
        [-1.0, 1.0].iter().all(|sign| self.x.iter().any(|x| (x - self.middle) * sign > 0.0))
    }

    /// The same, with the variable counted from the middle of its range, if it has one sign and the curve may be.
    fn counted_from_middle(&self) -> Knots {
        if !self.may_be_centred || self.has_both_signs() {
            return self.clone();
        }
        let low = self.x.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let middle = rounded(0.5 * (low + high));
        let scale = rounded((low - middle).abs().max((high - middle).abs()));
        Knots { middle, scale, ..self.clone() }
    }

    /// A form fitted to the knots: the best of its shapes.
    fn fitted(&self, effect: usize, form: &'static Form) -> Option<Candidate> {
        let shares = usize::from(self.is_shared) + usize::from(self.is_anchored);
        let parameters = form.terms.len() + form.shapes.len() + shares;
        let has_both_signs = self.has_both_signs();
        // From the middle, a parabola has the same values.
        let is_repeated = form.is_odd_parabola() && self.may_be_centred && !has_both_signs;
        let is_near_pole = |x: &f64| (x - self.middle) / self.scale < LEAST_DISTANCE;
        if parameters >= self.x.len()
            || form.has_pole_at_zero() && self.x.iter().any(is_near_pole)
            || self.is_shared && form.has_line()
            || is_repeated
            || form.needs_both_signs() && !has_both_signs
        {
            return None;
        }
        let penalty = parameters as f64 * (self.x.len() as f64).ln();
        let candidate = |shapes: Vec<f64>| {
            let (amplitudes, constant, cost) = self.amplitudes(form, &shapes)?;
            let criterion = cost + penalty;
            let Knots { middle, scale, is_shared, .. } = *self;
            Some(Candidate {
                effect,
                form,
                amplitudes,
                constant,
                shapes,
                criterion,
                middle,
                scale,
                is_shared,
            })
        };
        let mut best: Option<Candidate> = None;
        for shapes in grid(form) {
            best = match (best, candidate(shapes)) {
                (Some(best), other) => Some(best.or_better(other)),
                (None, first) => first,
            };
        }
        Some(refined_shapes(best?, &candidate))
    }

    /// What the value at a place is multiplied from: each term of a form, then the constant part and the shared line if there
    /// are any.
    fn row(&self, form: &Form, shapes: &[f64], x: f64) -> Vec<f64> {
        let u = (x - self.middle) / self.scale;
        let terms = form.terms.iter().map(|t| (t.value)(u, shapes));
        let constant = self.is_anchored.then_some(1.0);
        terms.chain(constant).chain(self.is_shared.then_some(u)).collect()
    }

    /// The amplitudes of least squares for given shapes, the constant part, and the weighted sum of squares that is left.
    fn amplitudes(&self, form: &Form, shapes: &[f64]) -> Option<(Vec<f64>, f64, f64)> {
        let n = form.terms.len() + usize::from(self.is_shared) + usize::from(self.is_anchored);
        let mut normal = NormalEquations::new(n);
        let rows: Vec<Vec<f64>> = self.x.iter().map(|x| self.row(form, shapes, *x)).collect();
        let points = self.x.len();
        for k in 0..points {
            let weights = &self.whitening[k * points..k * points + k + 1];
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                weights.iter().enumerate().map(|(j, w)| w * of(j)).sum()
            };
            let slopes: Vec<f64> = (0..n).map(|c| sum(&|j| rows[j][c])).collect();
            normal.add(-sum(&|j| self.y[j]), &slopes);
        }
        if !normal.is_finite() {
            return None;
        }
        let mut lu = DenseLu::new(n);
        lu.factor(&normal.gram).ok()?;
        let mut step: Vec<f64> = normal.gradient.iter().map(|g| -g).collect();
        lu.solve_in_place(&mut step);
        let cost = normal.after(&step);
        let constant = if self.is_anchored { step[form.terms.len()] } else { 0.0 };
        step.truncate(form.terms.len());
        // The parameter takes the constant part: 1 + c + f = (1 + c)(1 + f/(1 + c)).
        step.iter_mut().for_each(|a| *a /= 1.0 + constant);
        let is_finite = cost.is_finite() && step.iter().all(|a| a.is_finite());
        is_finite.then_some((step, constant, cost.max(0.0)))
    }
}

/// A formula with the parameters that describe the knots best.
struct Candidate {
    effect: usize,
    form: &'static Form,
    amplitudes: Vec<f64>,
    /// The part that belongs to the parameter which an anchored curve multiplies, as a share of it; else 0.
    constant: f64,
    shapes: Vec<f64>,
    /// Information criterion over the knots.
    criterion: f64,
    /// Those of [`Knots`].
    middle: f64,
    /// Those of [`Knots`].
    scale: f64,
    /// That of [`Knots`].
    is_shared: bool,
}

impl Candidate {
    /// A general form that equals the fitted special form in the place of effect `k`; `None` if that is another one.
    fn from_special(
        study: &Study,
        special: &Hypothesis,
        k: usize,
        (effect, form): (usize, &'static Form),
        knots: &Knots,
    ) -> Option<Candidate> {
        let chosen = &special.effects[k];
        let own = study.effects[chosen.effect].formula.as_ref()?.form;
        let (name, added) = form.special()?;
        if own.name != name {
            return None;
        }
        let value = |name: &str| Some(special.estimate(&chosen.full_name(name))?.0);
        let amplitudes = &study.effects[chosen.effect].amplitudes;
        let shapes = own.shapes.iter().map(|s| value(s.name));
        Some(Candidate {
            effect,
            form,
            amplitudes: amplitudes.iter().map(|a| value(&a.name)).collect::<Option<_>>()?,
            constant: 0.0,
            shapes: shapes.chain([Some(added)]).collect::<Option<_>>()?,
            criterion: 0.0,
            middle: knots.middle,
            scale: knots.scale,
            is_shared: knots.is_shared,
        })
    }

    /// The other one, if it describes the knots noticeably better.
    fn or_better(self, other: Option<Candidate>) -> Candidate {
        match other {
            Some(other) if other.criterion < self.criterion - NEGLIGIBLE => other,
            _ => self,
        }
    }

    /// The hypothesis with the formula in the place of its curve, effect `k`, fitted to the recordings.
    fn hypothesis(
        &self,
        search: &Search<'_>,
        from: &Hypothesis,
        k: usize,
        curve: &FreeCurve,
    ) -> Option<Hypothesis> {
        let study = search.study;
        let effect = &study.effects[self.effect];
        let old = &from.effects[k];
        let name = component_name(&effect.class, k, &from.effects);
        let prefix = name.clone();
        let mut chosen = ChosenEffect { effect: self.effect, name, prefix, ..old.clone() };
        chosen.fixed = vec![(scale_name(curve), self.scale)];
        if curve.is_centred() {
            chosen.fixed.push((middle_name(curve), self.middle));
        }
        let mut plan: Plan = from.plan.clone();
        let is_old = |name: &String| old.fitted.iter().any(|p| *name == old.full_name(p));
        plan.free.retain(|free| !free.targets.iter().any(is_old));
        let is_multiplied = |free: &Free| free.targets.iter().any(|t| old.place.at.contains(t));
        for free in plan.free.iter_mut().filter(|free| is_multiplied(free)) {
            free.start = free.start.map(|start| start * (1.0 + self.constant));
        }
        if self.is_shared {
            // Their values belong to the whole curve, of which they have a share.
            for free in &mut plan.free {
                let planned = study.plan.free.iter().find(|f| f.name == free.name);
                free.start = planned.map_or(free.start, |f| f.start);
            }
        }
        chosen.fitted.clear();
        let amplitudes = effect.amplitudes.iter().map(|a| a.name.clone()).zip(&self.amplitudes);
        let shapes = self.form.shapes.iter().zip(&self.shapes);
        let least = (effect.amplitudes.len() > 1).then_some(ANY_SIGN);
        let shapes = shapes.map(|(shape, value)| {
            let (least, greatest) = shape.range_around(*value);
            (shape.name.to_owned(), *value, (Some(least), Some(greatest)))
        });
        let starts = amplitudes.map(|(name, value)| (name, *value, (least, None))).chain(shapes);
        for (name, start, (min, max)) in starts.collect::<Vec<_>>() {
            let full = chosen.full_name(&name);
            plan.free.push(Free {
                name: full.clone(),
                targets: vec![full],
                start: Some(start),
                min,
                max,
                around: Some(RANGE),
                acts_on: None,
                only: None,
                span: Span::NONE,
            });
            chosen.fixed.push((name.clone(), start));
            chosen.fitted.push(name);
        }
        let mut effects = from.effects.clone();
        if chosen.place.signal.is_some() {
            // The signal, or a later effect of the same sensor, reads the output under its new name.
            let (output, new) = (format!("{}.y", old.name), format!("{}.y", chosen.name));
            let binds = effects.iter_mut().flat_map(|c| &mut c.place.binds).map(|(_, v)| v);
            let readers = binds.chain(plan.signals.iter_mut().map(|s| &mut s.variable));
            readers.filter(|v| **v == output).for_each(|v| v.clone_from(&new));
        }
        effects[k] = chosen;
        let policy = search.policy();
        // A line that does not get better soon when it may bend is straight.
        let least = from.train.total() - policy.evidence;
        let is_line = !study.is_curve(old.effect);
        let fit = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            let short = local_search(p, &start, &policy.short_fit, &mut |_, _| search.on_step())?;
            if is_line && short.normal.cost > least {
                return None;
            }
            let on_step = &mut |_, _| search.on_step();
            refined(p, &policy.fit, &short.x, &policy.fit.full, on_step)
        };
        let mut fitted = Hypothesis::fitted(study, effects, plan, fit).ok()?;
        fitted.is_complete_fit = true;
        Some(fitted)
    }
}

/// The best shapes around those of a candidate: a pattern search, whose step halves where no neighbour is better.
fn refined_shapes(
    mut best: Candidate,
    candidate: &dyn Fn(Vec<f64>) -> Option<Candidate>,
) -> Candidate {
    let starts = best.shapes.clone();
    let mut step = 0.25;
    for _ in 0..SHAPE_ROUNDS {
        let before = best.criterion;
        for (k, shape) in best.form.shapes.iter().enumerate() {
            let (low, high) = shape.range_around(starts[k]);
            for sign in [-1.0, 1.0] {
                let mut shapes = best.shapes.clone();
                shapes[k] += sign * step * shapes[k].abs().max(0.1);
                if (low..=high).contains(&shapes[k]) {
                    best = best.or_better(candidate(shapes));
                }
            }
        }
        if before - best.criterion < NEGLIGIBLE {
            step *= 0.5;
        }
    }
    best
}

/// All combinations of the shapes' starts.
fn grid(form: &Form) -> Vec<Vec<f64>> {
    let mut out: Vec<Vec<f64>> = vec![Vec::new()];
    for shape in form.shapes {
        let with = |known: &Vec<f64>| {
            let known = known.clone();
            shape.starts.iter().map(move |s| [known.as_slice(), &[*s]].concat())
        };
        out = out.iter().flat_map(with).collect();
    }
    out
}

/// A number rounded to one digit.
fn rounded(x: f64) -> f64 {
    format!("{x:.0e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::super::formula::{FORMS, formulas};
    use super::*;

    /// The whitening of `n` values with independent errors of 0.01.
    fn independent(n: usize) -> Vec<f64> {
        Points { at: vec![(0.0, 0.0); n], covariance: Vec::new() }.whitening(0.01)
    }

    fn knots(f: impl Fn(f64) -> f64) -> Knots {
        let x: Vec<f64> = (0..8).map(|k| 0.25 * f64::from(k)).collect();
        let y: Vec<f64> = x.iter().map(|x| f(*x)).collect();
        Knots {
            whitening: independent(8),
            x,
            y,
            is_shared: false,
            is_anchored: false,
            middle: 0.0,
            scale: 2.0,
            may_be_centred: true,
        }
    }

    /// The form that describes a function best, with its amplitudes and shapes.
    fn chosen(f: impl Fn(f64) -> f64) -> (&'static str, Vec<f64>, Vec<f64>) {
        let curve = FreeCurve { from: Some("a".into()), ..FreeCurve::default() };
        let effect = Effect { curve: Some(curve), ..Effect::default() };
        let knots = knots(f);
        let mut all: Vec<Candidate> = formulas(&[effect])
            .iter()
            .filter_map(|e| knots.fitted(0, e.formula.as_ref()?.form))
            .collect();
        all.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        let best = all.remove(0);
        (best.form.name, best.amplitudes, best.shapes)
    }

    #[test]
    fn the_form_is_that_of_the_function() {
        assert_eq!(chosen(|x| 3.0 * x).0, "Proportional");
        assert_eq!(chosen(|x| 3.0 * x - 1.0).0, "Line");
        // u = x/2: 5 x^1.5 = 5 2^1.5 u^1.5.
        let (name, amplitudes, shapes) = chosen(|x| 5.0 * x.powf(1.5));
        assert_eq!((name, shapes.as_slice()), ("PowerLaw", &[1.5][..]));
        assert!((amplitudes[0] - 5.0 * 2f64.powf(1.5)).abs() < 1e-9);
        assert_eq!(chosen(|x| 2.0 + 3.0 * (-x / 0.4).exp()).0, "Exponential");
        // The knots from 0 to 1.75 counted from 0.9 (0.875 with one digit), in units of 0.9.
        let parabola = FORMS.iter().find(|f| f.is_parabola()).unwrap();
        let around = knots(|x| 2.0 * (x - 0.9) + 3.0 * (x - 0.9).powi(2)).counted_from_middle();
        let found = around.fitted(0, parabola).unwrap().amplitudes;
        assert!((found[0] - 1.8).abs() < 1e-9 && (found[1] - 2.43).abs() < 1e-9, "{found:?}");
        let mut far = knots(|_| 0.0);
        far.x.iter_mut().for_each(|x| *x += 0.2);
        far.y = far.x.iter().map(|x| 0.1 / (x * x)).collect();
        let pole = FORMS.iter().find(|f| f.has_pole_at_zero()).unwrap();
        let found = far.fitted(0, pole).unwrap();
        // u = x/2: 0.1/x^2 = 0.025 u^-2.
        assert!((found.amplitudes[0] - 0.025).abs() < 1e-9 && found.shapes == [2.0]);
        assert!(knots(|x| x).fitted(0, pole).is_none(), "the knots contain zero");
        assert_eq!(chosen(|x| (3.0 * x).sin()).0, "Wave");
        // u/(0.4 + u) = x/(0.8 + x).
        let (name, amplitudes, shapes) = chosen(|x| 7.0 * x / (0.8 + x));
        assert_eq!(name, "Hyperbola");
        assert!((shapes[0] - 0.4).abs() < 1e-3 && (amplitudes[0] - 7.0).abs() < 1e-2, "{shapes:?}");
        let (name, _, shapes) = chosen(|x| 2.0 * (1.0 + x / 0.02).ln());
        assert_eq!(name, "Logarithm");
        assert!((shapes[0] - 0.01).abs() < 1e-4, "{shapes:?}");
        // The compliance of a rope of length 2.6 that winds up: 1/(1 - u/1.3) - 1.
        let (name, amplitudes, shapes) = chosen(|x| 0.5 * (1.0 / (1.0 - x / 2.6) - 1.0));
        assert_eq!(name, "Reciprocal");
        assert!((shapes[0] - 1.3).abs() < 1e-3 && (amplitudes[0] - 0.5).abs() < 1e-3, "{shapes:?}");
    }

    #[test]
    fn limits_and_dead_zones_have_forms_where_both_signs_occur() {
        let of = |f: fn(f64) -> f64| {
            let mut both = knots(|_| 0.0);
            both.x = (-4..=4).map(|k| 0.5 * f64::from(k)).collect();
            both.y = both.x.iter().map(|x| f(*x)).collect();
            both.whitening = independent(both.x.len());
            let curve = FreeCurve { from: Some("a".into()), ..FreeCurve::default() };
            let effect = Effect { curve: Some(curve), ..Effect::default() };
            let fit = |e: &Effect| both.fitted(0, e.formula.as_ref()?.form);
            let all: Vec<Candidate> = formulas(&[effect]).iter().filter_map(fit).collect();
            let best = all.into_iter().min_by(|a, b| a.criterion.total_cmp(&b.criterion));
            best.map(|b| (b.form.name, b.amplitudes, b.shapes))
        };
        // u = x/2. What exceeds a limit of 1.2 is missing.
        let limited = of(|x| x.clamp(-1.2, 1.2) - x).expect("a form");
        assert_eq!((limited.0, limited.2.as_slice()), ("DeadBand", &[0.6][..]));
        assert!((limited.1[0] + 2.0).abs() < 1e-9);
        let dead = of(|x| -x.clamp(-0.8, 0.8)).expect("a form");
        assert_eq!((dead.0, dead.2.as_slice()), ("LineAndDeadBand", &[0.4][..]));
        let uneven = of(|x| 3.0 * (x - 0.6).max(0.0) + (x + 1.2).min(0.0)).expect("a form");
        assert_eq!((uneven.0, uneven.2.as_slice()), ("TwoHinges", &[0.3, -0.6][..]));
    }

    #[test]
    fn scales_have_one_digit() {
        assert_eq!([rounded(0.0347), rounded(288.0), rounded(-6.1e5)], [0.03, 300.0, -6e5]);
    }
}
