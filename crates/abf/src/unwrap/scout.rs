//! Seams that grow with the stretch that is foreseen: no map is made for them.

use super::component::Component;
use super::foresight::{Foresight, Progress};
use super::stretch::Stretch;
use super::surface::Surface;
use crate::FlattenError;
use abf_control::{Event, ask};
use abf_cut::{Chart, HoleFilling};

/// One more cut than the aim asks for makes the seam at most so many times as long.
const MOST_SEAM: f64 = 1.35;

/// Without at least this part of all stretch at the places that it joins, no cut takes most of the stretch away.
const MOST_OF_STRETCH: f64 = 0.5;

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
                // A cut that reached a rim would make another surface of it.
                if surface.holes_filled() == 0 && self.cut_once_more(surface, &stretch, foresight)? {
                    cuts += 1;
                }
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

    /// Makes the next cut of a surface that a map is worth trying of, if that is worth a longer seam; whether it did.
    ///
    /// The aim may be met just before the cut that matters. A foot is within 1.15 with an F/3nt of 2.2e-4; the next cut, for a
    /// seam 1.3 times as long, brings 1.5e-4. And a map that misses the aim takes longer than a few cuts that are only foreseen:
    /// where it may, a short cut that takes much of the stretch away is made before it.
    fn cut_once_more(
        &self,
        surface: &mut Surface,
        stretch: &Stretch,
        foresight: &mut Foresight,
    ) -> Result<bool, FlattenError> {
        let peaks = self.peaks(surface, stretch);
        if peaks.share < MOST_OF_STRETCH && !foresight.is_doubtful() {
            return Ok(false);
        }
        let (before, length) = (surface.growth(), surface.seam_length());
        let is_cut = surface.extend(&peaks.vertices) > 0;
        let longer = surface.seam_length() / length;
        let pays = is_cut && longer <= MOST_SEAM && foresight.pays(surface, longer, &mut || self.go_on())?;
        if !pays {
            surface.back_to(before);
        }
        Ok(pays)
    }
}
