// status: 1
// error[MO0203] 11:16
// error[MO0203] 11:41
model Car
  model Base
    replaceable model Engine
      Real x = 1;
    end Engine;
    Engine part;
  end Base;
  extends Base(foo = 3, redeclare model Engin = Other);
  model Other
    Real x = 2;
  end Other;
end Car;
