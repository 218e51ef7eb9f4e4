//! UVs that a file has, judged.

use crate::record::Quality;
use abf::{Atlas, JudgeError, JudgeSettings, Judgement, MetricsError, Precision, Weld};
use abf_mesh::{TriMesh, UvMap};

/// How UVs are judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judging {
    /// What they are stored in.
    pub(crate) precision: Precision,
    /// Texels of their page along x and y, if that is known.
    pub(crate) page: Option<[u32; 2]>,
    /// What the repair before joins; `None` judges the faces as they are.
    pub(crate) repair: Option<Weld>,
}

impl Judging {
    /// The figures of the UVs; of the faces as they are where there is no repair, or where it leaves none. `objects` has the
    /// mesh that every face is of.
    ///
    /// # Errors
    /// Why they cannot be judged.
    pub(crate) fn judged(&self, mesh: &TriMesh, objects: Option<&[u32]>, uv: &UvMap) -> Result<Quality, MetricsError> {
        let &Self { precision, page, repair } = self;
        match repair.map(|weld| abf::judge(mesh, uv, &JudgeSettings { weld, objects, precision, page })) {
            Some(Ok(Judgement { metrics, turned, shared, .. })) => Ok(Quality::of_repaired(&metrics, turned, shared)),
            Some(Err(JudgeError::Metrics(error))) => Err(error),
            Some(Err(_)) | None => {
                let certificate = abf_metrics::certify_stored(mesh, uv, precision)?;
                let in_page = Atlas::in_proportions(uv, page.unwrap_or([1; 2]));
                Ok(Quality::new(&abf_metrics::measure_certified(mesh, &in_page, certificate)?))
            }
        }
    }
}
