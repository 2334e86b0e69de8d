//! Reads plan files.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::source::{FileId, SourceMap, Span};
use crate::numeric::time_series::Interpolation;

use super::cause::{PlanCause, RecordingCause};
use super::data::Split;
use super::plan::{Condition, DrivenInput, Free, InitialValue, ListedRecording, Plan, Signal};
use super::unit::Unit;

/// Reads a plan file. Errors are added to `problems`.
pub fn read(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Plan> {
    let file = sources.add(path, text);
    let before = problems.error_count();
    let root = match DeTable::parse(text) {
        Ok(root) => root,
        Err(why) => {
            let span = why.span().unwrap_or(0..0);
            let cause = PlanCause::NotToml { why: why.message().to_owned() };
            problems.push(Diagnostic::new(cause, Span::new(file, span.start, span.end)));
            return None;
        }
    };
    let whole = root.span();
    let mut r = PlanReader { file, problems };
    let folder_of_plan = path.parent().unwrap_or(Path::new(""));
    let plan = r.plan(root.get_ref(), &whole, path, folder_of_plan);
    (problems.error_count() == before).then_some(plan)
}

type Table<'t> = DeTable<'t>;
type Value<'t> = Spanned<DeValue<'t>>;

struct PlanReader<'a> {
    file: FileId,
    problems: &'a mut Problems,
}

/// The table of `[free]` with the parameters that are free for each recording; a keyword of Modelica, so no
/// parameter has this name.
const EACH: &str = "each";

const TOP: [&str; 15] = [
    "model",
    "name",
    "libraries",
    "fixed",
    "data",
    "recordings",
    "window",
    "skip",
    "every",
    "conditions",
    "inputs",
    "starts",
    "time",
    "signals",
    "free",
];

impl PlanReader<'_> {
    fn plan(&mut self, root: &Table<'_>, whole: &Range<usize>, path: &Path, base: &Path) -> Plan {
        self.known(root, &TOP);
        let model = self.required(root, "model", whole);
        let data = self.table(root, "data", whole);
        let (mut folder, mut table) = (String::new(), String::new());
        let (mut file_column, mut name_column, mut split_column) = (String::new(), None, None);
        if let Some((data, span)) = data {
            self.known(data, &["folder", "table", "file", "recording", "split"]);
            folder = self.required(data, "folder", &span);
            if root.get("recordings").is_none() || data.get("table").is_some() {
                table = self.required(data, "table", &span);
                file_column = self.required(data, "file", &span);
            } else if ["file", "recording", "split"].iter().any(|key| data.get(*key).is_some()) {
                // Columns of a table that the plan does not have.
                self.missing("table", &span);
            }
            name_column = self.text(data, "recording");
            split_column = self.text(data, "split");
        }
        let (mut time, mut time_unit) = (String::new(), None);
        if let Some((at, span)) = self.table(root, "time", whole) {
            self.known(at, &["column", "unit"]);
            time = self.required(at, "column", &span);
            time_unit = self.unit(at, &span).map(|(u, _)| u);
        }
        let mut fixed = Vec::new();
        for (name, value) in self.entries(root, "fixed") {
            let text = match value.get_ref() {
                DeValue::String(text) => text.to_string(),
                DeValue::Float(x) => x.as_str().to_owned(),
                DeValue::Integer(i) => i.as_str().to_owned(),
                DeValue::Boolean(b) => b.to_string(),
                _ => {
                    self.wrong(value, "a number, a string, `true` or `false`");
                    continue;
                }
            };
            fixed.push(format!("{name}={text}"));
        }
        let (free, each) = self.all_free(root);
        let plan = Plan {
            path: path.to_owned(),
            memory: Arc::default(),
            model: base.join(model),
            name: self.text(root, "name"),
            libraries: self.texts(root, "libraries").into_iter().map(|f| base.join(f)).collect(),
            fixed,
            folder: base.join(folder),
            listed: self.listed(root),
            window: self.window(root).unwrap_or(f64::INFINITY),
            skip: self.positive(root, "skip").unwrap_or(0.0),
            every: self.count(root, "every").unwrap_or(1),
            table,
            file_column,
            name_column,
            split_column,
            conditions: self.conditions(root),
            inputs: self.inputs(root),
            starts: self.starts(root),
            time,
            time_unit: time_unit.unwrap_or(Unit::SECOND),
            signals: self.signals(root, whole),
            free,
            each,
        };
        self.contradictions(&plan);
        plan
    }

    fn conditions(&mut self, root: &Table<'_>) -> Vec<Condition> {
        let mut out = Vec::new();
        for (column, value) in self.entries(root, "conditions") {
            let Some((table, span)) = self.as_table(&column, value) else { continue };
            self.known(table, &["parameter", "unit"]);
            let parameter = self.required(table, "parameter", &span);
            if let Some((unit, unit_name)) = self.unit(table, &span) {
                out.push(Condition { column, parameter, unit, unit_name, span: self.at(&span) });
            }
        }
        out
    }

    fn listed(&mut self, root: &Table<'_>) -> Vec<ListedRecording> {
        let Some(value) = root.get("recordings") else { return Vec::new() };
        let DeValue::Array(list) = value.get_ref() else {
            self.wrong(value, "a list of tables `[[recordings]]`");
            return Vec::new();
        };
        let mut out = Vec::new();
        for item in list.iter() {
            let Some((table, span)) = self.as_table("recordings", item) else { continue };
            self.known(table, &["file", "name", "split", "from", "to", "window", "skip"]);
            let file = self.required(table, "file", &span);
            let named = self.text(table, "split");
            let split = Split::named(named.as_deref()).unwrap_or_else(|| {
                self.wrong(item, "`split = \"train\"`, `\"validation\"` or `\"test\"`");
                Split::Train
            });
            let [from, to] = ["from", "to"].map(|key| self.number(table, key).map(|x| x.0));
            out.push(ListedRecording {
                name: self.text(table, "name").unwrap_or_else(|| file.clone()),
                file,
                split,
                part: (from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)),
                window: self.window(table),
                skip: self.positive(table, "skip"),
            });
        }
        out
    }

    fn inputs(&mut self, root: &Table<'_>) -> Vec<DrivenInput> {
        let mut out = Vec::new();
        for (column, value) in self.entries(root, "inputs") {
            let Some((table, span)) = self.as_table(&column, value) else { continue };
            self.known(table, &["input", "unit", "interpolation", "smooth", "every", "absent"]);
            let input = self.required(table, "input", &span);
            let wanted = self.required(table, "interpolation", &span);
            let found = Interpolation::ALL.iter().find(|(name, _)| *name == wanted);
            if found.is_none() && !wanted.is_empty() {
                let known = Interpolation::ALL.map(|(name, _)| name).join(", ");
                self.report(PlanCause::UnknownInterpolation { name: wanted, known }, &span);
            }
            let smooth = self.positive(table, "smooth").unwrap_or(0.0);
            let every = self.count(table, "every").unwrap_or(1).max(1);
            let absent = self.number(table, "absent").map(|(value, _)| value);
            if let (Some((unit, _)), Some((_, interpolation))) = (self.unit(table, &span), found) {
                let (interpolation, span) = (*interpolation, self.at(&span));
                out.push(DrivenInput {
                    column,
                    input,
                    unit,
                    interpolation,
                    smooth,
                    every,
                    absent,
                    span,
                });
            }
        }
        out
    }

    fn starts(&mut self, root: &Table<'_>) -> Vec<InitialValue> {
        let mut out = Vec::new();
        for (target, value) in self.entries(root, "starts") {
            let Some((table, span)) = self.as_table(&target, value) else { continue };
            self.known(table, &["column", "unit", "rate", "smooth"]);
            let column = self.required(table, "column", &span);
            let rate = match table.get("rate").map(|v| (v, v.get_ref())) {
                Some((_, DeValue::Boolean(b))) => *b,
                Some((v, _)) => {
                    self.wrong(v, "`true` or `false`");
                    false
                }
                None => false,
            };
            let smooth = self.positive(table, "smooth").unwrap_or(0.0);
            if let Some((unit, _)) = self.unit(table, &span) {
                out.push(InitialValue { target, column, unit, rate, smooth, span: self.at(&span) });
            }
        }
        out
    }

    /// A number that is not negative.
    fn positive(&mut self, table: &Table<'_>, key: &str) -> Option<f64> {
        let (number, span) = self.number(table, key)?;
        if number >= 0.0 && number.is_finite() {
            return Some(number);
        }
        self.report(PlanCause::NegativeNumber { key: key.to_owned() }, &span);
        None
    }

    /// The length of windows.
    fn window(&mut self, table: &Table<'_>) -> Option<f64> {
        let (number, span) = self.number(table, "window")?;
        if number > 0.0 {
            return Some(number);
        }
        self.report(PlanCause::WindowNotPositive, &span);
        None
    }

    /// A positive Integer.
    fn count(&mut self, table: &Table<'_>, key: &str) -> Option<usize> {
        let (number, span) = self.number(table, key)?;
        if number >= 1.0 && number.fract() == 0.0 && number < 1e15 {
            return Some(number as usize);
        }
        self.report(PlanCause::NotACount { key: key.to_owned() }, &span);
        None
    }

    /// Entries that are valid alone and contradict each other.
    fn contradictions(&mut self, plan: &Plan) {
        for (k, driven) in plan.inputs.iter().enumerate() {
            if let Some(first) = plan.inputs[..k].iter().find(|d| d.input == driven.input) {
                let (input, first) = (driven.input.clone(), first.column.clone());
                let cause = PlanCause::DrivenTwice { input, first };
                self.problems.push(Diagnostic::new(cause, driven.span));
            }
        }
        let free = || plan.free.iter().chain(&plan.each);
        let starts = plan.starts.iter().map(|s| (&s.target, s.span));
        let conditions = plan.conditions.iter().map(|c| (&c.parameter, c.span));
        for (target, span) in starts.chain(conditions) {
            if free().any(|f| f.targets.contains(target)) {
                let cause = PlanCause::FreeAndSet { name: target.clone() };
                self.problems.push(Diagnostic::new(cause, span));
            }
        }
        for (k, later) in free().enumerate() {
            let known = |target: &&String| free().take(k).any(|f| f.targets.contains(target));
            if let Some(target) = later.targets.iter().find(known) {
                let cause = PlanCause::FreeTwice { name: target.clone() };
                self.problems.push(Diagnostic::new(cause, later.span));
            }
        }
        if let Some(first) = plan.conditions.first().filter(|_| plan.table.is_empty()) {
            self.problems.push(Diagnostic::new(PlanCause::ConditionsWithoutTable, first.span));
        }
        for signal in plan.signals.iter().filter(|s| s.smooth > 0.0 && s.sigma.is_none()) {
            let column = signal.column.clone();
            let cause = RecordingCause::UnknownNoise { column, is_smoothed: true };
            self.problems.push(Diagnostic::new(cause, signal.span));
        }
    }

    fn signals(&mut self, root: &Table<'_>, whole: &Range<usize>) -> Vec<Signal> {
        let mut out = Vec::new();
        for (column, value) in self.entries(root, "signals") {
            let Some((table, span)) = self.as_table(&column, value) else { continue };
            self.known(table, &["variable", "unit", "sigma", "smooth"]);
            let smooth = self.positive(table, "smooth").unwrap_or(0.0);
            let variable = self.required(table, "variable", &span);
            let sigma = self.number(table, "sigma");
            if let Some((sigma, at)) = &sigma
                && !(*sigma > 0.0 && sigma.is_finite())
            {
                self.report(PlanCause::NoiseNotPositive, at);
            }
            if let Some((unit, unit_name)) = self.unit(table, &span) {
                let (sigma, span) = (sigma.map(|s| s.0), self.at(&span));
                out.push(Signal { column, variable, unit, unit_name, sigma, smooth, span });
            }
        }
        if out.is_empty() && self.problems.error_count() == 0 {
            self.report(PlanCause::NoSignals, whole);
        }
        out
    }

    /// The parameters that are free for all recordings together, and those that are free for each.
    fn all_free(&mut self, root: &Table<'_>) -> (Vec<Free>, Vec<Free>) {
        let (each, shared): (Vec<_>, Vec<_>) =
            self.entries(root, "free").into_iter().partition(|(name, _)| name == EACH);
        let mut of_each = Vec::new();
        for (_, value) in each {
            let Some((table, _)) = self.as_table(EACH, value) else { continue };
            let entries = table.iter().map(|(k, v)| (k.get_ref().to_string(), v)).collect();
            of_each.extend(self.free(entries));
        }
        (self.free(shared), of_each)
    }

    fn free(&mut self, entries: Vec<(String, &Value<'_>)>) -> Vec<Free> {
        let mut out = Vec::new();
        for (name, value) in entries {
            let span = value.span();
            let Some((table, _)) = self.as_table(&name, value) else { continue };
            self.known(table, &["start", "min", "max", "tied"]);
            let mut targets = self.texts(table, "tied");
            if targets.is_empty() {
                targets.push(name.clone());
            }
            let [start, min, max] =
                ["start", "min", "max"].map(|key| self.number(table, key).map(|x| x.0));
            let low = min.unwrap_or(f64::NEG_INFINITY);
            let high = max.unwrap_or(f64::INFINITY);
            let is_room = low < high;
            if !is_room || start.is_some_and(|s| !(low..=high).contains(&s)) {
                self.report(PlanCause::ContradictoryBounds { name: name.clone() }, &span);
            }
            let (acts_on, only, span) = (None, None, self.at(&span));
            out.push(Free { name, targets, start, min, max, acts_on, only, span });
        }
        out
    }

    fn at(&self, span: &Range<usize>) -> Span {
        Span::new(self.file, span.start, span.end)
    }

    fn report(&mut self, cause: PlanCause, place: &Range<usize>) {
        self.problems.push(Diagnostic::new(cause, self.at(place)));
    }

    /// Reports unknown keys.
    fn known(&mut self, table: &Table<'_>, keys: &[&str]) {
        for key in table.keys() {
            let name: &str = key.get_ref();
            if !keys.contains(&name) {
                let near = did_you_mean(name, keys.iter().copied()).map(str::to_owned);
                let known = keys.join(", ");
                let cause = PlanCause::UnknownKey { key: name.to_owned(), near, known };
                self.report(cause, &key.span());
            }
        }
    }

    fn missing(&mut self, key: &str, within: &Range<usize>) {
        self.report(PlanCause::MissingKey { key: key.to_owned() }, within);
    }

    fn wrong(&mut self, value: &Value<'_>, expected: &'static str) {
        self.report(PlanCause::WrongType { expected }, &value.span());
    }

    fn table<'t>(
        &mut self,
        root: &'t Table<'t>,
        key: &str,
        within: &Range<usize>,
    ) -> Option<(&'t Table<'t>, Range<usize>)> {
        let Some(value) = root.get(key) else {
            self.missing(key, within);
            return None;
        };
        self.as_table(key, value)
    }

    fn as_table<'t>(
        &mut self,
        _name: &str,
        value: &'t Value<'t>,
    ) -> Option<(&'t Table<'t>, Range<usize>)> {
        match value.get_ref() {
            DeValue::Table(table) => Some((table, value.span())),
            _ => {
                self.wrong(value, "a table `{ ... }`");
                None
            }
        }
    }

    fn entries<'t>(&mut self, root: &'t Table<'t>, key: &str) -> Vec<(String, &'t Value<'t>)> {
        let Some(value) = root.get(key) else { return Vec::new() };
        let Some((table, _)) = self.as_table(key, value) else { return Vec::new() };
        table.iter().map(|(k, v)| (k.get_ref().to_string(), v)).collect()
    }

    fn text(&mut self, table: &Table<'_>, key: &str) -> Option<String> {
        let value = table.get(key)?;
        match value.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            _ => {
                self.wrong(value, "a string in quotes");
                None
            }
        }
    }

    fn texts(&mut self, table: &Table<'_>, key: &str) -> Vec<String> {
        let Some(value) = table.get(key) else { return Vec::new() };
        let DeValue::Array(list) = value.get_ref() else {
            self.wrong(value, "a list of strings");
            return Vec::new();
        };
        let mut out = Vec::new();
        for item in list.iter() {
            match item.get_ref() {
                DeValue::String(text) => out.push(text.to_string()),
                _ => self.wrong(item, "a string in quotes"),
            }
        }
        out
    }

    fn required(&mut self, table: &Table<'_>, key: &str, within: &Range<usize>) -> String {
        if table.get(key).is_none() {
            self.missing(key, within);
        }
        self.text(table, key).unwrap_or_default()
    }

    fn number(&mut self, table: &Table<'_>, key: &str) -> Option<(f64, Range<usize>)> {
        let value = table.get(key)?;
        let number = match value.get_ref() {
            DeValue::Float(x) => x.as_str().replace('_', "").parse().ok(),
            DeValue::Integer(i) => i.as_str().replace('_', "").parse().ok(),
            _ => None,
        };
        if number.is_none() {
            self.wrong(value, "a number");
        }
        number.map(|n: f64| (n, value.span()))
    }

    fn unit(&mut self, table: &Table<'_>, within: &Range<usize>) -> Option<(Unit, String)> {
        let name = self.required(table, "unit", within);
        let value = table.get("unit")?;
        let unit = Unit::of(&name);
        if unit.is_none() && matches!(value.get_ref(), DeValue::String(_)) {
            let names: Vec<&str> = Unit::names().collect();
            let near = did_you_mean(&name, names.iter().copied()).map(str::to_owned);
            let (unit, known) = (name.clone(), names.join(", "));
            self.report(PlanCause::UnknownUnit { unit, near, known }, &value.span());
        }
        unit.map(|u| (u, name))
    }
}
