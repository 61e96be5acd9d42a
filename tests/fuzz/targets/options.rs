//! Builders with options of any value: an error that names one, or something sound.

use super::Target;
use super::numbers::Numbers;
use treesynth::foliage::{Foliage, Leaf};
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Preview};
use treesynth::radius::{PipeModel, Taper, Variational};
use treesynth::surface::blob::Skin;
use treesynth::surface::{Capsules, Implicit, Levels, Mask, Mesh, Polygonizer, Tubes, Unwrap};
use treesynth::texture::{Bark, BarkKind};
use treesynth::{RadiusModel, Skeleton};

/// Sets some of the options of a builder.
macro_rules! some_of {
    ($numbers:ident, $builder:expr, $($set:ident($($take:ident),*)),* $(,)?) => {{
        let mut builder = $builder;
        $(if $numbers.is_set() { builder = builder.$set($($numbers.$take()),*); })*
        builder
    }};
}
pub(super) use some_of;

pub(super) fn all() -> Vec<Target> {
    let target = |name, run| Target { name, seeds: seeds(96), run };
    vec![
        target("tubes", tubes),
        target("implicit", implicit),
        target("skin", skin),
        target("leaves", leaves),
        target("bark", bark),
        target("picture", picture),
        target("radii", radii),
    ]
}

/// So many bytes, in which a few options are set.
pub(super) fn seeds(length: usize) -> Vec<Vec<u8>> {
    let mut state = 1u32;
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..8).map(|_| (0..length).map(|_| byte()).collect()).collect()
}

/// A small tree: a fork, or a few nodes at odd places with odd radii.
pub(super) fn tree(numbers: &mut Numbers<'_>) -> Option<Skeleton> {
    if numbers.byte() < 128 {
        return Some(super::saved::fork());
    }
    let count = 2 + usize::from(numbers.byte() % 10);
    let place = |numbers: &mut Numbers<'_>| Vec3::new(numbers.float(), numbers.float(), numbers.float());
    let places = (0..count).map(|_| place(numbers)).collect();
    let parents =
        (0..count).map(|node| node.checked_sub(1).map(|last| u32::from(numbers.byte()) % (last as u32 + 1)));
    let tree = Skeleton::new(places, parents.collect()).ok()?;
    let radii = (0..count).map(|_| numbers.float()).collect();
    tree.with_radii(radii).ok()
}

fn is_sound(mesh: &Mesh) {
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|vector| vector.is_finite()));
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
    assert!(mesh.indices.iter().all(|&index| (index as usize) < mesh.positions.len()));
}

fn any_tubes(n: &mut Numbers<'_>) -> Tubes {
    some_of!(
        n,
        Tubes::default(),
        with_sides(count),
        with_least_sides(count),
        with_turn(float),
        with_error(float),
        with_root_flare(float),
        with_collars(is_set),
        with_closed_base(is_set),
        with_tile(float),
        with_square_tiles(is_set),
        with_even_texels(is_set),
        with_wind(is_set),
    )
}

fn tubes(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let tubes = any_tubes(&mut n);
    let levels =
        some_of!(n, Levels::default().with_tubes(tubes.clone()), with_count(count), with_error(float));
    let Some(tree) = tree(&mut n) else { return false };
    let mesh = tubes.mesh(&tree);
    if let Ok(mesh) = &mesh {
        is_sound(mesh);
        let mask = some_of!(n, Mask::snow(), with_patches(float, float));
        assert!(mask.values(mesh).iter().all(|value| (0.0..=1.0).contains(value)));
        let mut worn = mesh.clone();
        let unwrap = some_of!(n, Unwrap::default(), with_tile(float), with_least_radius(float));
        if unwrap.wrap(&mut worn, &tree).is_ok() {
            is_sound(&worn);
        }
    }
    if let Ok(levels) = levels.of(&tree) {
        for level in &levels {
            is_sound(&level.mesh);
        }
    }
    if let Ok(level) = tubes.within(&tree, n.count() as usize) {
        is_sound(&level.mesh);
    }
    let capsules = some_of!(n, Capsules::default(), with_tolerance(float), with_least_radius(float));
    let _ = capsules.of(&tree);
    mesh.is_ok()
}

fn implicit(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let surface = some_of!(
        n,
        Implicit::default().with_most_blocks(200),
        with_voxel(float),
        with_detail(float),
        with_blend(float),
        with_error(float),
        with_wind(is_set),
    );
    let Some(tree) = tree(&mut n) else { return false };
    let Ok(mesh) = surface.mesh(&tree) else { return false };
    is_sound(&mesh);
    true
}

fn skin(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let skin = some_of!(
        n,
        Skin::default(),
        with_age(float),
        with_blend(float),
        with_turn(float),
        with_bulge(float),
        with_scars(float),
        with_ridges(float),
        with_scar_years(float),
        with_ridge_years(float),
    );
    let polygonizer = some_of!(
        n,
        Polygonizer::default().with_most_blocks(200),
        with_voxel(float),
        with_detail(float),
        with_colors(is_set)
    );
    let Some(tree) = tree(&mut n) else { return false };
    let Ok(solid) = skin.blob_tree(&tree) else { return false };
    let Ok(mesh) = polygonizer.mesh(&solid) else { return false };
    is_sound(&mesh);
    true
}

fn leaves(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let foliage = some_of!(
        n,
        Foliage::new(Leaf::ovate()),
        with_spacing(float),
        with_size(float),
        with_size_at_tip(float),
        with_size_by_order(float),
        with_size_variation(float),
        with_reach(float),
        with_thickest(float),
        with_angle(float),
        with_rise(float),
        with_turn(float),
        with_disorder(float),
        with_kept(float),
        with_tint_variation(float),
    );
    let Some(tree) = tree(&mut n) else { return false };
    let Ok(leaves) = foliage.place(&tree, 1) else { return false };
    for leaf in &leaves.instances {
        assert!(leaf.position.is_finite() && leaf.rotation.is_finite() && leaf.scale.is_finite());
    }
    true
}

fn bark(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let kind = BarkKind::ALL[usize::from(n.byte()) % BarkKind::ALL.len()];
    let bark = some_of!(
        n,
        Bark::of_kind(kind).with_resolution(16),
        with_size(float),
        with_depth(float),
        with_age(float),
        with_spread(float),
    );
    bark.bake().is_ok()
}

fn picture(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let camera =
        some_of!(n, Camera::default(), with_azimuth(float), with_elevation(float), with_margin(float));
    let preview = some_of!(
        n,
        Preview::default().with_size(16, 16).with_camera(camera),
        with_supersampling(count),
        with_ground(is_set),
        with_ground_height(float),
        with_transparency(is_set),
    );
    let preview =
        if n.is_set() { preview.with_sun(Vec3::new(n.float(), n.float(), n.float())) } else { preview };
    let Some(tree) = tree(&mut n) else { return false };
    let Ok(mesh) = Tubes::default().mesh(&tree) else { return false };
    preview.draw(&mesh).is_ok()
}

fn radii(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let pipe = some_of!(
        n,
        PipeModel::default(),
        with_exponent(float),
        with_tip_diameter(float),
        with_trunk_diameter(float)
    );
    let taper = some_of!(n, Taper::new(pipe), with_fraction(float), with_tip_fraction(float));
    let varied = some_of!(
        n,
        Variational::uniform(n.float()),
        with_exponent(float),
        with_minimum_share(float),
        with_trunk_diameter(float),
    );
    let Some(tree) = tree(&mut n) else { return false };
    let models: [&dyn RadiusModel; 3] = [&pipe, &taper, &varied];
    let mut all = true;
    for model in models {
        match model.radii(&tree) {
            Ok(radii) => assert!(tree.clone().with_radii(radii).is_ok()),
            Err(_) => all = false,
        }
    }
    all
}
