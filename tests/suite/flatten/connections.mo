// A node of three: the potentials are equal, the flows add up to zero, and an open end carries none.
model Node
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  model Leak
    Pin p;
    parameter Real G = 1;
  equation
    p.i = G*p.v;
  end Leak;
  model Source
    Pin p(v = time);
    Pin open(v = 0);
  end Source;
  Leak a;
  Leak b(G = 2);
  Source source;
equation
  connect(a.p, b.p);
  connect(source.p, b.p);
end Node;
