//! Where nodes may stand, besides what the environment says.

use crate::ParameterError;
use crate::shape::Shape;
use glam::Vec3;
use std::sync::Arc;

/// Envelopes and obstacles.
#[derive(Clone, Default)]
pub(super) struct Room {
    pub(super) envelopes: Vec<Arc<dyn Shape>>,
    pub(super) obstacles: Vec<Arc<dyn Shape>>,
}

impl std::fmt::Debug for Room {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (envelopes, obstacles) = (self.envelopes.len(), self.obstacles.len());
        f.debug_struct("Room").field("envelopes", &envelopes).field("obstacles", &obstacles).finish()
    }
}

impl Room {
    pub(super) fn holds(&self, point: Vec3) -> bool {
        let inside = |shape: &Arc<dyn Shape>| shape.contains(point);
        self.envelopes.iter().all(inside) && !self.obstacles.iter().any(inside)
    }

    /// Whether a metamer may go from `start` to `end`: its end and three points on the way are looked at.
    pub(super) fn is_open(&self, start: Vec3, end: Vec3) -> bool {
        if self.envelopes.is_empty() && self.obstacles.is_empty() {
            return true;
        }
        [1.0, 0.25, 0.5, 0.75].into_iter().all(|way| self.holds(start.lerp(end, way)))
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        self.envelopes.iter().chain(&self.obstacles).try_for_each(Shape::check)
    }
}
