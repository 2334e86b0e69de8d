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
