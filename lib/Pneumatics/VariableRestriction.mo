within Pneumatics;
model VariableRestriction "Restriction with a variable opening"
  //   m_flow = iso6358(p_a, p_b, C x, b)
  // See iso6358.
  extends PartialRestriction;
  input Units.Fraction x "Opening, 0 closed to 1 fully open";
equation
  opening = x;

  annotation(__mocc(
    effect   = "amplitude=blocked",
    law      = "m_flow = iso6358(p_a, p_b, C x, b)",
    explains = "The conductance of %at differs from the data sheet: dirt, or another restriction in series."));
end VariableRestriction;
