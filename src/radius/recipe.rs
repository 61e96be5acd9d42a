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

#[cfg(test)]
mod tests {
    use super::super::sample::y_fork;
    use super::*;

    #[test]
    fn a_recipe_is_its_model() -> Result<(), Box<dyn std::error::Error>> {
        let (fork, model) = (y_fork()?, Stout::new(PipeModel::default(), 0.1));
        let recipe =
            RadiusRecipe::Stout(Box::new(Stout::new(RadiusRecipe::PipeModel(PipeModel::default()), 0.1)));
        assert_eq!(recipe.radii(&fork)?, model.radii(&fork)?);
        assert_eq!(recipe.check(), Ok(()));
        let bad = RadiusRecipe::PipeModel(PipeModel::default().with_exponent(0.0));
        assert!(bad.check().is_err() && bad.radii(&fork).is_err());
        Ok(())
    }
}
