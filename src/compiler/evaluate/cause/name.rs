//! Causes found when names in expressions are looked up.

use crate::base::cause::causes;
use crate::base::diag::did_you_mean_or;
use crate::base::name::Name;
use crate::classes::cause::Alternatives;

causes! {
    /// Causes found when names in expressions are looked up.
    pub enum NameCause {
        /// A name is not declared.
        error MO0202 UnknownName { name: Name, near: Option<String> } (section "5.3.1")
            => ("`{name}` is not declared"),
            remedy(match remedy_of_foreign_name(name.as_str()) {
                Some(remedy) => Some(remedy.to_owned()),
                None if name.as_str() == "t" => {
                    did_you_mean_or(near, "declare it in this class; the independent variable is `time`")
                }
                None => did_you_mean_or(near, "declare it in this class, or check the spelling"),
            });
        /// A function does not exist.
        error MO0288 UnknownFunction { path: String, near: Option<String> } (section "5.3")
            => ("there is no function `{path}`"),
            remedy(match remedy_of_foreign_function(path) {
                Some(remedy) => Some(remedy.to_owned()),
                None => did_you_mean_or(
                    near,
                    "define it, or name the folder of its library with `--lib DIR`",
                ),
            });
        /// An enumeration has no literal of this name.
        error MO0284 UnknownLiteral { enumeration: String, name: Name, others: Alternatives }
            (section "4.8.5")
            => ("`{enumeration}` has no literal `{name}`"), remedy(others.help("it has"));
        /// An element is assigned of a variable that is not a record.
        error MO0285 NotARecord { name: Name } (section "3.6.6")
            => ("`{name}` is not a record"), help("name a record before the dot");
        /// A function of an array of components is called.
        error MO0286 FunctionOfArray { name: Name } (section "5.3.2")
            => ("cannot call a function of `{name}`, which is an array"),
            help("name the class of the component instead: `Class.function(...)`");
        /// An operator of an operator record is called through a component.
        error MO0287 OperatorThroughComponent { operator: Name } (section "5.3.2")
            => ("cannot call operator {operator} through a component"),
            help("write the operator between its operands, or name the class");
        /// An element of a partial class is used from outside.
        error MO1201 ElementOfPartial { name: Name, class: Name } (section "5.3.2")
            => ("cannot use `{name}` of `{class}`, which is partial"),
            help("name a package that extends it");
        /// A component is used that its condition removes, or that no connection creates.
        error MO1203 AbsentComponent (section "4.4.5")
            => ("this component does not exist"),
            help("use it in components with the same condition, or connect something to it");
        /// A class is used where a value is expected.
        error MO1222 ClassAsValue { class: Name } (section "5.3")
            => ("expected a value, found class `{class}`"),
            help("name a component or a constant");
        /// Something that cannot be assigned or equated is used as a variable.
        error MO1223 NotAVariable { found: &'static str } (section "3.6.6")
            => ("expected a variable, found {found}"), help("name a component that has a value");
        /// A function is used as a value outside of function calls.
        error MO1227 FunctionAsValue (section "12.4.2")
            => ("expected a value, found a function"),
            help("pass it as an argument to a function that takes a function");
    }
}

/// What to write for a name that other languages know.
fn remedy_of_foreign_name(name: &str) -> Option<&'static str> {
    Some(match name {
        "dt" => "`der(x)` is the derivative by time already; remove the division by `dt`",
        "True" | "TRUE" => "write `true`",
        "False" | "FALSE" => "write `false`",
        "pi" | "Pi" | "PI" => "write `Modelica.Constants.pi`, or declare it as a constant",
        _ => return None,
    })
}

/// What to write for a function that other languages know.
fn remedy_of_foreign_function(path: &str) -> Option<&'static str> {
    Some(match path {
        "pow" | "power" => "write `x^y`",
        "ln" => "the natural logarithm is `log`",
        "fabs" => "the absolute value is `abs`",
        "print" | "printf" | "println" | "disp" => {
            "write `Modelica.Utilities.Streams.print`, which takes a string"
        }
        "length" | "len" | "numel" => "the number of elements of `x` is `size(x, 1)`",
        _ => return None,
    })
}
