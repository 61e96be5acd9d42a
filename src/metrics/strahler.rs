//! Stream orders after Horton 1945 and Strahler 1952, as botany took them over from rivers.

use super::angle::length;
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
/// A stream is a whole chain of nodes of one order. The root's counts even where the trunk base is itself a
/// fork and the stream has no length: a tree stands on one trunk. The last entry is therefore 1. O(n).
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

/// Mean length of the streams of each Strahler order, metres, that of order 1 first: all internodes of an order over its
/// [number of streams](stream_counts). O(n).
pub fn stream_lengths(skeleton: &Skeleton) -> Vec<f64> {
    let orders = strahler_orders(skeleton);
    let counts = streams_of(skeleton, &orders);
    let (lengths, _) = by_order(skeleton, &orders);
    lengths.iter().zip(&counts).map(|(length, &count)| length / count as f64).collect()
}

/// Mean diameter of the streams of each Strahler order, metres, that of order 1 first: over all internodes of an order by
/// their length, each as thick as its upper node. 0 where an order has no length. O(n).
pub fn stream_diameters(skeleton: &Skeleton) -> Vec<f64> {
    let (lengths, areas) = by_order(skeleton, &strahler_orders(skeleton));
    let mean = |(&length, &area): (&f64, &f64)| if length > 0.0 { area / length } else { 0.0 };
    lengths.iter().zip(&areas).map(mean).collect()
}

/// Length of the internodes of each order, and length times diameter.
fn by_order(skeleton: &Skeleton, orders: &[u16]) -> (Vec<f64>, Vec<f64>) {
    let mut sums = (vec![0.0; usize::from(orders[0])], vec![0.0; usize::from(orders[0])]);
    for (node, parent) in skeleton.edges() {
        let (order, length) = (usize::from(orders[node]) - 1, length(skeleton, node, parent));
        sums.0[order] += length;
        sums.1[order] += 2.0 * length * f64::from(skeleton.radii()[node]);
    }
    sums
}

/// Each value over the one before: Horton's length and diameter ratios, of [`stream_lengths`] and [`stream_diameters`]. 0 where
/// the value before is 0.
pub fn horton_ratios(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| if pair[0] > 0.0 { pair[1] / pair[0] } else { 0.0 }).collect()
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

    #[test]
    fn lengths_and_diameters_by_hand() -> Result<(), Box<dyn Error>> {
        // A trunk of 1 m that is 1 m thick, and two arms of 0.94 m that are half as thick.
        let arm = 0.89_f64.sqrt();
        let fork = y_fork()?.with_radii(vec![0.5, 0.5, 0.25, 0.25])?;
        let (lengths, diameters) = (stream_lengths(&fork), stream_diameters(&fork));
        assert!((lengths[0] - arm).abs() < 1e-6 && (lengths[1] - 1.0).abs() < 1e-6, "{lengths:?}");
        assert_eq!(diameters, [0.5, 1.0]);
        assert_eq!((horton_ratios(&diameters), horton_ratios(&[0.0, 1.0])), (vec![2.0], vec![0.0]));
        assert_eq!((stream_lengths(&chain(1)?), stream_diameters(&chain(1)?)), (vec![0.0], vec![0.0]));
        Ok(())
    }

    proptest! {
        #[test]
        fn lengths_sum_up(skeleton in any_skeleton()) {
            let lengths = stream_lengths(&skeleton);
            let counts = stream_counts(&skeleton);
            let sum: f64 = lengths.iter().zip(&counts).map(|(length, &count)| length * count as f64).sum();
            prop_assert!((sum - super::super::total_length(&skeleton)).abs() < 1e-6);
        }

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
