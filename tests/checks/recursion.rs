//! Functions that call themselves as deep as only a run knows.

use super::door::{Case, Reading, assert_close};

/// Simpson's rule by halves, of a function with an argument given: as fine as it must be, which depends on
/// that argument.
pub const INTEGRAL: &str = "package P
  partial function Integrand
    input Real u;
    output Real y;
  end Integrand;
  function byHalves
    input Integrand f;
    input Real a;
    input Real b;
    input Real f_a;
    input Real f_m;
    input Real f_b;
    input Real tolerance;
    output Real integral;
    output Integer calls;
  protected
    Real m = (a + b)/2;
    Real f_l = f((a + m)/2);
    Real f_r = f((m + b)/2);
    Real once = (b - a)/6*(f_a + 4*f_m + f_b);
    Real twice = (b - a)/12*(f_a + 4*f_l + 2*f_m + 4*f_r + f_b);
    Real right;
    Integer more;
  algorithm
    if abs(twice - once) <= 15*tolerance then
      integral := twice + (twice - once)/15;
      calls := 1;
    else
      (integral, calls) := byHalves(f, a, m, f_a, f_l, f_m, tolerance/2);
      (right, more) := byHalves(f, m, b, f_m, f_r, f_b, tolerance/2);
      integral := integral + right;
      calls := calls + more + 1;
    end if;
  end byHalves;
  function integral
    input Integrand f;
    input Real a;
    input Real b;
    input Real tolerance = 1e-10;
    output Real integral = byHalves(f, a, b, f(a), f((a + b)/2), f(b), tolerance);
  end integral;
  function decay
    extends Integrand;
    input Real k;
  algorithm
    y := k*exp(-k*u);
  end decay;
  model Decay
    parameter Real k = 1;
    Real x(start = 1, fixed = true);
    Real y = integral(function decay(k = k + time), 0, 2);
  equation
    der(x) = -integral(function decay(k = k), 0, 2)*x;
  end Decay;
end P;";

#[test]
fn an_integral_is_as_fine_as_it_must_be() {
    let case = Case::text(INTEGRAL).model("P.Decay").stop(3.0).tolerance(1e-8);
    let run = case.compile().differentiate(&["k"]);
    let trajectory = &run.trajectory;
    let rate = 1.0 - (-2.0f64).exp();
    for (row, t) in trajectory.time.iter().enumerate() {
        let k = 1.0 + t;
        assert_close(trajectory.of("y")[row], 1.0 - (-2.0 * k).exp(), 1e-9);
        assert_close(trajectory.of("x")[row], (-rate * t).exp(), 1e-6);
        // The rule is differentiated with the steps that it takes.
        assert!((run.by(0, "y")[row] - 2.0 * (-2.0 * k).exp()).abs() < 1e-7);
        let slope = -2.0 * (-2.0f64).exp() * t * (-rate * t).exp();
        assert!((run.by(0, "x")[row] - slope).abs() < 1e-6);
    }
}
