use glam::Vec3;

use super::*;
use crate::metrics::diameter_at;
use crate::radius::check_radii;
use crate::random::{Purpose, unit};
use crate::scan::{Scanner, Truth};
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

/// Four trees whose crowns reach into each other, from five places: the points, and the tree that each is of; [`Truth::GROUND`] for
/// the ground.
fn stand(truth: &Skeleton, scanner: &Scanner) -> (Vec<Vec3>, Cloud, Vec<u32>) {
    let mesh = Tubes::default().with_sides(32).with_root_flare(0.0).mesh(truth).expect("a mesh");
    let places =
        vec![Vec3::ZERO, Vec3::new(2.6, 0.0, 0.3), Vec3::new(0.2, 0.0, 2.7), Vec3::new(2.9, 0.0, 2.8)];
    let part = |(i, &at): (usize, &Vec3)| Part::new(&mesh).at(at, glam::Quat::from_rotation_y(i as f32), 1.0);
    let parts: Vec<Part<'_>> = places.iter().enumerate().map(part).collect();
    let scan = scanner.scan(&parts, 1).expect("a scan");
    (places, scan.cloud, scan.truth.iter().map(|truth| truth.part).collect())
}

#[test]
fn trees_whose_crowns_touch_come_back_one_by_one() {
    let truth = tree();
    let wanted = diameter_at(&truth, 1.3).unwrap_or(0.0);
    let scanner = Scanner::around(Vec3::new(1.4, 1.6, 1.4), 8.0, 5).with_step(0.002);
    for scanner in [scanner.clone(), scanner.with_ground(0.0)] {
        let (places, cloud, parts) = stand(&truth, &scanner);
        let has_ground = parts.contains(&Truth::GROUND);
        let found = Reconstruct::default().reconstruct_stand(&cloud).expect("trees");
        assert_eq!((found.trees.len(), found.owners.len()), (4, cloud.len()));
        assert_eq!(found.ground > 0, has_ground);
        let mut right = 0;
        for (part, place) in (0_u32..).zip(&places) {
            let far = |tree: &Reconstruction| tree.skeleton.positions()[0].distance(*place);
            let tree =
                (0..4).min_by(|&a, &b| far(&found.trees[a]).total_cmp(&far(&found.trees[b]))).expect("four");
            let own = &found.trees[tree];
            check(&own.skeleton);
            assert!(far(own) < 0.05, "{part}: root {}", own.skeleton.positions()[0]);
            let dbh = diameter_at(&own.skeleton, 1.3).unwrap_or(0.0);
            assert!((dbh - wanted).abs() < 0.01, "{part}: {dbh} {wanted}");
            let is_own = |&(&owner, &of): &(&Option<u32>, &u32)| of == part && owner == Some(tree as u32);
            right += found.owners.iter().zip(&parts).filter(is_own).count();
        }
        let all = parts.iter().filter(|&&part| part != Truth::GROUND).count();
        assert!(right as f32 > 0.95 * all as f32, "{right} of {all}");
        if !has_ground {
            let again = Reconstruct::default().reconstruct_stand_at(&cloud, &places[..2]).expect("two trees");
            assert_eq!(again.trees.len(), 2);
        }
        let twice = Reconstruct::default().reconstruct_stand_at(&cloud, &[places[0], places[0]]);
        assert!(twice.is_err_and(|error| error.to_string().contains("bases")));
        assert!(Reconstruct::default().reconstruct_stand_at(&cloud, &[Vec3::Y * 90.0]).is_err());
        assert!(Reconstruct::default().reconstruct_stand_at(&cloud, &[Vec3::NAN]).is_err());
    }
}

#[test]
fn the_axis_goes_on_in_the_straighter_limb_though_it_bears_less() {
    // A trunk that goes on thin, and a thick limb off it that bears more.
    let nodes =
        [[0.0, 0.0], [0.0, 1.5], [0.0, 3.0], [0.8, 2.2], [1.6, 2.6], [1.3, 3.0], [1.0, 3.2], [1.9, 2.2]];
    let nodes = nodes.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let parents = vec![None, Some(0), Some(1), Some(1), Some(3), Some(3), Some(3), Some(3)];
    let radii = vec![0.06, 0.06, 0.03, 0.05, 0.02, 0.02, 0.02, 0.02];
    let truth = Skeleton::new(nodes, parents).and_then(|tree| tree.with_radii(radii)).expect("a tree");
    let found = Reconstruct::default().reconstruct(&cloud(&truth, &scanner())).expect("a tree").skeleton;
    let nearest = |at: Vec3| {
        let far = |node: &usize| found.positions()[*node].distance(at);
        (0..found.len()).min_by(|a, b| far(a).total_cmp(&far(b))).expect("nodes")
    };
    assert_eq!(found.orders()[nearest(Vec3::new(0.0, 2.6, 0.0))], 0);
    assert_eq!(found.orders()[nearest(Vec3::new(0.5, 1.94, 0.0))], 1);
}

#[test]
fn what_is_no_tree_is_an_error() {
    let of = |points: Vec<Vec3>| Reconstruct::default().reconstruct(&Cloud::new(points).expect("finite"));
    for points in [vec![], vec![Vec3::ONE], vec![Vec3::ONE; 5000]] {
        let cloud = Cloud::new(points.clone()).expect("finite");
        let stand = Reconstruct::default().reconstruct_stand(&cloud);
        assert!(matches!(stand, Err(ReconstructError::TooFew { .. })));
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
