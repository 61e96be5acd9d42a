//! Branches that only pass each other are not bridged.

use std::collections::BTreeMap;
use treesynth::glam::Vec3;
use treesynth::surface::blob::{BlobTree, FieldFunction, Skin};
use treesynth::{Skeleton, presets};

/// The nearest places of two branches, each with its radius.
type Nearest = [(Vec3, f32); 2];

/// Distance of two branches that count as apart, in the sum of their radii; and the same around a
/// third one's axis, in its radii, which is its own wood.
const MARGIN: f32 = 0.2;
/// Side of the cells in which segments are found, metres.
const CELL: f32 = 0.1;
/// Places on the line between two surfaces.
const SAMPLES: usize = 21;

/// An internode of a branch.
struct Internode {
    branch: usize,
    ends: [Vec3; 2],
    radii: [f32; 2],
}

impl Internode {
    /// The nearest place of its axis, and the radius there.
    fn nearest(&self, point: Vec3) -> (Vec3, f32) {
        let way = self.ends[1] - self.ends[0];
        let t = ((point - self.ends[0]).dot(way) / way.length_squared().max(1e-20)).clamp(0.0, 1.0);
        (self.ends[0] + way * t, self.radii[0] + (self.radii[1] - self.radii[0]) * t)
    }

    /// `true` if fields, which reach at most a radius beyond the surface, may meet.
    fn is_near(&self, other: &Self) -> bool {
        let middle = |one: &Self| 0.5 * (one.ends[0] + one.ends[1]);
        let reach =
            |one: &Self| 0.5 * one.ends[0].distance(one.ends[1]) + 2.0 * one.radii[0].max(one.radii[1]);
        middle(self).distance(middle(other)) <= reach(self) + reach(other)
    }
}

/// The nearest places of two axes, found by going to and fro.
fn nearest(a: &Internode, b: &Internode) -> Nearest {
    let mut best = [a.nearest(b.ends[0]), b.nearest(a.ends[0])];
    let mut least = f32::INFINITY;
    for start in [0.0, 1.0] {
        let mut at = a.ends[0].lerp(a.ends[1], start);
        for _ in 0..8 {
            at = a.nearest(b.nearest(at).0).0;
        }
        let pair = [a.nearest(at), b.nearest(at)];
        let distance = pair[0].0.distance(pair[1].0);
        if distance < least {
            (least, best) = (distance, pair);
        }
    }
    best
}

/// Widths of the fields of a bearer, and of a lateral at most.
const FIELDS: [f32; 2] = [0.7, 1.0];

/// Numbers of the pairs of branches that are apart but within reach of each other's fields, neither
/// bearing the other, and of those that are bridged: the solid goes on all along the line between
/// their surfaces where they are nearest, and the thinnest place of that bridge is neither a third
/// branch's own wood nor the fillet of a lateral and its parent branch.
pub(crate) fn bridged(skeleton: &Skeleton, skin: &BlobTree) -> [usize; 2] {
    let branches = skeleton.branches();
    let mut home = vec![0usize; skeleton.len()];
    for (number, branch) in branches.iter().enumerate() {
        branch.nodes()[1..].iter().for_each(|&node| home[node as usize] = number);
    }
    let bearers: Vec<usize> = branches.iter().map(|branch| home[branch.nodes()[0] as usize]).collect();
    let mut internodes = Vec::new();
    for (branch, nodes) in branches.iter().enumerate() {
        for pair in nodes.nodes().windows(2) {
            let place = |node: u32| skeleton.positions()[node as usize];
            let radius = |node: u32| skeleton.radii()[node as usize];
            let start = if pair[0] == nodes.nodes()[0] { radius(pair[1]) } else { radius(pair[0]) };
            internodes.push(Internode {
                branch,
                ends: [place(pair[0]), place(pair[1])],
                radii: [start, radius(pair[1])],
            });
        }
    }
    let mut cells: BTreeMap<[i32; 3], Vec<u32>> = BTreeMap::new();
    for (number, internode) in internodes.iter().enumerate() {
        // Fields reach at most one radius beyond the surface.
        let reach = internode.radii[0].max(internode.radii[1]) * 2.0;
        let low = internode.ends[0].min(internode.ends[1]) - reach;
        let high = internode.ends[0].max(internode.ends[1]) + reach;
        let [low, high] = [low, high].map(|corner| (corner / CELL).floor().as_ivec3());
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                for z in low.z..=high.z {
                    cells.entry([x, y, z]).or_default().push(number as u32);
                }
            }
        }
    }
    let mut pairs: BTreeMap<[usize; 2], (f32, Nearest)> = BTreeMap::new();
    for cell in cells.values() {
        for (i, &first) in cell.iter().enumerate() {
            for &second in &cell[i + 1..] {
                let [a, b] = [first, second].map(|number| &internodes[number as usize]);
                let key = [a.branch.min(b.branch), a.branch.max(b.branch)];
                let kin = |one: usize, other: usize| one > 0 && bearers[one] == other;
                if key[0] == key[1] || kin(key[0], key[1]) || kin(key[1], key[0]) {
                    continue;
                }
                if !a.is_near(b) {
                    continue;
                }
                let pair = nearest(a, b);
                let gap = pair[0].0.distance(pair[1].0) - pair[0].1 - pair[1].1;
                let known = pairs.entry(key).or_insert((gap, pair));
                if gap < known.0 {
                    *known = (gap, pair);
                }
            }
        }
    }
    let apart = |(gap, pair): &(f32, Nearest)| *gap > MARGIN * (pair[0].1 + pair[1].1);
    pairs.retain(|_, pair| apart(pair));
    let is_bridged = |key: &[usize; 2], [(from, near), (to, far)]: Nearest| {
        let way = (to - from).normalize();
        let (start, end) = (from + way * near, to - way * far);
        let places = (0..SAMPLES).map(|i| start.lerp(end, i as f32 / (SAMPLES - 1) as f32));
        let thinnest = places.map(|place| (skin.value(place), place)).min_by(|a, b| a.0.total_cmp(&b.0));
        let (value, place) = thinnest.expect("samples");
        let cell = (place / CELL).floor().as_ivec3().to_array();
        // Fields of each branch there at the place, as a parent branch and as a lateral.
        let mut felt: BTreeMap<usize, [f32; 2]> = BTreeMap::new();
        // Nor do two pass each other where one of them is still within the wood of what bears it.
        let is_within = |at: Vec3| {
            let others = cells.get(&(at / CELL).floor().as_ivec3().to_array()).into_iter().flatten();
            let mut others = others.map(|&number| &internodes[number as usize]);
            others.any(|other| {
                let (axis, radius) = other.nearest(at);
                !key.contains(&other.branch) && axis.distance(at) < radius
            })
        };
        let mut within_another = is_within(from) || is_within(to);
        for other in cells.get(&cell).into_iter().flatten().map(|&number| &internodes[number as usize]) {
            let (axis, radius) = other.nearest(place);
            let distance = axis.distance(place) / radius;
            within_another |= !key.contains(&other.branch) && distance < 1.0 + MARGIN;
            let values = FIELDS.map(|width| FieldFunction::Smooth { width }.value(distance));
            let known = felt.entry(other.branch).or_default();
            *known = [known[0].max(values[0]), known[1].max(values[1])];
        }
        within_another |= felt.iter().any(|(&lateral, values)| {
            let bearer = felt.get(&bearers[lateral]).filter(|_| lateral > 0);
            bearer.is_some_and(|bearer| bearer[0] + values[1] >= 0.5)
        });
        value > 0.0 && !within_another
    };
    let count = pairs.iter().filter(|(key, (_, pair))| is_bridged(key, *pair)).count();
    [pairs.len(), count]
}

/// Each kind of tree that grows, at three ages; what grows in a plane does not pass.
#[test]
fn branches_that_only_pass_each_other_are_not_bridged() {
    let mut apart = 0;
    for preset in presets::grown().filter(|preset| !preset.planar) {
        for (seed, age) in [(1, 4.6), (2, 8.6), (3, 12.6), (4, 16.6)] {
            let stand = preset.grow(seed).expect("a species").at(age).expect("an age");
            let skin = Skin::default().with_age(age + 1.0).blob_tree(&stand.skeleton).expect("a skin");
            let [pairs, bridges] = bridged(&stand.skeleton, &skin);
            apart += pairs;
            assert!(bridges * 1000 <= pairs + 999, "{} {age}: {bridges} of {pairs}", preset.name);
        }
    }
    assert!(apart > 1000, "{apart}");
}

/// Two laterals of one bearer, and two of a lateral's laterals, side by side.
#[test]
fn what_stands_side_by_side_meets_without_a_bridge() {
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    // A trunk, and two limbs from it that go in parallel, a third of a radius of air between them.
    let places = vec![
        at(0.0, 0.0, 0.0),
        at(0.0, 1.0, 0.0),
        at(0.0, 1.1165, 0.0),
        at(0.0, 2.0, 0.0),
        at(1.0, 1.0, 0.0),
        at(1.0, 1.1165, 0.0),
    ];
    let parents = vec![None, Some(0), Some(1), Some(2), Some(1), Some(2)];
    let radii = vec![0.1, 0.1, 0.1, 0.1, 0.05, 0.05];
    let tree = Skeleton::new(places, parents).and_then(|tree| tree.with_radii(radii)).expect("a tree");
    let skin = Skin::default().blob_tree(&tree).expect("a skin");
    for x in [0.3, 0.5, 0.9] {
        let between = skin.value(at(x, 1.058, 0.0));
        assert!(between < -0.01 && between > -0.5, "{between} at {x}");
    }
    // On the bearer both still blend.
    assert!(skin.value(at(0.09, 1.0, 0.062)) > skin.value(at(0.09, 0.7, 0.062)));
}
