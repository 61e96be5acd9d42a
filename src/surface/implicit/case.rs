//! The 256 ways in which a surface can pass between the corners of a cube.

use std::sync::LazyLock;

/// The surface in each case. Bit i of a case says that corner i is inside; corner `x + 2y + 4z` is at (x, y,
/// z).
pub(super) static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| (0..=255).map(Case::new).collect());

/// The triangles of the surface between the corners of a cube.
#[derive(Debug)]
pub(super) struct Case {
    /// Triangles, named by the cube's edges.
    pub(super) triangles: Vec<[u8; 3]>,
    /// Bit i says that the surface crosses edge i.
    pub(super) crossed: u16,
}

impl Case {
    fn new(case: u8) -> Self {
        let crossed = (0..).zip(EDGES).filter(|(_, [a, b])| (case >> a ^ case >> b) & 1 == 1);
        Self { triangles: triangles(case), crossed: crossed.fold(0, |bits, (edge, _)| bits | 1 << edge) }
    }
}

/// The two corners of an edge: four along x, then y, then z.
pub(super) const EDGES: [[u8; 2]; 12] = {
    let mut edges = [[0; 2]; 12];
    let mut edge = 0;
    while edge < 12 {
        let axis = edge / 4;
        let (low, high) = (edge as u8 & 1, (edge as u8 >> 1) & 1);
        // The corner on the lower side: the other two axes' bits.
        let corner = low << ((axis + 1) % 3) | high << ((axis + 2) % 3);
        edges[edge] = [corner, corner | 1 << axis];
        edge += 1;
    }
    edges
};

fn edge_between(a: u8, b: u8) -> u8 {
    let pair = [a.min(b), a.max(b)];
    EDGES.iter().position(|&edge| edge == pair).expect("neighbouring corners") as u8
}

/// The corners of each face, counter-clockwise seen from outside.
fn faces() -> [[u8; 4]; 6] {
    std::array::from_fn(|face| {
        let (axis, side) = (face / 2, (face % 2) as u8);
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let base = side << axis;
        if side == 1 {
            [base, base | u, base | u | v, base | v]
        } else {
            [base, base | v, base | u | v, base | u]
        }
    })
}

/// For each edge, the edge whose crossing follows around the surface's patches.
///
/// On each face the surface runs from the edge at which the face's border, counter-clockwise seen from
/// outside, leaves the inside to the edge at which it enters it. If two opposite corners are inside, they are
/// joined, whatever the cube: so two cubes agree on the face they share, and thin twigs hold together.
fn follow(case: u8) -> [Option<u8>; 12] {
    let inside = |corner: u8| case >> corner & 1 == 1;
    let mut next = [None; 12];
    for face in faces() {
        for i in 0..4 {
            let [a, b] = [face[i], face[(i + 1) % 4]];
            if inside(a) && !inside(b) {
                // The next entry along the border cuts off the outside corners between.
                let entry = (1..4)
                    .map(|step| [face[(i + step) % 4], face[(i + step + 1) % 4]])
                    .find(|&[a, b]| !inside(a) && inside(b))
                    .expect("who leaves comes in again");
                next[edge_between(entry[0], entry[1]) as usize] = Some(edge_between(a, b));
            }
        }
    }
    next
}

fn triangles(case: u8) -> Vec<[u8; 3]> {
    let mut next = follow(case);
    let mut found = Vec::new();
    for start in 0..12u8 {
        let mut patch = Vec::new();
        let mut edge = start;
        while let Some(following) = next[edge as usize].take() {
            patch.push(edge);
            edge = following;
        }
        if !patch.is_empty() {
            found.extend(divide(&patch).expect("every patch can be divided"));
        }
    }
    found
}

/// A patch in triangles without a diagonal that lies in a face of the cube, for the cube behind it might have the same.
fn divide(patch: &[u8]) -> Option<Vec<[u8; 3]>> {
    let [first, .., last] = *patch else { return Some(Vec::new()) };
    if patch.len() < 3 {
        return Some(Vec::new());
    }
    let free = |from: usize, to: usize| to - from == 1 || !share_face(patch[from], patch[to]);
    // The triangle on the side from the last to the first.
    (1..patch.len() - 1).filter(|&i| free(0, i) && free(i, patch.len() - 1)).find_map(|i| {
        let mut found = vec![[first, patch[i], last]];
        found.extend(divide(&patch[..=i])?);
        found.extend(divide(&patch[i..])?);
        Some(found)
    })
}

fn share_face(a: u8, b: u8) -> bool {
    let holds = |face: &[u8; 4], edge: u8| EDGES[edge as usize].iter().all(|corner| face.contains(corner));
    faces().iter().any(|face| holds(face, a) && holds(face, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each patch's border lies in the faces, and is the border of the triangles.
    #[test]
    fn every_case_has_patches_with_borders_in_the_faces_alone() {
        for case in 0..=255u8 {
            let mut sides: Vec<[u8; 2]> = Vec::new();
            let Case { triangles, crossed } = &CASES[case as usize];
            for [a, b, c] in triangles {
                sides.extend([[*a, *b], [*b, *c], [*c, *a]]);
            }
            let open: Vec<_> = sides.iter().filter(|[a, b]| !sides.contains(&[*b, *a])).collect();
            assert!(open.iter().all(|[a, b]| share_face(*a, *b)), "case {case}");
            assert!(sides.iter().filter(|side| !open.contains(side)).all(|[a, b]| !share_face(*a, *b)));
            assert_eq!(
                open.len(),
                crossed.count_ones() as usize,
                "case {case}: a crossing a border's corner"
            );
        }
    }

    /// Triangles face from the inside to the outside.
    #[test]
    fn one_corner_faces_outward() {
        for corner in 0..8u8 {
            let [triangle] = CASES[1 << corner as usize].triangles[..] else {
                panic!("one triangle around {corner}")
            };
            let place = |corner: u8| {
                glam::Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32)
            };
            let [a, b, c] = triangle.map(|edge| {
                let [low, high] = EDGES[edge as usize];
                (place(low) + place(high)) / 2.0
            });
            assert!((b - a).cross(c - a).dot(a - place(corner)) > 0.0);
        }
    }
}
