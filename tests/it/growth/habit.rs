//! Habit of grown species: crowns are more than tufts at the ends of bare limbs.

use treesynth::growth::TreeAtAge;
use treesynth::presets;

/// Limbs shorter than this are twigs, metres; the second is for trees younger than [`YOUNG`], whose limbs are all short.
const LIMB: [f32; 2] = [2.0, 1.0];
/// Years below which a tree is young.
const YOUNG: f32 = 10.0;
/// Share of a limb's length from its base that counts as long.
const LONG: f32 = 0.4;

/// Of the living limbs of so many metres: their number, the mean share of their length from the base to the first leaf or the first lateral that
/// bears one, and the share of limbs where that is long.
fn bare(tree: &TreeAtAge, limb: f32) -> [f32; 3] {
    let skeleton = &tree.skeleton;
    let mut clothed = vec![false; skeleton.len()];
    tree.leaves.iter().for_each(|leaf| clothed[leaf.node as usize] = true);
    let branches = skeleton.branches();
    let branches: Vec<_> = branches.iter().collect();
    // Laterals come after their parent branches.
    for branch in branches.iter().rev() {
        let is_clothed = branch.nodes()[1..].iter().any(|&node| clothed[node as usize]);
        clothed[branch.nodes()[0] as usize] |= is_clothed;
    }
    let (mut count, mut sum, mut long) = (0.0, 0.0, 0.0);
    for branch in branches.iter().filter(|branch| branch.order() > 0) {
        let nodes = branch.nodes();
        let place = |node: u32| skeleton.positions()[node as usize];
        let internode = |pair: &[u32]| place(pair[0]).distance(place(pair[1]));
        let length: f32 = nodes.windows(2).map(internode).sum();
        if length < limb || tree.dead[nodes[1] as usize] {
            continue;
        }
        let first = nodes[1..].iter().position(|&node| clothed[node as usize]).unwrap_or(nodes.len() - 2);
        let share = nodes[..first + 2].windows(2).map(internode).sum::<f32>() / length;
        count += 1.0;
        sum += share;
        long += f32::from(u8::from(share > LONG));
    }
    [count, sum / count.max(1.0), long / count.max(1.0)]
}

/// From eight years on. The first shoots of a limb bear little, some 0.7 m in all, which is much of the short limbs of a young tree.
#[test]
fn limbs_are_clothed_along_their_length() {
    let mut bald = Vec::new();
    for preset in presets::grown().filter(|preset| !preset.planar && matches!(preset.figure, 0 | 15)) {
        let last = *preset.ages.last().expect("ages");
        for seed in 1..=3 {
            let growth = preset.grow(seed).expect("a species");
            for age in [8.6, 12.6, 16.6, 20.6, 26.6].into_iter().filter(|&age| age < last).chain([last]) {
                let is_young = age < YOUNG;
                let tree = growth.at(age).expect("an age");
                let [limbs, mean, long] = bare(&tree, LIMB[usize::from(is_young)]);
                let found = format!(
                    "{}, seed {seed}, at {age}: {limbs} limbs, {mean:.3} bare, {long:.3} for long",
                    preset.name
                );
                println!("{found}");
                assert!(limbs > if age < last { 0.0 } else { 20.0 }, "{found}");
                let [most, longest] = if is_young { [0.5, 0.55] } else { [0.35, 0.26] };
                if mean >= most || long >= longest {
                    bald.push(found);
                }
            }
        }
    }
    assert!(bald.is_empty(), "{}", bald.join("\n"));
}

/// A birch of 4.6 years is a small tree in leaf, not a whip.
#[test]
fn a_young_birch_is_a_tree() {
    let preset = presets::by_name("growth-weeping-birch").expect("a preset").grown().unwrap();
    for seed in 1..=4 {
        let tree = preset.grow(seed).expect("a species").at(4.6).expect("an age");
        let places = tree.skeleton.positions();
        let high = places.iter().map(|place| place.y).fold(0.0, f32::max);
        let wide = places.iter().map(|place| place.with_y(0.0).length()).fold(0.0, f32::max);
        let branches = tree.skeleton.branches();
        let base = branches
            .iter()
            .filter(|branch| branch.order() == 1)
            .map(|branch| places[branch.nodes()[0] as usize].y);
        let lowest = base.fold(f32::INFINITY, f32::min);
        assert!((3.0..5.0).contains(&high) && 2.0 * wide > 0.35 * high, "{seed}: {high} by {wide}");
        assert!(tree.leaves.len() > 310 && lowest < 0.3 * high, "{seed}: {} {lowest}", tree.leaves.len());
    }
}
