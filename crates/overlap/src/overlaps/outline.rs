//! The boundary of a map as segments between spots of the plane.

use crate::box_tree::Extent;
use crate::sheet::Sheet;
use abf_mesh::{CornerId, FaceId, Point2};

/// Marks a UV point that is not on the boundary.
const NONE: u32 = u32::MAX;

/// The boundary: spots are different places, segments different pairs of spots.
pub(super) struct Outline {
    /// The places of the ends of segments, each once, from left to right, then from below.
    pub(super) spots: Vec<Point2<f64>>,
    /// The segments, ordered by their spots.
    pub(super) segments: Vec<Segment>,
    spot_of_point: Vec<u32>,
}

/// A piece of boundary between two spots, with all the edges that lie there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// The end that comes first among the spots.
    pub(super) low: u32,
    /// The other end.
    pub(super) high: u32,
    /// Faces on the left, seen from `low` to `high`.
    pub(super) left: Side,
    /// Faces on the right.
    pub(super) right: Side,
}

/// The faces on one side of a segment: the first two, since two are too many already.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Side {
    /// How many.
    pub(super) count: u32,
    /// The first two.
    pub(super) faces: [Option<FaceId>; 2],
}

impl Side {
    fn add(&mut self, face: FaceId) {
        if let Some(free) = self.faces.iter_mut().find(|free| free.is_none()) {
            *free = Some(face);
        }
        self.count += 1;
    }
}

impl Segment {
    /// A face of it.
    pub(super) fn face(&self) -> Option<FaceId> {
        self.left.faces[0].or(self.right.faces[0])
    }
}

impl Outline {
    /// The boundary of a sheet. Edges without length are left out: nothing lies beside them.
    pub(super) fn new(sheet: &Sheet<'_>) -> Self {
        let mut spot_of_point = vec![NONE; sheet.point_count()];
        for c in sheet.boundary() {
            [c.next(), c.prev()].into_iter().for_each(|c| spot_of_point[sheet.point(c).index()] = 0);
        }
        let mut points: Vec<(Point2<f64>, u32)> = (0..sheet.point_count())
            .filter(|&p| spot_of_point[p] != NONE)
            .map(|p| (sheet.place_of(abf_mesh::UvId::new(p)), p as u32))
            .collect();
        points.sort_unstable_by(|(a, i), (b, j)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(i.cmp(j)));
        let mut spots: Vec<Point2<f64>> = Vec::new();
        for (place, point) in points {
            if spots.last() != Some(&place) {
                spots.push(place);
            }
            spot_of_point[point as usize] = spots.len() as u32 - 1;
        }
        let mut edges: Vec<(u32, u32, u32, bool)> = sheet
            .boundary()
            .filter_map(|c| {
                let [from, to] = [c.next(), c.prev()].map(|c| spot_of_point[sheet.point(c).index()]);
                (from != to).then(|| (from.min(to), from.max(to), c.index() as u32, from < to))
            })
            .collect();
        edges.sort_unstable();
        let segments = edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).map(segment).collect();
        Self { spots, segments, spot_of_point }
    }

    /// The place of a spot.
    pub(super) fn place(&self, spot: u32) -> Point2<f64> {
        self.spots[spot as usize]
    }

    /// The box of a segment.
    pub(super) fn extent(&self, segment: u32) -> Extent {
        let segment = &self.segments[segment as usize];
        Extent::around(self.place(segment.low), self.place(segment.high))
    }

    /// The spot of a corner on the boundary.
    pub(super) fn spot(&self, sheet: &Sheet<'_>, corner: CornerId) -> u32 {
        self.spot_of_point[sheet.point(corner).index()]
    }
}

/// All edges between two spots.
fn segment(edges: &[(u32, u32, u32, bool)]) -> Segment {
    let (low, high, ..) = edges[0];
    let mut segment = Segment { low, high, left: Side::default(), right: Side::default() };
    for &(_, _, corner, is_upwards) in edges {
        let side = if is_upwards { &mut segment.left } else { &mut segment.right };
        side.add(CornerId::new(corner as usize).face());
    }
    segment
}
