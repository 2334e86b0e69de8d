within;
package Friction "Exchangeable friction laws of a seal"

  type Kind = enumeration(
    Frictionless          "none",
    Coulomb               "independent of speed, pressure and time",
    Stribeck              "equation 1 of the spool valve paper",
    StribeckDwell         "grows with time without operation",
    StribeckDwellPressure "grows with time without operation and with pressure",
    LuGre                 "elastic bristles, constant parameters",
    LuGreDwellPressure    "elastic bristles, grows with time without operation and with pressure",
    Dahl                  "elastic bristles without Stribeck force",
    TanhRegularised       "smoothed at v = 0")
    "Friction law of a seal, where a parameter selects it (Friction.Chosen)";
end Friction;
