// status: 1
// error[MO0242] 9:13
// error[MO0242] 9:22
model M
  expandable connector Bus
  end Bus;
  Bus a, b;
equation
  connect(a.speed, b.speed);
end M;
