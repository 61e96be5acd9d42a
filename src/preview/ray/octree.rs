//! The octree of a solid's parts: a cube is split when the first ray enters it.
//!
//! The split of a cube depends on the cube alone, so it does not matter which thread's ray came
//! first.

use super::super::camera::View;
use crate::Bounds;
use crate::surface::solid::{CROWD, Coverage, Part, Solid};
use glam::Vec3;
use std::array;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// A cube no longer than this many times its part's detail is not split: what is left in it is a piece of one limb.
const DETAILS: f32 = 1.0;
/// Neither is a cube no longer than this many pixels.
const PIXELS: f32 = 1.0;
/// Nor one that has been halved this often.
const DEEPEST: u8 = 22;
/// Roots are found to within this part of a pixel or of the detail, whichever is smaller.
const TOLERANCE: f32 = 0.02;

/// A corner and a side, metres. Both are such that halves are exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cube {
    pub(super) corner: Vec3,
    pub(super) side: f32,
    level: u8,
}

impl Cube {
    /// A cube around a box, its corner and its side so round that no halving rounds.
    pub(super) fn around(bounds: Bounds) -> Self {
        let extent = (bounds.size().max_element() * 1.01).max(1e-6);
        // The next power of two, with room for the corner's rounding.
        let side = f32::from_bits((extent.to_bits() + 0x007f_ffff) & 0x7f80_0000);
        let unit = side / 4096.0;
        let corner = ((bounds.center() - 0.5 * side) / unit).floor() * unit;
        Self { corner, side, level: 0 }
    }

    pub(super) fn bounds(self) -> Bounds {
        Bounds::new(self.corner, self.corner + self.side)
    }

    pub(super) fn middle(self) -> Vec3 {
        self.corner + 0.5 * self.side
    }

    /// The eighth whose bits say on which side of the middle it is.
    pub(super) fn child(self, index: usize) -> Self {
        let side = 0.5 * self.side;
        let bit = |axis: usize| (index >> axis & 1) as f32;
        let corner = self.corner + Vec3::new(bit(0), bit(1), bit(2)) * side;
        Self { corner, side, level: self.level + 1 }
    }
}

/// Knowledge of a cube.
pub(super) enum Node<P> {
    Outside,
    Inside,
    Leaf(Box<Leaf<P>>),
    Inner(Box<Inner<P>>),
}

/// A cube that is not split.
pub(super) struct Leaf<P> {
    pub(super) part: P,
    pub(super) lipschitz: f32,
    /// Tolerance of roots, metres.
    pub(super) tolerance: f32,
    /// Work of a value there because of many primitives, in values of [`CROWD`] primitives.
    pub(super) crowd: usize,
}

pub(super) struct Inner<P> {
    /// Given up when the children are made.
    part: Mutex<Option<P>>,
    children: OnceLock<[Node<P>; 8]>,
}

/// The parts of a solid, as fine as a view of it shows.
pub(super) struct Octree<'a, S: Solid> {
    solid: &'a S,
    view: &'a View,
    /// Samples of the view per pixel, in each direction.
    samples: f32,
    pub(super) cube: Cube,
    pub(super) root: Node<S::Part>,
    cubes: AtomicUsize,
    most: usize,
    /// The work of crowded values, and its limit.
    work: AtomicUsize,
    most_work: usize,
}

impl<'a, S: Solid> Octree<'a, S> {
    #[cfg(test)]
    pub(super) fn new(solid: &'a S, view: &'a View, samples: u32, most: usize) -> Self {
        Self::with_work(solid, view, samples, [most, usize::MAX])
    }

    /// Of a solid whose bounds are finite and not empty. Cubes that the surface may pass are at most `most`, and crowds of
    /// primitives make no more than `most_work`.
    pub(super) fn with_work(
        solid: &'a S,
        view: &'a View,
        samples: u32,
        [most, most_work]: [usize; 2],
    ) -> Self {
        let cube = Cube::around(solid.bounds());
        let (root, cubes, work) = (Node::Outside, AtomicUsize::new(0), AtomicUsize::new(0));
        let samples = samples as f32;
        let mut octree = Self { solid, view, samples, cube, root, cubes, most, work, most_work };
        octree.root = octree.node(None, cube);
        octree
    }

    /// `true` if more cubes were needed than were allowed: results are of no use then.
    pub(super) fn is_full(&self) -> bool {
        self.cubes.load(Ordering::Relaxed) > self.most
    }

    /// `true` if crowds of primitives made more work than was allowed: results are of no use then.
    pub(super) fn is_crowded(&self) -> bool {
        self.work.load(Ordering::Relaxed) > self.most_work
    }

    /// Counts work in a leaf; says whether there may be more.
    pub(super) fn works(&self, crowd: usize) -> bool {
        crowd == 0 || self.work.fetch_add(crowd, Ordering::Relaxed) <= self.most_work
    }

    /// The side of a pixel at a point, metres.
    pub(super) fn pixel(&self, point: Vec3) -> f32 {
        self.view.sample(point) * self.samples
    }

    fn node(&self, of: Option<&S::Part>, cube: Cube) -> Node<S::Part> {
        let part = match self.solid.part(of, cube.bounds()) {
            Coverage::Outside => return Node::Outside,
            Coverage::Inside => return Node::Inside,
            Coverage::Crossed(part) => part,
        };
        if self.cubes.fetch_add(1 + part.count() / CROWD, Ordering::Relaxed) >= self.most {
            return Node::Outside;
        }
        let (detail, pixel) = (part.detail(), self.pixel(cube.middle()));
        if cube.side > (DETAILS * detail).max(PIXELS * pixel) && cube.level < DEEPEST {
            return Node::Inner(Box::new(Inner { part: Mutex::new(Some(part)), children: OnceLock::new() }));
        }
        let lipschitz = part.lipschitz();
        let tolerance = TOLERANCE * detail.min(pixel).min(cube.side);
        let crowd = part.count() / CROWD;
        Node::Leaf(Box::new(Leaf { part, lipschitz, tolerance, crowd }))
    }

    /// The eighths of a cube.
    pub(super) fn children<'b>(&self, inner: &'b Inner<S::Part>, cube: Cube) -> &'b [Node<S::Part>; 8] {
        inner.children.get_or_init(|| {
            let part = inner.part.lock().unwrap_or_else(PoisonError::into_inner).take();
            array::from_fn(|i| self.node(part.as_ref(), cube.child(i)))
        })
    }
}
