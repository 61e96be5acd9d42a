//! Bark and leaves together in ever fewer triangles.

use super::builder::{check_side, watch};
use super::tree::Tree;
use super::{Asset, AssetBuilder, AssetError};
use crate::foliage::Leaves;
use crate::observer::{Observer, Silent};
use crate::{ParameterError, Skeleton};

impl AssetBuilder {
    /// The asset in several levels of detail, each with this share of the triangles: `[1.0, 0.3, 0.08]` for three. An
    /// [`Impostor`](super::Impostor) of the same leaves goes where they end.
    ///
    /// Every level has fewer triangles than the one before. Levels are nested: the bark of a level has
    /// branches of the finer one only, and its cards stand for one or several cards of that, or for the
    /// leaves of one. Each level's images are a quarter as wide as those of the one before, 128 pixels at the
    /// least: a level is half as high on the screen, and has fewer cards. Cards of less than 48 pixels have no
    /// normal map. A level is meant for pictures in which the tree is [`Asset::pixels`] pixels high. There are
    /// fewer levels if there is nothing left to drop.
    ///
    /// # Errors
    /// Shares that are not 1 to 8 numbers in (0, 1], each less than the one before; otherwise as [`build`](Self::build). A
    /// last level that would be too small for the trunk is an error too.
    #[doc(alias("LOD", "level of detail"))]
    pub fn levels(&self, skeleton: &Skeleton, seed: u64, shares: &[f32]) -> Result<Vec<Asset>, AssetError> {
        self.levels_observed(skeleton, seed, shares, &Silent)
    }

    /// As [`levels`](Self::levels), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`levels`](Self::levels), and [`AssetError::Cancelled`].
    pub fn levels_observed(
        &self,
        skeleton: &Skeleton,
        seed: u64,
        shares: &[f32],
        observer: &dyn Observer,
    ) -> Result<Vec<Asset>, AssetError> {
        self.levels_with_observed(skeleton, &self.placed(skeleton, seed, observer)?, shares, observer)
    }

    /// As [`levels`](Self::levels), of a tree with these leaves.
    ///
    /// # Errors
    /// As [`levels`](Self::levels); leaves at nodes that do not exist.
    pub fn levels_with(
        &self,
        skeleton: &Skeleton,
        leaves: &[Leaves],
        shares: &[f32],
    ) -> Result<Vec<Asset>, AssetError> {
        self.levels_with_observed(skeleton, leaves, shares, &Silent)
    }

    /// As [`levels_with`](Self::levels_with), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`levels_with`](Self::levels_with), and [`AssetError::Cancelled`].
    pub fn levels_with_observed(
        &self,
        skeleton: &Skeleton,
        leaves: &[Leaves],
        shares: &[f32],
        observer: &dyn Observer,
    ) -> Result<Vec<Asset>, AssetError> {
        let falling = shares.windows(2).all(|pair| pair[1] < pair[0]);
        let within = shares.iter().all(|share| *share > 0.0 && *share <= 1.0);
        let holds = falling && within && (1..=8).contains(&shares.len());
        let range = "1 to 8 numbers in (0, 1], each less than the one before";
        ParameterError::unless(holds, "AssetBuilder.levels.shares", shares, range)?;
        let watch = watch(skeleton, leaves, observer);
        let tree = Tree::new(self, skeleton, leaves, &watch)?;
        let dense = tree.dense_triangles();
        let whole = self.triangles.unwrap_or(dense).min(dense);
        let (mut levels, mut grouping) = (Vec::<Asset>::new(), None);
        let mut side = self.texture_size;
        for share in shares {
            let mut most = (f64::from(*share) * whole as f64) as usize;
            if let Some(last) = levels.last() {
                most = most.min(last.triangles().saturating_sub(1));
                if last.triangles() <= 1 {
                    break;
                }
            }
            check_side("AssetBuilder.texture_size", side)?;
            let most = if most == dense { None } else { Some(most) };
            let (asset, groups) = tree.level(most, side, grouping.as_ref())?;
            levels.push(asset);
            grouping = Some(groups);
            side = (side / 4).max(128);
        }
        watch.finish()?;
        Ok(levels)
    }
}
