//! Leaves: on the bark, where the options say, as they say.

use crate::sample::{cases, fnv1a};
use proptest::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};
use treesynth::foliage::{Arrangement, Foliage, FoliageError, Leaf, Leaves};
use treesynth::glam::Vec3;
use treesynth::presets;
use treesynth::surface::Instance;
use treesynth::{Skeleton, SkeletonError};

/// A straight shoot along `way`, in `internodes` steps, 4 mm thick.
fn shoot(way: Vec3, internodes: u32) -> Result<Skeleton, SkeletonError> {
    let at = |i: u32| way * (i as f32 / internodes as f32);
    let parents = (0..=internodes).map(|i| i.checked_sub(1)).collect();
    let radii = vec![0.002; internodes as usize + 1];
    Skeleton::new((0..=internodes).map(at).collect(), parents)?.with_radii(radii)
}

/// Neither disorder nor variation; a leaf every 10 cm.
fn orderly() -> Foliage {
    Foliage::new(Leaf::ovate())
        .with_disorder(0.0)
        .with_size_variation(0.0)
        .with_spacing(0.1)
        .with_reach(f32::INFINITY)
}

fn midrib(instance: &Instance) -> Vec3 {
    instance.rotation_matrix().y_axis
}

fn upper_side(instance: &Instance) -> Vec3 {
    instance.rotation_matrix().z_axis
}

/// Distance of a leaf from the axis of its internode and radius of the branch there, as the
/// documents say it.
fn distance_and_radius(tree: &Skeleton, leaf: &Instance) -> (f64, f64) {
    let node = leaf.node as usize;
    let parent = tree.parent(node).expect("leaves are on internodes");
    let [from, to] = [parent, node].map(|n| tree.positions()[n].as_dvec3());
    let (place, way) = (leaf.position.as_dvec3(), to - from);
    let t = (place - from).dot(way) / way.length_squared();
    let goes_on = tree.orders()[parent] == tree.orders()[node];
    let [below, above] = [if goes_on { parent } else { node }, node].map(|n| f64::from(tree.radii()[n]));
    assert!((-1e-3..=1.001).contains(&t), "beside the internode: {t}");
    (place.distance(from + way * t), below + (above - below) * t)
}

#[test]
fn leaves_sit_on_the_bark() {
    let tree = presets::by_name("figure-06c").unwrap().guided().unwrap().synth(8_000).synthesize(1).unwrap();
    for arrangement in [Arrangement::Alternate, Arrangement::Decussate, Arrangement::SPIRAL] {
        let foliage = Foliage::new(Leaf::ovate()).with_arrangement(arrangement).with_thickest(0.05);
        let leaves = foliage.place(&tree, 1).unwrap().instances;
        assert!(leaves.len() > 5_000, "{}", leaves.len());
        for leaf in &leaves {
            let (distance, radius) = distance_and_radius(&tree, leaf);
            assert!((distance - radius).abs() < 2e-5, "{distance} from the axis, {radius} thick");
            assert!(radius <= 0.05 + 1e-6);
        }
    }
}

#[test]
fn arrangements_are_what_they_are_called() {
    let up = shoot(Vec3::Y, 4).unwrap();
    let expected = [
        (Arrangement::Alternate, 1, PI),
        (Arrangement::Opposite, 2, 0.0),
        (Arrangement::Decussate, 2, FRAC_PI_2),
        (Arrangement::Whorled(3), 3, PI / 3.0),
        (Arrangement::SPIRAL, 1, 137.507_77f32.to_radians()),
    ];
    for (arrangement, per_whorl, divergence) in expected {
        let leaves = orderly().with_arrangement(arrangement).place(&up, 5).unwrap().instances;
        // From the tip down to the foot, every 10 cm.
        assert_eq!(leaves.len(), 11 * per_whorl);
        let azimuth = |leaf: &Instance| leaf.position.x.atan2(leaf.position.z);
        // `true` if two leaves are turned by an angle from each other, either way round.
        let turned = |from: &Instance, to: &Instance, angle: f32| {
            let turn = azimuth(to) - azimuth(from);
            [turn - angle, turn + angle].iter().any(|off| (off / 2.0).sin().abs() < 1e-4)
        };
        let whorls: Vec<_> = leaves.chunks(per_whorl).collect();
        for (i, whorl) in whorls.iter().enumerate() {
            for (j, leaf) in whorl.iter().enumerate() {
                assert!((leaf.position.y - (1.0 - 0.1 * i as f32)).abs() < 1e-5);
                assert!(turned(&whorl[0], leaf, 2.0 * PI * j as f32 / per_whorl as f32), "{arrangement:?}");
            }
        }
        for pair in whorls.windows(2) {
            assert!(turned(&pair[0][0], &pair[1][0], divergence), "{arrangement:?}");
        }
    }
}

#[test]
fn flat_twigs_lie_level() {
    let tree = shoot(Vec3::new(1.0, 0.3, 0.2), 3).unwrap();
    for arrangement in [Arrangement::Alternate, Arrangement::Opposite] {
        for leaf in orderly().with_arrangement(arrangement).place(&tree, 3).unwrap().instances {
            let on_axis = tree.positions()[3] * leaf.position.dot(tree.positions()[3])
                / tree.positions()[3].length_squared();
            assert!((leaf.position - on_axis).y.abs() < 1e-6);
        }
    }
}

#[test]
fn angle_rise_and_light_turn_leaves() {
    let tree = shoot(Vec3::Y, 2).unwrap();
    let place = |foliage: Foliage| foliage.place(&tree, 1).unwrap().instances;
    for angle in [0.0f32, 0.5, 1.2, PI] {
        for leaf in place(orderly().with_angle(angle)) {
            assert!((midrib(&leaf).y - angle.cos()).abs() < 1e-5);
        }
    }
    for leaf in place(orderly().with_angle(FRAC_PI_2).with_rise(-1.0)) {
        assert!((midrib(&leaf).y + 0.5f32.sqrt()).abs() < 1e-5, "hangs by 45°");
    }
    let light = Vec3::new(1.0, 2.0, 0.5).normalize();
    for leaf in place(orderly().with_light(light * 7.0).with_turn(1.0)) {
        // As near to the light as turning about the midrib brings it.
        let best = (1.0 - midrib(&leaf).dot(light).powi(2)).sqrt();
        assert!((upper_side(&leaf).dot(light) - best).abs() < 1e-4);
    }
    for leaf in place(orderly().with_angle(1.0).with_turn(0.0)) {
        // As it grew: the upper side looks to the tip of the shoot.
        assert!((upper_side(&leaf).y - 1f32.sin()).abs() < 1e-5);
    }
}

#[test]
fn sizes_go_by_place_and_order() {
    let tree = shoot(Vec3::Y, 2).unwrap();
    let leaves = orderly().with_size(0.2).with_size_at_tip(0.5).place(&tree, 1).unwrap().instances;
    for (i, leaf) in leaves.iter().enumerate() {
        assert!((leaf.scale - 0.2 * (0.5 + 0.05 * i as f32)).abs() < 1e-6, "{i}: {}", leaf.scale);
    }
    let fork = Skeleton::new(
        vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(1.0, 1.5, 0.0), Vec3::Y * 3.0],
        vec![None, Some(0), Some(1), Some(1), Some(2)],
    );
    let fork = fork.unwrap().with_radii(vec![0.002; 5]).unwrap();
    let even = orderly().with_size(0.2).with_size_at_tip(1.0).with_size_by_order(0.25);
    for leaf in even.place(&fork, 1).unwrap().instances {
        let expected = if fork.orders()[leaf.node as usize] == 0 { 0.2 } else { 0.05 };
        assert!((leaf.scale - expected).abs() < 1e-6);
    }
    let varied = even.with_size_by_order(1.0).with_size_variation(0.4).place(&fork, 1).unwrap().instances;
    assert!(varied.iter().all(|leaf| (0.12..=0.28).contains(&leaf.scale)));
    assert!(varied.iter().any(|leaf| (leaf.scale - 0.2).abs() > 0.02));
}

#[test]
fn leaves_keep_to_thin_twigs_near_tips_and_out_of_the_wood() {
    // A trunk 1 m tall that tapers from 10 cm to 0, with a twig that starts in the middle of its wood.
    let tree = Skeleton::new(
        vec![Vec3::ZERO, Vec3::Y * 0.5, Vec3::Y, Vec3::new(0.2, 0.5, 0.0)],
        vec![None, Some(0), Some(1), Some(1)],
    );
    let tree = tree.unwrap().with_radii(vec![0.1, 0.05, 0.0, 0.002]).unwrap();
    let place = |foliage: Foliage| foliage.with_spacing(0.01).place(&tree, 1).unwrap().instances;
    let lowest = |leaves: &[Instance]| {
        let trunk = leaves.iter().filter(|leaf| leaf.node != 3);
        trunk.map(|leaf| leaf.position.y).fold(f32::MAX, f32::min)
    };
    let leaves = place(orderly().with_thickest(0.02));
    assert!((lowest(&leaves) - 0.8).abs() < 0.011, "the trunk is 2 cm thick at 0.8 m: {}", lowest(&leaves));
    let leaves = place(orderly().with_thickest(f32::INFINITY).with_reach(0.3));
    assert!((lowest(&leaves) - 0.7).abs() < 0.011);
    let twig = leaves.iter().filter(|leaf| leaf.node == 3);
    let nearest = twig.map(|leaf| leaf.position.x).fold(f32::MAX, f32::min);
    assert!((nearest - 0.05).abs() < 0.011, "no leaf is in the trunk: {nearest}");
    assert!(place(orderly().with_thickest(1e-6).with_reach(0.1)).len() < 3, "almost nothing is that thin");
}

#[test]
fn thinning_leaves_the_others_where_they_are() {
    let tree = shoot(Vec3::new(1.0, 2.0, 0.0), 5).unwrap();
    let place = |kept: f32| -> Vec<Instance> {
        let foliage = Foliage::new(Leaf::ovate()).with_spacing(0.0005).with_reach(9.0).with_kept(kept);
        foliage.place(&tree, 9).unwrap().instances
    };
    let all = place(1.0);
    let mut before = all.clone();
    for kept in [0.9, 0.5, 0.1, 0.0] {
        let rest = place(kept);
        let share = rest.len() as f32 / all.len() as f32;
        assert!((share - kept).abs() < 0.03, "{share} of {kept}");
        assert!(rest.iter().all(|leaf| before.contains(leaf)));
        before = rest;
    }
}

fn hash(leaves: &Leaves) -> u64 {
    let words = leaves.instances.iter().flat_map(|leaf| {
        let [x, y, z] = leaf.position.to_array();
        let [a, b, c, d] = leaf.rotation.to_array();
        [x, y, z, a, b, c, d, leaf.scale].map(f32::to_bits).into_iter().chain([leaf.node])
    });
    fnv1a(words.flat_map(u32::to_le_bytes))
}

#[test]
fn the_same_seed_gives_the_same_leaves() {
    let tree = presets::by_name("figure-07").unwrap().guided().unwrap().synth(3_000).synthesize(2).unwrap();
    let foliage = Foliage::new(Leaf::ovate()).with_arrangement(Arrangement::SPIRAL).with_thickest(0.1);
    assert_eq!(hash(&foliage.place(&tree, 2).unwrap()), PINNED);
    assert_ne!(hash(&foliage.place(&tree, 3).unwrap()), PINNED);
}
const PINNED: u64 = 0x62e9_bfde_c0e6_475a;

#[test]
fn what_is_wrong_is_named() {
    let tree = shoot(Vec3::Y, 2).unwrap();
    let nan = f32::NAN;
    let wrong = [
        ("spacing", orderly().with_spacing(0.0)),
        ("spacing", orderly().with_spacing(nan)),
        ("size", orderly().with_size(-1.0)),
        ("size_at_tip", orderly().with_size_at_tip(f32::INFINITY)),
        ("size_by_order", orderly().with_size_by_order(0.0)),
        ("size_variation", orderly().with_size_variation(1.0)),
        ("reach", orderly().with_reach(nan)),
        ("thickest", orderly().with_thickest(0.0)),
        ("angle", orderly().with_angle(4.0)),
        ("rise", orderly().with_rise(nan)),
        ("light", orderly().with_light(Vec3::ZERO)),
        ("light", orderly().with_light(Vec3::NAN)),
        ("turn", orderly().with_turn(1.5)),
        ("disorder", orderly().with_disorder(nan)),
        ("kept", orderly().with_kept(1.1)),
        ("Whorled", orderly().with_arrangement(Arrangement::Whorled(0))),
        ("Spiral", orderly().with_arrangement(Arrangement::Spiral(nan))),
    ];
    for (name, foliage) in wrong {
        let Err(FoliageError::Parameter(error)) = foliage.place(&tree, 1) else { panic!("{name} passed") };
        assert!(error.parameter.ends_with(name), "{error}");
    }
    let bare = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).unwrap();
    assert!(matches!(orderly().place(&bare, 1), Err(FoliageError::NoRadii { nodes: 2 })));
    let far = shoot(Vec3::Y * 1e38, 2).unwrap();
    assert!(matches!(orderly().place(&far, 1), Err(FoliageError::TooMany { .. })));
    let root = Skeleton::new(vec![Vec3::ZERO], vec![None]).unwrap();
    assert_eq!(orderly().place(&root, 1).unwrap().instances, []);
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn any_skeleton_has_sound_leaves_or_a_named_error(
        nodes in prop::collection::vec((any::<prop::sample::Index>(), prop::array::uniform3(-1.0f32..1.0),
            prop::sample::select(vec![0.0f32, 1e-6, 1e-3, 0.1, 1.0, 1e3])), 1..60),
        scale in prop::sample::select(vec![0.0f32, 1e-6, 0.1, 1.0, 1e3, 1e20, 3e38]),
        kind in 0usize..5, spacing in 0.001f32..0.3, angle in 0f32..3.1, rise in -2f32..2.0, turn in 0f32..1.0,
        seed: u64,
    ) {
        let positions = nodes.iter().map(|n| Vec3::from_array(n.1) * scale).collect();
        let parents = nodes.iter().enumerate().map(|(i, n)| (i > 0).then(|| n.0.index(i) as u32)).collect();
        let radii = nodes.iter().map(|n| n.2).collect();
        let tree = Skeleton::new(positions, parents).and_then(|s| s.with_radii(radii)).unwrap();
        let arrangement = [Arrangement::Alternate, Arrangement::Opposite, Arrangement::Decussate,
            Arrangement::Whorled(5), Arrangement::SPIRAL][kind];
        let foliage = Foliage::new(Leaf::ovate()).with_arrangement(arrangement).with_spacing(spacing)
            .with_angle(angle).with_rise(rise).with_turn(turn).with_thickest(2e3).with_reach(20.0);
        match foliage.place(&tree, seed) {
            Ok(leaves) => for leaf in &leaves.instances {
                prop_assert!(leaf.position.is_finite() && leaf.scale > 0.0 && leaf.scale < 1.0);
                let length: f32 = leaf.rotation.to_array().iter().map(|x| x * x).sum();
                prop_assert!((length - 1.0).abs() < 1e-5, "{length}");
                prop_assert!((leaf.node as usize) < tree.len() && leaf.node > 0);
            },
            Err(FoliageError::NoRadii { .. } | FoliageError::TooMany { .. }) => {}
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        }
    }
}
