//! Diagnostics and failures as Python exceptions, which `mocc._errors` defines.

use mocc::base::diag::{Diagnostic, Problems, Severity};
use mocc::base::render::{Style, render};
use mocc::base::source::SourceMap;
use mocc::calibrate::run::CalibrationError;
use mocc::diagnose::run::RunError;
use mocc::diagnose::study::DiagnosisError;
use mocc::driver::compile::{CompileError, Session};
use mocc::simulate::failure::{Failure, FailureKind};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Why a call has no result; made without the interpreter lock.
#[derive(Clone, Debug)]
pub struct Trouble {
    kind: Kind,
    problems: Vec<Problem>,
}

/// The exception that is raised.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// The model is wrong.
    Model,
    /// The arguments or the data are wrong.
    Request,
    /// The numerics failed.
    Simulation,
    /// mocc has a bug.
    Internal,
}

/// A diagnostic without its session.
#[derive(Clone, Debug, Default)]
struct Problem {
    code: Option<&'static str>,
    message: String,
    place: Option<String>,
    help: Option<String>,
    notes: Vec<String>,
    rendered: String,
    /// Time of the failure, s.
    time: Option<f64>,
}

impl Trouble {
    /// A message without a code.
    pub fn plain(kind: Kind, message: impl Into<String>) -> Trouble {
        let message = message.into();
        let problem =
            Problem { rendered: format!("error: {message}"), message, ..Problem::default() };
        Trouble { kind, problems: vec![problem] }
    }

    /// The errors of a session.
    pub fn of_session(error: CompileError, session: &Session) -> Trouble {
        let kind = match error {
            CompileError::Model => Kind::Model,
            CompileError::Request => Kind::Request,
        };
        let errors = session.problems.sorted().into_iter();
        let errors = errors.filter(|d| d.severity == Severity::Error);
        let problems: Vec<Problem> = errors.map(|d| problem(d, &session.sources)).collect();
        match problems.is_empty() {
            true => Trouble::plain(kind, error.to_string()),
            false => Trouble { kind, problems },
        }
    }

    /// A run that ended early.
    pub fn of_failure(failure: &Failure, sources: &SourceMap) -> Trouble {
        let kind = match failure.kind {
            FailureKind::Numerics | FailureKind::Assertion => Kind::Simulation,
            FailureKind::Settings => Kind::Request,
            FailureKind::Bug => Kind::Internal,
        };
        let mut problem = problem(&failure.diagnostic, sources);
        problem.time = Some(failure.time);
        Trouble { kind, problems: vec![problem] }
    }

    /// A calibration without a result.
    pub fn of_calibration(error: &CalibrationError, session: &Session) -> Trouble {
        match error {
            CalibrationError::Invalid(error) => Trouble::of_session(*error, session),
            CalibrationError::Failed(failure) => Trouble::of_failure(failure, &session.sources),
            CalibrationError::Unreadable { .. } | CalibrationError::Refused(_) => {
                Trouble::plain(Kind::Request, error.to_string())
            }
        }
    }

    /// A diagnosis without a result.
    pub fn of_diagnosis(error: &RunError, session: &Session) -> Trouble {
        match error {
            RunError::Setup(error) => Trouble::of_calibration(error, session),
            RunError::Search(DiagnosisError::Model(error)) => Trouble::of_session(*error, session),
            RunError::Search(DiagnosisError::Simulation) => {
                Trouble::plain(Kind::Simulation, error.to_string())
            }
        }
    }

    /// The exception.
    pub fn raise(&self, py: Python<'_>) -> PyErr {
        self.exception(py).map_or_else(|why| why, PyErr::from_value)
    }

    /// The exception as an object.
    pub fn exception<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let problems = PyList::empty(py);
        for p in &self.problems {
            let entry = PyDict::new(py);
            entry.set_item("code", p.code)?;
            entry.set_item("message", &p.message)?;
            entry.set_item("place", &p.place)?;
            entry.set_item("help", &p.help)?;
            entry.set_item("notes", &p.notes)?;
            entry.set_item("rendered", &p.rendered)?;
            entry.set_item("time", p.time)?;
            problems.append(entry)?;
        }
        let name = match self.kind {
            Kind::Model => "ModelError",
            Kind::Request => "RequestError",
            Kind::Simulation => "SimulationError",
            Kind::Internal => "InternalError",
        };
        py.import("mocc._errors")?.getattr(name)?.call_method1("of", (problems,))
    }
}

/// The warnings of a session, rendered.
pub fn warnings(problems: &Problems, sources: &SourceMap) -> Vec<String> {
    let all = problems.sorted().into_iter().filter(|d| d.severity == Severity::Warning);
    all.map(|d| render(d, sources, Style::Plain)).collect()
}

/// The error of a thread that ended without an answer.
pub fn lost() -> PyErr {
    PyRuntimeError::new_err(
        "this is a bug in mocc, please report it with the model and the call; the standard error says more",
    )
}

fn problem(d: &Diagnostic, sources: &SourceMap) -> Problem {
    Problem {
        code: Some(d.code),
        message: d.message.clone(),
        place: sources.place(d.primary.0),
        help: d.help.clone(),
        notes: d.notes.clone(),
        rendered: render(d, sources, Style::Plain),
        time: None,
    }
}
