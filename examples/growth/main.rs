//! Grows a tree over the years and writes an animation, its frames, a contact sheet, and a model of any age.
//!
//!     cargo run --release --example growth -- --species cottonwood --age 12.5 --out out

mod close;
#[path = "../common/mod.rs"]
mod common;
mod options;

use common::{Failure, Outputs, print};
use indicatif::{ProgressBar, ProgressStyle};
use options::Options;
use treesynth::export::gltf::{GlbOptions, write_glb_parts};
use treesynth::foliage::{Leaf, Leaves};
use treesynth::growth::{Growth, TreeAtAge};
use treesynth::presets::Grown;
use treesynth::preview::{Camera, Picture, Preview, RayCaster};
use treesynth::surface::{Mesh, Part, Tubes};
use treesynth::{Bounds, Silent};

fn main() {
    common::run(|| match Options::from_arguments()? {
        None => Ok(()),
        Some(options) => run(&options),
    });
}

fn run(options: &Options) -> Result<(), Failure> {
    let preset = options::named(&options.species)?;
    let folder = options.out.join(preset.name);
    let mut outputs = Outputs::new("--out", &options.out)?;
    let growth = preset.grow(options.seed.unwrap_or(preset.seed))?;
    let file = |extension: &str| options.out.join(format!("{}{extension}", preset.name));

    let last = preset.ages.last().copied().unwrap_or_default();
    let age = options.age.unwrap_or(last);
    if age > f32::from(growth.years()) {
        return Err(
            format!("--age is {age}, but must be 0 to {} years for {}", growth.years(), preset.name).into()
        );
    }
    // From the first summer to the last, unless it is said otherwise; with one frame a year it is always summer.
    let years = f32::from(growth.years());
    let (from, to) =
        (options.from.unwrap_or(0.6_f32.min(years)), options.to.unwrap_or((years - 0.4).max(0.6)));
    if from >= to || to > years {
        let range = format!("0 to {years} years for {}, and --from below --to", preset.name);
        return Err(format!("--from is {from} and --to is {to}, but must be {range}").into());
    }
    let look = Look::at(preset, &growth, age, 8)?;
    let parts = look.parts(preset);
    if parts.iter().all(|part| part.triangles() == 0) {
        print([format!("nothing has sprouted at {age} years: no model, and no picture of it")]);
    } else {
        outputs.write(&file(".glb"), |writer| {
            Ok(write_glb_parts(&parts, &GlbOptions::default().with_name(preset.name), writer)?)
        })?;
        let preview = Preview::default().with_ground_height(0.0);
        let picture = look.draw(preset, &preview, options.skin)?;
        outputs.write(&file(".png"), |writer| Ok(picture.write_png(writer)?))?;
    }
    if options.skin
        && let Some(close) = close::sheet(preset, &growth, options.size)?
    {
        outputs.write(&file("-close.png"), |writer| Ok(close.write_png(writer)?))?;
    }

    // All pictures are framed as the oldest tree is, so that it is the tree that grows and not the picture.
    let size = options.size;
    let width = size * 3 / 4;
    let framed = |oldest: f32| -> Result<Preview, Failure> {
        let oldest = Look::at(preset, &growth, oldest, 4)?;
        let camera = Camera::default().with_frame(oldest.bounds().ok_or("nothing has sprouted yet")?);
        Ok(Preview::default().with_camera(camera).with_size(width, size).with_ground_height(0.0))
    };
    let draw = |preview: &Preview, age: f32| -> Result<Picture, Failure> {
        let look = Look::at(preset, &growth, age, 5)?;
        let mut picture = look.draw(preset, preview, options.skin)?;
        picture.label(&format!("{age:.1} years"), 8, 8, 1 + size / 400, [70, 70, 70]);
        Ok(picture)
    };

    let ages = preset.ages.iter().filter(|&&age| age <= f32::from(growth.years()));
    let preview = framed(last.min(f32::from(growth.years())))?;
    let sheet: Vec<Picture> = ages.map(|&age| draw(&preview, age)).collect::<Result<_, _>>()?;
    let columns = sheet.len() as u32;
    outputs.write(&file("-sheet.png"), |writer| {
        Ok(Picture::sheet(&sheet, columns, 4, [255; 3])?.write_png(writer)?)
    })?;

    let a_year = if to - from < 2.0 { 48 } else { (to - from).round() as u32 + 1 };
    let count = options.frames.unwrap_or(a_year);
    let bar = ProgressBar::new(u64::from(count));
    bar.set_style(ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3}% {elapsed_precise}")?);
    let preview = framed(to)?;
    let mut frames = Vec::new();
    for frame in 0..count {
        let age = from + (to - from) * frame as f32 / (count - 1) as f32;
        bar.set_message(format!("{age:.2} years"));
        let picture = draw(&preview, age)?;
        outputs.write(&folder.join(format!("{frame:04}.png")), |writer| Ok(picture.write_png(writer)?))?;
        frames.push(picture);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let milliseconds = (10_000 / count).clamp(40, 400) as u16;
    outputs.write(&file(".apng"), |writer| Ok(Picture::write_animation(&frames, milliseconds, writer)?))?;
    outputs.finish()?;
    print([format!(
        "{}: at {age} years {} internodes and {} leaves -> {}",
        preset.name,
        look.stand.skeleton.segments(),
        look.leaves.iter().map(|tone| tone.instances.len()).sum::<usize>(),
        file("{.glb,.png,.apng,-sheet.png,/}").display(),
    )]);
    Ok(())
}

/// A tree of one age, to be drawn and written.
struct Look {
    age: f32,
    stand: TreeAtAge,
    mesh: Mesh,
    leaves: Vec<Leaves>,
    buds: Leaves,
}

impl Look {
    fn at(preset: &Grown, growth: &Growth, age: f32, sides: u32) -> Result<Self, Failure> {
        let stand = growth.at(age)?;
        let mesh = Tubes::default().with_sides(sides).mesh(&stand.skeleton)?;
        let buds = Leaves::buds(&stand, &Leaf::bud());
        Ok(Self { age, mesh, leaves: preset.leaves(&stand), buds, stand })
    }

    fn parts(&self, preset: &Grown) -> Vec<Part<'_>> {
        let bark = Part::new(&self.mesh).with_material(preset.bark());
        let leaves = self.leaves.iter().map(Leaves::part);
        [bark].into_iter().chain(leaves).chain([self.buds.part().with_name("buds")]).collect()
    }

    /// In tubes, or in a skin with scars and ridges.
    fn draw(&self, preset: &Grown, preview: &Preview, skin: bool) -> Result<Picture, Failure> {
        let parts = self.parts(preset);
        // What has no internode yet has no bark.
        if !skin || self.stand.skeleton.segments() == 0 {
            return Ok(preview.draw_parts(&parts)?);
        }
        let bark = close::skin(preset, self.age).blob_tree(&self.stand.skeleton)?;
        Ok(RayCaster::new(preview.clone()).draw(&bark, &parts[1..], &Silent)?)
    }

    fn bounds(&self) -> Option<Bounds> {
        self.mesh.bounds()
    }
}
