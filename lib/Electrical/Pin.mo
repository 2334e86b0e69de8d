within Electrical;
connector Pin "Electric connection"
  Units.Voltage v "Potential, the same for all connected components";
  flow Units.Current i "Current into the component that owns this pin";
end Pin;
