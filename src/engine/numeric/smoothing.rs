//! Smoothing of noisy recordings by local polynomials.
//!
//! A. Savitzky, M. J. E. Golay, Anal. Chem. 36, 1964 (local polynomials, here over a window of time
//! instead of a number of samples, so that instants need not be equidistant); W. S. Cleveland, J.
//! Am. Stat. Assoc. 74, 1979 (weights).

/// Smoothed values and rates of a recording: at each instant those of the parabola that fits the
/// samples within `half` of it best, with Cleveland's tricube weights. Instants with too few
/// neighbours keep their value and take the slope to the adjacent sample.
pub fn smoothed(times: &[f64], values: &[f64], half: f64) -> (Vec<f64>, Vec<f64>) {
    let n = times.len();
    let (mut smooth, mut rates) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let mut first = 0;
    for k in 0..n {
        let t = times[k];
        while times[first] < t - half {
            first += 1;
        }
        let (mut s, mut r) = ([0.0; 5], [0.0; 3]);
        let near =
            times[first..].iter().zip(&values[first..]).take_while(|(at, _)| **at <= t + half);
        let mut count = 0;
        for (at, y) in near {
            let x = (at - t) / half;
            let w = (1.0 - x.abs().powi(3)).max(0.0).powi(3);
            count += usize::from(w > 0.0);
            let mut power = w;
            for (j, s) in s.iter_mut().enumerate() {
                *s += power;
                if let Some(r) = r.get_mut(j) {
                    *r += power * y;
                }
                power *= x;
            }
        }
        let det = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[3] * s[2])
            + s[2] * (s[1] * s[3] - s[2] * s[2]);
        if count < 4 || !(det > 1e-12 * s[0] * s[2] * s[4]) {
            let other = if k > 0 { k - 1 } else { (k + 1).min(n - 1) };
            let dt = t - times[other];
            smooth.push(values[k]);
            rates.push(if dt == 0.0 { 0.0 } else { (values[k] - values[other]) / dt });
            continue;
        }
        let value = r[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (r[1] * s[4] - s[3] * r[2])
            + s[2] * (r[1] * s[3] - s[2] * r[2]);
        let rate = s[0] * (r[1] * s[4] - r[2] * s[3]) - r[0] * (s[1] * s[4] - s[3] * s[2])
            + s[2] * (s[1] * r[2] - r[1] * s[2]);
        smooth.push(value / det);
        rates.push(rate / det / half);
    }
    (smooth, rates)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_reproduced() {
        let times: Vec<f64> =
            (0..60).map(|k| 0.1 * k as f64 + 0.01 * ((k * k) % 3) as f64).collect();
        let f = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t;
        let values: Vec<f64> = times.iter().map(|t| f(*t)).collect();
        let (smooth, rates) = smoothed(&times, &values, 0.5);
        for ((t, y), v) in times.iter().zip(smooth).zip(rates) {
            assert!((y - f(*t)).abs() < 1e-11 && (v - (t - 2.0)).abs() < 1e-9, "{t} {y} {v}");
        }
    }
}
