//! Things far from the origin: their surfaces are made near it and moved back.
//!
//! Steps between 32-bit floats grow with the coordinate: at 10 km they are 1 mm, at 454 km 3 cm. Every
//! computation there is as coarse, and errors add up. Far things are therefore moved near the origin first,
//! which rounds nothing, and their surface is rounded once, on its way back.

use super::mesh::has_area;
use super::{Mesh, SurfaceError};
use crate::{Bounds, Skeleton};
use glam::{DVec3, Vec3};
use std::borrow::Cow;

/// A thing farther than this many of its own sizes from the origin along an axis is moved; from 2 on that
/// rounds nothing (Sterbenz 1974).
const FAR: f32 = 4.0;
/// Farther out than this, in metres, nothing is computed.
const FARTHEST: f32 = 1e9;
/// The largest share of a surface whose triangles may be turned over or lose their area when its vertices are rounded.
const MOST_LOST: f64 = 0.02;
/// Number of rounds in which vertices are moved to give flat triangles an area.
const TRIES: usize = 8;

/// The offset that is subtracted from a thing within `bounds` so that it lies near the origin: on each axis
/// the coordinate of `at`, a point within its box, or 0 where it is near.
pub(super) fn offset(at: Vec3, bounds: Bounds) -> Vec3 {
    let size = bounds.size().max_element();
    if !bounds.is_finite() || bounds.min.abs().max(bounds.max.abs()).max_element() > FARTHEST {
        return Vec3::ZERO;
    }
    Vec3::select(at.abs().cmpgt(Vec3::splat(FAR * size)), at, Vec3::ZERO)
}

/// The offset that is subtracted from a skeleton: coordinates of its root.
pub(super) fn offset_of(skeleton: &Skeleton) -> Vec3 {
    let widest = skeleton.radii().iter().copied().fold(0.0, f32::max);
    let nodes = Bounds::of(skeleton.positions().iter().copied());
    offset(skeleton.positions()[0], Bounds::new(nodes.min - widest, nodes.max + widest))
}

/// `true` if a skeleton is moved near the origin.
pub(crate) fn is_far(skeleton: &Skeleton) -> bool {
    offset_of(skeleton) != Vec3::ZERO
}

/// The skeleton less the offset.
pub(super) fn near(skeleton: &Skeleton, offset: Vec3) -> Cow<'_, Skeleton> {
    if offset == Vec3::ZERO {
        return Cow::Borrowed(skeleton);
    }
    let positions = skeleton.positions().iter().map(|&position| position - offset).collect();
    skeleton.clone().with_positions(positions).map_or(Cow::Borrowed(skeleton), Cow::Owned)
}

/// Adds the offset to an open mesh. Triangles that are left without an area are left out.
pub(super) fn back_open(mut mesh: Mesh, offset: Vec3) -> Result<Mesh, SurfaceError> {
    if offset == Vec3::ZERO {
        return Ok(mesh);
    }
    let before = moved(&mut mesh, offset);
    check(&before, &mesh, offset)?;
    let positions = &mesh.positions;
    let (mut kept, mut indices) = (0, std::mem::take(&mut mesh.indices));
    for start in (0..indices.len()).step_by(3) {
        if has_area(corners(positions, &indices[start..start + 3])) {
            indices.copy_within(start..start + 3, kept);
            kept += 3;
        }
    }
    indices.truncate(kept);
    mesh.indices = indices;
    Ok(mesh)
}

/// Adds the offset to a closed mesh. It stays closed: where a triangle is left without an area, one of its vertices takes the next
/// place that floats have.
pub(super) fn back_closed(mut mesh: Mesh, offset: Vec3) -> Result<Mesh, SurfaceError> {
    if offset == Vec3::ZERO {
        return Ok(mesh);
    }
    let before = moved(&mut mesh, offset);
    check(&before, &mesh, offset)?;
    give_area(&mut mesh);
    check(&before, &mesh, offset)?;
    if mesh.triangles().all(|triangle| has_area(triangle.map(|i| mesh.positions[i as usize]))) {
        Ok(mesh)
    } else {
        Err(shapeless(&before, &mesh, offset))
    }
}

/// Moves the vertices, and returns where they were.
fn moved(mesh: &mut Mesh, offset: Vec3) -> Vec<Vec3> {
    let there = mesh.positions.iter().map(|&position| position + offset).collect();
    std::mem::replace(&mut mesh.positions, there)
}

fn corners(positions: &[Vec3], indices: &[u32]) -> [Vec3; 3] {
    [0, 1, 2].map(|i| positions[indices[i] as usize])
}

/// The share of the surface whose triangles were turned over or have lost their area.
fn lost(before: &[Vec3], mesh: &Mesh) -> f64 {
    let (mut all, mut lost) = (0.0, 0.0);
    let area = |corners: [Vec3; 3]| {
        let [a, b, c]: [DVec3; 3] = corners.map(Vec3::as_dvec3);
        (b - a).cross(c - a)
    };
    for triangle in mesh.indices.chunks_exact(3) {
        let [then, now] = [before, &mesh.positions].map(|positions| area(corners(positions, triangle)));
        let size = then.length();
        all += size;
        if then.dot(now) <= 0.0 {
            lost += size;
        }
    }
    if all > 0.0 { lost / all } else { 0.0 }
}

fn check(before: &[Vec3], mesh: &Mesh, offset: Vec3) -> Result<(), SurfaceError> {
    if lost(before, mesh) <= MOST_LOST { Ok(()) } else { Err(shapeless(before, mesh, offset)) }
}

fn shapeless(before: &[Vec3], mesh: &Mesh, offset: Vec3) -> SurfaceError {
    SurfaceError::Shapeless { position: offset, step: step(offset), lost: lost(before, mesh) as f32 }
}

/// Distance between a coordinate and the next 32-bit float, the greatest of the three axes.
pub(crate) fn step(position: Vec3) -> f32 {
    let most = position.abs().max_element();
    most.next_up() - most
}

/// Moves vertices by one step where triangles have no area.
fn give_area(mesh: &mut Mesh) {
    let is_flat = |positions: &[Vec3], triangle: usize| {
        !has_area(corners(positions, &mesh.indices[3 * triangle..3 * triangle + 3]))
    };
    let mut flat: Vec<usize> =
        (0..mesh.indices.len() / 3).filter(|&triangle| is_flat(&mesh.positions, triangle)).collect();
    if flat.is_empty() {
        return;
    }
    let around = Around::new(mesh.positions.len(), &mesh.indices);
    for _ in 0..TRIES {
        for &triangle in &flat {
            if !is_flat(&mesh.positions, triangle) {
                continue;
            }
            let mut best = None;
            for corner in 3 * triangle..3 * triangle + 3 {
                let vertex = mesh.indices[corner] as usize;
                let home = mesh.positions[vertex];
                let count = |positions: &[Vec3]| {
                    around
                        .of(vertex)
                        .iter()
                        .filter(|&&triangle| is_flat(positions, triangle as usize))
                        .count()
                };
                let now = count(&mesh.positions);
                for place in neighbours(home) {
                    mesh.positions[vertex] = place;
                    let rest = count(&mesh.positions);
                    if rest < best.map_or(now, |(least, _, _)| least) {
                        best = Some((rest, vertex, place));
                    }
                }
                mesh.positions[vertex] = home;
            }
            if let Some((_, vertex, place)) = best {
                mesh.positions[vertex] = place;
            }
        }
        flat.retain(|&triangle| is_flat(&mesh.positions, triangle));
    }
}

/// The places one step away along each axis: the next float, but at least a 64th of the step of the largest
/// coordinate.
fn neighbours(place: Vec3) -> [Vec3; 6] {
    let least = step(place) / 64.0;
    std::array::from_fn(|i| {
        let (axis, mut there) = (i / 2, place);
        let at = place[axis];
        there[axis] = if i % 2 == 0 { at.next_up().max(at + least) } else { at.next_down().min(at - least) };
        there
    })
}

/// The triangles around each vertex.
struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(vertices: usize, indices: &[u32]) -> Self {
        let mut starts = vec![0u32; vertices + 1];
        for &vertex in indices {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut free = starts.clone();
        let mut triangles = vec![0; indices.len()];
        for (corner, &vertex) in indices.iter().enumerate() {
            triangles[free[vertex as usize] as usize] = (corner / 3) as u32;
            free[vertex as usize] += 1;
        }
        Self { starts, triangles }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.triangles[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_near_stays() {
        let tree = Bounds::new(Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 20.0, 5.0));
        assert_eq!(offset(Vec3::ZERO, tree), Vec3::ZERO);
        let beside = tree.translated(Vec3::X * 60.0);
        assert_eq!(offset(Vec3::X * 60.0, beside), Vec3::ZERO);
        let far = tree.translated(Vec3::new(454_000.0, 812.0, 0.0));
        assert_eq!(offset(Vec3::new(454_000.0, 812.0, 0.0), far), Vec3::new(454_000.0, 812.0, 0.0));
    }

    proptest! {
        #[test]
        fn nothing_is_rounded_on_the_way(
            at in [-1e7f32..1e7, -1e7f32..1e7, -1e7f32..1e7].prop_map(Vec3::from_array),
            ways in proptest::collection::vec([-3f32..3.0, -3f32..3.0, -3f32..3.0].prop_map(Vec3::from_array), 1..20),
        ) {
            let points: Vec<Vec3> = std::iter::once(at).chain(ways.iter().map(|way| at + *way)).collect();
            let offset = offset(at, Bounds::of(points.iter().copied()));
            for point in points {
                prop_assert_eq!((point - offset).as_dvec3(), point.as_dvec3() - offset.as_dvec3());
                prop_assert_eq!((point - offset) + offset, point);
            }
        }
    }

    #[test]
    fn triangles_get_an_area() {
        // Three vertices in a row, closed by two more.
        let at = Vec3::new(454_000.0, 0.0, 0.0);
        let step = step(at);
        let ways = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::new(1.0, 40.0, 0.0), Vec3::new(1.0, 0.0, 40.0)];
        let positions: Vec<Vec3> = ways.iter().map(|&way| at + way * step).collect();
        let indices = vec![0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 4, 3, 0, 4, 4, 0, 2];
        let mut mesh = Mesh::new(positions, vec![Vec3::Y; 5], indices);
        let flat = |mesh: &Mesh| {
            mesh.triangles().filter(|t| !has_area(t.map(|i| mesh.positions[i as usize]))).count()
        };
        assert_eq!(flat(&mesh), 1);
        give_area(&mut mesh);
        assert_eq!(flat(&mesh), 0);
    }
}
