//! The cost of each stage for the 5/2-way valve, from the source to the trajectory of one cycle.

use divan::Bencher;
use mocc::base::diag::Problems;
use mocc::base::source::FileId;
use mocc::driver::compile::{Request, Session};
use mocc::ir::blocks::Blocks;
use mocc::ir::flat::FlatModel;
use mocc::parse::grammar;
use mocc::simulate::run::simulate;
use mocc::simulate::settings::Settings;

fn main() {
    divan::main();
}

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/valve52.mol");

/// The file of the valve alone; classes of the library are parsed when `flatten` needs them.
#[divan::bench]
fn parse(bencher: Bencher) {
    let text = std::fs::read_to_string(FILE).expect("the example");
    bencher.bench_local(|| {
        let mut problems = Problems::new();
        let file = grammar::parse(FileId(0), &text, &mut problems);
        assert!(problems.is_empty());
        file
    });
}

/// From the file on disk to the flat model: reading, parsing, instantiating, flattening.
#[divan::bench]
fn flatten(bencher: Bencher) {
    bencher.bench_local(flat);
}

/// From the flat model to sorted blocks: `lower` and `structure`.
#[divan::bench]
fn sort(bencher: Bencher) {
    bencher.with_inputs(flat).bench_local_values(blocks);
}

/// From sorted blocks to the program.
#[divan::bench]
fn codegen(bencher: Bencher) {
    bencher
        .with_inputs(|| blocks(flat()))
        .bench_local_values(|blocks| Session::default().generate(blocks).expect("a program"));
}

/// All compilation stages together.
#[divan::bench]
fn compile(bencher: Bencher) {
    bencher.bench_local(|| Session::default().compile(&request()).expect("a program"));
}

/// One cycle, on and off, at the default tolerance, with all variables recorded.
#[divan::bench]
fn cycle(bencher: Bencher) {
    let mut session = Session::default();
    let program = session.compile(&request()).expect("a program");
    let settings = Settings::of(&program.blocks.dae.experiment);
    bencher.bench_local(|| simulate(&program, &settings, &session.sources).expect("a run"));
}

fn request() -> Request {
    Request { file: Some(FILE.into()), ..Request::default() }
}

fn flat() -> FlatModel {
    Session::default().flatten(&request()).expect("a flat model")
}

fn blocks(flat: FlatModel) -> Blocks {
    Session::default().sort(flat).expect("sorted blocks")
}
