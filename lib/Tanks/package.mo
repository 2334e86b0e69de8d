within;
package Tanks "Open tanks with a liquid, emptying into one another"
  // What connects them is the level of the liquid, and the volume that flows.
end Tanks;
