//! One tree in several levels of detail.

use super::plan::Plan;
use super::tube::PLANNING;
use super::{Mesh, SurfaceError, Tubes, far};
use crate::observer::{Observer, Watch, Work};
use crate::parallel;
use crate::{Bounds, ParameterError, Skeleton};
use std::{iter, mem};

/// Factor on the error from one try to the next, until a level is small enough.
const STEP: f32 = 1.25;
/// Usual number of tries until triangles are halved.
const USUAL: usize = 4;

/// A chain of meshes of one skeleton, each of at most half the triangles of the one before.
///
/// Every level is [`Tubes::with_error`] at the least error that halves the triangles, found in steps of a
/// quarter. Small branches go first, silhouettes agree within a few errors, nothing is random, and all levels
/// share their axes: one can fade into the next.
///
/// ```
/// use treesynth::{presets, surface::Levels};
///
/// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(3000).synthesize(1)?.relaxed(0.5, 3)?;
/// let levels = Levels::default().with_count(3).of(&tree)?;
/// for pair in levels.windows(2) {
///     assert!(pair[1].mesh.triangles().len() * 2 <= pair[0].mesh.triangles().len());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[doc(alias("LOD", "level of detail"))]
pub struct Levels {
    tubes: Tubes,
    count: u32,
    error: f32,
}

crate::recipe::readable!(Levels { count: u32, error: f32 });

crate::recipe::readable!(&Levels { tubes: Tubes });

/// A mesh and how far it may be off.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Level {
    /// The surface.
    pub mesh: Mesh,
    /// Greatest difference from the smooth tubes, metres. Show the level from the distance at which this is
    /// less than a pixel: `error · height / (2·tan(fov / 2))` for a picture of `height` pixels height and the
    /// vertical field of view `fov`. In [screen coverage](crate::export::GlbOptions::with_coverages) that is,
    /// for all levels but the last, the tree's height over the next level's error and the picture's height in
    /// pixels; 0 for the last.
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
    /// O(nodes) for each try, of which there are two or three per level of a tree of many branches, and the
    /// time of each mesh. With the feature `parallel` a mesh is made while the next error is looked for.
    ///
    /// # Errors
    /// A count out of range; whatever [`Tubes::mesh`] refuses.
    pub fn of(&self, skeleton: &Skeleton) -> Result<Vec<Level>, SurfaceError> {
        self.levels(skeleton, None)
    }

    /// As [`of`](Self::of), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`of`](Self::of), and [`SurfaceError::Cancelled`].
    pub fn of_observed(
        &self,
        skeleton: &Skeleton,
        observer: &dyn Observer,
    ) -> Result<Vec<Level>, SurfaceError> {
        // Each level takes half the time of the one before: as much as two of the first together, and some for trying.
        let watch = Watch::new(observer, Work::Surface, 8 * skeleton.len(), PLANNING);
        let levels = self.levels(skeleton, Some(&watch))?;
        watch.finish()?;
        Ok(levels)
    }

    fn levels(&self, skeleton: &Skeleton, watch: Option<&Watch<'_>>) -> Result<Vec<Level>, SurfaceError> {
        ParameterError::unless((1..=32).contains(&self.count), "Levels.count", self.count, "1 to 32")?;
        let tubes = |error| self.tubes.clone().with_error(error);
        let offset = far::offset_of(skeleton);
        let skeleton = &*far::near(skeleton, offset);
        let silent = Watch::silent();
        let is_watched = watch.is_some();
        let watch = watch.unwrap_or(&silent);
        let mut next = Some((0, tubes(self.error).plan_watched(skeleton, watch)?));
        let size = Bounds::of(skeleton.positions().iter().copied()).size().length();
        let widest = skeleton.radii().iter().copied().fold(0.0, f32::max);
        // At an error of the whole tree's size nothing is left to save.
        let mut last = false;
        let errors = iter::successors(Some(self.error), |error| Some(error * STEP));
        let errors: Vec<_> =
            errors.take_while(|error| !mem::replace(&mut last, *error > size + widest)).collect();
        let mut levels: Vec<Level> = Vec::new();
        while let Some((step, plan)) = next {
            let error = errors[step];
            let after = |triangles| {
                half(step, &errors, triangles / 2, |error| tubes(error).plan_watched(skeleton, watch))
            };
            let is_last = levels.len() + 1 == self.count as usize;
            let weave = || plan.weave_watched(&tubes(error), watch);
            let look_ahead = || if is_last { Ok(None) } else { after(plan.triangles) };
            // One after the other for an observer, which gets reports from one thread.
            let (mesh, ahead) =
                if is_watched { (weave(), look_ahead()) } else { parallel::join(weave, look_ahead) };
            let mesh = far::back_open(mesh?, offset)?;
            if mesh.is_empty() {
                break;
            }
            let triangles = mesh.triangles().len();
            levels.push(Level { mesh, error });
            // Triangles that rounding has left without area were not known ahead.
            next = if is_last || triangles == plan.triangles { ahead? } else { after(triangles)? };
        }
        Ok(levels)
    }
}

impl Tubes {
    /// The most detailed tubes of at most `triangles` triangles.
    ///
    /// That is [`with_error`](Self::with_error) at the least error that keeps the budget, found in steps of an eighth, but
    /// branches go sooner than the others lose their shape: those that show less than 4 (2 `error`)² with all they bear. A
    /// larger budget keeps every branch of a smaller one. O(nodes) for each of some seven tries.
    ///
    /// ```
    /// use treesynth::{presets, surface::Tubes};
    ///
    /// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(3000).synthesize(1)?.relaxed(0.5, 3)?;
    /// assert!(Tubes::default().within(&tree, 2_000)?.mesh.triangles().len() <= 2_000);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Fewer triangles than the trunk needs, [`SurfaceError::TooFewTriangles`]; whatever [`mesh`](Self::mesh) refuses.
    pub fn within(&self, skeleton: &Skeleton, triangles: usize) -> Result<Level, SurfaceError> {
        let silent = Watch::silent();
        Ok(self.within_keeping(skeleton, triangles, &silent)?.0)
    }

    /// As [`within`](Self::within), and for each branch whether it is there.
    pub(crate) fn within_keeping(
        &self,
        skeleton: &Skeleton,
        triangles: usize,
        watch: &Watch<'_>,
    ) -> Result<(Level, Vec<bool>), SurfaceError> {
        /// Factor on the error from one step to the next.
        const STEP: f32 = 1.125;
        /// The least error tried, as a share of the thickest radius.
        const LEAST: f32 = 1e-3;
        /// Branches go sooner than the others lose their shape by this factor.
        const UNSEEN: f32 = 2.0;
        let widest = skeleton.radii().iter().copied().fold(0.0, f32::max);
        let size = Bounds::of(skeleton.positions().iter().copied()).size().length();
        let tubes = |error| self.clone().with_error(error).with_unseen(UNSEEN);
        let offset = far::offset_of(skeleton);
        let skeleton = &*far::near(skeleton, offset);
        let first = (widest * LEAST).clamp(1e-6, f32::MAX);
        // At an error of the whole tree's size nothing is left to save. Coordinates near the greatest floats have no finite size.
        let most = (size + widest).min(0.5 * f32::MAX);
        let mut errors = vec![first];
        while errors[errors.len() - 1] <= most {
            errors.push(errors[errors.len() - 1] * STEP);
        }
        let (mut low, mut high) = (0, errors.len() - 1);
        let mut found = tubes(errors[high]).plan_watched(skeleton, watch)?;
        if found.triangles > triangles {
            return Err(SurfaceError::TooFewTriangles { triangles, least: found.triangles });
        }
        while low < high {
            let middle = usize::midpoint(low, high);
            let plan = tubes(errors[middle]).plan_watched(skeleton, watch)?;
            if plan.triangles <= triangles {
                (high, found) = (middle, plan);
            } else {
                low = middle + 1;
            }
        }
        let error = errors[high];
        let mut kept = vec![false; skeleton.branches().len()];
        found.axes.all.iter().for_each(|axis| kept[axis.branch] = true);
        let mesh = far::back_open(found.weave_watched(&tubes(error), watch)?, offset)?;
        Ok((Level { mesh, error }, kept))
    }
}

/// The least step after `step` at which there are at most `most` triangles, and its plan; `None` if there is
/// none.
///
/// Triangles get fewer with every step; the search starts at the usual one.
fn half(
    step: usize,
    errors: &[f32],
    most: usize,
    plan: impl Fn(f32) -> Result<Plan, SurfaceError>,
) -> Result<Option<(usize, Plan)>, SurfaceError> {
    let mut found = None;
    let mut at = (step + USUAL).min(errors.len() - 1);
    while at > step && at < errors.len() {
        let plan = plan(errors[at])?;
        if plan.triangles <= most {
            found = Some((at, plan));
            at -= 1;
        } else if found.is_none() {
            at += 1;
        } else {
            break;
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn errors_are_the_least_that_halve_the_triangles() {
        for (name, nodes) in
            [("figure-06b", 2000), ("figure-18", 3000), ("figure-17e", 500), ("figure-03", 300)]
        {
            let preset = presets::by_name(name).expect("a preset").guided().unwrap();
            let tree =
                preset.synth(nodes).synthesize(1).expect("a tree").relaxed(0.5, 3).expect("sound options");
            for least in [1e-5f32, 0.001, 0.05] {
                let levels = Levels::default().with_count(9).with_error(least).of(&tree).expect("levels");
                assert_eq!(levels[0].error.to_bits(), least.to_bits());
                for pair in levels.windows(2) {
                    let most = pair[0].mesh.triangles().len() / 2;
                    assert!(pair[1].mesh.triangles().len() <= most);
                    let mut error = pair[0].error * STEP;
                    while error < pair[1].error {
                        let plan = Tubes::default().with_error(error).plan(&tree).expect("a plan");
                        assert!(
                            plan.triangles > most,
                            "{name}: {error} would do instead of {}",
                            pair[1].error
                        );
                        error *= STEP;
                    }
                    assert_eq!(error.to_bits(), pair[1].error.to_bits(), "{name}");
                }
            }
        }
    }
}
