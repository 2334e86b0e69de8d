//! External functions as bytes, for programs that leave the process.
//!
//! In: a function. Out: its bytes, and the same function again. One row for each type that implements
//! [`External`].

use std::cmp::Ordering;
use std::sync::Arc;

use super::External;
use super::array_access::ArrayAccess;
use super::printf::Form;
use super::split_u64::Operation;
use super::string_operator::{CompareStrings, Concatenate, FormatNumber};
use super::table::operator::{CurveValue, NextTimeEvent, SurfaceValue, TimeTableValue};
use super::xorshift1024::Stream;
use crate::base::name::name;
use crate::base::wire::{Damaged, Reader, Wire, wire_struct};

wire_struct!(CurveValue { curve, order });
wire_struct!(TimeTableValue { table, order });
wire_struct!(SurfaceValue { surface, orders });
wire_struct!(ArrayAccess { elements, is_integer });
wire_struct!(FormatNumber { form, is_integer });

impl Wire for Form {
    fn write(&self, out: &mut Vec<u8>) {
        (self.digits, self.width, self.left).write(out);
        self.format.map(str::to_owned).write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (digits, width, left) = Wire::read(from)?;
        // Interned, as every format of a model is.
        let format = Option::<String>::read(from)?.map(|text| name(&text).as_str());
        Ok(Form { digits, width, left, format })
    }
}

/// Appends a function; false if its type has no row here.
pub fn write(function: &dyn External, out: &mut Vec<u8>) -> bool {
    let any = function.as_any();
    macro_rules! row {
        ($code:literal, $ty:ty) => {
            if let Some(found) = any.downcast_ref::<$ty>() {
                out.push($code);
                found.write(out);
                return true;
            }
        };
    }
    row!(0, CurveValue);
    row!(1, TimeTableValue);
    row!(2, SurfaceValue);
    row!(3, ArrayAccess);
    row!(4, FormatNumber);
    row!(5, Operation);
    row!(6, Stream);
    if let Some(found) = any.downcast_ref::<NextTimeEvent>() {
        out.push(7);
        found.0.write(out);
        return true;
    }
    if any.is::<Concatenate>() {
        out.push(8);
        return true;
    }
    if let Some(found) = any.downcast_ref::<CompareStrings>() {
        out.push(9);
        let has = |order: Ordering| found.0.contains(&order);
        [has(Ordering::Less), has(Ordering::Equal), has(Ordering::Greater)].write(out);
        return true;
    }
    false
}

/// The function at the front.
pub fn read(from: &mut Reader<'_>) -> Result<Arc<dyn External>, Damaged> {
    Ok(match from.byte()? {
        0 => Arc::new(CurveValue::read(from)?),
        1 => Arc::new(TimeTableValue::read(from)?),
        2 => Arc::new(SurfaceValue::read(from)?),
        3 => Arc::new(ArrayAccess::read(from)?),
        4 => Arc::new(FormatNumber::read(from)?),
        5 => Arc::new(Operation::read(from)?),
        6 => Arc::new(Stream::read(from)?),
        7 => Arc::new(NextTimeEvent(Wire::read(from)?)),
        8 => Arc::new(Concatenate),
        9 => {
            let has: [bool; 3] = Wire::read(from)?;
            let orders = [Ordering::Less, Ordering::Equal, Ordering::Greater];
            let kept = orders.into_iter().zip(has).filter(|(_, has)| *has).map(|(order, _)| order);
            Arc::new(CompareStrings(kept.collect()))
        }
        _ => return Err(Damaged),
    })
}
