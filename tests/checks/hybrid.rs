//! Systems with events whose times and results are known.

use super::door::{Case, Reading, assert_close};

#[test]
fn bouncing_ball() {
    let run = Case::file("examples/bouncing_ball.mol").run();
    let (g, h_0, e) = (9.81, 1.0, 0.8_f64);
    let t_1 = f64::sqrt(2.0 * h_0 / g);
    let impacts = run.times_of("h <= 0.0 became true");
    assert_eq!(impacts.len(), 6);
    let mut exact = t_1;
    for (k, t) in impacts.iter().enumerate() {
        assert_close(*t, exact, 1e-9);
        assert_eq!(run.at("impacts", *t), (k + 1) as f64);
        exact += 2.0 * t_1 * e.powi(k as i32 + 1);
    }
}

#[test]
fn stick_slip() {
    let run = Case::file("examples/stick_slip.mol").run();
    let leaves = run.times_of("> slider.f_static became true");
    let rests = run.times_of("slider.v_along < 0.0 became true");
    assert_close(leaves[0], 10.0 / (500.0 * 0.1), 1e-9);
    assert_eq!((leaves.len(), rests.len()), (5, 5));
    for k in 1..leaves.len() {
        assert!(leaves[k - 1] < rests[k - 1] && rests[k - 1] < leaves[k]);
        assert_close(leaves[k] - leaves[k - 1], leaves[1] - leaves[0], 1e-6);
    }
    let (locked, v) = (run.of("slider.locked"), run.of("slider.v"));
    assert!(locked.iter().zip(v).all(|(locked, v)| *locked == 0.0 || *v == 0.0));
}
