//! Landscapes of any size, grown tile by tile.

use super::environment::Environment;
use super::forest::{Forest, ForestError};
use super::habit::{Habit, within};
use super::planting::PlantingMap;
use super::shadow::ShadowPropagation;
use super::terrain::Terrain;
use super::tree::Tree;
use crate::ParameterError;
use crate::random::{Purpose, unit};
use crate::shape::{Bounds, LARGEST};
use glam::{DVec2, DVec3, IVec2, Vec2, Vec3};
use std::fmt;
use std::sync::Arc;

/// The most cells along a side of a tile with its margins, so that places within it are exact to a few thousandths of a
/// cell.
const MOST_CELLS: u32 = 4096;
/// The farthest a tree stands from the middle of its cell, as a part of the cell's width, so that no rounding takes it out.
const FARTHEST: f32 = 0.9;

/// A species for the point x, z of the landscape, metres, and a random number in [0, 1).
type SpeciesRule = dyn Fn(f32, f32, f32) -> Option<usize> + Send + Sync;

/// What is planted where.
#[derive(Clone)]
enum Planting {
    Rule(Arc<SpeciesRule>),
    Map(Arc<PlantingMap>),
}

/// The ground of one tile, in its own frame.
struct Ground {
    whole: Arc<dyn Terrain>,
    origin: DVec3,
}

impl Terrain for Ground {
    fn height(&self, x: f32, z: f32) -> f32 {
        let place = (DVec2::new(x.into(), z.into()) + DVec2::new(self.origin.x, self.origin.z)).as_vec2();
        (f64::from(self.whole.height(place.x, place.y)) - self.origin.y) as f32
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.whole.check()
    }
}

/// A planted landscape without end, of which any tile can be grown by itself: in any order, on any thread, process or
/// machine, to the same bits.
///
/// The landscape is a lattice of square cells. Each cell has a tree at a random place in it, or none: what
/// [`with_species`](Self::with_species) says. All draws are keyed by the seed and the cell, so neighbouring tiles agree
/// on what is planted where, of which species, and with which number.
///
/// # What a tile sees of its neighbours
/// The trees planted within the [margin](Self::with_margin) around it, and nothing beyond. They are grown with the tile's
/// own as one [`Forest`], shade them, and drop their seeds; then they are left out ([`own`](Self::own)), for their own
/// tile grows them among all of *their* neighbours. So what grows in a tile follows from the landscape's description, the
/// tile's place and the number of seasons alone.
///
/// The same tree therefore exists twice near a border, once as its tile has it and once as its neighbour sees it: alike in
/// place, species, age and draws, but not node by node, for the two have different trees at their far sides. A margin of
/// the width of a crown or two is enough for the trees at a border to be as high and as dense as those in the middle;
/// without a margin they grow as on the edge of a wood. Seeds that fall into another tile come up there only if that tile
/// has their mother in its margin, so it should also be as wide as seeds fly.
///
/// # Frames
/// Each tile's forest has its origin at the tile's corner of least x and z, on the ground below the tile's middle:
/// [`origin`](Self::origin). So far tiles are as exact as near ones, but for the terrain and the species, which are asked at `f32` places of
/// the landscape: in steps of 6 cm a million metres off.
///
/// Memory and time are those of one forest on (tile + 2 · margin)².
///
/// ```
/// use treesynth::glam::IVec2;
/// use treesynth::self_organizing::{Habit, Landscape, ShadowPropagation};
///
/// let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
/// let landscape = Landscape::new(light, Habit::default().with_length(0.1), 1)
///     .with_spacing(1.5)
///     .with_tile(4)
///     .with_margin(2)
///     .with_terrain(|x: f32, z: f32| 0.1 * x - 0.05 * z);
/// let tile = IVec2::new(1000, -3);
/// let mut forest = landscape.plant(tile)?;
/// assert_eq!(forest.trees().len(), 64);
/// forest.grow(6)?;
/// // Of the sixteen that are its own some may have died in the shade of others.
/// assert!((12..=16).contains(&landscape.own(&forest).count()));
/// for tree in landscape.own(&forest) {
///     let (skeleton, _stands_at) = (forest.skeleton(tree)?, landscape.origin(tile));
///     assert!(skeleton.len() > 1);
/// }
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
#[derive(Clone)]
#[must_use]
pub struct Landscape<E: Environment = ShadowPropagation> {
    environment: Arc<dyn Fn(Bounds) -> E + Send + Sync>,
    habits: Vec<Habit>,
    seed: u64,
    spacing: f32,
    scatter: f32,
    tile: u32,
    margin: u32,
    height: f32,
    planting: Option<Planting>,
    terrain: Option<Arc<dyn Terrain>>,
}

crate::recipe::readable!(@[E: Environment] Landscape<E> {
    spacing: f32, scatter: f32, tile: u32, margin: u32, height: f32,
});

impl<E: Environment> fmt::Debug for Landscape<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut all = f.debug_struct("Landscape");
        all.field("habits", &self.habits).field("seed", &self.seed).field("spacing", &self.spacing);
        all.field("scatter", &self.scatter).field("tile", &self.tile).field("margin", &self.margin);
        all.finish_non_exhaustive()
    }
}

impl<E: Environment> Landscape<E> {
    /// A tree in each cell of 2 m, in tiles of 16 cells and margins of 4, on level ground. `environment` makes what the
    /// trees of a tile compete for in the box that they grow in, margins included, in the tile's own frame; it must
    /// depend on the box alone.
    pub fn new(environment: impl Fn(Bounds) -> E + Send + Sync + 'static, habit: Habit, seed: u64) -> Self {
        Self {
            environment: Arc::new(environment),
            habits: vec![habit],
            seed,
            spacing: 2.0,
            scatter: 0.7,
            tile: 16,
            margin: 4,
            height: 20.0,
            planting: None,
            terrain: None,
        }
    }

    /// Adds another species and returns its number for [`with_species`](Self::with_species); that of `new` is 0.
    pub fn add_habit(&mut self, habit: Habit) -> usize {
        self.habits.push(habit);
        self.habits.len() - 1
    }

    /// Sets the width of a cell, metres, in [1e-3, 1e3]; 2 by default.
    pub fn with_spacing(mut self, metres: f32) -> Self {
        self.spacing = metres;
        self
    }

    /// Sets how far trees stray in their cells, in [0, 0.9]: 0 for the middle of each, 0.7 by default.
    pub fn with_scatter(mut self, part: f32) -> Self {
        self.scatter = part;
        self
    }

    /// Sets the cells along a side of a tile, at least 1; 16 by default. A tile with both its margins has at most 4096.
    pub fn with_tile(mut self, cells: u32) -> Self {
        self.tile = cells;
        self
    }

    /// Sets how many cells of its neighbours a tile sees on each side; 4 by default.
    pub fn with_margin(mut self, cells: u32) -> Self {
        self.margin = cells;
        self
    }

    /// Sets the height of the box that the environment is made for, metres, in [1e-3, 1e4]; 20 by default.
    /// [`ShadowPropagation`] grows beyond it by itself.
    pub fn with_height(mut self, metres: f32) -> Self {
        self.height = metres;
        self
    }

    /// Sets what is planted where: `species(x, z, draw)` is the species at a point of the landscape, metres, or `None`
    /// for no tree there; `draw` is a random number in [0, 1) for mixtures and gaps. The same answer for the same
    /// question, always. By default the first species everywhere.
    ///
    /// ```
    /// use treesynth::glam::IVec2;
    /// use treesynth::self_organizing::{Habit, Landscape, ShadowPropagation};
    ///
    /// let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
    /// let habit = Habit::default().with_length(0.1);
    /// let mut landscape = Landscape::new(light, habit.clone(), 1);
    /// let alder = landscape.add_habit(habit.with_shade_tolerance(0.5));
    /// // Alders along a stream of 6 m, three quarters stocked elsewhere.
    /// let landscape = landscape.with_species(move |x, _z, draw| match x.abs() {
    ///     0.0..3.0 => None,
    ///     3.0..8.0 => Some(alder),
    ///     _ => (draw < 0.75).then_some(0),
    /// });
    /// let forest = landscape.plant(IVec2::ZERO)?;
    /// assert!(forest.trees().iter().any(|tree| tree.habit() == alder));
    /// # Ok::<(), treesynth::self_organizing::ForestError>(())
    /// ```
    pub fn with_species(
        mut self,
        species: impl Fn(f32, f32, f32) -> Option<usize> + Send + Sync + 'static,
    ) -> Self {
        self.planting = Some(Planting::Rule(Arc::new(species)));
        self
    }

    /// Sets what is planted where by a map, instead of [by a rule](Self::with_species).
    pub fn with_planting(mut self, map: PlantingMap) -> Self {
        self.planting = Some(Planting::Map(Arc::new(map)));
        self
    }

    /// Sets the ground of the whole landscape.
    pub fn with_terrain(mut self, terrain: impl Terrain + 'static) -> Self {
        self.terrain = Some(Arc::new(terrain));
        self
    }

    /// The species.
    pub fn habits(&self) -> &[Habit] {
        &self.habits
    }

    /// The length of a side of a tile, metres.
    pub fn side(&self) -> f32 {
        self.tile as f32 * self.spacing
    }

    /// Place of the origin of a tile's frame in the landscape, metres.
    pub fn origin(&self, tile: IVec2) -> DVec3 {
        let corner = tile.as_dvec2() * f64::from(self.tile) * f64::from(self.spacing);
        let middle = (corner + 0.5 * f64::from(self.side())).as_vec2();
        let height = self.terrain.as_ref().map_or(0.0, |terrain| terrain.height(middle.x, middle.y));
        DVec3::new(corner.x, if height.is_finite() { height.into() } else { 0.0 }, corner.y)
    }

    /// Checks that all options are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        within("Landscape.spacing", self.spacing, 1e-3, 1e3)?;
        within("Landscape.scatter", self.scatter, 0.0, FARTHEST)?;
        within("Landscape.height", self.height, 1e-3, 1e4)?;
        let (tile, margin) = (self.tile, self.margin);
        let range = "1 to 4096 cells";
        ParameterError::unless((1..=MOST_CELLS).contains(&tile), "Landscape.tile", tile, range)?;
        let all = u64::from(tile) + 2 * u64::from(margin);
        let range = "so few cells that a tile and both its margins have at most 4096";
        ParameterError::unless(all <= u64::from(MOST_CELLS), "Landscape.margin", margin, range)?;
        self.terrain.as_ref().map_or(Ok(()), |terrain| terrain.check())?;
        if let Some(Planting::Map(map)) = &self.planting {
            map.check()?;
        }
        self.habits.iter().try_for_each(Habit::check)
    }

    /// The forest of a tile with its margins, with no season passed. Grow it, tend it, save it as any other; then
    /// [`own`](Self::own) has the trees that are the tile's. Where there is no room for a tree none is planted.
    ///
    /// # Errors
    /// Options out of range; a tile beyond a million metres; a species that does not exist.
    pub fn plant(&self, tile: IVec2) -> Result<Forest<E>, ForestError> {
        self.check()?;
        let origin = self.origin(tile);
        let (side, margin) = (self.side(), self.margin as f32 * self.spacing);
        let farthest = origin.x.abs().max(origin.z.abs()) + f64::from(side + margin);
        ParameterError::unless(farthest <= f64::from(LARGEST), "tile", tile, "within a million metres")?;
        let low = Vec3::new(-margin, 0.0, -margin);
        let bounds = Bounds::new(low, Vec3::new(side + margin, self.height, side + margin));
        let (first, others) = self.habits.split_at(1);
        let mut forest = Forest::new((self.environment)(bounds), first[0].clone(), self.seed);
        for habit in others {
            forest.add_habit(habit.clone());
        }
        forest = self.grounded(tile, forest);
        let plants = self.plants(tile);
        let most = plants.len() + forest.most_trees();
        forest = forest.with_most_trees(most);
        for (number, place, habit) in plants {
            if habit < self.habits.len() && !forest.has_room(forest.room.grounded(place)) {
                continue;
            }
            forest.next_tree = number;
            forest.plant_as(place, habit)?;
        }
        Ok(forest)
    }

    /// The forest of a tile with its margins, after so many seasons.
    ///
    /// # Errors
    /// As [`plant`](Self::plant) and [`Forest::grow`].
    pub fn grow(&self, tile: IVec2, seasons: u32) -> Result<Forest<E>, ForestError> {
        let mut forest = self.plant(tile)?;
        forest.grow(seasons)?;
        Ok(forest)
    }

    /// Gives the forest of a tile that was read from a file its ground again.
    pub fn grounded(&self, tile: IVec2, forest: Forest<E>) -> Forest<E> {
        let origin = self.origin(tile);
        match self.terrain.clone() {
            Some(whole) => forest.with_terrain(Ground { whole, origin }),
            None => forest,
        }
    }

    /// The trees of a tile's forest that are its own, planted and sown, by ascending number. Each tree of the landscape
    /// is that of one tile.
    pub fn own<'a>(&self, forest: &'a Forest<E>) -> impl Iterator<Item = &'a Tree> + use<'a, E> {
        let side = self.side();
        let inside = move |along: f32| (0.0..side).contains(&along);
        forest.trees().iter().filter(move |tree| inside(tree.foot().x) && inside(tree.foot().z))
    }

    /// Number, place and species of all that is planted in a tile and its margins, by ascending number.
    fn plants(&self, tile: IVec2) -> Vec<(u32, Vec3, usize)> {
        let (cells, margin) = (i64::from(self.tile), i64::from(self.margin));
        let mut plants = Vec::new();
        for row in -margin..cells + margin {
            for column in -margin..cells + margin {
                let (x, z) = (i64::from(tile.x) * cells + column, i64::from(tile.y) * cells + row);
                let index = u64::from(x as u32) << 32 | u64::from(z as u32);
                let draw = |stage: u32| unit(self.seed, stage, Purpose::PLANTS, index);
                let aside = Vec2::new(draw(0), draw(1)) - 0.5;
                let aside = 0.5 + aside * self.scatter;
                let place = (Vec2::new(column as f32, row as f32) + aside) * self.spacing;
                // The same bits for all tiles that see it.
                let at = (DVec2::new(x as f64, z as f64) + aside.as_dvec2()) * f64::from(self.spacing);
                let at = at.as_vec2();
                let habit = match &self.planting {
                    None => Some(0),
                    Some(Planting::Rule(species)) => species(at.x, at.y, draw(2)),
                    Some(Planting::Map(map)) => map.species(at.x, at.y, draw(2)),
                };
                if let Some(habit) = habit {
                    plants.push((number(x, z), Vec3::new(place.x, 0.0, place.y), habit));
                }
            }
        }
        plants.sort_unstable_by_key(|plant| plant.0);
        plants
    }
}

/// The number of the tree of a cell: the low 15 bits of x and z in turn. No two are the same in a tile, and as the last two
/// bits say in which turn of a season a tree grows, no two neighbours grow at once.
fn number(x: i64, z: i64) -> u32 {
    let bit = |from: i64, i: u32| (from >> i & 1) as u32;
    (0..15).fold(0, |number, i| number | bit(x, i) << (2 * i) | bit(z, i) << (2 * i + 1))
}
