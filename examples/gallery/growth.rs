//! Trees that grow over the years, a sheet for each figure of theirs.

use super::common::Failure;
use super::{Options, write};
use std::collections::BTreeMap;
use treesynth::Bounds;
use treesynth::foliage::{Leaf, Leaves};
use treesynth::glam::{Vec2, Vec3};
use treesynth::growth::TreeAtAge;
use treesynth::presets::{self, Grown};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::surface::{Part, Tubes};

const PAPER: [f32; 3] = [0.97, 0.965, 0.955];

pub(crate) fn draw_all(options: &Options) -> Result<(), Failure> {
    let mut sheets: BTreeMap<u8, Vec<Picture>> = BTreeMap::new();
    for preset in presets::grown().filter(|preset| preset.name.contains(&options.only)) {
        println!("{}: {}", preset.name, preset.caption);
        sheets.entry(preset.figure).or_default().extend(draw(preset, options.size)?);
    }
    for (figure, pictures) in &sheets {
        let columns = match pictures.len() {
            count @ 0..=6 => count,
            // Of other species, three ages in a row.
            12 | 21 => 6,
            count => count.div_ceil(2),
        };
        let sheet = Picture::sheet(pictures, columns as u32, 6, [255, 255, 255])?;
        write(&options.out.join(format!("sheet-growth-{figure:02}.png")), &sheet)?;
    }
    Ok(())
}

/// The ages of a figure, all at the scale of the last; of other species each at its own, with its height.
fn draw(preset: &Grown, size: u32) -> Result<Vec<Picture>, Failure> {
    let growth = preset.grow(preset.seed)?;
    let stands: Vec<TreeAtAge> = preset.ages.iter().map(|&age| growth.at(age)).collect::<Result<_, _>>()?;
    // A shoot alone is shown from where it begins.
    let first_year = if preset.figure == 12 { 2 } else { 0 };
    let everything = stands.iter().map(|stand| {
        let nodes = stand.skeleton.positions().iter().zip(stand.skeleton.stages());
        Bounds::of(nodes.filter(|(_, year)| **year >= first_year).map(|(position, _)| *position))
    });
    let Some(bounds) = everything.reduce(Bounds::union) else { return Ok(Vec::new()) };
    let labelled = stands.iter().zip(preset.ages).map(|(stand, age)| {
        // Of other species each age fills its picture, so that a young tree is seen too.
        let own = Bounds::of(stand.skeleton.positions().iter().copied());
        let bounds = if preset.figure == 0 { own } else { bounds };
        let mut picture = if preset.planar {
            lines(stand, *age, bounds, size)?
        } else {
            shaded(preset, stand, bounds, size)?
        };
        let height = if preset.figure == 0 { format!(", {:.1} m", own.max.y) } else { String::new() };
        picture.label(&format!("{} {age}{height}", preset.name), 6, 6, 1, [60, 60, 60]);
        Ok(picture)
    });
    labelled.collect()
}

/// Each year's growth in turn blue and red, the latest green, as figure 8 has it.
fn lines(stand: &TreeAtAge, age: f32, bounds: Bounds, size: u32) -> Result<Picture, Failure> {
    let scale = size as f32 * 0.9 / bounds.size().max_element();
    let foot = Vec2::new(size as f32 * 0.5, size as f32 * 0.95);
    let at = |place: Vec3| foot + Vec2::new(place.x, -place.y) * scale;
    let mut picture = Picture::new(size, size, [255, 255, 255])?;
    let skeleton = &stand.skeleton;
    for (node, parent) in skeleton.edges() {
        let [from, to] = [parent, node].map(|node| at(skeleton.positions()[node]));
        let year = skeleton.stages()[node];
        let color = match year % 2 {
            _ if f32::from(year) >= age => [40, 160, 60],
            1 => [40, 80, 200],
            _ => [205, 50, 45],
        };
        picture.line(from, to, (size as f32 / 250.0).max(1.0), color);
    }
    Ok(picture)
}

fn shaded(preset: &Grown, stand: &TreeAtAge, bounds: Bounds, size: u32) -> Result<Picture, Failure> {
    let mesh = Tubes::default().with_sides(5).mesh(&stand.skeleton)?;
    let (leaves, buds) = (preset.leaves(stand), Leaves::buds(stand, &Leaf::bud()));
    let bark = Part::new(&mesh).with_material(preset.bark());
    let parts: Vec<_> = [bark, buds.part()].into_iter().chain(leaves.iter().map(Leaves::part)).collect();
    let preview = Preview::default().with_size(size, size).with_background(PAPER, PAPER);
    let camera = Camera::default().with_frame(bounds);
    Ok(preview.with_camera(camera).with_ground_height(0.0).draw_parts(&parts)?)
}
