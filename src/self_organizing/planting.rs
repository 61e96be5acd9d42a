//! What is planted where, as maps.

use crate::ParameterError;
use crate::shape::LARGEST;
use glam::Vec2;

/// Species and stocking of a landscape on a square lattice of fields; nothing is planted beyond them.
///
/// ```
/// use treesynth::glam::{IVec2, Vec2};
/// use treesynth::self_organizing::{Habit, Landscape, PlantingMap, ShadowPropagation};
///
/// // Two fields of 50 m: the first fully stocked with species 0, the other half with species 1.
/// let map = PlantingMap::new(Vec2::ZERO, 50.0, 2, vec![Some(0), Some(1)]).with_density(vec![1.0, 0.5]);
/// let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
/// let mut landscape = Landscape::new(light, Habit::default().with_length(0.1), 1);
/// landscape.add_habit(Habit::default().with_length(0.08));
/// let landscape = landscape.with_planting(map).with_tile(25).with_margin(0);
/// let [one, other] = [IVec2::ZERO, IVec2::X].map(|tile| landscape.plant(tile));
/// assert_eq!(one?.trees().len(), 625);
/// assert!((250..375).contains(&other?.trees().len()));
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[must_use]
pub struct PlantingMap {
    corner: Vec2,
    spacing: f32,
    columns: u32,
    species: Vec<Option<u32>>,
    density: Option<Vec<f32>>,
}

impl PlantingMap {
    /// `species` row by row: `columns` fields of `spacing` metres along x from `corner` (x and z, metres) on, then the next row in z; `None`
    /// where nothing grows. At least one row of one, all full.
    pub fn new(corner: Vec2, spacing: f32, columns: u32, species: Vec<Option<u32>>) -> Self {
        Self { corner, spacing, columns, species, density: None }
    }

    /// Sets the share of its cells that is planted for each field, in [0, 1]; by default 1 for all.
    pub fn with_density(mut self, density: Vec<f32>) -> Self {
        self.density = Some(density);
        self
    }

    /// What is planted at (x, z), metres, given a random number in [0, 1).
    pub fn species(&self, x: f32, z: f32, draw: f32) -> Option<usize> {
        let place = ((Vec2::new(x, z) - self.corner) / self.spacing).floor();
        let (columns, rows) = (self.columns as usize, self.species.len() / self.columns.max(1) as usize);
        let is_inside = place.min_element() >= 0.0 && place.x < columns as f32 && place.y < rows as f32;
        let field = is_inside.then(|| place.y as usize * columns + place.x as usize)?;
        let density = self.density.as_ref().map_or(1.0, |density| density[field]);
        if draw < density { self.species[field].map(|species| species as usize) } else { None }
    }

    /// Checks that all options are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let (columns, fields) = (self.columns as usize, self.species.len());
        let holds = self.corner.abs().max_element() <= LARGEST;
        ParameterError::unless(holds, "PlantingMap.corner", self.corner, "within a million metres")?;
        let holds = (1e-3..=LARGEST).contains(&self.spacing);
        ParameterError::unless(holds, "PlantingMap.spacing", self.spacing, "1e-3 to 1e6 metres")?;
        let holds = columns > 0 && fields > 0 && fields.is_multiple_of(columns);
        ParameterError::unless(holds, "PlantingMap.columns", columns, "a part of the number of fields")?;
        let Some(density) = &self.density else { return Ok(()) };
        let range = "as many numbers as there are fields";
        ParameterError::unless(density.len() == fields, "PlantingMap.density", density.len(), range)?;
        let wrong = density.iter().find(|share| !(0.0..=1.0).contains(*share));
        ParameterError::unless(wrong.is_none(), "PlantingMap.density", wrong, "0 to 1")
    }
}
