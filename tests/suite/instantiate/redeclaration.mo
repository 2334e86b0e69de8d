//@ case unknown_element
model Slider
  model Rubber = Friction.Coulomb(F_Coulomb = 1);
  //@ error[MO0203] 76-85
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictonLaw = Rubber);
end Slider;

//@ case not_replaceable
package Shop
  model Law
    input Real v;
    output Real f = v;
  end Law;
  model Quadratic
    extends Law(f = v*v);
  end Quadratic;
  model Holder
    replaceable model Open = Law;
    model Closed = Law;
    replaceable Law open;
    Law closed;
  end Holder;
  model Locked = Holder(redeclare model Open = Quadratic);
  model Fine
    Holder a(redeclare model Open = Quadratic, redeclare Quadratic open(v = 1), closed(v = 1));
    // The type that it has may be written again.
    Holder b(redeclare Law closed(v = 2), open(v = 1));
  end Fine;
  model Machine
    Fine fine;
    // A class, a component, and a class that an inner redeclaration has closed.
    //@ error[MO0224] 30-35
    Holder c(redeclare model Closed = Quadratic, open(v = 1), closed(v = 1));
    //@ error[MO0224] 34-39
    Holder d(redeclare Quadratic closed(v = 1), open(v = 1));
    //@ error[MO0224] 30-33
    Locked e(redeclare model Open = Law, open(v = 1), closed(v = 1));
  end Machine;
end Shop;

//@ case closed_elements
package Closed
  model Base
    final replaceable Real fixed_part = 2;
    replaceable constant Real number = 1;
    replaceable Real level = 3;
  protected
    replaceable model Inside
      Real x = 1;
    end Inside;
  end Base;

  model Derived
    extends Base;
    //@ error[MO1206] 20-29
    redeclare Real fixed_part = 3;
    //@ error[MO1206] 20-25
    redeclare Real number = 2;
    //@ error[MO1206] 21-26
    redeclare model Inside
      Real x = 2;
    end Inside;
  protected
    //@ error[MO1206] 20-24
    redeclare Real level = 4;
  end Derived;

  model Small
    Real x = 1;
  end Small;

  model Large
    Real x = 2;
    Real y = 3;
  end Large;

  model Open
    replaceable Large part constrainedby Small;
  end Open;

  model Narrow
    extends Open(replaceable Large part constrainedby Large);
  end Narrow;

  model Wrong
    //@ error[MO1207] 23-26
    replaceable Small part constrainedby Large;
  end Wrong;

  type Pair = Real[2];
  model Vector
    replaceable type Item = Pair;
    Item item = {1, 2};
  end Vector;

  model Test
    Derived derived;
    Open open(redeclare Small part);
    //@ error[MO0225] 35-38
    Narrow narrow(redeclare Small part);
    Wrong wrong;
    //@ error[MO0225] 34-37
    Vector vector(redeclare type Item = Real);
  end Test;
end Closed;

//@ case not_a_subtype
// Translational.Mass is not a subtype of `constrainedby Friction.Law`.
model Slider
  //@ error[MO0225] 76-86
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Translational.Mass(m = 1));
end Slider;

//@ case beyond_the_constraint
package P
  model Small
    Real x = 1;
  end Small;
  model Large
    extends Small;
    Real y = 2;
  end Large;
  model Holder
    replaceable Large part constrainedby Large;
    replaceable constant Real k = 1;
  end Holder;
  model Wider
    //@ error[MO0225] 38-41
    extends Holder(replaceable Large part constrainedby Small);
  end Wider;
  model Changed
    //@ error[MO1206] 29
    Holder h(redeclare Real k = 2);
  end Changed;
  type Row = Real[3];
  type Matrix = Real[2, 3];
  model Rows
    //@ error[MO1207] 22
    replaceable type T = Row[2] constrainedby Matrix;
    T x = {{1, 2, 3}, {4, 5, 6}};
  end Rows;
  model Top
    Wider w;
    Changed c;
    Rows r;
  end Top;
end P;

//@ case replaceable_models
package P
partial model Law
  input Real v;
  Real f;
end Law;
model Linear
  extends Law;
  parameter Real d = 1;
equation
  f = d*v;
end Linear;
model Square
  extends Law;
equation
  f = v*abs(v);
end Square;
model Body
  replaceable model Drag = Linear constrainedby Law;
  Drag drag(v = v);
  Real v(start = 1, fixed = true);
equation
  der(v) = -drag.f;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Body;
  model A = Body;
  model B = Body(redeclare model Drag = Square);
  model C = Body(redeclare model Drag = Linear(d = 2));
end P;
//@ run model=P.A
//@ expect v = exp(-1) rel 1e-7
//@ run model=P.B
//@ expect v = 0.5 rel 1e-7
//@ run model=P.C
//@ expect v = exp(-2) rel 1e-7

//@ case inner_and_condition_are_kept
package P
  connector Port
    Real e;
    flow Real f;
  end Port;
  model Load
    parameter Real r = 1;
    Port p;
  equation
    p.e = r*p.f;
  end Load;
  model Other
    extends Load(r = 5);
  end Other;
  model Source
    Port p;
  equation
    p.e = 10;
  end Source;
  model Reader
    outer Real level;
    Real y = level;
  end Reader;
  model Machine
    parameter Boolean loaded = false;
    replaceable Load load if loaded;
    inner replaceable Real level;
    Reader reader;
    Source source;
  equation
    connect(source.p, load.p);
    level = 3;
  end Machine;
  model Top
    Machine idle(redeclare Other load, redeclare Real level);
    Machine busy(loaded = true, redeclare Other load);
  end Top;
end P;
// 10 on 5, where there is a load.
//@ expect idle.source.p.f, busy.source.p.f = 0, -2
//@ expect idle.reader.y = 3

//@ case open_enumeration
package P
  model Chooser
    replaceable type Kind = enumeration(:);
    parameter Kind kind;
    Integer number = Integer(kind);
  end Chooser;
  model Top
    type Colour = enumeration(red, green, blue);
    Chooser c(redeclare type Kind = Colour, kind = Colour.blue);
  end Top;
end P;
//@ expect c.number = 3

//@ case modifications_of_constraining_clauses
// What a constraining clause says of classes and values also holds for the class that takes the place (section 7.3.2);
// names in it are looked up where it is written, and a modification further outside counts more.
package Constrained
  partial package Fluid
    constant Real rho = 1;
    replaceable partial function density
      input Real T;
      output Real d;
    end density;
  end Fluid;

  package Water
    extends Fluid(rho = 1000);
    redeclare function extends density
    algorithm
      d := rho - T;
    end density;
  end Water;

  partial function pressure_drop
    replaceable package Medium = Fluid;
    input Real T;
    input Real k = 1;
    output Real dp;
  end pressure_drop;

  function none
    extends pressure_drop;
  algorithm
    dp := 0;
  end none;

  function linear
    extends pressure_drop;
  protected
    Real d = Medium.density(T);
  algorithm
    dp := k*d;
  end linear;

  partial model Law
    replaceable package Medium = Fluid;
    parameter Real a = 1;
    parameter Real b = 1;
    Real y;
  end Law;

  model Doubled
    extends Law;
  equation
    y = 2*a*b*Medium.density(0);
  end Doubled;

  model Single
    extends Law;
  equation
    y = a*b*Medium.density(0);
  end Single;

  partial model Machine
    replaceable package Medium = Fluid;
    parameter Real size = 5;
    replaceable function drop = none constrainedby pressure_drop(redeclare package Medium = Medium);
    replaceable model L = Single constrainedby Law(redeclare package Medium = Medium, a = size, b = 10);
    Real dp = drop(300);
    L law;
  end Machine;

  model Pump
    extends Machine(redeclare function drop = characteristic);
    replaceable function characteristic = none constrainedby pressure_drop(redeclare package Medium = Medium);
    // The medium of a short class is the one around it.
    model Inner = Single(redeclare package Medium = Medium);
    Inner inner_law;
  end Pump;

  model Top
    replaceable package Medium = Water;
    Pump plain(redeclare package Medium = Medium);
    Pump pump(redeclare package Medium = Medium, redeclare function characteristic = linear(k = 3),
      redeclare model L = Doubled(b = 7));
  end Top;
end Constrained;
//@ expect plain.dp, pump.dp = 0, 2100
//@ expect plain.law.y, pump.law.y = 50000, 70000
//@ expect plain.inner_law.y = 1000

//@ case the_same_class_by_another_name
// A redeclaration that is not `replaceable` may be repeated, also by another name of the class.
package Renamed
  package A
    constant Real c = 1;
  end A;
  partial model Base
    replaceable package M = A;
    Real x = M.c;
  end Base;
  package Two
    extends A(c = 2);
  end Two;
  model Closed
    extends Base(redeclare package M = Two);
  end Closed;
  model Top
    replaceable package Mine = Two;
    Closed closed(redeclare package M = Mine);
  end Top;
end Renamed;
//@ expect closed.x = 2

//@ case a_redeclared_component_in_an_array
// Without `each`, a value in the redeclaration of a component of an array is split among its elements.
package Network
  record Cable
    parameter Real r = 1;
    parameter Real bound(start = 0) = 2;
  end Cable;
  function resistance
    input Cable cable;
    output Real r = 10*cable.r;
  end resistance;
  model Line
    parameter Real length;
    replaceable parameter Cable cable constrainedby Cable;
    final parameter Real r = length*cable.r;
    final parameter Real r10 = resistance(cable);
  end Line;
  partial model Lines
    parameter Cable cables[2] = {Cable(r = 3), Cable(r = 5)};
    replaceable Line lines[2](length = {1, 2});
  end Lines;
  model Grid
    extends Lines(redeclare Line lines(redeclare replaceable Cable cable = cables));
    Line more[2](each length = 1, redeclare each Cable cable = cables[2]);
  end Grid;
end Network;
//@ expect lines[1].r, lines[2].r = 3, 10
//@ expect lines[1].r10, lines[2].r10 = 30, 50
//@ expect more[1].r, more[2].r = 5, 5

//@ case a_medium_of_an_older_library
// A package that replaces another one may lack functions that nobody calls.
package Media
  partial package Medium
    constant Real c = 1;
    replaceable function density
      input Real p;
      output Real d;
    end density;
    function viscosity
      input Real p;
      output Real v = p/7;
    end viscosity;
  end Medium;
  package Older
    constant Real c = 4;
    function density
      input Real p;
      output Real d = 2*p;
    end density;
  end Older;
  model Tank
    replaceable package M = Medium;
    Real d = M.density(M.c);
  end Tank;
  model Top
    Tank tank(redeclare package M = Older);
  end Top;
end Media;
//@ expect tank.d = 8

//@ case the_outermost_modification_counts
// Whether it redeclares or not, and whether the others do.
package Layers
  model Part
    parameter Real p = 1;
    parameter Real q = 1;
    Real y = p + 10*q;
  end Part;
  model Plain
    replaceable Part a;
  end Plain;
  model Redeclared
    extends Plain(redeclare replaceable Part a(p = 5));
  end Redeclared;
  model Modified
    extends Redeclared(a(p = 15));
  end Modified;
  model Short = Redeclared(a(p = 16));
  model Around
    Redeclared m(a(q = 3));
    Plain n(a(p = 15));
  end Around;
  model Top
    extends Redeclared(a(p = 17, q = 2));
    Modified modified;
    Short short;
    Redeclared direct(a(p = 18));
    Around around(m(redeclare Part a(p = 7)), n(redeclare Part a(p = 8)));
  end Top;
end Layers;
//@ expect a.y, modified.a.y, short.a.y, direct.a.y = 37, 25, 26, 28
//@ expect around.m.a.y, around.n.a.y = 37, 18
