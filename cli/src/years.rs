//! `years`: a tree over the years.

use crate::arguments::Common;
use crate::clothe::{Clothes, Model, triangles};
use crate::failure::refused;
use crate::files::Outputs;
use crate::number::{number, text};
use crate::progress::Bar;
use crate::wish::stem;
use crate::write::{Out, Tree, write_animation};
use crate::{Failure, report};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use treesynth::Silent;
use treesynth::foliage::{Leaf, Leaves};
use treesynth::growth::{Growth, TreeAtAge};
use treesynth::presets::{self, Found, Grown};
use treesynth::preview::{Camera, Picture, Preview, RayCaster};
use treesynth::surface::{Mesh, Part, Tubes, blob::Skin};

/// Grow a tree over the years: a model of one age, a sheet of several, an animation
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth years cottonwood
  treesynth years cottonwood --age 12.5 --frames 0 --format glb,usdz
  treesynth years growth-15-cottonwood --from 8 --to 9 --frames 48 --stills
  treesynth years spreading-oak --skin --size 480
  treesynth years norway-maple --age 6.6 --frames 0 --surface skin --format glb,ply")]
pub(crate) struct Options {
    /// One of `treesynth list years`, or what its name ends in
    #[arg(value_name = "NAME", value_parser = text)]
    name_of_tree: String,
    /// Age of the model, years, 0 to as long as the tree is grown; fractions are days [default: the last of the preset's]
    #[arg(long, value_name = "YEARS", allow_negative_numbers = true, value_parser = number(0.0..=1000.0_f32, "years"))]
    age: Option<f32>,
    /// Seed, 0 to 18446744073709551615 [default: the preset's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0..=u64::MAX, ""))]
    seed: Option<u64>,
    /// Pictures of the animation NAME.apng, 2 to 1000, or 0 for none [default: one per year; 48 of less than
    /// two years]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0..=1000_u32, "pictures"))]
    frames: Option<u32>,
    /// Age at which the animation begins, years [default: 0.6, the first summer]
    #[arg(long, value_name = "YEARS", allow_negative_numbers = true, value_parser = number(0.0..=1000.0_f32, "years"))]
    from: Option<f32>,
    /// Age at which it ends, years [default: the last summer]
    #[arg(long, value_name = "YEARS", allow_negative_numbers = true, value_parser = number(0.0..=1000.0_f32, "years"))]
    to: Option<f32>,
    /// Write each picture of the animation too, NAME/0000.png and so on
    #[arg(long)]
    stills: bool,
    /// Draw sheet and animation in a blended skin with scars and ridges, cast ray by ray; the model has it by --surface skin
    #[arg(long)]
    skin: bool,
    /// No sheet of several ages, NAME-sheet.png
    #[arg(long)]
    no_sheet: bool,
    #[command(flatten, next_help_heading = "Model")]
    clothes: Clothes,
    #[command(flatten, next_help_heading = "Files")]
    out: Out,
}

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    options.clothes.check()?;
    let preset = options.preset()?;
    if options.frames == Some(1) {
        return Err(refused("--frames is 1, but must be 2 to 1000 pictures, or 0"));
    }
    let seed = options.seed.unwrap_or(preset.seed);
    let growth = preset.grow(seed)?;
    let oldest = f32::from(growth.years());
    let span = options.span(preset, oldest)?;
    let last = preset.ages.last().copied().unwrap_or(oldest).min(oldest);
    let age = options.age.unwrap_or(last);
    if age > oldest {
        return Err(refused(format!("--age is {age}, but must be 0 to {oldest} years for {}", preset.name)));
    }
    let look = Look::at(preset, &growth, age, 8)?;
    if look.stand.skeleton.segments() == 0 {
        return Err(refused(format!(
            "--age is {age}, but nothing has sprouted then: there is no model of it"
        )));
    }
    let mut outputs = options.out.outputs()?;
    let bar = Bar::new(common.quiet);
    let name = options.out.name.clone().unwrap_or_else(|| stem(preset.name));
    bar.step("bark, leaves and levels");
    let dress: Vec<Leaves> = look.leaves.iter().chain([&look.buds]).cloned().collect();
    let skeleton = &look.stand.skeleton;
    let images = preset.bark_texture().with_seed(seed);
    let model = if options.out.has_triangles() {
        // Stages of a tree that grows count from 1.
        options.clothes.dressed_at(Some(age + 1.0), skeleton, &dress, preset.bark(), Some(images))?
    } else {
        Model::none()
    };
    let height = treesynth::metrics::height(skeleton) as f32;
    let (levels, coverages) = (model.levels(), model.coverages(height));
    bar.step("writing the model");
    let tree = Tree { levels: &levels, coverages: &coverages, skeleton, bark: preset.bark() };
    let mut files = options.out.tree(&mut outputs, &name, &tree)?;

    let drawing = Drawing { preset, growth: &growth, skin: options.skin, size: options.out.size.min(1024) };
    if !options.no_sheet {
        let ages: Vec<f32> = preset.ages.iter().copied().filter(|&age| age <= oldest).collect();
        bar.parts("drawing ages", ages.len() as u64);
        let preview = drawing.framed(last)?;
        let mut pictures = Vec::new();
        for &age in &ages {
            pictures.push(drawing.draw(&preview, age)?);
            bar.done(pictures.len() as u64);
        }
        let sheet = Picture::sheet(&pictures, ages.len() as u32, 4, [255; 3])?;
        let path = outputs.path(&format!("{name}-sheet.png"));
        outputs.write(&path, |writer| Ok(sheet.write_png(writer)?))?;
        files.push(path);
    }
    files.extend(options.animate(&drawing, span, &name, &mut outputs, &bar)?);
    outputs.finish()?;
    let milliseconds = bar.finish();
    let leaves: usize = look.leaves.iter().map(|tone| tone.instances.len()).sum();
    let value = json!({
        "name": preset.name,
        "seed": seed,
        "age": age,
        "oldest": oldest,
        "internodes": look.stand.skeleton.segments(),
        "leaves": leaves,
        "triangles": triangles(&levels),
        "files": files,
        "milliseconds": milliseconds,
    });
    report::tell(common, &value, || {
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        format!(
            "{}, seed {seed}: at {age} of {oldest} years {} internodes and {leaves} leaves, {milliseconds:.0} ms\n{}",
            preset.name,
            look.stand.skeleton.segments(),
            files.join("\n"),
        )
    })
}

impl Options {
    /// The ages between which the animation is, from the first summer to the last unless it is said otherwise.
    fn span(&self, preset: &Grown, oldest: f32) -> Result<[f32; 2], Failure> {
        let [from, to] =
            [self.from.unwrap_or(0.6_f32.min(oldest)), self.to.unwrap_or((oldest - 0.4).max(0.6))];
        if from < to && to <= oldest {
            return Ok([from, to]);
        }
        let name = preset.name;
        Err(refused(format!(
            "--from is {from} and --to is {to}, but must be 0 to {oldest} years for {name}, and --from below --to"
        )))
    }

    /// The animation and its stills; the paths of their files.
    fn animate(
        &self,
        drawing: &Drawing<'_>,
        [from, to]: [f32; 2],
        name: &str,
        outputs: &mut Outputs,
        bar: &Bar,
    ) -> Result<Vec<PathBuf>, Failure> {
        let a_year = if to - from < 2.0 { 48 } else { (to - from).round() as u32 + 1 };
        let count = self.frames.unwrap_or(a_year);
        let mut files = Vec::new();
        if count == 0 {
            return Ok(files);
        }
        bar.parts("drawing years", u64::from(count));
        let preview = drawing.framed(to)?;
        let mut drawn = Vec::new();
        for frame in 0..count {
            // With one picture a year from summer to summer it is always summer.
            let picture = drawing.draw(&preview, from + (to - from) * frame as f32 / (count - 1) as f32)?;
            if self.stills {
                let path = outputs.path(&format!("{name}/{frame:04}.png"));
                outputs.write(&path, |writer| Ok(picture.write_png(writer)?))?;
                files.push(path);
            }
            drawn.push(picture);
            bar.done(u64::from(frame) + 1);
        }
        let path = outputs.path(&format!("{name}.apng"));
        write_animation(outputs, &path, &drawn, (10_000 / count).clamp(40, 400) as u16)?;
        files.push(path);
        Ok(files)
    }

    /// The preset of this whole name, or of this ending of a name; the drawings in the plane are
    /// those of a figure.
    fn preset(&self) -> Result<&'static Grown, Failure> {
        let ending = format!("-{}", self.name_of_tree.to_lowercase());
        match presets::grown().find(|preset| !preset.planar && preset.name.ends_with(&ending)) {
            Some(preset) => Ok(preset),
            None => presets::by_name(&self.name_of_tree).and_then(Found::grown).map_err(refused),
        }
    }
}

/// Pictures of a tree at several ages, all framed alike, so that it is the tree that grows and not the picture.
struct Drawing<'a> {
    preset: &'a Grown,
    growth: &'a Growth,
    /// With scars and ridges instead of tubes.
    skin: bool,
    /// Height, pixels.
    size: u32,
}

impl Drawing<'_> {
    /// As the tree of this age fills it.
    fn framed(&self, age: f32) -> Result<Preview, Failure> {
        let look = Look::at(self.preset, self.growth, age, 4)?;
        let camera = Camera::default().with_frame(look.mesh.bounds().ok_or("nothing has sprouted yet")?);
        let preview = Preview::default().with_camera(camera).with_ground_height(0.0);
        Ok(preview.with_size(self.size * 3 / 4, self.size))
    }

    fn draw(&self, preview: &Preview, age: f32) -> Result<Picture, Failure> {
        let look = Look::at(self.preset, self.growth, age, 5)?;
        let mut picture = look.draw(self.preset, preview, self.skin)?;
        picture.label(&format!("{age:.1} years"), 8, 8, 1 + self.size / 400, [70, 70, 70]);
        Ok(picture)
    }
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
        // A tree without an internode has no bark yet.
        if !skin || self.stand.skeleton.segments() == 0 {
            return Ok(preview.draw_parts(&parts)?);
        }
        // Stages of a tree that grows count from 1.
        let skin = Skin::default().with_age(self.age + 1.0).with_bark(preset.bark().color());
        let bark = skin.blob_tree(&self.stand.skeleton)?;
        Ok(RayCaster::new(preview.clone()).draw(&bark, &parts[1..], &Silent)?)
    }
}
