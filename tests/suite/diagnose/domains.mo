//@ case fan
//@ used by diagnose_domains.rs
connector Shaft "End of a shaft, without units"
  Real phi;
  flow Real tau;
end Shaft;

model Rotor
  parameter Real J = 2e-3;
  Shaft shaft;
  Real w(start = 0, fixed = true);
equation
  w = der(shaft.phi);
  J*der(w) = shaft.tau;
initial equation
  shaft.phi = 0;
end Rotor;

model Armature "Torque of a DC motor at a voltage"
  parameter Real k = 0.08;
  parameter Real R = 0.9;
  input Real u;
  Shaft shaft;
  Real i;
equation
  u = R*i + k*der(shaft.phi);
  shaft.tau = -k*i;
end Armature;

model Bearing
  parameter Real d = 2e-4;
  Shaft shaft;
equation
  shaft.tau = d*der(shaft.phi);
end Bearing;

model Motor
  parameter Real U = 10;
  Rotor    rotor;
  Armature armature(u = if time < 3 then U else 0);
  Bearing  bearing;
equation
  connect(rotor.shaft, armature.shaft);
  connect(rotor.shaft, bearing.shaft);
  annotation(experiment(StopTime = 5, Interval = 0.04));
end Motor;

//@ case fan_truth
//@ used by diagnose_domains.rs
model Blades
  Shaft shaft;
  Real w = der(shaft.phi);
equation
  shaft.tau = 2.4e-5*w*abs(w);
end Blades;

model Truth
  extends Motor;
  Blades blades;
equation
  connect(blades.shaft, rotor.shaft);
end Truth;

//@ case motor_constant_truth
//@ used by diagnose_domains.rs
model Truth "The constant of the motor is not that of the data sheet"
  extends Motor(armature(k = 0.1));
end Truth;

//@ case release
//@ used by diagnose_domains.rs
model Pendulum "Released from rest at an angle that is read from a scale"
  parameter Real phi_0 = 0.5;
  parameter Real g_l = 9.8;
  parameter Real d = 0.1;
  Real phi(unit = "rad", start = phi_0, fixed = true);
  Real w(start = 0, fixed = true);
equation
  der(phi) = w;
  der(w) = -g_l*sin(phi) - d*w;
  annotation(experiment(StopTime = 5, Interval = 0.02));
end Pendulum;

//@ case release_truth
//@ used by diagnose_domains.rs
model Truth "The scale is not where it should be"
  extends Pendulum(phi(start = phi_0 + 0.02));
end Truth;

//@ case stirrer_truth
//@ used by diagnose_domains.rs
model Stirrer "A law between those of a bearing and a fan"
  Shaft shaft;
  Real w = der(shaft.phi);
equation
  shaft.tau = 1.5e-4*w*abs(w)^0.6;
end Stirrer;

model Truth
  extends Motor;
  Stirrer stirrer;
equation
  connect(stirrer.shaft, rotor.shaft);
end Truth;

//@ case smooth_brake_truth
//@ used by diagnose_domains.rs
model Brake "Dry friction as models smooth it"
  Shaft shaft;
equation
  shaft.tau = 0.04*tanh(der(shaft.phi)/5);
end Brake;

model Truth
  extends Motor;
  Brake brake;
equation
  connect(brake.shaft, rotor.shaft);
end Truth;

//@ case rectifier
//@ used by diagnose_domains.rs
connector Pole
  Real potential(unit = "V");
  flow Real current(unit = "A");
end Pole;

partial model Branch
  Pole p;
  Pole n;
  Real v = p.potential - n.potential;
  Real i = p.current;
equation
  p.current + n.current = 0;
end Branch;

model Source
  extends Branch;
  input Real u;
equation
  v = u;
end Source;

model Resistor
  extends Branch;
  parameter Real R = 100;
equation
  v = R*i;
end Resistor;

model Capacitor
  extends Branch(v(start = 0, fixed = true));
  parameter Real C = 1e-3;
equation
  C*der(v) = i;
end Capacitor;

model Ground
  Pole p;
equation
  p.potential = 0;
end Ground;

model Rectifier
  parameter Real U = 10;
  parameter Real f = 5;
  constant Real pi = 3.14159265358979323846;
  Source    source(u = U*sin(2*pi*f*time));
  Resistor  line;
  Capacitor store;
  Resistor  load(R = 1000);
  Ground    ground;
equation
  connect(source.p, line.p);
  connect(line.n, store.p);
  connect(store.p, load.p);
  connect(store.n, ground.p);
  connect(load.n, ground.p);
  connect(source.n, ground.p);
  annotation(experiment(StopTime = 1, Interval = 4e-3));
end Rectifier;

//@ case rectifier_truth
//@ used by diagnose_domains.rs
model Diode "In series with a resistor of 110 Ohm"
  extends Branch;
equation
  i = if v > 0.7 then (v - 0.7)/110 else 0;
end Diode;

model Truth
  extends Rectifier(line(R = 1e12));
  Diode diode;
equation
  connect(diode.p, source.p);
  connect(diode.n, store.p);
end Truth;

//@ case plates
//@ used by diagnose_domains.rs
connector Contact
  Real T(unit = "K");
  flow Real heat(unit = "W");
end Contact;

model Plate
  parameter Real C = 100;
  parameter Real T_0 = 293;
  Contact contact;
  Real T(start = T_0, fixed = true);
equation
  T = contact.T;
  C*der(T) = contact.heat;
end Plate;

model Heater
  Contact contact;
  input Real P;
equation
  contact.heat = -P;
end Heater;

model Bridge
  parameter Real G = 0.8;
  Contact a;
  Contact b;
equation
  a.heat = G*(a.T - b.T);
  a.heat + b.heat = 0;
end Bridge;

model Plates
  parameter Real P   = 30;
  parameter Real T_s = 300;
  Heater heater(P = if time < 300 then P else 0);
  Plate  plate[2](C = {150, 80}, each T_0 = T_s);
  Bridge bridge;
equation
  connect(heater.contact, plate[1].contact);
  connect(plate[1].contact, bridge.a);
  connect(bridge.b, plate[2].contact);
  annotation(experiment(StopTime = 1000, Interval = 4));
end Plates;

//@ case plates_truth
//@ used by diagnose_domains.rs
model Loss
  Contact contact;
equation
  contact.heat = 0.12*(contact.T - 288);
end Loss;

model Truth
  extends Plates;
  Loss loss;
equation
  connect(loss.contact, plate[2].contact);
end Truth;

//@ case holder_truth
//@ used by diagnose_domains.rs
model Truth
  extends Plates;
  Plate  holder(C = 60, T_0 = T_s);
  Bridge grip(G = 0.3);
equation
  connect(plate[1].contact, grip.a);
  connect(grip.b, holder.contact);
end Truth;

//@ case leak
//@ used by diagnose_domains.rs
model Leak "A current to ground"
  parameter Real G(unit = "S") = 0;
  Electrical.Pin p;
equation
  p.i = G*p.v;
  annotation(__mocc(effect = "amplitude=G", explains = "%at has a leak."));
end Leak;

//@ case cooling
//@ used by diagnose_domains.rs
model Cooling "A body that is heated and loses heat, in equations alone"
  parameter Real P = 40;
  parameter Real G = 0.5;
  parameter Real C = 60;
  Real T(start = 290, fixed = true);
equation
  C*der(T) = (if time < 250 then P else 0) - G*(T - 290);
  annotation(experiment(StopTime = 500, Interval = 2));
end Cooling;

//@ case cooling_truth
//@ used by diagnose_domains.rs
model Truth "The conductance grows by 1 % per kelvin"
  parameter Real P = 40;
  Real T(start = 290, fixed = true);
equation
  60*der(T) = (if time < 250 then P else 0) - 0.4*(1 + 0.01*(T - 290))*(T - 290);
  annotation(experiment(StopTime = 500, Interval = 2));
end Truth;

//@ case collector
//@ used by diagnose_domains.rs
model Collector "A solar collector in air whose temperature is an input"
  parameter Real U = 10;
  parameter Real C = 1500;
  input Real sun(start = 0);
  input Real T_air(start = 280);
  Real T(start = 290, fixed = true);
equation
  C*der(T) = sun - U*(T - T_air);
  annotation(experiment(StopTime = 3000, Interval = 10));
end Collector;

//@ case collector_truth
//@ used by diagnose_domains.rs
model Truth "The loss grows with the square of the difference to the air as well"
  parameter Real A = 1000;
  Real sun = A*(1 + sin(time/300))/2;
  Real air = 283 + 12*sin(time/450 + A);
  Real T(start = 290, fixed = true);
equation
  2000*der(T) = sun - 8*(T - air) - 0.05*(T - air)*abs(T - air);
  annotation(experiment(StopTime = 3000, Interval = 10));
end Truth;

//@ case kettle_itself
//@ used by diagnose_domains.rs
model Truth
  extends Kettle;
end Truth;

//@ case sled
//@ used by diagnose_domains.rs
type Drag = enumeration(Linear "proportional to the speed", Quadratic "proportional to its square");
model Sled "A sled on which a drag acts that a parameter selects"
  parameter Drag drag = Drag.Linear;
  parameter Real m = 20;
  parameter Real k = 5;
  parameter Real c = 2;
  parameter Real F = 50;
  Real v(start = 0, fixed = true);
equation
  m*der(v) = (if time < 10 then F else 0) - (if drag == Drag.Linear then k*v else c*v*abs(v));
  annotation(experiment(StopTime = 20, Interval = 0.1));
end Sled;

//@ case sled_truth
//@ used by diagnose_domains.rs
model Truth "The drag is quadratic"
  extends Sled(drag = Drag.Quadratic, c = 0.7);
end Truth;

//@ case sledge
//@ used by diagnose_domains.rs
partial model Brake
  input Real v;
  Real F;
end Brake;
model Viscous
  extends Brake;
  parameter Real k = 5;
equation
  F = k*v;
end Viscous;
model Quadratic
  extends Brake;
  parameter Real c = 2;
equation
  F = c*v*abs(v);
end Quadratic;
model Dry
  extends Brake;
  parameter Real F_c = 5;
equation
  F = F_c*tanh(v/0.1);
end Dry;
model Sledge "A sled whose brake is replaceable"
  replaceable model Law = Viscous constrainedby Brake;
  parameter Real m = 20;
  parameter Real F = 50;
  Real v(start = 0, fixed = true);
  Law brake(v = v);
equation
  m*der(v) = (if time < 10 then F else 0) - brake.F;
  annotation(experiment(StopTime = 20, Interval = 0.1));
end Sledge;
model Sleigh "The same with a replaceable component"
  replaceable Viscous brake constrainedby Brake(v = v);
  parameter Real m = 20;
  parameter Real F = 50;
  Real v(start = 0, fixed = true);
equation
  m*der(v) = (if time < 10 then F else 0) - brake.F;
  annotation(experiment(StopTime = 20, Interval = 0.1));
end Sleigh;

//@ case sledge_truth
//@ used by diagnose_domains.rs
model Truth "The drag is quadratic"
  parameter Real F = 50;
  Real v(start = 0, fixed = true);
equation
  20*der(v) = (if time < 10 then F else 0) - 0.7*v*abs(v);
  annotation(experiment(StopTime = 20, Interval = 0.1));
end Truth;

//@ case oven
//@ used by diagnose_domains.rs
model Oven "An oven whose heating is an input"
  parameter Real G = 0.5;
  parameter Real C = 60;
  input Real P(start = 0);
  Real T(start = 290, fixed = true);
equation
  C*der(T) = P - G*(T - 290);
  annotation(experiment(StopTime = 500, Interval = 2));
end Oven;

//@ case oven_truth
//@ used by diagnose_domains.rs
model Truth "The heating element stores heat of its own for 12 s"
  parameter Real A = 40;
  Real asked = A*(1 + sin(time/20 + time^2/8000))/2;
  Real heat(start = 0.5*A, fixed = true);
  Real T(start = 290, fixed = true);
equation
  12*der(heat) = asked - heat;
  60*der(T) = heat - 0.5*(T - 290);
  annotation(experiment(StopTime = 500, Interval = 2));
end Truth;

//@ case late_truth
//@ used by diagnose_domains.rs
model Truth "The heating acts 7 s after it is asked"
  parameter Real A = 40;
  Real asked = A*(1 + sin(time/20 + time^2/8000))/2;
  Real T(start = 290, fixed = true);
equation
  60*der(T) = delay(asked, 7) - 0.5*(T - 290);
  annotation(experiment(StopTime = 500, Interval = 2));
end Truth;

//@ case amplifier_truth
//@ used by diagnose_domains.rs
model Truth "The amplifier gives no more than 30 W"
  parameter Real A = 40;
  Real asked = A*(1 + sin(time/20 + time^2/8000))/2;
  Real T(start = 290, fixed = true);
equation
  60*der(T) = min(asked, 30) - 0.5*(T - 290);
  annotation(experiment(StopTime = 500, Interval = 2));
end Truth;

//@ case fan_itself
//@ used by diagnose_domains.rs
model Truth
  extends Motor;
end Truth;

//@ case varistor_truth
//@ used by diagnose_domains.rs
model Varistor "A current past the capacitor"
  Pole p;
  Pole n;
  Real v = p.potential - n.potential;
equation
  p.current = 5e-3*(v/3)^5;
  n.current = -p.current;
end Varistor;

model Truth
  extends Rectifier;
  Varistor varistor;
equation
  connect(varistor.p, store.p);
  connect(varistor.n, store.n);
end Truth;

//@ case wheel
//@ used by diagnose_domains.rs
model Wheel "A wheel that is driven, in equations alone"
  parameter Real M = 0.1;
  parameter Real J(unit = "kg.m2") = 2e-3;
  parameter Real d(unit = "N.m.s/rad") = 1e-2;
  Real phi(unit = "rad", start = 0, fixed = true);
  Real w(unit = "rad/s", start = 0, fixed = true);
equation
  der(phi) = w;
  J*der(w) = M - d*w;
  annotation(experiment(StopTime = 2, Interval = 0.01));
end Wheel;

//@ case wheel_truth
//@ used by diagnose_domains.rs
model Truth "The wheel is out of balance"
  parameter Real M = 0.1;
  Real phi(start = 0, fixed = true);
  Real w(start = 0, fixed = true);
equation
  der(phi) = w;
  2.5e-3*der(w) = M - 8e-3*w - 0.05*sin(phi);
  annotation(experiment(StopTime = 2, Interval = 0.01));
end Truth;

//@ case cart
//@ used by diagnose_domains.rs
model Cart "A cart that rolls out, in equations alone and without units"
  parameter Real v_0 = 1;
  parameter Real d = 0.5;
  Real v(start = v_0, fixed = true);
equation
  0 = -der(v) - d*v;
  annotation(experiment(StopTime = 4, Interval = 0.02));
end Cart;

//@ case cart_truth
//@ used by diagnose_domains.rs
model Truth "Air drag instead of a part of the damping"
  parameter Real v_0 = 1;
  Real v(start = v_0, fixed = true);
equation
  der(v) = -0.2*v - 0.3*v*abs(v);
  annotation(experiment(StopTime = 4, Interval = 0.02));
end Truth;

//@ case kettle
//@ used by diagnose_domains.rs
model Kettle "Vessel in a mantle, as equations, without losses"
  parameter Real P = 400;
  parameter Real C_1(unit = "J/K") = 2000 "Mantle";
  parameter Real C_2(unit = "J/K") = 12000 "Vessel";
  parameter Real G(unit = "W/K") = 30;
  Real T_1(unit = "K", start = 295, fixed = true);
  Real T_2(unit = "K", start = 295, fixed = true);
equation
  C_1*der(T_1) = (if time < 600 then P else 0) - G*(T_1 - T_2);
  C_2*der(T_2) = G*(T_1 - T_2);
  annotation(experiment(StopTime = 1500, Interval = 10));
end Kettle;

//@ case kettle_truth
//@ used by diagnose_domains.rs
model Truth "The vessel loses heat to a room at 288 K"
  parameter Real P = 400;
  Real T_1(unit = "K", start = 295, fixed = true);
  Real T_2(unit = "K", start = 295, fixed = true);
equation
  2100*der(T_1) = (if time < 600 then P else 0) - 28*(T_1 - T_2);
  12000*der(T_2) = 28*(T_1 - T_2) - 6*(T_2 - 288);
  annotation(experiment(StopTime = 1500, Interval = 10));
end Truth;

//@ case row
//@ used by diagnose_domains.rs
model Row "Three bodies in a row on a base"
  parameter Real P = 20;
  Thermal.HeatSource heater(Q_flow = if time < 400 then P else 0);
  Thermal.HeatCapacity body_1(C = 200);
  Thermal.HeatCapacity body_2(C = 300);
  Thermal.HeatCapacity body_3(C = 250);
  Thermal.Conductance joint_1(G = 1);
  Thermal.Conductance joint_2(G = 1);
  Thermal.Conductance foot(G = 0.4);
  Thermal.Ambient base(T = 293.15);
equation
  connect(heater.port, body_1.port);
  connect(body_1.port, joint_1.port_a);
  connect(joint_1.port_b, body_2.port);
  connect(body_2.port, joint_2.port_a);
  connect(joint_2.port_b, body_3.port);
  connect(body_3.port, foot.port_a);
  connect(foot.port_b, base.port);
  annotation(experiment(StopTime = 1000, Interval = 5));
end Row;

//@ case row_truth
//@ used by diagnose_domains.rs
model Truth "A strap leads from the first body to the third"
  extends Row;
  Thermal.Conductance strap(G = 0.35);
equation
  connect(body_1.port, strap.port_a);
  connect(strap.port_b, body_3.port);
  annotation(experiment(StopTime = 1000, Interval = 5));
end Truth;

//@ case bath
//@ used by diagnose_domains.rs
model Bath "Heated bath that starts at the temperature of the room"
  parameter Real T_0 = 294;
  parameter Real P = 100;
  parameter Real C(unit = "J/K") = 8000;
  parameter Real G(unit = "W/K") = 5;
  Real T(unit = "K", start = 294, fixed = true);
equation
  C*der(T) = P*(1 + sin(time/200)) - G*(T - 294);
  annotation(experiment(StopTime = 3000, Interval = 30));
end Bath;

//@ case bath_truth
//@ used by diagnose_domains.rs
model Truth "Each recording starts elsewhere"
  extends Bath(C = 8600, G = 4.6, T(start = T_0));
  annotation(experiment(StopTime = 3000, Interval = 30));
end Truth;

//@ case slip_rings
//@ used by diagnose_domains.rs
model Generator
  parameter Real U = 10;
  parameter Real f = 1;
  Electrical.Pin p;
  Electrical.Pin n;
equation
  p.v - n.v = U*sin(6.283185307179586*f*time) + 0.4*U*sin(16.3*f*time);
  p.i + n.i = 0;
end Generator;

model Rig
  parameter Real U = 10;
  parameter Real f = 1;
  Generator generator(U = U, f = f);
  Electrical.Resistor winding(R = 1.5);
  Electrical.Resistor load(R = 5);
  Electrical.Ground ground;
equation
  connect(generator.p, winding.p);
  connect(winding.n, load.p);
  connect(load.n, ground.p);
  connect(generator.n, ground.p);
  annotation(experiment(StopTime = 3, Interval = 0.02));
end Rig;

//@ case slip_rings_truth
//@ used by diagnose_domains.rs
model Ring
  parameter Real V = 0.8;
  Electrical.Pin p;
  Electrical.Pin n;
equation
  p.v - n.v = V*tanh(200*p.i);
  p.i + n.i = 0;
end Ring;

model Truth
  parameter Real U = 10;
  parameter Real f = 1;
  Generator generator(U = U, f = f);
  Electrical.Resistor winding(R = 1.25);
  Electrical.Resistor load(R = 6);
  Electrical.Ground ground;
  Ring ring;
equation
  connect(generator.p, winding.p);
  connect(winding.n, ring.p);
  connect(ring.n, load.p);
  connect(load.n, ground.p);
  connect(generator.n, ground.p);
  annotation(experiment(StopTime = 3, Interval = 0.02));
end Truth;

//@ case coil
//@ used by diagnose_domains.rs
model Coil "A coil at a voltage that is switched"
  parameter Real U = 5;
  parameter Real R = 3;
  parameter Real L = 0.6;
  Real u = if sin(0.02*time) > -0.3 then U else 0.3*U;
  Real i(start = 0, fixed = true);
equation
  L*der(i) = u - R*i;
  annotation(experiment(StopTime = 600, Interval = 2));
end Coil;

//@ case coil_truth
//@ used by diagnose_domains.rs
model Truth "Copper that the current heats: its resistance grows by 0.4 % per kelvin"
  parameter Real U = 5;
  Real u = if sin(0.02*time) > -0.3 then U else 0.3*U;
  Real i(start = 0, fixed = true);
  Real T(start = 0, fixed = true) "Above the surroundings";
  Real R = 3.3*(1 + 0.004*T);
equation
  0.6*der(i) = u - R*i;
  40*der(T) = R*i^2 - 0.5*T;
  annotation(experiment(StopTime = 600, Interval = 2));
end Truth;

//@ case tanks
//@ used by diagnose_domains.rs
model Tanks "Two tanks that empty by themselves"
  parameter Real h_0 = 2;
  parameter Real c = 0.03 "Inflow";
  Real h_1(start = h_0, fixed = true);
  Real h_2(start = 0.1, fixed = true);
equation
  der(h_1) = c - 0.02*h_1;
  der(h_2) = 0.5*c - 0.03*h_2;
  annotation(experiment(StopTime = 80, Interval = 0.5));
end Tanks;

//@ case tanks_truth
//@ used by diagnose_domains.rs
model Truth "A wall that leaks"
  parameter Real h_0 = 2;
  Real leak = 0.01*(h_1 - h_2);
  Real h_1(start = h_0, fixed = true);
  Real h_2(start = 0.1, fixed = true);
equation
  der(h_1) = 0.04 - 0.02*h_1 - leak;
  der(h_2) = 0.02 - 0.03*h_2 + leak;
  annotation(experiment(StopTime = 80, Interval = 0.5));
end Truth;

//@ case cascade
//@ used by diagnose_domains.rs
model Vessel "A vessel with a hole"
  parameter Real A = 1;
  parameter Real k = 0.02;
  parameter Real h_0 = 1;
  input Real q_in;
  Real q;
  Real h(start = h_0, fixed = true);
equation
  q = k*sqrt(h);
  A*der(h) = q_in - q;
end Vessel;

model Cascade
  parameter Real k_1 = 0.02;
  parameter Real k_2 = 0.02;
  parameter Real h_0 = 1;
  parameter Real f = 1;
  Vessel upper(k = k_1, h_0 = h_0, q_in = 0.02*(1 + sin(f*time/30)));
  Vessel lower(k = k_2, h_0 = 0.5*h_0, q_in = upper.q);
  annotation(experiment(StopTime = 300, Interval = 1));
end Cascade;

//@ case cascade_truth
//@ used by diagnose_domains.rs
model Truth "The holes are short pipes"
  parameter Real h_0 = 1;
  parameter Real f = 1;
  Real h_1(start = h_0, fixed = true);
  Real h_2(start = 0.5*h_0, fixed = true);
equation
  der(h_1) = 0.02*(1 + sin(f*time/30)) - 0.022*h_1^0.7;
  der(h_2) = 0.022*h_1^0.7 - 0.018*h_2^0.7;
  annotation(experiment(StopTime = 300, Interval = 1));
end Truth;

//@ case kiln
//@ used by diagnose_domains.rs
model Kiln
  parameter Real tau = 30;
  parameter Real f = 1;
  Real u = 1 + sin(f*time/25);
  Real y(start = 0, fixed = true);
equation
  tau*der(y) = u - y;
  annotation(experiment(StopTime = 400, Interval = 1));
end Kiln;

//@ case kiln_truth
//@ used by diagnose_domains.rs
model Truth "It cools down more slowly"
  parameter Real f = 1;
  Real u = 1 + sin(f*time/25);
  Real y(start = 0, fixed = true);
equation
  (if u > y then 20 else 60)*der(y) = u - y;
  annotation(experiment(StopTime = 400, Interval = 1));
end Truth;

//@ case filter
//@ used by diagnose_domains.rs
model Filter
  parameter Real R = 2;
  parameter Real C = 5;
  input Real q;
  Real p(start = 1, fixed = true);
equation
  C*der(p) = q - p/R;
  annotation(experiment(StopTime = 100, Interval = 0.5));
end Filter;

//@ case filter_truth
//@ used by diagnose_domains.rs
model Truth "The filter is another one in later recordings"
  parameter Real R = 2;
  parameter Real f = 1;
  Real q = 1 + 0.5*sin(f*time/5);
  Real p(start = 1, fixed = true);
equation
  5*der(p) = q - p/R;
  annotation(experiment(StopTime = 100, Interval = 0.5));
end Truth;

//@ case hover
//@ used by diagnose_domains.rs
model Hover "A rotor above the ground, with its controller"
  parameter Real z_1 = 1;
  parameter Real z_2 = 1;
  parameter Real k_T = 1;
  Real z(start = z_1, fixed = true);
  Real v(start = 0, fixed = true);
  Real F(start = 9.81, fixed = true);
equation
  der(z) = v;
  der(v) = k_T*F - 9.81 - 0.2*v;
  0.1*der(F) = 9.81 + 4*((if time < 4 then z_1 else z_2) - z) - 4*v - F;
  annotation(experiment(StopTime = 8, Interval = 0.05));
end Hover;

//@ case hover_truth
//@ used by diagnose_domains.rs
model Truth "The ground helps"
  parameter Real z_1 = 1;
  parameter Real z_2 = 1;
  Real z(start = z_1, fixed = true);
  Real v(start = 0, fixed = true);
  Real F(start = 9.81, fixed = true);
equation
  der(z) = v;
  der(v) = 0.95*(1 + 0.03/z^2)*F - 9.81 - 0.2*v;
  0.1*der(F) = 9.81 + 4*((if time < 4 then z_1 else z_2) - z) - 4*v - F;
  annotation(experiment(StopTime = 8, Interval = 0.05));
end Truth;

//@ case culture
//@ used by diagnose_domains.rs
model Culture "Growth in water whose temperature changes"
  parameter Real T_m = 20;
  parameter Real mu = 0.04;
  Real T = T_m + 10*sin(time/20);
  Real X(start = 0.5, fixed = true);
equation
  der(X) = mu*X*(1 - X/10);
  annotation(experiment(StopTime = 200, Interval = 1));
end Culture;

//@ case culture_truth
//@ used by diagnose_domains.rs
model Truth "It grows best at 25 degrees"
  parameter Real T_m = 20;
  Real T = T_m + 10*sin(time/20);
  Real X(start = 0.5, fixed = true);
equation
  der(X) = 0.06*exp(-((T - 25)/8)^2)*X*(1 - X/10);
  annotation(experiment(StopTime = 200, Interval = 1));
end Truth;

//@ case elimination
//@ used by diagnose_domains.rs
model Elimination "A substance that is given and leaves"
  parameter Real dose = 20;
  parameter Real k = 0.1;
  Real C(start = 0, fixed = true);
equation
  der(C) = (if time < 2 then dose/2 else 0) - k*C;
  annotation(experiment(StopTime = 30, Interval = 0.1));
end Elimination;

//@ case elimination_truth
//@ used by diagnose_domains.rs
model Truth "An enzyme helps"
  parameter Real dose = 20;
  Real C(start = 0, fixed = true);
equation
  der(C) = (if time < 2 then dose/2 else 0) - 0.1*C - 1.6*C/(1.5 + C);
  annotation(experiment(StopTime = 30, Interval = 0.1));
end Truth;

//@ case slide
//@ used by diagnose_domains.rs
model Slide "A body between stops that a force pushes against a spring"
  parameter Real F = 40;
  parameter Real m = 0.5;
  parameter Real d = 20;
  parameter Real c = 800;
  Translational.StopMass      body(m = m, s_max = 0.02);
  Translational.HousingSpring spring(c = c, f_0 = 5);
  Translational.Force         drive(f = if time < 0.6 then F*min(time/0.3, 1) else 0);
  Translational.Damper        damper(d = d);
  Translational.Fixed         wall;
equation
  connect(drive.flange, body.flange);
  connect(spring.flange, body.flange);
  connect(wall.flange, damper.flange_a);
  connect(damper.flange_b, body.flange);
  annotation(experiment(StopTime = 1, Interval = 0.002));
end Slide;

//@ case slide_truth
//@ used by diagnose_domains.rs
model NarrowPlace
  parameter Real F = 30;
  parameter Real s_0 = 0.009;
  parameter Real w = 0.6e-3;
  Translational.SpoolFlange spool;
equation
  spool.f_slide = -F*exp(-((spool.s - s_0)/w)^2);
  spool.f_static = -F*exp(-((spool.s - s_0)/w)^2);
  spool.f_push = 0;
end NarrowPlace;

model Truth "The body is held at a narrow place"
  extends Slide;
  NarrowPlace place;
equation
  connect(place.spool, body.seals);
  annotation(experiment(StopTime = 1, Interval = 0.002));
end Truth;
