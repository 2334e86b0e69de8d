//! The operators of clocks and state machines (Modelica 3.6, chapters 16 and 17).
//!
//! *Holds:* which operator a [`Node::Clocked`](super::expr::Node::Clocked) is, with the meaning of its operands.
//! *Never holds:* clocks themselves: these are variables and expressions of type
//! [`Type::Clock`](super::expr::Type::Clock).
//! *Made by:* `evaluate`. *Read by:* `clocks`, after which no such node is left.

/// An operator of clocks or state machines.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ClockOperator {
    /// `Clock()`
    Inferred,
    /// `Clock(intervalCounter, resolution)`; the resolution is a literal.
    Rational,
    /// `Clock(interval)`
    Interval,
    /// `Clock(condition, startInterval)`
    Event,
    /// `Clock(c, solverMethod)`; the method is a literal.
    Solver,
    /// `sample(u)` or `sample(u, clock)`
    Sample,
    /// `hold(u)`
    Hold,
    /// `previous(u)`
    Previous,
    /// `subSample(u, factor)`; the factor is a literal, 0 if it is inferred.
    SubSample,
    /// `superSample(u, factor)`; the factor is a literal, 0 if it is inferred.
    SuperSample,
    /// `shiftSample(u, shiftCounter, resolution)`; both are literals.
    ShiftSample,
    /// `backSample(u, backCounter, resolution)`; both are literals.
    BackSample,
    /// `noClock(u)`
    NoClock,
    /// `firstTick()` or `firstTick(u)`
    FirstTick,
    /// `interval()` or `interval(u)`
    Elapsed,
    /// `(u, clock)` or `(u, clock, x)`: the value `u` in an equation of a clocked when-clause, of which another
    /// equation gives the value of `x`.
    At,
    /// `activeState(state)`; the name of the state is a literal.
    ActiveState,
    /// `ticksInState()`
    TicksInState,
    /// `timeInState()`
    TimeInState,
}

impl ClockOperator {
    /// How Modelica writes it.
    pub fn name(self) -> &'static str {
        match self {
            ClockOperator::Inferred
            | ClockOperator::Rational
            | ClockOperator::Interval
            | ClockOperator::Event
            | ClockOperator::Solver => "Clock",
            ClockOperator::Sample | ClockOperator::At => "sample",
            ClockOperator::Hold => "hold",
            ClockOperator::Previous => "previous",
            ClockOperator::SubSample => "subSample",
            ClockOperator::SuperSample => "superSample",
            ClockOperator::ShiftSample => "shiftSample",
            ClockOperator::BackSample => "backSample",
            ClockOperator::NoClock => "noClock",
            ClockOperator::FirstTick => "firstTick",
            ClockOperator::Elapsed => "interval",
            ClockOperator::ActiveState => "activeState",
            ClockOperator::TicksInState => "ticksInState",
            ClockOperator::TimeInState => "timeInState",
        }
    }

    /// Whether it lets a value pass from one sub-clock partition into another (section 16.5.2).
    pub fn converts(self) -> bool {
        matches!(
            self,
            ClockOperator::SubSample
                | ClockOperator::SuperSample
                | ClockOperator::ShiftSample
                | ClockOperator::BackSample
                | ClockOperator::NoClock
        )
    }

    /// Whether it makes a clock that ticks on its own, or one that is inferred.
    pub fn constructs(self) -> bool {
        matches!(
            self,
            ClockOperator::Inferred
                | ClockOperator::Rational
                | ClockOperator::Interval
                | ClockOperator::Event
                | ClockOperator::Solver
        )
    }
}
