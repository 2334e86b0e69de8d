//! Friction laws against their closed forms, bodies that nothing holds at rest, and the choice of a law.

use super::door::{Case, Reading, assert_close, text_of};

/// The choice by a parameter and by a redeclaration are the same model.
#[test]
fn a_law_chosen_is_the_law_declared() {
    let dwell = "F_Stribeck_max = F_Stribeck_max, tau = tau, n = n";
    let curve = "F_prop = F_prop, f_exp = f_exp";
    let pressure = "k_C = k_C, k_S = k_S";
    let bristles = "sigma_0 = sigma_0, sigma_1 = sigma_1";
    let laws = [
        ("Frictionless", String::new()),
        ("Coulomb", "F_Coulomb = F_Coulomb".to_owned()),
        ("Stribeck", format!("F_Coulomb = F_Coulomb, F_Stribeck = F_Stribeck_max, {curve}")),
        ("StribeckDwell", format!("F_Coulomb = F_Coulomb, {dwell}, {curve}")),
        ("StribeckDwellPressure", format!("F_Coulomb = F_Coulomb, {pressure}, {dwell}, {curve}")),
        (
            "LuGre",
            format!("F_Coulomb = F_Coulomb, F_Stribeck = F_Stribeck_max, {curve}, {bristles}"),
        ),
        (
            "LuGreDwellPressure",
            format!("F_Coulomb = F_Coulomb, {pressure}, {dwell}, {curve}, {bristles}"),
        ),
        ("Dahl", "F_Coulomb = F_Coulomb, sigma_0 = sigma_0".to_owned()),
        ("TanhRegularised", "F_Coulomb = F_Coulomb".to_owned()),
    ];
    let valve = text_of("examples/valve32.mol");
    for (law, parameters) in laws {
        let chosen =
            Case::file("examples/valve32.mol").set(format!("friction_law=Friction.Kind.{law}"));
        let chosen = chosen.stop(0.04).interval(1e-4).run();
        let declared = format!(
            "{valve}\nmodel Declared\n  extends Valve32(redeclare model SealFriction = Friction.{law}({parameters}));\n\
             end Declared;"
        );
        let declared = Case::text(&declared).stop(0.04).interval(1e-4).run();
        assert!(chosen.last("s") > 3.4e-3, "{law}: the valve has switched");
        assert!(chosen.events.len() < 20, "{law}: {} events", chosen.events.len());
        for column in ["s", "p14", "p2"] {
            assert_close(chosen.at(column, 0.02), declared.at(column, 0.02), 1e-12);
            assert_close(chosen.last(column), declared.last(column), 1e-12);
        }
    }
}

/// The stiffer its bristles, the closer LuGre comes to the Stribeck curve with exact locking.
#[test]
fn stiff_bristles_approach_dry_friction() {
    let run = |settings: &[&str]| {
        let mut case = Case::file("examples/valve52.mol").stop(0.05).tolerance(1e-7);
        for setting in settings {
            case = case.set(*setting);
        }
        case.run()
    };
    let dry = run(&[]);
    let mut before = f64::INFINITY;
    for (sigma_0, sigma_1) in [(1e5, 40), (1e6, 150), (1e7, 400)] {
        let bristles = run(&[
            "friction_law=Friction.Kind.LuGreDwellPressure",
            &format!("sigma_0={sigma_0}"),
            &format!("sigma_1={sigma_1}"),
        ]);
        let times = (0..=500).map(|k| f64::from(k) * 1e-4);
        let apart = times.map(|t| (bristles.at("s", t) - dry.at("s", t)).abs()).fold(0.0, f64::max);
        assert!(apart < before / 2.0, "{apart} m after {before} m");
        before = apart;
    }
    assert!(before < 10e-6, "{before} m");
}
