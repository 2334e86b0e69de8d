within;
package Signals "Switching signals and what follows them"
end Signals;
