//! The stand-ins: one thread, the names of rayon. They are here with threads, too, to be compared with them.
//!
//! They ask of closures and items what rayon asks, so that code which compiles without threads compiles with them.

use std::iter::{Enumerate, Filter, Map, Zip};

/// A parallel iterator that runs on one thread.
#[derive(Clone, Debug)]
pub struct Sequential<I>(I);

/// What [`scope`] hands to its closure.
#[derive(Debug)]
pub struct Scope(());

/// How many threads there are: one.
#[must_use]
pub fn current_num_threads() -> usize {
    1
}

/// Runs `a`, then `b`.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    let a = a();
    (a, b())
}

/// Runs `run`. With threads it would be run on one of the pool.
pub fn scope<R: Send>(run: impl FnOnce(&Scope) -> R + Send) -> R {
    run(&Scope(()))
}

/// The traits by their names in rayon's prelude.
pub mod prelude {
    pub use super::{
        IntoParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator, ParallelSlice,
        ParallelSliceMut,
    };
}

/// What can be done with every item.
pub trait ParallelIterator: Sized {
    /// What it runs over.
    type Item: Send;
    /// The iterator that does the work.
    type Iter: Iterator<Item = Self::Item>;

    /// The iterator that does the work.
    fn into_sequential(self) -> Self::Iter;

    /// How many items a thread takes at least: all of them are taken by one.
    #[must_use]
    fn with_min_len(self, _min: usize) -> Self {
        self
    }

    /// Every item with its index.
    fn enumerate(self) -> Sequential<Enumerate<Self::Iter>> {
        Sequential(self.into_sequential().enumerate())
    }

    /// The items for which `keep` is true.
    fn filter<F: Fn(&Self::Item) -> bool + Sync + Send>(self, keep: F) -> Sequential<Filter<Self::Iter, F>> {
        Sequential(self.into_sequential().filter(keep))
    }

    /// What `f` makes of every item.
    fn map<R: Send, F: Fn(Self::Item) -> R + Sync + Send>(self, f: F) -> Sequential<Map<Self::Iter, F>> {
        Sequential(self.into_sequential().map(f))
    }

    /// Pairs with the items of `other`, up to the end of the shorter one.
    fn zip<Z: IntoParallelIterator>(
        self,
        other: Z,
    ) -> Sequential<Zip<Self::Iter, <Z::Iter as ParallelIterator>::Iter>> {
        Sequential(self.into_sequential().zip(other.into_par_iter().into_sequential()))
    }

    /// Whether `is` is true for every item.
    fn all(self, is: impl Fn(Self::Item) -> bool + Sync + Send) -> bool {
        self.into_sequential().all(is)
    }

    /// Whether `is` is true for some item.
    fn any(self, is: impl Fn(Self::Item) -> bool + Sync + Send) -> bool {
        self.into_sequential().any(is)
    }

    /// The items in their order.
    fn collect<C: FromIterator<Self::Item>>(self) -> C {
        self.into_sequential().collect()
    }

    /// How many items there are.
    fn count(self) -> usize {
        self.into_sequential().count()
    }

    /// Does something with every item.
    fn for_each(self, f: impl Fn(Self::Item) + Sync + Send) {
        self.into_sequential().for_each(f);
    }

    /// All items combined by `join`, which has to be associative, with `identity` where there is none.
    fn reduce(
        self,
        identity: impl Fn() -> Self::Item + Sync + Send,
        join: impl Fn(Self::Item, Self::Item) -> Self::Item + Sync + Send,
    ) -> Self::Item {
        self.into_sequential().fold(identity(), join)
    }

    /// The sum of the items.
    fn sum<S: std::iter::Sum<Self::Item>>(self) -> S {
        self.into_sequential().sum()
    }
}

impl<I: Iterator<Item: Send>> ParallelIterator for Sequential<I> {
    type Item = I::Item;
    type Iter = I;

    fn into_sequential(self) -> I {
        self.0
    }
}

/// What becomes a parallel iterator.
pub trait IntoParallelIterator {
    /// The iterator that it becomes.
    type Iter: ParallelIterator<Item = Self::Item>;
    /// What that runs over.
    type Item: Send;

    /// The iterator over what `self` holds.
    fn into_par_iter(self) -> Self::Iter;
}

impl<P: ParallelIterator> IntoParallelIterator for P {
    type Iter = P;
    type Item = P::Item;

    fn into_par_iter(self) -> P {
        self
    }
}

/// Containers that have `into_iter` of their own.
macro_rules! into_par_iter {
    ($([$($generics:tt)*] $container:ty where $bound:path;)*) => {$(
        impl<$($generics)*> IntoParallelIterator for $container
        where
            T: $bound,
            Self: IntoIterator<Item: Send>,
        {
            type Iter = Sequential<<Self as IntoIterator>::IntoIter>;
            type Item = <Self as IntoIterator>::Item;

            fn into_par_iter(self) -> Self::Iter {
                Sequential(self.into_iter())
            }
        }
    )*};
}

into_par_iter! {
    [T] Vec<T> where Send;
    [T] std::ops::Range<T> where Send;
    ['a, T] &'a Vec<T> where Sync;
    ['a, T] &'a [T] where Sync;
    ['a, T] &'a mut Vec<T> where Send;
    ['a, T] &'a mut [T] where Send;
}

/// What lends its items.
pub trait IntoParallelRefIterator<T> {
    /// The items, one after another.
    fn par_iter(&self) -> Sequential<std::slice::Iter<'_, T>>;
}

impl<T: Sync> IntoParallelRefIterator<T> for [T] {
    fn par_iter(&self) -> Sequential<std::slice::Iter<'_, T>> {
        Sequential(self.iter())
    }
}

/// What lends its items to be changed.
pub trait IntoParallelRefMutIterator<T> {
    /// The items, one after another.
    fn par_iter_mut(&mut self) -> Sequential<std::slice::IterMut<'_, T>>;
}

impl<T: Send> IntoParallelRefMutIterator<T> for [T] {
    fn par_iter_mut(&mut self) -> Sequential<std::slice::IterMut<'_, T>> {
        Sequential(self.iter_mut())
    }
}

/// A slice in pieces.
pub trait ParallelSlice<T> {
    /// Pieces of `size` items; the last one may be shorter.
    fn par_chunks(&self, size: usize) -> Sequential<std::slice::Chunks<'_, T>>;
}

impl<T: Sync> ParallelSlice<T> for [T] {
    fn par_chunks(&self, size: usize) -> Sequential<std::slice::Chunks<'_, T>> {
        Sequential(self.chunks(size))
    }
}

/// A slice in pieces that are changed.
pub trait ParallelSliceMut<T> {
    /// Pieces of `size` items; the last one may be shorter.
    fn par_chunks_mut(&mut self, size: usize) -> Sequential<std::slice::ChunksMut<'_, T>>;
}

impl<T: Send> ParallelSliceMut<T> for [T] {
    fn par_chunks_mut(&mut self, size: usize) -> Sequential<std::slice::ChunksMut<'_, T>> {
        Sequential(self.chunks_mut(size))
    }
}

#[cfg(test)]
mod tests;
