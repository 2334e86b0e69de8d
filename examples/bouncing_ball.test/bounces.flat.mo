model BouncingBall "Ball bouncing on the floor"
  parameter Real g(unit = "m/s2") = 9.81 "Gravity";
  parameter Real h_0(unit = "m") = 1.0 "Height of the drop";
  parameter Real e(unit = "1") = 0.8 "Speed after an impact over speed before";
  Real h(unit = "m", start = h_0, fixed = true) "Height";
  Real v(unit = "m/s", start = 0.0, fixed = true) "Speed, upwards";
  Integer impacts(start = 0, fixed = true) "Number of impacts so far";
equation
  der(h) = v;
  der(v) = -g;
  when h <= 0.0 then
    reinit(v, -e * v);
    impacts = pre(impacts) + 1;
  end when;
  annotation(experiment(StartTime = 0.0, StopTime = 3.0, Interval = 0.01, Tolerance = 1e-8));
end BouncingBall;
