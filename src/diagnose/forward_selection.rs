//! Forward selection: one effect after the other, for as long as the data support it.

use std::ops::Range;

use super::candidate_fit::CandidateFits;
use super::hypothesis::Hypothesis;
use super::rank::{Scored, rank};
use super::result::Diagnosis;
use super::search::{Search, accept};

/// Adds effects one after the other. `depths`: the numbers of effects before each of them.
pub fn forward_selection(search: &Search<'_>, diagnosis: &mut Diagnosis, depths: Range<usize>) {
    let policy = search.policy();
    for depth in depths {
        let resolved = match depth {
            0 => 0.0,
            _ if depth < policy.usual_effects => policy.resolved_train,
            _ => policy.many_effects_above,
        };
        if diagnosis.after.chi2_train() < resolved || !search.may_continue() {
            break;
        }
        let ranking = rank(search, &diagnosis.after);
        let total = diagnosis.after.train.total();
        let notable = if depth < policy.usual_effects { 0.0 } else { policy.notable_share * total };
        let mut proposals = promising(search, &diagnosis.after, &ranking);
        proposals.retain(|p| p.iter().all(|s| s.gain > notable));
        for s in ranking.iter().take(2 * policy.fitted_places) {
            let share = 100.0 * s.gain / total;
            let label = search.study.label(s.effect, &s.place);
            search.note(&format!("  score {share:5.1} %  {label} {:?}", s.shape));
        }
        diagnosis.rankings.push(ranking);
        let fits = CandidateFits { search, from: &diagnosis.after, proposals: &proposals, depth };
        let mut hypotheses = fits.run();
        let supported = |h: &Hypothesis| {
            h.bic() < diagnosis.after.bic() - policy.evidence
                && h.train.total() < total - notable
                && h.chi2_validation() < diagnosis.after.chi2_validation()
        };
        let first = hypotheses.iter().position(supported);
        let best = first.map(|k| hypotheses.remove(k));
        if let Some(best) = best {
            accept(search, diagnosis, best);
            diagnosis.rejected.extend(hypotheses);
        } else {
            diagnosis.rejected.extend(hypotheses);
            break;
        }
    }
}

/// The proposals, of one effect each, whose promise outweighs their parameters.
pub fn promising(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    ranking: &[Scored],
) -> Vec<Vec<Scored>> {
    let policy = search.policy();
    let supported = |s: &&Scored| s.bic_gain(hypothesis) > policy.evidence;
    ranking.iter().filter(supported).take(policy.fitted_places).map(|s| vec![s.clone()]).collect()
}
