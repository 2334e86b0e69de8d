//@ case two_states
//@ run stop=30 interval=1
// Both states count one variable in opposite directions; `j` of a state starts anew when it is entered.
model Zigzag
  inner Integer i(start = 0);
  block Up
    outer output Integer i;
    output Integer j(start = 10);
  equation
    i = previous(i) + 2;
    j = previous(j) - 1;
  end Up;
  block Down
    outer output Integer i;
  equation
    i = previous(i) - 1;
  end Down;
  Up up;
  Down down;
  Real now = sample(time, Clock(1, 1));
  Boolean goesUp = activeState(up);
equation
  initialState(up);
  transition(up, down, i > 10 and now >= 0, immediate = false);
  transition(down, up, i < 1, immediate = false);
end Zigzag;
//@ expect i at 0, 5, 6, 17, 18, 23 = 2, 12, 11, 0, 2, 12
//@ expect up.j at 0, 5, 10, 18, 20 = 9, 4, 4, 9, 7
//@ expect goesUp at 5, 6, 18 = 1, 0, 1

//@ case nested_and_parallel
//@ run stop=40 interval=1
// The model of section 17.3.7, whose course the figure there shows.
block HierarchicalAndParallelStateMachine
  inner Integer v(start = 0);
  State1 state1;
  State2 state2;
  Real now = sample(time, Clock(1, 1));
equation
  initialState(state1);
  transition(state1, state2, activeState(state1.stateD) and activeState(state1.stateY) and now >= 0,
    immediate = false);
  transition(state2, state1, v >= 20, immediate = false);
public
  block State1
    inner Integer count(start = 0);
    inner outer output Integer v;
    block StateA
      outer output Integer v;
    equation
      v = previous(v) + 2;
    end StateA;
    StateA stateA;
    block StateB
      outer output Integer v;
    equation
      v = previous(v) - 1;
    end StateB;
    StateB stateB;
    block StateC
      outer output Integer count;
    equation
      count = previous(count) + 1;
    end StateC;
    StateC stateC;
    block StateD
    end StateD;
    StateD stateD;
  equation
    initialState(stateA);
    transition(stateA, stateB, v >= 6, immediate = false);
    transition(stateB, stateC, v == 0, immediate = false);
    transition(stateC, stateA, true, immediate = false, priority = 2);
    transition(stateC, stateD, count >= 2, immediate = false);
  public
    block StateX
      outer input Integer v;
      Integer i(start = 0);
      Integer w;
    equation
      i = previous(i) + 1;
      w = v;
    end StateX;
    StateX stateX;
    block StateY
      Integer j(start = 0);
    equation
      j = previous(j) + 1;
    end StateY;
    StateY stateY;
  equation
    initialState(stateX);
    transition(stateX, stateY, stateX.i > 20, immediate = false, reset = false);
  end State1;
  block State2
    outer output Integer v;
  equation
    v = previous(v) + 5;
  end State2;
end HierarchicalAndParallelStateMachine;
//@ expect v at 0, 1, 2, 3, 8, 9, 10, 12, 18 = 2, 4, 6, 5, 0, 0, 2, 6, 0
//@ expect v at 21, 22, 25, 26, 27, 40 = 0, 5, 20, 22, 21, 8
//@ expect state1.count at 8, 9, 19, 25, 26 = 0, 1, 2, 2, 0
//@ expect state1.stateX.i at 0, 20, 25, 26 = 1, 21, 21, 1
//@ expect state1.stateY.j at 20, 21, 40 = 0, 1, 1
//@ expect state1.stateX.w at 10, 22, 26 = 2, 0, 22

//@ case synchronized
//@ run stop=20 interval=1
// `synchronize` waits until both machines of the state have arrived: after 3 and after 5 ticks.
model Fork
  block Rest
  end Rest;
  block Both
    block Rest
    end Rest;
    Rest a1, a2, b1, b2;
  equation
    initialState(a1);
    transition(a1, a2, ticksInState() >= 3, immediate = false);
    initialState(b1);
    transition(b1, b2, ticksInState() >= 5, immediate = false);
  end Both;
  Both both;
  Rest after;
  Real now = sample(time, Clock(1, 1));
  Boolean arrivedA = activeState(both.a2), arrivedB = activeState(both.b2);
  Boolean done = activeState(after) and now >= 0;
equation
  initialState(both);
  transition(both, after, true, immediate = false, synchronize = true);
end Fork;
//@ expect arrivedA at 2, 3 = 0, 1
//@ expect arrivedB at 4, 5 = 0, 1
//@ expect done at 5, 6, 20 = 0, 1, 1

//@ case ticks_and_time_in_state
//@ run stop=0.03 interval=0.001
// The example of section 17.1: A1 is active from 10 ms to 14 ms.
model Ticks
  block State
  end State;
  State A0, A1, A2;
  Boolean in1 = activeState(A1), in2 = activeState(A2);
equation
  initialState(A0);
  transition(A0, A1, sample(time, Clock(1, 1000)) > 0.0095);
  transition(A1, A2, ticksInState() >= 5, immediate = false);
  transition(A2, A0, timeInState() > 0.0045, immediate = false);
end Ticks;
//@ expect in1 at 0.0099, 0.0101, 0.0149, 0.0151 = 0, 1, 1, 0
//@ expect in2 at 0.0149, 0.0151, 0.0204, 0.0214 = 0, 1, 1, 0

//@ case priorities
//@ run stop=3 interval=1
// Of two transitions that could fire, the one with the lower number does; an immediate one fires at its tick.
model Priorities
  block State
  end State;
  State a, b, c;
  Integer n(start = 0) = previous(n) + 1;
  Real now = sample(time, Clock(1, 1));
  Boolean inB = activeState(b), inC = activeState(c);
equation
  initialState(a);
  transition(a, b, n >= 3 and now >= 0, priority = 2);
  transition(a, c, n >= 3, priority = 1);
end Priorities;
//@ expect inC at 1, 2 = 0, 1
//@ expect inB at 2, 3 = 0, 0

//@ case outputs_of_states_connected
//@ run stop=4 interval=1
// Several outputs of states feed one input: that of the active state counts (section 17.3.6).
model Merged
  connector Out = output Integer;
  connector In = input Integer;
  block State
    parameter Integer step;
    Out y(start = 0);
  equation
    y = previous(y) + step;
  end State;
  block Scale
    In u;
    Out y;
  equation
    y = 100*u;
  end Scale;
  State slow(step = 1), quick(step = 10);
  Scale scale;
  Real now = sample(time, Clock(1, 1));
equation
  initialState(slow);
  transition(slow, quick, slow.y >= 2 and now >= 0, immediate = false);
  connect(slow.y, scale.u);
  connect(quick.y, scale.u);
end Merged;
//@ expect scale.y at 0, 1, 2, 3, 4 = 100, 200, 1000, 2000, 3000
