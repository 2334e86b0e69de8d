//! Causes found in classes: names, inheritance, modifications and redeclarations.

use crate::base::diag::did_you_mean_or;
use std::fmt;

use crate::base::cause::causes;
use crate::base::diag;
use crate::base::name::Name;
use crate::ir::ast::Variability;

causes! {
    /// Causes found in classes: names, inheritance, modifications and redeclarations.
    pub enum ClassCause {
        /// A class does not exist.
        error MO0201 UnknownClass { path: String, inside: Option<String>, near: Option<String> }
            (section "5.3")
            => ("there is no class `{path}`{}", inside_of(inside)),
            remedy(did_you_mean_or(
                near,
                "check the spelling, or name the folder that holds the library with `--lib DIR`",
            ));
        /// A class extension has no inherited class to extend.
        error MO0281 NothingToExtend { name: Name } (section "7.3.1")
            => ("there is no inherited class `{name}` to extend"),
            help("`model extends A` extends the A of a base class; \
                  write `model A extends ...` for another one");
        /// The name of a component is used as that of a class.
        error MO0282 ComponentAsClass { name: Name } (section "5.3.1")
            => ("expected a class, found component `{name}`"),
            help("rename the component, or write the full name of the class with a dot before it");
        /// An expandable connector has no such variable.
        error MO0242 UnknownBusVariable { bus: String, name: Name } (section "9.1.3")
            => ("the expandable connector `{bus}` has no `{name}`"),
            help("declare it in the connector, or connect it to a declared connector");
        /// A component, record or package has no element of this name.
        error MO0283 UnknownElement { holder: Holder, name: Name, others: Alternatives }
            (section "5.3.2")
            => ("{holder} has no `{name}`"), remedy(others.help("it has"));
        /// A modification names an element that the class does not have.
        error MO0203 UnknownModifiedElement { class: String, name: Name, others: Alternatives }
            (section "7.2")
            => ("class `{class}` has no element `{name}` to modify"),
            remedy(others.help("it has").or_else(|| Some("remove the modification".to_string())));
        /// A variable has no attribute of this name.
        error MO0289 UnknownAttribute { path: String, name: Name, others: Alternatives }
            (section "4.8")
            => ("`{path}` has no attribute `{name}`"), remedy(others.help("attributes are"));
        /// A final element is modified.
        error MO0209 Final { path: String, attribute: Option<Name> } (section "7.2.6")
            => ("{}`{path}` is final", attribute_of(attribute)),
            help("remove this value, or `final` where it is declared");
        /// A parameter or constant is bound to an expression of higher variability.
        error MO0268 VaryingBinding { kind: Variability, path: String, to: Varying }
            (section "4.4.2.1")
            => ("{} `{path}` is bound to {to}", word_of(*kind)),
            help("{}", match kind {
                Variability::Constant => "use constants only, or make it a parameter",
                _ => "use parameters and constants only, or leave `parameter` out",
            });
        /// An attribute is given a value that varies during simulation.
        error MO0274 VaryingAttribute { attribute: Name, path: String } (section "4.8")
            => ("`{attribute}` of `{path}` is given a value that changes during simulation"),
            help("{}", match attribute.as_str() {
                "start" => "use parameters and constants, or write an initial equation",
                _ => "use parameters and constants, or an `assert`",
            });
        /// The value of a conditional component is read.
        error MO0217 ConditionalRead { path: String } (section "4.4.5")
            => ("`{path}` is conditional, and cannot be read as a value"),
            help("declare it without condition, \
                  or read it inside of a component that has the same condition");
        /// A class declares a name twice.
        error MO0204 DeclaredTwice { name: Name } (section "4.2")
            => ("`{name}` is declared twice"), help("rename or remove one of them");
        /// An element that is inherited twice is modified in two ways.
        error MO0256 ModifiedTwice { name: Name } (section "7.1")
            => ("`{name}` is inherited twice, and modified in two ways"),
            help("write the same modification in both `extends` clauses");
        /// An inherited element is declared again in another way.
        error MO0292 InheritedTwice { name: Name } (section "7.1")
            => ("`{name}` is inherited and declared again in another way"),
            help("modify the inherited one, as in `extends ...({name} = ...)`, or rename");
        /// An element is redeclared that is not replaceable.
        error MO0224 NotReplaceable { name: Name } (section "7.3.3")
            => ("`{name}` is not replaceable"),
            help("write `replaceable` before the declaration, or modify it instead");
        /// An element is redeclared to a class that is not a subtype of its constraining type.
        error MO0225 IncompatibleRedeclaration { name: Name, why: Incompatibility }
            (section "7.3.2")
            => ("cannot redeclare `{name}`: {why}"),
            help("use a class that has all that the constraining class has, \
                  for instance one that extends it");
        /// A class that is not a function is to be differentiated.
        error MO1255 DerivativeOfOther { base: String, name: Name } (section "12.7.2")
            => ("`{base}` is not a function: `{name}` cannot be its derivative"),
            help("name a function before `der`");
        /// A class inherits from itself.
        error MO0205 InheritanceCycle { class: String } (section "7.1")
            => ("`{class}` inherits from itself"), help("break the cycle of `extends` clauses");
        /// An `outer` component has no `inner` one.
        error MO0206 NoInner { name: Name } (section "5.4")
            => ("there is no `inner` component `{name}` around this one"),
            help("declare one in an enclosing component");
        /// An `outer` component has no `inner` one, so one is added to the model.
        warning MO0295 InnerAdded { name: Name, prefix: &'static str, class: String }
            (section "5.4")
            => ("there is no `inner` component `{name}`: one is added to the model"),
            help("declare it: `inner {prefix}{class} {name};`");
        /// An array has an open size, and no value to take it from.
        error MO0207 UnknownSize { name: Name } (section "10.1")
            => ("the size of `{name}` is left open and has no value to take it from"),
            help("give it a size or a binding");
        /// Two unqualified imports bring the same name.
        error MO0263 AmbiguousImport { name: Name } (section "5.3.1")
            => ("`{name}` is imported from two packages"),
            help("import the one that is meant by its name: `import PACKAGE.{name};`");
        /// Something is imported that is not an element of a package.
        error MO1217 ImportFromOther { name: Name, holder: String } (section "13.2.1")
            => ("cannot import `{name}` from `{holder}`, which is not a package"),
            help("import packages and elements of packages only");
        /// A protected element is named from outside.
        error MO0260 Protected { name: Name } (section "4.1")
            => ("`{name}` is protected"),
            help("use a public element, or make this one public where it is declared");
        /// An element of a class that is not a package is named from outside.
        error MO0261 NotInPackage { name: Name, holder: String } (section "5.3.2")
            => ("cannot name `{name}` from outside `{holder}`, which is not a package"),
            help("move it to a package, or declare it `encapsulated`");
    }
}

/// Whatever a name with a dot is looked up in.
#[derive(Clone, PartialEq, Debug)]
pub enum Holder {
    /// A component, and its class.
    Component(String, Option<Name>),
    /// A package or another class, or the value of a record.
    Named(String),
    /// A record without a name.
    Record,
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Holder::Component(path, Some(class)) => write!(f, "`{path}` of class `{class}`"),
            Holder::Component(path, None) | Holder::Named(path) => write!(f, "`{path}`"),
            Holder::Record => f.write_str("this record"),
        }
    }
}

/// Names that may have been meant instead of one that is unknown.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Alternatives {
    near: Option<String>,
    listed: String,
}

impl Alternatives {
    /// The best of `names`, and the first of them.
    pub fn of(wanted: Name, names: &[&str]) -> Self {
        let near = diag::did_you_mean(&wanted, names.iter().copied()).map(str::to_string);
        Alternatives { near, listed: listed(names) }
    }
    /// All of `names`, which may be too short to be misspelled.
    pub fn all(names: &[&str]) -> Self {
        Alternatives { near: None, listed: listed(names) }
    }
    /// Only the best of `names`: there are too many to list them.
    pub fn near(wanted: Name, names: &[&str]) -> Self {
        Alternatives { listed: String::new(), ..Self::of(wanted, names) }
    }
    /// "did you mean", or the list after `intro`; `None` if there are no names.
    pub fn help(&self, intro: &str) -> Option<String> {
        match &self.near {
            Some(near) => Some(format!("did you mean `{near}`?")),
            None if self.listed.is_empty() => None,
            None => Some(format!("{intro} {}", self.listed)),
        }
    }
}

/// Values that vary more than a parameter or constant may.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Varying {
    /// A parameter.
    Parameter,
    /// A variable.
    Variable,
}

impl fmt::Display for Varying {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Varying::Parameter => "a parameter",
            Varying::Variable => "a value that changes during simulation",
        })
    }
}

/// Why a class (`given`) cannot take the place of another (`wanted`).
#[derive(Clone, PartialEq, Debug)]
#[allow(missing_docs)]
pub enum Incompatibility {
    /// It has another number of dimensions.
    Dimensions { given: Name, has: usize, wanted: Name, needs: usize },
    /// It is another predefined type.
    Type { given: Name, wanted: Name },
    /// It lacks an element.
    Missing { given: Name, element: Name, wanted: Name },
    /// It has a class where the other has a component, or the reverse.
    Element { element: Name, wanted: Name },
}

impl fmt::Display for Incompatibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Incompatibility::Dimensions { given, has, wanted, needs } => {
                let dimensions = if *has == 1 { "dimension" } else { "dimensions" };
                write!(f, "`{given}` has {has} {dimensions}, and `{wanted}` has {needs}")
            }
            Incompatibility::Type { given, wanted } => {
                write!(f, "`{given}` is of another type than `{wanted}`")
            }
            Incompatibility::Missing { given, element, wanted } => {
                write!(f, "`{given}` has no `{element}`, and `{wanted}` has")
            }
            Incompatibility::Element { element, wanted } => {
                write!(f, "`{element}` is a component in one and a class in the other, `{wanted}`")
            }
        }
    }
}

/// `a, b and c`, at most eight.
pub(crate) fn listed(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(8).map(|n| format!("`{n}`")).collect();
    match shown.split_last() {
        Some((last, rest)) if names.len() > 8 => format!("{}, {last} ...", rest.join(", ")),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// The prefix that makes a value fixed.
pub(crate) fn word_of(variability: Variability) -> &'static str {
    match variability {
        Variability::Constant => "constant",
        Variability::Parameter => "parameter",
        Variability::Discrete => "discrete",
        Variability::Continuous => "variable",
    }
}

fn inside_of(package: &Option<String>) -> String {
    package.as_ref().map_or_else(String::new, |package| format!(" in `{package}`"))
}

fn attribute_of(attribute: &Option<Name>) -> String {
    attribute.as_ref().map_or_else(String::new, |attribute| format!("attribute `{attribute}` of "))
}
