// status: 1
// error[MO0104] -
// args: --model Tanks.Larg
package Tanks
  model Large
    Real x = 1;
  end Large;
end Tanks;
