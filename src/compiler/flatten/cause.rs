//! Causes found while a model is flattened: equations, clauses and parameter overrides.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;

causes! {
    /// Causes found in the equations of a model while it is flattened.
    pub enum FlattenCause {
        /// A when-equation is where none may occur.
        error MO0231 MisplacedWhen { inside: WhenEquationPlace } (section "8.3.5.2")
            => ("`when` is inside of {inside}"), help("{}", inside.remedy());
        /// A connect-equation is where none may occur.
        error MO1272 MisplacedConnect { inside: ConnectPlace } (section "9.3")
            => ("`connect` is inside of {inside}"),
            help("decide it by parameters, or switch by equations");
        /// An expression is where an equation must be.
        error MO1273 NotAnEquation (section "8.3")
            => ("expected an equation, found an expression"),
            help("write an equation with `=`, or call a function");
        /// The branches of an if-equation define different discrete variables.
        error MO1274 DifferentDiscrete (section "8.3.4")
            => ("branches must define the same discrete variables"),
            help("give each branch, `else` included, an equation for each of them");
        /// The branches of an if-equation have different numbers of equations.
        error MO0232 BranchCount { first: usize, second: usize } (section "8.3.4")
            => ("the branches have {first} and {second} equations, \
                 but their condition changes during simulation"),
            help("give each branch, `else` included, the same number of equations");
        /// A model has more scalar variables than mocc is allowed to make.
        error MO0330 TooManyVariables { path: String, before: usize, elements: usize, most: usize }
            => ("the model has more than {most} scalar variables: `{path}` adds {} to {before}",
                counted(*elements, "element")),
            help("use smaller arrays; `--max-size` of `mocc check` and `mocc simulate` allows more");
        /// A when-equation determines a variable of another component.
        error MO1275 ForeignVariable { variable: Name, component: Name } (section "4.7")
            => ("`{variable}` of component `{component}` is determined \
                 in a when-clause outside of it"),
            help("write the when-clause there, or determine a variable of this class \
                  and bind or connect the other one to it");
        /// A branch of a when-equation determines a variable that another one does not.
        error MO0257 OtherLeftSides { name: String } (section "8.3.5.2")
            => ("only some branches of this when-equation determine `{name}`"),
            help("determine it in each branch, where `{name} = pre({name})` keeps its value, \
                  or write when-equations of their own");
        /// The left side of an equation in a when-clause is not a variable.
        error MO1276 LeftSideInWhen (section "8.3.5.3")
            => ("expected a variable on the left side of an equation in a when-clause"),
            help("solve the equation for a variable");
        /// The operator `reinit` is applied to something other than a variable.
        error MO1277 ReinitTarget (section "8.3.6")
            => ("the first argument of `reinit` must be a state"),
            help("name a variable that is differentiated");
        /// Two equations reinitialize one variable, or two statements of one branch.
        error MO0254 ReinitTwice { name: String } (section "8.3.6")
            => ("`{name}` is reinitialized twice"),
            help("join them by `elsewhen`, or let one `reinit` choose among both values");
        /// An assertion is false for the given parameters.
        error MO0233 Assertion { message: String } (section "8.3.7")
            => ("assertion failed: {message}"),
            help("give the parameters values for which the assertion holds");
        /// A component has more or fewer equations than unknowns.
        error MO0234 Unbalanced { component: String, equations: usize, unknowns: usize }
            (section "4.7")
            => (
                "`{component}` is not balanced: it has {} for {}",
                counted(*equations, "equation"),
                counted(*unknowns, "unknown")
            ),
            remedy(Some(match equations.checked_sub(*unknowns) {
                None => format!("add {}", counted(unknowns - equations, "equation")),
                Some(more) => format!("remove {}", counted(more, "equation")),
            }));
        /// A discrete variable has a declaration equation.
        error MO0248 BoundDiscrete { path: String } (section "4.4.4")
            => ("`{path}` is `discrete`, and cannot have a declaration equation"),
            help("assign it in a when-clause, or leave `discrete` out");
        /// A parameter or constant is outside of its bounds.
        warning MO0273 OutsideBounds { name: String, value: f64, bound: f64, above: bool }
            (section "4.8.1")
            => ("`{name}` is {value}, {} of {bound}", match above {
                true => "above its `max`",
                false => "below its `min`",
            }),
            help("give it another value, or another bound");
        /// The seed of a random number generator is known only at run time.
        error MO1246 UnknownSeed
            => ("the seed of this random number generator is known only at run time"),
            help("call `initializeImpureRandom` with a seed that is known before simulation");
        /// An annotation lets a parameter vary that cannot.
        error MO1292 UnusableVariation { parameter: String, factor: String, why: WrongVariation }
            => ("{}", why.message(parameter, factor)), help("{}", why.remedy());
        /// An annotation leads a signal through a component that cannot take it.
        error MO0326 UnusablePassage { signal: String, output: String, why: WrongPassage }
            => ("{}", why.message(signal, output)),
            help("write `through = \"SIGNAL = COMPONENT.OUTPUT\"` with names of this model");
        /// An annotation adds a term to an equation that cannot take it.
        error MO0329 UnusableTerm { determined: String, term: String, why: WrongTerm }
            => ("{}", why.message(determined, term)),
            help("write `adds = \"der(STATE) = VARIABLE\"` or `adds = \"VARIABLE = VARIABLE\"` with names of this model");
        /// An annotation adds to a start that cannot take it.
        error MO0336 UnusableStart { state: String, offset: String, why: WrongStart }
            => ("{}", why.message(state, offset)),
            help("write `starts = \"STATE = PARAMETER\"` with names of this model");
    }
}

causes! {
    /// Causes found in parameter overrides, such as those of `--set`.
    pub enum OverrideCause {
        /// A parameter override cannot be read.
        error MO0240 Malformed { text: String, why: WrongOverride }
            => ("the parameter override `{text}` {why}"), help("{}", why.remedy());
        /// A parameter override names nothing in the model.
        error MO0241 UnknownParameter { name: String, near: Option<String> }
            => ("the model has no parameter `{name}`"), remedy(Some(match near {
                Some(near) => format!("did you mean `{near}`?"),
                None => "`mocc flatten FILE` lists all parameters".to_string(),
            }));
        /// A parameter gets two values.
        error MO0253 SetTwice { first: String, second: String }
            => ("`{first}` and `{second}` set one parameter to two values"),
            help("leave one of them out");
        /// A parameter override names a variable.
        error MO1213 OverriddenVariable { name: String }
            => ("`{name}` is a variable, not a parameter"),
            help("set its start value instead: `{name}.start=...`");
    }
}

/// Where a when-equation may not occur.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WhenEquationPlace {
    Initial,
    When,
    VaryingIf,
}

impl WhenEquationPlace {
    fn remedy(self) -> &'static str {
        match self {
            WhenEquationPlace::Initial => "write it in an `equation` section",
            WhenEquationPlace::When => "write `elsewhen`, or join the conditions with `and`",
            WhenEquationPlace::VaryingIf => "put the condition into the `when`",
        }
    }
}

impl fmt::Display for WhenEquationPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            WhenEquationPlace::Initial => "an initial section",
            WhenEquationPlace::When => "another `when`",
            WhenEquationPlace::VaryingIf => "an `if` whose condition is known only at run time",
        })
    }
}

/// Where a connect-equation may not occur.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum ConnectPlace {
    VaryingIf,
    When,
}

impl fmt::Display for ConnectPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ConnectPlace::VaryingIf => "an `if` whose condition is known only at run time",
            ConnectPlace::When => "a when-clause",
        })
    }
}

/// Why a parameter cannot vary as an annotation says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WrongVariation {
    Unknown,
    NotReal,
    Factor,
    Structural,
}

impl WrongVariation {
    fn message(self, parameter: &str, factor: &str) -> String {
        match self {
            WrongVariation::Unknown => format!("the model has no parameter `{parameter}`"),
            WrongVariation::NotReal => {
                format!("`{parameter}` cannot vary: it is not a `Real` parameter")
            }
            WrongVariation::Factor => {
                format!(
                    "`{parameter}` cannot vary: `{factor}` is not a `Real` variable of the model"
                )
            }
            WrongVariation::Structural => {
                format!(
                    "`{parameter}` cannot vary: its value determines the structure of the model"
                )
            }
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            WrongVariation::Structural => "let another parameter vary",
            _ => "write `varies = \"PARAMETER = VARIABLE\"` with names of this model",
        }
    }
}

/// Why a signal cannot pass through a component as an annotation says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WrongPassage {
    Signal,
    Output,
}

impl WrongPassage {
    fn message(self, signal: &str, output: &str) -> String {
        match self {
            WrongPassage::Signal => format!(
                "`{signal}` is neither an unconnected `Real` input of the model, nor an output of a component, nor a variable that an equation is solved for"
            ),
            WrongPassage::Output => {
                format!("`{output}` is not a `Real` variable of a component of the model")
            }
        }
    }
}

/// Why a term cannot be added to an equation as an annotation says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WrongTerm {
    Equation,
    Term,
}

impl WrongTerm {
    fn message(self, determined: &str, term: &str) -> String {
        match self {
            WrongTerm::Equation => format!("no equation is written for `{determined}`"),
            WrongTerm::Term => format!("`{term}` is not a `Real` variable of the model"),
        }
    }
}

/// Why nothing can be added to a start as an annotation says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WrongStart {
    State,
    Offset,
}

impl WrongStart {
    fn message(self, state: &str, offset: &str) -> String {
        match self {
            WrongStart::State => {
                format!("`{state}` is not a variable whose declaration fixes its start")
            }
            WrongStart::Offset => format!("`{offset}` is not a `Real` parameter of the model"),
        }
    }
}

/// Why a parameter override cannot be read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum WrongOverride {
    NoValue,
    NoName,
    NoExpression,
}

impl WrongOverride {
    fn remedy(self) -> &'static str {
        match self {
            WrongOverride::NoValue | WrongOverride::NoName => {
                "write NAME=VALUE, such as `seal_a.s_ce=1.2e-3`"
            }
            WrongOverride::NoExpression => {
                "write a number, true, false, a literal such as Contact.Free, \
                 or {1, 2} after the `=`"
            }
        }
    }
}

impl fmt::Display for WrongOverride {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            WrongOverride::NoValue => "has no `=`",
            WrongOverride::NoName => "does not start with a name",
            WrongOverride::NoExpression => "has a value that is not an expression",
        })
    }
}

/// `no X`, `1 X`, `2 Xs`.
pub(super) fn counted(n: usize, what: &str) -> String {
    match n {
        0 => format!("no {what}s"),
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
}
