// status: 1
// error[MO0208] 8:3
partial model Law
  Real v;
  Real f;
end Law;
model Use
  Law law;
end Use;
