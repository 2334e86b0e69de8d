//@ case inheritance_cycle
model A
  extends B;
end A;
//@ error[MO0205] 7
model B
  extends A;
end B;

//@ case duplicate_declaration
model Box
  Real length = 1;
  Real width = 2;
  //@ error[MO0204] 11-16
  Integer length = 3;
end Box;

//@ case inherited_twice
model Base
  Real x = 1;
end Base;
model Box
  extends Base;
  //@ error[MO0292] 8
  Real x = 2;
end Box;

//@ case modified_twice_by_two_bases
package Springs
  model Spring
    parameter Real c = 2000;
    parameter Real l = 1;
  end Spring;
  model Damped
    extends Spring;
  end Damped;
  model Strut
    extends Spring(l = 2, c = 200);
    //@ error[MO0256] 27-33
    extends Damped(l = 2, c = 300);
  end Strut;
  model Half
    extends Spring;
    //@ error[MO0256] 20-26
    extends Damped(c = 300);
  end Half;
  model Both
    Strut strut;
    Half half;
  end Both;
end Springs;

//@ case extends_unknown_modifier
model Car
  model Base
    replaceable model Engine
      Real x = 1;
    end Engine;
    Engine part;
  end Base;
  //@ error[MO0203] 16-18
  //@ error[MO0203] 41-45
  extends Base(foo = 3, redeclare model Engin = Other);
  model Other
    Real x = 2;
  end Other;
end Car;

//@ case partial_model
partial model Law
  Real v;
  Real f;
end Law;
model Use
  //@ error[MO0208] 3-5
  Law law;
end Use;

//@ case prefixed_base
package P
  record Data
    Real x;
  end Data;
  record Given = input Data;
  record Both
    //@ error[MO1289] 13-17
    extends Given;
    Real y;
  end Both;
  model Top
    Both both(x = 1, y = 2);
  end Top;
end P;

//@ case experiment_of_a_base_class
model Base
  Real x = time;
  annotation(experiment(StopTime = 3, Interval = 0.5));
end Base;
model Between
  extends Base;
end Between;
model Derived
  extends Between;
end Derived;
//@ expect x = 3
//@ expect events = 0
//@ expect rows = 7

//@ case constants_of_the_derived_package
// Elements that a package inherits see the constants and classes of that package.
package Media
  partial package PM
    constant String mediumName = "unusable";
    constant String names[:] = {mediumName};
    constant Real refX[nX] = fill(1/nX, nX);
    final constant Integer nS = size(names, 1);
    constant Integer nX = nS;
    constant Boolean fixedX = false;
    constant Boolean explicit;
    constant Integer nXi = if fixedX then 0 else nS - 1;
    replaceable record State
      Real p;
      Real X[nX](start = refX);
    end State;
    replaceable partial function setState
      input Real p;
      input Real X[:] = refX;
      output State s;
    end setState;
    replaceable partial function density
      input State s;
      output Real d;
    end density;
    replaceable partial model Base
      Real p; 
      Real Xi[nXi];
      Real X[nX](start = refX);
      State state;
    equation
      Xi = X[1:nXi];
      X[nX] = 1 - sum(Xi);
    end Base;
  end PM;
  package Air
    extends PM(names = {"N2", "O2", "Ar"}, refX = {0.7,0.2,0.1}, explicit = true, mediumName="air");
    redeclare function extends setState
    algorithm
      s := State(p = p, X = X);
    end setState;
    redeclare function extends density
    algorithm
      d := if explicit then s.p*sum(s.X) else 0;
    end density;
    redeclare model extends Base
    equation
      state = setState(p, X);
    end Base;
  end Air;
  package Water
    extends PM(explicit = false);
    redeclare function extends setState
    algorithm
      s := State(p = p, X = X);
    end setState;
    redeclare function extends density
    algorithm
      d := if explicit then 0 else s.p*2;
    end density;
  end Water;
  partial model Test
    replaceable package Medium = PM;
    Real d = Medium.density(Medium.setState(3));
    Medium.State state = Medium.setState(2 + time);
  end Test;
  model T1
    extends Test(redeclare package Medium = Air);
    Medium.Base medium(p = 1, Xi = Medium.refX[1:Medium.nXi], X(start=Medium.refX));
  end T1;
  model T2
    extends Test(redeclare package Medium = Water);
  end T2;
end Media;
//@ run model=Media.T1
//@ expect state.X[1:3] = 0.7, 0.2, 0.1
//@ expect medium.state.X[1:2] = 0.7, 0.2
//@ expect d = 3 rel 1e-12
//@ run model=Media.T2
//@ expect d, state.X[1], state.p = 6, 1, 3

//@ case short_classes_inherited_twice
// The same short class inherited twice is one, whatever its description.
package Flow
  package Medium constant Real d = 1; end Medium;
  package Water extends Medium(d = 1000); end Water;
  partial model In replaceable package M = Medium; Real m; end In;
  partial model Out
    replaceable package M = Medium "what flows" annotation (choicesAllMatching = true);
    Real m "mass";
  end Out;
  model Pipe
    extends In(redeclare package M = Water);
    extends Out(redeclare package M = Water);
  equation
    m = M.d*time;
  end Pipe;
end Flow;
//@ expect m = 1000

//@ case narrower_package_of_two_bases
//@ run stop=1
// A replaceable package comes from two bases, one of which asks for more than the other; the
// component gives one that fits both.
package Media
  partial package Fluid
    constant Real density;
  end Fluid;
  partial package Mixture
    extends Fluid;
    constant Real fraction;
  end Mixture;
  package Air
    extends Mixture(density = 1.2, fraction = 0.25);
  end Air;
  partial model Port
    replaceable package Medium = Fluid;
    Real d = Medium.density;
  end Port;
  partial model Fraction
    replaceable package Medium = Mixture;
    Real x = Medium.fraction;
  end Fraction;
  model Sensor
    extends Port;
    extends Fraction;
    Real partialDensity = d*x;
  end Sensor;
  model User
    Sensor s(redeclare package Medium = Air);
  end User;
end Media;
//@ expect s.partialDensity = 0.3 abs 1e-15

//@ case redeclared_in_component_and_constraining_clause
//@ run stop=1
// Both the component and its constraining clause say which medium; both hold (section 7.3.2).
package Media
  partial package Fluid
    constant Real density;
  end Fluid;
  package Water
    extends Fluid(density = 1000);
  end Water;
  package Oil
    extends Fluid(density = 850);
  end Oil;
  partial model Reader
    replaceable package Medium = Water constrainedby Fluid;
    Real d;
  end Reader;
  model Plain
    extends Reader;
  equation
    d = Medium.density*time;
  end Plain;
  model Plant
    package M = Oil;
    replaceable Plain reader(redeclare package Medium = M)
      constrainedby Reader(redeclare package Medium = M);
  end Plant;
  model User
    Plant plant;
  end User;
end Media;
//@ expect plant.reader.d = 850

//@ case inherited_and_declared_again_with_a_unit
// The two differ in nothing but an attribute; the new declaration counts.
package Units
  type Time = Real(unit = "s");
  partial block Base
    output Real y = 3;
  end Base;
  block Timer
    extends Base;
    output Time y(max = 5) = 3;
  end Timer;
  model Both
    Timer timer;
    Real x = timer.y;
  end Both;
end Units;
//@ expect x = 3

//@ case inherited_twice_by_two_names_of_one_class
package Grid
  model System
    parameter Real f = 50;
  end System;
  partial model Framework
    outer System system;
  end Framework;
  model Controller
    extends Framework;
    outer Grid.System system;
    Real x = system.f*time;
  end Controller;
  model Top
    inner System system(f = 60);
    Controller controller;
  end Top;
end Grid;
//@ expect controller.x = 60
