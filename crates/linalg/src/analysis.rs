//! An order of elimination with all that follows from the pattern alone.

use crate::bisection::Dissection;
use crate::{Graph, LinearError, Parts, Permutation, SymbolicCholesky, SymmetricPattern};
use abf_control::Checkpoint;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Multiplications of a factor from which a second order is tried, `Σ c²` over the lengths `c` of its columns. Below it
/// nested dissection costs more than it saves: measured on cut scans of one to four million triangles.
const DEAR: f64 = 5e10;

/// On graphs of more vertices dissection begins before it is known whether minimum degree is dear, where there is more than one thread.
const LARGE: usize = 1 << 20;

/// The order, its independent parts and the analysis of the factor, one unknown a vertex.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Which vertex is eliminated when.
    pub order: Permutation,
    /// Ranges of it that do not touch one another.
    pub parts: Parts,
    /// The pattern of the factor.
    pub symbolic: Arc<SymbolicCholesky>,
}

impl Analysis {
    /// Orders a graph by minimum degree and analyses the factor. Where that costs more than 5e10 multiplications, nested
    /// dissection is tried, too, and the cheaper of the two is kept: the same one for any number of threads.
    ///
    /// Minimum degree is one long thread. A second one does `beside` meanwhile. On a graph of more than a million vertices
    /// it then begins to dissect, since the factor is dear there more often than not; the checkpoint is not asked until the
    /// first thread has ordered and analysed the graph.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices, or the checkpoint ends it.
    pub fn cheaper<R: Send>(
        graph: &Graph,
        beside: impl FnOnce() -> R + Send,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(Self, R), LinearError> {
        let begin_early = graph.vertex_count() > LARGE && abf_parallel::current_num_threads() > 1;
        Self::cheaper_above(DEAR, begin_early, graph, beside, checkpoint)
    }

    fn cheaper_above<R: Send>(
        dear: f64,
        begin_early: bool,
        graph: &Graph,
        beside: impl FnOnce() -> R + Send,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(Self, R), LinearError> {
        let is_ordered = AtomicBool::new(false);
        let by_degree = || {
            let order = graph.amd();
            // While this thread analyses, the other one goes on dissecting.
            let analysed = begin_early.then(|| Self::of(graph, order.as_ref().ok()?, &mut || Ok(())).ok()).flatten();
            is_ordered.store(true, Ordering::Relaxed);
            order.map(|order| (order, analysed))
        };
        let is_idle = || begin_early && !is_ordered.load(Ordering::Relaxed);
        let dissect = || {
            let mut dissection = Dissection::new(graph);
            while is_idle() && !dissection.is_complete() {
                dissection.level()?;
            }
            Ok::<_, LinearError>(dissection)
        };
        let meanwhile = || (beside(), is_idle().then(dissect));
        let (by_degree, (result, begun)) = abf_parallel::join(by_degree, meanwhile);
        let (order, analysed) = by_degree?;
        checkpoint()?;
        let first = analysed.map_or_else(|| Self::of(graph, &order, checkpoint), Ok)?;
        let cost = first.symbolic.flops();
        if cost <= dear {
            return Ok((first, result));
        }
        let dissection = begun.unwrap_or_else(|| Ok(Dissection::new(graph)))?;
        let halved = dissection.finish(checkpoint)?;
        checkpoint()?;
        let second = Self::of(graph, &halved, checkpoint)?;
        Ok((if second.symbolic.flops() < cost { second } else { first }, result))
    }

    fn of(graph: &Graph, order: &Permutation, checkpoint: &mut Checkpoint<'_>) -> Result<Self, LinearError> {
        let (order, parts) = graph.in_parts(order);
        checkpoint()?;
        let pattern = SymmetricPattern::of_blocks(graph, &order, 1);
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(Arc::new(pattern))?;
        checkpoint()?;
        Ok(Self { order, parts, symbolic })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{sheet, with_threads};

    #[test]
    fn the_cheaper_order_is_kept_however_early_dissection_begins() {
        for n in [30, 120] {
            let graph = sheet(n);
            let amd = graph.amd().expect("an ordering");
            let halved = graph.nested_dissection(&mut || Ok(())).expect("an ordering");
            let [by_degree, by_halves] =
                [&amd, &halved].map(|order| Analysis::of(&graph, order, &mut || Ok(())).expect("fits"));
            let cost = |analysis: &Analysis| analysis.symbolic.flops();
            assert!(cost(&by_degree) != cost(&by_halves));
            let cheaper = if cost(&by_halves) < cost(&by_degree) { &by_halves } else { &by_degree };
            for (threads, begin_early) in [(1, false), (1, true), (2, false), (2, true)] {
                for (dear, expected) in [(0.0, cheaper), (f64::INFINITY, &by_degree)] {
                    let kept = with_threads(threads, || {
                        Analysis::cheaper_above(dear, begin_early, &graph, || n, &mut || Ok(())).expect("fits")
                    });
                    assert_eq!(
                        (&kept.0.order, kept.1),
                        (&expected.order, n),
                        "{threads} threads, early: {begin_early}"
                    );
                }
            }
            let untried = Analysis::cheaper(&graph, || (), &mut || Ok(())).expect("fits").0;
            assert_eq!(untried.order, by_degree.order, "cheap factors keep minimum degree");
        }
    }
}
