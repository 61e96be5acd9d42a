//! Radii: twigs by the species' twig radius with its spread, the wood below by pipes, stems by the measured
//! profile.
//!
//! Pipes: the p-th power of a radius is the sum of those that it bears. The exponent is the one by which the pipes of
//! the trunk at 1.3 m have the diameter asked for, so that twigs, limbs and trunk fit one another.

use super::data::Species;
use super::draw::Draw;
use super::request::Numbers;
use super::wood::{Rank, Wood};
use crate::math;

/// The height at which trunks are measured, metres.
pub(super) const BREAST: f32 = 1.3;
/// Exponents that trees have; beyond, radii are stretched.
const EXPONENTS: [f32; 2] = [1.75, 3.0];
/// No branch is thicker than this part of its parent.
const BRANCH: f32 = 0.86;

/// The radius of each node. A diameter that was `asked` for is met however low the stem is.
pub(super) fn radii(species: &Species, wood: &Wood, plan: &Numbers, asked: bool, mut draw: Draw) -> Vec<f32> {
    let count = wood.positions.len();
    let tip = species.shoots.radius / 1000.0;
    let mut bears = vec![false; count];
    for node in 1..count {
        bears[wood.parents[node] as usize] = true;
    }
    let tips: Vec<f32> = (0..count)
        .map(|node| {
            if bears[node] {
                0.0
            } else {
                tip * (1.0 + species.shoots.radius_cv * draw.normal()).clamp(0.4, 1.9)
            }
        })
        .collect();
    let breast = plan.dbh * 0.5;
    let exponent = exponent(wood, &tips, breast);
    // Sums of powers, then radii.
    let mut powers: Vec<f64> = tips
        .iter()
        .map(|&tip| if tip > 0.0 { f64::from(math::powf(tip * 1000.0, exponent)) } else { 0.0 })
        .collect();
    for node in (1..count).rev() {
        powers[wood.parents[node] as usize] += powers[node];
    }
    let pipe: Vec<f32> =
        powers.iter().map(|&power| math::powf(power as f32, 1.0 / exponent) / 1000.0).collect();
    let trunk = breast_node(wood);
    let stretch = math::ln(breast / tip).max(0.1) / math::ln(pipe[trunk] / tip).max(0.1);
    let stretch = stretch.clamp(0.4, 1.6);
    let mut radii: Vec<f32> = pipe
        .iter()
        .map(|&radius| if radius > tip { tip * math::powf(radius / tip, stretch) } else { radius })
        .collect();
    stems(species, wood, plan, asked, &mut radii);
    // Nothing is thicker than what bears it; a limb keeps its own taper below its stem's.
    let mut narrowed = vec![1.0f32; count];
    for node in 1..count {
        let parent = wood.parents[node] as usize;
        if wood.ranks[node] == Rank::Stem {
            continue;
        }
        let mut factor = narrowed[parent];
        let thin = |radius: f32, factor: f32| tip + (radius - tip).max(0.0) * factor;
        if wood.orders[node] != wood.orders[parent] && radii[node] > tip {
            let of_stem = wood.ranks[parent] == Rank::Stem;
            let most = if of_stem { species.limbs.thickest } else { BRANCH } * radii[parent];
            let now = thin(radii[node], factor);
            if now > most {
                factor *= ((most - tip) / (now - tip).max(1e-6)).clamp(0.0, 1.0);
            }
        }
        narrowed[node] = factor;
        let wanted = if radii[node] > tip { thin(radii[node], factor) } else { radii[node] };
        radii[node] = wanted.min(radii[parent]);
    }
    radii
}

/// The node of the trunk at breast height, or its highest if it is lower.
fn breast_node(wood: &Wood) -> usize {
    let of_trunk = |node: &usize| wood.ranks[*node] == Rank::Stem && wood.orders[*node] == 0;
    let trunk = (0..wood.positions.len()).filter(of_trunk);
    trunk.take_while(|&node| wood.positions[node].y < BREAST * 1.02).last().unwrap_or(0)
}

/// The exponent by which the twigs above breast height have a trunk of this radius.
fn exponent(wood: &Wood, tips: &[f32], breast: f32) -> f32 {
    let trunk = breast_node(wood);
    let mut above = vec![false; wood.positions.len()];
    above[trunk] = true;
    for node in trunk + 1..wood.positions.len() {
        above[node] = above[wood.parents[node] as usize];
    }
    let borne: Vec<f32> = (0..wood.positions.len())
        .filter(|&node| above[node] && tips[node] > 0.0)
        .map(|node| math::ln(tips[node] / breast))
        .collect();
    // The sum falls with the exponent; it is 1 where it fits.
    let [mut low, mut high] = EXPONENTS;
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        let sum: f64 = borne.iter().map(|ratio| f64::from(math::exp(middle * ratio))).sum();
        if sum > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Stems by their profile; where a trunk divides, its end by pipes.
fn stems(species: &Species, wood: &Wood, plan: &Numbers, asked: bool, radii: &mut [f32]) {
    let trunk = &species.trunk;
    let tip = species.shoots.radius / 1000.0;
    let count = wood.positions.len();
    // The height of each node's stem, handed down from its end.
    let mut tops = vec![0.0f32; count];
    let is_stem = |node: usize| wood.ranks[node] == Rank::Stem;
    for node in (1..count).rev().filter(|&node| is_stem(node)) {
        tops[node] = tops[node].max(wood.positions[node].y);
        let parent = wood.parents[node] as usize;
        if parent > 0 && wood.orders[parent] == wood.orders[node] {
            tops[parent] = tops[parent].max(tops[node]);
        }
    }
    let trunk_top = (1..count).filter(|&node| is_stem(node) && wood.orders[node] == 0);
    tops[0] = trunk_top.map(|node| tops[node]).fold(0.1, f32::max);
    for node in (0..count).filter(|&node| is_stem(node)) {
        let y = wood.positions[node].y;
        let main = wood.orders[node] == 0;
        let end = if main && trunk.leader < 1.0 { plan.height } else { tops[node] };
        // Further stems are thinner as they are shorter.
        let own = if main { 1.0 } else { math::powf(end / plan.height, 1.5) };
        let breast = plan.dbh * 0.5 * own;
        let flare = |y: f32| trunk.flare * math::exp(-y.max(0.0) / (1.4 * plan.dbh * own));
        // The shares are of the diameter at breast height as it is measured, flare included.
        let at_breast = 1.0 + flare(BREAST.min(end));
        let shares = trunk.profile.map(|share| share * at_breast);
        let measured = profile(shares, end, tip / breast, y) * breast * (1.0 + flare(y)) / at_breast;
        radii[node] = if main && trunk.leader < 1.0 && tops[0] > BREAST {
            // Over its upper part a trunk that divides comes down to what its limbs ask for.
            let way = ((y - BREAST) / (tops[0] - BREAST)).clamp(0.0, 1.0);
            let weight = way * way;
            measured * (1.0 - weight) + radii[node].min(measured) * weight
        } else {
            measured
        };
    }
    for node in 1..count {
        let parent = wood.parents[node] as usize;
        if is_stem(node) && (wood.orders[parent] == wood.orders[node]) {
            radii[node] = radii[node].min(radii[parent]).max(tip);
        }
    }
    // To the diameter asked for, exactly.
    let measured = at_breast(wood, radii);
    if measured > 0.0 {
        let factor = plan.dbh * 0.5 / measured;
        // Of a stem hardly higher than that, the diameter there is nearly the tip's, and says nothing about the base.
        let factor = if !asked && tops[0] < 1.25 * BREAST { factor.min(MOST_THICKER) } else { factor };
        for node in (0..count).filter(|&node| is_stem(node) && wood.orders[node] == 0) {
            radii[node] = (radii[node] * factor).max(tip);
        }
    }
}

/// Largest factor by which low stems become thicker than their profile, where the diameter is not
/// asked for.
const MOST_THICKER: f32 = 1.3;

/// Radius over that at breast height, by height: linear between the measured ones, down to the shoot at the top.
fn profile(shares: [f32; 3], height: f32, tip: f32, y: f32) -> f32 {
    let start = BREAST.min(0.5 * height);
    let mut before = (start, 1.0f32);
    let knots = [(0.25, shares[0]), (0.5, shares[1]), (0.75, shares[2]), (1.0, tip)];
    let mut slope = None;
    for (part, share) in knots {
        let at = part * height;
        if at < start * 1.35 {
            continue;
        }
        let here = (share - before.1) / (at - before.0);
        let first = *slope.get_or_insert(here);
        if y < start {
            return 1.0 + (y - start) * first;
        }
        if y <= at {
            return before.1 + (y - before.0) * here;
        }
        before = (at, share);
    }
    tip
}

/// Radius of the trunk at breast height; at its end if it ends lower.
pub(super) fn at_breast(wood: &Wood, radii: &[f32]) -> f32 {
    let mut last: Option<usize> = None;
    let of_trunk = |node: &usize| wood.ranks[*node] == Rank::Stem && wood.orders[*node] == 0;
    for node in (0..wood.positions.len()).filter(of_trunk) {
        let y = wood.positions[node].y;
        if y >= BREAST {
            let Some(before) = last else { return radii[node] };
            let low = wood.positions[before].y;
            let share = (BREAST - low) / (y - low).max(1e-6);
            return radii[before] + (radii[node] - radii[before]) * share;
        }
        last = Some(node);
    }
    last.map_or(0.0, |node| radii[node])
}
