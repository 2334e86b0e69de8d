//! Run time of the integrators on published problems, and of the decompositions that they use.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use mocc::integrate::bdf::Bdf;
use mocc::integrate::options::Options;
use mocc::integrate::outcome::Step;
use mocc::integrate::radau::Radau;
use mocc::integrate::stepper::{JacobianMemory, Stepper};
use mocc::integrate::system::{EvalError, System};
use mocc::numeric::linear::DenseLu;
use mocc::numeric::linear::complex::ComplexLu;
use mocc::numeric::small_lu;

/// Counts allocations; a step must not make any.
#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

const TOLERANCES: [f64; 2] = [1e-6, 1e-8];
const ORDERS: [usize; 6] = [4, 8, 13, 24, 32, 64];

/// Robertson's reaction over eleven decades of time.
#[divan::bench(args = TOLERANCES)]
fn robertson(bencher: Bencher, rtol: f64) {
    let mut stepper =
        Radau::new(3, Options::with_nominals(rtol, &[1e-6, 1e-12, 1e-2])).expect("valid options");
    bencher.bench_local(|| solve(&mut stepper, &mut Robertson, &[1.0, 0.0, 0.0], 1e11));
}

/// The response of plants to light.
#[divan::bench(args = TOLERANCES)]
fn hires(bencher: Bencher, rtol: f64) {
    let mut stepper =
        Radau::new(8, Options::with_nominals(rtol, &[1e-3; 8])).expect("valid options");
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    bencher.bench_local(|| solve(&mut stepper, &mut Hires, &start, 321.8122));
}

/// Robertson's reaction, backward differentiation.
#[divan::bench(args = TOLERANCES)]
fn robertson_bdf(bencher: Bencher, rtol: f64) {
    let mut stepper =
        Bdf::new(3, Options::with_nominals(rtol, &[1e-6, 1e-12, 1e-2])).expect("valid options");
    bencher.bench_local(|| solve(&mut stepper, &mut Robertson, &[1.0, 0.0, 0.0], 1e11));
}

/// The response of plants to light, backward differentiation.
#[divan::bench(args = TOLERANCES)]
fn hires_bdf(bencher: Bencher, rtol: f64) {
    let mut stepper = Bdf::new(8, Options::with_nominals(rtol, &[1e-3; 8])).expect("valid options");
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    bencher.bench_local(|| solve(&mut stepper, &mut Hires, &start, 321.8122));
}

/// A chain of 13 stores: the cost of one step at the order of a valve model.
#[divan::bench]
fn chain_of_thirteen(bencher: Bencher) {
    let mut stepper = Radau::new(13, Options::new(13)).expect("valid options");
    let start: Vec<f64> = (0..13).map(|i| 1.0 + i as f64).collect();
    let steps = solve(&mut stepper, &mut Chain, &start, 10.0);
    bencher
        .counter(ItemsCount::new(steps))
        .bench_local(|| solve(&mut stepper, &mut Chain, &start, 10.0));
}

/// The chain with an event every 6 ms that lifts its first store: restarts and transients.
#[divan::bench]
fn chain_with_twenty_events(bencher: Bencher) {
    let mut stepper = Radau::new(13, Options::new(13)).expect("valid options");
    let mut y = [0.0; 13];
    let mut run = || {
        let before = stepper.stats().steps;
        y.fill(1.0);
        for event in 0..20 {
            y[0] += 1.0;
            let (t, t_stop) = (6e-3 * f64::from(event), 6e-3 * f64::from(event + 1));
            stepper.restart(&mut Chain, t, &y, JacobianMemory::Forget).expect("a start");
            while let Step::Advanced { .. } = stepper.step(&mut Chain, t_stop).expect("a step") {}
            y.copy_from_slice(stepper.y());
        }
        stepper.stats().steps - before
    };
    let steps = run();
    bencher.counter(ItemsCount::new(steps)).bench_local(run);
}

/// The plain loops alone, with the copy of the matrix.
#[divan::bench(args = ORDERS)]
fn factor_real_plain(bencher: Bencher, n: usize) {
    let a = scatter(n * n);
    let (mut lu, mut pivots) = (vec![0.0; n * n], vec![0; n]);
    bencher.bench_local(|| {
        lu.copy_from_slice(black_box(&a));
        small_lu::factor(n, &mut lu, &mut pivots)
    });
}

/// The decomposition of the integrator: plain loops or faer, by order.
#[divan::bench(args = ORDERS)]
fn factor_real(bencher: Bencher, n: usize) {
    let a = scatter(n * n);
    let mut lu = DenseLu::new(n);
    bencher.bench_local(|| lu.factor(black_box(&a)));
}

/// The plain loops alone, with the copy of the matrix.
#[divan::bench(args = ORDERS)]
fn factor_complex_plain(bencher: Bencher, n: usize) {
    let a = scatter(n * n);
    let (mut re, mut im, mut pivots) = (vec![0.0; n * n], vec![0.0; n * n], vec![0; n]);
    bencher.bench_local(|| {
        re.copy_from_slice(black_box(&a));
        im.copy_from_slice(black_box(&a));
        small_lu::factor_complex(n, &mut re, &mut im, &mut pivots)
    });
}

/// The decomposition of the integrator: plain loops or faer, by order.
#[divan::bench(args = ORDERS)]
fn factor_complex(bencher: Bencher, n: usize) {
    let a = scatter(n * n);
    let mut lu = ComplexLu::new(n);
    bencher.bench_local(|| lu.factor(black_box(&a), black_box(&a)));
}

/// One right-hand side.
#[divan::bench(args = ORDERS)]
fn solve_real(bencher: Bencher, n: usize) {
    let mut lu = DenseLu::new(n);
    lu.factor(&scatter(n * n)).expect("a regular matrix");
    let (b, mut x) = (scatter(n), vec![0.0; n]);
    bencher.bench_local(|| {
        x.copy_from_slice(black_box(&b));
        lu.solve_in_place(&mut x);
    });
}

/// One complex right-hand side.
#[divan::bench(args = ORDERS)]
fn solve_complex(bencher: Bencher, n: usize) {
    let mut lu = ComplexLu::new(n);
    lu.factor(&scatter(n * n), &scatter(n * n)).expect("a regular matrix");
    let (b, mut x, mut y) = (scatter(n), vec![0.0; n], vec![0.0; n]);
    bencher.bench_local(|| {
        x.copy_from_slice(black_box(&b));
        y.copy_from_slice(black_box(&b));
        lu.solve_in_place(&mut x, &mut y);
    });
}

fn solve(stepper: &mut impl Stepper, system: &mut dyn System, start: &[f64], t_stop: f64) -> u64 {
    stepper.restart(system, 0.0, start, JacobianMemory::Forget).expect("a start");
    let before = stepper.stats().steps;
    while let Step::Advanced { .. } = stepper.step(system, t_stop).expect("a step") {}
    stepper.stats().steps - before
}

/// Entries in (-1, 1), with a diagonal that keeps the matrix regular.
fn scatter(count: usize) -> Vec<f64> {
    let mut state = 1_u64;
    (0..count)
        .map(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect()
}

struct Robertson;

impl System for Robertson {
    fn dim(&self) -> usize {
        3
    }
    fn differential(&self) -> &[bool] {
        &[true; 3]
    }
    fn rhs(&mut self, _: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let (slow, back, fast) = (0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]);
        f.copy_from_slice(&[back - slow, slow - back - fast, fast]);
        Ok(())
    }
    fn jacobian(&mut self, _: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let (a, b, c) = (1e4 * y[2], 1e4 * y[1], 6e7 * y[1]);
        j.copy_from_slice(&[-0.04, 0.04, 0.0, a, -a - c, c, b, -b, 0.0]);
        Ok(())
    }
}

struct Hires;

impl System for Hires {
    fn dim(&self) -> usize {
        8
    }
    fn differential(&self) -> &[bool] {
        &[true; 8]
    }
    fn rhs(&mut self, _: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let r = 280.0 * y[5] * y[7];
        f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
        f[1] = 1.71 * y[0] - 8.75 * y[1];
        f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
        f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
        f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
        f[5] = -r + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
        f[6] = r - 1.81 * y[6];
        f[7] = -f[6];
        Ok(())
    }
    fn jacobian(&mut self, _: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let (p, q) = (280.0 * y[7], 280.0 * y[5]);
        j[..2].copy_from_slice(&[-1.71, 1.71]);
        j[8..12].copy_from_slice(&[0.43, -8.75, 0.0, 8.32]);
        j[16..20].copy_from_slice(&[8.32, 0.0, -10.03, 1.71]);
        j[26..30].copy_from_slice(&[0.43, -1.12, 0.0, 0.69]);
        j[34..38].copy_from_slice(&[0.035, 0.0, -1.745, 1.71]);
        j[44..48].copy_from_slice(&[0.43, -0.43 - p, p, -p]);
        j[52..56].copy_from_slice(&[0.43, 0.69, -1.81, 1.81]);
        j[61..64].copy_from_slice(&[-q, q, -q]);
        Ok(())
    }
}

/// Stores in a row; each exchanges with its neighbours as the square of the difference, at rates
/// over six decades.
struct Chain;

impl Chain {
    fn rate(i: usize) -> f64 {
        10.0_f64.powi(i as i32 % 7)
    }
}

impl System for Chain {
    fn dim(&self) -> usize {
        13
    }
    fn differential(&self) -> &[bool] {
        &[true; 13]
    }
    fn rhs(&mut self, _: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        f.fill(0.0);
        for i in 0..12 {
            let d = y[i + 1] - y[i];
            let flow = Self::rate(i) * d * (1.0 + d.abs());
            f[i] += flow;
            f[i + 1] -= flow;
        }
        Ok(())
    }
    fn jacobian(&mut self, _: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        for i in 0..12 {
            let slope = Self::rate(i) * (1.0 + 2.0 * (y[i + 1] - y[i]).abs());
            j[i + 13 * i] -= slope;
            j[i + 1 + 13 * i] += slope;
            j[i + 13 * (i + 1)] += slope;
            j[i + 1 + 13 * (i + 1)] -= slope;
        }
        Ok(())
    }
}
