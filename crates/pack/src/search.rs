//! From pieces to pages.

use crate::combine::{DECIDES, Job, Layout};
use crate::geometry::{UNTURNED, extent};
use crate::grid::Pose;
use crate::shape::Shape;
use crate::{PackError, PackSettings, Packing, Piece, Placement};
use abf_parallel::prelude::*;
use std::collections::BTreeMap;

/// Packs pieces: at the scale that is given, on as few pages as are found to do; without one at the largest scale that is
/// found to fit the pages that are allowed.
///
/// A group of one piece is put at the angle at which it can be largest, in closed form.
///
/// # Errors
/// [`PackError`].
pub fn pack(pieces: &[Piece], settings: &PackSettings) -> Result<Packing, PackError> {
    settings.check()?;
    let unit = check(pieces)?;
    let mut job = job(pieces, unit, settings);
    let (scale, layout) = match settings.texels_per_unit {
        None => job.largest_scale(settings.effort).ok_or_else(|| {
            let [width, height] = settings.page;
            let pieces = job.groups.iter().map(Vec::len).max().unwrap_or(0);
            PackError::TooManyPieces { pieces, pages: job.pages, margin: settings.margin, width, height }
        })?,
        Some(given) => {
            let scale = given * unit;
            (scale, at_scale(&mut job, scale, unit, settings)?)
        }
    };
    let texels_per_unit = settings.texels_per_unit.unwrap_or(scale / unit);
    Ok(packing(pieces, &job, &layout, (scale, texels_per_unit), settings))
}

/// The length of the longest piece; 1 if none has a length.
pub(crate) fn check(pieces: &[Piece]) -> Result<f64, PackError> {
    let mut unit = 0.0_f64;
    for (piece, points) in pieces.iter().map(Piece::points).enumerate() {
        let points: Vec<[f64; 2]> = points.collect();
        if points.is_empty() {
            return Err(PackError::NoPoints { piece });
        }
        let (_, [w, h]) = extent(&points, UNTURNED);
        // An extent beyond all numbers is no length, either.
        if !points.iter().flatten().all(|x| x.is_finite()) || !(w + h).is_finite() {
            return Err(PackError::NotFinite { piece });
        }
        unit = unit.max(w.max(h));
    }
    Ok(if unit > 0.0 { unit } else { 1.0 })
}

fn job(pieces: &[Piece], unit: f64, settings: &PackSettings) -> Job {
    let inner = settings.inner();
    let shape = |piece: &Piece| {
        let points: Vec<[f64; 2]> = piece.points().collect();
        let (low, size) = extent(&points, UNTURNED);
        Shape::new(&piece.polygons, [low[0] + 0.5 * size[0], low[1] + 0.5 * size[1]], unit)
    };
    let shapes: Vec<Shape> = pieces.par_iter().map(shape).collect();
    // By the points themselves: the hull may lack a corner that hardly is one.
    let fitted = |pose: Pose| (pose, (inner[0] / pose.size[0]).min(inner[1] / pose.size[1]));
    let boxed = |(shape, piece): (&Shape, &Piece)| {
        Pose::new(shape, if piece.keeps_its_angle { UNTURNED } else { shape.hull.tightest_box() })
    };
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    pieces.iter().enumerate().for_each(|(i, piece)| groups.entry(piece.group).or_default().push(i));
    let boxes: Vec<Pose> = shapes.par_iter().zip(pieces).map(boxed).collect();
    // No group of several gets larger than its area lets it. A piece that is far smaller even in its box decides nothing.
    let mut is_asked = vec![settings.texels_per_unit.is_some(); pieces.len()];
    for group in groups.values() {
        let area: f64 = group.iter().map(|&i| shapes[i].area).sum();
        let by_area = (inner[0] * inner[1] * settings.pages as f64 / area).sqrt();
        let is_near = |i: usize| group.len() == 1 || !(fitted(boxes[i]).1 > DECIDES * by_area);
        group.iter().for_each(|&i| is_asked[i] |= is_near(i));
    }
    let largest = |i: usize| match &pieces[i] {
        piece if piece.keeps_its_angle => fitted(Pose::new(&shapes[i], UNTURNED)),
        _ if is_asked[i] => fitted(Pose::new(&shapes[i], shapes[i].hull.largest_in(inner).0)),
        _ => fitted(boxes[i]),
    };
    Job {
        largest: (0..pieces.len()).into_par_iter().map(largest).collect(),
        boxes,
        fixed: pieces.iter().map(|piece| piece.keeps_its_angle).collect(),
        groups: groups.into_values().collect(),
        shapes,
        // No group needs more pages than it has pieces.
        pages: settings.pages.min(pieces.len().max(1)),
        inner,
        margin: settings.kept_margin(),
    }
}

/// Each group onto as few pages as are found to do.
fn at_scale(job: &mut Job, scale: f64, unit: f64, settings: &PackSettings) -> Result<Layout, PackError> {
    let [width, height] = settings.page;
    let given = scale / unit;
    if let Some(piece) = job.largest.iter().position(|&(_, largest)| scale > largest) {
        let largest = job.largest[piece].1 / unit;
        return Err(PackError::PieceTooLarge { piece, width, height, texels_per_unit: given, largest });
    }
    let groups = std::mem::take(&mut job.groups);
    let (most, mut whole) = (job.pages, None);
    for group in &groups {
        job.groups = vec![group.clone()];
        job.pages = most;
        let too_many = || PackError::TooManyPages { pieces: group.len(), pages: most, texels_per_unit: given };
        let mut layout = job.at_scale(scale, settings.effort).ok_or_else(too_many)?;
        loop {
            let used = group.iter().map(|&i| layout[i].page + 1).max().unwrap_or(1);
            if used == 1 {
                break;
            }
            job.pages = used - 1;
            let Some(fewer) = job.at_scale(scale, settings.effort) else { break };
            layout = fewer;
        }
        let whole = whole.get_or_insert_with(|| layout.clone());
        group.iter().for_each(|&i| whole[i] = layout[i]);
    }
    (job.groups, job.pages) = (groups, most);
    Ok(whole.unwrap_or_default())
}

fn packing(
    pieces: &[Piece],
    job: &Job,
    layout: &Layout,
    (scale, texels_per_unit): (f64, f64),
    settings: &PackSettings,
) -> Packing {
    let margin = settings.kept_margin();
    let mut first_page = vec![0; pieces.len()];
    let mut pages = 0;
    for group in &job.groups {
        let used = group.iter().map(|&i| layout[i].page + 1).max().unwrap_or(0);
        group.iter().for_each(|&i| first_page[i] = pages);
        pages += used;
    }
    let placement = |(i, piece): (usize, &Piece)| {
        let slot = layout[i];
        let points: Vec<[f64; 2]> = piece.points().collect();
        let (low, _) = extent(&points, slot.turn);
        let corner = slot.corner.map(|x| x + margin);
        Placement { page: first_page[i] + slot.page, turn: slot.turn, low, corner }
    };
    let area: f64 = job.shapes.iter().map(|shape| shape.area).sum::<f64>() * scale * scale;
    let texels = settings.page.map(f64::from).iter().product::<f64>() * pages.max(1) as f64;
    Packing {
        texels_per_unit,
        placements: pieces.par_iter().enumerate().map(placement).collect(),
        pages,
        coverage: area / texels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effort;
    use crate::combine::BISECTIONS;

    #[test]
    fn boxes_that_are_nearly_as_large_as_can_be_do_not_keep_a_layout_from_being_so() {
        let notched =
            vec![[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [5.5, 6.0], [5.5, 4.5], [4.5, 4.5], [4.5, 6.0], [0.0, 6.0]];
        // Its spike goes into the notch. The boxes of both are a thousandth too high together.
        let spiked = vec![[0.0, 0.0], [9.0, 0.0], [9.0, 2.99], [4.6, 2.99], [4.5, 3.99], [4.4, 2.99], [0.0, 2.99]];
        let pieces = [notched, spiked].map(|ring| Piece::new(vec![ring]));
        for effort in Effort::ALL {
            let packing = pack(&pieces, &PackSettings { effort, ..PackSettings::default() }).expect("they fit");
            // The page without its margins, through the longest side.
            assert!((packing.texels_per_unit - 102.0).abs() < 1e-6, "{effort}: {}", packing.texels_per_unit);
        }
    }

    #[test]
    fn fast_is_not_below_boxes_however_many_pieces_there_are() {
        let rectangle = |i: usize| {
            let (w, h) = (1.0 + (i * 7 % 11) as f64, 0.5 + (i * 5 % 7) as f64);
            Piece::new(vec![vec![[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]]])
        };
        for count in [3, 20, 450] {
            let pieces: Vec<Piece> = (0..count).map(rectangle).collect();
            let job = job(&pieces, check(&pieces).expect("pieces"), &PackSettings::default());
            let ((boxes, _), _) = job.largest_boxes(job.bound(), BISECTIONS).expect("boxes");
            let (fast, _) = job.largest_scale(Effort::Fast).expect("a layout");
            // Both are bisected to four digits.
            assert!(fast > 0.999 * boxes, "{count}: {fast} {boxes}");
        }
    }
}
