//! The Eastern cottonwood of 27 years in its skin, from its curves to pictures and polygons: seconds on two threads, beside
//! the goals and the times of Galbraith, Mündermann and Wyvill 2004 on a Pentium IV.

mod measure;

use measure::{SEED, Samples, count, number, print_table};
use rayon::ThreadPoolBuilder;
use treesynth::growth::{Growth, TreeAtAge};
use treesynth::preview::{Camera, Preview, RayCaster};
use treesynth::surface::blob::{BlobTree, Skin};
use treesynth::surface::{Part, Polygonizer};
use treesynth::{Silent, foliage::Leaves, presets};

/// In the last summer.
const AGE: f32 = 26.6;
/// Pictures of the film, one per year.
const FRAMES: usize = 27;
/// No goal, or no time of the paper.
const NONE: f64 = 0.0;

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be started");
    pool.install(run);
}

fn run() {
    let preset = presets::by_name("growth-15-cottonwood").expect("a preset of this name").grown().unwrap();
    let grow = || preset.grow(SEED).expect("a species in range");
    let growth = grow();
    let age = if measure::is_test() { 8.6 } else { AGE };
    let at = |growth: &Growth, age: f32| {
        let stand = growth.at(age).expect("an age in range");
        let leaves = preset.leaves(&stand);
        (stand, leaves)
    };
    let skin = |stand: &TreeAtAge, age: f32| -> BlobTree {
        Skin::default().with_age(age + 1.0).blob_tree(&stand.skeleton).expect("a skin")
    };
    let (stand, leaves) = at(&growth, age);
    let tree = skin(&stand, age);
    let preview = Preview::default();
    let square = measure::size(768, 24) as u32;
    let square = RayCaster::new(preview.clone().with_size(square, square));
    let film = preview
        .with_camera(Camera::default().with_frame(tree.bounds()))
        .with_size(measure::size(480, 15) as u32, measure::size(640, 20) as u32)
        .with_ground_height(0.0);
    let film = RayCaster::new(film);
    let draw = |caster: &RayCaster, tree: &BlobTree, leaves: &[Leaves]| {
        let parts: Vec<Part<'_>> = leaves.iter().map(Leaves::part).collect();
        caster.draw(tree, &parts, &Silent).expect("a picture")
    };
    let polygons = |detail: usize| {
        let voxel = tree.bounds().size().max_element() / measure::size(detail, 128) as f32;
        let surface = Polygonizer::default().with_voxel(voxel).with_detail(1.0).with_most_blocks(20_000_000);
        surface.mesh(&tree).expect("a surface").positions.len()
    };
    let frames = measure::size(FRAMES, 3);
    let (mut samples, mut rows) = (Samples::default(), Vec::new());
    // Number of runs, goal and paper's time in seconds, and the work.
    let mut time = |name: &str, times: usize, [goal, paper]: [f64; 2], work: &mut dyn FnMut()| {
        samples.repeat(times, name, work);
        let Some(milliseconds) = samples.median(name) else { return };
        let seconds = milliseconds / 1e3;
        let share = |of: f64| if of == NONE { String::new() } else { number(seconds / of) };
        rows.push(vec![name.to_owned(), format!("{seconds:.3}"), share(goal), share(paper)]);
    };
    time("structure, once for all ages", 3, [NONE, NONE], &mut || drop(grow()));
    time("skeleton and leaves at an age", 3, [0.15, NONE], &mut || drop(at(&growth, age)));
    time("BlobTree", 3, [1.0, NONE], &mut || drop(skin(&stand, age)));
    time("ray cast, 768 x 768", 3, [15.0, 430.0], &mut || drop(draw(&square, &tree, &[])));
    time("the same with leaves", 3, [15.0, 430.0], &mut || drop(draw(&square, &tree, &leaves)));
    let mut vertices = [0; 2];
    time("polygons, 1024 voxels per side", 3, [20.0, 350.0], &mut || vertices[0] = polygons(1024));
    time("polygons, 8192 voxels per side", 3, [20.0, NONE], &mut || vertices[1] = polygons(8192));
    time("27 frames of 480 x 640 with leaves", 1, [240.0, NONE], &mut || {
        for year in 0..frames {
            let age = year as f32 + 0.6;
            let (stand, leaves) = at(&growth, age);
            drop(draw(&film, &skin(&stand, age), &leaves));
        }
    });
    print_table(
        &format!(
            "The cottonwood at {age} years: {} internodes, {} leaves, {} primitives, {} operators; {} and {} vertices:",
            count(stand.skeleton.segments()),
            count(stand.leaves.len()),
            count(tree.primitives()),
            count(tree.operators()),
            count(vertices[0]),
            count(vertices[1]),
        ),
        &["", "seconds", "of the goal", "of the paper's"],
        &rows,
    );
}
