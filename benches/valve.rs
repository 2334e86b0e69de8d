//! One cycle of the 5/2-way valve, on and off, within one process: the model is compiled once, then
//! initialized and run at the default tolerance, with 1200 rows of all variables.

use std::sync::LazyLock;

use divan::Bencher;
use mocc::base::source::SourceMap;
use mocc::codegen::recording;
use mocc::driver::compile::{Request, Session};
use mocc::ir::program::Program;
use mocc::ir::trajectory::Trajectory;
use mocc::runtime::jit::MachineCode;
use mocc::runtime::jit::tiering::Execution;
use mocc::simulate::run::simulate_to;
use mocc::simulate::settings::Settings;

fn main() {
    divan::main();
}

struct Valve {
    program: Program,
    sources: SourceMap,
}

static VALVE: LazyLock<Valve> = LazyLock::new(|| {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/valve52.mol");
    let mut session = Session::default();
    let request = Request { file: Some(file.into()), ..Request::default() };
    let program = session.compile(&request).expect("a program");
    Valve { program, sources: session.sources }
});

fn run(bencher: Bencher, program: &Program, execution: Execution) {
    let mut settings = Settings::of(&program.blocks.dae.experiment);
    settings.stop = 0.12;
    settings.interval = 1e-4;
    settings.execution = execution;
    // The memory of the rows is reused, as in a series of simulations.
    let mut rows = Trajectory::default();
    bencher.bench_local(|| {
        simulate_to(program, &settings, &VALVE.sources, &mut rows).expect("a run");
        rows.rows()
    });
}

/// With precompiled machine code.
#[divan::bench]
fn cycle(bencher: Bencher) {
    run(bencher, &VALVE.program, Execution::translated(&VALVE.program));
}

/// With machine code, recording only the stroke, like a calibration.
#[divan::bench]
fn cycle_of_one_variable(bencher: Bencher) {
    let mut program = VALVE.program.clone();
    recording::only(&mut program, |name| name == "spool.s");
    let execution = Execution::translated(&program);
    run(bencher, &program, execution);
}

/// With the interpreter.
#[divan::bench]
fn cycle_interpreted(bencher: Bencher) {
    run(bencher, &VALVE.program, Execution::Interpreted);
}

/// Like a single simulation: interpreted at first, then compiled.
#[divan::bench]
fn cycle_adaptive(bencher: Bencher) {
    run(bencher, &VALVE.program, Execution::default());
}

/// From the program to its machine code.
#[divan::bench]
fn translate(bencher: Bencher) {
    bencher.bench_local(|| MachineCode::translate(&VALVE.program).expect("machine code"));
}
