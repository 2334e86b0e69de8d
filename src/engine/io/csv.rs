//! CSV tables (RFC 4180). Written numbers read back exactly. Sole user of `csv` (reading) and
//! `zmij` (printing numbers).

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::atomic_file::{AtomicFile, WriteError};
use super::results::ResultWriter;
use crate::ir::trajectory::{Column, ColumnStorage, Kind, Trajectory};

/// Why a table was not written.
#[derive(Error, Debug)]
pub enum TableError {
    /// A value is NaN or infinite, which results never contain.
    #[error("`{name}` is {value} at time {time} s")]
    NotFinite {
        /// The column, or `time`.
        name: String,
        /// NaN or an infinity.
        value: f64,
        /// Time of the row, s.
        time: f64,
    },
    /// A row is not as long as the header.
    #[error("a row at time {time} s has {found} values for {expected} columns")]
    RowLength {
        /// Number of values given.
        found: usize,
        /// Number of columns.
        expected: usize,
        /// Time of the row, s.
        time: f64,
    },
    /// A value of an Integer column is not an integer, or too large for the format.
    #[error("`{name}` is {value} at time {time} s, which is not an Integer of 64 bits")]
    NotWhole {
        /// The column.
        name: String,
        /// The value.
        value: f64,
        /// Time of the row, s.
        time: f64,
    },
    /// The format cannot hold so many columns or rows.
    #[error("{what} {count} is more than the format can hold; write .csv or .parquet")]
    TooLarge {
        /// The counted objects.
        what: &'static str,
        /// The number.
        count: usize,
    },
    /// Writing failed.
    #[error("cannot write the table: {0}")]
    Output(#[from] io::Error),
    /// The file could not be created.
    #[error(transparent)]
    File(#[from] WriteError),
}

/// Writes a table row by row; allocates only in [`TableWriter::new`].
pub struct TableWriter<W: Write> {
    out: W,
    /// Header names with `time` in front.
    names: Vec<String>,
    /// True for columns of Booleans and Integers.
    whole: Vec<bool>,
    /// For each column, one before it that it probably equals up to the sign, or itself.
    twins: Vec<usize>,
    /// The current row and the previous one.
    row: Row,
    before: Row,
}

/// A formatted row. Runs of values that equal those of the previous row are copied as text: many
/// variables of a run are constant, and copying is many times faster than formatting.
struct Row {
    text: Vec<u8>,
    /// The bits of each value.
    bits: Vec<u64>,
    /// End of the text of each value.
    ends: Vec<usize>,
}

/// Maximum length of an f64 (`-2.2250738585072014e-308`) with its comma.
const MAX_NUMBER_LENGTH: usize = 25;

/// The bit of a negative number.
const SIGN: u64 = 1 << 63;

impl<W: Write> TableWriter<W> {
    /// Writes the header `time,NAME,...` and allocates one row.
    pub fn new(mut out: W, columns: &[Column]) -> Result<Self, TableError> {
        let mut header = String::from("time");
        for column in columns {
            header.push(',');
            push_quoted(&mut header, &column.name);
        }
        header.push('\n');
        out.write_all(header.as_bytes())?;
        let width = columns.len() + 1;
        let row = || Row {
            text: Vec::with_capacity(width * MAX_NUMBER_LENGTH),
            bits: Vec::with_capacity(width),
            ends: Vec::with_capacity(width),
        };
        let whole = |kind| matches!(kind, Kind::Boolean | Kind::Integer);
        Ok(TableWriter {
            out,
            names: std::iter::once("time".to_owned())
                .chain(columns.iter().map(|c| c.name.clone()))
                .collect(),
            whole: std::iter::once(false).chain(columns.iter().map(|c| whole(c.kind))).collect(),
            twins: (0..width).collect(),
            row: row(),
            before: row(),
        })
    }
    /// Of columns of which some probably equal others: their numbers are copied as text.
    pub fn with_storage(mut self, storage: &[ColumnStorage]) -> Self {
        for (twin, storage) in self.twins[1..].iter_mut().zip(storage) {
            if let ColumnStorage::Alias { of, .. } = storage {
                *twin = of + 1;
            }
        }
        self
    }
    /// Writes one row; `values` in the order of the columns. A rejected row writes nothing.
    pub fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        let (found, expected) = (values.len(), self.names.len() - 1);
        if found != expected {
            return Err(TableError::RowLength { found, expected, time });
        }
        self.format(time, values)?;
        // The trailing comma is kept in the buffer, so that all values can be copied alike.
        let text = &self.row.text;
        self.out.write_all(&text[..text.len() - 1])?;
        self.out.write_all(b"\n")?;
        std::mem::swap(&mut self.row, &mut self.before);
        Ok(())
    }
    /// Flushes and returns the output.
    pub fn finish(mut self) -> Result<W, TableError> {
        self.out.flush()?;
        Ok(self.out)
    }
    /// Fills `row`, reading `before`.
    fn format(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        let Row { text, bits, ends } = &mut self.row;
        let (before, cells) = (&self.before, self.names.len());
        text.clear();
        bits.resize(cells, 0);
        ends.resize(cells, 0);
        bits[0] = time.to_bits();
        for (bits, value) in bits[1..].iter_mut().zip(values) {
            *bits = value.to_bits();
        }
        // None before the first row.
        let known = before.bits.len();
        let mut i = 0;
        while i < cells {
            // `before` contains only finite values, so equal values are finite.
            let mut next = i;
            while next < known && bits[next] == before.bits[next] {
                next += 1;
            }
            if next > i {
                let start = if i == 0 { 0 } else { before.ends[i - 1] };
                let here = text.len();
                for (end, earlier) in ends[i..next].iter_mut().zip(&before.ends[i..next]) {
                    *end = earlier - start + here;
                }
                text.extend_from_slice(&before.text[start..before.ends[next - 1]]);
            }
            i = next;
            let Some(&changed) = bits.get(i) else { break };
            let value = f64::from_bits(changed);
            if !value.is_finite() {
                return Err(TableError::NotFinite { name: self.names[i].clone(), value, time });
            }
            let twin = self.twins[i];
            let is_same_kind = twin < i && self.whole[i] == self.whole[twin];
            let differing = bits[twin] ^ changed;
            if is_same_kind && (differing == 0 || (differing == SIGN && !self.whole[i])) {
                let start = if twin == 0 { 0 } else { ends[twin - 1] };
                let is_negative = text[start] == b'-';
                if differing != 0 && !is_negative {
                    text.push(b'-');
                }
                text.extend_from_within(
                    start + usize::from(differing != 0 && is_negative)..ends[twin],
                );
            } else {
                push_number(text, value, self.whole[i]);
                text.push(b',');
            }
            ends[i] = text.len();
            i += 1;
        }
        Ok(())
    }
}

impl ResultWriter for TableWriter<AtomicFile> {
    fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        TableWriter::row(self, time, values)
    }

    fn finish(self: Box<Self>, _end: f64) -> Result<AtomicFile, TableError> {
        TableWriter::finish(*self)
    }
}

/// Writes a trajectory to `path`; see [`AtomicFile`].
pub fn write_csv(trajectory: &Trajectory, path: impl AsRef<Path>) -> Result<(), TableError> {
    table_to(AtomicFile::create(path)?, trajectory)?.finish()?;
    Ok(())
}

/// A trajectory as the text of a table.
pub fn text_of(trajectory: &Trajectory) -> Result<String, TableError> {
    let bytes = table_to(Vec::new(), trajectory)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn table_to<W: Write>(out: W, trajectory: &Trajectory) -> Result<W, TableError> {
    let mut table = TableWriter::new(out, &trajectory.columns)?;
    let mut row = vec![0.0; trajectory.columns.len()];
    for (i, &time) in trajectory.time.iter().enumerate() {
        for (cell, values) in row.iter_mut().zip(&trajectory.data) {
            *cell = values[i];
        }
        table.row(time, &row)?;
    }
    table.finish()
}

/// Prints integers below 2^53 without a point if the column is `whole`, otherwise the shortest text
/// that reads back as the same value. A negative zero keeps its sign, except in columns of
/// integers.
pub(crate) fn push_number(text: &mut Vec<u8>, value: f64, whole: bool) {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let value = if whole { value + 0.0 } else { value };
    let plain = whole && value.fract() == 0.0 && value.abs() < EXACT;
    let mut buffer = zmij::Buffer::new();
    let digits = buffer.format_finite(value);
    let digits = if plain { digits.strip_suffix(".0").unwrap_or(digits) } else { digits };
    text.extend_from_slice(digits.as_bytes());
}

/// Appends a name, quoted if it contains a comma, a quote or a line break.
pub(crate) fn push_quoted(header: &mut String, name: &str) {
    if name.contains([',', '"', '\n', '\r']) {
        header.push('"');
        header.push_str(&name.replace('"', "\"\""));
        header.push('"');
    } else {
        header.push_str(name);
    }
}

/// Why a table could not be read; positions count from 1.
#[derive(Error, Debug)]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// Not a table: unbalanced quotes or invalid UTF-8.
    #[error("{}:{line}: not a table: {what}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// Description of the error.
        what: String,
    },
    /// There is no header.
    #[error("{} is empty: a header line with names is needed, the time first", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// There is one column where there must be several.
    #[error("{} is not a table: its first line does not name two columns or more", path.display())]
    OneColumn {
        /// The file.
        path: PathBuf,
    },
    /// Two columns have the same name, or a column has none.
    #[error("{}:1: column {column}: {what}", path.display())]
    Name {
        /// The file.
        path: PathBuf,
        /// Position of the column.
        column: usize,
        /// Description of the error.
        what: String,
    },
    /// A line has more or fewer fields than the header.
    #[error("{}:{line}: {found} fields, but the header names {expected}", path.display())]
    FieldCount {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// Number of fields in the line.
        found: usize,
        /// Number of names in the header.
        expected: usize,
    },
    /// A field is not a finite number.
    #[error("{}:{line}: column {column} (`{name}`): `{text}` is not a finite number", path.display())]
    NotANumber {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// Position of the column.
        column: usize,
        /// Name of the column.
        name: String,
        /// The field.
        text: String,
    },
    /// A line is earlier than the one before it.
    #[error("{}:{line}: the time goes back from {before} s to {after} s", path.display())]
    TimeDecreases {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// Time of the line before, s.
        before: f64,
        /// Time of the line, s.
        after: f64,
    },
}

/// Reads a table of numbers with a header; the column `time`, or without one the first, is the time in s.
/// The columns have no units and count as continuous. Spaces around fields and a byte order mark
/// are skipped.
pub fn read_csv(path: impl AsRef<Path>) -> Result<Trajectory, ReadError> {
    trajectory_of(path.as_ref(), read_text(&path)?)
}

/// The trajectory of a table, which `path` names in messages; its column `time`, or else its first, is the time.
pub fn trajectory_of(path: &Path, table: TextTable) -> Result<Trajectory, ReadError> {
    let at = || path.to_path_buf();
    let names = table.names;
    let time = names.iter().position(|n| matches!(n.as_str(), "time" | "Time")).unwrap_or(0);
    let others = names.iter().enumerate().filter(|(k, _)| *k != time);
    let mut run = Trajectory::new(others.map(|(_, n)| Column::new(n.as_str(), "")).collect());
    let mut values = vec![0.0; names.len()];
    for (line, record) in table.rows {
        for (i, field) in record.iter().enumerate() {
            values[i] = field.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| {
                let (name, text) = (names[i].clone(), field.to_owned());
                ReadError::NotANumber { path: at(), line, column: i + 1, name, text }
            })?;
        }
        // The time before the others, which keep their order.
        values[..=time].rotate_right(1);
        if let Some(&before) = run.time.last().filter(|&&before| values[0] < before) {
            let after = values[0];
            return Err(ReadError::TimeDecreases { path: at(), line, before, after });
        }
        run.push(values[0], &values[1..]);
    }
    Ok(run)
}

/// A table of strings.
#[derive(Clone, PartialEq, Debug)]
pub struct TextTable {
    /// Names of the columns, all different.
    pub names: Vec<String>,
    /// Lines with their numbers, counted from 1, each as long as `names`.
    pub rows: Vec<(u64, Vec<String>)>,
}

impl TextTable {
    /// Position of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }
}

/// Reads a table of strings with a header. Spaces around fields and a byte order mark are skipped.
/// Fields are separated by commas, or by semicolons or tabs if the header has no comma. Between semicolons a number may
/// have a decimal comma.
pub fn read_text(path: impl AsRef<Path>) -> Result<TextTable, ReadError> {
    let path = path.as_ref();
    let open = |source| ReadError::Open { path: path.to_path_buf(), source };
    table_of(path, &std::fs::read(path).map_err(open)?)
}

/// The same of the bytes of a file, which `path` names in messages.
pub fn table_of(path: &Path, bytes: &[u8]) -> Result<TextTable, ReadError> {
    let at = || path.to_path_buf();
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let separator = delimiter(bytes);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let mut record = csv::StringRecord::new();
    let mut next = |record: &mut csv::StringRecord| {
        reader.read_record(record).map_err(|error| ReadError::Syntax {
            path: at(),
            line: error.position().map_or(1, csv::Position::line),
            what: match error.kind() {
                csv::ErrorKind::Utf8 { .. } => "the text is not UTF-8".to_owned(),
                _ => error.to_string(),
            },
        })
    };
    if !next(&mut record)? {
        return Err(ReadError::Empty { path: at() });
    }
    let names: Vec<String> = record.iter().map(str::to_owned).collect();
    check_names(&names, path)?;
    let mut rows = Vec::new();
    let mut counted = Lines { bytes, at: 0, line: 1 };
    while next(&mut record)? {
        let line = counted.of(&record);
        if record.len() != names.len() {
            let (found, expected) = (record.len(), names.len());
            return Err(ReadError::FieldCount { path: at(), line, found, expected });
        }
        let field = |text: &str| match separator {
            b';' => with_point(text),
            _ => text.to_owned(),
        };
        rows.push((line, record.iter().map(field).collect()));
    }
    Ok(TextTable { names, rows })
}

/// A number with a decimal comma as one with a point; another text as it is.
fn with_point(text: &str) -> String {
    let changed = || Some(text.replace(',', ".")).filter(|plain| plain.parse::<f64>().is_ok());
    let is_one = text.matches(',').count() == 1;
    if is_one { changed() } else { None }.unwrap_or_else(|| text.to_owned())
}

/// Counts lines up to the current record.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

impl Lines<'_> {
    /// The line of a record; records must come in order. `csv` includes preceding empty lines in
    /// the position of a record.
    fn of(&mut self, record: &csv::StringRecord) -> u64 {
        let bytes = self.bytes;
        let start = record.position().map_or(0, |p| p.byte() as usize).min(bytes.len());
        let empty = bytes[start..].iter().take_while(|b| matches!(b, b'\r' | b'\n')).count();
        let passed = &bytes[self.at..start + empty];
        self.line += passed.iter().filter(|b| **b == b'\n').count() as u64;
        self.at = start + empty;
        self.line
    }
}

/// The field separator.
fn delimiter(bytes: &[u8]) -> u8 {
    let header = bytes.split(|b| *b == b'\n').next().unwrap_or(bytes);
    [b',', b';', b'\t'].into_iter().find(|d| header.contains(d)).unwrap_or(b',')
}

/// Checks that all columns have different names.
fn check_names(names: &[String], path: &Path) -> Result<(), ReadError> {
    for (i, name) in names.iter().enumerate() {
        let what = if name.is_empty() {
            "has no name".to_owned()
        } else if name.parse::<f64>().is_ok() {
            format!("`{name}` is a number; a header line with names is needed")
        } else if let Some(earlier) = names[..i].iter().position(|n| n == name) {
            format!("`{name}` is also the name of column {}", earlier + 1)
        } else {
            continue;
        };
        return Err(ReadError::Name { path: path.to_path_buf(), column: i + 1, what });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::atomic_file::tests::Scratch;

    fn text(columns: &[Column], rows: &[(f64, &[f64])]) -> Result<String, TableError> {
        let mut table = TableWriter::new(Vec::new(), columns)?;
        for (time, values) in rows {
            table.row(*time, values)?;
        }
        Ok(String::from_utf8(table.finish()?).unwrap())
    }

    #[test]
    fn every_f64_comes_back_to_the_bit() {
        let mut values = vec![
            0.0,
            -0.0,
            0.1,
            1.0 / 3.0,
            5e-324,
            -5e-324,
            f64::MIN_POSITIVE,
            f64::MIN_POSITIVE.next_down(),
            f64::MAX,
            f64::MIN,
            f64::EPSILON,
            1e16,
            123456789012345680.0,
            1e23,
            9007199254740993.0,
            2.2250738585072014e-308,
        ];
        // All exponents and signs, digits by a multiplicative generator.
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        while values.len() < 20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            values.push(f64::from_bits(state ^ (state >> 29)));
            if !values[values.len() - 1].is_finite() {
                values.pop();
            }
        }
        let mut run = Trajectory::new(vec![Column::new("a[1,2]", "m"), Column::new("q\"x", "")]);
        for (i, pair) in values.chunks(2).enumerate() {
            run.push(i as f64 * 0.1, pair);
        }
        let dir = Scratch::new("bits");
        write_csv(&run, dir.path("run.csv")).unwrap();
        let back = read_csv(dir.path("run.csv")).unwrap();
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(back.columns[0].name, "a[1,2]");
        assert_eq!(back.columns[1].name, "q\"x");
        assert_eq!(bits(&back.time), bits(&run.time));
        for (a, b) in back.data.iter().zip(&run.data) {
            assert_eq!(bits(a), bits(b));
        }
        assert_eq!(dir.files(), ["run.csv"]);
    }

    #[test]
    fn whole_columns_are_plain_and_event_rows_stay_two() {
        let kind = |name: &str, kind| Column { kind, ..Column::new(name, "") };
        let columns = [
            Column::new("a[1,2]", "m"),
            kind("closed", Kind::Boolean),
            kind("n", Kind::Integer),
            kind("huge", Kind::Integer),
        ];
        let rows: [(f64, &[f64]); 4] = [
            (0.0, &[1.0, 0.0, -3.0, 1e300]),
            (0.25, &[1.5, 0.0, -3.0, 1e300]),
            (0.25, &[1.5, 1.0, 12.0, 1e300]),
            (0.5, &[1.5, 1.0, -0.0, 1e300]),
        ];
        assert_eq!(
            text(&columns, &rows).unwrap(),
            "time,\"a[1,2]\",closed,n,huge\n\
             0.0,1.0,0,-3,1e+300\n\
             0.25,1.5,0,-3,1e+300\n\
             0.25,1.5,1,12,1e+300\n\
             0.5,1.5,1,0,1e+300\n"
        );
    }

    #[test]
    fn what_is_not_finite_is_refused_with_name_and_time() {
        let columns = [Column::new("p", "Pa"), Column::new("v", "m/s")];
        let error = text(&columns, &[(0.0, &[1.0, 1.0]), (0.5, &[1.0, f64::NAN])]).unwrap_err();
        assert_eq!(error.to_string(), "`v` is NaN at time 0.5 s");
        let error = text(&columns, &[(0.5, &[f64::NEG_INFINITY, 1.0])]).unwrap_err();
        assert_eq!(error.to_string(), "`p` is -inf at time 0.5 s");
        let error = text(&columns, &[(0.5, &[1.0])]).unwrap_err();
        assert_eq!(error.to_string(), "a row at time 0.5 s has 1 values for 2 columns");

        let dir = Scratch::new("refused-table");
        let mut run = Trajectory::new(columns.to_vec());
        run.push(0.0, &[1.0, f64::INFINITY]);
        assert!(write_csv(&run, dir.path("run.csv")).is_err());
        assert_eq!(dir.files(), [""; 0]);
    }

    #[test]
    fn copied_text_is_that_of_the_row_above() {
        // Numbers of different lengths on both sides of a constant column.
        let columns: Vec<Column> = (0..5).map(|i| Column::new(format!("x{i}"), "")).collect();
        let rows: [(f64, &[f64]); 4] = [
            (0.0, &[0.125, 7.5, -8.25, 3.0, 1e-7]),
            (0.5, &[2.0, 7.5, -8.25, 0.0625, 1e-7]),
            (0.5, &[2.0, 7.5, -8.25, -0.0, 1e-7]),
            (12.5, &[2.0, 7.0, -8.25, 0.0, 1e-7]),
        ];
        let expected: String = rows
            .iter()
            .map(|(time, values)| {
                let values: Vec<String> = values.iter().map(|v| format!(",{v:?}")).collect();
                format!("{time:?}{}\n", values.concat())
            })
            .collect();
        let written = text(&columns, &rows).unwrap();
        assert_eq!(written, format!("time,x0,x1,x2,x3,x4\n{}", expected));
    }

    #[test]
    fn copies_of_other_columns_are_written_like_them() {
        let mut columns: Vec<Column> =
            ["x", "same", "negative", "other"].map(|name| Column::new(name, "")).into();
        let of = |negated| ColumnStorage::Alias { of: 0, negated };
        let storage = [ColumnStorage::Own, of(false), of(true), of(false)];
        let rows: [[f64; 4]; 4] = [
            [0.1, 0.1, -0.1, 7.0],
            [-1e300, -1e300, 1e300, 7.0],
            [-0.0, -0.0, 0.0, -0.0],
            [3.0, 3.0, -3.0, -3.0],
        ];
        let written = |columns: &[Column], storage: &[ColumnStorage]| {
            let mut table = TableWriter::new(Vec::new(), columns).unwrap().with_storage(storage);
            for (k, row) in rows.iter().enumerate() {
                table.row(k as f64, row).unwrap();
            }
            String::from_utf8(table.finish().unwrap()).unwrap()
        };
        assert_eq!(written(&columns, &storage), written(&columns, &[]));
        columns.iter_mut().take(3).for_each(|c| c.kind = Kind::Integer);
        assert_eq!(written(&columns, &storage), written(&columns, &[]));
    }

    #[test]
    fn a_refused_row_leaves_no_trace_in_the_next() {
        let mut table = TableWriter::new(Vec::new(), &[Column::new("x", "")]).unwrap();
        table.row(0.0, &[1.0]).unwrap();
        assert!(table.row(1.0, &[f64::NAN]).is_err());
        table.row(2.0, &[1.0]).unwrap();
        assert_eq!(table.finish().unwrap(), b"time,x\n0.0,1.0\n2.0,1.0\n");
    }

    #[test]
    fn reading_names_file_line_and_column() {
        let dir = Scratch::new("reading");
        let path = dir.path("m.csv");
        let read = |content: &[u8]| {
            std::fs::write(&path, content).unwrap();
            let place = path.display().to_string();
            read_csv(&path).map_err(|e| e.to_string().replace(&place, "m.csv"))
        };
        let run = read(b"\xef\xbb\xbft_s,\"q, m\"\r\n0, 1\r\n1e-3 ,-2.5\r\n").unwrap();
        assert_eq!(run.columns[0].name, "q, m");
        assert_eq!((run.time, run.data), (vec![0.0, 1e-3], vec![vec![1.0, -2.5].into()]));
        let wrong = |content: &str| read(content.as_bytes()).unwrap_err();
        assert_eq!(
            wrong("t,x\n0,1\n\n1,one\n"),
            "m.csv:4: column 2 (`x`): `one` is not a finite number"
        );
        assert_eq!(wrong("t,x\n0,nan\n"), "m.csv:2: column 2 (`x`): `nan` is not a finite number");
        assert_eq!(wrong("t,x\r\n0,1\r\n0,1,2\r\n"), "m.csv:3: 3 fields, but the header names 2");
        assert_eq!(wrong("t,x\n0,1,2\n"), "m.csv:2: 3 fields, but the header names 2");
        assert_eq!(wrong("t,x\n0,1\n2,1\n1,1\n"), "m.csv:4: the time goes back from 2 s to 1 s");
        assert_eq!(wrong("t,x,x\n"), "m.csv:1: column 3: `x` is also the name of column 2");
        assert_eq!(
            wrong("0,1\n"),
            "m.csv:1: column 1: `0` is a number; a header line with names is needed"
        );
        assert_eq!(wrong(""), "m.csv is empty: a header line with names is needed, the time first");
        assert_eq!(
            read(b"t,x\n0,\xff\n").unwrap_err(),
            "m.csv:2: not a table: the text is not UTF-8"
        );
        assert!(read_csv(dir.path("none.csv")).unwrap_err().to_string().contains("none.csv"));
    }
}
