//! Effects that a model may lack (`lib/Effects`): each agrees with a closed form where it is present, and changes nothing
//! where its amplitudes are 0. The models are in `tests/data/effects.mo`; the effects are found in the library.

use std::path::Path;

use mocc::ir::trajectory::Trajectory;

use super::door::{Case, Compiled, Reading};

const MODELS: &str = "tests/data/effects.mo";

/// A class of the library with an effect annotation.
struct Effect {
    name: String,
    /// Entries of the annotation, such as `amplitude=F>0`.
    entries: Vec<String>,
    explains: String,
}

impl Effect {
    /// Names of the amplitudes, without their signs.
    fn amplitudes(&self) -> Vec<&str> {
        let entry = self.entries.iter().find_map(|e| e.strip_prefix("amplitude="));
        let names = entry.unwrap_or_else(|| panic!("{} has no amplitude", self.name));
        names.split(',').map(|n| n.strip_suffix(">0").unwrap_or(n)).collect()
    }
    /// The component that is the effect in its models under `Absent`.
    fn component(&self) -> &str {
        match self.name.as_str() {
            "Source" => "supply",
            "Restriction" => "line",
            "VariableRestriction" => "fill",
            "PilotValve" => "pilot",
            _ => "effect",
        }
    }
}

/// All effects of the library, by name.
fn effects() -> Vec<Effect> {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("lib");
    let mut found = Vec::new();
    for package in std::fs::read_dir(library).expect("lib").flatten() {
        for file in std::fs::read_dir(package.path()).expect("a package").flatten() {
            let text = std::fs::read_to_string(file.path()).expect("a text");
            let quoted = |key: &str| {
                let rest = text.split_once(key)?.1;
                rest.split('"').nth(1).map(str::to_owned)
            };
            if let (Some(entries), Some(explains)) = (quoted("effect   ="), quoted("explains =")) {
                let entries = entries.split(';').map(|e| e.trim().to_owned()).collect();
                let name = file.path().file_stem().expect("a name").display().to_string();
                found.push(Effect { name, entries, explains });
            }
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(found.len() > 30, "only {} effects", found.len());
    found
}

/// The valve without any effect, or with one whose amplitudes are 0.
fn absent(model: &str) -> Compiled {
    let case = Case::file(MODELS).model(format!("EffectTests.{model}"));
    case.stop(0.08).interval(1e-4).tolerance(1e-9).compile()
}

#[test]
fn every_effect_follows_its_closed_form() {
    for effect in effects() {
        let run = Case::file(MODELS).model(format!("EffectTests.Present.{}", effect.name)).run();
        let holds: Vec<bool> = match run.values("compared") {
            Some(values) => values.iter().map(|v| *v != 0.0).collect(),
            None => vec![true; run.rows()],
        };
        assert!(holds.iter().filter(|h| **h).count() > 100, "{}: hardly compared", effect.name);
        let count = run.columns.iter().filter(|c| c.name.starts_with("found")).count();
        assert!(count > 0, "{}: nothing compared", effect.name);
        for k in 1..=count {
            let exact = run.of(&format!("exact[{k}]"));
            let scale = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let found = run.of(&format!("found[{k}]"));
            for (row, (found, exact)) in found.iter().zip(exact).enumerate() {
                assert!(
                    !holds[row] || (found - exact).abs() <= 1e-8 * scale,
                    "{}: found[{k}] is {found} instead of {exact} at {} s",
                    effect.name,
                    run.time[row]
                );
            }
        }
    }
}

#[test]
fn an_effect_of_amplitude_zero_changes_nothing() {
    let base = absent("Base").run();
    let most = base.of("s").iter().fold(0.0_f64, |most, s| most.max(*s));
    assert!(most > 3e-3 && base.last("s") < 1e-3, "the valve switches on and off");
    assert!(base.last("p_2") > 2e5, "air passes the seal");
    for effect in effects() {
        let run = absent(&format!("Absent.{}", effect.name)).run();
        same(&run, &base, &effect.name);
        // What an effect is attached to beside the valve stands there twice.
        if let Some(observed) = run.values("observed").filter(|_| run.values("twin").is_some()) {
            let scale = observed.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            for (with, without) in observed.iter().zip(run.of("twin")) {
                assert!(
                    (with - without).abs() <= 1e-7 * scale,
                    "{}: {with}, {without}",
                    effect.name
                );
            }
        }
    }
}

/// Compares two runs of the valve at the times of the rows, but for rounding and another choice of steps.
fn same(run: &Trajectory, base: &Trajectory, name: &str) {
    assert_eq!(run.events.len(), base.events.len(), "{name}: another number of events");
    assert_eq!(run.rows(), base.rows(), "{name}");
    for column in ["s", "v", "p", "p_2"] {
        let scale = base.of(column).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for (row, (found, expected)) in run.of(column).iter().zip(base.of(column)).enumerate() {
            assert!(
                (found - expected).abs() <= 1e-7 * scale,
                "{name}: {column} is {found} instead of {expected} at {} s",
                run.time[row]
            );
        }
    }
}

/// The score test needs the derivative of a run by an amplitude at 0.
#[test]
fn a_run_has_derivatives_by_every_amplitude_at_zero() {
    // Only a recorded input has a derivative by its delay: see `an_actuator_with_a_dead_time_is_found`.
    for effect in effects().into_iter().filter(|e| e.name != "ActuatorDelay") {
        let compiled = absent(&format!("Absent.{}", effect.name));
        let variables = &compiled.program.blocks.dae.variables;
        for amplitude in effect.amplitudes() {
            let whole = format!("{}.{amplitude}", effect.component());
            let first = format!("{whole}[1]");
            let is = |name: &str| variables.enumerate().any(|(_, v)| v.name == name);
            let input = if is(&whole) { whole } else { first };
            let run = compiled.differentiate(&[input.as_str()]);
            let observed = match [
                "Sensor",
                "ActuatorLag",
                "PartialLag",
                "RateLimit",
                "ActuatorHysteresis",
                "ActuatorBacklash",
                "EmptyStore",
            ]
            .iter()
            .any(|n| effect.name.contains(n))
            {
                true => "effect.y",
                false if is("observed") => "observed",
                false => "s",
            };
            let slopes = run.by(0, observed);
            assert!(slopes.iter().all(|x| x.is_finite()), "{}", effect.name);
            assert!(slopes.iter().any(|x| *x != 0.0), "{}: {input} changes nothing", effect.name);
        }
    }
}

/// A tool attaches effects by their annotations, so these must name existing elements.
#[test]
fn annotations_name_existing_elements() {
    for effect in effects() {
        let compiled = absent(&format!("Absent.{}", effect.name));
        let variables = &compiled.program.blocks.dae.variables;
        let is_there = |name: &str| {
            let whole = format!("{}.{name}", effect.component());
            let (member, element) = (format!("{whole}."), format!("{whole}["));
            variables.enumerate().any(|(_, v)| {
                let found = v.name.as_str();
                found == whole || found.starts_with(&member) || found.starts_with(&element)
            })
        };
        assert!(effect.explains.contains("%at"), "{}", effect.name);
        for name in effect.amplitudes() {
            assert!(is_there(name), "{}: amplitude {name}", effect.name);
        }
        for entry in &effect.entries {
            let (names, values) = match entry.strip_prefix("bind ") {
                Some(bound) => (bound.split_once('=').expect("bind NAME=PATH").0, ""),
                None => entry.split_once('=').expect("NAME=VALUES"),
            };
            let names = names.strip_prefix("with ").unwrap_or(names);
            match names {
                "amplitude" | "named" => {}
                "of" => {
                    let known = ["state", "speed", "term", "rate", "recording"];
                    assert!(known.contains(&values), "{}", effect.name);
                }
                "simpler" => {
                    for class in values.split(',') {
                        let name = class.strip_prefix("Effects.").expect("a class of Effects");
                        assert!(
                            effects().iter().any(|e| e.name == name),
                            "{}: {name}",
                            effect.name
                        );
                    }
                }
                "order" => assert_eq!(values, "first", "{}", effect.name),
                "follows" => assert_eq!(values, "line", "{}", effect.name),
                "pairs" => assert_eq!(values, "ordered", "{}", effect.name),
                "series" => assert_eq!(values, "true", "{}", effect.name),
                "between" => assert_eq!(values, "moving", "{}", effect.name),
                "varies" | "acts" | "adds" | "starts" => {
                    assert!(is_there(values), "{}: {values}", effect.name)
                }
                "host" => {
                    for connector in values.split(',') {
                        assert!(is_there(connector), "{}: connector {connector}", effect.name);
                    }
                }
                _ => {
                    assert!(is_there(names), "{}: {names}", effect.name);
                    for value in values.split([',', '/']).filter(|v| v.contains('(')) {
                        let (_, rest) = value.split_once('(').expect("a bracket");
                        let of = match value.split_once('(').expect("a bracket").0 {
                            "min" | "max" | "span" | "between" | "zero" => {
                                rest.trim_end_matches(')')
                            }
                            multiple if multiple.ends_with("*span") => rest.trim_end_matches(')'),
                            multiple if multiple.ends_with("*max") => rest.trim_end_matches(')'),
                            variable => variable,
                        };
                        assert!(is_there(of), "{}: {of} in {value}", effect.name);
                    }
                }
            }
        }
    }
}
