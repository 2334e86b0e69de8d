//! One cycle of the 5/2-way valve, on and off, within one process: the model is compiled once, then
//! initialised and run at the default tolerance, with 1200 rows of all variables.

use std::sync::{Arc, LazyLock};

use divan::Bencher;
use mocc::base::source::SourceMap;
use mocc::codegen::jit::MachineCode;
use mocc::codegen::jit::rent::Execution;
use mocc::driver::compile::{Request, Session};
use mocc::ir::program::Program;
use mocc::simulate::run::simulate;
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

fn run(bencher: Bencher, execution: Execution) {
    let Valve { program, sources } = &*VALVE;
    let mut settings = Settings::of(&program.blocks.dae.experiment);
    settings.stop = 0.12;
    settings.interval = 1e-4;
    settings.execution = execution;
    bencher.bench_local(|| simulate(program, &settings, sources).expect("a run"));
}

/// By machine code that was made before.
#[divan::bench]
fn cycle(bencher: Bencher) {
    let code = MachineCode::translate(&VALVE.program).expect("machine code");
    run(bencher, Execution::Machine(Arc::new(code)));
}

/// By the interpreter.
#[divan::bench]
fn cycle_interpreted(bencher: Bencher) {
    run(bencher, Execution::Interpreted);
}

/// As a single run does by itself: interpreted at first, translated on the way.
#[divan::bench]
fn cycle_adaptive(bencher: Bencher) {
    run(bencher, Execution::Adaptive);
}

/// From the program to its machine code.
#[divan::bench]
fn translate(bencher: Bencher) {
    bencher.bench_local(|| MachineCode::translate(&VALVE.program).expect("machine code"));
}
