//! Space colonization: buds compete for marker points.

use super::environment::{Bud, Environment};
use super::habit::within;
use super::region::Region;
use super::tree::Site;
use crate::random::{Purpose, stream};
use crate::shape::{Bounds, LARGEST, Shape};
use crate::{ParameterError, math, parallel};
use glam::{IVec3, Vec3};

/// The most markers.
const MOST_MARKERS: usize = 1 << 26;
/// The most cells along an axis of the grid over the markers.
const MOST_CELLS: f32 = 128.0;

/// Marker points that buds perceive and nodes occupy: step 1 of the text, second method.
///
/// A marker within the occupancy radius of a node is taken. Each free one goes to the nearest bud that perceives
/// it, in a cone around the bud's direction up to the perception distance; among equally near buds to the first.
/// A bud that has a marker gets light 1, whatever their number, and one that has none gets none, as in Pałubicki et al.
/// 2009; so the vigor of a tree does not depend on how densely space is sown. Its optimal direction is the mean of
/// the unit vectors towards its markers.
///
/// A metamer grows only where space is free: where it begins, a marker that no node had taken at the start of the
/// season must lie within the perception distance and not behind it. Markers [in a shape](Self::in_shape) confine
/// growth to that shape, but for what comes in from outside.
///
/// A marker is free again once the nodes that took it have fallen, so that a cut branch can grow again. When branches
/// are shed, every living bud counts as if it had light: what has taken its space keeps it, and a crown that is
/// full stays as it is.
///
/// Time: O(free markers near a bud) for each bud and season, on all threads. Memory: 24 bytes a marker. Markers are
/// found through a grid of cells as wide as the larger radius.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::self_organizing::{Habit, SelfOrganizing, SpaceColonization};
/// use treesynth::shape::Ellipsoid;
///
/// let crown = Ellipsoid::new(Vec3::Y * 0.6, Vec3::new(0.3, 0.6, 0.3));
/// let space = SpaceColonization::in_shape(&crown, 5000, 1)?;
/// let mut tree = SelfOrganizing::new(space, Habit::default().with_optimal_weight(0.5), 1);
/// tree.grow(15)?;
/// assert!(tree.metamers() > 100);
/// assert!(tree.environment().free() < 5000);
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Options", into = "Options"))]
pub struct SpaceColonization {
    options: Options,
    grid: Grid,
    /// Number of nodes that take each marker.
    takers: Vec<u32>,
    /// Free markers by cell as of this season, where each cell's begin, and whether there are any in it or beside it.
    free: Vec<Vec3>,
    free_numbers: Vec<u32>,
    free_starts: Vec<u32>,
    near_free: Vec<bool>,
    /// Share of each surveyed bud: markers, and the sum of the directions towards them.
    gains: Vec<(u32, Vec3)>,
}

crate::recipe::readable!(in options: SpaceColonization { occupancy: f32, light: f32 });

impl SpaceColonization {
    /// Distance in metres and angle in radians; set by [`with_perception`](Self::with_perception).
    pub fn perception(&self) -> (f32, f32) {
        (self.options.distance, self.options.angle)
    }
}

/// Options as the user sets them.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
struct Options {
    markers: Vec<Vec3>,
    occupancy: f32,
    distance: f32,
    angle: f32,
    light: f32,
    /// Region to which growth is confined; none if the user has brought the markers.
    #[cfg_attr(feature = "serde", serde(default))]
    region: Option<Region>,
    /// Regions that were added later.
    #[cfg_attr(feature = "serde", serde(default))]
    more: Vec<Region>,
}

impl Options {
    fn regions(&self) -> impl Iterator<Item = &Region> {
        self.region.iter().chain(&self.more)
    }
}

/// Markers by cell.
#[derive(Debug, Clone, PartialEq, Default)]
struct Grid {
    min: Vec3,
    cell: f32,
    size: IVec3,
    /// Index of each cell's first marker among `members`, and the end.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl SpaceColonization {
    /// Markers that the user brings, metres: at most 2²⁶, finite. Occupancy radius 0.04 m, perception up to 0.12
    /// m within 45° of the bud's direction, light 1: two and six metamers of the default habit, in the ranges of
    /// Pałubicki et al. 2009.
    pub fn new(markers: Vec<Vec3>) -> Self {
        let angle = std::f32::consts::FRAC_PI_4;
        Self::of(Options {
            markers,
            occupancy: 0.04,
            distance: 0.12,
            angle,
            light: 1.0,
            region: None,
            more: Vec::new(),
        })
    }

    /// This number of markers, drawn in `shape` where all parts are equally likely. Nodes stay in the shape, to a 64th of its
    /// size; a tree that stands outside may grow into it.
    ///
    /// # Errors
    /// Options of the shape out of range; too many markers; a shape that is empty or so thin that no point is found.
    pub fn in_shape(shape: &dyn Shape, markers: usize, seed: u64) -> Result<Self, ParameterError> {
        let mut space = Self::new(drawn(shape, markers, seed)?);
        space.options.region = Some(Region::new(shape));
        Ok(space)
    }

    /// More markers, metres, in free space; a stroke of a brush, say. In a forest this belongs into
    /// [`Forest::environment_mut`](super::Forest::environment_mut): alone, it takes no node to stand.
    pub fn add_markers(&mut self, markers: impl IntoIterator<Item = Vec3>) {
        self.options.markers.extend(markers);
        self.takers = vec![0; self.options.markers.len()];
        self.grid = Grid::default();
    }

    /// As [`add_markers`](Self::add_markers), so many as [`in_shape`](Self::in_shape) draws. Nodes of the other shapes may
    /// grow into this one and back.
    ///
    /// # Errors
    /// As `in_shape`; the environment is then as it was.
    pub fn add_shape(&mut self, shape: &dyn Shape, markers: usize, seed: u64) -> Result<(), ParameterError> {
        check_count(self.options.markers.len().saturating_add(markers))?;
        let points = drawn(shape, markers, seed)?;
        self.options.more.push(Region::new(shape));
        self.add_markers(points);
        Ok(())
    }

    fn of(options: Options) -> Self {
        let takers = vec![0; options.markers.len()];
        Self {
            options,
            grid: Grid::default(),
            takers,
            free: Vec::new(),
            free_numbers: Vec::new(),
            free_starts: Vec::new(),
            near_free: Vec::new(),
            gains: Vec::new(),
        }
    }

    /// Sets the radius around each node in which markers are taken, metres, in [0, 1e3]; 0.04 by default.
    pub fn with_occupancy(mut self, metres: f32) -> Self {
        self.options.occupancy = metres;
        Self::of(self.options)
    }

    /// Sets how far a bud perceives markers, metres, in [0, 1e3], and how far from its direction, radians, in [0, π];
    /// 0.12 m and 45° by default.
    pub fn with_perception(mut self, metres: f32, radians: f32) -> Self {
        (self.options.distance, self.options.angle) = (metres, radians);
        Self::of(self.options)
    }

    /// Sets the light of a bud that has a marker, in [0, 1e3]; 1 by default.
    pub fn with_light(mut self, light: f32) -> Self {
        self.options.light = light;
        self
    }

    /// The markers, metres.
    pub fn markers(&self) -> &[Vec3] {
        &self.options.markers
    }

    /// Number of free markers.
    pub fn free(&self) -> usize {
        self.takers.iter().filter(|&&takers| takers == 0).count()
    }

    fn gain(&self, bud: &Bud<'_>) -> (u32, Vec3) {
        self.gains.get(bud.index()).copied().unwrap_or_default()
    }

    fn build_grid(&mut self) {
        if self.grid.starts.is_empty() {
            self.grid = Grid::new(&self.options.markers, self.options.occupancy.max(self.options.distance));
        }
    }

    /// Lists the free markers of each cell.
    fn list_free(&mut self) {
        let Self { grid, takers, options, .. } = self;
        let cells = grid.starts.len() - 1;
        (self.free, self.free_numbers) = (Vec::new(), Vec::new());
        self.free_starts = vec![0];
        for cell in 0..cells {
            for &marker in &grid.members[grid.starts[cell] as usize..grid.starts[cell + 1] as usize] {
                if takers[marker as usize] == 0 {
                    self.free.push(options.markers[marker as usize]);
                    self.free_numbers.push(marker);
                }
            }
            self.free_starts.push(self.free.len() as u32);
        }
        self.near_free = vec![false; cells];
        for cell in (0..cells).filter(|&cell| self.free_starts[cell + 1] > self.free_starts[cell]) {
            let place = self.grid.place_of(cell as u32);
            let (low, high) = ((place - 1).max(IVec3::ZERO), (place + 1).min(self.grid.size - 1));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    for x in low.x..=high.x {
                        self.near_free[self.grid.number(IVec3::new(x, y, z)) as usize] = true;
                    }
                }
            }
        }
    }

    /// Calls `found` with each free marker at most `radius` from `point`: its place in the list and the way to it. Stops
    /// when told to.
    fn near_free(&self, point: Vec3, radius: f32, mut found: impl FnMut(usize, Vec3) -> bool) {
        if self.free.is_empty() {
            return;
        }
        let place = self.grid.place(point);
        let inside = place.cmpge(IVec3::ZERO).all() && place.cmplt(self.grid.size).all();
        if inside && !self.near_free[self.grid.number(place) as usize] {
            return;
        }
        let low = self.grid.place(point - radius).max(IVec3::ZERO);
        let high = self.grid.place(point + radius).min(self.grid.size - 1);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                if low.x > high.x {
                    return;
                }
                let first = self.grid.number(IVec3::new(low.x, y, z)) as usize;
                let last = self.grid.number(IVec3::new(high.x, y, z)) as usize;
                for marker in self.free_starts[first] as usize..self.free_starts[last + 1] as usize {
                    let away = self.free[marker] - point;
                    if away.length_squared() <= radius * radius && !found(marker, away) {
                        return;
                    }
                }
            }
        }
    }
}

/// Buds that are looked at in one go.
const PART: usize = 4096;

impl Environment for SpaceColonization {
    fn light(&self, bud: &Bud<'_>) -> f32 {
        if self.gain(bud).0 > 0 { self.options.light } else { 0.0 }
    }

    fn direction(&self, bud: &Bud<'_>) -> Vec3 {
        self.gain(bud).1.normalize_or_zero()
    }

    fn upkeep(&self) -> Option<f32> {
        Some(self.options.light)
    }

    fn admits(&self, start: Vec3, end: Vec3) -> bool {
        let inside = |point: Vec3| self.options.regions().any(|region| region.contains(point));
        if inside(start) && !inside(end) {
            return false;
        }
        let mut free = false;
        self.near_free(start, self.options.distance, |_, away| {
            free = away.dot(end - start) >= 0.0;
            !free
        });
        free
    }

    fn surveys(&self) -> bool {
        true
    }

    fn prepare(&mut self, buds: &[Site]) {
        self.build_grid();
        self.list_free();
        let Options { distance, angle, .. } = self.options;
        let cos = math::cos(angle);
        // Each bud that perceives a free marker, the marker, and the square of the distance.
        let parts: Vec<&[Site]> = buds.chunks(PART).collect();
        let seen = parallel::map(parts.len(), |part| {
            let mut seen: Vec<(u32, u32, f32)> = Vec::new();
            for (index, bud) in parts[part].iter().enumerate() {
                self.near_free(bud.position, distance, |marker, away| {
                    let squared = away.length_squared();
                    if away.dot(bud.direction) >= cos * squared.sqrt() {
                        seen.push(((part * PART + index) as u32, marker as u32, squared));
                    }
                    true
                });
            }
            seen
        });
        let mut nearest = vec![(f32::INFINITY, 0u32); self.free.len()];
        for (bud, marker, squared) in seen.into_iter().flatten() {
            let nearest = &mut nearest[marker as usize];
            if squared < nearest.0 {
                *nearest = (squared, bud);
            }
        }
        self.gains.clear();
        self.gains.resize(buds.len(), (0, Vec3::ZERO));
        // In the order of the markers' numbers, so that sums of directions do not depend on the grid.
        let mut order: Vec<u32> = (0..self.free.len() as u32).collect();
        order.sort_unstable_by_key(|&marker| self.free_numbers[marker as usize]);
        for marker in order {
            let (squared, bud) = nearest[marker as usize];
            if squared < f32::INFINITY {
                let gain = &mut self.gains[bud as usize];
                gain.0 += 1;
                gain.1 += (self.free[marker as usize] - buds[bud as usize].position).normalize_or_zero();
            }
        }
    }

    fn update(&mut self, appeared: &[Vec3], fallen: &[Vec3]) {
        self.build_grid();
        let Options { markers, occupancy, .. } = &self.options;
        for &node in appeared {
            self.grid.near(node, *occupancy, markers, |marker, _| self.takers[marker] += 1);
        }
        for &node in fallen {
            self.grid.near(node, *occupancy, markers, |marker, _| self.takers[marker] -= 1);
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        let Options { markers, occupancy, distance, angle, light, .. } = &self.options;
        check_count(markers.len())?;
        let far = |marker: &&Vec3| !marker.abs().cmple(Vec3::splat(LARGEST)).all();
        if let Some(marker) = markers.iter().find(far) {
            let range = "within a million metres";
            return Err(ParameterError::new("SpaceColonization.markers", format_args!("{marker:?}"), range));
        }
        let holds = self.options.regions().all(Region::is_sound);
        ParameterError::unless(holds, "SpaceColonization.region", "unsound", "cells of a box, all of them")?;
        within("SpaceColonization.occupancy", *occupancy, 0.0, 1e3)?;
        within("SpaceColonization.distance", *distance, 0.0, 1e3)?;
        within("SpaceColonization.angle", *angle, 0.0, std::f32::consts::PI)?;
        within("SpaceColonization.light", *light, 0.0, 1e3)
    }
}

/// Random points of a shape, `markers` of them.
fn drawn(shape: &dyn Shape, markers: usize, seed: u64) -> Result<Vec<Vec3>, ParameterError> {
    shape.check()?;
    check_count(markers)?;
    let mut random = stream(seed, 0, Purpose::MARKERS, 0);
    let points: Option<Vec<Vec3>> = (0..markers).map(|_| shape.sample(&mut random)).collect();
    let (bounds, range) = (shape.bounds(), "a shape in which points are found");
    points.ok_or_else(|| ParameterError::new("shape", format_args!("{bounds:?}"), range))
}

fn check_count(markers: usize) -> Result<(), ParameterError> {
    let range = "1 to 67108864 markers";
    ParameterError::unless((1..=MOST_MARKERS).contains(&markers), "SpaceColonization.markers", markers, range)
}

impl Grid {
    /// `radius` metres is the farthest that [`near`](Self::near) will look.
    fn new(markers: &[Vec3], radius: f32) -> Self {
        let bounds = Bounds::of(markers.iter().copied());
        let cell = radius.max(bounds.size().max_element() / MOST_CELLS).max(1e-6);
        let size = (bounds.size() / cell).as_ivec3() + 1;
        let mut grid = Self { min: bounds.min, cell, size, starts: Vec::new(), members: Vec::new() };
        let mut cells: Vec<(u32, u32)> = markers
            .iter()
            .enumerate()
            .map(|(i, &marker)| (grid.number(grid.place(marker)), i as u32))
            .collect();
        cells.sort_unstable();
        let count = grid.number(size - 1) + 1;
        grid.starts = (0..=count).map(|cell| cells.partition_point(|entry| entry.0 < cell) as u32).collect();
        grid.members = cells.into_iter().map(|entry| entry.1).collect();
        grid
    }

    fn place(&self, point: Vec3) -> IVec3 {
        ((point - self.min) / self.cell).floor().as_ivec3()
    }

    fn number(&self, place: IVec3) -> u32 {
        ((place.z * self.size.y + place.y) * self.size.x + place.x) as u32
    }

    /// The cell of this number.
    fn place_of(&self, number: u32) -> IVec3 {
        let (row, x) = (number as i32 / self.size.x, number as i32 % self.size.x);
        IVec3::new(x, row % self.size.y, row / self.size.y)
    }

    /// Calls `found` with each marker at most `radius` from `point`, and the way to it.
    fn near(&self, point: Vec3, radius: f32, markers: &[Vec3], mut found: impl FnMut(usize, Vec3)) {
        let low = self.place(point - radius).max(IVec3::ZERO);
        let high = self.place(point + radius).min(self.size - 1);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let cell = self.number(IVec3::new(x, y, z)) as usize;
                    for &marker in &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                        let away = markers[marker as usize] - point;
                        if away.length_squared() <= radius * radius {
                            found(marker as usize, away);
                        }
                    }
                }
            }
        }
    }
}

#[cfg(feature = "serde")]
impl From<SpaceColonization> for Options {
    fn from(space: SpaceColonization) -> Self {
        space.options
    }
}

#[cfg(feature = "serde")]
impl From<Options> for SpaceColonization {
    fn from(mut options: Options) -> Self {
        options.region.iter_mut().chain(&mut options.more).for_each(Region::unpack);
        Self::of(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0f32..1.0).prop_map(Vec3::from_array)
    }

    proptest! {
        #[test]
        fn the_grid_finds_what_a_search_through_all_finds(
            markers in prop::collection::vec(point(), 1..300), at in point(), scale in 0.0f32..3.0, radius in 0.0f32..1.0,
        ) {
            let markers: Vec<Vec3> = markers.into_iter().map(|marker| marker * scale).collect();
            let grid = Grid::new(&markers, radius);
            let mut found = Vec::new();
            grid.near(at * 4.0, radius, &markers, |marker, _| found.push(marker));
            found.sort_unstable();
            let near = |i: &usize| (markers[*i] - at * 4.0).length_squared() <= radius * radius;
            prop_assert_eq!(found, (0..markers.len()).filter(near).collect::<Vec<_>>());
        }

        #[test]
        fn each_free_marker_goes_to_the_nearest_bud_that_sees_it(
            markers in prop::collection::vec(point(), 1..100), nodes in prop::collection::vec(point(), 0..5),
            buds in prop::collection::vec((point(), point()), 1..20), angle in 0.2f32..3.0,
        ) {
            let mut space = SpaceColonization::new(markers.clone()).with_occupancy(0.3).with_perception(0.7, angle);
            space.update(&nodes, &[]);
            let buds: Vec<Site> = buds
                .into_iter()
                .map(|(position, direction)| Site { position, direction: direction.normalize_or(Vec3::X) })
                .collect();
            space.prepare(&buds);
            let mut counts = vec![0; buds.len()];
            for &marker in markers.iter().filter(|marker| nodes.iter().all(|node| node.distance(**marker) > 0.3)) {
                let sees = |bud: &&(usize, &Site)| {
                    let away = marker - bud.1.position;
                    away.length() <= 0.7 && math::angle_between(away, bud.1.direction) <= angle
                };
                let distance = |bud: &(usize, &Site)| bud.1.position.distance_squared(marker);
                let nearest = buds
                    .iter()
                    .enumerate()
                    .filter(|bud| sees(&bud))
                    .min_by(|a, b| distance(a).total_cmp(&distance(b)));
                if let Some((bud, _)) = nearest {
                    counts[bud] += 1;
                }
            }
            let gains: Vec<u32> = space.gains.iter().map(|gain| gain.0).collect();
            // A marker on the very edge of a cone may round to either side.
            let apart: u32 = gains.iter().zip(&counts).map(|(a, b)| a.abs_diff(*b)).sum();
            prop_assert!(apart <= 1, "{gains:?} {counts:?}");
        }

        #[test]
        fn markers_are_free_again_once_nodes_have_fallen(
            markers in prop::collection::vec(point(), 1..100), nodes in prop::collection::vec(point(), 0..50),
        ) {
            let mut space = SpaceColonization::new(markers.clone()).with_occupancy(0.5);
            space.update(&nodes, &[]);
            let taken = markers.iter().filter(|m| nodes.iter().any(|n| (**m - *n).length_squared() <= 0.25)).count();
            prop_assert_eq!(space.free(), markers.len() - taken);
            space.update(&[], &nodes);
            prop_assert_eq!(space.free(), markers.len());
        }
    }
}
