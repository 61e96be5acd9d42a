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

/// Bends are round on both sides, whether their nodes are few or many.
#[test]
fn an_axis_that_bends_has_no_crease() {
    let radius = 0.2;
    let step = 0.01 * radius;
    for (turn, nodes) in [(0.05, 7), (0.1, 7), (0.1, 13), (0.3, 7), (0.3, 25)] {
        let angle = |i: usize| i as f32 * 2.4 / (nodes - 1) as f32;
        let points = (0..nodes).map(|i| Vec3::new(math::cos(angle(i)), math::sin(angle(i)), 0.0)).collect();
        let ends = [0.0f32, 2.4].map(|angle| Vec3::new(-math::sin(angle), math::cos(angle), 0.0));
        let curve = Curve::new(points, vec![radius; nodes]).with_turn(turn);
        let tree = worn(&curve.with_tangents(Some(ends[0]), Some(ends[1])));
        let outer = normals(&tree, Vec3::new(1.0 + radius, 0.1, 0.0), Vec3::Z, -step, 700);
        let inner = normals(&tree, Vec3::new(1.0 - radius, 0.1, 0.0), Vec3::Z, step, 500);
        for side in [&outer, &inner] {
            assert!(sharpest(side) < 1.1 * step / radius, "{turn}, {nodes}: {}", sharpest(side));
        }
        assert!(outer[0].angle_between(outer[699]) > 1.0 && inner[0].angle_between(inner[499]) > 1.0);
    }
}

/// An axis that winds and tapers, in space: no two normals of its surface beside each other differ by more than
/// its own curvature makes them, on any of eight lines along it.
#[test]
fn an_axis_that_winds_has_no_crease() {
    let radius = |i: usize| 0.1 - 0.003 * i as f32;
    let place = |i: usize| {
        let angle = i as f32 * 0.35;
        Vec3::new(0.5 * math::cos(angle), 0.12 * i as f32, 0.5 * math::sin(angle))
    };
    let tree = worn(&Curve::new((0..20).map(place).collect(), (0..20).map(radius).collect()).with_turn(0.1));
    let mut worst: f32 = 0.0;
    for line in 0..8 {
        let (sin, cos) = math::sin_cos(line as f32 * std::f32::consts::FRAC_PI_4);
        let mut before: Option<Vec3> = None;
        for k in 300..1600 {
            let angle = k as f32 * 0.0035;
            // Outward, and square to that and the axis.
            let out = Vec3::new(math::cos(angle), 0.0, math::sin(angle));
            let along = Vec3::new(-0.5 * out.z, 0.12 / 0.35, 0.5 * out.x).normalize();
            let (from, side) =
                (out * 0.5 + Vec3::Y * (angle * 0.12 / 0.35), out * cos + along.cross(out) * sin);
            let (mut inside, mut outside) = (0.0, 0.2);
            for _ in 0..30 {
                let middle = 0.5 * (inside + outside);
                if tree.value(from + side * middle) > 0.0 { inside = middle } else { outside = middle }
            }
            let normal = tree.gradient(from + side * inside).1.normalize();
            worst = worst.max(before.map_or(0.0, |before| before.angle_between(normal)));
            before = Some(normal);
        }
    }
    assert!(worst < 0.03, "{worst}");
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
