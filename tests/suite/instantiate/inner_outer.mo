//@ case missing_inner
// A scalar, an array and a record whose `inner` nobody declares.
model MissingInner
  record Air
    Real p = 1e5;
    Real T = 300;
  end Air;
  model Part
    //@ warning[MO0295] 16-22
    outer Real ambient;
    //@ error[MO0206] 16-21
    outer Real levels[2];
    //@ warning[MO0295] 15-17
    outer Air air;
    //@ warning[MO0295] 29
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
    //@ error[MO0283] 18-25
    Real h = air.humidity;
  end Inside;
  model Modified
    //@ error[MO1219] 28-33
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
  //@ error[MO1219] 17-20
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

//@ case modified_inner
// Records, `inner` and `outer`, and constants of packages.
package P
  constant Real g = 9.81;
  record Point
    Real x;
    Real y;
  end Point;
  model World
    parameter Real scale = 2;
  end World;
  model Part
    outer World world;
    Real weight = world.scale*g;
  end Part;
  model Top
    inner World world(scale = 3);
    Part part[2];
    Point p = Point(time, 2*time);
    Real r = p.x + p.y;
  end Top;
end P;
//@ expect part[2].weight = 29.43 rel 1e-15
//@ expect r = 3 rel 1e-15

//@ case inner_outer_component
// The gain of each level is that of the level above times its own.
package P
  model Leaf
    outer Real gain;
    Real y = gain;
  end Leaf;
  model Level
    parameter Real own = 3;
    inner outer Real gain = own*gain;
    Leaf leaf;
    Real seen = gain;
  end Level;
  model Top
    inner Real gain = 5;
    Level level;
    Leaf leaf;
  end Top;
end P;
//@ expect level.leaf.y, level.seen, leaf.y = 15, 5, 5

//@ case automatic_inner
package P
  model World
    parameter Real g = 9.81;
    Real weight = 2*g;
  end World;
  model Body
    //@ warning[MO0295] 17-21
    outer World world;
    Real f = world.weight;
  end Body;
  model Top
    Body one;
    Body two;
  end Top;
end P;
//@ expect one.f, two.f, world.weight = 2*9.81

//@ case outer_constant_of_a_package
model Top
  model Part
    package Data
      outer constant Integer n;
    end Data;
    Integer y = 2*Data.n;
  end Part;
  inner constant Integer n = 21;
  Part part;
end Top;
//@ expect part.y = 42
