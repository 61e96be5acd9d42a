//! Previews: trees that are soon there rather than fine, for while a slider moves.
//!
//! A preview has fewer, larger shoots and leaves than the tree itself, tubes of few triangles and no images, and is no file: its arrays
//! go to the page as they are. Limbs and outline are those of the tree.

use crate::ask::Ask;
use crate::tree::requested;
use std::ops::RangeInclusive;
use std::sync::{Mutex, PoisonError};
use treesynth::foliage::{Leaf, Leaves};
use treesynth::glam::{Vec2, Vec3};
use treesynth::math;
use treesynth::species::{Species, SpeciesError, Specimen};
use treesynth::surface::{Instance, Material, Mesh, Tubes};

/// Nodes that previews may have.
pub const NODES: RangeInclusive<usize> = 1_000..=20_000;
/// Leaves of a preview at the most, if this is more than half of its nodes: larger ones would not look like leaves.
const LEAVES: usize = 3_000;
/// Triangles of a leaf of a preview at the most.
const TRIANGLES: usize = 4;
/// Error of a preview's tubes, as a share of the tree's height: a pixel or two of the page.
const ERROR: f32 = 0.002;
/// Powers of the factor of thinning by which shoots, twigs and branches stand farther apart: together 1.
const THINNING: [f32; 3] = [0.5, 0.3, 0.2];

/// Tubes of few triangles for a tree of some height, metres.
pub fn tubes(height: f32) -> Tubes {
    Tubes::default().with_error((ERROR * height).max(1e-4)).with_collars(false).with_root_flare(0.0)
}

/// Nodes of the last preview over those that it was thinned to, and its species: the next one is thinned the more.
static LAST: Mutex<(String, f32)> = Mutex::new((String::new(), 1.0));

/// The tree of a species with about the nodes that are asked for, or fewer.
pub fn grow(ask: &Ask, species: &Species) -> Result<Specimen, SpeciesError> {
    let area = requested(ask, species).plan()?.leaf_area;
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if last.0 != species.name {
        *last = (species.name.clone(), 1.0);
    }
    let factor = (last.1 * nodes(species, area) / ask.preview as f32).max(1.0);
    let tree = requested(ask, &sparse(species, factor)).grow()?;
    if factor > 1.0 {
        last.1 = (last.1 * tree.skeleton.len() as f32 / ask.preview as f32).clamp(0.1, 10.0);
    }
    Ok(tree)
}

/// Nodes that the tree would have, about: a shoot bears some leaves, and needs some nodes.
fn nodes(species: &Species, area: f32) -> f32 {
    let data = &species.leaves;
    let leaves = area / (0.35 * data.length * data.length).max(1e-9);
    let shoot = species.shoots.length.min(data.reach) / data.spacing.max(1e-3) + 1.0;
    3.0 * leaves / shoot
}

/// The species with about `1 / factor` of the shoots and leaves: these are larger instead, for the same leaf area.
fn sparse(species: &Species, factor: f32) -> Species {
    let mut sparse = species.clone();
    let [shoots, twigs, branches] = THINNING.map(|power| math::powf(factor, power));
    sparse.leaves.length *= factor.sqrt();
    sparse.shoots.spacing *= shoots;
    sparse.twigs.spacing *= twigs;
    sparse.branches.spacing *= branches;
    sparse
}

/// A mesh of a preview, once or as copies.
pub struct Piece {
    mesh: Mesh,
    material: Material,
    copies: Option<Vec<Instance>>,
}

impl Piece {
    pub fn triangles(&self) -> u64 {
        (self.mesh.triangles().len() * self.copies.as_ref().map_or(1, Vec::len)) as u64
    }
}

/// The meshes of a preview of at most this number of nodes.
pub fn pieces<'a>(
    nodes: usize,
    bark: Mesh,
    material: Material,
    leaves: impl Iterator<Item = &'a Leaves>,
) -> Vec<Piece> {
    let all: Vec<&Leaves> = leaves.collect();
    let count: usize = all.iter().map(|leaves| leaves.instances.len()).sum();
    let step = count.div_ceil(LEAVES.max(nodes / 2)).max(1);
    let bark = Piece { mesh: bark, material, copies: None };
    let leaves = all.into_iter().map(|leaves| few(leaves, step)).filter(|leaves| leaves.triangles() > 0);
    [bark].into_iter().chain(leaves).collect()
}

/// Each `step`th leaf, of few triangles, larger so that all have the same area as before.
fn few(leaves: &Leaves, step: usize) -> Piece {
    let mut copies: Vec<Instance> = leaves.instances.iter().step_by(step).copied().collect();
    let larger = (leaves.instances.len() as f32 / copies.len().max(1) as f32).sqrt();
    copies.iter_mut().for_each(|leaf| leaf.scale *= larger);
    Piece { mesh: simple(&leaves.leaf), material: leaves.leaf.material(), copies: Some(copies) }
}

/// The leaf itself, or two blades that cross, as long and of the same area.
fn simple(leaf: &Leaf) -> Mesh {
    let mesh = leaf.mesh();
    let Some(bounds) = mesh.bounds().filter(|_| mesh.triangles().len() > TRIANGLES) else {
        return mesh.clone();
    };
    let (low, high) = (bounds.min.y, bounds.max.y);
    // Two rhombs of this half width have the area.
    let half = (mesh.area() / (2.0 * (high - low).max(1e-6))).min(0.5 * bounds.size().max_element());
    let mut blades = Mesh::default();
    let at = |out: Vec3, share: f32| Vec3::Y * (low + (high - low) * share) + out * half;
    for (out, normal) in [(Vec3::X, Vec3::Z), (Vec3::Z, Vec3::NEG_X)] {
        let first = blades.positions.len() as u32;
        blades.positions.extend([at(Vec3::ZERO, 0.0), at(out, 0.4), at(Vec3::ZERO, 1.0), at(-out, 0.4)]);
        blades.normals.extend([normal; 4]);
        blades.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    blades.uvs = vec![Vec2::ZERO; blades.positions.len()];
    blades
}

/// A mesh as the page reads it: little-endian words, of which `page/pieces.js` says the order.
pub fn write(piece: &Piece, out: &mut Vec<u8>) {
    let Piece { mesh, material, copies } = piece;
    let copies = copies.as_deref();
    let flags = u32::from(!mesh.colors.is_empty())
        + 2 * u32::from(material.is_double_sided())
        + 4 * u32::from(copies.is_some());
    let counts = [mesh.positions.len(), mesh.indices.len(), copies.map_or(0, <[Instance]>::len)];
    counts.iter().for_each(|&count| out.extend((count as u32).to_le_bytes()));
    out.extend(flags.to_le_bytes());
    let mut floats = |values: &[f32]| values.iter().for_each(|value| out.extend(value.to_le_bytes()));
    floats(&material.color());
    floats(&[material.roughness()]);
    mesh.positions.iter().for_each(|place| floats(&place.to_array()));
    mesh.normals.iter().for_each(|normal| floats(&normal.to_array()));
    mesh.colors.iter().for_each(|color| floats(color));
    for copy in copies.unwrap_or_default() {
        for column in copy.matrix().to_cols_array_2d() {
            floats(&column);
            floats(&[0.0]);
        }
        floats(&copy.position.to_array());
        floats(&[1.0]);
    }
    copies.unwrap_or_default().iter().for_each(|copy| floats(&copy.tint));
    mesh.indices.iter().for_each(|index| out.extend(index.to_le_bytes()));
}
