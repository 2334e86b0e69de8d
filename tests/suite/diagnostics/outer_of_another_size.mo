// status: 1
// error[MO0267] 5:16
package P
  model Reader
    outer Real p[3];
    Real x = p[2];
  end Reader;
  model Top
    inner Real p[5] = {1, 2, 3, 4, 5};
    Reader reader;
  end Top;
end P;
