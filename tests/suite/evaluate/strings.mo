//@ case of_discrete_values
model Texts
  type Colour = enumeration(red, green, blue);
  Colour colour = if time < 1 then Colour.red else Colour.blue;
  parameter String wanted = "blue";
  parameter String kind = if wanted == "blue" then "cold" else "warm";
  Boolean is_blue = String(colour) == wanted;
  Boolean is_late = String(time > 1.5) == "true";
  Boolean cold = kind == "cold";
  discrete String last(start = "none");
  Boolean changed = last == "second";
equation
  when time > 1.2 then
    last = if is_blue then "second" else "first";
  end when;
end Texts;
//@ run stop=0.5
//@ expect is_blue, cold, changed = 0, 1, 0
//@ run stop=2
//@ expect is_blue, is_late, changed = 1, 1, 1

//@ case concatenated_at_run_time
model Texts
  function list
    input Integer n;
    output String s = "";
  algorithm
    for i in 1:n loop
      s := s + String(i) + ";";
    end for;
  end list;
  type Size = enumeration(small, large);
  discrete Integer n(start = 0, fixed = true);
  parameter Integer p = 4;
  String s = "n = " + String(n);
  String last(start = "none");
  String form = String(n/3.0, significantDigits = 3) + String(n/3.0, format = ".1f");
  Size size = if n > 2 then Size.large else Size.small;
  Boolean is_four = s == "n = " + String(p);
  Boolean before = s < "n = 2" and not s > "n = 2";
  Boolean after = s >= "n = 2" and not s <= "n = 2";
  Boolean listed = list(n) == "1;2;3;4;";
  Boolean formed = form == "1.331.3";
  Boolean padded = String(size, minimumLength = 7, leftJustified = false) == "  large";
  Boolean was_three = last == "n = 3";
  discrete Integer changes(start = 0, fixed = true);
equation
  when sample(0.1, 0.1) then
    n = pre(n) + 1;
    last = pre(s);
  end when;
  when change(s) then
    changes = pre(changes) + 1;
  end when;
end Texts;
//@ run stop=1.05 also=flat
//@ expect each changes = n where n < 10
//@ expect is_four, before, after, listed, formed, padded, was_three at 0.15 = 0, 1, 0, 0, 0, 0, 0
//@ expect is_four, before, after, listed, formed, padded, was_three at 0.25 = 0
//@ expect is_four, before, after, listed, formed, padded, was_three at 0.45 = 1, 0, 1, 1, 1, 1, 1
// "n = 10" is before "n = 2".
//@ expect changes, is_four, before, after, listed, formed, padded, was_three = 10, 0, 1, 0, 0, 0, 1, 0

//@ case flags_of_formats
//@ run also=flat
// Each is what `printf` of C writes.
model Formats
  Integer n(start = 7, fixed = true);
  discrete Real x(start = 3.5, fixed = true);
  Boolean known = String(7, format = "05d") == "00007" and String(3.5, format = "08.3f") == "0003.500"
    and String(7, format = " d") == " 7" and String(2.0, format = "#.0f") == "2." and String(7, format = "5.3d") == "  007"
    and String(7, format = "+d") == "+7" and String(255, format = "x") == "ff" and String(255, format = "#X") == "0XFF"
    and String(8, format = "o") == "10" and String(65, format = "c") == "A" and String(7, format = "u") == "7";
  Boolean later = String(n, format = "05d") == "00007" and String(x, format = "08.3f") == "0003.500"
    and String(n, format = "+.2d") == "+07" and String(n, format = "#x") == "0x7";
equation
  when time > 0.5 then
    n = 8;
    x = -3.5;
  end when;
end Formats;
//@ expect known at start = 1
//@ expect later at start = 1
//@ expect later = 0

//@ case growing_text
// Each of the shorter texts would stay in memory, tens of gigabytes of them.
model Growing
  function longer
    input Integer n;
    output String s = "";
  algorithm
    for i in 1:n loop
      //@ error[MO0331] 12-25
      s := s + "abcdefgh";
    end for;
  end longer;
  parameter String s = longer(120000);
  Real y = time;
end Growing;
