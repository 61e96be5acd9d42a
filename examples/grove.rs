//! Twenty trees grow in one graph, in one search: a picture from above and from the side (`grove.png`).
//!
//!     cargo run --release --example grove -- [OUT] [SEED]

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::PathBuf;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Apart, AroundEachRoot, Bend, ByTree, Count, ForkAngle, Guided, Leader, LimbSurface, PoissonYao, Stage,
    Territory, TreeSynth,
};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::radius::PipeModel;
use treesynth::shape::{Cuboid, Ellipsoid};
use treesynth::surface::{Material, Mesh, Part, Tubes};

const COLUMNS: usize = 5;
const ROWS: usize = 4;
/// Metres from one trunk to the next; each crown would be 5.2 m across.
const STEP: f32 = 2.5;
const COLORS: [[u8; 3]; 5] = [[150, 96, 60], [92, 110, 70], [96, 90, 120], [170, 140, 80], [70, 104, 112]];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = PathBuf::from(arguments.next().unwrap_or_else(|| "out".to_owned()));
    let seed = arguments.next().map_or(Ok(1), |seed| seed.parse())?;
    let foot = |i: usize| {
        let place = |i: usize, count: usize| (i as f32 - 0.5 * (count - 1) as f32) * STEP;
        Vec3::new(place(i % COLUMNS, COLUMNS), 0.0, place(i / COLUMNS, ROWS))
    };
    let feet: Vec<Vec3> = (0..COLUMNS * ROWS).map(foot).collect();
    let leaders = |i: usize| Leader::new(Vec3::ZERO, Vec3::Y * (5.5 + 0.3 * (i * 7 % 5) as f32));
    let region = Cuboid::new(Vec3::new(-8.5, 0.0, -7.5), Vec3::new(8.5, 8.5, 7.5));
    let graph = PoissonYao::new(region)
        .with_nodes(300_000)
        .with_roots(feet.clone())
        .with_leaders((0..feet.len()).map(leaders).collect::<Vec<_>>());
    // A rule of its own for each tree: limbs rise on the left and lie flat on the right.
    let limbs = (0..feet.len()).fold(ByTree::new(), |rules, i| {
        let angle = (30.0 + 12.0 * (i % COLUMNS) as f32).to_radians();
        rules.then(Bend::piecewise(angle, 0.0, 1).with_hop_length(0.25))
    });
    let crown = Ellipsoid::new(Vec3::Y * 5.0, Vec3::new(2.6, 2.4, 2.6));
    // Places nearer to a neighbour's trunk cost more, so crowns give way to each other.
    let limbs = Stage::new(limbs, AroundEachRoot::new(crown, Count::UpTo(30))).with_weight(Territory::new(
        Apart::new(Guided, 0.25),
        feet.clone(),
        0.5,
    ));
    let twigs = |metres: f32, spacing: f32| {
        let endpoints = LimbSurface::new(3, spacing).with_hop_length(metres / 3.0).with_least_order(1);
        let rule = ForkAngle::new(50f32.to_radians(), Bend::none()).with_spread(0.2);
        Stage::new(rule, endpoints).with_weight(Territory::new(Apart::new(Guided, 0.5), feet.clone(), 0.5))
    };
    let trees = TreeSynth::new(graph)
        .stage(limbs)
        .stage(twigs(0.7, 0.35))
        .stage(twigs(0.45, 0.3))
        .with_radius(PipeModel::default().with_exponent(2.3).with_trunk_diameter(0.2))
        .synthesize_all(seed)?;
    for (number, tree) in trees.iter().enumerate() {
        println!("tree {number}: {} internodes, {} tips", tree.segments(), tree.tips().count());
    }
    let meshes: Vec<Mesh> = trees.iter().map(|tree| Tubes::default().mesh(tree)).collect::<Result<_, _>>()?;
    // No two neighbours in one colour.
    let color = |number: usize| COLORS[(number % COLUMNS + 2 * (number / COLUMNS)) % COLORS.len()];
    let parts: Vec<Part<'_>> = meshes
        .iter()
        .enumerate()
        .map(|(number, mesh)| Part::new(mesh).with_material(Material::default().with_srgb(color(number))))
        .collect();
    let view = |elevation: f32| {
        let camera =
            Camera::default().with_azimuth(20f32.to_radians()).with_elevation(elevation.to_radians());
        Preview::default().with_size(800, 700).with_camera(camera).draw_parts(&parts)
    };
    let sheet = Picture::sheet(&[view(12.0)?, view(89.0)?], 2, 4, [255, 255, 255])?;
    fs::create_dir_all(&out)?;
    Ok(sheet.write_png(BufWriter::new(File::create(out.join("grove.png"))?))?)
}
