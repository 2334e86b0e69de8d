//! The response of a linear system to sinusoidal inputs: `G(iω) = C (iω - A)⁻¹ B + D`.

use crate::numeric::eigenvalues::Complex;
use crate::numeric::linear::complex::ComplexLu;

use super::linearize::Linearization;

/// Frequencies of a response.
const POINTS: usize = 400;
/// Decades below the slowest and above the fastest eigenvalue.
const AROUND: f64 = 1.5;
/// Eigenvalues that are smaller than the largest by this factor are integrators.
const NEGLIGIBLE: f64 = 1e-9;

/// A response over frequency.
#[derive(Clone, PartialEq, Debug)]
pub struct FrequencyResponse {
    /// Frequencies, Hz, ascending.
    pub frequencies: Vec<f64>,
    /// For each output, and for it each input.
    pub responses: Vec<Response>,
}

/// The response of an output to an input, at each frequency.
#[derive(Clone, PartialEq, Debug)]
pub struct Response {
    /// Ratio of the amplitudes in SI units, dB; NaN where it is zero or infinite.
    pub decibels: Vec<f64>,
    /// Phase, degrees, without jumps by a turn.
    pub phases: Vec<f64>,
}

impl FrequencyResponse {
    /// The response of a system around its eigenvalues, or around 1 Hz if it has none.
    pub fn of(system: &Linearization) -> Self {
        let all = system.eigenvalues().unwrap_or_default();
        let sizes: Vec<f64> = all.iter().map(|x| x.abs()).filter(|x| *x > 0.0).collect();
        let most = sizes.iter().copied().fold(0.0, f64::max);
        let (low, high) = match most > 0.0 {
            true => {
                let moving = sizes.iter().filter(|x| **x > NEGLIGIBLE * most);
                (moving.copied().fold(most, f64::min).log10(), most.log10())
            }
            false => (std::f64::consts::TAU.log10(), std::f64::consts::TAU.log10()),
        };
        let (low, high) = (low - AROUND, high + AROUND);
        let place = |k: usize| low + (high - low) * k as f64 / (POINTS - 1) as f64;
        let speeds: Vec<f64> = (0..POINTS).map(|k| 10_f64.powf(place(k))).collect();
        let mut responses =
            vec![Vec::with_capacity(POINTS); system.outputs.len() * system.inputs.len()];
        for speed in &speeds {
            for (series, value) in responses.iter_mut().zip(at(system, *speed)) {
                series.push(value);
            }
        }
        let frequencies = speeds.iter().map(|speed| speed / std::f64::consts::TAU).collect();
        let responses = responses.iter().map(|values| Response {
            decibels: values.iter().map(decibels).collect(),
            phases: phases(values),
        });
        FrequencyResponse { frequencies, responses: responses.collect() }
    }
}

/// The responses at an angular frequency, rad/s, outputs by inputs; NaN at an undamped resonance.
fn at(system: &Linearization, speed: f64) -> Vec<Complex> {
    let (n, m, p) = (system.states.len(), system.inputs.len(), system.outputs.len());
    let mut lu = ComplexLu::new(n);
    let factored = lu.factor_with(|re, im| {
        im.fill(0.0);
        for i in 0..n {
            (0..n).for_each(|j| re[i + n * j] = -system.a[n * i + j]);
            im[i + n * i] = speed;
        }
    });
    let mut out = vec![Complex { re: f64::NAN, im: f64::NAN }; p * m];
    if factored.is_err() {
        return out;
    }
    for j in 0..m {
        let mut re: Vec<f64> = (0..n).map(|i| system.b[m * i + j]).collect();
        let mut im = vec![0.0; n];
        lu.solve_in_place(&mut re, &mut im);
        for k in 0..p {
            let row = &system.c[n * k..n * (k + 1)];
            let along = |x: &[f64]| row.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
            out[m * k + j] = Complex { re: along(&re) + system.d[m * k + j], im: along(&im) };
        }
    }
    out
}

fn decibels(value: &Complex) -> f64 {
    let size = value.abs();
    if size > 0.0 { 20.0 * size.log10() } else { f64::NAN }
}

fn phases(values: &[Complex]) -> Vec<f64> {
    let mut before: Option<f64> = None;
    let one = |value: &Complex| {
        let raw = value.im.atan2(value.re).to_degrees();
        if !raw.is_finite() {
            return f64::NAN;
        }
        let near = before.map_or(raw, |last: f64| raw + 360.0 * ((last - raw) / 360.0).round());
        before = Some(near);
        near
    };
    values.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::index::Id;
    use crate::ir::expr::VarId;

    /// `x'' + 2 D w x' + w^2 x = w^2 u`, output `x`: 0 dB far below `w`, -20 log10(2 D) and -90 degrees at `w`, and
    /// -40 dB by decade above.
    #[test]
    fn an_oscillator_has_its_closed_form() {
        let (w, damping) = (20.0, 0.1);
        let v = VarId::from_usize;
        let system = Linearization {
            time: 0.0,
            states: vec![v(0), v(1)],
            inputs: vec![v(2)],
            outputs: vec![v(0)],
            x: vec![0.0; 2],
            rates: vec![0.0; 2],
            u: vec![0.0],
            y: vec![0.0],
            a: vec![0.0, 1.0, -w * w, -2.0 * damping * w],
            b: vec![0.0, w * w],
            c: vec![1.0, 0.0],
            d: vec![0.0],
        };
        let found = FrequencyResponse::of(&system);
        let response = &found.responses[0];
        for ((f, level), phase) in
            found.frequencies.iter().zip(&response.decibels).zip(&response.phases)
        {
            let r = std::f64::consts::TAU * f / w;
            let (re, im) = (1.0 - r * r, 2.0 * damping * r);
            assert!((level + 20.0 * re.hypot(im).log10()).abs() < 1e-9, "{f}");
            assert!((phase + im.atan2(re).to_degrees()).abs() < 1e-9, "{f}");
        }
        assert!(found.frequencies[0] < 0.1 * w && found.frequencies[399] > w);
    }
}
