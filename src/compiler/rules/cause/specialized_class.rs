//! Causes found in class definitions: elements and bases that a specialized class may not have,
//! and reserved names.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;
use crate::ir::ast::ClassKind;
use crate::rules::specialized_class::word;

causes! {
    /// Causes found in class definitions.
    pub enum SpecializedClassCause {
        /// A specialized class has an element that it may not have.
        error MO0226 ForbiddenElement { element: Name, kind: ClassKind, class: Name, is: Forbidden }
            (section "4.6")
            => ("`{element}` of {} `{class}` is {is}", word(*kind)), help("{}", is.remedy());
        /// A connector or record has equations or an algorithm, or a function has equations.
        error MO1281 ForbiddenSection { kind: ClassKind, class: Name, section: &'static str }
            (section "4.6")
            => ("{} `{class}` has {section}", word(*kind)), help("{}", match kind {
                ClassKind::Connector | ClassKind::ExpandableConnector => {
                    "write them in the model that has the connector"
                }
                ClassKind::Record | ClassKind::OperatorRecord => {
                    "write them in the model that has the record"
                }
                _ => "write an `algorithm`",
            });
        /// An operator has an element that is not a function.
        error MO1282 OtherInOperator { element: Name, operator: Name } (section "4.6")
            => ("`{element}` of operator `{operator}` is not a function"),
            help("declare it outside of the operator, in the record");
        /// A constructor of an operator record has a second output.
        error MO1283 SecondOutput { constructor: Name, output: Name } (section "14.3")
            => ("constructor `{constructor}` has a second output, `{output}`"),
            help("leave the record as its only output");
        /// A public component of a function is neither input nor output.
        error MO1284 UndirectedFormal { name: Name, function: Name } (section "12.2")
            => ("public component `{name}` of function `{function}` is neither input nor output"),
            help("declare it after `protected`");
        /// A function has an initial algorithm, or more than one algorithm.
        error MO1285 FunctionAlgorithm { function: Name, initial: bool } (section "12.2")
            => ("function `{function}` has {}", match initial {
                true => "an initial algorithm",
                false => "more than one algorithm",
            }),
            help("{}", match initial {
                true => "write `algorithm`",
                false => "put the statements into one",
            });
        /// The variable `time` is used outside of models and blocks.
        error MO1286 TimeOutsideModel { kind: ClassKind } (section "3.6.7")
            => ("`time` is unknown in a {}", word(*kind)),
            help("give it from outside: as an input, or by a modification in a model");
        /// A component of a function is a model or block.
        error MO1287 ModelInFunction { name: Name, kind: ClassKind } (section "12.2")
            => ("component `{name}` of a function is a {}", word(*kind)),
            help("use a record, or pass the values that are needed");
        /// An enumeration has two literals of one name.
        error MO1278 LiteralTwice { name: Name } (section "4.8.5")
            => ("the enumeration has two literals `{name}`"),
            help("give one of them another name");
        /// A literal has the name of an attribute of enumerations.
        error MO1279 LiteralAttribute { name: Name } (section "4.8.5.1")
            => ("`{name}` is an attribute of enumerations"),
            help("give the literal another name");
        /// An element has the name of a predefined type.
        error MO1280 PredefinedName { name: Name } (section "2.3.3")
            => ("`{name}` is the name of a predefined type"), help("choose another name");
        /// A class extends a class of another specialized class.
        error MO0227 OtherBase { kind: ClassKind, class: Name, of: ClassKind, base: String }
            (section "7.1.3")
            => ("{} `{class}` cannot extend {} `{base}`", word(*kind), word(*of)),
            remedy(Some(match (kind, of) {
                (ClassKind::Class, ClassKind::Function { .. }) => {
                    format!("write `function {class} = ...`")
                }
                _ => "extend a class of the same kind, or declare a component of it".to_string(),
            }));
        /// An operator record is extended, or a class that has one.
        error MO1288 OperatorRecordBase { base: Name, class: Name, inside: Option<Name> }
            (section "4.6")
            => ("{}", match inside {
                Some(record) => {
                    format!("cannot extend `{base}`: it has the operator record `{record}`")
                }
                None => format!("cannot extend operator record `{base}`"),
            }),
            remedy(Some(match inside {
                Some(_) => "move the operator record to a package of its own".to_string(),
                None => format!("write `operator record {class} = {base}(...)`"),
            }));
        /// A class that adds a prefix is extended together with other elements.
        error MO1289 PrefixedBase { base: Name } (section "4.5.2")
            => ("cannot extend `{base}`, which has a prefix, together with other elements"),
            help("declare a component of the class");
        /// A predefined type or an array is extended together with other elements.
        error MO1290 SimpleBase { class: Name, scalar: bool, components: bool } (section "4.5.2")
            => (
                "`{class}` extends {}, and {}",
                if *scalar { "a predefined type" } else { "an array" },
                if *components { "has components" } else { "extends another class" }
            ),
            help("declare a component of the type instead of extending it");
    }
}

/// A property of an element that its class does not allow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Forbidden {
    Inner,
    Outer,
    Protected,
    Flow,
    Stream,
    /// A `stream` variable outside of connectors and records.
    StreamOutsideConnector,
    Input,
    Output,
    ProtectedFormal,
    NotConstant,
}

impl Forbidden {
    fn remedy(self) -> &'static str {
        match self {
            Forbidden::Inner | Forbidden::Outer => "declare it in a model",
            Forbidden::Protected => "make it public",
            Forbidden::Flow | Forbidden::Stream | Forbidden::Input | Forbidden::Output => {
                "use a connector, or leave the prefix out"
            }
            Forbidden::StreamOutsideConnector => "declare it in a connector",
            Forbidden::ProtectedFormal => "make it public, or leave the prefix out",
            Forbidden::NotConstant => "declare it `constant`, or make the package a model",
        }
    }
}

impl fmt::Display for Forbidden {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Forbidden::Inner => "`inner`",
            Forbidden::Outer => "`outer`",
            Forbidden::Protected => "protected",
            Forbidden::Flow => "a `flow` variable",
            Forbidden::Stream | Forbidden::StreamOutsideConnector => "a `stream` variable",
            Forbidden::Input => "an `input`",
            Forbidden::Output => "an `output`",
            Forbidden::ProtectedFormal => "an input or output, but protected",
            Forbidden::NotConstant => "not a constant",
        })
    }
}
