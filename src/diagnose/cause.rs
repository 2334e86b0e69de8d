//! Diagnostics of a diagnosis.

use crate::base::cause::causes;
use crate::base::diag::did_you_mean_or;

causes! {
    /// Causes found in the catalogue of effects.
    pub enum CatalogueCause {
        /// A class with an annotation `__mocc` cannot be used as an effect.
        warning MO1019 UnusableEffect { class: String, why: String }
            => ("cannot use `{class}`: {why}"),
            help("the comment in `lib/Effects/package.mo` describes the annotation `__mocc`");
        /// The folder of further effects cannot be searched.
        error MO1020 UnreadableEffects { folder: String, why: String }
            => ("cannot read effects from `{folder}`: {why}"),
            help("give `--effects` a folder with a file `NAME.mo` for each effect `NAME`, or with packages of effects");
        /// The folder of further effects has none.
        warning MO1021 NoEffects { folder: String, searched: usize }
            => ("no class in `{folder}` is an effect: {}", match searched {
                0 => "it has no files `NAME.mo` and no packages".to_owned(),
                1 => "the one found there has no annotation `__mocc(effect = ...)`".to_owned(),
                n => format!("none of the {n} found there has an annotation `__mocc(effect = ...)`"),
            }),
            help("write each effect `NAME` in a file `NAME.mo`, with the annotation that `lib/Effects/package.mo` describes");
        /// An effect of the user's own cannot be attached to the model anywhere.
        warning MO1022 FitsNowhere { class: String, why: String }
            => ("`{class}` fits nowhere in the model: {why}"),
            help("the comment in `lib/Effects/package.mo` says where an effect is attached");
        /// The search is restricted to an effect that does not exist.
        error MO1023 UnknownEffect { name: String, near: Option<String> }
            => ("there is no effect `{name}`"),
            remedy(did_you_mean_or(near, "`mocc lib list Effects` lists the shipped effects"));
    }
}
