within Effects;
model OtherStart "A state that starts elsewhere than the model says"
  //   x(t_0) = x_0 + d
  // An angle of release that was read from a scale, a level at the beginning: it may be wrong by the same amount in all
  // recordings. The annotation `starts` of an amended model says to which start d is added.
  parameter Real d = 0 "Amount that is added to the start";

  annotation(__mocc(
    effect   = "starts=d; amplitude=d",
    law      = "x_0 + d",
    explains = "%at starts elsewhere than the model says."));
end OtherStart;
