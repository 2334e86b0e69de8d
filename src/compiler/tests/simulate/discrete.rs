//! Events against closed forms.

use super::builder::Builder;
use crate::ir::dae::{Sample, Trigger};
use crate::ir::expr::{Binary, Type};

/// A ball dropped from 1 m that keeps 0.7 of its speed.
fn ball() -> Builder {
    let mut b = Builder::new();
    let (_, h, dh) = b.state("h", 1.0);
    let (v_id, v, dv) = b.state("v", 0.0);
    b.assign(dh, v);
    let g = b.real(-9.81);
    b.assign(dv, g);
    let zero = b.real(0.0);
    let below = b.relation(h, Binary::Less, zero, Trigger::State);
    let hit = b.edge("$hit", below);
    let e = b.real(-0.7);
    let value = b.g().mul(e, v);
    b.reinit(hit, v_id, value);
    b
}

#[test]
fn the_ball_bounces_at_the_closed_form_times() {
    let run = ball().run(2.0, 1e-8).unwrap();
    let mut at = (2.0f64 / 9.81).sqrt();
    let mut speed = 9.81 * at;
    let hits: Vec<f64> = run
        .trajectory
        .events
        .iter()
        .filter(|e| e.what == "h < 0.0 became true")
        .map(|e| e.time)
        .collect();
    assert_eq!(run.trajectory.events[0].place, "model.mo:1:1");
    let mut count = 0;
    while at < 2.0 {
        assert!((hits[count] - at).abs() < 1e-9, "{count}: {} {at}", hits[count]);
        count += 1;
        speed *= 0.7;
        at += 2.0 * speed / 9.81;
    }
    assert_eq!(hits.len(), count);
    // Two rows at the first hit: the limits of the speed.
    let first = run.trajectory.time.iter().position(|t| *t == hits[0]).unwrap();
    let v = run.trajectory.values("v").unwrap();
    assert_eq!(run.trajectory.time[first + 1], hits[0]);
    assert!((v[first + 1] + 0.7 * v[first]).abs() < 1e-15);
}

/// The bounces pile up at `t1 (1 + e) / (1 - e)`, where `t1` is the time of the first.
#[test]
fn the_run_stops_where_the_bounces_pile_up() {
    let failure = ball().run(3.0, 1e-8).unwrap_err();
    let end = (2.0f64 / 9.81).sqrt() * 1.7 / 0.3;
    assert!((failure.time - end).abs() < 1e-6, "{} {end}", failure.time);
    assert!(failure.diagnostic.message.contains("`h < 0.0` switches without end"));
}

#[test]
fn time_events_are_exact_and_strict_comparisons_switch_too() {
    for op in [Binary::Greater, Binary::GreaterEqual] {
        let mut b = Builder::new();
        let (_, _, dx) = b.state("x", 0.0);
        let (_, at) = b.parameter("at", 0.3);
        let time = b.g().time();
        let late = b.relation(time, op, at, Trigger::Time { instant: at });
        let (one, zero) = (b.real(1.0), b.real(0.0));
        let slope = b.g().if_then_else(late, one, zero);
        b.assign(dx, slope);
        let run = b.run(1.0, 1e-6).unwrap();
        assert_eq!(run.trajectory.events.len(), 1);
        assert_eq!(run.trajectory.events[0].time, 0.3);
        let x = run.trajectory.values("x").unwrap();
        assert!((x.last().unwrap() - 0.7).abs() < 1e-14);
        // Before the event the state rests to the bit.
        let before = run.trajectory.time.iter().zip(x).filter(|(t, _)| **t <= 0.3);
        assert!(before.into_iter().all(|(_, x)| *x == 0.0));
        assert_eq!(run.statistics.time_events, 1);
    }
}

#[test]
fn a_clock_counts_its_ticks() {
    let mut b = Builder::new();
    let (flag, tick) = b.discrete("$sample", Type::Boolean, 0.0);
    let (n, _) = b.discrete("n", Type::Integer, 0.0);
    let before = b.g().pre(n, Type::Integer);
    let one = b.g().integer(1);
    let next = b.g().add(before, one);
    let edge = b.edge("$tick", tick);
    let value = b.g().if_then_else(edge, next, before);
    b.at_events(n, value);
    let (start, interval) = (b.real(0.0), b.real(0.1));
    b.blocks.dae.samples.push(Sample { start, interval, flag });
    let run = b.run(1.0, 1e-6).unwrap();
    let n = run.trajectory.values("n").unwrap();
    assert_eq!(n[0], 1.0);
    assert_eq!(*n.last().unwrap(), 11.0);
    assert_eq!(run.statistics.time_events, 10);
}

/// `when x > 0.5 then` chain: one event sets `a`, which sets `b` in the next iteration.
#[test]
fn event_iteration_reaches_the_fixed_point() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 0.0);
    let one = b.real(1.0);
    b.assign(dx, one);
    let half = b.real(0.5);
    let passed = b.relation(x, Binary::Greater, half, Trigger::State);
    let (a, _) = b.discrete("a", Type::Boolean, 0.0);
    b.at_events(a, passed);
    let (c, _) = b.discrete("b", Type::Boolean, 0.0);
    let pre = b.g().pre(a, Type::Boolean);
    b.at_events(c, pre);
    let run = b.run(1.0, 1e-6).unwrap();
    assert_eq!(run.statistics.state_events, 1);
    let at = run.trajectory.events[0].time;
    assert!((at - 0.5).abs() < 1e-12);
    let row = run.trajectory.time.iter().rposition(|t| *t == at).unwrap();
    for name in ["a", "b"] {
        let values = run.trajectory.values(name).unwrap();
        assert_eq!((values[row - 1], values[row]), (0.0, 1.0), "{name}");
    }
}

/// Without states: a relation of time alone is still found.
#[test]
fn events_without_states() {
    let mut b = Builder::new();
    let (y, y_read) = b.algebraic("y");
    let time = b.g().time();
    let sine = b.g().unary(crate::ir::expr::Unary::Sin, time);
    b.assign(y, sine);
    let zero = b.real(0.0);
    let positive = b.relation(y_read, Binary::GreaterEqual, zero, Trigger::State);
    let (c, _) = b.discrete("c", Type::Boolean, 0.0);
    b.at_events(c, positive);
    let run = b.run(10.0, 1e-6).unwrap();
    let times: Vec<f64> = run.trajectory.events.iter().map(|e| e.time).collect();
    assert_eq!(times.len(), 3, "{times:?}");
    for (k, t) in times.iter().enumerate() {
        assert!((t - (k + 1) as f64 * std::f64::consts::PI).abs() < 1e-12);
    }
}
