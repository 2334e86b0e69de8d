// status: 1
// error[MO0200] 4:12
model Stream
  Real x = delay(time, 0.1);
end Stream;
