//! Pictures of implicit solids, cast ray by ray, without a mesh.

mod cast;
mod octree;
mod outline;
mod walk;

pub(super) use cast::{Cast, Hit, Look, Sunbeams, Sunlight};
pub(super) use walk::{Beam, Ray};

use super::{Picture, Preview, PreviewError};
use crate::surface::blob::BlobTree;
use crate::surface::solid::Solid;
use crate::surface::{Implicit, Part};
use crate::{Observer, ParameterError, Skeleton};
use glam::Vec3;
use octree::Octree;

/// Draws implicit surfaces as they are, without triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct RayCaster {
    preview: Preview,
    shadows: bool,
    most_cubes: usize,
}

impl Default for RayCaster {
    fn default() -> Self {
        Self::new(Preview::default())
    }
}

impl RayCaster {
    /// Of pictures as this has them.
    pub fn new(preview: Preview) -> Self {
        Self { preview, shadows: true, most_cubes: 20_000_000 }
    }

    /// Whether the solid casts shadows, on itself, on meshes and on the ground; default true. Without, a picture
    /// takes about half of the time.
    pub fn with_shadows(mut self, shadows: bool) -> Self {
        self.shadows = shadows;
        self
    }

    /// The greatest number of cubes that the surface may pass, 1 to a billion; default 20 million.
    pub fn with_most_cubes(mut self, cubes: usize) -> Self {
        self.most_cubes = cubes;
        self
    }

    /// A picture of a `BlobTree`, and of meshes beside it.
    ///
    /// # Errors
    /// As of [`Preview::draw_parts`]; more cubes than were allowed; the observer's `Break`.
    pub fn draw(
        &self,
        tree: &BlobTree,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Picture, PreviewError> {
        self.cast(tree, parts, observer)
    }

    /// A picture of a tree in one smooth skin, as [`Implicit`] has it without its voxels, and of meshes beside it.
    ///
    /// # Errors
    /// As of [`Implicit::mesh`] and [`Preview::draw_parts`]; more cubes than were allowed; the observer's `Break`.
    pub fn draw_implicit(
        &self,
        surface: &Implicit,
        skeleton: &Skeleton,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Picture, PreviewError> {
        let (field, _) = surface.field(skeleton)?;
        self.cast(&&field, parts, observer)
    }

    /// A picture of any solid, and of meshes beside it.
    pub(crate) fn cast(
        &self,
        solid: &impl Solid,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Picture, PreviewError> {
        self.check()?;
        self.preview.check()?;
        let bounds = solid.bounds();
        if bounds.is_empty() {
            return Err(PreviewError::EmptySolid);
        }
        if bounds.min.abs().max(bounds.max.abs()).max_element() > super::FARTHEST {
            return Err(PreviewError::TooFar { bounds });
        }
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let directions = [&axes[..], &self.preview.directions()].concat();
        let stage = self.preview.stage(parts, &outline::outline(solid, &directions))?;
        let octree = Octree::new(solid, &stage.view, self.preview.supersampling, self.most_cubes);
        let picture = self.preview.paint(&stage, Some(&octree), self.shadows, observer)?;
        if octree.is_full() {
            return Err(PreviewError::TooManyCubes { most: self.most_cubes });
        }
        Ok(picture)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let holds = (1..=1_000_000_000).contains(&self.most_cubes);
        ParameterError::unless(holds, "RayCaster.most_cubes", self.most_cubes, "1 to 1,000,000,000")
    }
}

#[cfg(test)]
mod sample;
#[cfg(test)]
mod tests;
