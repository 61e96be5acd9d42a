//! One level of a tree, piece by piece.

use crate::{Use, image, merged, mesh};
use bevy_image::Image;
use bevy_math::{Quat, Vec3};
use bevy_mesh::Mesh;
use bevy_transform::components::Transform;
use treesynth::asset::Asset;
use treesynth::surface::Part;

/// A mesh, its images and colours, and where it stands.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Its kind: `bark`, `leaves`, `cards`, `impostor`.
    pub name: String,
    /// The mesh once.
    pub mesh: Mesh,
    /// Places of the mesh; one place for bark. [`all`](Self::all) has them in one mesh.
    pub places: Vec<Transform>,
    /// All copies in one mesh, with the tint of each; nothing if there is one place, the root.
    pub all: Option<Mesh>,
    /// Linear red, green and blue, by which images are multiplied.
    pub color: [f32; 3],
    /// 0 (a mirror) to 1.
    pub roughness: f32,
    /// `true` if it is seen from behind, too.
    pub double_sided: bool,
    /// Alpha below which a pixel is not drawn.
    pub alpha_cutoff: Option<f32>,
    /// Its images.
    pub images: Images,
}

/// Images of a piece.
#[derive(Debug, Clone, Default)]
pub struct Images {
    /// Colour, sRGB, with alpha.
    pub base_color: Option<Image>,
    /// Normals in tangent space, +Y up as in glTF.
    pub normal: Option<Image>,
    /// Red: occlusion; green: roughness; blue: metallic.
    pub occlusion_roughness_metallic: Option<Image>,
}

/// The pieces of one level: bark, leaves, cards.
pub fn pieces(level: &Asset) -> Vec<Piece> {
    level.parts().iter().map(piece).collect()
}

fn piece(part: &Part<'_>) -> Piece {
    let (material, textures) = (part.material(), part.textures());
    let cutoff = textures.and_then(|textures| textures.alpha_cutoff());
    let images = textures.map_or_else(Images::default, |textures| Images {
        base_color: textures.base_color().map(|own| image(own, Use::Color(cutoff))),
        normal: textures.normal().map(|own| image(own, Use::Data)),
        occlusion_roughness_metallic: textures
            .occlusion_roughness_metallic()
            .map(|own| image(own, Use::Data)),
    });
    let copies = part.placed();
    let places = copies.iter().map(|copy| Transform {
        translation: Vec3::from_array(copy.position.to_array()),
        rotation: Quat::from_array(copy.rotation.to_array()),
        scale: Vec3::splat(copy.scale),
    });
    Piece {
        name: part.name().to_owned(),
        mesh: mesh(part.mesh()),
        places: places.collect(),
        all: part.instances().map(|_| merged(part.mesh(), &copies)),
        color: material.color(),
        roughness: material.roughness(),
        double_sided: material.is_double_sided(),
        alpha_cutoff: cutoff,
        images,
    }
}
