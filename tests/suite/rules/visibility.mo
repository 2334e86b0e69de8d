//@ case protected_access
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
    //@ error[MO0260] 16-19
    Tank other(area = 3);
    //@ error[MO0260] 31-36
    Tank third(redeclare Real volume = 5);
    Hidden hidden;
    Larger larger;
    //@ error[MO0260] 10-13
    Tank.Wall wall;
    //@ error[MO0260] 19-24
    Real a = tank.volume;
    //@ error[MO0260] 21-25
    Real b = hidden.level;
    //@ error[MO0260] 20-25
    //@ error[MO0260] 35-40
    Real c = Tools.closed + Tools.Inside.deep;
    //@ error[MO0202] 21-26
    Real d = open + closed;
  end Plant;
end Access;
