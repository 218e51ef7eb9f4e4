//! Parametric shapes of any size: the fixtures, the benchmarks' meshes and the tests'.
