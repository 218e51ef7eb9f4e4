//! Walks over a map, by which two faces that lie over each other are taken apart.

use abf_cut::FaceWalks;
use abf_mesh::{FaceId, UvId, UvMap, Vector2};
use std::collections::HashMap;

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
