within Pneumatics;
model SealOpening "Gap between a seal and its control edge, opened by the stroke"
  //   opening = (1 +- tanh((s - s_ce)/w_t))/2
  extends PartialRestriction;
  parameter Units.Position s_ce           "Stroke at which the seal meets its control edge";
  parameter Units.Length   w_t            "Width of the transition";
  parameter Boolean        opens  = true  "True if it opens towards +s, false if it closes";
  input Units.Position     s              "Stroke";
protected
  Units.Fraction past "Place relative to the edge: -1 well before it, +1 well past it";
equation
  past = tanh((s - s_ce)/w_t);
  opening = if opens then (1 + past)/2 else (1 - past)/2;
end SealOpening;
