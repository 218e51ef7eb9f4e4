//! The Hessian of the Lagrangian, where it is diagonal.

use abf_constraints::{AngleProblem, WheelForm};
use abf_control::UnknownName;
use abf_mesh::CornerId;

/// Which second derivatives go into Λ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Hessian {
    /// Those of the energy only: Λ = 2w, always positive (ABF++, LinABF).
    #[default]
    GaussNewton,
    /// Those of the constraints too: Λ = 2w − m/sin²x in the log form (VMV04 §6), with m the wheel
    /// multipliers where x is `next` minus those where it is `prev`. Negative on a few corners.
    Exact,
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<Hessian>("Hessian", given)
}

/// 2w, the Gauss–Newton Λ.
pub(crate) fn gauss_newton(problem: &AngleProblem<'_>) -> Vec<f64> {
    problem.weight().iter().map(|w| 2.0 * w).collect()
}

/// The diagonal of the exact Hessian at `angles`, from that of the energy alone, and how many of its entries are negative.
///
/// A triangle whose entries cancel in `1ᵀ Λ⁻¹ 1` takes 2w: its own row could not be eliminated.
pub(crate) fn exact_diagonal(
    problem: &AngleProblem<'_>,
    gauss_newton: &[f64],
    form: WheelForm,
    angles: &[f64],
    multipliers: &[f64],
) -> (Vec<f64>, usize) {
    let (topology, rows) = (problem.topology(), problem.rows());
    let mut lambda = gauss_newton.to_vec();
    for (i, &v) in rows.interior().iter().enumerate() {
        let m = multipliers[rows.wheel(i)];
        for hub in topology.fan(v) {
            for (corner, sign) in [(hub.next(), 1.0), (hub.prev(), -1.0)] {
                lambda[corner.index()] += sign * m * wheel_second_derivative(form, angles, corner);
            }
        }
    }
    for face in topology.faces() {
        let corners = face.corners().map(CornerId::index);
        if abf_constraints::TriangleReduction::new(corners.map(|c| lambda[c])).is_singular() {
            corners.into_iter().for_each(|c| lambda[c] = gauss_newton[c]);
        }
    }
    let negative = lambda.iter().filter(|&&l| l < 0.0).count();
    (lambda, negative)
}

/// `d²/dx² log sin x = −1/sin²x`. The product form puts its second derivatives, diagonal and not,
/// into [`crate::ProductCurvature`].
fn wheel_second_derivative(form: WheelForm, angles: &[f64], corner: CornerId) -> f64 {
    match form {
        WheelForm::Log => -angles[corner.index()].sin().powi(-2),
        WheelForm::Product => 0.0,
    }
}
