//! Second thoughts on what a search has found step by step: two effects at once, one exchanged for another,
//! fewer for many.

use crate::calibrate::fit::{Fit, Heed};
use crate::calibrate::problem::Problem;

use super::attempt::Attempt;
use super::case::Case;
use super::effect::Effect;
use super::level::{Chosen, Level, groups, level};
use super::pairs::pairs;
use super::preference::{COMPLETE, CURVE, EVIDENCE, RESOLVED};
use super::rank::{Scored, rank, rank_instead};
use super::search::{Found, admit, bare_plan, promising, without};

/// Rounds in which effects are exchanged for others.
const ROUNDS: usize = 3;
/// Rivals of a law that are fitted.
const RIVALS: usize = 3;
/// A rival promises at least this share of what the law itself promises.
const RIVALLING: f64 = 0.7;
/// It is searched for long if it leaves less than this share of what is to be explained after a first look.
const DISTANT: f64 = 0.2;

/// Two effects at once, where one leaves something.
pub fn together(case: &Case<'_>, found: &mut Found, heed: &mut Heed<'_>) {
    let ranking = found.rankings.first().cloned().unwrap_or_default();
    if !is_resolved(&found.after) && heed(0, found.after.train.total()) {
        together_from(case, found, &found.before.clone(), &ranking, heed);
    }
}

/// Where one effect beside another leaves something too: two at once from where what was found has led, and
/// then each exchanged for another beside the rest.
pub fn revise(case: &Case<'_>, found: &mut Found, heed: &mut Heed<'_>) {
    if is_resolved(&found.after) || !heed(0, found.after.train.total()) {
        return;
    }
    if let Some(there) = stripped(case, &found.after) {
        let ranking = rank(case, &there);
        together_from(case, found, &there, &ranking, heed);
    }
    for _ in 0..ROUNDS {
        let last = found.after.bic();
        exchange(case, found, heed);
        if found.after.bic() >= last {
            break;
        }
    }
}

/// Two effects at once beside a level without any.
fn together_from(
    case: &Case<'_>,
    found: &mut Found,
    from: &Level,
    ranking: &[Scored],
    heed: &mut Heed<'_>,
) {
    let promising = pairs(case, from, ranking);
    let levels = Attempt { case, from, promising: &promising, depth: 0 }.fit(heed);
    if found.pairs.is_empty() {
        found.pairs = promising;
    }
    take_better(case, found, levels, heed);
}

/// Each effect exchanged for another beside the rest, from where the level stands.
fn exchange(case: &Case<'_>, found: &mut Found, heed: &mut Heed<'_>) {
    let number = groups(&found.after.chosen).count();
    for k in 0..number {
        let done = is_resolved(&found.after) || !heed(0, found.after.train.total());
        let mut all = found.after.chosen.chunk_by(|a, b| a.group == b.group);
        let Some(own) = all.nth(k).filter(|_| number > 1 && !done) else { return };
        let names: Vec<String> = own.iter().map(|c| c.name.clone()).collect();
        let Some(rest) = without(case, &found.after, &names, &mut |p| here(p)) else { continue };
        (case.say)(&format!("exchanging {}", names.join(", ")));
        let promising = promising(&rest, &rank(case, &rest));
        let attempt = Attempt { case, from: &rest, promising: &promising, depth: number - 1 };
        let levels = attempt.fit(heed);
        if take_better(case, found, levels, heed) {
            return;
        }
    }
}

/// Takes the first of the levels that is better than what was found; true if there is one.
fn take_better(
    case: &Case<'_>,
    found: &mut Found,
    mut levels: Vec<Level>,
    heed: &mut Heed<'_>,
) -> bool {
    let better = |l: &Level| {
        l.bic() < found.after.bic() - EVIDENCE
            && l.chi2_validation() < found.after.chi2_validation()
    };
    let best = levels.iter().position(better).map(|k| levels.remove(k));
    found.rejected.extend(levels);
    let Some(best) = best else { return false };
    let last = admit(case, found, best, heed);
    if !last.chosen.is_empty() {
        found.rejected.push(last);
    }
    true
}

/// True if nothing is left to explain, whether it was fitted or not.
fn is_resolved(level: &Level) -> bool {
    level.chi2_train() < COMPLETE && level.chi2_validation() < RESOLVED
}

/// One simple effect instead of several or of a curve, or two instead of more, if that explains as much. Where
/// nothing was kept, what was fitted best may still have led to better parameters.
pub fn simplify(case: &Case<'_>, found: &mut Found, heed: &mut Heed<'_>) {
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
        && let Some(simple) = fewer(case, &from.clone(), &found.before.clone(), heed)
        && simple.chi2_validation() < found.before.chi2_validation()
    {
        let last = admit(case, found, simple, heed);
        if !last.chosen.is_empty() {
            found.rejected.push(last);
        }
    }
}

/// One law that leaves nothing may stand for another that leaves still less: where it has led, the parameters
/// of the model are near the true ones, and the scores tell more than at the first attempt.
pub fn contest(case: &Case<'_>, found: &mut Found, heed: &mut Heed<'_>) {
    let law = found.after.clone();
    let explained = law.chi2_train() < COMPLETE && !law.chosen.is_empty();
    if !explained || is_intricate(case, &law) || !heed(0, law.train.total()) {
        return;
    }
    let Some(start) = stripped(case, &law) else { return };
    let by_sensor = law.chosen.iter().any(|c| c.place.signal.is_some());
    let ranking = rank_instead(case, &law, &found.before, &|effect, place| {
        effect.amplitudes.len() < CURVE && (by_sensor || place.signal.is_none())
    });
    let is_own = |s: &Scored| {
        let own =
            |c: &Chosen| s.members().iter().any(|(e, p)| *e == c.effect && p.at == c.place.at);
        law.chosen.iter().all(own)
    };
    let gain = ranking.iter().find(|s| is_own(s)).map_or(0.0, |s| s.gain);
    let is_rival = |s: &&Scored| s.gain > RIVALLING * gain && !is_own(s);
    let rivals: Vec<Vec<Scored>> =
        ranking.iter().filter(is_rival).take(RIVALS).map(|s| vec![s.clone()]).collect();
    let attempt = Attempt { case, from: &start, promising: &rivals, depth: 0 };
    let near = 1.0 + DISTANT * (found.before.chi2_train() - 1.0);
    let (mut levels, distant): (Vec<_>, Vec<_>) =
        attempt.look(heed).into_iter().partition(|l| l.chi2_train() < near);
    attempt.search_longer(&mut levels, heed);
    levels.sort_by(|a, b| a.evidence().total_cmp(&b.evidence()));
    // Of two that explain the same the one at fewer places, or the simpler one if it deserves its price.
    let better = |l: &Level| {
        let gained = law.evidence() - l.evidence();
        let simpler = l.values.len() < law.values.len() && l.bic() < law.bic();
        let fewer = l.chosen.len() < law.chosen.len();
        gained > EVIDENCE || gained > -EVIDENCE && (fewer || simpler)
    };
    let best = levels.iter().position(better).map(|k| levels.remove(k));
    found.rejected.extend(levels.into_iter().chain(distant));
    if let Some(best) = best {
        let last = admit(case, found, best, heed);
        found.rejected.push(last);
    }
}

/// True for several effects, or a free curve.
fn is_intricate(case: &Case<'_>, level: &Level) -> bool {
    let Some(first) = level.chosen.first() else { return false };
    level.chosen.iter().any(|c| c.group != first.group)
        || case.effects[first.effect].amplitudes.len() >= CURVE
}

/// One simple effect in place of what a level has, or two: where that has led, the parameters of the model
/// are near the true ones, and the scores tell more than at the first attempt.
fn fewer(case: &Case<'_>, from: &Level, before: &Level, heed: &mut Heed<'_>) -> Option<Level> {
    if !heed(0, from.train.total()) {
        return None;
    }
    let start = stripped(case, from)?;
    let mut fitted = |promising: &[Vec<Scored>]| {
        let levels = Attempt { case, from: &start, promising, depth: 0 }.fit(heed);
        levels.into_iter().find(|l| l.bic() < from.bic() + EVIDENCE)
    };
    let is_law = |effect: &Effect| effect.amplitudes.len() < CURVE;
    let instead = rank_instead(case, from, before, &|effect, _| is_law(effect));
    let mut one = fitted(&promising(&start, &instead));
    let ranking = if one.is_none() { rank(case, &start) } else { Vec::new() };
    if one.is_none() {
        let simple = ranking.iter().filter(|s| is_law(&case.effects[s.effect]));
        let simple: Vec<Scored> = simple.cloned().collect();
        one = fitted(&promising(&start, &simple));
    }
    let laws = from.chosen.iter().filter(|c| case.effects[c.effect].amplitudes.len() < CURVE);
    let more = from.chosen.len() > 2 || laws.count() < from.chosen.len();
    match one {
        None if groups(&from.chosen).count() > 1 && more => fitted(&pairs(case, &start, &ranking)),
        one => one,
    }
}

/// The model as it was, with the parameters that a level with effects has led to.
fn stripped(case: &Case<'_>, from: &Level) -> Option<Level> {
    level(case, Vec::new(), bare_plan(case, from), &mut |p| here(p)).ok()
}

/// Not fitted any further.
fn here(problem: &mut Problem<'_>) -> Option<Fit> {
    let x = problem.start();
    let normal = problem.normal(&x).ok()?;
    Some(Fit { x, normal, iterations: 0, converged: true, beyond: None })
}
