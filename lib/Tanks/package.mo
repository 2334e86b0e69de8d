within;
package Tanks "Open tanks with a liquid, emptying into one another"
  // Connectors carry the level of the liquid and the volume flow.
end Tanks;
