// A node of two: the potentials are equal, the flows add up to zero, and an open end carries none.
model Node
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  model Leak
    Pin p;
    Pin open;
    parameter Real G = 1;
  equation
    p.i = G*p.v;
    open.v = 0;
  end Leak;
  model Source
    Pin p(v = time);
  end Source;
  Leak a(G = 2);
  Source source;
equation
  connect(a.p, source.p);
end Node;
