//! The one expression graph after parsing: typed, scalar, hash-consed.
//!
//! *Holds:* every scalar expression of a model once; equal expressions have equal ids, so common
//! sub-expressions are shared from the first day and differentiation and code follow the sharing.
//! *Never holds:* arrays, records (they are scalarised before), syntax, source positions
//! (equations carry those).
//! *Made by:* `flatten` (through the simplifying constructors of `symbolic`). *Read by:* all after.

use hashbrown::HashTable;
use std::hash::{BuildHasher, Hash};
use std::sync::Arc;

use crate::base::index::{FastMap, Id, IndexVec};
use crate::base::name::{self, Name};
use crate::define_id;
use crate::external::External;
pub use crate::external::printf::Form;
use crate::ir::builtin::{BinaryFacts, Shape, Syntax, UnaryFacts, binary_builtins, unary_builtins};
use crate::ir::clock::ClockOperator;
use crate::ir::external::{ExternalId, Externals};

define_id! {
    /// A node of the [`Graph`].
    pub struct ExprId
}
define_id! {
    /// A scalar variable of the flat model.
    pub struct VarId
}
define_id! {
    /// A function that is called at run time.
    pub struct FunctionId
}
define_id! {
    /// An enumeration type.
    pub struct EnumId
}
define_id! {
    /// An interned list of arguments.
    pub struct ListId
}
define_id! {
    /// A format of numbers as strings.
    pub struct FormId
}

/// The scalar types.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Type {
    /// `Real`
    Real,
    /// `Integer`
    Integer,
    /// `Boolean`
    Boolean,
    /// `String`
    String,
    /// An enumeration.
    Enumeration(EnumId),
    /// `Clock`. Gone after `clocks`.
    Clock,
}

/// A literal value. Reals are kept by their bits, so that the graph can compare and hash them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Const {
    /// The bits of a finite `f64`.
    Real(u64),
    /// An integer.
    Integer(i64),
    /// A Boolean.
    Boolean(bool),
    /// A string.
    String(Name),
    /// A literal of an enumeration, counted from 1.
    Enumeration(EnumId, u32),
}

macro_rules! define_unary {
    (($($_:ident),*) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
        /// Unary operators and functions: the rows of the [table](super::builtin), and those that carry data.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        #[allow(missing_docs)]
        pub enum Unary {
            $($(#[$doc])* $op,)*
            /// An external function.
            External(ExternalId),
            /// The value on a transport line at the position that the operand gives.
            Carried(Carried),
            /// `String(x)` in this form.
            Text(FormId),
        }

        impl Unary {
            /// The operators of the table, in its order.
            pub const TABLE: &'static [Unary] = &[$(Unary::$op),*];

            /// The row of the table; `None` for operators that carry data.
            pub const fn facts(self) -> Option<&'static UnaryFacts> {
                use super::builtin::{Code::*, Domain::*, Rounding, Shape::*, Syntax::*, UnaryUnit::*};
                use super::builtin::ValueType::{Boolean, Integer, Operand, Real};
                macro_rules! row {
                    (($names:expr, $syntax:expr, $result:expr, $unit:expr, $domain:expr, $shape:expr,
                      $code:expr)) => {
                        Some(&const {
                            UnaryFacts {
                                names: &$names,
                                syntax: $syntax,
                                result: $result,
                                unit: $unit,
                                domain: $domain,
                                shape: $shape,
                                code: $code,
                            }
                        })
                    };
                }
                match self {
                    $(Unary::$op => row!($facts),)*
                    Unary::External(_) | Unary::Carried(_) | Unary::Text(_) => None,
                }
            }
        }
    };
}
unary_builtins!(define_unary);

/// A read of a profile on a transport line.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Carried {
    /// Number of the line in the model.
    pub line: u16,
    /// Number of the reader of this line.
    pub reader: u16,
    /// Order of the derivative by the place; 0 the value itself.
    pub order: u8,
}

macro_rules! define_binary {
    (($($_:ident),*) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
        /// Binary operators and functions: the rows of the [table](super::builtin), and those that carry data.
        /// Relations give `Boolean`.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        #[allow(missing_docs)]
        pub enum Binary {
            $($(#[$doc])* $op,)*
            /// An external function.
            External(ExternalId),
        }

        impl Binary {
            /// The operators of the table, in its order.
            pub const TABLE: &'static [Binary] = &[$(Binary::$op),*];

            /// The row of the table; `None` for operators that carry data.
            pub const fn facts(self) -> Option<&'static BinaryFacts> {
                use super::builtin::{BinaryUnit, Code::*, Rounding, Shape::*};
                use super::builtin::ValueType::{Boolean, Operand, Real};
                macro_rules! row {
                    (($names:expr, $syntax:ident, $result:expr, $unit:ident, $shape:expr, $code:expr)) => {
                        Some(&const {
                            BinaryFacts {
                                names: &$names,
                                syntax: Syntax::$syntax,
                                result: $result,
                                unit: BinaryUnit::$unit,
                                shape: $shape,
                                code: $code,
                            }
                        })
                    };
                }
                match self {
                    $(Binary::$op => row!($facts),)*
                    Binary::External(_) => None,
                }
            }
        }
    };
}
binary_builtins!(define_binary);

/// One node.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Node {
    /// A literal.
    Const(Const),
    /// `time`
    Time,
    /// The current value of a variable.
    Var(VarId),
    /// `der(v)`. Gone after `lower`, which gives derivatives variables of their own.
    Der(VarId),
    /// `pre(v)`
    Pre(VarId),
    /// An operator or function of one argument.
    Unary(Unary, ExprId),
    /// An operator or function of two arguments.
    Binary(Binary, ExprId, ExprId),
    /// `if c then a else b`
    If(ExprId, ExprId, ExprId),
    /// `noEvent(e)`
    NoEvent(ExprId),
    /// `smooth(k, e)`
    Smooth(u32, ExprId),
    /// `homotopy(actual, simplified)`
    Homotopy(ExprId, ExprId),
    /// Output `output` of a function called at run time.
    Call {
        /// The function.
        function: FunctionId,
        /// Which of its scalar outputs.
        output: u32,
        /// Its scalar arguments.
        args: ListId,
    },
    /// `sample(start, interval)`
    Sample(ExprId, ExprId),
    /// An operator of clocks or state machines. Gone after `clocks`.
    Clocked(ClockOperator, ListId),
    /// `initial()`
    Initial,
    /// `terminal()`
    Terminal,
    /// The value of relation `k` of the model, held between events. Made by `lower`.
    Relation(u32),
    /// The recorded value of an input at `time` (order 0), or its derivative of this order.
    /// Made by `lower`.
    Recorded(VarId, u32),
}

/// Large models have tens of millions of nodes.
const _: () = assert!(size_of::<(Node, Type)>() == 32);

/// An enumeration type.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Enumeration {
    /// Its full name.
    pub name: String,
    /// Its literals in order.
    pub literals: Vec<Name>,
}

/// Variables from this number on are symbols: placeholders for values that a loop computes.
pub const FIRST_SYMBOL: u32 = 1 << 30;

/// The expression graph.
#[derive(Clone, Default)]
pub struct Graph {
    /// The nodes with their types, which are looked up together.
    nodes: IndexVec<ExprId, (Node, Type)>,
    table: HashTable<ExprId>,
    /// The nodes of variables, by number. Most look-ups are for variables, so these bypass the hash
    /// table.
    variables: Vec<Option<ExprId>>,
    lists: IndexVec<ListId, Box<[ExprId]>>,
    list_table: FastMap<Box<[ExprId]>, ListId>,
    /// The enumeration types of the model.
    pub enumerations: IndexVec<EnumId, Enumeration>,
    /// The formats of `String(...)`, all different.
    pub forms: IndexVec<FormId, Form>,
    externals: Arc<Externals>,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// The external functions.
    #[inline]
    pub fn externals(&self) -> &Arc<Externals> {
        &self.externals
    }

    /// Drops the external functions of a graph that is not used any more and is not to be freed: the FMUs among them
    /// remove their folders.
    pub fn release_externals(&mut self) {
        self.externals = Arc::default();
    }

    /// The id of an external function, which is added unless an equal one exists.
    pub fn add_external(&mut self, function: Arc<dyn External>) -> ExternalId {
        Arc::make_mut(&mut self.externals).add(function)
    }

    /// The partial derivative of an external function by an argument (counted from 0); `None` if it
    /// is 0 everywhere.
    pub fn external_derivative(&mut self, f: ExternalId, argument: usize) -> Option<ExternalId> {
        let derivative = self.externals.get(f).derivative(argument)?;
        Some(self.add_external(derivative))
    }

    /// The id of a format, which is added unless an equal one exists.
    pub fn add_form(&mut self, form: Form) -> FormId {
        let known = self.forms.enumerate().find(|(_, other)| **other == form).map(|(id, _)| id);
        known.unwrap_or_else(|| self.forms.push(form))
    }

    /// The node of an id.
    #[inline]
    pub fn node(&self, e: ExprId) -> Node {
        self.nodes[e].0
    }

    /// The type of an expression.
    #[inline]
    pub fn ty(&self, e: ExprId) -> Type {
        self.nodes[e].1
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// All nodes.
    pub fn ids(&self) -> impl Iterator<Item = ExprId> {
        self.nodes.ids()
    }

    /// True without nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The arguments of a call.
    pub fn list(&self, id: ListId) -> &[ExprId] {
        &self.lists[id]
    }

    /// Interns a list of arguments.
    pub fn intern_list(&mut self, items: &[ExprId]) -> ListId {
        if let Some(id) = self.list_table.get(items) {
            return *id;
        }
        let id = self.lists.push(items.into());
        self.list_table.insert(items.into(), id);
        id
    }

    /// Interns a node exactly as given, without simplification.
    pub fn intern(&mut self, node: Node, ty: Type) -> ExprId {
        let hasher = rustc_hash::FxBuildHasher;
        let typed = (node, ty);
        let hash = hasher.hash_one(typed);
        let nodes = &self.nodes;
        if let Some(id) = self.table.find(hash, |id| nodes[*id] == typed) {
            return *id;
        }
        let id = self.nodes.push(typed);
        let nodes = &self.nodes;
        self.table.insert_unique(hash, id, |id| hasher.hash_one(nodes[*id]));
        id
    }

    /// Removes all nodes but the first `len`, to which no other refers.
    pub fn truncate(&mut self, len: usize) {
        let hasher = rustc_hash::FxBuildHasher;
        while self.nodes.len() > len {
            let last = ExprId::from_usize(self.nodes.len() - 1);
            let typed = self.nodes[last];
            match typed.0 {
                Node::Var(v) if self.known_variable(v) == Some(last) => {
                    self.variables[v.idx()] = None;
                }
                _ => {
                    let hash = hasher.hash_one(typed);
                    if let Ok(entry) = self.table.find_entry(hash, |id| *id == last) {
                        entry.remove();
                    }
                }
            }
            self.nodes.pop();
        }
    }

    /// A literal.
    pub fn constant(&mut self, value: Const) -> ExprId {
        let ty = match value {
            Const::Real(_) => Type::Real,
            Const::Integer(_) => Type::Integer,
            Const::Boolean(_) => Type::Boolean,
            Const::String(_) => Type::String,
            Const::Enumeration(e, _) => Type::Enumeration(e),
        };
        self.intern(Node::Const(value), ty)
    }

    /// A real literal; `-0.0` is stored as `0.0`.
    pub fn real(&mut self, value: f64) -> ExprId {
        self.constant(Const::Real((value + 0.0).to_bits()))
    }

    /// An integer literal.
    pub fn integer(&mut self, value: i64) -> ExprId {
        self.constant(Const::Integer(value))
    }

    /// A Boolean literal.
    pub fn boolean(&mut self, value: bool) -> ExprId {
        self.constant(Const::Boolean(value))
    }

    /// `time`
    pub fn time(&mut self) -> ExprId {
        self.intern(Node::Time, Type::Real)
    }

    /// The value of a variable.
    pub fn var(&mut self, v: VarId, ty: Type) -> ExprId {
        let at = v.0 as usize;
        match self.variables.get(at) {
            Some(Some(known)) if self.nodes[*known].1 == ty => return *known,
            // In a function its number may stand for a local of another type.
            Some(Some(_)) => return self.intern(Node::Var(v), ty),
            _ if v.0 >= FIRST_SYMBOL => return self.intern(Node::Var(v), ty),
            _ => {}
        }
        if self.variables.len() <= at {
            self.variables.resize(at + 1, None);
        }
        let e = self.nodes.push((Node::Var(v), ty));
        self.variables[at] = Some(e);
        e
    }

    /// The literal that stands for a value of a Boolean or an enumeration; `None` for numbers.
    pub fn literal(&self, ty: Type, value: f64) -> Option<String> {
        match ty {
            Type::Boolean => Some((value != 0.0).to_string()),
            Type::Enumeration(e) => {
                let kind = &self.enumerations[e];
                let literal = (value as usize).checked_sub(1).and_then(|k| kind.literals.get(k))?;
                Some(format!("{}.{literal}", kind.name))
            }
            _ => None,
        }
    }

    /// The literal, if the expression is one.
    pub fn as_const(&self, e: ExprId) -> Option<Const> {
        match self.node(e) {
            Node::Const(c) => Some(c),
            _ => None,
        }
    }

    /// The node of a variable, if an expression reads it.
    pub fn known_variable(&self, v: VarId) -> Option<ExprId> {
        self.variables.get(v.0 as usize).copied().flatten()
    }

    /// The number, if the expression is a real or integer literal.
    pub fn as_number(&self, e: ExprId) -> Option<f64> {
        self.as_const(e).and_then(Const::number)
    }
}

impl Const {
    /// The number of a real or integer literal.
    pub fn number(self) -> Option<f64> {
        match self {
            Const::Real(bits) => Some(f64::from_bits(bits)),
            Const::Integer(i) => Some(i as f64),
            _ => None,
        }
    }

    /// The literal of a type whose register holds `x`.
    pub fn of_type(ty: Type, x: f64) -> Const {
        match ty {
            Type::Real => Const::Real(x.to_bits()),
            Type::Integer => Const::Integer(x as i64),
            Type::Boolean | Type::Clock => Const::Boolean(x != 0.0),
            Type::Enumeration(t) => Const::Enumeration(t, x as u32),
            Type::String => Const::String(name::string_of_id(x as u32)),
        }
    }

    /// The value of the literal in a register at run time: Booleans are 0 and 1, enumeration
    /// literals and strings their number.
    pub fn register(self) -> f64 {
        match self {
            Const::Real(bits) => f64::from_bits(bits),
            Const::Integer(i) => i as f64,
            Const::Boolean(b) => f64::from(u8::from(b)),
            Const::Enumeration(_, k) => f64::from(k),
            Const::String(text) => f64::from(name::string_id(text)),
        }
    }
}

impl Unary {
    /// The operator or the function's name in Modelica.
    pub fn name(self) -> &'static str {
        match self {
            Unary::External(_) => "external",
            Unary::Carried(_) => "carried",
            Unary::Text(_) => "String",
            _ => self.facts().map_or("", |row| row.names[0]),
        }
    }

    /// How its value moves with the operand.
    pub fn shape(self) -> Shape {
        self.facts().map_or(Shape::Smooth, |row| row.shape)
    }

    /// The names by which Modelica calls it; none if it is not a function.
    pub fn called_names(self) -> &'static [&'static str] {
        self.facts().filter(|row| row.syntax == Syntax::Function).map_or(&[], |row| row.names)
    }

    /// The function that Modelica calls by this name.
    pub fn called(name: &str) -> Option<Unary> {
        Unary::TABLE.iter().copied().find(|op| op.called_names().contains(&name))
    }
}

impl Binary {
    /// The operator or the function's name in Modelica.
    pub fn name(self) -> &'static str {
        match self {
            Binary::External(_) => "external",
            _ => self.facts().map_or("", |row| row.names[0]),
        }
    }

    /// How its value moves with the operands.
    pub fn shape(self) -> Shape {
        self.facts().map_or(Shape::Smooth, |row| row.shape)
    }

    /// The names by which Modelica calls it; none if it is not a function.
    pub fn called_names(self) -> &'static [&'static str] {
        self.facts().filter(|row| row.syntax == Syntax::Function).map_or(&[], |row| row.names)
    }

    /// The function that Modelica calls by this name.
    pub fn called(name: &str) -> Option<Binary> {
        Binary::TABLE.iter().copied().find(|op| op.called_names().contains(&name))
    }

    /// True for `<`, `<=`, `>`, `>=`, `==`, `<>`.
    pub fn is_relation(self) -> bool {
        self.facts().is_some_and(|row| row.syntax == Syntax::Relation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_truncated_graph_is_as_it_was() {
        let mut graph = Graph::new();
        let (x, y) = (VarId(0), VarId(1));
        let a = graph.var(x, Type::Real);
        let kept = graph.intern(Node::Unary(Unary::Neg, a), Type::Real);
        let len = graph.len();
        let b = graph.var(y, Type::Real);
        let sum = graph.intern(Node::Binary(Binary::Add, a, b), Type::Real);
        graph.truncate(len);
        assert_eq!((graph.len(), graph.known_variable(y)), (len, None));
        assert_eq!(graph.var(x, Type::Real), a);
        assert_eq!(graph.intern(Node::Unary(Unary::Neg, a), Type::Real), kept);
        assert_eq!(graph.var(y, Type::Real), b);
        assert_eq!(graph.intern(Node::Binary(Binary::Add, a, b), Type::Real), sum);
    }

    #[test]
    fn equal_formats_have_one_id() {
        let mut graph = Graph::new();
        let wide = Form { width: 8, ..Form::default() };
        let ids = [Form::default(), wide, Form::default()].map(|form| graph.add_form(form));
        assert_eq!(ids[0], ids[2]);
        assert_eq!(graph.forms[ids[1]], wide);
    }
}
