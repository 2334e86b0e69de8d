within;
package Friction "Exchangeable friction laws of a seal"
end Friction;
