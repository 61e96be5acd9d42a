//! Limbs drawn by the user: what is drawn is what stands.

use rand::RngExt;
use std::collections::BTreeSet;
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{
    Bend, Canvas, DrawnLimbs, ForkAngle, LimbSurface, PoissonYao, Stage, Stroke, TreeSynth,
};
use treesynth::random::{Purpose, stream};
use treesynth::shape::Cuboid;
use treesynth::{ParameterError, Skeleton};

const SPACING: f32 = 0.15;

/// A trunk and some limbs that wander, most of which start away from what is drawn before.
fn random_lines(seed: u64) -> Vec<Vec<Vec3>> {
    let mut random = stream(seed, 0, Purpose::CUSTOM, 0);
    let mut draw = |low: f32, high: f32| low + (high - low) * random.random::<f32>();
    let mut line = |start: Vec3, heading: Vec3, step: f32| -> Vec<Vec3> {
        let mut points = vec![start];
        let mut heading = heading;
        for _ in 0..2 + draw(0.0, 9.0) as usize {
            heading = (heading + Vec3::new(draw(-0.6, 0.6), draw(-0.6, 0.6), draw(-0.6, 0.6))).normalize();
            let next = points[points.len() - 1] + heading * step * draw(0.3, 1.7);
            points.push(next.max(Vec3::new(-2.4, 0.05, -2.4)).min(Vec3::new(2.4, 4.4, 2.4)));
            if points[points.len() - 1] == points[points.len() - 2] {
                points.pop();
            }
        }
        points
    };
    let mut lines = vec![line(Vec3::ZERO, Vec3::Y, 0.5)];
    let top = lines[0].iter().fold(0.5, |top: f32, point| top.max(point.y));
    for number in 0..=(seed as usize % 7) {
        let turn = number as f32 * 2.4;
        let side = Vec3::new(turn.cos(), 0.3, turn.sin());
        let start = Vec3::Y * top * (0.3 + 0.1 * number as f32) + side * (0.3 * (seed % 4) as f32);
        lines.push(line(start.max(Vec3::Y * 0.1), side, 0.35));
    }
    lines.retain(|line| line.len() > 1);
    lines
}

/// The parts of a tree that stood before its stages, as internodes.
fn drawn_part(tree: &Skeleton, orders: u16) -> Vec<[Vec3; 2]> {
    let stands = |&(node, _): &(usize, usize)| tree.stages()[node] <= orders;
    tree.edges()
        .filter(stands)
        .map(|(node, parent)| [tree.positions()[parent], tree.positions()[node]])
        .collect()
}

fn mean_distance(line: &[Vec3], internodes: &[[Vec3; 2]]) -> f32 {
    let to = |point: Vec3, [a, b]: &[Vec3; 2]| {
        let way = *b - *a;
        let t = ((point - *a).dot(way) / way.length_squared().max(1e-20)).clamp(0.0, 1.0);
        (*a + way * t).distance(point)
    };
    let mut distances = Vec::new();
    for pair in line.windows(2) {
        for part in 0..20 {
            let point = pair[0].lerp(pair[1], part as f32 / 20.0);
            let least = internodes.iter().map(|internode| to(point, internode)).fold(f32::INFINITY, f32::min);
            distances.push(least);
        }
    }
    distances.iter().sum::<f32>() / distances.len() as f32
}

fn bits(point: Vec3) -> [u32; 3] {
    (point + Vec3::ZERO).to_array().map(f32::to_bits)
}

fn grown(limbs: Skeleton, seed: u64) -> Skeleton {
    let region = Cuboid::new(Vec3::new(-2.6, 0.0, -2.6), Vec3::new(2.6, 4.6, 2.6));
    TreeSynth::new(PoissonYao::new(region).with_spacing(SPACING).with_tree(limbs))
        .stage(Stage::new(ForkAngle::new(0.8, Bend::none()), LimbSurface::new(2, 0.4)))
        .synthesize(seed)
        .unwrap()
}

#[test]
fn limbs_are_where_they_are_drawn_and_their_points_stay() {
    let mut worst = 0.0f32;
    for seed in 0..60 {
        let lines = random_lines(seed);
        let smooth = seed % 3 == 0;
        let stroke = |line: &Vec<Vec3>| {
            let stroke = Stroke::new(line.clone());
            if smooth { stroke.smoothed() } else { stroke }
        };
        let drawn = DrawnLimbs::from_strokes(lines.iter().map(stroke).collect::<Vec<_>>());
        let limbs = drawn.skeleton().unwrap();
        limbs.check().unwrap();
        let orders = *limbs.orders().iter().max().unwrap();
        let tree = grown(limbs.clone(), seed);
        let places: BTreeSet<_> = tree.positions().iter().map(|&point| bits(point)).collect();
        let internodes = drawn_part(&tree, orders);
        for line in &lines {
            assert!(line.iter().all(|&point| places.contains(&bits(point))), "seed {seed}: a point is gone");
            let mean = mean_distance(line, &internodes);
            worst = worst.max(mean);
            assert!(mean <= SPACING, "seed {seed}: {mean}");
        }
        assert!(limbs.positions().iter().all(|&point| places.contains(&bits(point))), "seed {seed}");
    }
    println!("worst mean distance {worst}");
}

#[test]
fn depth_keeps_the_projection() {
    let flat = |points: &[[f32; 2]]| points.iter().map(|&point| Vec2::from(point)).collect::<Vec<_>>();
    let canvas = Canvas::new(Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.6, 0.0, 0.8), Vec3::Y);
    let lines = [
        flat(&[[0.0, 0.0], [0.1, 1.0], [0.0, 2.0], [0.2, 3.0]]),
        flat(&[[0.1, 1.0], [0.7, 1.4], [1.5, 1.5]]),
        flat(&[[-0.4, 1.5], [-1.0, 1.9], [-1.4, 2.6]]),
        flat(&[[0.8, 1.5], [1.0, 1.9], [1.4, 2.1]]),
        flat(&[[0.3, 2.4], [0.8, 2.9]]),
    ];
    let drawn = DrawnLimbs::from_strokes(lines.clone().map(|line| Stroke::on(canvas, line)));
    let spread = |drawn: &DrawnLimbs| {
        let tree = drawn.skeleton().unwrap();
        let depth = |point: &Vec3| (*point - Vec3::new(1.0, 0.0, 2.0)).dot(canvas.normal());
        let depths: Vec<f32> = tree.positions().iter().map(depth).collect();
        let seen: Vec<Vec3> =
            tree.positions().iter().zip(&depths).map(|(&p, &depth)| p - canvas.normal() * depth).collect();
        for point in lines.iter().flatten() {
            let nearest = seen.iter().map(|p| p.distance(canvas.point(*point))).fold(f32::INFINITY, f32::min);
            assert!(nearest < 1e-5, "{point}: {nearest}");
        }
        let least = depths.iter().copied().fold(0.0, f32::min);
        [least, depths.iter().copied().fold(0.0, f32::max)]
    };
    assert!(spread(&drawn).iter().all(|depth| depth.abs() < 1e-5));
    let [behind, before] = spread(&drawn.with_depth(0.9));
    assert!(behind < -0.2 && before > 0.2, "{behind} {before}");
}

#[test]
fn strokes_join_where_they_start() {
    let trunk = Stroke::new([Vec3::ZERO, Vec3::Y * 4.0]).with_diameters(0.4, 0.1);
    let level =
        |y: f32, start: f32, end: f32| Stroke::new([Vec3::new(start, y, 0.0), Vec3::new(end, y + 0.4, 0.0)]);
    // One that starts on the trunk, one far away, one that goes on from its top.
    let drawn = DrawnLimbs::new(trunk)
        .with_stroke(level(1.37, 0.0, 1.5))
        .with_stroke(level(3.0, 0.8, 1.8).with_diameters(0.05, 0.02))
        .with_stroke(Stroke::new([Vec3::Y * 4.0, Vec3::new(0.3, 4.8, 0.0)]));
    let tree = drawn.skeleton().unwrap();
    let branches = tree.branches();
    let mut branches: Vec<_> = branches.iter().collect();
    branches.sort_by(|a, b| {
        tree.positions()[a.nodes()[0] as usize].y.total_cmp(&tree.positions()[b.nodes()[0] as usize].y)
    });
    assert_eq!(branches.iter().map(treesynth::skeleton::Branch::order).collect::<Vec<_>>(), [0, 1, 1]);
    let place = |branch: usize, i: usize| tree.positions()[branches[branch].nodes()[i] as usize];
    assert_eq!(place(1, 0), Vec3::new(0.0, 1.37, 0.0));
    let trunk = branches[0].nodes();
    assert_eq!(tree.positions()[trunk[trunk.len() - 1] as usize], Vec3::new(0.3, 4.8, 0.0));
    // The connecting piece begins below, and leaves at about 50 degrees.
    assert!((2.0..2.5).contains(&place(2, 0).y), "{}", place(2, 0));
    let leaves = (place(2, 1) - place(2, 0)).angle_between(Vec3::Y).to_degrees();
    assert!((40.0..60.0).contains(&leaves), "{leaves}");
    assert_eq!(tree.radii()[0], 0.2);
    let radius = |at: Vec3| tree.radii()[tree.positions().iter().position(|&place| place == at).unwrap()];
    assert!(
        (radius(Vec3::Y * 4.0) - 0.05).abs() < 1e-6 && (radius(Vec3::new(1.8, 3.4, 0.0)) - 0.01).abs() < 1e-6
    );
}

#[test]
fn thickness_is_the_least_that_a_limb_has() {
    let trunk = Stroke::new([Vec3::ZERO, Vec3::Y * 3.0]).with_diameters(0.6, 0.3);
    let limb = Stroke::new([Vec3::Y * 2.0, Vec3::new(1.5, 2.6, 0.2)]).with_diameters(0.2, 0.1);
    let limbs = DrawnLimbs::new(trunk).with_stroke(limb).skeleton().unwrap();
    let tree = grown(limbs.clone(), 3);
    for (place, radius) in limbs.positions().iter().zip(limbs.radii()) {
        let node = tree.positions().iter().position(|at| at == place).unwrap();
        assert!(tree.radii()[node] >= *radius, "{place}: {} below {radius}", tree.radii()[node]);
    }
}

#[test]
fn bad_strokes_are_named() {
    let trunk = || Stroke::new([Vec3::ZERO, Vec3::Y]);
    let refused = |drawn: DrawnLimbs, parameter: &str| {
        let error: ParameterError = drawn.skeleton().unwrap_err();
        assert_eq!(error.parameter, parameter, "{error}");
    };
    let with = |stroke: Stroke| DrawnLimbs::new(trunk()).with_stroke(stroke);
    refused(DrawnLimbs::from_strokes([]), "DrawnLimbs.strokes");
    refused(with(Stroke::new([Vec3::X])), "DrawnLimbs.strokes[1].points");
    refused(with(Stroke::new([])), "DrawnLimbs.strokes[1].points");
    for wrong in [f32::NAN, f32::INFINITY, 2e9] {
        refused(with(Stroke::new([Vec3::X, Vec3::X * wrong])), "DrawnLimbs.strokes[1].points[1]");
    }
    refused(with(Stroke::new([Vec3::X, Vec3::Z, Vec3::Z])), "DrawnLimbs.strokes[1].points[2]");
    // Back to the trunk base, where there is a node.
    refused(with(Stroke::new([Vec3::X, Vec3::ZERO])), "DrawnLimbs.strokes[1].points[1]");
    refused(with(trunk().with_diameters(-1.0, 0.0)), "DrawnLimbs.strokes[1].diameters");
    let level = Canvas::new(Vec3::ZERO, Vec3::X, Vec3::X * 2.0);
    refused(with(Stroke::on(level, [Vec2::ZERO, Vec2::ONE])), "Canvas.up");
    for angle in [0.0, 2.0, f32::NAN] {
        refused(DrawnLimbs::new(trunk()).with_angle(angle), "DrawnLimbs.angle");
    }
    for depth in [-0.1, 1.5, f32::NAN] {
        refused(DrawnLimbs::new(trunk()).with_depth(depth), "DrawnLimbs.depth");
    }
    for detail in [0.0, 1e-9, f32::NAN] {
        refused(DrawnLimbs::new(trunk()).with_detail(detail), "DrawnLimbs.detail");
    }
    assert!(Stroke::from_svg_path(Canvas::front(), "M 0 0 Q").is_err());
    assert!(Stroke::from_svg_path(Canvas::front(), "M 0 0").is_err());
    assert_eq!(
        Stroke::from_svg_path(Canvas::front(), "M 0 0 L 0 -3 M 0 -1 Q 1 -1 2 -2").map(|s| s.len()),
        Ok(2)
    );
}
