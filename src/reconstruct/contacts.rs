//! Limbs that paths have entered where another limb touches them: found where two paths meet within a limb, and hung at their
//! thicker end.

use glam::Vec3;

use super::limbs::Ring;

/// Metres along a limb over which its direction is taken.
const REACH: f32 = 0.12;
/// Cosine of the angle within which two paths that meet lie in one limb, and of that beyond which a path turns from one limb into
/// another.
const ONE_LIMB: f32 = 0.85;
const TURN: f32 = 0.75;
/// Edges between two rings that are one limb, at least.
const LINKS: usize = 3;
/// Rings at the end of a limb whose size tells how thick it is.
const AT_END: usize = 5;

/// Least ratio of the thicknesses of a limb's two ends for it to be hung at the other.
const RATIO: f32 = 1.3;

/// The rings' tree, as it is changed.
struct Forest<'a> {
    rings: &'a [Ring],
    parents: Vec<Option<u32>>,
    children: Vec<Vec<u32>>,
}

/// The way from where two paths meet to where one of them has entered the limb.
struct Way {
    /// Rings of the limb, the one at the meeting first.
    limb: Vec<u32>,
    /// Thickness of the limb at the other end, metres; infinite for a trunk.
    thick: f32,
    /// `true` if the path comes from another limb there.
    turns: bool,
}

impl Forest<'_> {
    fn at(&self, ring: u32) -> Vec3 {
        self.rings[ring as usize].center
    }

    fn parent(&self, ring: u32) -> Option<u32> {
        self.parents[ring as usize]
    }

    /// The ring [`REACH`] towards the base.
    fn before(&self, from: u32) -> u32 {
        let mut ring = from;
        while self.at(ring).distance(self.at(from)) < REACH {
            let Some(parent) = self.parent(ring) else { break };
            ring = parent;
        }
        ring
    }

    /// The direction in which the path comes to a ring.
    fn coming(&self, ring: u32) -> Vec3 {
        (self.at(ring) - self.at(self.before(ring))).normalize_or_zero()
    }

    /// The direction that of all directions in which limbs go on from a ring is nearest to `way`, as a cosine.
    fn going(&self, from: u32, way: Vec3) -> f32 {
        let mut best = -1.0_f32;
        for &child in &self.children[from as usize] {
            let mut ring = child;
            while self.at(ring).distance(self.at(from)) < REACH {
                let next = self.children[ring as usize].iter().copied();
                let Some(next) = next.max_by_key(|&next| (self.rings[next as usize].nodes.len(), next))
                else {
                    break;
                };
                ring = next;
            }
            let on = self.at(ring) - self.at(from);
            if on.length() > 0.5 * REACH {
                best = best.max(on.normalize_or_zero().dot(way));
            }
        }
        best
    }

    /// From a ring, up to where the path has come into its limb; `way` leads into the limb from the meeting.
    fn way(&self, from: u32, way: Vec3) -> Way {
        let mut limb = vec![from];
        let mut ring = from;
        let mut turns = false;
        // The last ring that is farther from the present one than the reach.
        let mut behind = 0;
        while let Some(parent) = self.parent(ring) {
            while self.at(limb[behind + 1..].first().copied().unwrap_or(ring)).distance(self.at(ring)) > REACH
            {
                behind += 1;
            }
            let here = self.at(ring) - self.at(limb[behind]);
            let here = if here.length() < 0.5 * REACH { way } else { here.normalize_or_zero() };
            let on = (self.at(self.before(parent)) - self.at(parent)).normalize_or(here);
            if on.dot(here) < TURN {
                turns = true;
                break;
            }
            limb.push(parent);
            ring = parent;
        }
        let mut sizes: Vec<f32> =
            limb.iter().rev().take(AT_END).map(|&ring| self.rings[ring as usize].spread).collect();
        sizes.sort_unstable_by(f32::total_cmp);
        let thick = if turns { sizes[sizes.len() / 2] } else { f32::INFINITY };
        Way { limb, thick, turns }
    }

    fn is_below(&self, mut ring: u32, ancestor: u32) -> bool {
        loop {
            if ring == ancestor {
                return true;
            }
            let Some(parent) = self.parent(ring) else { return false };
            ring = parent;
        }
    }

    /// Hangs a limb, turned around, on a ring.
    fn hang(&mut self, limb: &[u32], on: u32) {
        let mut parent = on;
        for &ring in limb {
            if let Some(old) = self.parents[ring as usize].replace(parent) {
                self.children[old as usize].retain(|&child| child != ring);
            }
            self.children[parent as usize].push(ring);
            parent = ring;
        }
    }

    /// Mends the limb that two paths which meet in `a` and `b` have come into from both ends, if it is one.
    fn mend(&mut self, a: u32, b: u32) {
        let (from_a, from_b) = (self.coming(a), self.coming(b));
        let far = (self.at(b) - self.at(a))
            .reject_from_normalized(from_a.try_normalize().unwrap_or(Vec3::Y))
            .length();
        let wide = self.rings[a as usize].spread.max(self.rings[b as usize].spread);
        if far > wide + 0.01 {
            return;
        }
        let (ends_a, ends_b) = (self.going(a, from_a) < 0.5, self.going(b, from_b) < 0.5);
        let [size_a, size_b] = [a, b].map(|ring| self.rings[ring as usize].spread);
        let (way_a, way_b);
        if from_a.dot(from_b) < -ONE_LIMB && ends_a && ends_b {
            (way_a, way_b) = (self.way(a, -from_a), self.way(b, -from_b));
        } else if ends_a
            && size_a > 0.7 * size_b
            && self.going(b, from_a) > ONE_LIMB
            && from_b.dot(from_a) < TURN
        {
            (way_a, way_b) = (self.way(a, -from_a), Way { limb: vec![b], thick: 0.0, turns: true });
        } else if ends_b
            && size_b > 0.7 * size_a
            && self.going(a, from_b) > ONE_LIMB
            && from_a.dot(from_b) < TURN
        {
            (way_a, way_b) = (Way { limb: vec![a], thick: 0.0, turns: true }, self.way(b, -from_b));
        } else {
            return;
        }
        let (keep, cut, on) =
            if way_a.thick >= way_b.thick { (&way_a, &way_b, a) } else { (&way_b, &way_a, b) };
        let Some(&last) = cut.limb.last() else { return };
        if keep.turns && cut.turns && keep.thick > RATIO * cut.thick && !self.is_below(on, last) {
            self.hang(&cut.limb, on);
        }
    }
}

/// The rings, each limb hung at its thicker end; parents first. O(n + m log m) for n rings and m edges of nodes, and the length of the
/// limbs that are mended.
pub(super) fn mended(rings: Vec<Ring>, edges: &[(u32, u32)], nodes: usize) -> Vec<Ring> {
    let mut ring_of = vec![u32::MAX; nodes];
    for (number, ring) in (0_u32..).zip(&rings) {
        ring.nodes.iter().for_each(|&node| ring_of[node as usize] = number);
    }
    let parents: Vec<Option<u32>> = rings.iter().map(|ring| ring.parent).collect();
    let mut children = vec![Vec::new(); rings.len()];
    for (ring, parent) in (0_u32..).zip(&parents) {
        if let Some(parent) = *parent {
            children[parent as usize].push(ring);
        }
    }
    let is_tree = |a: u32, b: u32| {
        parents[a as usize] == Some(b)
            || parents[b as usize] == Some(a)
            || parents[a as usize] == parents[b as usize]
    };
    let mut meetings: Vec<(u32, u32)> = edges
        .iter()
        .map(|&(a, b)| (ring_of[a as usize], ring_of[b as usize]))
        .filter(|&(a, b)| a != b && a != u32::MAX && b != u32::MAX && !is_tree(a, b))
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    meetings.sort_unstable();
    let size = |ring: u32| rings[ring as usize].nodes.len();
    let mut found: Vec<(usize, u32, u32)> = meetings
        .chunk_by(|a, b| a == b)
        .filter(|links| links.len() >= LINKS)
        .map(|links| (size(links[0].0).min(size(links[0].1)), links[0].0, links[0].1))
        .collect();
    // Thick limbs first.
    found.sort_unstable_by_key(|&(size, a, b)| (std::cmp::Reverse(size), a, b));
    let mut forest = Forest { rings: &rings, parents, children };
    for (_, a, b) in found {
        if forest.parent(a) != Some(b) && forest.parent(b) != Some(a) {
            forest.mend(a, b);
        }
    }
    let Forest { parents, children, .. } = forest;
    let mut order: Vec<u32> =
        (0..rings.len() as u32).filter(|&ring| parents[ring as usize].is_none()).collect();
    let mut next = 0;
    while let Some(&ring) = order.get(next) {
        order.extend(&children[ring as usize]);
        next += 1;
    }
    let mut number = vec![0_u32; rings.len()];
    (0_u32..).zip(&order).for_each(|(new, &old)| number[old as usize] = new);
    let mut rings: Vec<Option<Ring>> = rings.into_iter().map(Some).collect();
    let take = |&old: &u32| {
        let ring = rings[old as usize].take()?;
        Some(Ring { parent: parents[old as usize].map(|parent| number[parent as usize]), ..ring })
    };
    order.iter().filter_map(take).collect()
}
