within;
package Effects "Physical effects that a model may lack"
  // An effect is an ordinary component. It is connected to existing connectors and removes nothing. With its
  // amplitudes at 0, their default, it changes nothing and the model stays regular; its contribution is linear in its
  // amplitudes. So the derivative of a run with respect to an amplitude at 0 shows, at the cost of one run and before
  // any fit, how much the effect could explain.
  //
  // The annotation __mocc(effect = "...", explains = "...") describes how a class is used, with these entries,
  // separated by `;`:
  //   amplitude=F           parameters that are 0 without the effect, separated by commas; `F>0` if only positive values
  //                         have a physical meaning; an array has one amplitude per element
  //   w=0.1e-3,0.2e-3       a shape parameter, with values to start from
  //   s_0=s(15)             the same: 15 values, evenly spaced over the range of the effect's variable s in the base run
  //   s_lo=min(s)           the same: the least (max: the greatest) value of the effect's variable s in the base run
  //   w=0.02*span(u)        the same: a multiple of max(u) - min(u); if it is 0, the effect is not tried
  //   r=2*span(u)/span(t)   the same: a multiple of the range of u per range of t
  //   V=0.1*max(v)          the same: a multiple of the greatest value
  //   x_s=between(x)        the same: halfway between the Integers that x takes; it is not fitted
  //   u_0=zero(u)           of a sensor: the zero of the unit of its column; if that is the zero of u, the effect is not tried
  //   host=port_a,port_b    attach to one component that has connectors of these names and classes, each to its namesake;
  //                         without it, an effect with one connector is attached to every connection set of such
  //                         connectors, and one with two to every pair that a component bridges, between every volume
  //                         or body and its surroundings, and between every point of a circuit and ground
  //   bind V=V|gap.V        bind an input of the effect to a variable of the host: the first that exists. An input without
  //                         this entry is bound to the host's variable of the same name
  //   with has_line=true    a class that has the effect built in: the override that makes it part of the model
  //   varies=factor         parameters of the model are multiplied by this variable of the effect, whose first input is
  //                         bound to each variable that they may vary with, of its unit if it has one
  //   of=rate               the first input of such an effect is bound to the rate of each state instead
  //   of=recording          it is bound to the number of the recording alone
  //   follows=line          such an effect is tried for the two parameters only that a law without this entry suits best
  //   series=true           the effect and its host together are another law of the host: a sensor of the host's flow reads
  //                         what flows through both
  //   simpler=CLASS,...     laws that it becomes at a limit of its parameters: one of them takes its place where it
  //                         explains as much
  //   between=moving        of an effect with two connectors: neither of them is attached to a point that is fixed in space
  //   adds=term             this variable of the effect is added to an equation of the model that determines the rate of a
  //                         state or a measured variable. The inputs of the effect are bound to variables of the model of
  //                         their units; an input without a unit, to any
  //   of=state              the input is bound to that state only; of a measured variable, to any
  //   of=speed              the same, if it has the unit of a speed or none
  //   of=term               the input is bound to each term that the equation has
  //   pairs=ordered         of a term of two inputs: exchanged, they make another term
  //   acts=y                equations of the model read this variable of the effect in place of a signal, to which the
  //                         first input of the effect is bound: an input of the model, an output of a component, or a
  //                         variable that an equation of the model is solved for
  //   order=first           of several such effects on one input, this one reads the recording itself; it acts on no
  //                         other signal
  // Without `host`, connectors of a model may be of another class, its own or that of a library, if they mean the same:
  // one potential and one flow with the units of the effect's connector, or where none are declared, with its names. The
  // model is then extended by an adapter.
  //
  // A block Sensor... has no connector: it converts the simulated value u to the reading y. A further input is bound to each
  // other quantity that is known during a run: what other sensors measure, and inputs that are recorded.
  // `explains` is the sentence that a diagnosis reports; %at is the location and %over the variable that a parameter
  // varies with or a term depends on. `law` is the effect's formula.
  //
  // An entry `formula` of a free curve tells how a short formula takes its place where the recordings support one:
  //   extends=PartialLeak   the class of the same package that the law extends
  //   knots=Q               the amplitudes that are the values of the curve
  //   count=n               the parameter that is their number: a curve that leaves something gets more of them
  //   over=dp               the variable of that class that it depends on
  //   from=v_lo; to=v_hi    the parameters that are its first and its last knot; without `from`, the curve begins at 0
  //   zero=true             the curve passes through 0 at 0, and its first knot is at least one n-th of the last
  //   anchored=true         the curve is 0 at its first knot, which has no amplitude of its own
  //   equation=i = F(v)     an equation of the law, with F for the formula; one entry for each equation
  //
  // An entry `choice` describes another law that a class has built in: the overrides that select it (`with`), its own
  // parameters with values to start from, and by `named` what it is called. `chosen` is its formula.
  //
  // An entry `unknown` instead of `effect` marks a question rather than an effect: an inflow that is free over time,
  // from t_lo to t_hi. Where it would explain most of the residual, the balance does not close.
  //   inflow=f              the variable that enters the balance; effects with a variable of this name contribute it
  //   over=s,v              variables over which the inflow is drawn and compared with the contributions of effects
  //
  // A class whose annotation cannot be read, or that cannot be compiled by itself, is skipped with a warning (MO1019).
  //
  // An effect sees positions from min(s) to max(s) of a run; `side` selects an end: +1 the upper, -1 the lower.
end Effects;
