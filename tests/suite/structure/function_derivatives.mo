//@ case loop_in_a_constraint
//@ run stop=1
// Between 1 and 2 the function is half of its input, and so is its derivative:
// force = (1 - force)/2.
package Cams
  function cam
    input Real angle;
    output Real lift = angle;
  algorithm
    while lift > 1 loop
      lift := lift/2;
    end while;
  end cam;
  model Follower
    Real angle(start = 1.2, fixed = true), lift;
    Real force;
  equation
    der(angle) = 1 - force;
    der(lift) = force;
    lift = cam(angle);
  end Follower;
end Cams;
//@ expect angle, force = 1.2 + 2/3, 1/3 rel 1e-9

//@ case second_derivative_of_a_loop
//@ run stop=1 tolerance=1e-9
// A mass slides on the curve y = sqrt(s), whose root a loop of Newton's iteration computes, with a
// call of another function in it. The constraint is differentiated twice; the energy stays.
package Slides
  function improved
    input Real x;
    input Real u;
    output Real y = (x + u/x)/2;
  algorithm
    y := max(y, 0);
  end improved;
  function root
    input Real u;
    output Real x = 1;
  protected
    Real before = 0;
    Integer count = 0;
  algorithm
    while abs(x - before) > 1e-13*x and count < 50 loop
      before := x;
      x := improved(x, u);
      count := count + 1;
    end while;
  end root;
  model Slide
    Real s(start = 4, fixed = true), y;
    Real vs(start = 1, fixed = true), vy;
    Real normal;
  equation
    vs = der(s);
    vy = der(y);
    der(vs) = -normal/(2*y);
    der(vy) = normal - 10;
    y = root(s);
  end Slide;
end Slides;
//@ expect each (vs^2 + vy^2)/2 + 10*y = (1 + 0.25^2)/2 + 20 abs 1e-5
//@ expect each y = sqrt(s) abs 1e-8
