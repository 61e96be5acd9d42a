use super::*;
use crate::field::FieldFn;
use proptest::prelude::*;

/// Changes evenly along each axis.
fn linear(point: Vec3) -> Vec3 {
    Vec3::new(
        1.0 + 2.0 * point.x - point.y,
        point.y + 0.5 * point.z,
        -3.0 * point.x + 0.25 * point.y + point.z,
    )
}

fn grid() -> GridField {
    GridField::sampled(&FieldFn::new(linear), Vec3::new(-1.0, 0.5, 2.0), Vec3::new(0.5, 0.25, 1.5), [5, 4, 3])
        .expect("in range")
}

#[test]
fn samples_are_met_exactly_and_are_in_order() {
    let field = grid();
    let mut number = 0;
    for z in 0..3 {
        for y in 0..4 {
            for x in 0..5 {
                let place = field.origin() + field.spacing() * Vec3::new(x as f32, y as f32, z as f32);
                assert_eq!(field.at(place), field.samples()[number]);
                assert!(field.at(place).abs_diff_eq(linear(place), 1e-5));
                number += 1;
            }
        }
    }
    assert_eq!(number, field.samples().len());
}

#[test]
fn outside_is_the_nearest_or_zero() {
    let field = grid();
    let (low, high) = (Vec3::new(-1.0, 0.5, 2.0), Vec3::new(1.0, 1.25, 5.0));
    for out in [Vec3::NEG_X * 9.0, Vec3::Y * 30.0, Vec3::new(5.0, -3.0, 50.0)] {
        assert!(field.at(out).abs_diff_eq(linear(out.clamp(low, high)), 1e-4), "{out}");
        assert_eq!(field.clone().with_zero_outside().at(out), Vec3::ZERO);
    }
    for corner in [low, high] {
        assert_ne!(field.clone().with_zero_outside().at(corner), Vec3::ZERO);
    }
    assert_eq!(field.at(Vec3::NAN), Vec3::ZERO);
    assert!(field.at(Vec3::splat(f32::INFINITY)).is_finite());
    let flat = GridField::new(Vec3::ZERO, Vec3::ONE, [2, 2, 1], vec![Vec3::X; 4]).expect("in range");
    assert_eq!(flat.with_zero_outside().at(Vec3::new(0.5, 0.5, 80.0)), Vec3::X, "one layer is for all z");
}

proptest! {
    /// A trilinear field gives back what is linear, and never leaves the range of its samples.
    #[test]
    fn linear_fields_come_back(x in -1.0f32..1.0, y in 0.5f32..1.25, z in 2.0f32..5.0) {
        let point = Vec3::new(x, y, z);
        prop_assert!(grid().at(point).abs_diff_eq(linear(point), 2e-5));
    }

    #[test]
    fn between_the_samples_anywhere(
        samples in proptest::collection::vec(proptest::array::uniform3(-1e18f32..1e18), 12),
        point in proptest::array::uniform3(proptest::num::f32::ANY),
    ) {
        let samples: Vec<Vec3> = samples.into_iter().map(Vec3::from_array).collect();
        let (low, high) = samples.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
        let field = GridField::new(Vec3::ZERO, Vec3::splat(0.3), [2, 3, 2], samples).expect("in range");
        let vector = field.at(Vec3::from_array(point));
        if !Vec3::from_array(point).is_nan() {
            let slack = 1e12;
            prop_assert!(vector.cmpge(low - slack).all() && vector.cmple(high + slack).all());
        }
    }

    /// No file ends in a panic, however it is damaged.
    #[test]
    fn damaged_files_are_refused_or_read(at in 0usize..600, byte: u8, cut in 0usize..600) {
        let mut file = Vec::new();
        grid().write_vtk(&mut file).expect("memory");
        let length = file.len();
        file[at % length] = byte;
        drop(GridField::read_vtk(&file[..cut.max(at).min(length)]));
        drop(GridField::read_vtk(file.as_slice()));
    }
}

#[test]
fn files_come_back() {
    let field = grid();
    let mut file = Vec::new();
    field.write_vtk(&mut file).expect("memory");
    assert_eq!(GridField::read_vtk(file.as_slice()).expect("a file of ours"), field);
    let text = "# vtk DataFile Version 2.0\n\nASCII\r\nDATASET STRUCTURED_POINTS\nSPACING 1 2 0.5\n\nDIMENSIONS 2 1 2\n\
                ORIGIN 0 0 -1\nPOINT_DATA 4\nVECTORS wind double\n1 0 0 2 0\n0 1e0 1\n1\n\n4 5 6.5\nMETADATA\n";
    let field = GridField::read_vtk(text.as_bytes()).expect("as the format has it");
    assert_eq!(
        (field.dimensions(), field.spacing(), field.origin().z),
        ([2, 1, 2], Vec3::new(1.0, 2.0, 0.5), -1.0)
    );
    assert_eq!(field.samples(), [Vec3::X, Vec3::X * 2.0, Vec3::ONE, Vec3::new(4.0, 5.0, 6.5)]);
    let mut wide = text[..text.find("1 0 0 2").expect("the data")].replace("ASCII", "BINARY").into_bytes();
    for number in 0..12 {
        wide.extend(f64::from(number).to_be_bytes());
    }
    let field = GridField::read_vtk(wide.as_slice()).expect("binary, 64 bits");
    assert_eq!(field.samples()[3], Vec3::new(9.0, 10.0, 11.0));
}

#[test]
fn errors_name_the_line_or_the_byte() {
    let head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 2\nORIGIN 0 0 0\nSPACING 1 1 1\n";
    let error = |text: String| GridField::read_vtk(text.as_bytes()).expect_err("not a field").to_string();
    let data = |tail: &str| error(format!("{head}{tail}"));
    for (message, start) in [
        (error(String::new()), "line 1: the file ends, but `# vtk"),
        (error("solid model\n".into()), "line 1: must begin with"),
        (error(head.replace("ASCII", "ascii")), "line 3: must be `ASCII` or `BINARY`, is `ascii`"),
        (error(head.replace("STRUCTURED_POINTS", "POLYDATA")), "line 4: must be `DATASET"),
        (error(head.replace("1 1 2", "1 -1 2")), "line 5: `-1` is no number"),
        (error(head.replace("ORIGIN 0 0 0", "ORIGIN 0 0")), "line 6: must be `DIMENSIONS`"),
        (data(""), "line 8: the file ends, but `POINT_DATA`"),
        (data("POINT_DATA 3\n"), "line 8: must be `POINT_DATA 2`"),
        (data("POINT_DATA 2\nSCALARS p float\n"), "line 9: must be `VECTORS name float`"),
        (data("POINT_DATA 2\nVECTORS v float\n1 2 3\n4 five 6\n"), "line 11: `five` is no number"),
        (data("POINT_DATA 2\nVECTORS v float\n1 2 3\n4 5\n"), "line 12: the file ends after 1 of 2 vectors"),
        (data("POINT_DATA 2\nVECTORS v float\n1 2 3 4 5 6 7\n"), "line 10: there are more than 2 vectors"),
        (data("POINT_DATA 2\nVECTORS v float\n1 2 3 4 5 nan\n"), "line 10: vector 1 is"),
        (error(head.replace("SPACING 1 1 1", "SPACING 1 0 1") + "POINT_DATA 2\n"), "GridField.spacing is"),
        (error(head.replace("ORIGIN 0 0 0\n", "") + "POINT_DATA 2\n"), "line 7: `ORIGIN` must come"),
        (
            error(head.replace("1 1 2", "4000000000 4000000000 4000000000") + "POINT_DATA 2\n"),
            "GridField.dimensions is",
        ),
        (error(head.replace("\nt\n", &format!("\n{}\n", "t".repeat(1 << 17)))), "line 2: longer than"),
    ] {
        assert!(message.starts_with(start), "{message}, not {start}");
    }
    let mut file = Vec::new();
    grid().write_vtk(&mut file).expect("memory");
    let start = file.len() - 60 * 12 - 1;
    let cut = GridField::read_vtk(&file[..start + 30]).expect_err("cut off").to_string();
    assert_eq!(cut, format!("byte {}: the file ends after 2 of 60 vectors", start + 30));
    file[start + 16..start + 20].copy_from_slice(&f32::NAN.to_be_bytes());
    let nan = GridField::read_vtk(file.as_slice()).expect_err("NaN").to_string();
    assert!(nan.starts_with(&format!("byte {}: vector 1 has", start + 16)), "{nan}");
    // A header that promises much costs no memory.
    let promise = head.replace("1 1 2", "16384 16384 1") + "POINT_DATA 268435456\nVECTORS v float\n1 2 3\n";
    assert!(error(promise).starts_with("line 11: the file ends after 1 of"));
}

#[test]
fn what_is_out_of_range_is_named() {
    let new = |origin, spacing, dimensions, samples| {
        GridField::new(origin, spacing, dimensions, samples).expect_err("out of range").to_string()
    };
    let one = vec![Vec3::X];
    assert!(new(Vec3::X * 1e7, Vec3::ONE, [1; 3], one.clone()).starts_with("GridField.origin"));
    assert!(new(Vec3::NAN, Vec3::ONE, [1; 3], one.clone()).starts_with("GridField.origin"));
    assert!(new(Vec3::ZERO, Vec3::ONE - Vec3::Y, [1; 3], one.clone()).starts_with("GridField.spacing"));
    assert!(
        new(Vec3::ZERO, Vec3::ONE, [1, 0, 1], Vec::new()).starts_with("GridField.dimensions is [1, 0, 1]")
    );
    assert!(new(Vec3::ZERO, Vec3::ONE, [usize::MAX, 2, 1], one.clone()).starts_with("GridField.dimensions"));
    assert_eq!(new(Vec3::ZERO, Vec3::ONE, [2, 1, 1], one), "the grid has 2 samples, but 1 are given");
    assert!(new(Vec3::ZERO, Vec3::ONE, [1; 3], vec![Vec3::NAN]).starts_with("sample 0 is"));
    let wrong = crate::field::Uniform::new(Vec3::ZERO);
    let sampled = GridField::sampled(&wrong, Vec3::ZERO, Vec3::ONE, [1; 3]).expect_err("no direction");
    assert!(sampled.to_string().starts_with("Uniform"));
}
