//! A tree of a species, scanned and reconstructed.

use treesynth::cloud::{Cloud, Frame};
use treesynth::glam::{DVec3, Vec3};
use treesynth::guided::Example;
use treesynth::metrics::diameter_at;
use treesynth::radius::check_radii;
use treesynth::reconstruct::{PointKind, Reconstruct, Twigs};
use treesynth::scan::Scanner;
use treesynth::surface::{Part, Tubes};
use treesynth::{Metrics, Skeleton, species};

/// Volume of what is thicker than 5 cm.
fn wood(tree: &Skeleton) -> f32 {
    let thick = tree.edges().filter(|&(node, _)| tree.radii()[node] > 0.025);
    let volume = |(node, parent): (usize, usize)| {
        std::f32::consts::PI
            * tree.radii()[node]
            * tree.radii()[node]
            * tree.positions()[node].distance(tree.positions()[parent])
    };
    thick.map(volume).sum()
}

#[test]
fn species_come_back_from_their_clouds() {
    for (name, seed) in [("ash", 2), ("London plane", 3)] {
        let request = species::by_name(name).unwrap().request();
        let truth = request.with_height(8.0).with_day(20.0).with_seed(seed).grow().unwrap().skeleton;
        let mesh = Tubes::default().with_sides(32).with_root_flare(0.0).mesh(&truth).unwrap();
        let scanner = Scanner::around(Vec3::Y * 1.7, 9.0, 3).with_step(0.0012);
        let cloud = scanner.scan(&[Part::new(&mesh)], seed).unwrap().cloud;
        let found = Reconstruct::default().reconstruct(&cloud).unwrap().skeleton;
        check_radii(&found, found.radii()).unwrap();
        let [dbh, wanted] = [&found, &truth].map(|tree| diameter_at(tree, 1.3).unwrap());
        assert!((dbh - wanted).abs() < 0.005, "{name}: {dbh} {wanted}");
        let ratio = wood(&found) / wood(&truth);
        assert!((0.88..1.12).contains(&ratio), "{name}: {ratio}");
    }
}

/// Points around an upright stem.
fn stem(base: Vec3, height: f32) -> impl Iterator<Item = Vec3> {
    (0..(height * 2000.0) as u32).map(move |i| {
        let (sin, cos) = (i as f32 * 2.4).sin_cos();
        base + Vec3::new(0.06 * cos, i as f32 / 2000.0, 0.06 * sin)
    })
}

/// Errors of stands name the base, or say that there is no trunk and which call goes on from there.
#[test]
fn errors_of_stands_say_what_to_do() {
    let of = |points: Vec<Vec3>| Cloud::new(points).unwrap();
    let reconstruct = Reconstruct::default().with_ground(false);
    let flat = of((0..900).map(|i| Vec3::new((i % 30) as f32, 0.0, (i / 30) as f32)).collect());
    let lying = of(stem(Vec3::ZERO, 2.0).map(|point| Vec3::new(point.y, point.x, point.z)).collect());
    for cloud in [&flat, &lying] {
        if let Err(error) = reconstruct.reconstruct_stand(cloud) {
            let text = error.to_string();
            assert!(text.contains("trunk") && text.contains("reconstruct_stand_at"), "{text}");
        }
    }
    assert!(reconstruct.reconstruct_stand(&flat).is_err());
    // Of two bases in one trunk one has next to no points; and a thousand have none each.
    let one = of(stem(Vec3::ZERO, 2.0).collect());
    for far in [1e-2, 2e-3, 1.5e-3] {
        let bases = [Vec3::ZERO, Vec3::new(far, 0.0, 0.0)];
        if let Err(error) = reconstruct.reconstruct_stand_at(&one, &bases) {
            let text = error.to_string();
            assert!(bases.iter().any(|base| text.contains(&format!("{base}"))), "{text}");
        }
    }
    let above = [Vec3::ZERO, Vec3::new(0.0, 2.9, 0.0)];
    let text = reconstruct.reconstruct_stand_at(&one, &above).unwrap_err().to_string();
    assert!(text.contains("[0, 2.9, 0]"), "{text}");
    let many: Vec<Vec3> = (0..1000).map(|i| Vec3::new(i as f32 * 1e-3, 0.0, 0.01 * (i % 2) as f32)).collect();
    let twice: Vec<Vec3> = many.iter().chain(&many[500..501]).copied().skip(1).collect();
    for (bases, named) in [
        (&twice[..], format!("{}", many[500])),
        (&[many.clone(), vec![Vec3::X]].concat()[..], "1001".into()),
        (&[][..], "0".into()),
        (&[Vec3::ZERO, Vec3::NAN], format!("{}", Vec3::NAN)),
        (&[Vec3::NAN], format!("{}", Vec3::NAN)),
    ] {
        let text = reconstruct.reconstruct_stand_at(&one, bases).unwrap_err().to_string();
        assert!(text.contains(&named) && text.contains("bases") && text.len() < 300, "{text}");
    }
}

/// Far from 0 floats have steps wider than bark: an error, not a tree of steps.
#[test]
fn coordinates_of_surveys_are_refused_or_exact() {
    let points = || stem(Vec3::ZERO, 2.0).chain(stem(Vec3::X, 2.0));
    for (far, holds) in [(0.0, true), (1e3, true), (2e5, false), (9e5, false)] {
        let cloud = Cloud::new(points().map(|point| point + Vec3::new(far, 0.0, -far)).collect()).unwrap();
        match Reconstruct::default().reconstruct_stand(&cloud) {
            Ok(stand) => {
                assert!(holds, "{far}");
                assert_eq!(stand.trees.len(), 2);
                for tree in &stand.trees {
                    let dbh = diameter_at(&tree.skeleton, 1.3).unwrap();
                    assert!((dbh - 0.12).abs() < 0.01, "{far}: {dbh}");
                }
            }
            Err(error) => {
                assert!(!holds && error.to_string().contains("Cloud::from_places"), "{far}: {error}");
            }
        }
    }
    let beyond = Cloud::new(points().map(|point| point + Vec3::Z * 5e6).collect()).unwrap_err();
    assert!(beyond.to_string().contains("Cloud::from_places"), "{beyond}");
    // As they stand in a survey.
    let place = |p: DVec3| DVec3::new(500_000.0 + p.x, 5_000_000.0 + p.z, 300.0 + p.y);
    let places: Vec<DVec3> = points().map(|point| place(point.as_dvec3())).collect();
    let cloud = Cloud::from_places(&Frame::default(), &places).unwrap();
    let stand = Reconstruct::default().reconstruct_stand(&cloud).unwrap();
    assert_eq!(stand.trees.len(), 2);
    assert!((stand.trees[0].offset - DVec3::new(500_000.0, 5_000_000.0, 300.0)).abs().max_element() < 1e3);
}

/// Trunks are found at any height above sea, also where a limb reaches beyond the ground's edge.
#[test]
fn trunks_are_found_at_any_height() {
    let ground =
        (0..80 * 80).map(|i| Vec3::new((i % 80) as f32 * 0.025 - 1.0, 0.0, (i / 80) as f32 * 0.025 - 1.0));
    let limb = (0..303).map(|i| {
        let (sin, cos) = (i as f32 * 2.4).sin_cos();
        Vec3::new(i as f32 * 0.005, 1.8 + 0.02 * sin, 0.02 * cos)
    });
    let points: Vec<Vec3> = stem(Vec3::ZERO, 2.0).chain(limb).chain(ground).collect();
    for y in [0.0, -100.0, 300.0] {
        let cloud = Cloud::new(points.iter().map(|&point| point + Vec3::Y * y).collect()).unwrap();
        let bases = Reconstruct::default().trunk_bases(&cloud).unwrap();
        assert_eq!(bases.len(), 1, "{y}: {bases:?}");
        assert!(bases[0].distance(Vec3::Y * (y + 0.12)) < 0.05, "{y}: {bases:?}");
    }
}

/// Trees in leaf: most points are told from leaves rightly, and diameters are those of the wood.
#[test]
fn leaves_are_set_aside() {
    for (name, seed) in [("English oak", 4), ("ash", 5)] {
        let request = species::by_name(name).unwrap().request();
        let tree = request.with_height(6.0).with_day(200.0).with_seed(seed).grow().unwrap();
        let mesh = Tubes::default().with_sides(24).with_root_flare(0.0).mesh(&tree.skeleton).unwrap();
        let leaves = tree.leaves.as_ref().unwrap();
        let scanner = Scanner::around(Vec3::Y * 1.7, 7.0, 3).with_step(0.0012);
        let scan = scanner.scan(&[Part::new(&mesh), leaves.part()], seed).unwrap();
        let found = Reconstruct::default().with_leaves_set_aside(true).reconstruct(&scan.cloud).unwrap();
        check_radii(&found.skeleton, found.skeleton.radii()).unwrap();
        assert_eq!(found.kinds.len(), scan.cloud.len());
        let share = |part: u32, kind: PointKind| {
            let own = || scan.truth.iter().zip(&found.kinds).filter(|(truth, _)| truth.part == part);
            own().filter(|(_, own)| **own == kind).count() as f32 / own().count() as f32
        };
        let [wood, leaf] = [share(0, PointKind::Wood), share(1, PointKind::Leaf)];
        println!("{name}: wood {wood:.3}, leaves {leaf:.3}");
        assert!(0.5 * (wood + leaf) > 0.75, "{name}: wood {wood}, leaves {leaf}");
        let [dbh, wanted] = [&found.skeleton, &tree.skeleton].map(|tree| diameter_at(tree, 1.3).unwrap());
        assert!((dbh - wanted).abs() < 0.005, "{name}: {dbh} {wanted}");
        let all = found.kinds.iter().filter(|&&kind| kind == PointKind::Leaf).count();
        assert_eq!(all, found.leaves);
        let plain = Reconstruct::default().reconstruct(&scan.cloud).unwrap();
        assert_eq!(plain.leaves, 0);
    }
}

/// Measured nodes stay as they are, and twigs are thin, on thin limbs, and say that they are made up.
#[test]
fn twigs_are_grown_onto_measured_limbs() {
    let request = species::by_name("ash").unwrap().request();
    let truth = request.with_height(6.0).with_day(20.0).with_seed(2).grow().unwrap().skeleton;
    let mesh = Tubes::default().with_sides(24).with_root_flare(0.0).mesh(&truth).unwrap();
    let scanner = Scanner::around(Vec3::Y * 1.7, 7.0, 3).with_step(0.0016);
    let cloud = scanner.scan(&[Part::new(&mesh)], 2).unwrap().cloud;
    let found = Reconstruct::default().reconstruct(&cloud).unwrap();
    let whole = found.completed(&Twigs::default(), 1).unwrap();
    assert_eq!(found.completed(&Twigs::default(), 1).unwrap(), whole);
    let (tree, old) = (&whole.skeleton, &found.skeleton);
    tree.check().unwrap();
    check_radii(tree, tree.radii()).unwrap();
    let count = old.len();
    assert_eq!(whole.measured, count);
    assert!(whole.is_measured(count - 1) && !whole.is_measured(count));
    assert_eq!(tree.positions()[..count], *old.positions());
    assert_eq!(tree.radii()[..count], *old.radii());
    assert_eq!(tree.orders()[..count], *old.orders());
    assert!((0..count).all(|node| tree.parent(node) == old.parent(node)));
    assert!(tree.tips().count() > old.tips().count() + 50, "{}", tree.tips().count());
    for node in count..tree.len() {
        let parent = tree.parent(node).unwrap();
        assert!(tree.radii()[node] <= tree.radii()[parent] && tree.stages()[node] > 0);
        assert!(parent >= count || old.radii()[parent] < 0.03, "{node} is on {}", old.radii()[parent]);
    }
    for (twigs, name) in [
        (Twigs::default().with_thickest(0.0), "thickest"),
        (Twigs::default().with_spacing(f32::NAN), "spacing"),
        (Twigs::default().with_tip_radius(-1.0), "tip_radius"),
        (Twigs::default().with_reach(0), "reach"),
        (Twigs::default().with_stages([]), "stages"),
        (Twigs::default().with_thickest(1e-6), "thin enough"),
    ] {
        let text = found.completed(&twigs, 1).unwrap_err().to_string();
        assert!(text.contains(name), "{text}");
    }
}

/// Ten trees after a measured one are of its kind: as tall, but with thicker trunks, for what it lacks in twigs is drawn.
#[test]
fn more_trees_after_a_measured_one() {
    let request = species::by_name("London plane").unwrap().request();
    let truth = request.with_height(7.0).with_day(20.0).with_seed(3).grow().unwrap().skeleton;
    let mesh = Tubes::default().with_sides(24).with_root_flare(0.0).mesh(&truth).unwrap();
    let scanner = Scanner::around(Vec3::Y * 1.7, 8.0, 3).with_step(0.0014);
    let cloud = scanner.scan(&[Part::new(&mesh)], 3).unwrap().cloud;
    let measured = Reconstruct::default().reconstruct(&cloud).unwrap().skeleton;
    let example = Example::of(&measured).unwrap().tuned(20_000, 8).unwrap();
    let measures = |tree: &Skeleton| {
        let metrics = Metrics::of(tree);
        let dbh = diameter_at(tree, 1.3).unwrap();
        [
            ("height", metrics.height, 0.1),
            ("DBH", dbh, 0.1),
            ("crown width", metrics.crown_width, 0.15),
            ("length", metrics.total_length, 0.15),
            ("wood", metrics.wood_volume, 0.15),
        ]
    };
    let grown: Vec<_> = (1..=10).map(|seed| measures(&example.grow(20_000, seed).unwrap())).collect();
    for (i, (name, own, off)) in measures(&measured).into_iter().enumerate() {
        let mut ratios: Vec<f64> = grown.iter().map(|tree| tree[i].1 / own).collect();
        ratios.sort_by(f64::total_cmp);
        let median = f64::midpoint(ratios[4], ratios[5]);
        println!("{name}: {own:.3}, median {median:.3} of it, {:.3} to {:.3}", ratios[0], ratios[9]);
        assert!((median - 1.0).abs() < off, "{name}: {median}");
    }
}
