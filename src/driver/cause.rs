//! Diagnostics of requests: files, models and inputs that the user names.

use crate::base::cause::causes;
use crate::base::diag::did_you_mean_or;

causes! {
    /// Causes found in a request.
    pub enum RequestCause {
        /// The user's file cannot be read.
        error MO0100 UnreadableFile { path: String, why: String, near: Option<String> }
            => ("cannot read `{path}`: {why}"),
            remedy(did_you_mean_or(near, "check the path; it is read from the folder where mocc runs"));
        /// No model has this name.
        error MO0104 UnknownModel { name: String, near: Option<String> }
            => ("there is no model `{name}`"),
            remedy(did_you_mean_or(
                near,
                "check the name, or name the folder of its library with `--lib DIR`",
            ));
        /// A file has no model that can be instantiated.
        error MO0106 NoModelInFile
            => ("this file has no model that can be instantiated"),
            help("write a model that is not partial, or name one with `--model`");
        /// A request names neither a file nor a model.
        error MO0107 NothingNamed
            => ("neither a file nor a model is named"),
            help("name a file, or a model of a library with `--model`");
        /// A partial model cannot be instantiated.
        error MO0108 PartialModel { name: String } (section "4.4.2")
            => ("cannot instantiate `{name}`: it is partial"),
            help("name a model that extends it with `--model`");
        /// A package or a function cannot be simulated.
        error MO0109 NotAModel { name: String }
            => ("`{name}` is a package or a function, not a model"),
            help("name a model with `--model`");
        /// The folder of a library does not exist.
        error MO0110 NoSuchFolder { folder: String }
            => ("there is no folder `{folder}`"),
            help("name the folder that contains the library with `--lib DIR`; it is read from the folder where mocc runs");
        /// A file is of another kind, by its extension.
        error MO0111 NotAModelFile { path: String, why: &'static str }
            => ("`{path}` is not a file of models, which ends in `.mo` or `.mol`"),
            help("{why}");
        /// The start value of a variable that is the same as another one.
        error MO1420 StartOfAlias { name: String, root: String }
            => ("the start value of `{name}` has no effect: `{name}` is the same as `{root}`, whose start value counts"),
            help("set `{root}.start` instead");
        /// A flat model is too large to be printed.
        error MO0275 FlatModelTooLarge { why: String }
            => ("{why}"),
            help("`mocc simulate` runs it, and `mocc structure` shows its blocks");
        /// A recording should drive an input that the model does not have.
        error MO1017 UnknownInput { name: String, near: Option<String> }
            => ("the model has no input `{name}`"),
            remedy(did_you_mean_or(near, "declare it as `input Real` without a value of its own"));
        /// A recording should drive a variable that is not a free input.
        error MO1030 NotDrivable { name: String }
            => ("`{name}` is not an input without a value, so no signal can drive it"),
            help("declare it as `input Real`, `input Boolean` or `input Integer` without a value of its own");
    }
}
