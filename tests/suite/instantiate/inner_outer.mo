//@ case missing_inner
// A scalar, an array and a record whose `inner` nobody declares.
model MissingInner
  record Air
    Real p = 1e5;
    Real T = 300;
  end Air;
  model Part
    //@ warning[MO0206] 16-22
    outer Real ambient;
    //@ error[MO0206] 16-21
    outer Real levels[2];
    //@ warning[MO0206] 15-17
    outer Air air;
    //@ warning[MO0206] 29
    outer parameter Integer n;
    Real y = ambient + levels[1] + air.T + n;
  end Part;
  Part part;
end MissingInner;

//@ case outer_not_a_subtype
model Surroundings
  record Air
    Real temperature = 300;
  end Air;
  record Wet
    extends Air;
    Real humidity = 0.5;
  end Wet;
  model Inside
    outer Air air;
    Real t = air.temperature;
    //@ error[MO0202] 18-25
    Real h = air.humidity;
  end Inside;
  model Modified
    //@ error[MO0267] 28-33
    outer parameter Real g = 9.81;
  end Modified;
  model Plain
    outer parameter Real g;
    //@ error[MO0267] 16-19
    outer Real list[2, 2];
    //@ error[MO0267] 15-20
    outer Wet breeze;
  end Plain;
  inner parameter Real g = 9.80665;
  inner Wet air;
  inner Air breeze;
  inner Real list[4] = {1, 2, 3, 4};
  Inside inside;
  Modified modified;
  //@ error[MO0267] 17-20
  Plain plain(g = 10);
end Surroundings;

//@ case outer_of_another_size
package P
  model Reader
    //@ error[MO0267] 16
    outer Real p[3];
    Real x = p[2];
  end Reader;
  model Top
    inner Real p[5] = {1, 2, 3, 4, 5};
    Reader reader;
  end Top;
end P;
