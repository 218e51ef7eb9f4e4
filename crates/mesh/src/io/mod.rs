//! Reading and writing mesh files: the only place in the workspace that touches files of geometry.
