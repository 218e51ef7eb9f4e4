//! Where a surface turns.

use abf_mesh::{CornerId, TriMesh, Vector3};

/// The edges at which a sheet is folded, each by one of its corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Folds {
    /// The front of the sheet is outside: the surface is convex.
    pub(crate) mountains: Vec<CornerId>,
    /// The front of the sheet is inside.
    pub(crate) valleys: Vec<CornerId>,
}

impl Folds {
    /// The edges at which the surface turns by at least an angle, rad. Faces without area have no folds.
    pub(crate) fn of(mesh: &TriMesh, joined: &[[CornerId; 2]], angle: f64) -> Self {
        let place = |c: CornerId| mesh.positions()[mesh.faces()[c.face().index()][c.place()].index()];
        let normal = |c: CornerId| -> Option<Vector3<f64>> {
            let [p, q, r] = [c, c.next(), c.prev()].map(place);
            (q - p).cross(&(r - p)).try_normalize(0.0)
        };
        let mut folds = Self::default();
        for &[c, d] in joined {
            let (Some(one), Some(other)) = (normal(c), normal(d)) else { continue };
            if one.cross(&other).norm().atan2(one.dot(&other)) < angle {
                continue;
            }
            // Whether the far corner of the other face is above this one.
            let is_valley = one.dot(&(place(d.prev()) - place(c))) > 0.0;
            if is_valley { &mut folds.valleys } else { &mut folds.mountains }.push(c);
        }
        folds
    }
}
