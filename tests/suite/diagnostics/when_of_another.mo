// status: 1
// error[MO0231] 15:5
// error[MO0231] 16:5
model Foreign
  model Counter
    discrete Real count(start = 0);
  end Counter;
  block Display
    input Real shown;
  end Display;
  Counter counter;
  Display display;
equation
  when sample(0, 1) then
    counter.count = pre(counter.count) + 1;
    display.shown = time;
  end when;
end Foreign;
