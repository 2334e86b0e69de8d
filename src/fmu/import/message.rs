//! The messages between a run and the child process of an FMU.
//!
//! A message is its length as four bytes, lowest first, and its content. Each [`Order`] but the
//! last has one [`Answer`]; the child sends nothing by itself, and ends at the end of the stream.

use std::io::{self, BufRead, Write};

use crate::base::wire::{Damaged, Reader, Wire, wire_struct};

use super::description::{Group, Passing};

/// Largest message, bytes.
const LARGEST: usize = 1 << 30;

/// What to load and instantiate.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Load {
    /// The shared library.
    pub library: String,
    /// FMI 3 rather than 2.
    pub third: bool,
    /// Co-Simulation rather than Model Exchange.
    pub stepping: bool,
    /// The token.
    pub token: String,
    /// The folder of resources.
    pub resources: String,
    /// The folder in which the FMU is unpacked: removed if mocc ends without doing so.
    pub folder: String,
    /// The values by their references.
    pub groups: Vec<Group>,
    /// The values that `Values` asks for.
    pub watched: Vec<usize>,
    /// Value references of the derivatives and their states, if the FMU differentiates.
    pub states: Vec<(u32, u32)>,
    /// Number of continuous states.
    pub state_count: usize,
    /// Number of event indicators.
    pub indicators: usize,
}

/// An instant, states and inputs.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Point {
    /// The instant, s.
    pub t: f64,
    /// The continuous states.
    pub states: Vec<f64>,
    /// Numbers of values, and the values.
    pub inputs: Vec<(usize, f64)>,
}

/// What the child should do.
#[derive(Clone, PartialEq, Debug)]
pub enum Order {
    /// Load and instantiate.
    Load(Box<Load>),
    /// Initialise: start, stop, tolerance, values.
    Initialise([f64; 3], Vec<(usize, f64)>),
    /// Derivatives, then indicators.
    Evaluate(Point),
    /// Derivatives by states, column by column.
    Jacobian(Point),
    /// The watched values, at a point or as they are.
    Values(Option<Point>),
    /// The integrator has completed a step.
    Complete(Point),
    /// An event.
    Event(Point),
    /// A step: instant, size, inputs.
    Step(f64, f64, Vec<(usize, f64)>),
    /// The end of the run.
    End,
    /// The last order: the process is no longer needed. It has no answer.
    Leave,
}

/// What came of it.
#[derive(Clone, PartialEq, Debug)]
pub enum Answer {
    /// Numbers; what they mean depends on the order.
    Numbers(Vec<f64>),
    /// States, nominals, indicators, next event, end of the run.
    Event(Vec<f64>, Vec<f64>, Vec<f64>, Option<f64>, bool),
    /// Instant reached, an event is asked for, end of the run; the watched values there, if the FMU has integrated.
    Step(f64, bool, bool, Vec<f64>),
    /// The library cannot be loaded, for this reason.
    NotLoaded(String),
    /// The library needs Python, which cannot be loaded, for this reason.
    NeedsPython(String),
    /// The FMU cannot be instantiated; its messages.
    NotInstantiated(Vec<String>),
    /// A call failed: its name, the status, messages; the failure is avoidable.
    Failed(String, String, Vec<String>, bool),
}

impl Wire for Passing {
    fn write(&self, out: &mut Vec<u8>) {
        out.push(*self as u8);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Passing::ALL.get(usize::from(from.byte()?)).copied().ok_or(Damaged)
    }
}

wire_struct!(Group { reference, passing, first, count });
wire_struct!(Load {
    library,
    third,
    stepping,
    token,
    resources,
    folder,
    groups,
    watched,
    states,
    state_count,
    indicators,
});
wire_struct!(Point { t, states, inputs });

impl Wire for Order {
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Order::Load(load) => {
                out.push(0);
                load.write(out);
            }
            Order::Initialise(span, values) => {
                out.push(1);
                span.write(out);
                values.write(out);
            }
            Order::Evaluate(point) => {
                out.push(2);
                point.write(out);
            }
            Order::Jacobian(point) => {
                out.push(3);
                point.write(out);
            }
            Order::Values(point) => {
                out.push(4);
                point.write(out);
            }
            Order::Complete(point) => {
                out.push(5);
                point.write(out);
            }
            Order::Event(point) => {
                out.push(6);
                point.write(out);
            }
            Order::Step(t, size, inputs) => {
                out.push(7);
                t.write(out);
                size.write(out);
                inputs.write(out);
            }
            Order::End => out.push(8),
            Order::Leave => out.push(9),
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(match from.byte()? {
            0 => Order::Load(Wire::read(from)?),
            1 => Order::Initialise(Wire::read(from)?, Wire::read(from)?),
            2 => Order::Evaluate(Wire::read(from)?),
            3 => Order::Jacobian(Wire::read(from)?),
            4 => Order::Values(Wire::read(from)?),
            5 => Order::Complete(Wire::read(from)?),
            6 => Order::Event(Wire::read(from)?),
            7 => Order::Step(Wire::read(from)?, Wire::read(from)?, Wire::read(from)?),
            8 => Order::End,
            9 => Order::Leave,
            _ => return Err(Damaged),
        })
    }
}

impl Wire for Answer {
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Answer::Numbers(numbers) => {
                out.push(0);
                numbers.write(out);
            }
            Answer::Event(states, nominals, indicators, next, ends) => {
                out.push(1);
                states.write(out);
                nominals.write(out);
                indicators.write(out);
                next.write(out);
                ends.write(out);
            }
            Answer::Step(reached, event, ends, values) => {
                out.push(2);
                reached.write(out);
                event.write(out);
                ends.write(out);
                values.write(out);
            }
            Answer::NotLoaded(why) => {
                out.push(3);
                why.write(out);
            }
            Answer::NeedsPython(why) => {
                out.push(6);
                why.write(out);
            }
            Answer::NotInstantiated(messages) => {
                out.push(4);
                messages.write(out);
            }
            Answer::Failed(call, status, messages, is_avoidable) => {
                out.push(5);
                call.write(out);
                status.write(out);
                messages.write(out);
                is_avoidable.write(out);
            }
        }
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(match from.byte()? {
            0 => Answer::Numbers(Wire::read(from)?),
            1 => Answer::Event(
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
            ),
            2 => Answer::Step(
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
            ),
            3 => Answer::NotLoaded(Wire::read(from)?),
            4 => Answer::NotInstantiated(Wire::read(from)?),
            5 => Answer::Failed(
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
                Wire::read(from)?,
            ),
            6 => Answer::NeedsPython(Wire::read(from)?),
            _ => return Err(Damaged),
        })
    }
}

/// Sends a message. `buffer` is memory to be used again.
pub fn send(to: &mut impl Write, what: &impl Wire, buffer: &mut Vec<u8>) -> io::Result<()> {
    buffer.clear();
    buffer.extend_from_slice(&[0; 4]);
    what.write(buffer);
    let length = (buffer.len() - 4) as u32;
    buffer[..4].copy_from_slice(&length.to_le_bytes());
    to.write_all(buffer)
}

/// Receives a message. `from` is buffered: a message then costs one call of the system.
pub fn receive<T: Wire>(from: &mut impl BufRead, buffer: &mut Vec<u8>) -> io::Result<T> {
    let mut length = [0; 4];
    from.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length) as usize;
    let damaged = || io::Error::new(io::ErrorKind::InvalidData, "a message is damaged");
    if length > LARGEST {
        return Err(damaged());
    }
    buffer.resize(length, 0);
    from.read_exact(buffer)?;
    T::read(&mut Reader::new(buffer)).map_err(|_| damaged())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_arrive_as_they_were_sent() {
        let (mut pipe, mut buffer) = (Vec::new(), Vec::new());
        let point = Point { t: 0.5, states: vec![1.0, -2.0], inputs: vec![(3, 4.0)] };
        let group = Group { reference: 7, passing: Passing::UInt16, first: 2, count: 3 };
        let load = Load { library: "a.so".into(), groups: vec![group], ..Load::default() };
        let orders = [
            Order::Load(Box::new(load)),
            Order::Initialise([0.0, 1.0, 1e-6], vec![(1, 2.0)]),
            Order::Values(None),
            Order::Event(point),
            Order::Step(0.1, 0.2, Vec::new()),
            Order::End,
            Order::Leave,
        ];
        for order in &orders {
            send(&mut pipe, order, &mut buffer).unwrap();
        }
        let mut stream = pipe.as_slice();
        for order in &orders {
            assert_eq!(&receive::<Order>(&mut stream, &mut buffer).unwrap(), order);
        }
        assert!(receive::<Order>(&mut stream, &mut buffer).is_err());
        let answer = Answer::Failed("f".into(), "error".into(), vec!["m".into()], true);
        pipe.clear();
        send(&mut pipe, &answer, &mut buffer).unwrap();
        assert_eq!(receive::<Answer>(&mut pipe.as_slice(), &mut buffer).unwrap(), answer);
    }
}
