//! Seams that grow with the stretch that is foreseen: no map is made for them.

use super::component::Component;
use super::foresight::{Foresight, Progress};
use super::surface::Surface;
use crate::FlattenError;
use abf_control::{Event, ask};
use abf_cut::{Chart, HoleFilling};

/// What came of scouting.
pub(super) enum Scouted {
    /// After so many cuts a map is worth trying.
    Promising(usize),
    /// More cuts no longer help, and there have been so many: only one map is worth trying.
    Stalled(usize),
    /// After so many cuts nothing can be foreseen: only maps will tell.
    Unknown(usize),
    /// However it is cut, no map will meet the aim.
    Hopeless,
}

impl Component<'_, '_> {
    /// Joins the places where the largest stretch is foreseen to the seam, and again, until a map is worth trying.
    pub(super) fn scout(
        &self,
        piece: &Chart,
        filling: Option<HoleFilling>,
        surface: &mut Surface,
        foresight: &mut Foresight,
        round: usize,
    ) -> Result<Scouted, FlattenError> {
        let mut progress = Progress::default();
        let mut cuts = 0;
        while self.interruption().is_none() && !self.is_long(surface) {
            let mut ear = self.ear();
            ear.begin_round(round + cuts);
            ask(&mut ear, Event::Working)?;
            let Some(stretch) = foresight.stretch(surface, &mut || self.go_on())? else {
                return Ok(Scouted::Unknown(cuts));
            };
            if stretch.l2 <= foresight.worth_trying {
                break;
            }
            if progress.is_stalled(stretch.l2) || !self.cut_further(surface, &stretch) {
                return Ok(if foresight.is_hopeless() { Scouted::Hopeless } else { Scouted::Stalled(cuts) });
            }
            cuts += 1;
            self.release_caps(piece, filling, surface)?;
        }
        Ok(Scouted::Promising(cuts))
    }
}
