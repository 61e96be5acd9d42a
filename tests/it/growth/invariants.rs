//! Invariants of every tree at every age.

use crate::sample::fnv1a;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::LazyLock;
use treesynth::glam::Vec3;
use treesynth::growth::{Architecture, Curve, Growth, TreeAtAge};
use treesynth::presets;

/// Five species at full size are slow to grow for each of many cases, so they grow once.
static TREES: LazyLock<Vec<Growth>> = LazyLock::new(|| {
    let species = [
        Architecture::cottonwood(),
        Architecture::spruce(),
        Architecture::lombardy_poplar(),
        Architecture::weeping_birch(),
        Architecture::spreading_oak(),
    ];
    let young = species.into_iter().map(|species| species.with_most_order(2));
    young.map(|species| Growth::new(species, 5).expect("a tree")).collect()
});

/// The places of nodes by their numbers.
fn places(stand: &TreeAtAge) -> BTreeMap<u32, Vec3> {
    stand.ids.iter().copied().zip(stand.skeleton.positions().iter().copied()).collect()
}

/// The length of each living branch, by the number of its first node.
fn lengths(stand: &TreeAtAge) -> BTreeMap<u32, f32> {
    let positions = stand.skeleton.positions();
    let branches = stand.skeleton.branches();
    let length = |nodes: &[u32]| -> f32 {
        nodes.windows(2).map(|pair| positions[pair[0] as usize].distance(positions[pair[1] as usize])).sum()
    };
    let living = branches.iter().filter(|branch| !stand.dead[branch.nodes()[1] as usize]);
    living.map(|branch| (stand.ids[branch.nodes()[1] as usize], length(branch.nodes()))).collect()
}

fn hash(stand: &TreeAtAge) -> u64 {
    let skeleton = &stand.skeleton;
    let floats = skeleton.positions().iter().flat_map(Vec3::to_array).chain(skeleton.radii().iter().copied());
    let leaves = stand.leaves.iter().flat_map(|leaf| {
        let vectors = [leaf.position, leaf.midrib * leaf.length, leaf.normal, Vec3::from_array(leaf.color)];
        vectors.map(|v| v.to_array()).concat()
    });
    let buds = stand
        .buds
        .iter()
        .flat_map(|bud| [bud.position, bud.direction * bud.length].map(|v| v.to_array()).concat());
    let bearers = stand.leaves.iter().map(|leaf| leaf.node).chain(stand.buds.iter().map(|bud| bud.node));
    let orders = skeleton.orders().iter().chain(skeleton.stages()).map(|&order| u32::from(order));
    let numbers = stand.ids.iter().chain(skeleton.hops()).copied().chain(bearers).chain(orders);
    let parents =
        (0..skeleton.len()).map(|node| skeleton.parent(node).map_or(u32::MAX, |parent| parent as u32));
    let bits = floats.chain(leaves).chain(buds).map(f32::to_bits).chain(numbers).chain(parents);
    fnv1a(bits.flat_map(u32::to_le_bytes))
}

/// Parent, stage, order and hops of a node.
type Facts = (Option<u32>, u16, u16, u32);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn every_age_is_a_tree(tree in 0usize..5, part in 0.0f32..=0.6) {
        let growth = &TREES[tree];
        let age = part * f32::from(growth.years());
        let stand = growth.at(age).expect("a tree");
        let skeleton = &stand.skeleton;
        prop_assert_eq!(skeleton.check(), Ok(()));
        prop_assert_eq!(stand.ids.len(), skeleton.len());
        let mut ids = stand.ids.clone();
        ids.sort_unstable();
        prop_assert!(ids.windows(2).all(|pair| pair[0] < pair[1]) && (ids[ids.len() - 1] as usize) < growth.nodes());
        for (node, parent) in skeleton.edges() {
            let (stages, orders) = (skeleton.stages(), skeleton.orders());
            prop_assert!(f32::from(stages[node]) < age + 1.0);
            // A branch is of an order above its bearer and springs in a later year; an axis goes on in time.
            prop_assert!(orders[node] - orders[parent] <= 1 && stages[node] >= stages[parent]);
            prop_assert!(orders[node] == orders[parent] || stages[node] > stages[parent]);
            prop_assert!(stand.ids[node] > stand.ids[parent]);
            prop_assert!(skeleton.radii()[node] > 0.0 && skeleton.radii()[node] <= skeleton.radii()[parent] * 1.0001);
            prop_assert_eq!(skeleton.hops()[node], skeleton.hops()[parent] + 1);
        }
        for leaf in &stand.leaves {
            prop_assert!((leaf.midrib.length() - 1.0).abs() < 1e-4 && (leaf.normal.length() - 1.0).abs() < 1e-4);
            prop_assert!(leaf.midrib.dot(leaf.normal).abs() < 1e-3 && leaf.length > 0.0);
            let foot = skeleton.positions()[leaf.node as usize];
            let radius = skeleton.radii()[leaf.node as usize];
            prop_assert!((leaf.position.distance(foot) - radius).abs() < 1e-4, "a leaf off the bark");
        }
    }

    /// Equation 5 in the finished tree, up to rounding; and branches only ever get longer.
    #[test]
    fn branches_grow_by_the_least_shoot_each_year(tree in 0usize..5, year in 1u16..14) {
        let growth = &TREES[tree];
        let before = lengths(&growth.at(f32::from(year)).expect("a tree"));
        let within = lengths(&growth.at(f32::from(year) + 0.45).expect("a tree"));
        let after = lengths(&growth.at(f32::from(year) + 1.0).expect("a tree"));
        let mut compared = 0;
        for (branch, length) in &before {
            // Places ten metres up are exact to a millionth; an internode is two of them.
            let rounding = 1e-4 + 1e-4 * length;
            if let Some(within) = within.get(branch) {
                prop_assert!(*within >= length - rounding);
            }
            let Some(after) = after.get(branch) else { continue };
            prop_assert!(after - length >= growth.architecture().least_shoot() - rounding, "{} to {}", length, after);
            compared += 1;
        }
        prop_assert!(compared > 0);
    }

    /// In a hundredth of a year no place moves farther than a tenth of the trunk's greatest shoot (some 2 m) or, at the
    /// end of a long branch whose heading turns, than a twentieth of its way from the root.
    #[test]
    fn growth_is_continuous(tree in 0usize..5, part in 0.0f32..0.55) {
        let growth = &TREES[tree];
        let age = part * f32::from(growth.years());
        let (before, after) = (growth.at(age).expect("a tree"), growth.at(age + 0.01).expect("a tree"));
        let later = places(&after);
        let mut stayed = 0;
        for (id, place) in places(&before) {
            if let Some(other) = later.get(&id) {
                let moved = place.distance(*other);
                prop_assert!(moved <= 0.2 + 0.05 * place.length(), "{id} moved {moved} m at {age}");
                stayed += 1;
            }
        }
        prop_assert!(stayed > 0);
    }

    /// A node never changes, and a node that is gone stays away.
    #[test]
    fn nodes_keep_their_identity(tree in 0usize..5, ages in prop::collection::vec(0.0f32..0.55, 3)) {
        let growth = &TREES[tree];
        let mut ages = ages;
        ages.sort_by(f32::total_cmp);
        let [first, second, third] =
            [0, 1, 2].map(|i| growth.at(ages[i] * f32::from(growth.years())).expect("a tree"));
        let facts = |stand: &TreeAtAge| -> BTreeMap<u32, Facts> {
            let skeleton = &stand.skeleton;
            let fact = |node: usize| {
                let parent = skeleton.parent(node).map(|parent| stand.ids[parent]);
                (parent, skeleton.stages()[node], skeleton.orders()[node], skeleton.hops()[node])
            };
            stand.ids.iter().enumerate().map(|(node, &id)| (id, fact(node))).collect()
        };
        let [first, second, third] = [&first, &second, &third].map(facts);
        for (id, fact) in &first {
            match (second.get(id), third.get(id)) {
                (Some(second), _) => prop_assert_eq!(second, fact),
                (None, third) => prop_assert!(third.is_none(), "node {} came back", id),
            }
            if let Some(third) = third.get(id) {
                prop_assert_eq!(third, fact);
            }
        }
    }
}

/// Wood is never lost: at no place does a branch get thinner.
#[test]
fn branches_never_thin() {
    for growth in TREES.iter() {
        let radii = |age: f32| -> BTreeMap<u32, f32> {
            let stand = growth.at(age).expect("a tree");
            stand.ids.iter().copied().zip(stand.skeleton.radii().iter().copied()).collect()
        };
        let mut before = radii(2.0);
        for year in 3..14 {
            let after = radii(f32::from(year as u16));
            for (id, radius) in &before {
                if let Some(after) = after.get(id) {
                    assert!(*after >= *radius, "node {id}: {radius} to {after} in year {year}");
                }
            }
            before = after;
        }
    }
}

/// At the end of a year every branch is as long as the sum of its shoots, and each internode of a shoot as its others.
#[test]
fn internodes_of_a_shoot_are_equal() {
    let stand = TREES[0].at(9.0).expect("a tree");
    let (positions, stages) = (stand.skeleton.positions(), stand.skeleton.stages());
    for branch in stand.skeleton.branches().iter() {
        let internodes: Vec<(u16, f32)> = branch
            .nodes()
            .windows(2)
            .map(|pair| [pair[0] as usize, pair[1] as usize])
            .map(|[from, to]| (stages[to], positions[from].distance(positions[to])))
            .collect();
        for pair in internodes.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            assert!((pair[0].1 - pair[1].1).abs() < 1e-4 + 1e-3 * pair[0].1);
        }
    }
}

#[test]
fn the_trunk_is_as_long_as_its_curve_says() {
    let height = Curve::new([[0.0, 0.0], [0.5, 6.0], [1.0, 8.0]]).expect("a curve");
    let species = Architecture::default().with_years(10).with_height(height.clone()).with_most_order(1);
    let growth = Growth::new(species, 2).expect("a tree");
    for year in 1..=10u16 {
        let stand = growth.at(f32::from(year)).expect("a tree");
        // The first branch is the trunk, and its first node the tree's first.
        let trunk = lengths(&stand)[&1];
        assert!((trunk - height.at(f32::from(year) / 10.0)).abs() < 1e-3, "{trunk} in year {year}");
    }
}

#[test]
fn same_seed_same_bits_and_other_seeds_other_trees() {
    let at = |seed: u64, age: f32| {
        hash(&Growth::new(Architecture::default(), seed).expect("a tree").at(age).expect("it"))
    };
    assert_eq!(at(1, 7.5), at(1, 7.5));
    assert!(at(1, 7.5) != at(2, 7.5) && at(1, 7.5) != at(1 << 40, 7.5));
}

/// Branch by branch, as ever. The hashes change only with a line in CHANGELOG.md.
#[test]
fn presets_grow_the_same_trees_as_ever() {
    let mut found = String::new();
    for preset in presets::grown() {
        let growth = preset.grow(preset.seed).expect("a tree");
        let ages = preset.ages.iter().filter(|&&age| age < 13.0);
        let hashes = ages.flat_map(|&age| hash(&growth.at(age).expect("a tree")).to_le_bytes());
        writeln!(found, "{} {:016x}", preset.name, fnv1a(hashes)).expect("strings take everything");
    }
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/growth/pinned.txt");
    if std::env::var_os("TREESYNTH_PIN").is_some() {
        std::fs::write(table, found).expect("the table can be written");
        return;
    }
    let pinned = std::fs::read_to_string(table).expect("tests/it/growth/pinned.txt");
    assert_eq!(
        found, pinned,
        "equal seeds no longer give equal trees; if that is meant, say so in CHANGELOG.md and pin them with \
         TREESYNTH_PIN=1 cargo test --all-features --test it presets_grow"
    );
}
