//! Same seed, same bits: at every number of threads, and from one version to the next.

use crate::sample::fnv1a;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use treesynth::glam::{Vec2, Vec3, Vec4};
use treesynth::guided::{
    Edges, GradedYao, Graph, Lattice, NearSurface, PointCloud, PoissonDelaunay, PoissonSurface, PoissonYao,
};
use treesynth::shape::{Cuboid, HalfEllipsoid};
use treesynth::surface::{Implicit, Levels, Mesh, Tubes};
use treesynth::{GraphBuilder, Silent, Skeleton, presets};

fn of_positions(positions: &[Vec3]) -> impl Iterator<Item = u8> {
    positions.iter().flat_map(Vec3::to_array).flat_map(|x| x.to_bits().to_le_bytes())
}

/// Of every bit a graph holds.
fn graph_hash(graph: &Graph) -> u64 {
    let edges = (0..graph.nodes() as u32).flat_map(|node| {
        let neighbours = graph.neighbours(node);
        std::iter::once(neighbours.len() as u32).chain(neighbours.iter().copied())
    });
    let numbers = std::iter::once(graph.root()).chain(edges).flat_map(u32::to_le_bytes);
    fnv1a(of_positions(graph.positions()).chain(numbers))
}

/// Of every bit a skeleton holds.
fn tree_hash(tree: &Skeleton) -> u64 {
    let parents = (0..tree.len()).map(|node| tree.parent(node).map_or(u32::MAX, |parent| parent as u32));
    let short = tree.stages().iter().chain(tree.orders()).map(|&number| u32::from(number));
    let radii = tree.radii().iter().map(|radius| radius.to_bits());
    let numbers = parents.chain(radii).chain(short).chain(tree.hops().iter().copied());
    fnv1a(of_positions(tree.positions()).chain(numbers.flat_map(u32::to_le_bytes)))
}

/// The results of `work` on pools of 1, 2 and 8 threads.
fn at_thread_counts<T: Send>(work: impl Fn() -> T + Sync + Send) -> Vec<T> {
    [1, 2, 8]
        .into_iter()
        .map(|threads| {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            pool.install(&work)
        })
        .collect()
}

fn all_the_same(hashes: &[u64], what: &str) {
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{what} depends on the threads: {hashes:x?}");
}

#[test]
fn graphs_do_not_depend_on_the_threads() {
    let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
    let points =
        PoissonYao::new(region).with_nodes(20_000).build(5, &Silent).expect("a graph").positions().to_vec();
    let dome = HalfEllipsoid::new(Vec3::ZERO, Vec3::new(3.0, 2.0, 5.0));
    let sizing = NearSurface::new(dome, 1.0, 5.0, 2.0);
    // Two hills side by side, the way up one of them steeper.
    let hills = |i: u32| {
        Vec3::new(
            (i % 40) as f32 * 0.1,
            (i % 40).min(30) as f32 * (i / 40) as f32 * 0.002,
            (i / 40) as f32 * 0.1,
        )
    };
    let squares = (0..39 * 39).map(|i| i / 39 * 40 + i % 39);
    let triangles = squares.flat_map(|i| [[i, i + 40, i + 1], [i + 1, i + 40, i + 41]]).collect();
    let surface = PoissonSurface::new((0..1600).map(hills).collect(), triangles);
    let builders: [(&str, Box<dyn GraphBuilder>); 10] = [
        ("surface", Box::new(surface.with_nodes(5_000))),
        ("delaunay", Box::new(PoissonDelaunay::new(region).with_nodes(10_000))),
        ("poisson", Box::new(PoissonYao::new(region).with_nodes(60_000))),
        ("dome", Box::new(PoissonYao::new(dome).with_nodes(30_000).with_sectors(12))),
        ("plane", Box::new(PoissonYao::new(region).with_nodes(30_000).planar())),
        ("graded", Box::new(GradedYao::new(region, sizing).with_nodes(40_000))),
        ("lattice", Box::new(Lattice::new(region, 0.2))),
        ("cloud", Box::new(PointCloud::new(points.clone(), Edges::Yao(8)))),
        ("wedges", Box::new(PointCloud::new(points.clone(), Edges::PlanarYao(6)))),
        ("nearest", Box::new(PointCloud::new(points, Edges::Nearest(9)))),
    ];
    for (name, builder) in builders {
        for seed in [1, u64::MAX] {
            let build = || graph_hash(&builder.build(seed, &Silent).expect("a graph"));
            all_the_same(&at_thread_counts(build), name);
        }
    }
}

/// A sizing field is asked on the lattice's points, then the tiles are filled: neither may depend on the platform.
#[test]
fn a_graded_graph_is_the_same_as_ever() {
    let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
    let dome = HalfEllipsoid::new(Vec3::Y, Vec3::new(2.0, 3.0, 2.0));
    let builder = GradedYao::new(region, NearSurface::new(dome, 0.15, 0.5, 1.0));
    let graph = builder.build(7, &Silent).expect("a graph");
    assert_eq!(graph_hash(&graph), 0xdd91_6cf6_9d39_7055);
}

#[test]
fn planar_and_surface_graphs_are_the_same_as_ever() {
    let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
    let plane = PoissonDelaunay::new(region).with_nodes(2_000).build(7, &Silent).expect("a graph");
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::Y + Vec3::Z, Vec3::Z];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [5, 0, 3], [5, 3, 4]];
    let walls = PoissonSurface::new(corners, triangles).with_nodes(1_000).build(7, &Silent).expect("a graph");
    let found = [&plane, &walls].map(graph_hash);
    assert_eq!(found, [0x9e1a_2fe0_f8fa_7f32, 0xc939_d4a0_4543_67cc], "{found:#x?}");
}

#[test]
fn trees_do_not_depend_on_the_threads() {
    for name in
        ["figure-05-right", "figure-06c", "figure-07", "figure-08a", "figure-13", "figure-17b", "figure-17e"]
    {
        let preset = presets::by_name(name).expect("a preset").guided().unwrap();
        let synth = preset.synth(20_000);
        let grow = || tree_hash(&synth.synthesize(preset.seed).expect("a tree"));
        all_the_same(&at_thread_counts(grow), name);
    }
}

/// Enough shape nodes that several threads have a part in each step.
#[test]
fn trees_in_shapes_are_the_same_as_ever() {
    let preset = presets::by_name("variational-14-oak").expect("a preset").variational().unwrap();
    let synth = preset.synth(6_000).expect("a shape");
    let grow = || tree_hash(&synth.synthesize(preset.seed).expect("a tree"));
    let hashes = at_thread_counts(grow);
    all_the_same(&hashes, preset.name);
    assert_eq!(hashes[0], 0xcf85_9da2_32ae_53fc);
}

#[test]
fn the_seed_matters() {
    let synth = presets::by_name("figure-06c").expect("a preset").guided().unwrap().synth(3000);
    let hash = |seed| tree_hash(&synth.synthesize(seed).expect("a tree"));
    assert_eq!(hash(1), hash(1));
    assert!(hash(1) != hash(2) && hash(1) != hash(1 << 32) && hash(1) != hash(1 << 63));
}

/// FNV's own test vectors.
#[test]
fn the_hash_is_fnv1a() {
    assert_eq!(fnv1a(*b""), 0xcbf2_9ce4_8422_2325);
    assert_eq!(fnv1a(*b"foobar"), 0x8594_4171_f739_67e8);
}

/// Nodes of the graphs that pinned trees grow in.
const COARSE: usize = 3000;

/// "Late endpoints are 'up to' the figure's count, so that coarse graphs work too."
#[test]
fn every_preset_grows_in_a_coarse_graph() {
    let failed: Vec<String> = presets::guided()
        .filter_map(|preset| {
            let error = preset.synth(COARSE).synthesize(preset.seed).err()?;
            Some(format!("{}: {error}", preset.name))
        })
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/pinned.txt");

#[test]
fn presets_grow_the_same_trees_as_ever() {
    let found: BTreeMap<String, u64> = presets::guided()
        .map(|preset| {
            // One that does not grow is pinned by what it says; the test above calls it by name.
            let hash = match preset.synth(COARSE).synthesize(preset.seed) {
                Ok(tree) => tree_hash(&tree),
                Err(error) => fnv1a(error.to_string().bytes()),
            };
            (preset.name.to_owned(), hash)
        })
        .collect();
    if std::env::var_os("TREESYNTH_PIN").is_some() {
        let mut text = String::new();
        for (name, hash) in &found {
            writeln!(text, "{name} {hash:016x}").expect("strings take everything");
        }
        std::fs::write(TABLE, text).expect("the table can be written");
        return;
    }
    let text = std::fs::read_to_string(TABLE).expect("tests/it/pinned.txt");
    let pinned: BTreeMap<String, u64> = text
        .lines()
        .map(|line| {
            let (name, hash) = line.split_once(' ').expect("a name and a hash");
            (name.to_owned(), u64::from_str_radix(hash, 16).expect("a hash of 16 digits"))
        })
        .collect();
    let names = found.keys().chain(pinned.keys()).collect::<std::collections::BTreeSet<_>>();
    let mut changes = String::new();
    for name in names {
        let word = match (pinned.get(name), found.get(name)) {
            (None, Some(_)) => "new",
            (Some(_), None) => "gone",
            (pinned, found) if pinned != found => "another tree",
            _ => continue,
        };
        write!(changes, "\n  {name}: {word}").expect("strings take everything");
    }
    assert!(
        changes.is_empty(),
        "Equal seeds no longer give equal trees:{changes}\nIf that is meant, say so in CHANGELOG.md, for users \
         count on it, and pin the new trees with TREESYNTH_PIN=1 cargo test --all-features --test it presets_grow"
    );
}

/// Of every bit a mesh of tubes holds.
fn mesh_hash(mesh: &Mesh) -> u64 {
    let tangents = mesh.tangents.iter().flat_map(Vec4::to_array);
    let uvs = mesh.uvs.iter().flat_map(Vec2::to_array);
    let wind =
        mesh.wind.iter().flat_map(|w| w.moments.into_iter().chain(w.axes).chain([Vec3::splat(w.flutter)]));
    let wind = wind.flat_map(|vector| vector.to_array());
    let numbers = tangents.chain(uvs).chain(wind).map(f32::to_bits).chain(mesh.indices.iter().copied());
    fnv1a(
        of_positions(&mesh.positions)
            .chain(of_positions(&mesh.normals))
            .chain(numbers.flat_map(u32::to_le_bytes)),
    )
}

/// Vertices are computed in fours, and levels made while the next one is looked for.
#[test]
fn tubes_are_the_same_as_ever() {
    let tree = presets::by_name("figure-18")
        .expect("a preset")
        .guided()
        .unwrap()
        .synth(30_000)
        .synthesize(1)
        .expect("a tree");
    let tree = tree.relaxed(0.5, 3).expect("sound options");
    let kinds = [
        (Tubes::default().with_closed_base(true).with_wind(true), 0x709c_ae13_9298_fe92),
        (Tubes::default().with_error(0.002), 0xd787_4116_9d14_8a1c),
    ];
    for (tubes, pinned) in kinds {
        let hashes = at_thread_counts(|| mesh_hash(&tubes.mesh(&tree).expect("a surface")));
        all_the_same(&hashes, "the tubes");
        assert_eq!(hashes[0], pinned, "another mesh: {:#x}", hashes[0]);
    }
    let levels = || {
        let levels = Levels::default().of(&tree).expect("levels");
        let hashes = levels.iter().map(|level| mesh_hash(&level.mesh) ^ u64::from(level.error.to_bits()));
        fnv1a(hashes.flat_map(u64::to_le_bytes))
    };
    all_the_same(&at_thread_counts(levels), "the levels");
}

/// Blocks are made and marched in parallel, and joined in order.
#[test]
fn closed_surfaces_do_not_depend_on_the_threads() {
    let tree = presets::by_name("figure-06c")
        .expect("a preset")
        .guided()
        .unwrap()
        .synth(3000)
        .synthesize(1)
        .expect("a tree");
    for error in [0.0, 0.1] {
        let hash = || {
            let surface = Implicit::default().with_voxel(0.01).with_error(error);
            let mesh = surface.mesh(&tree).expect("a surface");
            let indices = mesh.indices.iter().flat_map(|index| index.to_le_bytes());
            fnv1a(of_positions(&mesh.positions).chain(of_positions(&mesh.normals)).chain(indices))
        };
        all_the_same(&at_thread_counts(hash), "the surface");
    }
}
