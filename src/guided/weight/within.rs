//! Obstacles, and ground that is easier or harder to grow in.

use super::{Edge, WeightFn, check_factor};
use crate::parameter::ParameterError;
use crate::shape::Shape;

/// Another weight, multiplied inside a shape: an obstacle, or ground that is easier to grow in.
///
/// An edge counts as inside when its middle or its end is. An infinite factor forbids the inside: then no node of
/// a tree lies in the shape (the root excepted), and no edge crosses what is thicker than half of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Within<W, S> {
    weight: W,
    shape: S,
    #[cfg_attr(feature = "serde", serde(with = "crate::parameter::maybe_infinite"))]
    factor: f32,
}

crate::recipe::mapped!(Within { weight, shape; factor });

impl<W: WeightFn, S: Shape> Within<W, S> {
    /// `factor` times `weight` inside `shape`; at least 0, and infinite to forbid.
    pub fn new(weight: W, shape: S, factor: f32) -> Self {
        Self { weight, shape, factor }
    }

    /// No edge leads into `shape`.
    pub fn obstacle(weight: W, shape: S) -> Self {
        Self::new(weight, shape, f32::INFINITY)
    }
}

impl<W: WeightFn, S: Shape> WeightFn for Within<W, S> {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        let inside =
            self.shape.contains(edge.end) || self.shape.contains(edge.start + (edge.end - edge.start) * 0.5);
        match (inside, self.factor == f32::INFINITY) {
            (false, _) => self.weight.weight(edge),
            (true, true) => f32::INFINITY,
            (true, false) => self.weight.weight(edge) * self.factor,
        }
    }

    fn forbids(&self) -> bool {
        self.factor == f32::INFINITY || self.weight.forbids()
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_factor("Within.factor", self.factor, true)?;
        self.shape.check()?;
        self.weight.check()
    }
}
