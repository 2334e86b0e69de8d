// status: 1
// error[MO0225] 18:38
// error[MO0224] 21:29
// error[MO0225] 26:22
package P
  model Small
    Real x = 1;
  end Small;
  model Large
    extends Small;
    Real y = 2;
  end Large;
  model Holder
    replaceable Large part constrainedby Large;
    replaceable constant Real k = 1;
  end Holder;
  model Wider
    extends Holder(replaceable Large part constrainedby Small);
  end Wider;
  model Changed
    Holder h(redeclare Real k = 2);
  end Changed;
  type Row = Real[3];
  type Matrix = Real[2, 3];
  model Rows
    replaceable type T = Row[2] constrainedby Matrix;
    T x = {{1, 2, 3}, {4, 5, 6}};
  end Rows;
  model Top
    Wider w;
    Changed c;
    Rows r;
  end Top;
end P;
