//! Machine code leaves in every cell what the interpreter leaves, on whole models.

use std::path::{Path, PathBuf};

use mocc::ir::program::Program;
use mocc::ir::trajectory::Trajectory;
use mocc::runtime::jit::tiering::Execution;
use mocc::runtime::machine::Machine;
use mocc::simulate::initialization::initialise;
use mocc::simulate::settings::Settings;

use super::door::{Case, suite_model};

/// The bits, where what is not a number is one value: Rust leaves its sign and payload open.
fn bits(memory: &[f64]) -> Vec<u64> {
    memory.iter().map(|x| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }).collect()
}

fn translated(program: &Program) -> Execution {
    let execution = Execution::translated(program);
    assert!(matches!(execution, Execution::Compiled(_)));
    execution
}

/// Runs every tape in both ways, at the start and at states along a run, and compares all cells.
fn compare_tapes(program: &Program, trajectory: &Trajectory, what: &str) {
    let settings = Settings::of(&program.blocks.dae.experiment);
    let mut both = [Machine::new(program), Machine::new(program)];
    both[1].set_execution(&translated(program));
    for machine in &mut both {
        initialise(machine, &settings).expect("a start");
    }
    assert_eq!(bits(&both[0].memory), bits(&both[1].memory), "{what}: initialised");
    let names = program.blocks.states.iter().map(|s| program.name(s.variable));
    let columns: Vec<_> = names.map(|n| trajectory.values(n)).collect();
    for row in (0..trajectory.rows()).step_by(1 + trajectory.rows() / 100) {
        let own = both[0].states().to_vec();
        let states = columns.iter().zip(own).map(|(column, own)| column.map_or(own, |c| c[row]));
        let states: Vec<f64> = states.collect();
        for machine in &mut both {
            machine.set_point(trajectory.time[row], &states);
        }
        for (name, tape) in program.all_tapes() {
            if matches!(name, "parameters" | "initial") {
                continue;
            }
            let [oracle, fast] = &mut both;
            let outcome = oracle.run(tape);
            assert_eq!(fast.run(tape), outcome, "{what}: {name} at row {row}");
            assert_eq!(bits(&fast.memory), bits(&oracle.memory), "{what}: {name} at row {row}");
        }
    }
}

/// Compares tapes along a run, and then whole runs.
fn compare(case: &Case, what: &str) {
    let mut compiled = case.compile();
    compiled.execute(Execution::Interpreted);
    let interpreted = compiled.run();
    compare_tapes(&compiled.program, &interpreted, what);
    let code = translated(&compiled.program);
    compiled.execute(code);
    let run = compiled.run();
    assert_eq!(bits(&run.time), bits(&interpreted.time), "{what}");
    assert_eq!(run.events, interpreted.events, "{what}");
    for (column, (a, b)) in run.columns.iter().zip(run.data.iter().zip(&interpreted.data)) {
        assert_eq!(bits(a), bits(b), "{what}: {}", column.name);
    }
}

#[test]
fn examples_run_equally() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(folder).expect("examples").flatten().map(|e| e.path());
    let models: Vec<PathBuf> =
        files.filter(|p| p.extension().is_some_and(|e| e == "mol")).collect();
    assert!(!models.is_empty());
    for path in models {
        compare(&Case::file(&path), &path.display().to_string());
    }
}

/// Loops, branches, assertions and calls of calls; the Jacobian needs their derivatives.
#[test]
fn functions_run_equally() {
    let text = &suite_model("runtime/machine_code/functions");
    compare(&Case::text(text), "functions");
}

/// Torn blocks, linear and nonlinear, and a mixed one.
#[test]
fn blocks_run_equally() {
    let text = &suite_model("runtime/machine_code/blocks");
    compare(&Case::text(text), "blocks");
}

/// Calls of functions that call themselves stand between the pieces of machine code.
#[test]
fn functions_that_call_themselves_run_equally() {
    compare(
        &Case::suite("evaluate/recursion/adaptive_integral").model("P.Decay").stop(1.0),
        "recursion",
    );
}
