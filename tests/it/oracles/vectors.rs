//! Guiding vectors (sections 3.1.2 and 3.2.1): incremental rotations, worked out again in double precision.

use crate::sample::{Nothing, built, cases, cube_graph, degrees, plot, turned};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use treesynth::field::{Helix, SphericalMeridians};
use treesynth::glam::{DVec3, Vec3};
use treesynth::guided::{
    Bend, BendAxis, Blend, ByHeight, ByStage, Count, FollowField, Graph, HopSurface, InShape, NearestTo,
    PoissonYao, Search, SourceElevation, SourceVector, Stage, TreeSynth,
};
use treesynth::shape::Ellipsoid;
use treesynth::{GuidingRule, Silent, VectorField};

/// A node as the rule under test left it.
struct Node {
    /// Edges from the source.
    hops: u32,
    source: u32,
    stage: usize,
    position: DVec3,
    edge: DVec3,
    /// Of the node before.
    before: DVec3,
    vector: DVec3,
}

/// Three stages with `rule`, the third without endpoints; all nodes of every stage go to `check`.
fn each_node(graph: &Graph, seed: u64, rule: &Arc<dyn GuidingRule>, mut check: impl FnMut(&Node)) {
    let crown = Ellipsoid::new(Vec3::Y * 3.6, Vec3::new(2.0, 1.6, 2.0));
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Arc::clone(rule), NearestTo::new(Vec3::Y * 4.0)))
        .stage(Stage::new(Arc::clone(rule), InShape::uniform(crown, Count::UpTo(10))))
        .stage(Stage::new(Arc::clone(rule), HopSurface::new(2, Count::UpTo(20))))
        .stage(Stage::new(Arc::clone(rule), Nothing));
    let mut search = Search::new(graph);
    let mut seen = 0;
    for stage in 0..4 {
        let mut source = vec![false; graph.nodes()];
        for &node in search.tree() {
            source[node as usize] = true;
        }
        synth.grow_stage(&mut search, stage, seed, &Silent).expect("endpoints enough");
        let at = |node: u32| graph.position(node).as_dvec3();
        for node in (0..graph.nodes() as u32).filter(|&node| !source[node as usize]) {
            let Some(vector) = search.vector(node) else { continue };
            let parent = search.parent(node).expect("settled");
            let (mut from, mut hops) = (parent, 1);
            while !source[from as usize] {
                from = search.parent(from).expect("settled before");
                hops += 1;
            }
            assert_eq!(search.hops(node), hops, "node {node} of stage {stage}");
            assert!((vector.length() - 1.0).abs() < 1e-5, "{vector} is no unit vector");
            check(&Node {
                hops,
                source: from,
                stage,
                position: at(node),
                edge: (at(node) - at(parent)).normalize(),
                before: search.vector(parent).expect("settled before").as_dvec3(),
                vector: vector.as_dvec3(),
            });
            seen += 1;
        }
    }
    assert!(seen > graph.nodes());
}

/// "The vector is rotated about an axis perpendicular to both the up direction and the traversed edge."
fn rotated(node: &Node, angle: f64) -> DVec3 {
    let axis = DVec3::Y.cross(node.edge);
    if axis.length() < 1e-5 { node.before } else { turned(node.before, axis.normalize(), angle) }
}

fn assert_vector(node: &Node, expected: DVec3) {
    // Next to a vertical edge the axis is little more than rounding.
    if DVec3::Y.cross(node.edge).length() > 1e-3 {
        let apart = node.vector.distance(expected);
        assert!(apart < 1e-4, "{} instead of {expected} at hop {}", node.vector, node.hops);
    }
}

fn equation_1(node: &Node, first: f32, rest: f32, h0: u32) -> f64 {
    f64::from(if node.hops <= h0 { first } else { rest })
}

/// β is "the angle, in radians, between the node's position vector and the up vector, with the root at the origin".
fn equation_2(node: &Node, root: DVec3, theta: f32) -> f64 {
    let beta = (node.position - root).angle_between(DVec3::Y);
    f64::from(theta) * (beta / PI).sqrt()
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn equation_1_turns(seed: u64, first in -180f32..180.0, rest in -30f32..30.0, h0 in 0u32..12) {
        let (first, rest) = (degrees(first), degrees(rest));
        let rule: Arc<dyn GuidingRule> = Arc::new(Bend::piecewise(first, rest, h0));
        each_node(&cube_graph(500, seed), seed, &rule, |node| {
            assert_vector(node, rotated(node, equation_1(node, first, rest, h0)));
        });
    }

    #[test]
    fn equation_2_turns_about_the_root_wherever_it_is(seed: u64, theta in -90f32..90.0, shift in -2f32..2.0) {
        let theta = degrees(theta);
        let root = Vec3::new(shift, 0.5, -shift * 0.5);
        let graph = built(&PoissonYao::new(plot(6.0, 6.0)).with_nodes(500).with_root(root), seed);
        let rule: Arc<dyn GuidingRule> = Arc::new(Bend::from_axis(theta));
        each_node(&graph, seed, &rule, |node| {
            assert_vector(node, rotated(node, equation_2(node, root.as_dvec3(), theta)));
        });
    }

    #[test]
    fn the_other_axis_is_up_cross_vector(seed: u64, angle in -20f32..20.0) {
        // A vertical vector turns no way, so the sources get others.
        let bend = Bend::constant(degrees(angle)).with_axis(BendAxis::UpCrossVector);
        let rule: Arc<dyn GuidingRule> = Arc::new(SourceVector::new(bend, Vec3::new(0.5, 1.0, 0.3)));
        each_node(&cube_graph(500, seed), seed, &rule, |node| {
            let axis = DVec3::Y.cross(node.before);
            if axis.length() > 1e-3 {
                let expected = turned(node.before, axis.normalize(), f64::from(degrees(angle)));
                assert!(node.vector.distance(expected) < 1e-4, "{} for {expected}", node.vector);
            }
        });
    }

    /// Figure 6 (c): "each node on the trunk has a different random direction".
    #[test]
    fn each_source_has_one_random_angle(seed: u64, low in 10f32..60.0, width in 1f32..60.0) {
        let (low, high) = (degrees(low), degrees(low + width));
        let rule: Arc<dyn GuidingRule> = Arc::new(Bend::random(low, high, degrees(2.0), 1));
        let mut angles = std::collections::BTreeMap::<(usize, u32), f64>::new();
        each_node(&cube_graph(500, seed), seed, &rule, |node| {
            let axis = DVec3::Y.cross(node.edge);
            if node.hops > 1 {
                assert_vector(node, rotated(node, f64::from(degrees(2.0))));
            } else if axis.length() > 1e-3 {
                let axis = axis.normalize();
                let across = |v: DVec3| v - axis * v.dot(axis);
                let (from, to) = (across(node.before), across(node.vector));
                if from.length() < 0.05 {
                    return; // Almost along the axis: the angle cannot be measured.
                }
                let angle = axis.dot(from.cross(to)).atan2(from.dot(to));
                assert!(angle > f64::from(low) - 1e-4 && angle < f64::from(high) + 1e-4, "{angle}");
                let of_source = *angles.entry((node.stage, node.source)).or_insert(angle);
                assert!((of_source - angle).abs() < 2e-4, "{of_source} and {angle} from one source");
            }
        });
        let mut drawn: Vec<f64> = angles.into_values().collect();
        drawn.sort_by(f64::total_cmp);
        let same = drawn.windows(2).filter(|pair| pair[1] - pair[0] < 1e-7).count();
        prop_assert!(drawn.len() > 30 && same * 10 < drawn.len(), "{same} of {} alike", drawn.len());
        let middle = f64::from(low + high) * 0.5;
        let below = drawn.iter().filter(|&&angle| angle < middle).count();
        prop_assert!(below * 5 > drawn.len() && below * 5 < drawn.len() * 4, "{below} of {}", drawn.len());
    }
}

/// "Positive angles turn the vector away from up towards the edge", and "a vertical edge rotates nothing".
#[test]
fn positive_angles_turn_outwards() {
    let positions = vec![Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)];
    let graph = Graph::new(positions, &[(0, 1), (1, 2), (2, 3)], 0).expect("a small graph");
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Bend::constant(degrees(30.0)), Nothing));
    let mut search = Search::new(&graph);
    synth.grow_stage(&mut search, 0, 0, &Silent).expect("nothing can fail");
    let vector = |node| search.vector(node).expect("settled");
    assert_eq!([vector(0), vector(1)], [Vec3::Y; 2]);
    assert!(vector(2).abs_diff_eq(Vec3::new(0.5, 0.75f32.sqrt(), 0.0), 1e-6), "{}", vector(2));
    assert!(vector(3).abs_diff_eq(Vec3::new(0.75f32.sqrt(), 0.5, 0.0), 1e-6), "{}", vector(3));
}

/// Section 3.2.1 and figure 8: vectors straight from a field.
#[test]
fn fields_are_followed() {
    let graph = cube_graph(800, 4);
    let helix = Helix::with_angle(Vec3::ZERO, degrees(35.0));
    let rule: Arc<dyn GuidingRule> = Arc::new(FollowField::new(helix));
    each_node(&graph, 4, &rule, |node| {
        let field = helix.at(node.position.as_vec3()).as_dvec3();
        assert!(node.vector.distance(if field == DVec3::ZERO { node.before } else { field }) < 1e-5);
    });
    let onion = SphericalMeridians::new(Vec3::Y * 2.0);
    let rule: Arc<dyn GuidingRule> = Arc::new(Blend::new(Bend::none(), FollowField::new(onion), 0.3));
    each_node(&graph, 4, &rule, |node| {
        let field = onion.at(node.position.as_vec3()).as_dvec3();
        let field = if field == DVec3::ZERO { node.before } else { field };
        let sum = node.before * 0.7 + field * 0.3;
        assert!(sum.length() < 1e-2 || node.vector.distance(sum.normalize()) < 1e-4);
    });
}

/// Rules of rules: by stage, and by the height of the source (figure 17 (b)).
#[test]
fn rules_are_chosen_by_stage_and_height() {
    let graph = cube_graph(800, 6);
    let by_height = ByHeight::new(2.0, Bend::constant(degrees(8.0)), Bend::piecewise(0.5, -0.2, 3));
    let rule: Arc<dyn GuidingRule> = Arc::new(ByStage::new().then(Bend::constant(0.1)).then(by_height));
    each_node(&graph, 6, &rule, |node| {
        let height = graph.position(node.source).y;
        let angle = match (node.stage, height < 2.0) {
            (0, _) => f64::from(0.1f32),
            (_, true) => f64::from(degrees(8.0)),
            (_, false) => equation_1(node, 0.5, -0.2, 3),
        };
        assert_vector(node, rotated(node, angle));
    });
}

/// Trees (e) and (i) of figure 17: branches start "more steeply upward" the higher their source, each to the side of
/// its first edge, and the sources keep their vectors.
#[test]
fn branches_start_by_the_height_of_their_source() {
    let graph = cube_graph(800, 8);
    let rule = SourceElevation::new(Bend::none(), [degrees(100.0), degrees(20.0)], [1.0, 4.0]);
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 5.0)))
        .stage(Stage::new(rule, Nothing));
    let mut search = Search::new(&graph);
    for stage in 0..2 {
        synth.grow_stage(&mut search, stage, 8, &Silent).expect("endpoints enough");
    }
    assert!(search.tree().iter().all(|&node| search.vector(node) == Some(Vec3::Y)));
    let mut firsts = 0;
    for node in (0..graph.nodes() as u32).filter(|&node| !search.is_on_tree(node)) {
        let (Some(vector), Some(parent)) = (search.vector(node), search.parent(node)) else { continue };
        if search.hops(node) > 1 {
            assert_eq!(Some(vector), search.vector(parent), "the rest is the inner rule's");
            continue;
        }
        firsts += 1;
        let source = graph.position(parent).as_dvec3();
        let share = ((source.y - 1.0) / 3.0).clamp(0.0, 1.0);
        let expected = (100.0 - 80.0 * share).to_radians();
        assert!((vector.as_dvec3().angle_between(DVec3::Y) - expected).abs() < 1e-3);
        let edge = (graph.position(node) - graph.position(parent)).as_dvec3();
        assert!(vector.as_dvec3().with_y(0.0).angle_between(edge.with_y(0.0)) < 1e-3);
    }
    assert!(firsts > 20, "{firsts}");
}

/// Section 3.1.4: "optionally, the guiding vectors for the source nodes are changed"; they stay so in later stages.
#[test]
fn sources_keep_or_change_their_vectors() {
    let graph = cube_graph(800, 8);
    let trunk = || Stage::new(Bend::constant(0.2), NearestTo::new(Vec3::new(1.5, 3.0, 1.0)));
    let vectors = |changed: bool| {
        let second = if changed {
            Stage::new(SourceVector::new(Bend::none(), Vec3::new(0.0, 2.0, 0.0)), Nothing)
        } else {
            Stage::new(Bend::none(), Nothing)
        };
        let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0))).stage(trunk()).stage(second);
        let mut search = Search::new(&graph);
        synth.grow_stage(&mut search, 0, 8, &Silent).expect("endpoints enough");
        let before: Vec<_> = search.tree().iter().map(|&node| search.vector(node)).collect();
        synth.grow_stage(&mut search, 1, 8, &Silent).expect("nothing wanted");
        let after: Vec<_> = search.tree().iter().map(|&node| search.vector(node)).collect();
        (before, after)
    };
    let (before, kept) = vectors(false);
    assert_eq!(before, kept);
    assert!(before.iter().any(|&vector| vector != Some(Vec3::Y)));
    assert!(vectors(true).1.iter().all(|&vector| vector == Some(Vec3::Y)));
}
