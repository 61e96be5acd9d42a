//! Meshes against the solids they stand for.

use super::*;
use crate::random::{Purpose, stream};
use crate::shape::{Cuboid, Sphere};
use proptest::prelude::*;
use std::f32::consts::PI;

type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// A box, each face of its own four vertices, as many formats have it.
fn cube(center: Vec3, half: f32) -> Triangles {
    let mut mesh = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3] * sign);
            let first = mesh.0.len() as u32;
            let at = |x: f32, y: f32| center + (Vec3::AXES[axis] * sign + u * x + v * y) * half;
            mesh.0.extend([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]);
            mesh.1.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh
}

fn joined(mut a: Triangles, b: &Triangles) -> Triangles {
    let first = a.0.len() as u32;
    a.0.extend(&b.0);
    a.1.extend(b.1.iter().map(|corners| corners.map(|corner| first + corner)));
    a
}

fn turned(mut mesh: Triangles) -> Triangles {
    mesh.1.iter_mut().for_each(|corners| corners.swap(0, 1));
    mesh
}

/// A ball of rings.
fn ball(rings: u32, sectors: u32) -> Triangles {
    let at = |ring: u32, sector: u32| {
        let (down, across) = crate::math::sin_cos(PI * ring as f32 / rings as f32);
        let (sin, cos) = crate::math::sin_cos(2.0 * PI * (sector % sectors) as f32 / sectors as f32);
        let down = if ring == rings { 0.0 } else { down };
        Vec3::new(down * cos, across, down * sin)
    };
    let mut mesh = (Vec::new(), Vec::new());
    for ring in 0..rings {
        for sector in 0..sectors {
            let first = mesh.0.len() as u32;
            mesh.0.extend([
                at(ring, sector),
                at(ring, sector + 1),
                at(ring + 1, sector + 1),
                at(ring + 1, sector),
            ]);
            mesh.1.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh
}

fn solid(mesh: &Triangles) -> TriangleMesh {
    TriangleMesh::new(&mesh.0, &mesh.1).expect("a solid")
}

#[test]
fn a_box_of_triangles_is_a_box() {
    let mesh = solid(&cube(Vec3::new(1.0, 2.0, -1.0), 2.0));
    let exact = Cuboid::centered(Vec3::new(1.0, 2.0, -1.0), Vec3::splat(4.0));
    assert!(mesh.flaws().is_none(), "{}", mesh.flaws());
    assert_eq!(mesh.bounds(), exact.bounds());
    assert!((mesh.volume() - 64.0).abs() < 1e-3);
    assert!((mesh.surface_area().expect("known") - 96.0).abs() < 1e-3);
    let mut random = stream(1, 0, Purpose::CUSTOM, 0);
    let around = Cuboid::from(exact.bounds().grown(1.0));
    for _ in 0..2000 {
        let point = around.sample(&mut random).expect("a box");
        assert_eq!(mesh.contains(point), exact.contains(point), "{point}");
    }
    let mut above = 0;
    for _ in 0..6000 {
        let point = mesh.sample_surface(&mut random).expect("a surface");
        let off = ((point - Vec3::new(1.0, 2.0, -1.0)).abs().max_element() - 2.0).abs();
        assert!(off < 1e-5, "{point}");
        above += u32::from(point.y > 3.999);
    }
    assert!((900..1100).contains(&above), "a sixth of the surface has {above} of 6000 points");
    assert!(!mesh.contains(Vec3::NAN) && !mesh.contains(Vec3::INFINITY));
}

#[test]
fn what_looks_the_wrong_way_is_turned() {
    let good = cube(Vec3::ZERO, 1.0);
    let mut three = good.clone();
    for face in [0, 4, 7] {
        three.1[face].swap(1, 2);
    }
    for (mesh, count) in [(three, 3), (turned(good.clone()), 12)] {
        let mesh = solid(&mesh);
        assert_eq!(mesh.flaws(), Flaws { turned: count, ..Flaws::default() });
        assert!(mesh.contains(Vec3::splat(0.9)) && !mesh.contains(Vec3::splat(1.1)));
    }
    // A cavity looks inward, and stays; a second box beside the first is turned, however it comes.
    let cavity = joined(good.clone(), &turned(cube(Vec3::ZERO, 0.5)));
    for mesh in [cavity.clone(), turned(cavity)] {
        let mesh = solid(&mesh);
        assert!(!mesh.contains(Vec3::ZERO) && mesh.contains(Vec3::X * 0.7));
        assert!((mesh.volume() - 7.0).abs() < 1e-3, "{}", mesh.volume());
    }
    let beside = solid(&joined(good, &turned(cube(Vec3::X * 4.0, 0.5))));
    assert!(beside.contains(Vec3::X * 4.0) && beside.contains(Vec3::ZERO));
    assert_eq!(beside.flaws().turned, 12);
}

#[test]
fn overlaps_count_once() {
    let mesh = solid(&joined(cube(Vec3::ZERO, 1.0), &cube(Vec3::X, 1.0)));
    assert!(mesh.winding_number(Vec3::X * 0.5) > 1.9 && mesh.contains(Vec3::X * 0.5));
    assert!((mesh.volume() / 12.0 - 1.0).abs() < 0.02, "{}", mesh.volume());
}

#[test]
fn small_holes_are_put_up_with_and_large_ones_refused() {
    let mut mesh = ball(24, 48);
    (10..14).rev().for_each(|ring| drop(mesh.1.drain(ring * 96..ring * 96 + 12)));
    let holed = solid(&mesh);
    let flaws = holed.flaws();
    assert!(flaws.open_sides > 8 && flaws.doubt > 0.0 && flaws.doubt < 0.1, "{flaws}");
    assert!(flaws.without_area > 40, "the poles are slivers: {flaws}");
    let exact = Sphere::new(Vec3::ZERO, 1.0);
    assert!((holed.volume() / exact.volume() - 1.0).abs() < 0.03, "{}", holed.volume());
    assert!(holed.contains(Vec3::ZERO) && !holed.contains(Vec3::Y * 1.5));

    let refused = |mesh: &Triangles| TriangleMesh::new(&mesh.0, &mesh.1).map(|mesh| mesh.flaws());
    let mut cap = ball(24, 48);
    // Half a ball is told from what is around it, a shallow bowl is not.
    cap.1.truncate(12 * 96);
    assert!((0.3..1.0).contains(&solid(&cap).flaws().doubt));
    cap.1.truncate(4 * 96);
    assert!(
        matches!(refused(&cap), Err(TriangleMeshError::InDoubt { open_sides: 48, doubt }) if doubt > 1.0)
    );
    let face = (vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    assert_eq!(refused(&face), Err(TriangleMeshError::Nothing { open_sides: 3 }));
    let flat = (face.0.clone(), vec![[0, 1, 2], [0, 2, 1]]);
    assert_eq!(refused(&flat), Err(TriangleMeshError::Nothing { open_sides: 3 }));
    assert_eq!(refused(&(face.0.clone(), vec![])), Err(TriangleMeshError::Empty));
    assert_eq!(refused(&(face.0.clone(), vec![[0, 1, 1]])), Err(TriangleMeshError::Empty));
    let index = TriangleMeshError::Index { triangle: 0, index: 3, vertices: 3 };
    assert_eq!(refused(&(face.0.clone(), vec![[0, 1, 3]])), Err(index));
    for bad in [Vec3::NAN, Vec3::INFINITY, Vec3::X * 2e6] {
        let mesh = (vec![Vec3::ZERO, Vec3::X, bad], vec![[0, 1, 2]]);
        assert!(matches!(refused(&mesh), Err(TriangleMeshError::Position { vertex: 2, .. })));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// However small or far off, however the triangles are ordered and turned: a ball of triangles is that ball.
    #[test]
    fn order_and_side_do_not_matter(
        scale in 0.001_f32..1000.0,
        off in [-5.0_f32..5.0, -5.0_f32..5.0, -5.0_f32..5.0],
        seed: u64,
    ) {
        use rand::RngExt;
        use rand::seq::SliceRandom;
        let mut random = stream(seed, 0, Purpose::CUSTOM, 0);
        let mut mesh = ball(8, 12);
        let plain = solid(&mesh);
        let off = Vec3::from_array(off);
        mesh.0.iter_mut().for_each(|place| *place = (*place + off) * scale);
        mesh.1.shuffle(&mut random);
        for corners in &mut mesh.1 {
            if random.random_range(0..5) == 0 {
                corners.swap(0, 2);
            }
        }
        let mesh = solid(&mesh);
        prop_assert_eq!(mesh.flaws().open_sides, 0);
        prop_assert!((mesh.volume() / (plain.volume() * scale * scale * scale) - 1.0).abs() < 0.01);
        for _ in 0..100 {
            let point = Vec3::new(random.random(), random.random(), random.random()) * 2.4 - 1.2;
            // The rounding of the vertices.
            if (0.85..1.001).contains(&point.length()) {
                continue;
            }
            prop_assert_eq!(mesh.contains((point + off) * scale), point.length() < 0.9, "{}", point);
        }
    }

    #[test]
    fn nothing_panics_on_any_triangles(
        places in prop::collection::vec([any::<f32>(), any::<f32>(), any::<f32>()], 0..12),
        corners in prop::collection::vec([0_u32..14, 0_u32..14, 0_u32..14], 0..20),
        small: bool,
    ) {
        let scale = |x: f32| if small && x.is_finite() { (x % 3.0).round() } else { x };
        let places: Vec<Vec3> = places.into_iter().map(|place| Vec3::from_array(place.map(scale))).collect();
        if let Ok(mesh) = TriangleMesh::new(&places, &corners) {
            prop_assert!(mesh.volume() > 0.0 && mesh.volume().is_finite());
            prop_assert!(mesh.bounds().is_finite() && mesh.surface_area().is_some_and(|area| area > 0.0));
        }
    }
}

/// The crate reads what it writes.
#[cfg(feature = "import")]
#[test]
fn files_become_solids() -> Result<(), Box<dyn std::error::Error>> {
    use crate::export::{PlyFormat, write_obj, write_ply, write_stl};
    use crate::surface::{Mesh, Part};
    use std::io::Cursor;

    let (places, corners) = cube(Vec3::Y, 1.0);
    let normals = vec![Vec3::Y; places.len()];
    let mesh = Mesh::new(places.clone(), normals, corners.iter().flatten().copied().collect());
    let parts = [Part::new(&mesh)];
    let plain = solid(&(places, corners));
    let mut files = [const { Vec::new() }; 4];
    write_obj(&parts, "none.mtl", &mut files[0])?;
    write_stl(&parts, &mut files[1])?;
    write_ply(&parts, PlyFormat::Ascii, &mut files[2])?;
    write_ply(&parts, PlyFormat::Binary, &mut files[3])?;
    let read = [
        TriangleMesh::read_obj(&files[0][..])?,
        TriangleMesh::read_stl(Cursor::new(&files[1]))?,
        TriangleMesh::read_ply(&files[2][..])?,
        TriangleMesh::read_ply(&files[3][..])?,
    ];
    assert!(read.iter().all(|read| *read == plain));
    // A square as one polygon is two triangles.
    let pyramid =
        "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv .5 1 .5\nf 1 2 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n";
    let read = TriangleMesh::read_obj(pyramid.as_bytes())?;
    assert!((read.volume() - 1.0 / 3.0).abs() < 1e-5 && read.triangles().len() == 6);

    let named =
        |result: Result<TriangleMesh, TriangleMeshError>| matches!(result, Err(TriangleMeshError::File(_)));
    assert!(named(TriangleMesh::read_obj(&b"v 1 2 a\n"[..])));
    assert!(named(TriangleMesh::read_stl(Cursor::new(b"not an STL file"))));
    assert!(named(TriangleMesh::read_ply(&b"not a PLY file"[..])));
    let faceless = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n";
    assert!(named(TriangleMesh::read_ply(faceless.as_bytes())));
    assert!(named(TriangleMesh::read_obj(&b""[..])));
    Ok(())
}
