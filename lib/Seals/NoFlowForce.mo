within Seals;
model NoFlowForce "No force of the flowing air"
  extends FlowForce;
equation
  f = 0;
end NoFlowForce;
