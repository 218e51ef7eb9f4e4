//! Flatten triangle meshes by solving for the angles of the flat mesh
