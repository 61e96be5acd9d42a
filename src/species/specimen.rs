//! A grown tree of a species.

use super::SpeciesError;
use super::architecture::{self, Scale};
use super::bark_colors::BarkColors;
use super::bear;
use super::data::Species;
use super::decay::{self, Timber};
use super::draw::Draw;
use super::dress;
use super::request::Numbers;
use super::thickness;
use super::wood::{Rank, Wood};
use crate::foliage::Leaves;
use crate::math;
use crate::surface::{Material, Mesh, SurfaceError, Tubes};
use crate::{ParameterError, Skeleton};
use std::f32::consts::TAU;

/// A tree of a species: what [`Request::grow`](super::Request::grow) gives.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Specimen {
    /// The species it is of.
    pub species: Species,
    /// Its branches with their radii; orders are those of its axes, stages its ranks: 0 stems, 1 limbs, 2 branches, 3
    /// twigs, 4 shoots.
    pub skeleton: Skeleton,
    /// Its leaves on that day, each in its tone; none in winter.
    pub leaves: Option<Leaves>,
    /// Its blossom, catkins, fruit and cones on that day, one entry per sort that is there.
    pub organs: Vec<Leaves>,
    /// The numbers it was grown by, with those that are measured on it.
    pub numbers: Numbers,
    /// The seed.
    pub seed: u64,
    /// Share of bark that is missing at each node, 0 to 1.
    pub(super) bare: Vec<f32>,
}

impl Specimen {
    /// Everything that stands on the branches: leaves, then blossom, catkins, fruit and cones.
    pub fn foliage(&self) -> impl Iterator<Item = &Leaves> {
        self.leaves.iter().chain(&self.organs)
    }

    /// The bark of the trunk as a plain material.
    pub fn bark(&self) -> Material {
        Material::bark().with_srgb(self.species.bark.trunk.map(|channel| channel as u8))
    }

    /// The tubes of the tree with a colour at each vertex, from old bark on the trunk to young bark on the twigs; to be
    /// drawn with [`Material::white`]. The trunk has its flare from its radii, and none from the tubes.
    ///
    /// # Errors
    /// As [`Tubes::mesh`].
    pub fn bark_mesh(&self, tubes: &Tubes) -> Result<Mesh, SurfaceError> {
        let tubes = tubes.clone().with_wind(true).with_root_flare(0.0);
        let mut mesh = tubes.mesh(&self.rooted())?;
        self.blend_roots(&mut mesh);
        let colors = BarkColors::new(self);
        let places = mesh.wind.iter().zip(&mesh.positions);
        mesh.colors = places.map(|(wind, place)| colors.at(wind.node as usize, place.y)).collect();
        mesh.wind = Vec::new();
        Ok(mesh)
    }
}

/// Most times that a tree is grown again to get the crown width that was asked for.
const TRIALS: usize = 3;

/// More leaves than these have no room in memory at the spacing of the species.
const MOST_LEAVES: usize = 4_000_000;
/// Largest deviation from a diameter that was asked for, as a part of it.
const OFF: f32 = 0.02;

pub(super) fn grow(
    species: &Species,
    plan: Numbers,
    dbh: Option<f32>,
    seed: u64,
) -> Result<Specimen, SpeciesError> {
    let own = Draw::seed_of(&species.latin, seed);
    let mut scale = Scale { radius: 1.0, density: 1.0 };
    let leaves = dress::wanted(species, plan.leaf_area);
    let mut wood = architecture::grow(species, &plan, scale, own)?;
    for _ in 0..TRIALS {
        let width = crown_width(&wood) * plan.height / height(&wood);
        let off = plan.crown_width / width.max(0.01);
        let dense = leaves / room(species, &wood);
        if (0.97..1.03).contains(&off) && (0.8..1.25).contains(&dense) {
            break;
        }
        scale.radius = (scale.radius * off).clamp(0.3, 3.0);
        scale.density = (scale.density * math::powf(dense, 0.7)).clamp(0.3, 3.0);
        wood = architecture::grow(species, &plan, scale, own)?;
    }
    if room(species, &wood) > MOST_LEAVES as f32 {
        let (field, value, change) = ("leaves.spacing", species.leaves.spacing, "greater");
        let (species, what, most) = (species.name.clone(), "leaves", MOST_LEAVES);
        return Err(SpeciesError::TooMany { species, what, most, field, value, change });
    }
    // To the height asked for, exactly.
    let factor = plan.height / height(&wood);
    for position in &mut wood.positions {
        *position *= factor;
    }
    let radii = thickness::radii(species, &wood, &plan, dbh.is_some(), Draw::new(own).child(30, 0));
    let mut numbers = plan;
    numbers.height = height(&wood);
    numbers.dbh = 2.0 * thickness::at_breast(&wood, &radii);
    if let Some(wish) = dbh.filter(|wish| (numbers.dbh / wish - 1.0).abs() > OFF) {
        let [least, most] = [wish.min(numbers.dbh), species.size.diameter[1]];
        let range =
            format!("{} to {most} m at this height", if wish < numbers.dbh { numbers.dbh } else { least });
        let what = format!("dbh of {}", species.name);
        return Err(ParameterError::new(what, format!("{wish} m"), range).into());
    }
    numbers.crown_width = crown_width(&wood);
    numbers.crown_base = crown_base(&wood).unwrap_or(numbers.crown_base);
    let whole = skeleton(&Timber::new(wood.clone(), radii.clone()))?;
    let (mut dressed, area) = dress::dress(species, &whole, plan.leaf_area, plan.day, own)?;
    numbers.leaf_area = area;
    let mut organs = bear::bear(species, &whole, &numbers, own);
    // Breakage and death change the tree as it has grown.
    let mut timber = Timber::new(wood, radii);
    let number = decay::wreck(&mut timber, &numbers, own);
    let intact = numbers.dead.is_none() && numbers.damage <= 0.0;
    if !intact {
        let before = dressed.as_ref().map_or(0.0, Leaves::area);
        for leaves in dressed.iter_mut().chain(&mut organs) {
            decay::keep(leaves, &number);
        }
        let after = dressed.as_ref().map_or(0.0, Leaves::area);
        numbers.leaf_area *= if before > 0.0 { (after / before) as f32 } else { 1.0 };
        if let Some(years) = numbers.dead {
            let evergreen = species.leaves.evergreen;
            dressed = dressed.filter(|_| evergreen).and_then(|leaves| decay::wither(leaves, years, own));
            numbers.leaf_area = 0.0;
            organs.clear();
        }
        dressed = dressed.filter(|leaves| !leaves.instances.is_empty());
        organs.retain(|leaves| !leaves.instances.is_empty());
        numbers.height = height(&timber.wood);
        numbers.crown_width = crown_width(&timber.wood);
        numbers.crown_base = crown_base(&timber.wood).unwrap_or(numbers.crown_base);
    }
    decay::dead_limbs(&mut timber, species, &numbers, own);
    let skeleton = if timber.radii.len() == whole.len() && intact { whole } else { skeleton(&timber)? };
    let bare = timber.bare;
    Ok(Specimen { species: species.clone(), skeleton, leaves: dressed, organs, numbers, seed, bare })
}

fn skeleton(timber: &Timber) -> Result<Skeleton, SpeciesError> {
    let Timber { wood, radii, .. } = timber;
    let parents =
        wood.parents.iter().enumerate().map(|(node, &parent)| (node > 0).then_some(parent)).collect();
    let stages = wood.ranks.iter().map(|&rank| rank as u16).collect();
    let skeleton = Skeleton::new(wood.positions.clone(), parents)?.with_radii(radii.clone())?;
    Ok(skeleton.with_stages(stages)?.with_orders(wood.orders.clone())?)
}

fn height(wood: &Wood) -> f32 {
    wood.positions.iter().fold(0.01, |top, position| top.max(position.y))
}

/// Twice the mean of the crown's radii in eight directions.
fn crown_width(wood: &Wood) -> f32 {
    let mut radii = [0.0f32; 8];
    for position in &wood.positions {
        let out = (position.x * position.x + position.z * position.z).sqrt();
        let azimuth = math::atan2(position.z, position.x);
        let sector = ((azimuth / TAU + 1.0) * 8.0) as usize % 8;
        radii[sector] = radii[sector].max(out);
    }
    2.0 * radii.iter().sum::<f32>() / 8.0
}

/// The height of the lowest limb's base; none if there are no limbs.
fn crown_base(wood: &Wood) -> Option<f32> {
    let bases = (1..wood.positions.len()).filter(|&node| {
        wood.ranks[node] == Rank::Limb && wood.ranks[wood.parents[node] as usize] == Rank::Stem
    });
    bases.map(|node| wood.positions[wood.parents[node] as usize].y).reduce(f32::min)
}

/// Number of leaves for which there is room at the spacing of the species.
fn room(species: &Species, wood: &Wood) -> f32 {
    let data = &species.leaves;
    let each = data.arrangement().per_whorl() as f32;
    let mut lengths = vec![0.0f32; wood.positions.len()];
    let mut room = 0.0;
    let mut bears = vec![false; wood.positions.len()];
    for node in 1..wood.positions.len() {
        bears[wood.parents[node] as usize] = true;
    }
    for node in 1..wood.positions.len() {
        let parent = wood.parents[node] as usize;
        if wood.ranks[node] == Rank::Shoot {
            lengths[node] = lengths[parent] + wood.positions[node].distance(wood.positions[parent]);
            if !bears[node] {
                room += each * ((lengths[node].min(data.reach) / data.spacing).floor() + 1.0);
            }
        }
    }
    room.max(1.0)
}
