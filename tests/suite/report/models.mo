//@ case markup_in_strings
//@ used by report.rs
model Nasty "</script><script>window.nasty = 1</script> & <b>"
  parameter Real k(unit = "</title>") = 1 "<img src=x onerror='window.nasty = 2'>";
  Real x(start = 1, fixed = true) "</script> --> \" ' &amp; {body}";
  // <!-- </pre></section></script><script>window.nasty = 3</script>
equation
  der(x) = -k*x;
end Nasty;
