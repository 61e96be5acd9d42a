//! Trees in their places.

use super::{Part, Transform};
use crate::ParameterError;

/// Trees, or whatever else is made of parts, each in its place.
///
/// The same tree may stand in many places: formats with instances have each of its meshes and images once
/// ([`write_glb_scene`](crate::export::write_glb_scene), [`write_usda`](crate::export::write_usda)). For everything
/// else [`parts`](Self::parts) gives a list of parts that are in their places.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::surface::{Mesh, Part, Scene, Transform};
///
/// let trunk = Mesh::default();
/// let tree = [Part::new(&trunk)];
/// let mut stand = Scene::default();
/// for i in 0..3 {
///     stand = stand.with_asset("ash", &tree, Transform::at(Vec3::X * (4.0 * i as f32)));
/// }
/// assert_eq!(stand.parts()[2].transform().position.x, 8.0);
/// ```
#[must_use]
#[derive(Debug, Clone, Default)]
pub struct Scene<'a> {
    assets: Vec<PlacedAsset<'a>>,
}

/// Parts that stand together in one place of a [`Scene`].
#[derive(Debug, Clone, Copy)]
pub struct PlacedAsset<'a> {
    name: &'a str,
    parts: &'a [Part<'a>],
    transform: Transform,
}

impl<'a> Scene<'a> {
    /// Adds a tree in its place. Names are for readers of the files; they need not differ.
    pub fn with_asset(mut self, name: &'a str, parts: &'a [Part<'a>], transform: Transform) -> Self {
        self.assets.push(PlacedAsset { name, parts, transform });
        self
    }

    /// Contents, in the order in which they were added.
    pub fn assets(&self) -> &[PlacedAsset<'a>] {
        &self.assets
    }

    /// All parts of all assets, each with the transform that brings it to its place.
    pub fn parts(&self) -> Vec<Part<'a>> {
        let placed = |asset: &PlacedAsset<'a>| {
            let transform = asset.transform;
            asset.parts.iter().map(move |part| part.with_transform(transform.after(&part.transform())))
        };
        self.assets.iter().flat_map(placed).collect()
    }
}

impl<'a> PlacedAsset<'a> {
    /// Name in files.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Its parts, where they are without the transform.
    pub fn parts(&self) -> &'a [Part<'a>] {
        self.parts
    }

    /// Its transform.
    pub fn transform(&self) -> Transform {
        self.transform
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        self.transform.check("Scene.transform")
    }
}
