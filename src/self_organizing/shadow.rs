//! Shadow propagation: each node casts a pyramid of shadow onto the cells below it.

use super::environment::{Bud, Environment};
use super::grid::{Caster, Grid};
use super::habit::within;
use crate::math::UP;
use crate::shape::Bounds;
use crate::{ParameterError, parallel};
use glam::{IVec3, Vec3};

/// So many nodes are given their cells at once.
const PART: usize = 1024;
/// The most cells of a grid.
const MOST_CELLS: u64 = 1 << 29;

/// Light from above that fades below every node: step 1 of the text, first method.
///
/// Space is a grid of cubic cells. A node in a cell shades the cells of a pyramid below: q cells down, in a square of
/// 2q + 1 cells, by `a · b^-q`, for q from 0 to a greatest height. Shadows add up to s, and a bud gets
/// `max(C - s + a, 0)`, where C is the full exposure and a its own shadow. The optimal direction is against the
/// gradient of s, by central differences; up where that is zero.
///
/// The powers are rounded to whole parts of a, so that sums are exact whatever their order: the grid after any
/// growth, shedding and cutting is to the bit the one of the nodes that stand. The parts are 512 to 729, so that the
/// faintest power has 64 if possible; those of b = 1.5 down to q = 6 are whole. Sums are exact below five million
/// full shadows on one cell.
///
/// Time: one pyramid, 455 cells by default, for every node that appears or falls; a cell for each node with buds; six
/// for a bud that grows. Memory: 2 bytes a cell of each row of x that was ever in the shade, 4 at heights where a
/// cell had about 100 full shadows.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::self_organizing::{Environment, ShadowPropagation};
///
/// let mut light = ShadowPropagation::default();
/// light.update(&[Vec3::new(0.01, 1.01, 0.01)], &[]);
/// // Two cells straight below: a / b².
/// assert!((light.shadow(Vec3::new(0.01, 0.97, 0.01)) - 0.8 / 2.25).abs() < 1e-4);
/// // Two cells down, three to the side: outside of the pyramid.
/// assert_eq!(light.shadow(Vec3::new(0.07, 0.97, 0.01)), 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Options", into = "Options")
)]
pub struct ShadowPropagation {
    options: Options,
    grid: Grid,
}

/// What the user sets.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
struct Options {
    min: Vec3,
    max: Vec3,
    cell: f32,
    full_exposure: f32,
    height: u32,
    strength: f32,
    falloff: f32,
    darkest: Option<f32>,
}

impl Default for ShadowPropagation {
    /// The original's: a box 4 m wide and high on the ground, cells of 0.02 m, full exposure 2.5, height 6, a = 0.8,
    /// b = 1.5.
    fn default() -> Self {
        Self::new(Bounds::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 4.0, 2.0)))
    }
}

impl ShadowPropagation {
    /// Light in `bounds`, metres, in which all nodes must lie; at most 65,000 cells on an axis and 2²⁹ in all.
    pub fn new(bounds: Bounds) -> Self {
        let options = Options {
            min: bounds.min,
            max: bounds.max,
            cell: 0.02,
            full_exposure: 2.5,
            height: 6,
            strength: 0.8,
            falloff: 1.5,
            darkest: None,
        };
        Self { options, grid: Grid::default() }
    }

    /// Sets the size of a cell, metres, in [1e-6, 1e6]; 0.02 by default, the length of a metamer.
    pub fn with_cell(mut self, metres: f32) -> Self {
        self.options.cell = metres;
        self.reset()
    }

    /// Sets C, the light without shadow, in [0, 1e6]; 2.5 by default.
    pub fn with_full_exposure(mut self, exposure: f32) -> Self {
        self.options.full_exposure = exposure;
        self
    }

    /// Sets the greatest q, the height of a shadow in cells, at most 32; 6 by default.
    pub fn with_height(mut self, cells: u32) -> Self {
        self.options.height = cells;
        self.reset()
    }

    /// Sets a, the shadow in a node's own cell, in [0, 1e3]; 0.8 by default.
    pub fn with_strength(mut self, strength: f32) -> Self {
        self.options.strength = strength;
        self
    }

    /// Sets b, by which the shadow is divided at each cell down, in [1, 1e3]; 1.5 by default.
    pub fn with_falloff(mut self, falloff: f32) -> Self {
        self.options.falloff = falloff;
        self.reset()
    }

    /// Caps the sum of shadows on a cell, in [0, 1e6]; none by default. The text speaks of "up to max 1.0", but the
    /// program behind it, and the paper before it, have no cap.
    pub fn with_darkest(mut self, shadow: impl Into<Option<f32>>) -> Self {
        self.options.darkest = shadow.into();
        self
    }

    /// The shadow s at `point`; 0 outside of the bounds.
    pub fn shadow(&self, point: Vec3) -> f32 {
        self.cell(point).map_or(0.0, |cell| self.value(cell))
    }

    fn reset(mut self) -> Self {
        self.grid = Grid::default();
        self
    }

    fn value(&self, cell: IVec3) -> f32 {
        let shadow = self.grid.at(cell) as f32 * (self.options.strength / self.grid.full());
        self.options.darkest.map_or(shadow, |darkest| shadow.min(darkest))
    }

    /// The cell of `point`, if it is in the box.
    fn cell(&self, point: Vec3) -> Option<IVec3> {
        let Options { min, max, cell, .. } = self.options;
        let inside = point.cmpge(min).all() && point.cmplt(max).all();
        inside.then(|| ((point - min) / cell).as_ivec3())
    }
}

impl Environment for ShadowPropagation {
    fn light(&self, bud: &Bud<'_>) -> f32 {
        let own = self.options.strength;
        (self.options.full_exposure - self.shadow(bud.position()) + own).max(0.0)
    }

    fn direction(&self, bud: &Bud<'_>) -> Vec3 {
        let Some(cell) = self.cell(bud.position()) else { return UP };
        let falls = |axis: IVec3| self.value(cell - axis) - self.value(cell + axis);
        // There is nothing below the ground to compare with.
        let up =
            if cell.y > 0 { falls(IVec3::Y) } else { 2.0 * (self.value(cell) - self.value(cell + IVec3::Y)) };
        Vec3::new(falls(IVec3::X), up, falls(IVec3::Z)).normalize_or(UP)
    }

    fn update(&mut self, appeared: &[Vec3], fallen: &[Vec3]) {
        if self.grid.is_empty() {
            let Options { min, max, cell, height, falloff, .. } = self.options;
            let size = ((max - min) / cell).ceil().as_ivec3().max(IVec3::ONE);
            self.grid = Grid::new(size, height, falloff);
        }
        let casters = |points: &[Vec3], falls: bool| {
            let of = |part: &[Vec3]| -> Vec<Caster> {
                part.iter().filter_map(|&point| Some(Caster::new(self.cell(point)?, falls))).collect()
            };
            let parts: Vec<&[Vec3]> = points.chunks(PART).collect();
            parallel::map(parts.len(), |part| of(parts[part])).concat()
        };
        let casters = [casters(appeared, false), casters(fallen, true)].concat();
        self.grid.cast(&casters);
    }

    fn is_positional(&self) -> bool {
        true
    }

    fn contains(&self, point: Vec3) -> bool {
        self.cell(point).is_some()
    }

    fn check(&self) -> Result<(), ParameterError> {
        let Options { min, max, cell, full_exposure, height, strength, falloff, darkest } = self.options;
        within("ShadowPropagation.cell", cell, 1e-6, 1e6)?;
        let bounds = Bounds::new(min, max);
        let cells = bounds.size() / cell;
        let holds = !bounds.is_empty()
            && min.abs().max(max.abs()).max_element() <= 1e6
            && cells.min_element() >= 1.0
            && cells.max_element() <= 65_000.0
            && cells.as_dvec3().element_product() <= MOST_CELLS as f64;
        ParameterError::unless(
            holds,
            "ShadowPropagation.bounds",
            bounds,
            "within a million metres, 1 to 65000 cells on each axis, at most 2^29 cells",
        )?;
        within("ShadowPropagation.full_exposure", full_exposure, 0.0, 1e6)?;
        ParameterError::unless(height <= 32, "ShadowPropagation.height", height, "at most 32 cells")?;
        within("ShadowPropagation.strength", strength, 0.0, 1e3)?;
        within("ShadowPropagation.falloff", falloff, 1.0, 1e3)?;
        darkest.map_or(Ok(()), |darkest| within("ShadowPropagation.darkest", darkest, 0.0, 1e6))
    }
}

#[cfg(feature = "serde")]
impl From<ShadowPropagation> for Options {
    fn from(shadows: ShadowPropagation) -> Self {
        shadows.options
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Options> for ShadowPropagation {
    type Error = ParameterError;

    fn try_from(options: Options) -> Result<Self, ParameterError> {
        let shadows = Self { options, grid: Grid::default() };
        shadows.check().map(|()| shadows)
    }
}
