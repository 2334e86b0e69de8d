// status: 1
// error[MO0290] 16:27
model Fallen
  class Curve
    extends ExternalObject;
    function constructor
      input Real table[:, 2];
      output Curve curve;
    external "C" curve = ModelicaStandardTables_CombiTable1D_init3("NoName", "NoName", table, size(table, 1), 2, {2}, 1, 1, 1, false, ",", 0);
    end constructor;
    function destructor
      input Curve curve;
    external "C" ModelicaStandardTables_CombiTable1D_close(curve);
    end destructor;
  end Curve;
  parameter Curve curve = Curve([0, 1; 2, 3; 1, 4]);
  function at
    input Curve curve;
    input Real u;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTable1D_getValue(curve, 1, u);
  end at;
  Real y = at(curve, time);
end Fallen;
