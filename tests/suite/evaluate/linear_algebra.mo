//@ case linear_systems
//@ run stop=1
// A system with a pivot of zero, whose matrix varies, and a straight line through points by least
// squares. Cramer's rule and the formulas of the regression line are independent of the elimination.
package Solved
  function solve
    input Real A[:, size(A, 1)];
    input Real b[size(A, 1)];
    output Real x[size(A, 1)] = b;
    output Integer info;
  protected
    Real Awork[size(A, 1), size(A, 1)] = A;
    Integer n = size(A, 1);
    Integer ipiv[size(A, 1)];
  external "FORTRAN 77" dgesv(n, 1, Awork, n, ipiv, x, n, info);
  end solve;
  function leastSquares
    input Real A[:, :];
    input Real b[size(A, 1)];
    input Real rcond = 0;
    output Real x[size(A, 1)] = b;
    output Integer info;
    output Integer rank;
  protected
    Integer m = size(A, 1);
    Integer n = size(A, 2);
    Integer lwork = 10;
    Real work[10];
    Real Awork[size(A, 1), size(A, 2)] = A;
    Integer jpvt[size(A, 2)] = zeros(n);
  external "FORTRAN 77" dgelsy(m, n, 1, Awork, m, x, m, jpvt, rcond, rank, work, lwork, info);
  end leastSquares;
  model Systems
    Real x[2] = solve([0, 2 + time; 3, 1], {4, 5});
    Real line[4] = leastSquares([1, 0; 1, 1; 1, 2; 1, 3], {1, 3, 4, 7});
    parameter Real p = 2;
    Real y[3] = solve([p, 1, 0; 1, p, 1; 0, 1, p], {3, 4, 3});
  end Systems;
end Solved;
//@ expect x[2], x[1] = 4/3, (5 - 4/3)/3 rel 1e-12
//@ expect line[1], line[2] = 0.9, 1.9 rel 1e-12
//@ expect y[1], y[2], y[3] = 1, 1, 1 rel 1e-12
