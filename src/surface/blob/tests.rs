//! Random trees of every operator, against finite differences and against themselves without a hierarchy.

use super::*;
use crate::surface::implicit::solid::{Coverage, Part, Solid};
use crate::surface::implicit::span::Passage;
use glam::{Affine3A, Quat};
use proptest::prelude::*;

/// Next action with the nodes there are.
#[derive(Debug, Clone)]
enum Act {
    Add(Primitive),
    Curve([Vec3; 3], f32),
    Combine(Operator, usize),
    Bounded(Bounded, Primitive, usize),
    Warp(Vec3, Vec3),
    /// For the parent branch and the lateral, `true` if it is a limb already; then `true` if there is a
    /// bounding field.
    Fork([bool; 3], Contact, Primitive),
}

fn places() -> impl Strategy<Value = Vec3> {
    [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from)
}

fn fields() -> impl Strategy<Value = FieldFunction> {
    prop_oneof![
        (0.2f32..1.0).prop_map(|width| FieldFunction::Smooth { width }),
        Just(FieldFunction::Wyvill),
        Just(FieldFunction::Bounding { inner: 0.3 }),
    ]
}

fn primitives() -> impl Strategy<Value = Primitive> {
    let colors = [0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0];
    (places(), places(), 0.1f32..0.5, 0.1f32..0.5, fields(), 0..3, colors).prop_map(
        |(a, b, r, s, field, kind, color)| {
            let primitive = match kind {
                0 => Primitive::point(a, r),
                1 => Primitive::line(a, b, r),
                _ => Primitive::cone([a, b], [r, s]),
            };
            primitive.with_field(field).with_color(color)
        },
    )
}

fn operators() -> impl Strategy<Value = Operator> {
    let contact = (0.1f32..0.5, 0.0f32..3.0)
        .prop_map(|(reach, bulge)| Contact::default().with_reach(reach).with_bulge(bulge));
    prop_oneof![
        Just(Operator::Sum),
        (1.0f32..8.0).prop_map(Operator::SuperElliptic),
        Just(Operator::SuperElliptic(2.0)),
        Just(Operator::Union),
        Just(Operator::Intersection),
        Just(Operator::Difference),
        contact.clone().prop_map(Operator::Contact),
        contact.prop_map(Operator::Pressed),
    ]
}

fn boundings() -> impl Strategy<Value = Primitive> {
    let bounding = (places(), 0.3f32..1.0, 0.0f32..1.0, 0.0f32..0.8);
    bounding.prop_map(|(at, radius, strength, inner)| {
        Primitive::point(at, radius).with_field(FieldFunction::Bounding { inner }).with_strength(strength)
    })
}

fn acts() -> impl Strategy<Value = Act> {
    let bounding = boundings();
    let contact = (0.1f32..0.5, 0.0f32..3.0)
        .prop_map(|(reach, bulge)| Contact::default().with_reach(reach).with_bulge(bulge));
    let style = (operators(), operators()).prop_map(|(inside, outside)| Bounded::new(inside, outside));
    prop_oneof![
        6 => primitives().prop_map(Act::Add),
        1 => ([places(), places(), places()], 0.1f32..0.3).prop_map(|(points, radius)| Act::Curve(points, radius)),
        3 => (operators(), 1usize..8).prop_map(|(operator, parts)| Act::Combine(operator, parts)),
        2 => (style, bounding, 1usize..5).prop_map(|(style, at, parts)| Act::Bounded(style, at, parts)),
        1 => (places(), places()).prop_map(|(turn, scale)| Act::Warp(turn, scale)),
        3 => (any::<[bool; 3]>(), contact, boundings()).prop_map(|(what, contact, at)| Act::Fork(what, contact, at)),
    ]
}

/// Result of the acts, and whether anything is left.
fn build(acts: &[Act]) -> Option<BlobTree> {
    let mut builder = BlobTreeBuilder::default();
    let mut nodes: Vec<Node> = Vec::new();
    let mut limbs: Vec<Node> = Vec::new();
    for act in acts {
        let node = match act {
            Act::Add(primitive) => builder.add(*primitive).unwrap(),
            Act::Curve(points, radius) => {
                builder.curve(&Curve::new(points.to_vec(), vec![*radius; 3]).with_turn(0.5)).unwrap()
            }
            Act::Combine(operator, parts) => {
                let start = nodes.len().saturating_sub((*parts).max(operator.least_parts()));
                let parts = nodes.split_off(start);
                if parts.len() < operator.least_parts() {
                    nodes.extend(parts);
                    continue;
                }
                builder.combine(*operator, parts).unwrap()
            }
            Act::Bounded(style, at, parts) => {
                let least = style.needy().least_parts();
                let parts = nodes.split_off(nodes.len().saturating_sub((*parts).max(least)));
                if parts.len() < least {
                    nodes.extend(parts);
                    continue;
                }
                let at = builder.add(*at).unwrap();
                builder.bounded(parts, *style, at).unwrap()
            }
            Act::Fork([bearing, borne, is_bounded], contact, at) => {
                let mut take = |limb: bool| if limb { limbs.pop() } else { nodes.pop() };
                let pair = match (take(*bearing), take(*borne)) {
                    (Some(parent), Some(lateral)) => [parent, lateral],
                    (one, other) => {
                        for (part, limb) in [(other, *borne), (one, *bearing)] {
                            if limb { limbs.extend(part) } else { nodes.extend(part) }
                        }
                        continue;
                    }
                };
                let style = Bounded::new(Operator::Contact(*contact), Operator::Sum).with_color([0.5; 3]);
                let field = is_bounded.then(|| builder.add(*at).unwrap());
                limbs.push(builder.fork(pair, style, field).unwrap());
                continue;
            }
            Act::Warp(turn, scale) => {
                let Some(part) = nodes.pop() else { continue };
                let turn = Quat::from_scaled_axis(*turn);
                let map =
                    Affine3A::from_scale_rotation_translation(Vec3::ONE + *scale * 0.5, turn, *scale * 0.3);
                builder.warp(part, map).unwrap()
            }
        };
        nodes.push(node);
    }
    let mut root = if nodes.is_empty() { limbs.pop()? } else { builder.sum(nodes).ok()? };
    for limb in limbs {
        let style = Bounded::new(Operator::Sum, Operator::Sum);
        root = builder.fork([root, limb], style, None).unwrap();
    }
    builder.finish(root).ok()
}

fn trees() -> impl Strategy<Value = BlobTree> {
    prop::collection::vec(acts(), 1..24).prop_filter_map("nothing there", |acts| build(&acts))
}

/// The value and gradient without any hierarchy.
fn plain(tree: &BlobTree, point: Vec3) -> (f32, Vec3) {
    tree.scene.gradient(tree.scene.kinds.iter().copied(), point)
}

fn bits((value, gradient): (f32, Vec3)) -> [u32; 4] {
    [value.to_bits(), gradient.x.to_bits(), gradient.y.to_bits(), gradient.z.to_bits()]
}

/// Bound on the rounding error of a value.
fn rounding(slope: f32) -> f32 {
    1e-5 + 1e-5 * slope
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn gradients_are_those_of_finite_differences(
        tree in trees(),
        points in prop::collection::vec(places(), 24),
    ) {
        let step = 4e-4;
        for point in points {
            let (value, gradient) = tree.gradient(point);
            prop_assert_eq!(value.to_bits(), tree.value(point).to_bits());
            for axis in 0..3 {
                let mut by = Vec3::ZERO;
                by[axis] = step;
                let values = [-2.0f32, -1.0, 1.0, 2.0].map(|n| tree.value(point + by * n));
                // Slopes that differ on both sides mean a crease.
                let slopes = [values[1] - values[0], value - values[1], values[2] - value, values[3] - values[2]];
                let slopes = slopes.map(|rise| rise / step);
                let [least, most] = [f32::min, f32::max].map(|f| slopes.into_iter().reduce(f).unwrap());
                let central = 0.5 * (values[2] - values[1]) / step;
                let slack = 2e-3 + 1.5 * (most - least);
                prop_assert!(
                    (central - gradient[axis]).abs() <= slack,
                    "{central} differs from {} at {point}, {slopes:?}", gradient[axis]
                );
            }
        }
    }

    #[test]
    fn parts_are_the_whole_to_the_bit_and_their_bounds_hold(
        tree in trees(),
        cubes in prop::collection::vec((places(), 0.02f32..0.8), 6),
        inner in prop::collection::vec([0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0], 12),
    ) {
        for (corner, side) in cubes {
            let whole = Bounds::new(corner, corner + side);
            let half = Bounds::new(corner, corner + side * 0.5);
            let mut coverages = vec![(whole, tree.prune(None, whole))];
            coverages.push((half, tree.prune(Some(&coverages[0].1.0), half)));
            for (cube, (part, range)) in coverages {
                let coverage = tree.part(cube);
                let points: Vec<Vec3> = inner.iter().map(|&at| cube.at(Vec3::from(at))).collect();
                let mut last: Option<(Vec3, f32)> = None;
                for point in points {
                    let expected = plain(&tree, point);
                    prop_assert_eq!(bits(part.gradient(point)), bits(expected), "{:?} of {:?}", part, tree);
                    prop_assert_eq!(part.value(point).to_bits(), expected.0.to_bits());
                    prop_assert_eq!(bits(tree.gradient(point)), bits(expected));
                    prop_assert_eq!(bits(coverage.gradient(point)), bits(expected));
                    let colors = [part.color(point), tree.color(point)];
                    let expected_color = tree.scene.color(tree.scene.kinds.iter().copied(), point);
                    // Points that feel next to nothing have no surface to colour.
                    for color in colors.into_iter().filter(|_| expected.0 > -0.45) {
                        for (a, b) in color.iter().zip(&expected_color) {
                            prop_assert!((a - b).abs() < 1e-4 && (-1e-4..=1.0001).contains(a), "{a} is not {b} at {point} of {expected:?}");
                        }
                    }
                    let value = expected.0 + 0.5;
                    prop_assert!(value >= range.least && value <= range.most, "{value} is not in {range:?}");
                    prop_assert!(expected.1.length() <= Part::lipschitz(&part) * 1.001 + 1e-4);
                    if let Some((before, other)) = last {
                        let most = Part::lipschitz(&part) * before.distance(point);
                        prop_assert!((value - other).abs() <= most + rounding(Part::lipschitz(&part)));
                        let way = point - before;
                        let passage = Passage { origin: before, way, length: 1.0 };
                        let span = part.span(&passage);
                        for t in (0..=20).map(|i| i as f32 / 20.0) {
                            let is_within = span.is_some_and(|(low, high)| low <= t && t <= high);
                            prop_assert!(is_within || part.value(before + way * t) < 0.0, "{t} of {span:?}");
                        }
                    }
                    last = Some((point, value));
                }
            }
            match Solid::part(&tree, None, whole) {
                Coverage::Outside => prop_assert!(inner.iter().all(|&at| tree.value(whole.at(Vec3::from(at))) < 0.0)),
                Coverage::Inside => prop_assert!(inner.iter().all(|&at| tree.value(whole.at(Vec3::from(at))) > 0.0)),
                Coverage::Crossed(part) => prop_assert!(part.detail() > 0.0),
            }
        }
    }

    #[test]
    fn nothing_is_felt_outside_of_the_bounds(tree in trees(), point in places()) {
        let far = point * 4.0;
        if !tree.bounds().contains(far) {
            prop_assert_eq!(bits(plain(&tree, far)), bits((-0.5, Vec3::ZERO)));
        }
    }
}
