within;
package Pneumatics "Air in volumes and restrictions, isothermal"
end Pneumatics;
