// Functions that nothing calls are read all the same; what depends on the sizes of their arguments is left open.
package Uncalled
  function scaled "Misspells its input"
    input Real gain;
    output Real y;
  algorithm
    y := 2*gian;
  end scaled;

  function mixed "Adds a text to a number"
    input Real x;
    output Real y;
  algorithm
    y := x + "one";
  end mixed;

  function third "Right for three elements or more"
    input Real v[:];
    output Real y;
  algorithm
    y := v[3];
  end third;

  model Idle
    Real x = time;
  end Idle;
end Uncalled;
