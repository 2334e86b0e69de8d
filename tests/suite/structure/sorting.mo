//@ case chain_of_flows
//@ run stop=3
//@ snapshot structure
// Two volumes and a pipe between them: `semiLinear` with a common flow, which rests at the start.
model Chain
  parameter Real cold = 1;
  parameter Real hot = 5;
  Real rate = if time < 1 then 0 else time - 2.5;
  Real port;
  Real a;
  Real b;
  Boolean before(start = true);
  Boolean later(start = false);
initial equation
  pre(before) = false;
  pre(later) = pre(before);
equation
  a = semiLinear(rate, cold, port);
  b = semiLinear(-rate, hot, port);
  a + b = 0;
  before = time > 2 or pre(before);
  later = pre(before);
end Chain;
//@ expect structure has 1 "3 explicit"
//@ expect port, a, later = 1, 0.5, 1

//@ case closed_end
//@ run stop=2
//@ snapshot structure
// A closed end: nothing flows, so the balance does not determine the inflowing enthalpy. It is that of the boundary.
model ClosedEnd
  connector Port
    Real p;
    flow Real m_flow;
    Real h;
    flow Real H_flow;
  end Port;
  model Boundary
    Port port;
    parameter Real h = 3;
  equation
    port.p = 1;
    port.H_flow = semiLinear(port.m_flow, port.h, h*time);
  end Boundary;
  Boundary boundary;
end ClosedEnd;
//@ expect structure has 3 "boundary.port.h := boundary.h * time"
//@ expect boundary.port.h, boundary.port.H_flow = 6, 0

//@ case explicit
//@ snapshot structure
// Written backwards: sorting alone solves it.
model Sorted
  Real x(start = 1, fixed = true);
  Real a;
  Real b;
  Real c;
equation
  der(x) = -a;
  a = 2*b + 1;
  b*3 = c;
  c - sin(x) = 0;
end Sorted;
//@ expect structure has 2 "(3 explicit)"

//@ case booleans_that_refer_to_each_other
// Nothing reads them, so a warning is enough.
model Pair
  Boolean a;
  Boolean b;
equation
  //@ warning[MO0410] 3-11
  a = not b;
  b = not a;
end Pair;

//@ case relations_at_the_start
//@ run stop=1 tolerance=1e-9
// With the phase that a relation without a value would give, the second equation has no solution.
model Medium
  Real h(start = 1, fixed = true);
  Integer phase;
  Real d, q(start = 1);
equation
  phase = if h < 2 then 1 else 2;
  d = if phase == 1 then 3 + 0.1*h else -5;
  q^4 + q^2 = d;
  der(h) = -0.1*q;
end Medium;
//@ expect q at start = sqrt((-1 + sqrt(1 + 4*3.1))/2) abs 1e-9
