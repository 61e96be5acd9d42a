//! The watertight surface of a tree: milliseconds on one thread and on two, beside a plain copy of the mesh, and memory's
//! main part; and one piece beside `fast-surface-nets` on an array.

mod measure;

use criterion::{BenchmarkGroup, measurement::WallTime};
use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};

use measure::{PRESET, SEED, Samples, count, number, print_table};
use rayon::ThreadPoolBuilder;
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::surface::Implicit;

/// Nodes of the graph: as many as give about 17,000 segments.
const NODES: usize = 1_000_000;
/// Goal for 21,000 segments on two threads, milliseconds. Time grows with the segments.
const GOAL: f64 = 5000.0;
const GOAL_SEGMENTS: f64 = 21_000.0;

/// The piece that is made on an array too: voxels along each side, the side of one, and the radius of its rod, metres.
const ARRAY: u32 = 192;
const VOXEL: f32 = 0.01;
const ROD: f32 = 0.06;

/// A rod that goes to and fro.
fn rod() -> Vec<Vec3> {
    let [low, high] = [0.1, ARRAY as f32 * VOXEL - 0.1];
    (0..24u16)
        .map(|i| {
            let side = |bit: u16| if i >> bit & 1 == 0 { low } else { high };
            let rise = low + (high - low) * f32::from(i) / 23.0;
            Vec3::new(side(0), rise, side(1))
        })
        .collect()
}

/// Distance of each voxel's middle from the rod's surface, in voxels.
fn samples_of(rod: &[Vec3], shape: &RuntimeShape<u32, 3>) -> Vec<f32> {
    let distance = |point: Vec3, from: Vec3, to: Vec3| {
        let way = to - from;
        let t = ((point - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        point.distance_squared(from + way * t)
    };
    (0..shape.size())
        .map(|i| {
            let point = Vec3::from_array(shape.delinearize(i).map(|x| x as f32 * VOXEL));
            let nearest =
                rod.windows(2).map(|pair| distance(point, pair[0], pair[1])).fold(f32::MAX, f32::min);
            (nearest.sqrt() - ROD) / VOXEL
        })
        .collect()
}

/// One rod of voxels of one size: ours from the skeleton on, theirs from an array of samples on, and with sampling.
fn beside_an_array(group: &mut BenchmarkGroup<'_, WallTime>, samples: &mut Samples) {
    let rod = rod();
    let parents = (0..rod.len() as u32).map(|i| i.checked_sub(1)).collect();
    let skeleton = Skeleton::new(rod.clone(), parents).expect("a chain");
    let skeleton = skeleton.with_radii(vec![ROD; rod.len()]).expect("sound");
    let ours = Implicit::default().with_voxel(VOXEL).with_detail(ROD / VOXEL);
    let alone = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    let mesh = ours.mesh(&skeleton).expect("a surface");
    group.bench_function("rod/treesynth", |bencher| {
        samples.time(bencher, "rod/treesynth", || alone.install(|| ours.mesh(&skeleton)));
    });
    let shape = RuntimeShape::<u32, 3>::new([ARRAY; 3]);
    let array = samples_of(&rod, &shape);
    let nets = |array: &[f32]| {
        let mut buffer = SurfaceNetsBuffer::default();
        surface_nets(array, &shape, [0; 3], [ARRAY - 1; 3], &mut buffer);
        buffer
    };
    let theirs = nets(&array);
    group.bench_function("rod/nets", |bencher| samples.time(bencher, "rod/nets", || nets(&array)));
    group.bench_function("rod/sampled nets", |bencher| {
        samples.time(bencher, "rod/sampled nets", || nets(&samples_of(&rod, &shape)));
    });
    let Some(own) = samples.median("rod/treesynth") else { return };
    let each = |time: f64, triangles: usize| time * 1e6 / triangles as f64;
    let triangles = mesh.triangles().len();
    let mut rows = vec![vec![
        "treesynth, from the skeleton on".to_owned(),
        number(own),
        count(triangles),
        number(each(own, triangles)),
        String::new(),
    ]];
    let peers =
        [("fast-surface-nets, samples there", "rod/nets"), ("the same, sampling too", "rod/sampled nets")];
    for (name, what) in peers {
        let Some(time) = samples.median(what) else { continue };
        let their = theirs.indices.len() / 3;
        let ratio = each(own, triangles) / each(time, their);
        rows.push(vec![
            name.to_owned(),
            number(time),
            count(their),
            number(each(time, their)),
            number(ratio),
        ]);
    }
    print_table(
        &format!("A rod within {ARRAY} voxels along each side, one thread:"),
        &["", "ms", "triangles", "ns per triangle", "ours / theirs"],
        &rows,
    );
}

fn main() {
    let mut criterion = measure::criterion();
    let pools = [1, 2].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
    });
    let tree = measure::tree(measure::size(NODES, 10_000)).synthesize(SEED).expect("the preset grows");
    let tree = tree.relaxed(0.5, 3).expect("sound options");
    let thinnest = tree.radii().iter().copied().fold(f32::INFINITY, f32::min);
    let surface = Implicit::default().with_voxel(thinnest);
    let cases = [
        ("a voxel a radius", surface.clone()),
        ("longer triangles", surface.clone().with_error(0.15)),
        ("0.87 voxels per radius", surface.with_detail(0.87)),
    ];
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "implicit");
    let mut rows = Vec::new();
    for (name, surface) in &cases {
        let mesh = surface.mesh(&tree).expect("a surface");
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles().len());
        samples.thrice(&format!("{name}/copy"), || mesh.clone());
        drop(mesh);
        for (pool, threads) in pools.iter().zip(1..) {
            samples.thrice(&format!("{name}/{threads}"), || pool.install(|| surface.mesh(&tree)));
        }
        let median = |what: &str| samples.median(&format!("{name}/{what}"));
        if let (Some(copy), Some(one), Some(two)) = (median("copy"), median("1"), median("2")) {
            let scale = GOAL_SEGMENTS / tree.segments() as f64;
            rows.push(vec![
                (*name).to_owned(),
                number(copy),
                number(one),
                number(two),
                number(two * scale / GOAL),
                count(vertices),
                number((24 * vertices + 12 * triangles) as f64 / 1e6),
                number(vertices as f64 / two / 1e3),
            ]);
        }
    }
    beside_an_array(&mut group, &mut samples);
    group.finish();
    criterion.final_summary();
    print_table(
        &format!("Preset {PRESET}, {} segments, medians:", count(tree.segments())),
        &[
            "",
            "copy, ms",
            "one thread, ms",
            "two, ms",
            "two for 21,000 / goal",
            "vertices",
            "mesh, MB",
            "million vertices per second",
        ],
        &rows,
    );
}
