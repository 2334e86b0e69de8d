//! Values of variables by their types: references and numbers in the arrays that the C functions take.

use std::ffi::{c_int, c_void};

use super::{Instance, Status, Trouble, checked};
use crate::fmu::import::description::{Group, Passing};

impl Instance {
    /// Gets the values of groups of one type, one after the other.
    pub fn get(
        &self,
        passing: Passing,
        groups: &[Group],
        out: &mut Vec<f64>,
    ) -> Result<(), Trouble> {
        let references: Vec<u32> = groups.iter().map(|g| g.reference).collect();
        let count: usize = groups.iter().map(|g| g.count).sum();
        macro_rules! fetch {
            ($name:literal, $ty:ty, $zero:expr, $convert:expr) => {{
                let mut values: Vec<$ty> = vec![$zero; count];
                call!(self, $name, references.as_ptr() => *const u32, references.len() => usize,
                    values.as_mut_ptr() => *mut $ty, count => usize)?;
                let convert: fn($ty) -> f64 = $convert;
                out.extend(values.into_iter().map(convert));
                Ok(())
            }};
        }
        macro_rules! fetch_second {
            ($name:literal, $ty:ty, $zero:expr, $convert:expr) => {{
                let mut values: Vec<$ty> = vec![$zero; count];
                call!(self, $name, references.as_ptr() => *const u32, references.len() => usize,
                    values.as_mut_ptr() => *mut $ty)?;
                let convert: fn($ty) -> f64 = $convert;
                out.extend(values.into_iter().map(convert));
                Ok(())
            }};
        }
        match (self.third, passing) {
            (false, Passing::Float64) => fetch_second!("fmi2GetReal", f64, 0.0, |x| x),
            (false, Passing::Boolean) => {
                fetch_second!("fmi2GetBoolean", c_int, 0, |x| f64::from(u8::from(x != 0)))
            }
            (false, _) => fetch_second!("fmi2GetInteger", c_int, 0, f64::from),
            (true, Passing::Float64) => fetch!("fmi3GetFloat64", f64, 0.0, |x| x),
            (true, Passing::Float32) => fetch!("fmi3GetFloat32", f32, 0.0, f64::from),
            (true, Passing::Int8) => fetch!("fmi3GetInt8", i8, 0, f64::from),
            (true, Passing::UInt8) => fetch!("fmi3GetUInt8", u8, 0, f64::from),
            (true, Passing::Int16) => fetch!("fmi3GetInt16", i16, 0, f64::from),
            (true, Passing::UInt16) => fetch!("fmi3GetUInt16", u16, 0, f64::from),
            (true, Passing::Int32) => fetch!("fmi3GetInt32", i32, 0, f64::from),
            (true, Passing::UInt32) => fetch!("fmi3GetUInt32", u32, 0, f64::from),
            (true, Passing::Int64) => fetch!("fmi3GetInt64", i64, 0, |x| x as f64),
            (true, Passing::UInt64) => fetch!("fmi3GetUInt64", u64, 0, |x| x as f64),
            // Bytes, since a foreign Boolean may be neither 0 nor 1.
            (true, Passing::Boolean) => {
                fetch!("fmi3GetBoolean", u8, 0, |x| f64::from(u8::from(x != 0)))
            }
        }
    }

    /// Sets the values of one group.
    pub fn set(&self, group: &Group, new: &[f64]) -> Result<(), Trouble> {
        let reference = group.reference;
        macro_rules! put {
            ($name:literal, $ty:ty) => {{
                let values: Vec<$ty> = new.iter().map(|x| *x as $ty).collect();
                call!(self, $name, &reference => *const u32, 1 => usize,
                    values.as_ptr() => *const $ty, values.len() => usize)
            }};
        }
        macro_rules! put_second {
            ($name:literal, $ty:ty) => {{
                let values: Vec<$ty> = new.iter().map(|x| *x as $ty).collect();
                call!(self, $name, &reference => *const u32, 1 => usize,
                    values.as_ptr() => *const $ty)
            }};
        }
        match (self.third, group.passing) {
            (false, Passing::Float64) => put_second!("fmi2SetReal", f64),
            (false, Passing::Boolean) => put_second!("fmi2SetBoolean", c_int),
            (false, _) => put_second!("fmi2SetInteger", c_int),
            (true, Passing::Float64) => put!("fmi3SetFloat64", f64),
            (true, Passing::Float32) => put!("fmi3SetFloat32", f32),
            (true, Passing::Int8) => put!("fmi3SetInt8", i8),
            (true, Passing::UInt8) => put!("fmi3SetUInt8", u8),
            (true, Passing::Int16) => put!("fmi3SetInt16", i16),
            (true, Passing::UInt16) => put!("fmi3SetUInt16", u16),
            (true, Passing::Int32) => put!("fmi3SetInt32", i32),
            (true, Passing::UInt32) => put!("fmi3SetUInt32", u32),
            (true, Passing::Int64) => put!("fmi3SetInt64", i64),
            (true, Passing::UInt64) => put!("fmi3SetUInt64", u64),
            (true, Passing::Boolean) => put!("fmi3SetBoolean", u8),
        }
    }
}
