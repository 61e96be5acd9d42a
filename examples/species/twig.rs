//! Sheets of twigs close up: leaves in summer, or blossom and fruit in their season.

use crate::common::Failure;
use rayon::prelude::*;
use treesynth::Skeleton;
use treesynth::foliage::Leaves;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview, Projection};
use treesynth::shape::Bounds;
use treesynth::species::{self, OrganPlace, Species, Specimen};
use treesynth::surface::{Material, Part, Tubes};

/// Pixels along the sides of a picture, and below it for the name.
const SIDE: u32 = 300;
const LABEL: u32 = 22;
/// Species in a row.
const ROW: u32 = 5;
/// Lengths of a leaf that a twig is long.
const LEAVES: f32 = 3.6;
/// The part of a twig's longest side that is shown across: its other sides are shorter.
const SHOWN: f32 = 0.72;
/// The shortest and the longest twig, metres.
const LENGTHS: [f32; 2] = [0.28, 4.0];

/// A twig of each species, bare and in leaf.
pub(crate) fn leaves(seed: u64) -> Result<Picture, Failure> {
    sheet(|species| {
        let tree = species.request().with_seed(seed).grow()?;
        let leaf = species.leaves.length * (1.0 + species.leaves.petiole);
        let twig = Twig::of(&tree, (LEAVES * leaf).clamp(LENGTHS[0], LENGTHS[1]), false)?;
        let mut cell = Picture::new(2 * SIDE, SIDE + LABEL, [255; 3])?;
        cell.blit(&twig.draw(&[])?, 0, 0);
        cell.blit(&twig.draw(&twig.leaves)?, SIDE as i32, 0);
        label(&mut cell, &format!("{}, {:.0} cm across", species.name, 100.0 * twig.across()));
        Ok(cell)
    })
}

/// Twigs of each species with its first sort of blossom, and with its last of fruit.
pub(crate) fn blossom(seed: u64) -> Result<Picture, Failure> {
    sheet(|species| {
        let mut cell = Picture::new(2 * SIDE, SIDE + LABEL, [255; 3])?;
        let mut words = species.name.clone();
        let last = species.organs.last().filter(|_| species.organs.len() > 1);
        for (index, organ) in species.organs.first().into_iter().chain(last).enumerate() {
            let always = organ.days[3] - organ.days[0] > 366.0;
            let day =
                if always { 196.0 } else { (0.5 * (organ.days[1] + organ.days[2]) - 1.0) % 366.0 + 1.0 };
            let tree = species.request().with_seed(seed).with_day(day.floor()).grow()?;
            let leaf = species.leaves.length * (1.0 + species.leaves.petiole);
            let length = (2.5 * leaf).max(3.0 * organ.size).clamp(0.2, 3.0);
            let twig = Twig::of(&tree, if organ.place == OrganPlace::Stem { 4.0 } else { length }, true)?;
            let at = if last.is_some() { index as u32 * SIDE } else { SIDE / 2 };
            cell.blit(&twig.draw(&twig.leaves)?, at as i32, 0);
            let at = format!(
                "{} {day:.0} ({:.0} cm)",
                if index == 0 { ": day" } else { ", day" },
                100.0 * twig.across()
            );
            words += &at;
        }
        label(&mut cell, &words);
        Ok(cell)
    })
}

fn label(cell: &mut Picture, words: &str) {
    let scale = if Picture::label_width(words, 2) < cell.width() { 2 } else { 1 };
    let at = cell.width().saturating_sub(Picture::label_width(words, scale)) / 2;
    cell.label(words, at as i32, SIDE as i32 + 4, scale, [40; 3]);
}

fn sheet(draw: impl Fn(&Species) -> Result<Picture, Failure> + Sync) -> Result<Picture, Failure> {
    let cells: Result<Vec<Picture>, String> = species::all()
        .par_iter()
        .map(|species| draw(species).map_err(|error| format!("{}: {error}", species.name)))
        .collect();
    Ok(Picture::sheet(&cells?, ROW, 2, [255; 3])?)
}

/// A part of a tree.
struct Twig {
    skeleton: Skeleton,
    leaves: Vec<Leaves>,
}

impl Twig {
    /// One about this long, in metres, with the most leaves, or with the most organs.
    fn of(tree: &Specimen, length: f32, organs: bool) -> Result<Self, Failure> {
        let skeleton = &tree.skeleton;
        let (positions, count) = (skeleton.positions(), skeleton.len());
        let mut borne = vec![0u32; count];
        let counted: Vec<&Leaves> = if organs && !tree.organs.is_empty() {
            tree.organs.iter().collect()
        } else {
            tree.foliage().collect()
        };
        for copy in counted.iter().flat_map(|leaves| &leaves.instances) {
            borne[copy.node as usize] += 1;
        }
        // Least reach of each node's twig.
        let mut reach = vec![0.0f32; count];
        for (node, parent) in skeleton.edges().rev() {
            reach[parent] = reach[parent].max(reach[node] + positions[node].distance(positions[parent]));
            borne[parent] += borne[node];
        }
        let begins = |node: &usize| {
            skeleton.parent(*node).is_some_and(|parent| skeleton.orders()[parent] != skeleton.orders()[*node])
        };
        let fits = |node: &usize| (0.6 * length..1.1 * length).contains(&reach[*node]);
        let off = |node: usize| (reach[node] / length - 1.0).abs();
        let best = (1..count).filter(|node| begins(node) && fits(node)).max_by_key(|node| borne[*node]);
        let best = best.or_else(|| {
            (1..count).filter(|node| borne[*node] > 0).min_by(|a, b| off(*a).total_cmp(&off(*b)))
        });
        let root = best.and_then(|node| skeleton.parent(node).map(|parent| [parent, node]));
        let [base, first] = root.ok_or("there is no twig to be drawn")?;
        let mut number = vec![u32::MAX; count];
        let (mut places, mut parents, mut radii) = (vec![positions[base]], vec![None], Vec::new());
        radii.push(skeleton.radii()[first]);
        for node in first..count {
            let Some(parent) = skeleton.parent(node) else { continue };
            let at = if node == first { 0 } else { number[parent] };
            if at != u32::MAX {
                number[node] = places.len() as u32;
                places.push(positions[node]);
                parents.push(Some(at));
                radii.push(skeleton.radii()[node]);
            }
        }
        let leaves = tree.foliage().cloned().map(|mut leaves| {
            leaves.instances.retain(|copy| number[copy.node as usize] != u32::MAX);
            leaves.instances.iter_mut().for_each(|copy| copy.node = number[copy.node as usize]);
            leaves
        });
        let leaves = leaves.filter(|leaves| !leaves.instances.is_empty()).collect();
        Ok(Self { skeleton: Skeleton::new(places, parents)?.with_radii(radii)?, leaves })
    }

    fn bounds(&self) -> Bounds {
        let copies = self.leaves.iter().flat_map(|leaves| {
            leaves
                .instances
                .iter()
                .map(|copy| copy.position + copy.rotation_matrix() * (Vec3::Y * copy.scale))
        });
        let all: Vec<Vec3> = self.skeleton.positions().iter().copied().chain(copies).collect();
        let low = all.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = all.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let half = Vec3::splat(0.5 * (high - low).length());
        let middle = 0.5 * (low + high);
        Bounds::new(middle - half, middle + half)
    }

    /// The side of what its picture shows, metres.
    fn across(&self) -> f32 {
        SHOWN * self.bounds().size().x
    }

    fn draw(&self, leaves: &[Leaves]) -> Result<Picture, Failure> {
        let way = self.skeleton.positions().iter().fold(Vec3::ZERO, |sum, place| sum + *place);
        let way = way / self.skeleton.len() as f32 - self.skeleton.positions()[0];
        // From the side on which it lies across, a little from above.
        let azimuth = treesynth::math::atan2(way.x, way.z) + std::f32::consts::FRAC_PI_2;
        let size = self.bounds().size().x;
        let (middle, half) = (self.bounds().center(), Vec3::splat(0.5 * SHOWN * size));
        let camera = Camera::default()
            .with_azimuth(azimuth)
            .with_elevation(0.5)
            .with_projection(Projection::Orthographic)
            .with_margin(0.0)
            .with_frame(Bounds::new(middle - half, middle + half));
        let bark =
            Tubes::default().with_sides(10).with_least_sides(5).with_root_flare(0.0).mesh(&self.skeleton)?;
        let wood = Part::new(&bark).with_material(Material::bark().with_srgb([118, 96, 76]));
        let parts: Vec<Part<'_>> = std::iter::once(wood).chain(leaves.iter().map(Leaves::part)).collect();
        let preview = Preview::default().with_size(SIDE, SIDE).with_camera(camera).with_ground(false);
        Ok(preview
            .with_background([0.93, 0.94, 0.95], [0.97, 0.97, 0.96])
            .with_supersampling(2)
            .draw_parts(&parts)?)
    }
}
