//! A price on the way beside the tree.

use super::{Edge, WeightFn};
use crate::parameter::ParameterError;

/// Another weight, and a price on every metre beside the tree, so that new branches leave their parent branch and do
/// not run along it. The first edge off the tree is free.
///
/// ```
/// use treesynth::{WeightFn, glam::Vec3, guided::{Apart, Edge, Guided}};
///
/// let weight = Apart::new(Guided, 0.5);
/// let mut edge = Edge::new(Vec3::ZERO, Vec3::Y, Vec3::Y);
/// assert_eq!(weight.weight(&edge), 0.0);
/// edge.hops = 3;
/// edge.to = 0; // Beside the tree.
/// assert_eq!(weight.weight(&edge), 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Apart<W> {
    weight: W,
    price: f32,
}

crate::recipe::mapped!(Apart { weight; price });

impl<W: WeightFn> Apart<W> {
    /// `price` per metre, at least 0 and finite; the paper's weight is 2 per metre against the
    /// guiding vector and 0.1 to 0.3 along it, since edges are crooked.
    pub fn new(weight: W, price: f32) -> Self {
        Self { weight, price }
    }
}

impl<W: WeightFn> WeightFn for Apart<W> {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        let beside = edge.hops > 0 && edge.is_beside_tree();
        self.weight.weight(edge) + if beside { self.price * edge.length } else { 0.0 }
    }

    fn forbids(&self) -> bool {
        self.weight.forbids()
    }

    fn check(&self) -> Result<(), ParameterError> {
        let fits = self.price >= 0.0 && self.price.is_finite();
        ParameterError::unless(fits, "Apart.price", self.price, "finite and at least 0 per metre")?;
        self.weight.check()
    }
}
