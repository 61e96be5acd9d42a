//! Built-in shapes as data.

use super::{
    Bounds, Cone, Cuboid, Cylinder, Difference, Ellipsoid, HalfEllipsoid, Intersection, Shape, Shell, Sphere,
    Translated, Union,
};
use crate::ParameterError;
use crate::recipe::recipe;
use glam::Vec3;

recipe! {
    /// A built-in shape as data: what a [`guided::Recipe`](crate::guided::Recipe) can print, compare and save.
    ///
    /// ```
    /// use treesynth::{Shape, glam::Vec3, shape::{HalfEllipsoid, ShapeRecipe, Shell}};
    ///
    /// let dome = Shell::new(HalfEllipsoid::new(Vec3::Y * 2.0, Vec3::splat(4.0)), 0.25).about(Vec3::Y * 2.0);
    /// let recipe = ShapeRecipe::from(dome);
    /// assert_eq!(recipe.contains(Vec3::Y * 5.5), dome.contains(Vec3::Y * 5.5));
    /// assert!(format!("{recipe:?}").contains("thickness: 0.25"));
    /// ```
    ShapeRecipe: Shape {
        plain Cuboid,
        plain Sphere,
        plain Ellipsoid,
        plain HalfEllipsoid,
        plain Cone,
        plain Cylinder,
        nested Shell<ShapeRecipe>,
        nested Translated<ShapeRecipe>,
        pair Union<ShapeRecipe, ShapeRecipe>,
        pair Intersection<ShapeRecipe, ShapeRecipe>,
        pair Difference<ShapeRecipe, ShapeRecipe>,
    }
}

impl Shape for ShapeRecipe {
    fn contains(&self, point: Vec3) -> bool {
        self.strategy().contains(point)
    }

    fn bounds(&self) -> Bounds {
        self.strategy().bounds()
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }

    fn volume(&self) -> f32 {
        self.strategy().volume()
    }

    fn touches(&self, bounds: Bounds) -> bool {
        self.strategy().touches(bounds)
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.strategy().sample(random)
    }

    fn surface_area(&self) -> Option<f32> {
        self.strategy().surface_area()
    }

    fn sample_surface(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.strategy().sample_surface(random)
    }
}
