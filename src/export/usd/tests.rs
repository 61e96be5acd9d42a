//! Content of the text, and positions of files in archives. `scripts/check_exports` has USD's own library
//! read them.

use super::archive::{Archive, Sum};
use super::*;
use crate::shape::UpAxis;
use crate::surface::{Instance, Mesh, Transform};
use glam::{Quat, Vec2, Vec3};

fn triangle() -> Mesh {
    Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]).with_uvs(vec![
        Vec2::ZERO,
        Vec2::X,
        Vec2::Y,
    ])
}

fn text(stage: &UsdStage<'_>) -> String {
    let mut usda = Vec::new();
    write_usda(stage, &mut usda).expect("sound");
    String::from_utf8(usda).expect("text")
}

#[test]
fn instances_turn_with_the_axes() {
    let mesh = triangle();
    let copies = [
        Instance {
            position: Vec3::new(1.0, 2.0, 3.0),
            rotation: Quat::from_xyzw(0.0, 0.6, 0.0, 0.8),
            ..Instance::IDENTITY
        },
        Instance { tint: [0.5, 1.0, 1.0], scale: 2.0, ..Instance::IDENTITY },
    ];
    let parts = [Part::new(&mesh)
        .with_name("2 leaves")
        .with_instances(&copies)
        .with_material(crate::surface::Material::white())];
    let axes = Axes::default().with_up(UpAxis::Z).with_unit(0.01).with_origin(Vec3::X);
    let text = text(&UsdStage::of_parts(&parts).with_axes(axes).with_name("an elm"));
    for expected in [
        "metersPerUnit = 0.01\nupAxis = \"Z\"",
        "def Xform \"an_elm\"",
        "double3 xformOp:translate = (-100, ",
        "def PointInstancer \"_2_leaves\"",
        "point3f[] positions = [(100, -300, 200), ",
        // A turn about the axis that points up.
        "quath[] orientations = [(0.8, 0, -0, 0.6), (1, ",
        "float3[] scales = [(1, 1, 1), (2, 2, 2)]",
        "primvars:displayColor = [(1, 1, 1), (0.5, 1, 1)]",
        "rel prototypes = </an_elm/_2_leaves/Prototype>",
        "rel material:binding = </an_elm/Looks/_2_leaves>",
        "primvars:st = [(0, 1), (1, 1), (0, 0)]",
    ] {
        assert!(text.contains(expected), "{expected} is not in\n{text}");
    }
}

#[test]
fn tints_and_colors_of_a_mesh_are_multiplied() {
    let mut mesh = triangle();
    mesh.colors = vec![[1.0, 0.5, 0.5]; 3];
    let copies = [Instance::IDENTITY, Instance { tint: [0.5, 1.0, 1.0], ..Instance::IDENTITY }];
    let parts = [Part::new(&mesh).with_instances(&copies).with_material(crate::surface::Material::white())];
    let text = text(&UsdStage::of_parts(&parts));
    assert!(!text.contains("PointInstancer") && text.contains("faceVertexIndices = [0, 1, 2, 3, 4, 5]"));
    let expected = "displayColor = [(1, 0.5, 0.5), (1, 0.5, 0.5), (1, 0.5, 0.5), (0.5, 0.5, 0.5), ";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn names_are_not_longer_than_archives_can_say() {
    let mesh = triangle();
    let stage = |letters: usize| UsdStage::of_parts(&[Part::new(&mesh)]).with_name("n".repeat(letters));
    for letters in [65_531, 70_000, 131_071] {
        let mut out = Vec::new();
        let error = write_usdz(&stage(letters), &mut out).expect_err("too long").to_string();
        assert!(error.starts_with("UsdStage.name") && out.is_empty(), "{error}");
    }
    write_usdz(&stage(60_000), io::sink()).expect("not too long");
    write_usda(&stage(70_000), io::sink()).expect("text has no such limit");
}

#[test]
fn the_same_tree_is_one_kind() {
    let meshes = [
        triangle(),
        triangle(),
        Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Z], vec![Vec3::Y; 3], vec![0, 1, 2]),
    ];
    let trees = [0, 1, 2].map(|i| [Part::new(&meshes[i])]);
    let scene = (0..30).fold(Scene::default(), |scene, i| {
        scene.with_asset("elm", &trees[i % 3], Transform::at(Vec3::X * i as f32))
    });
    let text = text(&UsdStage::of_scene(&scene));
    assert_eq!(text.matches("class Xform").count(), 2);
    assert_eq!(text.matches("instanceable = true").count(), 30);
    assert!(text.contains("def Xform \"elm_30\"") && text.contains("references = </Kind_2>"));
}

#[test]
fn variants_are_words_that_differ() {
    let mesh = triangle();
    let parts = [Part::new(&mesh)];
    let seasons = [("summer", &parts[..]), ("winter", &parts[..])];
    let found = text(&UsdStage::of_variants("season", &seasons));
    assert!(found.contains("string season = \"summer\"") && found.matches("def Material").count() == 1);
    assert!(text(&UsdStage::of_levels(&[parts, parts])).contains("\"LOD1\" {"));
    for wrong in [
        UsdStage::of_variants("a season", &seasons),
        UsdStage::of_variants("", &seasons),
        UsdStage::of_variants("season", &[seasons[0], seasons[0]]),
        UsdStage::of_variants("season", &[("1", &parts)]),
    ] {
        let mut out = Vec::new();
        let error = write_usda(&wrong, &mut out).expect_err("no words").to_string();
        assert!(error.starts_with("UsdStage.") && out.is_empty(), "{error}");
    }
    for empty in [
        UsdStage::of_variants("season", &[]),
        UsdStage::of_parts(&[]),
        UsdStage::of_scene(&Scene::default()),
        UsdStage::of_levels(&[&parts[..], &[]]),
    ] {
        assert!(matches!(write_usdz(&empty, io::sink()), Err(ExportError::EmptyMesh)));
    }
}

#[test]
fn sums_are_those_of_zip() {
    // The check value of CRC-32/ISO-HDLC, in two pieces.
    let mut sum = Sum::of(b"12345");
    sum.write_all(b"6789").expect("never fails");
    let archive = Archive::new(vec![("a".into(), sum), ("b.png".into(), Sum::of(&[7; 100]))]).expect("small");
    let mut zip = Vec::new();
    archive
        .write(&mut zip, |index, writer| writer.write_all(if index == 0 { b"123456789" } else { &[7; 100] }))
        .expect("memory takes everything");
    assert_eq!(zip[14..18], 0xCBF4_3926_u32.to_le_bytes());
    assert_eq!((&zip[64..73], &zip[128..228]), (&b"123456789"[..], &[7; 100][..]));
    let end = zip.len() - 22;
    let word = |at: usize| u32::from_le_bytes(zip[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!(word(end), 0x0605_4B50);
    assert_eq!(word(end + 16) + word(end + 12), end);
    assert_eq!(word(word(end + 16)), 0x0201_4B50);
    let huge = Archive::new(vec![("a".into(), Sum::of(b"")); 70_000]);
    assert!(matches!(huge, Err(ExportError::Parameter(error)) if error.parameter == "UsdStage.images"));
}

#[cfg(feature = "texture")]
#[test]
fn archives_have_the_images() {
    use crate::texture::{Image, Textures};
    let mesh = triangle();
    let image =
        |channels: u8| Image::new(2, 2, channels, vec![90; 4 * usize::from(channels)]).expect("sizes fit");
    let worn = Textures::default().with_base_color(image(4)).with_normal(image(3)).with_alpha_cutoff(0.25);
    let worn = worn.with_occlusion_roughness_metallic(image(3));
    let parts = [Part::new(&mesh).with_textures(&worn)];
    let stage = UsdStage::of_parts(&parts);
    let text = text(&stage);
    for expected in
        ["@./bark_color.png@", "opacityThreshold = 0.25", "token inputs:sourceColorSpace = \"raw\""]
    {
        assert!(text.contains(expected), "{expected} is not in\n{text}");
    }
    // The normals are the same picture as the rest.
    let images = usd_images(&stage);
    assert_eq!(
        images.iter().map(super::super::ImageFile::name).collect::<Vec<_>>(),
        ["bark_color.png", "bark_normal.png"]
    );
    let mut zip = Vec::new();
    write_usdz(&stage, &mut zip).expect("sound");
    for (name, content) in [("tree.usda", text.as_bytes()), (images[1].name(), &images[1].png())] {
        let at = zip.windows(content.len()).position(|bytes| bytes == content).expect(name);
        assert_eq!(at % 64, 0, "{name}");
    }
}
