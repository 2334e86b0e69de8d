// status: 1
// error[MO0263] 15:12
// error[MO0260] 16:12
package P
  package A
    constant Real k = 1;
  protected
    constant Real hidden = 3;
  end A;
  package B
    constant Real k = 2;
  end B;
  model Top
    import P.A.*;
    import P.B.*;
    import P.A.hidden;
    Real x = k;
    Real y = hidden;
  end Top;
end P;
