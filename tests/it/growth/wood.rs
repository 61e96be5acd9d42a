//! Wood over the years: limbs die before they break, rings stay, forks keep their cross-section.

use std::collections::BTreeMap;
use treesynth::growth::{Architecture, Growth, TreeAtAge};

/// A name, the species, and its years.
type Kind = (&'static str, fn() -> Architecture, f32);

const SPECIES: [Kind; 8] = [
    ("cottonwood", Architecture::cottonwood, 27.0),
    ("spruce", Architecture::spruce, 40.0),
    ("Lombardy poplar", Architecture::lombardy_poplar, 30.0),
    ("weeping birch", Architecture::weeping_birch, 30.0),
    ("oak", Architecture::spreading_oak, 40.0),
    ("maple", Architecture::norway_maple, 40.0),
    ("ash", Architecture::european_ash, 40.0),
    ("horse chestnut", Architecture::horse_chestnut, 40.0),
];

/// The length of the internode below each node, and whether it lives, by number.
fn internodes(tree: &TreeAtAge) -> BTreeMap<u32, (f32, bool)> {
    let places = tree.skeleton.positions();
    let each = tree
        .skeleton
        .edges()
        .map(|(node, parent)| (tree.ids[node], (places[node].distance(places[parent]), !tree.dead[node])));
    each.collect()
}

#[test]
fn no_living_limb_vanishes() {
    for (name, species, years) in SPECIES {
        for seed in 1..=2 {
            let growth = Growth::new(species().with_most_order(2), seed).expect("a species in range");
            let mut before: Option<BTreeMap<u32, (f32, bool)>> = None;
            let (mut worst, mut broken, mut bare, mut all) = (0.0_f32, 0, 0, 0);
            for step in 0..=10 {
                let age = years - 1.0 + 0.1 * step as f32;
                let tree = growth.at(age.min(years)).expect("an age in range");
                for leaf in &tree.leaves {
                    assert!(!tree.dead[leaf.node as usize], "{name}: a leaf on dead wood");
                }
                let now = internodes(&tree);
                if let Some(before) = before {
                    let gone = before.iter().filter(|(id, _)| !now.contains_key(id));
                    let (living, dead): (Vec<_>, Vec<_>) = gone.partition(|(_, internode)| internode.1);
                    worst = worst.max(living.iter().map(|(_, internode)| internode.0).sum());
                    broken += dead.len();
                }
                bare += now.values().filter(|internode| !internode.1).count();
                all += now.len();
                before = Some(now);
            }
            println!(
                "{name}, seed {seed}: {worst} m living gone, {broken} dead internodes, {bare} of {all} bare"
            );
            assert!(worst <= 0.2, "{name}, seed {seed}: {worst} m of living shoot gone in a tenth of a year");
            assert!(broken > 20 && bare > 20, "{name}, seed {seed}: {broken} {bare}");
        }
    }
}

#[test]
fn no_wood_thins_and_forks_keep_their_cross_section() {
    for (name, species, years) in SPECIES {
        for seed in 1..=2 {
            let growth = Growth::new(species().with_most_order(3), seed).expect("a species in range");
            let mut before: BTreeMap<u32, f32> = BTreeMap::new();
            for age in [0.1, 0.2, 0.25, 0.27, 0.5, 0.75, 0.8, 0.97, 0.99, 1.0].map(|part| part * years) {
                let tree = growth.at(age).expect("an age in range");
                let radii = tree.skeleton.radii();
                let now: BTreeMap<u32, f32> = tree.ids.iter().copied().zip(radii.iter().copied()).collect();
                for (id, radius) in &now {
                    assert!(before.get(id).is_none_or(|before| before <= radius), "{name} at {age}: {id}");
                }
                before = now;
                let mut children = vec![(0, 0.0_f64); radii.len()];
                for (node, parent) in tree.skeleton.edges() {
                    children[parent].0 += 1;
                    children[parent].1 += f64::from(radii[node]).powi(2);
                }
                let mut ratios: Vec<f64> = children
                    .iter()
                    .zip(radii)
                    .filter(|((count, _), _)| *count > 1)
                    .map(|((_, area), &radius)| area / f64::from(radius).powi(2))
                    .collect();
                ratios.sort_by(f64::total_cmp);
                if ratios.is_empty() {
                    continue;
                }
                let at = |part: f64| ratios[((ratios.len() - 1) as f64 * part) as usize];
                let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
                println!(
                    "{name}, {age}: {} forks, mean {mean:.3}, {:.3} {:.3} {:.3}",
                    ratios.len(),
                    at(0.05),
                    at(0.5),
                    at(0.95)
                );
                assert!((0.9..=1.2).contains(&mean), "{name} at {age}: {mean}");
                assert!(at(0.05) >= 0.7 && at(0.95) <= 1.2, "{name} at {age}: {} {}", at(0.05), at(0.95));
            }
            let tree = growth.at(years).expect("an age in range");
            println!(
                "{name}: {} m across, tip {}",
                2.0 * tree.skeleton.radii()[0],
                tree.skeleton.radii().iter().copied().fold(1.0, f32::min)
            );
        }
    }
}

/// Two buds face each other at each metamer, each pair across the one before; laterals spring in pairs as well.
#[test]
fn opposite_species_bear_pairs() {
    for species in
        [Architecture::norway_maple(), Architecture::european_ash(), Architecture::horse_chestnut()]
    {
        let single = species.clone().with_forking(0.0).with_variation(0.0).with_most_order(1);
        for seed in 1..=3 {
            let tree =
                Growth::new(single.clone(), seed).expect("a species in range").at(6.0).expect("an age");
            let (skeleton, places) = (&tree.skeleton, tree.skeleton.positions());
            let mut laterals: BTreeMap<usize, Vec<_>> = BTreeMap::new();
            for (node, parent) in skeleton.edges().filter(|&(node, _)| skeleton.orders()[node] == 1) {
                if skeleton.orders()[parent] == 0 {
                    laterals.entry(parent).or_default().push(places[node] - places[parent]);
                }
            }
            let pairs = laterals.values().filter(|found| found.len() == 2);
            let facing = pairs.filter(|pair| {
                let [a, b] = [pair[0], pair[1]].map(|way| way.with_y(0.0));
                a.angle_between(b).to_degrees() > 170.0
            });
            let facing = facing.count();
            assert!(facing >= 5 && facing * 10 >= 7 * laterals.len(), "{facing} of {}", laterals.len());
            assert!(tree.buds.len() > 20, "{}", tree.buds.len());
        }
    }
}

/// Forks of like strength: both halves within a quarter of each other's thickness, leaning apart.
#[test]
fn branches_fork() {
    let forks = |species: Architecture, seed| {
        let tree = Growth::new(species, seed).expect("a species in range").at(20.0).expect("an age");
        let skeleton = &tree.skeleton;
        let mut children = vec![Vec::new(); skeleton.len()];
        for (node, parent) in skeleton.edges() {
            children[parent].push(node);
        }
        let thick = skeleton.radii()[0];
        let codominant = (0..skeleton.len()).filter(|&node| {
            let mut radii: Vec<f32> = children[node].iter().map(|&child| skeleton.radii()[child]).collect();
            radii.sort_by(f32::total_cmp);
            matches!(radii[..], [.., second, first] if first > 0.15 * thick && second > 0.75 * first)
        });
        codominant.count()
    };
    for seed in 1..=4 {
        let [plain, forked] = [0.0, 0.3]
            .map(|chance| forks(Architecture::norway_maple().with_most_order(3).with_forking(chance), seed));
        println!("seed {seed}: {plain} and {forked} forks of like strength");
        assert!(forked >= plain + 3, "{plain} {forked}");
    }
}

#[test]
fn leaves_turn_to_the_light_as_far_as_asked() {
    let upward = |weight: f32| {
        let species = Architecture::cottonwood().with_most_order(2);
        let phenology = species.phenology().clone().with_light_turn(weight);
        let growth = Growth::new(species.with_phenology(phenology), 1).expect("a species in range");
        let leaves = growth.at(8.6).expect("an age").leaves;
        leaves.iter().map(|leaf| leaf.normal.y).sum::<f32>() / leaves.len() as f32
    };
    let found = [0.0, 1.5, 20.0].map(upward);
    assert!(found[0] + 0.1 < found[1] && found[1] < found[2], "{found:?}");
}
