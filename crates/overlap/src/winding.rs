//! Fans whose triangles wind around their vertex more than once.

use abf_mesh::{CornerId, VertexId};
use abf_parallel::prelude::*;

use crate::direction;
use crate::sheet::{Fan, PER_TASK, Sheet};

/// Whether the triangles of a fan, all counter-clockwise, wind around its vertex more than once.
///
/// A step from one edge of a counter-clockwise triangle to the next turns by less than π, so a full turn
/// is completed exactly where a step leads from the lower half plane to the upper one: counting those
/// steps counts turns without any rounding. A fan that closes must turn once; one on the boundary must
/// not turn further than once, which means that it may come back to its first edge, but not pass it.
#[must_use]
pub fn winds_twice(sheet: &Sheet<'_>, fan: Fan) -> bool {
    let centre = sheet.place(fan.first);
    let turns = sheet.fan_corners(fan).filter(|&c| completes_turn(sheet, c)).count();
    if fan.is_closed || turns != 1 {
        return turns > 1;
    }
    // Once across the positive x axis: a full turn if it ends beyond where it began.
    let (begin, end) = (sheet.place(fan.first.next()), sheet.place(fan.last.prev()));
    direction::compare(centre, begin, end).is_lt()
}

/// In how many corners at these vertices the step from one edge to the next leads from the lower half plane to the
/// upper one: the turns around all of them together, when all their triangles are counter-clockwise.
#[must_use]
pub fn turns(sheet: &Sheet<'_>, is_at: impl Fn(VertexId) -> bool + Sync) -> usize {
    let corners = (0..sheet.corner_count()).into_par_iter().with_min_len(PER_TASK).map(CornerId::new);
    corners.filter(|&c| is_at(sheet.vertex(c)) && completes_turn(sheet, c)).count()
}

/// Whether the step across a triangle, from one edge at this corner to the next, leads from the lower half plane around
/// the corner to the upper one.
#[inline]
fn completes_turn(sheet: &Sheet<'_>, corner: CornerId) -> bool {
    let centre = sheet.place(corner);
    !direction::is_upper(centre, sheet.place(corner.next())) && direction::is_upper(centre, sheet.place(corner.prev()))
}
