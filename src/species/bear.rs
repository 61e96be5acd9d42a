//! Blossom, catkins, fruit and cones on a tree, as they are on a day.

use super::bark_colors::linear;
use super::data::Species;
use super::draw::Draw;
use super::model;
use super::organ::{Organ, OrganPlace};
use super::request::Numbers;
use crate::Skeleton;
use crate::foliage::Leaves;
use crate::math::{self, UP, perpendicular};
use crate::surface::Instance;
use glam::{Mat3, Quat, Vec3};
use std::f32::consts::TAU;

const GOLDEN: f32 = 2.399_963_2;
/// More organs of a sort than these are drawn as fewer, larger ones.
const MOST_ORGANS: f32 = 300_000.0;
/// Days of a year, for what stays over its end.
const YEAR: f32 = 366.0;
/// The size of an organ on its first day.
const FIRST: f32 = 0.45;

/// A place at which a bunch may stand.
#[derive(Debug, Clone, Copy)]
struct Station {
    node: u32,
    position: Vec3,
    along: Vec3,
    /// The number of its shoot, and its own on that.
    shoot: usize,
    number: usize,
}

/// The organs of each sort that are there on the day; sorts of which there are none are left out.
pub(super) fn bear(species: &Species, skeleton: &Skeleton, plan: &Numbers, seed: u64) -> Vec<Leaves> {
    let sorts = species.organs.iter().enumerate();
    sorts.filter_map(|(index, organ)| sort(species, organ, index, skeleton, plan, seed)).collect()
}

fn sort(
    species: &Species,
    organ: &Organ,
    index: usize,
    skeleton: &Skeleton,
    plan: &Numbers,
    seed: u64,
) -> Option<Leaves> {
    let in_season = |day: f32| (organ.days[0]..organ.days[3]).contains(&day);
    if organ.share <= 0.0 || !(in_season(plan.day) || in_season(plan.day + YEAR)) {
        return None;
    }
    let stations = stations(species, organ, skeleton, plan);
    let expected = stations.len() as f32 * organ.share * 0.5 * (organ.bunch[0] + organ.bunch[1]);
    let kept = (MOST_ORGANS / expected.max(1.0)).min(1.0);
    let draw = Draw::new(seed).child(40, index);
    let [r, g, b, s, h, c] = organ.colors;
    let colors = [linear([r, g, b]), linear([s, h, c])];
    let (mut instances, mut tones) = (Vec::new(), Vec::new());
    for station in &stations {
        let mut draw = draw.child(1, station.shoot).child(2, station.number);
        if draw.unit() >= organ.share * kept {
            continue;
        }
        let start = draw.unit() * TAU;
        for number in 0..draw.whole(organ.bunch).max(1) {
            let mut draw = draw.child(3, number);
            let Some(grown) = grown(organ, plan.day, [draw.unit(), draw.unit()]) else { continue };
            let around = start + number as f32 * GOLDEN + 0.4 * draw.normal();
            let size = organ.size * (1.0 + organ.variation * (2.0 * draw.unit() - 1.0));
            instances.push(place(organ, skeleton, station, around, size * grown / kept.sqrt(), &mut draw));
            let (own, light) = (draw.unit(), draw.within([0.85, 1.1]));
            tones.push(
                [0, 1, 2]
                    .map(|i| ((colors[0][i] + (colors[1][i] - colors[0][i]) * own) * light).clamp(0.0, 1.0)),
            );
        }
    }
    if instances.is_empty() {
        return None;
    }
    // A material of the brightest channels, and tints that darken it.
    let most =
        tones.iter().fold([1e-3f32; 3], |most, tone: &[f32; 3]| [0, 1, 2].map(|i| most[i].max(tone[i])));
    for (instance, tone) in instances.iter_mut().zip(&tones) {
        instance.tint = [0, 1, 2].map(|i| (tone[i] / most[i]).clamp(0.0, 1.0));
    }
    let leaf = model::organ(organ);
    let material = leaf.material().with_color(most);
    Some(Leaves { leaf: leaf.with_material(material), instances })
}

/// The size on a day of an organ that comes and falls at these parts of the times in which organs
/// do; none if it is not there.
fn grown(organ: &Organ, day: f32, [comes, falls]: [f32; 2]) -> Option<f32> {
    let [first, all, falling, last] = organ.days;
    let (from, to) = (first + (all - first) * comes, falling + (last - falling) * falls);
    let day = [day, day + YEAR].into_iter().find(|day| (from..to).contains(day))?;
    let open = ((day - from) / (0.5 * (all - first)).max(1.0)).clamp(0.0, 1.0);
    // Organs without a time of opening are full-grown.
    Some(if all > first { FIRST + (1.0 - FIRST) * open } else { 1.0 })
}

fn place(
    organ: &Organ,
    skeleton: &Skeleton,
    station: &Station,
    around: f32,
    scale: f32,
    draw: &mut Draw,
) -> Instance {
    let along = station.along;
    let level = along.cross(UP).try_normalize().unwrap_or_else(|| perpendicular(along));
    let (sin, cos) = math::sin_cos(around);
    let outward = level * cos + along.cross(level) * sin;
    let (sin, cos) = math::sin_cos(organ.angle.to_radians() + 0.15 * draw.normal());
    let grown = along * cos + outward * sin;
    let axis = (grown + UP * organ.rise).normalize_or(grown);
    let side = perpendicular(axis);
    let (sin, cos) = math::sin_cos(draw.unit() * TAU);
    let side = side * cos + axis.cross(side) * sin;
    let rotation = Quat::from_mat3(&Mat3::from_cols(axis.cross(side), axis, side));
    let radius = skeleton.radii()[station.node as usize];
    // Bunches at the top of a stem hang one below another.
    let down = if organ.place == OrganPlace::Stem { 3.0 * scale * draw.unit() } else { 0.0 };
    let on_bark = if organ.place == OrganPlace::Tips { 0.3 } else { 1.0 };
    Instance {
        position: station.position + outward * (radius * on_bark) - along * down,
        rotation: math::unit_rotation(rotation),
        scale,
        node: station.node,
        tint: [1.0; 3],
    }
}

/// All places of an organ's kind in its part of the crown, shoot by shoot.
fn stations(species: &Species, organ: &Organ, skeleton: &Skeleton, plan: &Numbers) -> Vec<Station> {
    let positions = skeleton.positions();
    let room = (plan.height - plan.crown_base).max(0.01);
    let within = |place: Vec3| {
        let share = ((place.y - plan.crown_base) / room).clamp(0.0, 1.0);
        (organ.heights[0]..=organ.heights[1]).contains(&share)
    };
    let direction = |node: usize| {
        let parent = skeleton.parent(node).unwrap_or(node);
        (positions[node] - positions[parent]).normalize_or(UP)
    };
    let mut found = Vec::new();
    if organ.place == OrganPlace::Stem {
        // The highest node of each stem that is in that part of the crown.
        let mut ends = vec![true; skeleton.len()];
        let low = |node: usize| within(positions[node]) || positions[node].y < plan.crown_base;
        for (node, parent) in skeleton.edges() {
            ends[parent] &= skeleton.stages()[node] != 0 || !low(node);
            ends[node] &= low(node);
        }
        let tops = (1..skeleton.len()).filter(|&node| skeleton.stages()[node] == 0 && ends[node]);
        found.extend(tops.enumerate().map(|(shoot, node)| {
            let along = direction(node);
            Station { node: node as u32, position: positions[node], along, shoot, number: 0 }
        }));
        return found;
    }
    let shoots = &species.shoots;
    // Halfway between the two lengths, as lengths go.
    let short = if shoots.short > 0.0 { (shoots.short_length * shoots.length).sqrt() } else { 0.0 };
    for (shoot, [first, last]) in chains(skeleton).into_iter().enumerate() {
        let step = |node: usize| positions[node].distance(positions[skeleton.parent(node).unwrap_or(node)]);
        let length: f32 = (first..=last).map(step).sum();
        if (length < short) != (organ.place == OrganPlace::ShortShoots) {
            continue;
        }
        if organ.place != OrganPlace::Along {
            let (position, along) = (positions[last], direction(last));
            if within(position) {
                found.push(Station { node: last as u32, position, along, shoot, number: 0 });
            }
            continue;
        }
        let (mut node, mut at, mut passed, mut number) = (last, 0.35 * organ.spacing, 0.0, 0);
        while at < length {
            while node > first && at > passed + step(node) {
                passed += step(node);
                node -= 1;
            }
            let along = direction(node);
            let position = positions[node] - along * (at - passed);
            if within(position) {
                found.push(Station { node: node as u32, position, along, shoot, number });
            }
            number += 1;
            at += organ.spacing;
        }
    }
    found
}

/// First and last node of each shoot: its nodes follow one another.
fn chains(skeleton: &Skeleton) -> Vec<[usize; 2]> {
    let mut chains: Vec<[usize; 2]> = Vec::new();
    for (node, parent) in skeleton.edges().filter(|(node, _)| skeleton.stages()[*node] == 4) {
        match chains.last_mut() {
            Some(chain) if chain[1] == parent && node == parent + 1 && skeleton.stages()[parent] == 4 => {
                chain[1] = node;
            }
            _ => chains.push([node, node]),
        }
    }
    chains
}
