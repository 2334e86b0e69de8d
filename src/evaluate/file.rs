//! External functions on files, from their documentation: what they read is known before the model runs.
//! What a model prints to a file is written by the run, line by line; nothing else is written: a function that says whether it could write says that it could not.

use std::path::Path;

use super::Context;
use super::external::Refusal;
use super::value::Value;
use crate::base::diag::Diagnostic;
use crate::base::name::name;
use crate::base::source::Span;
use crate::io::matrix_file::{self, Matrix};
use crate::ir::expr::Const;
use crate::ir::flat::Level;

impl Context<'_> {
    /// A function of the families `ModelicaInternal_`, `ModelicaStreams_` and `ModelicaIO_`.
    pub(super) fn file_function(
        &mut self,
        called: &str,
        args: &[Value],
        span: Span,
    ) -> Result<Vec<Value>, Refusal> {
        match (called, args) {
            // What the run prints. A message while a model is compiled is not for its user.
            ("ModelicaInternal_print", [text, file]) => {
                let file = self.text_of(file)?;
                let text = text.scalar().ok_or(Refusal::Unknown)?;
                let never = self.graph.boolean(false);
                let level = Level::Print(name(&file));
                self.assert_now_or_later(never, text, level, span).ok_or(Refusal::Reported)?;
                Ok(Vec::new())
            }
            ("ModelicaStreams_closeFile", _) => Ok(Vec::new()),
            ("ModelicaInternal_fullPathName", [name]) => {
                let uri = self.text_of(name)?;
                let path = self
                    .library
                    .resource(&uri)
                    .ok_or_else(|| Refusal::Wrong(format!("there is no package for `{uri}`")))?;
                Ok(vec![Value::Scalar(self.graph.string(&path.to_string_lossy()))])
            }
            ("ModelicaInternal_stat", [name]) => {
                let name = self.text_of(name)?;
                let kind = if self.library.data(Path::new(&name)).is_ok() { 2 } else { 1 };
                let of = self.enumeration_of(["NoFile", "RegularFile", "Directory", "SpecialFile"]);
                let of = of.ok_or(Refusal::Unknown)?;
                Ok(vec![Value::Scalar(self.graph.constant(Const::Enumeration(of, kind)))])
            }
            ("ModelicaInternal_countLines", [file]) => {
                let count = self.lines(file)?.len();
                Ok(vec![Value::Scalar(self.graph.integer(count as i64))])
            }
            ("ModelicaInternal_readFile", [file, ..]) => {
                let lines = self.lines(file)?;
                let lines = lines.iter().map(|l| self.graph.string(l)).collect();
                Ok(vec![Value::vector(lines)])
            }
            ("ModelicaInternal_readLine", [file, number]) => {
                let lines = self.lines(file)?;
                let Some(Const::Integer(k)) = self.known(number)?.first().copied() else {
                    return Err(Refusal::Unknown);
                };
                let line = usize::try_from(k - 1).ok().and_then(|k| lines.get(k));
                let text = self.graph.string(line.map_or("", String::as_str));
                let ended = self.graph.boolean(line.is_none());
                Ok(vec![Value::Scalar(text), Value::Scalar(ended)])
            }
            ("ModelicaIO_readMatrixSizes", [file, name]) => {
                let (file, name) = (self.text_of(file)?, self.text_of(name)?);
                let matrix = self.matrix_in_file(&file, &name)?;
                let sizes = [matrix.rows, matrix.columns];
                let sizes = sizes.map(|n| self.graph.integer(n as i64));
                Ok(vec![Value::vector(sizes.to_vec())])
            }
            ("ModelicaIO_readRealMatrix", [file, name, ..]) => {
                let (file, name) = (self.text_of(file)?, self.text_of(name)?);
                let matrix = self.matrix_in_file(&file, &name)?;
                let dims = vec![matrix.rows, matrix.columns];
                let elements = matrix.elements.iter();
                let elements = elements.map(|x| Value::Scalar(self.graph.real(*x))).collect();
                Ok(vec![Value::array(dims, elements)])
            }
            ("ModelicaIO_writeRealMatrix", _) => {
                self.problems.push(
                    Diagnostic::warning("MO0291", span, "a model writes no files")
                        .help("the results of a run are written with `--output`"),
                );
                Ok(vec![Value::Scalar(self.graph.boolean(false))])
            }
            _ => Err(Refusal::Unknown),
        }
    }

    fn lines(&mut self, file: &Value) -> Result<Vec<String>, Refusal> {
        let file = self.text_of(file)?;
        let bytes = self.bytes(&file)?;
        let text = String::from_utf8_lossy(&bytes);
        Ok(text.lines().map(str::to_string).collect())
    }

    /// The matrix of a name in a file of data.
    pub(super) fn matrix_in_file(&mut self, file: &str, name: &str) -> Result<Matrix, Refusal> {
        let bytes = self.bytes(file)?;
        matrix_file::matrix(&bytes, name).map_err(|why| Refusal::Wrong(format!("`{file}`: {why}")))
    }

    fn bytes(&mut self, file: &str) -> Result<Vec<u8>, Refusal> {
        let bytes = self.library.data(Path::new(file));
        bytes.map_err(|why| Refusal::Wrong(format!("`{file}`: {why}")))
    }
}
