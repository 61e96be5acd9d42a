//! Gaps between tubes and their parent branches, measured on the triangles.

use super::plan::Plan;
use super::{Mesh, Tubes};
use crate::Skeleton;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// The largest gap between a tube's first ring and the wood of its parent branch: metres, and radii of the
/// tube.
const GAP: f64 = 2e-3;
const GAP_RADII: f64 = 0.1;
/// A gap that rounding makes, metres.
const NOTHING: f64 = 1e-5;
/// Triangles that share one box.
const CHUNK: usize = 16;

/// The tube of an axis: a closed body.
struct Tube {
    /// The vertices of its first ring.
    ring: Range<usize>,
    /// Its indices in the mesh.
    indices: Range<usize>,
    /// The number of its parent tube.
    parent: Option<usize>,
    /// Radius of its first internode, metres.
    radius: f64,
    place: Vec3,
}

/// Gap between the start of a tube and its parent branch.
#[derive(Debug, Clone, Copy)]
#[allow(dead_code, reason = "what is not read is printed")]
struct Gap {
    /// Gap between its first ring and the parent branch, or the branch that bears that one, metres.
    width: f64,
    radius: f64,
    place: Vec3,
}

impl Gap {
    fn floats(&self) -> bool {
        self.width > GAP.min(GAP_RADII * self.radius)
    }
}

/// The triangles of a tube, with boxes around each few of them.
struct Body {
    triangles: Vec<[DVec3; 3]>,
    boxes: Vec<[DVec3; 2]>,
}

impl Body {
    fn of(mesh: &Mesh, tube: &Tube) -> Self {
        let corner = |index: &u32| mesh.positions[*index as usize].as_dvec3();
        let triangles: Vec<[DVec3; 3]> = mesh.indices[tube.indices.clone()]
            .chunks_exact(3)
            .map(|indices| [corner(&indices[0]), corner(&indices[1]), corner(&indices[2])])
            .collect();
        Self::of_triangles(triangles)
    }

    fn of_triangles(triangles: Vec<[DVec3; 3]>) -> Self {
        let around = |chunk: &[[DVec3; 3]]| {
            let corners = chunk.as_flattened();
            corners.iter().fold([DVec3::MAX, DVec3::MIN], |[low, high], &p| [low.min(p), high.max(p)])
        };
        Self { boxes: triangles.chunks(CHUNK).map(around).collect(), triangles }
    }

    /// Distance of a point outside of it; zero on it and within.
    fn outside(&self, point: DVec3) -> f64 {
        let distance = self.distance(point);
        if distance > NOTHING && self.holds(point) { 0.0 } else { distance }
    }

    fn distance(&self, point: DVec3) -> f64 {
        let mut best = f64::MAX;
        for (chunk, [low, high]) in self.triangles.chunks(CHUNK).zip(&self.boxes) {
            if point.distance_squared(point.clamp(*low, *high)) < best {
                for &triangle in chunk {
                    best = best.min(point.distance_squared(nearest(point, triangle)));
                }
            }
        }
        best.sqrt()
    }

    /// `true` if its triangles wind around a point, judged by the triangles that rays from there cross.
    /// Several rays vote, since one may graze an edge.
    fn holds(&self, point: DVec3) -> bool {
        let ways =
            [DVec3::new(0.31, 0.53, 0.79), DVec3::new(-0.83, 0.27, 0.49), DVec3::new(0.43, -0.71, 0.56)];
        let votes = ways.iter().filter(|way| self.winding(point, **way) > 0).count();
        votes >= 2
    }

    fn winding(&self, point: DVec3, way: DVec3) -> i32 {
        let mut winding = 0;
        for (chunk, [low, high]) in self.triangles.chunks(CHUNK).zip(&self.boxes) {
            let [a, b] = [(*low - point) / way, (*high - point) / way];
            if a.min(b).max_element() > a.max(b).min_element() || a.max(b).min_element() < 0.0 {
                continue;
            }
            for [a, b, c] in chunk.iter().map(|triangle| triangle.map(|corner| corner - point)) {
                // The side of each edge on which the ray passes.
                let sides = [way.dot(a.cross(b)), way.dot(b.cross(c)), way.dot(c.cross(a))];
                let facing = (b - a).cross(c - a);
                if sides.iter().all(|side| *side >= 0.0) && facing.dot(a) > 0.0 {
                    winding += 1;
                } else if sides.iter().all(|side| *side <= 0.0) && facing.dot(a) < 0.0 {
                    winding -= 1;
                }
            }
        }
        winding
    }
}

/// The point of a triangle that is nearest (Ericson 2004, "Real-Time Collision Detection", 5.1.5).
fn nearest(point: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let [d1, d2] = [ab, ac].map(|side| side.dot(point - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let [d3, d4] = [ab, ac].map(|side| side.dot(point - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let [d5, d6] = [ab, ac].map(|side| side.dot(point - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let total = va + vb + vc;
    a + ab * (vb / total) + ac * (vc / total)
}

/// The tubes of a plan, and their mesh. Their bases are closed, so that inside and outside are defined.
fn tubes(plan: &Plan, options: &Tubes) -> (Vec<Tube>, Mesh) {
    let mut tubes: Vec<Tube> = Vec::new();
    let (mut vertices, mut indices) = (0, 0);
    let mesh = plan.weave_each(&options.clone().with_closed_base(true), |axis, mesh| {
        let first = axis.base;
        let number = tubes.len();
        let parent = match axis.bearer {
            Some(node) => plan.axes.place(node).map(|(axis, _)| axis).filter(|parent| *parent != number),
            // After a sharp turn the branch goes on from the end of its last part.
            None => number.checked_sub(1).filter(|last| plan.axes.all[*last].branch == axis.branch),
        };
        let all = vertices..mesh.positions.len();
        let ring = vertices..(vertices + axis.sides as usize + 1).min(all.end);
        // A tube that begins with no radius begins with one vertex.
        let is_point = !axis.has_collar && plan.axes.stations[axis.stations.start].radius == 0.0;
        let ring = if is_point { vertices..vertices + 1 } else { ring };
        let radius = f64::from(first.radius);
        tubes.push(Tube {
            ring,
            indices: indices..mesh.indices.len(),
            parent,
            radius,
            place: first.position,
        });
        (vertices, indices) = (mesh.positions.len(), mesh.indices.len());
    });
    (tubes, mesh)
}

/// Gap between the start of each tube of a skeleton and its parent branch.
fn gaps(skeleton: &Skeleton, options: &Tubes) -> Vec<Gap> {
    let plan = options.plan(skeleton).expect("a skeleton with a surface");
    let (tubes, mesh) = tubes(&plan, options);
    gaps_of(&tubes, &mesh, 1)
}

/// The gaps of the tubes in a mesh: of every `each`-th tube.
fn gaps_of(tubes: &[Tube], mesh: &Mesh, each: usize) -> Vec<Gap> {
    let mut bodies: Vec<Option<Body>> = tubes.iter().map(|_| None).collect();
    let mut gaps = Vec::new();
    for tube in tubes.iter().filter(|tube| tube.parent.is_some()).step_by(each) {
        let mut gap = Gap { width: 0.0, radius: tube.radius, place: tube.place };
        for point in &mesh.positions[tube.ring.clone()] {
            let (mut least, mut parent) = (f64::MAX, tube.parent);
            while let Some(number) = parent.filter(|_| least > NOTHING) {
                let body = bodies[number].get_or_insert_with(|| Body::of(mesh, &tubes[number]));
                least = least.min(body.outside(point.as_dvec3()));
                parent = tubes[number].parent;
            }
            gap.width = gap.width.max(least);
        }
        gaps.push(gap);
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::skeletons;
    use crate::{presets, variational};
    use proptest::prelude::*;
    use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

    /// Fails where a tube of these skeletons floats; says how many do and which is worst.
    fn check(name: &str, skeletons: &[Skeleton], options: &Tubes) {
        for skeleton in skeletons.iter().filter(|skeleton| skeleton.segments() > 0) {
            let gaps = gaps(skeleton, options);
            let floating = gaps.iter().filter(|gap| gap.floats());
            if let Some(worst) = floating.clone().max_by(|a, b| a.width.total_cmp(&b.width)) {
                panic!("{name}: {} of {} tubes float, the worst {worst:?}", floating.count(), gaps.len());
            }
        }
    }

    /// Checks the trees of all presets of the guided and the variational system, with `nodes` nodes and
    /// `shape_nodes` shape nodes each.
    fn check_presets(seeds: u64, nodes: usize, shape_nodes: usize, options: &Tubes) {
        for seed in 0..seeds {
            for preset in presets::guided() {
                let tree = preset.synth(nodes).synthesize(preset.seed + seed).expect("a tree");
                let relaxed = tree.clone().relaxed(0.5, 3).expect("sound options");
                check(preset.name, &[tree, relaxed], options);
            }
            for preset in variational::presets() {
                let synth = preset.synth(shape_nodes).expect("enough shape nodes");
                check(preset.name, &[synth.synthesize(preset.seed + seed).expect("a tree")], options);
            }
        }
    }

    #[test]
    fn tubes_touch_what_bears_them() {
        check_presets(2, 5_000, 300, &Tubes::default());
    }

    #[test]
    fn tubes_of_stands_touch_what_bears_them() {
        for stand in presets::stands() {
            let mut forest = stand.plant(stand.seed).expect("a preset");
            forest.grow(stand.seasons.min(12)).expect("seasons");
            let trees = forest.skeletons().expect("skeletons");
            check(stand.name, &trees, &Tubes::default().with_sides(6));
        }
    }

    #[test]
    fn tubes_of_grown_trees_touch_what_bears_them() {
        for preset in presets::grown() {
            let growth = preset.grow(preset.seed).expect("a preset");
            let ages = preset.ages.iter().map(|age| age.min(14.6));
            let trees: Vec<Skeleton> = ages.map(|age| growth.at(age).expect("an age").skeleton).collect();
            check(preset.name, &trees, &Tubes::default());
        }
    }

    #[test]
    fn tubes_with_an_error_touch_what_bears_them() {
        for (preset, error) in presets::guided().zip([0.001, 0.01, 0.1].into_iter().cycle()) {
            let tree = preset.synth(5_000).synthesize(preset.seed).expect("a tree");
            check(preset.name, &[tree], &Tubes::default().with_error(error).with_wind(true));
        }
    }

    #[test]
    fn tubes_of_any_skeleton_touch_what_bears_them() {
        let options = [
            Tubes::default(),
            Tubes::default().with_error(0.01),
            Tubes::default().with_sides(3).with_least_sides(3).with_root_flare(3.0),
            Tubes::default().with_turn(4.0),
        ];
        // None of 256,000 such tubes floats, but there is no guarantee for branches that turn on the spot; so
        // the cases are always the same ones.
        let config = Config { cases: 500, failure_persistence: None, ..Config::default() };
        let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
        let result = runner.run(&skeletons(40), |skeleton| {
            for tubes in options.iter().filter(|_| skeleton.segments() > 0) {
                let gaps = gaps(&skeleton, tubes);
                let floating: Vec<&Gap> = gaps.iter().filter(|gap| gap.floats()).collect();
                prop_assert!(floating.is_empty(), "{floating:?}");
            }
            Ok(())
        });
        result.expect("no tube floats");
    }

    /// Times and gusts, the strongest and in different directions.
    const GUSTS: [(f32, Vec3); 4] = [
        (0.6, Vec3::X),
        (1.9, Vec3::new(0.0, 0.0, -1.0)),
        (4.4, Vec3::new(-0.6, 0.2, 0.77)),
        (7.3, Vec3::new(0.2, 0.0, 0.1)),
    ];

    /// Greatest widening of a gap by the wind, in radii of the tube; rounding does not count.
    fn widened(skeleton: &Skeleton, options: &Tubes) -> f64 {
        let options = options.clone().with_wind(true);
        let plan = options.plan(skeleton).expect("a skeleton with a surface");
        let (tubes, mesh) = tubes(&plan, &options);
        let still = gaps_of(&tubes, &mesh, 1);
        let mut worst = 0.0f64;
        for (time, gust) in GUSTS {
            let blown = mesh.blown(time, gust);
            for (before, after) in still.iter().zip(gaps_of(&tubes, &blown, 1)) {
                let more = after.width - before.width - 2.0 * NOTHING;
                worst = worst.max(more / after.radius.max(1e-9));
            }
        }
        worst
    }

    #[test]
    fn no_gust_opens_a_gap() {
        let mut worst = ("", 0.0);
        for preset in presets::guided() {
            let tree = preset.synth(3_000).synthesize(preset.seed).expect("a tree");
            let tree = tree.relaxed(0.5, 3).expect("sound options");
            for options in
                [Tubes::default(), Tubes::default().with_error(0.01), Tubes::default().with_error(0.1)]
            {
                let more = widened(&tree, &options);
                println!("{} {:?}: {more}", preset.name, options.error);
                worst = if more > worst.1 { (preset.name, more) } else { worst };
            }
        }
        assert!(worst.1 <= 0.01, "{worst:?}");
    }

    #[test]
    fn no_gust_opens_a_gap_of_any_skeleton() {
        let config = Config { cases: 300, failure_persistence: None, ..Config::default() };
        let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
        let result = runner.run(&skeletons(40), |skeleton| {
            for options in [Tubes::default(), Tubes::default().with_error(0.1)] {
                let more = if skeleton.segments() > 0 { widened(&skeleton, &options) } else { 0.0 };
                prop_assert!(more <= 0.01, "{more}");
            }
            Ok(())
        });
        result.expect("no gap opens");
    }

    /// One tube in this many is checked on trees of full size, and some of the presets, since all of them
    /// take minutes.
    const SAMPLED: usize = 23;

    #[test]
    fn tubes_of_full_size_touch_what_bears_them() {
        let check = |name: &str, skeleton: &Skeleton| {
            let options = Tubes::default();
            let plan = options.plan(skeleton).expect("a skeleton with a surface");
            let (tubes, mesh) = tubes(&plan, &options);
            let gaps = gaps_of(&tubes, &mesh, SAMPLED);
            if let Some(floating) = gaps.iter().find(|gap| gap.floats()) {
                panic!("{name}: of {} sampled tubes one floats, {floating:?}", gaps.len());
            }
        };
        for preset in presets::guided().step_by(6) {
            let tree = preset.synth(presets::TYPICAL_NODES).synthesize(preset.seed).expect("a tree");
            check(preset.name, &tree);
        }
        for preset in variational::presets().step_by(6) {
            let synth = preset.synth(3_500).expect("enough shape nodes");
            check(preset.name, &synth.synthesize(preset.seed).expect("a tree"));
        }
        for stand in presets::stands().step_by(5) {
            let forest = stand.grow(stand.seed).expect("a preset");
            for skeleton in forest.skeletons().expect("skeletons").iter().take(1) {
                if skeleton.segments() > 0 {
                    check(stand.name, skeleton);
                }
            }
        }
        for preset in presets::grown().step_by(4) {
            let growth = preset.grow(preset.seed).expect("a preset");
            let oldest = preset.ages.iter().copied().fold(0.0, f32::max);
            check(preset.name, &growth.at(oldest).expect("an age").skeleton);
        }
    }

    #[test]
    fn gaps_are_found() {
        let pole = Body::of_triangles(square_pole());
        assert!(pole.outside(DVec3::new(0.0, 0.5, 0.0)) == 0.0);
        assert!((pole.outside(DVec3::new(3.0, 0.5, 0.0)) - 2.0).abs() < 1e-9);
        assert!((pole.outside(DVec3::new(0.0, 1.25, 0.0)) - 0.25).abs() < 1e-9);
    }

    /// A closed box around the y axis, 2 m wide and 1 m high.
    fn square_pole() -> Vec<[DVec3; 3]> {
        let corner = |turn: usize, y: f64| {
            let [x, z] = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]][turn % 4];
            DVec3::new(x, y, z)
        };
        let (bottom, top) = (DVec3::ZERO, DVec3::Y);
        let side = |turn: usize| {
            let [a, b] = [corner(turn, 0.0), corner(turn + 1, 0.0)];
            let [c, d] = [corner(turn, 1.0), corner(turn + 1, 1.0)];
            [[a, b, d], [a, d, c], [bottom, b, a], [top, c, d]]
        };
        (0..4).flat_map(side).collect()
    }
}
