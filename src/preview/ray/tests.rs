//! Rays against formulas, pictures against promises.

use super::sample::{Shape, Union, one};
use super::*;
use crate::preview::camera::View;
use crate::preview::{Camera, Projection};
use crate::surface::blob::Skin;
use crate::surface::{Material, Mesh, Polygonizer};
use crate::{Bounds, Progress, Silent, math};
use proptest::prelude::*;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// The hash of the picture that all numbers of threads draw.
const PINNED: u64 = 0x163d_ae7c_9077_d74b;
const BOX: Bounds = Bounds { min: Vec3::new(-2.0, -2.0, -2.0), max: Vec3::new(2.0, 2.0, 2.0) };
const BALL: Shape = Shape::Sphere(Vec3::new(0.1, 0.2, 0.3), 1.0);
const RING: Shape = Shape::Torus(Vec3::ZERO, 1.2, 0.3);
const STICK: Shape = Shape::Capsule(Vec3::new(-1.0, -0.5, 0.2), Vec3::new(0.9, 1.1, -0.4), 0.2);

fn view() -> View {
    Camera::default().with_frame(BOX).view(std::iter::empty(), 300.0, 300.0)
}

fn ray(origin: Vec3, to: Vec3) -> Ray {
    Ray { origin, way: (to - origin).normalize(), from: 0.0, to: f32::MAX }
}

fn hit(solid: &Union, ray: &Ray) -> Option<f32> {
    let view = view();
    let octree = Octree::new(solid, &view, 3, usize::MAX);
    octree.hit(&octree.whole(), ray).map(|hit| (hit.point - ray.origin).dot(ray.way))
}

/// The smaller root of |origin + way·t - middle| = radius above 0.
fn formula(ray: &Ray, middle: Vec3, radius: f32) -> Option<f32> {
    let (o, w) = ((ray.origin - middle).as_dvec3(), ray.way.as_dvec3());
    let (half, rest) = (o.dot(w), o.length_squared() - f64::from(radius).powi(2));
    let root = half * half - rest;
    (root >= 0.0 && -half > 0.0).then(|| (-half - root.sqrt()) as f32)
}

fn point(reach: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-reach..reach).prop_map(Vec3::from_array)
}

proptest! {
    #[test]
    fn a_ball_is_hit_where_the_formula_says(from in point(5.0), to in point(1.4)) {
        prop_assume!(from.distance(Vec3::new(0.1, 0.2, 0.3)) > 1.1 && from.distance(to) > 1e-3);
        let ray = ray(from, to);
        let middle = Vec3::new(0.1, 0.2, 0.3);
        let (found, wanted) = (hit(&one(BALL), &ray), formula(&ray, middle, 1.0));
        // A ray may pass, or touch, within the tolerance of a root.
        let least = (middle - ray.origin).cross(ray.way).length();
        prop_assume!((least - 1.0).abs() > 1e-4);
        prop_assert_eq!(found.is_some(), wanted.is_some());
        if let (Some(found), Some(wanted)) = (found, wanted) {
            // At a grazing ray, a small way off the surface is a long way along it.
            let slope = (1.0 - least * least).sqrt();
            prop_assert!((found - wanted).abs() < 5e-4 / slope, "{found} for {wanted}");
        }
    }

    #[test]
    fn nothing_is_missed(from in point(4.0), to in point(1.5), which in 0usize..3) {
        let shape = [BALL, RING, STICK][which];
        prop_assume!(shape.distance(from) > 0.01 && from.distance(to) > 1e-3);
        let ray = ray(from, to);
        let found = hit(&one(shape), &ray);
        let end = found.unwrap_or(12.0);
        let step = 1e-3;
        for i in 0..((end - 2.0 * step) / step) as usize {
            let inside = -shape.distance(ray.origin + ray.way * (i as f32 * step));
            prop_assert!(inside < 1e-3, "{inside} inside at {} of {end}", i as f32 * step);
        }
        if let Some(t) = found {
            prop_assert!(shape.distance(ray.origin + ray.way * t).abs() < 2e-3);
        }
    }

    #[test]
    fn the_list_of_a_beam_does_for_its_rays(from in point(4.0), to in point(1.0), aside in point(0.01)) {
        prop_assume!(from.length() > 2.0);
        let solid = Union([BALL, RING, STICK].map(|shape| (shape, [0.5; 3])).to_vec());
        let view = view();
        let octree = Octree::new(&solid, &view, 3, usize::MAX);
        let (beam, other) = (ray(from, to), ray(from, to + aside));
        prop_assume!(beam.mirror() == other.mirror());
        let mut near = Vec::new();
        let beam = Beam { ray: beam, radius: 0.0, spread: 0.03 };
        octree.gather(octree.whole()[0], &beam, beam.ray.mirror(), 0.0, &mut near);
        let point = |hit: Option<Hit>| hit.map(|hit| hit.point);
        prop_assert_eq!(point(octree.hit(&near, &other)), point(octree.hit(&octree.whole(), &other)));
    }
}

#[test]
fn rays_along_axes_and_through_corners_of_cubes() {
    let solid = one(Shape::Sphere(Vec3::ZERO, 1.0));
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let way = Vec3::AXES[axis] * sign;
            let along =
                |offset: Vec3| hit(&solid, &Ray { origin: offset - 3.0 * way, way, from: 0.0, to: 9.0 });
            assert!((along(Vec3::ZERO).expect("hits") - 2.0).abs() < 1e-3);
            let across = Vec3::AXES[(axis + 1) % 3];
            assert!(along(across * 0.999).is_some() && along(across * 1.001).is_none());
        }
    }
    let diagonal = hit(&solid, &ray(Vec3::splat(-3.0), Vec3::ZERO)).expect("hits");
    assert!((diagonal - (27f32.sqrt() - 1.0)).abs() < 1e-3);
}

#[test]
fn a_ray_that_starts_inside_meets_the_solid_at_once_and_ends_are_kept() {
    let solid = one(BALL);
    assert_eq!(hit(&solid, &ray(Vec3::new(0.1, 0.2, 0.3), Vec3::X)), Some(0.0));
    let short = Ray { to: 1.9, ..ray(Vec3::new(0.1, 0.2, 3.3), Vec3::new(0.1, 0.2, 0.3)) };
    assert_eq!(hit(&solid, &short), None);
    assert!(hit(&solid, &Ray { to: 2.1, ..short }).is_some());
    let behind = Ray { from: 4.5, to: 9.0, ..short };
    assert_eq!(hit(&solid, &behind), None);
}

#[test]
fn surfaces_are_counted_once_by_rays_along_axes() {
    let solid = one(RING);
    let view = view();
    let octree = Octree::new(&solid, &view, 3, usize::MAX);
    let mut ambient = crate::preview::ambient::Ambient::new(solid_bounds(&solid));
    ambient.add_solid(&octree, solid_bounds(&solid));
    let area = std::f32::consts::TAU * std::f32::consts::TAU * 1.2 * 0.3;
    assert!((ambient.surface() - area).abs() < 0.02 * area, "{} for {area}", ambient.surface());
}

fn solid_bounds(solid: &Union) -> Bounds {
    solid.bounds()
}

#[test]
fn the_outline_is_tight() {
    let directions = [Vec3::X, Vec3::NEG_Y, Vec3::new(0.3, 0.5, -0.2), Vec3::new(1.0, 1.0, 1.0)];
    for (direction, point) in directions.into_iter().zip(outline::outline(&one(BALL), &directions)) {
        let reach = Vec3::new(0.1, 0.2, 0.3).dot(direction) + direction.length();
        let error = (point.dot(direction) - reach) / direction.length();
        assert!((-1e-5..8e-3).contains(&error), "{error} along {direction}");
    }
}

fn plain(size: u32) -> Preview {
    let camera = Camera::default().with_elevation(0.0).with_projection(Projection::Orthographic);
    let white = [1.0; 3];
    Preview::default()
        .with_size(size, size)
        .with_background(white, white)
        .with_ground(false)
        .with_camera(camera.with_frame(BOX))
}

#[test]
fn a_wire_is_as_dark_as_it_is_wide_and_never_broken() {
    for width in [0.3f32, 0.8, 3.0] {
        let radius = 0.5 * width * 4.0 / (0.92 * 100.0);
        let wire = Shape::Capsule(Vec3::new(-0.3, -1.9, 0.0), Vec3::new(0.4, 1.9, 0.0), radius);
        let solid = Union(vec![(wire, [0.0; 3])]);
        let picture =
            RayCaster::new(plain(100).with_supersampling(6)).cast(&solid, &[], &Silent).expect("a picture");
        let rows = picture.pixels().chunks(100).skip(10).take(80);
        let dark: Vec<f32> = rows
            .map(|row| {
                let linear = row.iter().map(|pixel| math::powf(f32::from(pixel[0]) / 255.0, 2.2));
                linear.map(|light| 1.0 - light).sum()
            })
            .collect();
        let mean = dark.iter().sum::<f32>() / 80.0;
        assert!((mean - 1.017 * width).abs() < 0.08 * width, "{mean} for {width}");
        assert!(dark.iter().all(|&row| row > 0.2 * width), "a gap at {width}");
    }
}

#[test]
fn a_ball_stands_before_and_behind_a_board() {
    let board = |z: f32| {
        let corner = |x: f32, y: f32| Vec3::new(x * 1.5, y * 1.5, z);
        let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Mesh::new(corners, vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3])
    };
    let red = Union(vec![(Shape::Sphere(Vec3::ZERO, 0.7), [0.9, 0.0, 0.0])]);
    let blue = Material::bark().with_color([0.0, 0.0, 0.9]);
    for (z, ball_first) in [(-1.0, true), (1.0, false)] {
        let board = board(z);
        let parts = [Part::new(&board).with_material(blue)];
        let picture = RayCaster::new(plain(64)).cast(&red, &parts, &Silent).expect("a picture");
        let [red, _, blue] = picture.pixel(32, 32).expect("inside");
        assert_eq!(red > blue, ball_first, "{red} {blue} with the board at {z}");
        let [red, _, blue] = picture.pixel(18, 18).expect("inside");
        assert!(blue > red);
    }
}

#[test]
fn a_ball_shades_what_is_below_it() {
    let ball = |y: f32| (Shape::Sphere(Vec3::new(0.0, y, 0.0), 0.5), [0.5; 3]);
    let solid = Union(vec![ball(-1.0), ball(1.0)]);
    let preview = plain(80).with_sun(Vec3::Y);
    let draw = |shadows: bool| {
        let caster = RayCaster::new(preview.clone()).with_shadows(shadows);
        caster.cast(&solid, &[], &Silent).expect("a picture").pixel(40, 51).expect("inside")[1]
    };
    assert!(draw(true) + 40 < draw(false), "{} {}", draw(true), draw(false));
}

#[test]
fn threads_do_not_matter() {
    let solid = Union([BALL, RING, STICK].map(|shape| (shape, [0.3; 3])).to_vec());
    let caster = RayCaster::new(Preview::default().with_size(90, 70));
    let pictures = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| caster.cast(&solid, &[], &Silent).expect("a picture"))
    });
    assert!(pictures[0] == pictures[1] && pictures[1] == pictures[2]);
    let bytes = pictures[0].pixels().as_flattened().iter();
    // FNV-1a. If it is meant to change, so is CHANGELOG.md.
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    assert_eq!(hash, PINNED, "{hash:#x}");
}

#[test]
fn it_can_be_watched_and_stopped() {
    let caster = RayCaster::new(Preview::default().with_size(60, 100));
    let seen = Mutex::new(Vec::new());
    let watch = |progress: Progress| {
        seen.lock().expect("no panic").push(progress.fraction);
        ControlFlow::Continue(())
    };
    caster.cast(&one(BALL), &[], &watch).expect("a picture");
    let seen = seen.into_inner().expect("no panic");
    assert!(seen.len() > 2 && seen.is_sorted() && seen.last() == Some(&1.0), "{seen:?}");
    let stop = |_: Progress| ControlFlow::Break(());
    assert!(matches!(caster.cast(&one(BALL), &[], &stop), Err(PreviewError::Cancelled)));
}

/// First point at which a ray meets a mesh, tried one triangle after the other.
fn nearest(mesh: &Mesh, ray: &Ray) -> Option<f32> {
    let triangles = mesh.triangles().map(|corners| corners.map(|corner| mesh.positions[corner as usize]));
    let meets = triangles.filter_map(|[a, b, c]| {
        // Möller and Trumbore 1997.
        let (ab, ac, from) = (b - a, c - a, ray.origin - a);
        let across = ray.way.cross(ac);
        let inverse = 1.0 / ab.dot(across);
        let (u, v) = (from.dot(across) * inverse, ray.way.dot(from.cross(ab)) * inverse);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| ac.dot(from.cross(ab)) * inverse)
    });
    meets.filter(|&t| t > 0.0).min_by(f32::total_cmp)
}

/// The root of the field and the polygonizer's mesh of it.
#[test]
fn rays_hit_where_the_mesh_is() {
    let points = vec![Vec3::ZERO, Vec3::Y, Vec3::new(0.2, 2.0, 0.1), Vec3::new(0.8, 1.5, 0.3)];
    let skeleton = Skeleton::new(points, vec![None, Some(0), Some(1), Some(1)]).expect("a tree");
    let skeleton = skeleton.with_radii(vec![0.2, 0.15, 0.1, 0.1]).expect("sound radii");
    let surface = Implicit::default().with_voxel(0.02);
    let mesh = surface.mesh(&skeleton).expect("a surface");
    let (field, voxel) = surface.field(&skeleton).expect("a field");
    let (solid, view) = (&field, view());
    let octree = Octree::new(&solid, &view, 3, usize::MAX);
    let (mut both, mut one) = (0, 0);
    for i in 0..400 {
        let angle = i as f32 * 2.4;
        let to = Vec3::new(0.3 * math::cos(3.7 * angle), i as f32 * 0.005, 0.3 * math::sin(1.3 * angle));
        let ray =
            ray(Vec3::new(4.0 * math::cos(angle), 2.0 * math::sin(0.3 * angle), 4.0 * math::sin(angle)), to);
        let found = octree.hit(&octree.whole(), &ray);
        let nearest = nearest(&mesh, &ray);
        match (found, nearest) {
            (Some(hit), Some(nearest)) => {
                both += 1;
                let off = (ray.origin + ray.way * nearest - hit.point).dot(hit.normal).abs();
                // Grazing rays may miss what is half a voxel off and hit what is behind it.
                one += usize::from(off > voxel);
            }
            (None, None) => {}
            _ => one += 1,
        }
    }
    assert!(both > 150 && one * 50 < both, "{both} hits of both, {one} apart");
}

/// A small tree with forks, some of them old, in no order.
fn small_tree(seed: u32) -> Skeleton {
    let unit = |i: u32, n: u32| {
        // A round of splitmix, of 32 bits.
        let mut x = (seed * 1009 + i * 31 + n).wrapping_mul(0x9e37_79b9);
        x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
        (x ^ (x >> 13)) as f32 / u32::MAX as f32
    };
    let (mut positions, mut parents) = (vec![Vec3::ZERO], vec![None]);
    let (mut radii, mut stages) = (vec![0.12], vec![0]);
    for i in 1..14u32 {
        // Mostly on from the last, at times from any.
        let parent = if unit(i, 0) < 0.6 { i - 1 } else { (unit(i, 1) * i as f32) as u32 };
        let way = Vec3::new(unit(i, 2) - 0.5, 0.3 + unit(i, 3), unit(i, 4) - 0.5).normalize();
        positions.push(positions[parent as usize] + way * (0.2 + 0.2 * unit(i, 5)));
        radii.push(radii[parent as usize] * (0.75 + 0.2 * unit(i, 6)));
        stages.push(stages[parent as usize] + u16::from(unit(i, 7) < 0.4));
        parents.push(Some(parent));
    }
    let tree = Skeleton::new(positions, parents).and_then(|tree| tree.with_radii(radii));
    tree.and_then(|tree| tree.with_stages(stages)).expect("a tree")
}

/// First hits of rays and of the mesh are less than a voxel of each other; or neither hits; or the one that hits first only
/// grazes, less than a voxel deep.
#[test]
fn rays_hit_a_skin_where_its_mesh_is() {
    let (mut hits, mut grazing, mut misses) = (0, 0, 0);
    for seed in 0..4 {
        let skeleton = small_tree(seed);
        let skin = Skin::default().with_age(6.0).blob_tree(&skeleton).expect("a skin");
        let voxel = 0.008;
        let mesh = Polygonizer::default().with_voxel(voxel).mesh(&skin).expect("a mesh");
        let (view, bounds) = (view(), skin.bounds());
        let octree = Octree::new(&skin, &view, 3, usize::MAX);
        for i in 0..250u32 {
            let unit = |n: u32| {
                (i * 7 + seed + 1).wrapping_mul(n).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32
            };
            let way = Vec3::new(unit(1) - 0.5, unit(7919) - 0.5, unit(104_729) - 0.5).normalize();
            let to = bounds.at(Vec3::new(unit(31), unit(6007), unit(50_021)));
            let ray = ray(to + way * 5.0, to);
            let along = |t: f32| ray.origin + ray.way * t;
            let cast = octree.hit(&octree.whole(), &ray).map(|hit| (hit.point - ray.origin).dot(ray.way));
            let met = nearest(&mesh, &ray);
            let Some(first) = [cast, met].into_iter().flatten().reduce(f32::min) else {
                misses += 1;
                continue;
            };
            let off = |t: f32| {
                let (value, slope) = skin.gradient(along(t));
                value / slope.length().max(1e-3)
            };
            // A hit by only one, or far before the other, is judged by its depth, to where the ray
            // leaves.
            let both = cast.zip(met).is_some_and(|(a, b)| {
                let normal = skin.gradient(along(first)).1.normalize_or_zero();
                (a - b).abs() * normal.dot(ray.way).abs() < voxel
            });
            if both {
                hits += 1;
                continue;
            }
            grazing += 1;
            // The rim of the trunk base is sharp, that of its mesh is not.
            if (along(first).y - skeleton.positions()[0].y).abs() < 2.0 * voxel {
                continue;
            }
            let deep = (1..).map(|k| off(first + 0.1 * voxel * k as f32)).take_while(|&deep| deep > 0.0);
            let deepest = deep.fold(off(first).abs(), f32::max);
            assert!(deepest < voxel, "{deepest} deep at {first}: {cast:?}, {met:?}, tree {seed}, ray {i}");
        }
    }
    assert!(hits > 150 && misses > 150 && grazing * 20 < hits, "{hits}, {grazing}, {misses}");
}

#[test]
fn faults_are_named() {
    let caster = RayCaster::new(Preview::default().with_size(40, 40));
    let error = |caster: &RayCaster, solid: &Union| caster.cast(solid, &[], &Silent).expect_err("not sound");
    for cubes in [0, 2_000_000_000] {
        let message = error(&caster.clone().with_most_cubes(cubes), &one(BALL)).to_string();
        assert!(message.contains("RayCaster.most_cubes"), "{message}");
    }
    let full = error(&caster.clone().with_most_cubes(50), &one(RING));
    assert!(matches!(full, PreviewError::TooManyCubes { most: 50 }), "{full}");
    assert!(matches!(error(&caster, &Union(Vec::new())), PreviewError::EmptySolid));
    let far = Shape::Sphere(Vec3::X * 1e12, 1.0);
    assert!(matches!(error(&caster, &one(far)), PreviewError::TooFar { .. }));
    let dark = RayCaster::new(Preview::default().with_sun(Vec3::NAN));
    assert!(matches!(error(&dark, &one(BALL)), PreviewError::Parameter(_)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_union_has_a_picture(
        ends in prop::collection::vec((point(1.0), point(1.0), 0.001f32..0.5), 1..8),
        scale in prop::sample::select(vec![1e-5f32, 1.0, 1e5]),
        azimuth in -7.0f32..7.0, elevation in -1.57f32..1.57, perspective in any::<bool>(),
        frame in prop::option::of(0.01f32..2.0), size in (1u32..40, 1u32..40), samples in 1u32..5,
        transparent in any::<bool>(),
    ) {
        let stick = |&(a, b, r): &(Vec3, Vec3, f32)| Shape::Capsule(a * scale, b * scale, r * scale);
        let solid = Union(ends.iter().map(|ends| (stick(ends), [0.4; 3])).collect());
        let projection =
            if perspective { Projection::Perspective { field_of_view: 1.0 } } else { Projection::Orthographic };
        let mut camera =
            Camera::default().with_azimuth(azimuth).with_elevation(elevation).with_projection(projection);
        if let Some(half) = frame {
            camera = camera.with_frame(Bounds::around(Vec3::ZERO, Vec3::splat(half * scale)));
        }
        let preview = Preview::default()
            .with_size(size.0, size.1)
            .with_supersampling(samples)
            .with_camera(camera)
            .with_transparency(transparent);
        let picture = RayCaster::new(preview).cast(&solid, &[], &Silent);
        prop_assert_eq!(picture.map(|p| (p.width(), p.height())).ok(), Some(size));
    }
}
