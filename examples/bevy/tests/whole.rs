//! A species' tree comes over whole: every vertex, index, image and place.

use bevy_mesh::{Mesh, VertexAttributeValues};
use treesynth::asset::Asset;
use treesynth::species;
use treesynth_bevy::{Piece, WIND_LIMB, WIND_LIMB_AXIS, WIND_TRUNK, WIND_TWIG, WIND_TWIG_AXIS, pieces};

fn levels() -> Vec<Asset> {
    let birch =
        species::by_name("silver birch").unwrap().request().with_height(4.0).with_seed(3).grow().unwrap();
    birch.levels_in_wind(Some(3_000), 128, &[1.0, 0.3]).unwrap()
}

fn three(mesh: &Mesh, attribute: bevy_mesh::MeshVertexAttribute) -> Vec<[f32; 3]> {
    let Some(VertexAttributeValues::Float32x3(values)) = mesh.attribute(attribute) else {
        panic!("{attribute:?}")
    };
    values.clone()
}

fn four(mesh: &Mesh, attribute: bevy_mesh::MeshVertexAttribute) -> Vec<[f32; 4]> {
    let Some(VertexAttributeValues::Float32x4(values)) = mesh.attribute(attribute) else {
        panic!("{attribute:?}")
    };
    values.clone()
}

#[test]
fn every_attribute_of_every_vertex_comes_over() {
    for level in levels() {
        let parts = level.parts();
        let pieces = pieces(&level);
        assert_eq!(parts.len(), pieces.len());
        for (part, piece) in parts.iter().zip(&pieces) {
            let (own, mesh) = (part.mesh(), &piece.mesh);
            assert_eq!(piece.name, part.name());
            assert_eq!(
                three(mesh, Mesh::ATTRIBUTE_POSITION),
                own.positions.iter().map(|v| v.to_array()).collect::<Vec<_>>()
            );
            assert_eq!(
                three(mesh, Mesh::ATTRIBUTE_NORMAL),
                own.normals.iter().map(|v| v.to_array()).collect::<Vec<_>>()
            );
            let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else {
                panic!()
            };
            assert_eq!(*uvs, own.uvs.iter().map(|v| v.to_array()).collect::<Vec<_>>());
            // Pieces without an image of normals have none.
            assert_eq!(mesh.attribute(Mesh::ATTRIBUTE_TANGENT).is_some(), !own.tangents.is_empty());
            if !own.tangents.is_empty() {
                assert_eq!(
                    four(mesh, Mesh::ATTRIBUTE_TANGENT),
                    own.tangents.iter().map(|v| v.to_array()).collect::<Vec<_>>()
                );
            }
            assert_eq!(mesh.attribute(Mesh::ATTRIBUTE_COLOR).is_some(), !own.colors.is_empty());
            let indices: Vec<u32> = mesh.indices().unwrap().iter().map(|index| index as u32).collect();
            assert_eq!(indices, own.indices);
            assert!(!own.wind.is_empty(), "{}", part.name());
            for (number, attribute) in [WIND_TRUNK, WIND_LIMB, WIND_TWIG].into_iter().enumerate() {
                let moments = four(mesh, attribute);
                for (wind, [x, y, z, w]) in own.wind.iter().zip(moments) {
                    assert_eq!(wind.moments[number].to_array(), [x, y, z]);
                    assert!(w.to_bits() == if number == 0 { wind.flutter } else { 0.0 }.to_bits());
                }
            }
            for (number, attribute) in [WIND_LIMB_AXIS, WIND_TWIG_AXIS].into_iter().enumerate() {
                for (wind, [x, y, z, _]) in own.wind.iter().zip(four(mesh, attribute)) {
                    assert_eq!(wind.axes[number].to_array(), [x, y, z]);
                }
            }
        }
    }
}

#[test]
fn all_copies_stand_where_they_stood() {
    let tree = species::by_name("hazel").unwrap().request().with_height(2.0).grow().unwrap();
    // Without a budget each leaf is a copy; within one, copies are merged into few meshes.
    let level = &tree.levels(None, 128, &[1.0]).unwrap()[0];
    let mut copied = 0;
    for (part, piece) in level.parts().iter().zip(pieces(level)) {
        assert_eq!(piece.places.len(), part.copies().len());
        let Some(all) = &piece.all else { continue };
        copied += piece.places.len();
        let (once, many) =
            (three(&piece.mesh, Mesh::ATTRIBUTE_POSITION), three(all, Mesh::ATTRIBUTE_POSITION));
        assert_eq!(many.len(), once.len() * piece.places.len());
        for (place, copy) in piece.places.iter().zip(many.chunks(once.len())) {
            for (point, moved) in once.iter().zip(copy) {
                let off = place.transform_point((*point).into()) - bevy_math::Vec3::from_array(*moved);
                assert!(off.length() < 1e-4, "{off}");
            }
        }
        assert_eq!(all.indices().unwrap().len(), part.mesh().indices.len() * piece.places.len());
    }
    assert!(copied > 100, "{copied} leaves and cards");
}

#[test]
fn images_have_all_their_sizes_and_keep_their_colors() {
    let level = &levels()[0];
    for (part, piece) in level.parts().iter().zip(pieces(level)) {
        let Piece { images, alpha_cutoff, .. } = &piece;
        let own = part.textures().unwrap();
        assert_eq!(own.alpha_cutoff(), *alpha_cutoff);
        let pairs = [
            (own.base_color(), &images.base_color, true),
            (own.normal(), &images.normal, false),
            (own.occlusion_roughness_metallic(), &images.occlusion_roughness_metallic, false),
        ];
        for (own, image, srgb) in pairs {
            assert_eq!(own.is_some(), image.is_some(), "{}", part.name());
            let (Some(own), Some(image)) = (own, image) else { continue };
            let descriptor = &image.texture_descriptor;
            assert_eq!((descriptor.size.width, descriptor.size.height), (own.width(), own.height()));
            assert_eq!(descriptor.format.is_srgb(), srgb);
            // A chain down to one pixel, four bytes each.
            assert_eq!(descriptor.mip_level_count, own.width().max(own.height()).ilog2() + 1);
            let pixels: u32 = (0..descriptor.mip_level_count)
                .map(|level| (own.width() >> level).max(1) * (own.height() >> level).max(1))
                .sum();
            let data = image.data.as_ref().unwrap();
            assert_eq!(data.len() as u32, pixels * 4);
            let channels = usize::from(own.channels());
            if channels >= 3 {
                for (own, pixel) in own.bytes().chunks_exact(channels).zip(data.chunks_exact(4)) {
                    assert_eq!(own[..3], pixel[..3]);
                }
            }
        }
    }
}

#[cfg(feature = "pbr")]
#[test]
fn levels_follow_each_other_without_a_gap() {
    let levels = levels();
    let ranges = treesynth_bevy::ranges(&levels, 4.0, 1080.0, 0.8);
    assert_eq!(ranges.len(), levels.len());
    assert!(ranges[0].start_margin.end <= 0.0 && ranges[1].start_margin.start > 1.0);
    for pair in ranges.windows(2) {
        assert_eq!(pair[0].end_margin, pair[1].start_margin);
    }
}
