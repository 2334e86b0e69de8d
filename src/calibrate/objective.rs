//! Recordings together: sums of squares and normal equations, each recording a task for a core or for another process.

use super::data::{Recording, Split};
use super::elsewhere::{self, Wanted};
use super::parallel;
use super::problem::Problem;
use super::sums::Sums;
use crate::numeric::least_squares::{NormalEquations, Residuals};
use crate::simulate::failure::Failure;

impl<'a> Problem<'a> {
    /// Sums of squares over the recordings of one kind; the first failure in their order.
    pub fn sums(&self, split: Split, x: &[f64]) -> Result<Sums, Failure> {
        let mut sums = Sums::default();
        for both in self.each(&self.recordings(split), x, Wanted::Squares) {
            let both = both?;
            let (counts, squares) = both.split_at(both.len() / 2);
            sums.counts.push(counts.iter().map(|n| *n as usize).collect());
            sums.squares.push(squares.to_vec());
        }
        Ok(sums)
    }

    /// The training recordings that are not trimmed.
    fn fitted(&self) -> Vec<&'a Recording> {
        let all = self.data.of(Split::Train).enumerate();
        all.filter(|(i, _)| !self.trimmed.contains(i)).map(|(_, r)| r).collect()
    }

    /// Calls `take` with every residual of the training recordings that are not trimmed and its derivatives by the
    /// coordinates of the search. Errors: the first recording that cannot be simulated.
    pub fn each_row(&self, x: &[f64], mut take: impl FnMut(f64, &[f64])) -> Result<(), Failure> {
        for rows in self.each(&self.fitted(), x, Wanted::Rows) {
            for row in rows?.chunks_exact(1 + self.parameters.len()) {
                take(row[0], &row[1..]);
            }
        }
        Ok(())
    }

    /// The sum of squares over the training recordings that are not trimmed.
    fn cost_of_fitted(&self, x: &[f64]) -> Result<f64, Failure> {
        let mut sum = 0.0;
        for cost in self.each(&self.fitted(), x, Wanted::Cost) {
            sum += cost?.iter().sum::<f64>();
        }
        Ok(sum)
    }

    /// Evaluates recordings, on all cores or elsewhere; the results in their order.
    pub(super) fn each(
        &self,
        recordings: &[&Recording],
        x: &[f64],
        wanted: Wanted,
    ) -> Vec<Result<Vec<f64>, Failure>> {
        let here = |i: usize| self.evaluated(recordings[i], x, wanted);
        let Some((elsewhere, description)) = &self.elsewhere else {
            return parallel::map(self.jobs, recordings.len(), here);
        };
        let position =
            |r: &&Recording| self.data.recordings.iter().position(|k| std::ptr::eq(k, *r));
        let tasks: Option<Vec<Vec<u8>>> =
            recordings.iter().map(|r| position(r).map(|k| elsewhere::task(k, wanted, x))).collect();
        let Some(tasks) = tasks else {
            return parallel::map(self.jobs, recordings.len(), here);
        };
        match elsewhere.answers(description, tasks) {
            // Simulated again here, a recording that fails says why.
            Ok(all) => {
                let answer =
                    |(i, found): (usize, Option<Vec<f64>>)| found.map_or_else(|| here(i), Ok);
                all.into_iter().enumerate().map(answer).collect()
            }
            Err(why) => recordings.iter().map(|_| Err(Failure::settings(why.clone()))).collect(),
        }
    }

    /// Evaluates a recording in this thread.
    pub fn evaluated(
        &self,
        recording: &Recording,
        x: &[f64],
        wanted: Wanted,
    ) -> Result<Vec<f64>, Failure> {
        let valid = |r: &&f64| !r.is_nan();
        match wanted {
            Wanted::Squares => {
                let residuals = self.residuals(recording, x)?;
                let count = |r: &Vec<f64>| r.iter().filter(valid).count() as f64;
                let square = |r: &Vec<f64>| r.iter().filter(valid).map(|r| r * r).sum();
                Ok(residuals.iter().map(count).chain(residuals.iter().map(square)).collect())
            }
            Wanted::Cost => {
                let residuals = self.residuals(recording, x)?;
                Ok(vec![residuals.iter().flatten().filter(valid).map(|r| r * r).sum::<f64>()])
            }
            Wanted::Normal => {
                let NormalEquations { gram, gradient, cost, .. } = self.normal_of(recording, x)?;
                Ok([gram, gradient, vec![cost]].concat())
            }
            Wanted::Residuals => {
                let residuals = self.residuals(recording, x)?;
                let instants = 0..recording.time.len();
                let at = |k: usize| residuals.iter().map(move |signal| signal[k]);
                Ok(instants.flat_map(at).filter(|r| !r.is_nan()).collect())
            }
            Wanted::Rows => {
                let mut rows = Vec::new();
                self.each_slope(recording, x, |residual, slopes| {
                    rows.push(residual);
                    rows.extend_from_slice(slopes);
                })?;
                Ok(rows)
            }
        }
    }

    /// The normal equations of the training recordings that are not trimmed.
    pub fn normal(&self, x: &[f64]) -> Result<NormalEquations, Failure> {
        self.normal_of_all(&self.fitted(), x)
    }

    /// The normal equations of the recordings of one kind.
    pub fn normal_of_split(&self, split: Split, x: &[f64]) -> Result<NormalEquations, Failure> {
        self.normal_of_all(&self.recordings(split), x)
    }

    fn normal_of_all(
        &self,
        recordings: &[&Recording],
        x: &[f64],
    ) -> Result<NormalEquations, Failure> {
        let n = self.parameters.len();
        let mut sum = NormalEquations::new(n);
        for normal in self.each(recordings, x, Wanted::Normal) {
            let all = normal?;
            let (gram, rest) = all.split_at(n * n);
            let (gradient, cost) = (rest[..n].to_vec(), rest[n]);
            sum.merge(&NormalEquations { n, gram: gram.to_vec(), gradient, cost });
        }
        Ok(sum)
    }
}

impl Residuals for Problem<'_> {
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
        Problem::normal(self, x).ok()
    }

    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        self.cost_of_fitted(x).ok()
    }
}
