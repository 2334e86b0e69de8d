// status: 1
// error[MO0260] 44:16
// error[MO0260] 45:31
// error[MO0260] 48:10
// error[MO0260] 49:19
// error[MO0260] 50:21
// error[MO0260] 51:20
// error[MO0260] 51:35
// error[MO0202] 52:21
package Access
  package Tools
    constant Real open = 1;
  protected
    constant Real closed = 2;
    package Inside
      constant Real deep = 3;
    end Inside;
  end Tools;

  model Tank
    Real level = 1;
  protected
    parameter Real area = 2;
    model Wall
      Real thickness = 0.1;
    end Wall;
    replaceable Real volume = area*level;
  end Tank;

  model Hidden
  protected
    extends Tank;
  end Hidden;

  model Larger
    // In a class that extends it, all of it is known.
    extends Tank(area = 4);
    Real doubled = 2*volume;
  end Larger;

  model Plant
    import Access.Tools.*;
    Tank tank;
    Tank other(area = 3);
    Tank third(redeclare Real volume = 5);
    Hidden hidden;
    Larger larger;
    Tank.Wall wall;
    Real a = tank.volume;
    Real b = hidden.level;
    Real c = Tools.closed + Tools.Inside.deep;
    Real d = open + closed;
  end Plant;
end Access;
