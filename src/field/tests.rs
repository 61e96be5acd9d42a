//! The contract of every field, checked over one list of fields.

use glam::Vec3;
use proptest::prelude::*;

use super::*;

/// One of each, from a center, an axis and a number.
fn fields(center: Vec3, axis: Vec3, number: f32) -> Vec<(&'static str, Box<dyn VectorField>)> {
    vec![
        ("Uniform", Box::new(Uniform::new(axis))),
        ("Source", Box::new(Source::new(center, number))),
        ("Sink", Box::new(Sink::new(center, number).with_core(number))),
        ("Vortex", Box::new(Vortex::new(center, axis, number))),
        ("Vortex with a core", Box::new(Vortex::new(center, axis, -number).with_core(number))),
        ("Helix", Box::new(Helix::new(center, number))),
        ("Helix with an angle", Box::new(Helix::with_angle(center, number))),
        ("Rotation", Box::new(Rotation::new(center, axis))),
        ("SphericalMeridians", Box::new(SphericalMeridians::new(center))),
        ("Scale", Box::new(Scale::new(Uniform::new(axis), number))),
        ("Sum", Box::new(Sum::new().with(Uniform::new(axis)).with(Scale::new(Uniform::new(axis), number)))),
        ("FieldFn", Box::new(FieldFn::new(move |point| (point - center) * number))),
    ]
}

fn points() -> impl Strategy<Value = Vec3> {
    (-50.0_f32..50.0, -50.0_f32..50.0, -50.0_f32..50.0).prop_map(Vec3::from)
}

/// Any floats at all.
fn wild() -> impl Strategy<Value = f32> {
    let edges =
        vec![0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e-45, 1e6, 1e-3];
    prop_oneof![any::<f32>(), prop::sample::select(edges)]
}

fn wild_vector() -> impl Strategy<Value = Vec3> {
    (wild(), wild(), wild()).prop_map(Vec3::from)
}

proptest! {
    #[test]
    fn always_finite(center in wild_vector(), axis in wild_vector(), number in wild(), point in wild_vector()) {
        for (name, field) in fields(center, axis, number) {
            for point in [point, center, -point, Vec3::ZERO] {
                let vector = field.at(point);
                prop_assert!(vector.is_finite(), "{name} at {point} is {vector}");
            }
            let _ = field.check();
        }
    }

    #[test]
    fn meridians_climb_along_the_sphere(center in points(), point in points()) {
        let outwards = point - center;
        prop_assume!(outwards.with_y(0.0).length() > 1e-3);
        let vector = SphericalMeridians::new(center).at(point);
        prop_assert!((vector.length() - 1.0).abs() < 1e-5);
        prop_assert!(vector.dot(outwards.normalize()).abs() < 1e-4, "tangent to the sphere");
        prop_assert!(vector.y > 0.0, "upwards");
        prop_assert!(vector.dot(outwards.cross(Vec3::Y).normalize()).abs() < 1e-4, "in the vertical plane");
    }

    #[test]
    fn helices_climb_along_the_cylinder(center in points(), point in points(), pitch in 0.01_f32..20.0) {
        let outwards = (point - center).with_y(0.0);
        prop_assume!(outwards.length() > 1e-2);
        for sign in [1.0, -1.0] {
            for helix in [
                Helix::new(center, sign * pitch),
                Helix::with_angle(center, sign * pitch / 20.0),
            ] {
                prop_assert!(helix.check().is_ok());
                let vector = helix.at(point);
                prop_assert!((vector.length() - 1.0).abs() < 1e-5);
                prop_assert!(vector.dot(outwards.normalize()).abs() < 1e-4, "tangent to the cylinder");
                prop_assert!(vector.y > 0.0, "upwards");
                prop_assert!(Vec3::Y.cross(outwards).dot(vector) * sign > 0.0, "handed");
            }
        }
        let slope = Helix::new(center, pitch).at(point);
        let expected = pitch / (std::f32::consts::TAU * outwards.length());
        prop_assert!((slope.y / slope.with_y(0.0).length() / expected - 1.0).abs() < 1e-3);
    }

    #[test]
    fn rotations_are_tangent(center in points(), point in points(), axis in points()) {
        let unit = axis.normalize_or_zero();
        let outwards = (point - center).reject_from_normalized(unit);
        prop_assume!(axis.length() > 1e-2 && outwards.length() > 1e-1);
        for field in [
            Box::new(Rotation::new(center, axis)) as Box<dyn VectorField>,
            Box::new(Vortex::new(center, axis, 2.0)),
        ] {
            let vector = field.at(point).normalize();
            prop_assert!(vector.dot(unit).abs() < 1e-3 && vector.dot(outwards.normalize()).abs() < 1e-3);
            prop_assert!(unit.cross(outwards).dot(vector) > 0.0);
        }
    }

    #[test]
    fn sums_add_up(center in points(), point in points()) {
        let (source, helix) = (Source::new(center, 9.0), Helix::new(center, 2.0));
        let sum = Sum::new().with(source).with(Scale::new(helix, -3.0));
        prop_assert_eq!(sum.at(point), source.at(point) - helix.at(point) * 3.0);
    }
}

#[test]
fn checks_name_the_parameter() {
    let (at, up) = (Vec3::ONE, Vec3::Y);
    let expect = |field: &dyn VectorField, parameter: &str| {
        assert_eq!(field.check().expect_err(parameter).parameter, parameter);
    };
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.1e6, 1.1e6] {
        let bad_point = Vec3::new(0.0, bad, 0.0);
        expect(&Uniform::new(bad_point), "Uniform.direction");
        expect(&Source::new(bad_point, 1.0), "Source.center");
        expect(&Sink::new(bad_point, 1.0), "Sink.center");
        expect(&Vortex::new(bad_point, up, 1.0), "Vortex.center");
        expect(&Vortex::new(at, bad_point, 1.0), "Vortex.axis");
        expect(&Vortex::new(at, up, bad), "Vortex.strength");
        expect(&Helix::new(bad_point, 1.0), "Helix.center");
        expect(&Helix::new(at, bad), "Helix.pitch");
        expect(&Helix::with_angle(at, bad), "Helix.angle");
        expect(&Rotation::new(bad_point, up), "Rotation.center");
        expect(&Rotation::new(at, bad_point), "Rotation.axis");
        expect(&SphericalMeridians::new(bad_point), "SphericalMeridians.center");
        expect(&Scale::new(Uniform::new(up), bad), "Scale.factor");
    }
    for bad in [f32::NAN, f32::INFINITY, 0.0, -1.0, 1.1e6] {
        expect(&Source::new(at, bad), "Source.strength");
        expect(&Sink::new(at, bad), "Sink.strength");
        expect(&Source::new(at, 1.0).with_core(bad), "Source.core");
        expect(&Sink::new(at, 1.0).with_core(bad), "Sink.core");
        expect(&Vortex::new(at, up, 1.0).with_core(bad), "Vortex.core");
    }
    expect(&Uniform::new(Vec3::ZERO), "Uniform.direction");
    expect(&Vortex::new(at, Vec3::ZERO, 1.0), "Vortex.axis");
    expect(&Vortex::new(at, up, 0.0), "Vortex.strength");
    expect(&Rotation::new(at, Vec3::ZERO), "Rotation.axis");
    expect(&Helix::new(at, 0.0), "Helix.pitch");
    expect(&Helix::with_angle(at, 1.6), "Helix.angle");
    expect(&Scale::new(Uniform::new(up), 0.0), "Scale.factor");
    let bad = Helix::new(at, 0.0);
    expect(&Sum::new().with(Uniform::new(up)).with(bad), "Helix.pitch");
    expect(&Scale::new(&bad, 2.0), "Helix.pitch");
    expect(&Arc::new(Box::new(bad) as Box<dyn VectorField>), "Helix.pitch");
}

#[test]
fn good_parameters_pass() {
    for (name, field) in fields(Vec3::ONE, Vec3::new(0.0, 2.0, 1.0), 1.0) {
        assert_eq!(field.check(), Ok(()), "{name}");
        assert_ne!(field.at(Vec3::new(3.0, 2.0, 0.0)), Vec3::ZERO, "{name}");
    }
    assert_eq!(Sum::new().check(), Ok(()));
    assert_eq!(Sum::new().at(Vec3::ONE), Vec3::ZERO);
    assert_eq!(Sum::from(vec![Box::new(Uniform::new(Vec3::X)) as Box<dyn VectorField>]).len(), 1);
}
