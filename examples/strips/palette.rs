//! Pictures of 256 colours, a third of the bytes.

use super::common::Failure;
use std::io::Write;
use treesynth::preview::Picture;

const COLORS: usize = 256;

/// Writes a PNG of at most 256 colours, chosen by median cut.
pub(crate) fn write(picture: &Picture, writer: impl Write) -> Result<(), Failure> {
    let mut colors: Vec<[u8; 3]> = picture.pixels().to_vec();
    colors.sort_unstable();
    colors.dedup();
    let palette: Vec<[u8; 3]> = if colors.len() <= COLORS { colors } else { cut(colors) };
    let nearest = |pixel: &[u8; 3]| {
        let far =
            |color: &[u8; 3]| (0..3).map(|i| (i32::from(color[i]) - i32::from(pixel[i])).pow(2)).sum::<i32>();
        (0..palette.len()).min_by_key(|&index| far(&palette[index])).unwrap_or(0) as u8
    };
    let mut encoder = png::Encoder::new(writer, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_palette(palette.concat());
    let indices: Vec<u8> = picture.pixels().iter().map(nearest).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&indices)?;
    Ok(writer.finish()?)
}

/// The box of colours that is longest is cut at its median, until there are enough; each box is then one colour.
fn cut(colors: Vec<[u8; 3]>) -> Vec<[u8; 3]> {
    let extent = |colors: &[[u8; 3]]| {
        let channel = |i: usize| {
            let of = || colors.iter().map(|color| color[i]);
            of().max().unwrap_or(0) - of().min().unwrap_or(0)
        };
        (0..3).map(|i| (channel(i), i)).max().unwrap_or((0, 0))
    };
    let mut boxes = vec![colors];
    while boxes.len() < COLORS {
        let Some(longest) = (0..boxes.len()).max_by_key(|&index| extent(&boxes[index]).0) else { break };
        let mut colors = boxes.swap_remove(longest);
        let (_, channel) = extent(&colors);
        colors.sort_unstable_by_key(|color| color[channel]);
        let upper = colors.split_off(colors.len() / 2);
        boxes.extend([colors, upper]);
    }
    let mean = |colors: &Vec<[u8; 3]>| {
        let sum = |i: usize| colors.iter().map(|color| usize::from(color[i])).sum::<usize>();
        [0, 1, 2].map(|i| (sum(i) / colors.len().max(1)) as u8)
    };
    boxes.iter().map(mean).collect()
}
