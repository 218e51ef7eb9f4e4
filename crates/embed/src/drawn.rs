//! A drawing as observers may measure it.

use crate::plane::{angles, not_counter_clockwise, of_face};
use abf_control::Drawing;
use abf_mesh::{Point2, Topology};

/// A drawing of a surface.
#[derive(Debug)]
pub(crate) struct Drawn<'d> {
    pub(crate) topology: &'d Topology,
    /// The angles of the surface, one per corner, rad.
    pub(crate) mesh_angles: &'d [f64],
    /// One point per vertex.
    pub(crate) uv: &'d [Point2<f64>],
}

impl Drawing for Drawn<'_> {
    fn f(&self) -> f64 {
        let of = |face| {
            let drawn: [f64; 3] = angles(&of_face(self.topology, self.uv, face));
            drawn.iter().zip(&self.mesh_angles[3 * face.index()..]).map(|(x, a)| (x - a) * (x - a)).sum::<f64>()
        };
        self.topology.faces().map(of).sum::<f64>() / self.mesh_angles.len() as f64
    }

    fn flips(&self) -> usize {
        not_counter_clockwise(self.topology, self.uv).map_or(0, |(_, count)| count)
    }
}
