//! Every example compiles, runs to its end, says nothing it should not, and agrees with what its comment claims.

use std::path::{Path, PathBuf};

use super::door::{Case, Reading, assert_close, text_of};

/// Specific gas constant times temperature, J/kg, and density at the reference state, kg/m3, of the library's air.
const RT: f64 = 287.1 * 293.15;
const RHO_0: f64 = 1.185;
/// Areas of the pistons 14 and 12, m2.
const A_14: f64 = 2.01e-4;
const A_12: f64 = 1.13e-4;

/// All models below a folder.
fn models(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("examples").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(models(&path));
        } else if path.extension().is_some_and(|e| e == "mol") {
            found.push(path);
        }
    }
    found
}

#[test]
fn every_example_runs_to_its_end() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let list = text_of("examples/README.md");
    let mut count = 0;
    for path in models(&folder) {
        let compiled = Case::file(&path).compile();
        let stop = compiled.program.blocks.dae.experiment.stop.expect("an experiment annotation");
        let trajectory = compiled.run();
        assert_eq!(trajectory.time.last(), Some(&stop), "{}", path.display());
        let name = path.file_name().expect("a name").display().to_string();
        assert!(list.contains(&name), "examples/README.md does not mention {name}");
        count += 1;
    }
    assert_eq!(count, 28, "an example was added or removed: change this number");
}

/// When a rigid chamber of 0.9 cm3, filled from 1 bar by 7 bar through C = 5e-10 and b = 0.3, has reached a pressure: on a
/// straight line while the flow is choked, then on a sine (see `filling.mol`).
fn filled(pressure: f64) -> f64 {
    let (volume, conductance, supply, b) = (0.9e-6, 5e-10, 7e5, 0.3);
    let fill = conductance * RHO_0 * RT / volume;
    let choked = (b * supply - 1e5) / (fill * supply);
    let z = (pressure / supply - b) / (1.0 - b);
    assert!(z > 0.0 && pressure / supply < 0.999, "subsonic at {pressure} Pa");
    choked + (1.0 - b) / fill * z.asin()
}

#[test]
fn a_spool_leaves_its_stop_when_the_piston_can_bear_it() {
    let held_by = [
        // Air spring, Coulomb and Stribeck force of the whole spool.
        ("a_air_springs", 6e5 * A_12 + 7.0 + 5.0),
        // Preload of the spring instead.
        ("b_mechanical_spring", 50.0 + 7.0 + 5.0),
        // Five of seven seals are in contact at the start.
        ("c_seal_signals", 6e5 * A_12 + 5.0 * (1.0 + 1.5)),
    ];
    for (name, force) in held_by {
        let run = Case::file(format!("examples/evolution/{name}.mol")).tolerance(1e-9).run();
        assert_close(run.times_of("f_ahead")[0], filled(1e5 + force / A_14), 1e-6);
    }
}

/// The mechanical spring is the first model with one redeclaration, so its file holds the first model as it is.
#[test]
fn the_mechanical_spring_redeclares_and_nothing_else() {
    let air = text_of("examples/evolution/a_air_springs.mol");
    let model = &air[air.find("model AirSprings").expect("the model")..];
    let spring = text_of("examples/evolution/b_mechanical_spring.mol");
    assert!(spring.contains(model));
}

#[test]
fn friction_after_rest_is_what_the_law_says() {
    let run = Case::file("examples/evolution/d_dwell.mol").tolerance(1e-9).run();
    let times = run.times_of("f_ahead");
    for (t, rest) in times.iter().zip([1.0, 60.0, 3600.0, 172_800.0]) {
        let share = 1.0 - (-f64::powf((rest + t) / 1500.0, 0.3)).exp();
        assert_close(10.0 * t, 7.0 + 16.8 * share, 1e-6);
    }
    assert_eq!(times.len(), 4);
}

#[test]
fn the_functional_unit_keeps_its_air() {
    let run = Case::file("examples/evolution/e_functional_unit.mol").run();
    let [m_in, m_out, m_all] = ["m_in", "m_out", "m_all"].map(|name| run.of(name));
    assert!(run.last("m_out") > 1e-4, "air has passed");
    for row in 0..run.rows() {
        let lost = m_all[0] + m_in[row] - m_out[row] - m_all[row];
        assert!(lost.abs() < 1e-12 * m_all[0], "{lost} kg at {} s", run.time[row]);
    }
}

#[test]
fn valves_do_what_their_symbols_say() {
    let open = Case::file("examples/valve22.mol").run();
    assert!(
        open.at("p2", 0.09) > 6e5 && open.last("p2") < 1.1e5,
        "filled, then emptied by the consumer"
    );

    let double = Case::file("examples/valve52_double.mol").run();
    // No coil is on and chamber 14 is losing its air: the spool stays where it is.
    assert_eq!(double.at("s", 0.080), 3.5e-3);
    assert_eq!(double.last("s"), 0.0);
    assert!(double.at("p4", 0.080) > 6.9e5 && double.last("p4") < 1.1e5);

    let centred = Case::file("examples/valve53.mol").run();
    assert_eq!((centred.at("s", 0.05), centred.at("s", 0.2)), (2e-3, -2e-3));
    assert!(centred.at("s", 0.14).abs() < 0.1e-3, "back in the middle");
    // Closed centre: port 4 keeps its pressure, port 2 stays vented.
    assert!(centred.at("p4", 0.14) > 6.9e5 && centred.at("p2", 0.14) < 1.01e5);
}

#[test]
fn a_ball_bounces_at_the_times_of_the_closed_form() {
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
fn a_slider_sticks_and_slips() {
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
