//! Access to a constant array with a subscript that varies during simulation.

use super::{External, Signature, same_if_equal};

/// The element with a subscript counted from 1; the first or last one for subscripts out of range.
#[derive(Clone, PartialEq, Debug)]
pub struct ArrayAccess {
    /// The array.
    pub elements: Vec<f64>,
    /// True if its elements are Integers.
    pub is_integer: bool,
}

impl External for ArrayAccess {
    fn signature(&self) -> Signature {
        let is_integer = self.is_integer;
        Signature { name: "element", arity: 1, is_integer, is_differentiable: false }
    }

    fn eval(&self, args: &[f64]) -> f64 {
        let last = self.elements.len().saturating_sub(1);
        let at = (args[0].max(1.0) as usize - 1).min(last);
        self.elements.get(at).copied().unwrap_or(f64::NAN)
    }

    fn elements(&self) -> Option<(&[f64], bool)> {
        Some((&self.elements, self.is_integer))
    }

    same_if_equal!();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_out_of_range_give_the_ends() {
        let array = ArrayAccess { elements: vec![3.0, 5.0, 7.0], is_integer: false };
        let at = [0.0, 1.0, 2.0, 3.0, 9.0].map(|k| array.eval(&[k]));
        assert_eq!(at, [3.0, 3.0, 5.0, 7.0, 7.0]);
    }
}
