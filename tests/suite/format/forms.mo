//@ case all_forms
//@ used by format.rs
within ;
// A file that nobody has looked after.
package   Forms   "All forms that lines can take"
 constant Real   c=3;   // a constant
      type   T=Real ( unit="m" );
   /* a comment
      of two lines */
   partial   model Base
  Real x  ;
 end Base;
model M  "It has
a description in two lines"
  extends Base( x( start=1 ,fixed =true ) );
  parameter Real  k     = 1  "Columns";
  parameter Real  longer= 2  "stay";
   replaceable model Law=Base constrainedby   Base;
  Real y [3],z;


  Boolean b;
protected
    Integer n( start=0 );
  initial equation
  n=0;
    equation
  der(x)=- x+k *y[ 1 ]
     +2;
  for i in 1:3 loop
  y[i]=if i<2 then i
  elseif i == 2 then
  1
  else -i;
  end for;
  if b then
  z=1; // one
  else
      z=-1;
  // last words
  end if;
  b = time>0.5 and not ( x<0.2 );
  when b then
  n=pre( n )+1;
  end when;
  annotation(experiment( StopTime=1 ));
end M;
   function f input Real u; output Real v; algorithm v:=u; while v>1 loop v:=v/2; end while; end f;
end Forms;
