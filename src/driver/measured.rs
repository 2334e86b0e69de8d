//! Programs of models with measures.

use super::compile::{CompileError, Request, Session};
use super::subject::find;

use crate::base::diag::Diagnostic;
use crate::base::name::name;
use crate::base::source::Span;
use crate::ir::program::Program;
use crate::measure::error::MeasureCause;
use crate::measure::model as extended;
use crate::measure::observe::Plan;
use crate::measure::text::{Measure, Measures};

impl Session {
    /// The program of a request with the variables that measures need, and the measures.
    pub fn compile_measured(
        &mut self,
        request: &Request,
        measures: &[String],
    ) -> Result<(Program, Plan), CompileError> {
        self.compile_with_measures(request, measures, false)
    }

    /// The same, with the variables that the derivatives of the measures need.
    pub fn compile_differentiable(
        &mut self,
        request: &Request,
        measures: &[String],
    ) -> Result<(Program, Plan), CompileError> {
        self.compile_with_measures(request, measures, true)
    }

    fn compile_with_measures(
        &mut self,
        request: &Request,
        measures: &[String],
        has_slopes: bool,
    ) -> Result<(Program, Plan), CompileError> {
        let mut read = Measures::default();
        let mut flat = self.flatten_by(
            request,
            |cx, class, settings| {
                read = Measures::read(measures, cx.class_graph.sources, cx.class_graph.problems);
                read.has_slopes = has_slopes;
                let base = cx.classes[class].full_name.to_string();
                let table = cx.table(class);
                let is_taken = |m: &&Measure| table.index.contains_key(&name(&m.name));
                for measure in read.list.iter().filter(is_taken) {
                    let name = measure.name.clone();
                    let cause = MeasureCause::TakenName { name };
                    cx.class_graph.problems.push(Diagnostic::new(cause, Span::NONE));
                }
                read.list.retain(|m| !table.index.contains_key(&name(&m.name)));
                let annotation = cx.definition(class).and_then(|t| t.annotation.clone());
                let file = extended::file(&read, &base, annotation, cx.sources);
                cx.class_graph.library.add_file(&file, cx.class_graph.problems);
                let extended = find(cx, extended::MODEL).unwrap_or(class);
                let mut flat = crate::flatten::flatten(cx, extended, settings);
                flat.name = base;
                flat
            },
            |flat| flat,
        )?;
        self.compare_units(&mut flat, request);
        extended::check(&flat, &read, &mut self.problems);
        self.checked(CompileError::Request)?;
        let mut program =
            self.compile_differentiated(flat, request.form, &request.differentiated)?;
        let plan = Plan::new(read, &mut program, &mut self.problems);
        self.checked(CompileError::Request)?;
        plan.map(|plan| (program, plan)).ok_or(CompileError::Request)
    }
}

/// A measure that is not `NAME = EXPRESSION` with a name of its own.
pub(super) fn is_unreadable_measure(cause: &MeasureCause) -> bool {
    use MeasureCause::*;
    matches!(
        cause,
        NoName { .. } | NotAnExpression { .. } | DuplicateName { .. } | TakenName { .. }
    )
}
