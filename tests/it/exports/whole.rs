//! A file as a reader of core glTF finds it, who knows no extension.

use std::collections::BTreeMap;
use treesynth::export::{self, GlbOptions, Instancing, LevelNodes};
use treesynth::glam::{Mat4, Vec2, Vec3};
use treesynth::presets::{self, Season};
use treesynth::surface::{Part, Scene, Transform, Tubes};
use treesynth::texture::{Image, Textures};

/// Triangles, the box around them, and the images of a file.
#[derive(Debug, Clone, PartialEq)]
struct Found {
    triangles: usize,
    low: Vec3,
    high: Vec3,
    images: usize,
}

fn read(glb: &[u8]) -> Found {
    let gltf = ::gltf::Gltf::from_slice(glb).unwrap();
    let blob = gltf.blob.as_deref().unwrap();
    let mut found = Found { triangles: 0, low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, images: 0 };
    let mut open: Vec<_> = gltf.default_scene().unwrap().nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    while let Some((node, above)) = open.pop() {
        let matrix = above * Mat4::from_cols_array_2d(&node.transform().matrix());
        open.extend(node.children().map(|child| (child, matrix)));
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
            let reader = primitive.reader(|_| Some(blob));
            let points: Vec<_> =
                reader.read_positions().unwrap().map(|p| matrix.transform_point3(Vec3::from(p))).collect();
            assert_eq!(reader.read_normals().unwrap().len(), points.len());
            let indices: Vec<_> = reader.read_indices().unwrap().into_u32().collect();
            found.triangles += indices.len() / 3;
            for index in indices {
                let point = points[index as usize];
                (found.low, found.high) = (found.low.min(point), found.high.max(point));
            }
        }
    }
    for image in gltf.images() {
        let ::gltf::image::Source::View { view, mime_type } = image.source() else {
            panic!("an image outside")
        };
        assert_eq!(mime_type, "image/png");
        let png = &blob[view.offset()..view.offset() + view.length()];
        Image::read_png(std::io::Cursor::new(png)).unwrap();
        found.images += 1;
    }
    // Every material's images are there.
    for material in gltf.materials() {
        if let Some(texture) = material.pbr_metallic_roughness().base_color_texture() {
            assert!(texture.texture().source().index() < found.images);
        }
    }
    found
}

fn expected(parts: &[Part<'_>]) -> Found {
    let mut found = Found { triangles: 0, low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, images: 0 };
    for part in parts {
        found.triangles += part.triangles() as usize;
        for copy in part.placed().iter() {
            for &index in &part.mesh().indices {
                let point = copy.matrix() * part.mesh().positions[index as usize] + copy.position;
                (found.low, found.high) = (found.low.min(point), found.high.max(point));
            }
        }
    }
    found
}

fn same(found: &Found, expected: &Found, within: f32, name: &str) {
    assert_eq!((found.triangles, found.images), (expected.triangles, expected.images), "{name}");
    let off = (found.low - expected.low).abs().max((found.high - expected.high).abs()).max_element();
    assert!(off < within, "{name}: {found:?} instead of {expected:?}");
}

#[test]
fn a_core_reader_finds_the_whole_tree() {
    let checked = |tone: u8, channels: usize| {
        let bytes = (0..8 * 8 * channels).map(|i| (i as u8).wrapping_mul(tone)).collect();
        Image::new(8, 8, channels as u8, bytes).unwrap()
    };
    let wood = Textures::default().with_base_color(checked(3, 3)).with_normal(checked(5, 3));
    let blade = Textures::default().with_base_color(checked(7, 4)).with_alpha_cutoff(0.5);
    let blade = blade.with_transmission(checked(9, 3));
    let mut trees = 0;
    for preset in presets::guided() {
        let Some(foliage) = preset.foliage(Season::Summer) else { continue };
        let Ok(skeleton) = preset.synth(400).synthesize(preset.seed) else { continue };
        let mut bark = Tubes::default().mesh(&skeleton).unwrap();
        let leaves = foliage.place(&skeleton, 1).unwrap();
        if leaves.instances.is_empty() || bark.is_empty() {
            continue;
        }
        trees += 1;
        if bark.uvs.is_empty() {
            bark.uvs = vec![Vec2::ZERO; bark.positions.len()];
        }
        let worn = !leaves.leaf.mesh().uvs.is_empty();
        let leaf = if worn { leaves.part().with_textures(&blade) } else { leaves.part() };
        let parts = [Part::new(&bark).with_textures(&wood), leaf];
        let wanted = Found { images: if worn { 4 } else { 2 }, ..expected(&parts) };
        let size = (wanted.high - wanted.low).max_element();
        for (name, options, within) in [
            ("default", GlbOptions::default(), 1e-4 * size),
            ("nodes", GlbOptions::default().with_instancing(Instancing::Nodes), 1e-4 * size),
        ] {
            let mut glb = Vec::new();
            export::write_glb_parts(&parts, &options, &mut glb).unwrap();
            same(&read(&glb), &wanted, within, &format!("{} {name}", preset.name));
        }
        // Levels: a core reader shows the finest, or all side by side if they are told apart by names.
        let levels = [&parts[..], &parts[..1]];
        let mut glb = Vec::new();
        export::write_glb_levels(&levels, &GlbOptions::default(), &mut glb).unwrap();
        same(&read(&glb), &wanted, 1e-4 * size, preset.name);
        glb.clear();
        let named = GlbOptions::default().with_levels(LevelNodes::Named);
        export::write_glb_levels(&levels, &named, &mut glb).unwrap();
        let both = Found { triangles: wanted.triangles + bark.triangles().len(), ..wanted.clone() };
        same(&read(&glb), &both, 1e-4 * size, preset.name);
    }
    assert!(trees > 10, "only {trees} presets in leaf");
}

#[test]
fn a_stand_of_200_trees_of_5_kinds_is_written_once_a_kind() {
    let preset = presets::by_name("figure-07").unwrap().guided().unwrap();
    let kinds: Vec<_> = (0..5)
        .map(|seed| {
            let skeleton = preset.synth(300).synthesize(seed).unwrap();
            let leaves = preset.foliage(Season::Summer).unwrap().place(&skeleton, seed).unwrap();
            (Tubes::default().mesh(&skeleton).unwrap(), leaves)
        })
        .collect();
    // As if each had been read from a file of its own.
    let trees: Vec<_> = (0..200).map(|i| kinds[i % 5].clone()).collect();
    let parts: Vec<_> = trees.iter().map(|(bark, leaves)| [Part::new(bark), leaves.part()]).collect();
    let place = |i: usize| Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32) * 6.0;
    let stand = parts
        .iter()
        .enumerate()
        .fold(Scene::default(), |stand, (i, parts)| stand.with_asset("tree", parts, Transform::at(place(i))));
    let write = |scene: &Scene<'_>, options: &GlbOptions| {
        let mut glb = Vec::new();
        export::write_glb_scene(scene, options, &mut glb).unwrap();
        glb
    };
    let five = parts[..5]
        .iter()
        .fold(Scene::default(), |scene, parts| scene.with_asset("tree", parts, Transform::IDENTITY));
    let options = GlbOptions::default();
    let (whole, few) = (write(&stand, &options), write(&five, &options));
    assert!(whole.len() < few.len() + 200 * 400, "{} bytes, five have {}", whole.len(), few.len());
    same(&read(&whole), &expected(&stand.parts()), 1e-3, "stand");

    // The formats that know no scene take its parts.
    let some = stand.parts()[390..].to_vec();
    let mut stl = Vec::new();
    export::write_stl(&some, &mut stl).unwrap();
    assert_eq!(stl.len() as u64, 84 + 50 * some.iter().map(Part::triangles).sum::<u64>());
    let corner = |at: usize| {
        let float = |at: usize| f32::from_le_bytes(stl[at..at + 4].try_into().unwrap());
        Vec3::new(float(at), float(at + 4), float(at + 8))
    };
    let first = some[0].mesh().positions[some[0].mesh().indices[0] as usize] + place(195);
    assert!(corner(84 + 12).abs_diff_eq(first, 1e-4));
    let mut names = BTreeMap::new();
    for file in ["obj", "ply"] {
        let mut out = Vec::new();
        match file {
            "obj" => export::write_obj(&some, "a.mtl", &mut out).unwrap(),
            _ => export::write_ply(&some, export::PlyFormat::Ascii, &mut out).unwrap(),
        }
        let text = String::from_utf8(out).unwrap();
        let line = if file == "obj" {
            text.lines().find_map(|line| line.strip_prefix("v "))
        } else {
            text.split("end_header\n").nth(1)
        };
        let numbers: Vec<f32> =
            line.unwrap().split_whitespace().take(3).map(|n| n.parse().unwrap()).collect();
        names.insert(file, Vec3::from_slice(&numbers));
    }
    let start = some[0].mesh().positions[0] + place(195);
    assert!(names.values().all(|place| place.abs_diff_eq(start, 1e-4)), "{names:?}");
}

#[test]
fn images_lie_beside_the_obj() {
    let image =
        |tone: u8, channels: u8| Image::new(2, 2, channels, vec![tone; 4 * usize::from(channels)]).unwrap();
    let rough = Image::new(1, 2, 3, vec![1, 200, 3, 4, 100, 6]).unwrap();
    let worn = Textures::default()
        .with_base_color(image(9, 4))
        .with_normal(image(128, 3))
        .with_occlusion_roughness_metallic(rough)
        .with_alpha_cutoff(0.5);
    let again = worn.clone();
    let mesh = super::kites().0;
    let parts = [
        Part::new(&mesh).with_name("a/leaf").with_textures(&worn),
        Part::new(&mesh).with_name("A leaf").with_textures(&again),
        Part::new(&mesh).with_name("bare"),
    ];
    let mtl = String::from_utf8(super::bytes(|out| export::write_mtl(&parts, out))).unwrap();
    let images = export::mtl_images(&parts);
    let names: Vec<_> = images.iter().map(|image| image.name().to_owned()).collect();
    assert_eq!(names, ["a_leaf_color.png", "a_leaf_normal.png", "a_leaf_roughness.png"]);
    for (line, times) in [
        ("map_Kd a_leaf_color.png", 2),
        ("map_d a_leaf_color.png", 2),
        ("norm a_leaf_normal.png", 2),
        ("map_Bump a_leaf_normal.png", 2),
        ("map_Pr a_leaf_roughness.png", 2),
    ] {
        assert_eq!(mtl.matches(line).count(), times, "{line}");
    }
    let roughness = Image::read_png(std::io::Cursor::new(images[2].png())).unwrap();
    assert_eq!((roughness.channels(), roughness.bytes()), (1, &[200, 100][..]));
    let (materials, _) = tobj::load_mtl_buf(&mut mtl.as_bytes()).unwrap();
    assert_eq!(materials[0].diffuse_texture.as_deref(), Some("a_leaf_color.png"));
    assert_eq!(materials[2].diffuse_texture, None);
}
