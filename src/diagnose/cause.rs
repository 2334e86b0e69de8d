//! Diagnostics of a diagnosis.

use crate::base::cause::causes;

causes! {
    /// Causes found in the catalogue of effects.
    pub enum CatalogueCause {
        /// A class with an annotation `__mocc` cannot be used as an effect.
        warning MO1019 UnusableEffect { class: String, why: String }
            => ("cannot use `{class}`: {why}"),
            help("the comment in `lib/Effects/package.mo` describes the annotation `__mocc`");
    }
}
