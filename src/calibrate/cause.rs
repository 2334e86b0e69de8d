//! Diagnostics of plans and recordings.

use crate::base::cause::causes;
use crate::base::diag::did_you_mean_or;

causes! {
    /// Causes found in a plan, alone or together with its model.
    pub enum PlanCause {
        /// A unit is unknown.
        error MO1005 UnknownUnit { unit: String, near: Option<String>, known: String }
            => ("unknown unit `{unit}`"), remedy(did_you_mean_or(near, format!("known are {known}, and what models write, such as `mol/m3`")));
        /// A parameter cannot be fitted.
        error MO1049 NotFittable { name: String, why: &'static str }
            => ("`{name}` cannot be fitted: {why}"),
            help("free a Real parameter that enters equations only, or give this one a value in `[fixed]`");
        /// A column measures something else than its variable.
        error MO1047 UnitOfVariable { name: String, declared: String, given: String }
            => ("`{name}` is in `{declared}`, but the column in `{given}`"),
            help("correct the unit, or name the variable that the column measures");
        /// A column counts events where its variable measures an angle, or the other way round.
        error MO1051 ATurnApart { name: String, declared: String }
            => ("`{name}` is in `{declared}`, and a turn lies between it and the unit of the column"),
            help("`Hz` and `1/min` count events, `rad/s`, `rev/s` and `rpm` measure an angle: a turn each second is 2 pi rad/s; give the unit that the column means");
        /// A variable is not declared in an SI unit.
        error MO1048 NotInSi { name: String, declared: String, si: String }
            => ("`{name}` is in `{declared}`, but columns are converted to SI units"),
            help("declare it with `unit = \"{si}\", displayUnit = \"{declared}\"`");
        /// The bounds of a free parameter contradict each other or its start.
        error MO1006 ContradictoryBounds { name: String }
            => ("the bounds of `{name}` contradict each other or its start"),
            help("`min` must be less than `max`, and `start` between them");
        /// A signal refers to a variable that the model does not have.
        error MO1014 UnknownVariable { name: String, near: Option<String> }
            => ("the model has no variable `{name}`"),
            remedy(did_you_mean_or(near, "name a variable that changes during the run"));
        /// A plan refers to a parameter or start value that the model does not have.
        error MO1015 UnknownParameter { kind: &'static str, name: String, near: Option<String> }
            => ("the model has no {kind} `{name}`"), remedy(did_you_mean_or(near, SETTABLE));
        /// Two columns drive the same input.
        error MO1018 DrivenTwice { input: String, first: String }
            => ("`{input}` is already driven by `{first}`"),
            help("only one column can drive an input: remove the other one");
        /// No column drives an input.
        warning MO1050 NotDriven { input: String }
            => ("no column drives the input `{input}`, so it keeps its start value"),
            help("[inputs]: COLUMN = {{ input = \"{input}\", unit = \"...\", interpolation = \"linear\" }}");
        /// A plan has no signals.
        error MO1031 NoSignals
            => ("the plan has no signals"),
            help("[signals]: s_mm = {{ variable = \"s\", unit = \"mm\", sigma = 0.003 }}");
        /// An interpolation is unknown.
        error MO1032 UnknownInterpolation { name: String, known: String }
            => ("unknown interpolation `{name}`"), help("known are {known}");
        /// A number is negative.
        error MO1033 NegativeNumber { key: String }
            => ("`{key}` must not be negative");
        /// The length of windows is not positive.
        error MO1034 WindowNotPositive
            => ("`window` must be positive"),
            help("omit it, or write `inf`, for whole recordings");
        /// A count is not a positive Integer.
        error MO1035 NotACount { key: String }
            => ("`{key}` must be a positive Integer");
        /// The noise of a sensor is not positive.
        error MO1036 NoiseNotPositive
            => ("the noise of a sensor must be positive"),
            help("give the standard deviation in the unit of the column, or omit `sigma` to estimate it \
                  from the recordings");
        /// A parameter or start value is fixed when the model is compiled.
        error MO1043 NotSettable { kind: &'static str, name: String, near: Option<String> }
            => ("cannot set {kind} `{name}` without recompiling"), remedy(did_you_mean_or(near, SETTABLE));
        /// A parameter is both free and set by the recordings.
        error MO1044 FreeAndSet { name: String }
            => ("`{name}` is both free and set by the recordings"),
            help("remove it from `[free]`, or from `[starts]` or `[conditions]`");
        /// Two entries free the same parameter.
        error MO1046 FreeTwice { name: String }
            => ("`{name}` is free twice"),
            help("remove one of the entries: a parameter is free for all recordings together in `[free]`, \
                  or for each in `[free.each]`");
        /// A plan has conditions but no table that lists them.
        error MO1045 ConditionsWithoutTable
            => ("the plan has conditions but no table with their columns"),
            help("name the table in `[data]`, or set parameters in `[fixed]`");
    }
}

/// Which parameters a plan may refer to.
const SETTABLE: &str = "name a Real parameter that is not final and on which no structure depends";

causes! {
    /// Causes found in recordings.
    pub enum RecordingCause {
        /// The table or a recording cannot be read.
        error MO1010 Unreadable { why: String, is_table: bool }
            => ("{why}"),
            remedy(is_table.then(|| "`[data]` of the plan or `--data` names the folder".to_owned()));
        /// The time of a recording does not increase.
        error MO1011 TimeNotIncreasing { place: String, dropped: usize, rows: usize }
            => ("{}", match dropped {
                0 => format!("{place}: the recording has {}; it needs two or more", match rows {
                    1 => "1 row".to_owned(),
                    rows => format!("{rows} rows"),
                }),
                _ => format!("{place}: the time does not increase in {dropped} of {rows} rows, from here on"),
            }),
            help("{}", match dropped {
                0 => "record more, or remove the file from the table of the plan",
                _ => "sort the rows by time; single rows out of order are skipped automatically",
            });
        /// The noise of a signal cannot be estimated.
        error MO1012 UnknownNoise { column: String, is_smoothed: bool }
            => ("cannot estimate the noise of `{column}`"),
            help("{}", if *is_smoothed {
                "its column is smoothed: give `sigma`, the noise after smoothing"
            } else {
                "give `sigma`, the standard deviation of its noise"
            });
        /// A file does not have a column that the plan refers to.
        error MO1013 UnknownColumn { path: String, column: String, near: Option<String>, columns: String }
            => ("{path} has no column `{column}`"),
            remedy(did_you_mean_or(near, format!("its columns are {columns}")));
        /// No recording is for training.
        error MO1037 NoTraining { path: String }
            => ("{path}: no recording is for training"),
            help("the column named by `split` must contain `train` in at least one row");
        /// The use of a recording is unknown.
        error MO1038 UnknownSplit { place: String, found: String }
            => ("{place}: `{found}` is not `train`, `validation` or `test`");
        /// A condition in the table is not a number.
        error MO1039 ConditionNotANumber { place: String, found: String, column: String }
            => ("{place}: `{found}` of `{column}` is not a number");
        /// A part of a recording contains no rows.
        error MO1040 NoRows { path: String, name: String }
            => ("{path}: no rows of `{name}` remain"),
            help("`from` and `to` are times of the recording, in s; `skip` is less than they span, and \
                  than `window`, which spans several rows");
        /// Most values of a recording are missing.
        error MO1041 MostlyMissing { place: String }
            => ("{place}: more than half of the values are not numbers");
        /// A column has no values.
        error MO1042 EmptyColumn { path: String, column: String }
            => ("{path}: `{column}` has no values");
        /// No recording has a value of a signal.
        warning MO1052 NeverMeasured { column: String }
            => ("no recording has a value of `{column}`, so it is not compared"),
            help("values are numbers with a decimal point; remove the signal from the plan if it was not measured");
    }
}
