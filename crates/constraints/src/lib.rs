//! The angle problem: targets, weights, constraints, Jacobians and their local reduction
