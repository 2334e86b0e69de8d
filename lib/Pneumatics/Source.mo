within Pneumatics;
model Source "Air supply that holds its pressure"
  parameter Units.AbsolutePressure p "Absolute pressure";
  Port port;
equation
  port.p = p;
end Source;
