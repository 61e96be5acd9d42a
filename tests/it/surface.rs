//! Guarantees of a tree's surface for those who draw it and for those who bump into it.

use crate::sample::cases;
use proptest::prelude::*;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Preview};
use treesynth::surface::{Capsules, Level, Levels, Material, SurfaceError, Tubes};
use treesynth::{Bounds, Skeleton, presets};

fn tree(name: &str, nodes: usize) -> Skeleton {
    let preset = presets::by_name(name).expect("a preset").guided().unwrap();
    let tree = preset.synth(nodes).synthesize(preset.seed).expect("a tree");
    tree.relaxed(0.5, 3).expect("sound options")
}

/// The part of a picture that the tree covers; twigs finer than a pixel cover a part of it.
fn coverage(level: &Level, frame: Bounds) -> f64 {
    let preview = Preview::default()
        .with_size(240, 240)
        .with_ground(false)
        .with_bark(Material::default().with_color([0.0; 3]));
    let camera = Camera::default().with_frame(frame);
    let picture =
        preview.with_background([1.0; 3], [1.0; 3]).with_camera(camera).draw(&level.mesh).expect("a picture");
    let pixels = picture.pixels();
    pixels.iter().map(|pixel| 1.0 - f64::from(pixel[1]) / 255.0).sum::<f64>() / pixels.len() as f64
}

#[test]
fn levels_halve_and_look_alike() {
    let tree = tree("figure-06c", 40_000);
    let levels = Levels::default().with_count(7).of(&tree).expect("levels");
    assert_eq!(levels.len(), 7);
    let finest = &levels[0];
    let bounds = finest.mesh.bounds().expect("vertices");
    let covered = coverage(finest, bounds);
    for level in &levels {
        level.mesh.check().expect("a sound mesh");
        let theirs = level.mesh.bounds().expect("vertices");
        let off = (bounds.min - theirs.min).abs().max((bounds.max - theirs.max).abs()).max_element();
        assert!(off <= 8.0 * level.error, "{off} m off at an error of {} m", level.error);
        let ratio = coverage(level, bounds) / covered;
        // Limbs may not swell to make up for what is too thin, so that a bare crown gets lighter at last.
        let least = if level.error < 0.1 { 0.8 } else { 0.6 };
        assert!((least..1.25).contains(&ratio), "{ratio} of the silhouette at an error of {} m", level.error);
    }
    for pair in levels.windows(2) {
        assert!(pair[1].mesh.triangles().len() * 2 <= pair[0].mesh.triangles().len());
        assert!(pair[1].error > pair[0].error);
    }
}

#[test]
fn levels_end_where_nothing_is_left_to_drop() {
    let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).expect("sound");
    let levels = Levels::default().with_count(32);
    assert!(matches!(levels.of(&pole), Err(SurfaceError::NoRadii { .. })));
    let pole = pole.with_radii(vec![0.1, 0.1]).expect("sound");
    let found = levels.of(&pole).expect("levels").len();
    assert!((1..8).contains(&found), "{found} levels of a pole");
    let root = Skeleton::new(vec![Vec3::ZERO], vec![None]).expect("sound");
    assert_eq!(levels.of(&root), Ok(Vec::new()));
    assert!(matches!(levels.with_count(0).of(&pole), Err(SurfaceError::Parameter(_))));
    for error in [0.0, -1.0, 1e-7, f32::NAN, f32::INFINITY] {
        assert!(matches!(Levels::default().with_error(error).of(&pole), Err(SurfaceError::Parameter(_))));
        assert!(Tubes::default().with_error(error).mesh(&pole).is_err());
    }
}

#[test]
fn every_preset_has_a_sound_mesh() {
    for preset in presets::guided() {
        let tree = tree(preset.name, 3000);
        let mesh = Tubes::default().with_wind(true).mesh(&tree).expect(preset.name);
        mesh.check().expect(preset.name);
        assert!(mesh.triangles().len() > 4 * tree.segments(), "{}", preset.name);
    }
}

/// Distance of a point from a straight way.
fn distance(point: Vec3, from: Vec3, to: Vec3) -> f32 {
    let way = to - from;
    let t = ((point - from).dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(from + way * t)
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn capsules_hold_the_tree(
        steps in prop::collection::vec((-1.0f32..1.0, 0.0f32..1.0, -1.0f32..1.0, 0.01f32..0.2), 1..600),
        tolerance in 0.0f32..0.3, least in 0.0f32..0.1,
    ) {
        let mut points = vec![Vec3::ZERO];
        for (x, y, z, _) in &steps {
            points.push(points[points.len() - 1] + Vec3::new(*x, *y, *z) * 0.2);
        }
        let parents = (0..points.len() as u32).map(|node| node.checked_sub(1)).collect();
        let radii: Vec<f32> = std::iter::once(0.2).chain(steps.iter().map(|step| step.3)).collect();
        let chain = Skeleton::new(points, parents).and_then(|s| s.with_radii(radii)).expect("sound");
        let capsules = Capsules::default().with_tolerance(tolerance).with_least_radius(least);
        let capsules = capsules.of(&chain).expect("sound options");
        let end = (1..chain.len()).find(|&node| chain.radii()[node] < least).unwrap_or(chain.len());
        for node in 1..end {
            let radius = chain.radii()[node];
            for t in [0.0, 0.5, 1.0] {
                let point = chain.positions()[node - 1].lerp(chain.positions()[node], t);
                let held = capsules.iter().any(|capsule| {
                    distance(point, capsule.from, capsule.to) + radius <= capsule.radius + tolerance + 1e-4
                });
                prop_assert!(held, "node {node} at {t}");
            }
        }
        prop_assert!(capsules.len() < end);
    }
}

#[test]
fn capsules_are_few_and_checked() {
    let tree = tree("figure-06c", 40_000);
    let found = Capsules::default().of(&tree).expect("sound options").len();
    assert!(found > 20 && found * 3 < tree.segments(), "{found} capsules of {} internodes", tree.segments());
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(Capsules::default().with_tolerance(bad).of(&tree).is_err());
        assert!(Capsules::default().with_least_radius(bad).of(&tree).is_err());
    }
}
