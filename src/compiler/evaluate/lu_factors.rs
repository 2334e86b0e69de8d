//! The functions of LAPACK that work on the factors of a matrix, `dgetrf`, `dgetrs` and `dgetri`, and those that find
//! its eigenvalues, `dgeev`, with eigenvectors, and `dhseqr`.
//!
//! They are computed on numbers, which must be known before simulation, because the pivots are
//! integers. Golub & Van Loan, *Matrix Computations*, 4th ed., section 3.4.

use super::Evaluator;
use super::external::Refusal;
use super::linear_algebra::name_of;
use super::value::Value;
use crate::base::name::Name;
use crate::ir::ast::{ExprKind, External};
use crate::ir::expr::Const;
use crate::numeric::eigenvalues::{Complex, eigenvalues};
use crate::numeric::eigenvectors::eigenvectors;

/// A matrix with its numbers of rows and columns, by rows.
struct Numbers {
    rows: usize,
    columns: usize,
    at: Vec<f64>,
}

impl Evaluator<'_> {
    /// Runs a function on the locals of the Modelica function that declares it: the outputs and
    /// their values; `None` if it is not one of those known here.
    pub(super) fn lapack_on_factors(
        &mut self,
        called: &str,
        external: &External,
    ) -> Option<Result<Vec<(Name, Value)>, Refusal>> {
        let local = |k: usize| external.args.get(k).and_then(name_of);
        Some(match called {
            "dgetrf" => self.factorize(local(2)?, local(4)?, local(5)?),
            "dgetri" => self.invert(local(1)?, local(3)?, local(6)?),
            "dgeev" => self.eigenvalues_of(external),
            "dhseqr" if self.wants_eigenvalues_only(local(0)?) => {
                self.eigenvalues_of_hessenberg(local(5)?, [local(7)?, local(8)?], local(13)?)
            }
            "dgetrs" => self.solve_by_factors(local(3)?, local(5)?, local(6)?, local(8)?),
            _ => return None,
        })
    }

    fn factorize(
        &mut self,
        matrix: Name,
        pivots: Name,
        info: Name,
    ) -> Result<Vec<(Name, Value)>, Refusal> {
        let mut a = self.numbers_of(matrix)?;
        let (exchanged, singular) = factor(&mut a);
        let exchanged = exchanged.iter().map(|k| self.graph.integer(*k as i64 + 1)).collect();
        let singular = self.graph.integer(singular as i64);
        Ok(vec![
            (matrix, self.matrix_value(&a)),
            (pivots, Value::vector(exchanged)),
            (info, Value::Scalar(singular)),
        ])
    }

    fn invert(
        &mut self,
        matrix: Name,
        pivots: Name,
        info: Name,
    ) -> Result<Vec<(Name, Value)>, Refusal> {
        let a = self.numbers_of(matrix)?;
        let mut at = vec![0.0; a.rows * a.rows];
        (0..a.rows).for_each(|k| at[k * a.rows + k] = 1.0);
        let mut unit = Numbers { rows: a.rows, columns: a.rows, at };
        let pivots = self.pivots_of(pivots, a.rows)?;
        let singular = substitute(&a, &pivots, &mut unit);
        let singular = Value::Scalar(self.graph.integer(singular as i64));
        Ok(vec![(matrix, self.matrix_value(&unit)), (info, singular)])
    }

    fn solve_by_factors(
        &mut self,
        matrix: Name,
        pivots: Name,
        right: Name,
        info: Name,
    ) -> Result<Vec<(Name, Value)>, Refusal> {
        let a = self.numbers_of(matrix)?;
        let dims = self.local(right).ok_or(Refusal::Unknown)?.dims().to_vec();
        let mut b = self.numbers_of(right)?;
        let pivots = self.pivots_of(pivots, a.rows)?;
        if b.rows != a.rows || substitute(&a, &pivots, &mut b) != 0 {
            return Err(Refusal::Wrong("the matrix is singular".into()));
        }
        let solution = Value::array(dims, self.matrix_value(&b).elements().to_vec());
        Ok(vec![(right, solution), (info, Value::Scalar(self.graph.integer(0)))])
    }

    /// `dgeev`: the real and imaginary parts of the eigenvalues, and of the right eigenvectors if these are wanted. The
    /// vectors of a pair are held in two columns, the real parts and then the imaginary ones.
    fn eigenvalues_of(&mut self, external: &External) -> Result<Vec<(Name, Value)>, Refusal> {
        let local = |k: usize| external.args.get(k).and_then(name_of).ok_or(Refusal::Unknown);
        let wants_vectors = matches!(external.args.get(1).map(|e| &e.kind),
            Some(ExprKind::String(text)) if &**text == "V");
        let a = self.numbers_of(local(3)?)?;
        let n = a.rows;
        if n != a.columns {
            return Err(Refusal::Wrong("the matrix is not square".into()));
        }
        let columns: Vec<f64> = (0..n * n).map(|k| a.at[k % n * n + k / n]).collect();
        let failed =
            || Refusal::Wrong("the iteration for the eigenvalues does not converge".into());
        let values = eigenvalues(n, &columns).ok_or_else(failed)?;
        let mut parts = |part: fn(&Complex) -> f64| {
            let numbers = values.iter().map(|value| self.graph.real(part(value)));
            Value::vector(numbers.collect())
        };
        let mut results =
            vec![(local(5)?, parts(|value| value.re)), (local(6)?, parts(|value| value.im))];
        if wants_vectors {
            let vectors = eigenvectors(n, &columns, &values).ok_or_else(failed)?;
            let mut at = vec![0.0; n * n];
            for (j, (value, vector)) in values.iter().zip(&vectors).enumerate() {
                // The second of a pair is the conjugate of the first.
                let column = match value.im < 0.0 && j > 0 {
                    true => &vectors[j - 1].im,
                    false => &vector.re,
                };
                (0..n).for_each(|i| at[i * n + j] = column[i]);
            }
            let vectors = self.matrix_value(&Numbers { rows: n, columns: n, at });
            results.push((local(9)?, vectors));
        }
        results.push((local(13)?, Value::Scalar(self.graph.integer(0))));
        Ok(results)
    }

    /// Whether the job of `dhseqr` is `E`: the Schur form is not asked for.
    fn wants_eigenvalues_only(&self, job: Name) -> bool {
        let job = self.local(job).and_then(|value| value.scalar());
        matches!(job.and_then(|e| self.graph.as_const(e)),
            Some(Const::String(text)) if text == "E")
    }

    /// `dhseqr`: the real and imaginary parts of the eigenvalues of a Hessenberg matrix.
    fn eigenvalues_of_hessenberg(
        &mut self,
        matrix: Name,
        parts: [Name; 2],
        info: Name,
    ) -> Result<Vec<(Name, Value)>, Refusal> {
        let a = self.numbers_of(matrix)?;
        let n = a.rows;
        if n != a.columns {
            return Err(Refusal::Wrong("the matrix is not square".into()));
        }
        let columns: Vec<f64> = (0..n * n).map(|k| a.at[k % n * n + k / n]).collect();
        let values = eigenvalues(n, &columns).ok_or_else(|| {
            Refusal::Wrong("the iteration for the eigenvalues does not converge".into())
        })?;
        let [real, imaginary] = [|v: &Complex| v.re, |v: &Complex| v.im]
            .map(|part| Value::vector(values.iter().map(|v| self.graph.real(part(v))).collect()));
        let zero = Value::Scalar(self.graph.integer(0));
        Ok(vec![(parts[0], real), (parts[1], imaginary), (info, zero)])
    }

    fn numbers_of(&mut self, local: Name) -> Result<Numbers, Refusal> {
        let value = self.local(local).ok_or(Refusal::Unknown)?;
        let (rows, columns) = match *value.dims() {
            [rows] => (rows, 1),
            [rows, columns] => (rows, columns),
            _ => return Err(Refusal::Unknown),
        };
        let at = self.known(&value)?.into_iter().map(Const::register).collect();
        Ok(Numbers { rows, columns, at })
    }

    /// Rows that were exchanged, from 0.
    fn pivots_of(&mut self, local: Name, rows: usize) -> Result<Vec<usize>, Refusal> {
        let pivots = self.numbers_of(local)?.at;
        let all: Vec<usize> = pivots.iter().map(|k| (*k as usize).wrapping_sub(1)).collect();
        match all.len() == rows && all.iter().all(|k| *k < rows) {
            true => Ok(all),
            false => Err(Refusal::Wrong("the pivots are not those of the matrix".into())),
        }
    }

    fn matrix_value(&mut self, a: &Numbers) -> Value {
        let elements = a.at.iter().map(|x| Value::Scalar(self.graph.real(*x))).collect();
        Value::array(vec![a.rows, a.columns], elements)
    }
}

/// Overwrites a matrix with its factors L, whose diagonal of ones is left out, and U; returns the
/// rows that were exchanged, and from 1 the first pivot that is zero, 0 if none is.
fn factor(a: &mut Numbers) -> (Vec<usize>, usize) {
    let (m, n) = (a.rows, a.columns);
    let mut singular = 0;
    let mut exchanged = Vec::with_capacity(m.min(n));
    for k in 0..m.min(n) {
        let size = |i: usize| a.at[i * n + k].abs();
        let pivot = (k + 1..m).fold(k, |best, i| if size(i) > size(best) { i } else { best });
        exchanged.push(pivot);
        if a.at[pivot * n + k] == 0.0 {
            singular = if singular == 0 { k + 1 } else { singular };
            continue;
        }
        (0..n).for_each(|j| a.at.swap(k * n + j, pivot * n + j));
        for i in k + 1..m {
            a.at[i * n + k] /= a.at[k * n + k];
            for j in k + 1..n {
                a.at[i * n + j] -= a.at[i * n + k] * a.at[k * n + j];
            }
        }
    }
    (exchanged, singular)
}

/// Overwrites `b` with the solution of the factorized system; returns from 1 a pivot that is zero.
fn substitute(a: &Numbers, pivots: &[usize], b: &mut Numbers) -> usize {
    let (n, width) = (a.rows, b.columns);
    if let Some(k) = (0..n).find(|k| a.at[k * n + k] == 0.0) {
        return k + 1;
    }
    for (k, pivot) in pivots.iter().enumerate() {
        (0..width).for_each(|j| b.at.swap(k * width + j, pivot * width + j));
    }
    for j in 0..width {
        for i in 0..n {
            let known: f64 = (0..i).map(|k| a.at[i * n + k] * b.at[k * width + j]).sum();
            b.at[i * width + j] -= known;
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| a.at[i * n + k] * b.at[k * width + j]).sum();
            b.at[i * width + j] = (b.at[i * width + j] - known) / a.at[i * n + i];
        }
    }
    0
}
