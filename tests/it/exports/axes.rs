//! Files for programs that have another axis up, or another unit.

use std::io::Cursor;
use treesynth::export::{self, Axes, PlyFormat};
use treesynth::glam::Vec3;
use treesynth::shape::{Import, MeshFormat, UpAxis};
use treesynth::surface::{Part, Tubes};
use treesynth::{Shape, Skeleton};

/// A pole of 9 m, and a little twig that leans to +Z from it.
fn pole() -> treesynth::surface::Mesh {
    let places = vec![Vec3::ZERO, Vec3::Y * 9.0, Vec3::new(0.0, 9.0, 1.0)];
    let skeleton =
        Skeleton::new(places, vec![None, Some(0), Some(1)]).unwrap().with_radii(vec![0.1; 3]).unwrap();
    Tubes::default().with_root_flare(0.0).with_closed_base(true).mesh(&skeleton).unwrap()
}

#[test]
fn poles_stand_where_z_is_up() {
    let mesh = pole();
    let parts = [Part::new(&mesh)];
    let bounds = mesh.bounds().unwrap();
    for (unit, name) in
        [(1.0, "metres"), (0.001, "millimetres"), (0.01, "centimetres"), (0.5, "units of 0.5 metres")]
    {
        for (up, sign) in [(UpAxis::Y, "+Y up"), (UpAxis::Z, "+Z up")] {
            let axes = Axes::default().with_up(up).with_unit(unit);
            let mut files = [const { Vec::new() }; 4];
            export::write_stl_with(&parts, axes, &mut files[0]).unwrap();
            export::write_ply_with(&parts, PlyFormat::Binary, axes, &mut files[1]).unwrap();
            export::write_ply_with(&parts, PlyFormat::Ascii, axes, &mut files[2]).unwrap();
            export::write_obj_with(&parts, "tree.mtl", axes, &mut files[3]).unwrap();
            let formats = [MeshFormat::Stl, MeshFormat::Ply, MeshFormat::Ply, MeshFormat::Obj];
            for (file, format) in files.iter().zip(formats) {
                let head = String::from_utf8_lossy(&file[..file.len().min(150)]);
                assert!(head.contains(&format!("{name}, {sign}")), "{head}");
                let plain = Import::default().read(format, Cursor::new(file)).unwrap().bounds();
                let height = if up == UpAxis::Z { plain.size().z } else { plain.size().y };
                assert!((height * unit / bounds.size().y - 1.0).abs() < 1e-5, "{height}");
                let import = Import::default().with_up(up).with_unit(f64::from(unit));
                let back = import.read(format, Cursor::new(file)).unwrap().bounds();
                assert!(
                    (back.min - bounds.min).abs().max_element() < 1e-4
                        && (back.max - bounds.max).abs().max_element() < 1e-4
                );
            }
        }
    }
    for unit in [0.0, -1.0, f32::NAN, 1e-7, 1e7] {
        let axes = Axes::default().with_unit(unit);
        let mut file = Vec::new();
        let error = export::write_stl_with(&parts, axes, &mut file).expect_err("no unit").to_string();
        assert!(error.starts_with("Axes.unit is ") && file.is_empty(), "{error}");
        assert!(
            export::write_ply_with(&parts, PlyFormat::Binary, axes, &mut file).is_err() && file.is_empty()
        );
    }
}

#[test]
fn origins_may_be_elsewhere() {
    let mesh = pole();
    let parts = [Part::new(&mesh)];
    let axes = Axes::default().with_up(UpAxis::Z).with_unit(0.01).with_origin(Vec3::Y * 9.0);
    let mut stl = Vec::new();
    export::write_stl_with(&parts, axes, &mut stl).unwrap();
    let found = Import::default().read(MeshFormat::Stl, Cursor::new(&stl)).unwrap().bounds();
    let bounds = mesh.bounds().unwrap();
    assert!((found.min.z - (bounds.min.y - 9.0) * 100.0).abs() < 1e-2, "{found:?}");
    assert!((found.max.z - (bounds.max.y - 9.0) * 100.0).abs() < 1e-2, "{found:?}");
    let lost = Axes::default().with_origin(Vec3::NAN);
    let error = export::write_obj_with(&parts, "a", lost, std::io::sink()).unwrap_err().to_string();
    assert!(error.starts_with("Axes.origin is "), "{error}");
}
