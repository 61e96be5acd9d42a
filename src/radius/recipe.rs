//! Built-in radius models as data.

use super::{PipeModel, RadiusError, RadiusModel, Stout, Taper, Variational};
use crate::recipe::recipe;
use crate::{ParameterError, Skeleton};

recipe! {
    /// A built-in radius model as data: what a [`guided::Recipe`](crate::guided::Recipe) can print, compare and save.
    RadiusRecipe: RadiusModel {
        plain PipeModel,
        plain Variational,
        nested Taper<RadiusRecipe>,
        nested Stout<RadiusRecipe>,
    }
}

impl RadiusModel for RadiusRecipe {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        self.strategy().radii(skeleton)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}
