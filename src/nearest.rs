//! Nearest nodes of many places.

use std::num::NonZero;

use glam::DVec3;
use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;

use crate::parallel;

/// Places searched by one task.
const CHUNK: usize = 2048;

/// The first node of each place: only these go into a search tree.
fn places_of(nodes: &[DVec3]) -> Vec<([f64; 3], u32)> {
    // Plus zero, to make -0 and 0 one place.
    let mut kept: Vec<([f64; 3], u32)> =
        (0_u32..).zip(nodes).map(|(i, &p)| ((p + DVec3::ZERO).to_array(), i)).collect();
    let key = |place: &([f64; 3], u32)| place.0.map(f64::to_bits);
    kept.sort_unstable_by_key(|place| (key(place), place.1));
    kept.dedup_by_key(|place| key(place));
    kept.sort_unstable_by_key(|place| place.1);
    kept
}

/// For each of `places` the number of the nearest of `nodes`, of which there is at least one; of those equally near the
/// lowest. O((n + m) log n); slower where many nodes share a coordinate.
pub(crate) fn nearest(nodes: &[DVec3], places: &[DVec3]) -> Vec<u32> {
    let kept = places_of(nodes);
    let points: Vec<[f64; 3]> = kept.iter().map(|place| place.0).collect();
    let tree = ImmutableKdTree::<f64, u32, 3, 32>::new_from_slice(&points);
    let find = |place: &DVec3| {
        let place = place.to_array();
        let nearest = tree.nearest_one::<SquaredEuclidean>(&place);
        // The search tree may return any of several equally near nodes first.
        let lowest = tree
            .best_n_within::<SquaredEuclidean>(&place, nearest.distance, NonZero::<usize>::MIN)
            .next()
            .map_or(nearest.item, |best| best.item);
        kept[lowest as usize].1
    };
    let chunks: Vec<&[DVec3]> = places.chunks(CHUNK).collect();
    parallel::map(chunks.len(), |i| chunks[i].iter().map(find).collect::<Vec<u32>>()).concat()
}

/// For each of `places` the `count` nearest of `nodes`, nearest first, fewer if there are no more; of nodes in one place only
/// the first. O((n + m) log n) for a small count.
pub(crate) fn nearest_few(nodes: &[DVec3], places: &[DVec3], count: usize) -> Vec<Vec<u32>> {
    let kept = places_of(nodes);
    let points: Vec<[f64; 3]> = kept.iter().map(|place| place.0).collect();
    let tree = ImmutableKdTree::<f64, u32, 3, 32>::new_from_slice(&points);
    let count = NonZero::new(count.min(kept.len())).unwrap_or(NonZero::<usize>::MIN);
    let find = |place: &DVec3| {
        let mut found: Vec<(f64, u32)> = tree
            .nearest_n::<SquaredEuclidean>(&place.to_array(), count)
            .into_iter()
            .map(|near| (near.distance, kept[near.item as usize].1))
            .collect();
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|near| near.1).collect::<Vec<u32>>()
    };
    let chunks: Vec<&[DVec3]> = places.chunks(CHUNK).collect();
    parallel::map(chunks.len(), |i| chunks[i].iter().map(find).collect::<Vec<_>>()).concat()
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
