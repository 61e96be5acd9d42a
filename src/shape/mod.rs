//! stub until merge
use glam::Vec3;
use crate::parameter::ParameterError;
/// Box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds { /// min
 pub min: Vec3, /// max
 pub max: Vec3 }
impl Bounds { /// size
 pub fn size(&self) -> Vec3 { self.max - self.min } }
/// Shape.
pub trait Shape: Send + Sync {
    /// contains
    fn contains(&self, point: Vec3) -> bool;
    /// bounds
    fn bounds(&self) -> Bounds;
    /// check
    fn check(&self) -> Result<(), ParameterError> { Ok(()) }
    /// volume
    fn volume(&self) -> f32 { let s = self.bounds().size(); s.element_product() }
}
/// cuboid
#[derive(Debug, Clone)]
pub struct Cuboid(Bounds);
impl Cuboid { /// new
 pub fn new(min: Vec3, max: Vec3) -> Self { Self(Bounds{min,max}) } }
impl Shape for Cuboid {
    fn contains(&self, p: Vec3) -> bool { p.cmpge(self.0.min).all() && p.cmple(self.0.max).all() }
    fn bounds(&self) -> Bounds { self.0 }
}
