//! Generates the parser from the grammar.
use std::path::Path;

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../grammar");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={}", folder.join("modelica.lalrpop").display());
    let out = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    lalrpop::Configuration::new()
        .set_in_dir(folder)
        .set_out_dir(out)
        .process()
        .expect("the grammar is LALR(1); LALRPOP prints the conflict above");
}
