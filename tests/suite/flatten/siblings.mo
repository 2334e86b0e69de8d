//@ case components_of_one_class
//@ used by stages.rs
//@ snapshot flat
// Several components of one class, modified and not.
package Siblings
  package Water
    constant Real rho = 1000;
    type Density = Real(unit = "kg/m3", start = rho);
  end Water;
  package Air
    extends Water(rho = 1.2);
  end Air;
  connector Port
    Real p;
    flow Real q;
  end Port;
  model Outside
    Port port;
  equation
    port.p = 0;
  end Outside;
  partial model Law
    input Real x;
    output Real y;
  end Law;
  model Linear
    extends Law;
    parameter Real k = 1;
  equation
    y = k*x;
  end Linear;
  model Square
    extends Law;
    parameter Real k = 2;
  equation
    y = k*x*x;
  end Square;
  model Tank
    replaceable package Medium = Water;
    replaceable model Loss = Linear;
    type Level = Real(unit = "m", min = 0);
    parameter Boolean vented = true;
    parameter Integer n = 2;
    Port port;
    Port vent if vented;
    Medium.Density d;
    Level h(start = 1, fixed = true);
    Level layers[n];
    Loss loss(x = h);
    Outside air if vented;
  equation
    d = Medium.rho;
    der(h) = -loss.y + port.q/d;
    port.p = d*h;
    layers = fill(h/n, n);
    connect(vent, air.port);
  end Tank;
  model Many
    Wrapped w[3];
    Wrapped one;
    Wrapped other(airy(h(start = 5)), square(redeclare model Loss = Linear));
  end Many;
  model Wrapped
    Tank plain;
    Tank airy(redeclare package Medium = Air, h(start = 2), vented = false);
    Tank square(redeclare replaceable model Loss = Square(k = 3), Level(max = 9), n = 3);
  end Wrapped;
end Siblings;
