//! An order of elimination with all that follows from the pattern alone.

use crate::{Graph, LinearError, Parts, Permutation, SymbolicCholesky, SymmetricPattern};
use abf_control::Checkpoint;
use std::sync::Arc;

/// Multiplications of a factor from which a second order is tried, `Σ c²` over the lengths `c` of its columns. Below it
/// nested dissection costs more than it saves: measured on cut scans of one to four million triangles.
const DEAR: f64 = 5e10;

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
    /// Analyses an order of minimum degree. Where its factor costs more than 5e10 multiplications, nested dissection is tried
    /// beside it, and the cheaper of the two is kept.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices, or the checkpoint ends it.
    pub fn cheaper(
        graph: &Graph,
        minimum_degree: &Permutation,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        Self::cheaper_above(DEAR, graph, minimum_degree, checkpoint)
    }

    fn cheaper_above(
        dear: f64,
        graph: &Graph,
        minimum_degree: &Permutation,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        let first = Self::of(graph, minimum_degree, checkpoint)?;
        let cost = first.symbolic.flops();
        if cost <= dear {
            return Ok(first);
        }
        let halved = graph.nested_dissection(checkpoint)?;
        checkpoint()?;
        let second = Self::of(graph, &halved, checkpoint)?;
        Ok(if second.symbolic.flops() < cost { second } else { first })
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
    use crate::test_support::sheet;

    #[test]
    fn the_cheaper_order_is_kept() {
        let mut go_on = || Ok(());
        for n in [30, 120] {
            let graph = sheet(n);
            let amd = graph.amd().expect("an ordering");
            let halved = graph.nested_dissection(&mut go_on).expect("an ordering");
            let [by_degree, by_halves] =
                [&amd, &halved].map(|order| Analysis::of(&graph, order, &mut || Ok(())).expect("fits"));
            let cost = |analysis: &Analysis| analysis.symbolic.flops();
            assert!(cost(&by_degree) != cost(&by_halves));
            let kept = Analysis::cheaper_above(0.0, &graph, &amd, &mut go_on).expect("fits");
            let better = if cost(&by_halves) < cost(&by_degree) { by_halves } else { by_degree.clone() };
            assert_eq!(kept.order, better.order);
            let untried = Analysis::cheaper(&graph, &amd, &mut go_on).expect("fits");
            assert_eq!(untried.order, by_degree.order, "cheap factors keep minimum degree");
        }
    }
}
