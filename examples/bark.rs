//! Barks as images to be used anywhere, and a sheet of pictures of them on trunks and limbs.
//!
//!     cargo run --release --example bark -- --help

#[path = "common/mod.rs"]
mod common;

use common::{Failure, Outputs, number, print, text};
use lexopt::prelude::{Long, Short};
use std::path::PathBuf;
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::shape::Bounds;
use treesynth::surface::{Material, Mesh, Part, Tubes};
use treesynth::texture::{Bark, BarkSet, Image};

const HELP: &str = "\
Makes barks: NAME.color.png, NAME.normal.png, NAME.orm.png (occlusion, roughness, metal) and NAME.height.png, the same
for young wood as NAME-young, and barks.png, a sheet of pictures of a trunk and a limb that wear them.

cargo run --release --example bark -- [OPTIONS]

  --only NAME        one of --list                                 [all]
  --list             the barks, one a line, and nothing else
  --resolution N     side of the images, a power of two, 16 to 8192 pixels  [1024]
  --age A            of the old bark, 0 to 1                       [0.8]
  --seed N           the seed, 0 to 18446744073709551615           [1]
  --size N           side of each picture in the sheet, 16 to 4096 pixels  [480]
  --sheet            only the sheet
  --out DIR          where files go; made if it is not there       [out]
  --help             this text";

/// The trunk's and the limb's radius, metres.
const RADII: [f32; 2] = [0.24, 0.055];
/// Distance of one from the next.
const APART: f32 = 0.34;
/// Factor on the bark's light, so that white bark in the sun is not whiter than paper.
const EXPOSURE: [f32; 3] = [0.55; 3];
/// Height of what is seen of them.
const SEEN: f32 = 0.78;

fn barks() -> [(&'static str, Bark); 11] {
    [
        ("oak", Bark::oak()),
        ("ash", Bark::ash()),
        ("pine", Bark::pine()),
        ("spruce", Bark::spruce()),
        ("plane", Bark::plane()),
        ("eucalyptus", Bark::eucalyptus()),
        ("birch", Bark::birch()),
        ("cherry", Bark::cherry()),
        ("beech", Bark::beech()),
        ("cedar", Bark::cedar()),
        ("palm", Bark::palm()),
    ]
}

fn main() {
    common::run(run);
}

fn run() -> Result<(), Failure> {
    let (mut only, mut resolution, mut seed, mut size, mut age) = (None, 1024, 1, 480, 0.8);
    let mut sheet_only = false;
    let mut out = PathBuf::from("out");
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("only") => only = Some(text(&mut arguments, "--only")?),
            Long("resolution") => {
                resolution = number(&mut arguments, "--resolution", 16..=8192, "pixels")?;
            }
            Long("age") => age = number(&mut arguments, "--age", 0.0..=1.0, "")?,
            Long("seed") => seed = number(&mut arguments, "--seed", 0..=u64::MAX, "")?,
            Long("size") => size = number(&mut arguments, "--size", 16..=4096, "pixels")?,
            Long("sheet") => sheet_only = true,
            Long("out") => out = arguments.value()?.into(),
            Long("list") => {
                print(barks().map(|(name, bark)| format!("{name}: {:?}, {} m", bark.kind(), bark.size())));
                return Ok(());
            }
            Long("help") | Short('h') => {
                print([HELP]);
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    let wanted: Vec<_> = barks()
        .into_iter()
        .filter(|(name, _)| only.as_ref().is_none_or(|only| only == name))
        .map(|(name, bark)| (name, bark.with_seed(seed).with_resolution(resolution)))
        .collect();
    if wanted.is_empty() {
        return Err(format!("--only is {:?}, but must be one of --list", only.unwrap_or_default()).into());
    }
    let mut outputs = Outputs::new("--out", &out)?;
    let mut pictures = Vec::new();
    for (name, bark) in wanted {
        let sets = [bark.clone().with_age(age).bake()?, bark.young().bake()?];
        if !sheet_only {
            for (set, name) in sets.iter().zip([name.to_owned(), format!("{name}-young")]) {
                write(&mut outputs, &name, set)?;
            }
        }
        let mut picture = draw(&sets, size)?;
        picture.label(name, 6, 6, 1, [20; 3]);
        pictures.push(picture);
    }
    let columns = pictures.len().min(4) as u32;
    let sheet = Picture::sheet(&pictures, columns, 6, [255; 3])?;
    let path = outputs.path("barks.png");
    outputs.write(&path, |file| Ok(sheet.write_png(file)?))?;
    outputs.finish()
}

fn write(outputs: &mut Outputs, name: &str, set: &BarkSet) -> Result<(), Failure> {
    let textures = &set.textures;
    let maps: [(&str, Option<&Image>); 4] = [
        ("color", textures.base_color()),
        ("normal", textures.normal()),
        ("orm", textures.occlusion_roughness_metallic()),
        ("height", Some(&set.height)),
    ];
    for (map, image) in maps {
        if let Some(image) = image {
            let path = outputs.path(&format!("{name}.{map}.png"));
            outputs.write(&path, |file| Ok(image.write_png(file)?))?;
        }
    }
    Ok(())
}

/// A trunk that wears the first set, and a limb that wears the second.
fn draw(sets: &[BarkSet; 2], size: u32) -> Result<Picture, Failure> {
    let poles = [pole(0.0, RADII[0], sets[0].size)?, pole(APART, RADII[1], sets[1].size)?];
    let parts = [0, 1].map(|i| {
        let part =
            Part::new(&poles[i]).with_material(Material::white().with_color(EXPOSURE).with_roughness(1.0));
        part.with_textures(&sets[i].textures)
    });
    let low = Vec3::new(-RADII[0] - 0.14, 0.6, -RADII[0]);
    let frame = Bounds { min: low, max: Vec3::new(APART + RADII[1] + 0.02, 0.6 + SEEN, RADII[0]) };
    let camera = Camera::default().with_elevation(0.0).with_azimuth(0.0).with_frame(frame).with_margin(0.0);
    let preview = Preview::default().with_size(size, size).with_camera(camera).with_ground(false);
    let backdrop = [0.30, 0.36, 0.42];
    let preview = preview.with_background(backdrop, backdrop).with_sun(Vec3::new(-0.75, 0.55, 0.65));
    Ok(preview.draw_parts(&parts)?)
}

/// A pole of 2 m that leans a little.
fn pole(x: f32, radius: f32, tile: f32) -> Result<Mesh, Failure> {
    let points =
        (0..=20).map(|i| Vec3::new(x + 0.01 * (i as f32 * 0.1 - 1.0), 0.1 * i as f32, 0.0)).collect();
    let parents = (0..=20u32).map(|i| i.checked_sub(1)).collect();
    let radii = (0..=20).map(|i| radius * (1.0 - 0.004 * i as f32)).collect();
    let skeleton = Skeleton::new(points, parents)?.with_radii(radii)?;
    let tubes = Tubes::default().with_sides(64).with_least_sides(64).with_root_flare(0.0);
    Ok(tubes.with_tile(tile).with_square_tiles(true).mesh(&skeleton)?)
}
