//! The feature that each figure of the paper shows, as a number.

use std::collections::BTreeMap;
use treesynth::glam::Vec3;
use treesynth::growth::{Growth, TreeAtAge};
use treesynth::metrics::Metrics;
use treesynth::presets::{self, Grown};

fn preset(name: &str) -> &'static Grown {
    presets::by_name(name).expect("a preset of this name").grown().unwrap()
}

fn growth(name: &str) -> Growth {
    preset(name).grow(1).expect("a tree")
}

/// A first-order branch: where it springs, the year of its first shoot, its places from its base.
struct Limb {
    year: u16,
    places: Vec<Vec3>,
}

impl Limb {
    fn length(&self) -> f32 {
        self.places.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    fn height(&self) -> f32 {
        self.places[0].y
    }

    /// The angle from up of the direction at a part of its length, degrees.
    fn inclination(&self, part: f32) -> f32 {
        let last = self.places.len() - 2;
        let i = ((part * last as f32) as usize).min(last);
        let direction = self.places[i + 1] - self.places[i];
        treesynth::math::angle_between(direction, Vec3::Y).to_degrees()
    }
}

/// The living first-order branches by the numbers of their first nodes.
fn limbs(stand: &TreeAtAge) -> BTreeMap<u32, Limb> {
    let skeleton = &stand.skeleton;
    let branches = skeleton.branches();
    let limbs = branches
        .iter()
        .filter(|branch| branch.order() == 1 && !stand.dead[branch.nodes()[1] as usize])
        .map(|branch| {
            let first = branch.nodes()[1] as usize;
            let places = branch.nodes().iter().map(|&node| skeleton.positions()[node as usize]).collect();
            (stand.ids[first], Limb { year: skeleton.stages()[first], places })
        });
    limbs.collect()
}

fn height(stand: &TreeAtAge) -> f32 {
    stand.skeleton.positions().iter().map(|p| p.y).fold(0.0, f32::max)
}

/// "The contours become more rounded as the tree ages": the longest branch beside the trunk, and the middle of the crown
/// beside its foot.
#[test]
fn figure_8_rounder_contours() {
    let growth = growth("growth-08-lengths");
    let shape = |age: f32| {
        let stand = growth.at(age).expect("a tree");
        let limbs = limbs(&stand);
        let tall = height(&stand);
        assert!(stand.skeleton.positions().iter().all(|p| p.z.abs() < 1e-3 * tall), "not flat");
        let longest = limbs.values().map(Limb::length).fold(0.0, f32::max);
        longest / height(&stand)
    };
    let [young, middle, old] = [4.0, 14.0, 27.0].map(shape);
    assert!(
        young < 0.33 && young + 0.05 < middle && middle + 0.05 < old && old > 0.45,
        "{young} {middle} {old}"
    );
    // Two branches per year on a trunk of so many years, none lost.
    assert_eq!(limbs(&growth.at(27.0).expect("a tree")).len(), 2 * 26);
}

/// Short branches turn up along their way; long ones sink first and rise then.
#[test]
fn figure_9_headings() {
    let stand = growth("growth-09-headings").at(27.0).expect("a tree");
    let (mut short, mut long) = (0, 0);
    for limb in limbs(&stand).values() {
        let [base, low, middle, tip] = [0.0, 0.3, 0.55, 1.0].map(|part| limb.inclination(part));
        if limb.length() < 2.5 {
            assert!(tip < base - 12.0 && low <= base + 4.0, "{base} {low} {tip}");
            short += 1;
        } else if limb.length() > 9.0 {
            assert!(low > base + 10.0 && tip < middle - 20.0, "{base} {low} {middle} {tip}");
            long += 1;
        }
    }
    assert!(short > 2 && long > 10, "{short} {long}");
}

/// The scale factor alone makes some branches half as long as their neighbours.
#[test]
fn figure_10_scale() {
    let [plain, scaled] =
        ["growth-09-headings", "growth-10-scale"].map(|name| limbs(&growth(name).at(27.0).expect("a tree")));
    assert_eq!(plain.len(), scaled.len());
    let ratios: Vec<f32> = plain.iter().map(|(id, limb)| scaled[id].length() / limb.length()).collect();
    let short = ratios.iter().filter(|&&ratio| ratio < 0.5).count();
    let long = ratios.iter().filter(|&&ratio| ratio > 0.85).count();
    assert!(short > 8 && long > 8, "{ratios:?}");
    assert!(ratios.iter().all(|&ratio| ratio > 0.25 && ratio <= 1.0001), "{ratios:?}");
}

/// "Shorter branches are only observed near the top of the tree where they are younger."
#[test]
fn figure_11_loss() {
    // Limbs by year and side: those that are lost leave their numbers to others.
    let sides = |name: &str| -> BTreeMap<(u16, bool), Limb> {
        let limbs = limbs(&growth(name).at(27.0).expect("a tree"));
        limbs
            .into_values()
            .map(|limb| ((limb.year, limb.places[limb.places.len() - 1].x > 0.0), limb))
            .collect()
    };
    let [plain, all, kept] = ["growth-09-headings", "growth-10-scale", "growth-11-loss"].map(sides);
    assert_eq!((plain.len(), all.len()), (52, 52));
    assert!(kept.len() * 4 < all.len() * 3 && kept.len() > 10, "{}", kept.len());
    let mut tops = Vec::new();
    for (key, limb) in &all {
        let (scale, age) = (limb.length() / plain[key].length(), 28 - limb.year);
        // Lost by the age of seven at a scale of 0.6; never at 0.8.
        if scale > 0.85 || age < 3 {
            assert!(kept.contains_key(key), "{scale} of year {}", limb.year);
        } else if scale < 0.55 && age > 7 {
            assert!(!kept.contains_key(key), "{scale} of year {}", limb.year);
        }
        if scale < 0.5 && kept.contains_key(key) {
            tops.push(limb.height() / 24.0);
        }
    }
    assert!(!tops.is_empty() && tops.iter().all(|&height| height > 0.75), "{tops:?}");
}

/// Metamer after metamer elongates, each with its leaf; buds come last.
#[test]
fn figure_12_a_shoot_unfolds() {
    let preset = preset("growth-12-shoot");
    let growth = growth("growth-12-shoot");
    let stands: Vec<TreeAtAge> = preset.ages.iter().map(|&age| growth.at(age).expect("a shoot")).collect();
    for pair in stands.windows(2) {
        assert!(height(&pair[0]) < height(&pair[1]) && pair[0].skeleton.len() <= pair[1].skeleton.len());
        assert!(pair[0].leaves.len() <= pair[1].leaves.len());
    }
    let internode = |stand: &TreeAtAge, node: usize| {
        stand.skeleton.positions()[node].distance(stand.skeleton.positions()[node - 1])
    };
    // Half way the lowest internode is done, while the highest that there is has just begun.
    let half = &stands[3];
    let below = growth.at(1.0).expect("a shoot").skeleton.len();
    let done = internode(&stands[5], below);
    assert!(internode(half, below) > 0.99 * done && internode(half, half.skeleton.len() - 1) < 0.3 * done);
    let (first, last) = (half.leaves[0].length, half.leaves[half.leaves.len() - 1].length);
    assert!(last < 0.5 * first, "{first} {last}");
    let winter = growth.at(2.0).expect("a shoot");
    let metamers = winter.skeleton.len() - below;
    assert_eq!((stands[5].leaves.len(), stands[5].skeleton.len()), (metamers, winter.skeleton.len()));
    // One bud in each axil and one at the tip.
    assert_eq!((winter.leaves.len(), winter.buds.len()), (0, metamers + 1));
    assert!(winter.buds[0].length > 3.0 * stands[3].buds[0].length);
}

/// None in winter, small and light in spring, dark in summer, yellow and fewer in autumn, none again.
#[test]
fn figure_13_foliage_over_the_year() {
    let preset = preset("growth-13-foliage");
    let growth = growth("growth-13-foliage");
    let stands: Vec<TreeAtAge> = preset.ages.iter().map(|&age| growth.at(age).expect("a tree")).collect();
    let counts: Vec<usize> = stands.iter().map(|stand| stand.leaves.len()).collect();
    assert_eq!((counts[0], counts[7]), (0, 0));
    assert!(counts[1] < counts[3] && counts[6] * 2 < counts[3] && counts[6] > 0, "{counts:?}");
    let mean = |stand: &TreeAtAge, of: fn(&treesynth::growth::Leaf) -> f32| {
        stand.leaves.iter().map(of).sum::<f32>() / stand.leaves.len() as f32
    };
    let size = |stand: &TreeAtAge| mean(stand, |leaf| leaf.length);
    assert!(size(&stands[1]) < 0.5 * size(&stands[3]), "{} {}", size(&stands[1]), size(&stands[3]));
    // Green outweighs red until autumn turns it round; summer is darker than spring.
    let redness = |stand: &TreeAtAge| mean(stand, |leaf| leaf.color[0] / leaf.color[1]);
    assert!(
        redness(&stands[3]) < 0.6 && redness(&stands[5]) > 1.2,
        "{} {}",
        redness(&stands[3]),
        redness(&stands[5])
    );
    assert!(mean(&stands[3], |leaf| leaf.color[1]) < mean(&stands[1], |leaf| leaf.color[1]));
}

/// A broom stick first, a rounded crown at last: its width beside its height, and where it is widest. Limbs of 40° to 80°
/// to the trunk; inside of the old crown few short branches are left.
#[test]
fn figure_15_cottonwood() {
    let growth = growth("growth-15-cottonwood");
    let stoutness = [2.0, 5.0, 10.0, 18.0, 27.0].map(|age| {
        let metrics = Metrics::of(&growth.at(age).expect("a tree").skeleton);
        metrics.crown_width / metrics.height
    });
    assert!(stoutness[0] < 0.15 && stoutness[1] < 0.25 && stoutness[2] < 0.35, "{stoutness:?}");
    assert!(stoutness[3] > 0.35 && stoutness[4] > 0.5 && stoutness[4] < 0.9, "{stoutness:?}");

    let old = growth.at(27.0).expect("a tree");
    assert!(old.skeleton.segments() > 150_000, "{} internodes", old.skeleton.segments());
    let tall = height(&old);
    let width = |low: f32, high: f32| {
        let within = |p: &&Vec3| p.y > low * tall && p.y < high * tall;
        old.skeleton.positions().iter().filter(within).map(|p| p.with_y(0.0).length()).fold(0.0, f32::max)
    };
    let (foot, middle, top) = (width(0.05, 0.15), width(0.45, 0.7), width(0.95, 1.0));
    assert!(foot < 0.2 * middle && top < 0.6 * middle, "{foot} {middle} {top}");

    let limbs = limbs(&old);
    let long: Vec<&Limb> = limbs.values().filter(|limb| limb.length() > 7.0).collect();
    assert!(long.len() > 8, "{}", long.len());
    let mean = |part: f32| long.iter().map(|limb| limb.inclination(part)).sum::<f32>() / long.len() as f32;
    let [base, middle, tip] = [0.0, 0.3, 1.0].map(mean);
    assert!(base > 30.0 && middle > base + 8.0 && tip < middle - 15.0, "{base} {middle} {tip}");
    // Of the limbs that ever sprang in the first ten years, most are lost, and the short ones among them all.
    let ages = (1..=11).map(|age| growth.at(age as f32).expect("a tree"));
    let mut sprung: BTreeMap<u32, u16> = BTreeMap::new();
    for stand in ages {
        sprung.extend(self::limbs(&stand).iter().map(|(&id, limb)| (id, limb.year)));
    }
    let left = sprung.keys().filter(|id| limbs.contains_key(id)).count();
    assert!(left * 2 < sprung.len() && left > 5, "{left} of {}", sprung.len());
    let shortest = sprung.keys().filter_map(|id| limbs.get(id)).map(Limb::length).fold(f32::MAX, f32::min);
    assert!(shortest > 2.0, "{shortest}");
}

/// Each by what marks it: the shape of its crown, and which way its twigs head.
#[test]
fn species_differ() {
    let at_last = |name: &str| {
        let preset = preset(name);
        let species = preset.architecture().expect("a species").with_most_order(2);
        let years = f32::from(species.years());
        Growth::new(species, 1).expect("a tree").at(years).expect("a tree").skeleton
    };
    let names = ["growth-spruce", "growth-lombardy-poplar", "growth-weeping-birch", "growth-spreading-oak"];
    let [spruce, poplar, birch, oak] = names.map(at_last);
    let breadth = |tree: &treesynth::Skeleton| {
        let metrics = Metrics::of(tree);
        metrics.crown_width / metrics.height
    };
    let found = [&poplar, &spruce, &birch, &oak].map(breadth);
    assert!(
        found[0] < 0.25 && found[1] > 0.35 && found[1] < 0.7 && found[2] > 0.5 && found[3] > 1.0,
        "{found:?}"
    );
    let hanging = |tree: &treesynth::Skeleton| {
        let down =
            tree.edges().filter(|&(node, parent)| tree.positions()[node].y < tree.positions()[parent].y);
        down.count() as f64 / tree.segments() as f64
    };
    assert!(hanging(&birch) > 0.5 && hanging(&poplar) < 0.02, "{} {}", hanging(&birch), hanging(&poplar));
    // A cone is widest near the ground.
    let lowest = |tree: &treesynth::Skeleton| {
        let wide = |a: &&Vec3, b: &&Vec3| a.with_y(0.0).length().total_cmp(&b.with_y(0.0).length());
        let top = tree.positions().iter().map(|p| p.y).fold(0.0, f32::max);
        tree.positions().iter().max_by(wide).map_or(0.0, |p| p.y / top)
    };
    assert!(lowest(&spruce) < 0.3, "{}", lowest(&spruce));
}
