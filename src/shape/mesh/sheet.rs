//! Triangles that enclose nothing: those that lie on one another, walls between solids, flat sheets beside a solid.

use glam::{DVec3, Vec3};

use super::prepare::{Patches, open_sides, sides};
use super::winding::Winding;
use super::{Bounds, Flaws};

/// Keeps one of the triangles with the same corners, or none if they are a wall.
///
/// An odd number of them count as one. An even number are either one sheet with two sides, as programs for
/// foliage write it, or the wall between two solids that share a face, or a face that was written twice. They
/// are judged together with those they hang together with: one of each stays if the surface has more borders
/// without them than with them, and goes if it has fewer. The side to which they face does not matter.
pub(super) fn single(triangles: &mut Vec<[u32; 3]>, flaws: &mut Flaws) {
    let key = |corners: &[u32; 3]| {
        let mut key = *corners;
        key.sort_unstable();
        key
    };
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    order.sort_unstable_by_key(|&triangle| (key(&triangles[triangle as usize]), triangle));
    let same = |&a: &u32, &b: &u32| key(&triangles[a as usize]) == key(&triangles[b as usize]);
    if order.chunk_by(same).all(|copies| copies.len() == 1) {
        return;
    }
    // The first of each, and how many there are.
    let mut firsts: Vec<(u32, usize)> =
        order.chunk_by(same).map(|copies| (copies[0], copies.len())).collect();
    firsts.sort_unstable();
    let kept: Vec<[u32; 3]> = firsts.iter().map(|&(first, _)| triangles[first as usize]).collect();
    let even = |triangle: u32| firsts[triangle as usize].1.is_multiple_of(2);
    let sides = sides(&kept);
    // Those of even number that hang together by sides.
    let mut groups = Groups::new(kept.len());
    for same in sides.chunk_by(|a, b| a.ends == b.ends) {
        let mut doubled = same.iter().map(|side| side.triangle).filter(|&triangle| even(triangle));
        if let Some(first) = doubled.next() {
            doubled.for_each(|other| groups.join(first, other));
        }
    }
    // Number of borders with a group less that without it; and `true` if it touches anything else.
    let mut borders = vec![0_i64; kept.len()];
    let mut touches = vec![false; kept.len()];
    for same in sides.chunk_by(|a, b| a.ends == b.ends) {
        let own = same.iter().filter(|side| even(side.triangle)).count();
        let Some(one) = same.iter().find(|side| even(side.triangle)) else { continue };
        let (group, others) = (groups.of(one.triangle) as usize, same.len() - own);
        borders[group] += (same.len() % 2) as i64 - (others % 2) as i64;
        touches[group] |= others > 0;
    }
    let alone = firsts.iter().all(|&(_, copies)| copies.is_multiple_of(2));
    *triangles = Vec::with_capacity(kept.len());
    for (number, (corners, &(_, copies))) in (0..).zip(kept.iter().zip(&firsts)) {
        let group = groups.of(number) as usize;
        let wall = copies.is_multiple_of(2) && borders[group] > 0;
        if !wall || alone {
            triangles.push(*corners);
            flaws.doubled += copies - 1;
        } else if !touches[group] {
            flaws.loose += 1;
            flaws.doubled += copies - 1;
        }
    }
}

/// Connected components of triangles.
struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    fn of(&mut self, mut triangle: u32) -> u32 {
        while self.parents[triangle as usize] != triangle {
            let above = self.parents[self.parents[triangle as usize] as usize];
            self.parents[triangle as usize] = above;
            triangle = above;
        }
        triangle
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}

/// The triangles of flat open patches, if the surface is closed without them and they enclose nothing together.
pub(super) fn loose(
    triangles: &[[u32; 3]],
    patches: &Patches,
    place: impl Fn(u32) -> Vec3,
) -> Option<Vec<bool>> {
    let mut loose = patches.open(triangles);
    if loose.iter().all(|&open| !open) || loose.iter().all(|&open| open) {
        return None;
    }
    // The plane of each patch's first triangle.
    let mut planes: Vec<Option<(DVec3, DVec3)>> = vec![None; patches.count];
    for (&patch, corners) in patches.of.iter().zip(triangles) {
        let [a, b, c] = corners.map(|corner| place(corner).as_dvec3());
        let (origin, normal) = *planes[patch as usize].get_or_insert_with(|| {
            let normal = (b - a).cross(c - a);
            (a, normal / normal.length().max(f64::MIN_POSITIVE))
        });
        let reach = [a, b, c].map(|corner| (corner - origin).length()).into_iter().fold(0.0, f64::max);
        let off = [a, b, c].map(|corner| (corner - origin).dot(normal).abs()).into_iter().fold(0.0, f64::max);
        loose[patch as usize] &= off <= 1e-4 * reach;
    }
    let loose: Vec<bool> = patches.of.iter().map(|&patch| loose[patch as usize]).collect();
    let part = |wanted: bool| {
        let chosen = triangles.iter().zip(&loose).filter(move |(_, loose)| **loose == wanted);
        chosen.map(|(corners, _)| *corners).collect::<Vec<_>>()
    };
    let (sheets, rest) = (part(true), part(false));
    if sheets.is_empty() || rest.is_empty() || open_sides(&rest) > 0 {
        return None;
    }
    let sheets: Vec<[Vec3; 3]> = sheets.into_iter().map(|corners| corners.map(&place)).collect();
    let bounds = Bounds::of(sheets.iter().flatten().copied());
    let winding = Winding::new(sheets);
    let mut encloses = false;
    crate::shape::lattice(bounds, super::CELLS, |point| encloses |= winding.number(point).abs() > 0.6);
    (!encloses).then_some(loose)
}
