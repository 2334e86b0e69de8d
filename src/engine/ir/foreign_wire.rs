//! Runs of foreign models as bytes, on their way between processes.

use crate::base::wire::{wire_enum, wire_struct};

use super::foreign::{ForeignOutcome, ForeignShape, ForeignSignal, ForeignTask, Stop};

wire_struct!(ForeignShape {
    steps_itself,
    states,
    indicators,
    needs_completed_steps,
    steps_vary,
    step,
});
wire_struct!(ForeignSignal { value, series, is_discrete, orders });
wire_struct!(ForeignOutcome {
    counters,
    method,
    state_events,
    time_events,
    end,
    ended,
    interrupted,
});
wire_enum!(Stop {
    Options(why) = 0,
    StepTooSmall(step) = 1,
    Singular = 2,
    TooManySteps(limit) = 3,
    NotFinite = 4,
    Chattering(relation, events, duration) = 5,
    NoStep = 6,
});

wire_struct!(ForeignTask {
    span,
    tolerance,
    method,
    most_steps,
    max_step,
    interval,
    spacing,
    instants,
    values,
    signals,
    watched,
});
