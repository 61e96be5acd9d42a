//! The places where trunks begin.

use std::collections::BTreeMap;

use glam::Vec3;

use super::ReconstructError;
use super::ground::Ground;
use super::net::Sets;
use super::nodes::Nodes;

/// A thing that stands in a slice of a cloud.
#[derive(Debug, Clone)]
struct Standing {
    /// The middle of its lowest nodes.
    base: Vec3,
    /// Places of its nodes, and how high above the slice's zero each is.
    nodes: Vec<(Vec3, f32)>,
}

/// The side of the cells whose nodes, if they touch, are one thing, metres.
const SIDE: f32 = 0.1;

/// The things in the slice of nodes from `low` up to `high` metres, the one of most nodes first. Each node has its height.
fn standing(nodes: &[(Vec3, f32)], low: f32, high: f32) -> Vec<Standing> {
    let mut cells: BTreeMap<(i32, i32), Vec<u32>> = BTreeMap::new();
    for (node, (position, _)) in (0_u32..).zip(nodes).filter(|(_, node)| node.1 >= low && node.1 <= high) {
        let at = ((position.x / SIDE).floor() as i32, (position.z / SIDE).floor() as i32);
        cells.entry(at).or_default().push(node);
    }
    let mut found = Vec::new();
    while let Some((first, own)) = cells.pop_first() {
        let (mut all, mut stack) = (own, vec![first]);
        while let Some((x, z)) = stack.pop() {
            for beside in (-1..=1).flat_map(|dx| (-1..=1).map(move |dz| (x + dx, z + dz))) {
                if let Some(own) = cells.remove(&beside) {
                    all.extend(own);
                    stack.push(beside);
                }
            }
        }
        let own: Vec<(Vec3, f32)> = all.into_iter().map(|node| nodes[node as usize]).collect();
        let lowest = own.iter().map(|node| node.0.y).fold(f32::INFINITY, f32::min);
        let at_base: Vec<Vec3> =
            own.iter().map(|node| node.0).filter(|p| p.y <= lowest + 0.5 * (high - low)).collect();
        let middle = at_base.iter().sum::<Vec3>() / at_base.len() as f32;
        found.push(Standing { base: middle.with_y(lowest), nodes: own });
    }
    found.sort_by_key(|thing| std::cmp::Reverse(thing.nodes.len()));
    found
}

/// The nodes of parts of some size only: what lies alone below a tree is noise.
fn sound(nodes: &Nodes, edges: &[(u32, u32)]) -> Vec<Vec3> {
    let mut sets = Sets::new(nodes.len());
    for &(a, b) in edges {
        sets.join(a, b);
    }
    let mut sizes = vec![0_usize; nodes.len()];
    (0..nodes.len() as u32).for_each(|node| sizes[sets.of(node) as usize] += 1);
    let least = (nodes.len() / 200).clamp(3, 50);
    let sound: Vec<Vec3> = (0..nodes.len() as u32)
        .filter(|&node| sizes[sets.of(node) as usize] >= least)
        .map(|node| nodes.positions[node as usize])
        .collect();
    if sound.len() * 4 > nodes.len() { sound } else { nodes.positions.clone() }
}

/// The lowest and the highest.
fn extent(heights: impl Iterator<Item = f32>) -> (f32, f32) {
    heights
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)))
}

/// The part of a cloud's height, metres, in which trunks are looked for.
fn slice(height: f32, side: f32) -> f32 {
    (0.05 * height).min(0.5).max(4.0 * side)
}

/// What stands wider than this share of the height, or than this, metres, is no trunk but a wall, or grass around one.
const WIDE: f32 = 0.15;
const WIDE_AT_LEAST: f32 = 1.0;

fn flat(place: Vec3) -> Vec3 {
    place.with_y(0.0)
}

impl Standing {
    /// Its middle on the ground, and how far it goes from there.
    fn footprint(&self) -> (Vec3, f32) {
        let places = || self.nodes.iter().map(|node| flat(node.0));
        let middle = places().sum::<Vec3>() / self.nodes.len() as f32;
        (middle, places().map(|place| place.distance(middle)).fold(0.0, f32::max))
    }

    /// The base below the trunk that goes on above, if that stands elsewhere over it: grass around a trunk is one thing with it.
    fn below(&self, above: Option<&(Vec3, f32)>) -> Vec3 {
        let Some((middle, spread)) = above else { return self.base };
        let reach = spread + LEAN * ABOVE as f32;
        let is_below = |place: &Vec3| flat(*place).distance(*middle) <= reach;
        let below: Vec<Vec3> = self.nodes.iter().map(|node| node.0).filter(is_below).collect();
        if below.is_empty() || is_below(&self.base) {
            return self.base;
        }
        let (lowest, _) = extent(below.iter().map(|place| place.y));
        (below.iter().sum::<Vec3>() / below.len() as f32).with_y(lowest)
    }
}

/// The base of the one trunk, where the nodes are lowest.
pub(super) fn lowest_trunk(nodes: &Nodes, edges: &[(u32, u32)]) -> Result<Vec3, ReconstructError> {
    let sound: Vec<(Vec3, f32)> = sound(nodes, edges).into_iter().map(|place| (place, place.y)).collect();
    let (low, top) = extent(sound.iter().map(|node| node.1));
    let thick = slice(top - low, nodes.side);
    let high = low + thick;
    let wide = (WIDE * (top - low)).max(WIDE_AT_LEAST);
    // Above grass, from the largest on.
    let above: Vec<(Vec3, f32)> =
        standing(&sound, high + thick, high + 2.0 * thick).iter().map(Standing::footprint).collect();
    let all = standing(&sound, low, high);
    let is_wall = |thing: &Standing| {
        let (middle, spread) = thing.footprint();
        let goes_on = |over: &(Vec3, f32)| over.1 > wide && over.0.distance(middle) < spread;
        spread > wide && above.iter().any(goes_on)
    };
    let mut trunks: Vec<&Standing> = all.iter().filter(|thing| !is_wall(thing)).collect();
    if trunks.is_empty() {
        // A crown that reaches down to the ground.
        trunks = all.iter().collect();
    }
    let count: usize = trunks.iter().map(|trunk| trunk.nodes.len()).sum();
    match &trunks[..] {
        [first, ..] if first.nodes.len() * 10 >= count * 7 => {
            Ok(first.below(above.iter().find(|over| over.1 <= wide)))
        }
        [first, second, ..] => {
            let (first, second) = (first.base, second.base);
            Err(ReconstructError::Trunks { high, trunks: trunks.len(), first, second })
        }
        _ => Err(ReconstructError::TooFew { points: 0, nodes: 0 }),
    }
}

/// Nodes that a trunk has at least, of those that the largest has.
const LEAST: usize = 10;
/// Slices above the lowest in which a trunk goes on, and nodes in each at least.
const ABOVE: usize = 2;
const GOES_ON: usize = 3;
/// Distance within which it goes on, beside its own spread, per slice, metres.
const LEAN: f32 = 0.15;

/// The bases of all trunks, that of most nodes first. Trunks reach through most of the lowest slice, above the ground if there is
/// one, and go on above it, unlike twigs that hang low, and grass.
pub(super) fn trunks(nodes: &Nodes, edges: &[(u32, u32)], ground: &Ground) -> Vec<Vec3> {
    let mut sound: Vec<(Vec3, f32)> =
        sound(nodes, edges).into_iter().map(|place| (place, ground.height(place))).collect();
    let (low, top) = extent(sound.iter().map(|node| node.1));
    let thick = slice(top - low, nodes.side);
    let things = standing(&sound, low, low + thick);
    let Some(largest) = things.first().map(|thing| thing.nodes.len()) else { return Vec::new() };
    sound.retain(|node| node.1 <= low + (ABOVE + 1) as f32 * thick);
    let is_trunk = |thing: &&Standing| {
        let (lowest, highest) = extent(thing.nodes.iter().map(|node| node.1));
        let flat = |place: Vec3| flat(place).distance(flat(thing.base));
        let spread = thing.nodes.iter().map(|node| flat(node.0)).fold(0.0, f32::max).min(1.5);
        let goes_on = (1..=ABOVE).all(|number| {
            let from = low + number as f32 * thick;
            let within = |node: &&(Vec3, f32)| {
                node.1 > from && node.1 <= from + thick && flat(node.0) <= spread + LEAN * number as f32
            };
            sound.iter().filter(within).count() >= GOES_ON
        });
        thing.nodes.len() * LEAST >= largest && highest - lowest >= 0.6 * thick && goes_on
    };
    things.iter().filter(is_trunk).map(|thing| thing.base).collect()
}
