//@ case components_and_their_connections
model Optional
  parameter Boolean damped = true;
  Translational.Mass mass(m = 1, s_start = 1);
  Translational.Spring spring(c = 4);
  Translational.Damper damper(d = 4) if damped;
  Translational.Fixed wall;
equation
  connect(wall.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange);
  connect(wall.flange, damper.flange_a);
  connect(damper.flange_b, mass.flange);
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Optional;
// Critical damping with 2 rad/s.
//@ run
//@ expect mass.s = 3*exp(-2) rel 1e-7
//@ run set=damped=false
//@ expect mass.s = cos(2) rel 1e-7
//@ expect no column damper.f

//@ case a_conditional_value_of_another_component
// Read from outside, where its condition holds.
package Machines
  model Machine
    parameter Boolean cage = true;
    output Real ir[2] = {3, 4}*time if cage;
  end Machine;
  model Drive
    Machine machine;
    //@ warning[MO0217] 29-30
    //@ warning[MO0217] 47-48
    Real rms = sqrt(machine.ir[1]^2 + machine.ir[2]^2);
  end Drive;
  partial model Base
    parameter Boolean shows = true;
    Real w = 3*time if shows;
  end Base;
  model Both
    extends Base;
    Drive drive;
    //@ warning[MO0217] 20
    Real power = 2*w*drive.rms;
  end Both;
end Machines;
//@ expect drive.rms = 5
//@ expect power = 30
