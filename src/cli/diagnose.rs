//! `mocc diagnose`: plan in, what the model lacks out.

use std::time::Instant;

use super::args::Diagnose;
use super::{Status, say};
use crate::base::diag::Problems;
use crate::calibrate::{data, plan};
use crate::diagnose::effect::catalogue;
use crate::diagnose::search::{Case, Nothing, diagnose};
use crate::driver::compile::{Request, Session};

/// Runs the command.
pub fn run(options: &Diagnose) -> Status {
    let begun = Instant::now();
    let mut session = Session::default();
    let status = examine(options, &mut session, begun);
    say(&session);
    status
}

fn examine(options: &Diagnose, session: &mut Session, begun: Instant) -> Status {
    let text = match crate::driver::files::read(&options.plan) {
        Ok(text) => text,
        Err(why) => {
            eprintln!("error: cannot read {}: {why}", options.plan.display());
            return Status::Usage;
        }
    };
    let plan = plan::read(&options.plan, &text, &mut session.sources, &mut session.problems);
    let Some(mut plan) = plan else { return Status::Usage };
    if let Some(folder) = &options.data {
        plan.folder = folder.clone();
    }
    let Some(data) = data::read(&plan, &mut session.problems) else { return Status::Usage };
    let mut folders = plan.libraries.clone();
    folders.extend(options.effects.clone());
    let request = Request {
        file: Some(plan.model.clone()),
        model: plan.name.clone(),
        appended: None,
        settings: plan.fixed.clone(),
        folders,
        modelica_path: std::env::var_os("MODELICAPATH"),
    };
    let (flat, inventory) = match session.inspect(&request) {
        Ok(found) => found,
        Err(wrong) => return wrong.into(),
    };
    let variables: Vec<String> = flat.variables.iter().map(|v| v.name.clone()).collect();
    let packages = vec!["Effects".to_owned()];
    let effects = catalogue(session, &request, &packages);
    let case = Case {
        plan: &plan,
        request,
        data: &data,
        base: flat.name.clone(),
        experiment: flat.experiment,
        effects: &effects,
        inventory: &inventory,
        variables: &variables,
    };
    // What the plan names wrongly is said before the search.
    if let Ok(program) = Session::default().compile(&case.request) {
        let mut program = program;
        crate::calibrate::problem::record_signals(&mut program, &plan);
        let mut problems = Problems::new();
        let fine = crate::calibrate::problem::Problem::new(
            &program,
            &session.sources,
            &plan,
            &data,
            &mut problems,
        );
        if fine.is_none() {
            drop(fine);
            session.problems.extend(problems);
            return Status::Usage;
        }
    }
    let found = diagnose(&case, &mut |_, cost| {
        eprintln!("  {:.1} s {cost:.1}", begun.elapsed().as_secs_f64());
        true
    });
    let found = match found {
        Ok(found) => found,
        Err(Nothing::Model(wrong)) => return wrong.into(),
        Err(Nothing::Run) => return Status::Numerics,
    };
    for ranking in &found.rankings {
        eprintln!("ranking");
        for s in ranking.iter().take(12) {
            eprintln!(
                "  {:10.1} {} {:?} {:?} {:?}",
                s.gain, effects[s.effect].class, s.place.at, s.shape, s.amplitudes
            );
        }
    }
    let show = |what: &str, l: &crate::diagnose::search::Level| {
        eprintln!("{what} train {:.4} validation {:.4}", l.chi2_train(), l.chi2_validation());
        for c in &l.chosen {
            eprintln!("   {} {:?}", effects[c.effect].class, c.place.at);
        }
        for (f, v) in l.plan.free.iter().zip(&l.values) {
            eprintln!("   {} = {v}", f.name);
        }
    };
    show("before", &found.before);
    show("after", &found.after);
    for r in &found.rejected {
        eprintln!(
            "rejected {:.4} {:.4} {:?}",
            r.chi2_train(),
            r.chi2_validation(),
            r.chosen.last().map(|c| (&effects[c.effect].class, &c.place.at))
        );
    }
    eprintln!("{:.1} s", begun.elapsed().as_secs_f64());
    Status::Done
}
