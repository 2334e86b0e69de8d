// status: 1
// error[MO0104] 1:1
partial model Law
  Real v;
  Real f;
end Law;
