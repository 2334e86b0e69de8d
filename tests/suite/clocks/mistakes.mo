//@ case zero_resolution
model Sampled
  //@ error[MO0355] 25-35
  Real x = sample(time, Clock(1, 0));
end Sampled;

//@ case state_of_number
model Machine
  Real x = sample(time, Clock(1, 10));
equation
  //@ error[MO0356] 3-17
  initialState(x);
end Machine;

//@ case two_periods
model Rates
  Real a = sample(time, Clock(1, 10));
  //@ error[MO0357] 8
  Real b = sample(time, Clock(1, 3));
  Real c = a + b;
end Rates;

//@ case no_method
model Controller
  Real u = sample(time, Clock(1, 10));
  //@ error[MO0358] 8
  Real x(start = 1);
equation
  der(x) = u - x;
end Controller;

//@ case unknown_method
model Controller
  //@ error[MO0359] 8
  Real u = sample(time, Clock(Clock(1, 10), solverMethod = "Heun"));
  Real x(start = 1);
equation
  der(x) = u - x;
end Controller;

//@ case mixed
model Plant
  Real x(start = 1, fixed = true);
  Real u = sample(x, Clock(1, 10));
equation
  //@ error[MO0360] 3-27
  der(x) = -x + hold(u) + u;
end Plant;

//@ case too_early
model Shifted
  //@ error[MO0361] 9
  Clock c = Clock(1, 10);
  Clock early = backSample(c, 1);
  Integer n(start = 0);
equation
  when early then
    n = previous(n) + 1;
  end when;
end Shifted;

//@ case faster_than_events
model Events
  //@ error[MO0362] 8
  Real u = sample(time, Clock(sin(time) > 0));
  Real y = superSample(u, 2);
end Events;

//@ case default_clock
model Sampled
  //@ warning[MO0363] 8
  Real u = sample(time);
end Sampled;

//@ case undetermined
model Sum
  Real u = sample(time, Clock(1, 10));
  //@ error[MO0364] 11
  Real y, z;
equation
  y + z = u;
end Sum;

//@ case overdetermined
model Twice
  Real u = sample(time, Clock(1, 10));
  //@ error[MO0365] 8
  Real y = u;
equation
  y = 2*u;
end Twice;

//@ case discrete_loop
model Latch
  Boolean go = sample(time > 1, Clock(1, 10));
  //@ error[MO0366] 11
  Boolean a = go or not b;
  Boolean b = go or not a;
end Latch;

//@ case switched_clock
model Switched
  Clock slow = Clock(1, 10), fast = Clock(1, 100);
  //@ error[MO0367] 9
  Clock c = if time > 1 then fast else slow;
  Real u = sample(time, c);
end Switched;

//@ case no_initial_state
model Machine
  block State
  end State;
  State a, b;
  Real u = sample(time, Clock(1, 10));
equation
  //@ error[MO0368] 3-25
  transition(a, b, u > 1);
end Machine;

//@ case equal_priorities
model Machine
  block State
  end State;
  State a, b, c;
  Real u = sample(time, Clock(1, 10));
equation
  initialState(a);
  transition(a, b, u > 1);
  //@ error[MO0369] 3-25
  transition(a, c, u > 2);
end Machine;

//@ case no_machine
//@ error[MO0370] 7-13
model Machine
  block State
  end State;
  State a;
  Real u = sample(time, Clock(1, 10));
  Boolean b = activeState(a) or u > 1;
end Machine;

//@ case initial_equation
model Start
  Real u = sample(time, Clock(1, 10));
  Real x = previous(x) + u;
initial equation
  //@ error[MO0371] 3-11
  x + u = 2;
end Start;

//@ case parallel_states
model Parallel
  inner Integer n(start = 0);
  block Count
    outer output Integer n;
  equation
    //@ error[MO0372] 5-23
    n = previous(n) + 1;
  end Count;
  Count a, b;
  Real u = sample(time, Clock(1, 10));
  Boolean later = u > 1;
  block State
  end State;
  State c;
equation
  initialState(a);
  transition(a, c, later, immediate = false);
  initialState(b);
end Parallel;
