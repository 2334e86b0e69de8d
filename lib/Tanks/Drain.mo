within Tanks;
model Drain "Sink for liquid"
  Port port;
equation
  port.h = 0;
end Drain;
