//! Reads matrices from data files.
//!
//! *Text:* a first line `#1`, then for each matrix `double NAME(ROWS, COLUMNS)` or `float ...` and
//! its numbers row by row, separated by blanks, commas, semicolons or tabs; `#` starts a comment.
//! *Binary:* MAT of levels 4 and 5, with full matrices of numbers.

/// A matrix, row by row.
#[derive(Clone, PartialEq, Debug)]
pub struct Matrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// All elements.
    pub elements: Vec<f64>,
}

impl Matrix {
    /// A column, counted from 1; the error is a message.
    pub fn column(&self, k: usize) -> Result<Vec<f64>, String> {
        if k < 1 || k > self.columns {
            return Err(format!(
                "the table has {} columns, and column {k} is wanted",
                self.columns
            ));
        }
        Ok(self.elements.iter().skip(k - 1).step_by(self.columns).copied().collect())
    }
}

/// The matrix with this name; the error is a message.
pub fn matrix(bytes: &[u8], name: &str) -> Result<Matrix, String> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if bytes.starts_with(b"#1") {
        let text = std::str::from_utf8(bytes).map_err(|_| "the text is not UTF-8".to_string())?;
        return in_text(text, name);
    }
    if bytes.starts_with(b"MATLAB") {
        return super::mat5::matrix(bytes, name);
    }
    in_mat(bytes, name)
}

fn in_text(text: &str, name: &str) -> Result<Matrix, String> {
    let mut lines = text.lines().skip(1).map(|l| l.split('#').next().unwrap_or_default().trim());
    let missing = || format!("there is no matrix `{name}` in it");
    let (rows, columns) = loop {
        let line = lines.next().ok_or_else(missing)?;
        if let Some(sizes) = declared(line, name) {
            break sizes;
        }
    };
    let wanted = rows * columns;
    let mut elements = Vec::with_capacity(wanted.min(text.len()));
    let separates = |c: char| c.is_whitespace() || c == ',' || c == ';';
    for line in lines {
        for word in line.split(separates).filter(|w| !w.is_empty()) {
            if elements.len() == wanted {
                break;
            }
            let number = word.parse::<f64>().ok().filter(|x| x.is_finite());
            elements.push(number.ok_or_else(|| format!("`{word}` in `{name}` is not a number"))?);
        }
        if elements.len() == wanted {
            return Ok(Matrix { rows, columns, elements });
        }
    }
    Err(format!("`{name}` has {} numbers instead of {wanted}", elements.len()))
}

/// The sizes of the matrix with this name, if a line declares it.
fn declared(line: &str, name: &str) -> Option<(usize, usize)> {
    let rest = line.strip_prefix("double").or_else(|| line.strip_prefix("float"))?.trim_start();
    let sizes = rest.strip_prefix(name)?.trim_start().strip_prefix('(')?;
    let (rows, columns) = sizes.split_once(')')?.0.split_once(',')?;
    Some((rows.trim().parse().ok()?, columns.trim().parse().ok()?))
}

/// Length of the header of a matrix: five 32-bit integers.
const HEAD: usize = 20;

fn in_mat(mut bytes: &[u8], name: &str) -> Result<Matrix, String> {
    let broken = || "this is neither a text file of tables nor a MAT file".to_string();
    while !bytes.is_empty() {
        let head = bytes.get(..HEAD).ok_or_else(broken)?;
        let field = |k: usize| {
            let part: [u8; 4] = head[4 * k..4 * k + 4].try_into().unwrap_or_default();
            u32::from_le_bytes(part) as usize
        };
        let (kind, rows, columns, imaginary, length) =
            (field(0), field(1), field(2), field(3), field(4));
        // Thousands: byte order; tens: type of the numbers.
        let size = match (kind / 1000, kind / 10 % 10) {
            (0, 0) => 8,
            (0, 1 | 2) => 4,
            (0, 3 | 4) => 2,
            (0, 5) => 1,
            _ => return Err(broken()),
        };
        let count = rows.checked_mul(columns).ok_or_else(broken)?;
        let data = HEAD.checked_add(length).ok_or_else(broken)?;
        let parts = if imaginary == 0 { 1 } else { 2 };
        let whole = count.checked_mul(size * parts).and_then(|n| n.checked_add(data));
        let whole = whole.filter(|n| *n <= bytes.len()).ok_or_else(broken)?;
        let own = bytes[HEAD..data].split(|b| *b == 0).next().unwrap_or_default();
        if own == name.as_bytes() {
            let columnwise: Vec<f64> = bytes[data..data + count * size]
                .chunks_exact(size)
                .map(|b| number(b, kind / 10 % 10))
                .collect();
            let places = (0..count).map(|k| k / columns + (k % columns) * rows);
            let elements = places.map(|p| columnwise[p]).collect();
            return Ok(Matrix { rows, columns, elements });
        }
        bytes = &bytes[whole..];
    }
    Err(format!("there is no matrix `{name}` in it"))
}

fn number(bytes: &[u8], kind: usize) -> f64 {
    match (kind, bytes) {
        (0, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        (1, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        (2, &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
        (3, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (4, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (_, &[a]) => f64::from(a),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_files_contain_several_matrices() {
        let text = "#1\n# a comment\ndouble first(1,2)\n1 2\nfloat other( 2, 2 ) # sizes\n1, 2.5;\n-3\t4e1\n";
        let other = matrix(text.as_bytes(), "other").unwrap();
        assert_eq!(other, Matrix { rows: 2, columns: 2, elements: vec![1.0, 2.5, -3.0, 40.0] });
        assert_eq!(other.column(2), Ok(vec![2.5, 40.0]));
        let marked = format!("\u{FEFF}{text}");
        assert_eq!(matrix(marked.as_bytes(), "other"), Ok(other));
        let missing = matrix(text.as_bytes(), "third").unwrap_err();
        assert_eq!(missing, "there is no matrix `third` in it");
        let short = matrix(b"#1\ndouble a(2,2)\n1 2 3\n", "a").unwrap_err();
        assert_eq!(short, "`a` has 3 numbers instead of 4");
    }

    #[test]
    fn mat_files_contain_matrices_in_column_major_order() {
        let mut bytes = Vec::new();
        for (name, values) in [("x", vec![9.0]), ("table", vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])] {
            let rows = if values.len() == 1 { 1_u32 } else { 2 };
            let head = [0, rows, values.len() as u32 / rows, 0, name.len() as u32 + 1];
            bytes.extend(head.iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend(name.bytes().chain([0]));
            bytes.extend(values.iter().flat_map(|x: &f64| x.to_le_bytes()));
        }
        let table = matrix(&bytes, "table").unwrap();
        assert_eq!((table.rows, table.columns), (2, 3));
        assert_eq!(table.elements, [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
        assert!(matrix(&bytes[..30], "table").is_err());
        assert!(matrix(&bytes, "y").is_err());
    }
}
