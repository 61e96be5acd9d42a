//! Files of others: models, drawings, tables of trees, point clouds.

use super::Target;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};
use treesynth::cloud::{Cloud, CloudError, Frame, PlyEncoding};
use treesynth::export::{GlbOptions, PlyFormat, write_glb, write_obj, write_ply, write_stl};
use treesynth::format::{FormatError, Trees, read_mtg, read_qsm, read_swc, write_mtg, write_qsm, write_swc};
use treesynth::glam::Vec3;
use treesynth::shape::{Import, MeshFormat, Outline};
use treesynth::surface::{Mesh, Part};
use treesynth::{Shape, Skeleton};

pub(super) fn all() -> Vec<Target> {
    let target = |name, seeds, run| Target { name, seeds, run };
    vec![
        target("obj", obj(), |bytes| model(MeshFormat::Obj, bytes)),
        target("stl", stl(), |bytes| model(MeshFormat::Stl, bytes)),
        target("ply", ply(), |bytes| model(MeshFormat::Ply, bytes)),
        target("gltf", gltf(), |bytes| model(MeshFormat::Gltf, bytes)),
        target("path", paths(), |bytes| {
            Outline::from_svg_path(&String::from_utf8_lossy(bytes)).is_ok_and(|outline| is_sound(&outline))
        }),
        target("svg", vec![DRAWING.into()], |bytes| {
            Outline::from_svg(&String::from_utf8_lossy(bytes))
                .is_ok_and(|outlines| outlines.iter().all(is_sound))
        }),
        target("qsm", vec![table(|tree, frame, out| write_qsm(tree, frame, out))], |bytes| {
            trees(read_qsm(&Frame::default(), bytes))
        }),
        target("swc", vec![table(|tree, frame, out| write_swc(tree, frame, out))], |bytes| {
            trees(read_swc(&Frame::default(), bytes))
        }),
        target("mtg", vec![table(|tree, frame, out| write_mtg(tree, frame, out))], |bytes| {
            trees(read_mtg(&Frame::default(), bytes))
        }),
        target("xyz", vec![xyz()], |bytes| points(Cloud::read_xyz(&Frame::default(), bytes))),
        target("cloud", clouds(), |bytes| points(Cloud::read_ply(&Frame::default(), bytes))),
        target("las", vec![las(false), las(true)], |bytes| {
            points(Cloud::read_las(&Frame::default(), Cursor::new(bytes.to_vec())))
        }),
        target("e57", vec![e57()], |bytes| points(Cloud::read_e57(&Frame::default(), Cursor::new(bytes)))),
    ]
}

/// Whether it is a model; what is asked of a shape then has an answer.
fn model(format: MeshFormat, bytes: &[u8]) -> bool {
    let Ok(mesh) = Import::default().read(format, Cursor::new(bytes)) else { return false };
    let (bounds, volume) = (mesh.bounds(), mesh.volume());
    assert!(bounds.min.is_finite() && bounds.max.is_finite() && volume.is_finite(), "{bounds:?}, {volume}");
    let mut random = treesynth::random::stream(1, 0, treesynth::random::Purpose::CUSTOM, 0);
    let sample = mesh.sample_surface(&mut random);
    assert!(sample.is_none_or(Vec3::is_finite), "{sample:?}");
    mesh.contains(bounds.center());
    true
}

/// Whether its check takes it; then it has a place and spans.
fn is_sound(outline: &Outline) -> bool {
    let sound = outline.check().is_ok();
    if sound {
        let middle = 0.5 * (outline.min() + outline.max());
        assert!(middle.is_finite());
        outline.contains(middle);
        for (left, right) in outline.spans(middle.y) {
            assert!(left <= right && left.is_finite() && right.is_finite(), "{left} to {right}");
        }
    }
    sound
}

fn trees(read: Result<Trees, FormatError>) -> bool {
    let Ok(read) = read else { return false };
    read.trees.iter().for_each(|tree| assert_eq!(tree.check(), Ok(())));
    true
}

fn points(read: Result<Cloud, CloudError>) -> bool {
    let Ok(cloud) = read else { return false };
    assert!(cloud.points().iter().all(|point| point.is_finite()));
    true
}

const CORNERS: [[u8; 3]; 8] =
    [[0, 0, 0], [0, 0, 2], [0, 2, 0], [0, 2, 2], [2, 0, 0], [2, 0, 2], [2, 2, 0], [2, 2, 2]];
const FACES: [[u32; 4]; 6] =
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];

/// A cube as this crate writes it.
fn cube(write: impl Fn(&Mesh, &mut Vec<u8>)) -> Vec<u8> {
    let corners = CORNERS.iter().map(|corner| Vec3::from_array(corner.map(f32::from))).collect();
    let indices = FACES.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let mut bytes = Vec::new();
    write(&Mesh::new(corners, vec![Vec3::Y; 8], indices), &mut bytes);
    bytes
}

/// An L-shaped prism whose faces are polygons.
fn prism() -> String {
    let outline = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]];
    let at = |z: u8| outline.map(|[x, y]| format!("v {x} {y} {z}\n")).concat();
    let sides: String =
        (1..=6).map(|i| (i, i % 6 + 1)).map(|(a, b)| format!("f {a} {b} {} {}\n", b + 6, a + 6)).collect();
    format!("{}{}f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n{sides}", at(0), at(2))
}

fn obj() -> Vec<Vec<u8>> {
    let written =
        cube(|mesh, out| write_obj(&[Part::new(mesh)], "a.mtl", out).expect("vectors take everything"));
    let odd = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nf -4/-1/-1 -2//-1 -3\nf 1 2 4\nf 1 4 3\nf 2 3 \\\n4\n";
    vec![written, prism().into_bytes(), odd.into()]
}

fn stl() -> Vec<Vec<u8>> {
    let facet = |corners: [[i32; 3]; 3]| {
        let lines = corners.map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).concat();
        format!("facet normal 0 0 0\nouter loop\n{lines}endloop\nendfacet\n")
    };
    let [o, x, y, z] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let facets = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(facet).concat();
    let written = cube(|mesh, out| write_stl(&[Part::new(mesh)], out).expect("vectors take everything"));
    vec![written, format!("solid a\n{facets}endsolid a\n").into_bytes()]
}

fn ply() -> Vec<Vec<u8>> {
    let written = [PlyFormat::Binary, PlyFormat::Ascii].map(|format| {
        cube(|mesh, out| write_ply(&[Part::new(mesh)], format, out).expect("vectors take everything"))
    });
    written.into()
}

fn gltf() -> Vec<Vec<u8>> {
    let options = [GlbOptions::default(), GlbOptions::default().with_quantization(true)];
    let write = |options: &GlbOptions| {
        cube(|mesh, out| write_glb(mesh, options, out).expect("vectors take everything"))
    };
    let mut seeds: Vec<Vec<u8>> = options.iter().map(write).collect();
    seeds.push(br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[2,1,1],"children":[1]},{"mesh":0,"translation":[0,0,3]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAAMCAQID"}]}"#.to_vec());
    seeds
}

fn paths() -> Vec<Vec<u8>> {
    [
        "M5 9 C-3 3 2 -1 5 2 S8 -1 13 3 Q1 1 5 9 T2 2Z",
        "M 0 1 A 1 1 0 0 1 2 1 A 1 1 0 0 1 0 1 Z M .5 1 a .5 .5 0 0 0 1 0 a .5 .5 0 0 0 -1 0 z",
        "m0 0h4v4h-4zl1 1 1-1zM1 1v2h2v-2z",
        "M0,-5 2.9389,4.0451 -4.7553,-1.5451 4.7553,-1.5451 -2.9389,4.0451z",
    ]
    .map(Vec::from)
    .into()
}

const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 9" width="3cm"><style>.a{fill:red}</style>
<defs><path id="p" d="M0 0h4v4h-4z"/></defs><use xlink:href="#p" transform="rotate(30 1 2)"/><g class="a"><circle r="2"/><rect width="10%" height="3"/>
<path fill-rule="evenodd" d="M0 0h4v4h-4zM1 1h2v2h-2z"/></g></svg>"##;

/// A fork, written by `write`.
fn table<E: std::fmt::Debug>(write: impl Fn(&Skeleton, &Frame, &mut Vec<u8>) -> Result<(), E>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&super::saved::fork(), &Frame::default(), &mut bytes).expect("vectors take everything");
    bytes
}

fn cloud() -> Cloud {
    Cloud::new(super::saved::fork().positions().to_vec()).expect("they are finite")
}

fn xyz() -> Vec<u8> {
    let mut bytes = Vec::new();
    cloud().write_xyz(&Frame::default(), &mut bytes).expect("vectors take everything");
    bytes
}

fn clouds() -> Vec<Vec<u8>> {
    let write = |encoding| {
        let mut bytes = Vec::new();
        cloud().write_ply(&Frame::default(), encoding, &mut bytes).expect("vectors take everything");
        bytes
    };
    [PlyEncoding::Text, PlyEncoding::Little, PlyEncoding::Big].map(write).into()
}

/// A file in memory that can be looked at after its writer is gone.
#[derive(Debug, Clone, Default)]
struct Shared(Arc<Mutex<Cursor<Vec<u8>>>>);

impl Shared {
    fn content(&self) -> Vec<u8> {
        self.0.lock().expect("one thread").get_ref().clone()
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("one thread").write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Shared {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.lock().expect("one thread").read(bytes)
    }
}

impl Seek for Shared {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.lock().expect("one thread").seek(to)
    }
}

fn las(is_compressed: bool) -> Vec<u8> {
    let file = Shared::default();
    cloud().write_las(&Frame::default(), is_compressed, file.clone()).expect("vectors take everything");
    file.content()
}

fn e57() -> Vec<u8> {
    use e57::{E57Writer, Record, RecordValue};
    let file = Shared::default();
    let mut writer = E57Writer::new(file.clone(), "file").expect("a file");
    let prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
    let mut scan = writer.add_pointcloud("scan", prototype).expect("a scan");
    for point in cloud().points() {
        let point = point.to_array().map(|x| RecordValue::Double(f64::from(x)));
        scan.add_point(point.to_vec()).expect("a point");
    }
    scan.finalize().expect("a scan");
    writer.finalize().expect("a file");
    file.content()
}
