//! `mocc evaluate`: judges a frozen model on recordings.

use std::sync::Arc;

use super::args::model::is_standard;
use super::args::study::Evaluate;
use super::{Status, modelica_path, plan_of, print, running, say, write_result};
use crate::calibrate::evaluate::{Request, is_model, run as evaluate};
use crate::calibrate::memory::Memory;
use crate::calibrate::run::CalibrationError;
use crate::driver::compile::Session;

/// Runs the command.
pub fn run(options: &Evaluate) -> Status {
    let request = match request(options) {
        Ok(request) => request,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let mut session = Session { parameters_vary: true, ..Session::default() };
    let evaluation = evaluate(&request, &mut session);
    say(&session);
    let evaluation = match evaluation {
        Ok(evaluation) => evaluation,
        Err(CalibrationError::Invalid(error)) => return error.into(),
        Err(CalibrationError::Failed(failure)) => {
            return running::failed(&failure, &session.sources);
        }
        Err(error) => {
            eprintln!("error: {error}");
            return Status::Usage;
        }
    };
    let mut text = evaluation.table();
    for repair in &evaluation.repairs {
        text.push_str(&format!("repaired: {repair}\n"));
    }
    match options.json.as_ref().map(|path| (path, write_result(path, evaluation.json().as_bytes())))
    {
        None => print(&text),
        Some((_, Err(why))) => {
            eprintln!("error: {why}");
            Status::Usage
        }
        Some((path, Ok(_))) if is_standard(path) => Status::Done,
        Some((_, Ok(written))) => print(&(text + &written)),
    }
}

/// The plan and the model, whichever is named first.
fn request(options: &Evaluate) -> Result<Request, String> {
    let Evaluate { subject, plan, model, data, .. } = options;
    let (plan, model) = match (is_model(subject), plan, model) {
        (false, None, _) => (subject.clone(), model.clone()),
        (false, Some(_), _) => {
            return Err(format!("`{}` is a plan; leave out `--plan`", subject.display()));
        }
        (true, Some(plan), None) => (plan.clone(), Some(subject.clone())),
        (true, None, _) => {
            let model = subject.display();
            return Err(format!("`{model}` is a model; name the plan with `--plan PLAN`"));
        }
        (true, Some(_), Some(_)) => {
            return Err("two models are named; leave out `--model`".to_owned());
        }
    };
    let (plan, text) = plan_of(&plan);
    // What the command names, the user allows.
    let fmus = options.allow_fmu.iter().chain(&model).cloned().collect();
    let memory = Arc::new(Memory { plan: text, fmus, ..Memory::default() });
    Ok(Request { plan, memory, model, data: data.clone(), modelica_path: modelica_path() })
}
