//! Files read back by readers that nobody here wrote, and compared with files as they once were.

#[cfg(feature = "import")]
mod axes;
#[cfg(feature = "texture")]
mod whole;

use crate::sample::{cases, fnv1a};
use proptest::prelude::*;
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::Path;
use treesynth::export::*;
use treesynth::foliage::{Foliage, Leaf, Leaves};
use treesynth::glam::{Quat, Vec3};
use treesynth::surface::{Instance, Material, Mesh, Part, Tubes};
use treesynth::{Skeleton, presets};

/// A grown tree in leaf.
fn tree() -> (Skeleton, Mesh, Leaves) {
    let skeleton =
        presets::by_name("figure-07").unwrap().guided().unwrap().synth(1_000).synthesize(1).unwrap();
    let bark = Tubes::default().mesh(&skeleton).unwrap();
    let leaves =
        Foliage::new(Leaf::lobed().with_petiole(0.5)).with_thickest(0.1).place(&skeleton, 1).unwrap();
    assert!(leaves.instances.len() > 100);
    (skeleton, bark, leaves)
}

/// A kite of two triangles, twice: as it is, and doubled, turned by a right angle about Y and moved.
fn kites() -> (Mesh, [Instance; 2]) {
    let positions = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 1.0, 0.0], [-0.5, 0.5, 0.25]];
    let uvs = [[0.5, 1.0], [1.0, 0.5], [0.5, 0.0], [0.0, 0.5]].map(Into::into).to_vec();
    let mesh = Mesh::new(positions.map(Vec3::from_array).to_vec(), vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3]);
    let half = 0.5f32.sqrt();
    let turned = Instance {
        position: Vec3::new(1.0, 2.0, 3.0),
        rotation: Quat::from_xyzw(0.0, half, 0.0, half),
        scale: 2.0,
        node: 1,
        ..Instance::IDENTITY
    };
    (mesh.with_uvs(uvs), [Instance::IDENTITY, turned])
}

fn bytes(write: impl FnOnce(&mut Vec<u8>) -> Result<(), ExportError>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes).unwrap();
    bytes
}

/// All points of all copies, in order.
fn points(parts: &[Part<'_>]) -> Vec<Vec3> {
    let of = |part: &Part<'_>, copy: &Instance| -> Vec<Vec3> {
        part.mesh().positions.iter().map(|&p| copy.matrix() * p + copy.position).collect()
    };
    parts
        .iter()
        .flat_map(|part| part.copies().iter().flat_map(|copy| of(part, copy)).collect::<Vec<_>>())
        .collect()
}

#[test]
fn tobj_reads_the_obj() {
    let (_, bark, leaves) = tree();
    let parts = [Part::new(&bark).with_material(Material::bark()), leaves.part()];
    let mtl = bytes(|out| write_mtl(&parts, out));
    let obj = bytes(|out| write_obj(&parts, "tree.mtl", out));
    let options = tobj::LoadOptions { single_index: false, ..tobj::LoadOptions::default() };
    let (models, materials) = tobj::load_obj_buf(&mut &obj[..], &options, |path| {
        assert_eq!(path, Path::new("tree.mtl"));
        tobj::load_mtl_buf(&mut &mtl[..])
    })
    .unwrap();
    let materials = materials.unwrap();
    assert_eq!((models.len(), materials.len()), (2, 2));
    for ((model, material), part) in models.iter().zip(&materials).zip(&parts) {
        let mesh = &model.mesh;
        assert_eq!((model.name.as_str(), material.name.as_str()), (part.name(), part.name()));
        assert_eq!(material.diffuse, Some(part.material().color()));
        assert_eq!(mesh.indices.len() as u64, 3 * part.triangles());
        assert_eq!(
            (mesh.normal_indices.len(), mesh.texcoord_indices.len()),
            (mesh.indices.len(), mesh.indices.len())
        );
        // It keeps the vertices in the order in which triangles name them.
        let points = points(&[*part]);
        let corners = part.copies().iter().enumerate().flat_map(|(copy, _)| {
            let first = copy * part.mesh().positions.len();
            part.mesh().indices.iter().map(move |index| first + *index as usize)
        });
        for (corner, index) in corners.zip(&mesh.indices) {
            let found = Vec3::from_slice(&mesh.positions[3 * *index as usize..]);
            assert_eq!(found, points[corner], "every number reads back as the same bits");
        }
    }
}

#[test]
fn stl_io_reads_the_stl() {
    let (_, bark, leaves) = tree();
    let parts = [Part::new(&bark), leaves.part()];
    let stl = bytes(|out| write_stl(&parts, out));
    let read: Vec<_> =
        stl_io::create_stl_reader(&mut Cursor::new(&stl)).unwrap().map(Result::unwrap).collect();
    assert_eq!(read.len() as u64, parts.iter().map(Part::triangles).sum::<u64>());
    let all = points(&parts);
    for (triangle, corners) in read.iter().zip(bark.triangles()) {
        for (vertex, corner) in triangle.vertices.iter().zip(corners) {
            assert_eq!(vertex.0, all[corner as usize].to_array());
        }
        assert!((Vec3::from_array(triangle.normal.0).length() - 1.0).abs() < 1e-3);
    }
}

#[test]
fn ply_rs_reads_the_ply() {
    use ply_rs_bw::{parser::Parser, ply::DefaultElement, ply::Property};
    let (_, bark, leaves) = tree();
    let parts = [Part::new(&bark), leaves.part()];
    let all = points(&parts);
    for format in [PlyFormat::Binary, PlyFormat::Ascii] {
        let file = bytes(|out| write_ply(&parts, format, out));
        let ply = Parser::<DefaultElement>::new().read_ply(&mut Cursor::new(&file)).unwrap();
        let (vertices, faces) = (&ply.payload["vertex"], &ply.payload["face"]);
        assert_eq!(faces.len() as u64, parts.iter().map(Part::triangles).sum::<u64>());
        assert_eq!(vertices.len(), all.len());
        for (vertex, point) in vertices.iter().zip(&all) {
            let [x, y, z] = ["x", "y", "z"].map(|name| vertex[name].clone());
            let expected = point.to_array().map(Property::Float);
            assert_eq!([x, y, z], expected);
            assert_eq!(vertex.len(), 11);
        }
        let last = all.len() - leaves.leaf.mesh().positions.len();
        let corners = leaves.leaf.mesh().triangles().last().unwrap().map(|corner| corner + last as u32);
        assert_eq!(faces.last().unwrap()["vertex_indices"], Property::ListUInt(corners.to_vec()));
    }
}

#[test]
fn vertices_have_their_colors_in_the_ply() {
    let (mut kite, _) = kites();
    kite.colors = vec![[1.0; 3], [0.5, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 1.0]];
    let white = Part::new(&kite).with_material(Material::bark().with_color([1.0; 3]));
    let text = |part: Part<'_>| {
        let ply = String::from_utf8(bytes(|out| write_ply(&[part], PlyFormat::Ascii, out))).unwrap();
        let body = ply.split_once("end_header\n").unwrap().1.to_owned();
        body.lines().take(4).map(|line| line.splitn(9, ' ').nth(8).unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(text(white), ["255 255 255", "188 255 0", "0 0 0", "255 0 255"]);
    assert_eq!(text(white.with_material(Material::bark().with_color([0.5; 3])))[3], "188 0 188");
}

#[test]
fn the_gltf_crate_reads_the_glb() {
    let (_, bark, leaves) = tree();
    let parts = [Part::new(&bark), leaves.part()];
    let options = GlbOptions::default().with_name("elm");
    let levels = [&parts[..], &parts[..1]];
    let extension = options.clone().with_instancing(Instancing::Extension);
    let glb = bytes(|out| write_glb_levels(&levels, &extension, out));
    let read = ::gltf::Gltf::from_slice(&glb).unwrap();
    assert_eq!((read.nodes().len(), read.meshes().len(), read.materials().len()), (4, 2, 2));
    let root = read.default_scene().unwrap().nodes().next().unwrap();
    assert_eq!((root.name(), root.children().len()), (Some("elm"), 2));
    assert_eq!(root.extension_value("MSFT_lod").unwrap()["ids"], serde_json::json!([1]));
    let blob = read.blob.as_deref();
    for (mesh, part) in read.meshes().zip(&parts) {
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|_| blob);
        let positions: Vec<_> = reader.read_positions().unwrap().map(Vec3::from_array).collect();
        assert_eq!(positions, part.mesh().positions);
        assert_eq!(reader.read_normals().unwrap().len(), positions.len());
        assert_eq!(reader.read_tex_coords(0).unwrap().into_f32().len(), positions.len());
        assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), part.mesh().indices);
        let look = primitive.material();
        let [red, green, blue] = part.material().color();
        assert_eq!(look.pbr_metallic_roughness().base_color_factor(), [red, green, blue, 1.0]);
        assert_eq!(look.pbr_metallic_roughness().metallic_factor(), 0.0);
        assert_eq!(look.double_sided(), part.material().is_double_sided());
    }

    let glb = bytes(|out| write_glb_parts(&parts, &options.with_instancing(Instancing::Nodes), out));
    let read = ::gltf::Gltf::from_slice(&glb).unwrap();
    let root = read.default_scene().unwrap().nodes().next().unwrap();
    let children: Vec<_> = root.children().collect();
    assert_eq!(children.len(), 1 + leaves.instances.len());
    for (node, instance) in children[1..].iter().zip(&leaves.instances) {
        let (translation, rotation, scale) = node.transform().decomposed();
        assert_eq!((translation, rotation), (instance.position.to_array(), instance.rotation.to_array()));
        assert_eq!((scale, node.mesh().unwrap().index()), ([instance.scale; 3], 1));
    }
}

#[test]
fn instances_in_the_glb_are_the_leaves() {
    let (mesh, copies) = kites();
    let parts = [Part::new(&mesh).with_instances(&copies)];
    let options = GlbOptions::default().with_instancing(Instancing::Extension);
    let glb = bytes(|out| write_glb_parts(&parts, &options, out));
    let read = ::gltf::Gltf::from_slice(&glb).unwrap();
    let node = read.nodes().nth(1).unwrap();
    let attributes = &node.extension_value("EXT_mesh_gpu_instancing").unwrap()["attributes"];
    let floats = |name: &str| -> Vec<f32> {
        let index = attributes[name].as_u64().unwrap() as usize;
        let view = read.accessors().nth(index).unwrap().view().unwrap();
        let bytes = &read.blob.as_ref().unwrap()[view.offset()..view.offset() + view.length()];
        bytes.chunks(4).map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect()
    };
    let half = 0.5f32.sqrt();
    assert_eq!(floats("TRANSLATION"), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    assert_eq!(floats("ROTATION"), [0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half]);
    assert_eq!(floats("SCALE"), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
}

#[test]
fn an_xml_reader_reads_the_svg() {
    let (skeleton, ..) = tree();
    let options = SvgOptions::default().with_thinnest(0.0).with_azimuth(0.7).with_elevation(0.2);
    let text = String::from_utf8(bytes(|out| write_svg(&skeleton, &options, out))).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let view: Vec<f32> = document
        .root_element()
        .attribute("viewBox")
        .unwrap()
        .split(' ')
        .map(|n| n.parse().unwrap())
        .collect();
    assert_eq!(view[2].max(view[3]), 1000.0);
    let paths: Vec<_> = document.descendants().filter(|node| node.has_tag_name("path")).collect();
    assert_eq!(paths.len(), skeleton.segments());
    for path in paths {
        let width: f32 = path.attribute("stroke-width").unwrap().parse().unwrap();
        let numbers = path.attribute("d").unwrap().replace(['M', 'L'], " ");
        let ends: Vec<f32> = numbers.split_whitespace().map(|n| n.parse().unwrap()).collect();
        for end in ends.chunks(2) {
            for axis in 0..2 {
                assert!(end[axis] >= width / 2.0 - 0.02 && end[axis] <= view[2 + axis] - width / 2.0 + 0.02);
            }
        }
    }
}

/// Compares with a file in `golden/`; `TREESYNTH_PIN=1` writes it anew.
fn golden(name: &str, found: &[u8]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/exports/golden").join(name);
    if std::env::var_os("TREESYNTH_PIN").is_some() {
        fs::write(&path, found).unwrap();
    }
    assert!(fs::read(&path).unwrap() == found, "{name} is another file than it was");
}

#[test]
fn small_files_are_as_ever() {
    let (mesh, copies) = kites();
    let bare = mesh.clone().with_uvs(Vec::new());
    let leaf = Material::leaf().with_srgb([80, 120, 40]);
    let parts = [
        Part::new(&mesh).with_name("two kites").with_material(leaf).with_instances(&copies),
        Part::new(&bare),
    ];
    golden("kites.obj", &bytes(|out| write_obj(&parts, "kites.mtl", out)));
    golden("kites.mtl", &bytes(|out| write_mtl(&parts, out)));
    golden("kites.ply", &bytes(|out| write_ply(&parts, PlyFormat::Ascii, out)));
    golden("kites-uv.ply", &bytes(|out| write_ply(&parts[..1], PlyFormat::Ascii, out)));
    golden("kites.stl", &bytes(|out| write_stl(&parts, out)));
    golden("kites.glb", &bytes(|out| write_glb_parts(&parts, &GlbOptions::default(), out)));
    golden("kites.usda", &bytes(|out| write_usda(&UsdStage::of_parts(&parts), out)));
    let fork = Skeleton::new(
        vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.8, 0.0), Vec3::new(0.5, 1.8, -0.5)],
        vec![None, Some(0), Some(1), Some(1)],
    );
    let fork = fork.unwrap().with_radii(vec![0.2, 0.1, 0.05, 0.05]).unwrap();
    golden("fork.svg", &bytes(|out| write_svg(&fork, &SvgOptions::default(), out)));
}

#[test]
fn a_crown_is_as_ever() {
    let (skeleton, _, leaves) = tree();
    let parts = [leaves.part()];
    let mut found = String::new();
    let mut add = |name: &str, file: Vec<u8>| {
        use std::fmt::Write as _;
        writeln!(found, "{name} {:016x}", fnv1a(file)).unwrap();
    };
    add("obj", bytes(|out| write_obj(&parts, "tree.mtl", out)));
    add("ply", bytes(|out| write_ply(&parts, PlyFormat::Binary, out)));
    add("stl", bytes(|out| write_stl(&parts, out)));
    add("svg", bytes(|out| write_svg(&skeleton, &SvgOptions::default(), out)));
    golden("crown.txt", found.as_bytes());
}

/// Takes so many bytes, then fails.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len().min(self.0);
        self.0 -= taken;
        if taken == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(taken) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

type Writer<'a> = &'a dyn Fn(&mut dyn Write) -> Result<(), ExportError>;

#[test]
fn a_full_disk_is_reported() {
    let (skeleton, bark, leaves) = tree();
    let parts = [Part::new(&bark), leaves.part()];
    let writers: [Writer<'_>; 10] = [
        &|out| write_obj(&parts, "tree.mtl", out),
        &|out| write_mtl(&parts, out),
        &|out| write_ply(&parts, PlyFormat::Binary, out),
        &|out| write_ply(&parts, PlyFormat::Ascii, out),
        &|out| write_stl(&parts, out),
        &|out| write_svg(&skeleton, &SvgOptions::default(), out),
        &|out| write_glb_parts(&parts, &GlbOptions::default(), out),
        &|out| write_skeleton(&skeleton, out),
        &|out| write_usda(&UsdStage::of_parts(&parts), out),
        &|out| write_usdz(&UsdStage::of_parts(&parts), out),
    ];
    for write in writers {
        let mut whole = Vec::new();
        write(&mut whole).unwrap();
        for room in [0, 1, 50, whole.len() / 2, whole.len() - 1] {
            let result = write(&mut Full(room));
            assert!(matches!(result, Err(ExportError::Io(e)) if e.kind() == io::ErrorKind::StorageFull));
        }
        assert!(write(&mut Full(whole.len())).is_ok());
    }
}

#[test]
fn what_is_wrong_is_named_and_nothing_written() {
    let (mesh, _) = kites();
    let mut broken = mesh.clone();
    broken.positions[2].y = f32::NAN;
    let nothing = Mesh::default();
    let wrong_look = Part::new(&mesh).with_material(Material::leaf().with_roughness(7.0));
    let cases: [(&[Part<'_>], &str); 6] = [
        (&[], "no triangles"),
        (&[Part::new(&nothing)], "no triangles"),
        (&[Part::new(&mesh).with_instances(&[])], "no triangles"),
        (&[Part::new(&mesh), Part::new(&broken)], "vertex 2"),
        (&[wrong_look], "Material.roughness is 7.0"),
        (&[Part::new(&mesh).at(Vec3::X, Quat::IDENTITY, 0.0)], "Part.transform is "),
    ];
    for (parts, expected) in cases {
        let mut out = Vec::new();
        let errors = [
            write_obj(parts, "a", &mut out).unwrap_err(),
            write_mtl(parts, &mut out).unwrap_err(),
            write_ply(parts, PlyFormat::Binary, &mut out).unwrap_err(),
            write_stl(parts, &mut out).unwrap_err(),
            write_glb_parts(parts, &GlbOptions::default(), &mut out).unwrap_err(),
            write_usda(&UsdStage::of_parts(parts), &mut out).unwrap_err(),
            write_usdz(&UsdStage::of_parts(parts), &mut out).unwrap_err(),
        ];
        assert!(errors.iter().all(|error| error.to_string().contains(expected)), "{errors:?}");
        assert!(out.is_empty());
    }
    let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).unwrap();
    let options = SvgOptions::default();
    for (wrong, name) in [
        (options.clone().with_size(0.0), "size"),
        (options.clone().with_azimuth(f32::NAN), "azimuth"),
        (options.clone().with_elevation(2.0), "elevation"),
        (options.clone().with_thinnest(-1.0), "thinnest"),
    ] {
        let error = write_svg(&pole, &wrong, io::sink()).unwrap_err().to_string();
        assert!(error.starts_with(&format!("SvgOptions.{name} is ")), "{error}");
    }
    let far = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 3e38], vec![None, Some(0)]).unwrap();
    assert!(matches!(write_svg(&far, &options, io::sink()), Err(ExportError::Parameter(_))));
    let root = Skeleton::new(vec![Vec3::ZERO], vec![None]).unwrap();
    assert!(write_svg(&root, &options, io::sink()).is_ok(), "an empty drawing");
}

proptest! {
    #![proptest_config(cases(64))]

    /// OBJ has no escapes: whatever parts are called, files stay readable and keep them apart.
    #[test]
    fn any_names(names in prop::collection::vec(".{0,8}", 1..4), library in ".{0,8}") {
        let (mesh, _) = kites();
        let parts: Vec<_> = names.iter().map(|name| Part::new(&mesh).with_name(name)).collect();
        let obj = bytes(|out| write_obj(&parts, &library, out));
        let mtl = bytes(|out| write_mtl(&parts, out));
        let read = tobj::load_obj_buf(&mut &obj[..], &tobj::LoadOptions::default(), |_| tobj::load_mtl_buf(&mut &mtl[..]));
        let (models, materials) = read.unwrap();
        prop_assert_eq!(models.len(), names.len());
        prop_assert_eq!(materials.unwrap().len(), names.len());
        for (i, model) in models.iter().enumerate() {
            prop_assert_eq!(model.mesh.material_id, Some(i));
        }
        let glb = bytes(|out| write_glb_parts(&parts, &GlbOptions::default().with_name(&library), out));
        let read = ::gltf::Gltf::from_slice(&glb).unwrap();
        let found: Vec<_> = read.nodes().map(|node| node.name().unwrap().to_owned()).collect();
        prop_assert_eq!(&found[0], &library);
        if names.len() > 1 {
            prop_assert_eq!(&found[1..], &names);
        }
    }
}
