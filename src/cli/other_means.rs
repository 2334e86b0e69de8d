//! A run by other means: where the method that was chosen automatically fails on the way, another
//! method, or loops solved by the integrator, may reach the end; where the start is not found, an
//! iteration from other start values may find it.

use super::args::runs::Simulate;
use super::running;
use super::stream::Stream;
use crate::base::diag::Diagnostic;
use crate::base::source::{SourceMap, Span};
use crate::driver::compile::{Request, Session};
use crate::ir::program::{Program, SystemForm};
use crate::simulate::cause::RunCause;
use crate::simulate::failure::Failure;
use crate::simulate::method::other_methods;
use crate::simulate::run::{Statistics, simulate_to};
use crate::simulate::settings::{Method, Settings};
use crate::structure::initial::StartTearing;

/// Steps after which an explicit method gives up.
const MOST_EXPLICIT_STEPS: u64 = 300_000;

/// A run that reached its end by other means.
pub(super) struct OtherRun {
    /// Its rows.
    pub(super) stream: Stream,
    /// Its statistics, with a warning that says how it came about.
    pub(super) statistics: Statistics,
    /// The program and the session that compiled it, if it is not that of the first run.
    pub(super) compiled: Option<(Session, Program)>,
}

/// Runs the model again after a failure, if the user has chosen neither method nor mode; `None` if that
/// does not help. `begin` gives the stream of a program.
pub(super) fn run(
    options: &Simulate,
    (program, sources): (&Program, &SourceMap),
    settings: &Settings,
    failure: &Failure,
    begin: &dyn Fn(&Program) -> Option<Stream>,
) -> Option<OtherRun> {
    let is_chosen = settings.method != Method::Auto || program.foreign.is_some();
    if is_chosen || !failure.depends_on_method() {
        return None;
    }
    let again = |program: &Program, settings: &Settings, sources: &SourceMap, name| {
        let mut stream = begin(program)?;
        let mut statistics = simulate_to(program, settings, sources, &mut stream).ok()?;
        statistics.warnings.insert(0, warning(failure, name));
        Some((stream, statistics))
    };
    if failure.time <= settings.start {
        let session = Session { start_tearing: StartTearing::AtStarts, ..Session::default() };
        let (session, other) = compiled(options, session, options.running.mode.into())?;
        let (stream, statistics) =
            again(&other, settings, &session.sources, "loops at the start torn at start values")?;
        return Some(OtherRun { stream, statistics, compiled: Some((session, other)) });
    }
    for method in other_methods(program) {
        let settings = Settings { method, ..settings.clone() };
        if let Some((stream, statistics)) = again(program, &settings, sources, flag(method)) {
            return Some(OtherRun { stream, statistics, compiled: None });
        }
    }
    if SystemForm::from(options.running.mode) == SystemForm::Ode
        && let Some((session, other)) = with_loops_left(options)
        && let Some((stream, statistics)) =
            again(&other, settings, &session.sources, "`--mode dae`")
    {
        return Some(OtherRun { stream, statistics, compiled: Some((session, other)) });
    }
    if !program.algebraics.is_empty() {
        return None;
    }
    let explicit =
        Settings { method: Method::Dopri, most_steps: MOST_EXPLICIT_STEPS, ..settings.clone() };
    let (stream, statistics) = again(program, &explicit, sources, flag(Method::Dopri))?;
    Some(OtherRun { stream, statistics, compiled: None })
}

/// The program that leaves its loops to the integrator, if it has any.
fn with_loops_left(options: &Simulate) -> Option<(Session, Program)> {
    let compiled = compiled(options, Session::default(), SystemForm::Dae)?;
    (!compiled.1.algebraics.is_empty()).then_some(compiled)
}

/// The program in this form, by this session.
fn compiled(options: &Simulate, session: Session, form: SystemForm) -> Option<(Session, Program)> {
    let mut session = Session { is_last: true, ..session };
    let request = running::request(&options.model, &options.running);
    let request = Request { form, max_size: options.limits.max_size, ..request };
    let mut program = session.compile(&request).ok()?;
    running::restrict(&options.running, &mut program, None).ok()?;
    Some((session, program))
}

/// The flag that chooses a method.
fn flag(method: Method) -> &'static str {
    match method {
        Method::Auto => "`--method auto`",
        Method::Radau => "`--method radau`",
        Method::Bdf => "`--method bdf`",
        Method::Dopri => "`--method dopri`",
    }
}

fn warning(failure: &Failure, method: &'static str) -> Diagnostic {
    let message = failure.diagnostic.message.clone();
    let cause = RunCause::OtherMethod { method, failure: message };
    Diagnostic::new(cause, Span::NONE)
}
