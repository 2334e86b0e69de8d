//! The search for what a model lacks: calibrate, score every effect at every place, fit the best few,
//! keep what the data ask for, and look once more.

use crate::calibrate::fit::{Fit, Heed, STOPPING, quick_fit, refine, search};
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::Problem;
use crate::math::numeric::least_squares::{self, Stopping};

use super::case::{Case, Nothing};
use super::level::{Chosen, Level, attach, level};
use super::preference::{COMPLETE, CURVE, EVIDENCE, in_order, is_curve};
use super::rank::{ENOUGH, Scored, rank};

/// Places that are fitted after a score test.
const FITTED: usize = 5;
/// Of these, those that are searched for long, at most.
const SEARCHED: usize = 3;
/// They are, if what they leave over after a first look is not more than this multiple of the least.
const CLOSE: f64 = 2.0;
/// Effects that are looked for, one after the other.
const DEPTH: usize = 5;
/// Of these, those that are looked for while anything is left to explain; more only where much is.
const USUAL: usize = 2;
/// Reduced sum of squares above which much is left.
const MUCH: f64 = 2.0;
/// Share of what is left that each of these further ones must promise, and explain.
const NOTABLE: f64 = 0.1;
/// An amplitude that is not so many standard errors from zero may not be needed.
const WEAK: f64 = 10.0;
/// Shares of what the score promises from which a look may begin.
const WAY: [f64; 5] = [1.0, 0.5, 0.2, 0.07, 0.02];
/// A fit may be caught if it explains all but this share of what was left,
const MOST: f64 = 0.5;
/// and leaves more than this over one of recordings that were never fitted.
const CAUGHT: f64 = 0.1;
/// Other shapes that it is begun with then.
const SHAPES: usize = 2;
/// A first look at an effect.
const LOOK: Stopping = Stopping { decrease: 1e-3, step: 1e-5, iterations: 10, reach: 1.0 };

/// What was found.
pub struct Found {
    /// Without any effect.
    pub before: Level,
    /// With the effects that were kept.
    pub after: Level,
    /// The scores at each level, best first; one entry for each effect and place.
    pub rankings: Vec<Vec<Scored>>,
    /// What was fitted besides, best first.
    pub rejected: Vec<Level>,
}

/// Looks for what the model lacks. `heed` is told about each step and ends the search by `false`.
pub fn diagnose(case: &Case<'_>, heed: &mut Heed<'_>) -> Result<Found, Nothing> {
    let before = level(case, Vec::new(), case.plan.clone(), &mut |p| quick_fit(p, heed))?;
    (case.say)(&format!("calibrated: reduced chi-square {:.4}", before.chi2_train()));
    (case.say)(&format!("  by recording {:.1?}", before.train.by_recording()));
    let mut found =
        Found { after: before.clone(), before, rankings: Vec::new(), rejected: Vec::new() };
    for depth in 0..DEPTH {
        let enough = match depth {
            0 => 0.0,
            1..USUAL => COMPLETE,
            _ => MUCH,
        };
        if found.after.chi2_train() < enough || !heed(0, found.after.train.total()) {
            break;
        }
        let ranking = rank(case, &found.after);
        let notable = if depth < USUAL { 0.0 } else { NOTABLE * found.after.train.total() };
        let mut promising = promising(&found.after, &ranking);
        promising.retain(|s| s.gain > notable);
        for s in ranking.iter().take(2 * FITTED) {
            let share = s.gain / found.after.train.total();
            let name = case.named(s.effect, &s.place);
            (case.say)(&format!("  score {:5.1} %  {name} {:?}", 100.0 * share, s.shape));
        }
        found.rankings.push(ranking);
        let mut levels = tried(case, &found.after, &promising, depth, heed);
        let asked_for = |l: &Level| {
            l.bic() < found.after.bic() - EVIDENCE
                && l.train.total() < found.after.train.total() - notable
                && l.chi2_validation() < found.after.chi2_validation()
        };
        if let Some(first) = levels.iter().position(asked_for) {
            let best = simplified(case, levels.remove(first), heed);
            // From where the amended model has led, the model as it was may fit better than before.
            let bare = bare(case, &best, heed);
            if let Some(bare) = bare.filter(|b| b.train.total() < found.before.train.total()) {
                let (train, bic) = (bare.chi2_train(), bare.bic());
                (case.say)(&format!("without any effect from there: {train:.4}"));
                found.before = bare.clone();
                if bic < best.bic() + EVIDENCE {
                    found.rejected.push(best);
                    found.rejected.extend(levels);
                    found.after = bare;
                    continue;
                }
            }
            found.after = best;
            found.rejected.extend(levels);
        } else {
            found.rejected.extend(levels);
            break;
        }
    }
    // Where nothing was kept, what was fitted best may still have led to better parameters.
    let refused = || found.rejected.iter().min_by(|a, b| a.bic().total_cmp(&b.bic()));
    let from = match found.after.chosen.is_empty() {
        true if found.after.chi2_train() >= COMPLETE => {
            refused().filter(|l| l.bic() < found.after.bic() - EVIDENCE)
        }
        true => None,
        false => {
            let explained = found.after.chi2_train() < COMPLETE;
            Some(&found.after).filter(|l| explained && is_intricate(case, l))
        }
    };
    if let Some(from) = from
        && let Some(simple) = single(case, &from.clone(), heed)
        && simple.chi2_validation() < found.before.chi2_validation()
    {
        let simple = simplified(case, simple, heed);
        let last = std::mem::replace(&mut found.after, simple);
        if !last.chosen.is_empty() {
            found.rejected.push(last);
        }
    }
    Ok(found)
}

/// True for several effects, or a free curve.
fn is_intricate(case: &Case<'_>, level: &Level) -> bool {
    let Some(first) = level.chosen.first() else { return false };
    level.chosen.iter().any(|c| c.group != first.group)
        || case.effects[first.effect].amplitudes.len() >= CURVE
}

/// Those whose promise is worth their parameters.
fn promising(level: &Level, ranking: &[Scored]) -> Vec<Scored> {
    let worth = |s: &&Scored| s.worth(level) > EVIDENCE;
    ranking.iter().filter(worth).take(FITTED).cloned().collect()
}

/// Fits each of them beside what the level has: a look at all, and a long search for the best. Best first.
fn tried(
    case: &Case<'_>,
    from: &Level,
    promising: &[Scored],
    depth: usize,
    heed: &mut Heed<'_>,
) -> Vec<Level> {
    let mut levels = looked_at(case, from, promising, depth, heed);
    if depth == 0 && !levels.iter().any(|l| explains_most(from, l)) {
        // The calibration has gone where nothing leads on: from where the plan begins something may.
        let begun = Level { plan: case.plan.clone(), ..from.clone() };
        for other in looked_at(case, &begun, promising, depth, heed) {
            let same = |l: &&mut Level| l.is_like(&other);
            match levels.iter_mut().find(same) {
                Some(known) if known.bic() <= other.bic() => {}
                Some(known) => *known = other,
                None => levels.push(other),
            }
        }
    }
    in_order(case, from, &mut levels, Level::bic);
    // A free curve soon leaves little, but says little: laws are measured by the best of the laws. A curve
    // that a law surpasses at the first look is not worth a long search.
    let least = |curve: bool| {
        let of_kind = levels.iter().filter(|l| curve || !is_curve(case, l));
        of_kind.map(|l| l.chi2_train() - 1.0).fold(f64::INFINITY, f64::min)
    };
    let reach = |least: f64| 1.0 + (CLOSE * least).max(CLOSE * (COMPLETE - 1.0));
    let (law, any) = (least(false), reach(least(true)));
    let reach_of_laws = reach(law);
    let hopeful = |l: &Level| match is_curve(case, l) {
        true => l.chi2_train() < any.min(1.0 + law),
        false => l.chi2_train() < reach_of_laws,
    };
    // Laws that lead on, then curves, then the rest. A curve says nothing beside a law that leaves nothing;
    // where a curve leaves nothing, laws are looked for from there.
    let turn = |l: &Level| match (is_curve(case, l), explains_most(from, l)) {
        (false, true) => 0,
        (true, _) => 1,
        (false, false) => 2,
    };
    let mut order: Vec<usize> =
        (0..levels.len().min(SEARCHED)).filter(|k| hopeful(&levels[*k])).collect();
    order.sort_by_key(|k| turn(&levels[*k]));
    let (mut law_solved, mut curve_solved) = (false, false);
    for k in order {
        let fitted = &mut levels[k];
        let own_turn = turn(fitted);
        if law_solved && own_turn == 1 || curve_solved && own_turn == 2 {
            continue;
        }
        let longer = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            let found = search(p, &start, &STOPPING, heed)?;
            Some(refine(p, found, heed))
        };
        if let Ok(better) = level(case, fitted.chosen.clone(), fitted.plan.clone(), longer) {
            let name = better.chosen.last().map(|c| case.named(c.effect, &c.place));
            let (train, validation) = (better.chi2_train(), better.chi2_validation());
            let name = name.unwrap_or_default();
            (case.say)(&format!("fitted {name}: {train:.4}, validation {validation:.4}"));
            if better.chi2_train() < COMPLETE {
                match is_curve(case, &better) {
                    true => curve_solved = true,
                    false => law_solved = true,
                }
            }
            *fitted = better;
        }
    }
    // Beside an effect that is there, what was never fitted counts as much as what was.
    let by = if from.chosen.is_empty() { Level::bic } else { Level::evidence };
    in_order(case, from, &mut levels, by);
    if let Some(best) = levels.first().filter(|l| is_caught(from, l))
        && let Some(better) = elsewhere(case, from, best, promising, depth, heed)
    {
        levels[0] = better;
        in_order(case, from, &mut levels, by);
    }
    levels
}

/// A first look at each of them beside what the level has.
fn looked_at(
    case: &Case<'_>,
    from: &Level,
    promising: &[Scored],
    depth: usize,
    heed: &mut Heed<'_>,
) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for scored in promising {
        if !heed(0, from.train.total()) {
            break;
        }
        let (chosen, plan) = attach(case, from, scored, depth);
        let new = amplitudes(case, &chosen[from.chosen.len()..]);
        let look = &mut |p: &mut Problem<'_>| {
            p.left_out = p.surplus(ENOUGH);
            let start = shortened(p, &new);
            let found = search(p, &start, &LOOK, heed);
            p.left_out = Vec::new();
            found
        };
        if let Ok(fitted) = level(case, chosen, plan, look) {
            let name = case.named(scored.effect, &scored.place);
            (case.say)(&format!("looked at {name}: {:.4}", fitted.chi2_train()));
            levels.push(fitted);
        }
    }
    levels
}

/// True for a fit that explains most of what was left, but not all: it may be caught beside a better one.
fn is_caught(from: &Level, level: &Level) -> bool {
    let left = level.chi2_train() > COMPLETE || level.chi2_validation() > 1.0 + CAUGHT;
    left && explains_most(from, level)
}

/// True for a fit that explains most of what was left.
fn explains_most(from: &Level, level: &Level) -> bool {
    level.chi2_train() - 1.0 < MOST * (from.chi2_train() - 1.0)
}

/// The effect that was found last, fitted from elsewhere: from where the plan begins, which the calibration
/// without the effect has left in order to make up for it, and from other shapes. `None` if nothing better
/// is found.
fn elsewhere(
    case: &Case<'_>,
    from: &Level,
    best: &Level,
    promising: &[Scored],
    depth: usize,
    heed: &mut Heed<'_>,
) -> Option<Level> {
    let new = &best.chosen[from.chosen.len()..];
    let last = new.first()?;
    let same = |s: &&Scored| {
        let members = s.place.members();
        let at_first = members.first().is_some_and(|place| *place == last.place);
        s.effect == last.effect && at_first && members.len() == new.len()
    };
    let mut begun = best.plan.clone();
    for free in &mut begun.free {
        let as_planned = case.plan.free.iter().find(|f| f.name == free.name);
        free.start = as_planned.map_or(free.start, |f| f.start);
    }
    let mut starts = vec![(best.chosen.clone(), begun)];
    let other_shapes = promising.iter().find(same).into_iter().flat_map(|s| &s.others);
    starts.extend(other_shapes.take(SHAPES).map(|scored| attach(case, from, scored, depth)));
    let mut better: Option<Level> = None;
    for (chosen, plan) in starts {
        if !heed(0, best.train.total()) {
            break;
        }
        let new = amplitudes(case, &chosen[from.chosen.len()..]);
        let thorough = &mut |p: &mut Problem<'_>| {
            let start = shortened(p, &new);
            let found = search(p, &start, &STOPPING, heed)?;
            Some(refine(p, found, heed))
        };
        let Ok(fitted) = level(case, chosen, plan, thorough) else { continue };
        let (train, validation) = (fitted.chi2_train(), fitted.chi2_validation());
        (case.say)(&format!("from elsewhere: {train:.4}, validation {validation:.4}"));
        let least = better.as_ref().unwrap_or(best);
        if fitted.train.total() < least.train.total() {
            better = Some(fitted);
        }
        if better.as_ref().is_some_and(|b| !is_caught(from, b)) {
            break;
        }
    }
    better
}

/// Full names of the amplitudes of effects.
fn amplitudes(case: &Case<'_>, chosen: &[Chosen]) -> Vec<String> {
    let of = |c: &Chosen| {
        let all = case.effects[c.effect].amplitudes.iter();
        all.map(|a| format!("{}.{}", c.name, a.name)).collect::<Vec<_>>()
    };
    chosen.iter().flat_map(of).collect()
}

/// Where a look begins: the score is a straight line, and amplitudes that follow it to its end may be far
/// beyond where it holds. So the best of some points on the way there.
fn shortened(problem: &mut Problem<'_>, amplitudes: &[String]) -> Vec<f64> {
    let whole = problem.start();
    let at = |share: f64| {
        let scaled = problem.parameters.iter().zip(&whole).map(|(p, x)| {
            let is_new = amplitudes.contains(&p.name);
            if is_new { p.scale.place(share * p.start) } else { *x }
        });
        scaled.collect::<Vec<f64>>()
    };
    let points: Vec<Vec<f64>> = WAY.into_iter().map(at).collect();
    let costs: Vec<f64> = points
        .iter()
        .map(|x| least_squares::Residuals::cost(problem, x).unwrap_or(f64::INFINITY))
        .collect();
    let best = (0..points.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    best.map_or(whole, |k| points[k].clone())
}

/// One simple effect in place of what a level has: where that has led, the parameters of the model are
/// near the true ones, and the scores tell more than at the first attempt.
fn single(case: &Case<'_>, from: &Level, heed: &mut Heed<'_>) -> Option<Level> {
    if !heed(0, from.train.total()) {
        return None;
    }
    let here = &mut |p: &mut Problem<'_>| {
        let x = p.start();
        let normal = p.normal(&x).ok()?;
        Some(Fit { x, normal, iterations: 0, converged: true, beyond: None })
    };
    let start = level(case, Vec::new(), bare_plan(case, from), here).ok()?;
    let ranking = rank(case, &start);
    let simple: Vec<Scored> =
        ranking.into_iter().filter(|s| case.effects[s.effect].amplitudes.len() < CURVE).collect();
    let levels = tried(case, &start, &promising(&start, &simple), 0, heed);
    let enough = |l: &Level| l.bic() < from.bic() + EVIDENCE;
    levels.into_iter().find(enough)
}

/// The model as it was, fitted from where a level with effects stands.
fn bare(case: &Case<'_>, from: &Level, heed: &mut Heed<'_>) -> Option<Level> {
    level(case, Vec::new(), bare_plan(case, from), &mut |p| quick_fit(p, heed)).ok()
}

/// The plan without effects, its starts where a level stands.
fn bare_plan(case: &Case<'_>, from: &Level) -> Plan {
    let mut plan = case.plan.clone();
    for free in &mut plan.free {
        let same = from.plan.free.iter().find(|f| f.name == free.name);
        free.start = same.map_or(free.start, |f| f.start);
    }
    plan
}

/// Without those effects that the data do not ask for beside the others, and without those places of an
/// effect at several.
fn simplified(case: &Case<'_>, mut level: Level, heed: &mut Heed<'_>) -> Level {
    let last = level.chosen.last().map_or(0, |c| c.group);
    for group in 0..=last {
        let weak: Vec<String> = level
            .chosen
            .iter()
            .filter(|c| c.group == group && is_weak(case, &level, c))
            .map(|c| c.name.clone())
            .collect();
        if weak.is_empty() || weak.len() == level.chosen.len() {
            continue;
        }
        if let Some(without) = without(case, &level, &weak, heed)
            && without.bic() < level.bic() + EVIDENCE
        {
            level = without;
        }
    }
    level
}

/// True if none of its amplitudes is far from zero.
fn is_weak(case: &Case<'_>, level: &Level, chosen: &Chosen) -> bool {
    let all = &case.effects[chosen.effect].amplitudes;
    let weak = |name: &String| {
        let estimate = level.estimate(&format!("{}.{name}", chosen.name));
        let significant = estimate.is_some_and(|(value, error)| value.abs() > WEAK * error);
        !significant
    };
    !all.is_empty() && all.iter().all(|a| weak(&a.name))
}

/// The level without the components of these names, fitted from where it stands.
fn without(case: &Case<'_>, level: &Level, names: &[String], heed: &mut Heed<'_>) -> Option<Level> {
    let (gone, chosen): (Vec<Chosen>, Vec<Chosen>) =
        level.chosen.iter().cloned().partition(|c| names.contains(&c.name));
    let mut plan = level.plan.clone();
    let is_gone = |target: &String| {
        gone.iter().any(|c| c.fitted.iter().any(|p| *target == format!("{}.{p}", c.name)))
    };
    plan.free.retain_mut(|free| {
        free.targets.retain(|target| !is_gone(target));
        // A shape that several places share keeps the name of the first that is left.
        if is_gone(&free.name)
            && let Some(first) = free.targets.first()
        {
            free.name.clone_from(first);
        }
        !free.targets.is_empty()
    });
    for c in &gone {
        if let (Some(k), Some((_, variable))) = (c.place.signal, c.place.binds.first()) {
            plan.signals[k].variable.clone_from(variable);
        }
    }
    let again = &mut |p: &mut Problem<'_>| {
        let start = p.start();
        search(p, &start, &STOPPING, heed)
    };
    self::level(case, chosen, plan, again).ok()
}
