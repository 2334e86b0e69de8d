// status: 1
// error[MO0226] 7:9
// error[MO0226] 10:8
// error[MO0226] 11:8
// error[MO0226] 12:8
model NamesOfPredefinedTypes
  model ExternalObject
    Real x = 1;
  end ExternalObject;
  type Integer = Real;
  Real StateSelect = 1;
  Real Boolean = 2;
  ExternalObject x;
end NamesOfPredefinedTypes;
