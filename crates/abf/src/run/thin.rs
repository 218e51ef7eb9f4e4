//! Meshes with angles below the bound: solved with their own angles and with bounded ones, and the better kept.
//!
//! Neither is always right. A flat sheet with needles in it is exact with its own angles; a needle on a curved surface can
//! spoil the linearisation, and the bound is what keeps its neighbours in shape.

use crate::{FlattenError, Flattening, SolverKind};
use abf_control::{Event, Observer, Termination, ask};
use abf_mesh::TriMesh;
use abf_metrics::Metrics;

/// A map whose L² stretch is above 1 by no more than this has nothing to gain.
const ISOMETRIC: f64 = 1e-9;

/// Stretches this near to each other, relative, are the same: the weighted F decides then.
const SAME_STRETCH: f64 = 1e-6;

/// The better of a result and another, which is made only where the first leaves something to gain: a stretch above
/// `enough`. `bounded` is told whose result the first is.
pub(crate) fn better(
    mesh: &TriMesh,
    enough: f64,
    own: Result<Flattening, FlattenError>,
    observer: &mut dyn Observer,
    bounded: impl FnOnce(Option<SolverKind>, &mut dyn Observer) -> Result<Flattening, FlattenError>,
) -> Result<Flattening, FlattenError> {
    let own = match own {
        Ok(own) => own,
        Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(error) => return bounded(None, observer).map_err(|_| error),
    };
    ask(observer, Event::Working)?;
    let Ok(with_own) = own.metrics(mesh) else { return Ok(own) };
    ask(observer, Event::Working)?;
    let is_enough = own.is_certified() && with_own.stretch_l2 <= enough.max(1.0 + ISOMETRIC);
    if is_enough || own.termination == Termination::Cancelled {
        return Ok(own);
    }
    let bounded = match bounded(Some(own.solver), observer) {
        Ok(bounded) => bounded,
        Err(FlattenError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(_) => return Ok(own),
    };
    ask(observer, Event::Working)?;
    let Ok(with_bound) = bounded.metrics(mesh) else { return Ok(own) };
    let is_better = is_better(&(&bounded, &with_bound), &(&own, &with_own));
    Ok(if is_better { bounded } else { own })
}

/// Certified before valid before not; then without overlap, less stretch, less relative angle error.
fn is_better(one: &(&Flattening, &Metrics), other: &(&Flattening, &Metrics)) -> bool {
    let rank = |(flat, metrics): &(&Flattening, &Metrics)| (flat.is_certified(), metrics.valid(), metrics.injective());
    if rank(one) != rank(other) {
        return rank(one) > rank(other);
    }
    let (a, b) = (one.1.stretch_l2, other.1.stretch_l2);
    let is_same = (a - b).abs() <= SAME_STRETCH * b;
    if is_same { one.1.f_weighted < other.1.f_weighted } else { a < b }
}
