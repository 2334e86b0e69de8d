//! Tests of the engine on programs that the compiler makes.
mod machine_code;
mod simulate;
mod verify;
