//! What an edge costs (section 3.1.2).

use super::context::Context;
use super::fork::Fork;
use crate::math::{UP, cos, powf, sin};
use crate::parameter::ParameterError;
use crate::shape::Shape;
use glam::{Vec3, Vec4};
use std::sync::Arc;

/// Edges whose weights are worked out together.
const LANES: usize = 4;

/// Gives each edge its weight, once the node it starts from has its guiding vector.
///
/// # Contract
/// - A weight is at least 0, and infinite where an edge is forbidden. NaN and negative weights end the synthesis
///   with [`SearchError::Weight`]: least-cost paths would not exist.
/// - The same edge gives the same weight. If not, equal seeds no longer give equal trees.
/// - A function that may return infinity says so in [`forbids`](Self::forbids). If it does not, endpoints may be
///   chosen where no path leads, and the synthesis ends with [`SearchError::Unreachable`].
///
/// [`SearchError::Weight`]: super::SearchError::Weight
/// [`SearchError::Unreachable`]: super::SearchError::Unreachable
///
/// ```
/// use treesynth::{WeightFn, guided::Edge};
///
/// /// Guided as in the paper, but climbing costs extra.
/// struct Heavy { gravity: f32 }
///
/// impl WeightFn for Heavy {
///     fn weight(&self, edge: &Edge<'_>) -> f32 {
///         edge.guided() + self.gravity * (edge.end.y - edge.start.y).max(0.0)
///     }
/// }
/// ```
pub trait WeightFn: Send + Sync {
    /// The weight of `edge`.
    fn weight(&self, edge: &Edge<'_>) -> f32;

    /// The weights of a star's edges, in their order. The search asks for all weights by it, so that one call through a
    /// pointer serves many edges; also for those of a way that proves not to be the best. Calls [`weight`](Self::weight) for each; override it only to share work between
    /// the edges, and give the same weights.
    fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = self.weight(&star.edge(i));
        }
    }

    /// Whether a weight may be infinite. Endpoints are then chosen after the search, among nodes it reached.
    fn forbids(&self) -> bool {
        false
    }

    /// Whether the options are in range; asked once, before synthesis starts.
    ///
    /// # Errors
    /// The first option that is not.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: WeightFn + ?Sized> WeightFn for $pointer {
            fn weight(&self, edge: &Edge<'_>) -> f32 {
                (**self).weight(edge)
            }
            fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
                (**self).weights(star, weights);
            }
            fn forbids(&self) -> bool {
                (**self).forbids()
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);

/// An edge of the graph, as seen from a settled node.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Edge<'a> {
    pub(super) context: Context<'a>,
    pub(super) source: u32,
    /// The node it starts from.
    pub from: u32,
    /// The node it leads to.
    pub to: u32,
    /// Where it starts, metres.
    pub start: Vec3,
    /// Where it ends, metres.
    pub end: Vec3,
    /// Unit vector along it.
    pub direction: Vec3,
    /// Its length, metres.
    pub length: f32,
    /// The unit guiding vector of the node it starts from.
    pub vector: Vec3,
    /// Least cost from the tree to the node it starts from.
    pub cost: f32,
    /// Edges from the source of this stage to the node it starts from; 0 on the tree.
    pub hops: u32,
    /// Metres of path from the source of this stage to the node it starts from; 0 on the tree.
    pub path_length: f32,
    /// The stage, from 0.
    pub stage: usize,
    /// The seed of the tree.
    pub seed: u64,
}

/// Edges that start from one node, which is settled: at most 8 of a node's at a time, and only those that may still
/// lead to something cheaper.
#[derive(Debug, Clone, Copy)]
pub struct Star<'a> {
    pub(super) context: Context<'a>,
    pub(super) from: u32,
    pub(super) source: u32,
    pub(super) start: Vec3,
    pub(super) vector: Vec3,
    pub(super) cost: f32,
    pub(super) hops: u32,
    pub(super) path_length: f32,
    pub(super) stage: usize,
    pub(super) seed: u64,
    /// The nodes that they lead to, and where those are.
    pub(super) ends: &'a [(u32, Vec3)],
}

impl<'a> Star<'a> {
    /// The number of edges.
    pub fn edges(&self) -> usize {
        self.ends.len()
    }

    /// One of the edges.
    ///
    /// # Panics
    /// When there is no edge `i`.
    #[inline]
    pub fn edge(&self, i: usize) -> Edge<'a> {
        let (to, end) = self.ends[i];
        let way = end - self.start;
        let length = way.length();
        Edge {
            context: self.context,
            source: self.source,
            from: self.from,
            to,
            start: self.start,
            end,
            direction: way / length,
            length,
            vector: self.vector,
            cost: self.cost,
            hops: self.hops,
            path_length: self.path_length,
            stage: self.stage,
            seed: self.seed,
        }
    }
}

impl Star<'_> {
    /// [`Edge::guided`] of four edges: the same operations in the same order.
    #[inline]
    fn guided(&self, edges: [usize; LANES]) -> [f32; LANES] {
        let ends = edges.map(|i| self.ends[i].1);
        let axis = |coordinate: fn(Vec3) -> f32| Vec4::from(ends.map(coordinate)) - coordinate(self.start);
        let (x, y, z) = (axis(|v| v.x), axis(|v| v.y), axis(|v| v.z));
        let lengths = (x * x + y * y + z * z).sqrt();
        let (x, y, z) = (x / lengths, y / lengths, z / lengths);
        let cosines = x * self.vector.x + y * self.vector.y + z * self.vector.z;
        (lengths * (Vec4::ONE - cosines).max(Vec4::ZERO)).to_array()
    }
}

impl Edge<'static> {
    /// An edge to try a weight with: from node 0, the root of a trunk that points up, at `start` to node 1 at `end`
    /// (metres, not the same place), with a guiding vector of any length but zero. The fields can be set.
    pub fn new(start: Vec3, end: Vec3, vector: Vec3) -> Self {
        let way = end - start;
        Self {
            context: Context::Alone { start, end, root: start, fork: Fork::new(UP) },
            source: 0,
            from: 0,
            to: 1,
            start,
            end,
            direction: way.normalize_or(UP),
            length: way.length(),
            vector: vector.normalize_or(UP),
            cost: 0.0,
            hops: 0,
            path_length: 0.0,
            stage: 0,
            seed: 0,
        }
    }
}

impl Edge<'_> {
    /// The node of the tree that the path to its start comes from; its start itself on the tree.
    pub fn source(&self) -> u32 {
        self.source
    }

    /// The parent branch at the source. O(1); the first call of a stage takes O(n) for the n nodes of the tree.
    pub fn fork(&self) -> Fork {
        self.context.fork(self.source)
    }

    /// Where the root of the tree is, metres.
    pub fn root(&self) -> Vec3 {
        self.context.root(self.source)
    }

    /// Whether it ends one edge away from the tree. O(edges of its end).
    pub fn is_beside_tree(&self) -> bool {
        self.context.is_beside_tree(self.to)
    }

    /// The paper's weight, `d (1 - e·v)`: 0 along the guiding vector, 2d against it.
    #[inline]
    pub fn guided(&self) -> f32 {
        self.length * self.deviation()
    }

    /// `1 - e·v`, in [0, 2], clamped at 0 against rounding.
    #[inline]
    pub fn deviation(&self) -> f32 {
        (1.0 - self.direction.dot(self.vector)).max(0.0)
    }
}

/// The paper's weight, `d (1 - e·v)`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Guided;

impl WeightFn for Guided {
    #[inline]
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        edge.guided()
    }

    /// Four edges at once, each as [`weight`](Self::weight) says, to the bit.
    fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
        let edges = weights.len();
        if edges == 0 {
            return;
        }
        if edges < LANES {
            for (weight, guided) in
                weights.iter_mut().zip(star.guided([0, 1, 2, 3].map(|i| i.min(edges - 1))))
            {
                *weight = guided;
            }
            return;
        }
        let mut first = 0;
        loop {
            let four = star.guided([0, 1, 2, 3].map(|i| first + i));
            weights[first..first + LANES].copy_from_slice(&four);
            if first + LANES == edges {
                return;
            }
            // The last four again where fewer are left.
            first = (first + LANES).min(edges - LANES);
        }
    }
}

/// `d^a (1 - e·v)^b`: a power of the paper's weight where a = b.
///
/// b above 1 forgives small deviations and punishes large ones; a above 1 prefers many short edges to few long.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GuidedPower {
    length_exponent: f32,
    deviation_exponent: f32,
}

impl GuidedPower {
    /// Both exponents, in [0, 16]: a power of the whole weight.
    pub fn new(exponent: f32) -> Self {
        Self { length_exponent: exponent, deviation_exponent: exponent }
    }

    /// The exponent of the edge's length alone, in [0, 16].
    pub fn with_length_exponent(mut self, exponent: f32) -> Self {
        self.length_exponent = exponent;
        self
    }

    /// The exponent of the deviation from the guiding vector alone, in [0, 16].
    pub fn with_deviation_exponent(mut self, exponent: f32) -> Self {
        self.deviation_exponent = exponent;
        self
    }
}

impl WeightFn for GuidedPower {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        powf(edge.length, self.length_exponent) * powf(edge.deviation(), self.deviation_exponent)
    }

    fn check(&self) -> Result<(), ParameterError> {
        for (parameter, exponent) in [
            ("GuidedPower.length_exponent", self.length_exponent),
            ("GuidedPower.deviation_exponent", self.deviation_exponent),
        ] {
            ParameterError::unless((0.0..=16.0).contains(&exponent), parameter, exponent, "in [0, 16]")?;
        }
        Ok(())
    }
}

/// Plain length: paths without guiding vectors, "crooked" as on the left of figure 2.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Length;

impl WeightFn for Length {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        edge.length
    }
}

/// Several favoured directions at once (section 5, "multimodal edge weight adjustments"): an edge costs what it
/// deviates from the best of them.
#[must_use]
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Multimodal {
    /// (unit direction, factor of the cost)
    directions: Vec<(Vec3, f32)>,
    /// (sine and cosine of the angle to the guiding vector, factor of the cost)
    cones: Vec<(f32, f32)>,
}

impl Multimodal {
    /// The guiding vector alone, as in [`Guided`].
    pub fn new() -> Self {
        Self::default()
    }

    /// Favours a direction in space too. `factor`, at least 0 and finite, multiplies the cost of deviating from
    /// it: above 1 the guiding vector is preferred, below 1 the direction is.
    pub fn with_direction(mut self, direction: Vec3, factor: f32) -> Self {
        self.directions.push((direction, factor));
        self
    }

    /// Favours all directions at `angle` radians, in [0, π], from the guiding vector too, as lateral branches
    /// of a fixed insertion angle do. `factor` as above.
    pub fn with_cone(mut self, angle: f32, factor: f32) -> Self {
        self.cones.push((angle, factor));
        self
    }
}

impl WeightFn for Multimodal {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        let mut least = edge.deviation();
        for &(direction, factor) in &self.directions {
            let cosine = edge.direction.dot(direction.normalize_or(UP));
            least = least.min(factor * (1.0 - cosine).max(0.0));
        }
        for &(angle, factor) in &self.cones {
            // cos(a - angle), with a the angle between the edge and the vector.
            let cosine = edge.direction.dot(edge.vector).clamp(-1.0, 1.0);
            let nearest = cosine * cos(angle) + (1.0 - cosine * cosine).max(0.0).sqrt() * sin(angle);
            least = least.min(factor * (1.0 - nearest).max(0.0));
        }
        edge.length * least
    }

    fn check(&self) -> Result<(), ParameterError> {
        for &(direction, factor) in &self.directions {
            let usable = direction.try_normalize().is_some();
            ParameterError::unless(usable, "Multimodal.direction", direction, "finite and not zero")?;
            check_factor("Multimodal.factor", factor, false)?;
        }
        for &(angle, factor) in &self.cones {
            let usable = (0.0..=std::f32::consts::PI).contains(&angle);
            ParameterError::unless(usable, "Multimodal.angle", angle, "in [0, π] radians")?;
            check_factor("Multimodal.factor", factor, false)?;
        }
        Ok(())
    }
}

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
    /// `price`, at least 0 and finite, a metre; the paper's weight is 2 a metre against the guiding vector and 0.1 to 0.3
    /// along it, as crooked as edges are.
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
        ParameterError::unless(fits, "Apart.price", self.price, "finite and at least 0 a metre")?;
        self.weight.check()
    }
}

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

fn check_factor(parameter: &str, factor: f32, infinite: bool) -> Result<(), ParameterError> {
    let range = if infinite { "at least 0, or infinite" } else { "at least 0 and finite" };
    ParameterError::unless(factor >= 0.0 && (infinite || factor.is_finite()), parameter, factor, range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, unit};

    /// [`Guided`] without what it does for several edges at once.
    struct OneByOne;

    impl WeightFn for OneByOne {
        fn weight(&self, edge: &Edge<'_>) -> f32 {
            edge.guided()
        }
    }

    #[test]
    fn edges_together_weigh_what_they_weigh_alone() {
        let draw = |i: u64, axis| unit(5, axis, Purpose::CUSTOM, i) - 0.5;
        let point = |i: u64| Vec3::new(draw(i, 0), draw(i, 1), draw(i, 2));
        for i in 0..2000 {
            let start = point(i * 10);
            let edge = Edge::new(start, start + Vec3::Y, point(i * 10 + 1));
            let ends: Vec<(u32, Vec3)> = (0..i % 9).map(|to| (to as u32, point(i * 10 + 2 + to))).collect();
            let star = Star {
                context: edge.context,
                from: 0,
                source: 0,
                start,
                vector: edge.vector,
                cost: 0.0,
                hops: 0,
                path_length: 0.0,
                stage: 0,
                seed: 0,
                ends: &ends,
            };
            let bits = |weight: &dyn WeightFn| -> Vec<u32> {
                let mut weights = vec![f32::NAN; ends.len()];
                weight.weights(&star, &mut weights);
                weights.into_iter().map(f32::to_bits).collect()
            };
            assert_eq!(bits(&Guided), bits(&OneByOne), "{} edges", ends.len());
        }
    }
}
