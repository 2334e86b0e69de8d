//! Decimates curves without changing the picture: of all points in a pixel column only the first,
//! the lowest, the highest, the last and both sides of the highest jump are kept.

/// Maximum number of points kept per pixel column.
pub const PER_COLUMN: usize = 6;

/// Positions to draw of the curve `x`, `y` (equally long, `x` not decreasing), ascending.
/// `columns` is the number of pixel columns; up to [`PER_COLUMN`] points each are all kept.
pub fn decimate(x: &[f64], y: &[f64], columns: usize) -> Vec<usize> {
    let rows = x.len().min(y.len());
    let columns = columns.max(1);
    let extent = if rows > 0 { x[rows - 1] - x[0] } else { 0.0 };
    if rows <= PER_COLUMN * columns || extent <= 0.0 {
        return (0..rows).collect();
    }
    let column = |i: usize| (((x[i] - x[0]) / extent * columns as f64) as usize).min(columns - 1);
    let mut kept = Vec::with_capacity(PER_COLUMN * columns);
    let mut first = 0;
    while first < rows {
        let here = column(first);
        let (mut low, mut high, mut last) = (first, first, first);
        // The row before the jump, and its height.
        let (mut jump, mut step) = (first, 0.0);
        while last + 1 < rows && column(last + 1) == here {
            last += 1;
            let height = (y[last] - y[last - 1]).abs();
            if x[last] == x[last - 1] && height > step {
                (jump, step) = (last - 1, height);
            }
            if y[last] < y[low] {
                low = last;
            }
            if y[last] > y[high] {
                high = last;
            }
        }
        let mut chosen = [first, low, high, jump, (jump + 1).min(last), last];
        chosen.sort_unstable();
        kept.extend_from_slice(&chosen);
        first = last + 1;
    }
    kept.dedup();
    kept
}

/// Drops repeated points, and points within horizontal or vertical lines; exact on the integer grid
/// of a picture.
pub fn merge_straight(points: impl IntoIterator<Item = (i32, i32)>) -> Vec<(i32, i32)> {
    let mut kept: Vec<(i32, i32)> = Vec::new();
    for point in points {
        if kept.last() == Some(&point) {
            continue;
        }
        if let [.., a, b] = kept[..] {
            let level = a.1 == b.1 && b.1 == point.1 && (b.0 - a.0 > 0) == (point.0 - b.0 > 0);
            let upright = a.0 == b.0 && b.0 == point.0 && (b.1 - a.1 > 0) == (point.1 - b.1 > 0);
            if level || upright {
                kept.pop();
            }
        }
        kept.push(point);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_and_ends_survive() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (x * 1e-4).sin()).collect();
        y[31_234] = 9.0;
        y[77_777] = -9.0;
        let kept = decimate(&x, &y, 500);
        assert!(kept.len() <= 500 * PER_COLUMN && kept.is_sorted());
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 99_999));
        assert!(kept.contains(&31_234) && kept.contains(&77_777));
    }

    #[test]
    fn both_limits_of_a_jump_survive() {
        let x: Vec<f64> = (0..5000).map(|i| f64::from(if i > 2500 { i - 1 } else { i })).collect();
        let y: Vec<f64> = (0..5000).map(|i| if i > 2500 { 1.0 } else { 0.0 }).collect();
        assert_eq!(x[2500], x[2501]);
        let kept = decimate(&x, &y, 10);
        let steps = kept.windows(2).filter(|w| y[w[0]] != y[w[1]]).collect::<Vec<_>>();
        assert_eq!(steps, [&[2500, 2501]]);
    }

    #[test]
    fn short_curves_stay_whole() {
        assert_eq!(decimate(&[0.0, 1.0, 1.0], &[0.0, 0.0, 1.0], 1), [0, 1, 2]);
        assert_eq!(decimate(&[], &[], 9), [0; 0]);
        assert_eq!(decimate(&[2.0; 9], &[1.0; 9], 1).len(), 9);
    }

    #[test]
    fn straight_runs_keep_their_ends_and_reversals() {
        let straight = merge_straight([(0, 0), (1, 0), (1, 0), (5, 0), (5, 3), (5, 9), (6, 10)]);
        assert_eq!(straight, [(0, 0), (5, 0), (5, 9), (6, 10)]);
        assert_eq!(merge_straight([(0, 0), (0, 9), (0, 4)]), [(0, 0), (0, 9), (0, 4)]);
    }
}
