//! Options that users get wrong, and skeletons that are odd: an error or a sound result, never a panic, and never minutes.

use std::panic::{AssertUnwindSafe, catch_unwind};
use treesynth::export::{
    Axes, GlbOptions, PlyFormat, SvgOptions, UsdStage, write_glb_parts, write_obj, write_ply, write_stl,
    write_stl_with, write_svg, write_usdz,
};
use treesynth::foliage::{Foliage, Leaf};
use treesynth::glam::Vec3;
use treesynth::growth::{Architecture, Growth, Timeline};
use treesynth::guided::{AroundTree, Bend, HopSurface, Refinement, Stage, TreeSynth};
use treesynth::radius::{PipeModel, Taper, Variational};
use treesynth::shape::Cuboid;
use treesynth::surface::blob::{BlobTreeBuilder, Primitive, Skin};
use treesynth::surface::{
    Capsules, Implicit, Levels, Mesh, Part, Polygonizer, SurfaceError, Sway, Tubes, Unwrap,
};
use treesynth::{Metrics, RadiusModel, Skeleton};

const NUMBERS: [f32; 19] = [
    0.0,
    -0.0,
    1e-45,
    f32::MIN_POSITIVE,
    1e-10,
    1e-4,
    0.3,
    1.0,
    -1.0,
    7.0,
    1e3,
    1e6,
    1e10,
    f32::MAX,
    f32::MIN,
    f32::EPSILON,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
];
const COUNTS: [u32; 8] = [0, 1, 2, 3, 17, 1 << 16, u32::MAX - 1, u32::MAX];

/// Has something done, which may fail but not panic.
fn tried(
    what: &str,
    value: impl std::fmt::Debug,
    work: impl FnOnce() -> Result<(), String>,
) -> Option<String> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => None,
        Ok(Err(error)) => {
            assert!(!error.is_empty() && error.len() < 1000, "{what}({value:?}): {error}");
            Some(error)
        }
        Err(panic) => panic!("{what}({value:?}) panics: {panic:?}"),
    }
}

/// A mesh is sound, or there is an error.
fn sound<E: std::fmt::Display>(made: Result<Mesh, E>) -> Result<(), String> {
    let mesh = made.map_err(|error| error.to_string())?;
    assert_eq!(mesh.check(), Ok(()));
    Ok(())
}

fn done<T, E: std::fmt::Display>(made: Result<T, E>) -> Result<(), String> {
    made.map(|_| ()).map_err(|error| error.to_string())
}

/// Each setter of some options with each value; what is not a number or infinite where that means nothing is refused.
macro_rules! bent {
    ($values:expr, $options:expr, $work:expr, [$($set:ident),* $(,)?]) => {$(
        for value in $values {
            let error = tried(stringify!($set), value, || $work(&$options.$set(value)));
            let is_nan = format!("{value:?}").contains("NaN");
            assert!(!is_nan || error.is_some(), concat!(stringify!($set), "(NaN) is accepted"));
        }
    )*};
}

fn fork() -> Skeleton {
    let points = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(1.0, 1.7, 0.0)];
    Skeleton::new(points, vec![None, Some(0), Some(1), Some(1)])
        .and_then(|tree| tree.with_radii(vec![0.2, 0.15, 0.1, 0.05]))
        .expect("a fork")
}

#[test]
fn options_of_surfaces() {
    let fork = fork();
    let tubes = |tubes: &Tubes| sound(tubes.mesh(&fork));
    bent!(NUMBERS, Tubes::default(), tubes, [with_turn, with_error, with_root_flare, with_tile]);
    bent!(COUNTS, Tubes::default(), tubes, [with_sides, with_least_sides]);
    let levels = |levels: &Levels| done(levels.of(&fork));
    bent!(NUMBERS, Levels::default(), levels, [with_error]);
    bent!(COUNTS, Levels::default(), levels, [with_count]);
    let implicit = |surface: &Implicit| sound(surface.mesh(&fork));
    let few = || Implicit::default().with_most_blocks(5_000);
    bent!(NUMBERS, few(), implicit, [with_voxel, with_detail, with_blend, with_error]);
    let skin = Skin::default().blob_tree(&fork).expect("a skin");
    let polygonizer = |surface: &Polygonizer| sound(surface.mesh(&skin));
    let few = || Polygonizer::default().with_most_blocks(5_000);
    bent!(NUMBERS, few(), polygonizer, [with_voxel, with_detail]);
    for blocks in [0, 1, 7, 100_000_000, 100_000_001, usize::MAX] {
        tried("with_most_blocks", blocks, || implicit(&Implicit::default().with_most_blocks(blocks)));
        tried("with_most_blocks", blocks, || {
            polygonizer(&Polygonizer::default().with_voxel(0.05).with_most_blocks(blocks))
        });
    }
    let skins = |skin: &Skin| {
        let solid = skin.blob_tree(&fork).map_err(|error| error.to_string())?;
        sound(Polygonizer::default().with_voxel(0.1).with_most_blocks(5_000).mesh(&solid))
    };
    bent!(
        NUMBERS,
        Skin::default(),
        skins,
        [
            with_age,
            with_blend,
            with_turn,
            with_bulge,
            with_scars,
            with_ridges,
            with_scar_years,
            with_ridge_years
        ]
    );
    let capsules = |capsules: &Capsules| done(capsules.of(&fork));
    bent!(NUMBERS, Capsules::default(), capsules, [with_tolerance, with_least_radius]);
    let closed = Implicit::default().mesh(&fork).expect("a surface");
    let unwrap = |unwrap: &Unwrap| {
        let mut mesh = closed.clone();
        done(unwrap.wrap(&mut mesh, &fork))
    };
    bent!(NUMBERS, Unwrap::default(), unwrap, [with_tile, with_least_radius]);
    for value in NUMBERS {
        tried("relaxed", value, || done(fork.relaxed(value, 3)));
        tried("Timeline", value, || {
            let line = Timeline::new(fork.clone(), value).map_err(|error| error.to_string())?;
            done(line.at(value * 0.5))
        });
        for (what, primitive) in [
            ("Primitive.radius", Primitive::point(Vec3::ZERO, value)),
            ("Primitive.at", Primitive::point(Vec3::splat(value), 1.0)),
            ("Primitive.strength", Primitive::point(Vec3::ZERO, 1.0).with_strength(value)),
        ] {
            tried(what, value, || {
                let mut parts = BlobTreeBuilder::default();
                let node = parts.add(primitive).map_err(|error| error.to_string())?;
                let solid = parts.finish(node).map_err(|error| error.to_string())?;
                sound(Polygonizer::default().with_detail(2.0).with_most_blocks(5_000).mesh(&solid))
            });
        }
    }
}

#[test]
fn options_of_leaves_and_years() {
    let fork = fork();
    let leaves = |foliage: &Foliage| {
        let leaves = foliage.place(&fork, 1).map_err(|error| error.to_string())?;
        let finite = leaves.instances.iter().all(|leaf| {
            leaf.position.is_finite()
                && leaf.rotation.is_finite()
                && leaf.scale > 0.0
                && leaf.scale.is_finite()
        });
        assert!(finite);
        Ok(())
    };
    let foliage = || Foliage::new(Leaf::ovate()).with_thickest(0.2);
    let few: Vec<f32> = NUMBERS.into_iter().filter(|x| !(1e-6..1e-3).contains(x)).collect();
    // A leaf every tenth of a millimetre is a second's work and no more.
    bent!(few.iter().copied(), foliage(), leaves, [with_spacing]);
    bent!(
        NUMBERS,
        foliage(),
        leaves,
        [
            with_size,
            with_size_at_tip,
            with_size_by_order,
            with_size_variation,
            with_reach,
            with_thickest,
            with_angle,
            with_rise,
            with_turn,
            with_disorder,
            with_kept,
            with_tint_variation,
        ]
    );
    let grown = |architecture: &Architecture| {
        let tree =
            Growth::with_most_nodes(architecture.clone(), 1, 3_000).map_err(|error| error.to_string())?;
        done(tree.at(f32::from(tree.years())))
    };
    let young = || Architecture::cottonwood().with_years(6);
    bent!(
        NUMBERS,
        young(),
        grown,
        [
            with_least_shoot,
            with_longest_branch,
            with_least_scale,
            with_divergence,
            with_forking,
            with_stoutness,
            with_twig_radius,
            with_variation,
            with_scale_variation,
            with_tropism,
        ]
    );
    for count in [0, 1, 2, 3, 40, u16::MAX] {
        tried("with_most_order", count, || grown(&young().with_most_order(count)));
        tried("with_whorl", count, || grown(&young().with_whorl(count)));
        tried("with_years", count, || grown(&Architecture::cottonwood().with_years(count)));
    }
}

#[test]
fn options_of_files() {
    let fork = fork();
    let mesh = Tubes::default().mesh(&fork).expect("tubes");
    let svg = |options: &SvgOptions| {
        let mut bytes = Vec::new();
        write_svg(&fork, options, &mut bytes).map_err(|error| error.to_string())?;
        let text = String::from_utf8(bytes).expect("text");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        Ok(())
    };
    bent!(NUMBERS, SvgOptions::default(), svg, [with_size, with_azimuth, with_elevation, with_thinnest]);
    let stl = |axes: &Axes| done(write_stl_with(&[Part::new(&mesh)], *axes, std::io::sink()));
    bent!(NUMBERS, Axes::default(), stl, [with_unit]);
}

#[cfg(feature = "preview")]
#[test]
fn options_of_pictures_and_assets() {
    use treesynth::asset::{AssetBuilder, Impostor};
    use treesynth::preview::{Camera, Preview, RayCaster};
    use treesynth::texture::Bark;
    let fork = fork();
    let mesh = Tubes::default().mesh(&fork).expect("tubes");
    let small = || Preview::default().with_size(24, 24);
    let drawn = |preview: &Preview| done(preview.draw(&mesh));
    bent!(NUMBERS, small(), drawn, [with_ground_height]);
    bent!(COUNTS, small(), drawn, [with_supersampling]);
    for count in [0, 1, 2, 16_385, u32::MAX] {
        tried("with_size", count, || drawn(&Preview::default().with_size(count, 3)));
        tried("with_size", count, || drawn(&Preview::default().with_size(3, count)));
    }
    let seen = |camera: &Camera| drawn(&small().with_camera(camera.clone()));
    bent!(NUMBERS, Camera::default(), seen, [with_azimuth, with_elevation, with_margin]);
    for cubes in [0, 1, 10, 1_000_000_001, usize::MAX] {
        let caster = RayCaster::new(small()).with_most_cubes(cubes);
        tried("with_most_cubes", cubes, || {
            done(caster.draw_implicit(&Implicit::default(), &fork, &[], &treesynth::Silent))
        });
    }
    let bark = |bark: &Bark| done(bark.bake());
    let oak = || Bark::oak().with_resolution(64);
    bent!(NUMBERS, oak(), bark, [with_size, with_depth, with_age, with_spread]);
    for count in [0, 1, 63, 64, u32::MAX] {
        tried("with_resolution", count, || bark(&Bark::oak().with_resolution(count)));
    }
    let asset = |builder: &AssetBuilder| done(builder.build(&fork, 1));
    let builder = || AssetBuilder::default().with_texture_size(128).with_triangles(Some(300));
    bent!(NUMBERS, builder(), asset, [with_bark_share, with_canopy_shade, with_bent_normals]);
    bent!(COUNTS, builder(), asset, [with_kinds]);
    for count in [0, 1, 100, 128, u32::MAX] {
        tried("with_texture_size", count, || asset(&builder().with_texture_size(count)));
        tried("with_triangles", count, || asset(&builder().with_triangles(Some(count as usize))));
        let parts = [Part::new(&mesh)];
        for (what, impostor) in [
            ("with_planes", Impostor::default().with_texture_size(128).with_planes(count)),
            ("with_grid", Impostor::default().with_texture_size(128).with_grid(count)),
            ("with_texture_size", Impostor::default().with_texture_size(count)),
        ] {
            tried(what, count, || done(impostor.billboards(&parts)));
            tried(what, count, || done(impostor.octahedral(&parts)));
        }
    }
}

/// A skeleton of so many nodes: where each is, which bears it, how thick it is.
fn made(
    nodes: usize,
    place: impl Fn(usize) -> Vec3,
    parent: impl Fn(usize) -> usize,
    radius: impl Fn(usize) -> f32,
) -> Skeleton {
    let parents = (0..nodes).map(|node| (node > 0).then(|| parent(node) as u32)).collect();
    Skeleton::new((0..nodes).map(place).collect(), parents)
        .and_then(|tree| tree.with_radii((0..nodes).map(radius).collect()))
        .expect("finite numbers")
}

/// Evenly over the unit ball's surface.
fn around(node: usize) -> Vec3 {
    let z = 1.0 - 2.0 * (node as f32 * 0.618_034).fract();
    let (sin, cos) = (node as f32 * 2.399_963).sin_cos();
    let across = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(cos * across, z, sin * across)
}

/// Names and skeletons that nobody means to make, the largest of `many` nodes.
fn odd(many: usize) -> Vec<(&'static str, Skeleton)> {
    let before = |node: usize| node - 1;
    let wound = |node: usize| {
        let (sin, cos) = (node as f32 * 0.01).sin_cos();
        Vec3::new(sin, node as f32 * 1e-3, cos)
    };
    let spread = |node: usize| around(node) + Vec3::Y * node as f32 * 0.01;
    let half = |node: usize| node / 2;
    let star = |node: usize| if node == 0 { Vec3::ZERO } else { around(node) };
    vec![
        ("a root alone", made(1, |_| Vec3::ZERO, before, |_| 0.1)),
        ("a root without thickness", made(1, |_| Vec3::ZERO, before, |_| 0.0)),
        ("all in one place", made(2_000, |_| Vec3::ONE, half, |_| 0.05)),
        ("a chain", made(many, wound, before, |_| 0.02)),
        ("a chain back and forth", made(2_000, |node| Vec3::X * (node % 2) as f32, before, |_| 0.05)),
        ("a star", made(many, star, |_| 0, |_| 0.002)),
        ("a thick star", made(many, star, |_| 0, |_| 0.05)),
        (
            "a comb",
            made(
                many,
                |node| Vec3::new((node % 2) as f32, (node / 2) as f32 * 1e-3, 0.0),
                |node| if node % 2 == 1 { node - 1 } else { node - 2 },
                |_| 0.001,
            ),
        ),
        ("all radii", made(900, spread, half, |node| 10f32.powf(node as f32 / 50.0 - 9.0))),
        ("thin", made(300, spread, half, |_| 1e-9)),
        ("thick", made(300, spread, half, |_| 1e9)),
        ("wide", made(300, |node| around(node) * 1e6, half, |_| 0.1)),
        ("tiny", made(300, |node| around(node) * 1e-30, half, |_| 1e-30)),
        ("subnormal", made(300, |node| around(node) * 1e-40, half, |_| 1e-40)),
        ("huge", made(300, |node| around(node) * 3e38, half, |_| f32::MAX)),
        ("far away", made(300, |node| spread(node) + Vec3::new(454_000.0, 0.0, 5_428_000.0), half, |_| 0.1)),
        ("of no thickness", made(300, spread, half, |_| 0.0)),
        ("now thick, now of no thickness", made(300, spread, half, |node| (node % 2) as f32 * 0.1)),
    ]
}

#[test]
fn odd_skeletons_through_every_surface() {
    for (name, tree) in &odd(1_000) {
        tried("Tubes", name, || sound(Tubes::default().with_wind(true).with_closed_base(true).mesh(tree)));
        tried("Tubes.within", name, || done(Tubes::default().within(tree, 1_000)));
        tried("Levels", name, || done(Levels::default().of(tree)));
        tried("Implicit", name, || sound(Implicit::default().with_most_blocks(10_000).mesh(tree)));
        tried("Skin", name, || {
            let solid = Skin::default().blob_tree(tree).map_err(|error| error.to_string())?;
            sound(Polygonizer::default().with_detail(1.0).with_most_blocks(10_000).mesh(&solid))
        });
        tried("Capsules", name, || done(Capsules::default().of(tree)));
        tried("Sway", name, || done(Sway::of(tree)));
    }
}

#[test]
fn tubes_of_gigabytes_are_refused_with_their_number() {
    let star = made(100_000, |node| around(node) * f32::from(node > 0), |_| 0, |_| 0.05);
    let error =
        Tubes::default().with_error(1e-6).mesh(&star).expect_err("more than memory should be asked for");
    assert!(
        matches!(error, SurfaceError::TooLarge { vertices: 150_000_001.., most: 150_000_000 }),
        "{error}"
    );
}

#[test]
fn odd_skeletons_through_every_measure() {
    let region = Cuboid::new(Vec3::splat(-3.0), Vec3::splat(3.0));
    for (name, tree) in &odd(100_000) {
        tried("Metrics", name, || {
            let metrics = Metrics::of(tree);
            assert!(!format!("{metrics:?}").is_empty());
            Ok(())
        });
        tried("relaxed", name, || done(tree.relaxed(0.5, 3)));
        tried("Timeline", name, || {
            let line = Timeline::new(tree.clone(), 30.0).map_err(|error| error.to_string())?;
            done(line.at(17.3))
        });
        tried("PipeModel", name, || done(PipeModel::default().radii(tree)));
        tried("Variational", name, || done(Variational::default().radii(tree)));
        tried("Taper", name, || done(Taper::new(PipeModel::default()).radii(tree)));
        tried("Foliage", name, || done(Foliage::new(Leaf::ovate()).with_spacing(1.0).place(tree, 1)));
        tried("AroundTree", name, || {
            let around = AroundTree::new(tree.clone(), Refinement::new(region, 0.5));
            let stage = Stage::new(Bend::none(), HopSurface::new(4, 30));
            done(TreeSynth::new(around).stage(stage).synthesize(1))
        });
    }
}

#[test]
fn odd_skeletons_through_every_exporter() {
    for (name, tree) in &odd(100_000) {
        tried("SVG", name, || done(write_svg(tree, &SvgOptions::default(), std::io::sink())));
        // Text of a hundred thousand branches takes long in tests.
        let tubes = Tubes::default().with_sides(3).with_least_sides(3);
        let mesh = if tree.len() > 10_000 {
            tubes.within(tree, 30_000).map(|level| level.mesh)
        } else {
            tubes.mesh(tree)
        };
        let Ok(mesh) = mesh else { continue };
        let parts = [Part::new(&mesh)];
        tried("GLB", name, || done(write_glb_parts(&parts, &GlbOptions::default(), std::io::sink())));
        tried("OBJ", name, || done(write_obj(&parts, "a.mtl", std::io::sink())));
        tried("PLY", name, || done(write_ply(&parts, PlyFormat::Ascii, std::io::sink())));
        tried("STL", name, || done(write_stl(&parts, std::io::sink())));
        tried("USDZ", name, || done(write_usdz(&UsdStage::of_parts(&parts), std::io::sink())));
    }
}

#[cfg(feature = "preview")]
#[test]
fn odd_skeletons_through_every_picture() {
    use treesynth::Silent;
    use treesynth::preview::{Preview, RayCaster};
    let small = Preview::default().with_size(24, 24);
    for (name, tree) in &odd(1_000) {
        tried("Preview", name, || {
            let level = Tubes::default().within(tree, 30_000).map_err(|error| error.to_string())?;
            done(small.draw(&level.mesh))
        });
        let caster = RayCaster::new(small.clone()).with_most_cubes(20_000);
        tried("RayCaster", name, || done(caster.draw_implicit(&Implicit::default(), tree, &[], &Silent)));
        tried("RayCaster of a skin", name, || {
            let solid = Skin::default().blob_tree(tree).map_err(|error| error.to_string())?;
            done(caster.draw(&solid, &[], &Silent))
        });
    }
}
