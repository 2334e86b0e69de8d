within Seals;
model NoFlowForce "The air flows through without a force"
  extends FlowForce;
equation
  f = 0;
end NoFlowForce;
