//@ case random_number_of_a_variable
// A generator that keeps its state returns another number at each call, so continuous equations cannot call it.
package P
  impure function draw
    input Integer id;
    output Real y;
  external "C" y = ModelicaRandom_impureRandom_xorshift1024star(id);
  end draw;

  model Noise
    //@ error[MO0290] 14-20
    Real y = draw(7);
    Real z;
  equation
    //@ error[MO0290] 9-15
    z = draw(7);
  end Noise;
end P;

//@ case falling_table
model Fallen
  class Curve
    extends ExternalObject;
    function constructor
      input Real table[:, 2];
      output Curve curve;
    external "C" curve = ModelicaStandardTables_CombiTable1D_init3("NoName", "NoName", table, size(table, 1), 2, {2}, 1, 1, 1, false, ",", 0);
    end constructor;
    function destructor
      input Curve curve;
    external "C" ModelicaStandardTables_CombiTable1D_close(curve);
    end destructor;
  end Curve;
  //@ error[MO0290] 27-51
  parameter Curve curve = Curve([0, 1; 2, 3; 1, 4]);
  function at
    input Curve curve;
    input Real u;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTable1D_getValue(curve, 1, u);
  end at;
  Real y = at(curve, time);
end Fallen;

//@ case errors_that_a_function_raises
//@ run stop=2
//@ status 3
// An error of the model where it is reached, and not before.
package Errors
  impure function error
    input String text;
    external "C" ModelicaError(text);
  end error;
  model Gauge
    parameter Real limit = 1.5;
    Real p = time;
  equation
    if limit < 1 then
      error("the limit is " + String(limit));
    end if;
  algorithm
    //@ error[MO0912] 5-
    when p > limit then
      error("the pressure is high");
    end when;
  end Gauge;
end Errors;
