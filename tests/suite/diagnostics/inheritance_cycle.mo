// status: 1
// error[MO0205] 6:7
model A
  extends B;
end A;
model B
  extends A;
end B;
