//! Trees that fill shapes, a sheet for each figure of theirs.

use super::common::Failure;
use super::{Options, write};
use std::collections::BTreeMap;
use treesynth::preview::{Picture, Preview};
use treesynth::surface::Tubes;
use treesynth::variational;

pub(crate) fn draw_all(options: &Options) -> Result<(), Failure> {
    let mut sheets: BTreeMap<u8, Vec<Picture>> = BTreeMap::new();
    for preset in variational::presets().filter(|preset| preset.name.contains(&options.only)) {
        let nodes = preset.shape_nodes.min(options.nodes / 10);
        let mesh = Tubes::default().mesh(&preset.synth(nodes)?.synthesize(preset.seed)?)?;
        let paper = [0.97, 0.965, 0.955];
        let preview = Preview::default().with_size(options.size, options.size).with_background(paper, paper);
        let mut picture = preview.draw(&mesh)?;
        picture.label(preset.name, 6, 6, 1, [60, 60, 60]);
        println!("{}: {}", preset.name, preset.caption);
        sheets.entry(preset.figure).or_default().push(picture);
    }
    for (figure, pictures) in &sheets {
        let columns = if pictures.len() % 3 == 0 { 3 } else { 4 };
        let sheet = Picture::sheet(pictures, columns, 6, [255, 255, 255])?;
        write(&options.out.join(format!("sheet-variational-{figure:02}.png")), &sheet)?;
    }
    Ok(())
}
