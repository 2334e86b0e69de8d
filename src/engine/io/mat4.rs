//! Results in the format of Dymola and OpenModelica: six matrices in a MATLAB file of level 4.
//!
//! `Aclass` names the layout; `name` and `description` hold a string per variable; `dataInfo` gives
//! the matrix and row of each variable; `data_1` has two instants (start and end) for constant
//! variables, `data_2` all instants for the others. Everything is transposed (`binTrans`): an
//! instant is a column, so that it can be appended. The number of columns is in a header, which is
//! patched at the end.
//!
//! Sources: MAT-File Format, The MathWorks, chapter on level 4; Dymola User Manual, volume 1,
//! section "Saving and restoring results"; the behaviour of DyMat and scipy.

use std::io::Write;

use super::atomic_file::AtomicFile;
use super::csv::TableError;
use super::results::{ResultWriter, check};
use crate::ir::trajectory::{Column, ColumnStorage, Constant};

/// Type of a matrix of doubles, little endian: digits M, O, P, T of its first word.
const DOUBLE: i32 = 0;
/// Type of a matrix of 32-bit integers.
const INTEGER: i32 = 20;
/// Type of a matrix of characters.
const TEXT: i32 = 51;

/// Offset of the number of columns in the header of a matrix, in bytes.
const COLUMNS_AT: u64 = 8;

/// Writes results row by row; allocates nothing after the first one.
pub struct MatWriter {
    out: AtomicFile,
    /// Bytes written.
    length: u64,
    columns: Vec<Column>,
    column_storage: Vec<ColumnStorage>,
    constants: Vec<Constant>,
    /// The columns in `data_2`.
    varying: Vec<usize>,
    rows: usize,
    /// Offsets of the end time in `data_1`, and of `data_2`.
    end_at: u64,
    data_at: u64,
    bytes: Vec<u8>,
}

impl MatWriter {
    /// A file with these columns.
    pub fn new(out: AtomicFile, columns: &[Column], column_storage: &[ColumnStorage]) -> Self {
        let own = |k: &usize| column_storage.get(*k).is_none_or(|c| *c == ColumnStorage::Own);
        MatWriter {
            out,
            length: 0,
            varying: (0..columns.len()).filter(own).collect(),
            columns: columns.to_vec(),
            column_storage: column_storage.to_vec(),
            constants: Vec::new(),
            rows: 0,
            end_at: 0,
            data_at: 0,
            bytes: Vec::new(),
        }
    }

    /// Writes all matrices before the instants, and the header of `data_2`.
    fn begin(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        let mut names = vec!["time".to_owned()];
        let mut descriptions = vec!["Time in [s]".to_owned()];
        let mut data_info: Vec<[i32; 4]> = vec![[0, 1, 0, -1]];
        let mut constants = vec![time];
        let constant = |constants: &mut Vec<f64>, value| {
            constants.push(value);
            Ok::<_, TableError>([1, count("the number of constants", constants.len())?, 0, 0])
        };
        for c in &self.constants {
            names.push(c.column.name.clone());
            descriptions.push(description(&c.column));
            data_info.push(constant(&mut constants, c.value)?);
        }
        let mut rows = vec![0; self.columns.len()];
        for (row, &k) in self.varying.iter().enumerate() {
            // The first row of the matrix is the time, and rows count from 1.
            rows[k] = count("the number of columns", row + 2)?;
        }
        for (k, column) in self.columns.iter().enumerate() {
            names.push(column.name.clone());
            descriptions.push(description(column));
            data_info.push(match self.column_storage.get(k) {
                Some(ColumnStorage::Constant) => constant(&mut constants, values[k])?,
                Some(ColumnStorage::Alias { of, negated: true }) => [2, -rows[*of], 0, -1],
                Some(ColumnStorage::Alias { of, negated: false }) => [2, rows[*of], 0, -1],
                Some(ColumnStorage::Own) | None => [2, rows[k], 0, -1],
            });
        }
        let class = ["Atrajectory", "1.1", "", "binTrans"];
        let width = class.iter().map(|t| t.len()).max().unwrap_or(0);
        // This matrix is not transposed: a string is a row.
        let text = |j: usize| class.map(|t| t.as_bytes().get(j).copied().unwrap_or(b' '));
        let class_bytes: Vec<u8> = (0..width).flat_map(text).collect();
        self.matrix("Aclass", TEXT, class.len(), width, &class_bytes)?;
        self.strings("name", &names)?;
        self.strings("description", &descriptions)?;
        let data_info_bytes: Vec<u8> =
            data_info.iter().flatten().flat_map(|word| word.to_le_bytes()).collect();
        self.matrix("dataInfo", INTEGER, 4, data_info.len(), &data_info_bytes)?;
        let constants_bytes: Vec<u8> =
            constants.iter().chain(&constants).flat_map(|value| value.to_le_bytes()).collect();
        self.matrix("data_1", DOUBLE, constants.len(), 2, &constants_bytes)?;
        self.end_at = self.length - 8 * constants.len() as u64;
        self.data_at = self.length;
        self.matrix("data_2", DOUBLE, self.varying.len() + 1, 0, &[])
    }

    /// Writes strings of equal length, padded with blanks, one per column.
    fn strings(&mut self, name: &str, texts: &[String]) -> Result<(), TableError> {
        let height = texts.iter().map(String::len).max().unwrap_or(0);
        let mut bytes = vec![b' '; height * texts.len()];
        for (place, text) in bytes.chunks_mut(height.max(1)).zip(texts) {
            place[..text.len()].copy_from_slice(text.as_bytes());
        }
        self.matrix(name, TEXT, height, texts.len(), &bytes)
    }

    /// Writes a header and the data, column by column.
    fn matrix(
        &mut self,
        name: &str,
        kind: i32,
        rows: usize,
        columns: usize,
        data: &[u8],
    ) -> Result<(), TableError> {
        let imaginary = 0;
        let (rows, columns) =
            (count("the number of rows", rows)?, count("the number of columns", columns)?);
        let mut bytes = Vec::with_capacity(32);
        for word in [kind, rows, columns, imaginary, name.len() as i32 + 1] {
            bytes.extend_from_slice(&word.to_le_bytes());
        }
        bytes.extend_from_slice(name.as_bytes());
        bytes.push(0);
        self.out.write_all(&bytes)?;
        self.out.write_all(data)?;
        self.length += (bytes.len() + data.len()) as u64;
        Ok(())
    }
}

impl ResultWriter for MatWriter {
    fn constants(&mut self, constants: Vec<Constant>) {
        self.constants = constants;
    }

    /// The first row determines the constant columns.
    fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        check(&self.columns, time, values)?;
        if self.rows == 0 {
            self.begin(time, values)?;
        }
        self.bytes.clear();
        self.bytes.extend_from_slice(&time.to_le_bytes());
        for &k in &self.varying {
            self.bytes.extend_from_slice(&values[k].to_le_bytes());
        }
        self.out.write_all(&self.bytes)?;
        self.rows += 1;
        Ok(())
    }

    /// Completes the headers.
    fn finish(mut self: Box<Self>, end: f64) -> Result<AtomicFile, TableError> {
        if self.rows > 0 {
            let rows = count("the number of rows", self.rows)?;
            self.out.patch(self.end_at, &end.to_le_bytes())?;
            self.out.patch(self.data_at + COLUMNS_AT, &rows.to_le_bytes())?;
        }
        Ok(self.out)
    }
}

/// The description of a variable with its units in the style of Dymola: `Pressure [Pa|bar]`.
fn description(column: &Column) -> String {
    let Column { unit, display_unit, description, .. } = column;
    let text = description.replace(['\n', '\r', '\t'], " ");
    let text = text.trim();
    let units = match (unit.as_str(), display_unit.as_str()) {
        ("", _) => return text.to_owned(),
        (unit, "") => format!("[{unit}]"),
        (unit, display) if unit == display => format!("[{unit}]"),
        (unit, display) => format!("[{unit}|{display}]"),
    };
    if text.is_empty() { units } else { format!("{text} {units}") }
}

/// Converts a count to the 32-bit integers of the format.
fn count(what: &'static str, count: usize) -> Result<i32, TableError> {
    i32::try_from(count).map_err(|_| TableError::TooLarge { what, count })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::atomic_file::tests::Scratch;

    /// Name, kind, rows, columns, data of each matrix.
    fn matrices(bytes: &[u8]) -> Vec<(String, i32, usize, usize, Vec<u8>)> {
        let (mut at, mut found) = (0, Vec::new());
        while at < bytes.len() {
            let word = |k: usize| {
                i32::from_le_bytes(bytes[at + 4 * k..at + 4 * k + 4].try_into().unwrap())
            };
            let (kind, rows, columns, name) =
                (word(0), word(1) as usize, word(2) as usize, word(4) as usize);
            assert_eq!(word(3), 0, "no imaginary part");
            let width = match kind {
                DOUBLE => 8,
                INTEGER => 4,
                TEXT => 1,
                other => panic!("kind {other}"),
            };
            let begin = at + 20 + name;
            let end = begin + rows * columns * width;
            let text = String::from_utf8(bytes[at + 20..begin - 1].to_vec()).unwrap();
            assert_eq!(bytes[begin - 1], 0);
            found.push((text, kind, rows, columns, bytes[begin..end].to_vec()));
            at = end;
        }
        found
    }

    fn doubles(bytes: &[u8]) -> Vec<f64> {
        bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn the_bytes_are_those_of_the_format() {
        let dir = Scratch::new("mat");
        let pressure = Column {
            display_unit: "bar".into(),
            description: "Pressure".into(),
            ..Column::new("p", "Pa")
        };
        let columns = [
            pressure,
            Column::new("x[1]", "m"),
            Column::new("y", "m"),
            Column::new("k", ""),
            Column::new("z", ""),
        ];
        let column_storage = [
            ColumnStorage::Own,
            ColumnStorage::Own,
            ColumnStorage::Alias { of: 1, negated: true },
            ColumnStorage::Constant,
            ColumnStorage::Alias { of: 0, negated: false },
        ];
        let file = AtomicFile::create(dir.path("run.mat")).unwrap();
        let mut writer = MatWriter::new(file, &columns, &column_storage);
        writer.constants(vec![Constant { column: Column::new("m", "kg"), value: 2.5 }]);
        writer.row(0.0, &[1e5, 0.25, -0.25, 7.0, 1e5]).unwrap();
        writer.row(0.5, &[2e5, 0.5, -0.5, 7.0, 2e5]).unwrap();
        writer.row(0.5, &[3e5, 0.5, -0.5, 7.0, 3e5]).unwrap();
        assert!(writer.row(0.75, &[f64::NAN, 0.5, -0.5, 7.0, 3e5]).is_err());
        Box::new(writer).finish(0.75).unwrap().finish().unwrap();

        let found = matrices(&std::fs::read(dir.path("run.mat")).unwrap());
        let names: Vec<&str> = found.iter().map(|m| m.0.as_str()).collect();
        assert_eq!(names, ["Aclass", "name", "description", "dataInfo", "data_1", "data_2"]);
        let (_, kind, rows, width, class) = &found[0];
        assert_eq!((*kind, *rows, *width), (TEXT, 4, 11));
        let row =
            |i: usize| -> String { (0..*width).map(|j| char::from(class[j * rows + i])).collect() };
        assert_eq!(
            (0..4).map(row).collect::<Vec<_>>(),
            ["Atrajectory", "1.1        ", "           ", "binTrans   "]
        );
        let texts = |m: usize| -> Vec<String> {
            let text = |t: &[u8]| String::from_utf8(t.to_vec()).unwrap().trim_end().to_owned();
            found[m].4.chunks(found[m].2).map(text).collect()
        };
        assert_eq!(texts(1), ["time", "m", "p", "x[1]", "y", "k", "z"]);
        assert_eq!(texts(2), ["Time in [s]", "[kg]", "Pressure [Pa|bar]", "[m]", "[m]", "", ""]);
        let words: Vec<i32> =
            found[3].4.chunks(4).map(|b| i32::from_le_bytes(b.try_into().unwrap())).collect();
        let data_info: Vec<&[i32]> = words.chunks(4).collect();
        assert_eq!(data_info[0], [0, 1, 0, -1]);
        assert_eq!(data_info[1], [1, 2, 0, 0]);
        assert_eq!(data_info[2], [2, 2, 0, -1]);
        assert_eq!(data_info[3], [2, 3, 0, -1]);
        assert_eq!(data_info[4], [2, -3, 0, -1]);
        assert_eq!(data_info[5], [1, 3, 0, 0]);
        assert_eq!(data_info[6], [2, 2, 0, -1]);
        assert_eq!((found[4].2, found[4].3), (3, 2));
        assert_eq!(doubles(&found[4].4), [0.0, 2.5, 7.0, 0.75, 2.5, 7.0]);
        assert_eq!((found[5].2, found[5].3), (3, 3));
        assert_eq!(doubles(&found[5].4), [0.0, 1e5, 0.25, 0.5, 2e5, 0.5, 0.5, 3e5, 0.5]);
    }
}
