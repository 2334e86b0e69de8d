//! Calibration and diagnosis of simulated specimens: the valve of `examples/valve52.toml` or, after
//! the word `valve32`, that of `examples/valve32.toml`, with other parameters, other noise, and
//! possibly one or two effects of the catalogue.
//!
//! ```sh
//! cargo bench --bench specimens -- starts 20          # calibrations from random starts
//! cargo bench --bench specimens -- healthy 20 [1]     # diagnoses of intact specimens
//! cargo bench --bench specimens -- effects [NAME]     # each effect of the catalogue in turn
//! cargo bench --bench specimens -- foreign [NAME]     # the same, effect not in the catalogue
//! cargo bench --bench specimens -- pairs 20 [1]       # two effects at once, from number 1
//! cargo bench --bench specimens -- random 20 [1 [NAME]]  # one effect of any size, some not in the catalogue
//! cargo bench --bench specimens -- random-pairs 20 [1]  # two such effects at once
//! cargo bench --bench specimens -- valve32 effects    # with the other valve
//! SPECIMENS_LOG=1 cargo bench --bench specimens -- random 1 7   # with every step of the search
//! SPECIMENS_SECONDS=60 cargo bench --bench specimens -- random 60  # the best verdict after a minute of each
//! ```

use std::path::Path;
use std::time::Instant;

use mocc::base::diag::Problems;
use mocc::calibrate::data::{self, Data, Split};
use mocc::calibrate::fit::{self, Fit};
use mocc::calibrate::observer::{Event, Observer};
use mocc::calibrate::plan::Plan;
use mocc::calibrate::plan_file;
use mocc::calibrate::problem::Problem;
use mocc::calibrate::sums::Sums;
use mocc::diagnose::catalogue::Effect;
use mocc::diagnose::hypothesis::{ChosenEffect, Hypothesis, amplitude, groups};
use mocc::diagnose::model_source::Attached;
use mocc::diagnose::policy::SearchPolicy;
use mocc::diagnose::rank::{Scored, unscored};
use mocc::diagnose::result::{Diagnosis, Verdict};
use mocc::diagnose::search::diagnose;
use mocc::diagnose::study::Study;
use mocc::driver::compile::{Request, Session};
use mocc::numeric::least_squares::NormalEquations;
use mocc::numeric::linear::DenseLu;

/// Excess of the reduced sum of squares that an inserted effect causes: the residual doubles.
const EXCESS: f64 = 3.0;
/// The same for each of two simultaneous effects.
const EXCESS_OF_EACH: f64 = 10.0;
/// Range of the reduced sum of squares that effects of random size cause, evenly distributed over its logarithm.
const RANDOM_SIZES: (f64, f64) = (2.0, 1000.0);
/// Every so many random specimens, the law is missing in the catalogue.
const HIDDEN_EVERY: u64 = 3;
/// Maximum relative difference of the parameters of a specimen from the data sheet.
const SPREAD: f64 = 0.2;

/// Signals this many times larger than those of the test stand are not physical.
const MAX_SIGNAL_RATIO: f64 = 10.0;

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let plan = match arguments.first().map(String::as_str) {
        Some("valve32") => arguments.remove(0),
        _ => "valve52".to_owned(),
    };
    let number = |k: usize| arguments.get(k).and_then(|a| a.parse().ok()).unwrap_or(20);
    let first = arguments.get(2).and_then(|a| a.parse().ok()).unwrap_or(1);
    let stand = Stand::new(&plan);
    match arguments.first().map(String::as_str) {
        Some("starts") => stand.starts(number(1)),
        Some("healthy") => stand.healthy(first, number(1)),
        Some(mode @ ("effects" | "foreign")) => {
            let wanted = arguments.get(1).map_or("", String::as_str);
            for k in 0..stand.study.effects.len() {
                if stand.study.effects[k].class.contains(wanted) {
                    stand.effect(k, mode == "foreign");
                }
            }
        }
        Some("pairs") => stand.pairs(first, number(1)),
        Some(mode @ ("random" | "random-pairs")) => {
            let wanted = arguments.get(3).map_or("", String::as_str);
            stand.random(first, number(1), if mode == "random" { 1 } else { 2 }, wanted);
        }
        _ => println!(
            "choose one of: starts N, healthy N, effects [NAME], foreign [NAME], pairs N, \
             random N, random-pairs N"
        ),
    }
}

/// The valve, its plan, and the conditions of its recordings.
struct Stand {
    study: Study,
}

impl Stand {
    fn new(name: &str) -> Stand {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/{name}.toml"));
        let mut session = Session::default();
        let text = std::fs::read_to_string(&path).expect("the plan");
        let plan = plan_file::read(&path, &text, &mut session.sources, &mut session.problems);
        let plan = plan.expect("a plan");
        let data = data::read(&plan, &mut session.problems).expect("recordings");
        let request = Request::new(Some(plan.model.clone()), None);
        let flat = session.flatten_with_inventory(&request).expect("a model");
        let policy = SearchPolicy::default();
        let study =
            Study::new(&mut session, (request, &[]), (&flat.0, flat.1), (plan, data), policy);
        Stand { study }
    }

    /// Simulated recordings of a specimen whose parameters are the start values of the plan.
    fn recorded(
        &self,
        plan: &Plan,
        attached: &[Attached<'_>],
        random: &mut Random,
    ) -> Option<Data> {
        let mut plan = plan.clone();
        for a in attached {
            if let Some(k) = a.place.signal {
                plan.signals[k].variable = format!("{}.y", a.name);
            }
        }
        let (session, program) = self.study.compile(&plan, attached, &[]).ok()?;
        let mut problems = Problems::new();
        let problem =
            Problem::new(&program, &session.sources, &plan, &self.study.data, &mut problems)?;
        let mut data = self.study.data.clone();
        for recording in &mut data.recordings {
            let exact = problem.predict(recording, &problem.start()).ok()?;
            let largest = |all: &[f64]| all.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let mut both = exact.iter().zip(&recording.signals);
            if both.any(|(e, s)| largest(e) > MAX_SIGNAL_RATIO * largest(s)) {
                return None;
            }
            for ((signal, exact), sigma) in
                recording.signals.iter_mut().zip(exact).zip(&data.sigmas)
            {
                *signal = exact.iter().map(|x| x + sigma * random.normal()).collect();
            }
        }
        Some(data)
    }

    /// The plan with parameters that differ from the data sheet.
    fn other(&self, spread: f64, random: &mut Random) -> Plan {
        let mut plan = self.study.plan.clone();
        let (session, program) = self.study.compile(&plan, &[], &[]).expect("a program");
        let mut problems = Problems::new();
        let problem =
            Problem::new(&program, &session.sources, &plan, &self.study.data, &mut problems);
        let nominal = problem.expect("a problem");
        for (free, p) in plan.free.iter_mut().zip(&nominal.parameters) {
            let value = p.start * (1.0 + spread * (2.0 * random.uniform() - 1.0));
            free.start = Some(value.max(p.bounds.0).min(p.bounds.1));
        }
        plan
    }

    fn starts(&self, count: u64) {
        let mut random = Random(1);
        let mut fine = 0;
        for k in 1..=count {
            let plan = self.other(0.5, &mut random);
            let started = Instant::now();
            let (session, program) = self.study.compile(&plan, &[], &[]).expect("a program");
            let mut problems = Problems::new();
            let problem =
                Problem::new(&program, &session.sources, &plan, &self.study.data, &mut problems);
            let mut problem = problem.expect("a problem");
            let policy = &self.study.policy.fit;
            let found = fit::fit(&mut problem, policy, &mut |_, _| true);
            let (train, validation) = match &found {
                Some(found) => quality(&problem, found),
                None => (f64::NAN, f64::NAN),
            };
            fine += u64::from(train <= 1.02 && validation <= 1.10);
            let seconds = started.elapsed().as_secs_f64();
            println!("{k:3}  train {train:8.4}  validation {validation:8.4}  {seconds:6.1} s");
        }
        println!("{fine} of {count} at the noise floor");
    }

    fn healthy(&self, first: u64, count: u64) {
        let mut alarms = 0;
        for k in first..first + count {
            let mut random = Random(100 + k);
            let plan = self.other(SPREAD, &mut random);
            let data = self.recorded(&plan, &[], &mut random).expect("recordings");
            let (found, seconds) = self.diagnosis(&data, None);
            let complete = found.as_ref().is_some_and(|f| self.verdict(f) == Verdict::Complete);
            alarms += u64::from(!complete);
            println!("{k:3}  {}  {seconds:6.1} s", self.words(found.as_ref(), None));
        }
        println!("{alarms} false alarms in {count} healthy specimens");
    }

    /// Inserts one effect; if `foreign`, the catalogue of the diagnosis lacks it.
    fn effect(&self, k: usize, foreign: bool) {
        let mut random = Random(1000 + k as u64);
        let plan = self.other(SPREAD, &mut random);
        let Some(inserted) = self.inserted(k, &plan, EXCESS) else {
            let class = &self.study.effects[k].class;
            println!("{class}: no trace in the signals beyond what the parameters absorb");
            return;
        };
        let hidden = foreign.then_some(k);
        self.report(&plan, &[inserted], hidden, &mut random);
    }

    /// Two effects of the catalogue at once.
    fn pairs(&self, first: u64, count: u64) {
        for k in first..first + count {
            let mut random = Random(5000 + k);
            let plan = self.other(SPREAD, &mut random);
            let mut both = Vec::new();
            while both.len() < 2 {
                let effect = (random.uniform() * self.study.effects.len() as f64) as usize;
                both.extend(self.inserted(effect, &plan, EXCESS_OF_EACH));
            }
            self.report(&plan, &both, None, &mut random);
        }
    }

    /// Effects of the catalogue of any size at any of their places; every third specimen with one effect has
    /// a law that the catalogue of the diagnosis lacks.
    fn random(&self, first: u64, count: u64, effects: usize, wanted: &str) {
        let mut tally = [0; OUTCOMES.len()];
        for k in first..first + count {
            let mut random = Random(9000 + 100 * effects as u64 + k);
            // The first numbers of neighbouring seeds are alike.
            for _ in 0..10 {
                random.uniform();
            }
            let plan = self.other(SPREAD, &mut random);
            let mut inserted: Vec<Inserted> = Vec::new();
            while inserted.len() < effects {
                inserted.extend(self.any(&plan, &mut random, wanted));
            }
            let is_hidden = effects == 1 && k % HIDDEN_EVERY == 0;
            let hidden = is_hidden.then_some(inserted[0].scored.effect);
            let outcome = match self.report(&plan, &inserted, hidden, &mut random) {
                Some(found) => self.outcome(&found, &inserted, hidden),
                None => continue,
            };
            println!("    {}{}", OUTCOMES[outcome], if is_hidden { ", law hidden" } else { "" });
            tally[outcome] += 1;
        }
        for (outcome, number) in OUTCOMES.iter().zip(tally) {
            println!("{number:4}  {outcome}");
        }
    }

    /// A parametric effect of random class, whose name contains what is wanted, place, shape and size.
    fn any(&self, plan: &Plan, random: &mut Random, wanted: &str) -> Option<Inserted> {
        let mut below = |n: usize| ((random.uniform() * n as f64) as usize).min(n - 1);
        let effect = below(self.study.effects.len());
        let is_wanted = self.study.effects[effect].class.contains(wanted);
        if self.study.is_curve(effect) || !is_wanted {
            return None;
        }
        let all = unscored(&self.study, &self.without_effects());
        let own: Vec<&Scored> =
            all.iter().filter(|s| s.effect == effect && s.place.others.is_empty()).collect();
        let scored = own.get(below(own.len().max(1)))?;
        let (least, most) = RANDOM_SIZES;
        let size = least * (most / least).powf(random.uniform());
        let values = self.amplitude(plan, scored, size - 1.0)?;
        Some(Inserted { scored: (*scored).clone(), values })
    }

    /// Position in [`OUTCOMES`].
    fn outcome(&self, found: &Diagnosis, inserted: &[Inserted], hidden: Option<usize>) -> usize {
        let known = self.catalogue(hidden);
        let is = |c: &ChosenEffect, one: &Inserted| {
            let effect = &self.study.effects[one.scored.effect];
            known[c.effect].name() == effect.name() && c.place.binds == one.scored.place.binds
        };
        let is_at = |c: &ChosenEffect, one: &Inserted| {
            c.place.at.iter().any(|at| one.scored.place.members().iter().any(|p| p.at.contains(at)))
        };
        let all_of = |h: &Hypothesis| {
            let named = |one| h.effects.iter().any(|c| is(c, one) && is_at(c, one));
            groups(&h.effects).count() == inserted.len() && inserted.iter().all(named)
        };
        let limit = found.after.bic() + self.study.policy.evidence;
        let is_explained = self.verdict(found) == Verdict::EffectFound;
        let at = |one| found.after.effects.iter().any(|c| is_at(c, one));
        match is_explained {
            true if all_of(&found.after) => 0,
            true if found.rejected.iter().any(|h| h.bic() < limit && all_of(h)) => 1,
            true if inserted.iter().all(at) => 2,
            true => 3,
            false => 4,
        }
    }

    /// An effect at one of its places with one of its shapes, not always the first. A place where
    /// it has no influence is skipped.
    fn inserted(&self, k: usize, plan: &Plan, excess: f64) -> Option<Inserted> {
        let all = unscored(&self.study, &self.without_effects());
        let own: Vec<&Scored> =
            all.iter().filter(|s| s.effect == k && s.place.others.is_empty()).collect();
        (0..own.len()).find_map(|i| {
            let scored = own[(5 * k + 3 + i) % own.len()];
            let values = self.amplitude(plan, scored, excess)?;
            Some(Inserted { scored: scored.clone(), values })
        })
    }

    /// Simulates recordings with these effects and reports the diagnosis.
    fn report(
        &self,
        plan: &Plan,
        inserted: &[Inserted],
        hidden: Option<usize>,
        random: &mut Random,
    ) -> Option<Diagnosis> {
        let attached: Vec<Attached<'_>> = inserted
            .iter()
            .enumerate()
            .map(|(i, one)| {
                let effect = &self.study.effects[one.scored.effect];
                attachment(effect, &one.scored, one.values.clone(), &format!("inserted_{i}"))
            })
            .collect();
        for one in inserted {
            let label = self.study.label(one.scored.effect, &one.scored.place);
            println!("{label} {:?}", one.values);
        }
        let Some(data) = self.recorded(plan, &attached, random) else {
            println!("    cannot be simulated");
            return None;
        };
        let (found, seconds) = self.diagnosis(&data, hidden);
        println!("    -> {}  {seconds:6.1} s", self.words(found.as_ref(), hidden));
        found
    }

    fn verdict(&self, diagnosis: &Diagnosis) -> Verdict {
        diagnosis.verdict(&self.study.policy)
    }

    /// The model without effects, not fitted.
    fn without_effects(&self) -> Hypothesis {
        Hypothesis {
            effects: Vec::new(),
            plan: self.study.plan.clone(),
            values: Vec::new(),
            errors: Vec::new(),
            covariance: Vec::new(),
            errors_beside_model: Vec::new(),
            fit: Fit {
                x: Vec::new(),
                normal: NormalEquations::new(0),
                iterations: 0,
                converged: true,
                beyond: None,
            },
            is_complete_fit: false,
            train: Sums::default(),
            validation: Sums::default(),
            test: Sums::default(),
        }
    }

    /// The catalogue, possibly without one effect.
    fn catalogue(&self, hidden: Option<usize>) -> Vec<Effect> {
        let known = |k: &usize| Some(*k) != hidden;
        (0..self.study.effects.len()).filter(known).map(|k| self.study.effects[k].clone()).collect()
    }

    /// Shape and amplitude that cause this excess in the linear approximation.
    fn amplitude(&self, plan: &Plan, inserted: &Scored, excess: f64) -> Option<Vec<(String, f64)>> {
        let effect = &self.study.effects[inserted.effect];
        let attached = [attachment(effect, inserted, inserted.shape.clone(), "inserted")];
        let name = &attached[0].name;
        let first = &effect.amplitudes[0].name;
        let mut more = plan.clone();
        more.free.push(amplitude(&format!("{name}.{first}"), 0.0, None, &inserted.place, name));
        let (session, program) = self.study.compile(&more, &attached, &[]).ok()?;
        let mut problems = Problems::new();
        let problem =
            Problem::new(&program, &session.sources, &more, &self.study.data, &mut problems)?;
        let normal = problem.normal(&problem.start()).ok()?;
        let size = excess * problem.count(Split::Train) as f64 / unabsorbed(&normal)?;
        let mut values = inserted.shape.clone();
        values.push((first.clone(), size.sqrt()));
        Some(values)
    }

    fn diagnosis(&self, data: &Data, hidden: Option<usize>) -> (Option<Diagnosis>, f64) {
        let started = Instant::now();
        let effects = self.catalogue(hidden);
        let study = Study { effects, data: data.clone(), ..self.study.clone() };
        let observer = Log::new(started);
        let found = diagnose(&study, &observer).ok();
        (found, started.elapsed().as_secs_f64())
    }

    fn words(&self, found: Option<&Diagnosis>, hidden: Option<usize>) -> String {
        let Some(found) = found else { return "cannot be calibrated".to_owned() };
        let known = self.catalogue(hidden);
        let effects: Vec<String> = found
            .after
            .effects
            .iter()
            .map(|c| format!("{} at {}", known[c.effect].class, c.place.at.join(", ")))
            .collect();
        format!(
            "{}  {}  train {:.3} -> {:.3}  validation {:.3} -> {:.3}",
            self.verdict(found).name(),
            effects.join(" + "),
            found.before.chi2_train(),
            found.after.chi2_train(),
            found.before.chi2_validation(),
            found.after.chi2_validation(),
        )
    }
}

/// Shows the steps of a search and limits its time if the environment asks for it.
struct Log {
    is_shown: bool,
    started: Instant,
    seconds: f64,
}

impl Log {
    fn new(started: Instant) -> Log {
        let is_shown = std::env::var_os("SPECIMENS_LOG").is_some();
        let limit = std::env::var("SPECIMENS_SECONDS").ok().and_then(|s| s.parse().ok());
        Log { is_shown, started, seconds: limit.unwrap_or(f64::INFINITY) }
    }
}

impl Observer for Log {
    fn event(&self, event: &Event<'_>) {
        if self.is_shown {
            println!("{:10.2} s  {event}", self.started.elapsed().as_secs_f64());
        }
    }

    fn is_cancelled(&self) -> bool {
        self.started.elapsed().as_secs_f64() > self.seconds
    }
}

/// How a diagnosis ends, best first.
const OUTCOMES: [&str; 5] = [
    "right",
    "right within the group that the data cannot tell apart",
    "another law at the right place",
    "another law at another place",
    "unexplained",
];

/// An effect with its place and its parameters.
struct Inserted {
    scored: Scored,
    values: Vec<(String, f64)>,
}

fn attachment<'a>(
    effect: &'a Effect,
    inserted: &'a Scored,
    values: Vec<(String, f64)>,
    name: &str,
) -> Attached<'a> {
    let place = &inserted.place;
    let name = if effect.built_in { place.at[0].clone() } else { name.to_owned() };
    Attached::new(effect, place, name, values)
}

fn quality(problem: &Problem<'_>, found: &Fit) -> (f64, f64) {
    let of = |split: Split, less: usize| {
        let sums = problem.sums(split, &found.x).unwrap_or_default();
        sums.total() / sums.count().saturating_sub(less).max(1) as f64
    };
    (of(Split::Train, found.x.len()), of(Split::Validation, 0))
}

/// Sum of squares of the last column that the others do not absorb; `None` if hardly any.
fn unabsorbed(normal: &NormalEquations) -> Option<f64> {
    let (n, p) = (normal.n, normal.n - 1);
    let entry = |i: usize, j: usize| normal.gram[i + n * j];
    let size = |i: usize| entry(i, i).sqrt().max(f64::MIN_POSITIVE);
    let mut lu = DenseLu::new(p);
    let mut matrix = vec![0.0; p * p];
    for j in 0..p {
        for i in 0..p {
            matrix[i + p * j] =
                entry(i, j) / (size(i) * size(j)) + if i == j { 1e-12 } else { 0.0 };
        }
    }
    lu.factor(&matrix).ok()?;
    let own: Vec<f64> = (0..p).map(|i| entry(i, p) / size(i)).collect();
    let mut absorbed = own.clone();
    lu.solve_in_place(&mut absorbed);
    let left = entry(p, p) - own.iter().zip(&absorbed).map(|(a, b)| a * b).sum::<f64>();
    (left > 1e-6 * entry(p, p) && left > 0.0).then_some(left)
}

/// Reproducible random numbers: a linear congruential generator.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Box and Muller's transformation.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
