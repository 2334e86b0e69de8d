//! A sweep with everything that it owns: compiled, checked, and identified by a fingerprint.

use super::design::Design;
use super::runs::{FIXED_COLUMNS, Sweep};
use super::variant::{Model, Variants};
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::driver::compile::{CompileError, Session};
use crate::io::journal::Fingerprint;
use crate::ir::flat::Experiment;
use crate::ir::trajectory::Column;
use crate::measure::error::MeasureCause;
use crate::simulate::settings::Settings;

/// A sweep that any number of processes may take part in.
pub struct Prepared {
    /// Full name of the model.
    pub name: String,
    /// Which values in which run.
    pub design: Design,
    /// The programs.
    pub variants: Variants,
    /// Settings of all runs.
    pub settings: Settings,
    /// Names and units of the measures.
    pub measures: Vec<Column>,
    /// Number of variables whose trajectories are kept, if any are asked for.
    pub shown: usize,
    /// Everything that the rows depend on: the sources, the version, and what the front end adds.
    pub fingerprint: Fingerprint,
}

impl Prepared {
    /// Compiles the model and checks the first run: an error in every run, such as an unknown parameter, is an error in
    /// the request. `settings` makes those of all runs; `what` describes the request for the fingerprint; `compiled` sees
    /// the warnings of the compiler.
    pub fn new(
        model: Model,
        design: Design,
        settings: impl FnOnce(&Experiment) -> Settings,
        what: &str,
        compiled: impl FnOnce(&Session),
        session: &mut Session,
    ) -> Result<Prepared, CompileError> {
        let mut base = model.compile(&[], session)?;
        compiled(session);
        let settings = settings(&base.program.blocks.dae.experiment);
        let mut fingerprint = Fingerprint::default();
        fingerprint.add(env!("CARGO_PKG_VERSION"));
        for text in session.sources.contents() {
            fingerprint.add(text);
        }
        fingerprint.add(what);
        let name = base.program.blocks.dae.name.clone();
        let (measures, shown) = (base.plan.columns.clone(), base.plan.shown);
        for measure in measures.iter().filter(|m| FIXED_COLUMNS.contains(&m.name.as_str())) {
            let cause = MeasureCause::ColumnOfSweep { name: measure.name.clone() };
            session.problems.push(Diagnostic::new(cause, Span::NONE));
        }
        if session.problems.has_errors() {
            return Err(CompileError::Request);
        }
        base.sources = std::mem::take(&mut session.sources);
        let variants = Variants::new(model, base, &design.axes, design.count);
        *session = Session { parameters_vary: true, ..Session::default() };
        variants.check(&design.values(0), session)?;
        Ok(Prepared { name, design, variants, settings, measures, shown, fingerprint })
    }

    /// The runs, on so many threads.
    pub fn sweep(&self, jobs: usize) -> Sweep<'_> {
        Sweep {
            design: &self.design,
            variants: &self.variants,
            settings: self.settings.clone(),
            traces: None,
            measures: self.measures.clone(),
            jobs,
        }
    }
}
