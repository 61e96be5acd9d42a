//! What is written is what was given.

use super::*;
use crate::surface::{MeshError, Tubes};
use crate::{Skeleton, math};
use glam::Vec3;
use serde_json::Value;

fn tree() -> Mesh {
    let points: Vec<_> = (0..10).map(|i| Vec3::new(math::sin(i as f32) / 3.0, i as f32 / 7.0, 0.1)).collect();
    let parents = (0..10u32).map(|i| i.checked_sub(1)).collect();
    let skeleton = Skeleton::new(points, parents).and_then(|s| s.with_radii(vec![0.03; 10])).expect("sound");
    let mut mesh = Tubes::default().with_wind(true).mesh(&skeleton).expect("has a surface");
    mesh.colors = (0..mesh.positions.len()).map(|i| [1.0, i as f32 / 1e4, 0.5]).collect();
    mesh
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

/// Splits a file into its JSON and its buffer, checking the container on the way.
fn read(glb: &[u8]) -> (Value, &[u8]) {
    assert_eq!((word(glb, 0), word(glb, 4), word(glb, 8)), (MAGIC, 2, glb.len() as u32));
    let json = word(glb, 12) as usize;
    assert_eq!((word(glb, 16), json % 4), (CHUNK_JSON, 0));
    let binary = &glb[20 + json..];
    assert_eq!((word(binary, 0) as usize, word(binary, 4)), (binary.len() - 8, CHUNK_BINARY));
    assert_eq!(binary.len() % 4, 0);
    (serde_json::from_slice(&glb[20..20 + json]).expect("valid JSON"), &binary[8..])
}

fn written(mesh: &Mesh, options: &GlbOptions) -> Vec<u8> {
    let mut glb = Vec::new();
    write_glb(mesh, options, &mut glb).expect("a vector takes everything");
    glb
}

#[test]
fn everything_comes_back() {
    let mesh = tree();
    let glb = written(&mesh, &GlbOptions::default());
    let (json, buffer) = read(&glb);
    assert_eq!(json["buffers"][0]["byteLength"], buffer.len());
    let number = |value: &Value| value.as_u64().expect("a number") as usize;
    let views = json["bufferViews"].as_array().expect("views");
    let accessors = json["accessors"].as_array().expect("accessors");
    let primitive = &json["meshes"][0]["primitives"][0];
    let mut end = 0;
    for view in views {
        assert_eq!((number(&view["byteOffset"]), end % 4), (end, 0));
        end += number(&view["byteLength"]);
    }
    assert_eq!((end, accessors.len()), (buffer.len(), views.len()));

    // The words of an accessor, which has a view of its own.
    let words = |accessor: &Value, count: usize, kind: &str, target: u64| -> Vec<u32> {
        let accessor = number(accessor);
        let view = &views[accessor];
        assert_eq!(number(&accessors[accessor]["count"]), count);
        assert_eq!(
            (accessors[accessor]["type"].as_str(), view["target"].as_u64()),
            (Some(kind), Some(target))
        );
        let start = number(&view["byteOffset"]);
        (start..start + number(&view["byteLength"])).step_by(4).map(|at| word(buffer, at)).collect()
    };
    let vertices = mesh.positions.len();
    let same = |attribute: &str, kind: &str, floats: Vec<f32>| {
        let found = words(&primitive["attributes"][attribute], vertices, kind, 34962);
        assert!(found == floats.into_iter().map(f32::to_bits).collect::<Vec<_>>(), "{attribute}");
    };
    same("POSITION", "VEC3", mesh.positions.iter().flat_map(Vec3::to_array).collect());
    same("NORMAL", "VEC3", mesh.normals.iter().flat_map(Vec3::to_array).collect());
    same("TANGENT", "VEC4", mesh.tangents.iter().flat_map(Vec4::to_array).collect());
    same("TEXCOORD_0", "VEC2", mesh.uvs.iter().flat_map(Vec2::to_array).collect());
    same("COLOR_0", "VEC3", mesh.colors.iter().flatten().copied().collect());
    for (level, name) in ["_WIND_TRUNK", "_WIND_LIMB", "_WIND_TWIG"].into_iter().enumerate() {
        same(name, "VEC3", mesh.wind.iter().flat_map(|wind| wind.moments[level].to_array()).collect());
    }
    for (level, name) in ["_WIND_LIMB_AXIS", "_WIND_TWIG_AXIS"].into_iter().enumerate() {
        same(name, "VEC3", mesh.wind.iter().flat_map(|wind| wind.axes[level].to_array()).collect());
    }
    same("_WIND_FLUTTER", "SCALAR", mesh.wind.iter().map(|wind| wind.flutter).collect());
    assert_eq!(words(&primitive["indices"], mesh.indices.len(), "SCALAR", 34963), mesh.indices);

    let position = &accessors[0];
    let bounds = mesh.bounds().expect("vertices");
    for axis in 0..3 {
        for (key, bound) in [("min", bounds.min), ("max", bounds.max)] {
            let value = position[key][axis].as_f64().expect("a number");
            assert_eq!(value.to_bits(), f64::from(bound[axis]).to_bits());
        }
    }
}

#[test]
fn attributes_are_optional() {
    let bare = tree();
    let mesh = Mesh::new(bare.positions, bare.normals, bare.indices);
    let glb = written(&mesh, &GlbOptions::default());
    let (json, _) = read(&glb);
    let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object().expect("attributes");
    assert_eq!(attributes.keys().collect::<Vec<_>>(), ["NORMAL", "POSITION"]);
    assert_eq!(json["accessors"].as_array().map(Vec::len), Some(3));
}

#[test]
fn names_are_escaped() {
    for name in ["", "a \"quoted\" \\ name", "line\nbreak\t\u{1}\u{7f}", "Lärche 落葉松 🌲"] {
        let glb = written(&tree(), &GlbOptions::default().with_name(name));
        let (json, _) = read(&glb);
        assert_eq!(json["nodes"][0]["name"], name);
    }
}

#[test]
fn extreme_numbers_come_back() {
    for scale in [f32::MIN_POSITIVE, 1e-30, 1.0 / 3.0, 1e30] {
        let text = document::numbers(&[scale, -scale, -0.0]);
        let back: [f32; 3] = serde_json::from_str(&text).expect("valid JSON");
        assert_eq!(back.map(f32::to_bits), [scale, -scale, -0.0].map(f32::to_bits));
    }
}

#[test]
fn what_is_wrong_is_named() {
    let write = |mesh: &Mesh, options: &GlbOptions| write_glb(mesh, options, io::sink());
    let fine = GlbOptions::default();
    assert!(matches!(write(&Mesh::default(), &fine), Err(ExportError::EmptyMesh)));
    let mut broken = tree();
    broken.positions[3].y = f32::NAN;
    assert!(matches!(write(&broken, &fine), Err(ExportError::Mesh(MeshError::Position { vertex: 3, .. }))));
    let coverages = |coverages: &[f32]| fine.clone().with_coverages(coverages);
    let looks = [Material::bark().with_color([0.0, f32::NAN, 0.0]), Material::bark().with_roughness(1.5)];
    let wrong = looks.map(|look| fine.clone().with_material(look)).into_iter().chain([
        coverages(&[0.5, 0.1]),
        coverages(&[f32::NAN]),
        coverages(&[1.1]),
    ]);
    for options in wrong {
        assert!(matches!(write(&tree(), &options), Err(ExportError::Parameter(_))), "{options:?}");
    }
    let mesh = tree();
    let lost = [Instance { position: Vec3::NAN, ..Instance::IDENTITY }];
    let result = write_glb_parts(&[Part::new(&mesh).with_instances(&lost)], &fine, io::sink());
    assert!(matches!(result, Err(ExportError::Mesh(MeshError::Instance { index: 0, .. }))));
    let none: [[Part<'_>; 1]; 0] = [];
    assert!(matches!(write_glb_levels(&none, &fine, io::sink()), Err(ExportError::EmptyMesh)));
    let bare = [Part::new(&mesh).with_instances(&[])];
    assert!(matches!(write_glb_parts(&bare, &fine, io::sink()), Err(ExportError::EmptyMesh)));
    let two = [[Part::new(&mesh)], [bare[0]]];
    assert!(matches!(write_glb_levels(&two, &fine, io::sink()), Err(ExportError::EmptyMesh)));
}

#[test]
fn meshes_and_materials_are_written_once() {
    let (bark, leaf) = (tree(), tree());
    let instances = [Instance { scale: 0.5, node: 3, ..Instance::IDENTITY }; 3];
    let leaves = Part::new(&leaf).with_name("leaves").with_material(Material::leaf());
    let level = |count: usize| [Part::new(&bark), leaves.with_instances(&instances[..count])];
    let mut glb = Vec::new();
    let options = GlbOptions::default().with_coverages([0.5, 0.25, 0.0]);
    write_glb_levels(&[level(3), level(2), level(0)], &options, &mut glb).expect("sound");
    let (json, buffer) = read(&glb);
    assert_eq!(json["extensionsUsed"], serde_json::json!(["EXT_mesh_gpu_instancing", "MSFT_lod"]));
    let nodes = json["nodes"].as_array().expect("nodes");
    // Three levels, of which the last has one part only and is that part; two parts of each of the others.
    assert_eq!(
        (nodes.len(), nodes[0]["extensions"]["MSFT_lod"]["ids"].clone()),
        (7, serde_json::json!([1, 2]))
    );
    assert_eq!(nodes[0]["extras"]["MSFT_screencoverage"], serde_json::json!([0.5, 0.25, 0]));
    assert_eq!((nodes[0]["children"].clone(), nodes[1]["children"].clone()), ([3, 4].into(), [5, 6].into()));
    assert_eq!((nodes[2]["mesh"].clone(), nodes[2]["name"].clone()), (0.into(), "tree_lod2".into()));
    assert_eq!(json["scenes"][0]["nodes"], serde_json::json!([0]));
    for (node, count) in [(4, 3), (6, 2)] {
        let attributes = &nodes[node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
        for (name, kind) in [("TRANSLATION", "VEC3"), ("ROTATION", "VEC4"), ("SCALE", "VEC3")] {
            let accessor = &json["accessors"][attributes[name].as_u64().expect("an index") as usize];
            assert_eq!((accessor["count"].clone(), accessor["type"].clone()), (count.into(), kind.into()));
        }
    }
    assert_eq!(json["meshes"].as_array().map(Vec::len), Some(2));
    let materials = json["materials"].as_array().expect("materials");
    assert_eq!(materials.len(), 2);
    assert_eq!(
        (materials[0]["doubleSided"].clone(), materials[1]["doubleSided"].clone()),
        (false.into(), true.into())
    );
    assert!(materials.iter().all(|material| material["pbrMetallicRoughness"]["metallicFactor"] == 0));
    assert_eq!(json["buffers"][0]["byteLength"], buffer.len());
}
