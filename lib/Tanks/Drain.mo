within Tanks;
model Drain "Where liquid is lost"
  Port port;
equation
  port.h = 0;
end Drain;
