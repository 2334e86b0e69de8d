//! The search for what a model lacks: calibrate, score every effect at every place, fit the best few,
//! keep what the data ask for; where that leaves something, score two at once, and look once more.

use std::ops::Range;

use crate::calibrate::fit::{Fit, Heed, STOPPING, fit, quick_fit, search};
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::Problem;

use super::attempt::Attempt;
use super::case::{Case, Nothing};
use super::level::{Chosen, Level, groups, level};
use super::preference::{COMPLETE, EVIDENCE};
use super::rank::{Scored, rank};
use super::revise::{contest, revise, simplify, together};

/// Places that are fitted after a score test.
const FITTED: usize = 5;
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
/// Steps of all fits after which no further one is begun: what many of them have not found, more do not.
const PATIENCE: u64 = 1000;

/// A longer calibration shows that the first was caught if it leaves less than this share of its sum.
const FREED: f64 = 0.7;

/// What was found.
pub struct Found {
    /// Without any effect.
    pub before: Level,
    /// With the effects that were kept.
    pub after: Level,
    /// The scores at each level, best first; one entry for each effect and place.
    pub rankings: Vec<Vec<Scored>>,
    /// Two at once that promise most, if they were asked for.
    pub pairs: Vec<Vec<Scored>>,
    /// What was fitted besides, best first.
    pub rejected: Vec<Level>,
}

/// Looks for what the model lacks. `heed` is told about each step and ends the search by `false`.
pub fn diagnose(case: &Case<'_>, heed: &mut Heed<'_>) -> Result<Found, Nothing> {
    let mut steps = 0;
    // Between fits it is told of a step 0.
    let heed: &mut Heed<'_> = &mut |step, sum| {
        steps += u64::from(step > 0);
        heed(step, sum) && (step > 0 || steps < PATIENCE)
    };
    let before = level(case, Vec::new(), case.plan.clone(), &mut |p| quick_fit(p, heed))?;
    let mut found = diagnose_from(case, before, heed);
    if found.after.chi2_train() >= COMPLETE && heed(0, found.after.train.total()) {
        // What no effect explains may come from a calibration that was caught.
        let thorough = level(case, Vec::new(), case.plan.clone(), &mut |p| fit(p, heed)).ok();
        let freed = thorough.filter(|t| t.train.total() < FREED * found.before.train.total());
        if let Some(freed) = freed {
            let again = diagnose_from(case, freed, heed);
            if again.after.chi2_validation() < found.after.chi2_validation() {
                found = again;
            }
        }
    }
    (case.say)(&format!("{steps} steps in all"));
    Ok(found)
}

/// Looks for what the model lacks, from its calibration on.
fn diagnose_from(case: &Case<'_>, before: Level, heed: &mut Heed<'_>) -> Found {
    (case.say)(&format!("calibrated: reduced chi-square {:.4}", before.chi2_train()));
    (case.say)(&format!("  by recording {:.1?}", before.train.by_recording()));
    let mut found = Found {
        after: before.clone(),
        before,
        rankings: Vec::new(),
        pairs: Vec::new(),
        rejected: Vec::new(),
    };
    climb(case, &mut found, 0..1, heed);
    together(case, &mut found, heed);
    if groups(&found.after.chosen).count() == 1 {
        climb(case, &mut found, 1..USUAL, heed);
    }
    revise(case, &mut found, heed);
    if groups(&found.after.chosen).count() >= USUAL {
        climb(case, &mut found, USUAL..DEPTH, heed);
    }
    simplify(case, &mut found, heed);
    contest(case, &mut found, heed);
    found
}

/// Adds one effect after the other, as long as the data ask for it.
fn climb(case: &Case<'_>, found: &mut Found, depths: Range<usize>, heed: &mut Heed<'_>) {
    for depth in depths {
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
        promising.retain(|p| p.iter().all(|s| s.gain > notable));
        for s in ranking.iter().take(2 * FITTED) {
            let share = s.gain / found.after.train.total();
            let name = case.named(s.effect, &s.place);
            (case.say)(&format!("  score {:5.1} %  {name} {:?}", 100.0 * share, s.shape));
        }
        found.rankings.push(ranking);
        let attempt = Attempt { case, from: &found.after, promising: &promising, depth };
        let mut levels = attempt.fit(heed);
        let asked_for = |l: &Level| {
            l.bic() < found.after.bic() - EVIDENCE
                && l.train.total() < found.after.train.total() - notable
                && l.chi2_validation() < found.after.chi2_validation()
        };
        if let Some(first) = levels.iter().position(asked_for) {
            let best = levels.remove(first);
            admit(case, found, best, heed);
            found.rejected.extend(levels);
        } else {
            found.rejected.extend(levels);
            break;
        }
    }
}

/// Takes what was found to be better, or the model as it was, if that fits as well from where the better one
/// has led: from there it may fit better than before. Gives back what that replaces.
pub fn admit(case: &Case<'_>, found: &mut Found, better: Level, heed: &mut Heed<'_>) -> Level {
    let mut best = simplified(case, better, heed);
    let bare = bare(case, &best, heed);
    if let Some(bare) = bare.filter(|b| b.train.total() < found.before.train.total()) {
        let (train, bic) = (bare.chi2_train(), bare.bic());
        (case.say)(&format!("without any effect from there: {train:.4}"));
        found.before = bare.clone();
        if bic < best.bic() + EVIDENCE {
            found.rejected.push(std::mem::replace(&mut best, bare));
        }
    }
    std::mem::replace(&mut found.after, best)
}

/// Those whose promise is worth their parameters.
pub fn promising(level: &Level, ranking: &[Scored]) -> Vec<Vec<Scored>> {
    let worth = |s: &&Scored| s.worth(level) > EVIDENCE;
    ranking.iter().filter(worth).take(FITTED).map(|s| vec![s.clone()]).collect()
}

/// The model as it was, fitted from where a level with effects stands.
fn bare(case: &Case<'_>, from: &Level, heed: &mut Heed<'_>) -> Option<Level> {
    level(case, Vec::new(), bare_plan(case, from), &mut |p| quick_fit(p, heed)).ok()
}

/// The plan without effects, its starts where a level stands.
pub fn bare_plan(case: &Case<'_>, from: &Level) -> Plan {
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
        let again = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            search(p, &start, &STOPPING, heed)
        };
        if let Some(without) = without(case, &level, &weak, again)
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

/// The level without the components of these names, and `how` it is fitted then.
pub fn without(
    case: &Case<'_>,
    level: &Level,
    names: &[String],
    how: &mut dyn FnMut(&mut Problem<'_>) -> Option<Fit>,
) -> Option<Level> {
    let (gone, mut chosen): (Vec<Chosen>, Vec<Chosen>) =
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
    // What stood behind a sensor's effect reads what that has read.
    for c in gone.iter().rev() {
        if let (Some(k), Some((_, input))) = (c.place.signal, c.place.binds.first()) {
            let output = format!("{}.y", c.name);
            let binds = chosen.iter_mut().flat_map(|c| &mut c.place.binds).map(|(_, v)| v);
            let readers = binds.chain(std::iter::once(&mut plan.signals[k].variable));
            readers.filter(|v| **v == output).for_each(|v| v.clone_from(input));
        }
    }
    self::level(case, chosen, plan, how).ok()
}
