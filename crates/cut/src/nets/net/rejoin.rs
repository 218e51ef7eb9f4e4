//! Nets that are left over, joined to a neighbour by way of one of its facets.
//!
//! A facet that was joined along its longest crease may bar the way for others: the sides of a notch touch each other once
//! they hang on the same face, but in a row they fit beside it. So a facet at the border of a neighbour is taken off and joined to
//! what is left over; where both together can be joined to the neighbour again, there is a net less.

use super::super::facets::{Facets, Fold};
use super::{Net, Nets};
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, FaceId, Point2, bounds};

/// Nets of more facets are not left over.
const MOST_FACETS: usize = 8;

/// A net less is worth this part of the border of what was left over, as more seam.
const WORTH: f64 = 0.25;

/// A net that is longer than so many sides of the square of its area is not made: it would waste a page.
const LONGEST: f64 = 3.0;

/// So many times all faces are looked at, at most.
const EFFORT: usize = 64;

/// What is tried with.
pub(crate) struct Creases<'f> {
    folds: &'f [Fold],
    /// Those before it are smooth.
    first: usize,
    /// By facet, its folds, ascending.
    of_facet: Vec<Vec<u32>>,
    faces_of_facet: Vec<Vec<FaceId>>,
    facet_of: &'f [u32],
    is_wanted: &'f dyn Fn(&Fold) -> bool,
}

impl<'f> Creases<'f> {
    /// Of folds those from `first` on for which `is_wanted` holds.
    pub(crate) fn new(
        folds: &'f [Fold],
        first: usize,
        facets: &'f Facets,
        is_wanted: &'f dyn Fn(&Fold) -> bool,
    ) -> Self {
        let facet_of = facets.of_face.as_slice();
        let mut of_facet = vec![Vec::new(); facets.sizes.len()];
        for (i, fold) in (0..).zip(folds) {
            for c in [fold.corner, fold.opposite] {
                of_facet[facet_of[c.face().index()] as usize].push(i);
            }
        }
        let mut faces_of_facet = vec![Vec::new(); facets.sizes.len()];
        (0..).zip(facet_of).for_each(|(f, &facet)| faces_of_facet[facet as usize].push(FaceId::new(f)));
        Self { folds, first, of_facet, faces_of_facet, facet_of, is_wanted }
    }

    /// The creases of some facets, in order.
    fn of(&self, facets: &[u32]) -> Vec<u32> {
        let all = facets.iter().flat_map(|&facet| &self.of_facet[facet as usize]).copied();
        let is_crease = |i: &u32| *i as usize >= self.first && (self.is_wanted)(&self.folds[*i as usize]);
        let mut creases: Vec<u32> = all.filter(is_crease).collect();
        creases.sort_unstable();
        creases.dedup();
        creases
    }

    /// The facets of some faces, ascending.
    fn facets(&self, faces: &[FaceId]) -> Vec<u32> {
        let mut facets: Vec<u32> = faces.iter().map(|f| self.facet_of[f.index()]).collect();
        facets.sort_unstable();
        facets.dedup();
        facets
    }
}

/// Two nets as they were.
struct Saved {
    nets: [(usize, Net); 2],
    places: Vec<(CornerId, Point2<f64>, bool)>,
}

impl Nets<'_> {
    /// Joins what is left over to its neighbours, the smallest first, until nothing can be or enough was tried.
    pub(crate) fn rejoin(&mut self, creases: &Creases<'_>, checkpoint: &mut Checkpoint<'_>) -> Result<(), Cancelled> {
        let mut effort = EFFORT * self.net_of.len();
        loop {
            let mut left: Vec<usize> = (0..self.nets.len()).filter(|&net| !self.nets[net].faces.is_empty()).collect();
            left.sort_by_key(|&net| (self.nets[net].faces.len(), net));
            let mut is_any = false;
            for net in left {
                checkpoint()?;
                is_any |= self.rejoin_one(net, creases, &mut effort);
            }
            if !is_any || effort == 0 {
                return Ok(());
            }
        }
    }

    fn rejoin_one(&mut self, net: usize, creases: &Creases<'_>, effort: &mut usize) -> bool {
        let facets = creases.facets(&self.nets[net].faces);
        if facets.is_empty() || facets.len() > MOST_FACETS {
            return false;
        }
        for i in creases.of(&facets) {
            let fold = creases.folds[i as usize];
            let sides = [fold.corner, fold.opposite].map(|c| self.net_of[c.face().index()] as usize);
            let (beyond, neighbour) = if sides[0] == net { (fold.opposite, sides[1]) } else { (fold.corner, sides[0]) };
            let facet = creases.facet_of[beyond.face().index()];
            if neighbour == net || self.nets[neighbour].faces.len() == creases.faces_of_facet[facet as usize].len() {
                continue;
            }
            let work = self.nets[neighbour].faces.len() + self.nets[net].faces.len();
            if *effort < work {
                *effort = 0;
                return false;
            }
            *effort -= work;
            if self.try_with(facet, &fold, (net, neighbour), creases) {
                return true;
            }
        }
        false
    }

    /// Takes a facet off the neighbour, joins it to the net along a fold, and both to the neighbour; or leaves all as it was.
    fn try_with(&mut self, facet: u32, fold: &Fold, (net, neighbour): (usize, usize), creases: &Creases<'_>) -> bool {
        let faces = &creases.faces_of_facet[facet as usize];
        let of_facet = &creases.of_facet[facet as usize];
        let is_held = |i: &u32| self.welded[creases.folds[*i as usize].corner.index()];
        let held: Vec<u32> = of_facet.iter().copied().filter(is_held).collect();
        let may_go = held.iter().all(|&i| i as usize >= creases.first);
        if !may_go || !self.stays_connected(neighbour, facet, creases) {
            return false;
        }
        let border = self.border(net);
        let both: Vec<u32> = creases.facets(&[self.nets[net].faces.as_slice(), faces].concat());
        let around = creases.of(&both);
        let before = self.joined_length(&around, creases);
        let saved = self.save((net, neighbour), faces, &held, creases);
        self.take_off(faces, neighbour, &held, creases);
        self.revive(&around, creases);
        if self.join(fold) {
            for i in around.iter().map(|&i| i as usize) {
                let sides = [creases.folds[i].corner, creases.folds[i].opposite].map(|c| self.net_of[c.face().index()]);
                if sides[0] != sides[1] && sides.contains(&(neighbour as u32)) && self.join(&creases.folds[i]) {
                    let is_cheap = before - self.joined_length(&around, creases) <= WORTH * border;
                    if is_cheap && self.is_compact(self.net_of[fold.corner.face().index()] as usize) {
                        return true;
                    }
                    break;
                }
            }
        }
        self.restore(saved);
        false
    }

    /// Whether a net is still connected without one of its facets.
    fn stays_connected(&mut self, net: usize, without: u32, creases: &Creases<'_>) -> bool {
        self.searches += 1;
        let Self { topology, welded, nets, seen, searches, .. } = self;
        let is_left = |f: FaceId| creases.facet_of[f.index()] != without;
        let faces = &nets[net].faces;
        let Some(&start) = faces.iter().find(|f| is_left(**f)) else { return false };
        let mut reached = 0;
        let mut open = vec![start];
        seen[start.index()] = *searches;
        while let Some(f) = open.pop() {
            reached += 1;
            for c in f.corners().into_iter().filter(|c| welded[c.index()]) {
                let next = topology.opposite(c).map(CornerId::face).filter(|&g| is_left(g));
                open.extend(next.filter(|g| std::mem::replace(&mut seen[g.index()], *searches) != *searches));
            }
        }
        reached == faces.iter().filter(|f| is_left(**f)).count()
    }

    /// Whether a net is not too long for its area.
    fn is_compact(&self, net: usize) -> bool {
        let faces = &self.nets[net].faces;
        let place = |c: CornerId| self.layout[c.index()];
        let Some((low, high)) = bounds(faces.iter().flat_map(|f| f.corners()).map(place)) else { return true };
        let area = |f: &FaceId| {
            let [p, q, r] = f.corners().map(place);
            0.5 * (q - p).perp(&(r - p)).abs()
        };
        (high - low).norm() <= LONGEST * faces.iter().map(area).sum::<f64>().sqrt()
    }

    /// The length of the border of a net.
    fn border(&self, net: usize) -> f64 {
        let corners = self.nets[net].faces.iter().flat_map(|f| f.corners());
        let length = |c: CornerId| {
            let [p, q] = self.segment(c);
            (q - p).norm()
        };
        corners.filter(|c| !self.welded[c.index()]).map(length).sum()
    }

    /// The length of those folds that are joined.
    fn joined_length(&self, folds: &[u32], creases: &Creases<'_>) -> f64 {
        let folds = folds.iter().map(|&i| &creases.folds[i as usize]);
        folds.filter(|fold| self.welded[fold.corner.index()]).map(|fold| fold.length).sum()
    }

    fn save(&self, (net, neighbour): (usize, usize), faces: &[FaceId], held: &[u32], creases: &Creases<'_>) -> Saved {
        let (own, others) = (&self.nets[net].faces, &self.nets[neighbour].faces);
        // The smaller of two nets is moved.
        let moved_too = if others.len() <= own.len() + 2 * faces.len() { others.as_slice() } else { faces };
        let moved = own.iter().chain(moved_too).flat_map(|f| f.corners());
        let sides = held.iter().map(|&i| creases.folds[i as usize]).flat_map(|fold| [fold.corner, fold.opposite]);
        let mut corners: Vec<CornerId> = moved.chain(sides).collect();
        // The other sides of all edges that may be joined.
        let beyond: Vec<CornerId> = corners.iter().filter_map(|&c| self.topology.opposite(c)).collect();
        corners.extend(beyond);
        let places = corners.into_iter().map(|c| (c, self.layout[c.index()], self.welded[c.index()])).collect();
        let nets = [net, neighbour].map(|net| (net, self.nets[net].clone()));
        Saved { nets, places }
    }

    fn restore(&mut self, saved: Saved) {
        for (net, was) in saved.nets {
            was.faces.iter().for_each(|f| self.net_of[f.index()] = net as u32);
            self.nets[net] = was;
        }
        for (c, place, is_welded) in saved.places {
            self.layout[c.index()] = place;
            self.welded[c.index()] = is_welded;
        }
        self.nets.pop();
    }

    /// Makes a net of its own of a facet.
    fn take_off(&mut self, faces: &[FaceId], from: usize, held: &[u32], creases: &Creases<'_>) {
        for fold in held.iter().map(|&i| &creases.folds[i as usize]) {
            self.welded[fold.corner.index()] = false;
            self.welded[fold.opposite.index()] = false;
        }
        let own = self.nets.len();
        faces.iter().for_each(|f| self.net_of[f.index()] = own as u32);
        let left = self.nets[from].faces.iter().copied().filter(|f| self.net_of[f.index()] == from as u32).collect();
        self.nets.push(Net::default());
        self.fill(from, left);
        self.fill(own, faces.to_vec());
    }

    fn fill(&mut self, net: usize, faces: Vec<FaceId>) {
        self.nets[net] = Net::default();
        for c in faces.iter().flat_map(|f| f.corners()) {
            if !self.welded[c.index()] {
                self.add_to_rim(net, c);
            }
        }
        self.nets[net].faces = faces;
    }

    /// Creases that could not be joined may be after a net has become smaller.
    fn revive(&mut self, around: &[u32], creases: &Creases<'_>) {
        for fold in around.iter().map(|&i| &creases.folds[i as usize]) {
            self.dead[fold.corner.index()] = false;
            self.dead[fold.opposite.index()] = false;
        }
    }
}
