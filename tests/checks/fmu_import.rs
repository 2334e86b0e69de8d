//! FMUs as models. The loops that drive them run here against an FMU of mocc in this process, and are compared with
//! closed forms; what reads archives is run as a user runs it. The way through a child process and foreign FMUs are
//! tested by `tests/fmu/check.py`, and here too where the runtime of FMUs has been built.

use std::fmt;
use std::io::Read;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use mocc::base::diag::Diagnostic;
use mocc::base::source::Span;
use mocc::driver::compile::{Request, Session};
use mocc::driver::ports::Exportable;
use mocc::fmu::archive::pack;
use mocc::fmu::cause::FmuCause;
use mocc::fmu::disclosure::disclosed;
use mocc::fmu::exchange::count_indicators;
use mocc::fmu::instance::{Instance, Kind};
use mocc::fmu::interface::{Role, Start, scalars};
use mocc::fmu::package;
use mocc::ir::expr::Type;
use mocc::ir::foreign::{
    AfterEvent, AfterStep, At, Foreign, ForeignFailure, ForeignFault, ForeignFaultKind,
    ForeignInstance, ForeignInterface, ForeignModel, ForeignObserver, ForeignOutcome, ForeignRole,
    ForeignTask, ForeignType, ForeignVariable, InstanceFault, Obstacle,
};
use mocc::ir::program::Program;
use mocc::simulate::foreign::carry_out;
use mocc::simulate::run::{Run, simulate};
use mocc::simulate::settings::Settings;
use mocc::simulate::stepping::Arrival;

use super::door::Scratch;
use super::program::{Ended, fmu_runtime, mocc};

// ---- The loops, with an FMU in this process ----

/// An FMU of mocc without its archive. Values are numbered as its variables.
struct Local {
    program: &'static Program,
    interface: ForeignInterface,
    references: Vec<u32>,
}

impl fmt::Debug for Local {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Local")
    }
}

struct Here {
    instance: Instance<'static>,
    references: Vec<u32>,
    watched: Vec<usize>,
}

/// Why a call failed.
#[derive(Debug)]
struct CallFault(String);

impl InstanceFault for CallFault {
    fn is_avoidable(&self) -> bool {
        false
    }
}

fn fault<T, E: fmt::Debug>(outcome: Result<T, E>) -> Result<T, CallFault> {
    outcome.map_err(|why| CallFault(format!("{why:?}")))
}

impl ForeignModel for Local {
    fn file(&self) -> &str {
        "local.fmu"
    }
    fn interface(&self) -> &ForeignInterface {
        &self.interface
    }
    fn run(
        &self,
        task: &ForeignTask,
        observer: &mut dyn ForeignObserver,
    ) -> Result<ForeignOutcome, ForeignFailure> {
        let kind = match self.interface.steps_itself {
            true => Kind::Stepping { events: false },
            false => Kind::Exchange,
        };
        let instance = Instance::new(self.program, kind);
        let watched = task.watched.iter().map(|(value, _)| *value).collect();
        let mut here = Here { instance, references: self.references.clone(), watched };
        let outcome = carry_out(&self.interface.shape(), &mut here, task, observer);
        outcome.map_err(|(time, why)| ForeignFailure {
            time,
            why: match why {
                Obstacle::Stop(stop) => Obstacle::Stop(stop),
                Obstacle::Fault(CallFault(status)) => {
                    let (path, call) = ("local".to_owned(), "a call".to_owned());
                    let cause = FmuCause::FailedCall { path, call, status };
                    let diagnostic = Box::new(Diagnostic::new(cause, Span::NONE));
                    Obstacle::Fault(ForeignFault { kind: ForeignFaultKind::Final, diagnostic })
                }
            },
        })
    }
}

impl Here {
    fn put(&mut self, values: &[(usize, f64)]) -> Result<(), CallFault> {
        values.iter().try_for_each(|(v, x)| fault(self.instance.set(self.references[*v], *x)))
    }

    fn place(&mut self, at: &At<'_>) -> Result<(), CallFault> {
        let exchange = fault(self.instance.exchange())?;
        exchange.set_time(at.t);
        exchange.set_states(at.states);
        self.put(at.inputs)
    }

    fn updated(&mut self) -> Result<AfterEvent, CallFault> {
        let updated = fault(self.instance.update())?;
        fault(self.instance.enter_continuous_mode())?;
        let exchange = fault(self.instance.exchange())?;
        let states = exchange.states().to_vec();
        let mut indicators = vec![0.0; exchange.count_indicators()];
        fault(exchange.indicators(&mut indicators))?;
        Ok(AfterEvent {
            nominals: vec![1.0; states.len()],
            states,
            indicators,
            next: updated.next_time,
            ends: updated.terminated.is_some(),
        })
    }
}

impl ForeignInstance for Here {
    type Fault = CallFault;

    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<AfterEvent, CallFault> {
        self.put(values)?;
        fault(self.instance.set_up(Some(tolerance), span[0], Some(span[1])))?;
        fault(self.instance.enter_initialization())?;
        fault(self.instance.exit_initialization())?;
        if self.instance.exchange().is_err() {
            return Ok(AfterEvent::default());
        }
        self.updated()
    }
    fn evaluate(
        &mut self,
        at: &At<'_>,
        derivatives: &mut [f64],
        indicators: &mut [f64],
    ) -> Result<(), CallFault> {
        self.place(at)?;
        let exchange = fault(self.instance.exchange())?;
        fault(exchange.derivatives(&mut derivatives[..at.states.len()]))?;
        fault(exchange.indicators(indicators))
    }
    fn jacobian(&mut self, at: &At<'_>, entries: &mut [f64]) -> Result<(), CallFault> {
        let n = at.states.len();
        let (mut base, mut moved, mut x) = (vec![0.0; n], vec![0.0; n], at.states.to_vec());
        self.evaluate(at, &mut base, &mut [])?;
        for j in 0..n {
            x[j] += 1e-7;
            self.evaluate(&At { states: &x, ..*at }, &mut moved, &mut [])?;
            x[j] = at.states[j];
            for i in 0..n {
                entries[i + n * j] = (moved[i] - base[i]) / 1e-7;
            }
        }
        Ok(())
    }
    fn values(&mut self, at: Option<&At<'_>>, values: &mut [f64]) -> Result<(), CallFault> {
        at.map_or(Ok(()), |at| self.place(at))?;
        for (value, v) in values.iter_mut().zip(&self.watched) {
            *value = fault(self.instance.get(self.references[*v]))?;
        }
        Ok(())
    }
    fn complete(&mut self, at: &At<'_>) -> Result<AfterStep, CallFault> {
        self.place(at)?;
        let asks_for_event = fault(self.instance.complete_step())?;
        Ok(AfterStep { reached: at.t, asks_for_event, ends: false })
    }
    fn event(&mut self, at: &At<'_>) -> Result<AfterEvent, CallFault> {
        self.place(at)?;
        fault(self.instance.enter_event_mode())?;
        self.updated()
    }
    fn step(&mut self, t: f64, size: f64, inputs: &[(usize, f64)]) -> Result<AfterStep, CallFault> {
        self.put(inputs)?;
        let (reached, ends) = match fault(self.instance.step(t, size))? {
            Arrival::Reached => (t + size, false),
            Arrival::EventDue(at) => (at, false),
            Arrival::Ended(at) => (at, true),
        };
        Ok(AfterStep { reached, ends, ..AfterStep::default() })
    }
}

/// The program that stands for a model as an FMU.
fn imported(text: &str, steps_itself: bool) -> Program {
    let request = Request {
        file: Some("model.mo".into()),
        text: Some(text.to_owned()),
        ..Request::default()
    };
    let made = Session::default().compile_for_export(&request).expect("compiles");
    let Exportable { program: own, causalities, .. } = made;
    let bytes = package::write(&disclosed(&own, false), "token");
    let program = package::read(&bytes, "token").expect("reads");
    let all = scalars(&own, &causalities);
    let experiment = &own.blocks.dae.experiment;
    let variable = |(value, s): (usize, &mocc::fmu::interface::Scalar)| ForeignVariable {
        name: s.name.clone(),
        role: match s.role {
            Role::Input => ForeignRole::Input,
            Role::Parameter => ForeignRole::Parameter,
            _ => ForeignRole::Computed,
        },
        ty: match s.ty {
            Type::Boolean => ForeignType::Boolean,
            Type::Real => ForeignType::Real,
            _ => ForeignType::Integer,
        },
        value,
        start: match s.start {
            Some(Start::Number(x)) => Some(x),
            _ => None,
        },
        is_tunable: false,
        may_be_set: matches!(s.role, Role::Parameter | Role::Input),
        unit: String::new(),
        display_unit: String::new(),
        description: String::new(),
        range: (None, None),
    };
    let interface = ForeignInterface {
        name: "Imported".to_owned(),
        steps_itself,
        states: if steps_itself { 0 } else { own.blocks.states.len() },
        indicators: if steps_itself { 0 } else { count_indicators(&own) },
        variables: all.iter().enumerate().map(variable).collect(),
        values: all.len(),
        needs_completed_steps: true,
        steps_vary: true,
        experiment: [experiment.start, experiment.stop, experiment.interval, None],
        ..ForeignInterface::default()
    };
    let references = all.iter().map(|s| s.reference).collect();
    let stand_in = mocc::fmu::import::text::model(&interface);
    let local = Local { program: Box::leak(Box::new(program)), interface, references };
    let request = Request { text: Some(stand_in), ..request };
    let mut session = Session { foreign: Some(Arc::new(local)), ..Session::default() };
    let program = session.compile(&request).expect("compiles");
    let foreign: &Foreign = program.foreign.as_deref().expect("an FMU");
    assert!(!foreign.variables.is_empty());
    program
}

fn run(program: &Program, change: impl FnOnce(&mut Settings)) -> Run {
    let mut settings = Settings::of(&program.blocks.dae.experiment);
    change(&mut settings);
    simulate(program, &settings, &Session::default().sources).expect("runs")
}

const BALL: &str = "model Ball
  parameter Real e = 0.5;
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -9.81;
  when h <= 0 then
    reinit(v, -e*pre(v));
  end when;
  annotation(experiment(StopTime = 1));
end Ball;";

/// Between bounces the ball flies on a parabola.
#[test]
fn bounces_are_found_where_they_are() {
    let program = imported(BALL, false);
    let found = run(&program, |_| {});
    let (g, t1) = (9.81, (2.0_f64 / 9.81).sqrt());
    let t2 = t1 + 2.0 * 0.5 * t1;
    let hits: Vec<f64> = found.trajectory.events.iter().map(|e| e.time).collect();
    assert!(hits.iter().any(|t| (t - t1).abs() < 1e-9), "{hits:?} without {t1}");
    assert!(hits.iter().any(|t| (t - t2).abs() < 1e-9), "{hits:?} without {t2}");
    let h = found.trajectory.values("h").expect("rows");
    for (t, h) in found.trajectory.time.iter().zip(h) {
        let expected = match t {
            t if *t <= t1 => 1.0 - 0.5 * g * t * t,
            t if *t <= t2 => 0.5 * g * t1 * (t - t1) - 0.5 * g * (t - t1).powi(2),
            _ => continue,
        };
        assert!((h - expected).abs() < 1e-7, "at {t} s {h} instead of {expected}");
    }
}

/// A parameter of the stand-in reaches the FMU.
#[test]
fn parameters_reach_the_fmu() {
    let program = imported(BALL, false);
    let variables = &program.blocks.dae.variables;
    let e = variables.enumerate().find(|(_, v)| v.name == "e").expect("a parameter").0;
    let found = run(&program, |settings| settings.parameters.push((e, 0.0)));
    let v = found.trajectory.values("v").expect("rows");
    let after = found.trajectory.time.iter().zip(v).find(|(t, _)| **t > 0.46).expect("a row");
    let t1 = (2.0_f64 / 9.81).sqrt();
    assert!((after.1 + 9.81 * (after.0 - t1)).abs() < 1e-6, "{after:?}");
}

/// Both kinds of simulation meet the exponential, with time events on the way.
#[test]
fn both_kinds_meet_a_closed_form() {
    let text = "model M
      discrete Real s(start = 0, fixed = true);
      Real x(start = 1, fixed = true);
    equation
      when sample(0.25, 0.25) then
        s = pre(s) + 1;
      end when;
      der(x) = s - x;
      annotation(experiment(StopTime = 0.5, Interval = 0.01));
    end M;";
    // x = e^-t until the first tick, then towards 1.
    let expected = |t: f64| match t {
        t if t <= 0.25 => (-t).exp(),
        t => 1.0 + ((-0.25_f64).exp() - 1.0) * (0.25 - t).exp(),
    };
    for steps_itself in [false, true] {
        let program = imported(text, steps_itself);
        let found = run(&program, |_| {});
        assert!(found.trajectory.rows() > 50, "{}", found.trajectory.rows());
        let x = found.trajectory.values("x").expect("rows");
        for (t, x) in found.trajectory.time.iter().zip(x).filter(|(t, _)| **t < 0.5) {
            let expected = expected(*t);
            assert!((x - expected).abs() < 1e-5, "at {t} s {x} instead of {expected}");
        }
    }
}

// ---- Archives, as a user meets them ----

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Ball" guid="g" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="Ball"/>
  <ModelVariables/>
  <ModelStructure/>
</fmiModelDescription>"#;

/// Runs an archive with these files; the code of the error.
fn refused(files: &[(&str, &str)], cut: usize, arguments: &[&str]) -> (String, Ended) {
    let folder = Scratch::new();
    let files: Vec<(String, &[u8])> =
        files.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes())).collect();
    let mut bytes = pack(&files).expect("packs");
    bytes.truncate(bytes.len() - cut);
    std::fs::write(folder.path().join("ball.fmu"), bytes).expect("writes");
    let mut words = vec!["simulate", "ball.fmu", "--output", "out.csv"];
    words.extend(arguments);
    let ended = mocc(folder.path(), &words);
    assert!(!folder.path().join("out.csv").exists(), "no results");
    let code = ended.err.split(['[', ']']).nth(1).unwrap_or_default().to_owned();
    (code, ended)
}

#[test]
fn bad_archives_are_refused_with_a_diagnostic_each() {
    let good = ("modelDescription.xml", DESCRIPTION);
    let other = ("binaries/win64/Ball.dll", "");
    let fake = ("binaries/linux64/Ball.so", "not a library");
    let bomb = "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]><fmiModelDescription/>";
    let first = DESCRIPTION.replace("2.0", "1.0");
    let cases: [(&str, &[(&str, &str)], usize, &[&str]); 8] = [
        ("MO1305", &[good], 40, &[]),
        ("MO1306", &[good, ("../../evil.so", "")], 0, &[]),
        ("MO1308", &[("modelDescription.xml", bomb)], 0, &[]),
        ("MO1308", &[("modelDescription.xml", "<fmiModelDescription")], 0, &[]),
        ("MO1309", &[("modelDescription.xml", &first)], 0, &[]),
        ("MO1310", &[good, other], 0, &[]),
        ("MO1311", &[good, fake], 0, &["--fmi-type", "cs"]),
        ("MO1312", &[good, fake], 0, &[]),
    ];
    for (code, files, cut, arguments) in cases {
        let (found, ended) = refused(files, cut, arguments);
        assert_eq!(found, code, "{}", ended.err);
        assert_eq!(ended.status, 2, "{code}: {}", ended.err);
        assert!(ended.err.contains("ball.fmu"), "{}", ended.err);
    }
    let (_, ended) = refused(&[good, other], 0, &[]);
    assert!(ended.err.contains("`win64`"), "the platforms that there are: {}", ended.err);
}

/// With the runtime of FMUs, the whole way: export, child process, both kinds, both versions.
#[test]
fn an_exported_model_comes_back() {
    let Some(runtime) = fmu_runtime() else { return };
    let folder = Scratch::new();
    folder.file("ball.mo", BALL);
    for version in ["2", "3"] {
        let runtime = runtime.display().to_string();
        let words = ["export", "fmu", "ball.mo", "--fmi", version, "--runtime", &runtime];
        let ended = mocc(folder.path(), &[&words[..], &["-o", "ball.fmu"]].concat());
        assert_eq!(ended.status, 0, "{}", ended.err);
        for kind in ["me", "cs"] {
            let words = ["simulate", "ball.fmu", "--fmi-type", kind, "--quiet", "--stop", "0.4"];
            let measure = ["--output", "ball.csv", "--measure", "height = final(h)"];
            let ended = mocc(folder.path(), &[&words[..], &measure[..]].concat());
            assert_eq!(ended.status, 0, "{}", ended.err);
            let value = ended.out.split('=').nth(1).and_then(|v| v.trim().parse::<f64>().ok());
            let expected = 1.0 - 0.5 * 9.81 * 0.16;
            let value = value.unwrap_or(f64::NAN);
            assert!((value - expected).abs() < 1e-9, "{kind}: {}", ended.out);
        }
    }
}

/// An FMU of which one step takes minutes, over half a million periods; none without the runtime of FMUs.
fn slow_fmu(folder: &Scratch) -> Option<[&'static str; 8]> {
    let runtime = fmu_runtime()?.display().to_string();
    folder.file(
        "swing.mo",
        "model Swing Real x(start = 1, fixed = true); Real v(start = 0, fixed = true);
         equation der(x) = v; der(v) = -1e6*x; end Swing;",
    );
    let words = ["export", "fmu", "swing.mo", "--runtime", &runtime, "--quiet", "--type", "cs"];
    let ended = mocc(folder.path(), &[&words[..], &["-o", "swing.fmu"]].concat());
    assert_eq!(ended.status, 0, "{}", ended.err);
    Some(["simulate", "swing.fmu", "--stop", "3e3", "--interval", "3e3", "--output", "out.csv"])
}

/// A call that does not return in time is named, and nothing is left of it.
#[test]
fn a_call_that_does_not_return_is_named() {
    let folder = Scratch::new();
    let Some(words) = slow_fmu(&folder) else { return };
    let temporary = folder.path().join("temporary");
    std::fs::create_dir(&temporary).expect("a folder");
    let ended = Command::new(env!("CARGO_BIN_EXE_mocc"))
        .current_dir(folder.path())
        .env("TMPDIR", &temporary)
        .args(words)
        .args(["--max-seconds", "2"])
        .output()
        .expect("mocc runs");
    let said = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(3), "{said}");
    assert!(said.contains("MO1316") && said.contains("DoStep` at time 0 s"), "{said}");
    assert_eq!(std::fs::read_dir(&temporary).expect("a folder").count(), 0);
    assert!(!folder.path().join("out.csv").exists());
}

/// A call that takes minutes is given up after Ctrl-C.
#[test]
fn ctrl_c_ends_a_call_that_does_not_return() {
    let folder = Scratch::new();
    let Some(words) = slow_fmu(&folder) else { return };
    let mut child = Command::new(env!("CARGO_BIN_EXE_mocc"))
        .current_dir(folder.path())
        .args(words)
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .expect("mocc starts");
    std::thread::sleep(Duration::from_secs(1));
    let pressed = Instant::now();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()));
    let mut said = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("UTF-8");
    let status = child.wait().expect("it ends");
    assert!(pressed.elapsed() < Duration::from_secs(5), "{:?}", pressed.elapsed());
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(said.contains("MO1316") && said.contains("swing.fmu"), "{said}");
}
