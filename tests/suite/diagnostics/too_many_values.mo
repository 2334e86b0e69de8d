// status: 1
// error[MO0215] 5:34
// error[MO0215] 6:52
model Chain
  Translational.Mass mass[2](m = {1, 2, 3});
  Translational.Mass more[2](each m = 1, s_start = {0, 1, 2});
  Translational.Mass fine[2](m = {1, 2}, s(start = {0, 1}));
end Chain;
