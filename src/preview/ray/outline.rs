//! Extents of a solid, which its bounds give only roughly.

use super::octree::Cube;
use crate::Bounds;
use crate::surface::solid::{Coverage, Part, Solid};
use glam::Vec3;

/// Extents are found to within this part of the whole.
const FINENESS: f32 = 1.0 / 2048.0;
/// Cubes looked at for one direction, at most; what is flat would need one for each of its pieces.
const MOST: usize = 2000;

/// Primitives and operators looked at, at most: where hundred thousands meet at one place it stays rough.
const MOST_WORK: usize = 100_000_000;

/// A cube that the surface may pass, or that is all inside.
struct Found<P> {
    part: Option<P>,
    cube: Cube,
    /// Its children, once it has been split.
    children: Option<Vec<usize>>,
}

/// For each direction, a point of a cube that the solid reaches and beyond which it does not reach. Branch and bound: what
/// seems to reach farthest is split first.
pub(super) fn outline<S: Solid>(solid: &S, directions: &[Vec3]) -> Vec<Vec3> {
    let bounds = solid.bounds();
    let whole = Cube::around(bounds);
    let mut found: Vec<Found<S::Part>> = Vec::new();
    let add = |of: Option<&S::Part>, cube: Cube| match solid.part(of, cube.bounds()) {
        Coverage::Outside => None,
        Coverage::Inside => Some(Found { part: None, cube, children: None }),
        Coverage::Crossed(part) => Some(Found { part: Some(part), cube, children: None }),
    };
    found.extend(add(None, whole));
    let least = bounds.size().max_element() * FINENESS;
    // Primitives and operators looked at so far.
    let mut work = 0;
    let mut points = Vec::new();
    for &direction in directions {
        let reach = |cube: Cube| {
            let corner = farthest(cube, direction, bounds);
            (corner.dot(direction), -cube.side, corner)
        };
        let mut open: Vec<_> = (0..found.len().min(1)).map(|i| (reach(found[i].cube), i)).collect();
        for turn in 0.. {
            let best = open
                .iter()
                .enumerate()
                .max_by(|(_, (a, _)), (_, (b, _))| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let Some((at, &((_, _, corner), index))) = best else { break };
            if found[index].part.is_none()
                || found[index].cube.side <= least
                || turn == MOST
                || work > MOST_WORK
            {
                points.push(corner);
                break;
            }
            open.swap_remove(at);
            if found[index].children.is_none() {
                let Found { part, cube, .. } = &found[index];
                work += 8 * part.as_ref().map_or(0, Part::count);
                let fresh: Vec<_> = (0..8).filter_map(|i| add(part.as_ref(), cube.child(i))).collect();
                found[index].children = Some((found.len()..found.len() + fresh.len()).collect());
                found.extend(fresh);
            }
            let children = found[index].children.iter().flatten();
            open.extend(children.map(|&child| (reach(found[child].cube), child)));
        }
    }
    points
}

/// The corner of a cube, cut to the bounds, that is farthest in a direction.
fn farthest(cube: Cube, direction: Vec3, bounds: Bounds) -> Vec3 {
    let side = cube.bounds();
    Vec3::select(direction.cmpge(Vec3::ZERO), side.max, side.min).clamp(bounds.min, bounds.max)
}
