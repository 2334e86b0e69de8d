// status: 1
// error[MO0226] 4:15
model Outside
  stream Real x = 1;
end Outside;
