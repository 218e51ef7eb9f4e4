//! Sparse linear algebra for angle-based flattening: ordering, Cholesky, refinement
