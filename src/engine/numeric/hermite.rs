//! Piecewise cubic Hermite interpolation: polynomials, and slopes at the points.
//!
//! H. Akima, "A new method of interpolation and smooth curve fitting based on local procedures", J.
//! ACM 17 (1970) 589-602. F. N. Fritsch and J. Butland, "A method for constructing local monotone
//! piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5 (1984) 300-304. M. Steffen, "A
//! simple method for monotonic interpolation in one dimension", Astron. Astrophys. 239 (1990)
//! 443-450. The modified weights are those of C. Moler, "Makima piecewise cubic interpolation",
//! 2019. The spline with two continuous derivatives: C. de Boor, *A Practical Guide to Splines*,
//! 2001, ch. IV, with natural ends.

/// How values between the points are interpolated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Smoothness {
    /// Straight lines.
    Linear,
    /// Cubic polynomials with Akima's slopes.
    Akima,
    /// The value of the last point.
    Constant,
    /// Cubic polynomials that are monotone where the points are, with the slopes of Fritsch and
    /// Butland.
    FritschButland,
    /// The same with the slopes of Steffen.
    Steffen,
    /// Akima's slopes with weights that avoid overshoots next to constant segments.
    ModifiedAkima,
}

impl Smoothness {
    /// The variant with this number, counted from 1 in the order of declaration.
    pub fn numbered(number: u32) -> Option<Smoothness> {
        use Smoothness::*;
        let all = [Linear, Akima, Constant, FritschButland, Steffen, ModifiedAkima];
        all.get(number.checked_sub(1)? as usize).copied()
    }
}

/// The cubic polynomial in the distance from the first of two points, from values and slopes.
#[inline]
pub fn hermite(h: f64, y0: f64, y1: f64, s0: f64, s1: f64) -> [f64; 4] {
    let secant = (y1 - y0) / h;
    [y0, s0, (3.0 * secant - 2.0 * s0 - s1) / h, (s0 + s1 - 2.0 * secant) / (h * h)]
}

/// The derivative of this order of a cubic polynomial at distance `h`; the value for order 0.
#[inline]
pub fn polynomial(c: &[f64; 4], h: f64, order: u8) -> f64 {
    match order {
        0 => c[0] + h * (c[1] + h * (c[2] + h * c[3])),
        1 => c[1] + h * (2.0 * c[2] + h * 3.0 * c[3]),
        2 => 2.0 * c[2] + h * 6.0 * c[3],
        3 => 6.0 * c[3],
        _ => 0.0,
    }
}

/// The slope at each point. `x` is increasing; `periodic` continues the end with the start. Two
/// points are joined by a line.
pub fn slopes(smoothness: Smoothness, x: &[f64], y: &[f64], periodic: bool) -> Vec<f64> {
    let n = x.len();
    let secants: Vec<f64> = (1..n).map(|i| (y[i] - y[i - 1]) / (x[i] - x[i - 1])).collect();
    match (n, smoothness) {
        (0 | 1, _) => vec![0.0; n],
        (2, _) => vec![secants[0]; 2],
        (_, Smoothness::Akima | Smoothness::ModifiedAkima) => {
            let d = extended(&secants, periodic);
            let modified = smoothness == Smoothness::ModifiedAkima;
            (0..n)
                .map(|i| {
                    let (left, right) = weights(&d[i..i + 4], modified);
                    left * d[i + 1] + right * d[i + 2]
                })
                .collect()
        }
        _ => {
            let widths: Vec<f64> = x.windows(2).map(|p| p[1] - p[0]).collect();
            let inner = |i: usize, j: usize| match smoothness {
                Smoothness::FritschButland => {
                    fritsch_butland(secants[i], secants[j], widths[i], widths[j])
                }
                _ => steffen(secants[i], secants[j], widths[i], widths[j]),
            };
            let ends = if periodic { [inner(n - 2, 0); 2] } else { [secants[0], secants[n - 2]] };
            let mut all = vec![ends[0]];
            all.extend((1..n - 1).map(|i| inner(i - 1, i)));
            all.push(ends[1]);
            all
        }
    }
}

/// The slopes that make the curvature continuous, with zero curvature at the ends: a tridiagonal
/// system.
pub fn spline_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 3 {
        return slopes(Smoothness::FritschButland, x, y, false);
    }
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let chords: Vec<f64> = y.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
    (upper[0], right[0]) = (0.5, 1.5 * chords[0]);
    for k in 1..n {
        let (below, diagonal, above, r) = if k + 1 < n {
            let r = 3.0 * (h[k] * chords[k - 1] + h[k - 1] * chords[k]);
            (h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1], r)
        } else {
            (1.0, 2.0, 0.0, 3.0 * chords[n - 2])
        };
        let pivot = diagonal - below * upper[k - 1];
        upper[k] = above / pivot;
        right[k] = (r - below * right[k - 1]) / pivot;
    }
    for k in (0..n - 1).rev() {
        right[k] -= upper[k] * right[k + 1];
    }
    right
}

/// Secants with two more on each side: by Akima's parabola or, if periodic, from the other end.
pub fn extended(secants: &[f64], periodic: bool) -> Vec<f64> {
    let n = secants.len();
    let mut d = vec![0.0; n + 4];
    d[2..n + 2].copy_from_slice(secants);
    if periodic {
        for k in 0..2 {
            d[1 - k] = secants[(2 * n - 1 - k) % n];
            d[n + 2 + k] = secants[k % n];
        }
    } else if n == 1 {
        d.fill(secants[0]);
    } else {
        d[1] = 2.0 * d[2] - d[3];
        d[0] = 2.0 * d[1] - d[2];
        d[n + 2] = 2.0 * d[n + 1] - d[n];
        d[n + 3] = 2.0 * d[n + 2] - d[n + 1];
    }
    d
}

/// The weights of the secants before and after a point, given the two on each side; their sum is 1.
pub fn weights(d: &[f64], modified: bool) -> (f64, f64) {
    let weight = |a: f64, b: f64| {
        let change = (b - a).abs();
        if modified { change + 0.5 * (a + b).abs() } else { change }
    };
    let (left, right) = (weight(d[2], d[3]), weight(d[0], d[1]));
    let sum = left + right;
    let size = d.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    if sum <= 1e-14 * size || sum == 0.0 {
        return (0.5, 0.5);
    }
    (left / sum, right / sum)
}

/// The weighted harmonic mean where both secants rise or both fall, else 0.
fn fritsch_butland(a: f64, b: f64, ha: f64, hb: f64) -> f64 {
    if a * b <= 0.0 {
        return 0.0;
    }
    let sum = ha + hb;
    3.0 * sum / ((sum + hb) / a + (sum + ha) / b)
}

/// The slope of the parabola through three points, limited by twice the smaller secant.
fn steffen(a: f64, b: f64, ha: f64, hb: f64) -> f64 {
    if a * b <= 0.0 {
        return 0.0;
    }
    let parabola = (a * hb + b * ha) / (ha + hb);
    2.0_f64.copysign(a) * a.abs().min(b.abs()).min(0.5 * parabola.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Smoothness; 4] = [
        Smoothness::Akima,
        Smoothness::ModifiedAkima,
        Smoothness::FritschButland,
        Smoothness::Steffen,
    ];

    #[test]
    fn a_line_keeps_its_slope() {
        let x = [0.0, 1.0, 3.0, 4.5, 7.0];
        let y = x.map(|x| 2.0 - 3.0 * x);
        for smoothness in ALL {
            for slope in slopes(smoothness, &x, &y, false) {
                assert!((slope + 3.0).abs() < 1e-14, "{smoothness:?}: {slope}");
            }
        }
    }

    /// Akima's first criterion: a parabola on equal steps is reproduced exactly in the interior.
    #[test]
    fn a_parabola_on_equal_steps_has_its_own_slopes() {
        let x: Vec<f64> = (0..7).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| x * x).collect();
        let found = slopes(Smoothness::Akima, &x, &y, false);
        for (x, slope) in x.iter().zip(found) {
            assert!((slope - 2.0 * x).abs() < 1e-13, "{x}: {slope}");
        }
    }

    /// At a corner between a constant and a rising segment, Akima's slope is that of the constant
    /// one.
    #[test]
    fn a_constant_segment_stays_constant() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let y = [0.0, 0.0, 0.0, 0.0, 1.0, 3.0];
        for smoothness in ALL {
            let found = slopes(smoothness, &x, &y, false);
            assert_eq!(found[1], 0.0, "{smoothness:?}");
            assert_eq!(found[2], 0.0, "{smoothness:?}");
        }
    }

    /// The harmonic mean of secants 1 and 3 on equal steps is 1.5; Steffen's parabola gives 2,
    /// which the bound of twice the smaller one allows.
    #[test]
    fn monotone_slopes_are_those_of_the_papers() {
        let (x, y) = ([0.0, 1.0, 2.0], [0.0, 1.0, 4.0]);
        assert_eq!(slopes(Smoothness::FritschButland, &x, &y, false)[1], 1.5);
        assert_eq!(slopes(Smoothness::Steffen, &x, &y, false)[1], 2.0);
    }
}
