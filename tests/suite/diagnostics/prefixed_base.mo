// status: 1
// error[MO0227] 9:13
package P
  record Data
    Real x;
  end Data;
  record Given = input Data;
  record Both
    extends Given;
    Real y;
  end Both;
  model Top
    Both both(x = 1, y = 2);
  end Top;
end P;
