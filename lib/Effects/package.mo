within;
package Effects "Physical effects that a model may lack, each ready to be attached to what is there"
  // An effect is an ordinary component. It is connected to connectors that exist already, and nothing is taken away.
  // With its amplitudes at 0, the values in the text, it changes nothing, and the model stays regular; what it adds
  // is linear in its amplitudes. So the derivative of a run by an amplitude at 0 says how much the effect could
  // explain, at the cost of one run, before any fit.
  //
  // The annotation __mocc(effect = "...", explains = "...") says how a class is used; entries are separated by `;`:
  //   amplitude=F           parameters that are 0 without the effect, separated by commas; `F>0` if only positive values
  //                         have a physical meaning; an amplitude that is an array has one amplitude per element
  //   w=0.1e-3,0.2e-3       a parameter of its shape, and values to start from
  //   s_0=s(15)             the same: 15 values spread evenly over the range of the effect's variable s in the base run
  //   s_lo=min(s)           the same: the least (max: the greatest) value of the effect's variable s in the base run
  //   w=0.02*span(u)        the same: a multiple of max(u) - min(u)
  //   host=port_a,port_b    attached to one component that has connectors of these names and classes, each to its
  //                         namesake; otherwise to every connection set of a flange's class, to every pair of ports
  //                         that a component with two ports bridges, and from every volume to ambient
  //   bind V=V|gap.V        an input of the effect, and the variable of the host it is bound to: the first that exists.
  //                         An input without such an entry is bound to the host's variable of the same name
  //   with has_line=true    for a class that has the effect built in, a setting that makes it part of the model
  // A block Sensor... has no connector: it stands between what is measured, u, and what was recorded, y.
  // `explains` says it in a sentence; %at stands for the place.
  //
  // An entry `unknown` in place of `effect` marks a question rather than an effect: an inflow that is free over time,
  // from t_lo to t_hi. Where it would explain most of what a model leaves, there something is missing.
  //
  // An effect sees positions from min(s) to max(s) of a run; `side` chooses an end: +1 the upper, -1 the lower.
end Effects;
