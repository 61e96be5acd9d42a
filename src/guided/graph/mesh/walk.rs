//! Straight ways on a surface, from one point to another.

use super::triangles::{NONE, Triangles};
use glam::Vec3;

/// Greatest ratio of a way on the surface to the edge's length.
const DETOUR: f32 = 1.5;
/// Triangles that a way may cross.
const MOST_STEPS: usize = 4096;

/// A point on a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) position: Vec3,
    pub(super) triangle: u32,
}

pub(super) struct Walk<'a> {
    pub(super) surface: &'a Triangles,
    /// Greatest distance of a way from the straight line between its ends, metres.
    pub(super) tolerance: f32,
}

impl Walk<'_> {
    /// `true` if the cut of the surface with the plane through both points and along `normal` leads
    /// from one to the other, near to the line between them.
    ///
    /// A corner on the plane counts as on its upper side. So every triangle has none or two sides that the plane
    /// crosses, whatever the rounding, and the way through triangles never branches.
    pub(super) fn leads(&self, from: Place, to: Place, normal: Vec3) -> bool {
        let way = to.position - from.position;
        let length = way.length();
        if length == 0.0 {
            return false;
        }
        let ahead = way / length;
        let Some(across) = ahead.cross(normal).try_normalize() else { return false };
        let above = |corner: Vec3| (corner - from.position).dot(across) >= 0.0;
        let mut triangle = from.triangle;
        let mut came_by = None;
        let (mut place, mut walked) = (from.position, 0.0);
        for _ in 0..MOST_STEPS {
            if triangle == to.triangle {
                return walked + place.distance(to.position) <= DETOUR * length;
            }
            let corners = self.surface.corners(triangle);
            let ups = corners.map(above);
            let mut best: Option<(f32, usize, Vec3)> = None;
            for side in (0..3).filter(|&side| Some(side) != came_by && ups[side] != ups[(side + 1) % 3]) {
                let (a, b) = (corners[side], corners[(side + 1) % 3]);
                let (da, db) = ((a - from.position).dot(across), (b - from.position).dot(across));
                // One is below 0, the other not, so they differ.
                let crossing = a.lerp(b, (da / (da - db)).clamp(0.0, 1.0));
                let progress = (crossing - from.position).dot(ahead);
                if best.is_none_or(|best| progress > best.0) {
                    best = Some((progress, side, crossing));
                }
            }
            let Some((progress, side, crossing)) = best else { return false };
            walked += place.distance(crossing);
            place = crossing;
            let off = (crossing - from.position - ahead * progress.clamp(0.0, length)).length();
            if off > self.tolerance || walked > DETOUR * length {
                return false;
            }
            let next = self.surface.beside(triangle, side);
            if next == NONE {
                return false;
            }
            came_by = self.surface.side_to(next, triangle);
            triangle = next;
        }
        false
    }
}
