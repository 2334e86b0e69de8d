//! Frames of local names: iterators, and the variables of a function that is run.

use super::Evaluator;
use super::value::Value;
use crate::base::name::Name;

/// The kind of code that a frame belongs to.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) enum FrameKind {
    /// A class: components are visible.
    #[default]
    Class,
    /// The algorithm of a function: components are not visible.
    Function,
}

/// One frame: locals below its base belong to callers and are hidden.
#[derive(Clone, Copy, Default, Debug)]
struct Frame {
    kind: FrameKind,
    base: usize,
}

/// The locals of all open frames; those of the current one are visible.
#[derive(Clone, Default, Debug)]
pub struct Frames {
    /// Innermost last.
    locals: Vec<(Name, Value)>,
    current: Frame,
}

impl Frames {
    /// Whether the current frame is that of a function.
    pub(crate) fn in_function(&self) -> bool {
        self.current.kind == FrameKind::Function
    }

    /// The visible locals, innermost last.
    pub(crate) fn visible(&self) -> &[(Name, Value)] {
        &self.locals[self.current.base..]
    }

    /// As [`Frames::visible`], to assign to.
    pub(crate) fn visible_mut(&mut self) -> &mut [(Name, Value)] {
        &mut self.locals[self.current.base..]
    }

    /// The value of the innermost visible local of a name.
    pub(crate) fn find(&self, wanted: Name) -> Option<&Value> {
        self.visible().iter().rev().find(|(n, _)| *n == wanted).map(|(_, v)| v)
    }

    /// The position of the innermost visible local of a name among the visible ones.
    pub(crate) fn position(&self, wanted: Name) -> Option<usize> {
        self.visible().iter().rposition(|(n, _)| *n == wanted)
    }

    /// The names of all locals, hidden ones too.
    pub(crate) fn names(&self) -> impl Iterator<Item = Name> {
        self.locals.iter().map(|(n, _)| *n)
    }

    /// Adds a local to the current frame.
    pub(crate) fn declare(&mut self, name: Name, value: Value) {
        self.locals.push((name, value));
    }

    /// Replaces the visible locals.
    pub(crate) fn restore(&mut self, visible: &[(Name, Value)]) {
        self.locals.truncate(self.current.base);
        self.locals.extend_from_slice(visible);
    }
}

impl Evaluator<'_> {
    /// Runs something in a frame of its own, in which the locals of callers are hidden.
    pub(crate) fn with_frame<T>(&mut self, kind: FrameKind, act: impl FnOnce(&mut Self) -> T) -> T {
        let frames = &mut self.frames;
        let caller = frames.current;
        frames.current = Frame { kind, base: frames.locals.len() };
        let result = act(self);
        let frames = &mut self.frames;
        frames.locals.truncate(frames.current.base);
        frames.current = caller;
        result
    }

    /// Runs something with one more local, such as an iterator.
    pub(crate) fn with_local<T>(
        &mut self,
        name: Name,
        value: Value,
        act: impl FnOnce(&mut Self) -> T,
    ) -> T {
        self.frames.declare(name, value);
        let result = act(self);
        self.frames.locals.pop();
        result
    }

    /// Runs something with the locals of another place, such as the iterators around a connection.
    pub(crate) fn with_frames<T>(
        &mut self,
        frames: &Frames,
        act: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let around = std::mem::replace(&mut self.frames, frames.clone());
        let result = act(self);
        self.frames = around;
        result
    }
}
