//! Explains singular systems in the user's names (Dulmage and Mendelsohn 1958).

use super::incidence::EquationSystem;
use super::{culprit, error, reduce};
use crate::base::diag::{Diagnostic, Problems};
use crate::base::index::IndexVec;
use crate::base::source::Span;
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::dulmage_mendelsohn::{self, Subsystem};
use crate::graph::matching::{self, Matching};
use crate::graph::pantelides;
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, Stated, Variable};
use crate::ir::expr::{ExprId, VarId};
use crate::ir::flat::Origin;
use crate::symbolic::print;

/// Reports surplus equations and undetermined unknowns, with derivatives identified with their
/// variables; `None` if there are any.
pub fn check_determined(dae: &Dae, stated: &Stated, problems: &mut Problems) -> Option<()> {
    let system = reduce::full_system(dae);
    let lowest = pantelides::lowest(&reduce::derivatives(dae, &system));
    // An unknown and its derivatives form one column, numbered like the lowest of them.
    let mut number = vec![None; lowest.len()];
    let mut unknowns = Vec::new();
    for (col, &low) in lowest.enumerate() {
        if col == low {
            number[col.0 as usize] = Some(Col(unknowns.len() as u32));
            unknowns.push(system.unknowns[col]);
        }
    }
    // An equation whose derivative is given belongs to one unknown with it.
    let mut counted = IndexVec::filled(true, system.sources.len());
    for (of, _) in reduce::given_derivatives(dae) {
        counted[of] = false;
    }
    let collapsed = Bipartite::from_rows(
        unknowns.len(),
        system.graph.rows().map(|row| {
            let cols: &[Col] = if counted[row] { system.graph.cols(row) } else { &[] };
            let lows = cols.iter().map(|col| lowest[*col]);
            lows.filter_map(|low| number[low.0 as usize]).collect::<Vec<_>>()
        }),
    );
    let matched = matching::maximum(&collapsed, |_, _| true, Matching::empty(&collapsed));
    let (rows, cols) = (counted.iter().filter(|c| **c).count(), unknowns.len());
    if matched.cardinality() == rows && rows == cols {
        return Some(());
    }
    let parts = dulmage_mendelsohn::decompose(&collapsed, &matched);
    // Count like the user: each eliminated variable is one equation and one unknown.
    let trivial = dae.eliminated.len();
    let counts = (rows + trivial, cols + trivial);
    let named = |part: &Subsystem| -> (Vec<Source>, Vec<VarId>) {
        let sources = part.rows.iter().map(|row| system.sources[*row]);
        (sources.collect(), part.cols.iter().map(|col| unknowns[col.0 as usize]).collect())
    };
    let blame = culprit::find(dae, stated).unwrap_or_default();
    let blamed = error::Blamed { dae, stated, blame: &blame, counts };
    if blame.over.is_found() || blame.under.is_found() {
        if blame.over.is_found() {
            problems.push(blamed.too_many_equations());
        }
        if blame.under.is_found() {
            problems.push(blamed.too_few_equations());
        }
        return None;
    }
    if !parts.over_determined.rows.is_empty() {
        let (sources, variables) = named(&parts.over_determined);
        let excess = sources.len() - variables.len();
        problems.push(error::too_many_equations(dae, counts, excess, &sources, &variables));
    }
    if !parts.under_determined.cols.is_empty() {
        let (sources, variables) = named(&parts.under_determined);
        let missing = variables.len() - sources.len();
        problems.push(error::too_few_equations(dae, counts, missing, &sources, &variables));
    }
    None
}

/// The error for a system that has no perfect matching after state selection.
pub fn lost_rank(dae: &Dae, system: &EquationSystem, matched: &Matching) -> Diagnostic {
    let parts = dulmage_mendelsohn::decompose(&system.graph, matched);
    let sources: Vec<Source> =
        parts.over_determined.rows.iter().map(|row| system.sources[*row]).collect();
    let mut equations: Vec<_> = sources
        .iter()
        .filter_map(|source| match source {
            Source::Continuous(id) => Some(*id),
            _ => None,
        })
        .collect();
    equations.sort_unstable();
    error::dependent(dae, &equations)
}

/// The error for too many initial equations and fixed starts.
pub fn initially_too_many(dae: &Dae, system: &EquationSystem, matched: &Matching) -> Diagnostic {
    let parts = dulmage_mendelsohn::decompose(&system.graph, matched);
    let part = &parts.over_determined;
    let sources: Vec<Source> = part.rows.iter().map(|row: &Row| system.sources[*row]).collect();
    let variables: Vec<VarId> = part.cols.iter().map(|col| system.unknowns[*col]).collect();
    error::initially_too_many(dae, sources.len() - variables.len(), &sources, &variables)
}

/// The error for fixed starts of variables that equations give other values.
pub fn contradicted_constants(dae: &Dae, contradicted: &[(VarId, ExprId)]) -> Diagnostic {
    let variables: Vec<VarId> = contradicted.iter().map(|(v, _)| *v).collect();
    let starts: Vec<Source> = variables.iter().copied().map(Source::Start).collect();
    let mut d = error::initially_too_many(dae, starts.len(), &starts, &variables);
    let names = |v: VarId| dae.variables[v].name.clone();
    for (v, value) in contradicted.iter().take(4) {
        let value = print::print(&dae.graph, *value, &names);
        d = d.note(format!("the equations give `{}` the value `{value}`", names(*v)));
    }
    d
}

/// The error for a variable that cannot be computed at the start.
pub fn initially_open(dae: &Dae, v: VarId) -> Diagnostic {
    error::initially_open(&dae.variables[v])
}

/// The span of an equation and the component it belongs to.
pub fn origin(dae: &Dae, source: Source) -> Origin {
    match source {
        Source::Continuous(id) => dae.equations[id].origin.clone(),
        Source::Discrete(i) => dae.discrete[i].origin.clone(),
        Source::Initial(i) => dae.initial[i].origin.clone(),
        Source::Start(v) => Origin { span: dae.variables[v].span, component: "".into() },
    }
}

/// A readable list of names: at most six, then the number of further ones.
pub fn list<'a>(variables: impl IntoIterator<Item = &'a Variable>) -> String {
    let names: Vec<String> = variables.into_iter().map(|v| format!("`{}`", v.name)).collect();
    let shown = if names.len() > 7 { 6 } else { names.len() };
    match (&names[..shown], names.len() - shown) {
        ([], _) => String::new(),
        ([one], 0) => one.clone(),
        (some, 0) => format!("{} and {}", some[..shown - 1].join(", "), some[shown - 1]),
        (some, more) => format!("{} and {more} more", some.join(", ")),
    }
}

/// Adds the spans of equations to a diagnostic, the first as the primary one.
pub fn with_places(
    diagnostic: Diagnostic,
    dae: &Dae,
    sources: &[Source],
    label: impl Fn(Source, &Origin) -> String,
) -> Diagnostic {
    let labelled = sources.iter().map(|&source| {
        let origin = origin(dae, source);
        let text = label(source, &origin);
        (origin, text)
    });
    with_labels(diagnostic, labelled)
}

/// Adds the spans of equations with their labels to a diagnostic, the first as the primary one.
pub fn with_labels(
    mut diagnostic: Diagnostic,
    labelled: impl IntoIterator<Item = (Origin, String)>,
) -> Diagnostic {
    const SHOWN: usize = 6;
    let mut places: Vec<(Span, String)> = Vec::new();
    for (origin, text) in labelled {
        if !origin.span.is_none() && !places.iter().any(|(_, t)| !t.is_empty() && *t == text) {
            places.push((origin.span, text));
        }
    }
    let more = places.len().saturating_sub(SHOWN);
    for (i, (span, text)) in places.into_iter().take(SHOWN).enumerate() {
        if i == 0 {
            diagnostic.primary = (span, text);
        } else {
            diagnostic.secondary.push((span, text));
        }
    }
    if more > 0 {
        diagnostic = diagnostic.note(format!("and {more} more equations"));
    }
    diagnostic
}
