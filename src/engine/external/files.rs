//! The functions of `ModelicaInternal` and `ModelicaIO` that read files.
//!
//! In: known arguments and the [`Files`] that may be read. Out: known results. Nothing is written
//! here.
//! *Modelica Standard Library 4.1.0, `Modelica.Utilities.Files` and `Modelica.Utilities.Streams`.*

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::component::Component;
use super::{Data, Fault, integer, string};
use crate::io::matrix_file::{self, Matrix};

/// Access to the files of a model.
pub trait Files {
    /// The contents of a file; the message says why it cannot be read.
    fn read(&mut self, path: &Path) -> Result<Vec<u8>, String>;
    /// The foreign model in an FMU with this token; the message says why it cannot be used.
    fn component(&mut self, path: &Path, token: &str) -> Result<Arc<dyn Component>, String>;
    /// The path of a `modelica://` URI; `None` if its package does not exist.
    fn resource(&mut self, uri: &str) -> Option<PathBuf>;
}

/// The literals of `Modelica.Utilities.Types.FileType`.
const FILE_TYPE: [&str; 4] = ["NoFile", "RegularFile", "Directory", "SpecialFile"];

type Reading = fn(&[Data], &mut dyn Files) -> Result<Vec<Data>, Fault>;

/// The functions by their names in C.
pub(super) const FUNCTIONS: [(&str, Reading); 7] = [
    ("ModelicaInternal_fullPathName", full_path_name),
    ("ModelicaInternal_stat", stat),
    ("ModelicaInternal_countLines", count_lines),
    ("ModelicaInternal_readFile", read_file),
    ("ModelicaInternal_readLine", read_line),
    ("ModelicaIO_readMatrixSizes", read_matrix_sizes),
    ("ModelicaIO_readRealMatrix", read_real_matrix),
];

/// The matrix called `name` in a text or MAT file.
pub fn matrix(file: &str, name: &str, files: &mut dyn Files) -> Result<Matrix, Fault> {
    let bytes = contents(file, files)?;
    matrix_file::matrix(&bytes, name).map_err(|why| Fault::Message(format!("`{file}`: {why}")))
}

fn contents(file: &str, files: &mut dyn Files) -> Result<Vec<u8>, Fault> {
    files.read(Path::new(file)).map_err(|why| Fault::Message(format!("`{file}`: {why}")))
}

fn lines(args: &[Data], files: &mut dyn Files) -> Result<Vec<String>, Fault> {
    let bytes = contents(string(args, 0)?, files)?;
    Ok(String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect())
}

fn full_path_name(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    let uri = string(args, 0)?;
    match files.resource(uri) {
        Some(path) => Ok(vec![Data::String(path.to_string_lossy().into_owned())]),
        None => Err(Fault::Message(format!("there is no package for `{uri}`"))),
    }
}

fn stat(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    let exists = files.read(Path::new(string(args, 0)?)).is_ok();
    Ok(vec![Data::Literal(&FILE_TYPE, if exists { 2 } else { 1 })])
}

fn count_lines(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    Ok(vec![Data::Integer(lines(args, files)?.len() as i64)])
}

fn read_file(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    let lines: Vec<Data> = lines(args, files)?.into_iter().map(Data::String).collect();
    Ok(vec![Data::Array(vec![lines.len()], lines)])
}

/// The line, and whether the file ends before it.
fn read_line(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    let lines = lines(args, files)?;
    let line = usize::try_from(integer(args, 1)? - 1).ok().and_then(|k| lines.get(k));
    let is_at_end = line.is_none();
    Ok(vec![Data::String(line.cloned().unwrap_or_default()), Data::Boolean(is_at_end)])
}

fn read_matrix_sizes(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    let matrix = matrix(string(args, 0)?, string(args, 1)?, files)?;
    let sizes = [matrix.rows, matrix.columns].map(|n| Data::Integer(n as i64));
    Ok(vec![Data::Array(vec![2], sizes.to_vec())])
}

fn read_real_matrix(args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
    let matrix = matrix(string(args, 0)?, string(args, 1)?, files)?;
    let elements = matrix.elements.iter().map(|x| Data::Real(*x)).collect();
    Ok(vec![Data::Array(vec![matrix.rows, matrix.columns], elements)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One file in memory.
    struct OneFile(&'static str, &'static str);

    impl Files for OneFile {
        fn read(&mut self, path: &Path) -> Result<Vec<u8>, String> {
            let found = path == Path::new(self.0);
            found.then(|| self.1.into()).ok_or_else(|| "no such file".to_owned())
        }

        fn component(&mut self, _: &Path, _: &str) -> Result<Arc<dyn Component>, String> {
            Err("there are no FMUs".to_owned())
        }

        fn resource(&mut self, uri: &str) -> Option<PathBuf> {
            uri.strip_prefix("modelica://A/").map(PathBuf::from)
        }
    }

    fn of(function: &str, args: &[Data], file: &mut OneFile) -> Result<Vec<Data>, Fault> {
        super::super::Function::named(function).expect("a known function").call(args, file)
    }

    #[test]
    fn lines_are_counted_from_one() {
        let mut file = OneFile("a.txt", "first\nsecond\n");
        let a = Data::String("a.txt".into());
        let mut line =
            |k| of("ModelicaInternal_readLine", &[a.clone(), Data::Integer(k)], &mut file);
        let read = |text: &str, ended| Ok(vec![Data::String(text.into()), Data::Boolean(ended)]);
        assert_eq!(line(2), read("second", false));
        assert_eq!(line(3), read("", true));
        assert_eq!(line(0), read("", true));
        let count = of("ModelicaInternal_countLines", &[a], &mut file);
        assert_eq!(count, Ok(vec![Data::Integer(2)]));
    }

    #[test]
    fn matrices_have_sizes_and_elements() {
        let mut file = OneFile("a.txt", "#1\ndouble m(2, 3)\n1 2 3\n4 5 6\n");
        let args = ["a.txt", "m"].map(|s| Data::String(s.into()));
        let sizes = of("ModelicaIO_readMatrixSizes", &args, &mut file);
        assert_eq!(sizes, Ok(vec![Data::Array(vec![2], vec![Data::Integer(2), Data::Integer(3)])]));
        let elements = (1..=6).map(|k| Data::Real(f64::from(k))).collect();
        let matrix = of("ModelicaIO_readRealMatrix", &args, &mut file);
        assert_eq!(matrix, Ok(vec![Data::Array(vec![2, 3], elements)]));
    }

    #[test]
    fn a_missing_file_is_named() {
        let mut file = OneFile("a.txt", "");
        let missing = of("ModelicaInternal_readFile", &[Data::String("b.txt".into())], &mut file);
        assert_eq!(missing, Err(Fault::Message("`b.txt`: no such file".into())));
        let stat = of("ModelicaInternal_stat", &[Data::String("b.txt".into())], &mut file);
        assert_eq!(stat, Ok(vec![Data::Literal(&FILE_TYPE, 1)]));
    }
}
