// status: 1
// error[MO0200] 9:11
model Turns
  function first
    input Real u;
    output Integer k;
  algorithm
    k := 0;
    while k < 10 loop
      k := k + 1;
      if k > u then
        break;
      end if;
    end while;
  end first;
  Real x = first(time);
end Turns;
