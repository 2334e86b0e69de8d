// status: 1
// error[MO0262] 17:13
// error[MO0227] 19:13
// error[MO0204] 30:11
// error[MO0264] 35:37
// error[MO0209] 36:22
package Modified
  type Angle = Real(final unit = "rad", displayUnit = "deg");
  model Part
    parameter Real gain = 1;
    parameter Real offset = 0;
  end Part;
  replaceable model Exchangeable
    Real x = 1;
  end Exchangeable;
  model Extended
    extends Exchangeable;
  end Extended;
  connector Mixed
    extends Real;
    Real more = 1;
  end Mixed;
  model Same
    model Inner
      Real x = 1;
    end Inner;
  end Same;
  model Twice
    extends Same;
    model Inner
      Real x = 2;
    end Inner;
  end Twice;
  model Test
    Part part(gain = 2, offset = 1, gain = 3);
    Angle phi(unit = "deg") = 1;
    Angle psi(displayUnit = "rad") = 1;
    Extended extended;
    Mixed mixed;
    Twice twice;
  end Test;
end Modified;
