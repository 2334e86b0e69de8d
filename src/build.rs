//! Tells Cargo which files the binary holds.
fn main() {
    println!("cargo::rerun-if-changed=src/build.rs");
    // The shipped library.
    println!("cargo::rerun-if-changed=lib");
    // The pages that explain diagnostics.
    println!("cargo::rerun-if-changed=docs/errors");
    // The models that `mocc new` begins with.
    println!("cargo::rerun-if-changed=examples/templates");
}
