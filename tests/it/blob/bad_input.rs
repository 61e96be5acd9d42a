//! Input that is no solid is refused, with the reason.

use treesynth::glam::{Affine3A, Vec3};
use treesynth::surface::blob::{
    BlobError, BlobTreeBuilder, Bounded, Contact, Curve, FieldFunction, Node, Operator, Primitive, Skin,
};
use treesynth::{Bounds, Skeleton};

fn ball(builder: &mut BlobTreeBuilder) -> Node {
    builder.add(Primitive::point(Vec3::ZERO, 1.0)).expect("a sound ball")
}

/// The error names the parameter and says the value.
fn names(error: &BlobError, parameter: &str, value: &str) {
    let text = error.to_string();
    assert!(text.contains(parameter) && text.contains(value), "{text}");
}

#[test]
fn primitives_out_of_range() {
    let at = |x: f32| Primitive::point(Vec3::new(x, 0.0, 0.0), 1.0);
    let unit = at(0.0);
    for (primitive, parameter, value) in [
        (Primitive::point(Vec3::ZERO, 0.0), "Primitive.radius", "0"),
        (Primitive::point(Vec3::ZERO, -1.0), "Primitive.radius", "-1"),
        (Primitive::line(Vec3::ZERO, Vec3::Y, f32::NAN), "Primitive.radius", "NaN"),
        (Primitive::cone([Vec3::ZERO, Vec3::Y], [1.0, f32::INFINITY]), "Primitive.radius", "inf"),
        (at(f32::NAN), "Primitive.ends", "NaN"),
        (at(1e30), "Primitive.ends", "1e30"),
        (unit.with_field(FieldFunction::Smooth { width: 0.0 }), "FieldFunction.width", "0"),
        (unit.with_field(FieldFunction::Bounding { inner: 1.0 }), "FieldFunction.inner", "1"),
        (unit.with_strength(1.5), "Primitive.strength", "1.5"),
        (unit.with_color([0.0, -0.1, 0.0]), "Primitive.color", "-0.1"),
    ] {
        names(&BlobTreeBuilder::default().add(primitive).expect_err(parameter), parameter, value);
    }
}

#[test]
fn operators_on_too_little() {
    let mut builder = BlobTreeBuilder::default();
    for operator in [
        Operator::Sum,
        Operator::Union,
        Operator::Intersection,
        Operator::SuperElliptic(2.0),
        Operator::Difference,
        Operator::contact(),
    ] {
        let error = builder.combine(operator, []).expect_err("nothing to combine");
        assert!(matches!(error, BlobError::TooFewParts { parts: 0, .. }), "{error}");
    }
    for operator in [Operator::contact(), Operator::Difference, Operator::Pressed(Contact::default())] {
        let one = ball(&mut builder);
        let error = builder.combine(operator, [one]).expect_err("one is not two");
        assert!(matches!(error, BlobError::TooFewParts { least: 2, parts: 1, .. }), "{error}");
    }
    let (one, field) = (ball(&mut builder), ball(&mut builder));
    let error = builder.bounded([one], Bounded::default(), field).expect_err("contact needs two");
    assert!(matches!(error, BlobError::TooFewParts { operator: "Contact", .. }), "{error}");
}

#[test]
fn operators_out_of_range() {
    let mut builder = BlobTreeBuilder::default();
    for (operator, parameter) in [
        (Operator::SuperElliptic(0.5), "Operator.SuperElliptic"),
        (Operator::SuperElliptic(f32::NAN), "Operator.SuperElliptic"),
        (Operator::Contact(Contact::default().with_reach(0.6)), "Contact.reach"),
        (Operator::Pressed(Contact::default().with_bulge(-1.0)), "Contact.bulge"),
    ] {
        let parts = [ball(&mut builder), ball(&mut builder)];
        names(&builder.combine(operator, parts).expect_err(parameter), parameter, "");
        let (parts, field) = ([ball(&mut builder), ball(&mut builder)], ball(&mut builder));
        let style = Bounded::new(Operator::Sum, operator);
        names(&builder.bounded(parts, style, field).expect_err(parameter), parameter, "");
    }
    let (parts, field) = ([ball(&mut builder), ball(&mut builder)], ball(&mut builder));
    let style = Bounded::default().with_color([2.0, 0.0, 0.0]);
    names(&builder.bounded(parts, style, field).expect_err("a colour"), "Bounded.color", "2.0");
}

#[test]
fn bounding_fields_beyond_one() {
    let mut builder = BlobTreeBuilder::default();
    let (parts, two) = ([ball(&mut builder), ball(&mut builder)], [ball(&mut builder), ball(&mut builder)]);
    let sum = builder.sum(two).expect("two balls");
    let error = builder.bounded(parts, Bounded::default(), sum).expect_err("a field of up to 2");
    assert_eq!(error, BlobError::BoundingField { most: 2.0 });
    // Their union is no more than either, and a field like any other.
    let mut builder = BlobTreeBuilder::default();
    let (parts, two) = ([ball(&mut builder), ball(&mut builder)], [ball(&mut builder), ball(&mut builder)]);
    let union = builder.union(two).expect("two balls");
    builder.bounded(parts, Bounded::default(), union).expect("a field of up to 1");
}

#[test]
fn nodes_of_others() {
    let mut builder = BlobTreeBuilder::default();
    let strangers: Vec<Node> = (0..3).map(|_| ball(&mut builder)).collect();
    let mut other = BlobTreeBuilder::default();
    let own: Vec<Node> = (0..3).map(|_| ball(&mut other)).collect();
    let error = other.sum(strangers).expect_err("another builder's");
    assert!(matches!(error, BlobError::Stranger { node: 0 }), "{error}");
    other.sum(own).expect("its own");
}

#[test]
fn singular_warps() {
    let maps = [
        Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0)),
        Affine3A::from_scale(Vec3::new(1.0, 1e-7, 1.0)),
        Affine3A::from_translation(Vec3::NAN),
        Affine3A::from_scale(Vec3::INFINITY),
        Affine3A::ZERO,
    ];
    for map in maps {
        let mut builder = BlobTreeBuilder::default();
        let part = ball(&mut builder);
        let error = builder.warp(part, map).expect_err("no inverse");
        assert!(matches!(error, BlobError::Singular { .. }), "{error}");
    }
    // Each is sound, but not both.
    let mut builder = BlobTreeBuilder::default();
    let mut part = ball(&mut builder);
    for _ in 0..2 {
        part = builder.warp(part, Affine3A::from_scale(Vec3::new(1.0, 1e-4, 1.0))).expect("a sound map");
    }
    assert!(matches!(builder.finish(part), Err(BlobError::Singular { .. })));
}

#[test]
fn warps_too_far_out() {
    for map in [Affine3A::from_scale(Vec3::splat(1e12)), Affine3A::from_translation(Vec3::X * 1e30)] {
        let mut builder = BlobTreeBuilder::default();
        let part = ball(&mut builder);
        let far = builder.warp(part, map).expect("a sound map");
        assert!(matches!(builder.finish(far), Err(BlobError::TooFar { .. })));
    }
}

/// Points and boxes that are none are felt by nobody.
#[test]
fn points_that_are_none() {
    let mut builder = BlobTreeBuilder::default();
    let part = ball(&mut builder);
    let tree = builder.finish(part).expect("a solid");
    for odd in [f32::NAN, f32::INFINITY, f32::MIN] {
        assert_eq!(tree.gradient(Vec3::splat(odd)), (-0.5, Vec3::ZERO));
        assert_eq!(tree.color(Vec3::splat(odd)), [0.0; 3]);
        assert!(tree.part(Bounds::around(Vec3::splat(odd), Vec3::ONE)).is_empty());
    }
    assert!(tree.part(Bounds::EMPTY).is_empty());
    let all = tree.part(Bounds::new(Vec3::NEG_INFINITY, Vec3::INFINITY));
    assert_eq!(all.value(Vec3::ZERO).to_bits(), tree.value(Vec3::ZERO).to_bits());
}

#[test]
fn empty_trees() {
    let mut builder = BlobTreeBuilder::default();
    let faint = builder.add(Primitive::point(Vec3::ZERO, 1.0).with_strength(0.25)).expect("a faint ball");
    assert_eq!(builder.finish(faint).expect_err("no surface"), BlobError::Empty { most: 0.25 });
    let mut builder = BlobTreeBuilder::default();
    let apart = [0.0, 10.0].map(|x| builder.add(Primitive::point(Vec3::X * x, 1.0)).expect("a ball"));
    let nothing = builder.intersection(apart).expect("two balls");
    assert!(matches!(builder.finish(nothing), Err(BlobError::Empty { .. })));
}

#[test]
fn curves_out_of_range() {
    let sound = || Curve::new(vec![Vec3::ZERO, Vec3::Y], vec![0.1, 0.1]);
    for (curve, text) in [
        (Curve::new(vec![], vec![]), "0 points"),
        (Curve::new(vec![Vec3::ZERO], vec![]), "0 radii"),
        (Curve::new(vec![Vec3::ZERO, Vec3::NAN], vec![1.0, 1.0]), "Primitive.ends"),
        (Curve::new(vec![Vec3::ZERO, Vec3::Y], vec![1.0, 0.0]), "Primitive.radius"),
        (Curve::new(vec![Vec3::ZERO, Vec3::Y], vec![f32::NAN; 2]), "Primitive.radius"),
        (sound().with_turn(0.0), "Curve.turn"),
        (sound().with_tangents(Some(Vec3::ZERO), None), "Curve.tangents"),
        (sound().with_strength(f32::NAN), "Primitive.strength"),
    ] {
        let error = BlobTreeBuilder::default().curve(&curve).expect_err(text);
        names(&error, text, "");
    }
}

#[test]
fn skins_out_of_range() {
    let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).expect("a pole");
    let error = Skin::default().blob_tree(&pole).expect_err("radii are 0");
    assert_eq!(error, BlobError::Radius { node: 1, radius: 0.0 });
    let thick = pole.with_radii(vec![0.0, 0.1]).expect("two radii");
    assert!(Skin::default().blob_tree(&thick).is_ok());
    for (skin, parameter) in [
        (Skin::default().with_age(-1.0), "Skin.age"),
        (Skin::default().with_age(f32::NAN), "Skin.age"),
        (Skin::default().with_blend(0.0), "Skin.blend"),
        (Skin::default().with_turn(9.0), "Skin.turn"),
        (Skin::default().with_bulge(4.0), "Skin.bulge"),
        (Skin::default().with_scars(1.1), "Skin.scars"),
        (Skin::default().with_ridges(-0.1), "Skin.ridges"),
        (Skin::default().with_scar_years(1.0), "Skin.scar_years"),
        (Skin::default().with_ridge_years(0.0), "Skin.ridge_years"),
        (Skin::default().with_bark([0.0, 0.0, 1.5]), "Skin.bark"),
        (Skin::default().with_mark([f32::INFINITY, 0.0, 0.0]), "Skin.mark"),
    ] {
        names(&skin.blob_tree(&thick).expect_err(parameter), parameter, "");
    }
    let far = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 1e20], vec![None, Some(0)]).expect("a long pole");
    let far = far.with_radii(vec![1.0, 1.0]).expect("two radii");
    names(&Skin::default().blob_tree(&far).expect_err("too far"), "Primitive.ends", "");
}
