//! The axes of all tubes, and the size of their mesh.

use super::attach::DOME_SIDES;
use super::axis::Axes;
use super::{Sway, Tubes};
use crate::observer::{Cancelled, Watch};

/// Greatest number of sections of a branch: more would have radii that floats cannot tell apart.
pub(super) const MOST_SECTIONS: usize = 200;

/// All that is known before the first vertex.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) axes: Axes,
    /// Bend in the wind, if it is asked for.
    pub(super) sway: Option<Sway>,
    /// Upper bound of the number of vertices.
    pub(super) vertices: usize,
    /// Upper bound of the number of triangles.
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

/// Number of rings of a collar between its base and its end.
pub(super) fn blends(sides: u32) -> u32 {
    (sides / 3).clamp(1, 4)
}
