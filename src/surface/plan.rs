//! The axes of all tubes, and how much their mesh will hold.

use super::attach::DOME_SIDES;
use super::axis::Axes;
use super::{Sway, Tubes};
use crate::observer::{Cancelled, Watch};

/// Sections that a branch has at the most: radii differ by no more than floats can tell.
pub(super) const MOST_SECTIONS: usize = 200;

/// All that is known before the first vertex.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) axes: Axes,
    /// How it bends, if that is wanted.
    pub(super) sway: Option<Sway>,
    /// At most so many vertices and triangles will be made.
    pub(super) vertices: usize,
    pub(super) triangles: usize,
}

impl Plan {
    pub(super) fn new(
        mut axes: Axes,
        sway: Option<Sway>,
        options: &Tubes,
        watch: &Watch<'_>,
    ) -> Result<Self, Cancelled> {
        axes.attach(options, watch)?;
        let (mut vertices, mut triangles) = (0, 0);
        for axis in &axes.all {
            let sides = axis.sides as usize;
            let blended = if axis.has_collar { blends(axis.sides) as usize + 1 } else { 0 };
            let rings = blended + axis.stations.len() + usize::from(axis.sides >= DOME_SIDES);
            vertices += rings * (sides + 1) + 1;
            triangles += (rings - 1) * 2 * sides + sides;
            if options.even_texels {
                vertices += axis.stations.len().min(MOST_SECTIONS) * (sides + 1);
            }
            if options.closed_base {
                vertices += sides + 2;
                triangles += sides;
            }
        }
        Ok(Self { axes, sway, vertices, triangles })
    }
}

/// Rings of a collar between its foot and its end.
pub(super) fn blends(sides: u32) -> u32 {
    (sides / 3).clamp(1, 4)
}
