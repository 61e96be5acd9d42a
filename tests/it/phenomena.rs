//! The results of the example `phenomena`, held to what its pictures claim.
#![allow(dead_code, reason = "pictures are drawn by the example alone")]

#[path = "../../examples/phenomena/cracks.rs"]
mod cracks;
#[path = "../../examples/phenomena/ivy.rs"]
mod ivy;
#[path = "../../examples/phenomena/lightning.rs"]
mod lightning;
#[path = "../../examples/phenomena/planar.rs"]
mod planar;
#[path = "../../examples/phenomena/rivers.rs"]
mod rivers;
#[path = "../../examples/phenomena/roots.rs"]
mod roots;
#[path = "../../examples/phenomena/ruin.rs"]
mod ruin;
#[path = "../../examples/phenomena/solid.rs"]
mod solid;
#[path = "../../examples/phenomena/wind.rs"]
mod wind;

use std::collections::BTreeMap;
use treesynth::field::Uniform;
use treesynth::glam::Vec3;
use treesynth::guided::Search;
use treesynth::{Silent, testing};

#[test]
fn rivers_run_downhill_and_keep_hacks_law() {
    let mut exponents = Vec::new();
    for seed in 1..=12 {
        let (tree, graph) = rivers::rivers(12_000, seed).expect("a land");
        testing::check_skeleton(&tree).expect("a tree");
        assert_eq!(tree.len(), graph.nodes(), "all water reaches the outlet");
        for (node, parent) in tree.edges() {
            let fall = tree.positions()[node].y - tree.positions()[parent].y;
            assert!(fall > 0.0, "seed {seed}: node {node} runs uphill by {} m", -fall);
        }
        exponents.push(rivers::hack(&tree));
    }
    println!("Hack's exponents: {exponents:.3?}");
    assert!(exponents.iter().all(|exponent| (0.5..=0.6).contains(exponent)), "{exponents:.3?}");
}

#[test]
fn twigs_follow_a_simulated_wind() {
    let wind = wind::simulated().expect("a field");
    for seed in 1..=5 {
        let grow = |synth: treesynth::guided::TreeSynth| synth.synthesize(seed).expect("a shrub");
        let tree = grow(wind::shrub(20_000, wind.clone()));
        let still = grow(wind::shrub(20_000, Uniform::new(Vec3::Y)));
        let (with, without) = (wind::along(&tree, &wind), wind::along(&still, &wind));
        println!("cosine to the wind: {with} in it, {without} without");
        assert!(with > 0.6 && without < with - 0.4, "seed {seed}: {with}, {without}");
        for position in tree.positions() {
            assert!(position.length() >= wind::ROCK && position.y >= 0.0, "{position} is in the rock");
        }
    }
}

#[test]
fn roots_stay_below_ground_and_out_of_stones() {
    for seed in 1..=5 {
        let tree = roots::roots(20_000).synthesize(seed).expect("roots");
        testing::check_skeleton(&tree).expect("a tree");
        for &position in tree.positions() {
            assert!(position.y <= 0.0, "{position} is above ground");
            for (center, radius) in roots::STONES {
                assert!(position.distance(center) >= radius, "{position} is in a stone");
            }
        }
        let deepest = tree.positions().iter().map(|p| p.y).fold(0.0, f32::min);
        let shallow = roots::share_above(&tree, 0.6);
        println!("roots to {deepest} m, {shallow} of the length above 0.6 m");
        assert!(deepest < -1.2, "a tap root");
        assert!((0.25..0.75).contains(&shallow), "seed {seed}: {shallow}");
    }
}

#[test]
fn lightning_strikes_and_its_branches_descend() {
    for seed in 1..=5 {
        let synth = lightning::stroke(20_000);
        let graph = synth.build_graph(seed, &Silent).expect("a graph");
        let growth = synth.grow(&mut Search::new(&graph), seed, &Silent).expect("a stroke");
        let tree = &growth.skeleton;
        let ground = growth.endpoints[0].iter().map(|&node| graph.position(node).y).fold(0.0, f32::max);
        assert!(ground < 30.0, "it strikes at {ground} m");
        let longer = lightning::tortuosity(tree);
        println!("main channel {longer} times as long as straight");
        assert!((1.1..1.8).contains(&longer), "seed {seed}: {longer}");
        let stages = tree.stages();
        for end in tree.tips().filter(|&tip| stages[tip] > 0) {
            let mut start = end;
            while let Some(parent) = tree.parent(start).filter(|_| stages[start] == stages[end]) {
                start = parent;
            }
            assert!(tree.positions()[end].y < tree.positions()[start].y, "a branch ends above its source");
        }
    }
}

/// No crack ends in the open but at the mud's border, and each cell is in one piece with cracks all around.
#[test]
fn cracks_close_their_cells() {
    for seed in 1..=5 {
        let found = cracks::cracks(4_000, seed).expect("mud");
        let (nodes, triangles) = (found.graph.nodes(), &found.triangles);
        // Euler: as many faces as a planar graph of so many edges in one piece has, but for the outer one.
        assert_eq!(nodes + triangles.len() + 1, found.graph.edges() / 2 + 2);
        let mut sides: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for &[a, b, c] in triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let mut ends = vec![0; triangles.len()];
        for &(one, two) in &found.cracks {
            ends[one as usize] += 1;
            ends[two as usize] += 1;
        }
        for (triangle, &count) in triangles.iter().zip(&ends) {
            let [a, b, c] = *triangle;
            let border = [(a, b), (b, c), (c, a)].iter().any(|&(a, b)| sides[&[a.min(b), a.max(b)]] == 1);
            assert!(count != 1 || border, "seed {seed}: a crack ends in the open");
        }
        // Each cell hangs together without crossing a crack.
        let mut seen = vec![false; nodes];
        let mut pieces = 0;
        for first in 0..nodes {
            if std::mem::replace(&mut seen[first], true) {
                continue;
            }
            pieces += 1;
            let mut found_nodes = vec![first as u32];
            while let Some(node) = found_nodes.pop() {
                for &to in found.graph.neighbours(node) {
                    let same = found.cells[to as usize] == found.cells[node as usize];
                    if same && !std::mem::replace(&mut seen[to as usize], true) {
                        found_nodes.push(to);
                    }
                }
            }
        }
        let mut names = found.cells.clone();
        names.sort_unstable();
        names.dedup();
        println!("{} cells in {pieces} pieces", names.len());
        assert!(names.len() > 40 && pieces == names.len(), "{} cells in {pieces} pieces", names.len());
    }
}

#[test]
fn ivy_lies_on_the_wall_and_its_leaves_look_away() {
    for seed in 1..=3 {
        let ivy = ivy::ivy(8_000, seed).expect("an ivy");
        testing::check_skeleton(&ivy.tree).expect("a tree");
        let corners: Vec<[Vec3; 3]> = ivy
            .ruin
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| ivy.ruin.positions[corner as usize]))
            .collect();
        // On a triangle: in its plane, and within its three sides.
        let lies_on = |point: Vec3, normal: Vec3| {
            corners.iter().any(|&[a, b, c]| {
                let face = (b - a).cross(c - a).normalize();
                let within = |p: Vec3, q: Vec3| (q - p).cross(point - p).dot(face) >= -1e-5;
                (point - a).dot(face).abs() < 1e-4
                    && face.dot(normal) > 0.999
                    && within(a, b)
                    && within(b, c)
                    && within(c, a)
            })
        };
        for (&position, &normal) in ivy.tree.positions().iter().zip(&ivy.normals) {
            assert!(lies_on(position, normal), "{position} is off the wall");
        }
        let stems = ivy.stems().expect("stems");
        let leaves = ivy.leaves(&stems, seed).expect("leaves");
        assert!(leaves.instances.len() > 500);
        let out = |leaf: &treesynth::surface::Instance| {
            (leaf.rotation * Vec3::Z).dot(ivy.normals[leaf.node as usize])
        };
        let cosines: Vec<f32> = leaves.instances.iter().map(out).collect();
        let mean = cosines.iter().sum::<f32>() / cosines.len() as f32;
        let least = cosines.iter().copied().fold(1.0, f32::min);
        println!("leaves face out: {mean} on the mean, {least} at least");
        assert!(mean > 0.9 && least > 0.5, "seed {seed}: {mean}, {least}");
        let highest = ivy.tree.positions().iter().map(|p| p.y).fold(0.0, f32::max);
        assert!(highest > 2.3, "it climbs to {highest} m of 3.4");
    }
}
