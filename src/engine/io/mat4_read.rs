//! Reads results in the format of Dymola and OpenModelica, as [`mat4`](super::mat4) describes it.
//!
//! Both layouts (`binTrans`, `binNormal`) and numbers of single or double precision are read.

use std::path::Path;
use std::sync::Arc;

use crate::ir::trajectory::{Column, Trajectory};

/// A matrix of numbers, column by column; strings are the codes of their characters.
struct Matrix {
    name: String,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// The element of a matrix, or of its transpose.
    fn at(&self, transposed: bool, row: usize, column: usize) -> Option<f64> {
        let (row, column) = if transposed { (column, row) } else { (row, column) };
        (row < self.rows).then(|| self.values.get(column * self.rows + row).copied()).flatten()
    }

    /// The string in a row of the matrix, or of its transpose, without the blanks at its end.
    fn text(&self, transposed: bool, row: usize) -> String {
        let length = if transposed { self.rows } else { self.columns };
        let bytes: Vec<u8> = (0..length)
            .map_while(|k| self.at(transposed, row, k))
            .map(|code| code as u8)
            .take_while(|byte| *byte != 0)
            .collect();
        String::from_utf8_lossy(&bytes).trim_end().to_owned()
    }
}

/// The variables of a result file whose names `wanted` accepts; constant ones have equal values in all rows. The error is
/// a message without the name of the file.
pub fn read_mat(path: &Path, wanted: &dyn Fn(&str) -> bool) -> Result<Trajectory, String> {
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    run(&bytes, wanted)
}

fn run(bytes: &[u8], wanted: &dyn Fn(&str) -> bool) -> Result<Trajectory, String> {
    let all = matrices(bytes)?;
    let find = |name: &str| {
        let found = all.iter().find(|m| m.name == name);
        found.ok_or_else(|| format!("there is no matrix `{name}`: not a result of a simulation"))
    };
    let class = find("Aclass")?;
    let transposed = class.text(false, 3) == "binTrans";
    let (names, info) = (find("name")?, find("dataInfo")?);
    let data = find("data_2")?;
    let described = all.iter().find(|m| m.name == "description");
    let constants = all.iter().find(|m| m.name == "data_1");
    let rows = if transposed { data.columns } else { data.rows };
    let row_of = |matrix: &Matrix, index: f64| -> Option<Vec<f64>> {
        let (k, sign) = (index.abs() as usize, index.signum());
        let k = k.checked_sub(1)?;
        (0..rows).map(|row| matrix.at(transposed, row, k).map(|x| sign * x)).collect()
    };
    let time = row_of(data, 1.0).ok_or("the matrix `data_2` has no time")?;
    let mut out = Trajectory { time, ..Trajectory::default() };
    let count = if transposed { names.columns } else { names.rows };
    for k in 0..count {
        let name = names.text(transposed, k);
        if matches!(name.as_str(), "time" | "Time") || !wanted(&name) {
            continue;
        }
        let broken = || format!("the place of `{name}` is not in the file");
        let entry = |j| info.at(transposed, k, j).ok_or_else(broken);
        let values = match (entry(0)? as i64, constants) {
            (1, Some(constants)) => {
                let k = (entry(1)?.abs() as usize).checked_sub(1).ok_or_else(broken)?;
                let value = constants.at(transposed, 0, k).ok_or_else(broken)?;
                vec![entry(1)?.signum() * value; rows]
            }
            _ => row_of(data, entry(1)?).ok_or_else(broken)?,
        };
        let unit = described.map_or(String::new(), |all| unit_of(&all.text(transposed, k)));
        out.columns.push(Column::new(name, unit));
        out.data.push(Arc::new(values));
    }
    out.verify().map_err(|fault| fault.to_string())?;
    Ok(out)
}

/// The unit at the end of a description, `Stroke [m]` or `Pressure [Pa|bar]`; empty without one.
fn unit_of(description: &str) -> String {
    let inner = description.trim_end().strip_suffix(']').and_then(|text| text.rsplit_once('['));
    inner.map_or(String::new(), |(_, units)| units.split('|').next().unwrap_or_default().into())
}

/// All matrices of a file of level 4.
fn matrices(bytes: &[u8]) -> Result<Vec<Matrix>, String> {
    let broken = || "it is not a MAT file of level 4, or it ends too early".to_owned();
    let mut rest = bytes;
    let mut out = Vec::new();
    while !rest.is_empty() {
        let word = |k: usize| -> Result<usize, String> {
            let part = rest.get(4 * k..4 * k + 4).ok_or_else(broken)?;
            usize::try_from(i32::from_le_bytes(part.try_into().unwrap_or_default()))
                .map_err(|_| broken())
        };
        let (kind, rows, columns, length) = (word(0)?, word(1)?, word(2)?, word(4)?);
        let size = match kind % 100 / 10 {
            0 => 8,
            1 | 2 => 4,
            3 | 4 => 2,
            5 => 1,
            _ => return Err(broken()),
        };
        if kind >= 1000 || kind % 10 > 1 || word(3)? != 0 {
            return Err(broken());
        }
        let name = rest.get(20..20 + length).ok_or_else(broken)?;
        let name = String::from_utf8_lossy(name).trim_end_matches('\0').to_owned();
        let count =
            rows.checked_mul(columns).and_then(|n| n.checked_mul(size)).ok_or_else(broken)?;
        let end = (20 + length).checked_add(count).ok_or_else(broken)?;
        let data = rest.get(20 + length..end).ok_or_else(broken)?;
        let number = |b: &[u8]| match (kind % 100 / 10, b) {
            (0, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            (1, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (2, &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
            (3, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
            (4, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
            (_, b) => f64::from(b.first().copied().unwrap_or_default()),
        };
        let values = data.chunks_exact(size).map(number).collect();
        out.push(Matrix { name, rows, columns, values });
        rest = &rest[end..];
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of level 4 as bytes.
    fn matrix(kind: i32, name: &str, rows: usize, columns: usize, data: &[u8]) -> Vec<u8> {
        let words = [kind, rows as i32, columns as i32, 0, name.len() as i32 + 1];
        let mut out: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        out.extend(name.bytes().chain([0]));
        out.extend(data);
        out
    }

    fn text(name: &str, lines: &[&str], transposed: bool) -> Vec<u8> {
        let width = lines.iter().map(|l| l.len()).max().unwrap_or(0);
        let at = |line: &str, k: usize| line.as_bytes().get(k).copied().unwrap_or(b' ');
        let data: Vec<u8> = if transposed {
            lines.iter().flat_map(|l| (0..width).map(move |k| at(l, k))).collect()
        } else {
            (0..width).flat_map(|k| lines.iter().map(move |l| at(l, k))).collect()
        };
        let (rows, columns) = if transposed { (width, lines.len()) } else { (lines.len(), width) };
        matrix(51, name, rows, columns, &data)
    }

    /// Single precision and rows that are not transposed, as other tools write on request.
    #[test]
    fn the_layout_with_rows_of_instants_is_read() {
        let mut file = text("Aclass", &["Atrajectory", "1.1", "", "binNormal"], false);
        file.extend(text("name", &["time", "x", "minus", "k"], false));
        // Columns: matrix, place, interpolation, extrapolation; stored column by column.
        let info = [[0, 2, 2, 1], [1, 2, -2, 2], [0; 4], [-1; 4]];
        let bytes: Vec<u8> = info.iter().flatten().flat_map(|w: &i32| w.to_le_bytes()).collect();
        file.extend(matrix(20, "dataInfo", 4, 4, &bytes));
        let doubles = |v: &[f64]| v.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        file.extend(matrix(0, "data_1", 2, 2, &doubles(&[0.0, 2.0, 7.5, 7.5])));
        let singles: Vec<u8> =
            [0.0_f32, 1.0, 2.0, 0.5, 0.25, 4.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        file.extend(matrix(10, "data_2", 3, 2, &singles));
        let run = run(&file, &|_| true).unwrap();
        assert_eq!(run.time, [0.0, 1.0, 2.0]);
        assert_eq!(run.values("x"), Some(&[0.5, 0.25, 4.0][..]));
        assert_eq!(run.values("minus"), Some(&[-0.5, -0.25, -4.0][..]));
        assert_eq!(run.values("k"), Some(&[7.5; 3][..]));
    }

    #[test]
    fn other_files_are_refused_with_a_reason() {
        let refused = |bytes: &[u8]| run(bytes, &|_| true).unwrap_err();
        assert!(refused(b"time,x\n0,1\n").contains("not a MAT file of level 4"));
        assert!(refused(&text("other", &["x"], false)).contains("no matrix `Aclass`"));
    }
}
