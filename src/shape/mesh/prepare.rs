//! Triangles as they come, made ready: welded, without slivers, turned to look outward.

use glam::{DVec3, Vec3};

use super::sheet;
use super::winding::{Winding, area_vector};
use super::{Flaws, TriangleMeshError};
use crate::shape::LARGEST;

/// Triangles that face outward, and the flaws that were found.
pub(super) struct Prepared {
    pub(super) triangles: Vec<[Vec3; 3]>,
    pub(super) flaws: Flaws,
    /// Cubic metres by the divergence theorem: exact if the surface is closed and does not cross itself.
    pub(super) volume: f64,
}

/// A side of a triangle, named by its ends, the lower first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    pub(super) ends: [u32; 2],
    pub(super) triangle: u32,
    /// `true` if the triangle goes from the end of lower number to that of higher.
    ascends: bool,
}

pub(super) fn prepare(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Prepared, TriangleMeshError> {
    for (vertex, &position) in positions.iter().enumerate() {
        if !position.abs().cmple(Vec3::splat(LARGEST)).all() {
            return Err(TriangleMeshError::Position { vertex, position });
        }
    }
    let vertices = positions.len();
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
            return Err(TriangleMeshError::Index { triangle, index, vertices });
        }
    }
    let names = weld(positions);
    let place = |index: u32| positions[index as usize];
    let welded = triangles.iter().map(|corners| corners.map(|index| names[index as usize]));
    let mut kept: Vec<[u32; 3]> =
        welded.filter(|&corners| area_vector(&corners.map(place)).length_squared() > 0.0).collect();
    let mut flaws = Flaws { without_area: triangles.len() - kept.len(), ..Flaws::default() };
    if kept.is_empty() {
        return Err(TriangleMeshError::Empty);
    }
    sheet::single(&mut kept, &mut flaws);
    let mut before = kept.clone();
    let mut patches = orient(&mut kept, place);
    if let Some(loose) = sheet::loose(&kept, &patches, place) {
        flaws.loose = loose.iter().filter(|&&loose| loose).count();
        let mut stays = loose.iter().map(|loose| !loose);
        let mut keep = || stays.next().unwrap_or(true);
        kept.retain(|_| keep());
        let mut stays = loose.iter().map(|loose| !loose);
        before.retain(|_| stays.next().unwrap_or(true));
        let mut stays = loose.iter().map(|loose| !loose);
        patches.of.retain(|_| stays.next().unwrap_or(true));
    }
    turn_outward(&mut kept, &patches, place);
    flaws.turned = kept.iter().zip(&before).filter(|(now, then)| now != then).count();
    flaws.open_sides = open_sides(&kept);
    let tip = place(kept[0][0]);
    let volume = kept.iter().map(|corners| signed_volume(corners.map(place), tip)).sum();
    Ok(Prepared { triangles: kept.into_iter().map(|corners| corners.map(place)).collect(), flaws, volume })
}

/// The first vertex in the place of each. O(n log n).
fn weld(positions: &[Vec3]) -> Vec<u32> {
    // Plus zero, to make -0 and 0 one place.
    let key = |vertex: u32| (positions[vertex as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| (key(vertex), vertex));
    let mut names = vec![0; positions.len()];
    let mut first = 0;
    for vertex in order {
        if key(first) != key(vertex) {
            first = vertex;
        }
        names[vertex as usize] = first.min(vertex);
    }
    names
}

/// The sides of all triangles; those between the same ends one after the other.
pub(super) fn sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides: Vec<Side> = (0_u32..)
        .zip(triangles)
        .flat_map(|(triangle, &[a, b, c])| {
            [(a, b), (b, c), (c, a)].map(|(from, to)| Side {
                ends: [from.min(to), from.max(to)],
                triangle,
                ascends: from < to,
            })
        })
        .collect();
    sides.sort_unstable();
    sides
}

/// Sides that as many triangles do not run down as run up, each as often as it is so.
pub(super) fn open_sides(triangles: &[[u32; 3]]) -> usize {
    sides(triangles).chunk_by(|a, b| a.ends == b.ends).map(unbalanced).sum()
}

/// Number of sides between two ends that run one way less those that run the other way.
fn unbalanced(same: &[Side]) -> usize {
    (2 * same.iter().filter(|side| side.ascends).count()).abs_diff(same.len())
}

/// Triangles that hang together by sides of two.
pub(super) struct Patches {
    /// The patch of each triangle.
    pub(super) of: Vec<u32>,
    pub(super) count: usize,
}

impl Patches {
    /// For each patch, `true` if it has sides at which it is not closed by itself.
    pub(super) fn open(&self, triangles: &[[u32; 3]]) -> Vec<bool> {
        let mut open = vec![false; self.count];
        let mut sides = sides(triangles);
        let of = |side: &Side| self.of[side.triangle as usize];
        sides.sort_unstable_by_key(|side| (side.ends, of(side), side.triangle, side.ascends));
        for same in sides.chunk_by(|a, b| a.ends == b.ends && of(a) == of(b)) {
            open[of(&same[0]) as usize] |= unbalanced(same) > 0;
        }
        open
    }
}

/// Turns the triangles of each patch to one side: the one that most of their area looks to.
fn orient(triangles: &mut [[u32; 3]], place: impl Fn(u32) -> Vec3) -> Patches {
    const NONE: u32 = u32::MAX;
    // For each triangle those beside it, and whether one of the two would have to turn.
    let mut beside = vec![[(NONE, false); 3]; triangles.len()];
    let mut add = |of: u32, other: u32, turns: bool| {
        if let Some(free) = beside[of as usize].iter_mut().find(|beside| beside.0 == NONE) {
            *free = (other, turns);
        }
    };
    for same in sides(triangles).chunk_by(|a, b| a.ends == b.ends) {
        if let [one, two] = same {
            add(one.triangle, two.triangle, one.ascends == two.ascends);
            add(two.triangle, one.triangle, one.ascends == two.ascends);
        }
    }
    let mut patches = Patches { of: vec![NONE; triangles.len()], count: 0 };
    let mut turned = vec![false; triangles.len()];
    for first in 0..triangles.len() {
        if patches.of[first] != NONE {
            continue;
        }
        let patch = patches.count as u32;
        patches.count += 1;
        patches.of[first] = patch;
        let mut found = vec![first as u32];
        let mut next = 0;
        let (mut all, mut against) = (0.0, 0.0);
        while let Some(&triangle) = found.get(next) {
            next += 1;
            let area = f64::from(area_vector(&triangles[triangle as usize].map(&place)).length());
            all += area;
            against += if turned[triangle as usize] { area } else { 0.0 };
            for &(other, turns) in beside[triangle as usize].iter().filter(|beside| beside.0 != NONE) {
                if patches.of[other as usize] == NONE {
                    patches.of[other as usize] = patch;
                    turned[other as usize] = turned[triangle as usize] != turns;
                    found.push(other);
                }
            }
        }
        for triangle in found {
            if turned[triangle as usize] != (against > 0.5 * all) {
                triangles[triangle as usize].swap(1, 2);
            }
        }
    }
    patches
}

/// Signed volume of the tetrahedron on a triangle, with its tip at `tip`.
fn signed_volume(triangle: [Vec3; 3], tip: Vec3) -> f64 {
    let [a, b, c]: [DVec3; 3] = triangle.map(|corner| (corner - tip).as_dvec3());
    a.dot(b.cross(c)) / 6.0
}

/// Turns all of it if it is inside out as a whole; then each closed patch that is, if it is no cavity of another.
fn turn_outward(triangles: &mut [[u32; 3]], patches: &Patches, place: impl Fn(u32) -> Vec3) {
    let tip = place(triangles[0][0]);
    let mut volumes = vec![0.0; patches.count];
    for (&patch, corners) in patches.of.iter().zip(triangles.iter()) {
        volumes[patch as usize] += signed_volume(corners.map(&place), tip);
    }
    if volumes.iter().sum::<f64>() < 0.0 {
        for corners in triangles.iter_mut() {
            corners.swap(1, 2);
        }
        for volume in &mut volumes {
            *volume = -*volume;
        }
    }
    if volumes.iter().all(|&volume| volume >= 0.0) {
        return;
    }
    let open = patches.open(triangles);
    let mut first = vec![None; patches.count];
    for (&patch, corners) in patches.of.iter().zip(triangles.iter()) {
        first[patch as usize].get_or_insert(corners[0]);
    }
    let outward =
        patches.of.iter().zip(triangles.iter()).filter(|&(&patch, _)| volumes[patch as usize] > 0.0);
    let around = Winding::new(outward.map(|(_, corners)| corners.map(&place)).collect());
    let turns: Vec<bool> = (0..patches.count)
        .map(|patch| {
            let inside_out = volumes[patch] < 0.0 && !open[patch];
            inside_out && first[patch].is_some_and(|corner| around.number(place(corner)) < 0.5)
        })
        .collect();
    for (&patch, corners) in patches.of.iter().zip(triangles) {
        if turns[patch as usize] {
            corners.swap(1, 2);
        }
    }
}
