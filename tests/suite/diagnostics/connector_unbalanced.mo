// status: 1
// error[MO0245] 5:13
// error[MO0245] 6:13
package Unbalanced
  connector Bare = Real;
  connector Lopsided
    Real v;
    Real w;
    flow Real i;
  end Lopsided;
  record State
    Real p;
    Real T;
  end State;
  connector Port
    State state;
    flow Real m_flow;
    flow Real H_flow;
    parameter Integer n = 2;
    input Real signal;
  end Port;
  model Plant
    Bare bare = 1;
    Lopsided lopsided(v = 1, w = 2);
    Port port(state(p = 1, T = 2), signal = 1);
  end Plant;
end Unbalanced;
