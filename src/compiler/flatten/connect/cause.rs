//! Causes found in connectors and connections.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;
use crate::flatten::cause::counted;

causes! {
    /// Causes found in connectors and connections.
    pub enum ConnectCause {
        /// A connection names something that is not a connector.
        error MO0230 NotAConnector { path: String } (section "9.1")
            => ("`{path}` is not a connector"),
            help("connect its connectors, `component.connector`, or write an equation");
        /// A connection names a connector inside of a component of a component.
        error MO1210 ConnectedTooDeep { name: Name } (section "9.1")
            => ("`{name}` is inside of a component of a component"),
            help("connect it in the class that declares its component");
        /// Two connectors are connected that do not match.
        error MO1211 ConnectorsDiffer { why: Mismatch } (section "9.3")
            => ("the two connectors {why}"), help("connect connectors of the same class");
        /// Two connected parameters or constants have different values.
        error MO1291 ValuesDiffer { names: [String; 2], values: [String; 2] } (section "9.3")
            => (
                "`{}` and `{}` are connected, but have the values {} and {}",
                names[0], names[1], values[0], values[1]
            ),
            help("give both the same value");
        /// No connector of a component is connected.
        warning MO0327 IsolatedComponent { path: String } (section "9.2")
            => ("no connector of `{path}` is connected: all its flows are zero"),
            help("connect it, or remove it");
        /// A connector of a component is not connected, so that nothing flows through the component.
        warning MO0334 OpenEnd { connector: String, path: String } (section "9.2")
            => ("`{connector}` is not connected, so nothing flows through `{path}`"),
            help("connect it, or remove the component");
        /// An expandable connector is connected to a component that is not expandable.
        error MO1212 ExpandableWithOther { path: String, bus: String } (section "9.1.3")
            => ("an expandable connector is connected to `{path}`, which is not expandable"),
            help("name a variable of the expandable connector: `{bus}.NAME`");
        /// An expandable connector declares a flow variable.
        error MO0243 FlowInExpandable { path: String } (section "9.1.3")
            => ("`{path}` is a flow variable of an expandable connector"),
            help("declare it in a connector, and that in the expandable one");
        /// A variable of an expandable connector has a declaration equation.
        error MO1214 BoundInExpandable { path: String } (section "9.1.3")
            => ("`{path}` has a value here, but may not exist"),
            help("connect it to an output that has the value");
        /// A variable of an expandable connector is read, and nothing gives it a value.
        error MO0244 UndrivenVariable { path: String } (section "9.1.3")
            => ("nothing gives `{path}` a value"),
            help("connect an output to it, here or at any connector that this one is connected to");
        /// A connector has another number of flows than of potentials.
        error MO0245 UnbalancedConnector { connector: String, potentials: usize, flows: usize }
            (section "9.3.1")
            => (
                "connector `{connector}` has {} and {}",
                counted(*potentials, "potential"),
                counted(*flows, "flow")
            ),
            help("{}", match flows {
                0 => "declare one `flow` variable for each potential, \
                      or make them `input` or `output`",
                _ => "give each potential one `flow` variable, \
                      and each `flow` variable a potential",
            });
        /// A connector with `stream` variables does not have one flow.
        error MO1215 StreamFlows { connector: String, streams: usize, flows: usize }
            (section "15.1")
            => (
                "connector `{connector}` has {} and {}",
                counted(*streams, "`stream` variable"),
                counted(*flows, "flow")
            ),
            help("give it one scalar `flow` variable, which transports the `stream` variables");
        /// Two connected variables both give a value.
        error MO0246 TwoSources { first: String, second: String } (section "9.3")
            => ("`{first}` and `{second}` are connected, and both give a value"),
            help("connect each input to one output only");
        /// A variable of a block's connector is neither input nor output.
        error MO0249 UndirectedInBlock { variable: String } (section "4.6")
            => ("`{variable}` of a block is neither input nor output"),
            help("use connectors of inputs and outputs, or declare the class as a model");
        /// A flow variable is of an operator record that has no sum.
        error MO0250 FlowWithoutOperator { path: String, class: Name, operator: &'static str }
            (section "9.2")
            => ("`{path}` is a flow, but `{class}` has no operator {operator}"),
            help("define the operators '0', '+' and '-' of one argument, \
                  which sums at connections need");
        /// An argument of an operator of `Connections` is not overdetermined.
        error MO0350 NotOverdetermined (section "9.4.1")
            => ("the argument must be an overdetermined variable or record of a connector"),
            help("name one whose type has a function `equalityConstraint`");
        /// Branches close a cycle, or join two roots.
        error MO0351 BranchClosesCycle (section "9.4.2")
            => ("this branch closes a cycle that cannot be broken, or joins two roots"),
            help("remove a `Connections.branch` or a `Connections.root`: \
                  its equations determine the same variables again");
        /// A connection graph has no root.
        warning MO0352 NoRoot { path: String } (section "9.4.2")
            => ("nothing that is connected with `{path}` is a root"),
            help("connect a component that is a root, such as a ground or the world");
        /// An unknown operator of `Connections`, or wrong arguments.
        error MO0353 GraphOperator { function: Name } (section "9.4.1")
            => ("`Connections.{function}` is not an operator of connection graphs with these arguments"),
            help("use `branch(a, b)`, `root(a)`, or `potentialRoot(a, priority)`");
        /// The function `equalityConstraint` has the wrong result.
        error MO0354 ConstraintType { class: Name } (section "9.4")
            => ("`{class}` must return one vector of Real residuals"),
            help("declare `output Real residue[n]`");
        /// An expandable connector is connected with a connector inside of it.
        error MO0276 ConnectedToOwnPart { outer: String, inner: String } (section "9.1.3")
            => ("`{outer}` is connected with `{inner}`, which is inside of it"),
            help("connect a bus with buses outside of it, or with variables in it");
    }
}

/// How two connected connectors differ.
#[derive(Clone, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Mismatch {
    /// An array and a scalar, or a record and a variable.
    Kind,
    Sizes,
    Variables,
    /// Only one of them has this element.
    OnlyOne(Name),
    FlowWithPotential,
    Types,
    /// A signal, and a variable that is neither input nor output.
    SignalWithOther {
        signal: String,
        other: String,
    },
    /// Two components, each with its variability in words.
    Variability([(String, &'static str); 2]),
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mismatch::Kind => f.write_str("are of different kinds"),
            Mismatch::Sizes => f.write_str("have different sizes"),
            Mismatch::Variables => f.write_str("do not match: they have different variables"),
            Mismatch::OnlyOne(name) => write!(f, "do not match: only one of them has `{name}`"),
            Mismatch::FlowWithPotential => {
                f.write_str("do not match: a flow variable is connected with a potential")
            }
            Mismatch::Types => f.write_str("do not match: their variables have different types"),
            Mismatch::SignalWithOther { signal, other } => write!(
                f,
                "do not match: `{signal}` is an input or output, and `{other}` is neither"
            ),
            Mismatch::Variability([(first, a), (second, b)]) => {
                write!(f, "do not match: `{first}` is {a}, and `{second}` is {b}")
            }
        }
    }
}
