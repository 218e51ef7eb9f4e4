//! How large the KKT matrix is in either wheel form: VMV04 fig. 2.

use crate::{ConstraintRows, WheelForm};

/// The size of `[∇²L Jᵀ; J 0]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KktCounts {
    /// `3 nt + nt + 2 ni`.
    pub unknowns: usize,
    /// Entries that are not zero by construction, both triangles.
    pub nonzeros: usize,
}

impl KktCounts {
    /// Counts without assembling anything.
    ///
    /// J has 3 entries per triangle row, `d` per vertex row and `2d` per wheel row of an interior
    /// vertex of valence `d`. The Hessian has its diagonal; the product form also couples the `d`
    /// `next` corners of a ring with each other, and its `d` `prev` corners.
    #[must_use]
    pub fn of(form: WheelForm, rows: &ConstraintRows) -> Self {
        let valences = (0..rows.interior_count()).map(|i| rows.hub_range(i).len());
        let corners = 3 * rows.triangle_count();
        let jacobian = corners + 3 * rows.hub_count();
        let hessian = corners
            + match form {
                WheelForm::Log => 0,
                WheelForm::Product => 2 * valences.map(|d| d * (d - 1)).sum::<usize>(),
            };
        Self { unknowns: corners + rows.len(), nonzeros: hessian + 2 * jacobian }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Jacobian;
    use abf_mesh::Topology;
    use abf_shapes::Shape;

    #[test]
    fn the_log_form_has_about_26_nonzeros_a_triangle_and_the_product_form_twice_that() {
        let mesh = Shape::BumpySheet.mesh(1800);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let log = KktCounts::of(WheelForm::Log, &rows);
        let product = KktCounts::of(WheelForm::Product, &rows);
        let jacobian = Jacobian::new(&topology, &rows);
        assert_eq!(log.nonzeros, topology.corner_count() + 2 * jacobian.view().nnz());
        let per_triangle = log.nonzeros as f64 / topology.face_count() as f64;
        assert!((24.0..27.0).contains(&per_triangle), "{per_triangle}");
        let ratio = product.nonzeros as f64 / log.nonzeros as f64;
        assert!((1.9..2.3).contains(&ratio), "{ratio}: VMV04 has 100 044 / 47 607 = 2.10");
        assert_eq!(log.unknowns, product.unknowns);
    }
}
