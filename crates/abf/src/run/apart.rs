//! Maps that lie over themselves, taken apart by walks over them.

use crate::FlattenError;
use abf_control::Checkpoint;
use abf_cut::FaceWalks;
use abf_mesh::{FaceId, UvId, UvMap, Vector2};
use abf_metrics::Certificate;
use std::collections::HashMap;

/// A part of a map that is taken apart.
pub(crate) trait Part: Sized {
    /// What is proved of it.
    fn certificate(&self) -> &Certificate;

    /// The walks over it.
    fn walks(&self) -> FaceWalks;

    /// Some of its faces, by their numbers in it, as a part.
    fn some_faces(&self, faces: &[usize], checkpoint: &mut Checkpoint<'_>) -> Result<Self, FlattenError>;
}

/// Parts of a map none of which lies over itself, in no order. Of two faces that lie over each other each gets the faces that are
/// nearer to it in the plane, walking from face to face.
pub(crate) fn taken_apart<P: Part>(whole: P, checkpoint: &mut Checkpoint<'_>) -> Result<Vec<P>, FlattenError> {
    let (mut waiting, mut done) = (vec![whole], Vec::new());
    while let Some(part) = waiting.pop() {
        let certificate = part.certificate();
        // Of a single face there is no pair.
        let pair = certificate.overlapping_faces.first().copied().filter(|[one, other]| one != other);
        let Some([one, other]) = pair.filter(|_| certificate.overlaps() > 0) else {
            done.push(part);
            continue;
        };
        checkpoint()?;
        let is_others = part.walks().nearer_to_second(one.index(), other.index(), checkpoint)?;
        for side in [true, false] {
            let faces: Vec<usize> = (0..is_others.len()).filter(|&f| is_others[f] == side).collect();
            if !faces.is_empty() {
                waiting.push(part.some_faces(&faces, checkpoint)?);
            }
        }
    }
    Ok(done)
}

/// The walks from face to face in the plane, from middle to middle; `stays` says across which sides faces stay together.
pub(crate) fn walks(uv: &UvMap, stays: impl Fn(usize, usize) -> bool) -> FaceWalks {
    let middle = |f: usize| uv.triangle(FaceId::new(f)).iter().fold(Vector2::zeros(), |sum, p| sum + p.coords);
    let with_length = |f: usize, g: usize| (g, (middle(g) - middle(f)).norm());
    let beyond = neighbours(uv).into_iter().enumerate();
    FaceWalks::new(beyond.map(|(f, sides)| sides.map(|g| g.map(|g| with_length(f, g)))).collect(), stays)
}

/// For every face the faces that share two UV points with it.
pub(crate) fn neighbours(uv: &UvMap) -> Vec<[Option<usize>; 3]> {
    let faces = uv.corners().as_chunks::<3>().0;
    let mut first: HashMap<[UvId; 2], (usize, usize)> = HashMap::with_capacity(3 * faces.len() / 2);
    let mut neighbours = vec![[None; 3]; faces.len()];
    for (f, [a, b, c]) in faces.iter().enumerate() {
        for (k, [p, q]) in [[b, c], [c, a], [a, b]].into_iter().enumerate() {
            if let Some((g, l)) = first.insert([*p.min(q), *p.max(q)], (f, k)) {
                neighbours[f][k] = Some(g);
                neighbours[g][l] = Some(f);
            }
        }
    }
    neighbours
}
