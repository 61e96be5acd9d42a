use glam::Vec3;

use super::*;
use crate::metrics::diameter_at;
use crate::radius::check_radii;
use crate::random::{Purpose, unit};
use crate::scan::Scanner;
use crate::surface::{Part, Tubes};

/// A trunk with six limbs, each with three branches.
fn tree() -> Skeleton {
    let mut nodes = vec![Vec3::ZERO];
    let (mut parents, mut radii) = (vec![None], vec![0.12_f32]);
    let mut add = |parent: u32, at: Vec3, radius: f32| {
        nodes.push(at);
        parents.push(Some(parent));
        radii.push(radius);
        nodes.len() as u32 - 1
    };
    let mut trunk = 0;
    for i in 0..10 {
        let up = 0.4 * (i + 1) as f32;
        trunk = add(trunk, Vec3::new(0.02 * up, up, 0.0), 0.12 - 0.008 * i as f32);
        if i < 4 {
            continue;
        }
        let (sin, cos) = crate::math::sin_cos(2.4 * i as f32);
        let out = Vec3::new(cos, 0.7, sin);
        let base = Vec3::new(0.02 * up, up, 0.0);
        let limb = add(trunk, base + out * 0.5, 0.03);
        let limb_end = add(limb, base + out * 1.1, 0.02);
        for turn in [-0.6, 0.0, 0.6] {
            let side = Vec3::new(-sin, 0.2, cos) * turn;
            add(limb_end, base + out * 1.7 + side, 0.01);
        }
    }
    Skeleton::new(nodes, parents).and_then(|tree| tree.with_radii(radii)).expect("a tree")
}

fn scanner() -> Scanner {
    Scanner::around(Vec3::Y * 1.6, 7.0, 3).with_step(0.0016)
}

fn cloud(tree: &Skeleton, scanner: &Scanner) -> Cloud {
    let mesh = Tubes::default().with_sides(32).with_root_flare(0.0).mesh(tree).expect("a mesh");
    scanner.scan(&[Part::new(&mesh)], 1).expect("a scan").cloud
}

/// The share of the way along one tree that lies within 5 cm of another.
fn near(one: &Skeleton, other: &Skeleton) -> f32 {
    let segments: Vec<(Vec3, Vec3)> =
        other.edges().map(|(a, b)| (other.positions()[a], other.positions()[b])).collect();
    let (mut hits, mut all) = (0.0, 0.0);
    for (a, b) in one.edges() {
        let (start, end) = (one.positions()[b], one.positions()[a]);
        let steps = (start.distance(end) / 0.02).ceil().max(1.0) as usize;
        for i in 0..steps {
            let at = start.lerp(end, (i as f32 + 0.5) / steps as f32);
            let off = |&(p, q): &(Vec3, Vec3)| {
                let share = ((at - p).dot(q - p) / (q - p).length_squared().max(1e-12)).clamp(0.0, 1.0);
                at.distance(p.lerp(q, share))
            };
            let length = start.distance(end) / steps as f32;
            all += length;
            hits += if segments.iter().any(|segment| off(segment) < 0.05) { length } else { 0.0 };
        }
    }
    hits / all
}

fn check(tree: &Skeleton) {
    assert!(tree.check().is_ok());
    assert!(check_radii(tree, tree.radii()).is_ok());
}

#[test]
fn a_scanned_tree_comes_back() {
    let truth = tree();
    let cloud = cloud(&truth, &scanner());
    let found = Reconstruct::default().reconstruct(&cloud).expect("a tree");
    check(&found.skeleton);
    let (recall, precision) = (near(&truth, &found.skeleton), near(&found.skeleton, &truth));
    assert!(recall > 0.95 && precision > 0.95, "{recall} {precision}");
    let [dbh, wanted] = [&found.skeleton, &truth].map(|tree| diameter_at(tree, 1.3).unwrap_or(0.0));
    assert!((dbh - wanted).abs() < 0.005, "{dbh} {wanted}");
    assert_eq!(found.ground, 0);
    assert_eq!(Reconstruct::default().reconstruct(&cloud).expect("a tree"), found);
}

#[test]
fn ground_outliers_gaps_and_thin_places_do_no_harm() {
    let truth = tree();
    let all = cloud(&truth, &scanner().with_ground(0.0));
    let chance = |i: usize, k: u32| unit(7, k, Purpose::CUSTOM, i as u64);
    // Fewer points the higher, none in two slices, and stray ones anywhere.
    let mut points: Vec<Vec3> = (all.points().iter().enumerate())
        .filter(|(i, p)| {
            chance(*i, 0) > 0.15 * p.y && !(2.0..2.15).contains(&p.y) && !(4.0..4.1).contains(&p.y)
        })
        .map(|(_, &p)| p)
        .collect();
    let count = points.len() / 100;
    points
        .extend((0..count).map(|i| {
            Vec3::new(chance(i, 1) * 5.0 - 2.5, chance(i, 2) * 6.0 - 0.5, chance(i, 3) * 5.0 - 2.5)
        }));
    let found = Reconstruct::default().reconstruct(&Cloud::new(points).expect("finite")).expect("a tree");
    check(&found.skeleton);
    assert!(found.ground > 1000, "{}", found.ground);
    let (recall, precision) = (near(&truth, &found.skeleton), near(&found.skeleton, &truth));
    assert!(recall > 0.85 && precision > 0.85, "{recall} {precision}");
}

#[test]
fn what_is_no_tree_is_an_error() {
    let of = |points: Vec<Vec3>| Reconstruct::default().reconstruct(&Cloud::new(points).expect("finite"));
    for points in [vec![], vec![Vec3::ONE], vec![Vec3::ONE; 5000]] {
        assert!(matches!(of(points), Err(ReconstructError::TooFew { .. })));
    }
    assert!(Cloud::new(vec![Vec3::NAN]).is_err());
    let one = cloud(&tree(), &scanner());
    let two: Vec<Vec3> = one.points().iter().flat_map(|&p| [p, p + Vec3::X * 6.0]).collect();
    assert!(matches!(of(two.clone()), Err(ReconstructError::Trunks { trunks: 2, .. })));
    // Told which, it is that one.
    let chosen =
        Reconstruct::default().with_base(Vec3::X * 6.0).reconstruct(&Cloud::new(two).expect("finite"));
    let chosen = chosen.expect("a tree");
    assert!(chosen.skeleton.positions().iter().all(|p| p.x > 3.0) && chosen.left_out >= one.len());
    let flipped = of(one.points().iter().map(|&p| p.with_y(-p.y)).collect());
    let is_refused = |error: &ReconstructError| {
        matches!(error, ReconstructError::Trunks { .. } | ReconstructError::ThinBase { .. })
    };
    assert!(flipped.as_ref().is_err_and(is_refused), "{:?}", flipped.map(|found| found.skeleton.len()));
    let crown = of(one.points().iter().copied().filter(|p| p.y > 2.6).collect());
    assert!(crown.is_err() || crown.is_ok_and(|found| found.skeleton.check().is_ok()));
    let few = Reconstruct::default().with_most_points(100).reconstruct(&one);
    assert!(few.is_err_and(|error| error.to_string().contains("Cloud::thinned")));
}

#[test]
fn points_of_any_kind_end_in_a_tree_or_an_error() {
    let chance = |i: usize, k: u32| unit(3, k, Purpose::CUSTOM, i as u64);
    let blob = |count: usize, size: Vec3| -> Vec<Vec3> {
        (0..count).map(|i| Vec3::new(chance(i, 0), chance(i, 1), chance(i, 2)) * size).collect()
    };
    let line = |count: usize, step: Vec3| -> Vec<Vec3> { (0..count).map(|i| step * i as f32).collect() };
    for points in [
        blob(3000, Vec3::ONE),
        blob(3000, Vec3::new(1.0, 0.0, 1.0)),
        blob(3000, Vec3::new(0.0, 1.0, 0.0)),
        blob(20, Vec3::splat(1e6)),
        blob(500, Vec3::splat(1e-4)),
        line(1000, Vec3::Y * 0.01),
        line(1000, Vec3::X * 0.01),
        line(1000, Vec3::Y * 100.0),
        line(12, Vec3::splat(1e-5)),
    ] {
        for with in [
            Reconstruct::default(),
            Reconstruct::default().with_base(Vec3::ZERO),
            Reconstruct::default().with_gap(0.0),
        ] {
            if let Ok(found) = with.reconstruct(&Cloud::new(points.clone()).expect("finite")) {
                check(&found.skeleton);
            }
        }
    }
}

#[test]
fn bad_options_are_named() {
    let cloud = Cloud::new(vec![Vec3::ONE]).expect("finite");
    for (with, name) in [
        (Reconstruct::default().with_base(Vec3::NAN), "base"),
        (Reconstruct::default().with_side(0.0), "side"),
        (Reconstruct::default().with_side(f32::NAN), "side"),
        (Reconstruct::default().with_gap(-1.0), "gap"),
        (Reconstruct::default().with_tip_radius(2.0), "tip"),
    ] {
        let error = with.reconstruct(&cloud).map(|found| found.side).expect_err(name).to_string();
        assert!(error.contains(name), "{error}");
    }
}
