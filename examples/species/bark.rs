//! Sheets of barks as one sees them from two metres: an old trunk and young wood of each species, and trunks of whole assets.

use crate::common::Failure;
use rayon::prelude::*;
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview, Projection};
use treesynth::shape::Bounds;
use treesynth::species::{self, Species};
use treesynth::surface::{Material, Mesh, Part, Tubes};
use treesynth::texture::BarkSet;

/// Pixels along the sides of a picture, and below it for the name.
const SIDE: u32 = 320;
const LABEL: u32 = 22;
/// Species in a row.
const ROW: u32 = 5;
/// Pixels along the side of a bark's images.
const TEXELS: u32 = 1024;
/// Metres across that are seen: two metres away, through a lens of 28°.
const SEEN: f32 = 1.0;
/// Radius of the trunk, and of the young wood beside it, metres.
const RADII: [f32; 2] = [0.27, 0.035];
/// Middles of both, metres from the middle of the picture to the right and towards the viewer: neither is in the other's shadow.
const PLACES: [[f32; 2]; 2] = [[-0.13, 0.0], [0.34, 0.4]];
/// Part of the sun's light that is left, so that white bark is not whiter than paper.
const EXPOSURE: f32 = 0.6;

/// All species, or one of them.
pub(crate) fn sheet(seed: u64, only: Option<&Species>) -> Result<Picture, Failure> {
    let all = only.map_or(species::all(), std::slice::from_ref);
    let cells: Result<Vec<Picture>, String> = all
        .par_iter()
        .map(|species| cell(species, seed).map_err(|error| format!("{}: {error}", species.name)))
        .collect();
    let cells = cells?;
    Ok(Picture::sheet(&cells, ROW.min(cells.len() as u32), 2, [255; 3])?)
}

fn cell(species: &Species, seed: u64) -> Result<Picture, Failure> {
    let bark = species.bark.texture(0.9).with_seed(seed).with_resolution(TEXELS);
    let sets =
        [bark.bake()?, species.bark.young_texture().with_seed(seed).with_resolution(TEXELS / 2).bake()?];
    let poles = [pole(PLACES[0], RADII[0], &sets[0])?, pole(PLACES[1], RADII[1], &sets[1])?];
    let material = Material::white().with_color([EXPOSURE; 3]).with_roughness(1.0);
    let parts = [0, 1].map(|i| Part::new(&poles[i]).with_material(material).with_textures(&sets[i].textures));
    let half = Vec3::new(0.5 * SEEN, 0.5 * SEEN, 0.3);
    let middle = Vec3::Y * 1.3;
    let camera = Camera::default()
        .with_elevation(0.0)
        .with_azimuth(0.0)
        .with_projection(Projection::Orthographic)
        .with_margin(0.0)
        .with_frame(Bounds::new(middle - half, middle + half));
    let backdrop = [0.62, 0.66, 0.68];
    let preview = Preview::default()
        .with_size(SIDE, SIDE)
        .with_camera(camera)
        .with_ground(false)
        .with_background(backdrop, backdrop)
        .with_supersampling(2)
        .with_sun(Vec3::new(-0.75, 0.55, 0.65));
    let mut cell = Picture::new(SIDE, SIDE + LABEL, [255; 3])?;
    cell.blit(&preview.draw_parts(&parts)?, 0, 0);
    let at = SIDE.saturating_sub(Picture::label_width(&species.name, 2)) / 2;
    cell.label(&species.name, at as i32, SIDE as i32 + 4, 2, [40; 3]);
    Ok(cell)
}

/// Species whose barks differ the most.
const TRUNKS: [&str; 6] =
    ["English oak", "silver birch", "Scots pine", "London plane", "cherry", "eucalyptus"];

/// The trunks of some species, with their feet, as assets of 20,000 triangles have them.
pub(crate) fn trunks(seed: u64, only: Option<&Species>) -> Result<Picture, Failure> {
    let draw = |name: &str| -> Result<Picture, Failure> {
        let species = species::by_name(name)?;
        let tree = species.request().with_seed(seed).with_day(30.0).with_dbh(0.4).grow()?;
        let levels = tree.levels(Some(20_000), TEXELS, &[1.0])?;
        let (half, middle) = (Vec3::new(0.8, 0.95, 0.8), Vec3::Y * 0.85);
        let camera = Camera::default()
            .with_elevation(0.05)
            .with_margin(0.0)
            .with_frame(Bounds::new(middle - half, middle + half));
        let preview = Preview::default().with_size(2 * SIDE, 2 * SIDE).with_camera(camera);
        let preview = preview.with_background([0.74, 0.82, 0.9], [0.86, 0.88, 0.86]).with_supersampling(2);
        let mut picture = preview.with_sun(Vec3::new(-0.75, 0.55, 0.65)).draw_parts(&levels[0].parts())?;
        picture.label(&species.name, 6, 6, 2, [20; 3]);
        Ok(picture)
    };
    let names = only.map_or(TRUNKS.to_vec(), |species| vec![species.name.as_str()]);
    let cells: Result<Vec<Picture>, String> =
        names.par_iter().map(|name| draw(name).map_err(|error| format!("{name}: {error}"))).collect();
    let cells = cells?;
    Ok(Picture::sheet(&cells, 3.min(cells.len() as u32), 2, [255; 3])?)
}

/// An upright pole of 2.6 m.
fn pole([x, z]: [f32; 2], radius: f32, set: &BarkSet) -> Result<Mesh, Failure> {
    let points = (0..=13).map(|i| Vec3::new(x, 0.2 * i as f32, z)).collect();
    let parents = (0..=13u32).map(|i| i.checked_sub(1)).collect();
    let skeleton = Skeleton::new(points, parents)?.with_radii(vec![radius; 14])?;
    let tubes = Tubes::default().with_sides(64).with_least_sides(32).with_root_flare(0.0);
    Ok(tubes.with_tile(set.size).with_square_tiles(true).mesh(&skeleton)?)
}
