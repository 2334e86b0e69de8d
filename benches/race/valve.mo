model Valve "A pneumatic valve of five states in plain equations, its stops without events"
  parameter Real p_s = 7e5 "Supply, Pa";
  parameter Real p_0 = 1e5 "Ambient, Pa";
  parameter Real C = 3e-8 "Sonic conductance, m3/(s.Pa)";
  parameter Real rho = 1.185 "Reference density, kg/m3";
  parameter Real RT = 84148.7 "Gas constant times temperature, J/kg";
  parameter Real A = 5e-5 "Piston, m2";
  parameter Real m = 0.02 "Moving mass, kg";
  parameter Real x_max = 3e-3 "Stroke, m";
  Real p1(start = 1e5, fixed = true, nominal = 1e5) "Drive chamber, Pa";
  Real p2(start = 1e5, fixed = true, nominal = 1e5) "Working volume, Pa";
  Real p3(start = 1e5, fixed = true, nominal = 1e5) "Reservoir, Pa";
  Real x(start = 0, fixed = true, nominal = 1e-3) "Position, m";
  Real v(start = 0, fixed = true, nominal = 0.1) "Speed, m/s";
  Real u "Opening of the pilot";
  Real opening "Opening of the main seat";
  Real q1;
  Real q2;
  Real q3;
equation
  u = 0.5 + 0.5*tanh(40*sin(12.566370614359172*time));
  opening = 0.5*(1 + tanh((x - 1e-3)/2e-4));
  q1 = 0.2*C*rho*(u*p_s*tanh((p_s - p1)/2e4) - (1 - u)*p1*tanh((p1 - p_0)/2e4));
  q2 = C*rho*opening*p_s*tanh((p_s - p2)/4e4);
  q3 = 0.5*C*rho*p2*tanh((p2 - p3)/4e4);
  der(p1) = RT/2e-6*q1;
  der(p2) = RT/5e-5*(q2 - q3);
  der(p3) = RT/1e-4*(q3 - 0.1*C*rho*p3*tanh((p3 - p_0)/4e4));
  der(x) = v;
  m*der(v) = A*(p1 - p_0) - 3000*x - 2*v - 4*tanh(v/1e-3)
    - 1e6*(if x > x_max then x - x_max elseif x < 0 then x else 0);
end Valve;
