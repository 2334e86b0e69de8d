//! The program itself, as a user runs it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What one command left behind.
pub struct Ended {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Runs `mocc` in a folder, without what the environment of the tests could say to it.
pub fn mocc(folder: &Path, arguments: &[&str]) -> Ended {
    command(folder, arguments, &[])
}

/// Runs `mocc` in a folder with variables of the environment.
pub fn command(folder: &Path, arguments: &[&str], environment: &[(&str, &Path)]) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mocc"));
    command.current_dir(folder).args(arguments).env_remove("MODELICAPATH");
    command.envs(environment.iter().map(|(name, value)| (name, value.as_os_str())));
    let output = command.output().expect("mocc starts");
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    Ended {
        status: output.status.code().expect("no signal ended mocc"),
        out: text(&output.stdout),
        err: text(&output.stderr),
    }
}

/// The runtime of FMUs next to the program, if `cargo build --package mocc-fmu` has built it.
pub fn fmu_runtime() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_BIN_EXE_mocc")).with_file_name("libmocc_fmu.so");
    path.exists().then_some(path)
}

/// Runs `mocc` with a text on its standard input.
pub fn piped(folder: &Path, arguments: &[&str], input: &str) -> Ended {
    let mut child = Command::new(env!("CARGO_BIN_EXE_mocc"))
        .current_dir(folder)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("mocc starts");
    child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    let status = output.status.code().expect("no signal");
    Ended { status, out: text(&output.stdout), err: text(&output.stderr) }
}
