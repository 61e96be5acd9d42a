//! Bark of thin wood, which wears images of its own.
//!
//! Old bark and young meet at forks alone: a lateral is young from its base on if its first internode is
//! thinner than the stated radius; a branch that becomes thinner on its way changes at the next fork. All
//! laterals of a young branch are young. No fork therefore leads back to old bark, and levels of detail agree
//! about every internode.

use super::Piece;
use super::light::in_bytes;
use crate::Skeleton;
use crate::surface::{Instance, Material};
use crate::texture::{Image, Textures};
use std::f32::consts::TAU;
use std::sync::Arc;

/// The greatest part of the thickest radius that counts as thin, so that small trees have a trunk too.
const THIN: f32 = 0.4;
/// Radii, as multiples of that at which thick wood changes to thin, beyond which wood has its own mean
/// colour: on thick wood, and on thin.
const FADES: (f32, f32) = (2.0, 0.4);
/// Means that differ by less are the same.
const SAME: f32 = 0.004;

/// The images of thin wood, and the radius below which wood is thin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Young {
    pub(super) textures: Arc<Textures>,
    /// The side of the tile, metres.
    pub(super) tile: f32,
    /// Wood thinner than this wears them, metres.
    pub(super) radius: f32,
}

impl Young {
    /// The radius below which wood of this tree is thin.
    fn radius_of(&self, skeleton: &Skeleton) -> f32 {
        let thickest = skeleton.radii().iter().copied().fold(0.0, f32::max);
        self.radius.min(THIN * thickest)
    }

    /// Takes thin wood out of a piece of bark whose vertices have wind, which names their nodes. The
    /// triangles of both are those that there were.
    pub(super) fn split(&self, old: &mut Piece, skeleton: &Skeleton, has_sections: bool) -> Piece {
        let change = self.radius_of(skeleton);
        let thin = Thin::of(skeleton, change);
        let mesh = &old.mesh;
        let mut owners = Vec::with_capacity(mesh.triangles().len());
        let mut around = vec![0.0f32; thin.firsts.len()];
        for corners in mesh.triangles() {
            let node = |corner: u32| mesh.wind[corner as usize].node as usize;
            // The base of a collar moves with the parent branch, but belongs to the branch it bears.
            let owner = corners.map(|corner| thin.branches[node(corner)]).into_iter().fold(0, u32::max);
            let is_thin = corners.iter().any(|&corner| {
                let node = node(corner);
                thin.branches[node] == owner && thin.nodes[node]
            });
            let most = corners.iter().map(|&corner| mesh.uvs[corner as usize].x).fold(0.0, f32::max);
            if is_thin || !has_sections {
                around[owner as usize] = around[owner as usize].max(most);
            }
            owners.push((owner, is_thin));
        }
        let of = |wanted: bool| {
            let mut all = owners.iter();
            mesh.selected(|_| all.next().is_some_and(|&(_, is_thin)| is_thin == wanted))
        };
        let ((rest, _), (mut mesh, _)) = (of(false), of(true));
        // A whole number of tiles around each branch, as wide as they are made for.
        let mut owner_of = vec![0; mesh.positions.len()];
        let thin_ones = owners.iter().filter(|(_, is_thin)| *is_thin);
        for (corners, (owner, _)) in mesh.indices.chunks_exact(3).zip(thin_ones) {
            for &corner in corners {
                owner_of[corner as usize] = *owner as usize;
            }
        }
        for (uv, &owner) in mesh.uvs.iter_mut().zip(&owner_of) {
            let tiles = around[owner].round().max(1.0);
            let factor = (TAU * thin.firsts[owner] / self.tile).round().max(1.0) / tiles;
            // If the number changes along a branch, it stays whole only if it is multiplied by a whole
            // number.
            *uv *= if has_sections { factor.round().max(1.0) } else { factor };
        }
        old.mesh = rest;
        let mut young = Piece {
            name: "young bark",
            mesh,
            material: old.material,
            textures: Some(Arc::clone(&self.textures)),
            instances: vec![Instance::IDENTITY],
            bent: None,
        };
        fade(old, &mut young, skeleton.radii(), change);
        young
    }

    /// The colour of wood on cards, by which that of its material is multiplied.
    pub(super) fn mean_color(&self) -> [f32; 3] {
        self.textures.base_color().map_or([1.0; 3], Image::mean_color)
    }
}

/// The wood that is thin.
struct Thin {
    /// For each node, `true` if its internode is thin.
    nodes: Vec<bool>,
    /// The branch that each node's internode belongs to.
    branches: Vec<u32>,
    /// For each branch the radius where it begins to be thin, metres.
    firsts: Vec<f32>,
}

impl Thin {
    fn of(skeleton: &Skeleton, radius: f32) -> Self {
        let mut children = vec![0u32; skeleton.len()];
        skeleton.edges().for_each(|(_, parent)| children[parent] += 1);
        let all = skeleton.branches();
        let mut thin = Self {
            nodes: vec![false; skeleton.len()],
            branches: vec![0; skeleton.len()],
            firsts: Vec::with_capacity(all.len()),
        };
        for (number, branch) in all.iter().enumerate() {
            let nodes = branch.nodes();
            let radius_of = |i: usize| skeleton.radii()[nodes[i] as usize];
            let is_lateral = number > 0;
            let mut begun =
                is_lateral && nodes.len() > 1 && (thin.nodes[nodes[0] as usize] || radius_of(1) < radius);
            let mut first = if begun { radius_of(1) } else { 0.0 };
            for (i, &node) in nodes.iter().enumerate().skip(1) {
                let node = node as usize;
                thin.branches[node] = number as u32;
                thin.nodes[node] = begun;
                if !begun && radius_of(i) < radius && children[node] > 1 {
                    (begun, first) = (true, radius_of(i));
                }
            }
            thin.firsts.push(first);
        }
        thin
    }
}

/// Brings the mean colours of both barks to one where they meet, by vertex colours; nothing if they are the same.
fn fade(old: &mut Piece, young: &mut Piece, radii: &[f32], change: f32) {
    let mean = |piece: &Piece| {
        let image = piece.textures.as_ref().and_then(|textures| textures.base_color());
        image.map_or([1.0; 3], Image::mean_color)
    };
    let means = [mean(old), mean(young)];
    let meeting: [f32; 3] = std::array::from_fn(|i| means[0][i].min(means[1][i]));
    let far = |piece: usize| (0..3).any(|i| means[piece][i] - meeting[i] > SAME);
    for (number, piece) in [old, young].into_iter().enumerate() {
        if !far(number) {
            continue;
        }
        let at_change: [f32; 3] = std::array::from_fn(|i| meeting[i] / means[number][i].max(1e-6));
        let own = |node: u32| {
            let part = radii[node as usize] / change.max(f32::MIN_POSITIVE);
            let end = if number == 0 { FADES.0 } else { FADES.1 };
            let t = ((part - 1.0) / (end - 1.0)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        let color = |node: u32| at_change.map(|factor| factor + (1.0 - factor) * own(node));
        let mesh = &mut piece.mesh;
        // There may be the crown's shade already.
        mesh.colors.resize(mesh.wind.len(), [1.0; 3]);
        for (shade, wind) in mesh.colors.iter_mut().zip(&mesh.wind) {
            let own = color(wind.node);
            *shade = std::array::from_fn(|i| shade[i] * own[i]);
        }
        in_bytes(&mut mesh.colors);
    }
}

/// Material of thin wood on cards.
pub(super) fn on_cards(young: &Young, bark: Material) -> Material {
    let (own, mean) = (bark.color(), young.mean_color());
    bark.with_color([own[0] * mean[0], own[1] * mean[1], own[2] * mean[2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::{Asset, AssetBuilder};
    use crate::presets;
    use crate::surface::{Mesh, Part, Tubes, Wind};
    use glam::Vec2;

    fn assets(check: impl Fn(&str, &Skeleton, &Asset, &Asset)) {
        for (name, nodes) in [("figure-06b", 2000), ("figure-18", 3000), ("fine-oak", 3000)] {
            let preset = presets::by_name(name).expect("a preset").guided().expect("guided");
            for seed in 0..2 {
                let tree = preset.synth(nodes).synthesize(seed).expect("a tree");
                let tubes = Tubes::default().with_square_tiles(true).with_tile(0.5);
                let bark = preset.bark_texture().with_resolution(64);
                for triangles in [None, Some(4_000)] {
                    let plain = AssetBuilder::default().with_triangles(triangles).with_tubes(tubes.clone());
                    // The same tubes: with even texels rings come twice.
                    let young =
                        plain.clone().with_bark_of(&bark).expect("in range").with_tubes(tubes.clone());
                    let of = |builder: &AssetBuilder| builder.build(&tree, 1).expect("a budget for a trunk");
                    check(name, &tree, &of(&plain), &of(&young));
                }
            }
        }
    }

    #[test]
    fn it_costs_no_triangles_and_moves_none() {
        assets(|name, _, plain, split| {
            let young = split.young_bark().expect("young bark");
            assert_eq!(plain.triangles(), split.triangles(), "{name}");
            assert!(!split.bark().is_empty() && !young.is_empty(), "{name}");
            let area = f64::from(split.bark().area()) + f64::from(young.area());
            assert!((area / f64::from(plain.bark().area()) - 1.0).abs() < 1e-3, "{name}");
            for mesh in [split.bark(), young] {
                mesh.check().expect("sound");
                assert!(mesh.wind.is_empty(), "nobody asked for wind");
            }
            assert!(split.parts().iter().map(Part::name).any(|name| name == "young bark"));
        });
    }

    #[test]
    fn tiles_around_young_wood_are_whole() {
        assets(|name, _, _, split| {
            let mesh = split.young_bark().expect("young bark");
            // Two vertices are in one place where a ring closes, and their u differs by a whole number.
            let mut all: Vec<([u32; 3], Vec2)> = mesh
                .positions
                .iter()
                .zip(&mesh.uvs)
                .map(|(p, uv)| (p.to_array().map(f32::to_bits), *uv))
                .collect();
            all.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)));
            let mut closed = 0;
            for pair in all
                .windows(2)
                .filter(|pair| pair[0].0 == pair[1].0 && pair[0].1.y.to_bits() == pair[1].1.y.to_bits())
            {
                let around = pair[1].1.x - pair[0].1.x;
                assert!((around - around.round()).abs() < 1e-3, "{name}: {around} tiles");
                closed += usize::from(around > 0.5);
            }
            assert!(closed > 20, "{name}: {closed} rings");
        });
    }

    #[test]
    fn bark_changes_at_forks_alone_and_means_meet() {
        assets(|name, tree, _, _| {
            let thickest = tree.radii().iter().copied().fold(0.0, f32::max);
            let thin = Thin::of(tree, AssetBuilder::THIN.min(THIN * thickest));
            let mut children = vec![0; tree.len()];
            tree.edges().for_each(|(_, parent)| children[parent] += 1);
            for (node, parent) in tree.edges().filter(|(_, parent)| *parent > 0) {
                assert!(thin.nodes[node] || !thin.nodes[parent], "{name}: bark does not grow old again");
                let changes = thin.nodes[node] != thin.nodes[parent];
                assert!(!changes || children[parent] > 1, "{name}: node {node} changes at no fork");
            }
            assert!(
                thin.nodes.iter().any(|thin| *thin) && thin.nodes[1..].iter().any(|thin| !thin),
                "{name}"
            );
        });
        // Old and young bark of different colours are of one colour where they meet.
        let set = |srgb| {
            let bark = crate::texture::Bark::oak().with_color(srgb).with_resolution(32);
            bark.bake().expect("in range").textures
        };
        let piece = |textures: Textures, node: u32| {
            let wind = vec![Wind { node, ..Wind::default() }];
            let mesh = Mesh { wind, ..Mesh::default() };
            let instances = vec![Instance::IDENTITY];
            Piece {
                name: "bark",
                mesh,
                material: Material::white(),
                textures: Some(Arc::new(textures)),
                instances,
                bent: None,
            }
        };
        let (mut old, mut young) = (piece(set([120, 90, 60]), 0), piece(set([90, 100, 60]), 1));
        let mean = |piece: &Piece| {
            let own = piece.textures.as_ref().and_then(|textures| textures.base_color()).expect("colours");
            let factor = piece.mesh.colors.first().copied().unwrap_or([1.0; 3]);
            let mean = own.mean_color();
            [0, 1, 2].map(|i| mean[i] * factor[i])
        };
        fade(&mut old, &mut young, &[0.03, 0.03], 0.03);
        for (a, b) in mean(&old).into_iter().zip(mean(&young)) {
            assert!((a - b).abs() < 0.004, "{a} and {b}");
        }
        // Far from there each has its own; what was there before is kept as a factor.
        old.mesh.colors = vec![[0.6; 3]];
        young.mesh.colors = vec![[0.6; 3]];
        fade(&mut old, &mut young, &[0.06, 0.012], 0.03);
        assert!(
            old.mesh.colors[0].iter().chain(&young.mesh.colors[0]).all(|&factor| (factor - 0.6).abs() < 1e-5)
        );
    }
}
