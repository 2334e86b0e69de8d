//@ case matrix_from_a_file
//@ used by native.rs
package P
  function sizes
    input String file;
    input String name;
    output Integer n[2];
  external "C" ModelicaIO_readMatrixSizes(file, name, n);
  end sizes;
  function gains
    input String file;
    input String name;
    input Integer rows;
    input Integer columns;
    output Real m[rows, columns];
  external "C" ModelicaIO_readRealMatrix(file, name, m, rows, columns, false);
  end gains;
  model Reads
    parameter String file = "FILE";
    parameter Integer n[2] = sizes(file, "gains");
    parameter Real m[n[1], n[2]] = gains(file, "gains", n[1], n[2]);
    Real y[n[1]] = m*{1, 2, time};
  end Reads;
end P;

//@ case a_file_of_somebody_else
//@ used by strangers.rs
model Curious
  impure function line
    input String file;
    output String string;
    output Boolean isAtEnd;
  external "C" string = ModelicaInternal_readLine(file, 1, isAtEnd);
  end line;
  parameter String secret = line("FILE");
  Real x = time;
equation
  assert(false, "found " + secret, AssertionLevel.warning);
end Curious;
