//@ case counted_at_run_time
//@ run stop=1
//@ snapshot flat
// A loop counted at run time becomes a function; a record value replaces the defaults of its class; a
// constructor knows what extends its class; two when-statements of one algorithm.
package Loops
  function root
    input Real square;
    output Real x;
  protected
    Real last;
    Integer turns;
  algorithm
    x := 1 + square;
    last := 0;
    turns := 0;
    while abs(x - last) > 1e-12 and turns < 100 loop
      last := x;
      x := 0.5*(x + square/x);
      turns := turns + 1;
    end while;
  end root;
  record Material
    Real density = 1;
    Real stiffness = 2*density;
  end Material;
  record Steel
    extends Material(density = 7800);
  end Steel;
  model Rod
    parameter Material material;
    Real m = material.stiffness + material.density;
  end Rod;
  model Example
    Real r = root(2 + time);
    Rod rods[2](each material = Steel());
    Rod plain(material(density = 3));
    discrete Real last(start = 0, fixed = true);
  algorithm
    when time > 0.5 then
      last := 1;
    end when;
    when time > 0.2 then
      last := 2;
    end when;
  end Example;
end Loops;
// The loop is in a function, and the model calls it.
//@ expect flat has 2 "while"
//@ expect flat has 1 "end while"
//@ expect flat has 3 "function0_1"
//@ expect r = sqrt(3) abs 1e-12
//@ expect rods[1].m, rods[2].m = 23400
//@ expect plain.m, last = 9, 1
