//! glTF as a source of shapes.

use super::{CORNERS, Read, has, is, is_cube, refused, triangles};
use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::shape::TriangleMesh;

fn read(bytes: impl AsRef<[u8]>) -> Read {
    TriangleMesh::read_gltf(bytes.as_ref())
}

fn base64(bytes: &[u8]) -> String {
    use ::base64::Engine;
    ::base64::prelude::BASE64_STANDARD.encode(bytes)
}

/// The cube's corners as floats, then indices of 16 bits, then three translations.
fn buffer() -> Vec<u8> {
    let mut bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|&x| f32::from(x).to_le_bytes()).collect();
    let index = |corner: [u8; 3]| CORNERS.iter().position(|other| *other == corner).unwrap() as u16;
    bytes.extend(triangles().flatten().flat_map(|corner| index(corner).to_le_bytes()));
    bytes.extend([0.0_f32, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 5.0, 0.0].iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

fn document(nodes: &str, mesh: &str, uri: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],"meshes":[{{"primitives":[{mesh}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}},{{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}},
        {{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":72}},{{"buffer":0,"byteOffset":168,"byteLength":36}}],
        "buffers":[{{"byteLength":204{uri}}}]}}"#
    )
}

const MESH: &str = r#"{"attributes":{"POSITION":0},"indices":1}"#;

fn text(nodes: &str) -> String {
    document(nodes, MESH, &format!(r#","uri":"data:application/octet-stream;base64,{}""#, base64(&buffer())))
}

fn binary(nodes: &str) -> Vec<u8> {
    let (mut json, binary) = (document(nodes, MESH, "").into_bytes(), buffer());
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    for word in [2, 28 + json.len() + binary.len(), json.len(), 0x4E4F_534A] {
        bytes.extend((word as u32).to_le_bytes());
    }
    bytes.extend(json);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(0x004E_4942_u32.to_le_bytes());
    bytes.extend(binary);
    bytes
}

#[test]
fn meshes_are_read_where_they_stand() {
    is_cube(read(text(r#"{"mesh":0}"#)), "text");
    is_cube(read(format!("\u{feff}{}", text(r#"{"mesh":0}"#))), "byte order mark");
    is_cube(read(binary(r#"{"mesh":0}"#)), "binary");
    let nested = r#"{"children":[1],"translation":[1,0,0]},{"mesh":0,"scale":[2,1,1],"rotation":[0,0,0.70710678,0.70710678]}"#;
    let mesh = is(read(binary(nested)), 16.0, 40.0, "nested");
    assert!((mesh.bounds().max - Vec3::new(1.0, 4.0, 2.0)).length() < 1e-5, "{:?}", mesh.bounds());
    let matrix = r#"{"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1]}"#;
    assert_eq!(is(read(binary(matrix)), 8.0, 24.0, "matrix").bounds().min, Vec3::new(7.0, 8.0, 9.0));
    is(read(binary(r#"{"mesh":0,"scale":[-1,1,1]}"#)), 8.0, 24.0, "mirrored");
    let instances = r#"{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}}"#;
    is(read(binary(instances)), 24.0, 72.0, "instances");
    // No scene is named: all roots.
    is_cube(read(text(r#"{"mesh":0}"#).replace(r#""scene":0,"scenes":[{"nodes":[0]}],"#, "")), "no scene");
}

#[test]
fn what_this_crate_writes_is_read() -> Result<(), Box<dyn std::error::Error>> {
    use treesynth::export::{GlbOptions, Instancing, write_glb_parts};
    use treesynth::foliage::{Foliage, Leaf};
    use treesynth::surface::{Part, Tubes};
    let twig = treesynth::Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 0.3], vec![None, Some(0)])?
        .with_radii(vec![0.02; 2])?;
    let bark = Tubes::default().with_closed_base(true).mesh(&twig)?;
    let leaves = Foliage::new(Leaf::ovate()).place(&twig, 7)?;
    let mut found = Vec::new();
    for instancing in [Instancing::Merged, Instancing::Extension, Instancing::Nodes] {
        let mut glb = Vec::new();
        let parts = [Part::new(&bark), leaves.part()];
        write_glb_parts(&parts, &GlbOptions::default().with_instancing(instancing), &mut glb)?;
        found.push(read(glb)?);
    }
    assert!(found.iter().all(|mesh| (mesh.volume() / found[0].volume() - 1.0).abs() < 1e-3));
    let mut glb = Vec::new();
    write_glb_parts(&[Part::new(&bark)], &GlbOptions::default(), &mut glb)?;
    let alone = read(glb)?;
    has(&alone, alone.volume(), alone.surface_area().unwrap_or(0.0), "bark");
    Ok(())
}

#[test]
fn buffers_beside_the_file_are_found() {
    let folder = std::env::temp_dir().join(format!("treesynth-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("a cube.GLTF");
    let with = |uri: &str| document(r#"{"mesh":0}"#, MESH, &format!(r#","uri":"{uri}""#));
    std::fs::write(folder.join("a b.bin"), buffer()).unwrap();
    std::fs::write(folder.join("short.bin"), [0; 9]).unwrap();
    let open = |uri: &str| {
        std::fs::write(&path, with(uri)).unwrap();
        TriangleMesh::open(&path)
    };
    is_cube(open("a%20b.bin"), "beside");
    refused(open("short.bin"), &["a cube.GLTF", "short.bin", "9 bytes", "204"], "short");
    refused(open("gone.bin"), &["a cube.GLTF", "gone.bin"], "gone");
    refused(open("/dev/zero"), &["/dev/zero", "beside this one"], "absolute");
    refused(open("http://a.b/c.bin"), &["beside this one"], "elsewhere");
    refused(read(with("a%20b.bin")), &["buffer 0", "Import::open"], "reader");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn strips_fans_and_odd_accessors() {
    let mesh = |mesh: &str, accessors: &str| {
        let text =
            document(r#"{"mesh":0}"#, mesh, &format!(r#","uri":"data:;base64,{}""#, base64(&buffer())));
        text.replace(r#"{"bufferView":1,"#, &format!(r#"{accessors}{{"bufferView":1,"#))
    };
    // Without indices: the first six corners are no solid.
    refused(read(mesh(r#"{"attributes":{"POSITION":0}}"#, "")), &["encloses nothing"], "no indices");
    for mode in ["0", "1", "2", "3"] {
        let text = mesh(&format!(r#"{{"attributes":{{"POSITION":0}},"mode":{mode}}},{MESH}"#), "");
        is_cube(read(text), "lines and points beside");
    }
    refused(read(mesh(r#"{"attributes":{"POSITION":0},"mode":5}"#, "")), &["open sides"], "strip");
    refused(read(mesh(r#"{"attributes":{"POSITION":0},"mode":6}"#, "")), &["open sides"], "fan");
}

#[test]
fn counts_are_not_believed() {
    let bent = |from: &str, to: &str, words: &[&str]| {
        let text = text(r#"{"mesh":0}"#);
        assert!(text.contains(from), "{from}");
        refused(read(text.replacen(from, to, 1)), words, to);
    };
    bent(r#""count":8"#, r#""count":4000000000"#, &["glTF, mesh 0", "4000000036"]);
    bent(r#""count":8"#, r#""count":20000000"#, &["glTF, accessor 0", "20000000"]);
    bent(r#""count":8"#, r#""count":9"#, &["glTF, accessor 0", "do not fit"]);
    bent(r#""count":8"#, r#""count":3"#, &["glTF, mesh 0", "vertex", "has 3"]);
    bent(r#"{"bufferView":0,"#, "{", &["no triangle"]);
    bent(
        r#"{"bufferView":0,"componentType":5126,"count":8"#,
        r#"{"componentType":5126,"count":20000000"#,
        &["accessor 0", "no buffer"],
    );
    bent(r#""byteLength":96"#, r#""byteLength":9600"#, &["accessor 0", "view 0"]);
    bent(r#""buffer":0"#, r#""buffer":7"#, &["accessor 0", "buffer 7"]);
    bent(r#""POSITION":0"#, r#""POSITION":9"#, &["accessor 9", "there are 3"]);
    bent(r#""mesh":0"#, r#""mesh":5"#, &["mesh 5", "there are 1"]);
    bent(r#""mesh":0"#, r#""children":[0]"#, &["node 0", "ancestor"]);
    bent(r#""mesh":0"#, r#""children":[3]"#, &["node 3", "there are 1"]);
    bent(r#""scene":0"#, r#""scene":4"#, &["scene 4"]);
    bent(r#""componentType":5123"#, r#""componentType":5126"#, &["accessor 1", "5126"]);
    bent(r#""version":"2.0""#, r#""version":"1.0""#, &["version", "2.0"]);
    bent(
        r#""scene":0"#,
        r#""extensionsRequired":["KHR_draco_mesh_compression"],"scene":0"#,
        &["KHR_draco_mesh_compression", "compressed"],
    );
    let plain = binary(r#"{"mesh":0}"#);
    for end in [4, 8, 12, 20, 100, plain.len() - 1] {
        refused(read(&plain[..end]), &["glTF"], "cut");
    }
    refused(read(""), &["glTF", "empty"], "empty");
    refused(read("solid a"), &["glTF", "solid a"], "STL");
    refused(read(b"\x1f\x8b\x08\0\0"), &["glTF", "1f 8b"], "gzip");
    refused(read(format!("{{\"nodes\":{}", "[".repeat(100_000))), &["glTF, line"], "deep");
}

/// Instances of instances would make more triangles than any memory holds.
#[test]
fn copies_are_bounded() {
    let buffer = vec![0_u8; 4_000_000];
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":0}}}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":200000,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":3000000}}],"buffers":[{{"byteLength":3000000,"uri":"data:;base64,{}"}}]}}"#,
        base64(&buffer)
    );
    refused(read(text), &["mesh 0", "200000 copies", "30000000"], "copies");
}
