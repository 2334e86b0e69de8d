//! The recipe: the order of the stages.

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::base::activity;
use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::index::FastMap;
use crate::base::name::name;
use crate::base::source::{SourceMap, Span};
use crate::classes::{ClassGraph, ROOT};
use crate::evaluate::Evaluator;
use crate::evaluate::budget::Budget;
use crate::flatten::cause::OverrideCause;
use crate::flatten::inventory::Inventory;
use crate::fmu::import::model::Integrating;
use crate::ir::assembly::Assembly;
use crate::ir::ast::{
    self, Argument, ArgumentKind, ClassBody, ClassKind, ElementKind, Modification,
};
use crate::ir::blocks::Blocks;
use crate::ir::dae::VariableKind;
use crate::ir::expr::{Const, Type, VarId};
use crate::ir::flat::{Causality, FlatModel, Variability, Variable};
use crate::ir::foreign::ForeignModel;
use crate::ir::instance::{ClassId, Scope};
use crate::ir::modification::ParameterOverride;
use crate::ir::program::{Continuation, Program, SystemForm};
use crate::measure::error::MeasureCause;
use crate::measure::model as extended;
use crate::measure::observe::Plan;
use crate::measure::text::Measures;
use crate::resolve::library::Library;
use crate::structure::error::StructureCause;
use crate::verify;

use super::cause::RequestCause;
use super::foreign::{is_fmu, needs_equations};
use super::packed::Packed;
use super::quantity;

/// A class with an annotation `__mocc`.
#[derive(Clone, Debug)]
pub struct Annotated {
    /// Its full name.
    pub class: String,
    /// The entries of the annotation, in order.
    pub entries: Vec<Annotation>,
}

/// An entry `key = "text"` of an annotation `__mocc`.
#[derive(Clone, Debug)]
pub struct Annotation {
    /// Its key.
    pub key: String,
    /// Its text.
    pub text: String,
    /// The place of the text.
    pub span: Span,
}

impl Annotated {
    /// The entry with a key.
    pub fn entry(&self, key: &str) -> Option<&Annotation> {
        self.entries.iter().find(|e| e.key == key)
    }
}

/// What to compile.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// The user's file.
    pub file: Option<PathBuf>,
    /// Its text, if a front end holds it; diagnostics then show `file` as its name.
    pub text: Option<String>,
    /// Full name of the model; without it the last model of the file that is not partial.
    pub model: Option<String>,
    /// A further source text that may use the classes of the file, such as a generated model.
    pub appended: Option<String>,
    /// `NAME=VALUE`.
    pub settings: Vec<String>,
    /// Compare the units in the user's own sources, as `mocc check` does.
    pub check_units: bool,
    /// Inputs of the model, or of its components, that recordings drive.
    pub recorded: Vec<String>,
    /// How algebraic loops are solved while the model runs.
    pub form: SystemForm,
    /// Folders of libraries.
    pub folders: Vec<PathBuf>,
    /// Folders whose data files the model may read, besides its own and those of libraries.
    pub readable: Vec<PathBuf>,
    /// FMUs, or folders with FMUs, that components of the model may run: foreign code.
    pub fmus: Vec<PathBuf>,
    /// The value of `MODELICAPATH`.
    pub modelica_path: Option<std::ffi::OsString>,
    /// Those of `folders` that are in memory.
    pub packed: Packed,
    /// Components, and scalar variables, that the model may have; without it, the default.
    pub max_size: Option<usize>,
    /// The file may be an FMU: foreign code, which a run will load.
    pub takes_fmu: bool,
    /// Who integrates an FMU; without it mocc, if the FMU offers it.
    pub integrating: Option<Integrating>,
}

/// Why a request has no result. The diagnostics of the session hold the details.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum CompileError {
    /// The model is wrong: exit status 1.
    #[error("the model has errors")]
    Model,
    /// The request is wrong, for example a file does not exist: exit status 2.
    #[error("the request cannot be met")]
    Request,
}

impl Request {
    /// A model of a file or, without one, of a library.
    pub fn new(file: Option<PathBuf>, model: Option<String>) -> Request {
        Request { file, model, ..Request::default() }
    }

    /// What the model may take.
    pub fn budget(&self) -> Budget {
        self.max_size.map_or_else(Budget::default, Budget::new)
    }
}

/// The connections of a model to its surroundings: Real variables at its top level.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    /// Names of the inputs without a value.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
}

/// Sources and the diagnostics about them.
#[derive(Default)]
pub struct Session {
    /// All sources read.
    pub sources: SourceMap,
    /// Errors and warnings so far.
    pub problems: Problems,
    /// Parameters get other values run by run, so equations may be singular at the declared ones.
    pub parameters_vary: bool,
    /// The process ends after this request, so large structures are leaked instead of freed.
    pub is_last: bool,
    /// How long each stage took, in order.
    pub times: Vec<(&'static str, Duration)>,
    /// The FMU of the last request, if it named one.
    pub foreign: Option<Arc<dyn ForeignModel>>,
}

impl Session {
    /// The flat model of a request.
    pub fn flatten(&mut self, request: &Request) -> Result<FlatModel, CompileError> {
        self.flatten_by(request, crate::flatten::flatten, |flat| flat)
    }

    /// The flat model of a request and the inventory of its components.
    pub fn flatten_with_inventory(
        &mut self,
        request: &Request,
    ) -> Result<(FlatModel, Inventory), CompileError> {
        self.flatten_by(request, crate::flatten::flatten_with_inventory, |(flat, _)| flat)
    }

    /// The flat model of a request and its component tree.
    pub fn flatten_with_assembly(
        &mut self,
        request: &Request,
    ) -> Result<(FlatModel, Assembly), CompileError> {
        self.flatten_by(request, crate::flatten::flatten_with_assembly, |(flat, _)| flat)
    }

    fn flatten_by<T>(
        &mut self,
        request: &Request,
        by: impl FnOnce(&mut Evaluator<'_>, ClassId, &[Rc<ParameterOverride>]) -> T,
        flat: impl Fn(&T) -> &FlatModel,
    ) -> Result<T, CompileError> {
        let begun = Instant::now();
        let request = &*self.with_foreign(request)?;
        let mut library = Library::new(super::files::folders(request));
        let file = self.read(request, &mut library)?;
        self.checked(CompileError::Model)?;
        let mut settings = Vec::with_capacity(request.settings.len());
        let mut quantities = Vec::new();
        for text in &request.settings {
            let text = match quantity::in_si(text) {
                Ok((text, given)) => {
                    quantities.extend(given);
                    text
                }
                Err(cause) => {
                    self.problems.push(Diagnostic::new(cause, Span::NONE));
                    return Err(CompileError::Request);
                }
            };
            let read = crate::flatten::parameter_override::read(
                &text,
                &mut self.sources,
                &mut self.problems,
            );
            settings.push(read.ok_or(CompileError::Request)?);
        }
        self.times.push(("parse", begun.elapsed()));

        let begun = Instant::now();
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        cx.budget = request.budget();
        let class = model(&mut cx, request, file.as_deref())?;
        activity::note("flattening the model".to_owned());
        let made = by(&mut cx, class, &settings);
        if !cx.class_graph.problems.has_errors() {
            verify::after("instantiate", "instance", || verify::instance::check(&cx.instances));
        }
        if self.is_last {
            std::mem::forget(cx);
        }
        self.times.push(("flatten", begun.elapsed()));
        let sources = &self.sources;
        let of_setting = |d: &Diagnostic| {
            d.is(|_: &OverrideCause| true)
                || d.is(is_unreadable_measure)
                || sources.get(d.primary.0.file).is_some_and(|f| {
                    f.path == Path::new("--set") || f.path == Path::new("--measure")
                })
        };
        let only_settings = self.problems.iter().all(of_setting);
        self.checked(if only_settings { CompileError::Request } else { CompileError::Model })?;
        verify::after("flatten", "flat", || verify::flat::check(flat(&made)));
        self.compare_quantities(flat(&made), &quantities);
        self.checked(CompileError::Request)?;
        Ok(made)
    }

    /// The full names of the classes of a package, sorted; the empty name is the top level.
    pub fn members(&mut self, request: &Request, package: &str) -> Vec<String> {
        let mut library = Library::new(super::files::folders(request));
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        if !package.is_empty() && find(&mut cx, package).is_none() {
            return Vec::new();
        }
        let mut names = cx.library.child_names(package);
        names.sort();
        names.dedup();
        let full = |name| if package.is_empty() { name } else { format!("{package}.{name}") };
        names.into_iter().map(full).collect()
    }

    /// Classes of libraries that have an annotation `__mocc`, each with its entries.
    pub fn annotated(&mut self, request: &Request, classes: &[String]) -> Vec<Annotated> {
        let mut library = Library::new(super::files::folders(request));
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        let mut out = Vec::new();
        for full in classes.iter().cloned() {
            let Some(class) = find(&mut cx, &full) else { continue };
            let entries = entries(&mut cx, class);
            if !entries.is_empty() {
                out.push(Annotated { class: full, entries });
            }
        }
        out
    }

    /// The entries of the annotation `__mocc` of the requested model; none if it cannot be found.
    pub fn own_annotation(&mut self, request: &Request) -> Annotated {
        let mut found = Annotated { class: String::new(), entries: Vec::new() };
        let mut library = Library::new(super::files::folders(request));
        let Ok(file) = self.read(request, &mut library) else { return found };
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        if let Ok(class) = model(&mut cx, request, file.as_deref()) {
            found.class = cx.classes[class].full_name.to_string();
            found.entries = entries(&mut cx, class);
        }
        found
    }

    /// The sorted system of a flat model.
    pub fn sort(&mut self, flat: FlatModel) -> Result<Blocks, CompileError> {
        let begun = Instant::now();
        activity::note("simplifying the equations of the model".to_owned());
        let dae = crate::lower::lower(flat, &mut self.problems);
        self.times.push(("lower", begun.elapsed()));
        self.checked(CompileError::Model)?;
        if let Some(dae) = &dae {
            verify::after("lower", "dae", || verify::dae::check(dae));
        }
        let begun = Instant::now();
        activity::note("finding the states and blocks of the model".to_owned());
        let blocks = dae.and_then(|dae| crate::structure::structure(dae, &mut self.problems));
        if self.parameters_vary {
            self.problems.remove_errors(|cause: &StructureCause| {
                matches!(cause, StructureCause::DependentLinearEquations { .. })
            });
        }
        self.times.push(("structure", begun.elapsed()));
        self.checked(CompileError::Model)?;
        if let Some(blocks) = &blocks {
            verify::after("structure", "blocks", || verify::blocks::check(blocks));
        }
        blocks.ok_or(CompileError::Model)
    }

    /// The program of a sorted system.
    pub fn generate(&mut self, blocks: Blocks) -> Result<Program, CompileError> {
        self.generate_as(blocks, SystemForm::Ode)
    }

    /// The program of a sorted system, in this form.
    pub fn generate_as(
        &mut self,
        blocks: Blocks,
        form: SystemForm,
    ) -> Result<Program, CompileError> {
        let begun = Instant::now();
        activity::note("generating code".to_owned());
        let program = crate::codegen::compile_as(blocks, form);
        self.times.push(("codegen", begun.elapsed()));
        if let Ok(program) = &program {
            verify::after("codegen", "program", || verify::program::check(program));
        }
        program.map_err(|problems| {
            self.problems.extend(problems);
            CompileError::Model
        })
    }

    /// The program of a request.
    pub fn compile(&mut self, request: &Request) -> Result<Program, CompileError> {
        let mut flat = self.flatten(request)?;
        self.compare_units(&flat, request);
        self.adopt_names(&mut flat);
        self.drive(&mut flat, &request.recorded)?;
        self.compile_flat(flat, request.form)
    }

    /// The program of a request, all of whose top-level inputs are driven, and the names of its inputs and outputs.
    pub fn compile_with_ports(
        &mut self,
        request: &Request,
    ) -> Result<(Program, Ports), CompileError> {
        let mut flat = self.flatten(request)?;
        let is_real = |v: &Variable| v.ty == Type::Real && v.variability == Variability::Continuous;
        let of = |causality: Causality| {
            let all =
                flat.variables.iter().filter(move |v| is_real(v) && v.causality == Some(causality));
            all.map(|v| (v.name.clone(), v.binding.is_none()))
        };
        let inputs = of(Causality::Input).filter(|(_, is_free)| *is_free).map(|(name, _)| name);
        let outputs = of(Causality::Output).map(|(name, _)| name);
        let ports = Ports { inputs: inputs.collect(), outputs: outputs.collect() };
        self.drive(&mut flat, &ports.inputs)?;
        Ok((self.compile_flat(flat, request.form)?, ports))
    }

    /// The program of a request, all of whose free inputs may be set while it runs, and the causality of its
    /// top-level variables.
    pub fn compile_for_export(
        &mut self,
        request: &Request,
    ) -> Result<(Program, Vec<(String, Causality)>), CompileError> {
        let mut flat = self.flatten(request)?;
        let known = |v: &Variable| v.causality.map(|causality| (v.name.clone(), causality));
        let is_free = |v: &Variable| v.causality != Some(Causality::Input) || v.binding.is_none();
        let causalities = flat.variables.iter().filter(|v| is_free(v)).filter_map(known).collect();
        let mut driven = Vec::new();
        for k in flat.variables.ids() {
            let v = &flat.variables[k];
            if v.causality != Some(Causality::Input) || v.binding.is_some() {
                continue;
            }
            if v.ty == Type::Real && v.variability == Variability::Continuous {
                driven.push(v.name.clone());
            } else if v.start.is_none() {
                // What can be set has a start value.
                let value = f64::from(u8::from(matches!(v.ty, Type::Enumeration(_))));
                let start = flat.graph.constant(Const::of_type(v.ty, value));
                flat.variables[k].start = Some(start);
            }
        }
        self.drive(&mut flat, &driven)?;
        Ok((self.compile_flat(flat, request.form)?, causalities))
    }

    /// Marks the inputs that recordings drive; each must exist and have no value of its own.
    pub fn drive(&mut self, flat: &mut FlatModel, inputs: &[String]) -> Result<(), CompileError> {
        for input in inputs {
            let found = flat.variables.enumerate().find(|(_, v)| v.name == *input);
            let open = |v: &Variable| {
                v.ty == Type::Real
                    && v.variability == Variability::Continuous
                    && v.causality == Some(Causality::Input)
            };
            match found {
                Some((id, v)) if v.binding.is_none() && open(v) => flat.recorded.push(id),
                Some((_, v)) => {
                    let cause = RequestCause::NotDrivable { name: input.clone() };
                    self.problems.push(Diagnostic::new(cause, v.span));
                }
                None => {
                    let inputs =
                        flat.variables.iter().filter(|v| v.causality == Some(Causality::Input));
                    let names = inputs.map(|v| v.name.as_str());
                    let near = did_you_mean(input, names).map(str::to_owned);
                    let cause = RequestCause::UnknownInput { name: input.clone(), near };
                    self.problems.push(Diagnostic::new(cause, Span::NONE));
                }
            }
        }
        self.checked(CompileError::Request)
    }

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
        let flat = self.flatten_by(
            request,
            |cx, class, settings| {
                read = Measures::read(measures, cx.class_graph.sources, cx.class_graph.problems);
                read.has_slopes = has_slopes;
                let base = cx.classes[class].full_name.to_string();
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
        self.compare_units(&flat, request);
        extended::check(&flat, &read, &mut self.problems);
        self.checked(CompileError::Request)?;
        let mut program = self.compile_flat(flat, request.form)?;
        let plan = Plan::new(read, &mut program, &mut self.problems);
        self.checked(CompileError::Request)?;
        plan.map(|plan| (program, plan)).ok_or(CompileError::Request)
    }

    /// Warns of units that do not match in the sources that the user has named. Those of libraries
    /// are the business of `mocc check`.
    fn compare_units(&mut self, flat: &FlatModel, request: &Request) {
        if !request.check_units {
            return;
        }
        let mut found = Problems::new();
        // The check adds nodes to the graph, and results must not depend on it.
        crate::units::check(&mut flat.clone(), &mut found);
        for d in found.iter() {
            let file = self.sources.get(d.primary.0.file).map(|f| f.path.as_path());
            let is_own = file.is_some_and(|path| {
                Some(path) == request.file.as_deref() || path.starts_with("--")
            });
            if is_own {
                self.problems.push(d.clone());
            }
        }
    }

    /// Refuses values whose units measure something else than their parameters.
    fn compare_quantities(&mut self, flat: &FlatModel, quantities: &[quantity::Given]) {
        for given in quantities {
            let Some(variable) = flat.variables.iter().find(|v| v.name == given.name) else {
                continue;
            };
            let declared = quantity::scale_of(&variable.unit);
            if declared.is_none_or(|(scale, dimension)| {
                dimension != given.dimension || (scale.factor - 1.0).abs() > 1e-12
            }) {
                let cause = quantity::QuantityCause::WrongUnit {
                    name: given.name.clone(),
                    declared: if variable.unit.is_empty() {
                        "1".into()
                    } else {
                        variable.unit.to_string()
                    },
                    unit: given.unit.clone(),
                };
                self.problems.push(Diagnostic::new(cause, variable.span));
            }
        }
    }

    /// The program of a flat model, in this form.
    pub fn compile_flat(
        &mut self,
        mut flat: FlatModel,
        form: SystemForm,
    ) -> Result<Program, CompileError> {
        self.adopt_names(&mut flat);
        self.drive_computed(&mut flat);
        let between = crate::lower::homotopy::homotopy_model(&flat);
        let blocks = self.sort(flat)?;
        let mut program = self.generate_as(blocks, form)?;
        program.continuation = between.and_then(|flat| continuation(flat, &program)).map(Box::new);
        self.attach_foreign(&mut program);
        Ok(program)
    }

    fn checked(&self, wrong: CompileError) -> Result<(), CompileError> {
        if self.problems.has_errors() { Err(wrong) } else { Ok(()) }
    }

    pub(super) fn read(
        &mut self,
        request: &Request,
        library: &mut Library,
    ) -> Result<Option<Arc<ast::File>>, CompileError> {
        if let Some(folder) =
            request.folders.iter().find(|f| request.packed.folder(f).is_none() && !f.is_dir())
        {
            let folder = folder.display().to_string();
            self.problems.push(Diagnostic::new(RequestCause::NoSuchFolder { folder }, Span::NONE));
            return Err(CompileError::Request);
        }
        let Some(path) = &request.file else { return Ok(None) };
        if request.text.is_none() && is_fmu(path) {
            self.problems
                .push(needs_equations(path, "this command needs the equations of a model"));
            return Err(CompileError::Request);
        }
        let path = if request.text.is_some() && path == Path::new("-") {
            Path::new("stdin.mo")
        } else {
            path
        };
        let text = match request.text.clone().map_or_else(|| super::files::read(path), Ok) {
            Ok(text) => text,
            Err(why) => {
                self.problems.push(unreadable(path, &why));
                return Err(CompileError::Request);
            }
        };
        let id = self.sources.add(path, text.as_str());
        let file = crate::parse::grammar::parse(id, &text, &mut self.problems);
        if !self.problems.has_errors() {
            verify::after("parse", "ast", || verify::ast::check(&file));
        }
        if let Some(home) = super::files::home(path, file.package()) {
            library.add_home(home.root, home.package, &file);
        }
        library.add_file(&file, &mut self.problems);
        if let Some(text) = &request.appended {
            let id = self.sources.add(Path::new("appended.mo"), text.as_str());
            let more = crate::parse::grammar::parse(id, text, &mut self.problems);
            library.add_file(&more, &mut self.problems);
        }
        Ok(Some(Arc::new(file)))
    }
}

/// The entries of the annotation `__mocc` of a class.
fn entries(cx: &mut Evaluator<'_>, class: ClassId) -> Vec<Annotation> {
    let Some(annotation) = cx.definition(class).and_then(|t| t.annotation.clone()) else {
        return Vec::new();
    };
    let scope = Scope { instance: ROOT.instance, class };
    let arguments = annotation.args.iter().filter_map(|a| named(a, "__mocc"));
    let mut out = Vec::new();
    for entry in arguments.flat_map(|m| m.args.iter()) {
        let ArgumentKind::Element { path, modification: Some(m), .. } = &entry.kind else {
            continue;
        };
        let Some(binding) = &m.binding else { continue };
        let value = cx.fold(binding, scope).and_then(|v| v.scalar());
        if let Some(Const::String(text)) = value.and_then(|e| cx.graph.as_const(e)) {
            let (key, span) = (path.to_string(), binding.span);
            out.push(Annotation { key, text: text.to_string(), span });
        }
    }
    out
}

fn named<'a>(argument: &'a Argument, name: &str) -> Option<&'a Modification> {
    match &argument.kind {
        ArgumentKind::Element { path, modification: Some(m), .. } if path.to_string() == name => {
            Some(m)
        }
        _ => None,
    }
}

/// The homotopy from simplified equations to the initial values of `program`. If it cannot be compiled,
/// the model is initialised without it.
fn continuation(flat: FlatModel, program: &Program) -> Option<Continuation> {
    let mut quiet = Problems::new();
    let dae = crate::lower::lower(flat, &mut quiet)?;
    let blocks = crate::structure::structure(dae, &mut quiet)?;
    let between = crate::codegen::compile(blocks).ok()?;
    let by_name: FastMap<&str, VarId> =
        between.blocks.dae.variables.enumerate().map(|(v, x)| (x.name.as_str(), v)).collect();
    let lambda = *by_name.get(crate::lower::homotopy::LAMBDA)?;
    let variables = program.blocks.dae.variables.enumerate();
    let continuous = variables.filter(|(_, x)| {
        x.ty == Type::Real
            && matches!(x.kind, VariableKind::Algebraic | VariableKind::Differentiated { .. })
    });
    let slots = continuous
        .filter_map(|(v, x)| Some((between.slot(*by_name.get(x.name.as_str())?), program.slot(v))))
        .collect();
    Some(Continuation { program: between, lambda, slots })
}

/// A measure that is not `NAME = EXPRESSION` with a name of its own.
fn is_unreadable_measure(cause: &MeasureCause) -> bool {
    use MeasureCause::*;
    matches!(cause, NoName { .. } | NotAnExpression { .. } | DuplicateName { .. })
}

fn unreadable(path: &Path, why: &str) -> Diagnostic {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let names: Vec<String> = std::fs::read_dir(folder)
        .map(|l| l.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    let mut sorted = names;
    sorted.sort();
    let near = did_you_mean(&wanted, sorted.iter().map(String::as_str));
    let cause = RequestCause::UnreadableFile {
        path: path.display().to_string(),
        why: why.to_owned(),
        near: near.map(|name| folder.join(name).display().to_string()),
    };
    Diagnostic::new(cause, Span::NONE)
}

/// The class of a request.
pub(super) fn model(
    cx: &mut Evaluator<'_>,
    request: &Request,
    file: Option<&ast::File>,
) -> Result<ClassId, CompileError> {
    let wanted = match (&request.model, file) {
        (Some(text), _) => text.clone(),
        (None, Some(file)) => match last_model(file) {
            Some(full_name) => full_name,
            None => {
                let place = Span::new(file.id, 0, 0);
                cx.problems.push(Diagnostic::new(RequestCause::NoModelInFile, place));
                return Err(CompileError::Model);
            }
        },
        (None, None) => {
            cx.problems.push(Diagnostic::new(RequestCause::NothingNamed, Span::NONE));
            return Err(CompileError::Request);
        }
    };
    let found = match file {
        Some(file) => find_in(cx, file, &wanted),
        None => find(cx, &wanted),
    };
    if let Some(class) = found {
        let text = cx.definition(class).cloned();
        let kind = cx.kind(class);
        if let Some(text) = text {
            let name = wanted.clone();
            let cause = if text.partial {
                Some(RequestCause::PartialModel { name })
            } else if matches!(kind, ClassKind::Package | ClassKind::Function { .. }) {
                Some(RequestCause::NotAModel { name })
            } else {
                None
            };
            if let Some(cause) = cause {
                cx.problems.push(Diagnostic::new(cause, text.name.span));
                return Err(CompileError::Model);
            }
        }
        return Ok(class);
    }
    if !cx.problems.has_errors() {
        let mut names: Vec<String> = file.map(models).unwrap_or_default();
        names.extend(cx.library.child_names(""));
        let near = did_you_mean(&wanted, names.iter().map(String::as_str)).map(str::to_owned);
        let cause = RequestCause::UnknownModel { name: wanted, near };
        cx.problems.push(Diagnostic::new(cause, Span::NONE));
    }
    Err(CompileError::Model)
}

/// A class of a file, which may be named without the packages that contain the file.
pub(super) fn find_in(cx: &mut Evaluator<'_>, file: &ast::File, wanted: &str) -> Option<ClassId> {
    let full = file.package().and_then(|package| find(cx, &format!("{package}.{wanted}")));
    full.or_else(|| find(cx, wanted))
}

pub(super) fn find(cx: &mut Evaluator<'_>, full_name: &str) -> Option<ClassId> {
    let mut class = ROOT.class;
    for part in split(full_name) {
        let holder = cx.classes[class].holder;
        class = cx.member_class(class, name(part), holder)?;
    }
    (class != ROOT.class).then_some(class)
}

/// The parts of a dotted name; dots in quoted identifiers do not separate.
fn split(full_name: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut quoted = false;
    for (i, c) in full_name.char_indices() {
        match c {
            '\'' => quoted = !quoted,
            '.' if !quoted => {
                parts.push(&full_name[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(&full_name[start..]);
    parts
}

fn last_model(file: &ast::File) -> Option<String> {
    models(file).pop()
}

/// Full names of the models of a file that are not partial, in order of the text.
pub(super) fn models(file: &ast::File) -> Vec<String> {
    let mut out = Vec::new();
    for class in &file.classes {
        collect(class, "", &mut out);
    }
    out
}

fn collect(class: &ast::Class, around: &str, out: &mut Vec<String>) {
    let full = if around.is_empty() {
        class.name.name.to_string()
    } else {
        format!("{around}.{}", class.name.name)
    };
    let runs = matches!(class.kind, ClassKind::Model | ClassKind::Block | ClassKind::Class);
    if class.kind == ClassKind::Package
        && let ClassBody::Long(composition) = &class.body
    {
        for e in &composition.elements {
            if let ElementKind::Class(c) = &e.kind {
                collect(c, &full, out);
            }
        }
    }
    if runs && !class.partial {
        out.push(full);
    }
}
