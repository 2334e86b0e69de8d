//! What must hold, by subject; models and data are beside this folder in `suite/` and `data/`.

mod door;

mod examples;
mod reference;
