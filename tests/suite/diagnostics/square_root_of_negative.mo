// status: 3
// error[MO0902] 8:3
model Orifice
  Real dp;
  Real q;
equation
  dp = 0.5 - time;
  q = 2*sqrt(dp);
end Orifice;
