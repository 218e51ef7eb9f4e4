//! Distortion and validity of a UV map, judged from the mesh and the UVs alone
