//! Trees that keep to their own ground.

use super::weight::{Edge, WeightFn};
use crate::parameter::ParameterError;
use glam::Vec3;

/// Another weight, and a price on every metre that is nearer to another tree's root than to one's own, seen from above: crowns
/// of several trees in one graph give way to each other.
///
/// The paper's weight alone lets a limb that goes straight on reach far into a neighbour's crown, for along the guiding
/// vector way costs next to nothing. An infinite price forbids it: each tree then stays within its cell of the roots' Voronoi
/// diagram. O(m) per edge for m roots.
///
/// ```
/// use treesynth::{WeightFn, glam::Vec3, guided::{Edge, Guided, Territory}};
///
/// let weight = Territory::new(Guided, [Vec3::ZERO, Vec3::X * 4.0], 0.5);
/// let edge = |x: f32| Edge::new(Vec3::new(x, 1.0, 0.0), Vec3::new(x, 2.0, 0.0), Vec3::Y);
/// // An edge to try a weight with starts at its tree's root.
/// assert_eq!(weight.weight(&edge(0.0)), 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Territory<W> {
    weight: W,
    roots: Vec<Vec3>,
    #[cfg_attr(feature = "serde", serde(with = "crate::parameter::maybe_infinite"))]
    price: f32,
}

crate::recipe::mapped!(Territory { weight; roots, price });

impl<W: WeightFn> Territory<W> {
    /// The roots of all trees, metres, and the price per metre: at least 0, and infinite to forbid.
    pub fn new(weight: W, roots: impl Into<Vec<Vec3>>, price: f32) -> Self {
        Self { weight, roots: roots.into(), price }
    }
}

impl<W: WeightFn> WeightFn for Territory<W> {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        let away = |root: Vec3| (edge.end - root).with_y(0.0).length_squared();
        let own = away(edge.root());
        let is_own = self.roots.iter().all(|&root| own <= away(root));
        self.weight.weight(edge) + if is_own { 0.0 } else { self.price * edge.length }
    }

    fn forbids(&self) -> bool {
        self.price == f32::INFINITY || self.weight.forbids()
    }

    fn check(&self) -> Result<(), ParameterError> {
        let price = self.price;
        ParameterError::unless(price >= 0.0, "Territory.price", price, "at least 0 per metre, or infinite")?;
        for root in &self.roots {
            ParameterError::unless(root.is_finite(), "Territory.roots", root, "finite, in metres")?;
        }
        self.weight.check()
    }
}
