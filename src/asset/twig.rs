//! Twigs too thin for a budget's bark: what the cards of a bare tree show.

use super::cluster::Leaf;
use crate::Skeleton;
use crate::surface::Instance;
use glam::{Quat, Vec3};
use std::f32::consts::FRAC_1_SQRT_2;

/// The number of no [`Dress`](super::leaf::Dress): cards draw the wood itself.
pub(super) const NO_DRESS: u32 = u32::MAX;

/// The internodes without bark, to be grouped as leaves are; their upper side is up.
pub(super) fn all(skeleton: &Skeleton, bare: &[bool]) -> Vec<Leaf> {
    let (positions, radii) = (skeleton.positions(), skeleton.radii());
    let rotation = Quat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);
    let internodes = skeleton.edges().filter(|&(node, _)| bare[node] && radii[node] > 0.0);
    internodes
        .map(|(node, parent)| {
            let middle = positions[node].midpoint(positions[parent]);
            let area = 2.0 * radii[node] * positions[node].distance(positions[parent]);
            let copy = Instance { position: middle, rotation, node: node as u32, ..Instance::IDENTITY };
            Leaf { dress: NO_DRESS, copy, middle, area: area.max(Leaf::LEAST_AREA) }
        })
        .collect()
}

/// An internode that a card shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wood {
    pub(super) node: usize,
    pub(super) parent: usize,
    pub(super) ends: [Vec3; 2],
    pub(super) radius: f32,
}

impl Wood {
    fn length(&self) -> f32 {
        self.ends[0].distance(self.ends[1])
    }
}

/// The longest of these twigs, as many as have the area of all once none is thinner than `least`;
/// in the order of their nodes, and none without its parent. O(n log n).
pub(super) fn fewer(wood: &[Wood], least: f32) -> Vec<Wood> {
    let parent = |own: &Wood| wood.binary_search_by_key(&own.parent, |other| other.node).ok();
    // The longest way to a tip, own internode included, and the child that it goes through.
    let mut longest: Vec<f32> = wood.iter().map(Wood::length).collect();
    let mut heir = vec![usize::MAX; wood.len()];
    let mut beyond = vec![0.0f32; wood.len()];
    for (i, own) in wood.iter().enumerate().rev() {
        longest[i] += beyond[i];
        if let Some(parent) = parent(own).filter(|&parent| longest[i] > beyond[parent]) {
            (beyond[parent], heir[parent]) = (longest[i], i);
        }
    }
    // The internodes along a twig are ranked by the length of the whole twig.
    for (i, own) in wood.iter().enumerate() {
        if let Some(parent) = parent(own).filter(|&parent| heir[parent] == i) {
            longest[i] = longest[parent];
        }
    }
    let mut order: Vec<usize> = (0..wood.len()).collect();
    order.sort_by(|&i, &j| longest[j].total_cmp(&longest[i]).then(i.cmp(&j)));
    let mut area: f32 = wood.iter().map(|own| own.radius * own.length()).sum();
    let thick = |own: &Wood| Wood { radius: own.radius.max(least), ..*own };
    let kept = order.iter().take_while(|&&i| {
        let is_room = area > 0.0;
        area -= thick(&wood[i]).radius * wood[i].length();
        is_room
    });
    let mut kept: Vec<usize> = kept.copied().collect();
    kept.sort_unstable();
    kept.into_iter().map(|i| thick(&wood[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Internodes of random lengths and radii on random ones before them, or on what is no twig.
    fn twigs() -> impl Strategy<Value = Vec<Wood>> {
        let internode = (0.0f32..1.0, 0.1f32..1.0, 0.001f32..0.01);
        prop::collection::vec(internode, 1..60).prop_map(|internodes| {
            let wood = |(i, (place, length, radius)): (usize, (f32, f32, f32))| Wood {
                node: i + 1,
                parent: (place * (i + 1) as f32) as usize,
                ends: [Vec3::ZERO, Vec3::X * length],
                radius,
            };
            internodes.into_iter().enumerate().map(wood).collect()
        })
    }

    proptest! {
        #[test]
        fn fewer_twigs_hang_together_and_keep_the_area(wood in twigs(), least in 0.0f32..0.05) {
            let kept = fewer(&wood, least);
            let area = |wood: &[Wood]| wood.iter().map(|own| own.radius * own.length()).sum::<f32>();
            prop_assert!(kept.iter().all(|own| own.radius >= least));
            prop_assert!(kept.windows(2).all(|pair| pair[0].node < pair[1].node));
            for own in &kept {
                let is_borne = own.parent == 0 || kept.iter().any(|other| other.node == own.parent);
                prop_assert!(is_borne, "{own:?} hangs in the air");
            }
            // One internode more at the most.
            prop_assert!(area(&kept) >= 0.999 * area(&wood));
            let one = least.max(0.01);
            prop_assert!(area(&kept) <= 1.001 * area(&wood) + one);
            if least == 0.0 {
                prop_assert_eq!(kept.len(), wood.len());
            }
        }
    }
}
