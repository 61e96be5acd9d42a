//! Options out of range, NaN and infinite: the error names the parameter and says the value.

use crate::sample::{built, plot};
use std::f32::consts::{PI, TAU};
use std::time::{Duration, Instant};
use treesynth::field::{Helix, Scale, Source, Uniform, Vortex};
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Blend, ByHeight, ByStage, Count, Edges, FollowField, GradedYao, Graph, Guided, GuidedPower,
    HopSurface, InShape, Jitter, Lattice, Multimodal, NearSurface, NearestTo, PointCloud, PoissonYao,
    SizingFn, SourceElevation, Stage, TreeSynth, Within,
};
use treesynth::radius::{PipeModel, Taper, Variational};
use treesynth::shape::{
    Cone, Cuboid, Cylinder, Difference, Ellipsoid, HalfEllipsoid, Intersection, Shell, Sphere, Translated,
    Union,
};
use treesynth::{
    EndpointPolicy, GraphBuilder, GuidingRule, RadiusModel, Shape, Silent, SynthesisError, VectorField,
    WeightFn,
};

const NOT_FINITE: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// These and what is not finite.
fn and_not_finite(values: &[f32]) -> Vec<f32> {
    [values, &NOT_FINITE].concat()
}

fn cube() -> PoissonYao<Cuboid> {
    PoissonYao::new(plot(4.0, 4.0)).with_nodes(300)
}

fn small() -> Graph {
    built(&cube(), 1)
}

/// `check`, `synthesize` and, where the graph is not to blame, `synthesize_on` all refuse, and say the same.
fn refused(synth: &TreeSynth, parameter: &str, value: &str, on: Option<&Graph>) {
    let error = synth.check().expect_err(&format!("{parameter} = {value} was accepted"));
    assert_eq!(error.parameter, parameter, "{error}");
    let text = error.to_string();
    assert!(text.starts_with(&format!("{parameter} is ")) && text.contains(", but must be "), "{text}");
    assert!(text.contains(value), "{text} does not say {value}");
    assert_eq!(synth.synthesize(1), Err(SynthesisError::Parameter(error.clone())));
    match on {
        Some(graph) => assert_eq!(synth.synthesize_on(graph, 1), Err(SynthesisError::Parameter(error))),
        None => assert_eq!(synth.build_graph(1, &Silent).err(), Some(SynthesisError::Parameter(error))),
    }
}

fn trunk() -> Stage {
    Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 3.0))
}

fn bad_graph(graph: impl GraphBuilder + 'static, parameter: &str, value: impl std::fmt::Debug) {
    refused(&TreeSynth::new(graph).stage(trunk()), parameter, &format!("{value:?}"), None);
}

/// As second stage, so that no stage is checked in place of all.
fn bad_stage(stage: Stage, parameter: &str, value: impl std::fmt::Debug) {
    let synth = TreeSynth::new(cube()).stage(trunk()).stage(stage);
    refused(&synth, parameter, &format!("{value:?}"), Some(&small()));
}

fn bad_rule(rule: impl GuidingRule + 'static, parameter: &str, value: impl std::fmt::Debug) {
    bad_stage(Stage::new(rule, NearestTo::new(Vec3::Y)), parameter, value);
}

fn bad_weight(weight: impl WeightFn + 'static, parameter: &str, value: impl std::fmt::Debug) {
    bad_stage(trunk().with_weight(weight), parameter, value);
}

fn bad_policy(policy: impl EndpointPolicy + 'static, parameter: &str, value: impl std::fmt::Debug) {
    bad_stage(Stage::new(Bend::none(), policy), parameter, value);
}

fn bad_radius(model: impl RadiusModel + 'static, parameter: &str, value: impl std::fmt::Debug) {
    let synth = TreeSynth::new(cube()).stage(trunk()).with_radius(model);
    refused(&synth, parameter, &format!("{value:?}"), Some(&small()));
}

/// Some value, whatever its text.
struct Any;

impl std::fmt::Debug for Any {
    fn fmt(&self, _: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        Ok(())
    }
}

/// As a region, as a place for endpoints and as an obstacle.
fn bad_shape(shape: impl Shape + Clone + 'static, parameter: &str) {
    bad_graph(PoissonYao::new(shape.clone()), parameter, Any);
    bad_graph(PoissonYao::new(shape.clone()).with_spacing(0.1), parameter, Any);
    bad_graph(GradedYao::new(shape.clone(), SizingFn::new(|_| 0.1)), parameter, Any);
    bad_graph(Lattice::new(shape.clone(), 0.1), parameter, Any);
    bad_policy(InShape::uniform(shape.clone(), 3), parameter, Any);
    bad_weight(Within::obstacle(Guided, shape), parameter, Any);
}

#[test]
fn graphs() {
    for nodes in [0, 1, 200_000_001, usize::MAX] {
        bad_graph(cube().with_nodes(nodes), "PoissonYao.nodes", nodes);
    }
    for spacing in and_not_finite(&[0.0, -0.0, -1.0, 1e-30, f32::MIN_POSITIVE]) {
        bad_graph(cube().with_spacing(spacing), "PoissonYao.spacing", spacing);
        bad_graph(Lattice::new(plot(4.0, 4.0), spacing), "Lattice.spacing", spacing);
    }
    for sectors in [0, 1, 2, 65, usize::MAX] {
        bad_graph(cube().with_sectors(sectors), "PoissonYao.sectors", sectors);
        bad_graph(PointCloud::new(vec![Vec3::ZERO], Edges::Yao(sectors)), "PointCloud.edges", sectors);
        let planar = Lattice::new(plot(4.0, 4.0), 0.5).with_edges(Edges::PlanarYao(sectors));
        bad_graph(planar, "Lattice.edges", sectors);
    }
    for count in [0, 65, usize::MAX] {
        bad_graph(PointCloud::new(vec![Vec3::ZERO], Edges::Nearest(count)), "PointCloud.edges", count);
    }
    for jitter in and_not_finite(&[-0.1, 1.0, 2.0]) {
        bad_graph(Lattice::new(plot(4.0, 4.0), 0.5).with_jitter(jitter), "Lattice.jitter", jitter);
    }
    for bad in NOT_FINITE {
        for root in [Vec3::X * bad, Vec3::ZERO.with_z(bad)] {
            bad_graph(cube().with_root(root), "PoissonYao.root", root);
            let cloud = PointCloud::new(vec![Vec3::ZERO], Edges::Yao(8)).with_root(root);
            bad_graph(cloud, "PointCloud.root", root);
        }
    }
    bad_graph(cube().planar().with_root(Vec3::Z * 0.5), "PoissonYao.root", Vec3::Z * 0.5);
}

#[test]
fn graded_graphs() {
    let region = plot(4.0, 4.0);
    let graded = || GradedYao::new(region, SizingFn::new(|_| 0.5));
    for nodes in [0, 1, 200_000_001, usize::MAX] {
        bad_graph(graded().with_nodes(nodes), "GradedYao.nodes", nodes);
    }
    for grading in and_not_finite(&[0.0, -0.1, 1e-4, 0.141, 1.0]) {
        bad_graph(graded().with_grading(grading), "GradedYao.grading", grading);
    }
    for sectors in [0, 2, 65, usize::MAX] {
        bad_graph(graded().with_sectors(sectors), "GradedYao.sectors", sectors);
    }
    for root in [Vec3::X * f32::NAN, Vec3::NEG_Y, Vec3::splat(1e30)] {
        bad_graph(graded().with_root(root), "GradedYao.root", root);
    }
    // Everywhere, in one place, and too fine for memory; whatever the number of nodes asked for.
    for size in and_not_finite(&[0.0, -1.0]) {
        bad_graph(GradedYao::new(region, SizingFn::new(move |_| size)), "GradedYao.sizing", Any);
        let here = SizingFn::new(move |p: Vec3| if p.y > 3.9 { size } else { 1.0 });
        bad_graph(GradedYao::new(region, here).with_nodes(100), "GradedYao.sizing", Any);
    }
    for size in [f32::MIN_POSITIVE, 1e-20, 1e-5, 1e-3] {
        bad_graph(GradedYao::new(region, SizingFn::new(move |_| size)), "GradedYao.sizing", Any);
    }
    let ball = Sphere::new(Vec3::Y, 1.0);
    for bad in and_not_finite(&[0.0, -1.0]) {
        for (sizing, parameter) in [
            (NearSurface::new(ball, bad, 1.0, 1.0), "NearSurface.at_surface"),
            (NearSurface::new(ball, 1.0, bad, 1.0), "NearSurface.away"),
            (NearSurface::new(ball, 1.0, 1.0, bad), "NearSurface.distance"),
        ] {
            bad_graph(GradedYao::new(region, sizing), parameter, bad);
        }
        let sizing = NearSurface::new(Sphere::new(Vec3::Y, bad), 1.0, 1.0, 1.0);
        bad_graph(GradedYao::new(region, sizing), "Sphere.radius", bad);
    }
    let nothing = Difference::new(ball, region);
    bad_graph(GradedYao::new(region, NearSurface::new(nothing, 0.1, 1.0, 1.0)), "NearSurface.shape", Any);
}

#[test]
fn shapes() {
    for bad in and_not_finite(&[0.0, -1.0, 1e-7, 1e7, f32::MAX]) {
        bad_shape(Sphere::new(Vec3::ZERO, bad), "Sphere.radius");
        bad_shape(Cone::new(Vec3::ZERO, bad, 1.0), "Cone.radius");
        bad_shape(Cone::new(Vec3::ZERO, 1.0, bad), "Cone.height");
        bad_shape(Cylinder::new(Vec3::ZERO, bad, 1.0), "Cylinder.radius");
        bad_shape(Cylinder::new(Vec3::ZERO, 1.0, bad), "Cylinder.height");
        bad_shape(Ellipsoid::new(Vec3::ZERO, Vec3::ONE.with_y(bad)), "Ellipsoid.radii");
        bad_shape(HalfEllipsoid::new(Vec3::ZERO, Vec3::ONE.with_z(bad)), "HalfEllipsoid.radii");
    }
    for bad in and_not_finite(&[1e7, -1e7]) {
        let center = Vec3::ZERO.with_x(bad);
        bad_shape(Sphere::new(center, 1.0), "Sphere.center");
        bad_shape(Ellipsoid::new(center, Vec3::ONE), "Ellipsoid.center");
        bad_shape(HalfEllipsoid::new(center, Vec3::ONE), "HalfEllipsoid.base_center");
        bad_shape(Cone::new(center, 1.0, 1.0), "Cone.base_center");
        bad_shape(Cylinder::new(center, 1.0, 1.0), "Cylinder.base_center");
        bad_shape(Cuboid::new(center, Vec3::ONE), "Cuboid.min");
        bad_shape(Cuboid::new(Vec3::ZERO, Vec3::ONE.with_z(bad)), "Cuboid.max");
        bad_shape(Translated::new(Sphere::new(Vec3::ZERO, 1.0), center), "Translated.offset");
        bad_shape(Shell::new(Sphere::new(Vec3::ZERO, 1.0), 0.5).about(center), "Shell.about");
    }
    bad_shape(Cuboid::new(Vec3::ONE, Vec3::ZERO), "Cuboid.max");
    bad_shape(Cuboid::new(Vec3::ZERO, Vec3::ZERO), "Cuboid.max");
    for bad in and_not_finite(&[0.0, -0.1, 0.0009, 1.1]) {
        bad_shape(Shell::new(Sphere::new(Vec3::ZERO, 1.0), bad), "Shell.thickness");
    }
    let (good, bad) = (Sphere::new(Vec3::ZERO, 2.0), Sphere::new(Vec3::ZERO, -2.0));
    bad_shape(Union::new(good, bad), "Sphere.radius");
    bad_shape(Intersection::new(good, bad), "Sphere.radius");
    bad_shape(Difference::new(good, bad), "Sphere.radius");
    bad_shape(Translated::new(bad, Vec3::ZERO), "Sphere.radius");
}

#[test]
fn rules() {
    for angle in and_not_finite(&[6.3, -6.3, 1e30]) {
        bad_rule(Bend::constant(angle), "Bend.angle", angle);
        bad_rule(Bend::piecewise(angle, 0.0, 0), "Bend.first", angle);
        bad_rule(Bend::piecewise(0.0, angle, 0), "Bend.rest", angle);
        bad_rule(Bend::piecewise(0.0, angle, 1), "Bend.rest", angle);
        bad_rule(Bend::random(angle, 1.0, 0.0, 1), "Bend.low", angle);
        bad_rule(Bend::random(0.0, angle, 0.0, 1), "Bend.high", angle);
        bad_rule(Bend::random(0.0, 1.0, angle, 1), "Bend.rest", angle);
        bad_rule(Bend::from_axis(angle), "Bend.theta", angle);
        // Inside all that carry a rule.
        bad_rule(ByHeight::new(1.0, Bend::none(), Bend::constant(angle)), "Bend.angle", angle);
        bad_rule(ByHeight::new(1.0, Bend::constant(angle), Bend::none()), "Bend.angle", angle);
        bad_rule(ByStage::new().then(Bend::none()).then(Bend::constant(angle)), "Bend.angle", angle);
        bad_rule(Blend::new(Bend::none(), Bend::constant(angle), 0.5), "Bend.angle", angle);
        bad_rule(Jitter::new(Bend::constant(angle), 0.1), "Bend.angle", angle);
        bad_rule(SourceElevation::new(Bend::constant(angle), [0.0; 2], [0.0, 1.0]), "Bend.angle", angle);
        bad_rule(Box::new(Bend::constant(angle)) as Box<dyn GuidingRule>, "Bend.angle", angle);
    }
    bad_rule(Bend::random(1.0, 0.5, 0.0, 1), "Bend.low", 1.0);
    bad_rule(ByStage::new(), "ByStage.rules", 0);
    for share in and_not_finite(&[-0.01, 1.01]) {
        bad_rule(Blend::new(Bend::none(), Bend::none(), share), "Blend.share", share);
    }
    for angle in and_not_finite(&[-0.01, PI * 1.001]) {
        bad_rule(Jitter::new(Bend::none(), angle), "Jitter.angle", angle);
        let elevation = SourceElevation::new(Bend::none(), [1.0, angle], [0.0, 1.0]);
        bad_rule(elevation, "SourceElevation.angles", angle);
    }
    for heights in [[1.0, 1.0], [2.0, 1.0], [f32::NAN, 1.0], [0.0, f32::NAN], [0.0, f32::INFINITY]] {
        let elevation = SourceElevation::new(Bend::none(), [1.0, 1.0], heights);
        bad_rule(elevation, "SourceElevation.heights", heights);
    }
    for height in NOT_FINITE {
        bad_rule(ByHeight::new(height, Bend::none(), Bend::none()), "ByHeight.height", height);
    }
    assert!(Bend::piecewise(TAU, -TAU, u32::MAX).check().is_ok());
}

#[test]
fn fields() {
    let follow = |field: Box<dyn VectorField>, parameter| bad_rule(FollowField::new(field), parameter, Any);
    for bad in NOT_FINITE {
        follow(Box::new(Uniform::new(Vec3::Y * bad)), "Uniform.direction");
        follow(Box::new(Helix::new(Vec3::X * bad, 1.0)), "Helix.center");
        follow(Box::new(Helix::new(Vec3::ZERO, bad)), "Helix.pitch");
        follow(Box::new(Helix::with_angle(Vec3::ZERO, bad)), "Helix.angle");
        follow(Box::new(Source::new(Vec3::ZERO, bad)), "Source.strength");
        follow(Box::new(Source::new(Vec3::ZERO, 1.0).with_core(bad)), "Source.core");
        follow(Box::new(Vortex::new(Vec3::ZERO, Vec3::X * bad, 1.0)), "Vortex.axis");
        follow(Box::new(Scale::new(Uniform::new(Vec3::Y), bad)), "Scale.factor");
    }
    follow(Box::new(Uniform::new(Vec3::ZERO)), "Uniform.direction");
}

#[test]
fn weights() {
    for exponent in and_not_finite(&[-0.1, 16.1]) {
        bad_weight(GuidedPower::new(exponent), "GuidedPower.length_exponent", exponent);
        let deviation = GuidedPower::new(1.0).with_deviation_exponent(exponent);
        bad_weight(deviation, "GuidedPower.deviation_exponent", exponent);
    }
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::X * f32::INFINITY] {
        bad_weight(Multimodal::new().with_direction(direction, 1.0), "Multimodal.direction", direction);
    }
    for factor in and_not_finite(&[-1.0]) {
        bad_weight(Multimodal::new().with_direction(Vec3::X, factor), "Multimodal.factor", factor);
        bad_weight(Multimodal::new().with_cone(1.0, factor), "Multimodal.factor", factor);
    }
    for angle in and_not_finite(&[-0.1, 3.2]) {
        bad_weight(Multimodal::new().with_cone(angle, 1.0), "Multimodal.angle", angle);
    }
    for factor in [-1.0, f32::NAN, f32::NEG_INFINITY] {
        bad_weight(Within::new(Guided, plot(1.0, 1.0), factor), "Within.factor", factor);
    }
    let inner = Within::new(GuidedPower::new(-1.0), plot(1.0, 1.0), 2.0);
    bad_weight(inner, "GuidedPower.length_exponent", -1.0);
}

#[test]
fn endpoints() {
    for bad in NOT_FINITE {
        bad_policy(NearestTo::new(Vec3::Z * bad), "NearestTo.point", Vec3::Z * bad);
    }
    for count in [Count::Exactly(0), Count::UpTo(0)] {
        bad_policy(InShape::poisson_disc(plot(1.0, 1.0), count), "InShape.count", 0);
        bad_policy(HopSurface::new(2, count), "HopSurface.count", 0);
    }
    for share in and_not_finite(&[0.0, -0.5, 1.01]) {
        for count in [Count::Share(share), Count::Each(share)] {
            bad_policy(InShape::uniform(plot(1.0, 1.0), count), "InShape.count", share);
            bad_policy(HopSurface::new(2, count), "HopSurface.count", share);
        }
        bad_policy(HopSurface::new(2, 5).with_outermost(share), "HopSurface.outermost", share);
    }
    for hops in [0, 1001, u32::MAX] {
        bad_policy(HopSurface::new(hops, 5), "HopSurface.hops", hops);
    }
    for randomness in and_not_finite(&[-0.1, 1.0]) {
        let policy = HopSurface::new(2, 5).with_random_weights(randomness);
        bad_policy(policy, "HopSurface.random_weights", randomness);
    }
}

#[test]
fn radii() {
    for exponent in and_not_finite(&[0.0, 1.0, -2.0, 10.1]) {
        bad_radius(PipeModel::default().with_exponent(exponent), "PipeModel.exponent", exponent);
        bad_radius(Variational::uniform(1.0).with_exponent(exponent), "Variational.exponent", exponent);
    }
    for bad in and_not_finite(&[0.0, -1.0]) {
        bad_radius(PipeModel::default().with_tip_diameter(bad), "PipeModel.tip_diameter", bad);
        bad_radius(PipeModel::default().with_trunk_diameter(bad), "PipeModel.trunk_diameter", bad);
        bad_radius(Variational::uniform(bad), "Variational.area", bad);
        bad_radius(Variational::uniform(1.0).with_trunk_diameter(bad), "Variational.trunk_diameter", bad);
        bad_radius(Variational::guided([Vec3::Y], bad), "Variational.total_area", bad);
    }
    for bad in and_not_finite(&[-0.1, 1.1]) {
        let guided = Variational::guided([Vec3::Y], 1.0).with_minimum_share(bad);
        bad_radius(guided, "Variational.minimum_share", bad);
        bad_radius(Taper::new(PipeModel::default()).with_fraction(bad), "Taper.fraction", bad);
        bad_radius(Taper::new(PipeModel::default()).with_tip_fraction(bad), "Taper.tip_fraction", bad);
    }
    bad_radius(Variational::guided([], 1.0), "Variational.samples", Any);
    bad_radius(Variational::guided([Vec3::Y, Vec3::NAN], 1.0), "Variational.samples", Vec3::NAN);
    let inner = Taper::new(PipeModel::default().with_exponent(0.5));
    bad_radius(inner, "PipeModel.exponent", 0.5);
}

#[test]
fn stages() {
    refused(&TreeSynth::new(cube()), "TreeSynth.stages", "0", Some(&small()));
    let many = (0..65_536).fold(TreeSynth::new(cube()), |synth, _| synth.stage(trunk()));
    refused(&many, "TreeSynth.stages", "65536", Some(&small()));
    let graph = small();
    let mut search = treesynth::guided::Search::new(&graph);
    let error = TreeSynth::new(cube()).stage(trunk()).grow_stage(&mut search, 1, 1, &Silent);
    let Err(SynthesisError::Parameter(error)) = error else { panic!("{error:?}") };
    assert_eq!(error.to_string(), "stage is 1, but must be below the number of stages, 1");
}

fn at_once(what: &str, mut work: impl FnMut() -> bool) {
    let start = Instant::now();
    assert!(work(), "{what} was accepted");
    assert!(start.elapsed() < Duration::from_secs(5), "{what} took {:?} to refuse", start.elapsed());
}

#[test]
fn huge_sizes_are_refused_at_once() {
    let refuses = |builder: &dyn GraphBuilder| builder.build(1, &Silent).is_err();
    let wide = || Cuboid::new(Vec3::splat(-1e6), Vec3::splat(1e6));
    at_once("2^64 nodes", || refuses(&cube().with_nodes(usize::MAX)));
    at_once("a spacing of a nanometre", || refuses(&cube().with_spacing(1e-9)));
    at_once("a spacing of a nanometre in the plane", || refuses(&cube().planar().with_spacing(1e-9)));
    at_once("a kilometre at a millimetre", || refuses(&PoissonYao::new(plot(1e3, 1e3)).with_spacing(1e-3)));
    at_once("the widest box at a metre", || refuses(&PoissonYao::new(wide()).with_spacing(1.0)));
    at_once("the widest lattice", || refuses(&Lattice::new(wide(), 1.0)));
    at_once("a fine lattice", || refuses(&Lattice::new(plot(1.0, 1.0), 1e-9)));
}

/// 200 million nodes are refused where they are counted, so more of them should be where they follow from the
/// spacing: 700 million here, 50 GB by the 75 bytes per node that the docs state.
#[test]
fn spacings_too_fine_for_any_memory_are_refused() {
    assert!(PoissonYao::new(plot(1.0, 1.0)).with_nodes(700_000_000).check().is_err());
    let error = PoissonYao::new(plot(1.0, 1.0)).with_spacing(0.001).check();
    assert_eq!(error.expect_err("700 million nodes").parameter, "PoissonYao.spacing");
}

/// Edges are counted in 32 bits: 200 million nodes of 64 sectors have more.
#[test]
fn more_edges_than_indices_can_name_are_refused() {
    let builder = PoissonYao::new(plot(1.0, 1.0)).with_nodes(200_000_000).with_sectors(64);
    assert!(builder.check().is_err(), "12.8e9 edges were accepted");
}

/// Large, but allowed: it works.
#[test]
fn the_largest_lengths_work() {
    let region = Cuboid::new(Vec3::new(-1e6, 0.0, -1e6), Vec3::new(1e6, 1e6, 1e6));
    let synth = TreeSynth::new(PoissonYao::new(region).with_nodes(2000))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 1e6)))
        .stage(Stage::new(Bend::constant(0.1), InShape::poisson_disc(region, Count::UpTo(usize::MAX))));
    let tree = synth.synthesize(1).expect("a tree of a thousand kilometres");
    assert!(tree.len() > 1500 && tree.check().is_ok());
    let tiny = Sphere::new(Vec3::ZERO, 1e-6);
    let synth = TreeSynth::new(PoissonYao::new(tiny).with_nodes(500))
        .stage(Stage::new(Bend::none(), InShape::poisson_disc(tiny, 20)));
    assert!(synth.synthesize(1).expect("a tree of a micrometre").len() > 20);
}
