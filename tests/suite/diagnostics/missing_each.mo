// status: 1
// error[MO0215] 7:34
// error[MO0215] 8:40
// error[MO0215] 8:40
// error[MO0215] 8:40
model Chain
  Translational.Mass mass[3](m = {1, 2});
  Translational.Mass more[3](s_start = 1);
end Chain;
