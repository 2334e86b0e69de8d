//! Generates the parser from the grammar beside this file.
fn main() {
    println!("cargo::rerun-if-changed=grammar/build.rs");
}
