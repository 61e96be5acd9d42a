//! Grows botanical trees: the branching structure first, then its thickness, surface, files and pictures.
//!
//! Engine-free, and deterministic to the bit: the same seed gives the same tree on every platform, at every thread
//! count and with every feature set.
#![doc = concat!(
    "<img alt=\"Six kinds of trees\" src=\"data:image/png;base64,",
    include_str!("../docs/figures/overview.base64"),
    "\">"
)]
//!
//! # The way through
//!
//! [`shape`] and [`field`] say where a tree may grow and what pulls on it; [`guided`], [`variational`],
//! [`self_organizing`] and [`growth`] grow it; the result is a [`Skeleton`]; [`radius`] makes it thick,
//! [`metrics`] measures it, [`surface`] makes triangles of it, [`foliage`] puts leaves on it, [`export`]
//! writes files, and [`preview`](https://docs.rs/treesynth/latest/treesynth/preview/) draws pictures.
//! [`presets`] has the trees of the papers' figures and more, ready made, and [`species`] grows trees by
//! name.
//!
//! Measured trees: [`cloud`] reads points, [`reconstruct`] makes a skeleton of them, [`mod@format`] reads and
//! writes skeletons as plant scientists have them, and [`scan`] makes clouds whose truth is known.
//!
//! ```
//! use treesynth::{Metrics, presets, surface::Tubes};
//!
//! let elm = presets::by_name("figure-07")?.guided()?;
//! let tree = elm.synth(10_000).synthesize(42)?;
//! let mesh = Tubes::default().mesh(&tree)?;
//! println!("{} triangles, {:.1} m tall", mesh.triangles().len(), Metrics::of(&tree).height);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: metres, radians, +Y is up, right-handed, the root at the origin unless it is planted
//! elsewhere. Options are structs with `with_*` methods; they are checked where work starts (curves at once),
//! and a wrong value is returned as an error that names the parameter, its value and its range. Bad input
//! never causes a panic, except the number of a node that does not exist in methods that say so. The library
//! never prints.
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `parallel` | graphs are built, forests grow, shapes are filled, closed surfaces and pictures made on rayon's threads; same bits |
//! | `serde` | skeletons, metrics, forests, species, options and recipes with serde |
//! | `json` | skeletons as JSON text, `export::json`, and recipes; implies `serde` |
//! | `mint` | `From` and `Into` between [`glam`]'s vectors and `mint`'s, for users on another glam version |
//! | `texture` | images that surfaces wear, `texture`; trees within a budget, levels in leaf, impostors, `asset` |
//! | `jpeg` | JPEG for images without alpha in glTF files; implies `texture` |
//! | `preview` | shaded PNG pictures without a GPU, `preview`; implies `texture` |
//! | `import` | meshes from OBJ, STL, PLY and glTF files, outlines from SVG drawings and path data, as shapes |
//! | `lidar` | point clouds of laser scanners, LAS, LAZ and E57: [`cloud`] |
//! | `parquet` | inventories of landscapes as Apache Parquet: `export::parquet` |
//! | `testing` | proptest strategies and contract checks for strategies of your own, `testing` |
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "texture")]
pub mod asset;
pub mod cloud;
pub mod export;
pub mod field;
pub mod foliage;
pub mod format;
pub mod growth;
pub mod guided;
pub mod math;
pub mod metrics;
mod nearest;
mod observer;
mod parallel;
mod parameter;
mod ply;
pub mod presets;
#[cfg(feature = "preview")]
pub mod preview;
pub mod radius;
pub mod random;
mod recipe;
pub mod reconstruct;
pub mod scan;
pub mod self_organizing;
pub mod shape;
pub mod skeleton;
pub mod species;
pub mod surface;
#[cfg(feature = "testing")]
pub mod testing;
mod text;
#[cfg(feature = "texture")]
pub mod texture;
pub mod variational;

pub use field::VectorField;
pub use glam;
pub use guided::{EndpointPolicy, GraphBuilder, GuidingRule, SynthesisError, TreeSynth, WeightFn};
pub use metrics::Metrics;
#[cfg(feature = "mint")]
pub use mint;
pub use observer::{Observer, Progress, Silent, Work};
pub use parameter::ParameterError;
pub use radius::{RadiusError, RadiusModel};
pub use rand;
pub use self_organizing::{Forest, SelfOrganizing};
pub use shape::{Bounds, Shape};
pub use skeleton::{Skeleton, SkeletonError};

/// The code blocks of the README and of the guide are tests.
#[cfg(doctest)]
mod guide {
    macro_rules! pages {
        ($($name:ident: $file:literal),* $(,)?) => {
            $(#[doc = include_str!(concat!("../", $file))] struct $name;)*
        };
    }
    pages! {
        Readme: "README.md",
        Start: "docs/guide/start.md",
        Systems: "docs/guide/systems.md",
        Guided: "docs/guide/guided.md",
        Forests: "docs/guide/forests.md",
        Shapes: "docs/guide/shapes.md",
        Years: "docs/guide/years.md",
        Assets: "docs/guide/assets.md",
    }
}
