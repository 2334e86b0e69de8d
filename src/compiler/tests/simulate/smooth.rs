//! Systems without events, against closed forms, and the exact Jacobian.

use super::builder::Builder;
use crate::codegen::recording::only;
use crate::ir::expr::{Binary, Unary};
use mocc_engine::integrate::system::System;
use mocc_engine::simulate::run::simulate;
use mocc_engine::simulate::settings::Settings;
use mocc_engine::simulate::system::HybridSystem;

#[test]
fn decay_follows_the_exponential_and_parameters_are_inputs() {
    let mut b = Builder::new();
    let (rate, k) = b.parameter("k", 2.0);
    let (x, x_read, dx) = b.state("x", 3.0);
    let product = b.g().mul(k, x_read);
    let minus = b.g().neg(product);
    b.assign(dx, minus);
    let run = b.run(1.0, 1e-9).unwrap();
    let last = *run.trajectory.values("x").unwrap().last().unwrap();
    assert!((last - 3.0 * (-2.0f64).exp()).abs() < 1e-8, "{last}");
    assert_eq!(run.trajectory.rows(), 101);

    let program = b.program();
    let mut settings = Settings::of(&Default::default());
    settings.parameters = vec![(rate, 0.5)];
    settings.starts = vec![(x, 1.0)];
    settings.tolerance = 1e-9;
    let run = simulate(&program, &settings, &b.sources).unwrap();
    let last = *run.trajectory.values("x").unwrap().last().unwrap();
    assert!((last - (-0.5f64).exp()).abs() < 1e-8, "{last}");
}

#[test]
fn the_oscillator_keeps_its_phase() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 1.0);
    let (_, v, dv) = b.state("v", 0.0);
    b.assign(dx, v);
    let minus = b.g().neg(x);
    b.assign(dv, minus);
    let run = b.run(10.0, 1e-9).unwrap();
    let times = run.trajectory.time.iter();
    for (t, x) in times.zip(run.trajectory.values("x").unwrap()) {
        assert!((x - t.cos()).abs() < 1e-6, "{t} {x}");
    }
}

/// `a + b = x, a - b = y` torn at `b`: `a = x - b` explicit, `a - b - y = 0`.
#[test]
fn a_linear_block_is_solved_between_events() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 1.0);
    let (a, a_read) = b.algebraic("a");
    let (c, c_read) = b.algebraic("b");
    let rest = b.g().sub(x, c_read);
    let explicit = b.assignment(a, rest);
    let difference = b.g().sub(a_read, c_read);
    let time = b.g().time();
    b.torn(&[c], vec![explicit], &[(difference, time)], true);
    let minus = b.g().neg(a_read);
    b.assign(dx, minus);
    // a = (x + t) / 2, der(x) = -(x + t) / 2: x = 2 - t - exp(-t / 2) from x(0) = 1.
    let run = b.run(2.0, 1e-9).unwrap();
    let t = 2.0f64;
    let last = |n: &str| *run.trajectory.values(n).unwrap().last().unwrap();
    let exact = 2.0 - t - (-t / 2.0).exp();
    assert!((last("x") - exact).abs() < 1e-8, "{}", last("x"));
    assert!((last("a") + last("b") - last("x")).abs() < 1e-15);
    assert!((last("a") - last("b") - t).abs() < 1e-15);
}

/// Two simultaneous linear equations, solved by decomposition.
#[test]
fn a_linear_block_of_two_unknowns() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 1.0);
    let (u, u_read) = b.algebraic("u");
    let (w, w_read) = b.algebraic("w");
    let two = b.real(2.0);
    let three = b.real(3.0);
    let twice = b.g().mul(two, u_read);
    let first = b.g().add(twice, w_read);
    let thrice = b.g().mul(three, w_read);
    let second = b.g().add(u_read, thrice);
    let zero = b.real(0.0);
    b.torn(&[u, w], vec![], &[(first, x), (second, zero)], true);
    // 2 u + w = x, u + 3 w = 0: u = 3 x / 5, w = -x / 5.
    let minus = b.g().neg(u_read);
    b.assign(dx, minus);
    let run = b.run(1.0, 1e-9).unwrap();
    let last = |n: &str| *run.trajectory.values(n).unwrap().last().unwrap();
    assert!((last("x") - (-0.6f64).exp()).abs() < 1e-8);
    assert!((last("w") + last("x") / 5.0).abs() < 1e-15);
}

/// `y^3 + y = x` with `der(x) = -y`: by `x = y^3 + y`, `t = 3 (y0^2 - y^2) / 2 + ln(y0 / y)`.
fn cubic() -> Builder {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 10.0);
    let (y, y_read) = b.algebraic("y");
    let three = b.real(3.0);
    let cube = b.g().pow(y_read, three);
    let sum = b.g().add(cube, y_read);
    b.torn(&[y], vec![], &[(sum, x)], false);
    let minus = b.g().neg(y_read);
    b.assign(dx, minus);
    b
}

#[test]
fn a_nonlinear_block_is_solved_to_rounding() {
    let run = cubic().run(2.0, 1e-9).unwrap();
    let y = run.trajectory.values("y").unwrap();
    let x = run.trajectory.values("x").unwrap();
    assert_eq!(y[0], 2.0);
    for ((t, x), y) in run.trajectory.time.iter().zip(x).zip(y) {
        assert!((y * y * y + y - x).abs() < 1e-14 * x.abs().max(1.0));
        let exact = 1.5 * (4.0 - y * y) + (2.0 / y).ln();
        assert!((exact - t).abs() < 1e-7, "{t} {exact}");
    }
}

/// A nonlinear system with a torn block of two unknowns, selections and a maximum.
#[test]
fn the_jacobian_agrees_with_central_differences() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 0.7);
    let (_, y, dy) = b.state("y", 1.3);
    let (_, z, dz) = b.state("z", -0.4);
    let (p, p_read) = b.algebraic("p");
    let (q, q_read) = b.algebraic("q");
    let (r, r_read) = b.algebraic("r");
    // r := p x; 2 p + sin(q) = x y + r / 10; exp(p / 5) + 3 q = z.
    let product = b.g().mul(p_read, x);
    let explicit = b.assignment(r, product);
    let two = b.real(2.0);
    let twice = b.g().mul(two, p_read);
    let sine = b.g().unary(Unary::Sin, q_read);
    let left = b.g().add(twice, sine);
    let ten = b.real(10.0);
    let tenth = b.g().div(r_read, ten);
    let xy = b.g().mul(x, y);
    let right = b.g().add(xy, tenth);
    let five = b.real(5.0);
    let fifth = b.g().div(p_read, five);
    let exp = b.g().unary(Unary::Exp, fifth);
    let three = b.real(3.0);
    let thrice = b.g().mul(three, q_read);
    let second = b.g().add(exp, thrice);
    b.torn(&[p, q], vec![explicit], &[(left, right), (second, z)], false);
    // A root that must not be differentiated where it is not taken.
    let zero = b.real(0.0);
    let negative = b.g().binary(Binary::Less, z, zero);
    let negative = b.g().no_event(negative);
    let root = b.g().unary(Unary::Sqrt, z);
    let square = b.g().mul(r_read, q_read);
    let law = b.g().if_then_else(negative, square, root);
    b.assign(dx, law);
    let most = b.g().binary(Binary::Max, p_read, z);
    let value = b.g().mul(most, y);
    b.assign(dy, value);
    let sum = b.g().add(q_read, x);
    let tanh = b.g().unary(Unary::Tanh, sum);
    b.assign(dz, tanh);

    let program = b.program();
    let mut model = HybridSystem::new(&program);
    let settings = Settings::of(&Default::default());
    mocc_engine::simulate::initialization::initialise(&mut model.machine, &settings).unwrap();
    let at = [0.7, 1.3, -0.4];
    let mut exact = [0.0; 9];
    model.jacobian(0.0, &at, &mut exact).unwrap();
    for column in 0..3 {
        let h = 1e-5;
        let mut slopes = [[0.0; 3]; 2];
        for (slope, step) in slopes.iter_mut().zip([h, -h]) {
            let mut moved = at;
            moved[column] += step;
            model.rhs(0.0, &moved, slope).unwrap();
        }
        for row in 0..3 {
            let difference = (slopes[0][row] - slopes[1][row]) / (2.0 * h);
            let value = exact[row + 3 * column];
            assert!((value - difference).abs() < 1e-8, "({row},{column}) {value} {difference}");
        }
    }
}

#[test]
fn runs_agree_to_the_bit() {
    let b = cubic();
    let (first, second) = (b.run(2.0, 1e-6).unwrap(), b.run(2.0, 1e-6).unwrap());
    assert_eq!(first.trajectory, second.trajectory);
}

/// `f(x) = x + x + x`, by a loop that is counted at run time: `der(x) = -f(x)`.
#[test]
fn functions_run_and_are_differentiated() {
    use crate::base::index::IndexVec;
    use crate::base::source::Span;
    use crate::ir::expr::{FunctionId, Node, Type, VarId};
    use crate::ir::flat::{Function, LocalId, Statement};
    let mut b = Builder::new();
    let [x, y, i] = [0, 1, 2].map(|k| b.g().var(VarId(k), Type::Real));
    let (zero, one, three) = (b.real(0.0), b.real(1.0), b.real(3.0));
    let sum = b.g().add(y, x);
    let next = b.g().add(i, one);
    let more = b.g().binary(Binary::Less, i, three);
    let body = vec![
        Statement::Assign(LocalId(1), zero),
        Statement::Assign(LocalId(2), zero),
        Statement::While(
            more,
            vec![Statement::Assign(LocalId(1), sum), Statement::Assign(LocalId(2), next)],
        ),
    ];
    let locals: IndexVec<LocalId, String> =
        ["x", "y", "i"].into_iter().map(str::to_owned).collect();
    b.blocks.dae.functions.push(Function {
        name: "triple".into(),
        span: Span::NONE,
        inputs: vec![LocalId(0)],
        outputs: vec![LocalId(1)],
        locals,
        body,
    });
    let (_, state, derivative) = b.state("x", 1.0);
    let args = b.g().intern_list(&[state]);
    let call = Node::Call { function: FunctionId(0), output: 0, args };
    let call = b.g().intern(call, Type::Real);
    let minus = b.g().neg(call);
    b.assign(derivative, minus);
    let run = b.run(1.0, 1e-9).unwrap();
    let last = *run.trajectory.values("x").unwrap().last().unwrap();
    assert!((last - (-3.0f64).exp()).abs() < 1e-9);

    let program = b.program();
    let mut model = HybridSystem::new(&program);
    let settings = Settings::of(&Default::default());
    mocc_engine::simulate::initialization::initialise(&mut model.machine, &settings).unwrap();
    let mut slope = [0.0];
    model.jacobian(0.0, &[0.7], &mut slope).unwrap();
    assert!((slope[0] + 3.0).abs() < 1e-9, "{}", slope[0]);
}

#[test]
fn one_program_serves_many_threads() {
    let program = cubic().program();
    let settings = Settings::of(&Default::default());
    let sources = crate::base::source::SourceMap::default();
    let alone = simulate(&program, &settings, &sources).unwrap().trajectory;
    std::thread::scope(|scope| {
        let run = || simulate(&program, &settings, &sources).map(|r| r.trajectory);
        for other in [scope.spawn(run), scope.spawn(run)] {
            assert_eq!(other.join().unwrap().unwrap(), alone);
        }
    });
}

/// A ring of 80 masses, each coupled to its neighbours.
fn ring() -> Builder {
    let n = 80;
    let mut b = Builder::new();
    let states: Vec<_> =
        (0..n).map(|k| b.state(&format!("x[{}]", k + 1), (k % 7) as f64)).collect();
    for k in 0..n {
        let (before, own, after) = (states[(k + n - 1) % n].1, states[k].1, states[(k + 1) % n].1);
        let both = b.g().add(before, after);
        let square = b.g().mul(own, own);
        let change = b.g().sub(both, square);
        b.assign(states[k].2, change);
        let (double, _) = b.algebraic(&format!("double[{}]", k + 1));
        let sum = b.g().add(own, own);
        b.assign(double, sum);
    }
    b
}

#[test]
fn entries_by_pattern_are_those_of_the_dense_jacobian() {
    let program = ring().program();
    let mut model = HybridSystem::new(&program);
    let n = model.dim();
    let y: Vec<f64> = (0..n).map(|k| 0.1 + k as f64).collect();
    let mut dense = vec![0.0; n * n];
    model.jacobian(0.0, &y, &mut dense).unwrap();
    let pattern = model.pattern().unwrap().clone();
    assert_eq!(pattern.entries(), 3 * n);
    let mut entries = vec![0.0; pattern.entries()];
    model.jacobian_entries(0.0, &y, &mut entries).unwrap();
    for j in 0..n {
        assert_eq!(dense[j + n * j], -2.0 * y[j]);
        for i in 0..n {
            let sparse = pattern.position(i, j).map_or(0.0, |k| entries[k]);
            assert_eq!(dense[i + n * j], sparse, "({i}, {j})");
        }
    }
}

#[test]
fn recording_less_changes_nothing_but_the_work() {
    let b = ring();
    let settings = Settings { tolerance: 1e-8, ..Settings::of(&Default::default()) };
    let whole = b.program();
    let all = simulate(&whole, &settings, &b.sources).unwrap().trajectory;
    let mut part = b.program();
    only(&mut part, |name| name == "x[3]" || name == "double[7]");
    assert!(
        whole.tapes.outputs.len() >= 80 && part.tapes.outputs.len() <= 2,
        "{}",
        part.tapes.outputs.len()
    );
    let some = simulate(&part, &settings, &b.sources).unwrap().trajectory;
    let names: Vec<&str> = some.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["x[3]", "double[7]"]);
    for name in names {
        assert_eq!(some.values(name), all.values(name));
    }
}
