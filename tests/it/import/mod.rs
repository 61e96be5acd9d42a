//! Models of others: what readers of good repute read is read, and what is wrong is named by its place.

#![allow(
    clippy::format_collect,
    clippy::format_push_string,
    reason = "texts of tests, put together line by line"
)]

mod gltf;
#[cfg(all(feature = "json", feature = "lidar", feature = "preview", feature = "testing"))]
mod mutated;
mod obj;
mod options;
mod ply;
mod stl;
mod topology;

use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::shape::{TriangleMesh, TriangleMeshError};

pub(crate) type Read = Result<TriangleMesh, TriangleMeshError>;

/// The corners of a cube of 2 m, and its faces looking outward, counted from 0.
pub(crate) const CORNERS: [[u8; 3]; 8] =
    [[0, 0, 0], [0, 0, 2], [0, 2, 0], [0, 2, 2], [2, 0, 0], [2, 0, 2], [2, 2, 0], [2, 2, 2]];
pub(crate) const FACES: [[usize; 4]; 6] =
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];

/// The cube's triangles.
pub(crate) fn triangles() -> impl Iterator<Item = [[u8; 3]; 3]> {
    FACES.iter().flat_map(|face| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|corner| CORNERS[face[corner]])))
}

/// Volume and area, a flawless surface, and samples on it.
pub(crate) fn is(read: Read, volume: f32, area: f32, what: &str) -> TriangleMesh {
    let mesh = read.unwrap_or_else(|error| panic!("{what}: {error}"));
    assert!(mesh.flaws().is_none(), "{what}: {}", mesh.flaws());
    has(&mesh, volume, area, what);
    mesh
}

/// Volume and area, and samples on the border of what is inside.
pub(crate) fn has(mesh: &TriangleMesh, volume: f32, area: f32, what: &str) {
    let found = (mesh.volume(), mesh.surface_area().expect("known"));
    assert!(
        (found.0 / volume - 1.0).abs() < 1e-3 && (found.1 / area - 1.0).abs() < 1e-3,
        "{what}: {found:?}"
    );
    let mut random = treesynth::random::stream(1, 0, treesynth::random::Purpose::CUSTOM, 0);
    let near = mesh.bounds().size().max_element() * 1e-3;
    for _ in 0..500 {
        let point = mesh.sample_surface(&mut random).expect("a surface");
        let around = (0..27).map(|k| Vec3::new((k % 3) as f32, (k / 3 % 3) as f32, (k / 9) as f32) - 1.0);
        let inside = around.filter(|step| mesh.contains(point + *step * near)).count();
        assert!((1..27).contains(&inside), "{what}: {point} is off the surface");
    }
}

pub(crate) fn is_cube(read: Read, what: &str) {
    let mesh = is(read, 8.0, 24.0, what);
    assert_eq!((mesh.bounds().min, mesh.bounds().max), (Vec3::ZERO, Vec3::splat(2.0)), "{what}");
}

/// An error that has all these words.
pub(crate) fn refused(read: Read, words: &[&str], what: &str) {
    let error = read.map(|mesh| mesh.volume()).expect_err(what).to_string();
    for word in words {
        assert!(error.contains(word), "{what}: {error:?} lacks {word:?}");
    }
    assert!(error.len() < 500, "{what}: {error}");
}
