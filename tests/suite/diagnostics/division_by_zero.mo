// status: 3
// error[MO0902] 8:3
model Lever
  Real arm;
  Real force;
equation
  arm = 1 - time;
  force =
    10/arm;
end Lever;
