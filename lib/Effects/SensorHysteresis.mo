within Effects;
block SensorHysteresis "Sensor that reads too little on the way up and too much on the way down"
  // y = u - h z, w dz/dt = du/dt - |du/dt| z: after a way long against w, z is +1 upwards and -1 downwards, so up and
  // down are 2 h apart. Duhem's form of hysteresis, with the slope of Dahl's friction. u must be continuous.
  parameter Real h = 0 "Half the distance of the two branches, in the unit of u";
  parameter Real w = 1 "Way in which 63 % of the branch are reached, in the unit of u";

  input Real  u "What is measured, in any unit";
  output Real y "What the sensor says, in the same unit";
  Units.Fraction z(start = 0, fixed = true) "Place between the branches, -1 to 1";
equation
  w*der(z) = der(u) - noEvent(abs(der(u)))*z;
  y = u - h*z;

  annotation(__mocc(
    effect   = "amplitude=h>0; w=0.02*span(u),0.1*span(u)",
    explains = "The sensor of %at has hysteresis."));
end SensorHysteresis;
