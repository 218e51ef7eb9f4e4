//! Parallel iterators and `join`, with threads or without.
//!
//! With the feature `rayon` the names here are those of rayon. Without it they are stand-ins that run on the thread that
//! calls: for targets without threads, such as the browser, and for programs that want no thread but their own.
//!
//! ```
//! use abf_parallel::prelude::*;
//!
//! let squares: Vec<usize> = (0..4).into_par_iter().with_min_len(2).map(|i| i * i).collect();
//! assert_eq!(squares, [0, 1, 4, 9]);
//! let largest = squares.par_iter().map(|&x| x).reduce(|| 0, usize::max);
//! assert_eq!(largest, 9);
//! ```
//!
//! The results have the same bits both ways, as long as what is reduced does not depend on the order: a maximum, a sum of
//! whole numbers. Sums of floating-point numbers are formed block by block, and the blocks are added in order.

pub mod sequential;
mod threads;

#[cfg(feature = "rayon")]
pub use rayon::{current_num_threads, join, scope};
#[cfg(not(feature = "rayon"))]
pub use sequential::{current_num_threads, join, scope};
pub use threads::{Pool, PoolError, with_threads};

/// The traits whose methods are called: `use abf_parallel::prelude::*`.
pub mod prelude {
    #[cfg(not(feature = "rayon"))]
    pub use crate::sequential::prelude::*;
    #[cfg(feature = "rayon")]
    pub use rayon::prelude::*;
}
