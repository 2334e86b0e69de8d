//@ case squeezing_mechanism
// F. Mazzia, C. Magherini, *Test Set for Initial Value Problem Solvers* (2008), Andrews' squeezing mechanism: seven
// bodies in three loops, of index 3 as it is written; published at the end of 0.03 s.
model SqueezingMechanism "Andrews' squeezing mechanism of the test set for initial value problems, of index 3"
  // Seven bodies in a plane, three closed loops; q holds the angles beta, Theta, gamma, Phi, delta, Omega, epsilon.
  constant Real m[7] = {0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498} "Masses";
  constant Real I[7] = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5} "Inertias";
  constant Real xa = -0.06934, ya = -0.00227, xb = -0.03635, yb = 0.03273, xc = 0.014, yc = 0.072 "Bearings";
  constant Real d = 28e-3, da = 115e-4, e = 2e-2, ea = 1421e-5, rr = 7e-3, ra = 92e-5, ss = 35e-3, sa = 1874e-5;
  constant Real sb = 1043e-5, sc = 18e-3, sd = 2e-2, ta = 2308e-5, tb = 916e-5, u = 4e-2, ua = 1228e-5;
  constant Real ub = 449e-5, zf = 2e-2, zt = 4e-2, fa = 1421e-5;
  constant Real c0 = 4530 "Stiffness of the spring", l0 = 7785e-5 "Its length without force", mom = 33e-3 "Torque of the drive";

  Real q[7](start = {-0.0617138900142764, 0, 0.455279819163070, 0.222668390165886, 0.487364979543843,
      -0.222668390165886, 1.23054744454982}) "Angles";
  Real v[7] = der(q) "Their rates";
  Real lambda[6] "Forces in the loops";
  Real M[7, 7] "Inertia";
  Real G[6, 7] "Slopes of the loops' equations";
  Real f[7] "Torques";
protected
  Real xd, yd, length, F, Fx, Fy;
  Real joint[2] "What the three loops share";
initial equation
  q[2] = 0;
  v[2] = 0;
equation
  M*der(v) = f - transpose(G)*lambda;
  M = [m[1]*ra^2 + m[2]*(rr^2 - 2*da*rr*cos(q[2]) + da^2) + I[1] + I[2], m[2]*(da^2 - da*rr*cos(q[2])) + I[2],
        zeros(1, 5);
      m[2]*(da^2 - da*rr*cos(q[2])) + I[2], m[2]*da^2 + I[2], zeros(1, 5);
      0, 0, m[3]*(sa^2 + sb^2) + I[3], zeros(1, 4);
      0, 0, 0, m[4]*(e - ea)^2 + I[4], m[4]*((e - ea)^2 + zt*(e - ea)*sin(q[4])) + I[4], 0, 0;
      0, 0, 0, m[4]*((e - ea)^2 + zt*(e - ea)*sin(q[4])) + I[4],
        m[4]*(zt^2 + 2*zt*(e - ea)*sin(q[4]) + (e - ea)^2) + m[5]*(ta^2 + tb^2) + I[4] + I[5], 0, 0;
      zeros(1, 5), m[6]*(zf - fa)^2 + I[6], m[6]*((zf - fa)^2 - u*(zf - fa)*sin(q[6])) + I[6];
      zeros(1, 5), m[6]*((zf - fa)^2 - u*(zf - fa)*sin(q[6])) + I[6],
        m[6]*((zf - fa)^2 - 2*u*(zf - fa)*sin(q[6]) + u^2) + m[7]*(ua^2 + ub^2) + I[6] + I[7]];

  xd = sd*cos(q[3]) + sc*sin(q[3]) + xb;
  yd = sd*sin(q[3]) - sc*cos(q[3]) + yb;
  length = sqrt((xd - xc)^2 + (yd - yc)^2);
  F = -c0*(length - l0)/length;
  Fx = F*(xd - xc);
  Fy = F*(yd - yc);
  f = {mom - m[2]*da*rr*v[2]*(v[2] + 2*v[1])*sin(q[2]),
      m[2]*da*rr*v[1]^2*sin(q[2]),
      Fx*(sc*cos(q[3]) - sd*sin(q[3])) + Fy*(sd*cos(q[3]) + sc*sin(q[3])),
      m[4]*zt*(e - ea)*v[5]^2*cos(q[4]),
      -m[4]*zt*(e - ea)*v[4]*(v[4] + 2*v[5])*cos(q[4]),
      -m[6]*u*(zf - fa)*v[7]^2*cos(q[6]),
      m[6]*u*(zf - fa)*v[6]*(v[6] + 2*v[7])*cos(q[6])};

  joint = {rr*cos(q[1]) - d*cos(q[1] + q[2]), rr*sin(q[1]) - d*sin(q[1] + q[2])};
  joint = {ss*sin(q[3]) + xb, -ss*cos(q[3]) + yb};
  joint = {e*sin(q[4] + q[5]) + zt*cos(q[5]) + xa, -e*cos(q[4] + q[5]) + zt*sin(q[5]) + ya};
  joint = {zf*cos(q[6] + q[7]) + u*sin(q[7]) + xa, zf*sin(q[6] + q[7]) - u*cos(q[7]) + ya};
  for k in {1, 3, 5} loop
    G[k, 1:2] = {-rr*sin(q[1]) + d*sin(q[1] + q[2]), d*sin(q[1] + q[2])};
    G[k+1, 1:2] = {rr*cos(q[1]) - d*cos(q[1] + q[2]), -d*cos(q[1] + q[2])};
  end for;
  G[1:2, 3:7] = [-ss*cos(q[3]), zeros(1, 4); -ss*sin(q[3]), zeros(1, 4)];
  G[3:4, 3:7] = [0, -e*cos(q[4] + q[5]), -e*cos(q[4] + q[5]) + zt*sin(q[5]), 0, 0;
      0, -e*sin(q[4] + q[5]), -e*sin(q[4] + q[5]) - zt*cos(q[5]), 0, 0];
  G[5:6, 3:7] = [0, 0, 0, zf*sin(q[6] + q[7]), zf*sin(q[6] + q[7]) - u*cos(q[7]);
      0, 0, 0, -zf*cos(q[6] + q[7]), -zf*cos(q[6] + q[7]) - u*sin(q[7])];
  annotation(experiment(StopTime = 0.03, Tolerance = 1e-8));
end SqueezingMechanism;
//@ expect q[1] = 0.1581077119629904e2 rel 1e-8
//@ expect q[2] = -0.1575637105984298e2 rel 1e-8
//@ expect q[3] = 0.4082224013073101e-1 rel 1e-8
//@ expect q[4] = -0.5347301163226948 rel 1e-8
//@ expect q[5] = 0.5244099658805304 rel 1e-8
//@ expect q[6] = 0.5347301163226948 rel 1e-8
//@ expect q[7] = 0.1048080741042263e1 rel 1e-8

//@ case elastic_beam
//@ run tolerance=1e-7
// F. Mazzia, C. Magherini, *Test Set for Initial Value Problem Solvers* (2008), beam; the problem is (1.10) in
// section IV.1 of Hairer & Wanner II, with 40 elements; published at the end of 5 s.
model Beam "The clamped elastic beam of the test set for initial value problems, 80 states"
  constant Integer n = 40;
  Real theta[n](each start = 0, each fixed = true);
  Real omega[n](each start = 0, each fixed = true);
  Real phi = if time < 3.14159265358979323846 then 1.5*sin(time)^2 else 0;
  Real v[n];
  Real w[n];
  Real u[n];
  Real c[n-1];
  Real d[n-1];
equation
  for l in 1:n loop
    v[l] = n^4*((if l == 1 then -theta[1] else theta[max(l-1,1)]) - 2*theta[l] + theta[min(l+1, n)])
      + n^2*(cos(theta[l])*phi + sin(theta[l])*phi);
  end for;
  for l in 1:n-1 loop
    c[l] = cos(theta[l] - theta[l+1]);
    d[l] = sin(theta[l] - theta[l+1]);
  end for;
  for l in 1:n loop
    w[l] = (if l < n then -d[min(l, n-1)]*v[min(l+1, n)] else 0) + (if l > 1 then d[max(l-1,1)]*v[max(l-1,1)] else 0) + omega[l]^2;
    w[l] = (if l == 1 then 1 elseif l == n then 3 else 2)*u[l]
      - (if l < n then c[min(l,n-1)]*u[min(l+1,n)] else 0) - (if l > 1 then c[max(l-1,1)]*u[max(l-1,1)] else 0);
    der(omega[l]) = (if l == 1 then 1 elseif l == n then 3 else 2)*v[l]
      - (if l < n then c[min(l,n-1)]*v[min(l+1,n)] else 0) - (if l > 1 then c[max(l-1,1)]*v[max(l-1,1)] else 0)
      + (if l < n then -d[min(l, n-1)]*u[min(l+1, n)] else 0) + (if l > 1 then d[max(l-1,1)]*u[max(l-1,1)] else 0);
    der(theta[l]) = omega[l];
  end for;
  annotation(experiment(StopTime = 5, Tolerance = 1e-6));
end Beam;
//@ expect theta[1] = -0.5792366591285007e-2 rel 1e-6
//@ expect theta[2] = -0.1695298550721735e-1 rel 1e-6
//@ expect theta[3] = -0.2769103312973094e-1 rel 1e-6
//@ expect theta[4] = -0.3800815655879158e-1 rel 1e-6
