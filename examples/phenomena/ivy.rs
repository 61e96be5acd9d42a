//! Ivy on a ruin: a graph on the surface of a given mesh, stems that climb along it, leaves that look away from it.

use super::ruin::Ruin;
use std::sync::Arc;
use treesynth::foliage::{Foliage, Leaf, Leaves};
use treesynth::glam::{Mat3, Quat, Vec3};
use treesynth::guided::{Count, Graph, HopSurface, InShape, PoissonSurface, Search, Stage, Step, TreeSynth};
use treesynth::math::{self, Rotation};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::radius::{PipeModel, RadiusModel, Taper};
use treesynth::random::{Purpose, unit};
use treesynth::shape::Cuboid;
use treesynth::surface::{Material, Part, Tubes};
use treesynth::{GuidingRule, Silent, Skeleton};

type Failure = Box<dyn std::error::Error>;

/// The root of the ivy, at the base of the wall's front.
const FOOT: Vec3 = Vec3::new(1.6, 0.0, 1.0);

/// Upwards along the surface, in a line that wavers; off a bearing stem to one side first.
#[derive(Clone)]
struct Climb {
    normals: Arc<[Vec3]>,
    up: f32,
    fork: f32,
}

impl GuidingRule for Climb {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let normal = self.normals[step.node as usize];
        let random = step.random(Purpose::CUSTOM, step.node) - 0.5;
        let mut ahead = step.vector;
        if step.hops == 1 {
            let side = if step.random(Purpose::SOURCE_ANGLE, step.source()) < 0.5 { -1.0 } else { 1.0 };
            ahead = Rotation::new(self.fork * side).about(normal, ahead);
        }
        let ahead = Rotation::new(random * 0.9).about(normal, ahead) + Vec3::Y * self.up;
        (ahead - normal * ahead.dot(normal)).normalize_or(step.edge)
    }
}

/// An ivy: its stems as they lie on the wall, and the normal of the wall at each of their nodes.
pub(crate) struct Ivy {
    pub(crate) ruin: Ruin,
    pub(crate) graph: Graph,
    pub(crate) tree: Skeleton,
    pub(crate) normals: Vec<Vec3>,
}

pub(crate) fn ivy(nodes: usize, seed: u64) -> Result<Ivy, Failure> {
    let ruin = Ruin::new();
    let wall =
        PoissonSurface::new(ruin.positions.clone(), ruin.triangles.clone()).with_nodes(nodes).with_root(FOOT);
    let normals: Arc<[Vec3]> = wall.nodes(seed, &Silent)?.normals.into();
    let climb = |up, fork| Climb { normals: normals.clone(), up, fork };
    let heights = Cuboid::new(Vec3::new(-1.0, 0.9, -1.0), Vec3::new(3.6, 4.0, 2.0));
    // Hops are counted in spacings; the same number of metres on finer graphs.
    let hops = |metres: f32| -> Result<u32, Failure> { Ok((metres / wall.spacing()? / 1.3).ceil() as u32) };
    let shoots = |metres, count, fork| -> Result<Stage, Failure> {
        let ends = HopSurface::new(hops(metres)?, Count::UpTo(count)).with_outermost(0.85);
        Ok(Stage::new(climb(0.12, fork), ends))
    };
    let synth = TreeSynth::new(wall.clone())
        .stage(Stage::new(climb(0.3, 0.0), InShape::poisson_disc(heights, Count::UpTo(16))))
        .stage(shoots(0.3, 90, 0.7)?)
        .stage(shoots(0.16, 320, 0.9)?)
        .stage(shoots(0.1, 700, 0.9)?);
    let graph = synth.build_graph(seed, &Silent)?;
    let growth = synth.grow(&mut Search::new(&graph), seed, &Silent)?;
    let normals = growth.nodes.iter().map(|&node| normals[node as usize]).collect();
    Ok(Ivy { ruin, graph, tree: growth.skeleton, normals })
}

impl Ivy {
    /// The stems, their bark on the wall.
    pub(crate) fn stems(&self) -> Result<Skeleton, Failure> {
        let radii = Taper::new(PipeModel::default().with_exponent(2.6).with_trunk_diameter(0.07))
            .radii(&self.tree)?;
        let lifted = self.tree.positions().iter().zip(&self.normals).zip(&radii);
        let lifted = lifted.map(|((&position, &normal), radius)| position + normal * (radius * 0.8));
        let parents = (0..self.tree.len()).map(|node| self.tree.parent(node).map(|parent| parent as u32));
        Ok(Skeleton::new(lifted.collect(), parents.collect())?
            .with_stages(self.tree.stages().to_vec())?
            .with_radii(radii)?)
    }

    /// Leaves along the shoots, turned to look away from the wall and a little up, their tips down.
    pub(crate) fn leaves(&self, stems: &Skeleton, seed: u64) -> Result<Leaves, Failure> {
        let mut leaves = Foliage::new(Leaf::lobed().with_petiole(0.5))
            .with_spacing(0.05)
            .with_size(0.085)
            .with_reach(1.2)
            .with_thickest(0.02)
            .with_material(Material::leaf().with_srgb([58, 92, 42]))
            .place(stems, seed)?;
        for (number, leaf) in (0..).zip(&mut leaves.instances) {
            let draw = |purpose| unit(seed, purpose, Purpose::CUSTOM, number) - 0.5;
            let normal = self.normals[leaf.node as usize];
            let face = (normal + Vec3::Y * 0.25 + Vec3::new(draw(0), draw(1), draw(2)) * 0.5).normalize();
            let down = Vec3::NEG_Y + Vec3::new(draw(3), draw(4), draw(5)) * 1.6;
            let midrib = (down - face * down.dot(face)).normalize_or(face.any_orthonormal_vector());
            leaf.rotation =
                math::unit_rotation(Quat::from_mat3(&Mat3::from_cols(midrib.cross(face), midrib, face)));
            leaf.position += normal * (0.015 + 0.02 * (draw(6) + 0.5));
        }
        Ok(leaves)
    }
}

pub(crate) fn draw(nodes: usize, seed: u64, size: u32) -> Result<(Picture, String), Failure> {
    let ivy = ivy(nodes, seed)?;
    let stems = ivy.stems()?;
    let leaves = ivy.leaves(&stems, seed)?;
    let measured = format!(
        "{} tips, {} leaves, {} nodes of the wall",
        stems.tips().count(),
        leaves.instances.len(),
        ivy.graph.nodes()
    );
    let (bark, wall) = (Tubes::default().mesh(&stems)?, ivy.ruin.mesh());
    let parts = [
        Part::new(&wall).with_material(Material::white()),
        Part::new(&bark).with_material(Material::bark().with_srgb([104, 84, 64])),
        leaves.part(),
    ];
    let paper = [0.97, 0.965, 0.955];
    let preview = Preview::default()
        .with_size(size, size * 7 / 8)
        .with_background(paper, paper)
        .with_sun(Vec3::new(-0.7, 0.9, 0.9))
        .with_camera(Camera::default().with_azimuth(0.42).with_elevation(0.2));
    Ok((preview.draw_parts(&parts)?, measured))
}
