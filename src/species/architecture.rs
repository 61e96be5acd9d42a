//! The architecture of a tree: stems, limbs, branches, twigs and shoots by the tables of its species, within the
//! outline of its crown; then the shoots in deepest shade die.

use super::SpeciesError;
use super::data::{Laterals, Species};
use super::draw::Draw;
use super::growing::{GOLDEN, Growing, MOST_NODES, Stem};
use super::outline::Outline;
use super::request::Numbers;
use super::shade;
use super::wood::{Axis, Course, Rank, Wood};
use crate::math;
use glam::Vec3;
use std::f32::consts::TAU;

/// Above this number of usual diameters, laterals stand farther apart.
const HUGE: f32 = 2.5;
/// The part of a crown's height in which its leader bears shoots.
const LEADER: f32 = 0.14;
/// Depth below the ground at which the stems of one tree are joined, metres.
const STOOL: f32 = 0.06;
/// Settings for the growth of one tree: the width of its outline, the density of its shoots.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    pub(super) radius: f32,
    pub(super) density: f32,
}

/// The wood of a tree.
///
/// # Errors
/// More nodes than memory should be asked for.
pub(super) fn grow(species: &Species, plan: &Numbers, scale: Scale, seed: u64) -> Result<Wood, SpeciesError> {
    let draw = Draw::new(seed);
    let radius = plan.crown_width * 0.5 * scale.radius;
    let outline = Outline::new(&species.crown, plan.crown_base, plan.height, radius, &mut draw.child(1, 0));
    let coarse = (plan.dbh / (HUGE * species.size.usual_diameter)).max(1.0);
    let mut growing = Growing { species, coarse, outline, density: scale.density, wood: Wood::default() };
    growing.wood.push(Vec3::ZERO, 0, 0, Rank::Stem);
    let stems = draw.child(2, 0).whole(species.trunk.stems).max(1);
    let grown: Vec<Stem> =
        (0..stems).map(|number| growing.stem(plan, number, stems, draw.child(3, number))).collect();
    let mut limbs = Vec::new();
    for (number, stem) in grown.iter().enumerate() {
        growing.limbs(stem, stems, draw.child(4, number), &mut limbs);
    }
    let unforked = limbs.len();
    // Limbs that have forked may fork again.
    let mut number = 0;
    while number < limbs.len() && growing.wood.positions.len() <= MOST_NODES {
        growing.forks(number, draw.child(6, number), &mut limbs);
        number += 1;
    }
    let too_many = |field, value, change| {
        let (species, what) = (species.name.clone(), "nodes");
        SpeciesError::TooMany { species, what, most: MOST_NODES, field, value, change }
    };
    let mut branches = Vec::new();
    for limb in &limbs {
        let bare = species.limbs.bare;
        growing.laterals(limb, &species.branches, bare, Rank::Branch, &mut branches);
    }
    let mut twigs = Vec::new();
    for branch in &branches {
        growing.laterals(branch, &species.twigs, species.branches.bare, Rank::Twig, &mut twigs);
    }
    if species.trunk.leader >= 1.0 {
        for stem in &grown {
            growing.shoots(&stem.axis, stem.leader_from());
        }
    }
    for limb in &limbs {
        // Shoots stand at the outer parts of limbs and branches too.
        growing.shoots(limb, 0.75_f32.max(species.limbs.bare));
    }
    for branch in &branches {
        growing.shoots(branch, 0.3_f32.max(species.branches.bare));
    }
    for twig in &twigs {
        growing.shoots(twig, species.twigs.bare);
    }
    if growing.wood.positions.len() > MOST_NODES {
        if limbs.len() > 4 * unforked {
            return Err(too_many("limbs.forks", species.limbs.forks, "less"));
        }
        let spacings = [
            ("branches.spacing", species.branches.spacing, species.branches.ratio),
            ("twigs.spacing", species.twigs.spacing, species.twigs.ratio),
            ("shoots.spacing", species.shoots.spacing, 1.0),
        ];
        let used = spacings.into_iter().filter(|(_, _, ratio)| *ratio > 0.0);
        let least = used.min_by(|a, b| a.1.total_cmp(&b.1));
        let (field, value, _) = least.unwrap_or(("shoots.spacing", species.shoots.spacing, 1.0));
        return Err(too_many(field, value, "greater"));
    }
    Ok(shade::shed(growing.wood, species.crown.shed, draw.child(5, 0)))
}

impl Stem {
    /// The share of its way from which a leader bears shoots of its own, as the limbs there are hardly longer.
    fn leader_from(&self) -> f32 {
        1.0 - LEADER * (self.end - self.base).max(0.0) / self.end.max(1e-3)
    }
}

impl Growing<'_> {
    fn stem(&mut self, plan: &Numbers, number: usize, stems: usize, mut draw: Draw) -> Stem {
        let trunk = &self.species.trunk;
        let azimuth = number as f32 * GOLDEN + draw.unit() * 0.8;
        // The first is the tallest; the others stand around it, outer ones shorter and leaning more.
        let tall = if number == 0 { 1.0 } else { draw.within([0.55, 0.98]) };
        let height = plan.height * tall;
        let outer = (number as f32 / stems as f32).sqrt();
        let lean = if number == 0 {
            trunk.lean * draw.within([0.2, 1.0])
        } else {
            // To where the crown is wide they lean more.
            let wide = self.outline.reach(0.7 * plan.height, azimuth) / self.outline.radius().max(0.01);
            trunk.fork_angle * (0.35 + outer * 0.8) * wide.clamp(0.3, 1.8)
        };
        let end = height * if trunk.leader < 1.0 { trunk.leader * draw.within([0.88, 1.12]) } else { 1.0 };
        let end = end.min(height);
        let slope = math::sin(lean.to_radians()) / math::cos(lean.to_radians());
        let bend = math::sin(trunk.sweep.to_radians()) / math::cos(trunk.sweep.to_radians());
        let waves: Vec<(f32, f32, f32)> = [0.7, 1.6, 3.1]
            .into_iter()
            .map(|waves: f32| {
                let wave = TAU * waves * draw.within([0.8, 1.25]) / plan.height;
                (bend * draw.within([0.3, 1.0]) / wave * 0.6, wave, draw.unit() * TAU)
            })
            .collect();
        let turned = draw.unit() * TAU;
        let start = if number == 0 { 0.0 } else { 0.045 * plan.height * draw.within([0.25, 1.0]) };
        let place = |y: f32| {
            // A stem that leans straightens on its way up; one of several arches outwards.
            let way = if number == 0 { 1.0 - 0.35 * y / height } else { 0.35 + 0.65 * y / height };
            let out = start + slope * y * way;
            let (sin, cos) = math::sin_cos(azimuth);
            let mut place = Vec3::new(out * cos, y, out * sin);
            for (index, &(size, wave, phase)) in waves.iter().enumerate() {
                let way = size * (math::sin(wave * y + phase) - math::sin(phase));
                let (sin, cos) = math::sin_cos(turned + index as f32 * 1.9);
                place += Vec3::new(cos, 0.0, sin) * way;
            }
            place
        };
        let step = (plan.height / 60.0).clamp(0.08, 0.4);
        let low = [0.05, 0.15, 0.3, 0.6, 0.95, 1.3].into_iter().filter(|y| *y < 0.9 * end);
        let from = low.clone().next_back().unwrap_or(0.0);
        let count = ((end - from) / step).ceil().max(1.0);
        let high = (1..=count as usize).map(|i| from + (end - from) * i as f32 / count);
        let (order, mut nodes) = (u16::from(number > 0), vec![0]);
        if number > 0 {
            // It comes out of the ground where it stands; what joins it to the others is below.
            let below = place(0.0) - Vec3::Y * STOOL;
            nodes.push(self.wood.push(below, 0, order, Rank::Stem));
        }
        for y in low.chain(high) {
            let parent = nodes.last().copied().unwrap_or(0);
            nodes.push(self.wood.push(place(y), parent, order, Rank::Stem));
        }
        let base = if stems == 1 { plan.crown_base } else { plan.crown_base * tall };
        let axis = Axis { nodes, length: end, draw };
        if trunk.leader >= 1.0 {
            self.end_shoot(&axis, order);
        }
        Stem { axis, base, end, order }
    }

    fn limbs(&mut self, stem: &Stem, stems: usize, draw: Draw, limbs: &mut Vec<Axis>) {
        let species = self.species;
        let table = &species.limbs;
        let room = (stem.end - stem.base).max(0.05 * stem.end);
        let base = stem.end - room;
        let mut number = 0;
        let mut add = |this: &mut Self, height: f32, azimuth: f32, vigor: f32, fork: bool| {
            limbs.push(this.limb(stem, height, azimuth, vigor, fork, draw.child(11, number)));
            number += 1;
        };
        let mut draw = draw.child(12, 0);
        let rough = table.unequal;
        let vigor = |draw: &mut Draw| {
            let weak = draw.unit();
            1.0 - rough * weak * weak.sqrt()
        };
        if table.whorl_spacing > 0.0 {
            // A young tree's years are shorter.
            let spacing = table.whorl_spacing.max(room / 500.0).min(room / 4.0);
            let mut height = base + spacing * draw.unit();
            while height < stem.end - 0.25 * spacing {
                let count = draw.whole(table.whorl).max(1);
                let start = draw.unit() * TAU;
                for i in 0..count {
                    let azimuth = start + (i as f32 + 0.35 * (draw.unit() - 0.5)) * TAU / count as f32;
                    let strong = vigor(&mut draw);
                    add(self, height, azimuth, strong, false);
                }
                let between = (table.between + draw.unit()).floor() as usize;
                for _ in 0..between {
                    let at = height + spacing * draw.within([0.15, 0.9]);
                    if at < stem.end {
                        let (azimuth, weak) = (draw.unit() * TAU, draw.within([0.25, 0.65]));
                        add(self, at, azimuth, weak, false);
                    }
                }
                height += spacing * draw.within([0.75, 1.25]);
            }
        } else {
            let count = (table.count / (stems as f32).sqrt()).round().max(0.0) as usize;
            let start = draw.unit() * TAU;
            for i in 0..count {
                let height = base + room * ((i as f32 + draw.unit()) / count as f32);
                let azimuth = start + i as f32 * GOLDEN + (draw.unit() - 0.5) * 1.6;
                let strong = vigor(&mut draw);
                add(self, height, azimuth, strong, false);
            }
        }
        if species.trunk.leader < 1.0 {
            let count = draw.whole(species.trunk.forks).max(1);
            let start = draw.unit() * TAU;
            for i in 0..count {
                let azimuth = start + (i as f32 + 0.4 * (draw.unit() - 0.5)) * TAU / count as f32;
                // Not all at one point, which no tree has.
                let height = stem.end - room.min(stem.end * 0.1) * draw.unit() * f32::from(i > 0);
                let strong = 1.0 - 0.4 * rough * draw.unit();
                add(self, height, azimuth, strong, true);
            }
        }
    }

    /// Branches or twigs along their parent branch.
    fn laterals(&mut self, axis: &Axis, table: &Laterals, bare: f32, rank: Rank, found: &mut Vec<Axis>) {
        if table.ratio <= 0.0 || axis.nodes.len() < 2 {
            return;
        }
        let shoots = &self.species.shoots;
        let spacing = if rank == Rank::Twig { table.spacing / self.density.sqrt() } else { table.spacing };
        let mut number = 0;
        let from = self.wood.at(axis.nodes[0]).y;
        let bare_below = if from < self.outline.base() { self.outline.base() } else { 0.0 };
        self.stations(axis, table.stand, spacing, bare, |this, node, direction, outward, share| {
            let mut draw = axis.draw.child(rank as u32, number);
            number += 1;
            // Below the crown it is bare.
            if this.wood.at(node).y < bare_below {
                return;
            }
            let weak = draw.unit();
            let rest = ((share - bare) / (1.0 - bare).max(1e-3)).clamp(0.0, 1.0);
            let taper = math::powf(1.0 - 0.92 * rest, 0.7);
            let length = (axis.length * table.ratio * taper).clamp(table.length[0], table.length[1]);
            let length = length * (1.0 - table.unequal * weak * weak.sqrt());
            let angle = (table.angle + table.angle_spread * draw.normal()).to_radians();
            let (sin, cos) = math::sin_cos(angle);
            let heading = (direction * cos + outward * sin).normalize_or(direction);
            let from = this.wood.at(node);
            // Hanging ones leave the outline on their way down.
            let length = if table.rise > -1.0 {
                let open = this.outline.way_out(from, heading, length);
                length.min(open.max(0.35 * length) * draw.within([0.9, 1.1]))
            } else {
                length
            };
            if length < 1.3 * shoots.length {
                this.shoot(node, heading, draw.child(1, 0));
                return;
            }
            let finer = if rank == Rank::Branch { this.species.twigs.spacing } else { shoots.spacing };
            let course = Course {
                base: node,
                direction: heading,
                length,
                step: finer.clamp(length / 40.0, (length / 3.0).max(length / 40.0)),
                order: this.wood.orders[node as usize] + 1,
                rank,
                rise: table.rise,
                crooked: table.crooked.to_radians(),
            };
            let axis = course.grow(&mut this.wood, draw);
            this.end_shoot(&axis, course.order);
            found.push(axis);
        });
    }
}
