// status: 1
// error[MO0224] 28:30
// error[MO0224] 29:34
// error[MO0224] 30:30
package Shop
  model Law
    input Real v;
    output Real f = v;
  end Law;
  model Quadratic
    extends Law(f = v*v);
  end Quadratic;
  model Holder
    replaceable model Open = Law;
    model Closed = Law;
    replaceable Law open;
    Law closed;
  end Holder;
  model Locked = Holder(redeclare model Open = Quadratic);
  model Fine
    Holder a(redeclare model Open = Quadratic, redeclare Quadratic open(v = 1), closed(v = 1));
    // The type that it has may be written again.
    Holder b(redeclare Law closed(v = 2), open(v = 1));
  end Fine;
  model Machine
    Fine fine;
    // A class, a component, and a class that an inner redeclaration has closed.
    Holder c(redeclare model Closed = Quadratic, open(v = 1), closed(v = 1));
    Holder d(redeclare Quadratic closed(v = 1), open(v = 1));
    Locked e(redeclare model Open = Law, open(v = 1), closed(v = 1));
  end Machine;
end Shop;
