// status: 1
// error[MO0226] 21:16
// error[MO0226] 22:10
// error[MO0266] 24:5
// error[MO0266] 41:5
// error[MO0231] 50:5
// error[MO0265] 55:5
// error[MO0265] 57:5
// error[MO0231] 59:5
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
    input Real gain = 2;
    Part part;
  algorithm
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
    data.x := 1;
    y := data.x;
  end field;
  Real x = scaled(3);
  Real z = field(Data(1));
  discrete Real y(start = 0);
  discrete Real w(start = 0);
algorithm
  when x > 2 then
    when time > 1 then
      y := 1;
    end when;
  end when;
  if x > 3 then
    break;
  elseif x > 2 then
    return;
  else
    when time > 2 then
      w := 1;
    end when;
  end if;
end Statements;
