//! An FMU as a [`ForeignModel`]: its archive is unpacked once, and runs at the same time have a child process each.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::SystemTime;

use super::description::{Described, Kind, Unusable, read};
use super::message::Load;
use super::remote::Remote;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::fmu::archive::Archive;
use crate::fmu::cause::FmuCause;
use crate::fmu::description::Version;
use crate::io::atomic_file::scratch_path;
use crate::ir::foreign::{
    ForeignFailure, ForeignFault, ForeignInterface, ForeignModel, ForeignObserver, ForeignOutcome,
    ForeignRole, ForeignTask, Obstacle,
};

/// Who integrates.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Integrating {
    /// mocc: Model Exchange.
    Here,
    /// The FMU: Co-Simulation.
    There,
    /// mocc, or the FMU if it offers Co-Simulation only.
    #[default]
    RatherHere,
    /// The FMU, or mocc if it offers Model Exchange only.
    RatherThere,
}

/// An unpacked FMU. Dropped, it removes its folder.
#[derive(Debug)]
pub struct Fmu {
    file: String,
    folder: PathBuf,
    interface: ForeignInterface,
    load: Load,
    idle: Idle,
}

/// Instances of ended runs, in their processes, that wait for the next.
#[derive(Default)]
struct Idle(Mutex<Vec<Remote>>);

impl std::fmt::Debug for Idle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("instances that wait")
    }
}

/// Most instances that wait.
const MOST_IDLE: usize = 8;

/// The shared libraries of this platform, by version: the folder in `binaries/`, and the extension.
fn platform(version: Version) -> (&'static str, &'static str) {
    let third = version == Version::Three;
    match (std::env::consts::OS, std::env::consts::ARCH, third) {
        ("linux", "x86_64", false) => ("linux64", "so"),
        ("linux", "x86_64", true) => ("x86_64-linux", "so"),
        ("linux", "x86", false) => ("linux32", "so"),
        ("linux", "x86", true) => ("x86-linux", "so"),
        ("linux", "aarch64", _) => ("aarch64-linux", "so"),
        ("macos", "x86_64", true) => ("x86_64-darwin", "dylib"),
        ("macos", "aarch64", true) => ("aarch64-darwin", "dylib"),
        ("macos", _, false) => ("darwin64", "dylib"),
        ("windows", _, false) => ("win64", "dll"),
        ("windows", _, true) => ("x86_64-windows", "dll"),
        _ => ("unknown", "so"),
    }
}

/// The folders in `binaries/` of an archive.
fn platforms(names: &[String]) -> String {
    let folders = names.iter().filter_map(|n| n.strip_prefix("binaries/")?.split_once('/'));
    let mut all: Vec<String> = folders.map(|(folder, _)| format!("`{folder}`")).collect();
    all.sort();
    all.dedup();
    match all.as_slice() {
        [] => "no binaries".to_owned(),
        [one] => format!("only {one}"),
        all => format!("only {}", all.join(", ")),
    }
}

/// An FMU that was opened before and is still in use.
struct Known {
    file: PathBuf,
    wanted: Integrating,
    /// Length and date of the file then.
    stamp: (u64, Option<SystemTime>),
    fmu: Weak<Fmu>,
}

/// The FMUs in use.
static KNOWN: Mutex<Vec<Known>> = Mutex::new(Vec::new());

/// As [`open`], but an FMU that is still in use is not unpacked again: a model with an FMU inside may be compiled
/// hundreds of times.
pub fn open_shared(file: &Path, wanted: Integrating) -> Result<Arc<Fmu>, Box<Diagnostic>> {
    let full = file.canonicalize().unwrap_or_else(|_| file.to_path_buf());
    let found = std::fs::metadata(&full);
    let stamp = found.map_or((0, None), |m| (m.len(), m.modified().ok()));
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known.retain(|k| k.fmu.strong_count() > 0);
    let same = |k: &&Known| k.file == full && k.wanted == wanted && k.stamp == stamp;
    if let Some(fmu) = known.iter().find(same).and_then(|k| k.fmu.upgrade()) {
        return Ok(fmu);
    }
    let fmu = Arc::new(open(file, wanted)?);
    known.push(Known { file: full, wanted, stamp, fmu: Arc::downgrade(&fmu) });
    Ok(fmu)
}

/// Reads an archive and unpacks it into a folder of its own.
pub fn open(file: &Path, wanted: Integrating) -> Result<Fmu, Box<Diagnostic>> {
    let folder = scratch_path("fmu");
    let refuse = |cause: FmuCause| Box::new(Diagnostic::new(cause, Span::NONE));
    let path = file.display().to_string();
    let mut archive = Archive::open(file).map_err(refuse)?;
    let text = archive.description().map_err(refuse)?;
    let described = read(&text).map_err(|why| {
        refuse(match why {
            Unusable::Wrong(why) => FmuCause::BadDescription { path: path.clone(), why },
            Unusable::Version(version) => FmuCause::OtherVersion { path: path.clone(), version },
        })
    })?;
    let (kind, stepping) = kind(&described, wanted, &path).map_err(refuse)?;
    let (platform, extension) = platform(described.version);
    let library = format!("binaries/{platform}/{}.{extension}", kind.identifier);
    if !archive.names.contains(&library) {
        let present = platforms(&archive.names);
        return Err(refuse(FmuCause::NoBinary { path, wanted: library, present }));
    }
    let interface = interface(&described, &kind, stepping);
    let binaries = format!("binaries/{platform}/");
    let load = load(&described, &kind, &interface, &folder, &library);
    // From here on the folder is removed, whatever happens.
    let fmu = Fmu { file: path, folder, interface, load, idle: Idle::default() };
    let resources = fmu.folder.join("resources");
    if let Err(e) = std::fs::create_dir_all(&resources) {
        let (path, why) = (resources.display().to_string(), e.to_string());
        return Err(refuse(FmuCause::FileOfFmu { path, why }));
    }
    let is_needed = |name: &str| name.starts_with(&binaries) || name.starts_with("resources/");
    archive.unpack(&fmu.folder, is_needed).map_err(refuse)?;
    Ok(fmu)
}

/// The kind of simulation to use, and whether it is Co-Simulation.
fn kind(described: &Described, wanted: Integrating, path: &str) -> Result<(Kind, bool), FmuCause> {
    let missing = |wanted: &str, offered: &str| FmuCause::NotOffered {
        path: path.to_owned(),
        wanted: wanted.to_owned(),
        offered: offered.to_owned(),
    };
    let exchange = described.exchange.as_ref().map(|kind| (kind.clone(), false));
    let stepping = described.stepping.as_ref().map(|kind| (kind.clone(), true));
    let (first, second) = match wanted {
        Integrating::Here => (exchange, None),
        Integrating::There => (stepping, None),
        Integrating::RatherHere => (exchange, stepping),
        Integrating::RatherThere => (stepping, exchange),
    };
    first.or(second).ok_or_else(|| match wanted {
        Integrating::There => missing("Co-Simulation", "Model Exchange"),
        _ => missing("Model Exchange", "Co-Simulation"),
    })
}

fn interface(described: &Described, kind: &Kind, stepping: bool) -> ForeignInterface {
    let mut experiment = described.experiment;
    if let (true, Some(step), false) = (stepping, kind.own_step, kind.steps_vary) {
        experiment[2] = Some(step);
    }
    ForeignInterface {
        name: described.name.clone(),
        description: described.text.clone(),
        steps_itself: stepping,
        states: if stepping { 0 } else { described.state_count },
        indicators: if stepping { 0 } else { described.indicators },
        variables: described.variables.clone(),
        values: described.values,
        needs_completed_steps: kind.needs_completed_steps,
        steps_vary: kind.steps_vary || !stepping,
        experiment,
    }
}

fn load(
    described: &Described,
    kind: &Kind,
    interface: &ForeignInterface,
    folder: &Path,
    library: &str,
) -> Load {
    let text = |path: PathBuf| path.to_string_lossy().into_owned();
    let inputs = interface.variables.iter().filter(|v| v.role == ForeignRole::Input);
    Load {
        library: text(folder.join(library)),
        third: described.version == Version::Three,
        shape: interface.shape(),
        token: described.token.clone(),
        resources: text(folder.join("resources")),
        folder: text(folder.to_path_buf()),
        groups: described.groups.clone(),
        inputs: inputs.map(|v| v.value).collect(),
        watched: Vec::new(),
        states: if kind.differentiates { described.states.clone() } else { Vec::new() },
    }
}

impl Fmu {
    /// The token, which differs for each FMU.
    pub fn token(&self) -> &str {
        &self.load.token
    }

    /// An instance that watches these values, in the process of a run that has ended, if there is one.
    pub fn lend(&self, watched: &[usize]) -> Result<Remote, ForeignFault> {
        let idle = self.idle.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        if let Some(mut idle) = idle
            && idle.renew(watched).is_ok()
        {
            return Ok(idle);
        }
        let load = Load { watched: watched.to_vec(), ..self.load.clone() };
        Remote::start(&self.file, load)
    }

    /// Takes instances of runs that have ended well.
    pub fn give_back(&self, instances: Vec<Remote>) {
        let mut idle = self.idle.0.lock().unwrap_or_else(PoisonError::into_inner);
        let room = MOST_IDLE.saturating_sub(idle.len());
        idle.extend(instances.into_iter().take(room));
    }
}

impl ForeignModel for Fmu {
    fn file(&self) -> &str {
        &self.file
    }

    fn interface(&self) -> &ForeignInterface {
        &self.interface
    }

    fn run(
        &self,
        task: &ForeignTask,
        observer: &mut dyn ForeignObserver,
    ) -> Result<ForeignOutcome, ForeignFailure> {
        let watched: Vec<usize> = task.watched.iter().map(|(value, _)| *value).collect();
        let time = task.span[0];
        let lent = self.lend(&watched);
        let mut instance =
            lent.map_err(|fault| ForeignFailure { time, why: Obstacle::Fault(fault) })?;
        let outcome = instance.run(task, observer)?;
        if !outcome.interrupted {
            self.give_back(vec![instance]);
        }
        Ok(outcome)
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        self.idle.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
