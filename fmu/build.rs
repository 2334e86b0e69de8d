//! Links with GNU ld where there is one. It leaves out the unwinding tables of functions that it leaves out; lld keeps
//! them, which are 0.8 MB in each archive.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is_linux = std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux");
    let is_native = std::env::var("TARGET").ok() == std::env::var("HOST").ok();
    let version = Command::new("ld.bfd").arg("--version").output();
    if is_linux && is_native && version.is_ok_and(|output| output.status.success()) {
        println!("cargo::rustc-cdylib-link-arg=-fuse-ld=bfd");
    }
}
