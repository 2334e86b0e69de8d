//! The diagnostic: a message about a model with a stable code, labelled source spans, and a remedy.

use std::any::Any;
use std::sync::Arc;

use super::cause::Cause;
pub use super::cause::Severity;
use super::index::FastSet;
use super::source::Span;
use super::specification;

/// A message about the model, with the source spans it concerns and a remedy.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Why it is reported.
    pub cause: Arc<dyn Cause>,
    /// Stable code, such as `MO0201`; a retired code is never used again.
    pub code: &'static str,
    /// Error or warning.
    pub severity: Severity,
    /// One sentence, lower case, without full stop, in the user's names.
    pub message: String,
    /// The span it is about, which may be [`Span::NONE`], and the label shown there.
    pub primary: (Span, String),
    /// Further spans with their labels.
    pub secondary: Vec<(Span, String)>,
    /// How to repair the model.
    pub help: Option<String>,
    /// Background, such as the section of the Modelica specification.
    pub notes: Vec<String>,
}

impl PartialEq for Diagnostic {
    fn eq(&self, other: &Diagnostic) -> bool {
        self.digest() == other.digest()
    }
}

impl Diagnostic {
    /// A diagnostic at `span`, with the message, remedy and section of its cause.
    pub fn new(cause: impl Cause, span: Span) -> Self {
        let entry = cause.entry();
        Diagnostic {
            code: entry.code,
            severity: entry.severity,
            message: cause.message(),
            primary: (span, String::new()),
            secondary: Vec::new(),
            help: cause.help(),
            notes: specification::reference(entry.section).into_iter().collect(),
            cause: Arc::new(cause),
        }
    }
    /// Everything that it says, and where.
    fn digest(&self) -> String {
        let Diagnostic { code, severity, message, primary, secondary, help, notes, .. } = self;
        format!("{code} {severity:?} {message} {primary:?} {secondary:?} {help:?} {notes:?}")
    }
    /// Whether its cause is one of `C` for which `holds` is true.
    pub fn is<C: Cause>(&self, holds: impl FnOnce(&C) -> bool) -> bool {
        (&*self.cause as &dyn Any).downcast_ref::<C>().is_some_and(holds)
    }
    /// Sets the severity, where it depends on more than the cause.
    pub fn with_severity(mut self, severity: Severity) -> Self {
        self.severity = severity;
        self
    }
    /// Sets the label of the primary span.
    pub fn label(mut self, text: impl Into<String>) -> Self {
        self.primary.1 = text.into();
        self
    }
    /// Adds a further labelled span.
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        if !span.is_none() {
            self.secondary.push((span, text.into()));
        }
        self
    }
    /// Adds a note with background.
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }
}

/// The diagnostics that a stage has collected, so that one compilation reports many problems.
#[derive(Clone, Debug, Default)]
pub struct Problems {
    list: Vec<Diagnostic>,
    /// Everything that those of the list say, so that the cost of thousands stays linear.
    known: FastSet<String>,
}

impl PartialEq for Problems {
    fn eq(&self, other: &Problems) -> bool {
        self.list == other.list
    }
}

impl Problems {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }
    /// Adds a diagnostic unless the list already contains it.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.known.insert(diagnostic.digest()) {
            self.list.push(diagnostic);
        }
    }
    /// True if the list contains all of `other`.
    pub fn includes(&self, other: &Problems) -> bool {
        other.known.is_subset(&self.known)
    }
    /// Adds all of `other`.
    pub fn extend(&mut self, other: Problems) {
        other.list.into_iter().for_each(|d| self.push(d));
    }
    /// True if at least one is an error.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }
    /// Number of errors.
    pub fn error_count(&self) -> usize {
        self.list.iter().filter(|d| d.severity == Severity::Error).count()
    }
    /// Turns all warnings whose cause is one of `C` into errors.
    pub fn raise<C: Cause>(&mut self) {
        for d in self.list.iter_mut().filter(|d| d.is(|_: &C| true)) {
            d.severity = Severity::Error;
        }
        self.known = self.list.iter().map(Diagnostic::digest).collect();
    }
    /// Adds notes to the diagnostics with causes of a kind.
    pub fn add_note<C: Cause>(&mut self, text: impl Fn(&C) -> Option<String>) {
        for d in &mut self.list {
            let mut note = None;
            d.is(|cause: &C| {
                note = text(cause);
                true
            });
            d.notes.extend(note);
        }
        self.known = self.list.iter().map(Diagnostic::digest).collect();
    }
    /// Removes the errors with such a cause.
    pub fn remove_errors<C: Cause>(&mut self, is: impl Fn(&C) -> bool) {
        self.list.retain(|d| d.severity != Severity::Error || !d.is(&is));
        self.known = self.list.iter().map(Diagnostic::digest).collect();
    }
    /// Removes the diagnostics for which `is` is true.
    pub fn remove(&mut self, is: impl Fn(&Diagnostic) -> bool) {
        self.list.retain(|d| !is(d));
        self.known = self.list.iter().map(Diagnostic::digest).collect();
    }
    /// True if there are no diagnostics.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
    /// Sorted by file and offset; diagnostics without a span come last.
    pub fn sorted(&self) -> Vec<&Diagnostic> {
        let mut v: Vec<&Diagnostic> = self.list.iter().collect();
        v.sort_by_key(|d| (d.primary.0, d.code));
        v
    }
    /// In the order in which they were added.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }
}

/// The candidate closest to `wanted`, for "did you mean": at most a third of its letters differ. One that differs in case
/// and underscores alone comes first.
pub fn did_you_mean<'a>(
    wanted: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let limit = (wanted.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .filter(|c| *c != wanted)
        .map(|c| (letters(c) != letters(wanted), edit_distance(wanted, c), c))
        .filter(|(is_other, d, _)| !is_other || *d <= limit)
        .min()
        .map(|(.., c)| c)
}

/// The remedy "did you mean" if there is a candidate, else another one.
pub fn did_you_mean_or(near: &Option<String>, otherwise: impl Into<String>) -> Option<String> {
    Some(near.as_ref().map_or_else(|| otherwise.into(), |near| format!("did you mean `{near}`?")))
}

/// A name without case and underscores.
fn letters(name: &str) -> String {
    name.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect()
}

/// Case-insensitive Damerau-Levenshtein distance (optimal string alignment).
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let cost = usize::from(a[i - 1] != b[j - 1]);
            let mut d = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + cost);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                d = d.min(before[j - 2] + 1);
            }
            row.push(d);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggests_near_misses_only() {
        let names = ["p_supply", "t_dwell", "t_off"];
        assert_eq!(did_you_mean("p_suply", names), Some("p_supply"));
        assert_eq!(did_you_mean("t_dwlel", names), Some("t_dwell"));
        assert_eq!(did_you_mean("velocity", names), None);
        // One edit makes either of them, but only one is the same word.
        assert_eq!(did_you_mean("f0", ["f", "c0", "f_0"]), Some("f_0"));
        assert_eq!(did_you_mean("TStart", ["start", "T_start"]), Some("T_start"));
    }

    #[test]
    fn problems_are_sorted_by_span_and_reported_once() {
        use crate::base::source::FileId;
        crate::base::cause::causes! {
            enum Sample {
                /// The first.
                error MO0001 First => ("first");
                /// The second.
                warning MO0002 Second => ("second");
            }
        }
        let at = |s| Span::new(FileId(0), s, s + 1);
        let mut p = Problems::new();
        p.push(Diagnostic::new(Sample::Second, at(9)));
        p.push(Diagnostic::new(Sample::First, at(2)));
        p.push(Diagnostic::new(Sample::First, at(2)));
        let messages: Vec<_> = p.sorted().iter().map(|d| d.message.as_str()).collect();
        assert_eq!(messages, ["first", "second"]);
        assert_eq!((p.error_count(), Sample::ENTRIES.len()), (1, 2));
        assert!(p.sorted()[1].is(|c: &Sample| matches!(c, Sample::Second)));
    }
}
