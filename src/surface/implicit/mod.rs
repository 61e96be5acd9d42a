//! One closed surface of a whole tree.

mod brick;
mod case;
mod collapse;
mod crossed;
mod field;
mod grow;
mod march;
mod polygonizer;
pub(crate) mod solid;
#[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
pub(crate) mod span;
mod vertex;

pub use polygonizer::Polygonizer;

use super::{Mesh, SurfaceError, Sway, far};
use crate::observer::{Observer, Silent, Watch, Work, report};
use crate::{ParameterError, Skeleton};
use brick::Bricks;
use field::Field;
use march::Finish;
use solid::Solid;

/// One closed, watertight mesh of the whole tree: branches flow into each other in round fillets.
///
/// The tree is an implicit surface, as in the `BlobTree` trees of Galbraith, `MacMurchy` and Wyvill 2004
/// (section 3): each internode is a skeletal primitive, a cone with a ball at each end, of radii interpolated
/// along the branch. Its field is `f = 1 + (1 - d/r)/b`, at the distance d from the axis, for the radius r
/// there and the [blend](Self::with_blend) b: 1 on its surface, 0 where the distance exceeds the radius by
/// the blend width b·r. Along a branch the primitives are joined (the greatest f counts), and branches are
/// blended (Ricci 1973): the surface is where the root of the sum of the squares of their f is 1. The fillet
/// between two branches of one radius at right angles is an arc of the blend width; nothing grows by more
/// than that; and a branch away from others has exactly its radius.
///
/// Guaranteed: every side of a triangle is one of exactly two, in opposite directions, and around each vertex
/// there is one fan of triangles; triangles have an area and face outward; vertices are within a voxel of the
/// surface, mostly within a hundredth, and have the field's normals; the same skeleton gives the same bits at
/// any number of threads. Branches that do not touch make one body without handles, of Euler characteristic
/// 2; a handle appears where branches touch again, or come nearer than both's blend widths and a voxel. Not
/// guaranteed: there are no texture coordinates or tangents, unless [`Unwrap`](super::Unwrap) gives them;
/// small features between two voxels' middles may be missed.
///
/// **Voxels** are as fine as the branches near: an octree of blocks of 4 · 4 · 4 voxels follows them, and neither empty space
/// nor the inside of limbs is ever looked at. Marching cubes run on the dual of that octree. A branch thinner
/// than the finest voxel is thickened to its radius, internodes without length are balls, and so is a root alone.
///
/// **Far from the origin** a tree has the surface that it has at the origin, with vertices rounded to what 32-bit floats have there:
/// 1 mm at 10 km. Where that turns over or flattens more than 2% of the surface there is an error.
///
/// Time and memory grow with the voxels at the surface: 48 bytes per vertex for the mesh and about 10 on the
/// way to it, times the primitives felt at one place. If that is too much, [longer
/// triangles](Self::with_error) take a fifth of it, and twice the time.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::Implicit};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.1, 0.1])?;
/// let mesh = Implicit::default().with_detail(4.0).mesh(&pole)?;
/// let (vertices, triangles) = (mesh.positions.len(), mesh.triangles().len());
/// assert_eq!(vertices + triangles, triangles * 3 / 2 + 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Implicit {
    voxel: Option<f32>,
    detail: f32,
    blend: f32,
    error: f32,
    most_blocks: usize,
    wind: bool,
}

crate::recipe::readable!(Implicit {
    voxel: Option<f32>, detail: f32, blend: f32, error: f32, most_blocks: usize, wind: bool,
});

/// A voxel is at least this part of the greatest coordinate, so that 32-bit floats can tell corners of triangles apart.
const FINEST: f32 = 1.0 / 32_768.0;

/// Every ball of this radius holds a voxel's middle: half the diagonal of the unit cube, rounded up.
const COVERING: f32 = 0.867;

impl Default for Implicit {
    /// Voxels as long as the thinnest twig's radius, and up to a branch's radius elsewhere; blends half a radius wide;
    /// at most two million blocks; no wind.
    fn default() -> Self {
        Self { voxel: None, detail: 1.0, blend: 0.5, error: 0.0, most_blocks: 2_000_000, wind: false }
    }
}

impl Implicit {
    /// The side of the finest voxels, metres, at least 1/32768 of how far the tree reaches from its root, or from the origin if
    /// that is near, for 32-bit floats to tell triangles' corners apart; default the thinnest radius above zero over the [detail](Self::with_detail), or that
    /// limit. Branches thinner than this times the detail are thickened to it.
    pub fn with_voxel(mut self, side: f32) -> Self {
        self.voxel = Some(side);
        self
    }

    /// The least number of voxels per radius, 0.867 to 64; default 1. Voxels are the finest one's side times
    /// the greatest power of two that allows it. From √3/2 on, branches hold together however they lie.
    pub fn with_detail(mut self, voxels: f32) -> Self {
        self.detail = voxels;
        self
    }

    /// The blend width as a share of a branch's radius, 0.01 to 2; default 0.5.
    pub fn with_blend(mut self, share: f32) -> Self {
        self.blend = share;
        self
    }

    /// Greatest distance of triangles' sides from the surface, in units of the voxels there, 0 to 0.25: with
    /// more, triangles are longer than a voxel and fewer. Default 0, which leaves each within a voxel.
    /// Triangles within a voxel are off by 0.1 themselves, on twigs of a voxel's radius. 0.15 leaves a fifth
    /// of a tree's vertices, 0.2 a seventh, at twice the time. The guarantees stay, and the vertices that are
    /// left do not move.
    pub fn with_error(mut self, voxels: f32) -> Self {
        self.error = voxels;
        self
    }

    /// The greatest number of blocks, 1 to 100 million; default two million, which take about 1.2 GB, the mesh included. A
    /// block in which many primitives are felt counts once more for every 32 of them, as where thousands of branches meet.
    pub fn with_most_blocks(mut self, blocks: usize) -> Self {
        self.most_blocks = blocks;
        self
    }

    /// Gives vertices [`Wind`](super::Wind): each moves with the internode that it is next to; default false.
    /// The mesh stays closed however it blows.
    pub fn with_wind(mut self, wind: bool) -> Self {
        self.wind = wind;
        self
    }

    /// The surface. With the feature `parallel`, on rayon's threads.
    ///
    /// # Errors
    /// An option out of its range; radii that are all zero; more blocks than were allowed, or more vertices
    /// than 32-bit indices can name; a node more than a million kilometres out or thick; a tree so far out that floats cannot
    /// tell its vertices apart, [`SurfaceError::Shapeless`].
    pub fn mesh(&self, skeleton: &Skeleton) -> Result<Mesh, SurfaceError> {
        self.mesh_observed(skeleton, &Silent)
    }

    /// As [`mesh`](Self::mesh), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh), and [`SurfaceError::Cancelled`].
    pub fn mesh_observed(&self, skeleton: &Skeleton, observer: &dyn Observer) -> Result<Mesh, SurfaceError> {
        let offset = far::offset_of(skeleton);
        let skeleton = &*far::near(skeleton, offset);
        let (field, voxel) = self.field(skeleton)?;
        let finish = if self.error > 0.0 { Finish::Longer(self.error) } else { Finish::Plain };
        let voxels = Voxels { side: voxel, per_detail: 1.0, most_blocks: self.most_blocks };
        let mut mesh = polygonize(&&field, &voxels, finish, observer)?;
        if self.wind {
            let watch = Watch::part(observer, Work::Surface, 0.9..1.0, mesh.positions.len(), 8192);
            Sway::of(skeleton)?.clothe_watched(&mut mesh, &watch)?;
        }
        let mesh = far::back_closed(mesh, offset)?;
        report(observer, Work::Surface, 1.0)?;
        Ok(mesh)
    }

    /// The field, and the side of the finest voxels.
    pub(crate) fn field(&self, skeleton: &Skeleton) -> Result<(Field, f32), SurfaceError> {
        self.check()?;
        let thick = skeleton.radii().iter().copied().filter(|&radius| radius > 0.0);
        let thinnest = thick.fold(f32::INFINITY, f32::min);
        if thinnest == f32::INFINITY {
            return Err(SurfaceError::NoRadii { nodes: skeleton.len() });
        }
        let finest = field::extent(skeleton, self.blend)? * FINEST;
        let voxel = self.voxel.unwrap_or((thinnest / self.detail).max(finest));
        let range = format!("at least {finest} m, 1/32768 of the tree's reach, and finite");
        ParameterError::unless(voxel >= finest && voxel.is_finite(), "Implicit.voxel", voxel, &range)?;
        Ok((Field::new(skeleton, voxel * self.detail, self.blend, self.detail)?, voxel))
    }

    /// The field of a tree wherever it is, not to be polygonized.
    #[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
    pub(crate) fn field_there(&self, skeleton: &Skeleton) -> Result<Field, SurfaceError> {
        let offset = far::offset_of(skeleton);
        Ok(self.field(&far::near(skeleton, offset))?.0.moved_to(offset))
    }

    fn check(&self) -> Result<(), ParameterError> {
        let voxel = self.voxel.unwrap_or(1.0);
        let holds = voxel > 0.0 && voxel.is_finite();
        ParameterError::unless(holds, "Implicit.voxel", voxel, "above 0 m and finite")?;
        let holds = (COVERING..=64.0).contains(&self.detail);
        ParameterError::unless(holds, "Implicit.detail", self.detail, "0.867 to 64")?;
        ParameterError::unless(
            (0.01..=2.0).contains(&self.blend),
            "Implicit.blend",
            self.blend,
            "0.01 to 2",
        )?;
        let holds = (0.0..=0.25).contains(&self.error);
        ParameterError::unless(holds, "Implicit.error", self.error, "0 to 0.25")?;
        let holds = (1..=100_000_000).contains(&self.most_blocks);
        ParameterError::unless(holds, "Implicit.most_blocks", self.most_blocks, "1 to 100 million")
    }
}

/// The voxels with which a solid is sampled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Voxels {
    /// The side of the finest, metres; others are as long times a power of two.
    pub(crate) side: f32,
    /// The least number in the [detail](solid::Part::detail) of a place; infinite if all are to be the finest.
    pub(crate) per_detail: f32,
    /// The greatest number of blocks of them.
    pub(crate) most_blocks: usize,
}

/// Cubes looked at from one report to the next, and blocks in the making.
const GROWING: usize = 1024;
const MARCHING: usize = 64;

/// The closed surface of a solid.
pub(crate) fn polygonize(
    solid: &impl Solid,
    voxels: &Voxels,
    finish: Finish,
    observer: &dyn Observer,
) -> Result<Mesh, SurfaceError> {
    let watch = Watch::part(observer, Work::Surface, 0.0..0.3, 1 << 17, GROWING);
    let bricks = Bricks::new(solid, voxels, &watch)?;
    let watch = Watch::part(observer, Work::Surface, 0.3..0.9, bricks.leaves.len(), MARCHING);
    march::march(bricks, finish, &watch)
}

#[cfg(test)]
mod solid_tests;
#[cfg(test)]
mod tests;
