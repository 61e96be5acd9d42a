//! One tree in several levels of detail.

use super::{Mesh, SurfaceError, Tubes};
use crate::{Bounds, ParameterError, Skeleton};

/// How much the error grows from one try to the next, until a level is small enough.
const STEP: f32 = 1.25;

/// A chain of meshes of one skeleton, each of at most half the triangles of the one before.
///
/// Every level is [`Tubes::with_error`] at the least error that halves the triangles, found in steps of a quarter. So
/// small branches go first, silhouettes agree within a few errors, nothing is random, and all levels share their axes:
/// one can fade into the next.
///
/// ```
/// use treesynth::{presets, surface::Levels};
///
/// let tree = presets::by_name("figure-06b").unwrap().synth(3000).synthesize(1)?.relaxed(0.5, 3)?;
/// let levels = Levels::default().with_count(3).of(&tree)?;
/// for pair in levels.windows(2) {
///     assert!(pair[1].mesh.triangles().len() * 2 <= pair[0].mesh.triangles().len());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    tubes: Tubes,
    count: u32,
    error: f32,
}

/// A mesh and how far it may be off.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Level {
    /// The surface.
    pub mesh: Mesh,
    /// By how much it may differ from the smooth tubes, metres. Show it from where this is less than a pixel: at a
    /// distance of `error · height / (2·tan(fov / 2))`, for a picture of so many pixels height and a vertical field of
    /// view. In [screen coverage](crate::export::GlbOptions::with_coverages) that is, for all levels but the last, the tree's
    /// height over the next level's error and the picture's height in pixels; 0 for the last.
    pub error: f32,
}

impl Default for Levels {
    /// Four levels from an error of 1 mm on, otherwise default tubes.
    fn default() -> Self {
        Self { tubes: Tubes::default(), count: 4, error: 0.001 }
    }
}

impl Levels {
    /// All that is not a matter of detail: collars, root flare, bark, wind. Its sides, turn and error do not matter.
    pub fn with_tubes(mut self, tubes: Tubes) -> Self {
        self.tubes = tubes;
        self
    }

    /// The number of levels, 1 to 32; default 4. There are fewer if nothing is left to drop.
    pub fn with_count(mut self, count: u32) -> Self {
        self.count = count;
        self
    }

    /// The [error](Tubes::with_error) of the finest level, metres; default 0.001.
    pub fn with_error(mut self, error: f32) -> Self {
        self.error = error;
        self
    }

    /// The levels, finest first; none for a tree without a surface.
    ///
    /// O(nodes) for each try, of which there are about six a level, and the time of each mesh.
    ///
    /// # Errors
    /// A count out of range; whatever [`Tubes::mesh`] refuses.
    pub fn of(&self, skeleton: &Skeleton) -> Result<Vec<Level>, SurfaceError> {
        ParameterError::unless((1..=32).contains(&self.count), "Levels.count", self.count, "1 to 32")?;
        let mut levels: Vec<Level> = Vec::new();
        let size = Bounds::of(skeleton.positions().iter().copied()).size().length();
        let widest = skeleton.radii().iter().copied().fold(0.0, f32::max);
        let mut error = self.error;
        let mut most = usize::MAX;
        while levels.len() < self.count as usize {
            let tubes = self.tubes.clone().with_error(error);
            let plan = tubes.plan(skeleton)?;
            if plan.triangles <= most {
                let mesh = plan.weave(&tubes);
                most = mesh.triangles().len() / 2;
                if mesh.is_empty() {
                    break;
                }
                levels.push(Level { mesh, error });
            }
            // At an error of the whole tree's size nothing is left to save.
            if error > size + widest {
                break;
            }
            error *= STEP;
        }
        Ok(levels)
    }
}
