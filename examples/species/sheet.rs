//! All species at one scale.

use crate::common::Failure;
use rayon::prelude::*;
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview, Projection};
use treesynth::shape::Bounds;
use treesynth::species::{self, Species, Specimen};
use treesynth::surface::{Instance, Material, Mesh, Part, Tubes};

/// Metres of a cell across, of sky above the tallest tree of a row, and pixels per metre.
const WIDTH: f32 = 17.0;
const SKY: f32 = 1.0;
const SCALE: f32 = 16.0;
/// Pixels under each tree for its name.
const LABEL: u32 = 22;
/// Trees in a row, each bare and in leaf.
const ROW: usize = 5;

/// Somebody of 1.8 m, as a row of tubes.
fn person() -> Result<Mesh, Failure> {
    let outline = [
        (0.0, 0.1),
        (0.85, 0.16),
        (1.1, 0.15),
        (1.42, 0.21),
        (1.5, 0.07),
        (1.56, 0.08),
        (1.68, 0.11),
        (1.8, 0.04),
    ];
    let positions = outline.iter().map(|(y, _)| Vec3::new(0.0, *y, 0.0)).collect();
    let parents = (0..outline.len() as u32).map(|node| node.checked_sub(1)).collect();
    let radii = outline.iter().map(|(_, radius)| *radius).collect();
    let body = Skeleton::new(positions, parents)?.with_radii(radii)?;
    Ok(Tubes::default().with_root_flare(0.0).mesh(&body)?)
}

/// All species at one scale, each bare and in leaf.
pub(crate) fn draw(seed: u64) -> Result<Picture, Failure> {
    sheet(seed, |_| 196.0, true)
}

/// All species at one scale, each when most of its leaves have turned.
pub(crate) fn autumn(seed: u64) -> Result<Picture, Failure> {
    sheet(seed, |species| if species.leaves.evergreen { 285.0 } else { autumn_day(species) }, false)
}

fn autumn_day(species: &Species) -> f32 {
    let [_, _, turn, fall] = species.leaves.days;
    (turn + 0.48 * (fall - turn)).floor()
}

fn sheet(seed: u64, day: impl Fn(&Species) -> f32 + Sync, bare: bool) -> Result<Picture, Failure> {
    let person = person()?;
    let cell = |species: &Species, tree: &Specimen, height: f32| -> Result<Picture, Failure> {
        let corner = Vec3::new(WIDTH / 2.0, height, 0.5);
        let camera = Camera::default()
            .with_elevation(0.0)
            .with_projection(Projection::Orthographic)
            .with_margin(0.0)
            .with_frame(Bounds::new(corner * Vec3::new(-1.0, 0.0, -1.0), corner));
        let pixels = [WIDTH, height].map(|metres| (metres * SCALE) as u32);
        let preview = Preview::default()
            .with_size(pixels[0], pixels[1])
            .with_camera(camera)
            .with_background([0.74, 0.82, 0.9], [0.9, 0.9, 0.88])
            .with_ground(false)
            .with_supersampling(2);
        let tubes = Tubes::default().with_sides(8).with_least_sides(3).with_root_flare(0.0);
        let bark = tree.bark_mesh(&tubes)?;
        // The tree stands in the middle of its cell, wherever its crown grew.
        let reach = tree.skeleton.positions().iter().map(|place| place.x);
        let (low, high) = reach.fold((0.0f32, 0.0f32), |(low, high), x| (low.min(x), high.max(x)));
        let middle = Vec3::X * ((low + high) * -0.5);
        let stand = |place: Vec3| Instance { position: place, ..Instance::IDENTITY };
        let (trunk, body) = ([stand(middle)], [stand(Vec3::new(-WIDTH * 0.46, 0.0, 3.0))]);
        let human = Material::bark().with_srgb([60, 60, 66]);
        let wood = Part::new(&bark).with_material(Material::white()).with_instances(&trunk);
        let somebody = Part::new(&person).with_material(human).with_instances(&body);
        let mut moved: Vec<_> = tree.foliage().cloned().collect();
        for leaf in moved.iter_mut().flat_map(|leaves| &mut leaves.instances) {
            leaf.position += middle;
        }
        let leafy: Vec<Part<'_>> =
            [wood, somebody].into_iter().chain(moved.iter().map(|leaves| leaves.part())).collect();
        let wide = if bare { 2 * pixels[0] } else { pixels[0] };
        let mut cell = Picture::new(wide, pixels[1] + LABEL, [255; 3])?;
        if bare {
            cell.blit(&preview.draw_parts(&[wood, somebody])?, 0, 0);
        }
        cell.blit(&preview.draw_parts(&leafy)?, (wide - pixels[0]) as i32, 0);
        let at = wide.saturating_sub(Picture::label_width(&species.name, 2)) / 2;
        cell.label(&species.name, at as i32, pixels[1] as i32 + 4, 2, [40; 3]);
        Ok(cell)
    };
    let grown = |species: &Species| species.request().with_seed(seed).with_day(day(species)).grow();
    let named = |species: &Species, error: Failure| format!("{}: {error}", species.name);
    let row = |row: &[Species]| -> Result<Picture, String> {
        let trees: Result<Vec<Specimen>, String> = row
            .par_iter()
            .map(|species| grown(species).map_err(|error| named(species, error.into())))
            .collect();
        let trees = trees?;
        let tops = trees.iter().map(|tree| tree.numbers.height + SKY);
        let height = tops.fold(0.0, f32::max);
        let cells: Result<Vec<Picture>, String> = row
            .par_iter()
            .zip(&trees)
            .map(|(species, tree)| cell(species, tree, height).map_err(|error| named(species, error)))
            .collect();
        Picture::sheet(&cells?, row.len() as u32, 2, [255; 3]).map_err(|error| error.to_string())
    };
    let rows: Result<Vec<Picture>, String> =
        species::all().chunks(if bare { ROW } else { 9 }).map(row).collect();
    let rows = rows?;
    let width = rows.iter().map(Picture::width).max().unwrap_or(1);
    let mut all = Picture::new(width, rows.iter().map(Picture::height).sum(), [255; 3])?;
    let mut top = 0;
    for row in &rows {
        all.blit(row, 0, top);
        top += row.height() as i32;
    }
    Ok(all)
}
