//! The structure update: the positions of all branch nodes at which the energy is least (section 4.2).

use std::collections::VecDeque;

use glam::DVec3;

use super::energy::Soft;
use super::model::{Model, Weights};

/// Pairs of steps and slopes remembered.
const MEMORY: usize = 6;

/// Moves `positions` to where the energy with its kinks rounded off is less; never to where it is more.
///
/// A limited-memory quasi-Newton method (Nocedal 1980) that starts each step from Weiszfeld's: alone, that one descends on
/// the convex part `F_I + λF_E`, and the pairs remembered teach it what `F_P` adds. Each step is halved until the energy falls
/// enough (Armijo). Ends after `rounds` steps, or when one brings less than `tolerance` of the energy. The root stays.
pub(super) fn descend(
    model: &Model<'_>,
    weights: &Weights,
    positions: &mut Vec<DVec3>,
    soft: Soft,
    rounds: u32,
    tolerance: f64,
) {
    let mut slope = Vec::new();
    let mut energy = model.terms(positions, soft, Some(&mut slope)).total(weights);
    let mut pairs: VecDeque<(Vec<DVec3>, Vec<DVec3>, f64)> = VecDeque::new();
    for _ in 0..rounds {
        let mut way = direction(model, positions, soft, &slope, &pairs);
        let mut fall = dot(&way, &slope);
        if fall >= 0.0 || fall.is_nan() {
            pairs.clear();
            way = model.spring_step(positions, soft, &slope);
            negate(&mut way);
            fall = dot(&way, &slope);
        }
        let mut length = 1.0;
        let mut next_slope = Vec::new();
        let next = loop {
            let next: Vec<DVec3> =
                positions.iter().zip(&way).map(|(&at, &step)| at + step * length).collect();
            let found = model.terms(&next, soft, Some(&mut next_slope)).total(weights);
            if found <= energy + 1e-4 * length * fall {
                break Some((next, found));
            }
            length *= 0.5;
            if length < 1e-4 {
                break None;
            }
        };
        let Some((next, found)) = next else { break };
        let steps: Vec<DVec3> = next.iter().zip(positions.iter()).map(|(&to, &from)| to - from).collect();
        let bends: Vec<DVec3> = next_slope.iter().zip(&slope).map(|(&to, &from)| to - from).collect();
        let curvature = dot(&steps, &bends);
        if curvature > 1e-12 * (dot(&steps, &steps) * dot(&bends, &bends)).sqrt() {
            if pairs.len() == MEMORY {
                pairs.pop_front();
            }
            pairs.push_back((steps, bends, 1.0 / curvature));
        }
        let gain = energy - found;
        (*positions, slope, energy) = (next, next_slope, found);
        if gain <= tolerance * energy {
            break;
        }
    }
}

/// The two-loop recursion, around Weiszfeld's step in place of a multiple of the slope.
fn direction(
    model: &Model<'_>,
    positions: &[DVec3],
    soft: Soft,
    slope: &[DVec3],
    pairs: &VecDeque<(Vec<DVec3>, Vec<DVec3>, f64)>,
) -> Vec<DVec3> {
    let mut rest = slope.to_vec();
    let mut shares = Vec::with_capacity(pairs.len());
    for (steps, bends, inverse) in pairs.iter().rev() {
        let share = inverse * dot(steps, &rest);
        add(&mut rest, bends, -share);
        shares.push(share);
    }
    let mut way = model.spring_step(positions, soft, &rest);
    for ((steps, bends, inverse), share) in pairs.iter().zip(shares.into_iter().rev()) {
        let back = inverse * dot(bends, &way);
        add(&mut way, steps, share - back);
    }
    negate(&mut way);
    way
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

fn add(to: &mut [DVec3], what: &[DVec3], times: f64) {
    to.iter_mut().zip(what).for_each(|(to, &what)| *to += what * times);
}

fn negate(way: &mut [DVec3]) {
    for step in way {
        *step = -*step;
    }
}

#[cfg(test)]
mod tests {
    use super::super::draft::Draft;
    use super::super::energy::Wish;
    use super::super::model::Nodes;
    use super::*;

    /// The tree of `tests/powell.py`: `SciPy` 1.17.1's Powell search ends at 255.128401213 after 16,568 evaluations.
    #[test]
    fn ends_no_higher_than_powell() {
        let place = |i: usize| {
            DVec3::new((i * 7 % 11) as f64 - 5.0, 3.0 + (i * 5 % 13) as f64 * 0.5, (i * 3 % 7) as f64 - 3.0)
        };
        let nodes = Nodes {
            places: (0..40).map(place).collect(),
            flows: vec![1.0; 40],
            costs: vec![1.0; 40],
            shares: vec![1.0 / 40.0; 40],
            unit: 1.0,
        };
        let mut draft = Draft::new(DVec3::ZERO, 40);
        draft.positions = (0..9).map(|i| f64::from(i) * DVec3::new(0.25, 1.0, -0.25)).collect();
        draft.parents = vec![0, 0, 1, 2, 3, 1, 2, 3, 4];
        draft.wishes = vec![Wish::new(1.0); 9];
        draft.owners = (0..40).map(|i| 1 + i % 8).collect();
        let weights = Weights { power: 0.8, lambda: 0.0, mu: 0.0, outside: 0.0, margin: 0.0 };
        let model = Model::new(&draft, &nodes, weights);
        let mut positions = draft.positions.clone();
        let wood = |positions: &[DVec3]| model.terms(positions, Soft::NONE, None).structure;
        assert!((wood(&positions) - 306.685_601_653).abs() < 1e-8, "the same start: {}", wood(&positions));
        descend(
            &model,
            &weights,
            &mut positions,
            Soft { length: 1e-6, deviation: 0.05, turn: 0.2 },
            200,
            1e-12,
        );
        assert!(wood(&positions) < 255.128_401_213 + 1e-6, "{}", wood(&positions));
    }
}
