//! Rings that are no limbs.

use super::ground::Ground;
use super::heirs;
use super::limbs::Ring;

/// Undergrowth is no higher than this share of the tree, and than this, metres.
const UNDERGROWTH: f32 = 0.07;
const HIGHEST: f32 = 0.5;

/// Removes what leaves the tree near the ground and nowhere grows higher: grass and herbs that touch it. Twigs that hang down from above
/// stay, and so does all in a cloud without ground.
pub(super) fn without_undergrowth(rings: Vec<Ring>, ground: &Ground) -> Vec<Ring> {
    if !ground.is_found() {
        return rings;
    }
    let heights: Vec<f32> = rings.iter().map(|ring| ground.height(ring.center)).collect();
    let top = heights.iter().copied().fold(0.0, f32::max);
    let low = (UNDERGROWTH * top).min(HIGHEST);
    let mut highest = heights.clone();
    for (ring, own) in rings.iter().enumerate().rev() {
        if let Some(parent) = own.parent {
            highest[parent as usize] = highest[parent as usize].max(highest[ring]);
        }
    }
    let (mut kept, mut hangs) = (vec![true; rings.len()], vec![false; rings.len()]);
    for (ring, own) in rings.iter().enumerate() {
        let Some(parent) = own.parent.map(|parent| parent as usize) else { continue };
        hangs[ring] = heights[ring] <= low && (hangs[parent] || heights[parent] > low);
        kept[ring] = kept[parent] && (highest[ring] > low || hangs[ring]);
    }
    those(rings, &kept)
}

/// Removes laterals that hardly leave their limb: noise, bark, and the rims of forks.
pub(super) fn pruned(rings: Vec<Ring>, step: f32) -> Vec<Ring> {
    let count = rings.len();
    let heir = heirs(&rings);
    let mut kept = vec![true; count];
    // Distance from each ring to its farthest tip.
    let mut ahead = vec![0.0_f32; count];
    let mut members: Vec<usize> = rings.iter().map(|ring| ring.nodes.len()).collect();
    for ring in (1..count).rev() {
        let parent = rings[ring].parent.unwrap_or(0) as usize;
        let far = ahead[ring] + rings[ring].center.distance(rings[parent].center);
        ahead[parent] = ahead[parent].max(far);
        members[parent] += members[ring];
    }
    for ring in 1..count {
        let parent = rings[ring].parent.unwrap_or(0) as usize;
        let is_lateral = heir[parent] != Some(ring as u32);
        let far = ahead[ring] + rings[ring].center.distance(rings[parent].center);
        let short = far < 1.3 * rings[parent].spread + 2.0 * step || members[ring] < 4;
        kept[ring] = kept[parent] && !(is_lateral && short);
    }
    those(rings, &kept)
}

/// The rings that are kept, whose parents are too.
fn those(rings: Vec<Ring>, kept: &[bool]) -> Vec<Ring> {
    let mut number = vec![0_u32; rings.len()];
    let mut left = Vec::with_capacity(rings.len());
    for (ring, own) in rings.into_iter().enumerate() {
        if kept[ring] {
            number[ring] = left.len() as u32;
            left.push(Ring { parent: own.parent.map(|parent| number[parent as usize]), ..own });
        }
    }
    left
}
