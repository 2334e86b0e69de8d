//! Generates the parser from the grammar in this folder.
fn main() {
    println!("cargo::rerun-if-changed=grammar/build.rs");
    println!("cargo::rerun-if-changed=grammar/modelica.lalrpop");
    // The shipped library is embedded in the binary.
    println!("cargo::rerun-if-changed=lib");
    // So are the pages that explain diagnostics.
    println!("cargo::rerun-if-changed=docs/errors");
    let out = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    lalrpop::Configuration::new()
        .set_in_dir("grammar")
        .set_out_dir(out)
        .process()
        .expect("the grammar is LALR(1); LALRPOP prints the conflict above");
}
