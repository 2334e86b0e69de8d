// status: 1
// error[MO0317] 4:12
model Late
  Real x = delay(time, 0.1 + 0.01*time, 1);
end Late;
