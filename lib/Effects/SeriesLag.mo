within Effects;
model SeriesLag "Resistance in series with a capacitor, inductance in series with a resistor"
  //   i = y - i_host,   tau dy/dt = i_host - y
  // i_host is the current of the component alone; with this one, y flows through both. A capacitor C has the resistance
  // tau/C in series then, a resistor R the inductance tau R. With T = sqrt(tau^2 + tau_min^2), where tau_min is short compared
  // with everything, the equations are regular at tau = 0.
  extends PartialBranch;
  input Units.Current i_host "Current of the component alone";
  parameter Units.Time tau     = 0    "Time constant";
  parameter Units.Time tau_min = 1e-6 "Time that is short compared with all changes";

  Units.Time    t = time                   "Time";
  Units.Time    T = sqrt(tau^2 + tau_min^2) "Time constant of y";
  Units.Current y                          "i_host, with a lag";
initial equation
  y = i_host;
equation
  T*der(y) = i_host - y;
  i = -tau*(i_host - y)/T;

  annotation(__mocc(
    effect   = "series=true; amplitude=tau>0; tau_min=1e-5*span(t); bind i_host=i",
    law      = "i = y - i_host, tau dy/dt = i_host - y",
    explains = "The current through %at follows late: a resistance in series with a capacitor, an inductance with a resistor."));
end SeriesLag;
