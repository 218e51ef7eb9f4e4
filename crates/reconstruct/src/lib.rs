//! From angles to coordinates: least squares, tree integration, Poisson
