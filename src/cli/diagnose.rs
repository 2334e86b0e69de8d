//! `mocc diagnose`: plan in, what the model lacks out.

use std::time::Instant;

use super::args::Diagnose;
use super::calibrate::{failing, inputs, status_of};
use super::progress::Working;
use super::{Status, interrupt, print, say};
use crate::base::diag::Problems;
use crate::base::render::render;
use crate::calibrate::problem::{Problem, record_signals};
use crate::diagnose::case::{Case, Nothing};
use crate::diagnose::effect::{catalogue, unknowns};
use crate::diagnose::search::diagnose;
use crate::diagnose::{balance, page, residual, result};
use crate::driver::compile::{Request, Session};
use crate::io::atomic_file::{create_folder, write_file};
use crate::io::csv::write_csv;
use crate::ir::program::SystemForm;

/// Runs the command.
pub fn run(options: &Diagnose) -> Status {
    let begun = Instant::now();
    let mut session = Session::default();
    let status = examine(options, &mut session, begun);
    say(&session);
    status
}

fn examine(options: &Diagnose, session: &mut Session, begun: Instant) -> Status {
    let inputs = inputs(&options.plan, options.data.as_deref(), session);
    let Some((plan, data)) = inputs else { return Status::Usage };
    let mut folders = plan.libraries.clone();
    folders.extend(options.effects.clone());
    let request = Request {
        file: Some(plan.model.clone()),
        model: plan.name.clone(),
        appended: None,
        form: SystemForm::Ode,
        settings: plan.fixed.clone(),
        recorded: plan.recorded(),
        folders,
        modelica_path: std::env::var_os("MODELICAPATH"),
    };
    let (flat, inventory) = match session.inspect(&request) {
        Ok(found) => found,
        Err(wrong) => return wrong.into(),
    };
    let variables: Vec<String> = flat.variables.iter().map(|v| v.name.clone()).collect();
    let mut packages = vec!["Effects".to_owned()];
    if options.effects.is_some() {
        packages.push(String::new());
    }
    let units: Vec<(String, String)> =
        flat.variables.iter().map(|v| (v.name.clone(), v.unit.to_string())).collect();
    let effects = catalogue(session, &request, &packages, &inventory, &units);
    let case = Case {
        plan: &plan,
        request,
        data: &data,
        base: flat.name.clone(),
        experiment: flat.experiment,
        effects: &effects,
        inventory: &inventory,
        variables: &variables,
        say: &|text| {
            if options.verbose {
                eprintln!("{:7.2} s  {text}", begun.elapsed().as_secs_f64());
            }
        },
    };
    // What the plan names wrongly, and what can not be run, is said before the search.
    let mut trial = Session::default();
    if let Ok(mut program) = trial.compile(&case.request) {
        record_signals(&mut program, &plan);
        let mut problems = Problems::new();
        let problem = Problem::new(&program, &trial.sources, &plan, &data, &mut problems);
        let failure = problem.as_ref().map(failing);
        drop(problem);
        match failure {
            None => {
                session.problems.extend(problems);
                return Status::Usage;
            }
            Some(Some(failure)) => {
                eprintln!("{}", render(&failure.diagnostic, &trial.sources, super::style()));
                return status_of(&failure);
            }
            Some(None) => {}
        }
    }
    // From here on an end is asked for, not forced: what was found is to be written.
    interrupt::listen();
    let folder = options.out.clone().unwrap_or_else(|| {
        let stem = options.plan.file_stem().map(|s| s.to_string_lossy().into_owned());
        format!("{}-diagnosis", stem.unwrap_or_default()).into()
    });
    if let Err(why) = create_folder(&folder) {
        eprintln!("error: {why}");
        return Status::Usage;
    }
    let found = {
        let _working = Working::new();
        diagnose(&case, &mut |_, _| !interrupt::asked())
    };
    let complete = !interrupt::asked();
    let found = match found {
        Ok(found) => found,
        Err(Nothing::Model(wrong)) => return wrong.into(),
        Err(Nothing::Run) => {
            eprintln!(
                "error: the model cannot be simulated under the conditions of the recordings"
            );
            return Status::Numerics;
        }
    };
    let (mut balances, mut law) = (Vec::new(), Vec::new());
    if complete && result::verdict(&found) != result::Verdict::Complete {
        let unknowns = unknowns(session, &case.request, &packages);
        balances = balance::balances(&case, &unknowns, &found.before);
        law = balance::law(&case, &found.after);
        (case.say)(&format!("{} balances examined", balances.len()));
    }
    let original = match crate::driver::files::read(&plan.model) {
        Ok(text) => text,
        Err(why) => {
            eprintln!("error: cannot read {}: {why}", plan.model.display());
            return Status::Usage;
        }
    };
    let amended = result::amended(&case, &found, &original);
    let mut written = Vec::new();
    let name = amended.as_ref().map(|(name, _)| format!("{name}.mol"));
    let seconds = begun.elapsed().as_secs_f64();
    let mut files = vec![(
        "diagnosis.json".to_owned(),
        result::json(&case, &found, &balances, name.as_deref(), seconds, complete),
    )];
    if let (Some(name), Some((_, text))) = (&name, &amended) {
        files.push((name.clone(), text.clone()));
    }
    let page = page::html(&case, &found, (&balances, &law), &original, amended.as_ref());
    files.push(("diagnosis.html".to_owned(), page));
    for (name, text) in files {
        let path = folder.join(name);
        if let Err(why) = write_file(&path, text.as_bytes()) {
            eprintln!("error: {why}");
            return Status::Usage;
        }
        written.push(path);
    }
    if options.tables && complete {
        for (k, table) in residual::tables(&case, &found).iter().enumerate() {
            let path = folder.join(format!("recording-{}.csv", k + 1));
            if let Err(why) = write_csv(table, &path) {
                eprintln!("error: {why}");
                return Status::Usage;
            }
            written.push(path);
        }
    }
    let mut text = page::summary(&case, &found, seconds);
    let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
    text.push_str(&format!("wrote {}\n", names.join(", ")));
    match print(&text) {
        Status::Done if !complete => Status::Interrupted,
        status => status,
    }
}
