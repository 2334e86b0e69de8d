//! The messages between a run and the child process of an FMU.
//!
//! A message is its length as four bytes, lowest first, and its content. Each [`Order`] but the last has one answer, that
//! of [`Order::Run`] after any number of [`Answer::Progress`]; the child sends nothing by itself, and ends at the end of
//! the stream.

use std::io::{self, BufRead, Write};

use crate::base::wire::{Damaged, Reader, Wire, wire_enum, wire_struct};
use crate::ir::foreign::{Counters, ForeignOutcome, ForeignShape, ForeignTask, Stop};

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
    /// Its numbers.
    pub shape: ForeignShape,
    /// The token.
    pub token: String,
    /// The folder of resources.
    pub resources: String,
    /// The folder in which the FMU is unpacked: removed if mocc ends without doing so.
    pub folder: String,
    /// The values by their references.
    pub groups: Vec<Group>,
    /// The values that are inputs.
    pub inputs: Vec<usize>,
    /// The values that answers hold.
    pub watched: Vec<usize>,
    /// Value references of the derivatives and their states, if the FMU differentiates.
    pub states: Vec<(u32, u32)>,
}

/// What the child should do.
#[derive(Clone, PartialEq, Debug)]
pub enum Order {
    /// Load and instantiate.
    Load(Box<Load>),
    /// A whole run.
    Run(Box<ForeignTask>),
    /// Initialise for steps: start, stop, tolerance, values.
    Begin([f64; 3], Vec<(usize, f64)>),
    /// A step: instant, size, inputs.
    Step(f64, f64, Vec<(usize, f64)>),
    /// The last order: the process is no longer needed. It has no answer.
    Leave,
}

/// What came of it.
#[derive(Clone, PartialEq, Debug)]
pub enum Answer {
    /// The order is carried out.
    Done,
    /// The run has come to this instant, s; rows and events since the last message.
    Progress(f64, Counters, Vec<Item>),
    /// The run has ended.
    Ended(ForeignOutcome),
    /// The integration failed at this instant, s.
    Stopped(f64, Stop),
    /// Instant reached, s, end of the run, and the watched values there.
    Stepped(f64, bool, Vec<f64>),
    /// The library cannot be loaded, for this reason.
    NotLoaded(String),
    /// The library needs Python, which cannot be loaded, for this reason.
    NeedsPython(String),
    /// The FMU cannot be instantiated; its messages.
    NotInstantiated(Vec<String>),
    /// A call failed.
    Failed(Box<FailedCall>),
}

/// A call that returned no success.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct FailedCall {
    /// The instant that the run has come to, s.
    pub time: f64,
    /// The name of the function, with what it was called for.
    pub call: String,
    /// The name of the status.
    pub status: String,
    /// The messages of the FMU.
    pub messages: Vec<String>,
}

/// What a run tells its observer, with the instant, s.
#[derive(Clone, PartialEq, Debug)]
pub enum Item {
    /// The watched values.
    Row(f64, Vec<f64>),
    /// An event.
    Event(f64, String),
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
    shape,
    token,
    resources,
    folder,
    groups,
    inputs,
    watched,
    states
});
wire_struct!(FailedCall { time, call, status, messages });
wire_enum!(Item { Row(t, values) = 0, Event(t, what) = 1 });
wire_enum!(Order {
    Load(load) = 0,
    Run(task) = 1,
    Begin(span, values) = 2,
    Step(t, size, inputs) = 3,
    Leave = 4,
});
wire_enum!(Answer {
    Done = 0,
    Progress(t, counters, items) = 1,
    Ended(outcome) = 2,
    Stopped(t, stop) = 3,
    Stepped(reached, ends, values) = 4,
    NotLoaded(why) = 5,
    NeedsPython(why) = 6,
    NotInstantiated(messages) = 7,
    Failed(call) = 8,
});

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
    use crate::ir::foreign::ForeignSignal;
    use crate::numeric::time_series::{Interpolation, TimeSeries};

    #[test]
    fn messages_arrive_as_they_were_sent() {
        let (mut pipe, mut buffer) = (Vec::new(), Vec::new());
        let group = Group { reference: 7, passing: Passing::UInt16, first: 2, count: 3 };
        let load = Load { library: "a.so".into(), groups: vec![group], ..Load::default() };
        let times: std::sync::Arc<[f64]> = [0.0, 1.0, 2.0].into();
        let series = TimeSeries::new(times, vec![1.0, 4.0, 2.0], Interpolation::Spline);
        let signal =
            ForeignSignal { value: 3, series: series.into(), is_discrete: false, orders: 2 };
        let task = ForeignTask {
            span: [0.0, 2.0],
            tolerance: 1e-6,
            method: "auto".into(),
            most_steps: 100,
            max_step: Some(0.5),
            interval: 0.1,
            spacing: 0.1,
            instants: Some([0.5, 1.0].into()),
            values: vec![(1, 2.0)],
            signals: vec![signal],
            watched: vec![(7, true)],
        };
        let orders = [
            Order::Load(Box::new(load)),
            Order::Run(Box::new(task)),
            Order::Begin([0.0, 1.0, 1e-6], vec![(1, 2.0)]),
            Order::Step(0.1, 0.2, Vec::new()),
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
        let answers = [
            Answer::Done,
            Answer::Progress(
                0.5,
                [1; 9],
                vec![Item::Row(0.5, vec![1.0]), Item::Event(0.5, "e".into())],
            ),
            Answer::Ended(ForeignOutcome { end: 2.0, ..ForeignOutcome::default() }),
            Answer::Stopped(0.5, Stop::Chattering("e".into(), 1001, 1e-12)),
            Answer::Failed(Box::new(FailedCall { call: "f".into(), ..FailedCall::default() })),
        ];
        for answer in &answers {
            pipe.clear();
            send(&mut pipe, answer, &mut buffer).unwrap();
            assert_eq!(&receive::<Answer>(&mut pipe.as_slice(), &mut buffer).unwrap(), answer);
        }
    }
}
