//! Shoots in the deepest shade die, and with them the wood that bears nothing else.

use super::draw::Draw;
use super::wood::{Rank, Wood};
use glam::Vec3;

/// Share of a layer's shade that reaches the next lower one.
const THROUGH: f32 = 0.82;

/// A limb needs this part of the usual number of shoots per metre.
const STARVED: f32 = 0.25;

/// The tree without the shadiest part of its shoots.
pub(super) fn shed(wood: Wood, part: f32, mut draw: Draw) -> Wood {
    let shoots: Vec<usize> = bases(&wood);
    if part <= 0.0 || shoots.len() < 20 {
        return wood;
    }
    let shade = shades(&wood, &shoots);
    let mut ranked: Vec<(f32, usize)> =
        shoots.iter().zip(&shade).map(|(&node, &shade)| (shade * draw.within([0.75, 1.25]), node)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let dead = (ranked.len() as f32 * part) as usize;
    let mut falls = vec![false; wood.positions.len()];
    for (_, node) in &ranked[..dead] {
        falls[*node] = true;
    }
    // A shoot falls as a whole; what is left without shoots follows.
    let mut stays = vec![false; wood.positions.len()];
    for node in 1..wood.positions.len() {
        let parent = wood.parents[node] as usize;
        if wood.ranks[node] == Rank::Shoot && wood.ranks[parent] == Rank::Shoot && falls[parent] {
            falls[node] = true;
        }
        stays[node] = wood.ranks[node] == Rank::Stem || (wood.ranks[node] == Rank::Shoot && !falls[node]);
    }
    stays[0] = true;
    for node in (1..wood.positions.len()).rev() {
        if stays[node] {
            stays[wood.parents[node] as usize] = true;
        }
    }
    starve(&wood, &mut stays);
    let mut number = vec![0u32; wood.positions.len()];
    let mut left = Wood::default();
    for node in 0..wood.positions.len() {
        if stays[node] {
            let parent = number[wood.parents[node] as usize];
            number[node] = left.push(wood.positions[node], parent, wood.orders[node], wood.ranks[node]);
        }
    }
    left
}

/// Limbs that are left with few shoots for their length fall too: whips that no tree keeps.
fn starve(wood: &Wood, stays: &mut [bool]) {
    // Each node's limb, by the limb's first node.
    let count = wood.positions.len();
    let (mut limb, mut shoots, mut length) = (vec![0usize; count], vec![0.0f32; count], vec![0.0f32; count]);
    for node in (1..count).filter(|&node| stays[node] && wood.ranks[node] != Rank::Stem) {
        let parent = wood.parents[node] as usize;
        limb[node] = if wood.ranks[parent] == Rank::Stem { node } else { limb[parent] };
        match wood.ranks[node] {
            Rank::Limb => length[limb[node]] += wood.positions[node].distance(wood.positions[parent]),
            Rank::Shoot => shoots[limb[node]] += 1.0,
            _ => {}
        }
    }
    let bases: Vec<usize> = (1..count).filter(|&node| limb[node] == node && length[node] > 0.0).collect();
    let mut dense: Vec<f32> = bases.iter().map(|&base| shoots[base] / length[base]).collect();
    if dense.is_empty() {
        return;
    }
    dense.sort_by(f32::total_cmp);
    let least = STARVED * dense[dense.len() / 2];
    for node in 1..count {
        let base = limb[node];
        if base > 0 && length[base] > 0.0 && shoots[base] / length[base] < least {
            stays[node] = false;
        }
    }
}

/// The first node of each shoot.
fn bases(wood: &Wood) -> Vec<usize> {
    (1..wood.positions.len())
        .filter(|&node| {
            wood.ranks[node] == Rank::Shoot && wood.ranks[wood.parents[node] as usize] != Rank::Shoot
        })
        .collect()
}

/// The shade at each shoot: shoots above it, the nearer the more.
fn shades(wood: &Wood, shoots: &[usize]) -> Vec<f32> {
    let place = |node: usize| wood.positions[node];
    let low = shoots.iter().map(|&node| place(node)).fold(Vec3::INFINITY, Vec3::min);
    let high = shoots.iter().map(|&node| place(node)).fold(Vec3::NEG_INFINITY, Vec3::max);
    let extent = high - low;
    let cell = (extent.max_element() / 40.0).max(0.05);
    let size = (extent / cell).floor().as_ivec3() + 1;
    let [nx, ny, nz] = [size.x as usize + 2, size.y as usize, size.z as usize + 2];
    let index = |point: Vec3| {
        let at = ((point - low) / cell).floor().as_ivec3();
        let [x, y, z] = [
            at.x.min(size.x - 1) as usize + 1,
            at.y.min(size.y - 1) as usize,
            at.z.min(size.z - 1) as usize + 1,
        ];
        (y, z * nx + x)
    };
    let layer = nx * nz;
    let mut count = vec![0.0f32; layer * ny];
    for &node in shoots {
        let (y, at) = index(place(node));
        count[y * layer + at] += 1.0;
    }
    let mut shade = vec![0.0f32; layer * ny];
    let mut above = vec![0.0f32; layer];
    for y in (0..ny).rev() {
        shade[y * layer..(y + 1) * layer].copy_from_slice(&above);
        let sum: Vec<f32> = (0..layer).map(|at| above[at] * THROUGH + count[y * layer + at]).collect();
        for z in 1..nz - 1 {
            for x in 1..nx - 1 {
                let at = z * nx + x;
                let ring = sum[at - 1] + sum[at + 1] + sum[at - nx] + sum[at + nx];
                above[at] = 0.5 * sum[at] + 0.125 * ring;
            }
        }
    }
    shoots
        .iter()
        .map(|&node| {
            let (y, at) = index(place(node));
            // Half of its own layer is above it.
            shade[y * layer + at] + 0.5 * count[y * layer + at]
        })
        .collect()
}
