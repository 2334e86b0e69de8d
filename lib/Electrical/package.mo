within;
package Electrical "Electric circuits: sources, resistors, capacitors, inductors, motors"
  // A positive current flows into the component that owns the pin. Each circuit needs a Ground.
end Electrical;
