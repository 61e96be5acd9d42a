//! The trees of the papers' figures, by name, and more.
//!
//! [`by_name`] finds a preset of any system, [`all`] lists them.
//!
//! | presets | found as | after |
//! |---|---|---|
//! | [`guided`] | [`Found::guided`] | Xu and Mould 2015, "Procedural Tree Modeling with Guiding Vectors"; trees that refine their graphs or grow on graphs of varying spacing |
//! | [`stands`] | [`Found::stand`] | Pałubicki et al. 2009: habits and stands that organize themselves |
//! | [`spaces`] | [`Found::space`] | the same, by markers in space |
//! | [`grown`] | [`Found::grown`] | Galbraith, Mündermann and Wyvill 2004: trees over the years |
//! | [`variational::presets`](crate::variational::presets) | [`Found::variational`] | Wang et al. 2014: trees that fill shapes |
//! | [`species::all`](crate::species::all) | [`Found::species`] | floras and forestry tables: trees of a botanical name |
//!
//! The junctions of Galbraith's figures are no trees: [`surface::blob::presets`](crate::surface::blob::presets) has them.
//!
//! Of the first, angles, hops, exclusion zones and counts are the paper's where it gives them; heights (about 10 m), crowns
//! and the rest are chosen so that the tree shows what its figure shows, and each preset's caption says what that is.
//!
//! ```
//! use treesynth::presets;
//!
//! let ash = presets::by_name("figure-06c")?.guided()?;
//! let tree = ash.synth(10_000).synthesize(1)?;
//! assert!(tree.len() > 1_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clothed;
mod comparison;
mod fine;
mod found;
mod graded;
mod grown;
mod hedge;
mod look;
mod organized;
mod painted;
mod plane;
mod rotation;
mod samples;
mod site;
mod stand;
mod topiary;
mod variety;
mod volume;

pub use found::{Found, PresetError, System, all, by_name};
pub use grown::{Grown, grown};
pub use look::Season;
pub use organized::{WALL, stands};
pub use painted::{spaces, strokes};
pub use stand::Stand;
pub use topiary::Peacock;

use crate::foliage::Foliage;
use crate::guided::{Bend, NearestTo, Recipe, StageRecipe, TreeSynth};
use crate::radius::{PipeModel, Taper};
use crate::shape::Ellipsoid;
use crate::surface::Material;
use glam::Vec3;
use look::Look;
use site::Site;

/// The nodes of "a typical result" (section 4).
pub const TYPICAL_NODES: usize = 150_000;

/// A tree of one of the figures.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Preset {
    /// Its name: the figure, two digits, then the tree in it, e.g. `figure-06c`.
    pub name: &'static str,
    /// The number of the figure; 0 beyond the paper.
    pub figure: u8,
    /// Description of the tree in the figure.
    pub caption: &'static str,
    /// The seed of its picture.
    pub seed: u64,
    /// The stages after which the figure shows the unfinished tree, if it does.
    pub partial_stages: Option<usize>,
    /// `true` if it lies in the plane z = 0.
    pub planar: bool,
    build: fn(usize) -> Recipe,
    look: Look,
    volume: Option<Ellipsoid>,
}

impl Preset {
    const fn new(name: &'static str, figure: u8, caption: &'static str, build: fn(usize) -> Recipe) -> Self {
        Self {
            name,
            figure,
            caption,
            seed: 1,
            partial_stages: None,
            planar: false,
            build,
            look: look::ELM,
            volume: None,
        }
    }

    const fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    const fn partial(mut self, stages: usize) -> Self {
        self.partial_stages = Some(stages);
        self
    }

    const fn planar(mut self) -> Self {
        self.planar = true;
        self.like(look::BARE)
    }

    const fn like(mut self, look: Look) -> Self {
        self.look = look;
        self
    }

    const fn within(mut self, volume: Ellipsoid) -> Self {
        self.volume = Some(volume);
        self
    }

    /// The volume that its figure draws around it: where the endpoints of the second iteration lie. Figure 10 alone has them.
    pub fn volume(&self) -> Option<Ellipsoid> {
        self.volume
    }

    /// Material of its bark.
    pub fn bark(&self) -> Material {
        self.look.bark()
    }

    /// Its bark as images, in the mean the [colour](Self::bark) it has without them; they go with [`Material::white`] of roughness 1.
    #[cfg(feature = "texture")]
    pub fn bark_texture(&self) -> crate::texture::Bark {
        self.look.bark_texture()
    }

    /// Its leaves; `None` in winter, and of what has none all the year.
    ///
    /// ```
    /// use treesynth::presets::{Season, by_name};
    ///
    /// let ash = by_name("figure-06c")?.guided()?;
    /// let tree = ash.synth(5_000).synthesize(1)?;
    /// let leaves = ash.foliage(Season::Summer).expect("an ash in leaf").place(&tree, 1)?;
    /// assert!(leaves.instances.len() > 1_000);
    /// // A fifth larger.
    /// let foliage = ash.foliage(Season::Summer).expect("an ash in leaf");
    /// let larger = foliage.clone().with_size(foliage.size() * 1.2);
    /// assert!(larger.place(&tree, 1)?.instances[0].scale > leaves.instances[0].scale);
    /// assert!(ash.foliage(Season::Winter).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn foliage(&self, season: Season) -> Option<Foliage> {
        self.look.foliage(season)
    }

    /// The pipeline, on a graph of about `nodes` nodes; [`TYPICAL_NODES`] for the paper's detail.
    ///
    /// Angles and endpoints by hops are those of a graph of [`TYPICAL_NODES`], by metres of path: `nodes` changes the
    /// detail, not the tree. Late endpoints are "up to" the figure's count, so that coarse graphs work too.
    pub fn synth(&self, nodes: usize) -> TreeSynth {
        self.recipe(nodes).into()
    }

    /// The pipeline as data, with the seed of the preset's picture: to print, compare, change and save. [`synth`](Self::synth)
    /// is what it makes.
    pub fn recipe(&self, nodes: usize) -> Recipe {
        (self.build)(nodes).with_seed(self.seed)
    }
}

/// All presets of [`guided`](crate::guided), in the order of the figures, then those beyond the paper.
pub fn guided() -> impl Iterator<Item = &'static Preset> {
    [
        samples::SAMPLES,
        plane::PRESETS,
        samples::ITERATIONS,
        rotation::PRESETS,
        volume::PRESETS,
        variety::PRESETS,
        comparison::PRESETS,
        fine::PRESETS,
        graded::PRESETS,
    ]
    .into_iter()
    .flatten()
}

const fn degrees(angle: f32) -> f32 {
    angle.to_radians()
}

/// "Later iterations use α1 = 30°, α2 = 0 and h0 = 1": forks with straight children.
fn fork() -> Bend {
    Bend::piecewise(degrees(30.0), 0.0, 1)
}

/// Radii by the pipe model, tapered, for a trunk of this diameter in metres.
fn bark(trunk: f32) -> Taper<PipeModel> {
    Taper::new(PipeModel::default().with_exponent(2.4).with_trunk_diameter(trunk))
}

/// "The first iteration is used only to create a trunk (so α = 0)."
fn trunk(height: f32) -> StageRecipe {
    StageRecipe::new(Bend::none(), NearestTo::new(Vec3::Y * height))
}
