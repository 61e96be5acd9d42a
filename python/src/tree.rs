//! One tree with its leaves and bark, of any system.

use crate::asset::{self, Asset};
use crate::failure::{failure, refused};
use crate::file;
use crate::mesh::Leaves;
use crate::skeleton::{Skeleton, dict};
use crate::species::{self, Wish};
use crate::watch;
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use treesynth::Shape;
use treesynth::asset::{AssetBuilder, Impostor};
use treesynth::foliage;
use treesynth::presets::{self, Found, Preset, Season, TYPICAL_NODES};
use treesynth::shape::{Import, MeshFormat, Outline, Sketch};
use treesynth::species::Specimen;
use treesynth::surface::{Material, Mesh, Part, Sway, Tubes};
use treesynth::texture::Bark;
use treesynth::variational::{GuidanceShape, Level, VariationalSynth};

/// Triangles of each level over those of the one before.
const SHARE: f32 = 0.3;

/// A grown tree.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Tree {
    name: String,
    seed: u64,
    skeleton: Py<Skeleton>,
    leaves: Vec<foliage::Leaves>,
    numbers: Value,
    dress: Dress,
}

/// Bark and material of a tree.
enum Dress {
    Specimen(Box<Specimen>),
    Plain(Material, Bark),
}

impl Tree {
    pub(crate) fn of_specimen(py: Python<'_>, specimen: Specimen) -> PyResult<Self> {
        Ok(Self {
            name: specimen.species.name.clone(),
            seed: specimen.seed,
            skeleton: Py::new(py, Skeleton::from(specimen.skeleton.clone()))?,
            leaves: specimen.foliage().cloned().collect(),
            numbers: serde_json::to_value(specimen.numbers).map_err(failure)?,
            dress: Dress::Specimen(Box::new(specimen)),
        })
    }

    pub(crate) fn new(
        py: Python<'_>,
        (name, seed): (impl Into<String>, u64),
        skeleton: treesynth::Skeleton,
        leaves: Vec<foliage::Leaves>,
        bark: (Material, Bark),
        numbers: Value,
    ) -> PyResult<Self> {
        let skeleton = Py::new(py, Skeleton::from(skeleton))?;
        Ok(Self { name: name.into(), seed, skeleton, leaves, numbers, dress: Dress::Plain(bark.0, bark.1) })
    }

    /// Its bark as a scanner meets it, as thick and as round as the skeleton says; points tell the nodes they lie on.
    pub(crate) fn scanned_bark(&self) -> PyResult<Mesh> {
        let tubes = Tubes::default().with_sides(32).with_root_flare(0.0).with_wind(true);
        tubes.mesh(&self.skeleton.get().tree).map_err(failure)
    }

    pub(crate) fn leaf_parts(&self) -> impl Iterator<Item = Part<'_>> {
        self.leaves.iter().map(foliage::Leaves::part)
    }

    /// A tree of the guided system, smoothed a little as its pictures are.
    fn of_preset(
        py: Python<'_>,
        preset: &'static Preset,
        nodes: usize,
        season: Season,
        seed: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (skeleton, leaves) = watch::run(py, progress, |observer| {
            let grown = preset.synth(nodes).synthesize_observed(seed, observer).map_err(failure)?;
            let relaxed = grown.relaxed(0.5, 3).map_err(failure)?;
            let foliage = preset.foliage(season);
            let leaves = foliage.map(|foliage| foliage.place(&relaxed, seed)).transpose().map_err(failure)?;
            Ok((relaxed, leaves))
        })?;
        let bark = (preset.bark(), preset.bark_texture().with_seed(seed));
        let numbers = json!({ "nodes": nodes });
        Self::new(py, (preset.name, seed), skeleton, leaves.into_iter().collect(), bark, numbers)
    }
}

#[pymethods]
impl Tree {
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    #[getter]
    fn skeleton(&self, py: Python<'_>) -> Py<Skeleton> {
        self.skeleton.clone_ref(py)
    }

    #[getter]
    fn leaves(&self) -> Vec<Leaves> {
        self.leaves.iter().map(|leaves| Leaves { leaves: leaves.clone() }).collect()
    }

    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        dict(py, &self.numbers)
    }

    #[pyo3(
        signature = (triangles = Some(20_000), *, textures = Some(512), levels = 1, wind = false, progress = None),
        text_signature = "($self, triangles=20000, *, textures=512, levels=1, wind=False, progress=None)"
    )]
    fn asset(
        &self,
        py: Python<'_>,
        triangles: Option<usize>,
        textures: Option<u32>,
        levels: u32,
        wind: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Asset> {
        if !(1..=8).contains(&levels) {
            return Err(refused(format!("levels is {levels}, but must be 1 to 8")));
        }
        if let Some(side) = textures.filter(|side| !side.is_power_of_two() || !(128..=8192).contains(side)) {
            return Err(refused(format!(
                "textures is {side}, but must be None or a power of two from 128 to 8192"
            )));
        }
        let shares: Vec<f32> =
            std::iter::successors(Some(1.0), |share| Some(share * SHARE)).take(levels as usize).collect();
        let skeleton = &self.skeleton.get().tree;
        watch::run(py, progress, |observer| {
            let mut assets = match (&self.dress, textures) {
                (Dress::Specimen(tree), Some(side)) if wind => {
                    tree.levels_in_wind(triangles, side, &shares).map_err(failure)?
                }
                (Dress::Specimen(tree), Some(side)) => {
                    tree.levels(triangles, side, &shares).map_err(failure)?
                }
                (dress, side) => {
                    let bark = match dress {
                        Dress::Specimen(tree) => tree.bark(),
                        Dress::Plain(bark, _) => *bark,
                    };
                    let mut builder = AssetBuilder::default()
                        .with_triangles(triangles)
                        .with_bark(bark)
                        .with_leaf_size(side.map(|side| (side / 4).clamp(32, 2048)))
                        .with_texture_size(side.unwrap_or(512))
                        .with_tubes(Tubes::default().with_square_tiles(true).with_wind(wind));
                    if let (Some(side), Dress::Plain(_, images)) = (side, dress) {
                        builder =
                            builder.with_bark_of(&images.clone().with_resolution(side)).map_err(failure)?;
                    }
                    let mut levels = builder
                        .levels_with_observed(skeleton, &self.leaves, &shares, observer)
                        .map_err(failure)?;
                    if wind {
                        let sway = Sway::of(skeleton).map_err(failure)?;
                        levels = levels
                            .iter()
                            .map(|level| level.in_wind(&sway))
                            .collect::<Result<_, _>>()
                            .map_err(failure)?;
                    }
                    levels
                }
            };
            if levels > 1 {
                let impostor = Impostor::default().with_texture_size(textures.unwrap_or(512).clamp(128, 256));
                let last = impostor.billboards_observed(&assets[0].parts(), observer).map_err(failure)?;
                assets.push(last);
            }
            Ok(Asset::new(self.name.clone(), assets, treesynth::metrics::height(skeleton) as f32))
        })
    }

    /// As `asset` and `Asset.save`, in one call.
    #[pyo3(
        signature = (path, triangles = Some(20_000), *, textures = Some(512), levels = 1, wind = false, up = "y", unit = 1.0,
            images = "png", progress = None),
        text_signature = "($self, path, triangles=20000, *, textures=512, levels=1, wind=False, up='y', unit=1.0, images='png', progress=None)"
    )]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        triangles: Option<usize>,
        textures: Option<u32>,
        levels: u32,
        wind: bool,
        up: &str,
        unit: f32,
        images: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        Asset::check(&path)?;
        // Before the work.
        asset::jpeg(images)?;
        let asset = self.asset(py, triangles, textures, levels, wind, progress)?;
        asset.save(py, path, up, unit, false, false, images)
    }

    fn __repr__(&self) -> String {
        let leaves: usize = self.leaves.iter().map(|leaves| leaves.instances.len()).sum();
        let nodes = self.skeleton.get().tree.len();
        format!("<treesynth.Tree {:?}, seed {}: {nodes} nodes, {leaves} leaves>", self.name, self.seed)
    }
}

/// A tree of a species, or of a preset of the guided system.
#[pyfunction]
#[pyo3(signature = (name, *, seed = None, nodes = None, season = None, height = None, dbh = None, age = None,
    day = None, stand_spacing = None, years_dead = None, storm_damage = None, progress = None))]
pub(crate) fn grow(
    py: Python<'_>,
    name: &str,
    seed: Option<u64>,
    nodes: Option<usize>,
    season: Option<&str>,
    height: Option<f32>,
    dbh: Option<f32>,
    age: Option<f32>,
    day: Option<f32>,
    stand_spacing: Option<f32>,
    years_dead: Option<f32>,
    storm_damage: Option<f32>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Tree> {
    let wish = Wish { height, dbh, age, day, stand_spacing, years_dead, storm_damage };
    match presets::by_name(name).map_err(failure)? {
        Found::Species(species) => {
            let other = nodes.map(|_| "nodes").or(season.map(|_| "season"));
            if let Some(option) = other {
                return Err(refused(format!(
                    "{option} goes with presets of the guided system, but {name:?} is a species"
                )));
            }
            species::grow(py, species, wish, seed.unwrap_or(0))
        }
        Found::Guided(preset) => {
            if let Some(option) = wish.first() {
                return Err(refused(format!(
                    "{option} goes with species, but {name:?} is a preset of the guided system"
                )));
            }
            let season = match season.unwrap_or("summer") {
                "winter" => Season::Winter,
                "summer" => Season::Summer,
                "autumn" => Season::Autumn,
                other => {
                    return Err(refused(format!(
                        "season is {other:?}, but must be \"winter\", \"summer\" or \"autumn\""
                    )));
                }
            };
            let seed = seed.unwrap_or(preset.seed);
            Tree::of_preset(py, preset, nodes.unwrap_or(TYPICAL_NODES), season, seed, progress)
        }
        other => {
            let call = match other {
                Found::Stand(_) | Found::Space(_) => "Forest",
                Found::Variational(_) => "fill",
                _ => "Growth",
            };
            let (name, system) = (other.name(), other.system());
            Err(refused(format!("{name:?} is a preset of the system {system}: treesynth.{call}({name:?})")))
        }
    }
}

/// A bare tree that fills a mesh, a drawing, or the shape of a preset of the variational system.
#[pyfunction]
#[pyo3(signature = (shape, *, nodes = None, height = None, up = None, seed = None, progress = None))]
pub(crate) fn fill(
    py: Python<'_>,
    shape: PathBuf,
    nodes: Option<usize>,
    height: Option<f32>,
    up: Option<&str>,
    seed: Option<u64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Tree> {
    let ending = file::ending(&shape);
    let is_mesh = MeshFormat::of(&shape).is_some();
    if up.is_some() && !is_mesh {
        return Err(refused("up goes with a mesh file"));
    }
    let (name, synth, seed) = if is_mesh || ending == "svg" {
        let up = file::up_axis(up.unwrap_or("y"))?;
        let (height, nodes) = (height.unwrap_or(8.0), nodes.unwrap_or(4000));
        let synth = watch::run(py, None, |_| {
            if ending == "svg" {
                return filled(&sketch(&shape, height)?, nodes);
            }
            // That it is not there is told as Python tells it.
            file::open(&shape)?;
            let mesh = Import::default().with_up(up).open(&shape).map_err(failure)?;
            filled(&mesh.fitted(height / 6.0, height).map_err(failure)?, nodes)
        })?;
        let name = shape.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        (name, synth, seed.unwrap_or(1))
    } else {
        let name = shape.to_string_lossy();
        let preset = presets::by_name(&name).and_then(Found::variational).map_err(failure)?;
        if height.is_some() {
            return Err(refused("height goes with a mesh or a drawing, not with a preset"));
        }
        let synth = preset.synth(nodes.unwrap_or(preset.shape_nodes)).map_err(failure)?;
        (preset.name.to_owned(), synth, seed.unwrap_or(preset.seed))
    };
    let (growth, nodes) = watch::run(py, progress, |observer| {
        Ok((synth.grow(seed, observer).map_err(failure)?, synth.shape().len()))
    })?;
    let numbers =
        json!({ "nodes": nodes, "energy": growth.trace[growth.best].total, "steps": growth.best + 1 });
    Tree::new(py, (name, seed), growth.skeleton, Vec::new(), (Material::bark(), Bark::oak()), numbers)
}

/// The crown's silhouette from the front, and from the side if a second shape is there; on a trunk of a sixth of the height.
fn sketch(path: &Path, height: f32) -> PyResult<Sketch> {
    let text = std::io::read_to_string(file::open(path)?)?;
    let mut outlines = Outline::from_svg(&text).map_err(failure)?.into_iter();
    let fitted = |outline: Outline| outline.fitted(height / 6.0, height);
    let front = outlines.next().map(fitted);
    let mut sketch =
        Sketch::new(front.ok_or_else(|| refused(format!("{}: it draws nothing", path.display())))?);
    if let Some(side) = outlines.next() {
        sketch = sketch.with_side(fitted(side));
    }
    sketch.check().map_err(failure)?;
    Ok(sketch)
}

/// Half of the shape nodes on the surface, half in the volume.
fn filled(shape: &dyn Shape, nodes: usize) -> PyResult<VariationalSynth> {
    let surface = GuidanceShape::on_surface(shape, nodes / 2, 1).map_err(failure)?;
    let inside = GuidanceShape::in_volume(shape, nodes - nodes / 2, 1).map_err(failure)?;
    let axis = Level::default().with_apical_control(0.9);
    Ok(VariationalSynth::new(surface.joined(&inside)).with_levels([axis.with_metamers(7), axis, axis, axis]))
}

/// Names that `grow`, `fill`, `Forest` and `Growth` know.
#[pyfunction]
#[pyo3(signature = (system = None))]
pub(crate) fn names<'py>(py: Python<'py>, system: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    let systems = ["species", "guided", "self-organizing", "variational", "growth"];
    if let Some(other) = system.filter(|system| !systems.contains(system)) {
        return Err(refused(format!("system is {other:?}, but must be one of {}", systems.join(", "))));
    }
    let entries: Vec<Value> = presets::all()
        .filter(|found| system.is_none_or(|system| found.system().to_string() == system))
        .map(|found| {
            let mut entry =
                json!({ "name": found.name(), "system": found.system().to_string(), "about": found.about() });
            if let Found::Species(species) = found {
                entry["latin"] = json!(species.latin);
            }
            entry
        })
        .collect();
    dict(py, &entries)
}
