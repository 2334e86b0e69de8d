//! Reads MAT files of level 5, written by versions 5 to 7 of MATLAB ("MAT-File Format", The
//! MathWorks): tagged elements, possibly compressed, that contain matrices of numbers.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::matrix_file::Matrix;

/// Bytes before the first element.
const HEAD: usize = 128;
/// Maximum size of a decompressed matrix, bytes.
const LIMIT: u64 = 1 << 32;

/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Array class of structures.
const STRUCTURE: u32 = 2;
/// Array classes of numbers: double, single, and integers of 8 to 64 bits.
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;

/// An element of a file, or a part of one.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

/// The matrix with this name; the error is a message.
pub fn matrix(bytes: &[u8], name: &str) -> Result<Matrix, String> {
    if bytes.starts_with(b"MATLAB 7.3") {
        return Err(
            "MAT files of version 7.3 (HDF5) are not supported: save it as version 7".into()
        );
    }
    if bytes.get(126..HEAD) != Some(b"IM") {
        return Err("this MAT file was written with the most significant byte first".into());
    }
    let mut rest = &bytes[HEAD..];
    while !rest.is_empty() {
        let element = next(&mut rest)?;
        let mut unfolded = Vec::new();
        let content = match element.kind {
            COMPRESSED => {
                let unfolding =
                    ZlibDecoder::new(element.data).take(LIMIT).read_to_end(&mut unfolded);
                unfolding.map_err(|why| format!("cannot read a compressed matrix: {why}"))?;
                next(&mut unfolded.as_slice())?
            }
            _ => element,
        };
        if content.kind == MATRIX
            && let Some(found) = named(content.data, name)?
        {
            return Ok(found);
        }
    }
    Err(format!("there is no matrix `{name}` in it"))
}

/// Takes the next element; the following one is aligned to 8 bytes.
fn next<'a>(rest: &mut &'a [u8]) -> Result<Element<'a>, String> {
    let broken = || "this MAT file ends too early".to_string();
    let bytes = *rest;
    let word = |k: usize| {
        let part = bytes.get(4 * k..4 * k + 4).ok_or_else(broken)?;
        Ok::<u32, String>(u32::from_le_bytes(part.try_into().unwrap_or_default()))
    };
    let first = word(0)?;
    let (kind, begin, length) = match first >> 16 {
        0 => (first, 8, word(1)? as usize),
        // Up to four bytes of data are stored in the tag.
        short => (first & 0xFFFF, 4, short as usize),
    };
    let end = begin + length;
    let data = bytes.get(begin..end).ok_or_else(broken)?;
    let padded = if kind == COMPRESSED { end } else { end.next_multiple_of(8) };
    *rest = bytes.get(padded..).unwrap_or_default();
    Ok(Element { kind, data })
}

/// The matrix, if it has that name and holds real numbers; `a.b` is the field `b` of the structure
/// `a`.
fn named(mut parts: &[u8], name: &str) -> Result<Option<Matrix>, String> {
    let flags = next(&mut parts)?;
    let class = flags.data.first().map_or(0, |c| u32::from(*c));
    let sizes = numbers(&next(&mut parts)?)?;
    let own = next(&mut parts)?.data;
    if class == STRUCTURE {
        let rest = name.as_bytes().strip_prefix(own).and_then(|rest| rest.strip_prefix(b"."));
        let field = rest.and_then(|rest| std::str::from_utf8(rest).ok());
        return field.map_or(Ok(None), |field| in_structure(parts, field));
    }
    if own != name.as_bytes() {
        return Ok(None);
    }
    content(parts, class, &sizes, name).map(Some)
}

/// The matrix in a field of a structure: first the names of all fields, with equal lengths, then
/// the fields, which have empty names.
fn in_structure(mut parts: &[u8], path: &str) -> Result<Option<Matrix>, String> {
    let (wanted, inner) = match path.split_once('.') {
        Some((wanted, inner)) => (wanted, Some(inner)),
        None => (path, None),
    };
    let length = numbers(&next(&mut parts)?)?.first().map_or(0, |n| *n as usize);
    let names = next(&mut parts)?.data;
    for name in names.chunks(length.max(1)) {
        let field = next(&mut parts)?;
        if name.split(|b| *b == 0).next() != Some(wanted.as_bytes()) {
            continue;
        }
        let mut parts = field.data;
        let flags = next(&mut parts)?;
        let class = flags.data.first().map_or(0, |c| u32::from(*c));
        let sizes = numbers(&next(&mut parts)?)?;
        next(&mut parts)?;
        return match inner {
            Some(inner) if class == STRUCTURE => in_structure(parts, inner),
            Some(_) => Ok(None),
            None => content(parts, class, &sizes, path).map(Some),
        };
    }
    Ok(None)
}

/// Reads the numbers of a matrix with known sizes.
fn content(mut parts: &[u8], class: u32, sizes: &[f64], name: &str) -> Result<Matrix, String> {
    let &[rows, columns] = sizes else {
        return Err(format!("`{name}` has {} dimensions instead of 2", sizes.len()));
    };
    if !NUMBERS.contains(&class) {
        return Err(format!("`{name}` is not a full matrix of numbers"));
    }
    let (rows, columns) = (rows as usize, columns as usize);
    let columnwise = numbers(&next(&mut parts)?)?;
    if rows.checked_mul(columns) != Some(columnwise.len()) {
        return Err(format!(
            "`{name}` has {} numbers instead of {rows} x {columns}",
            columnwise.len()
        ));
    }
    let places = (0..columnwise.len()).map(|k| k / columns + (k % columns) * rows);
    let elements = places.map(|p| columnwise[p]).collect();
    Ok(Matrix { rows, columns, elements })
}

/// Reads numbers, which are stored in the smallest type that represents them.
fn numbers(element: &Element<'_>) -> Result<Vec<f64>, String> {
    fn each<const N: usize>(data: &[u8], number: fn([u8; N]) -> f64) -> Vec<f64> {
        data.chunks_exact(N).map(|b| number(b.try_into().unwrap_or([0; N]))).collect()
    }
    let data = element.data;
    Ok(match element.kind {
        1 => each(data, |b| f64::from(i8::from_le_bytes(b))),
        2 => each(data, |b| f64::from(u8::from_le_bytes(b))),
        3 => each(data, |b| f64::from(i16::from_le_bytes(b))),
        4 => each(data, |b| f64::from(u16::from_le_bytes(b))),
        5 => each(data, |b| f64::from(i32::from_le_bytes(b))),
        6 => each(data, |b| f64::from(u32::from_le_bytes(b))),
        7 => each(data, |b| f64::from(f32::from_le_bytes(b))),
        9 => each(data, f64::from_le_bytes),
        12 => each(data, |b| i64::from_le_bytes(b) as f64),
        13 => each(data, |b| u64::from_le_bytes(b) as f64),
        other => return Err(format!("numbers of kind {other} are not known in a MAT file")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::ZlibEncoder};
    use std::io::Write;

    fn element(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        if (1..=4).contains(&data.len()) {
            bytes.extend((kind | (data.len() as u32) << 16).to_le_bytes());
            bytes.extend(data);
        } else {
            bytes.extend([kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat());
            bytes.extend(data);
        }
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    fn whole(sizes: &[i32], name: &str, numbers: &[u8]) -> Vec<u8> {
        let sizes: Vec<u8> = sizes.iter().flat_map(|n| n.to_le_bytes()).collect();
        let parts = [
            element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
            element(5, &sizes),
            element(1, name.as_bytes()),
            numbers.to_vec(),
        ];
        element(MATRIX, &parts.concat())
    }

    fn file(elements: &[Vec<u8>]) -> Vec<u8> {
        let mut head = b"MATLAB 5.0 MAT-file".to_vec();
        head.resize(124, b' ');
        head.extend([0, 1, b'I', b'M']);
        head.into_iter().chain(elements.concat()).collect()
    }

    fn compressed(element: &[u8]) -> Vec<u8> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(element).unwrap();
        let data = encoder.finish().unwrap();
        [&COMPRESSED.to_le_bytes()[..], &(data.len() as u32).to_le_bytes(), &data].concat()
    }

    #[test]
    fn matrices_are_found_by_name_compressed_or_not() {
        let first = whole(&[1, 3], "a", &element(2, &[7, 8, 9]));
        let doubles: Vec<u8> =
            [1.5, 4.0, -2.0, 1e300].iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
        let second = whole(&[2, 2], "Matrix_A", &element(9, &doubles));
        let bytes = file(&[first, compressed(&second)]);
        let a = matrix(&bytes, "a").unwrap();
        assert_eq!((a.rows, a.columns, &a.elements[..]), (1, 3, &[7.0, 8.0, 9.0][..]));
        let b = matrix(&bytes, "Matrix_A").unwrap();
        assert_eq!((b.rows, b.columns, &b.elements[..]), (2, 2, &[1.5, -2.0, 4.0, 1e300][..]));
        assert_eq!(matrix(&bytes, "b").unwrap_err(), "there is no matrix `b` in it");
    }

    /// A structure with one element; its fields have empty names.
    fn structure(name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
        const LENGTH: usize = 8;
        let mut names = Vec::new();
        for (k, (name, _)) in fields.iter().enumerate() {
            names.extend(name.bytes());
            names.resize((k + 1) * LENGTH, 0);
        }
        let mut parts = [
            element(6, &[STRUCTURE as u8, 0, 0, 0, 0, 0, 0, 0]),
            element(5, &[1, 0, 0, 0, 1, 0, 0, 0]),
            element(1, name.as_bytes()),
            element(5, &(LENGTH as i32).to_le_bytes()),
            element(1, &names),
        ]
        .concat();
        fields.iter().for_each(|(_, field)| parts.extend(field));
        element(MATRIX, &parts)
    }

    #[test]
    fn fields_of_structures_are_found_by_path() {
        let inner = structure("", &[("b", whole(&[1, 1], "", &element(2, &[5])))]);
        let fields = [("a", whole(&[1, 2], "", &element(2, &[3, 4]))), ("s", inner)];
        let bytes = file(&[structure("s", &fields), whole(&[1, 1], "a", &element(2, &[1]))]);
        let numbers = |path: &str| matrix(&bytes, path).map(|m| m.elements);
        assert_eq!(numbers("s.a"), Ok(vec![3.0, 4.0]));
        assert_eq!(numbers("s.s.b"), Ok(vec![5.0]));
        assert_eq!(numbers("a"), Ok(vec![1.0]));
        for missing in ["s.b", "s.a.b", "s.s", "s"] {
            assert!(numbers(missing).is_err(), "{missing}");
        }
    }

    #[test]
    fn truncated_files_are_rejected() {
        let bytes = file(&[whole(&[2, 2], "a", &element(2, &[1, 2, 3, 4]))]);
        for length in HEAD + 1..bytes.len() {
            assert!(matrix(&bytes[..length], "a").is_err(), "{length} bytes");
        }
        assert!(matrix(&bytes[..100], "a").is_err());
        let wrong = file(&[whole(&[2, 3], "a", &element(2, &[1, 2, 3, 4]))]);
        assert_eq!(matrix(&wrong, "a").unwrap_err(), "`a` has 4 numbers instead of 2 x 3");
    }
}
