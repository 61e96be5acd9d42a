//! What real clouds have and clean ones have not: reconstruction goes on, or says what is wrong.

use treesynth::cloud::{Cloud, Frame};
use treesynth::glam::{DVec3, Quat, Vec3};
use treesynth::metrics::{diameter_at, height};
use treesynth::radius::check_radii;
use treesynth::reconstruct::{Reconstruct, ReconstructError, Reconstruction};
use treesynth::scan::Scanner;
use treesynth::surface::{Mesh, Part, Tubes};
use treesynth::{Skeleton, species};

/// Numbers of a sequence that has no order to the eye, in [0, 1).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn within(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        low + Vec3::new(self.next(), self.next(), self.next()) * (high - low)
    }

    /// About Gaussian, of deviation 1.
    fn gauss(&mut self) -> f32 {
        (0..12).map(|_| self.next()).sum::<f32>() - 6.0
    }

    fn noise(&mut self) -> Vec3 {
        Vec3::new(self.gauss(), self.gauss(), self.gauss())
    }
}

/// A tree, its points, and the place that each was seen from.
struct Scanned {
    truth: Skeleton,
    mesh: Mesh,
    points: Vec<Vec3>,
    places: Vec<u32>,
}

fn grown(name: &str, tall: f32, seed: u64) -> (Skeleton, Mesh) {
    let request = species::by_name(name).unwrap().request();
    let truth = request.with_height(tall).with_day(20.0).with_seed(seed).grow().unwrap().skeleton;
    let mesh = Tubes::default().with_sides(24).with_root_flare(0.0).mesh(&truth).unwrap();
    (truth, mesh)
}

fn scanner(tall: f32, step: f32) -> Scanner {
    Scanner::around(Vec3::Y * 1.6, 0.5 * tall + 4.0, 3).with_step(step)
}

fn scanned_by(name: &str, tall: f32, seed: u64, scanner: &Scanner) -> Scanned {
    let (truth, mesh) = grown(name, tall, seed);
    let scan = scanner.scan(&[Part::new(&mesh)], seed).unwrap();
    let places = scan.truth.iter().map(|truth| truth.place).collect();
    Scanned { truth, mesh, points: scan.cloud.into_points(), places }
}

fn scanned(name: &str, seed: u64) -> Scanned {
    scanned_by(name, 7.0, seed, &scanner(7.0, 0.0016))
}

/// The trees that all disturbances are tried on.
fn all() -> Vec<Scanned> {
    [("sycamore", 1), ("ash", 2), ("horse chestnut", 3)]
        .map(|(name, seed)| scanned(name, seed))
        .into_iter()
        .collect()
}

/// The share of the wood of one tree thicker than 2 cm that lies within 10 cm of another's axes.
fn near(one: &Skeleton, other: &Skeleton) -> f32 {
    let mut cells = std::collections::BTreeSet::new();
    let cell = |at: Vec3| (at / 0.1).floor().as_ivec3().to_array();
    let along = |tree: &Skeleton, (node, parent): (usize, usize)| {
        let (a, b) = (tree.positions()[parent], tree.positions()[node]);
        let steps = (a.distance(b) / 0.03).ceil().max(1.0) as usize;
        (0..=steps).map(move |i| a.lerp(b, i as f32 / steps as f32)).collect::<Vec<_>>()
    };
    for edge in other.edges() {
        cells.extend(along(other, edge).into_iter().map(cell));
    }
    let (mut hits, mut all) = (0.0, 0.0);
    for edge in one.edges().filter(|edge| one.radii()[edge.0] > 0.01) {
        for place in along(one, edge) {
            all += 1.0;
            let [x, y, z] = cell(place);
            let is_near =
                (-1..=1).any(|i| (-1..=1).any(|j| (-1..=1).any(|k| cells.contains(&[x + i, y + j, z + k]))));
            hits += if is_near { 1.0 } else { 0.0 };
        }
    }
    hits / f32::max(all, 1.0)
}

/// As [`resembles`], with three quarters of what is found on the true tree.
fn holds(what: &str, truth: &Skeleton, found: &Reconstruction, off: f64) {
    resembles(what, truth, found, off, 0.75);
}

/// What a reconstruction must be, whatever the cloud is like: its diameter within a share of the true one, and at least a share of
/// what is found on the true tree.
fn resembles(what: &str, truth: &Skeleton, found: &Reconstruction, off: f64, least: f32) {
    let tree = &found.skeleton;
    tree.check().unwrap();
    check_radii(tree, tree.radii()).unwrap();
    assert!(tree.radii().iter().all(|radius| radius.is_finite() && *radius < 1.0), "{what}");
    for (node, parent) in tree.edges() {
        assert!(tree.radii()[node] <= tree.radii()[parent], "{what}: node {node} is thicker than its parent");
    }
    let [dbh, wanted] = [tree, truth].map(|tree| diameter_at(tree, 1.3).unwrap_or(0.0));
    let (recall, precision) = (near(truth, tree), near(tree, truth));
    println!(
        "{what}: DBH {dbh:.4} of {wanted:.4}, {:+.1} %; recall {recall:.3}, precision {precision:.3}",
        100.0 * (dbh / wanted - 1.0)
    );
    assert!((dbh / wanted - 1.0).abs() < off, "{what}: DBH {dbh} of {wanted}");
    assert!(recall > 0.8 && precision > least, "{what}: recall {recall}, precision {precision}");
}

fn of(points: Vec<Vec3>) -> Cloud {
    Cloud::new(points).unwrap()
}

fn reconstruct(points: Vec<Vec3>) -> Result<Reconstruction, ReconstructError> {
    Reconstruct::default().reconstruct(&of(points))
}

/// A cloud made worse, told the foot; and without, where it must be a tree or an error that says what to do.
fn both(what: &str, tree: &Scanned, points: Vec<Vec3>, off: f64, least: f32) {
    let cloud = of(points);
    let told = Reconstruct::default().with_base(tree.truth.positions()[0]).reconstruct(&cloud);
    let told = told.unwrap_or_else(|error| panic!("{what}, told the base: {error}"));
    resembles(&format!("{what}, told the base"), &tree.truth, &told, off, least);
    match Reconstruct::default().reconstruct(&cloud) {
        Ok(found) => resembles(what, &tree.truth, &found, off, least),
        Err(error) => {
            println!("{what}: {error}");
            assert!(error.to_string().contains("with_base"), "{what}: {error}");
        }
    }
}

#[test]
fn mixed_pixels_and_ghosts() {
    for (name, seed) in [("sycamore", 1), ("ash", 2)] {
        // A wide beam whose echoes are told apart only 30 cm from each other.
        let scanner = scanner(7.0, 0.0016).with_beam(0.006, 0.001).with_separation(0.3);
        let tree = scanned_by(name, 7.0, seed, &scanner);
        let found = reconstruct(tree.points.clone()).unwrap();
        holds("mixed pixels", &tree.truth, &found, 0.06);
        // Points on the way from edges to the scanner, and points in the air.
        let tree = scanned(name, seed);
        let mut chance = Chance(seed);
        let mut points = tree.points.clone();
        for i in (0..tree.points.len()).step_by(40) {
            let to = Vec3::new(7.5, 1.6, 0.0) - tree.points[i];
            points.push(tree.points[i] + to.normalize() * (0.4 * chance.next()));
        }
        let most = tree.points.len() / 50;
        points.extend((0..most).map(|_| chance.within(Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 8.0, 4.0))));
        holds("ghosts", &tree.truth, &reconstruct(points).unwrap(), 0.03);
    }
}

#[test]
fn uneven_density() {
    for tree in all() {
        let mut chance = Chance(1);
        let sparse = tree.points.iter().copied().filter(|at| chance.next() > 0.95 * (at.y / 7.0)).collect();
        holds("sparse top", &tree.truth, &reconstruct(sparse).unwrap(), 0.03);
        let mut dense = tree.points.clone();
        for &at in tree.points.iter().filter(|at| at.y < 2.0) {
            dense.extend((0..6).map(|_| at + chance.noise() * 0.001));
        }
        holds("dense trunk", &tree.truth, &reconstruct(dense).unwrap(), 0.03);
    }
}

#[test]
fn twigs_that_the_wind_moved_and_scans_out_of_register() {
    for tree in all() {
        let seen = || tree.points.iter().zip(&tree.places);
        for far in [0.01, 0.03] {
            let moved = seen()
                .map(|(&at, &place)| {
                    // More towards the tips; each scan at another time.
                    let share = ((at.y - 1.5) / 5.5).clamp(0.0, 1.0) * at.with_y(0.0).length().min(1.0);
                    at + Vec3::new(place as f32 - 1.0, 0.0, (place % 2) as f32) * far * share
                })
                .collect();
            holds(&format!("wind of {far} m"), &tree.truth, &reconstruct(moved).unwrap(), 0.05);
        }
        // A ring of points that is drawn apart is wider by twice that at the most.
        let thick = diameter_at(&tree.truth, 1.3).unwrap();
        for far in [0.003, 0.006] {
            let shifts = [Vec3::new(1.0, 0.2, 0.0), Vec3::new(-0.5, -0.2, 0.9), Vec3::new(-0.5, 0.1, -0.9)];
            let moved = seen().map(|(&at, &place)| at + shifts[place as usize] * far).collect();
            let found = reconstruct(moved).unwrap();
            holds(
                &format!("{far} m out of register"),
                &tree.truth,
                &found,
                0.01 + f64::from(2.0 * far) / thick,
            );
        }
    }
}

/// Ground with bumps around a foot.
fn ground(chance: &mut Chance, count: usize) -> impl Iterator<Item = Vec3> + '_ {
    (0..count).map(move |_| {
        let at = chance.within(Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 0.0, 4.0));
        at.with_y(0.05 * (2.0 * at.x).sin() * (1.5 * at.z).cos() + 0.01 * chance.gauss())
    })
}

/// Blades of grass within a ring.
fn grass(chance: &mut Chance, blades: usize) -> Vec<Vec3> {
    let mut points = Vec::new();
    for _ in 0..blades {
        let foot = chance.within(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 0.0, 2.0));
        let lean = Vec3::new(chance.gauss(), 3.0, chance.gauss()).normalize();
        let tall = 0.1 + 0.3 * chance.next();
        points.extend((0..8).map(|i| foot + lean * (tall * i as f32 / 8.0) + chance.noise() * 0.003));
    }
    points
}

/// A bush of twigs.
fn bush(chance: &mut Chance, foot: Vec3) -> Vec<Vec3> {
    let mut points = Vec::new();
    for _ in 0..60 {
        let way = Vec3::new(chance.gauss(), 2.0, chance.gauss()).normalize();
        let long = 0.4 + 0.5 * chance.next();
        points.extend((0..60).map(|i| foot + way * (long * i as f32 / 60.0) + chance.noise() * 0.004));
    }
    points
}

#[test]
fn grass_shrubs_posts_and_walls_at_the_foot() {
    for (number, tree) in (0..).zip(all()) {
        let mut chance = Chance(number);
        let earth: Vec<Vec3> = ground(&mut chance, 40_000).collect();
        let with = |extra: Vec<Vec3>| [tree.points.clone(), earth.clone(), extra].concat();
        both("ground", &tree, with(Vec::new()), 0.04, 0.75);
        both("grass", &tree, with(grass(&mut chance, 2500)), 0.06, 0.75);
        both("shrub", &tree, with(bush(&mut chance, Vec3::new(0.9, 0.0, 0.3))), 0.04, 0.75);
        let post = (0..4000)
            .map(|i| {
                let (sin, cos) = (i as f32 * 2.4).sin_cos();
                Vec3::new(0.7 + 0.05 * cos, 1.2 * i as f32 / 4000.0, 0.4 + 0.05 * sin)
            })
            .collect();
        both("post", &tree, with(post), 0.04, 0.75);
        let wall = (0..40_000)
            .map(|_| chance.within(Vec3::new(-4.0, 0.0, -1.6), Vec3::new(4.0, 2.5, -1.595)))
            .collect();
        both("wall", &tree, with(wall), 0.04, 0.55);
    }
}

#[test]
fn a_tree_cut_roughly_out_of_a_forest() {
    for tree in all() {
        let (_, neighbour) = grown("ash", 7.5, 9);
        let parts = [
            Part::new(&tree.mesh),
            Part::new(&neighbour).at(Vec3::new(2.6, 0.0, 0.4), Quat::IDENTITY, 1.0),
            Part::new(&neighbour).at(Vec3::new(-1.6, 0.0, -2.2), Quat::from_rotation_y(2.0), 1.0),
        ];
        let cloud = scanner(9.0, 0.0016).scan(&parts, 1).unwrap().cloud;
        // A box with hard edges, without the others' trunks.
        let cut = cloud.into_points().into_iter().filter(|at| {
            at.x.abs() < 1.5 && at.z.abs() < 1.5 || at.y > 3.0 && at.x.abs() < 2.0 && at.z.abs() < 2.0
        });
        let found = reconstruct(cut.collect()).unwrap();
        let tree = &found.skeleton;
        tree.check().unwrap();
        check_radii(tree, tree.radii()).unwrap();
    }
}

#[test]
fn trunks_with_buttresses_and_ivy() {
    for (name, seed) in [("sycamore", 1), ("ash", 2), ("beech", 3)] {
        let (truth, _) = grown(name, 7.0, seed);
        let mesh = Tubes::default().with_sides(24).with_root_flare(1.5).mesh(&truth).unwrap();
        let cloud = scanner(7.0, 0.0016).scan(&[Part::new(&mesh)], seed).unwrap().cloud;
        let flared = Reconstruct::default().reconstruct(&cloud).unwrap();
        holds("root flare", &truth, &flared, 0.05);
        // Leaves of ivy on the lowest 2.5 m of the trunk, up to 8 cm off it.
        let mut chance = Chance(seed);
        let mut points = cloud.points().to_vec();
        for &at in cloud.points().iter().filter(|at| at.y < 2.5 && at.with_y(0.0).length() < 0.3) {
            if chance.next() < 0.4 {
                let out = at.with_y(0.0).normalize_or(Vec3::X);
                points.push(at + out * (0.03 + 0.05 * chance.next()) + chance.noise() * 0.01);
            }
        }
        holds("ivy", &truth, &reconstruct(points).unwrap(), 0.35);
    }
}

#[test]
fn trunks_seen_from_one_side() {
    for (name, seed) in [("sycamore", 1), ("ash", 2), ("horse chestnut", 3)] {
        let one = Scanner::new(vec![Vec3::new(7.5, 1.6, 0.0)]).with_step(0.0012);
        let tree = scanned_by(name, 7.0, seed, &one);
        holds("one side", &tree.truth, &reconstruct(tree.points.clone()).unwrap(), 0.08);
    }
}

#[test]
fn thinned_clouds() {
    for tree in all() {
        for (side, off) in [(0.005, 0.03), (0.01, 0.04), (0.02, 0.08)] {
            let thin = of(tree.points.clone()).thinned(side).unwrap();
            let found = Reconstruct::default().reconstruct(&thin).unwrap();
            holds(&format!("thinned to {side} m"), &tree.truth, &found, off);
        }
        // Points in the middle of cubes.
        let snapped = tree.points.iter().map(|at| (at / 0.01).round() * 0.01).collect();
        holds("snapped to 1 cm", &tree.truth, &reconstruct(snapped).unwrap(), 0.06);
        let twice = [tree.points.clone(), tree.points.clone(), tree.points.clone()].concat();
        holds("three times", &tree.truth, &reconstruct(twice).unwrap(), 0.03);
    }
}

#[test]
fn coordinates_of_surveys_and_centimetres() {
    let tree = scanned("ash", 2);
    let survey = |at: &Vec3| {
        DVec3::new(500_000.0, 5_400_000.0, 340.0)
            + DVec3::new(f64::from(at.x), -f64::from(at.z), f64::from(at.y))
    };
    let places: Vec<DVec3> = tree.points.iter().map(survey).collect();
    let cloud = Cloud::from_places(&Frame::default(), &places).unwrap();
    let found = Reconstruct::default().reconstruct(&cloud).unwrap();
    let dbh = |found: &Reconstruction| diameter_at(&found.skeleton, 1.3).unwrap();
    let wanted = diameter_at(&tree.truth, 1.3).unwrap();
    assert!((dbh(&found) / wanted - 1.0).abs() < 0.03);
    let hundreds: Vec<DVec3> = places.iter().map(|at| at * 100.0).collect();
    let cloud = Cloud::from_places(&Frame::default().with_unit(0.01), &hundreds).unwrap();
    let again = Reconstruct::default().reconstruct(&cloud).unwrap();
    assert!((dbh(&again) / wanted - 1.0).abs() < 0.03);
    // Centimetres taken for metres: a tree a hundred times as tall, or an error.
    let giant = reconstruct(tree.points.iter().map(|at| at * 100.0).collect());
    if let Ok(found) = giant {
        found.skeleton.check().unwrap();
    }
}

#[test]
fn trees_of_a_metre_and_of_thirty() {
    for (name, tall, step, off) in
        [("sycamore", 2.0, 0.0006, 0.1), ("ash", 3.0, 0.0006, 0.1), ("beech", 30.0, 0.0025, 0.03)]
    {
        let near = if tall < 4.0 { 4.0 } else { 18.0 };
        let scanner = Scanner::around(Vec3::Y * f32::min(1.6, 0.5 * tall), near, 3).with_step(step);
        let tree = scanned_by(name, tall, 1, &scanner);
        // The low ones at half their size.
        let size = if tall < 4.0 { 0.5 } else { 1.0 };
        let found = reconstruct(tree.points.iter().map(|at| at * size).collect()).unwrap();
        let [own, wanted] = [&found.skeleton, &tree.truth].map(height);
        let wanted = wanted * if tall < 4.0 { 0.5 } else { 1.0 };
        assert!((own / wanted - 1.0).abs() < 0.06, "{name}: {own} of {wanted}");
        if tall > 4.0 {
            // Points are 4 cm apart: half of its thin limbs are not seen.
            let [dbh, wanted] = [&found.skeleton, &tree.truth].map(|tree| diameter_at(tree, 1.3).unwrap());
            assert!((dbh / wanted - 1.0).abs() < off, "{name}: DBH {dbh} of {wanted}");
        }
        check_radii(&found.skeleton, found.skeleton.radii()).unwrap();
    }
}
