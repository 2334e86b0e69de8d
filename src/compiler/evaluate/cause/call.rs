//! Causes found in calls of functions, and in their bodies.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;
use crate::classes::cause::Alternatives;

causes! {
    /// Causes found in calls of functions, and in their bodies.
    pub enum CallCause {
        /// A call has too many or too few arguments.
        error MO0219 WrongArguments { function: String, takes: Takes } (section "12.4.1")
            => ("`{function}` takes {takes}"), help("pass the arguments that it takes");
        /// An argument without a default is missing.
        error MO1262 MissingArgument { function: Name, name: Name } (section "12.4.1")
            => ("argument `{name}` of `{function}` is missing"),
            help("give it a value: `{name} = ...`");
        /// An argument is given twice.
        error MO1260 ArgumentTwice { name: Name } (section "12.4.1")
            => ("argument `{name}` is given twice"), help("remove one of them");
        /// A function has no input of this name.
        error MO1261 UnknownArgument { function: Name, name: Name, others: Alternatives }
            (section "12.4.1")
            => ("`{function}` has no argument `{name}`"), remedy(others.help("it takes"));
        /// A class that is not a function is called.
        error MO1259 NotAFunction { class: Name } (section "12.4")
            => ("cannot call `{class}`, which is not a function"),
            help("call a function, or declare a component of the class");
        /// A partial function is called.
        error MO1200 PartialFunction { function: Name } (section "12.4")
            => ("function `{function}` is partial"), help("call a function that extends it");
        /// The class of an external object has no constructor.
        error MO1258 NoConstructor { class: Name } (section "12.9.7")
            => ("`{class}` has no constructor"),
            help("declare a function `constructor` in it");
        /// Two constructors of an operator record take the same arguments.
        error MO1257 AmbiguousConstructor { first: Name, second: Name } (section "14.3")
            => ("`{first}` and `{second}` both take these arguments"),
            help("let the constructors differ in the types of their inputs");
        /// A record constructor leaves a field without a value.
        error MO1256 FieldWithoutValue { record: Name, field: Name } (section "12.6")
            => ("field `{field}` of `{record}` has no value"),
            help("give it a value: `{field} = ...`");
        /// Several variables are set by something other than a function with several outputs.
        error MO1244 NotSeveralOutputs (section "12.4.3")
            => ("expected a function with several outputs"),
            help("call a function with an output for each variable on the left");
        /// More variables are set than the function has outputs.
        error MO1245 TooFewOutputs { wanted: usize, given: usize } (section "12.4.3")
            => ("expected {wanted} outputs, found a function with {given}"),
            help("leave out variables on the left");
        /// A function is differentiated by a name that is not one of its inputs.
        error MO1253 UnknownDerivativeInput { function: Name, name: Name, others: Alternatives }
            (section "12.7.2")
            => ("cannot differentiate `{function}` by `{name}`, which is not an input"),
            remedy(others.help("it has"));
        /// A function is differentiated by an input that is not Real.
        error MO1254 DerivativeByOther { function: Name, name: Name } (section "12.7.2")
            => ("cannot differentiate `{function}` by `{name}`, which is not Real"),
            help("differentiate by inputs of type Real only");
        /// A function assigns nothing to one of its outputs.
        error MO0252 UnassignedOutput { function: Name, name: Name } (section "12.4.4")
            => ("output `{name}` of `{function}` never gets a value"),
            help("assign it in the algorithm of the function, or give it a default: `= ...`");
        /// An output of a function, or a part of it, is not assigned on every path.
        warning MO0255 OutputInPart { function: Name, name: Name, part: String } (section "12.4.4")
            => ("`{function}` may end without a value of its output `{name}{part}`, which is then 0, false or empty"),
            help("assign every field and element of it on every path, or give it a default: `= ...`");
        /// A loop runs longer than mocc allows.
        error MO0221 EndlessLoop { most: usize }
            => ("this loop runs more than {most} times"),
            help("correct its condition, or use fewer iterations");
        /// A function calls itself too deeply.
        error MO1205 DeepRecursion { function: Name, most: usize }
            => ("`{function}` calls itself more than {most} deep"),
            help("let parameters and constants decide how deep it goes, or write a loop");
        /// One call of a function leads to too many others.
        error MO1294 TooManyCalls { function: Name, most: usize }
            => ("one call of `{function}` leads to more than {most} others"),
            help("compute its value by a loop, or with fewer calls");
        /// A function has a variable of a record that contains itself.
        error MO1298 RecordInItself { class: Name } (section "5.6.1")
            => ("record `{class}` contains itself"),
            help("remove the component of its own class, or give it another class");
        /// An external function is not one that mocc implements.
        error MO0222 UnknownExternal { function: String } (section "12.9")
            => ("mocc does not know the external function `{function}`"),
            help("write the function in Modelica");
        /// An external function fails for its arguments.
        error MO0290 ExternalFailed { function: String, why: String } (section "12.9")
            => ("`{function}`: {why}"),
            help("correct the arguments of the call, or the file that it reads");
        /// A model calls a function that writes a file.
        warning MO0291 FileNotWritten
            => ("mocc writes no files for a model"),
            help("write the results of a run with `--output`");
        /// An assertion in a function is false.
        error MO0223 FunctionAssertion { message: String } (section "11.2.8.1")
            => ("assertion failed: {message}"),
            help("call the function with arguments for which the assertion holds");
    }
}

/// The arguments that a function takes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Takes {
    /// These.
    These(&'static str),
    /// As many as it has inputs, compared with those that are given.
    Count {
        /// The inputs.
        inputs: usize,
        /// The arguments.
        given: usize,
    },
}

impl fmt::Display for Takes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Takes::These(arguments) => f.write_str(arguments),
            Takes::Count { inputs: 1, given } => write!(f, "1 argument, found {given}"),
            Takes::Count { inputs, given } => write!(f, "{inputs} arguments, found {given}"),
        }
    }
}
