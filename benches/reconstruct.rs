//! Ten broadleaved trees of 10 m, leaf-off, scanned from three places and reconstructed: how near, and in which time.

mod measure;

use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;
use measure::{count, is_test, print_table};
use std::f64::consts::PI;
use std::time::Instant;
use treesynth::glam::{Quat, Vec3};
use treesynth::metrics::diameter_at;
use treesynth::reconstruct::Reconstruct;
use treesynth::scan::Scanner;
use treesynth::surface::{Part, Tubes};
use treesynth::{Skeleton, species};

const SPECIES: [&str; 10] = [
    "English oak",
    "silver birch",
    "beech",
    "Norway maple",
    "sycamore",
    "ash",
    "small-leaved lime",
    "horse chestnut",
    "London plane",
    "cherry",
];
/// Metres to the other skeleton within which a place counts.
const NEAR: f32 = 0.05;
/// Radii from which branches, and wood, count, metres.
const BRANCHES: f32 = 0.005;
const WOOD: f32 = 0.025;

/// A place on a tree: where, the radius, the length it stands for, the branch order.
type Place = (Vec3, f32, f64, u16);

/// Places every centimetre.
fn places(tree: &Skeleton) -> Vec<Place> {
    let mut places = Vec::new();
    for (node, parent) in tree.edges() {
        let (start, end) = (tree.positions()[parent], tree.positions()[node]);
        let steps = (start.distance(end) / 0.01).ceil().max(1.0);
        for i in 0..steps as usize {
            let at = start.lerp(end, (i as f32 + 0.5) / steps);
            places.push((
                at,
                tree.radii()[node],
                f64::from(start.distance(end) / steps),
                tree.orders()[node],
            ));
        }
    }
    places
}

/// The share of the branches of one tree that lies near another, whatever is there.
fn share(one: &[Place], other: &[Place]) -> f64 {
    let points: Vec<[f32; 3]> = other.iter().map(|place| place.0.to_array()).collect();
    let tree = ImmutableKdTree::<f32, u32, 3, 32>::new_from_slice(&points);
    let (mut hits, mut all) = (0.0, 0.0);
    for (at, _, length, _) in one.iter().filter(|place| place.1 > BRANCHES) {
        all += length;
        if tree.nearest_one::<SquaredEuclidean>(&at.to_array()).distance <= NEAR * NEAR {
            hits += length;
        }
    }
    hits / all
}

/// The share of a tree's wood, by volume, at which the nearest place of another has the same branch order.
fn order(truth: &[Place], found: &[Place]) -> f64 {
    let points: Vec<[f32; 3]> = found.iter().map(|place| place.0.to_array()).collect();
    let tree = ImmutableKdTree::<f32, u32, 3, 32>::new_from_slice(&points);
    let (mut hits, mut all) = (0.0, 0.0);
    for (at, radius, length, order) in truth.iter().filter(|place| place.1 > WOOD) {
        let volume = length * f64::from(radius * radius);
        let nearest = tree.nearest_one::<SquaredEuclidean>(&at.to_array()).item;
        all += volume;
        hits += if found[nearest as usize].3 == *order { volume } else { 0.0 };
    }
    hits / all
}

/// Trees that stand so close that their crowns touch: species, height and place of each.
const STAND: [(&str, f32, [f32; 2]); 4] = [
    ("London plane", 8.0, [0.0, 0.0]),
    ("ash", 8.4, [2.6, 0.4]),
    ("sycamore", 8.8, [0.3, 2.8]),
    ("ash", 9.2, [3.0, 3.2]),
];

/// The stand, scanned from five places: for each tree how much of it comes back.
fn stand(step: f32) -> Vec<Vec<String>> {
    let grow = |(seed, (name, height, _)): (u64, &(&str, f32, [f32; 2]))| {
        let request = species::by_name(name).expect("a species").request();
        request.with_height(*height).with_day(20.0).with_seed(seed).grow().expect("a tree").skeleton
    };
    let trees: Vec<Skeleton> = (1..).zip(&STAND).map(grow).collect();
    let tubes = Tubes::default().with_sides(32).with_root_flare(0.0);
    let meshes: Vec<_> = trees.iter().map(|tree| tubes.mesh(tree).expect("a mesh")).collect();
    let at = STAND.map(|(_, _, [x, z])| Vec3::new(x, 0.0, z));
    let parts: Vec<Part<'_>> =
        meshes.iter().zip(at).map(|(mesh, at)| Part::new(mesh).at(at, Quat::IDENTITY, 1.0)).collect();
    let scanner = Scanner::around(Vec3::new(1.3, 1.7, 1.5), 9.0, 5).with_step(step);
    let scan = scanner.scan(&parts, 1).expect("a scan");
    let start = Instant::now();
    let found = Reconstruct::default().reconstruct_stand(&scan.cloud).expect("trees");
    let seconds = start.elapsed().as_secs_f64();
    println!("{} points, {} trees in {seconds:.1} s", count(scan.cloud.len()), found.trees.len());
    let mut rows = Vec::new();
    for (part, (truth, place)) in (0_u32..).zip(trees.iter().zip(at)) {
        let far = |tree: usize| found.trees[tree].skeleton.positions()[0].distance(place);
        let tree = (0..found.trees.len()).min_by(|&a, &b| far(a).total_cmp(&far(b))).expect("a tree");
        let own = || scan.truth.iter().zip(&found.owners).filter(|(truth, _)| truth.part == part);
        let right = own().filter(|(_, owner)| **owner == Some(tree as u32)).count();
        let dbh = |tree: &Skeleton| 1000.0 * diameter_at(tree, 1.3).unwrap_or(0.0);
        let skeleton = &found.trees[tree].skeleton;
        rows.push(vec![
            STAND[part as usize].0.to_owned(),
            count(own().count()),
            format!("{:.3}", right as f64 / own().count() as f64),
            format!("{:.1}", dbh(truth)),
            format!("{:+.1}", dbh(skeleton) - dbh(truth)),
            format!("{:+.1} %", 100.0 * (wood(skeleton) / wood(truth) - 1.0)),
        ]);
    }
    rows
}

fn wood(tree: &Skeleton) -> f64 {
    let volume = |(node, parent): (usize, usize)| {
        let radius = f64::from(tree.radii()[node]);
        let length = f64::from(tree.positions()[node].distance(tree.positions()[parent]));
        if tree.radii()[node] > WOOD { PI * radius * radius * length } else { 0.0 }
    };
    tree.edges().map(volume).sum()
}

fn main() {
    let (species, step) = if is_test() { (&SPECIES[8..9], 0.003) } else { (&SPECIES[..], 0.0008) };
    let mut rows = Vec::new();
    for name in species {
        let request = species::by_name(name).expect("a species").request();
        let truth = request.with_height(10.0).with_day(20.0).with_seed(1).grow().expect("a tree").skeleton;
        let tubes = Tubes::default().with_sides(32).with_root_flare(0.0).with_wind(true);
        let mesh = tubes.mesh(&truth).expect("a mesh");
        let scanner = Scanner::around(Vec3::Y * 1.7, 10.0, 3).with_step(step);
        let start = Instant::now();
        let cloud = scanner.scan(&[Part::new(&mesh)], 1).expect("a scan").cloud;
        let scanned = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let found = Reconstruct::default().reconstruct(&cloud).expect("a tree").skeleton;
        let seconds = start.elapsed().as_secs_f64();
        let (own, true_places) = (places(&found), places(&truth));
        let (recall, precision) = (share(&true_places, &own), share(&own, &true_places));
        let dbh = |tree: &Skeleton| 1000.0 * diameter_at(tree, 1.3).unwrap_or(0.0);
        rows.push(vec![
            (*name).to_owned(),
            count(cloud.len()),
            format!("{scanned:.1}"),
            format!("{seconds:.1}"),
            format!("{precision:.3}"),
            format!("{recall:.3}"),
            format!("{:.3}", 2.0 * recall * precision / (recall + precision)),
            format!("{:.1}", dbh(&truth)),
            format!("{:+.1}", dbh(&found) - dbh(&truth)),
            format!("{:.0}", 1000.0 * wood(&truth)),
            format!("{:+.1} %", 100.0 * (wood(&found) / wood(&truth) - 1.0)),
            format!("{:.3}", order(&true_places, &own)),
        ]);
    }
    print_table(
        "reconstruction of 10 m trees from three places, 2 mm noise; branches over 1 cm within 5 cm, wood over 5 cm",
        &[
            "tree",
            "points",
            "scan, s",
            "time, s",
            "precision",
            "recall",
            "F",
            "DBH, mm",
            "off, mm",
            "wood, dm³",
            "off",
            "order right",
        ],
        &rows,
    );
    print_table(
        "a stand of four trees from five places",
        &["tree", "points", "given to it", "DBH, mm", "off, mm", "wood, off"],
        &stand(if is_test() { 0.003 } else { 0.0012 }),
    );
}
