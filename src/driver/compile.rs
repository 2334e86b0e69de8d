//! The recipe: the order of the stages.

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::cause::RequestCause;
use super::foreign::{is_fmu, needs_equations};
use super::measured::is_unreadable_measure;
use super::open_ends;
use super::open_texts::OpenTexts;
use super::packed::Packed;
use super::quantity;
use super::subject::{find, model};

use crate::base::activity;
use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::index::FastMap;
use crate::base::name::{split_unquoted, without_spaces};
use crate::base::source::{SETTING, SourceMap, Span};
use crate::classes::ClassGraph;
use crate::evaluate::Evaluator;
use crate::evaluate::budget::Budget;
use crate::flatten::cause::OverrideCause;
use crate::flatten::inventory::Inventory;
use crate::fmu::import::model::Integrating;
use crate::ir::assembly::Assembly;
use crate::ir::ast;
use crate::ir::blocks::Blocks;
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Node, Type, VarId};
use crate::ir::flat::FlatModel;
use crate::ir::foreign::ForeignModel;
use crate::ir::instance::ClassId;
use crate::ir::modification::ParameterOverride;
use crate::ir::program::{Continuation, Program, SystemForm};
use crate::resolve::library::Library;
use crate::structure::error::StructureCause;
use crate::structure::initial::StartTearing;
use crate::structure::structure_with;
use crate::verify;

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
    /// Parameters by which runs will be differentiated, by name: code for this is generated.
    pub differentiated: Vec<String>,
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
    /// The texts of an editor, which go before those on disk.
    pub open: OpenTexts,
    /// Those of `folders` that are in memory.
    pub packed: Packed,
    /// Components, and scalar variables, that the model may have; without it, the default.
    pub max_size: Option<usize>,
    /// The file may be an FMU: foreign code, which a run will load.
    pub takes_fmu: bool,
    /// Who integrates an FMU.
    pub integrating: Integrating,
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

    /// Adds settings, in place of those of the same parameters.
    pub fn set(&mut self, settings: &[String]) {
        let name =
            |s: &str| split_unquoted(s, '=').map_or(String::new(), |(n, _)| without_spaces(n));
        self.settings.retain(|old| !settings.iter().any(|new| name(new) == name(old)));
        self.settings.extend_from_slice(settings);
    }

    /// What the model may take.
    pub fn budget(&self) -> Budget {
        self.max_size.map_or_else(Budget::default, Budget::new)
    }
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
    /// Where loops of the initialization are torn.
    pub start_tearing: StartTearing,
    /// The process ends after this request, so large structures are leaked instead of freed.
    pub is_last: bool,
    /// How long each stage took, in order.
    pub times: Vec<(&'static str, Duration)>,
    /// Variables whose start values the last request sets.
    pub starts: Vec<String>,
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

    pub(super) fn flatten_by<T>(
        &mut self,
        request: &Request,
        mut by: impl FnMut(&mut Evaluator<'_>, ClassId, &[Rc<ParameterOverride>]) -> T,
        flat: impl Fn(&T) -> &FlatModel,
    ) -> Result<T, CompileError> {
        let before = self.problems.clone();
        let begun = Instant::now();
        let request = &*self.with_foreign(request)?;
        let mut library = Library::new(super::files::folders(request));
        let file = self.read(request, &mut library)?;
        self.checked(CompileError::Model)?;
        let names = request.settings.iter().filter_map(|s| split_unquoted(s, '='));
        let starts = names
            .filter_map(|(name, _)| without_spaces(name).strip_suffix(".start").map(str::to_owned));
        self.starts = starts.collect();
        let mut settings = Vec::with_capacity(request.settings.len());
        let mut quantities = Vec::new();
        for (at, text) in request.settings.iter().enumerate() {
            let text = match quantity::in_si(text) {
                Ok((text, given)) => {
                    quantities.extend(given.map(|given| (at, given)));
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
        self.check_set_twice(&request.settings)?;
        // The value of an element is looked up before that of its array, whatever their order.
        settings.sort_by_key(|s| std::cmp::Reverse(s.subscript_count()));
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
        // The FMUs of components remove their folders when they are dropped.
        if self.is_last && !cx.has_objects() {
            std::mem::take(&mut cx.class_graph.instances).leak_elements();
            std::mem::forget(cx);
        }
        self.times.push(("flatten", begun.elapsed()));
        let sources = &self.sources;
        let of_setting = |d: &Diagnostic| {
            d.is(|_: &OverrideCause| true)
                || d.is(is_unreadable_measure)
                || sources.get(d.primary.0.file).is_some_and(|f| {
                    f.path == Path::new(SETTING) || f.path == Path::new("--measure")
                })
        };
        let only_settings = self.problems.iter().all(of_setting);
        self.checked(if only_settings { CompileError::Request } else { CompileError::Model })?;
        verify::after("flatten", "flat", || verify::flat::check(flat(&made)));
        let converted = self.compare_quantities(flat(&made), &quantities);
        self.checked(CompileError::Request)?;
        if converted.is_empty() {
            return Ok(made);
        }
        // The units of parameters are known only now: their values may be those of sizes and conditions.
        let mut request = request.clone();
        converted.into_iter().for_each(|(at, text)| request.settings[at] = text);
        self.problems = before;
        self.flatten_by(&request, by, flat)
    }

    /// Reports a parameter that is set to two values.
    fn check_set_twice(&mut self, settings: &[String]) -> Result<(), CompileError> {
        let mut values: FastMap<String, &String> = FastMap::default();
        for setting in settings {
            let Some((name, _)) = split_unquoted(setting, '=') else { continue };
            let first = *values.entry(without_spaces(name)).or_insert(setting);
            if without_spaces(first) != without_spaces(setting) {
                let (first, second) = (first.clone(), setting.clone());
                let cause = OverrideCause::SetTwice { first, second };
                self.problems.push(Diagnostic::new(cause, Span::NONE));
                return Err(CompileError::Request);
            }
        }
        Ok(())
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
        let tearing = self.start_tearing;
        let blocks = dae.and_then(|dae| structure_with(dae, tearing, &mut self.problems));
        if self.parameters_vary {
            self.problems.remove_errors(|cause: &StructureCause| {
                matches!(cause, StructureCause::DependentLinearEquations { .. })
            });
        }
        open_ends::note(&mut self.problems);
        self.times.push(("structure", begun.elapsed()));
        self.checked(CompileError::Model)?;
        if let Some(blocks) = &blocks {
            verify::after("structure", "blocks", || verify::blocks::check(blocks));
        }
        blocks.ok_or(CompileError::Model)
    }

    /// The program of a sorted system.
    pub fn generate(&mut self, blocks: Blocks) -> Result<Program, CompileError> {
        self.generate_for(blocks, SystemForm::Ode, &[])
    }

    /// The program of a sorted system, in this form, with code for runs that are differentiated by these parameters.
    fn generate_for(
        &mut self,
        blocks: Blocks,
        form: SystemForm,
        differentiated: &[String],
    ) -> Result<Program, CompileError> {
        let begun = Instant::now();
        activity::note("generating code".to_owned());
        let variables = blocks.dae.variables.enumerate();
        let is_named = |name: &str| differentiated.iter().any(|d| d == name);
        let by: Vec<VarId> = variables.filter(|(_, x)| is_named(&x.name)).map(|(v, _)| v).collect();
        let program = crate::codegen::compile_for(blocks, form, &by);
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
        self.compare_units(&mut flat, request);
        self.adopt_names(&mut flat);
        self.drive(&mut flat, &request.recorded)?;
        self.compile_differentiated(flat, request.form, &request.differentiated)
    }

    /// The program of a flat model, in this form.
    pub fn compile_flat(
        &mut self,
        flat: FlatModel,
        form: SystemForm,
    ) -> Result<Program, CompileError> {
        self.compile_differentiated(flat, form, &[])
    }

    /// The program of a flat model, in this form, with code for runs that are differentiated by these parameters.
    pub(super) fn compile_differentiated(
        &mut self,
        mut flat: FlatModel,
        form: SystemForm,
        differentiated: &[String],
    ) -> Result<Program, CompileError> {
        self.adopt_names(&mut flat);
        self.drive_computed(&mut flat);
        let between = crate::lower::homotopy::homotopy_model(&flat);
        let blocks = self.sort(flat)?;
        self.check_starts(&blocks.dae)?;
        let mut program = self.generate_for(blocks, form, differentiated)?;
        let tearing = self.start_tearing;
        program.continuation =
            between.and_then(|flat| continuation(flat, &program, tearing)).map(Box::new);
        self.attach_foreign(&mut program);
        Ok(program)
    }

    /// Reports start values that are set and that the variable they would have to be set at does not have.
    fn check_starts(&mut self, dae: &Dae) -> Result<(), CompileError> {
        for name in &self.starts {
            let found = dae.variables.enumerate().find(|(_, v)| v.name == *name);
            let root = found.and_then(|(id, _)| {
                let (_, value) = dae.eliminated.iter().find(|(v, _)| *v == id)?;
                match dae.graph.node(*value) {
                    Node::Var(root) => Some(root),
                    _ => None,
                }
            });
            let (Some((_, own)), Some(root)) = (found, root.map(|root| &dae.variables[root]))
            else {
                continue;
            };
            if own.start != root.start {
                let cause =
                    RequestCause::StartOfAlias { name: name.clone(), root: root.name.clone() };
                self.problems.push(Diagnostic::new(cause, Span::NONE));
            }
        }
        self.checked(CompileError::Request)
    }

    pub(super) fn checked(&self, wrong: CompileError) -> Result<(), CompileError> {
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
        if let Some(why) = super::files::other_kind(path) {
            let path = path.display().to_string();
            self.problems
                .push(Diagnostic::new(RequestCause::NotAModelFile { path, why }, Span::NONE));
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
        if let Some(home) = super::files::home(path, file.package(), &request.open) {
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

/// The homotopy from simplified equations to the initial values of `program`. If it cannot be compiled,
/// the model is initialised without it.
fn continuation(flat: FlatModel, program: &Program, tearing: StartTearing) -> Option<Continuation> {
    let mut quiet = Problems::new();
    let dae = crate::lower::lower(flat, &mut quiet)?;
    let blocks = structure_with(dae, tearing, &mut quiet)?;
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
