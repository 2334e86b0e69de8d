//! Typed indices and the vectors they index: the number of an equation cannot index variables.

use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

/// Hash map keyed by ids or interned names. Never iterated where the order could affect a result.
pub type FastMap<K, V> = std::collections::HashMap<K, V, rustc_hash::FxBuildHasher>;
/// Hash set of ids or interned names. Never iterated where the order could affect a result.
pub type FastSet<K> = std::collections::HashSet<K, rustc_hash::FxBuildHasher>;

/// A typed index: a `u32` that can only index one kind of object.
pub trait Id: Copy + Eq + Ord + std::hash::Hash + std::fmt::Debug {
    /// Wraps a position. Panics beyond `u32::MAX`, which is a bug in mocc, not an error in a model.
    fn from_usize(i: usize) -> Self;
    /// The position as an array index.
    fn idx(self) -> usize;
}

/// Declares a typed index.
#[macro_export]
macro_rules! define_id {
    ($(#[$meta:meta])* $vis:vis struct $name:ident) => {
        $(#[$meta])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        $vis struct $name(pub u32);
        impl $crate::base::index::Id for $name {
            #[inline]
            fn from_usize(i: usize) -> Self {
                $name(u32::try_from(i).expect("fewer than 2^32 objects of one kind"))
            }
            #[inline]
            fn idx(self) -> usize {
                self.0 as usize
            }
        }
    };
}

/// A vector indexed by a typed id.
#[derive(Clone, PartialEq, Eq)]
pub struct IndexVec<I, T> {
    raw: Vec<T>,
    index: PhantomData<fn(I) -> I>,
}

impl<I: Id, T> IndexVec<I, T> {
    /// An empty vector.
    pub fn new() -> Self {
        IndexVec { raw: Vec::new(), index: PhantomData }
    }
    /// `n` copies of `value`.
    pub fn filled(value: T, n: usize) -> Self
    where
        T: Clone,
    {
        IndexVec { raw: vec![value; n], index: PhantomData }
    }
    /// Appends and returns the id of the new element.
    pub fn push(&mut self, value: T) -> I {
        let id = I::from_usize(self.raw.len());
        self.raw.push(value);
        id
    }
    /// Removes the last element.
    pub fn pop(&mut self) {
        self.raw.pop();
    }
    /// The id that the next `push` returns.
    pub fn next_id(&self) -> I {
        I::from_usize(self.raw.len())
    }
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.raw.len()
    }
    /// True if there are no elements.
    pub fn is_empty(&self) -> bool {
        self.raw.is_empty()
    }
    /// Elements in order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.raw.iter()
    }
    /// Elements in order, mutable.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.raw.iter_mut()
    }
    /// Ids in order.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = I> + ExactSizeIterator + use<I, T> {
        (0..self.raw.len()).map(I::from_usize)
    }
    /// Ids and elements in order.
    pub fn enumerate(&self) -> impl DoubleEndedIterator<Item = (I, &T)> + ExactSizeIterator {
        self.raw.iter().enumerate().map(|(i, v)| (I::from_usize(i), v))
    }
    /// The element, if the id is in range.
    pub fn get(&self, i: I) -> Option<&T> {
        self.raw.get(i.idx())
    }
    /// The elements as a slice.
    pub fn as_slice(&self) -> &[T] {
        &self.raw
    }
    /// Makes room for exactly so many more elements.
    pub fn reserve_exact(&mut self, additional: usize) {
        self.raw.reserve_exact(additional);
    }
    /// Frees the array, but not what its elements own: of millions of small objects, that would take time.
    pub fn leak_elements(self) {
        self.raw.into_iter().for_each(std::mem::forget);
    }
    /// Grows to `n` elements with copies of `value`.
    pub fn resize(&mut self, n: usize, value: T)
    where
        T: Clone,
    {
        self.raw.resize(n, value);
    }
}

/// A map from ids that are dense: an array with a place for each id up to the largest. Where most ids have a value, it is
/// smaller than a hash map, and several times as fast.
#[derive(Clone, Debug)]
pub struct IdMap<I, T> {
    places: Vec<Option<T>>,
    index: PhantomData<fn(I) -> I>,
}

impl<I: Id, T> IdMap<I, T> {
    /// The value of an id.
    #[inline]
    pub fn get(&self, id: I) -> Option<&T> {
        self.places.get(id.idx())?.as_ref()
    }
    /// The value of an id, mutable.
    pub fn get_mut(&mut self, id: I) -> Option<&mut T> {
        self.places.get_mut(id.idx())?.as_mut()
    }
    /// True if the id has a value.
    #[inline]
    pub fn contains(&self, id: I) -> bool {
        self.get(id).is_some()
    }
    /// Sets the value of an id.
    pub fn insert(&mut self, id: I, value: T) {
        if self.places.len() <= id.idx() {
            self.places.resize_with(id.idx() + 1, || None);
        }
        self.places[id.idx()] = Some(value);
    }
    /// Removes the value of an id.
    pub fn remove(&mut self, id: I) {
        if let Some(place) = self.places.get_mut(id.idx()) {
            *place = None;
        }
    }
}

impl<I, T> Default for IdMap<I, T> {
    fn default() -> Self {
        IdMap { places: Vec::new(), index: PhantomData }
    }
}
impl<I: Id, T> FromIterator<(I, T)> for IdMap<I, T> {
    fn from_iter<It: IntoIterator<Item = (I, T)>>(pairs: It) -> Self {
        let mut map = IdMap::default();
        pairs.into_iter().for_each(|(id, value)| map.insert(id, value));
        map
    }
}

impl<I: Id, T> Default for IndexVec<I, T> {
    fn default() -> Self {
        Self::new()
    }
}
impl<I: Id, T> Index<I> for IndexVec<I, T> {
    type Output = T;
    #[inline]
    fn index(&self, i: I) -> &T {
        &self.raw[i.idx()]
    }
}
impl<I: Id, T> IndexMut<I> for IndexVec<I, T> {
    #[inline]
    fn index_mut(&mut self, i: I) -> &mut T {
        &mut self.raw[i.idx()]
    }
}
impl<'a, I, T> IntoIterator for &'a IndexVec<I, T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.raw.iter()
    }
}
impl<'a, I, T> IntoIterator for &'a mut IndexVec<I, T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.raw.iter_mut()
    }
}
impl<I: Id, T> FromIterator<T> for IndexVec<I, T> {
    fn from_iter<It: IntoIterator<Item = T>>(iter: It) -> Self {
        IndexVec { raw: iter.into_iter().collect(), index: PhantomData }
    }
}
impl<I: Id, T: std::fmt::Debug> std::fmt::Debug for IndexVec<I, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.raw.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::define_id! {
        struct Number
    }

    #[test]
    fn a_map_holds_what_was_inserted_last() {
        let mut map: IdMap<Number, &str> =
            [(Number(4), "four"), (Number(1), "one")].into_iter().collect();
        map.insert(Number(4), "vier");
        map.remove(Number(1));
        map.remove(Number(9));
        let all: Vec<_> = (0..6).filter_map(|k| map.get(Number(k))).collect();
        assert_eq!(all, [&"vier"]);
        assert!(map.contains(Number(4)) && !map.contains(Number(1)) && !map.contains(Number(9)));
        *map.get_mut(Number(4)).unwrap() = "4";
        assert_eq!(map.get(Number(4)), Some(&"4"));
    }
}
