//@ case equations_whose_units_differ
//@ expect accepted
//@ check
//@ used by check.rs
// Unit warnings name the equation, both units, and their declarations.
package Units
  model Tank
    parameter Real area(unit = "m2") = 2;
    parameter Real k(unit = "m3/(s.Pa)") = 1e-9;
    parameter Real rho(unit = "kg/m3") = 1000;
    parameter Real g(unit = "m/s2") = 9.81;
    Real level(unit = "m", start = 1, fixed = true);
    Real p(unit = "Pa");
    Real flow_out(unit = "m3/s");
    // Its unit follows from the equations: m/s.
    Real sinking;
    Real force(unit = "N");
    Real share(unit = "1") = level/area;
  equation
    p = rho*g*level;
    flow_out = k*p;
    der(level) = -flow_out/area;
    sinking = der(level);
    force = p*area + sinking;
  end Tank;

  model Right
    constant Real c(unit = "m/s") = 3e8;
    parameter Real m(unit = "kg") = 1;
    Real E(unit = "J") = m*c^2;
    Real half(unit = "J") = 0.5*E;
    Real angle(unit = "deg") = 0;
    Real turn(unit = "rad") = angle*3.141592653589793/180;
    Real root(unit = "m/s") = sqrt(2*E/m);
    Real rising(unit = "1") = exp(-time/T);
    parameter Real T(unit = "s") = 2;
  end Right;

  // Numbers that are given for quantities of a function have their units.
  function excess
    input Real p(unit = "Pa");
    input Real p_0(unit = "Pa");
    output Real dp(unit = "Pa");
  algorithm
    dp := p - p_0;
  end excess;

  model Given
    Real p(unit = "Pa") = excess(2e5, 1e5) + excess(p_0 = 1e5, p = 3e5);
  end Given;

  model Taken
    Real v(unit = "m/s") = 1;
    Real p(unit = "Pa") = excess(v, 1e5);
  end Taken;

  model Rising
    parameter Real T(unit = "kg") = 2;
    Real y = exp(-time/T);
  end Rising;
end Units;

//@ case scales_that_differ
//@ check
package Scales
  // A set point in degC for a temperature in K, a pressure in bar for one in Pa, and a length in mm for one in m.
  model Plant
    parameter Real tau(unit = "s") = 1;
    parameter Real goal(unit = "degC") = 60;
    parameter Real supply(unit = "bar") = 6;
    parameter Real stroke(unit = "mm") = 3;
    parameter Real speed(unit = "rev/min") = 1000;
    Real T(unit = "K", start = 293, fixed = true);
    Real p(unit = "Pa", start = 1e5, fixed = true);
    Real s(unit = "m", start = 0.001, fixed = true);
    Real phi(unit = "rad", start = 0, fixed = true);
    Real share(unit = "%", start = 20, fixed = true);
  equation
    //@ warning[MO0323] 5-25
    tau*der(T) = goal - T;
    //@ warning[MO0323] 5-27
    tau*der(p) = supply - p;
    //@ warning[MO0323] 5-27
    tau*der(s) = stroke - s;
    //@ warning[MO0323] 5-20
    der(phi) = speed;
    //@ warning[MO0323] 5-33
    tau*der(share) = 1 - sin(phi);
  end Plant;
end Scales;

//@ case scales_that_are_converted
// Literals convert; differences of temperatures are in K; unit-free parameters take what the equations require.
//@ check
package Converted
  model Plant
    parameter Real tau(unit = "s") = 1;
    parameter Real goal(unit = "degC") = 60;
    parameter Real ambient(unit = "degC") = 20;
    parameter Real supply(unit = "bar") = 6;
    parameter Real speed(unit = "rev/min") = 1000;
    parameter Real k = 0.001;
    parameter Real stroke(unit = "mm") = 3;
    parameter Real G(unit = "W/K") = 2;
    Real T(unit = "K", start = 293, fixed = true);
    Real p(unit = "Pa", start = 1e5, fixed = true);
    Real phi(unit = "rad", start = 0, fixed = true);
    Real s(unit = "m") = k*stroke;
    Real Q(unit = "W") = G*(goal - ambient);
    Real warmer(unit = "degC") = goal + (T - T);
    Real E(unit = "kJ") = Q*tau/1000;
  equation
    tau*der(T) = goal + 273.15 - T;
    tau*der(p) = supply*1e5 - p;
    der(phi) = speed*0.10471975511965977;
  end Plant;
end Converted;
//@ expect accepted

//@ case torque_and_energy
//@ check
package Levers
  model Lever
    parameter Real torque(unit = "N.m") = 5;
    parameter Real angle(unit = "rad") = 2;
    Real work(unit = "J") = torque*angle;
    //@ warning[MO0320] 10-15
    Real stored(unit = "J") = torque;
  end Lever;
end Levers;

//@ case units_of_arguments
// Arguments are compared with the inputs of functions, whose units may come from types or from classes that extend them.
//@ check
package Gases
  type Pressure = Real(unit = "Pa");

  partial function property
    input Pressure p;
    input Real T(unit = "K");
    output Real value;
  end property;

  function density
    extends property(value(unit = "kg/m3"));
    input Real R(unit = "J/(kg.K)") = 287;
  algorithm
    value := p/(R*T);
  end density;

  model Vessel
    parameter Real supply(unit = "bar") = 6;
    parameter Pressure p = 6e5;
    parameter Real T(unit = "K") = 293;
    parameter Real warm(unit = "degC") = 20;
    parameter Real v(unit = "m/s") = 3;
    Pressure ports[2] = {p, p/2};
    Real right(unit = "kg/m3") = density(p, T);
    Real converted(unit = "kg/m3") = density(supply*1e5, warm + 273.15);
    Real numbers(unit = "kg/m3") = density(6e5, 293);
    Real each_port[2](each unit = "kg/m3") = density(ports, T);
    //@ warning[MO0328] 34-51
    Real scale(unit = "kg/m3") = density(supply, T);
    //@ warning[MO0328] 33-48
    Real zero(unit = "kg/m3") = density(p, warm);
    //@ warning[MO0328] 34-46
    Real other(unit = "kg/m3") = density(p, v);
    //@ warning[MO0328] 42-56
    Real all[2](each unit = "kg/m3") = 2*density(p*v, T)*{1, 2};
  end Vessel;
end Gases;

//@ case unknown_units
// Each is named once.
//@ check
package Tracks
  model Track
    //@ warning[MO0324] 20-25
    parameter Real length(unit = "furlong") = 8;
    parameter Real other(unit = "furlong") = 4;
    Real sum(unit = "m") = length + other;
  end Track;
end Tracks;

//@ case a_model_without_units
// Time alone gives no variable a unit.
//@ check
package Plain
  model Wave
    Real x(start = 0, fixed = true);
    Real v(start = 1, fixed = true);
  equation
    der(x) = v;
    der(v) = time - x + v;
  end Wave;
end Plain;
//@ expect accepted
