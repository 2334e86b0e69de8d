// status: 1
// error[MO0262] 20:13
// error[MO0227] 22:13
// error[MO0204] 33:11
// error[MO0264] 42:37
// error[MO0264] 43:37
// error[MO0264] 43:95
// error[MO0264] 44:82
// error[MO0209] 45:22
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
  model Whole
    Part part;
    replaceable model Chosen = Exchangeable;
  end Whole;
  model Test
    Part part(gain = 2, offset = 1, gain = 3);
    Whole whole(part.gain = 2, part(gain = 3, offset = 1), part(offset(min = 0)), part.offset(min = 1));
    Whole other(redeclare replaceable model Chosen = Same.Inner, redeclare model Chosen = Twice.Inner);
    Angle phi(unit = "deg") = 1;
    Angle psi(displayUnit = "rad") = 1;
    Extended extended;
    Mixed mixed;
    Twice twice;
  end Test;
end Modified;
