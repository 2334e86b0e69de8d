//! Diagnostics of FMUs.

use crate::base::cause::causes;

causes! {
    /// Causes found when an FMU is made.
    pub enum FmuCause {
        /// The shared library that runs programs is not where it is looked for.
        error MO1300 NoRuntime { looked: String }
            => ("the runtime of FMUs, `libmocc_fmu.so`, is not there; looked at {looked}"),
            help("build it with `cargo build --release`, which puts it next to `mocc`, or name it with `--runtime PATH`");
        /// States are selected while the model runs, which Model Exchange cannot express.
        error MO1301 StatesVary { model: String }
            => ("the states of `{model}` are selected while it runs, which Model Exchange cannot express"),
            help("export it for Co-Simulation with `--type cs`");
        /// A function of the model cannot leave the process.
        error MO1302 NotTransferable { name: String }
            => ("the external function `{name}` of the model cannot be written to an FMU"),
            help("replace the function by one of mocc's library");
        /// The same as [`FmuCause::StatesVary`], where Co-Simulation remains.
        warning MO1303 OnlyStepping { model: String }
            => ("the states of `{model}` are selected while it runs, so the FMU is for Co-Simulation only"),
            help("write `--type cs` to say so");
        /// A file cannot be read or written.
        error MO1304 FileOfFmu { path: String, why: String }
            => ("cannot use `{path}`: {why}"),
            help("check the path and its permissions");
    }
}
