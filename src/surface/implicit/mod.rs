//! One closed surface of a whole tree.

mod brick;
mod case;
mod field;
mod march;

use super::{Mesh, SurfaceError};
use crate::{ParameterError, Skeleton};
use brick::Bricks;
use field::Field;

/// One closed, watertight mesh of the whole tree: branches flow into each other in round fillets.
///
/// The tree is an implicit surface, as in Galbraith, MacMurchy and Wyvill 2004, *BlobTree Trees* (section 3): where a
/// field of skeletal primitives equals 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit {
    voxel: Option<f32>,
    detail: f32,
    blend: f32,
    most_blocks: usize,
}

/// A voxel is at least this part of the greatest coordinate, so that 32-bit floats can tell corners of triangles apart.
const FINEST: f32 = 1.0 / 32_768.0;

impl Default for Implicit {
    /// Voxels from half the thinnest twig's diameter on, never larger than a branch's radius; blends half a radius
    /// wide; at most a million blocks.
    fn default() -> Self {
        Self { voxel: None, detail: 1.0, blend: 0.5, most_blocks: 1_000_000 }
    }
}

impl Implicit {
    /// The finest voxel's side.
    pub fn with_voxel(mut self, side: f32) -> Self {
        self.voxel = Some(side);
        self
    }

    /// Voxels a radius.
    pub fn with_detail(mut self, voxels: f32) -> Self {
        self.detail = voxels;
        self
    }

    /// Blend width.
    pub fn with_blend(mut self, share: f32) -> Self {
        self.blend = share;
        self
    }

    /// Most blocks.
    pub fn with_most_blocks(mut self, blocks: usize) -> Self {
        self.most_blocks = blocks;
        self
    }

    /// The surface.
    ///
    /// # Errors
    /// todo
    pub fn mesh(&self, skeleton: &Skeleton) -> Result<Mesh, SurfaceError> {
        self.check()?;
        let thinnest =
            skeleton.radii().iter().copied().filter(|&radius| radius > 0.0).fold(f32::INFINITY, f32::min);
        if thinnest == f32::INFINITY {
            return Err(SurfaceError::NoRadii { nodes: skeleton.len() });
        }
        let finest = field::extent(skeleton, self.blend)? * FINEST;
        let voxel = self.voxel.unwrap_or((thinnest / self.detail).max(finest));
        let range = format!("at least {finest} m, 1/32768 of the tree's reach, and finite");
        ParameterError::unless(voxel >= finest && voxel.is_finite(), "Implicit.voxel", voxel, &range)?;
        let field = Field::new(skeleton, voxel, self.blend);
        let detail = self.detail;
        let level = |radius: f32| {
            (1..30u32).take_while(move |&level| voxel * (1u32 << level) as f32 * detail <= radius)
        };
        let levels: Vec<u8> =
            field.segments.iter().map(|segment| level(segment.thinnest()).count() as u8).collect();
        let bricks = Bricks::new(&field, &levels, voxel, self.most_blocks)?;
        let t = std::time::Instant::now();
        let m = march::march(&field, &bricks);
        eprintln!("bricks {} voxel {voxel} march {:?}", bricks.bricks.len(), t.elapsed());
        Ok(m)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let voxel = self.voxel.unwrap_or(1.0);
        let holds = voxel > 0.0 && voxel.is_finite();
        ParameterError::unless(holds, "Implicit.voxel", voxel, "above 0 m and finite")?;
        ParameterError::unless(
            (1.0..=64.0).contains(&self.detail),
            "Implicit.detail",
            self.detail,
            "1 to 64",
        )?;
        ParameterError::unless(
            (0.01..=2.0).contains(&self.blend),
            "Implicit.blend",
            self.blend,
            "0.01 to 2",
        )?;
        let holds = (1..=100_000_000).contains(&self.most_blocks);
        ParameterError::unless(holds, "Implicit.most_blocks", self.most_blocks, "1 to 100 million")
    }
}

#[cfg(test)]
mod tests;
