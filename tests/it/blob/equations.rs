//! Equations 2 to 4, precise contact modelling, and trees as deep and wide as they come.

use crate::sample::cases;
use proptest::prelude::*;
use treesynth::Bounds;
use treesynth::glam::{Affine3A, Vec3};
use treesynth::surface::blob::{
    BlobTree, BlobTreeBuilder, Bounded, Contact, FieldFunction, Operator, Primitive,
};

const INNER: f32 = 0.4;
const RADIUS: f32 = 0.8;

/// Two lines that cross, under one operator.
fn lines(builder: &mut BlobTreeBuilder) -> [treesynth::surface::blob::Node; 2] {
    let stem = Primitive::line(Vec3::NEG_Y, Vec3::Y, 0.3);
    let twig = Primitive::cone([Vec3::ZERO, Vec3::new(1.0, 0.8, 0.2)], [0.25, 0.15]);
    [stem, twig].map(|line| builder.add(line).expect("a sound line"))
}

fn under(operator: Operator) -> BlobTree {
    let mut builder = BlobTreeBuilder::default();
    let lines = lines(&mut builder);
    let root = builder.combine(operator, lines).expect("two parts");
    builder.finish(root).expect("a solid")
}

fn bounding() -> Primitive {
    let field = FieldFunction::Bounding { inner: INNER };
    Primitive::point(Vec3::new(0.3, 0.3, 0.0), RADIUS).with_field(field)
}

fn bounded(inside: Operator, outside: Operator, field: Primitive) -> BlobTree {
    let mut builder = BlobTreeBuilder::default();
    let lines = lines(&mut builder);
    let field = builder.add(field).expect("a sound field");
    let root = builder.bounded(lines, Bounded::new(inside, outside), field).expect("two parts and a field");
    builder.finish(root).expect("a solid")
}

fn operators() -> impl Strategy<Value = Operator> {
    prop_oneof![
        Just(Operator::Sum),
        Just(Operator::Union),
        Just(Operator::Intersection),
        Just(Operator::Difference),
        (1.0f32..6.0).prop_map(Operator::SuperElliptic),
        (0.0f32..3.0).prop_map(|bulge| Operator::Contact(Contact::default().with_bulge(bulge))),
        Just(Operator::Pressed(Contact::default())),
    ]
}

fn places() -> impl Strategy<Value = Vec3> {
    [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn equation_4_is_what_is_computed(inside in operators(), outside in operators(), point in places()) {
        let blend = bounded(inside, outside, bounding());
        let [(b1, slope1), (b2, slope2)] = [inside, outside].map(|operator| under(operator).gradient(point));
        let distance = point.distance(Vec3::new(0.3, 0.3, 0.0));
        let weight = FieldFunction::Bounding { inner: INNER }.value(distance / RADIUS);
        let (value, slope) = blend.gradient(point);
        prop_assert!((value - (weight * b1 + (1.0 - weight) * b2)).abs() < 1e-5);
        if weight == 1.0 {
            prop_assert_eq!((value, slope), (b1, slope1));
        }
        if weight == 0.0 {
            prop_assert_eq!((value, slope), (b2, slope2));
        }
    }

    /// Across both ends of the bounding field the gradient does not jump, for two blends that are smooth themselves.
    #[test]
    fn bounded_blends_are_smooth(direction in places(), at_inner: bool) {
        prop_assume!(direction.length() > 0.1);
        let blend = bounded(Operator::Sum, Operator::SuperElliptic(2.0), bounding());
        let end = if at_inner { INNER } else { 1.0 } * RADIUS;
        let at = |distance: f32| Vec3::new(0.3, 0.3, 0.0) + direction.normalize() * distance;
        let [before, after] = [end - 1e-4, end + 1e-4].map(|distance| blend.gradient(at(distance)));
        prop_assert!((before.0 - after.0).abs() < 3e-3);
        // Second derivatives are below 500 everywhere; a jump would not shrink with the step.
        prop_assert!(before.1.distance(after.1) < 0.1, "{:?} and {:?}", before, after);
    }

    /// Gascuel 1993: two equal solids meet in the plane between them.
    #[test]
    fn equal_solids_meet_in_the_plane_between(y in -0.2f32..0.2, z in -0.2f32..0.2, bulge in 0.0f32..3.0) {
        let mut builder = BlobTreeBuilder::default();
        let balls = [-0.3, 0.3].map(|x| Primitive::point(Vec3::new(x, 0.0, 0.0), 0.5));
        let balls = balls.map(|ball| builder.add(ball).expect("a sound ball"));
        let contact = Contact::default().with_bulge(bulge);
        let root = builder.combine(Operator::Pressed(contact), balls).expect("two balls");
        let pressed = builder.finish(root).expect("a solid");
        let middle = Vec3::new(0.0, y, z);
        prop_assert!(pressed.value(middle).abs() < 1e-5);
        let (_, slope) = pressed.gradient(middle);
        prop_assert!(slope.x < -0.5 && slope.y.abs() + slope.z.abs() < 1e-3, "{slope}");
        prop_assert!(pressed.value(middle - Vec3::X * 0.02) > 0.0 && pressed.value(middle + Vec3::X * 0.02) < 0.0);
    }
}

/// A pressed solid bulges beyond itself where it meets the other, not far from it, and no farther
/// than the other is felt.
#[test]
fn pressed_solids_bulge_around_what_presses() {
    let alone = {
        let mut builder = BlobTreeBuilder::default();
        let stem = builder.add(Primitive::line(Vec3::NEG_Y, Vec3::Y, 0.3)).expect("a line");
        builder.finish(stem).expect("a solid")
    };
    let contact = under(Operator::contact());
    let bulging = under(Operator::Contact(Contact::default().with_bulge(3.0)));
    // On the stem, above the twig.
    let near = Vec3::new(0.3, 0.52, 0.0);
    assert!(contact.value(near) > alone.value(near) + 0.005 && bulging.value(near) > contact.value(near));
    let far = Vec3::new(-0.3, -0.5, 0.0);
    assert_eq!(contact.value(far).to_bits(), alone.value(far).to_bits());
}

#[test]
fn the_operators_are_what_they_are_called() {
    let point = Vec3::new(0.32, 0.25, 0.1);
    let [first, second] = [Vec3::NEG_Y, Vec3::ZERO].map(|from| {
        let mut builder = BlobTreeBuilder::default();
        let line = if from == Vec3::ZERO {
            Primitive::cone([from, Vec3::new(1.0, 0.8, 0.2)], [0.25, 0.15])
        } else {
            Primitive::line(from, Vec3::Y, 0.3)
        };
        let root = builder.add(line).expect("a line");
        builder.finish(root).expect("a solid").value(point) + 0.5
    });
    assert!(first > 0.05 && second > 0.05 && first < 0.95);
    let is = |operator, expected: f32| {
        let value = under(operator).value(point) + 0.5;
        assert!((value - expected).abs() < 1e-6, "{operator:?}: {value}, not {expected}");
    };
    is(Operator::Sum, first + second);
    is(Operator::Union, first.max(second));
    is(Operator::Intersection, first.min(second));
    is(Operator::Difference, first.min(1.0 - second));
    is(Operator::SuperElliptic(2.0), first.hypot(second));
    is(Operator::SuperElliptic(3.0), (first.powi(3) + second.powi(3)).cbrt());
    is(Operator::SuperElliptic(1.0), first + second);
}

#[test]
fn warps_move_turn_and_stretch() {
    let mut builder = BlobTreeBuilder::default();
    let ball = builder.add(Primitive::point(Vec3::ZERO, 0.5)).expect("a ball");
    let egg = builder.warp(ball, Affine3A::from_scale(Vec3::new(1.0, 2.0, 1.0))).expect("a stretch");
    let map = Affine3A::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let lying =
        builder.warp(egg, Affine3A::from_translation(Vec3::new(0.0, 3.0, 0.0)) * map).expect("a turn");
    let egg = builder.finish(lying).expect("a solid");
    for (point, expected) in [
        (Vec3::new(1.0, 3.0, 0.0), 0.0),
        (Vec3::new(-1.0, 3.0, 0.0), 0.0),
        (Vec3::new(0.0, 3.5, 0.0), 0.0),
        (Vec3::new(0.0, 3.0, 0.5), 0.0),
        (Vec3::new(0.0, 3.0, 0.0), 0.5),
        (Vec3::ZERO, -0.5),
    ] {
        assert!((egg.value(point) - expected).abs() < 1e-5, "{point}");
    }
    assert!(egg.bounds().contains(Vec3::new(1.2, 3.0, 0.0)) && !egg.bounds().contains(Vec3::ZERO));
}

const MANY: usize = 100_000;

/// Chains as deep as they are long, on either side.
#[test]
fn depth_does_not_overflow() {
    let style = Bounded::default();
    for operator in [None, Some(Operator::Sum), Some(Operator::Difference), Some(Operator::contact())] {
        for first in [true, false] {
            let mut builder = BlobTreeBuilder::default();
            let ball = |i: usize| Primitive::point(Vec3::X * i as f32, 0.6);
            let mut all = builder.add(ball(0)).expect("a ball");
            for i in 1..=MANY {
                let next = builder.add(ball(i)).expect("a ball");
                let parts = if first { [all, next] } else { [next, all] };
                let made = if let Some(operator) = operator {
                    builder.combine(operator, parts)
                } else {
                    let field = builder.add(ball(i).bounding(0.5)).expect("a field");
                    builder.bounded(parts, style, field)
                };
                all = made.expect("two parts");
            }
            let tree = builder.finish(all).expect("a solid");
            assert!(tree.operators() >= MANY);
            let at = if first { Vec3::ZERO } else { Vec3::X * MANY as f32 };
            assert!(tree.value(at) > 0.3, "{operator:?}, {first}");
            let part = tree.part(Bounds::around(at, Vec3::splat(0.1)));
            assert_eq!(part.value(at).to_bits(), tree.value(at).to_bits());
            assert!(part.len() < 10, "{} steps for {operator:?}, {first}", part.len());
        }
    }
}

#[test]
fn warps_of_warps_do_not_overflow() {
    let mut builder = BlobTreeBuilder::default();
    let mut all = builder.add(Primitive::point(Vec3::ZERO, 0.5)).expect("a ball");
    for _ in 0..MANY {
        all = builder.warp(all, Affine3A::from_translation(Vec3::X / 128.0)).expect("a move");
    }
    let tree = builder.finish(all).expect("a solid");
    assert!(tree.value(Vec3::X * (MANY as f32 / 128.0)) > 0.49);
}

/// Of many parts side by side few are looked at.
#[test]
fn width_costs_little() {
    for operator in [Operator::Sum, Operator::Union, Operator::SuperElliptic(3.0)] {
        let mut builder = BlobTreeBuilder::default();
        let side = 316;
        // In an order that says nothing about where they are.
        let balls: Vec<_> = (0..side * side)
            .map(|i| {
                let i = i * 7919 % (side * side);
                let at = Vec3::new((i % side) as f32, 0.0, (i / side) as f32);
                builder.add(Primitive::point(at, 0.5)).expect("a ball")
            })
            .collect();
        let root = builder.combine(operator, balls).expect("many parts");
        let tree = builder.finish(root).expect("a solid");
        let at = Vec3::new(100.4, 0.1, 50.3);
        let part = tree.part(Bounds::around(at, Vec3::splat(0.05)));
        assert!(part.len() <= 8, "{} steps", part.len());
        assert_eq!(part.value(at).to_bits(), tree.value(at).to_bits());
        let whole = tree.part(tree.bounds());
        assert!((whole.value(at) - tree.value(at)).abs() == 0.0 && whole.len() > side * side);
    }
}

/// Colours follow the fields: the parts' own where they are alone, mixed where they blend, the blend's where they meet.
#[test]
fn colors_follow_the_fields() {
    let mut builder = BlobTreeBuilder::default();
    let (red, blue, green) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let stem = builder.add(Primitive::line(Vec3::NEG_Y, Vec3::Y, 0.3).with_color(red)).expect("a line");
    let twig = Primitive::line(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), 0.3).with_color(blue);
    let twig = builder.add(twig).expect("a line");
    let axil = Vec3::new(0.3, 0.724, 0.0);
    let field = Primitive::point(axil, 0.4).with_field(FieldFunction::Bounding { inner: 0.5 });
    let field = builder.add(field).expect("a field");
    let root = builder.bounded([stem, twig], Bounded::default().with_color(green), field).expect("a blend");
    let tree = builder.finish(root).expect("a solid");
    assert_eq!(tree.color(Vec3::new(-0.3, -0.6, 0.0)), red);
    assert_eq!(tree.color(Vec3::new(1.0, 0.7, 0.0)), blue);
    let [r, g, b] = tree.color(axil);
    assert!(g > 0.95 && r + b < 0.05, "{r} {g} {b}");
    // Below, in the fillet of the sum, half and half.
    let below = Vec3::new(0.35, -0.08, 0.0);
    let [r, g, b] = tree.color(below);
    assert!(g == 0.0 && r > 0.1 && b > 0.1 && (r + b - 1.0).abs() < 1e-5, "{r} {g} {b}");
}
