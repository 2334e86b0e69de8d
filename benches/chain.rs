//! A chain of masses, springs and dampers connected by flanges: the run time of each stage must be
//! linear in their number.

use mocc::driver::compile::{Request, Session};
use mocc::ir::program::Program;
use mocc::simulate::record::Sink;
use mocc::simulate::run::simulate_to;
use mocc::simulate::settings::Settings;

const SIZES: [usize; 2] = [1000, 10_000];

fn main() {
    divan::main();
}

/// Discards all rows.
struct NullSink;

impl Sink for NullSink {
    fn begin(&mut self, _: Vec<mocc::ir::trajectory::Column>) {}
    fn row(&mut self, _: f64, _: &[f64]) {}
    fn event(&mut self, _: mocc::ir::trajectory::Event) {}
}

fn request(n: usize) -> Request {
    Request {
        file: Some(concat!(env!("CARGO_MANIFEST_DIR"), "/benches/chain.mo").into()),
        settings: vec![format!("N={n}")],
        ..Request::default()
    }
}

fn program(n: usize) -> Program {
    Session::default().compile(&request(n)).expect("the chain compiles")
}

/// Source to flat model.
#[divan::bench(args = SIZES, sample_count = 5)]
fn a_flatten(bencher: divan::Bencher<'_, '_>, n: usize) {
    bencher.bench_local(|| Session::default().flatten(&request(n)).is_ok());
}

/// Flat model to sorted blocks.
#[divan::bench(args = SIZES, sample_count = 5)]
fn b_sort(bencher: divan::Bencher<'_, '_>, n: usize) {
    bencher
        .with_inputs(|| Session::default().flatten(&request(n)).expect("the chain is flattened"))
        .bench_local_values(|flat| Session::default().sort(flat).is_ok());
}

/// Blocks to program.
#[divan::bench(args = SIZES, sample_count = 5)]
fn c_generate(bencher: divan::Bencher<'_, '_>, n: usize) {
    bencher
        .with_inputs(|| {
            let mut session = Session::default();
            let flat = session.flatten(&request(n)).expect("the chain is flattened");
            session.sort(flat).expect("the chain is sorted")
        })
        .bench_local_values(|blocks| Session::default().generate(blocks).is_ok());
}

/// One second, one mass recorded 500 times.
#[divan::bench(args = SIZES, sample_count = 3)]
fn d_simulate(bencher: divan::Bencher<'_, '_>, n: usize) {
    let mut program = program(n);
    mocc::codegen::recording::only(&mut program, |name| name.starts_with("mass[1]."));
    let settings = Settings::of(&program.blocks.dae.experiment);
    let sources = mocc::base::source::SourceMap::default();
    bencher.bench_local(|| {
        simulate_to(&program, &settings, &sources, &mut NullSink).expect("the chain runs").rows
    });
}
