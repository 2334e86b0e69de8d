//! Diagnostics of FMUs.

use crate::base::cause::causes;

causes! {
    /// Causes found when an FMU is made or used.
    pub enum FmuCause {
        /// The shared library that runs programs is not where it is looked for.
        error MO1300 NoRuntime { looked: String }
            => ("the runtime of FMUs, `libmocc_fmu.so`, is not there; looked at {looked}"),
            help("build it with `cargo build --release`, which puts it next to `mocc`, install the Python package by \
                  `pip install ./python`, which holds it, or name it with `--runtime PATH`");
        /// The file that should run exported models is none that can.
        error MO1322 NotARuntime { path: String, fmi: String }
            => ("`{path}` is not a shared library with the functions of FMI {fmi}"),
            help("leave out `--runtime`, or name a `libmocc_fmu` that `cargo build --release` has made, perhaps on another system");
        /// States are selected while the model runs, which Model Exchange cannot express.
        error MO1301 StatesVary { model: String }
            => ("the states of `{model}` are selected while it runs, which Model Exchange cannot express"),
            help("export it for Co-Simulation with `--type cs`");
        /// The model needs the derivative of an input, which importers do not give.
        error MO1324 DifferentiatedInput { model: String, input: String }
            => ("`{model}` differentiates its input `{input}`, and an importer gives values alone"),
            help("declare the derivative as another input, or filter the input in the model: `T*der(y) = {input} - y`");
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
        /// A file is not a complete archive with a description.
        error MO1305 BadArchive { path: String, why: String }
            => ("`{path}` is not a complete FMU: {why}"),
            help("export or download the FMU again");
        /// An entry of an archive leads out of the folder in which it is unpacked.
        error MO1306 UnsafeEntry { path: String, entry: String }
            => ("`{path}` is refused: its entry `{}` leads out of the archive", entry.escape_debug()),
            help("do not use this FMU: no exporter writes such entries");
        /// An archive would fill memory or disk.
        error MO1307 TooLarge { path: String, what: String }
            => ("`{path}` is refused: it holds {what}"),
            help("do not use this FMU, or remove what is not needed from its archive");
        /// The description of an FMU does not make sense.
        error MO1308 BadDescription { path: String, why: String }
            => ("cannot read `modelDescription.xml` of `{path}`: {why}"),
            help("export the FMU again; FMPy's `validate` names what is wrong");
        /// The FMU is of a version that mocc does not import.
        error MO1309 OtherVersion { path: String, version: String }
            => ("`{path}` is an FMU of FMI {version}; mocc imports FMI 2.0 and 3.0"),
            help("export it as FMI 2.0 or 3.0");
        /// The FMU has no shared library for this platform.
        error MO1310 NoBinary { path: String, wanted: String, present: String }
            => ("`{path}` has no `{wanted}`; it has {present}"),
            help("export the FMU for this platform");
        /// The FMU does not offer the kind of simulation that is asked for.
        error MO1311 NotOffered { path: String, wanted: String, offered: String }
            => ("`{path}` does not offer {wanted}, only {offered}"),
            help("choose the other kind with `--fmi-type`");
        /// The shared library of an FMU cannot be loaded.
        error MO1312 NotLoadable { path: String, why: String }
            => ("cannot load the shared library of `{path}`: {why}"),
            help("install the libraries that it needs, or export the FMU again");
        /// An FMU refuses to be instantiated.
        error MO1313 NotInstantiated { path: String }
            => ("`{path}` cannot be instantiated"),
            help("read its messages; a wrong token means that `modelDescription.xml` and the shared library belong to different FMUs");
        /// A function of an FMU returns an error.
        error MO1314 FailedCall { path: String, call: String, status: String }
            => ("`{path}` failed: {call} returned the status {status}"),
            help("read the messages of the FMU; try other parameters, or a tighter `--tolerance`");
        /// An FMU ended its process.
        error MO1315 Crashed { path: String, how: String, doing: String }
            => ("`{path}` crashed: {how} {doing}"),
            help("report this to the maker of the FMU; mocc and its results are not affected");
        /// An FMU does not return.
        error MO1316 Hanging { path: String, seconds: f64, doing: String }
            => ("`{path}` does not return: {doing} took longer than {seconds} s"),
            help("report this to the maker of the FMU, or allow more time with `--max-seconds`");
        /// A command needs the equations of a model.
        error MO1317 NeedsEquations { path: String, what: String }
            => ("`{path}` is an FMU, and {what}"),
            help("`mocc simulate`, `report` and `sweep` take FMUs, and so do the plans of `calibrate`, `diagnose` and `evaluate`");
        /// The child process of an FMU cannot be started.
        error MO1318 NoProcess { path: String, why: String }
            => ("cannot start a process for `{path}`: {why}"),
            help("an FMU runs in a child process of `mocc`; check that the system allows it");
        /// An FMU that is a component of a model cannot go on.
        error MO1320 ComponentFailed { path: String, what: String }
            => ("`{path}`, a component of the model, failed: {what}"),
            help("try other parameters or inputs, or another `communicationStep`");
        /// A file that is not on the command line names an FMU.
        error MO1321 NotAllowed { path: String }
            => ("the plan names the FMU `{path}`, which is foreign code: it can do whatever you can do"),
            help("if you trust it, allow it with `--allow-fmu FILE`");
        /// The shared library of an FMU runs in Python, which is not there.
        error MO1323 NeedsPython { path: String, why: String }
            => ("`{path}` is written in Python, and {why}"),
            help("put a `python3` with a shared library and the packages of the FMU first in the PATH, or run the `mocc` of the Python package there (`pip install mocc`)");
    }
}
