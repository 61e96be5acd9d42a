//! Radii of rings: measured by cylinders where points suffice, else from the length that the limb
//! bears, as measured on this tree's limbs.

use glam::Vec3;

use super::fit::{Cylinder, cylinder};
use super::limbs::Ring;
use super::nodes::Nodes;
use crate::{Skeleton, math, parallel};

/// Points that a cylinder is fitted to at most.
const MOST_POINTS: usize = 600;
/// Points and share of the way around that a cylinder needs.
const LEAST_POINTS: usize = 16;
const LEAST_AROUND: f32 = 0.3;

/// The axis through a ring: from some rings before to some after, along the heaviest.
fn axis(rings: &[Ring], heir: &[Option<u32>], ring: usize, reach: f32) -> (Vec3, Vec<u32>) {
    let mut chain = vec![ring as u32];
    let center = rings[ring].center;
    let (mut low, mut high) = (ring, ring);
    while let Some(parent) = rings[low].parent.filter(|_| rings[low].center.distance(center) < reach) {
        // A limb that is a lateral of its parent begins here.
        if rings[parent as usize].nodes.is_empty() || heir[parent as usize] != Some(low as u32) {
            break;
        }
        low = parent as usize;
        chain.push(parent);
    }
    while let Some(next) = heir[high].filter(|_| rings[high].center.distance(center) < reach) {
        high = next as usize;
        chain.push(next);
    }
    ((rings[high].center - rings[low].center).normalize_or_zero(), chain)
}

/// A cylinder for each ring that has points enough.
pub(super) fn fits(
    points: &[Vec3],
    nodes: &Nodes,
    rings: &[Ring],
    heir: &[Option<u32>],
    step: f32,
) -> Vec<Option<Cylinder>> {
    parallel::map(rings.len(), |ring| {
        let own = &rings[ring];
        if own.nodes.is_empty() {
            return None;
        }
        let reach = (1.2 * own.spread).clamp(1.1 * step, 4.0 * step);
        let (along, chain) = axis(rings, heir, ring, reach);
        let members = || chain.iter().flat_map(|&ring| &rings[ring as usize].nodes);
        let total: usize = members().map(|&node| nodes.of(node as usize).len()).sum();
        let stride = total.div_ceil(MOST_POINTS).max(1);
        let near: Vec<Vec3> = members()
            .flat_map(|&node| nodes.of(node as usize))
            .step_by(stride)
            .map(|&point| points[point as usize])
            .filter(|point| (*point - own.center).dot(along).abs() <= reach)
            .collect();
        if near.len() < LEAST_POINTS || along == Vec3::ZERO {
            return None;
        }
        let fit = cylinder(&near, along)?;
        let steep = fit.axis.dot(along).abs();
        let off = (fit.center - own.center).reject_from(along).length();
        // Distance of the points from the limb's middle, across it: the radius if all sides are seen, less if
        // one side is.
        let middle = near.iter().sum::<Vec3>() / near.len() as f32;
        let squares: f32 =
            near.iter().map(|point| (*point - middle).reject_from(along).length_squared()).sum();
        let across = (squares / near.len() as f32).sqrt();
        let holds = fit.around >= LEAST_AROUND
            && fit.kept >= 0.7
            && steep > 0.85
            && fit.radius > 0.002
            && fit.radius < 1.8 * across
            && off < 1.2 * fit.radius + 0.005
            && fit.spread < 0.1 * fit.radius + 0.0025
            && (fit.around > 0.55 || fit.radius > 0.02);
        holds.then_some(fit)
    })
}

/// Radii that never grow towards the tips: measured ones, held by a power of the length that a limb bears.
pub(super) fn radii(skeleton: &Skeleton, measured: &[Option<(f32, f32)>], tip: f32) -> Vec<f32> {
    let count = skeleton.len();
    let mut borne = vec![TIP_LENGTH; count];
    for (node, parent) in skeleton.edges().rev() {
        borne[parent] += borne[node] + skeleton.positions()[node].distance(skeleton.positions()[parent]);
    }
    // Thinner ones are lost in a beam's width.
    let tip = tip.max(1e-6);
    let allometry = Allometry::new(&borne, measured, tip);
    let expected = |node: usize| allometry.radius(borne[node]);
    let mut radii = vec![0.0_f32; count];
    for (number, branch) in skeleton.branches().iter().enumerate() {
        let own = branch.nodes();
        // All but the first begin with a node of their parent branch.
        let inner = if number == 0 { own } else { &own[1..] };
        // Measured over expected radius, without outliers, carried along the branch.
        let mut ratios: Vec<Option<(f32, f32)>> = inner
            .iter()
            .map(|&node| {
                let (radius, weight) = measured[node as usize]?;
                let ratio = radius / expected(node as usize);
                // Near its base a limb has points of its parent branch.
                let parent = own[0] as usize;
                let from = skeleton.positions()[node as usize].distance(skeleton.positions()[parent]);
                let is_clear = number == 0 || from > 1.3 * radii[parent] + radius;
                // A thin limb that is more than twice too thick is several.
                let most = if radius > 0.02 { 3.5 } else { 2.2 };
                (is_clear && (0.4..most).contains(&ratio)).then_some((ratio, weight))
            })
            .collect();
        without_outliers(&mut ratios);
        let held = carried(&ratios);
        let values: Vec<(f32, f32)> = inner
            .iter()
            .enumerate()
            .map(|(i, &node)| match ratios[i] {
                Some((ratio, weight)) => (ratio * expected(node as usize), weight),
                None => (held[i] * expected(node as usize), 0.02),
            })
            .collect();
        let falling = falling(&values);
        let cap = if inner.len() < own.len() { radii[own[0] as usize] } else { f32::INFINITY };
        for (&node, radius) in inner.iter().zip(falling) {
            radii[node as usize] = radius.max(tip).min(cap);
        }
    }
    // The first nodes of branches were capped by the radius of their parents; now all nodes are.
    for node in 1..count {
        let parent = skeleton.parent(node).unwrap_or(0);
        radii[node] = radii[node].min(radii[parent]);
    }
    radii
}

/// Length of wood that a tip counts as bearing, metres.
const TIP_LENGTH: f32 = 0.05;

/// The usual radius on this tree, by the length that a limb bears: a point for each doubling of the length,
/// as logarithms, ascending.
struct Allometry(Vec<(f32, f32)>);

impl Allometry {
    /// Number of doublings of the length that a tip bears, each with an entry of its own.
    const DOUBLINGS: usize = 24;

    /// The medians of what is measured, where most limbs are; thinner ones, of which only those are measured that seem thick,
    /// follow a power down to the tip.
    fn new(borne: &[f32], measured: &[Option<(f32, f32)>], tip: f32) -> Self {
        let mut bins: Vec<(usize, Vec<f32>)> = vec![(0, Vec::new()); Self::DOUBLINGS];
        for (fit, &length) in measured.iter().zip(borne) {
            let bin = math::ln(length / TIP_LENGTH) / std::f32::consts::LN_2;
            let (count, radii) = &mut bins[(bin as usize).min(Self::DOUBLINGS - 1)];
            *count += 1;
            radii.extend(fit.map(|fit| fit.0));
        }
        let mut known = Vec::new();
        let mut least = f32::INFINITY;
        for (bin, (count, mut radii)) in bins.into_iter().enumerate().rev() {
            if radii.len() < 5 || 5 * radii.len() < 2 * count {
                continue;
            }
            let half = radii.len() / 2;
            least = least.min(*radii.select_nth_unstable_by(half, f32::total_cmp).1);
            if least > tip {
                known.push((
                    math::ln(TIP_LENGTH) + (bin as f32 + 0.5) * std::f32::consts::LN_2,
                    math::ln(least),
                ));
            }
        }
        known.push((math::ln(TIP_LENGTH), math::ln(tip)));
        known.reverse();
        Self(known)
    }

    /// The radius of a limb that bears this length of wood, metres.
    fn radius(&self, borne: f32) -> f32 {
        let length = math::ln(borne);
        let next = self.0.partition_point(|known| known.0 < length);
        let last = self.0.len() - 1;
        if next == 0 {
            return math::exp(self.0[0].1);
        }
        let (x, y) = self.0[next - 1];
        if next > last {
            // The pipe model of Shinozaki et al. 1964.
            return math::exp(y + 0.5 * (length - x));
        }
        let (u, v) = self.0[next];
        math::exp(y + (v - y) * (length - x) / (u - x))
    }
}

/// Leaves out ratios that are off the median of the seven around them by more than a third.
fn without_outliers(ratios: &mut [Option<(f32, f32)>]) {
    let known: Vec<(usize, f32)> =
        ratios.iter().enumerate().filter_map(|(i, ratio)| ratio.map(|ratio| (i, ratio.0))).collect();
    for (k, &(i, ratio)) in known.iter().enumerate() {
        let mut around: Vec<f32> =
            known[k.saturating_sub(3)..(k + 4).min(known.len())].iter().map(|near| near.1).collect();
        around.sort_unstable_by(f32::total_cmp);
        let median = around[around.len() / 2];
        let own = if around.len() < 3 { 1.0 } else { median };
        if !(0.66..1.5).contains(&(ratio / own)) {
            ratios[i] = None;
        }
    }
}

/// Ratios where there is none: between two known ones in a line, else towards 1.
fn carried(ratios: &[Option<(f32, f32)>]) -> Vec<f32> {
    let mut held = vec![1.0_f32; ratios.len()];
    let known: Vec<usize> = (0..ratios.len()).filter(|&i| ratios[i].is_some()).collect();
    let at = |i: usize| ratios[i].map_or(1.0, |ratio| ratio.0);
    for (i, value) in held.iter_mut().enumerate() {
        let next = known.partition_point(|&k| k < i);
        *value = match (next.checked_sub(1).map(|k| known[k]), known.get(next).copied()) {
            (Some(a), Some(b)) if b > a => at(a) + (at(b) - at(a)) * (i - a) as f32 / (b - a) as f32,
            (Some(a), _) => 1.0 + (at(a) - 1.0) * math::exp(-((i - a) as f32) / 10.0),
            (None, Some(b)) => at(b),
            _ => 1.0,
        };
    }
    held
}

/// The nearest numbers that never rise, by pooling neighbours: Barlow et al. 1972, "Statistical inference under order restrictions".
fn falling(values: &[(f32, f32)]) -> Vec<f32> {
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for &(value, weight) in values {
        let mut pool = (f64::from(value), f64::from(weight), 1);
        while let Some(&(before, heavy, many)) = pools.last() {
            if before >= pool.0 {
                break;
            }
            pools.pop();
            let weight = heavy + pool.1;
            pool = ((before * heavy + pool.0 * pool.1) / weight, weight, many + pool.2);
        }
        pools.push(pool);
    }
    pools.into_iter().flat_map(|(value, _, many)| std::iter::repeat_n(value as f32, many)).collect()
}
