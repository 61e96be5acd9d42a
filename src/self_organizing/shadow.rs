//! Shadow propagation: each node casts a pyramid of shadow onto the cells below it.

use super::daylight::Daylight;
use super::environment::{Bud, Environment};
use super::grid::{Caster, Grid, MOST_CELLS, MOST_ON_AXIS};
use super::habit::{Habit, within};
use super::sky::Sky;
use super::terrain::{Below, Terrain};
use crate::math::UP;
use crate::shape::{Bounds, Shape};
use crate::{ParameterError, parallel};
use glam::{IVec3, Vec3};
use std::sync::Arc;

/// Factor on the weight of the optimal direction where nothing is seen of the sky.
const URGE: f32 = 4.0;
/// Cells farther away than so many are all as far.
const FARTHEST: f32 = 1e9;
/// Number of nodes that are given their cells at once.
const PART: usize = 1024;

/// Light from above that fades below every node: step 1 of the text, first method.
///
/// Space is a grid of cubic cells. A node in a cell shades the cells of a pyramid below: q cells down, in a square of
/// 2q + 1 cells, by `a · b^-q`, for q from 0 to a greatest height. Shadows add up to s, and a bud gets
/// `max(C - s + a, 0)`, where C is the full exposure and a its own shadow. The optimal direction is against the
/// gradient of s, by central differences; up where that is zero.
///
/// The grid begins as a box and grows with the trees, to all sides and upwards; the bottom of the box is the ground,
/// unless the forest has a terrain. Once trees stand where no grid can reach, growth ends with an error.
///
/// A species of short metamers casts less shade with each of them ([`Habit::with_shade`]), and shadows count less for
/// one of more shade tolerance.
///
/// Obstacles and terrain hide parts of the sky. Under them C is multiplied by the [openness](Self::openness): the root of
/// the part of the sky's light that still comes, added up over 17 directions, for leaves make the most of little light;
/// and at least by what is scattered ([`with_scattered`](Self::with_scattered)). The less there is, the more the
/// optimal direction turns to where it comes from, and the more it weighs, up to four times. That field covers the box and the obstacles around it, in about 2¹⁸
/// cells at most, and is worked out once when obstacles are added.
///
/// All of the sky is equally bright by default; [`Daylight`] adds the sun.
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
/// Two are equal if their options, their shadows and what they see of the sky are.
#[derive(Debug, Clone)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Options", into = "Options")
)]
#[must_use]
pub struct ShadowPropagation {
    options: Options,
    grid: Grid,
    /// Sky that obstacles leave visible, if there are any.
    sky: Option<Sky>,
    /// Obstacles that hide the sky from now on, until the field is worked out.
    pending: Option<Hiding>,
    /// `true` if a terrain is the ground instead of the bottom of the box.
    has_terrain: bool,
    /// Number of nodes that stand where no grid can reach.
    lost: u64,
}

crate::recipe::readable!(in options: ShadowPropagation {
    cell: f32, full_exposure: f32, height: u32, strength: f32, falloff: f32, darkest: Option<f32>,
    scattered: f32, daylight: Option<Daylight>,
});

/// Obstacles that hide the sky.
#[derive(Clone)]
struct Hiding {
    obstacles: Vec<Arc<dyn Shape>>,
    terrain: Option<Arc<dyn Terrain>>,
}

impl std::fmt::Debug for Hiding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Hiding").field("obstacles", &self.obstacles.len()).finish_non_exhaustive()
    }
}

/// Options as the user sets them.
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
    /// Files from before obstacles cast shade do not have it.
    #[cfg_attr(feature = "serde", serde(default = "scattered"))]
    scattered: f32,
    /// Files from before there was a sun do not have it.
    #[cfg_attr(feature = "serde", serde(default))]
    daylight: Option<Daylight>,
}

/// The default of [`ShadowPropagation::with_scattered`].
fn scattered() -> f32 {
    0.25
}

impl Default for ShadowPropagation {
    /// The original's: a box 4 m wide and high on the ground, cells of 0.02 m, full exposure 2.5, height 6, a = 0.8,
    /// b = 1.5.
    fn default() -> Self {
        Self::new(Bounds::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 4.0, 2.0)))
    }
}

impl ShadowPropagation {
    /// Light in and around `bounds`, metres: the box in which the grid begins, its bottom the ground. At most 65,000
    /// cells on an axis and 2²⁹ in all, with what it grows by.
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
            scattered: scattered(),
            daylight: None,
        };
        Self::of(options)
    }

    fn of(options: Options) -> Self {
        Self { options, grid: Grid::default(), sky: None, pending: None, has_terrain: false, lost: 0 }
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

    /// Sets the least part of C that comes to any place, however hidden by obstacles, in [0, 1]; 0.25 by default.
    pub fn with_scattered(mut self, part: f32) -> Self {
        self.options.scattered = part;
        self
    }

    /// Sets where light comes from; `None`, the default, for a sky that is equally bright everywhere, and shadows
    /// straight below. Otherwise shadows fall away from the light, and obstacles hide what lies in its directions. A
    /// shadow is about as dark as the pyramid at each depth, however it is spread.
    pub fn with_daylight(mut self, daylight: impl Into<Option<Daylight>>) -> Self {
        self.options.daylight = daylight.into();
        self.reset()
    }

    /// The shadow s at `point`; 0 where there is none.
    pub fn shadow(&self, point: Vec3) -> f32 {
        self.value(self.cell_of(point))
    }

    /// The part of C that obstacles and terrain leave at `point`, in [0, 1]; 1 where nothing stands in the way.
    pub fn openness(&self, point: Vec3) -> f32 {
        let scattered = self.options.scattered;
        self.sky.as_ref().map_or(1.0, |sky| scattered + (1.0 - scattered) * sky.at(point).0.sqrt())
    }

    fn reset(mut self) -> Self {
        self.grid = Grid::default();
        self
    }

    fn value(&self, cell: IVec3) -> f32 {
        let shadow = self.grid.at(cell) as f32 * (self.options.strength / self.grid.full());
        self.options.darkest.map_or(shadow, |darkest| shadow.min(darkest))
    }

    /// The cell of `point`, from the lowest corner of the box.
    #[inline]
    fn cell_of(&self, point: Vec3) -> IVec3 {
        let Options { min, cell, .. } = self.options;
        let place = ((point - min) / cell).clamp(Vec3::splat(-FARTHEST), Vec3::splat(FARTHEST));
        let cut = place.as_ivec3();
        // As `floor`, which is a call on processors without SSE 4.1.
        cut - IVec3::select(place.cmplt(cut.as_vec3()), IVec3::ONE, IVec3::ZERO)
    }

    fn build(&mut self) {
        if self.grid.is_empty() {
            let Options { min, max, cell, height, falloff, daylight, .. } = self.options;
            let size = ((max - min) / cell).ceil().as_ivec3().max(IVec3::ONE);
            let light = daylight.map_or_else(Vec::new, Daylight::directions);
            self.grid = Grid::new(size, height, falloff, light);
        }
    }

    /// Visible part of the sky; `None` if nothing hides it, or if the obstacles are impossible, which is refused elsewhere.
    fn sky_behind(&self, hiding: &Hiding) -> Option<Sky> {
        let Hiding { obstacles, terrain } = hiding;
        let Options { min, max, cell, .. } = self.options;
        let mut all = obstacles.clone();
        all.extend(terrain.iter().map(|terrain| Arc::new(Below(terrain.clone())) as Arc<dyn Shape>));
        if all.is_empty() || self.check().is_err() || all.iter().any(|shape| shape.check().is_err()) {
            return None;
        }
        let width = (max - min).max_element();
        // Roofs above the box hide the sky too.
        let top = obstacles.iter().map(|shape| shape.bounds().max.y).fold(max.y, f32::max);
        let mut bounds = Bounds::new(min, max.with_y(top.min(max.y + width) + cell));
        // And so do those beside it.
        for shape in obstacles.iter().map(Shape::bounds).filter(|shape| !shape.is_empty()) {
            let (low, high) = (shape.min.max(min - width), shape.max.min(max + width));
            bounds.min = bounds.min.min(low.with_y(min.y));
            bounds.max = bounds.max.max(high.with_y(max.y));
        }
        if let Some(terrain) = terrain {
            // Hills rise around what grows on them, and valleys lie below.
            let ends = [min.x, max.x].into_iter().flat_map(|x| [(x, min.z), (x, max.z)]);
            for height in ends.map(|(x, z)| terrain.height(x, z)).filter(|height| height.abs() < width) {
                bounds.min.y = bounds.min.y.min(min.y + height);
                bounds.max.y = bounds.max.y.max(max.y + height);
            }
        }
        let light = self.options.daylight.map_or_else(Daylight::overcast, Daylight::directions);
        Some(Sky::new(bounds, cell, &all, &light))
    }

    /// Makes room for nodes in all these places, if there can be.
    fn fit(&mut self, points: &[Vec3]) {
        let bounds = Bounds::of(points.iter().copied());
        if bounds.is_empty() {
            return;
        }
        let (mut low, high) = (self.cell_of(bounds.min), self.cell_of(bounds.max));
        // Whole pyramids, lest layers that come later lack what has fallen there; nothing is below the ground.
        if self.has_terrain {
            low.y -= self.options.height as i32 + 1;
        } else {
            low.y = low.y.max(0);
        }
        if !self.grid.fit(low, high) {
            // Not all: those that fit.
            for &point in points {
                let mut low = self.cell_of(point);
                let high = low;
                low.y -= if self.has_terrain { self.options.height as i32 + 1 } else { 0 };
                self.grid.fit(low, high);
            }
        }
    }

    /// The casters at points, without those where no grid can reach, and how many those are.
    fn casters(&self, points: &[Vec3], falls: bool) -> (Vec<Caster>, u64) {
        let (low, end) = self.grid.range();
        let of = |part: &[Vec3]| -> Vec<Caster> {
            let cells = part.iter().map(|&point| self.cell_of(point));
            let inside = cells.filter(|cell| cell.cmpge(low).all() && cell.cmplt(end).all());
            inside.map(|cell| self.grid.caster(cell, falls)).collect()
        };
        let parts: Vec<&[Vec3]> = points.chunks(PART).collect();
        let casters = parallel::map(parts.len(), |part| of(parts[part])).concat();
        let lost = (points.len() - casters.len()) as u64;
        (casters, lost)
    }
}

impl Environment for ShadowPropagation {
    fn light(&self, bud: &Bud<'_>) -> f32 {
        let point = bud.position();
        let own = self.options.strength * self.shade_of(bud.habit);
        let full = self.options.full_exposure;
        let full = if self.sky.is_none() { full } else { full * self.openness(point) };
        let tolerance = bud.habit.shade_tolerance;
        (full - self.shadow(point) / tolerance + own / tolerance).max(0.0)
    }

    fn direction(&self, bud: &Bud<'_>) -> Vec3 {
        let cell = self.cell_of(bud.position());
        let falls = |axis: IVec3| self.value(cell - axis) - self.value(cell + axis);
        // There is nothing below the ground to compare with.
        let up = if cell.y > 0 || self.has_terrain {
            falls(IVec3::Y)
        } else {
            2.0 * (self.value(cell) - self.value(cell + IVec3::Y))
        };
        let from_shadows = Vec3::new(falls(IVec3::X), up, falls(IVec3::Z)).normalize_or(UP);
        let Some(sky) = &self.sky else { return from_shadows };
        let (open, toward) = sky.at(bud.position());
        let optimal = from_shadows * open + toward.normalize_or(UP) * (1.0 - open);
        optimal.normalize_or(UP) * (1.0 + (URGE - 1.0) * (1.0 - open))
    }

    fn shade_of(&self, habit: &Habit) -> f32 {
        // The nodes of a whorl share the shade of their metamer.
        let own =
            |habit: &Habit| (habit.length / self.options.cell).min(1.0) / habit.phyllotaxis.nodes() as f32;
        habit.shade.unwrap_or_else(|| own(habit))
    }

    fn update(&mut self, appeared: &[Vec3], fallen: &[Vec3]) {
        self.update_shaded(1.0, appeared, fallen);
    }

    fn update_shaded(&mut self, shade: f32, appeared: &[Vec3], fallen: &[Vec3]) {
        self.build();
        if let Some(hiding) = self.pending.take() {
            self.sky = self.sky_behind(&hiding);
        }
        self.fit(appeared);
        let ((casters, lost), (falling, found)) = (self.casters(appeared, false), self.casters(fallen, true));
        self.lost = (self.lost + lost).saturating_sub(found);
        self.grid.cast(&[casters, falling].concat(), shade);
    }

    fn update_moved(&mut self, shade: f32, from: &[Vec3], to: &[Vec3]) {
        // Most stay in their cell.
        let leave = |&(from, to): &(Vec3, Vec3)| self.cell_of(from) != self.cell_of(to);
        let pairs = from.iter().copied().zip(to.iter().copied());
        let (from, to): (Vec<Vec3>, Vec<Vec3>) = pairs.filter(leave).unzip();
        self.update_shaded(shade, &to, &from);
    }

    fn obstruct(&mut self, obstacles: &[Arc<dyn Shape>], terrain: Option<&Arc<dyn Terrain>>) {
        self.has_terrain = terrain.is_some();
        self.pending = Some(Hiding { obstacles: obstacles.to_vec(), terrain: terrain.cloned() });
    }

    fn is_positional(&self) -> bool {
        true
    }

    fn contains(&self, point: Vec3) -> bool {
        point.is_finite() && (self.has_terrain || point.y >= self.options.min.y)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let Options {
            min,
            max,
            cell,
            full_exposure,
            height,
            strength,
            falloff,
            darkest,
            scattered,
            daylight,
        } = self.options;
        daylight.map_or(Ok(()), Daylight::check)?;
        within("ShadowPropagation.cell", cell, 1e-6, 1e6)?;
        let bounds = Bounds::new(min, max);
        let cells = bounds.size() / cell;
        let holds = !bounds.is_empty()
            && min.abs().max(max.abs()).max_element() <= 1e6
            && cells.min_element() >= 1.0
            && cells.max_element() <= MOST_ON_AXIS as f32
            && cells.as_dvec3().element_product() <= MOST_CELLS as f64;
        let refused = |range: &str| {
            let range = format!("{range}; ShadowPropagation.cell is {cell} m");
            Err(ParameterError::new("ShadowPropagation.bounds", format_args!("{bounds:?}"), range))
        };
        if !holds {
            return refused("within a million metres, 1 to 65000 cells on each axis, at most 2^29 cells");
        }
        if self.lost > 0 {
            return refused("such that all trees stand within 65000 cells on each axis and 2^29 in all");
        }
        within("ShadowPropagation.scattered", scattered, 0.0, 1.0)?;
        within("ShadowPropagation.full_exposure", full_exposure, 0.0, 1e6)?;
        ParameterError::unless(height <= 32, "ShadowPropagation.height", height, "at most 32 cells")?;
        within("ShadowPropagation.strength", strength, 0.0, 1e3)?;
        within("ShadowPropagation.falloff", falloff, 1.0, 1e3)?;
        darkest.map_or(Ok(()), |darkest| within("ShadowPropagation.darkest", darkest, 0.0, 1e6))
    }
}

impl PartialEq for ShadowPropagation {
    fn eq(&self, other: &Self) -> bool {
        self.options == other.options && self.sky == other.sky && self.grid == other.grid
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
        let shadows = Self::of(options);
        shadows.check().map(|()| shadows)
    }
}
