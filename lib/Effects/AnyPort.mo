within Effects;
connector AnyPort "Connection of any kind"
  // Effects with this connector are attached to connectors with one potential and one flow of which no other package of
  // the library knows: hydraulic, magnetic, chemical ones, or those of a model's own. Neither has a unit here.
  Real e "Potential: pressure, level, concentration, ...";
  flow Real f "Flow into the component that owns this connector";
end AnyPort;
