//! Models and drawings as shapes, in every place that takes a shape, and trees of two methods in one.

use crate::sample::cases;
use proptest::prelude::*;
use std::collections::BTreeSet;
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{
    AroundTree, Bend, EndpointError, HopSurface, InShape, NearestTo, NearestToEach, PoissonYao, Refinement,
    Stage, TreeSynth,
};
use treesynth::presets;
use treesynth::shape::{
    CrossProfile, Cuboid, Extrusion, HalfEllipsoid, Outline, Sketch, Sphere, TriangleMesh, Union,
};
use treesynth::variational::{GuidanceShape, VariationalSynth};
use treesynth::{EndpointPolicy, Shape, Skeleton, SynthesisError};

/// A double pyramid, 4 m high, on eight faces.
fn diamond() -> TriangleMesh {
    let (middle, width) = (Vec3::Y * 3.0, 1.5);
    let ring = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z].map(|side| middle + side * width);
    let corners = [&ring[..], &[middle + Vec3::Y * 2.0, middle - Vec3::Y * 2.0]].concat();
    let faces: Vec<[u32; 3]> = (0..4).flat_map(|i| [[(i + 1) % 4, i, 4], [i, (i + 1) % 4, 5]]).collect();
    TriangleMesh::new(&corners, &faces).expect("a diamond")
}

/// A mesh that does not know its surface.
struct Plain(TriangleMesh);
impl Shape for Plain {
    fn contains(&self, point: Vec3) -> bool {
        self.0.contains(point)
    }
    fn bounds(&self) -> treesynth::Bounds {
        self.0.bounds()
    }
}

fn in_diamond(point: Vec3, margin: f32) -> bool {
    let off = (point - Vec3::Y * 3.0).abs();
    (off.x + off.z) / 1.5 + off.y / 2.0 <= 1.0 + margin
}

fn region() -> Cuboid {
    Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0))
}

#[test]
fn a_mesh_is_a_region_a_crown_and_a_guidance_shape() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = diamond();
    assert!(mesh.flaws().is_none() && (mesh.volume() / 6.0 - 1.0).abs() < 1e-4, "{}", mesh.volume());
    let whole = Union::new(mesh.clone(), Cuboid::new(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, 2.0, 0.3)));
    let tree = TreeSynth::new(PoissonYao::new(whole.clone()).with_nodes(3000))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.0)))
        .stage(Stage::new(Bend::none(), InShape::poisson_disc(mesh.clone(), 60)))
        .synthesize(1)?;
    assert!(tree.positions().iter().all(|&position| whole.contains(position)));
    let tips: Vec<Vec3> = tree.tips().map(|tip| tree.positions()[tip]).collect();
    assert!(tips.len() > 40 && tips.iter().all(|&tip| in_diamond(tip, 1e-4)));

    let inside = GuidanceShape::in_volume(&mesh, 300, 1)?;
    assert!(inside.positions().iter().all(|&position| in_diamond(position, 1e-4)));
    let surface = GuidanceShape::on_jittered_surface(&mesh, 300, 0.0, 1)?;
    assert!(surface.positions().iter().all(|&p| in_diamond(p, 1e-4) && !in_diamond(p, -1e-3)));
    // A node for each square of the area, of equal numbers on each of the eight faces.
    let exact = 2.0 * (mesh.surface_area().expect("known") / 300.0 / std::f32::consts::TAU).sqrt();
    assert!((surface.diameters()[0] / exact - 1.0).abs() < 1e-4);
    let above = surface.positions().iter().filter(|p| p.y > 3.0 && p.x > 0.0 && p.z > 0.0).count();
    assert!((30..=45).contains(&above), "an eighth of the surface holds {above} of 300");
    // A shape whose surface is found by `contains` alone has the same area.
    let crossed = GuidanceShape::on_surface(&Plain(mesh), 300, 1)?;
    assert!((crossed.diameters()[0] / exact - 1.0).abs() < 0.03);
    let growth = VariationalSynth::new(inside.joined(&surface)).synthesize(1)?;
    assert_eq!(growth.tips().count(), 600);
    Ok(())
}

/// Cells of a quarter metre that are hit, seen from the front.
fn seen(points: impl IntoIterator<Item = Vec3>) -> BTreeSet<(i32, i32)> {
    let cell = |p: Vec3| ((p.x * 4.0).floor() as i32, (p.y * 4.0).floor() as i32);
    points.into_iter().map(cell).collect()
}

/// The part that two views share, of all that either shows.
fn likeness(a: &BTreeSet<(i32, i32)>, b: &BTreeSet<(i32, i32)>) -> f32 {
    a.intersection(b).count() as f32 / a.union(b).count() as f32
}

/// Figure 13: the twigs of each letter look more like its silhouette than like that of any other.
#[test]
fn letters_read_as_letters() {
    let letters: Vec<_> = "graphics"
        .chars()
        .map(|name| presets::by_name(&format!("variational-13-{name}")).unwrap().variational().unwrap())
        .collect();
    let silhouettes: Vec<_> = letters
        .iter()
        .map(|letter| seen(letter.synth(8000).unwrap().shape().positions().iter().copied()))
        .collect();
    for (number, letter) in letters.iter().enumerate() {
        let tree = letter.synth(1500).unwrap().synthesize(letter.seed).unwrap();
        // All that is not the foot of the trunk, limbs included.
        let way = |(node, parent): (usize, usize)| {
            let (from, to) = (tree.positions()[parent], tree.positions()[node]);
            (0..=8).map(move |part| from.lerp(to, part as f32 / 8.0)).filter(|point| point.y > 1.6)
        };
        let view = seen(tree.edges().flat_map(way));
        let like: Vec<f32> = silhouettes.iter().map(|silhouette| likeness(&view, silhouette)).collect();
        println!("{}: {like:.2?}", letter.name);
        assert!(like[number] > 0.7, "{}: {like:.2?}", letter.name);
        let others = (0..8).filter(|&other| other != number).map(|other| like[other]).fold(0.0, f32::max);
        assert!(like[number] > others + 0.1, "{}: {like:.2?}", letter.name);
    }
}

/// A crown from two silhouettes has them, from the front and from the side.
#[test]
fn a_sketched_crown_has_its_silhouettes() -> Result<(), Box<dyn std::error::Error>> {
    let front =
        Outline::smooth([(0.0, 1.0), (3.0, 2.5), (1.0, 4.0), (1.5, 6.0), (-2.0, 5.0)].map(Vec2::from));
    let side = Outline::smooth([(0.0, 1.0), (1.0, 2.0), (0.5, 6.0), (-1.0, 4.0)].map(Vec2::from));
    let crown = Sketch::new(front.clone()).with_side(side.clone());
    let shape = GuidanceShape::on_jittered_surface(&crown, 400, 0.0, 1)?;
    let reach = |outline: &Outline, point: Vec2| {
        let spans = outline.spans(point.y);
        spans.iter().map(|&(from, to)| (point.x - from).min(to - point.x)).fold(f32::MIN, f32::max)
    };
    let (mut right, mut left) = (f32::MIN, f32::MAX);
    for &position in shape.positions() {
        let (across, along) = (Vec2::new(position.x, position.y), Vec2::new(position.z, position.y));
        assert!(reach(&front, across) > -1e-3 && reach(&side, along) > -1e-3, "{position}");
        (right, left) = (right.max(position.x), left.min(position.x));
    }
    assert!(front.max().x - right < 0.2 && left - front.min().x < 0.2, "{left} {right}");
    let flat = crown.with_profiles([CrossProfile::new([1.0, 0.4, 0.2, 0.4, 1.0, 0.4, 0.2, 0.4])]);
    assert!(flat.volume() < 0.6 * Sketch::new(front).with_side(side).volume());
    Ok(())
}

/// Every internode of `inner` is covered by nodes of `outer`, to a part of the spacing.
fn covers(outer: &Skeleton, inner: &Skeleton, distance: f32) -> bool {
    inner.tips().all(|tip| {
        let place = inner.positions()[tip];
        outer.positions().iter().any(|position| position.distance(place) <= distance)
    })
}

#[test]
fn guiding_vectors_fill_in_the_twigs_of_a_variational_tree() -> Result<(), Box<dyn std::error::Error>> {
    let crown = HalfEllipsoid::new(Vec3::Y * 2.0, Vec3::new(2.0, 3.0, 2.0));
    let limbs = VariationalSynth::new(GuidanceShape::in_volume(&crown, 40, 1)?).synthesize(1)?;
    let around = AroundTree::new(limbs.clone(), Refinement::new(region(), 0.15).with_relaxation(0));
    let synth =
        TreeSynth::new(around).stage(Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(4, 200)));
    let tree = synth.synthesize(1)?;
    assert_eq!(tree.check(), Ok(()));
    assert!(covers(&tree, &limbs, 1e-5), "tips of the limbs are nodes of the tree");
    let last = *limbs.stages().iter().max().expect("nodes");
    let twigs = tree.stages().iter().filter(|&&stage| stage == last + 1).count();
    assert!(twigs > 400 && tree.stages().iter().all(|&stage| stage <= last + 1), "{twigs}");
    // One graph serves several trees, and the same seed gives the same one.
    let graph = synth.build_graph(1, &treesynth::Silent)?;
    let (first, second) = (synth.synthesize_on(&graph, 1)?, synth.synthesize_on(&graph, 2)?);
    assert_eq!(first, tree);
    assert!(second != tree && covers(&second, &limbs, 1e-5));
    // A later stage may refine again.
    let finer = synth.stage(
        Stage::new(Bend::none(), HopSurface::new(3, 300)).with_refinement(Refinement::new(region(), 0.1)),
    );
    assert_eq!(finer.synthesize(1)?.stages().iter().max(), Some(&(last + 2)));

    let outside = Cuboid::new(Vec3::Y, Vec3::ONE * 3.0);
    let stage = || Stage::new(Bend::none(), HopSurface::new(4, 20));
    let refused =
        |refinement| TreeSynth::new(AroundTree::new(limbs.clone(), refinement)).stage(stage()).synthesize(1);
    for (refinement, name) in [
        (Refinement::new(outside, 0.15), "Refinement.region"),
        (Refinement::new(region(), 0.0), "Refinement.spacing"),
    ] {
        assert!(
            matches!(refused(refinement), Err(SynthesisError::Parameter(error)) if error.parameter == name)
        );
    }
    Ok(())
}

#[test]
fn shape_nodes_are_endpoints_of_guided_trees() -> Result<(), Box<dyn std::error::Error>> {
    let crown = HalfEllipsoid::new(Vec3::Y * 2.0, Vec3::new(2.0, 3.0, 2.0));
    let shape = GuidanceShape::on_surface(&crown, 120, 1)?;
    let synth = TreeSynth::new(PoissonYao::new(region()).with_nodes(20_000))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 3.0)))
        .stage(Stage::new(Bend::constant(0.05), NearestToEach::new(shape.positions())));
    let tree = synth.synthesize(1)?;
    let graph = synth.build_graph(1, &treesynth::Silent)?;
    for &place in shape.positions() {
        let nearest = graph.positions().iter().map(|node| node.distance(place)).fold(f32::MAX, f32::min);
        let found = tree.positions().iter().map(|node| node.distance(place)).fold(f32::MAX, f32::min);
        assert!(found <= nearest + 0.2, "{place}: {found} {nearest}");
    }
    assert!(NearestToEach::new([]).check().is_err());
    let bad = NearestToEach::new([Vec3::ONE, Vec3::NAN]).check().map_err(|error| error.parameter);
    assert_eq!(bad, Err("NearestToEach.points[1]".into()));
    let point = TreeSynth::new(treesynth::guided::PointCloud::new(
        vec![Vec3::ZERO, Vec3::Y],
        treesynth::guided::Edges::Yao(8),
    ))
    .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y)))
    .stage(Stage::new(Bend::none(), NearestToEach::new([Vec3::X])));
    let none = EndpointError::TooFew { wanted: 1, available: 0, place: "off the tree and reachable" };
    assert_eq!(point.synthesize(1), Err(SynthesisError::Endpoints { stage: 1, error: none }));
    Ok(())
}

proptest! {
    #![proptest_config(cases(16))]

    /// Whatever is drawn, a tree fills it or an error names what is wrong.
    #[test]
    fn any_polygon_is_filled_or_named(
        corners in prop::collection::vec([-3.0_f32..3.0, 0.5_f32..6.0], 3..9),
        depth in 0.3_f32..3.0,
        seed: u64,
    ) {
        let outline = Outline::new(corners.into_iter().map(Vec2::from_array).collect::<Vec<_>>());
        let shapes: [&dyn Shape; 2] = [&Sketch::new(outline.clone()), &Extrusion::new(outline.clone(), depth)];
        for shape in shapes {
            match GuidanceShape::in_volume(shape, 60, seed) {
                Ok(nodes) => {
                    prop_assert!(outline.check().is_ok());
                    prop_assert!(nodes.positions().iter().all(|&position| shape.contains(position)));
                    prop_assert_eq!(VariationalSynth::new(nodes).synthesize(seed).unwrap().tips().count(), 60);
                }
                Err(error) if outline.check().is_err() => prop_assert!(error.parameter.starts_with("Outline.")),
                // Slivers.
                Err(error) => prop_assert_eq!(error.parameter, "GuidanceShape.shape"),
            }
        }
    }
}

/// A root inside, far off and under, on shapes of triangles too.
#[test]
fn roots_may_stand_anywhere_near() {
    let ball = Sphere::new(Vec3::Y * 3.0, 1.0);
    for shape in [GuidanceShape::in_volume(&diamond(), 100, 1), GuidanceShape::in_volume(&ball, 100, 1)] {
        let synth = VariationalSynth::new(shape.expect("a shape"));
        for root in [Vec3::Y * 3.0, Vec3::Y * -20.0, Vec3::X * 200.0, Vec3::Y * 50.0] {
            let tree = synth.clone().with_root(root).synthesize(1).expect("a tree");
            assert_eq!((tree.positions()[0], tree.tips().count()), (root, 100));
        }
        let far = synth.with_root(Vec3::X * 1e5).check().map_err(|error| error.parameter);
        assert_eq!(far, Err("VariationalSynth.root".into()));
    }
}
