//! `mocc calibrate`: plan in, parameters out.

use std::time::Instant;

use super::args::Calibrate;
use super::{Status, say};
use crate::base::render::render;
use crate::calibrate::data::Split;
use crate::calibrate::fit::fit;
use crate::calibrate::problem::{Problem, record_signals};
use crate::calibrate::{data, plan};
use crate::driver::compile::{Request, Session};

/// Runs the command.
pub fn run(options: &Calibrate) -> Status {
    let mut session = Session::default();
    let status = calibrate(options, &mut session);
    say(&session);
    status
}

fn calibrate(options: &Calibrate, session: &mut Session) -> Status {
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
    let request = Request {
        file: Some(plan.model.clone()),
        model: plan.name.clone(),
        settings: plan.fixed.clone(),
        folders: plan.libraries.clone(),
        modelica_path: std::env::var_os("MODELICAPATH"),
    };
    let mut program = match session.compile(&request) {
        Ok(program) => program,
        Err(wrong) => return wrong.into(),
    };
    record_signals(&mut program, &plan);
    let problem = Problem::new(&program, &session.sources, &plan, &data, &mut session.problems);
    let Some(mut problem) = problem else { return Status::Usage };
    let begun = Instant::now();
    if let Err(f) = problem.sums(Split::Train, &problem.start()) {
        eprintln!("{}", render(&f.diagnostic, &session.sources, super::style()));
        return Status::Numerics;
    }
    eprintln!("sums {:?}", begun.elapsed());
    let begun = Instant::now();
    let _ = problem.normal(&problem.start());
    eprintln!("normal {:?}", begun.elapsed());
    let begun = Instant::now();
    let found = fit(&mut problem, &mut |i, cost| {
        eprintln!("{i} {:.6}", cost / 48000.0);
        true
    });
    let Some(found) = found else { return Status::Numerics };
    eprintln!("{:?} {} {}", begun.elapsed(), found.iterations, found.converged);
    for split in Split::ALL {
        let Ok(sums) = problem.sums(split, &found.x) else { continue };
        eprintln!("{} {}", split.name(), sums.total() / sums.count() as f64);
    }
    for (p, v) in problem.parameters.iter().zip(problem.values(&found.x)) {
        eprintln!("{} = {v} {}", p.name, p.unit);
    }
    Status::Done
}
