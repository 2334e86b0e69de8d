within;
package Signals "Switching signals, pilot valves and controllers"
end Signals;
