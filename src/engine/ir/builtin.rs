//! The table of built-in operators and functions: one row each.
//!
//! *Holds:* for each operator its Modelica name, the type of its result, its unit rule, its domain, how its
//! graph looks, how machine code computes it, its value and its derivative.
//! *Never holds:* operators that carry data (tables, transport lines, formatted strings): those are variants
//! of their own in [`Unary`](super::expr::Unary) and [`Binary`](super::expr::Binary).
//! *Read by:* whoever expands [`unary_builtins`] or [`binary_builtins`]: `ir::expr` makes the enums and their
//! facts, `symbolic::eval` the values, `symbolic::gradient` and `symbolic::partial` the derivatives,
//! `runtime::jit` the functions that machine code calls. The expansions are `match`es, so a look-up costs
//! nothing at run time.

/// How an operator is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Syntax {
    /// `name(...)`
    Function,
    /// `name(...)`, where a call has more forms than this one, such as `min` of an array.
    Overloaded,
    /// Before its operand.
    Prefix,
    /// `a or b`
    Disjunction,
    /// `a and b`
    Conjunction,
    /// `a < b`
    Relation,
    /// `a + b`
    Sum,
    /// `a * b`
    Product,
    /// `a ^ b`
    Power,
}

/// The type of a value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ValueType {
    /// That of the operand; of two operands `Real` if either is.
    Operand,
    /// `Real`
    Real,
    /// `Integer`
    Integer,
    /// `Boolean`
    Boolean,
}

/// What a unary operator asks of units, and gives.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UnaryUnit {
    /// The value has the unit of the argument.
    Same,
    /// The value has its square root.
    Root,
    /// Argument and value have no dimension.
    Number,
    /// The value has no dimension, the argument may have any.
    FromAny,
    /// Nothing is known about the unit of the value.
    Unknown,
}

/// What a binary operator asks of units, and gives.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BinaryUnit {
    /// Operands and value have one unit.
    Sum,
    /// The product of the units.
    Product,
    /// Their quotient.
    Quotient,
    /// The unit of the base to the exponent, which is a number.
    Power,
    /// Operands of one unit, a value without dimension.
    Angle,
    /// Operands of one unit; nothing is known about the unit of the value.
    Alike,
    /// Nothing is known.
    Unknown,
}

/// Where a unary function has a value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Domain {
    /// For every argument.
    Everywhere,
    /// From zero on.
    NotNegative,
    /// Above zero.
    Positive,
    /// From -1 to 1.
    UnitInterval,
}

impl Domain {
    /// The argument, moved to the border if it lies outside.
    #[inline]
    pub fn clamp(self, a: f64) -> f64 {
        match self {
            _ if a.is_nan() => a,
            Domain::Everywhere => a,
            Domain::NotNegative => a.max(0.0),
            Domain::Positive => a.max(f64::MIN_POSITIVE),
            Domain::UnitInterval => a.clamp(-1.0, 1.0),
        }
    }

    /// Whether a function of this domain has a value at `a`.
    pub fn contains(self, a: f64) -> bool {
        match self {
            Domain::Everywhere => true,
            Domain::NotNegative => a >= 0.0,
            Domain::Positive => a > 0.0,
            Domain::UnitInterval => a.abs() <= 1.0,
        }
    }
}

/// How a quotient becomes an Integer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Rounding {
    /// To the next below.
    Down,
    /// To the next above.
    Up,
    /// To the next towards zero.
    ToZero,
}

/// How the value moves with the operands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// It has a derivative wherever it is defined.
    Smooth,
    /// Two smooth branches meet.
    Kink,
    /// A Boolean value.
    Logic,
    /// Constant between jumps, which do not trigger events.
    Steps,
    /// Constant between jumps, which are events: the rounded operand or quotient.
    Rounds(Rounding),
    /// Smooth between jumps, which are events: what rounding the quotient leaves.
    Remainder(Rounding),
}

impl Shape {
    /// Whether the value jumps, and each jump is an event.
    pub fn makes_events(self) -> bool {
        matches!(self, Shape::Rounds(_) | Shape::Remainder(_))
    }

    /// Whether the value is a number that is constant between jumps.
    pub fn is_piecewise_constant(self) -> bool {
        matches!(self, Shape::Steps | Shape::Rounds(_))
    }
}

/// How machine code computes the value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Code {
    /// By instructions of the processor, which `runtime::jit` selects.
    Inline,
    /// By a call.
    Call,
    /// By a call that remembers its last arguments and value: for functions that cost more than that.
    Memo,
}

/// The facts about a unary operator: the data of its row.
#[derive(Clone, Copy, Debug)]
pub struct UnaryFacts {
    /// Its names in Modelica; the first is printed.
    pub names: &'static [&'static str],
    /// How it is written.
    pub syntax: Syntax,
    /// The type of its value.
    pub result: ValueType,
    /// Its unit rule.
    pub unit: UnaryUnit,
    /// Where it has a value.
    pub domain: Domain,
    /// How its value moves.
    pub shape: Shape,
    /// How machine code computes it.
    pub code: Code,
}

/// The facts about a binary operator: the data of its row.
#[derive(Clone, Copy, Debug)]
pub struct BinaryFacts {
    /// Its names in Modelica; the first is printed.
    pub names: &'static [&'static str],
    /// How it is written.
    pub syntax: Syntax,
    /// The type of its value.
    pub result: ValueType,
    /// Its unit rule.
    pub unit: BinaryUnit,
    /// How its value moves.
    pub shape: Shape,
    /// How machine code computes it.
    pub code: Code,
}

/// The rows of unary operators, handed to the macro `$then`.
///
/// `a` is the argument and `y` the value. The derivative is written once, for numbers and for expressions: `g`
/// is an [`Arithmetic`](crate::symbolic::arithmetic::Arithmetic). `None` stands for a function that is constant
/// wherever it has a derivative.
macro_rules! unary_builtins {
    ($then:ident) => {
        $then! {
            (a, y, g)
            // Columns: names, syntax, type, unit rule, domain, shape, machine code; value; derivative.
            Neg { (["-"], Prefix, Operand, Same, Everywhere, Smooth, Inline) -a; Some(g.real(-1.0)) }
            Not { (["not"], Prefix, Boolean, Unknown, Everywhere, Logic, Inline) truth(a == 0.0); None }
            Sin {
                (["sin"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.sin(); Some(g.unary(Unary::Cos, a))
            }
            Cos {
                (["cos"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.cos(); { let sine = g.unary(Unary::Sin, a); Some(g.neg(sine)) }
            }
            Tan {
                (["tan"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.tan(); { let square = g.square(y); Some(g.one_plus(square)) }
            }
            Asin {
                (["asin"], Function, Real, Number, UnitInterval, Smooth, Memo)
                a.asin(); Some(g.inverse_of_cathetus(a))
            }
            Acos {
                (["acos"], Function, Real, Number, UnitInterval, Smooth, Memo)
                a.acos(); { let slope = g.inverse_of_cathetus(a); Some(g.neg(slope)) }
            }
            Atan {
                (["atan"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.atan(); { let square = g.square(a); let sum = g.one_plus(square); Some(g.inverse(sum)) }
            }
            Sinh {
                (["sinh"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.sinh(); Some(g.unary(Unary::Cosh, a))
            }
            Cosh {
                (["cosh"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.cosh(); Some(g.unary(Unary::Sinh, a))
            }
            Tanh {
                (["tanh"], Function, Real, Number, Everywhere, Smooth, Memo)
                a.tanh(); { let square = g.square(y); Some(g.one_minus(square)) }
            }
            Exp { (["exp"], Function, Real, Number, Everywhere, Smooth, Memo) a.exp(); Some(y) }
            Log {
                (["log"], Function, Real, FromAny, Positive, Smooth, Memo)
                a.ln(); Some(g.inverse(a))
            }
            Log10 {
                (["log10"], Function, Real, FromAny, Positive, Smooth, Memo)
                a.log10(); { let factor = g.real(std::f64::consts::LOG10_E); Some(g.div(factor, a)) }
            }
            Sqrt {
                (["sqrt"], Function, Real, Root, NotNegative, Smooth, Inline)
                a.sqrt(); { let half = g.real(0.5); Some(g.div(half, y)) }
            }
            Abs {
                (["abs"], Function, Operand, Same, Everywhere, Kink, Inline)
                a.abs(); Some(g.unary(Unary::Sign, a))
            }
            Sign { (["sign"], Function, Integer, FromAny, Everywhere, Steps, Call) sign(a); None }
            Floor {
                (["floor"], Function, Real, Unknown, Everywhere, Rounds(Rounding::Down), Call)
                a.floor(); None
            }
            Ceil {
                (["ceil"], Function, Real, Unknown, Everywhere, Rounds(Rounding::Up), Call)
                a.ceil(); None
            }
            /// `integer(x)`: floor with an `Integer` result.
            ToInteger {
                (["integer"], Function, Integer, Unknown, Everywhere, Rounds(Rounding::Down), Call)
                a.floor(); None
            }
            /// The number of an enumeration literal; also `Integer(b)` of an event flag.
            Ordinal {
                (["Integer", "Real"], Function, Integer, Unknown, Everywhere, Steps, Inline)
                a; None
            }
        }
    };
}
pub(crate) use unary_builtins;

/// The rows of binary operators, handed to the macro `$then`.
///
/// `a` and `b` are the operands and `y` the value. The derivatives by `a` and `b` are written twice: as numbers,
/// and as expressions built with the graph `g`, each times `seed`, which a user of the chain rule puts
/// where it costs least. `None` stands for a derivative that is zero everywhere.
macro_rules! binary_builtins {
    ($then:ident) => {
        $then! {
            (a, b, y, g, seed)
            // Columns: names, syntax, type, unit rule, shape, machine code; value; derivatives as numbers; as
            // expressions.
            Add {
                (["+"], Sum, Operand, Sum, Smooth, Inline)
                a + b; (1.0, 1.0); [Some(seed), Some(seed)]
            }
            Sub {
                (["-"], Sum, Operand, Sum, Smooth, Inline)
                a - b; (1.0, -1.0); [Some(seed), Some(g.neg(seed))]
            }
            Mul {
                (["*"], Product, Operand, Product, Smooth, Inline)
                a * b; (b, a); [Some(g.mul(seed, b)), Some(g.mul(seed, a))]
            }
            Div {
                (["/"], Product, Real, Quotient, Smooth, Inline)
                a / b; (1.0 / b, -y / b); divided(g, b, y, seed)
            }
            Pow {
                (["^"], Power, Real, Power, Smooth, Memo)
                power(a, b); power_slopes(a, b, y); power_chain(g, a, b, y, seed)
            }
            Less {
                (["<"], Relation, Boolean, Alike, Logic, Inline)
                truth(a < b); (0.0, 0.0); [None, None]
            }
            LessEqual {
                (["<="], Relation, Boolean, Alike, Logic, Inline)
                truth(a <= b); (0.0, 0.0); [None, None]
            }
            Greater {
                ([">"], Relation, Boolean, Alike, Logic, Inline)
                truth(a > b); (0.0, 0.0); [None, None]
            }
            GreaterEqual {
                ([">="], Relation, Boolean, Alike, Logic, Inline)
                truth(a >= b); (0.0, 0.0); [None, None]
            }
            Equal {
                (["=="], Relation, Boolean, Unknown, Logic, Inline)
                truth(a == b); (0.0, 0.0); [None, None]
            }
            NotEqual {
                (["<>"], Relation, Boolean, Unknown, Logic, Inline)
                truth(a != b); (0.0, 0.0); [None, None]
            }
            And {
                (["and"], Conjunction, Boolean, Unknown, Logic, Inline)
                truth(a != 0.0 && b != 0.0); (0.0, 0.0); [None, None]
            }
            Or {
                (["or"], Disjunction, Boolean, Unknown, Logic, Inline)
                truth(a != 0.0 || b != 0.0); (0.0, 0.0); [None, None]
            }
            Atan2 {
                (["atan2"], Function, Real, Angle, Smooth, Memo)
                a.atan2(b);
                { let sum = a * a + b * b; (b / sum, -a / sum) };
                angle(g, a, b, seed)
            }
            Min {
                (["min"], Overloaded, Operand, Sum, Kink, Inline)
                if b < a || b.is_nan() { b } else { a };
                if a <= b { (1.0, 0.0) } else { (0.0, 1.0) };
                chosen(g, Binary::LessEqual, a, b, seed)
            }
            Max {
                (["max"], Overloaded, Operand, Sum, Kink, Inline)
                if b > a || b.is_nan() { b } else { a };
                if a >= b { (1.0, 0.0) } else { (0.0, 1.0) };
                chosen(g, Binary::GreaterEqual, a, b, seed)
            }
            /// `div(x, y)`: quotient truncated towards zero.
            Quotient {
                (["div"], Function, Operand, Unknown, Rounds(Rounding::ToZero), Call)
                (a / b).trunc(); (0.0, 0.0); [None, None]
            }
            Mod {
                (["mod"], Function, Operand, Alike, Remainder(Rounding::Down), Call)
                a - (a / b).floor() * b; (1.0, -(a / b).floor()); remainder(g, a, b, y, seed)
            }
            Rem {
                (["rem"], Function, Operand, Alike, Remainder(Rounding::ToZero), Call)
                a - (a / b).trunc() * b; (1.0, -(a / b).trunc()); remainder(g, a, b, y, seed)
            }
        }
    };
}
pub(crate) use binary_builtins;
