//! The spacing of nodes as a function of position, made from a sizing field.

use super::scalars::Scalars;
use super::sizing::SizingField;
use crate::math::cbrt;
use crate::parallel;
use crate::parameter::ParameterError;
use crate::shape::{Bounds, Shape};
use glam::{IVec3, Vec3};

/// The disc radius r of a [`GradedYao`](super::GradedYao) at every place: values on a lattice, linear in between.
///
/// Along each axis r changes by at most the grading, in any direction by at most √3 times that, metre for metre.
/// Beyond the lattice, which covers the region's bounds, r is that of the nearest place on it. 4 bytes per
/// point.
#[derive(Debug, Clone)]
pub struct Spacing {
    scalars: Scalars,
}

impl Spacing {
    /// r at `point`, metres, which must be finite. O(1).
    #[inline]
    pub fn at(&self, point: Vec3) -> f32 {
        self.scalars.at(point)
    }

    /// The least and the largest r in the region's bounds, metres. O(n) for n points of the lattice.
    pub fn extremes(&self) -> (f32, f32) {
        self.scalars.extremes()
    }

    /// The least and the largest r in a box.
    pub(super) fn range(&self, bounds: Bounds) -> (f32, f32) {
        self.scalars.range(bounds)
    }
}

/// A sizing field on a lattice over a region's bounds.
pub(super) struct Samples {
    /// Values of the field, not limited yet.
    wanted: Scalars,
    /// The volume of the region that each point stands for, cubic metres.
    volumes: Vec<f32>,
    /// The volume of a whole cell.
    cell: f32,
    /// The longest way through the bounds: a larger r makes no difference.
    diagonal: f32,
}

/// Nodes in a cube of side r, far from its border; and what a face of the region adds, in layers of r.
const DENSITY: f32 = 0.6687;
const FACE: f32 = 0.444;

impl Samples {
    /// About `points` of them; the region is checked, its bounds have a volume.
    pub(super) fn new(
        region: &dyn Shape,
        sizing: &dyn SizingField,
        points: f32,
    ) -> Result<Self, ParameterError> {
        let bounds = region.bounds();
        let size = bounds.size();
        let mut side = cbrt(size.element_product() / points);
        let cells = |side: f32| (size / side).ceil().max(Vec3::ONE);
        // Flat bounds would take too many.
        while (cells(side) + 1.0).element_product() > 4.0 * points {
            side *= 1.2;
        }
        let (step, dims) = (size / cells(side), cells(side).as_ivec3() + 1);
        let layers = parallel::map(dims.z as usize, |z| {
            let mut layer = Vec::with_capacity((dims.x * dims.y) as usize);
            for y in 0..dims.y {
                for x in 0..dims.x {
                    let place = IVec3::new(x, y, z as i32);
                    let point = (bounds.min + place.as_vec3() * step).min(bounds.max);
                    // Points on the border of the bounds stand for half a cell, a quarter, an eighth.
                    let border = place.cmpeq(IVec3::ZERO) | place.cmpeq(dims - 1);
                    let share = Vec3::select(border, Vec3::splat(0.5), Vec3::ONE).element_product();
                    layer.push((sizing.at(point), if region.contains(point) { share } else { 0.0 }, point));
                }
            }
            layer
        });
        let cell = step.element_product();
        let mut values = Vec::with_capacity(dims.element_product() as usize);
        let mut volumes = Vec::with_capacity(values.capacity());
        for (size, share, point) in layers.into_iter().flatten() {
            if !(size > 0.0 && size.is_finite()) {
                let value = format_args!("{size} at {point}");
                return Err(ParameterError::new("GradedYao.sizing", value, "finite and above 0 everywhere"));
            }
            values.push(size);
            volumes.push(share * cell);
        }
        let wanted = Scalars::new(bounds.min, step, dims, values);
        Ok(Self { wanted, volumes, cell, diagonal: size.length() })
    }

    /// The spacing that changes by at most `grading` along an axis and is nowhere above `scale` times the field.
    pub(super) fn spacing(&self, scale: f32, grading: f32) -> Spacing {
        let mut scalars = self.wanted.clone();
        for r in &mut scalars.values {
            *r = (*r * scale).min(self.diagonal);
        }
        scalars.limit(grading);
        Spacing { scalars }
    }

    /// The side, in spacings, of a cube that holds as many discs as the region, its border left out.
    pub(super) fn side(&self, spacing: &Spacing) -> f32 {
        let discs: f64 =
            self.volumes.iter().zip(&spacing.scalars.values).map(|(&v, &r)| f64::from(v / (r * r * r))).sum();
        cbrt(discs as f32)
    }

    /// Discs in the region's bounds.
    pub(super) fn discs_in_bounds(&self, spacing: &Spacing) -> f32 {
        spacing.scalars.values.iter().map(|&r| f64::from(self.cell / (r * r * r))).sum::<f64>() as f32
    }

    /// The scale at which about `nodes` nodes come out, from a guess. The spacing reacts to it less
    /// than in proportion where the grading holds it back, so each step goes the right way and not
    /// too far.
    pub(super) fn scale_for(&self, nodes: f32, grading: f32, guess: f32, steps: usize) -> f32 {
        let wanted = (cbrt(nodes / DENSITY) - FACE).max(0.5);
        let mut scale = guess;
        for _ in 0..steps {
            let ratio = self.side(&self.spacing(scale, grading)) / wanted;
            scale *= ratio;
            if (ratio - 1.0).abs() < 1e-3 {
                break;
            }
        }
        scale
    }

    /// Approximate number of nodes with this spacing.
    pub(super) fn nodes(&self, spacing: &Spacing) -> f32 {
        let side = self.side(spacing) + FACE;
        DENSITY * side * side * side
    }
}
