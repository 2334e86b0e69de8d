//! The child process of an FMU: carries out the orders that it reads from its standard input, which is a socket.
//!
//! Its answers go the same way. If mocc ends without an order to do so, even while the FMU does not return, the
//! child removes the folder of the FMU and ends. A call that takes long is named in a file in that folder, for the
//! message about one that does not return.

use std::io::{self, BufReader};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Barrier};
use std::time::Duration;

use super::description::{Group, Passing};
use super::library::current_call::current_call;
use super::library::process::end_at_once;
use super::library::{Instance, Trouble, keep_loaded, messages};
use super::message::{Answer, Load, Order, Point, receive, send};

/// Time between two looks after the parent process and the call that runs.
const LOOK: Duration = Duration::from_millis(100);
/// Time in which the parent process has gone if the stream ends without an order.
const FAREWELL: Duration = Duration::from_secs(1);
/// Displacement of a state for a difference quotient, relative to its size.
const DISPLACEMENT: f64 = 1.5e-8;

/// Serves until the end of the stream. Errors: the standard input is not a socket.
pub fn serve() -> io::Result<()> {
    let mut stream = BufReader::new(UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?));
    let mut buffer = Vec::new();
    let mut host: Option<Host> = None;
    while let Ok(order) = receive::<Order>(&mut stream, &mut buffer) {
        if order == Order::Leave {
            return Ok(());
        }
        let answer = match (order, host.as_mut()) {
            (Order::Load(load), _) => {
                if host.is_none() {
                    watch(PathBuf::from(&load.folder));
                    keep_loaded(&load);
                }
                // The instance of the last run goes first: an FMU may allow only one.
                if let Some(last) = host.take() {
                    last.instance.end();
                }
                match Host::new(*load) {
                    Ok(made) => {
                        host = Some(made);
                        Answer::Numbers(Vec::new())
                    }
                    Err(trouble) => answer_of(trouble),
                }
            }
            (Order::End, Some(host)) => {
                host.instance.end();
                Answer::Numbers(Vec::new())
            }
            (order, Some(host)) => host.carry_out(order).unwrap_or_else(answer_of),
            (_, None) => answer_of(Trouble::NotInstantiated),
        };
        if send(stream.get_mut(), &answer, &mut buffer).is_err() {
            break;
        }
    }
    // The thread that looks after the parent removes the folder when it has gone.
    std::thread::sleep(FAREWELL);
    Ok(())
}

/// The file in the folder of an FMU in which a child names the call that takes long.
pub fn call_file(folder: &Path, process: u32) -> PathBuf {
    folder.join(format!("call-{process}"))
}

fn answer_of(trouble: Trouble) -> Answer {
    match trouble {
        Trouble::NotLoaded(why) => Answer::NotLoaded(why),
        Trouble::NeedsPython(why) => Answer::NeedsPython(why),
        Trouble::NotInstantiated => Answer::NotInstantiated(messages()),
        Trouble::Failed { call, status } => {
            Answer::Failed(call.to_owned(), status.to_owned(), messages(), status == "discard")
        }
    }
}

/// Ends this process when its parent has gone, whatever the FMU does, and removes the folder; until then, names calls
/// that take long.
fn watch(folder: PathBuf) {
    let parent = std::os::unix::process::parent_id();
    let file = call_file(&folder, std::process::id());
    let begun = Arc::new(Barrier::new(2));
    let has_begun = Arc::clone(&begun);
    let look = move || {
        has_begun.wait();
        let (mut last, mut named) = (0, 0);
        loop {
            std::thread::sleep(LOOK);
            if std::os::unix::process::parent_id() != parent {
                let _ = std::fs::remove_dir_all(&folder);
                end_at_once();
            }
            let (number, name) = current_call();
            if number == last && number != named && !name.is_empty() {
                // Without the file the message names the order alone.
                let _ = std::fs::write(&file, name);
                named = number;
            } else if number != last && named != 0 {
                let _ = std::fs::remove_file(&file);
                named = 0;
            }
            last = number;
        }
    };
    // Without the thread only an FMU that hangs outlives its parent.
    if std::thread::Builder::new().name("parent".to_owned()).spawn(look).is_ok() {
        // A thread that begins while a library is loaded waits for the loader, which may never return.
        begun.wait();
    }
}

/// An instance with what orders refer to.
struct Host {
    instance: Instance,
    load: Load,
    /// The groups of the watched values by type, and for each watched value its place among those that are fetched.
    fetched: Vec<(Passing, Vec<Group>)>,
    places: Vec<usize>,
    /// Memory for those values.
    all: Vec<f64>,
    /// Directional derivatives failed: take differences.
    no_derivatives: bool,
    nominals: Vec<f64>,
}

impl Host {
    fn new(load: Load) -> Result<Host, Trouble> {
        let instance = Instance::new(&load)?;
        let of = |value: usize| {
            let next = load.groups.partition_point(|g| g.first <= value);
            load.groups.get(next.wrapping_sub(1)).copied()
        };
        let mut wanted: Vec<Group> = load.watched.iter().filter_map(|v| of(*v)).collect();
        wanted.sort_by_key(|g| (g.passing as u8, g.first));
        wanted.dedup();
        let mut fetched: Vec<(Passing, Vec<Group>)> = Vec::new();
        let mut starts = Vec::new();
        let mut total = 0;
        for group in wanted {
            match fetched.last_mut().filter(|(passing, _)| *passing == group.passing) {
                Some((_, list)) => list.push(group),
                None => fetched.push((group.passing, vec![group])),
            }
            starts.push((group.first, total));
            total += group.count;
        }
        starts.sort_unstable();
        let place = |value: &usize| {
            let next = starts.partition_point(|(first, _)| first <= value);
            starts.get(next.wrapping_sub(1)).map_or(0, |(first, at)| at + value - first)
        };
        let places = load.watched.iter().map(place).collect();
        let nominals = vec![1.0; load.state_count];
        let all = Vec::with_capacity(total);
        Ok(Host { instance, load, fetched, places, all, no_derivatives: false, nominals })
    }

    fn carry_out(&mut self, order: Order) -> Result<Answer, Trouble> {
        let stepping = self.load.stepping;
        Ok(match order {
            Order::Initialise(span, values) => {
                self.set(&values)?;
                self.instance.enter_initialization(span)?;
                self.instance.exit_initialization()?;
                match stepping {
                    true => Answer::Event(Vec::new(), Vec::new(), Vec::new(), None, false),
                    false => self.after_event()?,
                }
            }
            Order::Evaluate(point) => {
                self.place(&point)?;
                let n = self.load.state_count;
                let mut numbers = vec![0.0; n + self.load.indicators];
                self.instance.derivatives(&mut numbers[..n])?;
                self.instance.indicators(&mut numbers[n..])?;
                Answer::Numbers(numbers)
            }
            Order::Jacobian(point) => Answer::Numbers(self.jacobian(&point)?),
            Order::Values(point) => {
                if let Some(point) = point {
                    self.place(&point)?;
                }
                Answer::Numbers(self.watched()?)
            }
            Order::Complete(point) => {
                self.place(&point)?;
                let (event, ends) = self.instance.complete_step()?;
                Answer::Step(point.t, event, ends, Vec::new())
            }
            Order::Event(point) => {
                self.instance.set_time(point.t)?;
                self.instance.set_states(&point.states)?;
                self.instance.enter_event_mode()?;
                self.set(&point.inputs)?;
                self.after_event()?
            }
            Order::Step(t, size, inputs) => {
                self.set(&inputs)?;
                let (reached, ends) = self.instance.step(t, size)?;
                Answer::Step(reached, false, ends, self.watched()?)
            }
            Order::Load(_) | Order::End | Order::Leave => Answer::Numbers(Vec::new()),
        })
    }

    /// The watched values.
    fn watched(&mut self) -> Result<Vec<f64>, Trouble> {
        self.all.clear();
        for (passing, groups) in &self.fetched {
            self.instance.get(*passing, groups, &mut self.all)?;
        }
        Ok(self.places.iter().map(|at| self.all[*at]).collect())
    }

    /// Sets time, states, and the inputs that may change between events.
    fn place(&self, point: &Point) -> Result<(), Trouble> {
        self.instance.set_time(point.t)?;
        self.instance.set_states(&point.states)?;
        let groups = &self.load.groups;
        let is_real = |(value, _): &&(usize, f64)| {
            let next = groups.partition_point(|g| g.first <= *value);
            let group = groups.get(next.wrapping_sub(1));
            group.is_some_and(|g| matches!(g.passing, Passing::Float64 | Passing::Float32))
        };
        let inputs: Vec<(usize, f64)> = point.inputs.iter().filter(is_real).copied().collect();
        self.set(&inputs)
    }

    /// From event mode to continuous-time mode.
    fn after_event(&mut self) -> Result<Answer, Trouble> {
        let updated = self.instance.update()?;
        let n = self.load.state_count;
        let (mut states, mut nominals) = (vec![0.0; n], vec![1.0; n]);
        let mut indicators = vec![0.0; self.load.indicators];
        if !updated.ends {
            self.instance.enter_continuous_mode()?;
        }
        self.instance.states(&mut states)?;
        self.instance.nominals(&mut nominals)?;
        if !updated.ends {
            self.instance.indicators(&mut indicators)?;
        }
        self.nominals.clone_from(&nominals);
        Ok(Answer::Event(states, nominals, indicators, updated.next, updated.ends))
    }

    /// Sets values; elements of an array with the others of their group.
    fn set(&self, values: &[(usize, f64)]) -> Result<(), Trouble> {
        let groups = &self.load.groups;
        let mut rest = values;
        while let Some((value, _)) = rest.first() {
            let next = groups.partition_point(|g| g.first <= *value);
            let Some(group) = groups.get(next.wrapping_sub(1)) else { break };
            let own = |(v, _): &(usize, f64)| (group.first..group.first + group.count).contains(v);
            let count = rest.iter().take_while(|pair| own(pair)).count().max(1);
            let mut new = Vec::with_capacity(group.count);
            if count < group.count {
                self.instance.get(group.passing, std::slice::from_ref(group), &mut new)?;
            }
            new.resize(group.count, 0.0);
            for (v, x) in &rest[..count] {
                new[v - group.first] = *x;
            }
            self.instance.set(group, &new)?;
            rest = &rest[count..];
        }
        Ok(())
    }

    fn jacobian(&mut self, point: &Point) -> Result<Vec<f64>, Trouble> {
        let n = self.load.state_count;
        let mut out = vec![0.0; n * n];
        self.place(point)?;
        if !self.load.states.is_empty() && !self.no_derivatives {
            let unknowns: Vec<u32> = self.load.states.iter().map(|s| s.0).collect();
            let columns = out.chunks_mut(n.max(1)).zip(&self.load.states);
            let mut ok = true;
            for (column, (_, state)) in columns {
                ok &= self.instance.directional(&unknowns, *state, column).is_ok();
                if !ok {
                    break;
                }
            }
            if ok {
                return Ok(out);
            }
            messages();
            self.no_derivatives = true;
        }
        let mut base = vec![0.0; n];
        let mut moved = vec![0.0; n];
        let mut x = point.states.clone();
        self.instance.derivatives(&mut base)?;
        for j in 0..n {
            let size = x[j].abs().max(self.nominals[j].abs());
            let before = x[j];
            x[j] += DISPLACEMENT * size;
            let step = x[j] - before;
            self.instance.set_states(&x)?;
            self.instance.derivatives(&mut moved)?;
            x[j] = before;
            let column = &mut out[j * n..(j + 1) * n];
            for ((entry, moved), base) in column.iter_mut().zip(&moved).zip(&base) {
                *entry = (moved - base) / step;
            }
        }
        self.instance.set_states(&x)?;
        Ok(out)
    }
}
