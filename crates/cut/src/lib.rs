//! From any triangle mesh to disks: what angle-based flattening needs before it can begin.
//!
//! The way of a mesh, each step with a map back to where it came from:
//!
//! 0. [`weld`](weld()) joins vertices that stand in one place, where that makes boundary edges meet;
//! 1. [`repair`](repair()) makes an oriented manifold with boundary of it, and counts what that took;
//! 2. [`split`] without seams takes its components apart;
//! 3. [`fill`] closes holes by virtual faces, to be dropped after the layout;
//! 4. [`open`] finds the least seam that makes a component a disk;
//! 5. [`extend`] joins further vertices to the seam: those at which the stretch is too large;
//! 6. [`split`] cuts along the seam, into [`Chart`]s.
//!
//! Beside that, [`ConformalScale`] foresees where a map will shrink a surface, before there is a map, [`hard_surface`] finds
//! the nets of planar and developable parts, and [`two_parts`] takes apart what nothing else helps.
//!
//! Nothing here solves for an angle. Seams prefer edges that are short, creased and hidden
//! ([`EdgeCosts`]); every search is Dijkstra's (1959), so all of it takes time `O(n log n)`.
//!
//! | term | meaning |
//! | --- | --- |
//! | seam | an edge along which the surface is cut ([`Seams`]) |
//! | chart | what is left in one piece between seams |
//! | terminal | a vertex that a seam is to reach |
//! | hole | a boundary loop other than the longest of its component |

mod borders;
mod chart;
mod conformal;
mod costs;
mod extend;
mod holes;
mod nets;
mod open;
mod part;
mod paths;
mod repair;
mod seams;
#[cfg(test)]
mod test_support;
mod walks;
mod weld;

pub use borders::{label_borders, uv_borders};
pub use chart::{Chart, split, split_asking};
pub use conformal::{ConformalScale, scaled_angles};
pub use costs::{CostSettings, EdgeCosts};
pub use extend::{SeamWays, distances, extend};
pub use holes::{Filled, HoleFilling, fill, loop_length, outer_loop};
pub use nets::{HardSurface, PlanarFacets, hard_surface, hard_surface_asking, planar_facets};
pub use open::open;
pub use part::{two_parts, two_parts_asking};
pub use repair::{
    DoubleSided, Found, RepairError, RepairReport, Repaired, first_at_place, paired_by_place, repair, repair_asking,
    repair_with,
};
pub use seams::Seams;
pub use walks::FaceWalks;
pub use weld::{Weld, Welded, weld, weld_asking, weld_within};
