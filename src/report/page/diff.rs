//! The unified difference of two texts.
//!
//! A longest common subsequence by dynamic programming: J. W. Hunt, M. D. McIlroy, "An algorithm for
//! differential file comparison", Bell Laboratories 1976.

use crate::report::markup::escaped;

/// Entries of the table of a comparison at most; larger differences are not aligned.
const MOST_ENTRIES: usize = 1 << 25;
/// Lines of context around a change.
const CONTEXT: usize = 3;

/// A line of both texts, of the first, or of the second.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Edit<'a> {
    Same(&'a str),
    Removed(&'a str),
    Added(&'a str),
}

/// The unified difference as lines of plain text; nothing if the texts are equal.
pub fn plain(before: &str, after: &str) -> Vec<String> {
    let edits = edits(before, after);
    let is_near = |k: usize| {
        let around = k.saturating_sub(CONTEXT)..(k + CONTEXT + 1).min(edits.len());
        edits[around].iter().any(|e| !matches!(e, Edit::Same(_)))
    };
    let mut out = Vec::new();
    let (mut old, mut new, mut shown) = (1, 1, false);
    for (k, edit) in edits.iter().enumerate() {
        let is_shown = is_near(k);
        if is_shown && !shown {
            out.push(format!("@@ -{old} +{new} @@"));
        }
        shown = is_shown;
        let (sign, text) = match edit {
            Edit::Same(text) => (' ', text),
            Edit::Removed(text) => ('-', text),
            Edit::Added(text) => ('+', text),
        };
        if shown {
            out.push(format!("{sign}{text}"));
        }
        old += usize::from(sign != '+');
        new += usize::from(sign != '-');
    }
    out
}

/// The unified difference as markup; nothing if the texts are equal.
pub fn unified(before: &str, after: &str) -> String {
    let edits = edits(before, after);
    let changed = |e: &Edit<'_>| !matches!(e, Edit::Same(_));
    let mut out = String::new();
    let (mut old, mut new) = (1, 1);
    let mut shown = false;
    for (k, edit) in edits.iter().enumerate() {
        let around = k.saturating_sub(CONTEXT)..(k + CONTEXT + 1).min(edits.len());
        if edits[around].iter().any(changed) {
            if !shown {
                out.push_str(&format!("<span class=\"at\">@@ -{old} +{new} @@</span>"));
            }
            let (class, sign, text) = match edit {
                Edit::Same(text) => ("same", ' ', text),
                Edit::Removed(text) => ("minus", '-', text),
                Edit::Added(text) => ("plus", '+', text),
            };
            out.push_str(&format!("<span class=\"{class}\">{sign}{}\n</span>", escaped(text)));
            shown = true;
        } else {
            shown = false;
        }
        old += usize::from(!matches!(edit, Edit::Added(_)));
        new += usize::from(!matches!(edit, Edit::Removed(_)));
    }
    if out.is_empty() { out } else { format!("<pre class=\"diff\">{out}</pre>\n") }
}

fn edits<'a>(before: &'a str, after: &'a str) -> Vec<Edit<'a>> {
    let (a, b): (Vec<&str>, Vec<&str>) = (before.lines().collect(), after.lines().collect());
    // A common prefix needs no table.
    let head = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let (rest_a, rest_b) = (&a[head..], &b[head..]);
    // Neither does a common suffix.
    let tail = rest_a.iter().rev().zip(rest_b.iter().rev()).take_while(|(x, y)| x == y).count();
    let same = &rest_a[rest_a.len() - tail..];
    let (rest_a, rest_b) = (&rest_a[..rest_a.len() - tail], &rest_b[..rest_b.len() - tail]);
    let width = rest_b.len() + 1;
    if rest_a.len().saturating_mul(width) > MOST_ENTRIES {
        let removed = rest_a.iter().map(|l| Edit::Removed(l));
        let added = rest_b.iter().map(|l| Edit::Added(l));
        let around = |lines: &[&'a str]| lines.iter().map(|l| Edit::Same(l)).collect::<Vec<_>>();
        return around(&a[..head])
            .into_iter()
            .chain(removed)
            .chain(added)
            .chain(around(same))
            .collect();
    }
    let mut longest = vec![0u32; (rest_a.len() + 1) * width];
    for i in (0..rest_a.len()).rev() {
        for j in (0..rest_b.len()).rev() {
            longest[i * width + j] = if rest_a[i] == rest_b[j] {
                longest[(i + 1) * width + j + 1] + 1
            } else {
                longest[(i + 1) * width + j].max(longest[i * width + j + 1])
            };
        }
    }
    let mut out: Vec<Edit<'_>> = a[..head].iter().map(|l| Edit::Same(l)).collect();
    let (mut i, mut j) = (0, 0);
    while i < rest_a.len() || j < rest_b.len() {
        if i < rest_a.len() && j < rest_b.len() && rest_a[i] == rest_b[j] {
            out.push(Edit::Same(rest_a[i]));
            (i, j) = (i + 1, j + 1);
        } else if j == rest_b.len()
            || (i < rest_a.len() && longest[(i + 1) * width + j] >= longest[i * width + j + 1])
        {
            out.push(Edit::Removed(rest_a[i]));
            i += 1;
        } else {
            out.push(Edit::Added(rest_b[j]));
            j += 1;
        }
    }
    out.extend(same.iter().map(|l| Edit::Same(l)));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_is_changed() {
        use Edit::{Added, Removed, Same};
        assert_eq!(
            edits("a\nb\nc\nd", "a\nc\nx\nd\ny"),
            [Same("a"), Removed("b"), Same("c"), Added("x"), Same("d"), Added("y")]
        );
        assert_eq!(unified("a\nb", "a\nb\n"), "");
        assert_eq!(plain("a\nb\nc", "a\nc"), ["@@ -1 +1 @@", " a", "-b", " c"]);
        assert_eq!(edits("a\nb\nc", "x\nb\nc"), [Removed("a"), Added("x"), Same("b"), Same("c")]);
        assert_eq!(
            unified("a<", "b"),
            "<pre class=\"diff\"><span class=\"at\">@@ -1 +1 @@</span><span class=\"minus\">-a&lt;\n</span><span class=\"plus\">+b\n</span></pre>\n"
        );
    }
}
