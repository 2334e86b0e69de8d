//@ case values_at_run_time
//@ used by native.rs
model Printing
  function print
    input String string;
    input String fileName = "";
  external "C" ModelicaInternal_print(string, fileName);
  end print;
  Real x(start = 0, fixed = true);
  Integer n(start = 0, fixed = true);
initial algorithm
  print("begins at " + String(x));
equation
  der(x) = 2;
  when sample(0.25, 0.5) then
    n = pre(n) + 1;
    print(String(n) + ": " + String(x, format = "6.3f") + " " + String(n > 1));
  end when;
  when terminal() then
    print("ends at " + String(x, significantDigits = 3), "log.txt");
  end when;
  when time > 0.6 then
    assert(x < 1, "x has become " + String(x), level = AssertionLevel.warning);
  end when;
end Printing;

//@ case into_a_file_of_somebody_else
//@ used by strangers.rs
model Meddler
  function print
    input String string;
    input String fileName;
  external "C" ModelicaInternal_print(string, fileName);
  end print;
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when initial() then
    print("meddled", "FILE");
    print("noted", "notes.txt");
  end when;
end Meddler;

//@ case strings_that_command
//@ used by strangers.rs
model Loud "</title><script>alert(1)</script>"
  parameter Real '</script><b>p</b>'(unit = "<i>m</i>") = 1 "<img src=x onerror=alert(2)>";
  Real '=1+1' = time "\"><script>alert(3)</script>";
  Real 'a,b' = '</script><b>p</b>'*time;
equation
  assert(time < 0.5, "late </script><script>alert(4)</script> COMMAND", AssertionLevel.warning);
end Loud;
