//! Rows of a run on their way to the file, and the few curves that a picture may need.

use std::path::PathBuf;
use std::sync::Arc;

use super::interrupt;
use super::print;
use super::progress::Progress;
use super::writer::Writer;
use crate::base::render::visible;
use crate::driver::quantity::Conversion;
use crate::io::csv::TableError;
use crate::io::format::Format;
use crate::io::printout::Printout;
use crate::io::results::{Header, Results};
use crate::ir::trajectory::{Column, ColumnStorage, Constant, Event, Kind, Trajectory};
use crate::simulate::record::Sink;

/// So many curves are kept for a picture whose curves the user has not named.
const MOST_KEPT: usize = 2000;

/// A file of results.
enum Output {
    /// Not yet started.
    Waiting(Results),
    /// Takes rows.
    Begun(Writer),
}

/// A column that is written in another unit than SI.
#[derive(Clone, PartialEq, Debug)]
pub struct OtherUnit {
    /// Its position.
    pub column: usize,
    /// The unit.
    pub unit: String,
    /// How a value becomes one in this unit.
    pub conversion: Conversion,
}

/// Writes rows as they come and keeps only variables that may be drawn, so that the memory of a large run is
/// that of a few curves.
pub struct Stream {
    output: Option<(Output, PathBuf)>,
    /// The results could not be started; the run ends.
    trouble: Option<TableError>,
    progress: Option<Progress>,
    kept: Vec<usize>,
    /// Nobody has named the curves: see [`Stream::narrow`].
    may_narrow: bool,
    /// Rows that will come.
    expected: usize,
    /// Columns of the file that are written in other units.
    units: Vec<OtherUnit>,
    /// Files that the model itself writes.
    printout: Printout,
    /// The kept columns, and all events.
    pub trajectory: Trajectory,
}

impl Stream {
    /// Of a run that records `columns`: to the file `output`, in which some have other units, keeping the columns at
    /// `kept`.
    pub fn new(
        columns: &[Column],
        column_storage: &[ColumnStorage],
        output: Option<(PathBuf, &'static Format)>,
        units: Vec<OtherUnit>,
        kept: Vec<usize>,
    ) -> Result<Self, TableError> {
        let mut columns = columns.to_vec();
        let output = match output {
            Some((path, format)) => {
                let mut written = columns.clone();
                units.iter().for_each(|u| written[u.column].unit.clone_from(&u.unit));
                // A column in another unit differs from its aliases.
                let own = |storage: &ColumnStorage| match storage {
                    ColumnStorage::Alias { .. } => ColumnStorage::Own,
                    storage => *storage,
                };
                let changed: Vec<ColumnStorage> = column_storage.iter().map(own).collect();
                let column_storage = if units.is_empty() { column_storage } else { &changed };
                let header = Header { columns: &written, column_storage };
                let results = Results::create(&path, format, &header)?;
                Some((Output::Waiting(results), path))
            }
            None => None,
        };
        // Pictures convert by themselves.
        units.iter().for_each(|u| columns[u.column].display_unit.clone_from(&u.unit));
        let trajectory = Trajectory::new(kept.iter().map(|&k| columns[k].clone()).collect());
        let printout = Printout::default();
        Ok(Stream {
            output,
            trouble: None,
            progress: None,
            kept,
            may_narrow: false,
            expected: 0,
            units,
            printout,
            trajectory,
        })
    }

    /// With the bounds of what the model may write; without them it writes no file.
    pub fn with_printout(self, printout: Printout) -> Self {
        Stream { printout, ..self }
    }

    /// For a picture whose curves nobody has named.
    pub fn for_default_picture(self) -> Self {
        Stream { may_narrow: true, ..self }
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
        let Some((output, path)) = self.output.take() else { return Ok(None) };
        let results = match output {
            Output::Waiting(results) => results,
            Output::Begun(writer) => writer.end()?,
        };
        results.finish(end)?;
        Ok(Some(path))
    }

    /// Forgets the columns of components as soon as a variable of the model itself has moved: a picture whose curves
    /// nobody has named shows no others then.
    fn narrow(&mut self) {
        let Trajectory { columns, data, .. } = &mut self.trajectory;
        let is_own: Vec<bool> = columns.iter().map(|c| !c.name.contains('.')).collect();
        let moves = |(values, is_own): (&Arc<Vec<f64>>, &bool)| {
            *is_own && values.iter().any(|x| *x != values[0])
        };
        if !data.iter().zip(&is_own).any(moves) {
            return;
        }
        self.may_narrow = false;
        retain_marked(columns, &is_own);
        retain_marked(data, &is_own);
        retain_marked(&mut self.kept, &is_own);
        self.trajectory.reserve(self.expected.saturating_sub(self.trajectory.rows()));
    }

    /// Rows in the units of the file, if these are not SI.
    fn converted(&self, values: &[f64], width: usize) -> Option<Vec<f64>> {
        if self.units.is_empty() || self.output.is_none() {
            return None;
        }
        let mut out = values.to_vec();
        for OtherUnit { column, conversion, .. } in &self.units {
            let cells = out.iter_mut().skip(*column).step_by(width.max(1));
            cells.for_each(|value| *value = conversion.of(*value));
        }
        Some(out)
    }

    /// The file, ready for rows.
    fn writer(&mut self) -> Option<&mut Writer> {
        let (output, path) = self.output.take()?;
        let writer = match output {
            Output::Begun(writer) => Ok(writer),
            Output::Waiting(results) => Writer::begin(results),
        };
        match writer {
            Ok(writer) => match self.output.insert((Output::Begun(writer), path)) {
                (Output::Begun(writer), _) => Some(writer),
                _ => None,
            },
            Err(trouble) => {
                self.trouble = Some(trouble);
                None
            }
        }
    }
}

impl Sink for Stream {
    /// The columns are known since `new`.
    fn begin(&mut self, _: Vec<Column>) {}

    fn expect(&mut self, rows: usize) {
        self.expected = rows;
        if !self.may_narrow {
            self.trajectory.reserve(rows);
        }
    }

    fn constants(&mut self, constants: Vec<Constant>) {
        if let Some((Output::Waiting(results), _)) = &mut self.output {
            results.constants(constants);
        }
    }

    fn row(&mut self, time: f64, values: &[f64]) {
        self.rows(&[time], values);
    }

    fn rows(&mut self, times: &[f64], values: &[f64]) {
        let width = values.len() / times.len().max(1);
        let converted = self.converted(values, width);
        if let Some(writer) = self.writer() {
            writer.rows(times, converted.as_deref().unwrap_or(values));
        }
        if self.kept.is_empty() {
            return;
        }
        self.trajectory.time.extend_from_slice(times);
        for (column, &k) in self.trajectory.data.iter_mut().zip(&self.kept) {
            let values = (0..times.len()).map(|row| values[row * width + k]);
            Arc::make_mut(column).extend(values);
        }
        if self.may_narrow {
            self.narrow();
        }
    }

    fn event(&mut self, event: Event) {
        self.trajectory.events.push(event);
    }

    fn print(&mut self, line: &str, file: &str) {
        if file.is_empty() {
            print(&format!("{line}\n"));
            return;
        }
        if let Err(why) = self.printout.append(file, line) {
            eprintln!("warning: `{}` is not written: {why}", visible(file));
        }
    }

    fn goes_on(&mut self, time: f64) -> bool {
        if let Some(progress) = &self.progress {
            progress.reached(time);
        }
        let failed = match &self.output {
            Some((Output::Begun(writer), _)) => writer.has_failed(),
            _ => self.trouble.is_some(),
        };
        !failed && !interrupt::is_requested()
    }
}

/// Removes the elements that are not marked.
fn retain_marked<T>(all: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    all.retain(|_| marks.next().is_some_and(|mark| *mark));
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
    fn components_are_forgotten_when_the_model_itself_moves() {
        let columns = [Column::new("a", ""), Column::new("part.b", "")];
        let stream = Stream::new(&columns, &[], None, Vec::new(), vec![0, 1]).unwrap();
        let mut stream = stream.for_default_picture();
        stream.rows(&[0.0, 0.5], &[1.0, 2.0, 1.0, 3.0]);
        assert_eq!(stream.trajectory.values("part.b"), Some(&[2.0, 3.0][..]));
        stream.row(0.75, &[1.5, 4.0]);
        stream.row(1.0, &[1.0, 5.0]);
        assert_eq!(stream.trajectory.values("a"), Some(&[1.0, 1.0, 1.5, 1.0][..]));
        assert_eq!(stream.trajectory.values("part.b"), None);
        assert_eq!(stream.trajectory.verify(), Ok(()));
    }

    #[test]
    fn rows_reach_the_kept_columns() {
        let columns = [Column::new("a", ""), Column::new("b", ""), Column::new("c", "")];
        let mut stream = Stream::new(&columns, &[], None, Vec::new(), vec![0, 2]).unwrap();
        stream.row(0.5, &[1.0, 2.0, 3.0]);
        assert_eq!(stream.trajectory.values("c"), Some(&[3.0][..]));
        assert_eq!(stream.trajectory.values("b"), None);
        assert_eq!(stream.finish(0.5).unwrap(), None);
    }
}
