//! Pictures of a flattened mesh: the checkered surface next to its layout
