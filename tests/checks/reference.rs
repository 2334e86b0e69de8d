//! Both valves against trajectories of an independent fixed-step simulation, and what physics asks of them.

use mocc::ir::trajectory::Trajectory;

use super::door::{Case, Reading, text_of};

/// Allowed difference of the stroke, m.
const STROKE: f64 = 1e-6;
/// Allowed difference of a pressure, Pa.
const PRESSURE: f64 = 200.0;
/// Allowed difference of first motion and arrival, s.
const MOTION: f64 = 1e-4;
/// Samples this close to an event of the reference are not compared, s.
const NEAR_EVENT: f64 = 2e-4;
/// Values of `Translational.Motion` in a trajectory.
const FORWARD: f64 = 4.0;
const BACKWARD: f64 = 2.0;
/// Stroke of both valves, m.
const S_MAX: f64 = 3.5e-3;

/// A valve, its settings and the file they are compared with.
struct Reference {
    model: &'static str,
    file: &'static str,
    p_supply: f64,
    t_dwell: f64,
    /// Strokes of the control edges, m.
    edges: &'static [f64],
    pressures: &'static [&'static str],
}

const VT52_EDGES: &[f64] = &[1.20e-3, 1.95e-3, 1.35e-3, 2.15e-3];
const VT52_PRESSURES: &[&str] = &["p14", "p12", "p2", "p4"];

const VT52_6BAR: Reference = Reference {
    model: "examples/valve52.mol",
    file: "vt52_6bar_1s.csv",
    p_supply: 6e5,
    t_dwell: 1.0,
    edges: VT52_EDGES,
    pressures: VT52_PRESSURES,
};
const VT52_3BAR: Reference =
    Reference { file: "vt52_3bar_1h.csv", p_supply: 3e5, t_dwell: 3600.0, ..VT52_6BAR };
const VT52_9BAR: Reference =
    Reference { file: "vt52_9bar_48h.csv", p_supply: 9e5, t_dwell: 172_800.0, ..VT52_6BAR };
const VT32_6BAR: Reference = Reference {
    model: "examples/valve32.mol",
    file: "vt32_6bar_30s.csv",
    p_supply: 6e5,
    t_dwell: 30.0,
    edges: &[1.10e-3, 1.80e-3],
    pressures: &["p14", "p2"],
};

#[test]
fn valve_52_at_6_bar_after_a_second() {
    agrees(&VT52_6BAR);
}

#[test]
fn valve_52_at_3_bar_after_an_hour() {
    agrees(&VT52_3BAR);
}

#[test]
fn valve_52_at_9_bar_after_two_days() {
    agrees(&VT52_9BAR);
}

#[test]
fn valve_32_at_6_bar_after_half_a_minute() {
    agrees(&VT32_6BAR);
}

fn agrees(case: &Reference) {
    let found = Case::file(case.model)
        .set(format!("p_supply={}", case.p_supply))
        .set(format!("t_dwell={}", case.t_dwell))
        .run();
    let reference = Samples::read(case.file);
    let events = reference.events(case.edges);
    let mut compared = 0;
    for (k, &t) in reference.time.iter().enumerate() {
        if events.iter().any(|e| (e - t).abs() <= NEAR_EVENT) {
            continue;
        }
        let difference = (found.at("s", t) - reference.of("s_m")[k]).abs();
        assert!(difference <= STROKE, "{}: stroke off by {difference} m at {t} s", case.file);
        for p in case.pressures {
            let difference = (found.at(p, t) - reference.of(&format!("{p}_Pa"))[k]).abs();
            assert!(difference <= PRESSURE, "{}: {p} off by {difference} Pa at {t} s", case.file);
        }
        compared += 1;
    }
    assert!(compared > 1100, "only {compared} samples compared");

    let departures = found.times_of("> spool.f_static became true");
    let mut arrivals = found.times_of("spool.s_left <= 0.0 became true");
    arrivals.extend(found.times_of("spool.v_along < 0.0 became true"));
    arrivals.sort_by(f64::total_cmp);
    for (name, found, expected) in [
        ("departure", &departures, reference.departures()),
        ("arrival", &arrivals, reference.arrivals()),
    ] {
        assert_eq!(found.len(), expected.len(), "{}: {name}s at {found:?}", case.file);
        assert!(!found.is_empty());
        for (found, expected) in found.iter().zip(expected) {
            let difference = (found - expected).abs();
            assert!(difference <= MOTION, "{}: {name} at {found} s, not {expected} s", case.file);
        }
    }
}

/// Times, s, and names of what happens in the VT-52 at 6 bar after a rest of 1 s: nothing more, nothing less.
const EVENTS_AT_6_BAR: [(f64, &str); 15] = [
    (5.000e-3, "time >= pilot.t_open became true"),
    (17.294e-3, "spool.f_ahead > spool.f_static became true"),
    (21.771e-3, "spool.s > seal_45.s_ce became true"),
    (22.275e-3, "spool.s > seal_12.s_ce became true"),
    (26.089e-3, "spool.s < seal_14.s_ce became false"),
    (26.644e-3, "spool.s < seal_23.s_ce became false"),
    (29.542e-3, "spool.s_left <= 0.0 became true"),
    (50.000e-3, "time < switch.t_off became false"),
    (55.000e-3, "time >= pilot.t_close became true"),
    (75.777e-3, "spool.f_behind > spool.f_static became true"),
    (82.260e-3, "spool.s < seal_23.s_ce became true"),
    (83.142e-3, "spool.s < seal_14.s_ce became true"),
    (87.002e-3, "spool.s > seal_12.s_ce became false"),
    (87.467e-3, "spool.s > seal_45.s_ce became false"),
    (90.437e-3, "spool.s_left <= 0.0 became true"),
];

#[test]
fn the_events_are_those_of_the_physics() {
    let run = Case::file("examples/valve52.mol").run();
    let found: Vec<&str> = run.events.iter().map(|e| e.what.as_str()).collect();
    assert_eq!(found, EVENTS_AT_6_BAR.map(|(_, what)| what));
    for (event, (time, what)) in run.events.iter().zip(EVENTS_AT_6_BAR) {
        // The table is rounded to 1 us.
        assert!((event.time - time).abs() < 1.5e-6, "{what} at {} s", event.time);
    }
}

#[test]
fn a_locked_spool_rests_to_the_bit() {
    for (file, t_dwell) in [("examples/valve52.mol", 1), ("examples/valve32.mol", 3600)] {
        let run = Case::file(file).set(format!("t_dwell={t_dwell}")).run();
        rests_to_the_bit(&run);
        let rested = run.of("spool.locked").iter().filter(|l| **l == 1.0).count();
        assert!(rested > 500, "{file}: locked in {rested} rows only");
    }
}

/// Locked rows have no speed, and those in a row have one and the same stroke.
fn rests_to_the_bit(run: &Trajectory) {
    let (locked, s, v) = (run.of("spool.locked"), run.of("spool.s"), run.of("spool.v"));
    for k in 0..run.rows() {
        if locked[k] == 1.0 {
            assert_eq!(v[k], 0.0, "speed at {} s", run.time[k]);
            if k > 0 && locked[k - 1] == 1.0 {
                assert_eq!(s[k].to_bits(), s[k - 1].to_bits(), "stroke at {} s", run.time[k]);
            }
        }
    }
}

/// Adds what passes the borders of the valve: the flow into each part that holds its pressure.
const BALANCE_52: &str = "
model Balance
  extends Valve52;
  Units.Mass m_in(start = 0, fixed = true, nominal = 1e-5);
  Units.Mass m_total = chamber_14.m + chamber_12.m + chamber_1.m + chamber_2.m + chamber_3.m + chamber_4.m
    + chamber_5.m + work_2.m + work_4.m;
equation
  der(m_in) = -supply.port.m_flow - ambient.port.m_flow;
end Balance;";
const BALANCE_32: &str = "
model Balance
  extends Valve32;
  Units.Mass m_in(start = 0, fixed = true, nominal = 1e-5);
  Units.Mass m_total = chamber_14.m + chamber_1.m + chamber_2.m + chamber_3.m + work_2.m;
equation
  der(m_in) = -supply.port.m_flow - ambient.port.m_flow;
end Balance;";

#[test]
fn the_mass_of_air_balances() {
    for (file, balance) in
        [("examples/valve52.mol", BALANCE_52), ("examples/valve32.mol", BALANCE_32)]
    {
        let run = Case::text(&(text_of(file) + balance)).stop(0.12).interval(1e-4).run();
        let (total, added) = (run.of("m_total"), run.of("m_in"));
        let passed = added.iter().fold(0.0, |a: f64, m| a.max(m.abs()));
        assert!(passed > 0.1 * total[0], "{file}: nothing happened");
        for k in 0..run.rows() {
            let error = (total[k] - total[0] - added[k]).abs() / total[0];
            assert!(error < 1e-6, "{file}: {error} of the mass is lost at {} s", run.time[k]);
        }
    }
}

#[test]
fn no_setting_makes_the_valve_chatter() {
    let mut valve = Case::file("examples/valve52.mol").stop(0.2).interval(1e-3).compile();
    let mut turned_back = 0;
    for bar in 2..=9 {
        for t_dwell in [1.0, 60.0, 3600.0, 172_800.0] {
            for t_off in [3e-3, 5.5e-3, 9e-3, 12e-3, 15e-3, 17e-3, 18.5e-3, 19.5e-3, 50e-3] {
                valve.set("p_supply", f64::from(bar) * 1e5);
                valve.set("t_dwell", t_dwell);
                valve.set("t_off", t_off);
                let run = valve.run();
                let context = format!("{bar} bar, {t_dwell} s, {t_off} s: {:#?}", run.events);
                turned_back += usize::from(sane(&run, &context));
                rests_to_the_bit(&run);
            }
        }
    }
    assert!(turned_back > 5, "only {turned_back} strokes were broken off");
}

/// Checks that each motion leads somewhere and that the events are accounted for; whether the spool turned back
/// between the stops.
fn sane(run: &Trajectory, context: &str) -> bool {
    let (mode, s, v) = (run.of("spool.mode"), run.of("spool.s"), run.of("spool.v"));
    let time = &run.time;
    let sliding = |k: usize| mode[k] == FORWARD || mode[k] == BACKWARD;
    // First and last row of each motion; it begins in the second row of an event, with speed 0. A spool that locks
    // loses what friction it had gathered by resting: it may slide on at once, either way.
    let mut motions: Vec<(usize, usize)> = Vec::new();
    for k in 1..run.rows() {
        if sliding(k) && v[k] == 0.0 && time[k] == time[k - 1] {
            motions.push((k, k));
        } else if let Some((_, end)) = motions.last_mut().filter(|_| sliding(k)) {
            *end = k;
        }
    }
    assert!(motions.len() <= 4, "{context}");
    // The switch goes off, and both of its edges take effect later.
    let mut expected = 3;
    for (n, &(begin, end)) in motions.iter().enumerate() {
        assert!((s[end] - s[begin]).abs() > 1e-8, "{context}");
        assert!(time[end] - time[begin] > 1e-4, "{context}");
        expected += VT52_EDGES.iter().filter(|e| (s[begin] < **e) != (s[end] < **e)).count();
        // A spool that slides on at once ends one motion and begins the next in one event.
        let at_once = n > 0 && time[motions[n - 1].1] == time[begin];
        expected += usize::from(!at_once) + usize::from(end + 1 < run.rows());
    }
    assert_eq!(run.events.len(), expected, "{context}");
    !run.times_of("spool.v_along < 0.0").is_empty()
}

/// A table of the reference.
struct Samples {
    time: Vec<f64>,
    columns: Vec<(String, Vec<f64>)>,
}

impl Samples {
    fn read(file: &str) -> Samples {
        let text = text_of(&format!("tests/data/reference/{file}"));
        let mut lines = text.lines();
        let names = lines.next().expect("a header").split(',').skip(1);
        let mut columns: Vec<(String, Vec<f64>)> =
            names.map(|n| (n.to_string(), Vec::new())).collect();
        let mut time = Vec::new();
        for line in lines {
            let mut numbers = line.split(',').map(|n| n.parse::<f64>().expect("a number"));
            time.push(numbers.next().expect("a time"));
            columns.iter_mut().zip(numbers).for_each(|((_, values), n)| values.push(n));
        }
        Samples { time, columns }
    }

    fn of(&self, name: &str) -> &[f64] {
        let found = self.columns.iter().find(|(n, _)| n == name);
        found.unwrap_or_else(|| panic!("no column `{name}`")).1.as_slice()
    }

    /// When the spool starts to move: its speed, extrapolated back from the first two samples in motion, is zero.
    fn departures(&self) -> Vec<f64> {
        let v = self.of("v_m_per_s");
        let first = |k: &usize| v[k - 1] == 0.0 && v[*k] != 0.0;
        let back = |k: usize| self.standstill(k, k + 1).max(self.time[k - 1]);
        (1..v.len()).filter(first).map(back).collect()
    }

    /// When the spool comes to rest: it reaches the stop with the speed of the last sample in motion, or its speed
    /// fades away between the stops.
    fn arrivals(&self) -> Vec<f64> {
        let (s, v) = (self.of("s_m"), self.of("v_m_per_s"));
        let last = |k: &usize| v[k - 1] != 0.0 && v[*k] == 0.0;
        let on = |k: usize| {
            if s[k] == 0.0 || s[k] == S_MAX {
                self.time[k - 1] + (s[k] - s[k - 1]) / v[k - 1]
            } else {
                self.standstill(k - 2, k - 1).min(self.time[k])
            }
        };
        (1..v.len()).filter(last).map(on).collect()
    }

    /// Where a straight line through the speeds of two samples is zero, s.
    fn standstill(&self, a: usize, b: usize) -> f64 {
        let v = self.of("v_m_per_s");
        let slope = (v[b] - v[a]) / (self.time[b] - self.time[a]);
        self.time[a] - v[a] / slope
    }

    /// Departures, arrivals, edges passed, and the times at which the pilot is commanded to act and acts.
    fn events(&self, edges: &[f64]) -> Vec<f64> {
        let s = self.of("s_m");
        let mut events = vec![0.005, 0.050, 0.055];
        for k in 1..s.len() {
            for edge in edges {
                if (s[k - 1] < *edge) != (s[k] < *edge) {
                    let part = (edge - s[k - 1]) / (s[k] - s[k - 1]);
                    events.push(self.time[k - 1] + part * (self.time[k] - self.time[k - 1]));
                }
            }
        }
        events.extend(self.departures());
        events.extend(self.arrivals());
        events
    }
}
