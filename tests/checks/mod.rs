//! What must hold, by subject; models and data are beside this folder in `suite/` and `data/`.

mod door;
mod program;

mod architecture;
mod calibrate;
mod check;
mod cli;
mod closed_form;
mod diagnose;
mod diagnostics;
mod effects;
mod examples;
mod figures;
mod format;
mod functions;
mod friction;
mod hard;
mod hybrid;
mod implicit;
mod language;
mod machine_code;
mod mutation;
mod measured;
mod native;
mod recursion;
mod reference;
mod report;
mod results;
mod scoping;
mod sensitivity;
mod start;
mod suite;
mod sweep;
mod switching;
mod valve;
