//! Values of expressions: scalars of the graph, arrays and records of them.

use std::rc::Rc;

use crate::base::name::Name;
use crate::ir::ast::Ident;
use crate::ir::expr::ExprId;
use crate::ir::instance::ClassId;

/// The value of an expression, scalarised.
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// A scalar.
    Scalar(ExprId),
    /// An array of scalars or records.
    Array(Rc<Array>),
    /// A record.
    Record(Rc<Record>),
    /// The outputs of a function with several, as far as they are asked for.
    Tuple(Rc<[Value]>),
    /// A function, as an argument of another one.
    Function(Rc<Partial>),
}

/// A function of which some arguments may be given already (section 12.4.2.1).
#[derive(Clone, PartialEq, Debug)]
pub struct Partial {
    /// The function.
    pub class: ClassId,
    /// The arguments that are given.
    pub bound: Vec<(Ident, Value)>,
}

/// An array, row-major.
#[derive(Clone, PartialEq, Debug)]
pub struct Array {
    /// Sizes; at least one.
    pub dims: Vec<usize>,
    /// As many as the product of the sizes; none is an array.
    pub elements: Vec<Value>,
}

/// A record.
#[derive(Clone, PartialEq, Debug)]
pub struct Record {
    /// Its class.
    pub class: Option<ClassId>,
    /// Its fields in order.
    pub fields: Vec<(Name, Value)>,
}

impl Value {
    /// An array, or a scalar if there are no sizes.
    pub fn array(dims: Vec<usize>, elements: Vec<Value>) -> Value {
        debug_assert_eq!(dims.iter().product::<usize>(), elements.len());
        if dims.is_empty() {
            return elements.into_iter().next().expect("a scalar has one element");
        }
        Value::Array(Rc::new(Array { dims, elements }))
    }

    /// A vector of scalars.
    pub fn vector(elements: Vec<ExprId>) -> Value {
        let n = elements.len();
        Value::array(vec![n], elements.into_iter().map(Value::Scalar).collect())
    }

    /// Sizes; empty for scalars and records.
    pub fn dims(&self) -> &[usize] {
        match self {
            Value::Array(a) => &a.dims,
            _ => &[],
        }
    }

    /// The scalar, if it is one.
    pub fn scalar(&self) -> Option<ExprId> {
        match self {
            Value::Scalar(e) => Some(*e),
            _ => None,
        }
    }

    /// Elements of an array in order, or the value itself.
    pub fn elements(&self) -> &[Value] {
        match self {
            Value::Array(a) => &a.elements,
            other => std::slice::from_ref(other),
        }
    }

    /// The parts that subscripts of the first dimensions select, row-major; the elements if there are no further ones.
    pub fn parts(&self, outer: usize) -> Vec<Value> {
        let Some(own) = self.dims().get(outer..).filter(|own| !own.is_empty()) else {
            return self.elements().to_vec();
        };
        let count = own.iter().product::<usize>().max(1);
        let parts = self.elements().chunks(count);
        parts.map(|part| Value::array(own.to_vec(), part.to_vec())).collect()
    }

    /// Replaces an element of an array, by its position; no other value changes.
    pub fn set_element(&mut self, at: usize, element: Value) {
        if let Value::Array(a) = self
            && at < a.elements.len()
        {
            Rc::make_mut(a).elements[at] = element;
        }
    }

    /// Applies `f` to each element, keeping the sizes.
    pub fn map(&self, mut f: impl FnMut(&Value) -> Option<Value>) -> Option<Value> {
        match self {
            Value::Array(a) => {
                let elements = a.elements.iter().map(f).collect::<Option<Vec<_>>>()?;
                let mut dims = a.dims.clone();
                // A function may turn each element into an array: its sizes come last.
                if let Some(Value::Array(inner)) = elements.first() {
                    dims.extend(&inner.dims);
                    let flat = elements.iter().flat_map(|e| e.elements().to_vec()).collect();
                    return Some(Value::array(dims, flat));
                }
                Some(Value::array(dims, elements))
            }
            other => f(other),
        }
    }

    /// The part that whole-number subscripts (from 1) select: fewer subscripts than sizes give an array.
    /// `None` if one is out of range or there are too many.
    pub fn select(&self, subscripts: &[usize]) -> Option<Value> {
        if subscripts.is_empty() {
            return Some(self.clone());
        }
        let Value::Array(a) = self else { return None };
        let (offset, rest) = offset(&a.dims, subscripts)?;
        let count: usize = rest.iter().product();
        let elements = a.elements[offset..offset + count].to_vec();
        Some(Value::array(rest.to_vec(), elements))
    }

    /// The field of a record; of each element for an array of records.
    pub fn field(&self, name: Name) -> Option<Value> {
        match self {
            Value::Record(r) => r.fields.iter().find(|(n, _)| *n == name).map(|(_, v)| v.clone()),
            Value::Array(_) => self.map(|e| e.field(name)),
            _ => None,
        }
    }

    /// The value with every scalar in it replaced.
    pub fn each_scalar(&self, f: &mut impl FnMut(ExprId) -> ExprId) -> Value {
        match self {
            Value::Scalar(e) => Value::Scalar(f(*e)),
            Value::Array(a) => Value::Array(Rc::new(Array {
                dims: a.dims.clone(),
                elements: a.elements.iter().map(|v| v.each_scalar(f)).collect(),
            })),
            Value::Record(r) => Value::Record(Rc::new(Record {
                class: r.class,
                fields: r.fields.iter().map(|(n, v)| (*n, v.each_scalar(f))).collect(),
            })),
            Value::Tuple(t) => Value::Tuple(t.iter().map(|v| v.each_scalar(f)).collect()),
            Value::Function(p) => Value::Function(Rc::new(Partial {
                class: p.class,
                bound: p.bound.iter().map(|(n, v)| (*n, v.each_scalar(f))).collect(),
            })),
        }
    }

    /// Calls `f` with every scalar in it.
    pub fn for_each_scalar(&self, f: &mut impl FnMut(ExprId)) {
        match self {
            Value::Scalar(e) => f(*e),
            Value::Array(a) => a.elements.iter().for_each(|v| v.for_each_scalar(f)),
            Value::Record(r) => r.fields.iter().for_each(|(_, v)| v.for_each_scalar(f)),
            Value::Tuple(t) => t.iter().for_each(|v| v.for_each_scalar(f)),
            Value::Function(p) => p.bound.iter().for_each(|(_, v)| v.for_each_scalar(f)),
        }
    }
}

/// Where the part that `subscripts` select starts, and the sizes that are left.
pub fn offset<'a>(dims: &'a [usize], subscripts: &[usize]) -> Option<(usize, &'a [usize])> {
    if subscripts.len() > dims.len() {
        return None;
    }
    let mut at = 0;
    for (k, s) in subscripts.iter().enumerate() {
        if *s == 0 || *s > dims[k] {
            return None;
        }
        at = at * dims[k] + (s - 1);
    }
    let rest = &dims[subscripts.len()..];
    Some((at * rest.iter().product::<usize>(), rest))
}

/// The next subscripts in row-major order, counted from 1.
pub fn advance(subscripts: &mut [usize], sizes: &[usize]) {
    for k in (0..sizes.len()).rev() {
        subscripts[k] += 1;
        if subscripts[k] <= sizes[k] {
            return;
        }
        subscripts[k] = 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_major_selection() {
        let m = Value::array(vec![2, 3], (0..6).map(|i| Value::Scalar(ExprId(i))).collect());
        assert_eq!(m.select(&[2, 1]), Some(Value::Scalar(ExprId(3))));
        assert_eq!(m.select(&[2]).unwrap().dims(), [3]);
        assert_eq!(m.select(&[3]), None);
        assert_eq!(m.select(&[1, 1, 1]), None);
    }
}
