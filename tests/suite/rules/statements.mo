//@ case statements_out_of_place
model Statements
  record Data
    Real x;
  end Data;
  model Part
    parameter Real p = 1;
  end Part;
  function scaled
    input Real u;
    output Real y;
  protected
    //@ error[MO0226] 16-19
    input Real gain = 2;
    //@ error[MO1287] 10-13
    Part part;
  algorithm
    //@ error[MO0266] 5
    u := gain*u;
    y := u;
    while y < 1 loop
      y := 2*y;
      if y > 0.5 then
        break;
      end if;
    end while;
    if y > 2 then
      return;
    end if;
    y := y + part.p;
  end scaled;
  function field
    input Data data;
    output Real y;
  algorithm
    //@ error[MO0266] 5-8
    data.x := 1;
    y := data.x;
  end field;
  Real x = scaled(3);
  Real z = field(Data(1));
  discrete Real y(start = 0);
  discrete Real w(start = 0);
algorithm
  when x > 2 then
    //@ error[MO1271] 5-
    when time > 1 then
      y := 1;
    end when;
  end when;
  if x > 3 then
    //@ error[MO0265] 5-9
    break;
  elseif x > 2 then
    //@ error[MO1218] 5-10
    return;
  else
    //@ error[MO1271] 5-
    when time > 2 then
      w := 1;
    end when;
  end if;
end Statements;

//@ case reinit_in_algorithm
model ReinitInAlgorithm
  Real z(start = 0, fixed = true);
equation
  der(z) = 1;
algorithm
  when time > 0.5 then
    if z > 0 then
      //@ error[MO1265] 7-18
      reinit(z, 1);
    end if;
  end when;
end ReinitInAlgorithm;
