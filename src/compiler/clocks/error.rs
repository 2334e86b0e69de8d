//! Diagnostics of clocks and state machines.

use crate::base::cause::causes;

causes! {
    /// Causes found while clocks are inferred and state machines are replaced by equations.
    pub enum ClockCause {
        /// Two clocks of one partition tick at different instants.
        error MO0357 ContradictingClocks { first: String, second: String } (section "16.7.5")
            => ("clocks contradict each other: {first} and {second}"),
            help("separate the partitions with `sample(hold(u))`, or correct a factor or an interval");
        /// A partition with derivatives has no solver method.
        error MO0358 NoSolverMethod { variable: String } (section "16.8.4")
            => ("`der({variable})` is in a clocked partition without a solver method"),
            help("give its clock one: `Clock(c, solverMethod = \"ImplicitEuler\")`");
        /// A solver method that mocc does not have.
        error MO0359 UnknownSolverMethod { method: String } (section "16.8.2")
            => ("there is no solver method \"{method}\" for clocked partitions"),
            help("use ExplicitEuler, ExplicitMidPoint2, ExplicitRungeKutta4, ImplicitEuler or \
                  ImplicitTrapezoid");
        /// Clocked and continuous-time variables meet in one partition.
        error MO0360 MixedPartition { why: String } (section "16.7.3")
            => ("{why}"),
            help("convert with `sample` from continuous time to a clock, and with `hold` back");
        /// A clock would tick before the clock that it is derived from.
        error MO0361 TicksTooEarly (section "16.5.2")
            => ("this clock would tick before its base clock starts"),
            help("use a smaller `backCounter`, or a larger `shiftCounter` before it");
        /// A clock that is derived from an event clock is faster than it.
        error MO0362 FasterThanEvents (section "16.5.2")
            => ("this clock would tick between the events of its event clock"),
            help("only `subSample`, and shifts by whole ticks, are possible from an event clock");
        /// A partition without a clock.
        warning MO0363 DefaultClock (section "16.3")
            => ("no clock is given for this partition: `Clock(1.0)` is used"),
            help("write `Clock(...)` at one place of the partition");
        /// The equations of a clocked partition do not determine its variables.
        error MO0364 Undetermined { name: String } (section "16.7.4")
            => ("the equations of the clocked partition of `{name}` do not determine it"),
            help("give it one equation of the same clock");
        /// A clocked partition has more equations than variables.
        error MO0365 Overdetermined (section "16.7.4")
            => ("this equation is one too many in its clocked partition"),
            help("remove it, or convert a variable from another partition");
        /// Discrete variables of a clocked partition depend on each other.
        error MO0366 DiscreteLoop { names: String } (section "16.7.4")
            => ("clocked variables that are not Real depend on each other: {names}"),
            help("read one of them with `previous`");
        /// A clock depends on a condition that is not a parameter expression.
        error MO0367 SwitchedClock (section "16.3")
            => ("a condition between clocks must be a parameter expression"),
            help("use a parameter or constant in the condition");
        /// A state machine without exactly one initial state.
        error MO0368 InitialStates { states: String, count: usize } (section "17.1")
            => ("the state machine of {states} has {count} initial states"),
            help("name exactly one of its states in `initialState`");
        /// Two transitions of a state have the same priority.
        error MO0369 EqualPriorities { state: String, priority: i64 } (section "17.1")
            => ("two transitions from `{state}` have priority {priority}"),
            help("give each transition from one state another `priority`");
        /// An operator of states is used outside of a state machine.
        error MO0370 OutsideOfStateMachine { operator: String } (section "17.1")
            => ("`{operator}` is used outside of a state machine"),
            help("use it in the condition of a `transition` or in a state, and name a block that is a state");
        /// A clocked variable has an initial equation that is not a start value.
        error MO0371 ClockedInitialEquation (section "16.9")
            => ("an initial equation of a clocked variable must be a start value"),
            help("give the variable a `start` value");
        /// A variable is determined in several states that can be active together.
        error MO0372 AssignedInParallelStates { name: String } (section "17.3.5")
            => ("`{name}` is determined in states that can be active at the same tick"),
            help("determine it in states of one state machine only");
    }
}
