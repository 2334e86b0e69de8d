//@ case scanned_from_a_position
// Where nothing is found the position stays, and unsigned numbers have no sign.
package P
  function integer_at
    input String text;
    input Integer start;
    input Boolean unsigned;
    output Integer next;
    output Integer number;
  external "C" ModelicaStrings_scanInteger(text, start, unsigned, next, number);
  end integer_at;
  function name_at
    input String text;
    input Integer start;
    output Integer next;
    output String name;
  external "C" ModelicaStrings_scanIdentifier(text, start, next, name);
  end name_at;
  function hash
    input String text;
    output Integer number;
  external "C" number = ModelicaStrings_hashString(text);
  end hash;
  model Scan
    parameter Integer sign = integer_at("x = -12", 4, false);
    parameter Integer none = integer_at("x = -12", 4, true);
    parameter Integer name = name_at("2*(b1)", 4);
    parameter Integer no_name = name_at("2*(b1)", 3);
    Real y[5] = {sign, none, name, no_name, hash("Noise.source")};
  end Scan;
end P;
// The last one by an independent program for Partow's hash.
//@ expect y[1:5] = 8, 4, 6, 3, 1009890721
