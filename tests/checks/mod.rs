//! Tests from outside, by subject. Models are in `../suite/`, recordings in `../data/`.

mod door;
mod program;

mod architecture;
mod builtins;
mod calibrate;
mod check;
mod cli;
mod closed_form;
mod diagnose;
mod diagnose_domains;
mod docs;
mod effects;
mod errors;
mod examples;
mod figures;
mod format;
mod friction;
mod implicit;
mod library;
mod linear;
mod machine_code;
mod mutation;
mod measured;
mod native;
mod permutation;
mod reference;
mod report;
mod results;
mod sensitivity;
mod stages;
mod suite;
mod sweep;
mod valve;
mod wording;
