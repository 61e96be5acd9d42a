//! Properties of every tree of every species, over many seeds.

use super::{LeafShape, Request, Trunk, all};
use crate::Skeleton;
use crate::surface::{Tubes, Wind};
use glam::Vec3;
use std::collections::BTreeSet;
use std::error::Error;

const SEEDS: u64 = 6;
const STEM: u16 = 0;
const LIMB: u16 = 1;
const SHOOT: u16 = 4;
const ROOT: u16 = 5;

/// The nodes of each limb, its base on what bears it first.
fn limbs(skeleton: &Skeleton) -> Vec<Vec<usize>> {
    let (stages, orders) = (skeleton.stages(), skeleton.orders());
    let mut limbs: Vec<Vec<usize>> = Vec::new();
    let mut limb_of = vec![usize::MAX; skeleton.len()];
    for (node, parent) in skeleton.edges().filter(|(node, _)| stages[*node] == LIMB) {
        if stages[parent] == LIMB && orders[parent] == orders[node] {
            limb_of[node] = limb_of[parent];
            limbs[limb_of[node]].push(node);
        } else {
            limb_of[node] = limbs.len();
            limbs.push(vec![parent, node]);
        }
    }
    limbs
}

/// The way along some nodes, metres.
fn length(skeleton: &Skeleton, nodes: &[usize]) -> f32 {
    let places = skeleton.positions();
    nodes.windows(2).map(|pair| places[pair[0]].distance(places[pair[1]])).sum()
}

/// No limb is a hoop or a snake: it is little longer than the straight way from its base to its end.
#[test]
fn limbs_keep_to_their_way() -> Result<(), Box<dyn Error>> {
    for species in all() {
        let mut sinuous = Vec::new();
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let places = tree.skeleton.positions();
            for limb in limbs(&tree.skeleton).iter().filter(|limb| limb.len() > 8) {
                let chord = places[limb[0]].distance(places[limb[limb.len() - 1]]);
                sinuous.push(length(&tree.skeleton, limb) / chord);
            }
        }
        sinuous.sort_by(f32::total_cmp);
        let Some(&worst) = sinuous.last() else { continue };
        let most = sinuous[sinuous.len() * 99 / 100];
        assert!(most < 1.2 && worst < 1.3, "{}: {most} {worst}", species.name);
    }
    Ok(())
}

/// Leaders bear shoots up to their tip, on the last tenth of the crown too.
#[test]
fn leaders_are_clothed() -> Result<(), Box<dyn Error>> {
    let leads = |trunk: &Trunk| trunk.leader >= 1.0 && trunk.stems[1] <= 1.0;
    for species in all().iter().filter(|species| leads(&species.trunk) && species.shoots.spacing < 1.0) {
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let (skeleton, numbers) = (&tree.skeleton, tree.numbers);
            if numbers.height < 3.0 {
                continue;
            }
            let from = numbers.height - 0.1 * (numbers.height - numbers.crown_base);
            let on_leader = skeleton.edges().filter(|&(node, parent)| {
                skeleton.stages()[parent] == STEM
                    && skeleton.orders()[parent] == 0
                    && skeleton.stages()[node] != STEM
                    && skeleton.positions()[parent].y > from
            });
            let count = on_leader.count();
            assert!(
                count >= 4,
                "{} {seed}: {count} on the last {:.2} m",
                species.name,
                numbers.height - from
            );
        }
    }
    Ok(())
}

/// Roots come after all other nodes and change none; each begins within the trunk, is thinner than that, and ends below the ground.
#[test]
fn roots_spread_from_the_trunk_into_the_ground() -> Result<(), Box<dyn Error>> {
    for species in all() {
        for (seed, dead) in (0..SEEDS).flat_map(|seed| [(seed, false), (seed, true)]) {
            let request = species.request().with_seed(seed);
            // The thickest break lowest, in their radii.
            let dead_giant = |request: Request<'_>| {
                request.with_dbh(0.9 * species.size.diameter[1]).with_years_dead(80.0).grow()
            };
            let tree = if dead { dead_giant(request) } else { request.grow() }?;
            let (skeleton, rooted) = (&tree.skeleton, tree.rooted());
            let count = skeleton.len();
            assert_eq!(&rooted.positions()[..count], skeleton.positions());
            assert_eq!(&rooted.radii()[..count], skeleton.radii());
            let trunk = &species.trunk;
            if trunk.roots[1] == 0.0 || trunk.stems[1] > 1.0 || tree.numbers.dbh < 0.08 {
                assert_eq!(rooted.len(), count);
                continue;
            }
            let tips: Vec<usize> = rooted.tips().filter(|&tip| tip >= count).collect();
            let range = trunk.roots[0] as usize..=trunk.roots[1] as usize;
            assert!(range.contains(&tips.len()), "{} {seed}: {} roots", species.name, tips.len());
            assert!(tips.iter().all(|&tip| rooted.positions()[tip].y < 0.0));
            for (node, parent) in rooted.edges().filter(|(node, _)| *node >= count) {
                assert_eq!(rooted.stages()[node], ROOT);
                assert!(rooted.radii()[node] < 0.6 * skeleton.radii()[0]);
                if parent < count {
                    let top = skeleton.positions()[tree.stem()[tree.stem().len() - 1]].y;
                    assert!(
                        rooted.positions()[node].y <= top,
                        "{} {seed}: a root above the stem",
                        species.name
                    );
                    let out = (rooted.positions()[node] - rooted.positions()[parent]).with_y(0.0).length();
                    assert!(skeleton.stages()[parent] == STEM && out < skeleton.radii()[parent]);
                }
            }
            rooted.check()?;
        }
    }
    Ok(())
}

/// Roots wear the bark of the trunk, however thin they are.
#[test]
fn roots_wear_old_bark() -> Result<(), Box<dyn Error>> {
    let mut seen = 0;
    for (species, seed) in all().iter().zip(0..) {
        let tree = species
            .request()
            .with_dbh(species.size.diameter[0].max(0.11))
            .with_seed(seed)
            .with_day(20.0)
            .grow()?;
        for level in tree.levels_in_wind(Some(20_000), 128, &[1.0, 0.3])? {
            for part in level.parts() {
                let of_roots = |wind: &&Wind| wind.node as usize >= tree.skeleton.len();
                let count = part.mesh().wind.iter().filter(of_roots).count();
                assert!(count == 0 || part.name() != "young bark", "{} {seed}: {count}", species.name);
                seen += usize::from(count > 0);
            }
        }
    }
    assert!(seen > 20, "{seen} levels");
    Ok(())
}

/// Where a root comes out of the trunk, light falls on both alike: its normals there are level and away from the trunk's middle.
#[test]
fn roots_have_the_trunks_normals_where_they_come_out() -> Result<(), Box<dyn Error>> {
    let mut seen = 0;
    for (species, seed) in all().iter().zip(0..) {
        let tree = species.request().with_seed(seed).grow()?;
        let (skeleton, base) = (&tree.skeleton, tree.skeleton.radii()[0]);
        let mut mesh = Tubes::default().with_wind(true).with_root_flare(0.0).mesh(&tree.rooted())?;
        tree.blend_roots(&mut mesh);
        let stem = tree.stem();
        for (vertex, wind) in
            mesh.wind.iter().enumerate().filter(|(_, wind)| wind.node as usize >= skeleton.len())
        {
            let place = mesh.positions[vertex];
            let after = stem.iter().find(|&&node| skeleton.positions()[node].y >= place.y);
            let Some(&node) = after.filter(|&&node| node > 0) else { continue };
            let out = (place - skeleton.positions()[node]).with_y(0.0);
            if (out.length() - skeleton.radii()[node]).abs() < 0.04 * base {
                let normal = mesh.normals[vertex];
                let angle = normal.angle_between(out).to_degrees();
                assert!(angle < 35.0, "{} {seed}: node {}, {angle} degrees", species.name, wind.node);
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen} vertices");
    Ok(())
}

/// The stems of a shrub stand apart at the ground.
#[test]
fn stems_stand_apart() -> Result<(), Box<dyn Error>> {
    for species in all().iter().filter(|species| species.trunk.stems[0] > 1.0) {
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let (places, stages) = (tree.skeleton.positions(), tree.skeleton.stages());
            let below = |node: usize| places[node].y < 0.0 && stages[node] == STEM;
            let feet: Vec<Vec3> =
                (1..places.len()).filter(|&node| below(node)).map(|node| places[node]).collect();
            assert!(feet.len() + 1 >= species.trunk.stems[0] as usize, "{} {seed}", species.name);
            let apart: BTreeSet<_> =
                feet.iter().map(|foot| [foot.x, foot.z].map(|at| (at * 50.0) as i32)).collect();
            assert!(2 * apart.len() > feet.len(), "{} {seed}: {} places", species.name, apart.len());
        }
    }
    Ok(())
}

/// One seed gives two species two gestures: the crowns lean to different sides.
#[test]
fn species_differ_at_one_seed() -> Result<(), Box<dyn Error>> {
    for seed in 0..3 {
        let mut sectors = BTreeSet::new();
        for species in all() {
            let tree = species.request().with_seed(seed).grow()?;
            let shoots = tree.skeleton.positions().iter().zip(tree.skeleton.stages());
            let way: Vec3 = shoots.filter(|(_, stage)| **stage == SHOOT).map(|(place, _)| *place).sum();
            sectors.insert((crate::math::atan2(way.z, way.x) / std::f32::consts::TAU * 8.0).floor() as i32);
        }
        assert!(sectors.len() >= 5, "seed {seed}: {sectors:?}");
    }
    Ok(())
}

/// The crown's middle from the stem over its mean radius, from its radii in four directions.
fn lopsidedness(skeleton: &Skeleton) -> f32 {
    let mut radii = [0.0f32; 4];
    for place in skeleton.positions() {
        let quarter = crate::math::atan2(place.z, place.x) / std::f32::consts::FRAC_PI_2;
        let radius = &mut radii[(quarter.round() as i32).rem_euclid(4) as usize];
        *radius = radius.max(place.with_y(0.0).length());
    }
    let [east, north, west, south] = radii;
    let middle = 0.5 * Vec3::new(east - west, north - south, 0.0).length();
    middle / (0.25 * radii.iter().sum::<f32>())
}

/// Crowns stand off their stems as far as those of real trees, whose middle is off by 0.13 to 0.35 of their mean radius (quartiles),
/// and none hangs to one side.
#[test]
fn crowns_are_not_lopsided() -> Result<(), Box<dyn Error>> {
    let mut wrong = Vec::new();
    // A palm's crown stands on the end of a stem that leans.
    for species in all().iter().filter(|species| species.leaves.shape != LeafShape::Strap) {
        let trees = (0..20).map(|seed| species.request().with_seed(seed).grow());
        let trees = trees.collect::<Result<Vec<_>, _>>()?;
        let mut off: Vec<f32> = trees.iter().map(|tree| lopsidedness(&tree.skeleton)).collect();
        off.sort_by(f32::total_cmp);
        let (median, worst) = (off[10], off[19]);
        if median > 0.4 || worst > 0.7 {
            wrong.push(format!("{}: {median:.2} at the median, {worst:.2} at worst", species.name));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}

/// From a place to the nearest point of a triangle, metres.
#[cfg(feature = "texture")]
fn away(place: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let to_side = |from: Vec3, to: Vec3| {
        let way = to - from;
        let part = ((place - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
        place.distance(from + way * part)
    };
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let within = [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| normal.dot((b - a).cross(place - a)) >= 0.0);
    let sides = to_side(a, b).min(to_side(b, c)).min(to_side(c, a));
    if within && normal != Vec3::ZERO { sides.min(normal.dot(place - a).abs()) } else { sides }
}

/// Days on which some organ of the species is there.
fn days(species: &super::Species) -> BTreeSet<u32> {
    let at = |days: [f32; 4]| {
        let day = (0.5 * (days[1] + days[2])).floor();
        [day, days[3] - 2.0].map(|day| ((day - 1.0).max(0.0) % 366.0) as u32 + 1)
    };
    species.organs.iter().flat_map(|organ| at(organ.days)).collect()
}

/// Blossom, fruit and cones begin on the bark of the twig that bears them, within a centimetre.
#[test]
fn organs_are_fixed_to_their_twigs() -> Result<(), Box<dyn Error>> {
    let mut wrong = BTreeSet::new();
    for species in all() {
        for (seed, day) in days(species).into_iter().enumerate() {
            let tree = species.request().with_seed(seed as u64).with_day(day as f32).grow()?;
            let (places, radii) = (tree.skeleton.positions(), tree.skeleton.radii());
            for organ in tree.organs.iter().flat_map(|organs| &organs.instances) {
                let node = organ.node as usize;
                // Coconuts hang one below the other: along all of the stem.
                let mut nearest = f32::INFINITY;
                let mut below = Some(node);
                for _ in 0..8 {
                    let Some((node, parent)) =
                        below.and_then(|node| Some((node, tree.skeleton.parent(node)?)))
                    else {
                        break;
                    };
                    let corners = [places[node], places[parent], places[parent]];
                    nearest = nearest.min(away(organ.position, corners) - radii[node].max(radii[parent]));
                    below = Some(parent);
                }
                if nearest > 0.01 {
                    wrong.insert(format!("{} on day {day}", species.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}

/// Organs on a bare tree hang on wood that is drawn, within a budget too.
#[cfg(feature = "texture")]
#[test]
fn winter_fruit_hangs_on_wood_that_is_drawn() -> Result<(), Box<dyn Error>> {
    use crate::asset::AssetBuilder;
    let (mut loose, mut seen) = ([0, 0], 0);
    for species in all().iter().filter(|species| !species.leaves.evergreen) {
        let tree = species.request().with_day(350.0).grow()?;
        if tree.organs.is_empty() || tree.leaves.is_some() {
            continue;
        }
        for (loose, moved) in loose.iter_mut().zip([false, true]) {
            let builder = AssetBuilder::default()
                .with_triangles(Some(20_000))
                .with_tubes(Tubes::default().with_root_flare(0.0))
                .with_bent_normals(0.0)
                .with_leaves_on_bark(moved);
            let levels = builder.levels_with(&tree.rooted(), &tree.organs, &[1.0])?;
            let (parts, mesh) = (levels[0].parts(), levels[0].bark());
            let wood: Vec<[Vec3; 3]> = mesh
                .triangles()
                .map(|corners| corners.map(|corner| mesh.positions[corner as usize]))
                .collect();
            let fruit: Vec<Vec3> = parts
                .iter()
                .filter(|part| part.name() == "leaves")
                .flat_map(|part| part.copies().iter().map(|copy| copy.position))
                .collect();
            // A bark of fewer triangles lies by its error beside the whole one.
            let near = 0.01 + levels[0].error();
            for place in fruit.iter().step_by((fruit.len() / 200).max(1)) {
                let nearest = wood.iter().map(|&corners| away(*place, corners)).fold(f32::INFINITY, f32::min);
                *loose += usize::from(nearest > near);
                seen += 1;
            }
        }
    }
    assert!(loose[1] == 0 && loose[0] > 0 && seen > 200, "{loose:?} of {seen}");
    Ok(())
}
