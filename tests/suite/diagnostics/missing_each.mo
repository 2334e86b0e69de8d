// status: 1
// error[MO0215] 5:34
// error[MO0215] 6:40
model Chain
  Translational.Mass mass[3](m = {1, 2});
  Translational.Mass more[3](s_start = 1);
end Chain;
