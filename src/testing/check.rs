//! Checks of implementations against their contracts, and of trees against their invariants.

use crate::field::VectorField;
use crate::guided::{
    Bend, Count, EndpointPolicy, Graph, GraphBuilder, Growth, GuidingRule, HopSurface, InShape, Search,
    Stage, SynthesisError, TreeSynth, WeightFn,
};
use crate::observer::Silent;
use crate::radius::{RadiusModel, check_radii};
use crate::shape::{Cuboid, Shape};
use crate::skeleton::Skeleton;
use glam::Vec3;
use proptest::test_runner::TestCaseError;
use proptest::{prop_assert, prop_assert_eq};
use std::sync::Arc;

/// Result of a check: `Ok`, or the failure that proptest shrinks.
pub type CheckResult = Result<(), TestCaseError>;

fn failed(error: &impl std::fmt::Display) -> TestCaseError {
    TestCaseError::fail(error.to_string())
}

/// The builder is deterministic, and its graph is valid: distinct edges between existing nodes, finite positions, a
/// root that leads somewhere.
///
/// # Errors
/// The first promise that is broken.
pub fn check_builder(builder: &dyn GraphBuilder, seed: u64) -> CheckResult {
    builder.check().map_err(|error| failed(&error))?;
    let graph = builder.build(seed, &Silent).map_err(|error| failed(&error))?;
    let again = builder.build(seed, &Silent).map_err(|error| failed(&error))?;
    prop_assert_eq!(graph.root(), again.root(), "the same seed gives the same root");
    prop_assert!(
        bits(graph.positions()).eq(bits(again.positions())),
        "the same seed gives the same positions"
    );
    let edges = |graph: &Graph| -> Vec<(u32, u32)> {
        (0..graph.nodes() as u32)
            .flat_map(|from| graph.neighbours(from).iter().map(move |&to| (from, to)))
            .collect()
    };
    prop_assert_eq!(edges(&graph), edges(&again), "the same seed gives the same edges");
    Graph::new(graph.positions().to_vec(), &edges(&graph), graph.root()).map_err(|error| failed(&error))?;
    if graph.nodes() > 1 {
        prop_assert!(!graph.neighbours(graph.root()).is_empty(), "the root has edges");
    }
    Ok(())
}

fn bits(positions: &[Vec3]) -> impl Iterator<Item = [u32; 3]> + '_ {
    positions.iter().map(|p| p.to_array().map(f32::to_bits))
}

/// The shape's samples lie in it and in its bounds, what it contains lies in its bounds, and its volume is at most
/// that of its bounds.
///
/// # Errors
/// The first promise that is broken.
pub fn check_shape(shape: &dyn Shape, seed: u64) -> CheckResult {
    shape.check().map_err(|error| failed(&error))?;
    let bounds = shape.bounds();
    let mut random = crate::random::stream(seed, 0, crate::random::Purpose::CUSTOM, 0);
    for _ in 0..64 {
        let Some(point) = shape.sample(&mut random) else { break };
        prop_assert!(shape.contains(point), "sample {point} lies in the shape");
        prop_assert!(bounds.contains(point), "sample {point} lies in the bounds");
    }
    let around = bounds.grown(bounds.size().max_element() * 0.2);
    let probe = Cuboid::new(around.min, around.max);
    for _ in 0..256 {
        let Some(point) = probe.sample(&mut random) else { break };
        prop_assert!(!shape.contains(point) || bounds.contains(point), "{point} lies in the bounds");
    }
    let volume = shape.volume();
    prop_assert!(
        volume >= 0.0 && volume <= bounds.volume() * 1.001,
        "volume {volume} is at most the bounds'"
    );
    Ok(())
}

/// The field is finite, and the same every time, at and around points of its choosing.
///
/// # Errors
/// The first promise that is broken.
pub fn check_field(field: &dyn VectorField, points: &[Vec3]) -> CheckResult {
    field.check().map_err(|error| failed(&error))?;
    for &point in points.iter().chain(&[Vec3::ZERO, Vec3::Y]) {
        let vector = field.at(point);
        prop_assert!(vector.is_finite(), "the field is finite at {point}");
        prop_assert_eq!(vector, field.at(point), "the field is the same every time");
    }
    Ok(())
}

/// The rule gives usable vectors, the same every time, and the trees it guides satisfy every invariant.
///
/// # Errors
/// The first promise that is broken.
pub fn check_rule(rule: impl GuidingRule + 'static, graph: &Graph, seed: u64) -> CheckResult {
    let rule: Arc<dyn GuidingRule> = Arc::new(rule);
    check_synth(&two_stages(graph, |endpoints| Stage::new(rule.clone(), endpoints)), graph, seed)
}

/// The weights are at least zero and the same every time, and the trees they make satisfy every invariant.
///
/// # Errors
/// The first promise that is broken.
pub fn check_weight(weight: impl WeightFn + 'static, graph: &Graph, seed: u64) -> CheckResult {
    let weight: Arc<dyn WeightFn> = Arc::new(weight);
    let bend = || Bend::piecewise(0.5, -0.1, 2);
    let stage = |endpoints| Stage::new(bend(), endpoints).with_weight(weight.clone());
    check_synth(&two_stages(graph, stage), graph, seed)
}

/// The policy names nodes that exist and can be reached, the same every time, both on a bare root and on a tree;
/// having too few candidates is allowed.
///
/// # Errors
/// The first promise that is broken.
pub fn check_endpoints(policy: impl EndpointPolicy + 'static, graph: &Graph, seed: u64) -> CheckResult {
    let policy: Arc<dyn EndpointPolicy> = Arc::new(policy);
    let stage = || Stage::new(Bend::piecewise(0.5, -0.1, 2), policy.clone());
    check_synth(&TreeSynth::new(NoGraph).stage(stage()), graph, seed)?;
    let all = everywhere(graph);
    let trunk = Stage::new(Bend::none(), InShape::uniform(all, Count::UpTo(3)));
    check_synth(&TreeSynth::new(NoGraph).stage(trunk).stage(stage()), graph, seed)
}

/// The model gives every node of the skeleton a radius, finite and not negative, never growing towards the tips, and
/// the same every time.
///
/// # Errors
/// The first promise that is broken.
pub fn check_radius(model: &dyn RadiusModel, skeleton: &Skeleton) -> CheckResult {
    model.check().map_err(|error| failed(&error))?;
    let radii = model.radii(skeleton).map_err(|error| failed(&error))?;
    check_radii(skeleton, &radii).map_err(|error| failed(&error))?;
    let again = model.radii(skeleton).map_err(|error| failed(&error))?;
    let bits = |radii: &[f32]| radii.iter().map(|r| r.to_bits()).collect::<Vec<_>>();
    prop_assert_eq!(bits(&radii), bits(&again), "the same skeleton gives the same radii");
    Ok(())
}

/// The pipeline gives the same tree every time, whether its memory is fresh or used, and that tree satisfies every
/// invariant. Having too few candidates for endpoints is allowed.
///
/// # Errors
/// The first promise that is broken.
pub fn check_synth(synth: &TreeSynth, graph: &Graph, seed: u64) -> CheckResult {
    let mut search = Search::new(graph);
    let growth = match synth.grow(&mut search, seed, &Silent) {
        Ok(growth) => growth,
        Err(SynthesisError::Endpoints { .. }) => return Ok(()),
        Err(error) => return Err(failed(&error)),
    };
    check_growth(graph, &growth)?;
    let again = synth.grow(&mut search, seed, &Silent).map_err(|error| failed(&error))?;
    prop_assert_eq!(&growth, &again, "the same seed gives the same tree in used memory");
    let skeleton = synth.synthesize_on(graph, seed).map_err(|error| failed(&error))?;
    prop_assert_eq!(&growth.skeleton, &skeleton, "the same seed gives the same tree in fresh memory");
    Ok(())
}

/// The tree is made of the graph: acyclic, one root, parents first; its nodes are distinct nodes of the graph, its
/// edges edges of the graph; every endpoint is in it, every tip an endpoint; stages and hops ascend.
///
/// # Errors
/// The first promise that is broken.
pub fn check_growth(graph: &Graph, growth: &Growth) -> CheckResult {
    let graph = growth.graph.as_deref().unwrap_or(graph);
    let (skeleton, nodes) = (&growth.skeleton, &growth.nodes);
    check_skeleton(skeleton)?;
    prop_assert_eq!(nodes.len(), skeleton.len(), "one graph node per node");
    prop_assert_eq!(nodes[0], graph.root(), "the root is the graph's");
    let mut place = vec![None; graph.nodes()];
    for (i, &node) in nodes.iter().enumerate() {
        prop_assert!((node as usize) < graph.nodes(), "node {node} is in the graph");
        prop_assert!(place[node as usize].replace(i).is_none(), "node {node} is in the tree once");
        prop_assert_eq!(skeleton.positions()[i], graph.position(node), "nodes stay where they are");
    }
    for (child, parent) in skeleton.edges() {
        prop_assert!(
            graph.neighbours(nodes[parent]).contains(&nodes[child]),
            "{} -> {} is an edge of the graph",
            nodes[parent],
            nodes[child]
        );
        let (stages, hops) = (skeleton.stages(), skeleton.hops());
        prop_assert!(stages[parent] <= stages[child] || parent == 0, "stages ascend");
        let same_stage = stages[parent] == stages[child] && parent != 0;
        prop_assert_eq!(hops[child], if same_stage { hops[parent] + 1 } else { 1 }, "hops from the source");
    }
    let mut is_endpoint = vec![false; graph.nodes()];
    for &endpoint in growth.endpoints.iter().flatten() {
        prop_assert!(place[endpoint as usize].is_some(), "endpoint {endpoint} is in the tree");
        is_endpoint[endpoint as usize] = true;
    }
    for tip in skeleton.tips().filter(|&tip| tip != 0) {
        prop_assert!(is_endpoint[nodes[tip] as usize], "tip {tip} is an endpoint");
    }
    Ok(())
}

/// The skeleton is a tree: [`Skeleton::check`] holds, every node leads to the root without a cycle, children and
/// parents agree, branches hold every internode once, orders ascend by one where a branch leaves its axis.
///
/// # Errors
/// The first promise that is broken.
pub fn check_skeleton(skeleton: &Skeleton) -> CheckResult {
    skeleton.check().map_err(|error| failed(&error))?;
    let mut depth = vec![0usize; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        prop_assert!(parent < node, "parents come first");
        depth[node] = depth[parent] + 1;
    }
    prop_assert!(depth.iter().all(|&depth| depth < skeleton.len()), "no way to the root is a cycle");
    prop_assert_eq!((0..skeleton.len()).filter(|&n| skeleton.parent(n).is_none()).count(), 1, "one root");
    let children = skeleton.children();
    let held: usize = (0..skeleton.len()).map(|node| children.of(node).len()).sum();
    prop_assert_eq!(held, skeleton.segments(), "every node but the root is a child once");
    for node in 0..skeleton.len() {
        for &child in children.of(node) {
            prop_assert_eq!(skeleton.parent(child as usize), Some(node), "children know their parent");
        }
    }
    let mut seen = vec![false; skeleton.len()];
    for branch in skeleton.branches().iter() {
        for pair in branch.nodes().windows(2) {
            let (parent, child) = (pair[0] as usize, pair[1] as usize);
            prop_assert_eq!(skeleton.parent(child), Some(parent), "branches follow internodes");
            prop_assert!(!std::mem::replace(&mut seen[child], true), "internode {child} is in one branch");
            prop_assert_eq!(skeleton.orders()[child], branch.order(), "one order per branch");
        }
    }
    prop_assert!(seen.iter().skip(1).all(|&seen| seen), "every internode is in a branch");
    Ok(())
}

/// A pipeline that is only ever used on graphs that are already built.
struct NoGraph;

impl GraphBuilder for NoGraph {
    fn build(&self, _: u64, _: &dyn crate::Observer) -> Result<Graph, crate::guided::GraphError> {
        Err(crate::guided::GraphError::Empty)
    }
}

fn everywhere(graph: &Graph) -> Cuboid {
    let bounds = crate::shape::Bounds::of(graph.positions().iter().copied()).grown(1e-3);
    Cuboid::new(bounds.min, bounds.max)
}

fn two_stages(graph: &Graph, stage: impl Fn(Box<dyn EndpointPolicy>) -> Stage) -> TreeSynth {
    TreeSynth::new(NoGraph)
        .stage(stage(Box::new(InShape::poisson_disc(everywhere(graph), Count::UpTo(12)))))
        .stage(stage(Box::new(HopSurface::new(1, Count::UpTo(40)).with_outermost(0.9))))
}
