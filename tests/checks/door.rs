//! The one door of the tests in process: from a text or file to a trajectory.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mocc::base::diag::{Diagnostic, Severity};
use mocc::base::render::{Style, render, render_all};
use mocc::driver::compile::{Request, Session};
use mocc::ir::program::{Program, SystemForm};
use mocc::ir::trajectory::{Column, Event, Trajectory, position};
use mocc::numeric::time_series::TimeSeries;
use mocc::runtime::jit::tiering::Execution;
use mocc::simulate::record::Sink;
use mocc::simulate::run::{simulate, simulate_with_sensitivities};
use mocc::simulate::sensitivity::Input;
use mocc::simulate::settings::{Method, Settings};

/// A model on its way to a run.
pub struct Case {
    request: Request,
    stop: Option<f64>,
    interval: Option<f64>,
    tolerance: Option<f64>,
    /// Holds the file of a text until the case is done with.
    _scratch: Option<Scratch>,
}

impl Case {
    /// A file, by its path from the root of the repository.
    pub fn file(path: impl AsRef<Path>) -> Case {
        // Tests run in the root, and messages show the path as given.
        let request = Request { file: Some(path.as_ref().into()), ..Request::default() };
        Case { request, stop: None, interval: None, tolerance: None, _scratch: None }
    }
    /// A text; the last model of it is meant.
    pub fn text(text: &str) -> Case {
        let scratch = Scratch::new();
        let file = scratch.file("model.mo", text);
        Case { _scratch: Some(scratch), ..Case::file(file) }
    }
    /// A case of the suite by its `stage/topic/case`.
    pub fn suite(name: &str) -> Case {
        Case::text(&suite_model(name))
    }
    /// An example by its path, or a case of the suite.
    pub fn named(name: &str) -> Case {
        if name.starts_with("examples/") { Case::file(name) } else { Case::suite(name) }
    }
    /// A model of the file by its full name, instead of the last.
    pub fn model(mut self, name: impl Into<String>) -> Case {
        self.request.model = Some(name.into());
        self
    }
    /// `NAME=VALUE`, as with `--set`.
    pub fn set(mut self, setting: impl Into<String>) -> Case {
        self.request.settings.push(setting.into());
        self
    }
    /// Who solves algebraic loops.
    pub fn form(mut self, form: SystemForm) -> Case {
        self.request.form = form;
        self
    }
    /// Another end than the annotation's.
    pub fn stop(mut self, stop: f64) -> Case {
        self.stop = Some(stop);
        self
    }
    /// Another distance of rows than the annotation's.
    pub fn interval(mut self, interval: f64) -> Case {
        self.interval = Some(interval);
        self
    }
    /// Another tolerance than the annotation's.
    pub fn tolerance(mut self, tolerance: f64) -> Case {
        self.tolerance = Some(tolerance);
        self
    }
    /// With code for derivatives by these parameters.
    pub fn differentiated(mut self, by: &[&str]) -> Case {
        self.request.differentiated = by.iter().map(|name| name.to_string()).collect();
        self
    }
    /// The compiled model; panics with what the compiler says about it.
    pub fn compile(&self) -> Compiled {
        let mut session = Session::default();
        let program = match session.compile(&self.request) {
            Ok(program) => program,
            Err(_) => panic!("{}", said(&session)),
        };
        let mut settings = Settings::of(&program.blocks.dae.experiment);
        if let Some(stop) = self.stop {
            settings.stop = stop;
            if program.blocks.dae.experiment.interval.is_none() {
                settings.interval = (stop - settings.start) / 500.0;
            }
        }
        settings.interval = self.interval.unwrap_or(settings.interval);
        settings.tolerance = self.tolerance.unwrap_or(settings.tolerance);
        Compiled { session, program, settings }
    }
    /// The same, with inputs that follow recordings.
    pub fn compile_driven(&self, courses: &[(&str, TimeSeries)]) -> Compiled {
        let mut session = Session::default();
        let Ok((program, _)) = session.compile_with_ports(&self.request) else {
            panic!("{}", said(&session));
        };
        let settings = Settings { tolerance: 1e-9, ..Settings::of(&program.blocks.dae.experiment) };
        let mut compiled = Compiled { session, program, settings };
        for (name, series) in courses {
            let variables = &compiled.program.blocks.dae.variables;
            let (id, _) = variables.enumerate().find(|(_, v)| v.name == *name).expect(name);
            compiled.settings.courses.push((id, Arc::new(series.clone())));
        }
        compiled
    }
    /// The trajectory; panics with what the compiler or the run says.
    pub fn run(&self) -> Trajectory {
        self.compile().run()
    }
    /// The trajectory, or the codes of the errors of the compiler or the run.
    pub fn outcome(&self) -> Result<Trajectory, Vec<&'static str>> {
        let mut session = Session::default();
        let Ok(program) = session.compile(&self.request) else {
            let errors = session.problems.iter().filter(|d| d.severity == Severity::Error);
            let mut codes: Vec<_> = errors.map(|d| d.code).collect();
            codes.sort_unstable();
            codes.dedup();
            return Err(codes);
        };
        let settings = Settings::of(&program.blocks.dae.experiment);
        let run = simulate(&program, &settings, &session.sources);
        run.map(|run| run.trajectory).map_err(|failure| vec![failure.diagnostic.code])
    }
    /// The flat model as text.
    pub fn flat(&self) -> String {
        let mut session = Session::default();
        match session.flatten(&self.request) {
            Ok(flat) => mocc::flatten::print::print(&flat).expect("the text is not too long"),
            Err(_) => panic!("{}", said(&session)),
        }
    }
    /// States, blocks and what was differentiated, as text.
    pub fn structure(&self) -> String {
        let mut session = Session::default();
        match session.flatten(&self.request).and_then(|flat| session.sort(flat)) {
            Ok(blocks) => mocc::structure::print::print(&blocks, &session.sources),
            Err(_) => panic!("{}", said(&session)),
        }
    }
}

/// A compiled model with the settings of its next run.
pub struct Compiled {
    session: Session,
    pub program: Program,
    settings: Settings,
}

/// A run with the derivatives of every value by some inputs.
#[derive(Default)]
pub struct Differentiated {
    pub trajectory: Trajectory,
    inputs: usize,
    slopes: Vec<Vec<f64>>,
}

impl Differentiated {
    /// The derivatives of a column by an input, row by row.
    pub fn by(&self, input: usize, column: &str) -> Vec<f64> {
        let k = position(&self.trajectory.columns, column).expect(column);
        self.slopes.iter().map(|row| row[k * self.inputs + input]).collect()
    }
}

impl Sink for Differentiated {
    fn begin(&mut self, columns: Vec<Column>) {
        self.trajectory.begin(columns);
    }
    fn row(&mut self, time: f64, values: &[f64]) {
        self.trajectory.row(time, values);
    }
    fn slopes(&mut self, slopes: &[f64]) {
        self.slopes.push(slopes.to_vec());
    }
    fn event(&mut self, event: Event) {
        self.trajectory.event(event);
    }
}

impl Compiled {
    /// The trajectory with its derivatives by parameters and, written `start(x)`, by start values.
    pub fn differentiate(&self, inputs: &[&str]) -> Differentiated {
        let input = |name: &&str| {
            let start = name.strip_prefix("start(").and_then(|n| n.strip_suffix(')'));
            let wanted = start.unwrap_or(name);
            let variables = &self.program.blocks.dae.variables;
            let (id, _) = variables.enumerate().find(|(_, v)| v.name == wanted).expect(wanted);
            if start.is_some() { Input::Start(id) } else { Input::Parameter(id) }
        };
        let inputs: Vec<Input> = inputs.iter().map(input).collect();
        let mut sink = Differentiated { inputs: inputs.len(), ..Differentiated::default() };
        let sources = &self.session.sources;
        let outcome =
            simulate_with_sensitivities(&self.program, &self.settings, &inputs, sources, &mut sink);
        if let Err(failure) = outcome {
            panic!("{}", render(&failure.diagnostic, sources, Style::Plain));
        }
        assert_eq!(sink.slopes.len(), sink.trajectory.rows());
        sink
    }
    /// Gives a parameter another value for the next runs.
    pub fn set(&mut self, name: &str, value: f64) {
        let variables = &self.program.blocks.dae.variables;
        let (id, _) = variables.enumerate().find(|(_, v)| v.name == name).expect(name);
        self.settings.parameters.retain(|(other, _)| *other != id);
        self.settings.parameters.push((id, value));
    }
    /// The integrator of the next runs.
    pub fn method(&mut self, method: Method) {
        self.settings.method = method;
    }
    /// How the next runs compute.
    pub fn execute(&mut self, execution: Execution) {
        self.settings.execution = execution;
    }
    /// The trajectory; panics with the failure.
    pub fn run(&self) -> Trajectory {
        self.run_with_warnings().0
    }
    /// The message of a run that fails.
    pub fn fails(&self) -> String {
        match simulate(&self.program, &self.settings, &self.session.sources) {
            Ok(_) => panic!("the run does not fail"),
            Err(failure) => render(&failure.diagnostic, &self.session.sources, Style::Plain),
        }
    }
    /// The trajectory, and what was warned of on the way.
    pub fn run_with_warnings(&self) -> (Trajectory, Vec<Diagnostic>) {
        match simulate(&self.program, &self.settings, &self.session.sources) {
            Ok(run) => {
                run.trajectory.verify().expect("a trajectory in order");
                (run.trajectory, run.statistics.warnings)
            }
            Err(failure) => {
                panic!("{}", render(&failure.diagnostic, &self.session.sources, Style::Plain))
            }
        }
    }
}

fn said(session: &Session) -> String {
    render_all(&session.problems, &session.sources, Style::Plain)
}

/// A new empty folder below the build folder, gone when this is dropped.
pub struct Scratch(PathBuf);

impl Scratch {
    /// The folder.
    pub fn new() -> Scratch {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("mocc-{}-{number}", std::process::id());
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&folder).expect("the build folder can be written to");
        Scratch(folder)
    }
    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
    /// Writes a file into it, with the folders it needs; its path.
    pub fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a writable folder");
        std::fs::write(&path, text).expect("a writable folder");
        path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A text of this repository, by its path from the root.
pub fn text_of(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect(path)
}

/// The model of a case of the suite, by its `stage/topic/case`.
pub fn suite_model(name: &str) -> String {
    let mut parts = name.split('/');
    let [stage, topic, case] = [(); 3].map(|()| parts.next().expect("stage/topic/case"));
    let cases = super::suite::case::read(stage, topic).unwrap_or_else(|why| panic!("{why}"));
    let found = cases.into_iter().find(|c| c.name == case);
    found.unwrap_or_else(|| panic!("there is no case `{name}`")).model
}

/// What tests read from a trajectory. Names that are not there panic.
pub trait Reading {
    /// All values of a column.
    fn of(&self, name: &str) -> &[f64];
    /// The value in the first row.
    fn first(&self, name: &str) -> f64;
    /// The value in the last row.
    fn last(&self, name: &str) -> f64;
    /// The value in the last row at or before a time.
    fn at(&self, name: &str, time: f64) -> f64;
    /// Times of the events that contain this text.
    fn times_of(&self, what: &str) -> Vec<f64>;
}

impl Reading for Trajectory {
    fn of(&self, name: &str) -> &[f64] {
        self.values(name).unwrap_or_else(|| panic!("no column `{name}`"))
    }
    fn first(&self, name: &str) -> f64 {
        self.of(name)[0]
    }
    fn last(&self, name: &str) -> f64 {
        *self.of(name).last().expect("rows")
    }
    fn at(&self, name: &str, time: f64) -> f64 {
        let after = self.time.partition_point(|t| *t <= time * (1.0 + 1e-12));
        self.of(name)[after - 1]
    }
    fn times_of(&self, what: &str) -> Vec<f64> {
        self.events.iter().filter(|e| e.what.contains(what)).map(|e| e.time).collect()
    }
}

/// Whether two numbers agree to a relative tolerance, or absolutely below 1.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let scale = expected.abs().max(f64::MIN_POSITIVE);
    assert!((found - expected).abs() <= tolerance * scale, "{found} instead of {expected}");
}
