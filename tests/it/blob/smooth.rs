//! Surfaces that are to be smooth have normals that turn no faster than their shape asks for.

use treesynth::glam::Vec3;
use treesynth::math;
use treesynth::surface::blob::{BlobTree, BlobTreeBuilder, Curve, Primitive, Skin, fork};

/// The normals along a line of the surface: that in the plane through `start` across `side`, from near `start` on, in steps of
/// `step` metres.
fn normals(tree: &BlobTree, start: Vec3, side: Vec3, step: f32, count: usize) -> Vec<Vec3> {
    let mut point = start;
    let mut normals: Vec<Vec3> = Vec::new();
    for _ in 0..count {
        for _ in 0..12 {
            let (value, slope) = tree.gradient(point);
            let slope = slope - side * slope.dot(side);
            let most = step.abs() / slope.length();
            point -= slope * (value / slope.length_squared()).clamp(-most, most);
        }
        let normal = -tree.gradient(point).1.normalize();
        normals.push(normal);
        point += normal.cross(side).normalize() * step;
    }
    normals
}

/// The greatest turn from each to the next, radians.
fn sharpest(normals: &[Vec3]) -> f32 {
    normals.windows(2).map(|pair| pair[0].angle_between(pair[1])).fold(0.0, f32::max)
}

fn worn(curve: &Curve) -> BlobTree {
    let mut builder = BlobTreeBuilder::default();
    let root = builder.curve(curve).expect("a curve");
    builder.finish(root).expect("a solid")
}

/// Below an old fork the trunk's side goes over into the limb's as on a fillet with the radius of the trunk.
#[test]
fn below_old_forks_the_surface_is_smooth() {
    for years in [7.0, 10.0] {
        let skeleton = fork(years).expect("a fork");
        let tree = Skin::default().with_age(years + 1.0).blob_tree(&skeleton).expect("a skin");
        let (foot, radius) = (skeleton.positions()[7], skeleton.radii()[7]);
        let out = (skeleton.positions()[21] - foot).with_y(0.0).normalize();
        let start = foot + out * radius - Vec3::Y * (1.3 * radius);
        let side = Vec3::Y.cross(out);
        let normals = normals(&tree, start, side, 0.05 * radius, 60);
        // It goes all the way from the trunk's side to the limb's.
        let [first, last] = [normals[0], normals[59]].map(|normal| normal.dot(Vec3::Y));
        assert!(first > 0.0 && last < -0.6, "{first} {last}");
        assert!(sharpest(&normals) < 0.05, "{} after {years} years", sharpest(&normals));
    }
}

/// The axil's ridge stays sharp.
#[test]
fn in_the_axil_there_is_a_crease() {
    let skeleton = fork(10.0).expect("a fork");
    let tree = Skin::default().with_age(11.0).blob_tree(&skeleton).expect("a skin");
    let (foot, radius) = (skeleton.positions()[7], skeleton.radii()[7]);
    let out = (skeleton.positions()[21] - foot).with_y(0.0).normalize();
    let start = foot + out * radius + Vec3::Y * (3.5 * radius);
    let normals = normals(&tree, start, out.cross(Vec3::Y), 0.05 * radius, 60);
    assert!(sharpest(&normals) > 0.7, "{}", sharpest(&normals));
}

/// A straight axis that tapers ever more: no rings where its cones meet.
#[test]
fn an_axis_that_tapers_is_smooth() {
    let radii = vec![1.0, 0.99, 0.95, 0.86, 0.7, 0.5];
    let points = (0..6).map(|i| Vec3::Y * (i as f32 * 0.7)).collect();
    let tree = worn(&Curve::new(points, radii).with_turn(0.1));
    let step = 0.01;
    let normals = normals(&tree, Vec3::new(1.0, 0.05, 0.0), Vec3::Z, -step, 300);
    let turned = normals[0].angle_between(normals[299]);
    assert!((0.2..0.5).contains(&turned), "{turned}");
    // Cones are as round where they meet as the ball they share, of which the least is half a
    // metre.
    assert!(sharpest(&normals) < 2.2 * step, "{}", sharpest(&normals));
}

/// On the outer side of a bend it is round, and on the inner side there is no crease sharper than asked for.
#[test]
fn an_axis_that_bends_is_as_smooth_as_asked_for() {
    let turn = 0.1;
    let radius = 0.2;
    let points = (0..7).map(|i| {
        let angle = i as f32 * 0.4;
        Vec3::new(math::cos(angle), math::sin(angle), 0.0)
    });
    let ends = [0.0f32, 2.4].map(|angle| Vec3::new(-math::sin(angle), math::cos(angle), 0.0));
    let curve = Curve::new(points.collect(), vec![radius; 7]).with_turn(turn);
    let tree = worn(&curve.with_tangents(Some(ends[0]), Some(ends[1])));
    let step = 0.01 * radius;
    let outer = normals(&tree, Vec3::new(1.0 + radius, 0.1, 0.0), Vec3::Z, -step, 700);
    assert!(sharpest(&outer) < 1.1 * step / radius, "{}", sharpest(&outer));
    let inner = normals(&tree, Vec3::new(1.0 - radius, 0.1, 0.0), Vec3::Z, step, 500);
    assert!(sharpest(&inner) < turn + step / radius, "{}", sharpest(&inner));
    assert!(outer[0].angle_between(outer[699]) > 1.0 && inner[0].angle_between(inner[499]) > 1.0);
}

/// A cone's field is the greatest of the balls' along it, whatever its taper.
#[test]
fn a_cone_is_the_union_of_the_balls_along_it() {
    let alone = |primitive: Primitive| {
        let mut builder = BlobTreeBuilder::default();
        let root = builder.add(primitive).expect("a primitive");
        builder.finish(root).expect("a solid")
    };
    for [start, end] in [[0.5, 0.5], [0.5, 0.2], [0.1, 0.7], [1.0, 0.1], [1.5, 0.1], [0.2, 3.0]] {
        let (from, to) = (Vec3::new(0.1, -0.4, 0.2), Vec3::new(0.3, 0.6, -0.1));
        let cone = alone(Primitive::cone([from, to], [start, end]));
        let balls: Vec<_> = (0..=400)
            .map(|i| i as f32 / 400.0)
            .map(|t| alone(Primitive::point(from.lerp(to, t), start + (end - start) * t)))
            .collect();
        for i in 0..400u32 {
            let unit = |n: u32| i.wrapping_mul(n).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32 - 0.5;
            let point = Vec3::new(unit(1), unit(7919), unit(104_729)) * 5.0;
            let greatest = balls.iter().map(|ball| ball.value(point)).fold(-0.5, f32::max);
            let off = cone.value(point) - greatest;
            assert!((-1e-5..1e-3).contains(&off), "{off} at {point} of {start} to {end}");
        }
    }
}
