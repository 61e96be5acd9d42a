//! Axes, units and places of models, and models far away, huge, tiny and thin.

use super::{CORNERS, FACES, Read, has, is, refused};
use std::io::Cursor;
use treesynth::Shape;
use treesynth::glam::{DVec3, Vec3};
use treesynth::shape::{Import, MeshFormat, TriangleMesh, UpAxis};

fn cube(place: impl Fn(usize, u8) -> String) -> String {
    let vertices =
        CORNERS.iter().map(|c| format!("v {} {} {}\n", place(0, c[0]), place(1, c[1]), place(2, c[2])));
    let faces =
        FACES.iter().map(|face| format!("f {}\n", face.map(|corner| (corner + 1).to_string()).join(" ")));
    vertices.chain(faces).collect()
}

fn read(import: Import, text: &str) -> Read {
    import.read(MeshFormat::Obj, Cursor::new(text))
}

#[test]
fn surveys_are_moved_near() {
    let utm = cube(|axis, x| (f64::from(x) + [454_000.25, 5_428_000.5, 120.125][axis]).to_string());
    refused(TriangleMesh::read_obj(utm.as_bytes()), &["vertex 0", "5428000.5", "1e6", "with_offset"], "far");
    let near = Import::default().with_offset(DVec3::new(-454_001.25, -5_428_001.5, -121.125));
    let mesh = is(read(near, &utm), 8.0, 24.0, "near");
    assert_eq!(mesh.bounds().center(), Vec3::ZERO);
    // A nut of 2 cm there would become another.
    let nut = cube(|axis, x| (f64::from(x) * 0.01 + [454_000.26, 20_000.0, 120.1][axis]).to_string());
    refused(TriangleMesh::read_obj(nut.as_bytes()), &["0.0200", "with_offset"], "small");
    let near = Import::default().with_offset(DVec3::new(-454_000.0, -20_000.0, -120.0));
    let mesh = read(near, &nut).unwrap();
    assert!((mesh.volume() / 8e-6 - 1.0).abs() < 1e-3 && mesh.flaws().is_none());
    // Within what f32 tells apart it is as it is.
    let ball = cube(|_, x| (f64::from(x) + 9_999.0).to_string());
    assert!((TriangleMesh::read_obj(ball.as_bytes()).unwrap().volume() / 8.0 - 1.0).abs() < 0.01);
}

#[test]
fn models_stand_up_and_are_in_metres() {
    // 1 wide, 2 deep, 3 high, +Z up, in millimetres.
    let text = cube(|axis, x| (u32::from(x / 2) * [1000, 2000, 3000][axis]).to_string());
    let upright = Import::default().with_up(UpAxis::Z).with_unit(0.001);
    let mesh = is(read(upright, &text), 6.0, 22.0, "upright");
    assert!((mesh.bounds().min - Vec3::new(0.0, 0.0, -2.0)).length() < 1e-6, "{:?}", mesh.bounds());
    assert!((mesh.bounds().max - Vec3::new(1.0, 3.0, 0.0)).length() < 1e-6, "{:?}", mesh.bounds());
    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-10, 1e10] {
        refused(read(Import::default().with_unit(unit), &text), &["Import.unit", "1e-9 to 1e9"], "unit");
    }
    for bad in [f64::NAN, f64::INFINITY, 1e13] {
        refused(
            read(Import::default().with_offset(DVec3::X * bad), &text),
            &["Import.offset", "1e12"],
            "offset",
        );
    }
}

#[test]
fn any_size_and_any_shape_is_a_solid() {
    for scale in [1e-8, 1e-6, 1e-4, 1.0, 1e3, 4e5] {
        let text = cube(|_, x| (f64::from(x) * scale).to_string());
        let volume = (8.0 * scale * scale * scale) as f32;
        is(
            TriangleMesh::read_obj(text.as_bytes()),
            volume,
            (24.0 * scale * scale) as f32,
            &format!("{scale}"),
        );
    }
    let text = cube(|_, x| (f64::from(x) * 6e5).to_string());
    refused(TriangleMesh::read_obj(text.as_bytes()), &["1200000", "1e6"], "too large");
    // A wire of 100 m and 1 mm, a plate of 1 km and 2 cm.
    for (sizes, what) in [
        ([100.0, 0.001, 0.001], "wire"),
        ([1000.0, 0.02, 1000.0], "plate"),
        ([0.001, 100.0, 0.002], "ribbon"),
    ] {
        let text = cube(|axis, x| (f64::from(x / 2) * sizes[axis]).to_string());
        let mesh = TriangleMesh::read_obj(text.as_bytes()).unwrap_or_else(|error| panic!("{what}: {error}"));
        let volume = (sizes[0] * sizes[1] * sizes[2]) as f32;
        assert!(
            (mesh.volume() / volume - 1.0).abs() < 1e-3 && mesh.flaws().is_none(),
            "{what}: {}",
            mesh.volume()
        );
        assert!(mesh.contains(mesh.bounds().center()) && !mesh.contains(mesh.bounds().max * 1.01), "{what}");
    }
}

#[test]
fn names_tell_the_kind() {
    let folder = std::env::temp_dir().join(format!("treesynth-import-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = cube(|_, x| x.to_string());
    let path = folder.join("CUBE.OBJ");
    std::fs::write(&path, &text).unwrap();
    has(&TriangleMesh::open(&path).unwrap(), 8.0, 24.0, "capitals");
    let open = |name: &str, text: &str, words: &[&str]| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        refused(TriangleMesh::open(&path), words, name);
    };
    open("cube.step", &text, &["cube.step", ".obj, .stl, .ply"]);
    open("cube", &text, &["cube", ".obj"]);
    open("cube.stl", &text, &["cube.stl", "STL, line 1", "solid"]);
    open("cube.ply", &text, &["cube.ply", "PLY, line 1"]);
    open("cube.glb", &text, &["cube.glb", "glTF"]);
    refused(TriangleMesh::open(folder.join("gone.obj")), &["gone.obj"], "gone");
    let dir = folder.join("dir.obj");
    std::fs::create_dir_all(&dir).unwrap();
    refused(TriangleMesh::open(&dir), &["dir.obj"], "a folder");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn heights_are_checked() {
    let mesh = TriangleMesh::read_obj(cube(|_, x| x.to_string()).as_bytes()).unwrap();
    for height in [0.0, -0.0, -9.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e10, 1e-45] {
        let error = mesh.fitted(0.0, height).map(|mesh| mesh.volume()).expect_err("no height").to_string();
        assert!(error.contains("TriangleMesh.height") && error.contains("1e-6 to 1e6"), "{height}: {error}");
    }
    for base in [f32::NAN, f32::INFINITY, 1e10] {
        let error = mesh.fitted(base, 1.0).map(|mesh| mesh.volume()).expect_err("no base").to_string();
        assert!(error.contains("TriangleMesh.base"), "{base}: {error}");
    }
    let fitted = mesh.fitted(-1.0, 4.0).unwrap();
    assert_eq!(
        (fitted.bounds().min, fitted.bounds().max),
        (Vec3::new(-2.0, -1.0, -2.0), Vec3::new(2.0, 3.0, 2.0))
    );
}
