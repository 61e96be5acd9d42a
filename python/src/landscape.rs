//! Landscapes that are grown tile by tile.

use crate::failure::{failure, refused};
use crate::file;
use crate::skeleton::Skeleton;
use crate::watch;
use numpy::{AllowTypeChange, IntoPyArray, PyArray2, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use treesynth::export::{self, GlbOptions, TileModel, Tileset};
use treesynth::foliage::{Leaf, Leaves};
use treesynth::glam::{DVec3, IVec2, Vec2, Vec3};
use treesynth::presets::{self, Season};
use treesynth::self_organizing::{self, Habit, Heightmap, PlantingMap, ShadowPropagation, Tree, TreeRecord};
use treesynth::surface::{Material, Mesh, Part, Tubes};
use treesynth::{Bounds, Forest};

/// What a landscape is made of.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    species: Vec<(String, Habit)>,
    seed: u64,
    spacing: f32,
    scatter: f32,
    tile: u32,
    margin: u32,
    heights: Option<Heightmap>,
    planting: Option<PlantingMap>,
}

impl Description {
    fn landscape(&self) -> PyResult<self_organizing::Landscape> {
        let Some(((_, first), others)) = self.species.split_first() else {
            return Err(refused("species is empty, but must name at least one"));
        };
        // Metamers as long as cells are wide, as the presets have them.
        let cell = first.length();
        let light = move |bounds| ShadowPropagation::new(bounds).with_cell(cell);
        let mut landscape = self_organizing::Landscape::new(light, first.clone(), self.seed)
            .with_spacing(self.spacing)
            .with_scatter(self.scatter)
            .with_tile(self.tile)
            .with_margin(self.margin);
        for (_, habit) in others {
            landscape.add_habit(habit.clone());
        }
        if let Some(heights) = &self.heights {
            landscape = landscape.with_terrain(heights.clone());
        }
        if let Some(planting) = &self.planting {
            landscape = landscape.with_planting(planting.clone());
        }
        landscape.check().map_err(failure)?;
        Ok(landscape)
    }
}

/// A species: the name of a stand, or a name and a habit as data.
#[derive(FromPyObject)]
enum Kind<'py> {
    Stand(String),
    Own(String, Bound<'py, PyDict>),
}

impl Kind<'_> {
    fn habit(self) -> PyResult<(String, Habit)> {
        match self {
            Self::Stand(name) => {
                let found = presets::by_name(&name).map_err(failure)?;
                let stand = found.stand().map_err(failure)?;
                let habit = stand.plant(stand.seed).map_err(failure)?.habits()[0].clone();
                Ok((name, habit))
            }
            Self::Own(name, data) => {
                let text: String = data.py().import("json")?.call_method1("dumps", (data,))?.extract()?;
                let habit = serde_json::from_str(&text)
                    .map_err(|error| refused(format!("species {name:?}: {error}")))?;
                Ok((name, habit))
            }
        }
    }
}

type Map<'py, T> = PyArrayLike2<'py, T, AllowTypeChange>;

/// A map's values row by row, and its columns.
fn rows<T: numpy::Element + Copy>(map: &Map<'_, T>) -> (Vec<T>, u32) {
    let array = map.as_array();
    (array.iter().copied().collect(), array.ncols() as u32)
}

/// Species and densities of the fields, which have the same shape.
fn planted(
    planting: Option<&Map<'_, i32>>,
    density: Option<&Map<'_, f32>>,
    corner: Vec2,
    step: f32,
    kinds: usize,
) -> PyResult<Option<PlantingMap>> {
    let densities = density.map(rows);
    let (species, columns) = match (planting.map(rows), &densities) {
        (None, None) => return Ok(None),
        (Some(species), _) => species,
        (None, Some((densities, columns))) => (vec![0; densities.len()], *columns),
    };
    if let Some(wrong) = species.iter().find(|&&kind| kind < -1 || kind >= kinds as i32) {
        return Err(refused(format!("planting has {wrong}, but must have -1 to {}", kinds - 1)));
    }
    if densities.as_ref().is_some_and(|(_, other)| *other != columns) {
        return Err(refused(format!("density has other columns than the {columns} of planting")));
    }
    let map =
        PlantingMap::new(corner, step, columns, species.iter().map(|&kind| kind.try_into().ok()).collect());
    Ok(Some(match densities {
        Some((densities, _)) => map.with_density(densities),
        None => map,
    }))
}

/// A landscape of which any tile can be grown alone.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Landscape {
    description: Description,
    landscape: self_organizing::Landscape,
}

impl TryFrom<Description> for Landscape {
    type Error = PyErr;

    fn try_from(description: Description) -> PyResult<Self> {
        Ok(Self { landscape: description.landscape()?, description })
    }
}

#[pymethods]
impl Landscape {
    #[new]
    #[pyo3(signature = (species, *, seed = 1, spacing = 2.0, scatter = 0.7, tile = 16, margin = 4, heights = None, planting = None,
        density = None, corner = (0.0, 0.0), step = 1.0))]
    fn new(
        species: Vec<Kind<'_>>,
        seed: u64,
        spacing: f32,
        scatter: f32,
        tile: u32,
        margin: u32,
        heights: Option<Map<'_, f32>>,
        planting: Option<Map<'_, i32>>,
        density: Option<Map<'_, f32>>,
        corner: (f32, f32),
        step: f32,
    ) -> PyResult<Self> {
        let species = species.into_iter().map(Kind::habit).collect::<PyResult<Vec<_>>>()?;
        let corner = Vec2::from(corner);
        let planting = planted(planting.as_ref(), density.as_ref(), corner, step, species.len())?;
        let heights = heights.map(|heights| {
            let (heights, columns) = rows(&heights);
            Heightmap::new(corner, step, columns, heights)
        });
        Description { species, seed, spacing, scatter, tile, margin, heights, planting }.try_into()
    }

    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let description: Description =
            serde_json::from_str(text).map_err(|error| refused(format!("text: {error}")))?;
        description.try_into()
    }

    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.description).map_err(failure)
    }

    #[getter]
    fn species(&self) -> Vec<&str> {
        self.description.species.iter().map(|(name, _)| name.as_str()).collect()
    }

    #[getter]
    fn side(&self) -> f32 {
        self.landscape.side()
    }

    fn origin(&self, x: i32, z: i32) -> (f64, f64, f64) {
        self.landscape.origin(IVec2::new(x, z)).into()
    }

    #[pyo3(signature = (x, z, seasons, *, progress = None))]
    fn grow(
        &self,
        py: Python<'_>,
        x: i32,
        z: i32,
        seasons: u32,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Tile> {
        watch::run(py, progress, |observer| {
            let (landscape, tile) = (self.landscape.clone(), IVec2::new(x, z));
            let mut forest = landscape.plant(tile).map_err(failure)?;
            forest.grow_observed(seasons, observer).map_err(failure)?;
            let trees = landscape.inventory(tile, &forest).map_err(failure)?;
            let names = self.description.species.iter().map(|(name, _)| name.clone()).collect();
            Ok(Tile { landscape, names, tile, forest, trees })
        })
    }

    fn __repr__(&self) -> String {
        let Description { species, seed, spacing, tile, margin, .. } = &self.description;
        format!(
            "<treesynth.Landscape of {} species, seed {seed}: cells of {spacing} m, {tile} a side and {margin} around>",
            species.len()
        )
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((this.get_type().getattr("from_json")?, (this.get().to_json()?,)))
    }
}

/// The trees of one tile.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Tile {
    landscape: self_organizing::Landscape,
    names: Vec<String>,
    tile: IVec2,
    forest: Forest,
    trees: Vec<TreeRecord>,
}

impl Tile {
    fn skeletons(&self) -> PyResult<Vec<treesynth::Skeleton>> {
        self.own().map(|tree| self.forest.skeleton(tree).map_err(failure)).collect()
    }

    /// The box of its trees and their leaves; `None` without trees.
    fn bounds(&self) -> Option<Bounds> {
        let nodes = self.own().flat_map(Tree::positions);
        nodes.map(|node| Bounds::around(node, Vec3::splat(LEAVES))).reduce(Bounds::union)
    }

    /// The bark of all trees in one mesh, off by `error` metres at most, and leaves as many times as large as there are fewer.
    fn model(&self, error: f32, fewer: usize) -> PyResult<(Mesh, Option<Leaves>)> {
        let tubes = Tubes::default().with_error(error);
        // All stands have the same leaves.
        let stand = presets::stands().next().ok_or_else(|| refused("there are no stands"))?;
        let (mut bark, mut leaves) = (Mesh::default(), None::<Leaves>);
        for tree in self.own() {
            let skeleton = self.forest.skeleton(tree).map_err(failure)?;
            let mesh = tubes.mesh(&skeleton).map_err(failure)?;
            let first = bark.positions.len() as u32;
            bark.positions.extend(mesh.positions);
            bark.normals.extend(mesh.normals);
            bark.indices.extend(mesh.indices.iter().map(|vertex| first + vertex));
            let Some(mut own) = stand.leaves(tree, &skeleton, Season::Summer).map_err(failure)? else {
                continue;
            };
            own.instances = own.instances.into_iter().step_by(fewer).collect();
            own.instances.iter_mut().for_each(|leaf| leaf.scale *= (fewer as f32).sqrt());
            if let Some(leaves) = &mut leaves {
                leaves.instances.extend(own.instances);
            } else {
                own.leaf = rhombus(&own.leaf);
                leaves = Some(own);
            }
        }
        Ok((bark, leaves))
    }

    /// The trees that are its own, but for seeds.
    fn own(&self) -> impl Iterator<Item = &Tree> {
        self.landscape.own(&self.forest).filter(|tree| tree.metamers() > 0)
    }
}

/// A leaf of two triangles, half as wide as it is long.
fn rhombus(leaf: &Leaf) -> Leaf {
    let corners = vec![Vec3::ZERO, Vec3::new(0.25, 0.5, 0.0), Vec3::Y, Vec3::new(-0.25, 0.5, 0.0)];
    Leaf::new(Mesh::new(corners, vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3])).with_material(leaf.material())
}

/// No leaf or trunk reaches farther from a node, metres.
const LEAVES: f32 = 0.5;
/// Of how many leaves one stands for all, near by and far off, and how much coarser the far model is.
const FEWER: [usize; 2] = [12, 96];
const COARSER: [f32; 2] = [1.0, 8.0];

/// The lowest and the highest.
type Corners = [[f32; 3]; 2];

#[pymethods]
impl Tile {
    #[getter]
    fn tile(&self) -> (i32, i32) {
        self.tile.into()
    }

    #[getter]
    fn origin(&self) -> (f64, f64, f64) {
        self.landscape.origin(self.tile).into()
    }

    #[getter]
    fn metamers(&self) -> usize {
        self.trees.iter().map(|tree| tree.metamers).sum()
    }

    #[getter]
    fn trees(&self, py: Python<'_>) -> PyResult<Vec<Skeleton>> {
        let trees = py.detach(|| self.skeletons())?;
        Ok(trees.into_iter().map(Skeleton::from).collect())
    }

    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let places: Vec<f64> = self.trees.iter().flat_map(|tree| tree.place.to_array()).collect();
        places.into_pyarray(py).reshape([self.trees.len(), 3])
    }

    fn save_table(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        if file::ending(&path) != "parquet" {
            return Err(file::unknown(&path, ".parquet"));
        }
        py.detach(|| {
            let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
            // Small, and a writer that may go to other threads.
            let mut table = Vec::new();
            export::write_parquet(&self.trees, &names, &mut table).map_err(failure)?;
            file::write(&path, |file| Ok(file.write_all(&table)?))
        })
    }

    #[pyo3(signature = (near, far, *, error = 0.02))]
    fn save_models(
        &self,
        py: Python<'_>,
        near: PathBuf,
        far: PathBuf,
        error: f32,
    ) -> PyResult<Option<(Corners, [f64; 2])>> {
        for path in [&near, &far] {
            if file::ending(path) != "glb" {
                return Err(file::unknown(path, ".glb"));
            }
        }
        if !(1e-4..=0.1).contains(&error) {
            return Err(refused(format!("error is {error}, but must be 1e-4 to 0.1 metres")));
        }
        py.detach(|| {
            let Some(bounds) = self.bounds() else { return Ok(None) };
            let mut errors = COARSER.map(|coarser| coarser * error);
            for (level, path) in [near, far].iter().enumerate() {
                let (bark, leaves) = self.model(errors[level], FEWER[level])?;
                // A large leaf that stands for many is seen as one where it is larger than some pixels.
                let large = leaves.iter().flat_map(|leaves| &leaves.instances).map(|leaf| leaf.scale);
                errors[level] = large.fold(errors[level], f32::max);
                let bark = Part::new(&bark).with_name("bark").with_material(Material::bark());
                let parts: Vec<Part<'_>> =
                    [bark].into_iter().chain(leaves.as_ref().map(Leaves::part)).collect();
                let options = GlbOptions::default().with_name("tile").with_quantization(true);
                file::write(path, |file| export::write_glb_parts(&parts, &options, file).map_err(failure))?;
            }
            Ok(Some(([bounds.min.to_array(), bounds.max.to_array()], errors.map(f64::from))))
        })
    }

    fn __repr__(&self) -> String {
        let (x, z) = self.tile();
        format!(
            "<treesynth.Tile ({x}, {z}) after {} seasons: {} trees, {} metamers>",
            self.forest.season(),
            self.trees.len(),
            self.metamers()
        )
    }
}

/// Near model, far model, origin, corners, errors.
type Entry = (String, String, [f64; 3], Corners, [f64; 2]);

#[pyfunction]
#[pyo3(signature = (path, tiles, *, position = None))]
pub(crate) fn write_tileset(
    path: PathBuf,
    tiles: Vec<Entry>,
    position: Option<(f64, f64, f64)>,
) -> PyResult<()> {
    let models = tiles.into_iter().map(|(near, far, origin, [low, high], errors)| {
        let bounds = Bounds { min: low.into(), max: high.into() };
        let near = TileModel::new(near, bounds, errors[0]);
        TileModel::new(far, bounds, errors[1]).with_origin(DVec3::from(origin)).with_finer(near)
    });
    let tileset = Tileset::new(models.collect());
    let tileset = match position {
        Some((longitude, latitude, height)) => tileset.with_position(longitude, latitude, height),
        None => tileset,
    };
    file::write(&path, |file| export::write_tileset(&tileset, file).map_err(failure))
}
