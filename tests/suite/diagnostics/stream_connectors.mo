// status: 1
// error[MO0245] 5:13
// error[MO0245] 8:13
package Streams
  connector Lone
    stream Real h;
  end Lone;
  connector Double
    Real p[2];
    flow Real m[2];
    stream Real h;
  end Double;
  model Plant
    Lone lone(h = 1);
    Double double(p = {1, 2}, h = 3);
  end Plant;
end Streams;
