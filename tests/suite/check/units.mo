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
    Real turn(unit = "rad") = angle;
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
