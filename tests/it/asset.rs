//! Guarantees of assets: their budget, cover and colour, levels that are nested, images that can be
//! worn.

use std::f32::consts::PI;
use treesynth::asset::{Asset, AssetBuilder, AssetError, Impostor, LeafImages, Likeness};
use treesynth::foliage::{Foliage, Leaf, Leaves};
use treesynth::glam::Vec3;
use treesynth::presets::{self, Preset, Season};
use treesynth::surface::{Instance, Part, SurfaceError, Sway, Tubes};
use treesynth::{Skeleton, texture::Textures};

fn tree(preset: &Preset, nodes: usize) -> Skeleton {
    let tree = preset.synth(nodes).synthesize(preset.seed).expect(preset.name);
    tree.relaxed(0.5, 3).expect("sound options")
}

fn foliage_of(preset: &Preset) -> Foliage {
    preset.foliage(Season::Summer).expect("in leaf")
}

/// Presets in leaf, every so manieth.
fn in_leaf(step: usize) -> impl Iterator<Item = (&'static Preset, Foliage)> {
    presets::guided().filter_map(|preset| Some((preset, preset.foliage(Season::Summer)?))).step_by(step)
}

fn small(preset: &Preset, foliage: Foliage) -> AssetBuilder {
    AssetBuilder::default()
        .with_bark(preset.bark())
        .with_foliage(foliage)
        .with_texture_size(256)
        .with_leaf_size(Some(32))
}

fn check(asset: &Asset, name: &str) {
    for part in asset.parts() {
        part.mesh().check().expect(name);
        if let Some(textures) = part.textures() {
            textures.check().expect(name);
            assert!(textures.base_color().is_some() && textures.transmission().is_some(), "{name}");
            let bumpy = textures.normal().is_some();
            assert_eq!(part.mesh().tangents.is_empty(), !bumpy, "{name}: tangents go with normals");
            assert!(
                part.mesh()
                    .uvs
                    .iter()
                    .all(|uv| uv.cmpge([0.0; 2].into()).all() && uv.cmple([1.0; 2].into()).all())
            );
        }
        assert!(part.copies().iter().all(|copy| copy.position.is_finite() && copy.scale.is_finite()));
    }
}

#[test]
fn budgets_are_always_kept() {
    for (preset, foliage) in in_leaf(7) {
        let tree = tree(preset, 2_000);
        let builder = small(preset, foliage);
        for triangles in [60, 301, 2_003, 40_000] {
            let asset = builder.clone().with_triangles(Some(triangles)).build(&tree, 1).expect(preset.name);
            let found = asset.triangles();
            assert!(found <= triangles, "{}: {found} of {triangles}", preset.name);
            assert!(asset.cards() > 0 || asset.leaves() > 0, "{} is bare at {triangles}", preset.name);
            // It is used, too, where there is more to show.
            assert!(found * 2 > triangles || triangles < 100, "{}: only {found} of {triangles}", preset.name);
            check(&asset, preset.name);
        }
    }
}

#[test]
fn no_budget_is_the_dense_model() {
    let (preset, foliage) = in_leaf(1).next().expect("a preset");
    let tree = tree(preset, 2_000);
    let leaves = foliage.place(&tree, 1).expect("leaves");
    let asset = small(preset, foliage).with_triangles(None).build(&tree, 1).expect("an asset");
    let bark = Tubes::default().mesh(&tree).expect("bark");
    assert_eq!((asset.leaves(), asset.cards()), (leaves.instances.len(), 0));
    // The same, in the crown's shade.
    assert_eq!((&asset.bark().positions, &asset.bark().indices), (&bark.positions, &bark.indices));
    let plain = small(preset, foliage_of(preset)).with_canopy_shade(0.0).with_triangles(None);
    assert_eq!(plain.build(&tree, 1).expect("an asset").bark(), &bark);
    assert_eq!(asset.triangles() as u64, bark.triangles().len() as u64 + leaves.part().triangles());
}

#[test]
fn levels_are_smaller_and_nested_and_look_alike() {
    // Cover and colour where a level's error is a pixel, and where the next level's is.
    let (mut worst, mut later, mut count) = ([0.0f32; 2], [0.0f32; 3], 0.0f32);
    for (preset, foliage) in in_leaf(11) {
        let tree = tree(preset, 4_000);
        // Bent normals are a matter of taste, not of likeness; and instances tell which twig they stand for.
        let builder = small(preset, foliage).with_bent_normals(0.0);
        let dense = builder.clone().with_triangles(None).build(&tree, 1).expect(preset.name);
        let height = dense.bark().bounds().expect("bark").size().y;
        let levels = builder.with_texture_size(512).levels(&tree, 1, &[1.0, 0.3, 0.08]).expect(preset.name);
        assert_eq!(levels.len(), 3, "{}", preset.name);
        let pixels: Vec<f32> = levels.iter().map(|level| level.pixels(height)).collect();
        // Each level is shown for some sizes, and none where the next one's error is over a pixel of 1080 lines.
        let coverages = Asset::screen_coverages(&levels, height);
        assert_eq!((coverages.len(), coverages[2]), (3, 0.0), "{}", preset.name);
        assert!(coverages[0] <= 1.0 && coverages[1] <= 0.7 * coverages[0], "{}: {coverages:?}", preset.name);
        for (covered, next) in coverages.iter().zip(&pixels[1..]) {
            assert!(covered * 1080.0 <= next * 1.0001, "{}: {coverages:?}", preset.name);
        }
        assert!(Asset::screen_coverages(&levels[..1], height).is_empty());
        for (i, (level, share)) in levels.iter().zip([1.0, 0.3, 0.08]).enumerate() {
            assert!(level.triangles() <= (share * 10_000.0) as usize, "{}", preset.name);
            check(level, preset.name);
            let bumpy = level.card_textures().is_some_and(|cards| cards.normal().is_some());
            assert_eq!(bumpy, i == 0, "{}, level {i}: a normal map", preset.name);
            let like = |pixels: f32| {
                let pixels = pixels.clamp(8.0, 400.0) as u32;
                let like = Likeness::of(&level.parts(), &dense.parts(), pixels).expect(preset.name);
                println!("{} {} triangles at {pixels} pixels: {like:?}", preset.name, level.triangles());
                (like.cover.abs(), like.color)
            };
            let (cover, color) = like(pixels[i]);
            worst = [worst[0].max(cover), worst[1].max(color)];
            if let Some(&next) = pixels.get(i + 1) {
                let (cover, color) = like(next);
                later = [later[0].max(cover), later[1].max(color), later[2] + cover];
                count += 1.0;
            }
        }
        for pair in levels.windows(2) {
            assert!(pair[1].triangles() < pair[0].triangles() && pair[1].error() >= pair[0].error());
            assert!(pair[1].cards() < pair[0].cards() + pair[0].leaves());
            // A card stands where one of the finer level's stands.
            let nodes = |asset: &Asset| -> Vec<u32> {
                let parts = asset.parts();
                let copies = parts.iter().filter(|part| part.name() == "cards").flat_map(Part::copies);
                let mut nodes: Vec<u32> = copies.map(|copy| copy.node).collect();
                nodes.sort_unstable();
                nodes
            };
            let (finer, coarser) = (nodes(&pair[0]), nodes(&pair[1]));
            if pair[0].leaves() == 0 {
                let lost = coarser.iter().filter(|node| !bears(&tree, **node, &finer)).count();
                assert_eq!(lost, 0, "{}: cards that stand for none of the finer level's", preset.name);
            }
        }
    }
    assert!(worst[0] < 0.03 && worst[1] < 2.0, "cover and colour are off by {worst:?}");
    // The sparsest crown is thin when the next level comes; most keep their cover all the way.
    let [most, color, sum] = later;
    let off = (most, color, sum / count);
    assert!(
        off.0 < 0.3 && off.1 < 3.2 && off.2 < 0.06,
        "before the next level comes, they are off by {off:?}"
    );
}

#[test]
fn bare_trees_keep_their_twigs() {
    let (mut worst, mut with_cards) = ([0.0f32; 2], 0);
    for preset in presets::guided().step_by(9) {
        let tree = tree(preset, 6_000);
        let builder = AssetBuilder::default().with_bark(preset.bark()).with_texture_size(512);
        let dense = builder.clone().with_triangles(None).build(&tree, 1).expect(preset.name);
        assert_eq!(dense.cards(), 0);
        let height = dense.bark().bounds().expect("bark").size().y;
        for triangles in [1_500, 5_000] {
            let asset = builder.clone().with_triangles(Some(triangles)).build(&tree, 1).expect(preset.name);
            let found = asset.triangles();
            assert!(found <= triangles && 2 * found > triangles, "{}: {found} of {triangles}", preset.name);
            check(&asset, preset.name);
            with_cards += usize::from(asset.cards() > 0);
            let pixels = asset.pixels(height).clamp(8.0, 240.0) as u32;
            let like = Likeness::of(&asset.parts(), &dense.parts(), pixels).expect(preset.name);
            println!(
                "{} {found} triangles, {} cards at {pixels} pixels: {like:?}",
                preset.name,
                asset.cards()
            );
            worst = [worst[0].max(like.cover.abs()), worst[1].max(like.color)];
        }
    }
    assert!(with_cards > 4, "{with_cards}");
    // Bark within a budget is a little thicker than what it stands for, and cards cannot make up for all of it.
    assert!(worst[0] < 0.05 && worst[1] < 2.0, "cover and colour are off by {worst:?}");
}

/// `true` if one of these nodes is `node` or above it.
fn bears(tree: &Skeleton, node: u32, nodes: &[u32]) -> bool {
    nodes.iter().any(|&other| {
        let mut at = Some(other as usize);
        while let Some(here) = at.filter(|here| *here > node as usize) {
            at = tree.parent(here);
        }
        at == Some(node as usize)
    })
}

#[test]
fn impostors_hide_as_much_as_the_tree() {
    let (preset, foliage) = in_leaf(1).nth(3).expect("a preset");
    let tree = tree(preset, 4_000);
    let dense = small(preset, foliage).with_triangles(None).build(&tree, 1).expect("an asset");
    let far =
        Impostor::default().with_texture_size(256).with_lying(true).billboards(&dense.parts()).expect("far");
    assert_eq!(far.triangles(), 16);
    check(&far, "impostor");
    let like = Likeness::of(&far.parts(), &dense.parts(), 64).expect("both are seen");
    assert!(like.cover.abs() < 0.1 && like.color < 4.0, "{like:?}");
    let all_around = Impostor::default().with_texture_size(256).octahedral(&dense.parts()).expect("views");
    assert_eq!(
        (all_around.color.width(), all_around.normal.width(), all_around.depth.channels()),
        (256, 256, 1)
    );
    let json: serde_json::Value = serde_json::from_str(&all_around.json()).expect("JSON");
    assert_eq!(json["grid"], 8);
    assert!((json["radius"].as_f64().expect("a number") - f64::from(all_around.radius)).abs() < 1e-4);
    // Something is seen from everywhere.
    for cell in 0..64 {
        let pixels = (0..32 * 32).map(|i| (cell % 8 * 32 + i % 32, cell / 8 * 32 + i / 32));
        let covered = pixels.filter(|(x, y)| all_around.color.pixel(*x, *y)[3] > 0).count();
        assert!(covered > 50, "view {cell} is empty");
    }
}

/// An impostor's upper edge moves as far as the upper tenth of the model that it stands for, on the average of a period; its lower
/// edge stays.
#[test]
fn impostors_lean_with_the_tree() {
    for (preset, foliage) in in_leaf(7) {
        let tree = tree(preset, 2_000);
        let sway = Sway::of(&tree).expect(preset.name);
        let model = small(preset, foliage).with_triangles(Some(4_000)).build(&tree, 1).expect(preset.name);
        let far = Impostor::default().with_texture_size(128).billboards(&model.parts()).expect(preset.name);
        let (model, far) = (model.in_wind(&sway).expect(preset.name), far.in_wind(&sway).expect(preset.name));
        let ups = || tree.positions().iter().map(|place| place.y);
        let top = ups().fold(f32::NEG_INFINITY, f32::max);
        let height = top - ups().fold(f32::INFINITY, f32::min);
        let moved = |asset: &Asset, heights: std::ops::Range<f32>| -> f32 {
            let parts = asset.parts();
            let meshes = parts.iter().map(Part::mesh);
            let vertices = meshes.flat_map(|mesh| mesh.positions.iter().zip(&mesh.wind));
            let within = vertices.filter(|(place, _)| heights.contains(&((top - place.y) / height)));
            let ways: Vec<f32> = within
                .flat_map(|(&place, wind)| {
                    (0..16).map(move |i| wind.blown(place, 0.5 * i as f32, Vec3::X) - place)
                })
                .map(|way| way.x)
                .collect();
            assert!(!ways.is_empty(), "{}: {heights:?}", preset.name);
            ways.iter().sum::<f32>() / ways.len() as f32
        };
        let (crown, edge) = (moved(&model, -0.2..0.1), moved(&far, -0.2..0.1));
        assert!((0.3..1.2).contains(&(edge / crown)), "{}: {edge} m for {crown} m", preset.name);
        assert!(moved(&far, 0.9..1.3).abs() < 0.02 * edge, "{}", preset.name);
    }
}

#[test]
fn crowns_are_round_and_dark_inside() {
    let preset = presets::by_name("fine-oak").expect("a preset").guided().expect("guided");
    let tree = tree(preset, 8_000);
    let builder = small(preset, foliage_of(preset)).with_triangles(Some(6_000));
    let asset = builder.build(&tree, 1).expect("an asset");
    let plain =
        builder.clone().with_bent_normals(0.0).with_canopy_shade(0.0).build(&tree, 1).expect("an asset");
    let (parts, flat) = (asset.parts(), plain.parts());
    assert_eq!((asset.leaves(), asset.cards()), (plain.leaves(), plain.cards()));
    let names = |parts: &[Part<'_>]| parts.iter().map(|part| part.name().to_owned()).collect::<Vec<_>>();
    assert_eq!(names(&parts), names(&flat));
    let crown = parts.iter().filter(|part| part.name() != "bark");
    let points: Vec<(Vec3, Vec3, f32)> = crown
        .flat_map(|part| {
            assert!(part.instances().is_none() && part.mesh().colors.len() == part.mesh().positions.len());
            let mesh = part.mesh();
            (0..mesh.positions.len()).map(|i| (mesh.positions[i], mesh.normals[i], mesh.colors[i][1]))
        })
        .collect();
    let middle = points.iter().map(|point| point.0).sum::<Vec3>() / points.len() as f32;
    let reach = points.iter().map(|point| point.0.distance(middle)).fold(0.0, f32::max);
    let mean = |keep: &dyn Fn(f32) -> bool| {
        let kept: Vec<f32> =
            points.iter().filter(|p| keep(p.0.distance(middle) / reach)).map(|p| p.2).collect();
        kept.iter().sum::<f32>() / kept.len() as f32
    };
    let (inside, outside) = (mean(&|at| at < 0.35), mean(&|at| at > 0.8));
    assert!(inside < 0.93 * outside && inside > 0.3, "{inside} inside, {outside} outside");
    // Normals look away from the crown's middle, or from the other side of the leaf straight to it.
    let outward = |points: &mut dyn Iterator<Item = (Vec3, Vec3)>| {
        let (sum, count) = points.fold((0.0, 0), |(sum, count), (position, normal)| {
            (sum + (position - middle).normalize_or_zero().dot(normal).abs(), count + 1)
        });
        sum / count as f32
    };
    let bent = outward(&mut points.iter().map(|point| (point.0, point.1)));
    let before = outward(&mut flat.iter().filter(|part| part.name() != "bark").flat_map(|part| {
        let mesh = part.mesh();
        part.copies().iter().flat_map(move |copy| {
            let placed = move |i: usize| {
                (copy.matrix() * mesh.positions[i] + copy.position, copy.rotation_matrix() * mesh.normals[i])
            };
            (0..mesh.positions.len()).map(placed)
        })
    }));
    assert!(bent > before + 0.1, "{bent} bent, {before} before");
    // Bark is darker under leaves, too; colours are in steps that files have.
    let all = parts.iter().flat_map(|part| &part.mesh().colors).flatten();
    assert!(all.clone().all(|c| (c * 255.0 - (c * 255.0).round()).abs() < 1e-3) && all.count() > 0);
    let bark = &asset.bark().colors;
    assert!(bark.iter().any(|color| color[0] < 0.9) && plain.bark().colors.is_empty());
}

#[test]
fn light_from_the_right_comes_from_the_right_on_both_sides_of_a_billboard() {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..=16u32 {
        for column in 0..32u32 {
            let (up, around) = (row as f32 / 16.0 * PI, column as f32 / 16.0 * PI);
            let normal = Vec3::new(up.sin() * around.cos(), up.cos(), up.sin() * around.sin());
            normals.push(normal);
            positions.push(Vec3::Y + normal);
            if row < 16 {
                let (a, b) = (row * 32 + column, row * 32 + (column + 1) % 32);
                indices.extend([a, b, a + 32, b, b + 32, a + 32]);
            }
        }
    }
    let mesh = treesynth::surface::Mesh::new(positions, normals, indices);
    let parts = [Part::new(&mesh)];
    let far = Impostor::default().with_planes(1).with_texture_size(128).billboards(&parts).expect("seen");
    for yaw in [0.0, PI] {
        for parts in [&parts[..], &far.parts()] {
            let image = treesynth::asset::portrait(parts, yaw, 0.0, 64).expect("seen");
            let mut halves = [0u32; 2];
            for y in 0..image.height() {
                for x in 0..image.width() {
                    let red = u32::from(image.pixel(x, y)[0]);
                    halves[usize::from(2 * x >= image.width())] += if red < 255 { red } else { 0 };
                }
            }
            assert!(halves[1] * 10 > halves[0] * 11, "from {yaw}: {halves:?}");
        }
    }
}

#[test]
fn the_same_at_every_thread_count() {
    let (preset, foliage) = in_leaf(1).next().expect("a preset");
    let tree = tree(preset, 2_000);
    let builder = small(preset, foliage.with_tint_variation(0.3)).with_triangles(Some(1_500));
    let made = |threads| {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        pool.install(|| {
            let asset = builder.build(&tree, 1).expect("an asset");
            let far = Impostor::default().with_texture_size(128).with_grid(2).octahedral(&asset.parts());
            (asset, far.expect("views"))
        })
    };
    let one = made(1);
    assert!(made(2) == one && made(5) == one);
}

#[test]
fn bad_input_is_named_or_does_what_it_can() {
    let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).expect("sound");
    let thick = pole.clone().with_radii(vec![0.05; 2]).expect("sound");
    let oak = || Foliage::new(Leaf::sinuate()).with_thickest(0.1);
    let builder = AssetBuilder::default().with_texture_size(128).with_leaf_size(Some(32));
    // A tree without leaves has bark only, within the budget.
    let bare = builder.clone().with_triangles(Some(40)).build(&thick, 1).expect("bark");
    assert!(bare.cards() == 0 && bare.leaves() == 0 && (1..=40).contains(&bare.triangles()));
    // Too small for the trunk: the least that would do, does.
    let tiny =
        |triangles, builder: &AssetBuilder| builder.clone().with_triangles(Some(triangles)).build(&thick, 1);
    let leafy = builder.clone().with_foliage(oak());
    for builder in [&builder, &leafy] {
        let Err(AssetError::TooFewTriangles { least, .. }) = tiny(2, builder) else {
            panic!("no trunk has 2 triangles")
        };
        assert!(tiny(least - 1, builder).is_err());
        assert!(tiny(least, builder).expect("the least").triangles() <= least);
    }
    // Nor has a card, where there is no bark.
    let bald = oak().place(&thick, 1).expect("leaves");
    for few in 0..4 {
        let error = builder.clone().with_triangles(Some(few)).build_with(&pole, std::slice::from_ref(&bald));
        let Err(AssetError::TooFewTriangles { triangles, least: 4 }) = error else { panic!("{error:?}") };
        assert_eq!(triangles, few);
        let error = tiny(few, &builder).expect_err("no bark").to_string();
        assert!(error.contains("too small"), "{error}");
    }
    builder.clone().with_triangles(Some(4)).build_with(&pole, &[bald]).expect("a card");
    assert!(matches!(Tubes::default().within(&thick, 2), Err(SurfaceError::TooFewTriangles { .. })));
    // Radii of zero: no bark and no foliage, but leaves of one's own.
    assert!(builder.build(&pole, 1).is_err() && leafy.build(&pole, 1).is_err());
    let mut one: Leaves = oak().place(&thick, 1).expect("leaves");
    one.instances.truncate(1);
    let crown = builder
        .clone()
        .with_triangles(Some(1_000))
        .build_with(&pole, std::slice::from_ref(&one))
        .expect("one leaf");
    assert_eq!((crown.leaves(), crown.triangles()), (1, 20));
    let card = builder
        .clone()
        .with_triangles(Some(19))
        .build_with(&pole, std::slice::from_ref(&one))
        .expect("one card");
    assert_eq!((card.cards(), card.triangles()), (1, 4));
    check(&card, "a crown of one leaf");
    one.instances[0] = Instance { node: 7, ..one.instances[0] };
    let error = builder.build_with(&thick, &[one]).expect_err("no such node").to_string();
    assert!(error.contains("Instance.node"), "{error}");
    for side in [0, 1, 100, 64, 16_384] {
        let error = builder.clone().with_texture_size(side).build(&thick, 1).expect_err("a side").to_string();
        assert!(error.contains("texture_size") && error.contains("power of two"), "{error}");
        assert!(Impostor::default().with_texture_size(side).billboards(&bare.parts()).is_err());
    }
    for wrong in [
        builder.clone().with_kinds(0),
        builder.clone().with_kinds(17),
        builder.clone().with_bark_share(f32::NAN),
        builder.clone().with_canopy_shade(1.1),
        builder.clone().with_bent_normals(f32::NAN),
        builder.clone().with_bark_textures(Textures::default().with_alpha_cutoff(2.0)),
        leafy.clone().with_leaf_size(Some(33)),
        builder.clone().with_foliage(oak().with_tint_variation(1.0)),
    ] {
        let error = wrong.build(&thick, 1).expect_err("out of range").to_string();
        assert!(error.contains("must be"), "{error}");
    }
    for shares in [&[][..], &[0.0], &[0.3, 0.3], &[1.1], &[f32::NAN]] {
        assert!(matches!(builder.levels(&thick, 1, shares), Err(AssetError::Parameter(_))), "{shares:?}");
    }
    assert!(matches!(Likeness::of(&[], &[], 64), Err(AssetError::Nothing)));
    assert!(matches!(Impostor::default().octahedral(&[]), Err(AssetError::Nothing)));
    assert!(
        LeafImages::of(&Leaf::ovate(), 0, 64, 1).is_err()
            && LeafImages::of(&Leaf::ovate(), 1, 48, 1).is_err()
    );
}
