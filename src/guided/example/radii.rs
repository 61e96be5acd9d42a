//! Thickness after an example.

use super::learn::{base_radius, geometric_mean};
use crate::math::{exp, ln};
use crate::parameter::ParameterError;
use crate::radius::{RadiusError, RadiusModel, Taper};
use crate::skeleton::Skeleton;

/// Thickness after an example: the bole narrows as the example's does, below all forks too; the rest has it by the share of
/// tips, and none is thicker than what it leaves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LikeExample {
    shares: TipShare,
    /// Logarithm of the bole's radius in metres at its base, at 1/[`PLACES`] of its length ... and at its end; never ascending.
    bole: Vec<f32>,
}

/// Parts of the bole.
const PLACES: usize = 32;
/// The bole ends where the trunk bears less than this share of the tips.
const BOLE: f32 = 0.75;

impl LikeExample {
    /// `None` where the example has no thickness.
    pub(super) fn new(skeleton: &Skeleton) -> Option<Self> {
        let shares = TipShare::of(skeleton)?;
        let (ways, nodes) = bole(skeleton);
        let radius = |i: usize| skeleton.radii()[nodes[i] as usize];
        let mut least = base_radius(skeleton);
        let mut bole = vec![ln(least)];
        for part in 1..=PLACES {
            let way = part as f32 / PLACES as f32;
            let i = ways.partition_point(|&other| other < way).min(ways.len() - 1);
            let before = i.saturating_sub(1);
            let t = (way - ways[before]) / (ways[i] - ways[before]).max(f32::MIN_POSITIVE);
            let own = radius(before) + (radius(i) - radius(before)) * t.clamp(0.0, 1.0);
            least = if own > 0.0 { least.min(own) } else { least };
            bole.push(ln(least));
        }
        Some(Self { shares, bole })
    }
}

impl RadiusModel for LikeExample {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        let shares = self.shares.clone();
        let mut radii = match shares.taper {
            Some(tip) => Taper::new(shares).with_tip_fraction(tip).radii(skeleton)?,
            None => shares.radii(skeleton)?,
        };
        let (ways, nodes) = bole(skeleton);
        for (way, node) in ways.into_iter().zip(nodes) {
            let radius = &mut radii[node as usize];
            *radius = radius.min(exp(between(&self.bole, way * PLACES as f32)));
        }
        for (node, parent) in skeleton.edges() {
            radii[node] = radii[node].min(radii[parent]);
        }
        Ok(radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

/// The way to each node of the bole as a share of the whole, and the nodes.
fn bole(skeleton: &Skeleton) -> (Vec<f32>, Vec<u32>) {
    let tips = tips(skeleton);
    let branches = skeleton.branches();
    let trunk = branches.iter().next().map_or(vec![0], |branch| branch.nodes().to_vec());
    let bears = |&node: &u32| tips[node as usize] as f32 >= BOLE * tips[0] as f32;
    let nodes: Vec<u32> = trunk.into_iter().take_while(bears).collect();
    let positions = skeleton.positions();
    let mut way = 0.0;
    let mut ways = vec![0.0];
    for pair in nodes.windows(2) {
        way += positions[pair[0] as usize].distance(positions[pair[1] as usize]);
        ways.push(way);
    }
    for own in &mut ways {
        *own /= way.max(f32::MIN_POSITIVE);
    }
    (ways, nodes)
}

/// A table's value between two of its places.
fn between(table: &[f32], place: f32) -> f32 {
    let last = table.len() - 1;
    let place = place.clamp(0.0, last as f32);
    let (i, t) = (place as usize, place.fract());
    table[i] + (table[(i + 1).min(last)] - table[i]) * t
}

/// Radius by the share of the tree's tips that a branch bears: the pipe model's law, with the example's numbers at each
/// halving of the tips.
#[derive(Debug, Clone, PartialEq)]
struct TipShare {
    /// Logarithm of the radius in metres where 1, 1/2, 1/4 ... of the tips are borne; never ascending.
    logs: Vec<f32>,
    /// Radius of a twig's tip over that at its base; `None` where runs do not narrow.
    taper: Option<f32>,
}

impl TipShare {
    /// `None` where the example has no thickness.
    fn of(skeleton: &Skeleton) -> Option<Self> {
        let radii = skeleton.radii();
        let tips = tips(skeleton);
        let mut children = vec![0u32; skeleton.len()];
        skeleton.edges().for_each(|(_, parent)| children[parent] += 1);
        let layers = halvings(tips[0], 1).round() as usize + 1;
        // Each run: from the first node after a fork to the next fork or a tip.
        let mut first: Vec<usize> = (0..skeleton.len()).collect();
        let mut internodes = vec![0u32; skeleton.len()];
        let (mut narrowing, mut twigs) = (Vec::new(), Vec::new());
        let mut thickest = vec![0usize; skeleton.len()];
        for (node, parent) in skeleton.edges() {
            if children[parent] == 1 {
                first[node] = first[parent];
                internodes[node] = internodes[parent] + 1;
            } else if thickest[parent] == 0 || tips[node] > tips[thickest[parent]] {
                thickest[parent] = node;
            }
            if children[node] != 1 && internodes[node] >= 2 && radii[first[node]] > 0.0 {
                let share = radii[node] / radii[first[node]];
                if children[node] == 0 { twigs.push(share) } else { narrowing.push(share) }
            }
        }
        let mean = |shares: &[f32]| geometric_mean(shares.iter().copied()).unwrap_or(1.0);
        let tapers = mean(&narrowing) < 0.97 && mean(&twigs) < 0.8;
        // A run that narrows ends as thick as the thickest that goes on from it begins.
        let base = base_radius(skeleton);
        let mut known: Vec<[f32; 2]> = vec![[0.0, base]];
        for (node, parent) in skeleton.edges() {
            let begins = children[parent] > 1 && if tapers { thickest[parent] == node } else { true };
            if begins {
                known.push([halvings(tips[0], tips[node]), if tapers { radii[parent] } else { radii[node] }]);
            }
        }
        known.retain(|&[_, radius]| radius > 0.0);
        if base <= 0.0 {
            return None;
        }
        let slope = slope(&known);
        // Means at each halving, of what is brought there along the line that all make.
        let mut least = ln(base);
        let mut logs = vec![least];
        for layer in 1..layers {
            let layer = layer as f32;
            let near = known.iter().filter(|[place, _]| (place - layer).abs() <= 0.5);
            let (mut sum, mut count) = (0.0, 0.0);
            for &[place, radius] in near {
                sum += ln(radius) + slope * (layer - place);
                count += 1.0;
            }
            if count > 0.0 {
                least = least.min(sum / count);
            }
            logs.push(if count > 0.0 { least } else { f32::NAN });
        }
        fill(&mut logs);
        Some(Self { logs, taper: tapers.then(|| mean(&twigs).clamp(0.05, 1.0)) })
    }
}

/// Change of the logarithm of the radius for one halving, by regression.
fn slope(known: &[[f32; 2]]) -> f32 {
    let count = known.len() as f32;
    let places = known.iter().map(|&[place, _]| place).sum::<f32>() / count;
    let logs = known.iter().map(|&[_, radius]| ln(radius)).sum::<f32>() / count;
    let (mut above, mut below) = (0.0, 0.0);
    for &[place, radius] in known {
        above += (place - places) * (ln(radius) - logs);
        below += (place - places) * (place - places);
    }
    if below > 0.0 { (above / below).min(0.0) } else { 0.0 }
}

/// Straight lines over gaps.
fn fill(logs: &mut [f32]) {
    let mut last = 0;
    for i in 1..logs.len() {
        if !logs[i].is_nan() {
            for j in last + 1..i {
                logs[j] = logs[last] + (logs[i] - logs[last]) * (j - last) as f32 / (i - last) as f32;
            }
            last = i;
        }
    }
    let end = logs[last];
    logs[last..].fill(end);
}

fn tips(skeleton: &Skeleton) -> Vec<u32> {
    let mut tips = vec![0u32; skeleton.len()];
    for (node, parent) in skeleton.edges().rev() {
        tips[node] = tips[node].max(1);
        tips[parent] += tips[node];
    }
    tips[0] = tips[0].max(1);
    tips
}

/// Number of times that the tips of the tree are halved to get those of a branch.
fn halvings(all: u32, own: u32) -> f32 {
    ln(all as f32 / own as f32) / std::f32::consts::LN_2
}

impl RadiusModel for TipShare {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        let tips = tips(skeleton);
        let radius = |&own: &u32| exp(between(&self.logs, halvings(tips[0], own)));
        Ok(tips.iter().map(radius).collect())
    }

    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}
