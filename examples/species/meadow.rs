//! A picture of several species in a meadow, each as the asset that one would ship.

use crate::common::Failure;
use rayon::prelude::*;
use treesynth::asset::Asset;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview, Projection};
use treesynth::shape::Bounds;
use treesynth::species;
use treesynth::surface::{Part, Transform};

/// Name, place on the ground in metres, and height in metres; nearest first.
const TREES: [(&str, f32, f32, f32); 13] = [
    ("English oak", -9.0, 4.0, 13.0),
    ("silver birch", 4.5, 5.0, 12.5),
    ("silver birch", 7.0, 3.0, 10.5),
    ("apple", 13.0, 7.0, 5.0),
    ("weeping willow", 20.0, 0.0, 10.0),
    ("hazel", -1.0, 8.0, 4.0),
    ("wild cherry", -20.0, 3.0, 8.0),
    ("Scots pine", 11.5, -9.0, 17.0),
    ("Norway spruce", -2.0, -10.0, 18.0),
    ("Norway spruce", -19.0, -12.0, 15.0),
    ("beech", 22.0, -15.0, 17.0),
    ("Lombardy poplar", 3.5, -17.0, 19.0),
    ("Douglas fir", -10.5, -17.0, 19.0),
];
/// Triangles of each.
const TRIANGLES: usize = 60_000;

pub(crate) fn draw(seed: u64) -> Result<Picture, Failure> {
    let grown: Result<Vec<Asset>, String> = TREES
        .par_iter()
        .enumerate()
        .map(|(number, &(name, _, _, height))| {
            let told = |error: &dyn std::fmt::Display| format!("{name}: {error}");
            let species = species::by_name(name).map_err(|error| told(&error))?;
            let request = species.request().with_height(height).with_seed(seed + number as u64);
            let tree = request.grow().map_err(|error| told(&error))?;
            let mut levels = tree.levels(Some(TRIANGLES), 512, &[1.0]).map_err(|error| told(&error))?;
            levels.pop().ok_or_else(|| told(&"no level"))
        })
        .collect();
    let grown = grown?;
    let stand = |number: usize| {
        let (_, x, z, _) = TREES[number];
        Transform::at(Vec3::new(x, 0.0, z))
    };
    let parts: Vec<Part<'_>> = grown
        .iter()
        .enumerate()
        .flat_map(|(number, tree)| {
            tree.parts().into_iter().map(move |part| part.with_transform(stand(number)))
        })
        .collect();
    let frame = Bounds::new(Vec3::new(-20.0, 1.5, -8.0), Vec3::new(20.0, 14.0, 6.0));
    let camera = Camera::default()
        .with_azimuth(0.0)
        .with_elevation(0.07)
        .with_margin(0.0)
        .with_projection(Projection::Perspective { field_of_view: 0.5 })
        .with_frame(frame);
    let preview = Preview::default()
        .with_size(1600, 720)
        .with_camera(camera)
        .with_background([0.36, 0.57, 0.86], [0.86, 0.90, 0.90])
        .with_ground_color([0.16, 0.24, 0.07])
        .with_ground_height(0.0);
    Ok(preview.draw_parts(&parts)?)
}
