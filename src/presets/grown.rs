//! Trees that grow over the years by positional information: the figures of Galbraith, Mündermann and Wyvill 2004, and
//! seven more species.

use super::look::{self, Look};
use crate::ParameterError;
use crate::foliage::{Leaf, Leaves};
use crate::growth::{Architecture, Curve, Growth, TreeAtAge};
use crate::surface::Material;
use std::f32::consts::PI;

/// A tree of [`growth`](crate::growth) at the ages that its figure shows.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Grown {
    /// Its name, e.g. `growth-15-cottonwood`.
    pub name: &'static str,
    /// The number of the figure; 0 beyond the paper.
    pub figure: u8,
    /// One line that says what is seen.
    pub caption: &'static str,
    /// The ages of its pictures, years.
    pub ages: &'static [f32],
    /// The seed of its pictures.
    pub seed: u64,
    /// `true` if it lies in the plane z = 0, for a drawing.
    pub planar: bool,
    architecture: fn() -> Result<Architecture, ParameterError>,
    look: Look,
    leaf: fn() -> Leaf,
}

impl Grown {
    /// The species.
    ///
    /// # Errors
    /// None for the presets of this module.
    pub fn architecture(&self) -> Result<Architecture, ParameterError> {
        (self.architecture)()
    }

    /// The tree, to be had at any age.
    ///
    /// # Errors
    /// None for the presets of this module.
    pub fn grow(&self, seed: u64) -> Result<Growth, ParameterError> {
        Growth::new(self.architecture()?, seed)
    }

    /// Material of its bark.
    pub fn bark(&self) -> Material {
        self.look.bark()
    }

    /// Its bark as images, as [`Preset::bark_texture`](super::Preset::bark_texture).
    #[cfg(feature = "texture")]
    pub fn bark_texture(&self) -> crate::texture::Bark {
        self.look.bark_texture()
    }

    /// The leaf that hangs on its trees; their sizes and colours are the architecture's
    /// [`phenology`](Architecture::phenology).
    pub fn leaf(&self) -> Leaf {
        (self.leaf)()
    }

    /// The leaves that hang on a tree, one value per colour.
    pub fn leaves(&self, tree: &TreeAtAge) -> Vec<Leaves> {
        Leaves::grown(tree, &(self.leaf)())
    }

    const fn new(
        name: &'static str,
        figure: u8,
        caption: &'static str,
        ages: &'static [f32],
        architecture: fn() -> Result<Architecture, ParameterError>,
    ) -> Self {
        let leaf = || Leaf::deltoid().with_petiole(0.6);
        Self { name, figure, caption, ages, seed: 1, planar: false, architecture, look: look::POPLAR, leaf }
    }

    const fn planar(mut self) -> Self {
        self.planar = true;
        self
    }

    const fn like(mut self, look: Look, leaf: fn() -> Leaf) -> Self {
        (self.look, self.leaf) = (look, leaf);
        self
    }
}

/// All presets of [`growth`](crate::growth): those of the figures, then other species.
pub fn grown() -> impl Iterator<Item = &'static Grown> {
    GROWN.iter()
}

/// Ages of a tree that is drawn in lines: the end of a year, when shoots are done.
const DRAWN: &[f32] = &[4.0, 8.0, 14.0, 20.0, 27.0];

const SPECIES_OF_30: &[f32] = &[4.6, 12.6, 29.6];
const SPECIES_OF_40: &[f32] = &[6.6, 16.6, 39.6];

const GROWN: &[Grown] = &[
    Grown::new(
        "growth-08-lengths",
        8,
        "Each year's growth in turn blue and red, the new one green.",
        DRAWN,
        lengths,
    )
    .planar(),
    Grown::new("growth-09-headings", 9, "Short branches turn up, long ones get an S.", DRAWN, headings)
        .planar(),
    Grown::new("growth-10-scale", 10, "An exaggerated scale factor.", DRAWN, scales).planar(),
    Grown::new(
        "growth-11-loss",
        11,
        "Short branches are lost, but for the young near the top.",
        DRAWN,
        losses,
    )
    .planar(),
    Grown::new(
        "growth-12-shoot",
        12,
        "The second shoot of a seedling unfolds.",
        &[1.33, 1.38, 1.42, 1.46, 1.5, 1.6],
        shoot,
    ),
    Grown::new(
        "growth-13-foliage",
        13,
        "Leaves come, turn and fall in one year.",
        &[8.2, 8.34, 8.42, 8.6, 8.78, 8.82, 8.86, 9.0],
        foliage,
    ),
    Grown::new(
        "growth-15-cottonwood",
        15,
        "An Eastern cottonwood of 27 years, from a broom stick to a rounded crown.",
        &[2.6, 5.6, 10.6, 18.6, 26.6],
        || Ok(Architecture::cottonwood()),
    ),
    Grown::new("growth-spruce", 0, "A spruce: one trunk to the top, a slender cone.", SPECIES_OF_40, || {
        Ok(Architecture::spruce())
    })
    .like(look::SPRUCE, Leaf::needles),
    Grown::new("growth-lombardy-poplar", 0, "A Lombardy poplar: a column.", SPECIES_OF_30, || {
        Ok(Architecture::lombardy_poplar())
    }),
    Grown::new("growth-weeping-birch", 0, "A birch whose twigs hang.", SPECIES_OF_30, || {
        Ok(Architecture::weeping_birch())
    })
    .like(look::BIRCH, || Leaf::deltoid().with_petiole(0.4)),
    Grown::new("growth-spreading-oak", 0, "An oak in the open, wider than high.", SPECIES_OF_40, || {
        Ok(Architecture::spreading_oak())
    })
    .like(look::OAK, Leaf::sinuate),
    Grown::new("growth-norway-maple", 0, "A Norway maple: opposite, forked, round.", SPECIES_OF_40, || {
        Ok(Architecture::norway_maple())
    })
    .like(look::MAPLE, || Leaf::lobed().with_petiole(0.7)),
    Grown::new(
        "growth-european-ash",
        0,
        "An ash: opposite, open, shoots that turn up.",
        SPECIES_OF_40,
        || Ok(Architecture::european_ash()),
    )
    .like(look::ASH, || Leaf::pinnate().with_petiole(0.15)),
    Grown::new(
        "growth-horse-chestnut",
        0,
        "A horse chestnut: limbs rise, dip and turn up, shoots that flower fork.",
        SPECIES_OF_40,
        || Ok(Architecture::horse_chestnut()),
    )
    .like(look::CHESTNUT, || Leaf::palmate().with_petiole(0.7)),
];

/// Figure 12: a shoot alone.
fn shoot() -> Result<Architecture, ParameterError> {
    Ok(foliage()?.with_most_order(0))
}

/// Figure 13: vigorous shoots of many metamers, whose leaves unfold one after another.
fn foliage() -> Result<Architecture, ParameterError> {
    let metamers = Curve::new([[0.0, 2.0], [0.1, 6.0], [0.3, 11.0], [1.0, 24.0]])?;
    Ok(Architecture::cottonwood().with_metamers(metamers))
}

/// Figure 8: two branches per year in one plane, straight, none scaled, none lost.
fn lengths() -> Result<Architecture, ParameterError> {
    Ok(Architecture::cottonwood()
        .with_most_order(1)
        .with_divergence(PI)
        .with_variation(0.0)
        .with_scale_variation(0.0)
        .with_tropism(0.0)
        .with_least_scale(0.5)
        .with_metamers(Curve::constant(6.0)?)
        .with_shoot_scale(Curve::new([[0.0, 0.0], [0.7, 0.0], [0.8, 1.0], [1.0, 1.0]])?)
        .with_short_heading(Curve::constant(0.0)?)
        .with_long_heading(Curve::constant(0.0)?)
        .with_branching_angle(Curve::constant(0.9)?)
        .with_branch_scale(Curve::constant(1.0)?)
        .with_lifespan(Curve::constant(1e4)?))
}

/// Figure 9: the same with headings, those of long branches exaggerated for the eye.
fn headings() -> Result<Architecture, ParameterError> {
    let degrees =
        |points: [[f32; 2]; 4]| Curve::new(points.map(|[place, angle]| [place, angle.to_radians()]));
    Ok(lengths()?
        .with_short_heading(degrees([[0.0, 0.0], [0.4, 10.0], [0.8, 28.0], [1.0, 34.0]])?)
        .with_long_heading(degrees([[0.0, -4.0], [0.3, -28.0], [0.6, -22.0], [1.0, 36.0]])?))
}

/// Figure 10: branches by turns long and short.
fn scales() -> Result<Architecture, ParameterError> {
    let wave = (0..=16).map(|i| [i as f32 / 16.0, if i % 2 == 0 { 1.0 } else { 0.3 }]);
    Ok(headings()?.with_least_scale(0.0).with_branch_scale(Curve::new(wave)?))
}

/// Figure 11: the short ones of figure 10 are lost by the age of seven, the long ones stay.
fn losses() -> Result<Architecture, ParameterError> {
    Ok(scales()?.with_lifespan(Curve::new([[0.0, 3.0], [0.6, 7.0], [0.8, 60.0]])?))
}
