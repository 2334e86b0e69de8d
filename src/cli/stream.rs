//! Rows of a run on their way to the file, and the few curves that a picture may need.

use std::path::PathBuf;

use super::interrupt;
use super::progress::Progress;
use crate::ir::trajectory::{Column, Constant, Course, Event, Kind, Trajectory};
use crate::report::results::{Format, Results};
use crate::report::table::TableError;
use crate::simulate::record::Sink;

/// So many curves are kept for a picture whose curves the user has not named.
const MOST_KEPT: usize = 2000;

/// Writes rows as they come and keeps what may be drawn, so that the memory of a large model's run is
/// that of a few curves.
pub struct Stream {
    results: Option<(Results, PathBuf)>,
    /// The first trouble with the results; nothing is written after it, and the run ends.
    trouble: Option<TableError>,
    progress: Option<Progress>,
    kept: Vec<usize>,
    row: Vec<f64>,
    /// The kept columns, and all events.
    pub trajectory: Trajectory,
}

impl Stream {
    /// Of a run that records `columns`: to the file `output`, keeping the columns at `kept`.
    pub fn new(
        columns: &[Column],
        courses: &[Course],
        output: Option<(PathBuf, Format)>,
        kept: Vec<usize>,
    ) -> Result<Self, TableError> {
        let results = match output {
            Some((path, format)) => Some((Results::create(&path, format, columns, courses)?, path)),
            None => None,
        };
        let trajectory = Trajectory::new(kept.iter().map(|&k| columns[k].clone()).collect());
        let row = vec![0.0; kept.len()];
        Ok(Stream { results, trouble: None, progress: None, kept, row, trajectory })
    }

    /// Shows how far the run has come, until [`Stream::hide`].
    pub fn show(&mut self, progress: Progress) {
        self.progress = Some(progress);
    }

    /// Takes the progress off the screen.
    pub fn hide(&mut self) {
        self.progress = None;
    }

    /// Gives the file its name, if there is one, after a run that reached `end`, s; that name.
    pub fn finish(&mut self, end: f64) -> Result<Option<PathBuf>, TableError> {
        if let Some(trouble) = self.trouble.take() {
            return Err(trouble);
        }
        let Some((results, path)) = self.results.take() else { return Ok(None) };
        results.finish(end)?;
        Ok(Some(path))
    }
}

impl Sink for Stream {
    /// The columns are known since `new`.
    fn begin(&mut self, _: Vec<Column>) {}

    fn expect(&mut self, rows: usize) {
        self.trajectory.reserve(rows);
    }

    fn constants(&mut self, constants: Vec<Constant>) {
        if let Some((results, _)) = &mut self.results {
            results.constants(constants);
        }
    }

    fn row(&mut self, time: f64, values: &[f64]) {
        if let (Some((results, _)), None) = (&mut self.results, &self.trouble) {
            self.trouble = results.row(time, values).err();
        }
        if self.kept.is_empty() {
            return;
        }
        for (to, &k) in self.row.iter_mut().zip(&self.kept) {
            *to = values[k];
        }
        self.trajectory.push(time, &self.row);
    }

    fn event(&mut self, event: Event) {
        self.trajectory.events.push(event);
    }

    fn goes_on(&mut self, time: f64) -> bool {
        if let Some(progress) = &self.progress {
            progress.reached(time);
        }
        self.trouble.is_none() && !interrupt::asked()
    }
}

/// Columns of which a picture may be made by itself: those of the model before those of its
/// components, in order of declaration.
pub fn drawable(columns: &[Column]) -> Vec<usize> {
    let drawn = |c: &Column| c.kind == Kind::Continuous && !c.name.starts_with("der(");
    let of = |top: bool| {
        let wanted = move |c: &Column| drawn(c) && c.name.contains('.') != top;
        columns.iter().enumerate().filter(move |(_, c)| wanted(c)).map(|(k, _)| k)
    };
    let mut kept: Vec<usize> = of(true).chain(of(false)).take(MOST_KEPT).collect();
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_of_the_model_itself_are_kept_first() {
        let mut columns: Vec<Column> =
            (0..MOST_KEPT).map(|k| Column::new(format!("part.x[{k}]"), "m")).collect();
        columns.push(Column::new("x", "m"));
        columns.push(Column::new("der(x)", "m/s"));
        let kept = drawable(&columns);
        assert_eq!(kept.len(), MOST_KEPT);
        assert_eq!(kept.last(), Some(&MOST_KEPT));
        assert_eq!(kept[MOST_KEPT - 2], MOST_KEPT - 2);
    }

    #[test]
    fn rows_reach_the_kept_columns() {
        let columns = [Column::new("a", ""), Column::new("b", ""), Column::new("c", "")];
        let mut stream = Stream::new(&columns, &[], None, vec![0, 2]).unwrap();
        stream.row(0.5, &[1.0, 2.0, 3.0]);
        assert_eq!(stream.trajectory.values("c"), Some(&[3.0][..]));
        assert_eq!(stream.trajectory.values("b"), None);
        assert_eq!(stream.finish(0.5).unwrap(), None);
    }
}
