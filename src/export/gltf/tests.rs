//! The file written has what was given to the writer.

use super::*;
use crate::surface::{Instance, Material, MeshError, Transform, Tubes};
use crate::{Skeleton, math};
use glam::{Vec2, Vec3, Vec4};
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
fn texture_coordinates_that_16_bits_hold_have_16_bits() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let triangle = Mesh::new(corners, vec![Vec3::Z; 3], vec![0, 1, 2]);
    let shorts = [[0.0, 1.0], [1.0, 0.0], [13_107.0 / 65_535.0, 7.0 / 65_535.0]];
    for (uv, component) in [(shorts[2], 5123), ([0.3, 0.5], 5126), ([0.0, 1.5], 5126), ([-1.0, 0.0], 5126)] {
        let uvs = [shorts[0], shorts[1], uv].map(Vec2::from_array).to_vec();
        let glb = written(&triangle.clone().with_uvs(uvs), &GlbOptions::default());
        let (json, buffer) = read(&glb);
        let accessor = &json["accessors"][2];
        assert_eq!(accessor["componentType"], component, "{uv:?}");
        assert!(json["extensionsRequired"].is_null());
        if component == 5123 {
            assert_eq!(accessor["normalized"], true);
            let start = json["bufferViews"][2]["byteOffset"].as_u64().expect("a number") as usize;
            let read = |at: usize| u16::from_le_bytes([buffer[start + at], buffer[start + at + 1]]);
            assert_eq!([0, 2, 4, 6, 8, 10].map(read), [0, 65_535, 65_535, 0, 13_107, 7]);
        }
    }
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
        end += number(&view["byteLength"]).next_multiple_of(4);
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
    // Two indices a word, for there are few vertices; the last one may be alone.
    let pairs = words(&primitive["indices"], mesh.indices.len(), "SCALAR", 34963);
    let mut indices: Vec<_> = pairs.iter().flat_map(|pair| [pair & 0xFFFF, pair >> 16]).collect();
    indices.truncate(mesh.indices.len());
    assert_eq!(indices, mesh.indices);

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
        let text = text::numbers(&[scale, -scale, -0.0]);
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
    let options =
        GlbOptions::default().with_coverages([0.5, 0.25, 0.0]).with_instancing(Instancing::Extension);
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

/// Every vertex of every mesh as any core reader finds it: nodes' transforms, accessors, no extension but rounded numbers.
fn shown(glb: &[u8]) -> Vec<(Vec3, Option<[f32; 3]>)> {
    let (json, buffer) = read(glb);
    let mut found = Vec::new();
    let nodes = json["nodes"].as_array().expect("nodes");
    let float = |value: &Value| value.as_f64().expect("a number") as f32;
    let mut open = vec![(json["scenes"][0]["nodes"][0].clone(), Transform::IDENTITY)];
    while let Some((node, above)) = open.pop() {
        let node = &nodes[node.as_u64().expect("an index") as usize];
        let floats = |key: &str| node[key].as_array().map(|v| v.iter().map(float).collect::<Vec<_>>());
        let transform = above.after(&Transform {
            position: floats("translation").map_or(Vec3::ZERO, |v| Vec3::from_slice(&v)),
            rotation: floats("rotation").map_or(glam::Quat::IDENTITY, |v| glam::Quat::from_slice(&v)),
            scale: floats("scale").map_or(1.0, |v| v[0]),
        });
        open.extend(
            node["children"].as_array().into_iter().flatten().map(|child| (child.clone(), transform)),
        );
        let Some(mesh) = node["mesh"].as_u64() else { continue };
        for primitive in json["meshes"][mesh as usize]["primitives"].as_array().expect("primitives") {
            let numbers = |accessor: &Value| -> Vec<Vec<f32>> {
                let accessor = &json["accessors"][accessor.as_u64().expect("an index") as usize];
                let view = &json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
                let width = match accessor["type"].as_str() {
                    Some("SCALAR") => 1,
                    Some("VEC2") => 2,
                    Some("VEC3") => 3,
                    _ => 4,
                };
                let component = accessor["componentType"].as_u64().expect("a type");
                let size = match component {
                    5120 | 5121 => 1,
                    5123 => 2,
                    _ => 4,
                };
                let stride = view["byteStride"].as_u64().unwrap_or(size * width) as usize;
                let start =
                    view["byteOffset"].as_u64().unwrap_or(0) + accessor["byteOffset"].as_u64().unwrap_or(0);
                let scale = if accessor["normalized"] == true {
                    [127.0, 255.0, 0.0, 65_535.0][(component - 5120) as usize]
                } else {
                    1.0
                };
                let count = accessor["count"].as_u64().expect("a count") as usize;
                let at = |element: usize, i: u64| {
                    let at = start as usize + element * stride + (i * size) as usize;
                    match component {
                        5120 => f32::from(buffer[at] as i8) / scale,
                        5121 => f32::from(buffer[at]) / scale,
                        5123 => f32::from(u16::from_le_bytes([buffer[at], buffer[at + 1]])) / scale,
                        5125 => word(buffer, at) as f32,
                        _ => f32::from_bits(word(buffer, at)),
                    }
                };
                (0..count).map(|element| (0..width).map(|i| at(element, i)).collect()).collect()
            };
            let positions = numbers(&primitive["attributes"]["POSITION"]);
            let colors = primitive["attributes"].get("COLOR_0").map(numbers);
            for index in numbers(&primitive["indices"]) {
                let index = index[0] as usize;
                let color =
                    colors.as_ref().map(|colors| [colors[index][0], colors[index][1], colors[index][2]]);
                found.push((transform.point(Vec3::from_slice(&positions[index])), color));
            }
        }
    }
    found
}

/// `count` leaves in two tints.
fn crown(leaf: &Mesh, count: usize) -> Vec<Instance> {
    let place = |i: usize| Instance {
        position: Vec3::new(math::sin(i as f32), i as f32 / 3.0, math::cos(i as f32)),
        rotation: glam::Quat::from_xyzw(0.6, 0.0, 0.0, 0.8),
        scale: 0.5,
        tint: if i.is_multiple_of(2) { [1.0; 3] } else { [1.0, 0.8, 0.2] },
        ..Instance::IDENTITY
    };
    assert!(!leaf.is_empty());
    (0..count).map(place).collect()
}

#[test]
fn every_form_shows_every_leaf() {
    let (bark, mut leaf) = (tree(), tree());
    leaf.colors.clear();
    for count in [1, 3, 2_000] {
        let copies = crown(&leaf, count);
        let quarter = glam::Quat::from_xyzw(0.0, 0.6, 0.0, 0.8);
        let parts = [
            Part::new(&bark),
            Part::new(&leaf).with_name("leaves").with_instances(&copies).at(Vec3::X * 7.0, quarter, 1.5),
        ];
        let expected: Vec<_> = parts
            .iter()
            .flat_map(|part| {
                let of = |copy: Instance| {
                    let at =
                        move |&i: &u32| copy.matrix() * part.mesh().positions[i as usize] + copy.position;
                    part.mesh().indices.iter().map(at).collect::<Vec<_>>()
                };
                part.placed().iter().copied().flat_map(of).collect::<Vec<_>>()
            })
            .collect();
        for instancing in [Instancing::Merged, Instancing::Nodes] {
            for quantization in [false, true] {
                let options = GlbOptions::default()
                    .with_instancing(instancing)
                    .with_quantization(quantization)
                    .with_origin(Vec3::new(1.0, 2.0, 3.0));
                let mut glb = Vec::new();
                write_glb_parts(&parts, &options, &mut glb).expect("sound");
                let mut found = shown(&glb);
                assert_eq!(found.len(), expected.len(), "{instancing:?} {quantization}");
                // Nodes come off the stack in another order; each vertex has one in its place.
                let key = |p: Vec3| (p.y * 64.0).floor() as i64;
                let mut order: Vec<_> = expected.iter().map(|&p| p - Vec3::new(1.0, 2.0, 3.0)).collect();
                let sort = |points: &mut Vec<Vec3>| {
                    points.sort_by(|a, b| key(*a).cmp(&key(*b)).then(a.x.total_cmp(&b.x)));
                };
                let mut points: Vec<_> = found.iter().map(|vertex| vertex.0).collect();
                let sum = |points: &[Vec3]| points.iter().map(|point| point.as_dvec3()).sum::<glam::DVec3>();
                let (a, b) = (sum(&points), sum(&order));
                let size = 1e-3 * found.len() as f64;
                assert!((a - b).abs().max_element() < size, "{instancing:?} {quantization} {a} {b}");
                if !quantization && instancing == Instancing::Merged {
                    sort(&mut points);
                    sort(&mut order);
                    let bounds = |points: &[Vec3]| crate::Bounds::of(points.iter().copied());
                    let (found, wanted) = (bounds(&points), bounds(&order));
                    assert!((found.min - wanted.min).abs().max_element() < 1e-3);
                    assert!((found.max - wanted.max).abs().max_element() < 1e-3);
                }
                if instancing == Instancing::Merged && count > 1 {
                    found.retain(|vertex| {
                        vertex.1.is_some_and(|[_, g, b]| (g - 0.8).abs() < 0.003 && (b - 0.2).abs() < 0.003)
                    });
                    let leaves = count / 2 * leaf.indices.len();
                    assert_eq!(found.len(), leaves, "tinted corners");
                }
                let (json, _) = read(&glb);
                assert_eq!(json["extensionsRequired"].is_null(), !quantization);
                if instancing == Instancing::Nodes && count > 1 {
                    assert_eq!(json["materials"].as_array().map(Vec::len), Some(3));
                }
            }
        }
    }
}

#[test]
fn tints_go_with_instances() {
    let mesh = tree();
    let copies = crown(&mesh, 4);
    let parts = [Part::new(&mesh).with_instances(&copies)];
    for quantization in [false, true] {
        let options =
            GlbOptions::default().with_instancing(Instancing::Extension).with_quantization(quantization);
        let mut glb = Vec::new();
        write_glb_parts(&parts, &options, &mut glb).expect("sound");
        let (json, buffer) = read(&glb);
        let attributes = &json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
        let floats = |name: &str| -> Vec<f32> {
            let view = &json["bufferViews"][attributes[name].as_u64().expect(name) as usize];
            let start = view["byteOffset"].as_u64().expect("a start") as usize;
            let bytes = view["byteLength"].as_u64().expect("a length") as usize;
            (start..start + bytes).step_by(4).map(|at| f32::from_bits(word(buffer, at))).collect()
        };
        assert_eq!(floats("_COLOR_0")[..6], [1.0, 1.0, 1.0, 1.0, 0.8, 0.2]);
        // A corner of the box, taken back by the first instance.
        let position = &json["accessors"][0];
        let corner = |key: &str| {
            let numbers: Vec<_> =
                (0..3).map(|axis| position[key][axis].as_f64().expect("a number") as f32).collect();
            Vec3::from_slice(&numbers)
        };
        let copy = Instance {
            position: Vec3::from_slice(&floats("TRANSLATION")[..3]),
            rotation: glam::Quat::from_slice(&floats("ROTATION")[..4]),
            scale: floats("SCALE")[0],
            ..Instance::IDENTITY
        };
        let low = mesh.bounds().expect("vertices").min;
        let expected = copies[0].transform().point(low);
        assert!(copy.transform().point(corner("min")).abs_diff_eq(expected, 1e-4), "{quantization}");
    }
}

#[test]
fn levels_may_be_named() {
    let mesh = tree();
    let levels = [[Part::new(&mesh)], [Part::new(&mesh)]];
    let mut glb = Vec::new();
    write_glb_levels(&levels, &GlbOptions::default().with_levels(LevelNodes::Named), &mut glb)
        .expect("sound");
    let (json, _) = read(&glb);
    let names: Vec<_> = (0..3).map(|i| json["nodes"][i]["name"].clone()).collect();
    assert_eq!(names, ["tree", "tree_LOD0", "tree_LOD1"]);
    assert_eq!(
        (json["nodes"][0]["children"].clone(), json["extensionsUsed"].clone()),
        ([1, 2].into(), Value::Null)
    );
}

#[test]
fn a_stand_has_each_mesh_once() {
    let kinds = [tree(), Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2])];
    // As many meshes in memory as trees.
    let own: Vec<_> = (0..20).map(|i| kinds[i % 2].clone()).collect();
    let copies: Vec<_> = own.iter().map(|mesh| crown(mesh, 5)).collect();
    let trees: Vec<_> = own
        .iter()
        .zip(&copies)
        .map(|(mesh, copies)| [Part::new(mesh), Part::new(mesh).with_instances(copies)])
        .collect();
    let stand = trees.iter().enumerate().fold(Scene::default(), |stand, (i, tree)| {
        stand.with_asset("tree", tree, Transform::at(Vec3::X * i as f32))
    });
    for instancing in [Instancing::Merged, Instancing::Extension, Instancing::Nodes] {
        let options = GlbOptions::default().with_instancing(instancing).with_wind(WindEncoding::None);
        let mut glb = Vec::new();
        write_glb_scene(&stand, &options, &mut glb).expect("sound");
        let (json, buffer) = read(&glb);
        let geometries = if instancing == Instancing::Merged { 4 } else { 2 };
        let positions: std::collections::BTreeSet<_> = json["meshes"]
            .as_array()
            .expect("meshes")
            .iter()
            .map(|mesh| mesh["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an accessor"))
            .collect();
        assert_eq!(positions.len(), geometries, "{instancing:?}");
        assert_eq!(json["nodes"][0]["children"].as_array().map(Vec::len), Some(20));
        assert!(buffer.len() < 200_000);
    }
    let nothing = Scene::default();
    assert!(matches!(
        write_glb_scene(&nothing, &GlbOptions::default(), io::sink()),
        Err(ExportError::EmptyMesh)
    ));
    let lost = Scene::default().with_asset("lost", &trees[0], Transform::at(Vec3::NAN));
    let error = write_glb_scene(&lost, &GlbOptions::default(), io::sink()).expect_err("no place").to_string();
    assert!(error.starts_with("Scene.transform is "), "{error}");
    let options = GlbOptions::default().with_origin(Vec3::INFINITY);
    let error = write_glb_scene(&stand, &options, io::sink()).expect_err("no place").to_string();
    assert!(error.starts_with("GlbOptions.origin is "), "{error}");
}

#[test]
fn what_four_gibibytes_cannot_hold_is_refused_at_once() {
    let mesh = Mesh::new(vec![Vec3::ZERO; 70_000], vec![Vec3::Z; 70_000], vec![0, 1, 2]);
    let copies = vec![Instance::IDENTITY; 6_000];
    let parts = [Part::new(&mesh).with_instances(&copies)];
    let error = write_glb_parts(&parts, &GlbOptions::default(), io::sink()).expect_err("too much");
    assert!(matches!(error, ExportError::TooLarge { bytes, .. } if bytes > u64::from(u32::MAX)));
}

#[cfg(feature = "texture")]
#[test]
fn images_are_written_once_and_named_by_materials() {
    use crate::texture::{Image, Textures};
    let image = |tone, channels: u8| {
        Image::new(4, 4, channels, vec![tone; 16 * usize::from(channels)]).expect("sizes fit")
    };
    let worn = || {
        Textures::default()
            .with_base_color(image(200, 4))
            .with_normal(image(128, 3))
            .with_occlusion_roughness_metallic(image(90, 3))
            .with_transmission(image(50, 3))
            .with_alpha_cutoff(0.5)
    };
    // The same in two places of memory.
    let (one, two) = (worn(), worn());
    let mesh = tree();
    let leaf = Material::leaf().with_color([0.5, 1.0, 0.25]);
    let parts = [&one, &two].map(|worn| Part::new(&mesh).with_material(leaf).with_textures(worn));
    let other = parts[0].with_name("other");
    let mut glb = Vec::new();
    write_glb_parts(&[parts[0], parts[1], other, Part::new(&mesh)], &GlbOptions::default(), &mut glb)
        .expect("sound");
    let (json, buffer) = read(&glb);
    let count = |key: &str| json[key].as_array().map_or(0, Vec::len);
    assert_eq!((count("images"), count("textures"), count("samplers"), count("materials")), (4, 4, 1, 3));
    assert_eq!(json["extensionsUsed"], serde_json::json!(["KHR_materials_diffuse_transmission"]));
    assert!(json["extensionsRequired"].is_null());
    let material = &json["materials"][0];
    let pbr = &material["pbrMetallicRoughness"];
    assert_eq!(pbr["baseColorFactor"], serde_json::json!([0.5, 1, 0.25, 1]));
    assert_eq!(
        (pbr["metallicFactor"].clone(), pbr["baseColorTexture"]["index"].clone()),
        (1.into(), 0.into())
    );
    assert_eq!(pbr["metallicRoughnessTexture"], material["occlusionTexture"]);
    assert_eq!((material["alphaMode"].clone(), material["alphaCutoff"].clone()), ("MASK".into(), 0.5.into()));
    for (index, image) in
        [one.base_color(), one.normal(), one.occlusion_roughness_metallic(), one.transmission()]
            .into_iter()
            .enumerate()
    {
        let view =
            &json["bufferViews"][json["images"][index]["bufferView"].as_u64().expect("a view") as usize];
        let start = view["byteOffset"].as_u64().expect("a start") as usize;
        let png = &buffer[start..start + view["byteLength"].as_u64().expect("a length") as usize];
        assert_eq!(Some(&Image::read_png(io::Cursor::new(png)).expect("a PNG")), image);
    }
}

/// What has no alpha is a JPEG if one asks for it, and says so; the rest stays PNG.
#[cfg(feature = "jpeg")]
#[test]
fn images_without_alpha_can_be_jpeg() {
    use crate::texture::{Image, Textures};
    let image =
        |channels: u8| Image::new(8, 8, channels, vec![100; 64 * usize::from(channels)]).expect("fits");
    let worn = Textures::default().with_base_color(image(4)).with_normal(image(3)).with_alpha_cutoff(0.5);
    let mesh = tree();
    let parts = [Part::new(&mesh).with_textures(&worn)];
    let mut glb = Vec::new();
    write_glb_parts(&parts, &GlbOptions::default().with_jpeg(Some(85)), &mut glb).expect("sound");
    let (json, buffer) = read(&glb);
    for (index, (form, start)) in
        [("image/png", [0x89, b'P']), ("image/jpeg", [0xff, 0xd8])].into_iter().enumerate()
    {
        let image = &json["images"][index];
        assert_eq!(image["mimeType"], form);
        let view = &json["bufferViews"][image["bufferView"].as_u64().expect("a view") as usize];
        let from = view["byteOffset"].as_u64().expect("a start") as usize;
        assert_eq!(buffer[from..from + 2], start);
    }
    for quality in [0, 101] {
        let error =
            write_glb_parts(&parts, &GlbOptions::default().with_jpeg(Some(quality)), io::sink()).unwrap_err();
        assert_eq!(error.to_string(), format!("GlbOptions.jpeg is {quality}, but must be 1 to 100"));
    }
}
