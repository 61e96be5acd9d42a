//! The contract of every shape, checked over one list of shapes.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use proptest::prelude::*;

use super::*;
use crate::random::{Purpose, stream};

fn boxed<'a>(shape: impl Shape + 'a) -> Box<dyn Shape + 'a> {
    Box::new(shape)
}

/// One of each, from a center and three lengths.
fn shapes(center: Vec3, sizes: Vec3) -> Vec<(&'static str, Box<dyn Shape>)> {
    let ellipsoid = Ellipsoid::new(center, sizes);
    let half = HalfEllipsoid::new(center, sizes);
    let sphere = Sphere::new(center + sizes * 0.4, sizes.x);
    let cuboid = Cuboid::centered(center, sizes * 1.5);
    let moved = Translated::new(half, Vec3::new(0.3, -4.7, 11.1));
    let far_off = Translated::new(ellipsoid, Vec3::splat(200.0));
    vec![
        ("Cuboid", boxed(cuboid)),
        ("Sphere", boxed(sphere)),
        ("Ellipsoid", boxed(ellipsoid)),
        ("HalfEllipsoid", boxed(half)),
        ("Cone", boxed(Cone::new(center, sizes.x, sizes.y))),
        ("Cylinder", boxed(Cylinder::new(center, sizes.x, sizes.y))),
        ("Brush", boxed(Brush::new(vec![center, center + sizes, center + sizes.with_y(0.0)], 0.5 * sizes.x))),
        ("Shell", boxed(Shell::new(ellipsoid, 0.3))),
        ("Shell of a dome", boxed(Shell::new(half, 0.3).about(center))),
        ("Union", boxed(Union::new(ellipsoid, cuboid))),
        ("Union far apart", boxed(Union::new(ellipsoid, far_off))),
        ("Intersection", boxed(Intersection::new(ellipsoid, cuboid))),
        ("Difference", boxed(Difference::new(ellipsoid, sphere))),
        ("Translated", boxed(moved)),
        (
            "nested",
            boxed(Arc::new(Difference::new(Box::new(Union::new(half, cuboid)), Shell::new(sphere, 0.5)))),
        ),
        ("TriangleMesh", tetrahedron(center, sizes)),
        ("Sketch", boxed(Sketch::new(kite(center, sizes)).with_profiles([UNEVEN]))),
        ("Sketch of two", boxed(Sketch::new(kite(center, sizes)).with_side(kite(center, sizes)))),
        ("Extrusion", boxed(Extrusion::new(kite(center, sizes), sizes.z))),
    ]
}

/// A tetrahedron on three corners of a box; for invalid numbers, an invalid ball.
fn tetrahedron(center: Vec3, sizes: Vec3) -> Box<dyn Shape> {
    let corners = [center, center + Vec3::X * sizes, center + Vec3::Y * sizes, center + Vec3::Z * sizes];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    match TriangleMesh::new(&corners, &faces) {
        Ok(mesh) => boxed(mesh),
        Err(_) => boxed(Sphere::new(center, -1.0)),
    }
}

const UNEVEN: CrossProfile = CrossProfile::new([1.0, 0.7, 1.3, 1.0, 0.8, 1.2, 0.9, 1.0]);

fn kite(center: Vec3, sizes: Vec3) -> Outline {
    let at = |x: f32, y: f32| Vec2::new(center.x + x * sizes.x, center.y + y * sizes.y);
    Outline::new([at(0.0, -1.0), at(1.0, 0.2), at(0.1, 1.0), at(-0.8, 0.5)])
}

fn centers() -> impl Strategy<Value = Vec3> {
    (-100.0_f32..100.0, -100.0_f32..100.0, -100.0_f32..100.0).prop_map(Vec3::from)
}

fn sizes() -> impl Strategy<Value = Vec3> {
    (0.1_f32..30.0, 0.1_f32..30.0, 0.1_f32..30.0).prop_map(Vec3::from)
}

/// Any floats at all.
fn wild() -> impl Strategy<Value = Vec3> {
    let any = || {
        prop_oneof![
            any::<f32>(),
            prop::sample::select(vec![
                0.0,
                -1.0,
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::MAX,
                f32::MIN,
                f32::MIN_POSITIVE,
                1e-45,
                1e6,
                1e-6,
            ])
        ]
    };
    (any(), any(), any()).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn contained_points_are_in_bounds(center in centers(), sizes in sizes(), seed: u64) {
        for (name, shape) in shapes(center, sizes) {
            prop_assert!(shape.check().is_ok(), "{name}");
            let bounds = shape.bounds();
            // Points all around, and points a rounding error from the faces.
            let around = Cuboid::from(bounds.grown(sizes.max_element() * 0.2));
            let mut random = stream(seed, 0, Purpose::CUSTOM, 0);
            for _ in 0..200 {
                let point = around.sample(&mut random).expect("a box is not empty");
                prop_assert!(!shape.contains(point) || bounds.contains(point), "{name} {point}");
                for face in [point.with_x(bounds.max.x.next_up()), point.with_y(bounds.min.y.next_down())] {
                    prop_assert!(!shape.contains(face), "{name} {face}");
                }
            }
            let middle = bounds.center();
            for axis in Vec3::AXES {
                let outside = middle + axis * (bounds.size().dot(axis) * 0.5 + 1e-3);
                prop_assert!(!shape.contains(outside), "{name} {outside}");
            }
        }
    }

    #[test]
    fn samples_are_contained_and_repeatable(center in centers(), sizes in sizes(), seed: u64) {
        for (name, shape) in shapes(center, sizes) {
            let draw = || {
                let mut random = stream(seed, 0, Purpose::CUSTOM, 1);
                (0..50).map(|_| shape.sample(&mut random)).collect::<Vec<_>>()
            };
            let points = draw();
            // A difference may be empty if the sphere covers the ellipsoid.
            let may_be_empty = name == "Difference";
            for point in &points {
                match point {
                    Some(point) => prop_assert!(shape.contains(*point), "{name} {point}"),
                    None => prop_assert!(may_be_empty, "{name}"),
                }
            }
            prop_assert_eq!(points, draw());
        }
    }

    #[test]
    fn nothing_panics_on_any_floats(center in wild(), sizes in wild(), point in wild(), seed: u64) {
        let mut random = stream(seed, 0, Purpose::CUSTOM, 2);
        for (name, shape) in shapes(center, sizes) {
            let checked = shape.check();
            let volume = shape.volume();
            prop_assert!(volume >= 0.0, "{name} {volume}");
            let sample = shape.sample(&mut random);
            prop_assert!(sample.is_none_or(|point| point.is_finite() && shape.contains(point)), "{name}");
            prop_assert!(point.is_finite() || !shape.contains(point), "{name} {point}");
            if checked.is_ok() {
                prop_assert!(volume.is_finite() && shape.bounds().is_finite(), "{name} {volume}");
            }
        }
    }
}

#[test]
fn analytic_volumes_agree_with_the_lattice() {
    for (name, shape) in shapes(Vec3::new(1.0, 2.0, -3.0), Vec3::new(2.0, 3.0, 1.5)) {
        if name == "Union far apart" {
            continue;
        }
        let estimate = lattice_volume(shape.bounds(), |point| shape.contains(point));
        let error = shape.volume() / estimate - 1.0;
        assert!(error.abs() < 0.01, "{name}: {} but {estimate}", shape.volume());
    }
}

#[test]
fn volumes_by_hand() {
    let ball = Sphere::new(Vec3::ZERO, 1.0);
    let cube = |x| Cuboid::centered(Vec3::X * x, Vec3::splat(2.0));
    let close = |shape: &dyn Shape, expected: f32| {
        assert!((shape.volume() / expected - 1.0).abs() < 0.01, "{} {expected}", shape.volume());
    };
    close(&Union::new(cube(0.0), cube(1.0)), 12.0);
    close(&Union::new(cube(0.0), cube(50.0)), 16.0);
    close(&Intersection::new(cube(0.0), cube(1.0)), 4.0);
    close(&Difference::new(cube(0.0), ball), 8.0 - 4.188_79);
    close(&Difference::new(ball, cube(9.0)), 4.188_79);
    assert_eq!(Intersection::new(ball, cube(9.0)).volume().to_bits(), 0);
    assert_eq!(Difference::new(ball, cube(0.0)).volume().to_bits(), 0);
}

#[test]
fn lattice_does_not_line_up_with_faces() {
    // A slab from 0.5 to 0.5 + 1/96 of the bounds: half a cell thick.
    let bounds = Bounds::new(Vec3::ZERO, Vec3::ONE);
    let thin = lattice_volume(bounds, |point| (0.5..0.5 + 1.0 / 96.0).contains(&point.y));
    assert!((thin * 96.0 - 1.0).abs() < 0.05, "{thin}");
}

#[test]
fn unions_are_sampled_by_volume() {
    let left = Cuboid::new(Vec3::ZERO, Vec3::new(2.0, 1.0, 1.0));
    let right = Cuboid::new(Vec3::X, Vec3::new(5.0, 1.0, 1.0));
    let union = Union::new(left, right);
    let mut random = stream(6, 0, Purpose::CUSTOM, 0);
    let mut fifths = [0_u32; 5];
    for _ in 0..20_000 {
        fifths[union.sample(&mut random).expect("not empty").x as usize] += 1;
    }
    assert!(fifths.iter().all(|&count| count.abs_diff(4000) < 250), "{fifths:?}");
}

#[test]
fn empty_shapes_have_no_samples() {
    let ball = Sphere::new(Vec3::ZERO, 1.0);
    let far = Sphere::new(Vec3::X * 9.0, 1.0);
    let mut random = stream(7, 0, Purpose::CUSTOM, 0);
    assert!(Intersection::new(ball, far).bounds().is_empty());
    for shape in [
        boxed(Intersection::new(ball, far)),
        boxed(Difference::new(ball, ball)),
        boxed(Union::new(Difference::new(ball, ball), Difference::new(far, far))),
        boxed(Sphere::new(Vec3::ZERO, f32::INFINITY)),
        boxed(Union::new(Sphere::new(Vec3::NAN, 1.0), Sphere::new(Vec3::ZERO, -1.0))),
    ] {
        assert_eq!(shape.sample(&mut random), None);
        assert_eq!(shape.volume().to_bits(), 0);
    }
    // One broken half does not hide the other.
    let half_broken = Union::new(Sphere::new(Vec3::ZERO, -1.0), ball);
    assert!(half_broken.check().is_err() && half_broken.sample(&mut random).is_some());
}

#[test]
fn checks_name_the_parameter() {
    let at = Vec3::ONE;
    let expect = |shape: &dyn Shape, parameter: &str| {
        let error = shape.check().expect_err(parameter);
        assert_eq!(error.parameter, parameter);
        assert!(error.range.contains("metres"), "{error}");
    };
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.1e6, 1.1e6] {
        let bad_point = Vec3::new(0.0, bad, 0.0);
        expect(&Cuboid::new(bad_point, at), "Cuboid.min");
        expect(&Cuboid::new(-at, bad_point), "Cuboid.max");
        expect(&Sphere::new(bad_point, 1.0), "Sphere.center");
        expect(&Ellipsoid::new(bad_point, at), "Ellipsoid.center");
        expect(&HalfEllipsoid::new(bad_point, at), "HalfEllipsoid.base_center");
        expect(&Cone::new(bad_point, 1.0, 1.0), "Cone.base_center");
        expect(&Cylinder::new(bad_point, 1.0, 1.0), "Cylinder.base_center");
        expect(&Translated::new(Sphere::new(at, 1.0), bad_point), "Translated.offset");
    }
    for bad in [f32::NAN, f32::INFINITY, 0.0, -1.0, 1e-7, 1.1e6] {
        let bad_radii = Vec3::new(1.0, 1.0, bad);
        expect(&Sphere::new(at, bad), "Sphere.radius");
        expect(&Ellipsoid::new(at, bad_radii), "Ellipsoid.radii");
        expect(&HalfEllipsoid::new(at, bad_radii), "HalfEllipsoid.radii");
        expect(&Cone::new(at, bad, 1.0), "Cone.radius");
        expect(&Cone::new(at, 1.0, bad), "Cone.height");
        expect(&Cylinder::new(at, bad, 1.0), "Cylinder.radius");
        expect(&Cylinder::new(at, 1.0, bad), "Cylinder.height");
    }
    let error = Brush::new(Vec::new(), 1.0).check().expect_err("no points");
    assert_eq!((error.parameter.as_str(), error.range.as_str()), ("Brush.points", "at least 1 point"));
    for flat in [Vec3::new(1.0, 0.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::ZERO] {
        expect(&Cuboid::centered(at, flat), "Cuboid.max");
    }
    let (good, bad) = (Sphere::new(at, 1.0), Cone::new(at, 1.0, 0.0));
    for shape in [
        boxed(Union::new(good, bad)),
        boxed(Union::new(bad, good)),
        boxed(Intersection::new(good, bad)),
        boxed(Difference::new(good, bad)),
        boxed(Shell::new(bad, 0.5)),
        boxed(Translated::new(&bad, at)),
        boxed(Arc::new(Box::new(bad) as Box<dyn Shape>)),
    ] {
        expect(&shape, "Cone.height");
    }
}

#[test]
fn limits_are_inclusive() {
    for shape in [
        boxed(Sphere::new(Vec3::splat(LARGEST), LARGEST)),
        boxed(Ellipsoid::new(Vec3::splat(-LARGEST), Vec3::splat(SMALLEST))),
        boxed(Cuboid::new(Vec3::splat(-LARGEST), Vec3::splat(LARGEST))),
        boxed(Cone::new(Vec3::ZERO, SMALLEST, LARGEST)),
    ] {
        assert_eq!(shape.check(), Ok(()));
        assert!(shape.volume().is_finite());
        let mut random = stream(8, 0, Purpose::CUSTOM, 0);
        assert!(shape.sample(&mut random).is_some_and(|point| shape.contains(point)));
    }
}

#[test]
fn samples_are_pinned() {
    let mut random = stream(9, 0, Purpose::CUSTOM, 0);
    let sum: Vec3 = shapes(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0))
        .iter()
        .map(|(name, shape)| shape.sample(&mut random).expect(name))
        .sum();
    assert_eq!(sum.to_array().map(f32::to_bits), PINNED_SAMPLES, "{sum}");
}
const PINNED_SAMPLES: [u32; 3] = [1_129_005_981, 1_129_273_600, 1_129_816_641];
