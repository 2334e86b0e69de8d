within Effects;
model Cogging "Torque that repeats itself over the turn"
  //   tau = M_s sin(N phi) + M_c cos(N phi)
  // Magnets that prefer the teeth of the stator, an eccentric weight (N = 1), or the meshing of teeth.
  extends PartialTorque;
  parameter Units.Torque M_s = 0 "Amplitude of the sine";
  parameter Units.Torque M_c = 0 "Amplitude of the cosine";
  parameter Real         N   = 1 "Periods per turn";
equation
  tau = M_s*sin(N*phi) + M_c*cos(N*phi);

  annotation(__mocc(
    effect   = "amplitude=M_s,M_c; N=1,2,3,4,5,6,7,8,9,10,12,14,15,16,18,20,22,24,28,30,36,42,48",
    law      = "tau = M_s sin(N phi) + M_c cos(N phi)",
    explains = "A torque that repeats itself over the turn acts on %at."));
end Cogging;
