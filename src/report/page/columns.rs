//! Columns of numbers in a page: little-endian binary as base64, thinned where a picture does not
//! need all of it. *RFC 4648, section 4.*

use crate::io::json::Json;
use crate::ir::trajectory::{ColumnStorage, Trajectory};
use crate::report::plot::decimate::{PER_COLUMN, decimate};

/// Pixel columns for which a thinned curve still looks the same: a wide screen, a few times magnified.
const PIXELS: usize = 4000;

/// Base64 of bytes, with padding.
pub fn base64(bytes: &[u8]) -> String {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().enumerate().fold(0u32, |w, (i, b)| w | u32::from(*b) << (16 - 8 * i));
        for i in 0..4 {
            let sign = SIGNS[(word >> (18 - 6 * i)) as usize & 63];
            out.push(if i <= chunk.len() { char::from(sign) } else { '=' });
        }
    }
    out
}

/// The arrays of a page, each once.
#[derive(Default)]
pub struct Arrays(Vec<Json>);

impl Arrays {
    /// Adds values in double precision; their position.
    pub fn doubles(&mut self, values: &[f64]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.push("f64", &bytes)
    }

    /// Adds values in single precision, seven digits: enough for any picture. Their position.
    pub fn singles(&mut self, values: &[f64]) -> usize {
        let single = |x: &f64| (*x as f32).clamp(f32::MIN, f32::MAX);
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|x| if x.is_nan() { f32::NAN } else { single(x) }.to_le_bytes())
            .collect();
        self.push("f32", &bytes)
    }

    fn push(&mut self, kind: &str, bytes: &[u8]) -> usize {
        self.0.push(Json::object([(kind, Json::text(base64(bytes)))]));
        self.0.len() - 1
    }

    /// All of them as a list.
    pub fn json(self) -> Json {
        Json::list(self.0)
    }
}

/// The columns of a run: for each a time array, a value array and a factor, or its only value.
pub fn columns(run: &Trajectory, column_storage: &[ColumnStorage], arrays: &mut Arrays) -> Json {
    let rows = run.rows();
    let thin = rows > PER_COLUMN * PIXELS;
    let time = if thin { 0 } else { arrays.doubles(&run.time) };
    let mut known: Vec<(usize, usize)> = Vec::new();
    let mut out = Vec::new();
    for (k, values) in run.data.iter().enumerate() {
        let constant = values.iter().all(|x| *x == values[0]);
        if constant {
            known.push((0, 0));
            out.push(Json::number(values.first().copied().unwrap_or(0.0)));
            continue;
        }
        let (mut place, mut factor) = (None, 1.0);
        if let Some(ColumnStorage::Alias { of, negated }) = column_storage.get(k)
            && let Some(first) = known.get(*of)
        {
            place = Some(*first);
            factor = if *negated { -1.0 } else { 1.0 };
        }
        let (t, v) = place.unwrap_or_else(|| {
            if !thin {
                return (time, arrays.singles(values));
            }
            let kept = decimate(&run.time, values, PIXELS);
            let of = |all: &[f64]| kept.iter().map(|i| all[*i]).collect::<Vec<f64>>();
            (arrays.doubles(&of(&run.time)), arrays.singles(&of(values)))
        });
        known.push((t, v));
        out.push(Json::list([Json::count(t), Json::count(v), Json::number(factor)]));
    }
    Json::list(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::trajectory::Column;

    #[test]
    fn the_examples_of_rfc_4648() {
        let pairs = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in pairs {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn a_long_run_keeps_its_peaks() {
        let mut run = Trajectory::new(vec![Column::new("x", ""), Column::new("c", "")]);
        for i in 0..60_000 {
            run.push(f64::from(i), &[if i == 31_234 { 9.0 } else { f64::from(i % 2) }, 3.0]);
        }
        let mut arrays = Arrays::default();
        let json =
            columns(&run, &[ColumnStorage::Own, ColumnStorage::Constant], &mut arrays).compact();
        assert_eq!(json, "[[0,1,1.0],3.0]");
        let text = arrays.json().compact();
        assert!(text.len() < 60_000 * 12, "{}", text.len());
        let bytes = decoded(text.rsplit('"').nth(1).unwrap());
        let values: Vec<f32> =
            bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(values.iter().filter(|x| **x == 9.0).count(), 1);
        assert!(values.contains(&0.0) && values.contains(&1.0));
    }

    fn decoded(text: &str) -> Vec<u8> {
        const SIGNS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let place = |c: char| SIGNS.find(c).map(|k| k as u32);
        let signs: Vec<u32> = text.chars().filter_map(place).collect();
        let word = |c: &[u32]| c.iter().enumerate().fold(0, |w, (i, s)| w | s << (18 - 6 * i));
        let bytes = |c: &[u32]| (0..c.len() - 1).map(|i| (word(c) >> (16 - 8 * i)) as u8).collect();
        signs.chunks(4).flat_map(|c| -> Vec<u8> { bytes(c) }).collect()
    }
}
