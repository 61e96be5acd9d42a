//! Which of some nodes each of some places is nearest to.

use std::num::NonZero;

use glam::DVec3;
use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;

use crate::parallel;

/// Places asked for by one task.
const CHUNK: usize = 2048;

/// For each of `places` the number of the nearest of `nodes`, of which there is at least one; of those equally near the
/// lowest. O((n + m) log n); slower where many nodes share a coordinate.
pub(crate) fn nearest(nodes: &[DVec3], places: &[DVec3]) -> Vec<u32> {
    // Only the first node of each place goes into the search tree. Plus zero, to make -0 and 0 one place.
    let mut kept: Vec<([f64; 3], u32)> =
        (0_u32..).zip(nodes).map(|(i, &p)| ((p + DVec3::ZERO).to_array(), i)).collect();
    let key = |place: &([f64; 3], u32)| place.0.map(f64::to_bits);
    kept.sort_unstable_by_key(|place| (key(place), place.1));
    kept.dedup_by_key(|place| key(place));
    kept.sort_unstable_by_key(|place| place.1);
    let points: Vec<[f64; 3]> = kept.iter().map(|place| place.0).collect();
    let tree = ImmutableKdTree::<f64, u32, 3, 32>::new_from_slice(&points);
    let find = |place: &DVec3| {
        let place = place.to_array();
        let nearest = tree.nearest_one::<SquaredEuclidean>(&place);
        // Which of equally near nodes is found first is the search tree's affair.
        let lowest = tree
            .best_n_within::<SquaredEuclidean>(&place, nearest.distance, NonZero::<usize>::MIN)
            .next()
            .map_or(nearest.item, |best| best.item);
        kept[lowest as usize].1
    };
    let chunks: Vec<&[DVec3]> = places.chunks(CHUNK).collect();
    parallel::map(chunks.len(), |i| chunks[i].iter().map(find).collect::<Vec<u32>>()).concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Coordinates on a lattice of few steps, so that nodes coincide and tie.
    fn places(most: usize) -> impl Strategy<Value = Vec<DVec3>> {
        let place = [-3i32..4, -3i32..4, -3i32..4].prop_map(|p| DVec3::from_array(p.map(f64::from)) * 0.5);
        prop::collection::vec(place, 1..most)
    }

    proptest! {
        #[test]
        fn equals_brute_force(nodes in places(200), places in places(100)) {
            for (found, place) in nearest(&nodes, &places).into_iter().zip(places) {
                let first = (0..nodes.len())
                    .min_by(|&a, &b| nodes[a].distance_squared(place).total_cmp(&nodes[b].distance_squared(place)));
                prop_assert_eq!(Some(found as usize), first);
            }
        }
    }
}
