//! The native part of the Python package `abf_flatten`: its module `_abf`.
//!
//! Arrays come in as `NumPy` arrays of one type each and are copied before anything looks at them; results go out as dicts
//! of numbers, names and arrays. What users call, with every setting as a keyword, is in `python/abf_flatten`.
//!
//! | file | what it does |
//! | --- | --- |
//! | `arrays.rs` | between `NumPy` arrays and meshes |
//! | `settings.rs` | from keywords to the settings of the library |
//! | `errors.rs` | from the library's errors to Python exceptions |
//! | `pools.rs` | threads that survive neither a fork nor a call too many |
//! | `supervise.rs` | signals, progress and the interpreter's lock while the library works |
//! | `results.rs` | what is known of a map, as a dict |
//! | `flatten.rs`, `unwrap.rs`, `relax.rs`, `judge.rs`, `pack.rs`, `files.rs` | one function of the package each |

mod arrays;
mod errors;
mod files;
mod flatten;
mod judge;
mod pack;
mod pools;
mod relax;
mod results;
mod running;
mod settings;
mod supervise;
mod unwrap;

use pyo3::prelude::*;

/// The native part of `abf_flatten`.
#[pymodule]
mod _abf {
    #[pymodule_export]
    use crate::errors::{
        AbfError, FormatError, GeometryError, NoResultError, NotADiskError, SettingError, ShapeError, TopologyError,
    };
    #[pymodule_export]
    use crate::files::{parse, read, write};
    #[pymodule_export]
    use crate::flatten::flatten;
    #[pymodule_export]
    use crate::judge::{certify, metrics};
    #[pymodule_export]
    use crate::pack::pack;
    #[pymodule_export]
    use crate::relax::relax;
    #[pymodule_export]
    use crate::running::end_calls;
    #[pymodule_export]
    use crate::unwrap::unwrap;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("solvers", abf::SolverKind::ALL.map(abf::SolverKind::name))
    }
}
