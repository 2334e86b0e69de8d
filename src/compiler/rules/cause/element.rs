//! Causes found in single elements and statements of a class: prefixes, modifiers, redeclarations,
//! shadowed names, misplaced statements.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;
use crate::classes::cause::Incompatibility;

causes! {
    /// Causes found in single elements and statements of a class.
    pub enum ElementCause {
        /// A component has a prefix that its class does not allow.
        error MO0228 ForbiddenPrefix { name: Name, class: String, prefix: &'static str }
            (section "4.4.2.2")
            => ("`{name}` of class `{class}` cannot be `{prefix}`"),
            help("leave the prefix out, or use a type that can have it");
        /// A connector is declared as a parameter or constant.
        error MO1208 FixedConnector { name: Name, prefix: &'static str } (section "9.3")
            => ("connector `{name}` cannot be `{prefix}`"),
            help("leave the prefix out, or use a record");
        /// A component and an element in it both have a prefix that only one of them may have.
        error MO1209 PrefixTwice { name: Name, element: Name, prefix: TwicePrefix }
            (section "4.4.2.2")
            => ("`{name}` is {prefix}, and so is `{element}` in it"),
            help("leave one of the prefixes out");
        /// An element is redeclared that must stay as it is.
        error MO1206 ClosedElement { name: Name, why: Closed } (section "7.3.3")
            => ("cannot redeclare `{name}`: it {why}"),
            help("leave it as it is, or change its declaration");
        /// A replaceable element is not a subtype of its own constraining type.
        error MO1207 IncompatibleDefault { name: Name, why: Incompatibility } (section "7.3.2")
            => ("`{name}` is not a subtype of its own constraining type: {why}"),
            help("declare it with a class that has all that the constraining class has");
        /// A base class is replaceable.
        error MO0262 ReplaceableBase { name: Name } (section "7.1.4")
            => ("base class `{name}` is replaceable"),
            help("extend a class that is not replaceable, \
                  or leave `replaceable` out where it is declared");
        /// A name hides another one.
        warning MO0270 Shadowing { name: Name, by: Shadow } (section "5.3.1")
            => ("{by} `{name}` hides {}", by.hidden()), help("{}", by.remedy());
        /// The prefix `each` modifies a component that is not an array.
        warning MO0271 EachOfScalar { name: Name } (section "7.2.5")
            => ("`each` has no effect: `{name}` is not an array"),
            help("leave `each` out, or give the component its sizes");
        /// A component is modified that its condition removes.
        warning MO0272 AbsentModified { path: String, switch: String } (section "4.4.5")
            => ("this has no effect: `{path}` is removed by `{switch}`"),
            help("set `{switch}`, or leave the modification out");
        /// A class imports two elements under one name.
        error MO1216 ImportedTwice { name: Name } (section "13.2.2")
            => ("`{name}` is imported twice"),
            help("remove one of them, or rename it: `import NAME = ...`");
        /// A modification gives an element two values.
        error MO0264 ModifiedTwice { names: String, redeclared: bool } (section "7.2.4")
            => ("`{names}` is {} twice", if *redeclared { "redeclared" } else { "modified" }),
            help("remove one of them");
        /// A `break` is outside of a loop.
        error MO0265 BreakOutsideLoop (section "11.2.4")
            => ("`break` is outside of a loop"),
            help("write it inside of `for` or `while`, or turn the condition round");
        /// A `return` is outside of a function.
        error MO1218 ReturnOutsideFunction (section "12.1.2")
            => ("`return` is outside of a function"),
            help("put the statements that follow into the `else` branch of an `if`");
        /// A when-statement is where none may occur.
        error MO1271 MisplacedWhen { inside: WhenPlace } (section "11.2.7.1")
            => ("`when` is inside of {inside}"), help("{}", inside.remedy());
        /// A statement assigns the iterator of a loop around it.
        error MO0251 IteratorAssigned { name: Name } (section "11.2.2")
            => ("loop variable `{name}` is assigned"),
            help("let the range of the loop give it its values, or count with a variable of its own in a `while`");
        /// A function assigns one of its inputs.
        error MO0266 InputAssigned { name: Name } (section "12.2")
            => ("input `{name}` of a function is assigned"),
            help("copy it to a protected variable, and change that");
    }
}

/// Prefixes that a component and its elements cannot both have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TwicePrefix {
    /// `flow` or `stream`.
    Connection,
    /// `input` or `output`.
    Causality,
}

impl fmt::Display for TwicePrefix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            TwicePrefix::Connection => "`flow` or `stream`",
            TwicePrefix::Causality => "`input` or `output`",
        })
    }
}

/// Why an element cannot be redeclared.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Closed {
    Final,
    Constant,
    BecomesPublic,
    BecomesProtected,
}

impl fmt::Display for Closed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Closed::Final => "is final",
            Closed::Constant => "is a constant",
            Closed::BecomesPublic => "is protected, and would become public",
            Closed::BecomesProtected => "is public, and would become protected",
        })
    }
}

/// A declaration that hides another one of the same name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shadow {
    /// An iterator, and a component.
    IteratorOfComponent,
    /// An iterator, and that of an enclosing loop.
    IteratorOfIterator,
    /// An element, and an import.
    Element,
    /// A component, and a constant of an enclosing class.
    Component,
}

impl Shadow {
    fn hidden(self) -> &'static str {
        match self {
            Shadow::IteratorOfComponent => "a component",
            Shadow::IteratorOfIterator => "the iterator of an enclosing loop",
            Shadow::Element => "an import",
            Shadow::Component => "a constant of an enclosing class",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Shadow::IteratorOfComponent | Shadow::IteratorOfIterator => "rename the iterator",
            Shadow::Element => {
                "remove the import, or give it a name of its own: `import NAME = ...`"
            }
            Shadow::Component => "rename the component",
        }
    }
}

impl fmt::Display for Shadow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Shadow::IteratorOfComponent | Shadow::IteratorOfIterator => "iterator",
            Shadow::Element => "element",
            Shadow::Component => "component",
        })
    }
}

/// Where a when-statement may not occur.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WhenPlace {
    Function,
    Initial,
    When,
    If,
    For,
    While,
}

impl WhenPlace {
    fn remedy(self) -> &'static str {
        match self {
            WhenPlace::When => "write `elsewhen`, or join the conditions with `and`",
            WhenPlace::Function => "compute it in the model, in a when-clause",
            _ => "put the `when` outside, and this statement into it",
        }
    }
}

impl fmt::Display for WhenPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            WhenPlace::Function => "a function",
            WhenPlace::Initial => "an initial section",
            WhenPlace::When => "another `when`",
            WhenPlace::If => "`if`",
            WhenPlace::For => "`for`",
            WhenPlace::While => "`while`",
        })
    }
}
