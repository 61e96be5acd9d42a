//! Stream orders after Horton 1945 and Strahler 1952, as botany took them over from rivers.

use crate::Skeleton;

/// Horton-Strahler order of each node and so of the internode below it: 1 at tips; at a fork the highest among
/// the children, and one more if two or more share it. At most log2 of the tips, plus 1. O(n).
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, metrics::strahler_orders};
///
/// let fork = Skeleton::new(vec![Vec3::ZERO; 4], vec![None, Some(0), Some(1), Some(1)])?;
/// assert_eq!(strahler_orders(&fork), [2, 2, 1, 1]);
/// # Ok::<(), treesynth::SkeletonError>(())
/// ```
pub fn strahler_orders(skeleton: &Skeleton) -> Vec<u16> {
    // The highest order among the children seen, and whether two have it. Every node's children come after it.
    let mut orders = vec![0u16; skeleton.len()];
    let mut shared = vec![false; skeleton.len()];
    let finish = |order: u16, shared: bool| (order + u16::from(shared)).max(1);
    for (node, parent) in skeleton.edges().rev() {
        orders[node] = finish(orders[node], shared[node]);
        if orders[node] > orders[parent] {
            orders[parent] = orders[node];
            shared[parent] = false;
        } else if orders[node] == orders[parent] {
            shared[parent] = true;
        }
    }
    orders[0] = finish(orders[0], shared[0]);
    orders
}

/// Number of streams of each Strahler order, that of order 1 first.
///
/// A stream is a whole chain of nodes of one order. The root's counts even where the foot is itself a fork and
/// the stream has no length: a tree stands on one trunk. The last entry is therefore 1. O(n).
pub fn stream_counts(skeleton: &Skeleton) -> Vec<usize> {
    streams_of(skeleton, &strahler_orders(skeleton))
}

pub(super) fn streams_of(skeleton: &Skeleton, orders: &[u16]) -> Vec<usize> {
    let mut counts = vec![0; usize::from(orders[0])];
    counts[usize::from(orders[0]) - 1] = 1;
    for (node, parent) in skeleton.edges() {
        if orders[node] != orders[parent] {
            counts[usize::from(orders[node]) - 1] += 1;
        }
    }
    counts
}

/// `N_k / N_(k+1)` of [`stream_counts`]: how many streams of each order there are for one of the next. One entry
/// fewer than orders. Each is at least 2, since it takes two streams to make one of the next order.
pub fn bifurcation_ratios(streams: &[usize]) -> Vec<f64> {
    streams.windows(2).map(|pair| pair[0] as f64 / pair[1] as f64).collect()
}

/// The bifurcation ratio of the whole tree by Horton's law of stream numbers, `N_k = R^(K - k)`: `exp(-s)`, where
/// s is the slope of the least-squares line through `(k, ln N_k)` over all orders k.
///
/// `None` with fewer than two orders, and where a count is 0. Rivers, where the law was found, lie between 3 and 5.
///
/// ```
/// use treesynth::metrics::mean_bifurcation_ratio;
///
/// let ratio = mean_bifurcation_ratio(&[27, 9, 3, 1]);
/// assert!(ratio.is_some_and(|ratio| (ratio - 3.0).abs() < 1e-12));
/// ```
pub fn mean_bifurcation_ratio(streams: &[usize]) -> Option<f64> {
    if streams.len() < 2 || streams.contains(&0) {
        return None;
    }
    let middle = 0.5 * (streams.len() - 1) as f64;
    let (mut along, mut square) = (0.0, 0.0);
    for (order, &count) in streams.iter().enumerate() {
        let from_middle = order as f64 - middle;
        along += from_middle * libm::log(count as f64);
        square += from_middle * from_middle;
    }
    Some(libm::exp(-along / square))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::{any_skeleton, binary, chain, y_fork};
    use proptest::prelude::*;
    use std::error::Error;

    /// The definition, word for word.
    fn oracle(skeleton: &Skeleton, node: usize) -> u16 {
        let below: Vec<u16> =
            skeleton.children().of(node).iter().map(|&child| oracle(skeleton, child as usize)).collect();
        match below.iter().max() {
            None => 1,
            Some(&most) if below.iter().filter(|&&order| order == most).count() >= 2 => most + 1,
            Some(&most) => most,
        }
    }

    #[test]
    fn perfect_binary_trees() -> Result<(), Box<dyn Error>> {
        for depth in 1..=10 {
            let tree = binary(depth)?;
            let streams = stream_counts(&tree);
            assert_eq!(u32::from(strahler_orders(&tree)[0]), depth);
            let want: Vec<usize> = (0..depth).rev().map(|k| 1 << k).collect();
            assert_eq!(streams, want);
            assert!(bifurcation_ratios(&streams).iter().all(|ratio| (ratio - 2.0).abs() < 1e-12));
            match mean_bifurcation_ratio(&streams) {
                None => assert_eq!(depth, 1),
                Some(ratio) => assert!((ratio - 2.0).abs() < 1e-12),
            }
        }
        Ok(())
    }

    #[test]
    fn by_hand() -> Result<(), Box<dyn Error>> {
        assert_eq!(strahler_orders(&y_fork()?), [2, 2, 1, 1]);
        assert_eq!(stream_counts(&y_fork()?), [2, 1]);
        assert_eq!(stream_counts(&chain(1)?), [1]);
        assert_eq!(stream_counts(&chain(1_000_000)?), [1]);
        assert_eq!(mean_bifurcation_ratio(&[1]), None);
        assert_eq!(mean_bifurcation_ratio(&[4, 0, 1]), None);
        assert!(mean_bifurcation_ratio(&[]).is_none() && bifurcation_ratios(&[]).is_empty());
        // Three equal children raise the order once, a lesser one does not; the chain between stays one stream.
        let parents = [None, Some(0), Some(0), Some(0), Some(1), Some(4), Some(4), Some(5)];
        let tree = Skeleton::new(vec![glam::Vec3::ZERO; 8], parents.to_vec())?;
        assert_eq!(strahler_orders(&tree), [2, 2, 1, 1, 2, 1, 1, 1]);
        assert_eq!(stream_counts(&tree), [4, 1]);
        Ok(())
    }

    proptest! {
        #[test]
        fn agrees_with_the_definition(skeleton in any_skeleton()) {
            let orders = strahler_orders(&skeleton);
            for (node, &order) in orders.iter().enumerate() {
                prop_assert_eq!(order, oracle(&skeleton, node));
            }
            let streams = stream_counts(&skeleton);
            prop_assert_eq!(streams[0], skeleton.tips().count());
            prop_assert_eq!(streams.last(), Some(&1));
            prop_assert!(bifurcation_ratios(&streams).iter().all(|&ratio| ratio >= 2.0));
        }
    }
}
