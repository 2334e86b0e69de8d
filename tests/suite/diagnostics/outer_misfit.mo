// status: 1
// error[MO0202] 18:18
// error[MO0267] 21:28
// error[MO0267] 25:16
// error[MO0267] 26:15
// error[MO0267] 34:17
model Surroundings
  record Air
    Real temperature = 300;
  end Air;
  record Wet
    extends Air;
    Real humidity = 0.5;
  end Wet;
  model Inside
    outer Air air;
    Real t = air.temperature;
    Real h = air.humidity;
  end Inside;
  model Modified
    outer parameter Real g = 9.81;
  end Modified;
  model Plain
    outer parameter Real g;
    outer Real list[2, 2];
    outer Wet breeze;
  end Plain;
  inner parameter Real g = 9.80665;
  inner Wet air;
  inner Air breeze;
  inner Real list[4] = {1, 2, 3, 4};
  Inside inside;
  Modified modified;
  Plain plain(g = 10);
end Surroundings;
