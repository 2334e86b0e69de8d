// status: 2
// error[MO0212] --set:1:16
// error[MO0202] --set:1:21
// args: --set closed=5 --set kind=Kind.Steel
model Body
  type Kind = enumeration(Oak, Ash);
  parameter Boolean closed = true;
  parameter Kind kind = Kind.Oak;
  Real v(start = 1);
equation
  der(v) = if closed and kind == Kind.Oak then -v else v;
end Body;
