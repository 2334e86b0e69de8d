//! The types of variables: how the library passes them, and what declared types say of all their variables.

use roxmltree::Node;

use super::child;
use crate::fmu::description::Version;

/// How the library passes the values of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Passing {
    /// As doubles.
    Float64,
    /// As floats.
    Float32,
    /// As whole numbers of so many bits, with or without sign.
    Int8,
    /// See [`Passing::Int8`].
    UInt8,
    /// See [`Passing::Int8`].
    Int16,
    /// See [`Passing::Int8`].
    UInt16,
    /// See [`Passing::Int8`]; in FMI 2 Integer and Enumeration.
    Int32,
    /// See [`Passing::Int8`].
    UInt32,
    /// See [`Passing::Int8`]; in FMI 3 Enumeration too.
    Int64,
    /// See [`Passing::Int8`].
    UInt64,
    /// As Booleans.
    Boolean,
}

impl Passing {
    /// All, by their number.
    pub const ALL: [Passing; 11] = [
        Passing::Float64,
        Passing::Float32,
        Passing::Int8,
        Passing::UInt8,
        Passing::Int16,
        Passing::UInt16,
        Passing::Int32,
        Passing::UInt32,
        Passing::Int64,
        Passing::UInt64,
        Passing::Boolean,
    ];

    /// The least and the greatest whole number that can be passed so; `None` for other types, and for Integers as those of
    /// Modelica.
    pub fn bounds(self) -> Option<(f64, f64)> {
        let signed = |bits: i32| (-2.0_f64.powi(bits - 1), 2.0_f64.powi(bits - 1) - 1.0);
        let unsigned = |bits: i32| (0.0, 2.0_f64.powi(bits) - 1.0);
        Some(match self {
            Passing::Int8 => signed(8),
            Passing::UInt8 => unsigned(8),
            Passing::Int16 => signed(16),
            Passing::UInt16 => unsigned(16),
            Passing::UInt32 => unsigned(32),
            // Beyond this, doubles are not whole numbers.
            Passing::UInt64 => unsigned(53),
            Passing::Int32 | Passing::Int64 => return None,
            Passing::Float64 | Passing::Float32 | Passing::Boolean => return None,
        })
    }
}

/// The way in which the variables of an element are passed; `None` for text, binaries and clocks.
pub(super) fn passing(version: Version, tag: &str) -> Option<Passing> {
    Some(match (version, tag) {
        (Version::Two, "Real") | (Version::Three, "Float64") => Passing::Float64,
        (Version::Two, "Integer" | "Enumeration") | (Version::Three, "Int32") => Passing::Int32,
        (_, "Boolean") => Passing::Boolean,
        (Version::Three, "Float32") => Passing::Float32,
        (Version::Three, "Int8") => Passing::Int8,
        (Version::Three, "UInt8") => Passing::UInt8,
        (Version::Three, "Int16") => Passing::Int16,
        (Version::Three, "UInt16") => Passing::UInt16,
        (Version::Three, "UInt32") => Passing::UInt32,
        (Version::Three, "Int64" | "Enumeration") => Passing::Int64,
        (Version::Three, "UInt64") => Passing::UInt64,
        _ => return None,
    })
}

/// Declared types, whose attributes hold for variables without their own.
pub(super) struct Types<'a, 'i> {
    list: Vec<(&'a str, Node<'a, 'i>)>,
}

impl<'a, 'i> Types<'a, 'i> {
    pub(super) fn of(root: Node<'a, 'i>) -> Self {
        let definitions = child(root, "TypeDefinitions");
        let elements = definitions.into_iter().flat_map(|d| d.children());
        let list = elements.filter(Node::is_element).filter_map(|e| {
            let inner = match e.tag_name().name() {
                "SimpleType" => e.children().find(Node::is_element)?,
                _ => e,
            };
            Some((e.attribute("name")?, inner))
        });
        Types { list: list.collect() }
    }

    pub(super) fn attribute<'n>(&'n self, typed: Node<'n, '_>, key: &str) -> Option<&'n str> {
        if let Some(own) = typed.attribute(key) {
            return Some(own);
        }
        let declared = typed.attribute("declaredType")?;
        let (_, found) = self.list.iter().find(|(name, _)| *name == declared)?;
        found.attribute(key)
    }
}
