//! Error and run time of our methods and of a peer, diffsol's BDF, at several tolerances; then the
//! run time of ours relative to the peer at equal error.
//!
//! `cargo bench --features peer --bench peer`. All solvers use the same right-hand sides,
//! derivatives, tolerances and output times; the error is the largest over output times and
//! components, in units of `|y| + nominal`. Times are the shortest of many runs, from the start
//! values to the last output, with the memory of the solver allocated. Reference: Radau at a much
//! smaller tolerance.

use std::hint::black_box;
use std::time::Instant;

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};
use mocc::integrate::bdf::Bdf;
use mocc::integrate::options::Options;
use mocc::integrate::radau::Radau;
use mocc::integrate::stepper::{JacobianMemory, Stepper};
use mocc::integrate::switching::{Choices, Switching};
use mocc::integrate::system::{EvalError, System};

/// Tolerances of the solvers.
const TOLERANCES: [f64; 7] = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// Errors at which run times are compared.
const ERRORS: [f64; 4] = [1e-4, 1e-5, 1e-6, 1e-8];
/// Tolerance of the reference.
const REFERENCE: f64 = 1e-13;
/// Number of runs, of which the fastest counts.
const RUNS: usize = 30;

/// A problem with `N` components, as both solvers receive it.
trait Problem<const N: usize> {
    const NAME: &'static str;
    const START: [f64; N];
    const NOMINALS: [f64; N];
    fn outputs() -> Vec<f64>;
    fn rhs(t: f64, y: &[f64], f: &mut [f64]);
    /// Column-major; `j` arrives filled with zeros.
    fn jacobian(t: f64, y: &[f64], j: &mut [f64]);
    /// The product of the Jacobian with `v`, computed as fast as possible.
    fn product(t: f64, y: &[f64], v: &[f64], out: &mut [f64]);
}

struct Robertson;

impl Problem<3> for Robertson {
    const NAME: &'static str = "Robertson";
    const START: [f64; 3] = [1.0, 0.0, 0.0];
    const NOMINALS: [f64; 3] = [1e-6, 1e-12, 1e-2];
    fn outputs() -> Vec<f64> {
        (-1..=10).map(|k| 4.0 * 10.0_f64.powi(k)).collect()
    }
    fn rhs(_: f64, y: &[f64], f: &mut [f64]) {
        let (slow, back, fast) = (0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]);
        f[0] = back - slow;
        f[1] = slow - back - fast;
        f[2] = fast;
    }
    fn jacobian(_: f64, y: &[f64], j: &mut [f64]) {
        let (a, b, c) = (1e4 * y[2], 1e4 * y[1], 6e7 * y[1]);
        j.copy_from_slice(&[-0.04, 0.04, 0.0, a, -a - c, c, b, -b, 0.0]);
    }
    fn product(_: f64, y: &[f64], v: &[f64], out: &mut [f64]) {
        let (slow, fast) = (0.04 * v[0], 6e7 * y[1] * v[1]);
        let back = 1e4 * (v[1] * y[2] + y[1] * v[2]);
        out[0] = back - slow;
        out[1] = slow - back - fast;
        out[2] = fast;
    }
}

struct Hires;

impl Problem<8> for Hires {
    const NAME: &'static str = "HIRES";
    const START: [f64; 8] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    const NOMINALS: [f64; 8] = [1e-3; 8];
    fn outputs() -> Vec<f64> {
        (1..=10).map(|k| 32.18122 * f64::from(k)).collect()
    }
    fn rhs(_: f64, y: &[f64], f: &mut [f64]) {
        linear_part(y, f);
        let r = 280.0 * y[5] * y[7];
        f[0] += 0.0007;
        f[5] -= r;
        f[6] += r;
        f[7] -= r;
    }
    fn jacobian(_: f64, y: &[f64], j: &mut [f64]) {
        let (p, q) = (280.0 * y[7], 280.0 * y[5]);
        j[..2].copy_from_slice(&[-1.71, 1.71]);
        j[8..12].copy_from_slice(&[0.43, -8.75, 0.0, 8.32]);
        j[16..20].copy_from_slice(&[8.32, 0.0, -10.03, 1.71]);
        j[26..30].copy_from_slice(&[0.43, -1.12, 0.0, 0.69]);
        j[34..38].copy_from_slice(&[0.035, 0.0, -1.745, 1.71]);
        j[44..48].copy_from_slice(&[0.43, -0.43 - p, p, -p]);
        j[52..56].copy_from_slice(&[0.43, 0.69, -1.81, 1.81]);
        j[61..64].copy_from_slice(&[-q, q, -q]);
    }
    fn product(_: f64, y: &[f64], v: &[f64], out: &mut [f64]) {
        linear_part(v, out);
        let r = 280.0 * (v[5] * y[7] + y[5] * v[7]);
        out[5] -= r;
        out[6] += r;
        out[7] -= r;
    }
}

fn linear_part(y: &[f64], f: &mut [f64]) {
    f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2];
    f[1] = 1.71 * y[0] - 8.75 * y[1];
    f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
    f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
    f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
    f[5] = 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
    f[6] = -1.81 * y[6];
    f[7] = 1.81 * y[6];
}

/// Three volumes and a moving valve, all flows smooth, with a control signal that opens and closes
/// twice a second.
struct Valve;

const SUPPLY: f64 = 7e5;
const AMBIENT: f64 = 1e5;
const CONDUCTANCE: f64 = 3e-8 * 1.185;
const RT: f64 = 84148.7;
const VOLUMES: [f64; 3] = [2e-6, 5e-5, 1e-4];
const AREA: f64 = 5e-5;
const WIDTH: f64 = 2e3;
const MASS: f64 = 0.02;

/// `tanh x` and its derivative.
fn tanh(x: f64) -> (f64, f64) {
    let t = x.tanh();
    (t, 1.0 - t * t)
}

/// Penetration of a stop, and whether there is one.
fn beyond(x: f64) -> (f64, f64) {
    if x > 3e-3 {
        (x - 3e-3, 1.0)
    } else if x < 0.0 {
        (x, 1.0)
    } else {
        (0.0, 0.0)
    }
}

impl Problem<5> for Valve {
    const NAME: &'static str = "valve";
    const START: [f64; 5] = [1e5, 1e5, 1e5, 0.0, 0.0];
    const NOMINALS: [f64; 5] = [1e5, 1e5, 1e5, 1e-3, 0.1];
    fn outputs() -> Vec<f64> {
        (1..=20).map(|k| 0.05 * f64::from(k)).collect()
    }
    fn rhs(t: f64, y: &[f64], f: &mut [f64]) {
        let [p1, p2, p3, x, v] = [y[0], y[1], y[2], y[3], y[4]];
        let u = 0.5 + 0.5 * (40.0 * (12.566370614359172 * t).sin()).tanh();
        let op = 0.5 * (1.0 + ((x - 1e-3) / 2e-4).tanh());
        let filling = u * SUPPLY * ((SUPPLY - p1) / WIDTH / 10.0).tanh();
        let emptying = (1.0 - u) * p1 * ((p1 - AMBIENT) / WIDTH / 10.0).tanh();
        let q1 = CONDUCTANCE * (filling - emptying) * 0.2;
        let q3 = CONDUCTANCE * 0.5 * p2 * ((p2 - p3) / (20.0 * WIDTH)).tanh();
        let q2 = CONDUCTANCE * op * SUPPLY * ((SUPPLY - p2) / (20.0 * WIDTH)).tanh() - q3;
        let leak = CONDUCTANCE * 0.1 * p3 * ((p3 - AMBIENT) / (20.0 * WIDTH)).tanh();
        f[0] = RT / VOLUMES[0] * q1 - p1 * AREA * v / VOLUMES[0] * 0.1;
        f[1] = RT / VOLUMES[1] * q2;
        f[2] = RT / VOLUMES[2] * (q3 - leak);
        f[3] = v;
        let force = AREA * (p1 - AMBIENT) - 3000.0 * x - 2.0 * v;
        f[4] = (force - 4.0 * (v / 1e-3).tanh() - 1e6 * beyond(x).0) / MASS;
    }
    fn jacobian(t: f64, y: &[f64], j: &mut [f64]) {
        let d = ValveSlopes::at(t, y);
        (j[0], j[4]) = (d.p1_p1, AREA / MASS);
        (j[6], j[7]) = (d.p2_p2, d.p3_p2);
        (j[11], j[12]) = (d.p2_p3, d.p3_p3);
        (j[16], j[19]) = (d.p2_x, d.v_x);
        (j[20], j[23], j[24]) = (d.p1_v, 1.0, d.v_v);
    }
    fn product(t: f64, y: &[f64], v: &[f64], out: &mut [f64]) {
        let d = ValveSlopes::at(t, y);
        out[0] = d.p1_p1 * v[0] + d.p1_v * v[4];
        out[1] = d.p2_p2 * v[1] + d.p2_p3 * v[2] + d.p2_x * v[3];
        out[2] = d.p3_p2 * v[1] + d.p3_p3 * v[2];
        out[3] = v[4];
        out[4] = AREA / MASS * v[0] + d.v_x * v[3] + d.v_v * v[4];
    }
}

/// Entries of the Jacobian, by row and column.
struct ValveSlopes {
    p1_p1: f64,
    p1_v: f64,
    p2_p2: f64,
    p2_p3: f64,
    p2_x: f64,
    p3_p2: f64,
    p3_p3: f64,
    v_x: f64,
    v_v: f64,
}

impl ValveSlopes {
    fn at(t: f64, y: &[f64]) -> Self {
        let [p1, p2, p3, x, v] = [y[0], y[1], y[2], y[3], y[4]];
        let u = 0.5 + 0.5 * (40.0 * (12.566370614359172 * t).sin()).tanh();
        let (op, op_slope) = tanh((x - 1e-3) / 2e-4);
        let (narrow, wide) = (WIDTH * 10.0, WIDTH * 20.0);
        let (_, filling) = tanh((SUPPLY - p1) / WIDTH / 10.0);
        let (emptying, emptying_slope) = tanh((p1 - AMBIENT) / WIDTH / 10.0);
        let q1 =
            -u * SUPPLY * filling / narrow - (1.0 - u) * (emptying + p1 * emptying_slope / narrow);
        let (across, across_slope) = tanh((p2 - p3) / wide);
        let q3_p2 = 0.5 * (across + p2 * across_slope / wide);
        let q3_p3 = -0.5 * p2 * across_slope / wide;
        let (inlet, inlet_slope) = tanh((SUPPLY - p2) / wide);
        let q2_p2 = -0.5 * (1.0 + op) * SUPPLY * inlet_slope / wide - q3_p2;
        let q2_x = 0.5 * op_slope / 2e-4 * SUPPLY * inlet;
        let (leak, leak_slope) = tanh((p3 - AMBIENT) / wide);
        let leak = 0.1 * (leak + p3 * leak_slope / wide);
        let (_, friction) = tanh(v / 1e-3);
        let rate = VOLUMES.map(|volume| RT / volume * CONDUCTANCE);
        ValveSlopes {
            p1_p1: rate[0] * 0.2 * q1 - AREA * v / VOLUMES[0] * 0.1,
            p1_v: -p1 * AREA / VOLUMES[0] * 0.1,
            p2_p2: rate[1] * q2_p2,
            p2_p3: -rate[1] * q3_p3,
            p2_x: rate[1] * q2_x,
            p3_p2: rate[2] * q3_p2,
            p3_p3: rate[2] * (q3_p3 - leak),
            v_x: -(3000.0 + 1e6 * beyond(x).1) / MASS,
            v_v: -(2.0 + 4.0 * friction / 1e-3) / MASS,
        }
    }
}

/// A problem as our solvers receive it.
struct Ours<P, const N: usize>(std::marker::PhantomData<P>);

impl<P: Problem<N>, const N: usize> System for Ours<P, N> {
    fn dim(&self) -> usize {
        N
    }
    fn differential(&self) -> &[bool] {
        &[true; N]
    }
    fn rhs(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        P::rhs(t, y, f);
        Ok(())
    }
    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        P::jacobian(t, y, j);
        Ok(())
    }
}

/// The solution at the output times.
type Outputs<const N: usize> = Vec<[f64; N]>;

fn ours<P: Problem<N>, const N: usize>(
    stepper: &mut impl Stepper,
    at: &[f64],
) -> Result<Outputs<N>, String> {
    let mut system = Ours::<P, N>(std::marker::PhantomData);
    let end = at[at.len() - 1];
    let mut rows = Vec::with_capacity(at.len());
    stepper
        .restart(&mut system, 0.0, &P::START, JacobianMemory::Forget)
        .map_err(|e| e.to_string())?;
    for &t in at {
        while stepper.t() < t {
            stepper.step(&mut system, end).map_err(|e| e.to_string())?;
        }
        let mut row = [0.0; N];
        stepper.interpolate(t, &mut row);
        rows.push(row);
    }
    Ok(rows)
}

/// Error and time in microseconds, for each tolerance at which the solver succeeded.
struct Curve {
    name: &'static str,
    points: Vec<(f64, f64)>,
}

impl Curve {
    fn measure<const N: usize>(
        name: &'static str,
        nominals: &[f64; N],
        reference: &[[f64; N]],
        mut run: impl FnMut(f64) -> Result<Outputs<N>, String>,
    ) -> Curve {
        let mut points = Vec::new();
        for rtol in TOLERANCES {
            let error = match run(rtol) {
                Ok(rows) => error(&rows, reference, nominals),
                Err(why) => {
                    println!("  {name:8} rtol {rtol:.0e}  {why}");
                    continue;
                }
            };
            let time = (0..RUNS)
                .map(|_| {
                    let started = Instant::now();
                    let _ = black_box(run(rtol));
                    started.elapsed().as_secs_f64() * 1e6
                })
                .fold(f64::INFINITY, f64::min);
            println!("  {name:8} rtol {rtol:.0e}  error {error:9.2e}  {time:9.1} us");
            points.push((error, time));
        }
        Curve { name, points }
    }

    /// The time at this error, by linear interpolation in log-log coordinates; `None` if the error
    /// is outside the measured range.
    fn time_at(&self, error: f64) -> Option<f64> {
        let mut points: Vec<(f64, f64)> =
            self.points.iter().map(|(e, t)| (-e.ln(), t.ln())).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let x = -error.ln();
        let k = points.iter().take_while(|p| p.0 < x).count().checked_sub(1)?;
        let ((x0, y0), (x1, y1)) = (points[k], *points.get(k + 1)?);
        Some((y0 + (y1 - y0) * (x - x0) / (x1 - x0)).exp())
    }
}

fn error<const N: usize>(rows: &[[f64; N]], reference: &[[f64; N]], nominals: &[f64; N]) -> f64 {
    let mut worst = 0.0_f64;
    for (row, reference) in rows.iter().zip(reference) {
        for ((y, r), nominal) in row.iter().zip(reference).zip(nominals) {
            worst = worst.max((y - r).abs() / (r.abs() + nominal));
        }
    }
    worst
}

fn compare<P: Problem<N>, const N: usize>() {
    println!("{}", P::NAME);
    let at = P::outputs();
    let options = |rtol| Options::with_nominals(rtol, &P::NOMINALS);
    let radau = |rtol| {
        let mut stepper = Radau::new(N, options(rtol)).expect("valid options");
        ours::<P, N>(&mut stepper, &at)
    };
    let reference = radau(REFERENCE).expect("a reference");
    let curves = [
        Curve::measure("radau", &P::NOMINALS, &reference, radau),
        Curve::measure("bdf", &P::NOMINALS, &reference, |rtol| {
            let mut stepper = Bdf::new(N, options(rtol)).expect("valid options");
            ours::<P, N>(&mut stepper, &at)
        }),
        // Like `simulate::method` for a simulation without events.
        Curve::measure("auto", &P::NOMINALS, &reference, |rtol| {
            let choices = Choices {
                explicit: options(0.1 * rtol),
                radau: options(rtol),
                bdf: options(0.01 * rtol),
            };
            let system = Ours::<P, N>(std::marker::PhantomData);
            let mut stepper = Switching::for_system(&system, choices).expect("valid options");
            ours::<P, N>(&mut stepper, &at)
        }),
    ];
    let peer = Curve::measure("diffsol", &P::NOMINALS, &reference, |rtol| peer::<P, N>(rtol, &at));
    for error in ERRORS {
        let Some(theirs) = peer.time_at(error) else {
            println!("  at error {error:.0e}: not reached by diffsol");
            continue;
        };
        let ours: Vec<String> = curves
            .iter()
            .map(|c| match c.time_at(error) {
                Some(time) => format!("{} {:.2}", c.name, time / theirs),
                None => format!("{} -", c.name),
            })
            .collect();
        println!("  at error {error:.0e}: diffsol {theirs:.0} us; {}", ours.join(", "));
    }
}

fn peer<P: Problem<N>, const N: usize>(rtol: f64, at: &[f64]) -> Result<Outputs<N>, String> {
    let mut problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(rtol)
        .atol(P::NOMINALS.map(|nominal| rtol * nominal).to_vec())
        .rhs_implicit(|y, _p, t, f| P::rhs(t, y, f), |y, _p, t, v, out| P::product(t, y, v, out))
        .init(|_p, _t, y| y.copy_from_slice(&P::START), N)
        .build()
        .expect("a problem");
    // By default, diffsol stops after 50 failed iterations per run.
    problem.ode_options.max_nonlinear_solver_failures = 10_000;
    let mut solver = problem.bdf::<NalgebraLU<f64>>().expect("a solver");
    let mut rows = Vec::with_capacity(at.len());
    for &t in at {
        while solver.state().t < t {
            solver.step().map_err(|e| e.to_string())?;
        }
        let y = solver.interpolate(t).expect("a time within the step");
        rows.push(std::array::from_fn(|i| y[i]));
    }
    Ok(rows)
}

fn main() {
    compare::<Robertson, 3>();
    compare::<Hires, 8>();
    compare::<Valve, 5>();
}
