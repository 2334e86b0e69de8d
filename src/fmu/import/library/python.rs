//! Python for FMUs that are written in it.
//!
//! The libraries of such FMUs, as PythonFMU makes them, name functions of Python without naming a library that has them:
//! they expect to run in a process of Python. If this process is none, the shared library of the `python3` in the PATH
//! is loaded, for all to see, and started as that Python would start itself, so that its packages are found.

use std::ffi::c_int;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_LAZY};

/// Prints its program, the folder and the names of its shared library, and its own folder, a line each.
const ASK: &str = "import sys, sysconfig as s
of = s.get_config_var
print(sys.executable, of('LIBDIR') or '', of('INSTSONAME') or '', of('LDLIBRARY') or '', sys.base_prefix, sep='\\n')";

/// Whether a library was refused since it needs Python, by the words of the loader.
pub fn is_missed(why: &str) -> bool {
    let symbols = why.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let is_of_python = |word: &str| {
        let name = word.trim_start_matches('_');
        name.strip_prefix("Py")
            .is_some_and(|rest| rest.starts_with(|c: char| c == '_' || c.is_ascii_uppercase()))
    };
    why.contains("symbol") && symbols.into_iter().any(is_of_python)
}

/// Loads and starts Python. Errors: why there is none.
pub fn start() -> Result<(), String> {
    let asked = Command::new("python3")
        .args(["-c", ASK])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .map_err(|e| format!("`python3` cannot be started: {e}"))?;
    let text = String::from_utf8_lossy(&asked.stdout).into_owned();
    let lines: Vec<&str> = text.lines().collect();
    let [program, folder, name, other, prefix] = lines[..] else {
        return Err("`python3` does not answer".to_owned());
    };
    let names = || [name, other].into_iter().filter(|n| n.contains(".so") || n.contains(".dylib"));
    if names().next().is_none() {
        return Err(format!("the Python in `{program}` was built without a shared library"));
    }
    let places = [PathBuf::from(folder), Path::new(prefix).join("lib"), PathBuf::new()];
    let candidates = places.iter().flat_map(|place| names().map(move |name| place.join(name)));
    // SAFETY: the user asks for code that runs in Python, and this is the one that the user has.
    let loaded = candidates
        .filter_map(|path| unsafe { Library::open(Some(path), RTLD_LAZY | RTLD_GLOBAL) }.ok())
        .next();
    let library = loaded.ok_or_else(|| {
        format!("`{name}`, the shared library of the Python in `{program}`, is not installed")
    })?;
    let begun = begin(&library, program).map_err(|e| format!("`{name}`: {e}"));
    std::mem::forget(library);
    begun
}

/// Starts the interpreter, whose program tells it where its packages are, and leaves its lock to the FMU.
fn begin(library: &Library, program: &str) -> Result<(), libloading::Error> {
    // On all systems with `dlopen` a wide character is one code point.
    let name: Vec<u32> = program.chars().map(u32::from).chain([0]).collect();
    // SAFETY: signatures of the stable interface of Python, in the order that it asks for; the name is never freed.
    unsafe {
        if let Ok(set) = library.get::<unsafe extern "C" fn(*const u32)>(b"Py_SetProgramName") {
            set(name.leak().as_ptr());
        }
        library.get::<unsafe extern "C" fn(c_int)>(b"Py_InitializeEx")?(0);
        library.get::<unsafe extern "C" fn() -> *mut std::ffi::c_void>(b"PyEval_SaveThread")?();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_of_python_are_known() {
        assert!(is_missed("/tmp/a.so: undefined symbol: _Py_NoneStruct"));
        assert!(is_missed("/tmp/a.so: undefined symbol: PyFloat_AsDouble"));
        assert!(is_missed("symbol not found in flat namespace '_PyBool_FromLong'"));
        assert!(!is_missed("/tmp/Pylon.so: undefined symbol: pump_start"));
        assert!(!is_missed("libPyThing.so: cannot open shared object file"));
    }
}
