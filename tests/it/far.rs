//! Trees far from the origin have the surface that they have near it, or an error that says why not.

use treesynth::foliage::{Foliage, FoliageError, Leaf};
use treesynth::glam::Vec3;
use treesynth::surface::blob::{BlobTree, BlobTreeBuilder, Primitive, Skin};
use treesynth::surface::{Implicit, Levels, Mesh, Polygonizer, SurfaceError, Tubes};
use treesynth::{Skeleton, presets};

/// Eastings, northings and heights; the last two are beyond what floats resolve for trees.
const PLACES: [Vec3; 6] = [
    Vec3::new(1_000.0, 0.0, 500.0),
    Vec3::new(0.0, 3_100.0, 0.0),
    Vec3::new(10_000.0, 0.0, -5_000.0),
    Vec3::new(-100_000.0, 250.0, 50_000.0),
    Vec3::new(454_000.0, 0.0, 227_000.0),
    Vec3::new(5_428_000.0, 0.0, 2_714_000.0),
];

fn fork(scale: f32) -> Skeleton {
    let points = [Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(1.0, 1.7, 0.0)];
    Skeleton::new(points.map(|p| p * scale).to_vec(), vec![None, Some(0), Some(1), Some(1)])
        .and_then(|tree| tree.with_radii([0.2, 0.15, 0.1, 0.05].map(|r| r * scale).to_vec()))
        .expect("a fork")
}

fn crown(seed: u64) -> Skeleton {
    let preset = presets::by_name("figure-17e").expect("a preset").guided().expect("guided");
    let tree = preset.synth(300).synthesize(seed).expect("a tree").relaxed(0.5, 2).expect("relaxed");
    let radii = tree.radii().iter().map(|radius| radius.max(0.02)).collect();
    tree.with_radii(radii).expect("radii")
}

fn trees() -> Vec<Skeleton> {
    vec![fork(1.0), fork(3.0), crown(1), crown(2)]
}

fn moved(tree: &Skeleton, by: Vec3) -> Skeleton {
    let positions = tree.positions().iter().map(|&position| position + by).collect();
    tree.clone().with_positions(positions).expect("finite")
}

fn volume(mesh: &Mesh, from: Vec3) -> f64 {
    let part = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(|i| (mesh.positions[i as usize] - from).as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    mesh.triangles().map(part).sum()
}

fn step(place: Vec3) -> f32 {
    let most = place.abs().max_element() * 1.01;
    most.next_up() - most
}

/// The tree moved there, and what is left of it by rounding, near the origin.
fn there(tree: &Skeleton, at: Vec3) -> (Skeleton, Skeleton) {
    let far = moved(tree, at);
    let near = moved(&far, -at);
    (far, near)
}

/// A mesh far away is the one near the origin, its vertices rounded; or it is refused.
fn same(what: &str, at: Vec3, far: Result<Mesh, SurfaceError>, near: &Mesh, closed: bool) -> bool {
    let far = match far {
        Err(SurfaceError::Shapeless { step: named, position, .. }) => {
            assert!((position - at).length() < 1.0 && named == step_at(at), "{what} {position} {named}");
            assert!(at.abs().max_element() > 9_000.0, "{what} is refused at {at}");
            return false;
        }
        other => other.expect(what),
    };
    assert_eq!(far.check(), Ok(()), "{what} at {at}");
    assert!(!far.is_empty());
    assert_eq!(far.positions.len(), near.positions.len(), "{what} at {at}");
    let most =
        far.positions.iter().zip(&near.positions).map(|(f, n)| (*f - at).distance(*n)).fold(0.0, f32::max);
    assert!(most <= 4.0 * step(at), "{what} at {at}: a vertex is {most} m off");
    if closed {
        assert_eq!(far.triangles().len(), near.triangles().len(), "{what} at {at}");
    }
    let (area, volumes) = (f64::from(far.area() / near.area()), [volume(&far, at), volume(near, Vec3::ZERO)]);
    assert!((0.9..1.15).contains(&area), "{what} at {at}: area times {area}");
    assert!((volumes[0] / volumes[1] - 1.0).abs() < 0.05, "{what} at {at}: volumes {volumes:?}");
    true
}

fn step_at(place: Vec3) -> f32 {
    let most = place.abs().max_element();
    most.next_up() - most
}

#[test]
fn tubes_are_those_near_the_origin() {
    let mut refused = 0;
    for tree in trees() {
        for at in PLACES {
            let (far, near) = there(&tree, at);
            let tubes = Tubes::default().with_closed_base(true);
            let mesh = tubes.mesh(&near).expect("tubes");
            refused += usize::from(!same("tubes", at, tubes.mesh(&far), &mesh, false));
            let level = tubes.within(&near, 2_000).expect("a level").mesh;
            same("tubes within", at, tubes.within(&far, 2_000).map(|level| level.mesh), &level, false);
        }
    }
    assert!((4..16).contains(&refused), "{refused} refused");
}

#[test]
fn levels_are_those_near_the_origin() {
    for tree in trees() {
        for at in &PLACES[..3] {
            let (far, near) = there(&tree, *at);
            let levels = [&near, &far].map(|tree| Levels::default().with_error(0.01).of(tree));
            let [Ok(near), far] = levels else { panic!("levels near the origin") };
            let Ok(far) = far else { continue };
            assert!(!near.is_empty() && near.len() == far.len());
            for (near, far) in near.iter().zip(far) {
                same("levels", *at, Ok(far.mesh), &near.mesh, false);
            }
        }
    }
}

#[test]
fn closed_surfaces_are_those_near_the_origin() {
    let mut refused = 0;
    for tree in trees() {
        for at in PLACES {
            let (far, near) = there(&tree, at);
            for wind in [false, true] {
                let surface = Implicit::default().with_wind(wind);
                let [far, near] = [&far, &near].map(|tree| surface.mesh(tree));
                refused += usize::from(!same("implicit", at, far, &near.expect("a surface"), true));
            }
            let [far, near] = [&far, &near].map(|tree| Skin::default().blob_tree(tree).expect("a skin"));
            let surface = Polygonizer::default().with_voxel(0.05);
            same("skin", at, surface.mesh(&far), &surface.mesh(&near).expect("a surface"), true);
        }
    }
    assert!((8..40).contains(&refused), "{refused} refused");
}

fn warped(at: Vec3) -> BlobTree {
    use treesynth::glam::{Affine3A, Quat};
    let mut parts = BlobTreeBuilder::default();
    let ball = parts.add(Primitive::point(at, 1.0)).expect("a ball");
    let line = parts.add(Primitive::line(Vec3::ZERO, Vec3::Y, 0.4)).expect("a line");
    let turn = Affine3A::from_rotation_translation(Quat::from_rotation_z(0.7), Vec3::X * 0.8);
    let line = parts.warp(line, turn).expect("a turn");
    let line = parts.warp(line, Affine3A::from_translation(at)).expect("a way");
    let both = parts.sum([ball, line]).expect("a sum");
    parts.finish(both).expect("a solid")
}

#[test]
fn solids_far_away_are_those_near_the_origin() {
    for at in PLACES {
        let (far, near) = (warped(at), warped(Vec3::ZERO));
        for point in (0..200)
            .map(|i| Vec3::new(i as f32 * 0.03125 - 3.0, (i % 17) as f32 * 0.125, (i % 5) as f32 * 0.25))
        {
            let point = (point + at) - at;
            assert!((far.value(point + at) - near.value(point)).abs() < 2e-5, "{at} {point}");
            assert!((far.gradient(point + at).1 - near.gradient(point).1).length() < 2e-4, "{at} {point}");
            assert_eq!(far.color(point + at), near.color(point));
            let part = far.part(far.bounds());
            assert_eq!(part.value(point + at), far.value(point + at));
        }
        let surface = Polygonizer::default().with_voxel(0.1);
        let (far, near) = (surface.mesh(&far), surface.mesh(&near).expect("a surface"));
        match far {
            Ok(far) => assert!((volume(&far, at) / volume(&near, Vec3::ZERO) - 1.0).abs() < 0.02, "{at}"),
            Err(error) => {
                assert!(matches!(error, SurfaceError::Shapeless { .. }) && at.x > 4e5, "{at}: {error}");
            }
        }
    }
}

#[test]
fn errors_say_where_how_coarse_and_what_would_do() {
    let tree = moved(&fork(1.0), PLACES[5]);
    let error = Tubes::default().mesh(&tree).expect_err("half a metre is more than a branch").to_string();
    for part in ["5428000", "0.5 m", "subtract an offset"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn leaves_keep_their_shape_or_are_refused() {
    let foliage = Foliage::new(Leaf::ovate()).with_thickest(0.2);
    for at in PLACES {
        for seed in 0..3 {
            let (far, near) = there(&crown(1), at);
            let near = foliage.place(&near, seed).expect("leaves").instances;
            match foliage.place(&far, seed) {
                Ok(far) => {
                    assert_eq!(far.instances.len(), near.len());
                    for (far, near) in far.instances.iter().zip(&near) {
                        assert!((far.position - at).distance(near.position) <= 2.0 * step(at));
                        assert!(far.rotation.dot(near.rotation).abs() > 0.999_9);
                    }
                    assert!(at.abs().max_element() < 2e5);
                }
                Err(error) => {
                    assert!(matches!(error, FoliageError::Shapeless { .. }), "{error}");
                    assert!(at.abs().max_element() > 9e4, "{at}: {error}");
                }
            }
        }
    }
}

#[cfg(feature = "preview")]
#[test]
fn pictures_show_what_they_show_near_the_origin() {
    use treesynth::Silent;
    use treesynth::preview::{Picture, Preview, RayCaster};
    let differ = |a: &Picture, b: &Picture| {
        let pairs = a
            .pixels()
            .iter()
            .zip(b.pixels())
            .filter(|(a, b)| a.iter().zip(b.iter()).any(|(a, b)| a.abs_diff(*b) > 40));
        pairs.count()
    };
    let caster = RayCaster::new(Preview::default().with_size(60, 60));
    for at in &PLACES[..3] {
        let (far, near) = there(&fork(3.0), *at);
        let drawn = |tree: &Skeleton| {
            let skin = Skin::default().blob_tree(tree).expect("a skin");
            let implicit = caster.draw_implicit(&Implicit::default(), tree, &[], &Silent).expect("a picture");
            [caster.draw(&skin, &[], &Silent).expect("a picture"), implicit]
        };
        for (far, near) in drawn(&far).iter().zip(&drawn(&near)) {
            let differ = differ(far, near);
            assert!(differ < 60 * 60 / 20, "{differ} pixels differ at {at}");
        }
    }
}
