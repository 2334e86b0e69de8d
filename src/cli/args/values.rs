//! Values of arguments: a text in, a value or what should be written instead out.

use std::path::PathBuf;

use super::linear::At;

/// A picture by its extension, or `-` for SVG on the standard output.
pub fn picture(text: &str) -> Result<PathBuf, String> {
    file(text, &["svg", "png"])
}

/// A page by its extension, or `-` for the standard output.
pub fn page(text: &str) -> Result<PathBuf, String> {
    file(text, &["html", "htm"])
}

/// A Functional Mock-up Unit by its extension, or `-` for the standard output.
pub fn fmu(text: &str) -> Result<PathBuf, String> {
    file(text, &["fmu"])
}

/// A file of models by its extension, or `-` for the standard output.
pub fn modelica(text: &str) -> Result<PathBuf, String> {
    file(text, &["mo", "mol"])
}

/// A plan by its extension, or `-` for the standard output.
pub fn plan(text: &str) -> Result<PathBuf, String> {
    file(text, &["toml"])
}

/// A file of JUnit by its extension, or `-` for the standard output.
pub fn junit(text: &str) -> Result<PathBuf, String> {
    file(text, &["xml"])
}

/// A graph for Graphviz by its extension, or `-` for the standard output.
pub fn graph(text: &str) -> Result<PathBuf, String> {
    file(text, &["dot", "gv"])
}

/// A file for JSON by its extension, or `-` for the standard output.
pub fn json(text: &str) -> Result<PathBuf, String> {
    file(text, &["json"])
}

/// A folder: the standard output, `-`, is none.
pub fn folder(text: &str) -> Result<PathBuf, String> {
    match text {
        "-" => {
            Err("several files are written, which the standard output cannot take; name a folder"
                .to_owned())
        }
        "" => Err("name a folder".to_owned()),
        path => Ok(PathBuf::from(path)),
    }
}

/// A file with one of these extensions, or `-`.
fn file(text: &str, known: &[&str]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match text == "-" || extension.as_deref().is_some_and(|e| known.contains(&e)) {
        true => Ok(path),
        false => {
            let names: Vec<String> = known.iter().map(|e| format!(".{e}")).collect();
            Err(format!("its name must end in {}", names.join(" or ")))
        }
    }
}

/// `NAME=UNIT`
pub fn unit_of(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').map(|(name, unit)| (name.trim(), unit.trim()));
    let pair = pair.filter(|(name, unit)| !name.is_empty() && !unit.is_empty());
    let (name, unit) = pair.ok_or_else(|| "write NAME=UNIT".to_owned())?;
    Ok((name.to_owned(), unit.to_owned()))
}

/// `FROM:TO`
pub fn ends(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let ends = text.split_once(':').and_then(|(from, to)| Some((number(from)?, number(to)?)));
    ends.filter(|(from, to)| from < to).ok_or_else(|| "write FROM:TO, two numbers".to_owned())
}

/// `steady`, or an instant.
pub fn at(text: &str) -> Result<At, String> {
    if text.trim() == "steady" {
        return Ok(At::Steady);
    }
    let time = text.trim().parse::<f64>().ok().filter(|t| t.is_finite());
    time.map(At::Time).ok_or_else(|| "write a time in s, or `steady`".to_owned())
}

/// A number that is not negative.
pub fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|t| t.is_finite() && *t >= 0.0);
    number.ok_or_else(|| "write a number that is not negative".to_owned())
}

/// A time in s that is not negative.
pub fn seconds(text: &str) -> Result<f64, String> {
    let time = text.trim().parse::<f64>().ok().filter(|t| t.is_finite() && *t >= 0.0);
    time.ok_or_else(|| "write a time in s".to_owned())
}
