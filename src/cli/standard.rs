//! Results on the standard output: an output whose path is `-`.

use std::path::{Path, PathBuf};

use super::args::model::is_standard;
use crate::io::atomic_file::scratch_path;

/// The option whose result goes to the standard output, of options with their paths. Only one can; the error is a
/// message.
pub fn single<'o>(outputs: &[(&'o str, &Option<PathBuf>)]) -> Result<Option<&'o str>, String> {
    let is_piped = |path: &Option<PathBuf>| path.as_deref().is_some_and(is_standard);
    let mut piped = outputs.iter().filter(|(_, path)| is_piped(path)).map(|(option, _)| *option);
    match (piped.next(), piped.next()) {
        (Some(first), Some(second)) => Err(both(&format!("{first} -"), &format!("{second} -"))),
        (first, _) => Ok(first),
    }
}

/// The same together with `--json`, which prints to the standard output as well.
pub fn single_with_json<'o>(
    outputs: &[(&'o str, &Option<PathBuf>)],
    json: bool,
) -> Result<Option<&'o str>, String> {
    match single(outputs)? {
        Some(option) if json => Err(both("--json", &format!("{option} -"))),
        option => Ok(option),
    }
}

fn both(first: &str, second: &str) -> String {
    format!("{first} and {second} both write to the standard output")
}

/// A path, or one of a temporary file with this extension in place of `-`.
pub fn real_path(path: &Path, extension: &str) -> PathBuf {
    if is_standard(path) { scratch_path(extension) } else { path.to_owned() }
}
