//! Values as bytes, for programs that leave the process.
//!
//! In: values whose types implement [`Wire`]. Out: bytes, and the same values again. Whole numbers are
//! written with seven bits a byte, lowest first, Reals by their eight bytes. Reading damaged bytes is an
//! error, never a panic, and allocates no more than the bytes can hold.

/// The bytes do not hold the value that was asked for.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the data are damaged")]
pub struct Damaged;

/// Bytes that are read from the front.
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Reads these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Reader { rest: bytes }
    }

    /// The next byte.
    pub fn byte(&mut self) -> Result<u8, Damaged> {
        let (first, rest) = self.rest.split_first().ok_or(Damaged)?;
        self.rest = rest;
        Ok(*first)
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Damaged> {
        if count > self.rest.len() {
            return Err(Damaged);
        }
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        Ok(taken)
    }

    /// True if nothing remains.
    pub fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }
}

/// A value that can be written as bytes and read back.
pub trait Wire: Sized {
    /// Appends the value.
    fn write(&self, out: &mut Vec<u8>);
    /// The value at the front.
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged>;
}

impl Wire for u64 {
    fn write(&self, out: &mut Vec<u8>) {
        let mut rest = *self;
        while rest >= 0x80 {
            out.push(rest as u8 | 0x80);
            rest >>= 7;
        }
        out.push(rest as u8);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = from.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(Damaged)
    }
}

macro_rules! wire_whole {
    ($($ty:ty),*) => {
        $(impl Wire for $ty {
            fn write(&self, out: &mut Vec<u8>) {
                (*self as u64).write(out);
            }
            fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
                <$ty>::try_from(u64::read(from)?).map_err(|_| Damaged)
            }
        })*
    };
}
wire_whole!(u8, u16, u32, usize);

impl Wire for i64 {
    fn write(&self, out: &mut Vec<u8>) {
        self.cast_unsigned().write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(u64::read(from)?.cast_signed())
    }
}

impl Wire for bool {
    fn write(&self, out: &mut Vec<u8>) {
        out.push(u8::from(*self));
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        match from.byte()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(Damaged),
        }
    }
}

impl Wire for f64 {
    fn write(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let bytes = from.take(8)?.try_into().map_err(|_| Damaged)?;
        Ok(f64::from_le_bytes(bytes))
    }
}

impl Wire for String {
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        out.extend_from_slice(self.as_bytes());
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let length = usize::read(from)?;
        String::from_utf8(from.take(length)?.to_vec()).map_err(|_| Damaged)
    }
}

impl<T: Wire> Wire for Vec<T> {
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        self.iter().for_each(|item| item.write(out));
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let length = usize::read(from)?;
        (0..length).map(|_| T::read(from)).collect()
    }
}

impl<T: Wire> Wire for std::collections::VecDeque<T> {
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        self.iter().for_each(|item| item.write(out));
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let length = usize::read(from)?;
        (0..length).map(|_| T::read(from)).collect()
    }
}

impl<T: Wire> Wire for Option<T> {
    fn write(&self, out: &mut Vec<u8>) {
        self.is_some().write(out);
        if let Some(value) = self {
            value.write(out);
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(if bool::read(from)? { Some(T::read(from)?) } else { None })
    }
}

impl<T: Wire> Wire for Box<T> {
    fn write(&self, out: &mut Vec<u8>) {
        T::write(self, out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(Box::new(T::read(from)?))
    }
}

impl<T: Wire> Wire for std::sync::Arc<T> {
    fn write(&self, out: &mut Vec<u8>) {
        T::write(self, out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(std::sync::Arc::new(T::read(from)?))
    }
}

impl<T: Wire> Wire for std::sync::Arc<[T]> {
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        self.iter().for_each(|item| item.write(out));
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(Vec::<T>::read(from)?.into())
    }
}

impl<T: Wire, const N: usize> Wire for [T; N] {
    fn write(&self, out: &mut Vec<u8>) {
        self.iter().for_each(|item| item.write(out));
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let items: Vec<T> = (0..N).map(|_| T::read(from)).collect::<Result<_, _>>()?;
        items.try_into().map_err(|_| Damaged)
    }
}

impl<A: Wire, B: Wire> Wire for (A, B) {
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
        self.1.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok((A::read(from)?, B::read(from)?))
    }
}

impl<A: Wire, B: Wire, C: Wire> Wire for (A, B, C) {
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
        self.1.write(out);
        self.2.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok((A::read(from)?, B::read(from)?, C::read(from)?))
    }
}

/// Implements [`Wire`] for a structure: its fields in this order.
#[macro_export]
macro_rules! wire_struct {
    ($ty:ident { $($field:ident),* $(,)? }) => {
        impl $crate::base::wire::Wire for $ty {
            fn write(&self, out: &mut Vec<u8>) {
                $($crate::base::wire::Wire::write(&self.$field, out);)*
            }
            fn read(
                from: &mut $crate::base::wire::Reader<'_>,
            ) -> Result<Self, $crate::base::wire::Damaged> {
                Ok($ty { $($field: $crate::base::wire::Wire::read(from)?),* })
            }
        }
    };
}
pub use wire_struct;

/// Implements [`Wire`] for an enumeration: a byte for the variant, then its fields.
#[macro_export]
macro_rules! wire_enum {
    ($ty:ident { $($variant:ident $(($($field:ident),+))? = $code:literal),+ $(,)? }) => {
        impl $crate::base::wire::Wire for $ty {
            fn write(&self, out: &mut Vec<u8>) {
                match self {
                    $($ty::$variant $(($($field),+))? => {
                        out.push($code);
                        $($($crate::base::wire::Wire::write($field, out);)+)?
                    })+
                }
            }
            fn read(
                from: &mut $crate::base::wire::Reader<'_>,
            ) -> Result<Self, $crate::base::wire::Damaged> {
                match from.byte()? {
                    $($code => {
                        $($(let $field = $crate::base::wire::Wire::read(from)?;)+)?
                        Ok($ty::$variant $(($($field),+))?)
                    })+
                    _ => Err($crate::base::wire::Damaged),
                }
            }
        }
    };
}
pub use wire_enum;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back() {
        let value = (vec![0_u64, 127, 128, u64::MAX], Some(-1_i64), "säule".to_owned());
        let mut bytes = Vec::new();
        value.write(&mut bytes);
        let mut reader = Reader::new(&bytes);
        let back: (Vec<u64>, Option<i64>, String) = Wire::read(&mut reader).unwrap();
        assert_eq!(back, value);
        assert!(reader.is_at_end());
    }

    /// A length beyond the end must not allocate.
    #[test]
    fn damaged_bytes_are_an_error() {
        let mut bytes = Vec::new();
        u64::MAX.write(&mut bytes);
        assert_eq!(Vec::<u64>::read(&mut Reader::new(&bytes)), Err(Damaged));
        assert_eq!(String::read(&mut Reader::new(&bytes)), Err(Damaged));
        assert_eq!(bool::read(&mut Reader::new(&[2])), Err(Damaged));
    }
}
