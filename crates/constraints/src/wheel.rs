//! The wheel condition, in both forms, and its derivative.
//!
//! Around an interior vertex the sine rule, applied from triangle to triangle, must come back to
//! the length it started with. With `next` and `prev` the other two corners of each triangle of
//! the ring, counter-clockwise:
//!
//! * product form (ABF eq. (3)): `Π sin x[next] − Π sin x[prev] = 0`
//! * log form (ZRS05; VMV04 eq. (6); LinABF eq. (7) with its bracket put right):
//!   `Σ log sin x[next] − log sin x[prev] = 0`
//!
//! The two vanish together. The log form has a diagonal second derivative; the product form
//! couples every pair of `next` corners, and every pair of `prev` corners, of a ring.

use crate::ConstraintRows;
use crate::per_corner::per_corner;
use abf_control::UnknownName;
use abf_mesh::{CornerId, Topology, VertexId};

/// Which form of the wheel condition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum WheelForm {
    /// `Σ log sin x[next] − log sin x[prev]`.
    #[default]
    Log,
    /// `Π sin x[next] − Π sin x[prev]`.
    Product,
}

impl WheelForm {
    /// The value of the wheel condition at one interior vertex, angles taken as they are.
    #[must_use]
    pub fn value(self, topology: &Topology, vertex: VertexId, angles: &[f64]) -> f64 {
        match self {
            Self::Log => topology.fan(vertex).map(|c| log_ratio(c, angles)).sum(),
            Self::Product => {
                let (next, prev) = sine_products(topology, vertex, angles);
                next - prev
            }
        }
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<WheelForm>("wheel form", given)
}

/// `log sin x[next] − log sin x[prev]` of one triangle of a ring.
#[inline]
fn log_ratio(hub: CornerId, angles: &[f64]) -> f64 {
    angles[hub.next().index()].sin().ln() - angles[hub.prev().index()].sin().ln()
}

/// `Π sin x[next]` and `Π sin x[prev]` around a vertex.
fn sine_products(topology: &Topology, vertex: VertexId, angles: &[f64]) -> (f64, f64) {
    topology.fan(vertex).fold((1.0, 1.0), |(next, prev), c| {
        (next * angles[c.next().index()].sin(), prev * angles[c.prev().index()].sin())
    })
}

/// The derivative of all wheel conditions at one set of angles.
///
/// In both forms it is a factor per vertex times the cotangent of the corner:
/// `d wheel / d x[next] = +factor_next · cot x[next]` and
/// `d wheel / d x[prev] = −factor_prev · cot x[prev]`, the factors being 1 in the log form and the
/// two sine products in the product form.
#[derive(Clone, Debug, Default)]
pub struct WheelDerivative {
    cotangents: Vec<f64>,
    /// Per interior vertex the factors for next and prev; empty in the log form.
    factors: Vec<(f64, f64)>,
}

impl WheelDerivative {
    /// The derivative at these angles, one per corner, radians.
    #[must_use]
    pub fn new(form: WheelForm, topology: &Topology, rows: &ConstraintRows, angles: &[f64]) -> Self {
        let cotangents = per_corner(angles, |x| x.tan().recip());
        let factors = match form {
            WheelForm::Log => Vec::new(),
            WheelForm::Product => rows.interior().iter().map(|&v| sine_products(topology, v, angles)).collect(),
        };
        Self { cotangents, factors }
    }

    /// The cotangents, to be written anew: all there is in the log form.
    pub(crate) fn cotangents_of_logs(&mut self) -> &mut Vec<f64> {
        self.factors.clear();
        &mut self.cotangents
    }

    /// `cot x` per corner. In the log form these are all the coefficients there are: `+cot x[next]` and
    /// `−cot x[prev]`.
    #[must_use]
    pub fn cotangents(&self) -> &[f64] {
        &self.cotangents
    }

    /// The coefficients of `x[next]` and `x[prev]` in the wheel row of the `interior`-th interior
    /// vertex, for the triangle whose corner at that vertex is `hub`.
    #[inline]
    #[must_use]
    pub fn coefficients(&self, interior: usize, hub: CornerId) -> (f64, f64) {
        let (next, prev) = (self.cotangents[hub.next().index()], self.cotangents[hub.prev().index()]);
        match self.factors.get(interior) {
            None => (next, -prev),
            Some((factor_next, factor_prev)) => (factor_next * next, -factor_prev * prev),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    #[test]
    fn both_forms_vanish_on_a_flat_ring_and_agree_in_sign_elsewhere() {
        let mesh = Shape::FoldedSheet.mesh(60);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let mut angles = mesh.corner_angles();
        for &v in rows.interior() {
            assert!(WheelForm::Log.value(&topology, v, &angles).abs() < 1e-13);
            assert!(WheelForm::Product.value(&topology, v, &angles).abs() < 1e-13);
        }
        let v = rows.interior()[0];
        let hub = topology.fan_start(v).expect("a ring");
        angles[hub.next().index()] *= 0.9;
        let (log, product) =
            (WheelForm::Log.value(&topology, v, &angles), WheelForm::Product.value(&topology, v, &angles));
        assert!(log * product > 0.0, "{log} {product}");
    }

    #[test]
    fn names_read_back() {
        for form in [WheelForm::Log, WheelForm::Product] {
            assert_eq!(form.to_string().parse(), Ok(form));
        }
        assert!("sum".parse::<WheelForm>().is_err());
    }
}
