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

//@ case factors
//@ run stop=1
// The inverse and a solution from the factors of a matrix whose first pivot is zero. Cramer's rule
// is independent of the elimination: det(A) = -2*(3*4 - 0*1) + 1*(3*1 - 1*1) = -22.
package Factors
  function factorize
    input Real A[:, :];
    output Real LU[size(A, 1), size(A, 2)] = A;
    output Integer pivots[min(size(A, 1), size(A, 2))];
    output Integer info;
  protected
    Integer m = size(A, 1);
    Integer n = size(A, 2);
    Integer lda = max(1, m);
  external "FORTRAN 77" dgetrf(m, n, LU, lda, pivots, info);
  end factorize;
  function invert
    input Real LU[:, size(LU, 1)];
    input Integer pivots[size(LU, 1)];
    output Real inv[size(LU, 1), size(LU, 2)] = LU;
    output Integer info;
  protected
    Integer n = size(LU, 1);
    Integer lwork = 10*n;
    Real work[10*n];
  external "FORTRAN 77" dgetri(n, inv, n, pivots, work, lwork, info);
  end invert;
  function solve
    input Real LU[:, size(LU, 1)];
    input Integer pivots[size(LU, 1)];
    input Real B[size(LU, 1), :];
    output Real X[size(B, 1), size(B, 2)] = B;
    output Integer info;
  protected
    Integer n = size(LU, 1);
    Integer nrhs = size(B, 2);
    Real work[size(LU, 1), size(LU, 1)] = LU;
  external "FORTRAN 77" dgetrs("N", n, nrhs, work, n, pivots, X, n, info);
  end solve;
  function inverse
    input Real A[:, size(A, 1)];
    output Real B[size(A, 1), size(A, 1)];
  protected
    Real LU[size(A, 1), size(A, 1)];
    Integer pivots[size(A, 1)];
    Integer info;
  algorithm
    (LU, pivots, info) := factorize(A);
    B := invert(LU, pivots);
  end inverse;
  function solution
    input Real A[:, size(A, 1)];
    input Real b[size(A, 1), :];
    output Real x[size(A, 1), size(b, 2)];
  protected
    Real LU[size(A, 1), size(A, 1)];
    Integer pivots[size(A, 1)];
    Integer info;
  algorithm
    (LU, pivots, info) := factorize(A);
    x := solve(LU, pivots, b);
  end solution;
  model User
    parameter Real A[3, 3] = {{0, 2, 1}, {3, 0, 1}, {1, 1, 4}};
    parameter Real B[3, 3] = inverse(A);
    parameter Real x[3, 1] = solution(A, {{1}, {2}, {3}});
    Real C[3, 3] = B*time;
    Real y[3] = x[:, 1]*time;
  end User;
end Factors;
//@ let det = -2*(3*4 - 1*1) + 1*(3*1 - 0*1)
//@ expect C[1,1], C[1,2], C[1,3] = (0*4 - 1*1)/det, -(2*4 - 1*1)/det, (2*1 - 1*0)/det abs 1e-14
//@ expect C[3,1], C[3,3] = (3*1 - 0*1)/det, (0*0 - 2*3)/det abs 1e-14
//@ expect y[1] = ((0*4 - 1*1) - 2*(2*4 - 1*1) + 3*(2*1 - 1*0))/det abs 1e-14

//@ case eigenvalues_of_lapack
// Real eigenvalues with vectors, and a pair whose vectors are held in two columns: `A v = lambda v`.
package Eigen
  pure function dgeev
    input Real A[:, size(A, 1)];
    output Real re[size(A, 1)];
    output Real im[size(A, 1)];
    output Real vectors[size(A, 1), size(A, 1)];
    output Integer info;
  protected
    Real dummy[1, 1];
    Integer n = size(A, 1);
    Integer lwork = 12*n;
    Real Awork[size(A, 1), size(A, 1)] = A;
    Real work[12*size(A, 1)];
    external "FORTRAN 77" dgeev("N", "V", n, Awork, n, re, im, dummy, 1, vectors, n, work, lwork, info);
  end dgeev;
  function values
    input Real A[:, size(A, 1)];
    output Real re[size(A, 1)];
    output Real im[size(A, 1)];
    output Real vectors[size(A, 1), size(A, 1)];
  protected
    Integer info;
  algorithm
    (re, im, vectors, info) := dgeev(A);
  end values;
  function error
    input Real A[:, size(A, 1)];
    output Real e;
  protected
    Real re[size(A, 1)];
    Real im[size(A, 1)];
    Real v[size(A, 1), size(A, 1)];
  algorithm
    (re, im, v) := values(A);
    e := max(abs(A*v - v*{{re[1], im[1]}, {-im[1], re[1]}}));
  end error;
  model User
    parameter Real re[2] = values({{4, 1}, {2, 3}});
    parameter Real pair = error({{1, -2}, {3, 1}});
    Real sum = (re[1] + 10*re[2])*time;
    Real off = pair*time;
  end User;
end Eigen;
//@ expect sum, off = 25, 0 abs 1e-11

//@ case eigenvalues_of_what_a_loop_makes_of_parameters
// How often the loop runs depends on a parameter, which is fixed by that.
package Eigen
  pure function dgeev
    input Real A[:, size(A, 1)];
    output Real re[size(A, 1)];
    output Real im[size(A, 1)];
    output Integer info;
  protected
    Real dummy[1, 1];
    Integer n = size(A, 1);
    Integer lwork = 12*n;
    Real Awork[size(A, 1), size(A, 1)] = A;
    Real work[12*size(A, 1)];
    external "FORTRAN 77" dgeev("N", "N", n, Awork, n, re, im, dummy, 1, dummy, n, work, lwork, info);
  end dgeev;
  function halved
    input Real d;
    output Real re[2];
  protected
    Real im[2];
    Integer info;
    Real x;
  algorithm
    x := d;
    while x > 1 loop
      x := x/2;
    end while;
    (re, im, info) := dgeev({{2, x}, {x, 2}});
  end halved;
  model User
    parameter Real d = 6;
    parameter Real e = d;
    parameter Real re[2] = halved(e);
    Real product = re[1]*re[2]*time;
  end User;
end Eigen;
//@ expect product = 2^2 - 0.75^2 rel 1e-12

//@ case fewer_equations_than_unknowns
// The shortest of all solutions: of x + y + z = 6*time and x - z = 0 it is (2, 2, 2)*time, by symmetry.
package Short
  function dgelsy
    input Real A[:, :];
    input Real b[size(A, 1)];
    output Real x[max(size(A, 1), size(A, 2))] = cat(1, b, zeros(max(size(A, 1), size(A, 2)) - size(A, 1)));
    output Integer info;
    output Integer rank;
  protected
    Integer nrow = size(A, 1);
    Integer ncol = size(A, 2);
    Integer nx = max(nrow, ncol);
    Real work[100];
    Real Awork[nrow, ncol] = A;
    Integer jpvt[ncol] = zeros(ncol);
    external "FORTRAN 77" dgelsy(nrow, ncol, 1, Awork, nrow, x, nx, jpvt, 1e-12, rank, work, 100, info);
  end dgelsy;
  model Plane
    Real x[3] = dgelsy({{1, 1, 1}, {1, 0, -1}}, {6*time, 0});
    Real y[3] = dgelsy({{0, 3, 4*time}}, {25*time});
  end Plane;
end Short;
//@ run stop=1
//@ expect x[1], x[2], x[3] = 2, 2, 2 rel 1e-12
//@ expect y[1], y[2], y[3] = 0, 3, 4 abs 1e-12

//@ case eigenvalues_of_a_hessenberg_matrix
// Those of the companion matrix of (s - 1)*(s - 2)*(s - 4) = s^3 - 7 s^2 + 14 s - 8.
package Roots
  function dhseqr
    input Real H[:, size(H, 1)];
    output Real re[size(H, 1)];
    output Real im[size(H, 1)];
    output Integer info;
  protected
    Integer n = size(H, 1);
    String job = "E";
    Real Ho[:, :] = H;
    Real Zo[:, :] = H;
    Real work[3*size(H, 1)];
    external "FORTRAN 77" dhseqr(job, "N", n, 1, n, Ho, n, re, im, Zo, n, work, 3*n, info);
  end dhseqr;
  model Polynomial
    parameter Real roots[3] = dhseqr({{7, -14, 8}, {1, 0, 0}, {0, 1, 0}});
    Real smallest = min(roots);
    Real sum = sum(roots);
    Real largest = max(roots);
  end Polynomial;
end Roots;
//@ expect smallest, largest, sum = 1, 4, 7 rel 1e-9

//@ case powers_of_matrices
//@ run stop=1
// The millionth power of a rotation by the time is one by a million times the time.
model Powers
  Real A[2, 2] = {{cos(time), -sin(time)}, {sin(time), cos(time)}};
  Real B[2, 2] = A^1000000;
  Real C[2, 2] = A^3;
  Real I[2, 2] = A^0;
end Powers;
//@ expect B[1,1], B[2,1] = cos(1e6), sin(1e6) abs 1e-8
//@ expect C[1,1], C[1,2] = cos(3), -sin(3) abs 1e-14
//@ expect I[1,1], I[1,2] = 1, 0
