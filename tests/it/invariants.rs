//! Every builder, rule, weight, policy and radius model of the crate, held by the calls that users have.

use proptest::prelude::*;
use treesynth::field::{Helix, Source, SphericalMeridians, Sum, Vortex};
use treesynth::glam::Vec3;
use treesynth::testing::{self, graphs, options, regions, skeletons};
use treesynth::{
    GraphBuilder, SynthesisError,
    guided::{
        Bend, ByStage, Count, GradedYao, Graph, GuidedPower, HopSurface, InShape, Jitter, Multimodal,
        NearSurface, Side, SourceElevation, SourceVector,
    },
    radius::*,
};

/// `false` if the root is on an island of the region, three spacings from everything else.
fn leads_somewhere(graph: &Graph) -> bool {
    graph.nodes() == 1 || graph.unreachable() + 1 < graph.nodes()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn pipelines(options in options(), seed: u64) {
        let synth = options.synth();
        let graph = synth.build_graph(seed, &treesynth::Silent).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assume!(leads_somewhere(&graph));
        testing::check_builder(&options.builder(), seed)?;
        testing::check_synth(&synth, &graph, seed)?;
        match synth.synthesize(seed) {
            Ok(skeleton) => prop_assert_eq!(skeleton, synth.synthesize_on(&graph, seed).unwrap()),
            Err(SynthesisError::Endpoints { .. }) => {}
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        }
    }

    #[test]
    fn graded_graphs(region in regions(), seed: u64, nodes in 2usize..2000, away in 0.1f32..10.0) {
        let sizing = NearSurface::new(region.clone(), 1.0, away, 0.5);
        let builder = GradedYao::new(region, sizing).with_nodes(nodes);
        let graph = builder.build(seed, &treesynth::Silent).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assume!(leads_somewhere(&graph));
        testing::check_builder(&builder, seed)?;
    }

    #[test]
    fn rules(graph in graphs(), seed: u64, angle in -2f32..2.0, hops in 0u32..5) {
        testing::check_rule(Bend::piecewise(angle, -angle, hops), &graph, seed)?;
        testing::check_rule(Bend::random(angle, angle + 1.0, 0.1, hops), &graph, seed)?;
        testing::check_rule(SourceVector::new(SourceElevation::new(Bend::none(), [1.5, 0.3], [0.0, 2.0]), Vec3::Y), &graph, seed)?;
        testing::check_rule(ByStage::new().then(Bend::none()).then(Jitter::new(Bend::from_axis(angle), 0.5)), &graph, seed)?;
    }

    #[test]
    fn weights(graph in graphs(), seed: u64, exponent in 0f32..3.0) {
        testing::check_weight(GuidedPower::new(exponent), &graph, seed)?;
        testing::check_weight(Multimodal::new().with_cone(exponent, 1.0), &graph, seed)?;
    }

    #[test]
    fn policies(graph in graphs(), region in regions(), seed: u64, hops in 1u32..5, count in 1usize..50) {
        testing::check_endpoints(InShape::poisson_disc(region.clone(), count), &graph, seed)?;
        testing::check_endpoints(InShape::uniform(region, Count::Share(0.2)), &graph, seed)?;
        testing::check_endpoints(HopSurface::new(hops, Count::Each(0.2)), &graph, seed)?;
        testing::check_endpoints(HopSurface::new(hops, Count::UpTo(count)), &graph, seed)?;
        testing::check_endpoints(HopSurface::new(hops, count).only(Side::Lower), &graph, seed)?;
    }

    #[test]
    fn shapes(region in regions(), seed: u64) {
        testing::check_shape(&region, seed)?;
    }

    #[test]
    fn fields(graph in graphs(), angle in -1.5f32..1.5) {
        testing::check_field(&Helix::with_angle(Vec3::ZERO, angle), graph.positions())?;
        testing::check_field(&SphericalMeridians::new(Vec3::Y), graph.positions())?;
        testing::check_field(&Sum::new().with(Source::new(Vec3::Y, 1.0)).with(Vortex::new(Vec3::ZERO, Vec3::Y, angle)), graph.positions())?;
    }

    #[test]
    fn radii(skeleton in skeletons(200), exponent in 1.5f32..4.0) {
        testing::check_skeleton(&skeleton)?;
        testing::check_radius(&PipeModel::default().with_exponent(exponent), &skeleton)?;
        testing::check_radius(&Taper::new(PipeModel::default().with_trunk_diameter(0.5)), &skeleton)?;
        testing::check_radius(&Variational::default(), &skeleton)?;
    }
}
