//! Wood over the years: limbs die before they break, rings stay, forks keep their cross-section.

use std::collections::BTreeMap;
use treesynth::growth::{Growth, Species, TreeAtAge};

const SPECIES: [(&str, fn() -> Species, f32); 5] = [
    ("cottonwood", Species::cottonwood, 27.0),
    ("spruce", Species::spruce, 40.0),
    ("Lombardy poplar", Species::lombardy_poplar, 30.0),
    ("weeping birch", Species::weeping_birch, 30.0),
    ("oak", Species::spreading_oak, 40.0),
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
            let growth = Growth::new(species().with_most_order(3), seed).expect("a species in range");
            let mut before: Option<BTreeMap<u32, (f32, bool)>> = None;
            let (mut worst, mut broken, mut bare, mut all) = (0.0_f32, 0, 0, 0);
            for step in 0..=12 {
                let age = years - 1.2 + 0.1 * step as f32;
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
            assert!(broken > 100 && bare > 100, "{name}, seed {seed}: {broken} {bare}");
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
