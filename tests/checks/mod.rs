//! One module per question.
mod architecture;
