//! Fitting effects that a score test has named beside what a level has: a look at all of them, a long
//! search for the best, and other beginnings where the best looks caught.

use crate::calibrate::fit::{Fit, Heed, STOPPING, refined, search};
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::Problem;
use crate::numeric::least_squares::{self, Stopping};

use super::case::Case;
use super::level::{Chosen, Level, attach, level};
use super::place::Place;
use super::preference::{COMPLETE, in_order, is_curve};
use super::rank::{ENOUGH, Scored};

/// Of what was looked at, so much is searched for long at most.
const SEARCHED: usize = 3;
/// It is, if what it leaves over after a first look is not more than this multiple of the least.
const CLOSE: f64 = 2.0;
/// Shares of what the score promises from which a look may begin.
const WAY: [f64; 5] = [1.0, 0.5, 0.2, 0.07, 0.02];
/// A fit may be caught if it explains all but this share of what was left,
const MOST: f64 = 0.5;
/// and leaves more than this over one of recordings that were never fitted.
const CAUGHT: f64 = 0.1;
/// Other shapes that it is begun with then.
const SHAPES: usize = 2;
/// Where several at once leave nothing, those are still looked at that promise less by this share at most.
const NEAR: f64 = 0.01;
/// A first look at an effect.
const LOOK: Stopping = Stopping { decrease: 1e-3, step: 1e-5, iterations: 10, reach: 1.0 };

/// Effects that may come beside what a level has.
#[derive(Clone, Copy)]
pub struct Attempt<'a> {
    /// What all levels share.
    pub case: &'a Case<'a>,
    /// The level as it is.
    pub from: &'a Level,
    /// What is tried, one or several at once, the best score first.
    pub promising: &'a [Vec<Scored>],
    /// Effects found before.
    pub depth: usize,
}

impl Attempt<'_> {
    /// The level with each of the effects, best first.
    pub fn fit(&self, heed: &mut Heed<'_>) -> Vec<Level> {
        let (case, from) = (self.case, self.from);
        let mut levels = self.first_looks(heed);
        in_order(case, from, &mut levels, Level::bic);
        self.search_longer(&mut levels, heed);
        // Beside an effect that is there, what was never fitted counts as much as what was.
        let by = if from.chosen.is_empty() { Level::bic } else { Level::evidence };
        in_order(case, from, &mut levels, by);
        if let Some(best) = levels.first().filter(|l| self.is_caught(l))
            && let Some(better) = self.elsewhere(best, heed)
        {
            levels[0] = better;
            in_order(case, from, &mut levels, by);
        }
        levels
    }

    /// A look at each of them, and where nothing leads on, another from where the plan begins.
    fn first_looks(&self, heed: &mut Heed<'_>) -> Vec<Level> {
        let mut levels = self.look(heed);
        if self.depth == 0 && !levels.iter().any(|l| self.explains_most(l)) {
            // The calibration has gone where nothing leads on: from where the plan begins something may.
            let begun = Level { plan: self.case.plan.clone(), ..self.from.clone() };
            for other in (Attempt { from: &begun, ..*self }).look(heed) {
                let same = |l: &&mut Level| l.is_like(&other);
                match levels.iter_mut().find(same) {
                    Some(known) if known.bic() <= other.bic() => {}
                    Some(known) => *known = other,
                    None => levels.push(other),
                }
            }
        }
        levels
    }

    /// A first look at each of them beside what the level has.
    pub fn look(&self, heed: &mut Heed<'_>) -> Vec<Level> {
        let mut levels: Vec<Level> = Vec::new();
        let (left, mut enough) = (self.from.train.total(), f64::NEG_INFINITY);
        for proposal in self.promising {
            if !heed(0, left) {
                break;
            }
            let gain = proposal.first().map_or(0.0, |s| s.gain);
            if proposal.len() > 1 && gain < enough {
                continue;
            }
            let (chosen, plan) = attach(self.case, self.from, proposal, self.depth);
            let short = &mut |p: &mut Problem<'_>, start: &[f64]| {
                p.left_out = p.surplus(ENOUGH);
                let found = search(p, start, &LOOK, heed);
                p.left_out = Vec::new();
                found
            };
            if let Some(fitted) = self.fitted(chosen, plan, short) {
                let names = self.named(&fitted);
                (self.case.say)(&format!("looked at {names}: {:.4}", fitted.chi2_train()));
                if fitted.chi2_train() < COMPLETE {
                    enough = enough.max(gain - NEAR * left);
                }
                levels.push(fitted);
            }
        }
        levels
    }

    /// Goes on with the best: laws that lead on, then curves, then the rest.
    pub fn search_longer(&self, levels: &mut [Level], heed: &mut Heed<'_>) {
        // A curve says nothing beside a law that leaves nothing; where a curve leaves nothing, laws are
        // looked for from there.
        let turn = |l: &Level| match (is_curve(self.case, l), self.explains_most(l)) {
            (false, true) => 0,
            (true, _) => 1,
            (false, false) => 2,
        };
        let mut order = self.hopeful(levels);
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
                refined(p, &start, &STOPPING, heed)
            };
            let better = level(self.case, fitted.chosen.clone(), fitted.plan.clone(), longer);
            let Ok(better) = better else { continue };
            self.say(&format!("fitted {}", self.named(&better)), &better);
            if better.chi2_train() < COMPLETE {
                match is_curve(self.case, &better) {
                    true => curve_solved = true,
                    false => law_solved = true,
                }
            }
            *fitted = better;
        }
    }

    /// Positions of those that are worth a long search.
    ///
    /// A free curve soon leaves little, but says little: laws are measured by the best of the laws. A curve
    /// that a law surpasses at the first look is not worth it.
    fn hopeful(&self, levels: &[Level]) -> Vec<usize> {
        let least = |curve: bool| {
            let of_kind = levels.iter().filter(|l| curve || !is_curve(self.case, l));
            of_kind.map(|l| l.chi2_train() - 1.0).fold(f64::INFINITY, f64::min)
        };
        let reach = |least: f64| 1.0 + (CLOSE * least).max(CLOSE * (COMPLETE - 1.0));
        let (law, any) = (least(false), least(true));
        let is_hopeful = |l: &Level| match is_curve(self.case, l) {
            true => l.chi2_train() < reach(any).min(1.0 + law),
            false => l.chi2_train() < reach(law),
        };
        (0..levels.len().min(SEARCHED)).filter(|k| is_hopeful(&levels[*k])).collect()
    }

    /// What was attached last, fitted from elsewhere: from where the plan begins, which the calibration
    /// without it has left in order to make up for it, and from other shapes. `None` if nothing better is
    /// found.
    fn elsewhere(&self, best: &Level, heed: &mut Heed<'_>) -> Option<Level> {
        let mut better: Option<Level> = None;
        for (chosen, plan) in self.other_starts(best) {
            if !heed(0, best.train.total()) {
                break;
            }
            let long = &mut |p: &mut Problem<'_>, start: &[f64]| refined(p, start, &STOPPING, heed);
            let Some(fitted) = self.fitted(chosen, plan, long) else { continue };
            self.say("from elsewhere", &fitted);
            let least = better.as_ref().unwrap_or(best);
            if fitted.train.total() < least.train.total() {
                better = Some(fitted);
            }
            if better.as_ref().is_some_and(|b| !self.is_caught(b)) {
                break;
            }
        }
        better
    }

    fn other_starts(&self, best: &Level) -> Vec<(Vec<Chosen>, Plan)> {
        let mut begun = best.plan.clone();
        for free in &mut begun.free {
            let as_planned = self.case.plan.free.iter().find(|f| f.name == free.name);
            free.start = as_planned.map_or(free.start, |f| f.start);
        }
        let mut starts = vec![(best.chosen.clone(), begun)];
        let new: Vec<(usize, &[String])> =
            self.added(best).iter().map(|c| (c.effect, c.place.at.as_slice())).collect();
        let same = |p: &&Vec<Scored>| {
            let members: Vec<(usize, Place)> = p.iter().flat_map(Scored::members).collect();
            members.iter().map(|(effect, place)| (*effect, place.at.as_slice())).eq(new.clone())
        };
        let Some(proposal) = self.promising.iter().find(same) else { return starts };
        for (k, scored) in proposal.iter().enumerate() {
            for other in scored.others.iter().take(SHAPES) {
                let mut proposal = proposal.clone();
                proposal[k] = other.clone();
                starts.push(attach(self.case, self.from, &proposal, self.depth));
            }
        }
        starts
    }

    /// What a level has that it was not begun with.
    fn added<'l>(&self, level: &'l Level) -> &'l [Chosen] {
        &level.chosen[self.from.chosen.len()..]
    }

    /// The same in words.
    fn named(&self, level: &Level) -> String {
        let mut last = None;
        let mut words: Vec<String> = Vec::new();
        for c in self.added(level) {
            match words.last_mut() {
                Some(word) if last == Some(c.group) => {
                    word.push_str(", ");
                    word.push_str(&c.place.at.join(", "));
                }
                _ => words.push(self.case.named(c.effect, &c.place)),
            }
            last = Some(c.group);
        }
        words.join(" and ")
    }

    /// The level with these effects, fitted from where their amplitudes begin best.
    fn fitted(
        &self,
        chosen: Vec<Chosen>,
        plan: Plan,
        how: &mut dyn FnMut(&mut Problem<'_>, &[f64]) -> Option<Fit>,
    ) -> Option<Level> {
        let new = amplitudes(self.case, &chosen[self.from.chosen.len()..]);
        let whole = &mut |p: &mut Problem<'_>| {
            let start = shortened(p, &new);
            how(p, &start)
        };
        level(self.case, chosen, plan, whole).ok()
    }

    fn say(&self, what: &str, level: &Level) {
        let (train, validation) = (level.chi2_train(), level.chi2_validation());
        (self.case.say)(&format!("{what}: {train:.4}, validation {validation:.4}"));
    }

    /// True for a fit that explains most of what was left, but not all: it may be caught beside a better one.
    fn is_caught(&self, level: &Level) -> bool {
        let left = level.chi2_train() > COMPLETE || level.chi2_validation() > 1.0 + CAUGHT;
        left && self.explains_most(level)
    }

    /// True for a fit that explains most of what was left.
    fn explains_most(&self, level: &Level) -> bool {
        level.chi2_train() - 1.0 < MOST * (self.from.chi2_train() - 1.0)
    }
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
