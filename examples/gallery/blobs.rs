//! Implicit solids cast ray by ray, a sheet for each figure of theirs.

use super::common::Failure;
use super::{Options, write};
use std::collections::BTreeMap;
use treesynth::Silent;
use treesynth::preview::{Camera, Picture, Preview, RayCaster};
use treesynth::surface::blob;

pub(crate) fn draw_all(options: &Options) -> Result<(), Failure> {
    let mut sheets: BTreeMap<u8, Vec<Picture>> = BTreeMap::new();
    for preset in blob::presets().filter(|preset| preset.name.contains(&options.only)) {
        let paper = [0.97, 0.965, 0.955];
        let camera = Camera::default().with_azimuth(0.25).with_elevation(0.3).with_frame(preset.view);
        let preview = Preview::default()
            .with_size(options.size, options.size)
            .with_background(paper, paper)
            .with_ground(false)
            .with_camera(camera);
        let mut picture = RayCaster::new(preview).draw(&preset.blob_tree()?, &[], &Silent)?;
        picture.label(preset.name, 6, 6, 1, [60, 60, 60]);
        println!("{}: {}", preset.name, preset.caption);
        sheets.entry(preset.figure).or_default().push(picture);
    }
    for (figure, pictures) in &sheets {
        let sheet = Picture::sheet(pictures, 4, 6, [255, 255, 255])?;
        write(&options.out.join(format!("sheet-blob-{figure:02}.png")), &sheet)?;
    }
    Ok(())
}
