//! Leaves on a tree: as many as make its leaf area, in the colours of the day.

use super::SpeciesError;
use super::data::{LeafData, Species};
use super::sprig;
use crate::foliage::{Foliage, Leaves};
use crate::random::{self, Purpose};
use crate::surface::{Instance, Material};
use crate::{Skeleton, math};

/// More leaves than these are drawn as fewer, larger ones.
const MOST_LEAVES: f32 = 600_000.0;
/// Random deviation of a leaf's size, as a share of it.
const SIZES: f32 = 0.22;
/// The leaf at a shoot's tip over the others.
const AT_TIP: f32 = 0.8;

/// The season of a day: the part of the leaves that is there, their size, how far they have turned.
#[derive(Debug, Clone, Copy)]
struct Season {
    present: f32,
    size: f32,
    fresh: f32,
    turned: f32,
}

fn season(leaves: &LeafData, day: f32) -> Season {
    let [out, full, turn, fall] = leaves.days;
    let share = |from: f32, to: f32| ((day - from) / (to - from).max(1.0)).clamp(0.0, 1.0);
    let opened = share(out, full);
    let fresh = 1.0 - share(full, full + 40.0);
    if leaves.evergreen {
        // Last year's stay; this year's are lighter at first.
        return Season { present: 1.0, size: 1.0, fresh: 0.3 * fresh * f32::from(day > out), turned: 0.0 };
    }
    let turned = share(turn, turn + 0.6 * (fall - turn));
    let fallen = share(turn + 0.4 * (fall - turn), fall);
    let present = if opened > 0.0 && day < fall { 1.0 - fallen * fallen } else { 0.0 };
    Season { present, size: 0.3 + 0.7 * opened, fresh, turned }
}

fn foliage(species: &Species, enlarged: f32) -> Foliage {
    let data = &species.leaves;
    Foliage::new(sprig::leaf(data))
        .with_arrangement(data.arrangement())
        .with_spacing(data.spacing)
        .with_size(data.length * enlarged)
        .with_size_at_tip(AT_TIP)
        .with_size_variation(SIZES)
        .with_reach(data.reach)
        .with_thickest(species.shoots.radius * 0.0045)
        .with_angle(data.angle.to_radians())
        .with_rise(data.rise)
        .with_turn(data.turn)
        .with_disorder(data.disorder)
}

/// Approximate number of leaves of this total area in square metres; of a huge tree at most as many
/// as are drawn.
pub(super) fn wanted(species: &Species, area: f32) -> f32 {
    natural(species, area).min(MOST_LEAVES)
}

/// Factor on the leaves' length, so that their greatest number is enough for the area.
fn enlarged(species: &Species, area: f32) -> f32 {
    (natural(species, area) / MOST_LEAVES).max(1.0).sqrt()
}

fn natural(species: &Species, area: f32) -> f32 {
    let each = sprig::leaf(&species.leaves).mesh().area();
    area / (each * species.leaves.length * species.leaves.length * 0.83).max(1e-9)
}

/// The leaves of the day, and the area that they have in summer.
pub(super) fn dress(
    species: &Species,
    skeleton: &Skeleton,
    wish: f32,
    day: f32,
    seed: u64,
) -> Result<(Option<Leaves>, f32), SpeciesError> {
    let data = &species.leaves;
    let foliage = foliage(species, enlarged(species, wish));
    let mut spacing = data.spacing;
    let mut summer = foliage.place(skeleton, seed)?;
    for _ in 0..3 {
        let ratio = summer.area() as f32 / wish;
        if (0.97..1.03).contains(&ratio) {
            break;
        }
        spacing = (spacing * ratio).clamp(data.spacing * 0.2, data.spacing * 4.0);
        summer = foliage.clone().with_spacing(spacing).place(skeleton, seed)?;
    }
    let ratio = summer.area() as f32 / wish;
    let thinned = foliage.with_spacing(spacing);
    let kept = (1.0 / ratio).min(1.0);
    let summer = if kept < 0.98 { thinned.clone().with_kept(kept).place(skeleton, seed)? } else { summer };
    let full = summer.area() as f32;
    let now = season(data, day);
    if now.present <= 0.0 {
        return Ok((None, full));
    }
    let mut leaves = summer;
    if now.present < 1.0 {
        leaves = thinned.with_kept(kept * now.present).place(skeleton, seed)?;
    }
    color(data, now, &mut leaves, seed);
    Ok((Some(leaves), full))
}

/// Each leaf in its own tone: fresh, ripe, or on its way to one of the colours of autumn.
fn color(data: &LeafData, now: Season, leaves: &mut Leaves, seed: u64) {
    let linear = |encoded: [f32; 3]| encoded.map(|channel| math::linear(channel / 255.0));
    let summer = linear(data.summer);
    let fresh = [summer[0] * 1.6 + 0.02, summer[1] * 1.35 + 0.02, summer[2] * 1.1];
    let [r, g, b, s, h, c] = data.autumn;
    let autumn = [linear([r, g, b]), linear([s, h, c])];
    let mix = |a: [f32; 3], b: [f32; 3], t: f32| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
    let tones: Vec<[f32; 3]> = leaves
        .instances
        .iter()
        .map(|leaf| {
            // A leaf's random numbers come from its place, which it keeps while others fall.
            let [x, y, z] = leaf.position.to_array().map(|at| u64::from(at.to_bits()));
            let place = (x << 32 | z) ^ y.rotate_left(17);
            // Leaves of one shoot turn together, more or less.
            let own = random::unit(seed, 1, Purpose::SPECIES, place);
            let shoot = random::unit(seed, 2, Purpose::SPECIES, u64::from(leaf.node));
            let when = 0.5 * own + 0.5 * shoot;
            let green = mix(summer, fresh, now.fresh);
            let turned = ((now.turned * 1.8 - when * 0.8) * 1.2).clamp(0.0, 1.0);
            let tone = mix(green, mix(autumn[0], autumn[1], own), turned);
            let light = 0.8 + 0.4 * random::unit(seed, 3, Purpose::SPECIES, place);
            let yellow = 0.12 * (shoot - 0.5);
            [tone[0] * light * (1.0 + yellow), tone[1] * light, tone[2] * light * (1.0 - yellow)]
                .map(|channel| channel.clamp(0.0, 1.0))
        })
        .collect();
    // A material of the brightest channels, and tints that darken it.
    let most = tones.iter().fold([1e-3f32; 3], |most, tone| [0, 1, 2].map(|i| most[i].max(tone[i])));
    let tint = |leaf: &mut Instance, tone: &[f32; 3]| {
        leaf.tint = [0, 1, 2].map(|i| (tone[i] / most[i]).clamp(0.0, 1.0));
        leaf.scale *= now.size;
    };
    for (leaf, tone) in leaves.instances.iter_mut().zip(&tones) {
        tint(leaf, tone);
    }
    let material = Material::leaf().with_color(most);
    leaves.leaf = leaves.leaf.clone().with_material(material);
}
