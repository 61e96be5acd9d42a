//! What a forester measures, on a grown tree.

use treesynth::glam::{Vec2, Vec3};
use treesynth::math;
use treesynth::species::Specimen;

/// The measures, in the order of the table.
pub(crate) const NAMES: [&str; COUNT] = [
    "height / DBH",
    "crown width / height",
    "leaf area, m², DBH 20 cm",
    "leaf area, m², DBH 40 cm",
    "leaf area index",
    "limb angle, °",
    "twig radius, mm",
    "CV of twig radius",
    "stem form factor",
    "D at ¼ height / DBH",
    "D at ½ height / DBH",
    "D at ¾ height / DBH",
    "CV of four crown radii",
    "crown's middle off the stem / radius",
    "leaf inclination, °",
];
pub(crate) const COUNT: usize = 15;
pub(crate) const LEAF_AREA: [usize; 2] = [2, 3];

/// All of one tree, but the leaf areas at trunks of given size, which are NaN; NaN also where there is nothing to measure.
pub(crate) fn all(tree: &Specimen) -> [f64; COUNT] {
    let numbers = &tree.numbers;
    let (height, dbh) = (f64::from(numbers.height), f64::from(numbers.dbh));
    let [spread, off, width] = crown(tree);
    let projection = std::f64::consts::PI / 4.0 * width * width;
    let (volume, diameters) = stem(tree);
    let (twig, twig_spread) = twigs(tree);
    [
        height / dbh,
        width / height,
        f64::NAN,
        f64::NAN,
        f64::from(numbers.leaf_area) / projection,
        limb_angle(tree),
        twig * 1000.0,
        twig_spread,
        volume / (std::f64::consts::PI / 4.0 * dbh * dbh * height),
        diameters[0] / dbh,
        diameters[1] / dbh,
        diameters[2] / dbh,
        spread,
        off,
        inclination(tree),
    ]
}

/// What tells species apart beside these: length of the median leaf, length of shoots, height of the crown's base, limbs.
pub(crate) fn more(tree: &Specimen) -> [f64; 4] {
    let leaves = tree.leaves.as_ref().map_or(&[][..], |leaves| &leaves.instances);
    let sizes: Vec<f64> = leaves.iter().step_by(37).map(|leaf| f64::from(math::ln(leaf.scale))).collect();
    let skeleton = &tree.skeleton;
    let mut shoots = Vec::new();
    let mut limbs = 0u32;
    for branch in skeleton.branches().iter() {
        let Some(&first) = branch.nodes().get(1) else { continue };
        match skeleton.stages()[first as usize] {
            1 => limbs += 1,
            4 => {
                let way = branch.nodes().windows(2).map(|pair| {
                    let [from, to] = [pair[0], pair[1]].map(|node| skeleton.positions()[node as usize]);
                    f64::from(from.distance(to))
                });
                shoots.push(f64::from(math::ln((way.sum::<f64>() as f32).max(1e-4))));
            }
            _ => {}
        }
    }
    let base = f64::from(tree.numbers.crown_base / tree.numbers.height);
    [median(sizes), median(shoots), base, f64::from(math::ln((limbs as f32).max(1.0)))]
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[count / 2],
        count => 0.5 * (values[count / 2 - 1] + values[count / 2]),
    }
}

/// CV of the radii in four directions, the middle's distance from the stem over the mean radius, and the crown's
/// diameter, twice the mean of eight radii. A radius is the farthest node of its sector.
fn crown(tree: &Specimen) -> [f64; 3] {
    let sectors = |count: usize| {
        let mut radii = vec![0.0f64; count];
        for place in tree.skeleton.positions() {
            let turn = math::atan2(place.z, place.x) / std::f32::consts::TAU + 1.0;
            let sector = (turn * count as f32 + 0.5) as usize % count;
            radii[sector] = radii[sector].max(f64::from(Vec2::new(place.x, place.z).length()));
        }
        radii
    };
    let radii = sectors(4);
    let mean = radii.iter().sum::<f64>() / 4.0;
    let variance = radii.iter().map(|radius| (radius - mean).powi(2)).sum::<f64>() / 3.0;
    let [dx, dz] = [(radii[0] - radii[2]) / 2.0, (radii[1] - radii[3]) / 2.0];
    [variance.sqrt() / mean, (dx * dx + dz * dz).sqrt() / mean, 2.0 * sectors(8).iter().sum::<f64>() / 8.0]
}

/// The trunk's volume as a row of cones, and its diameters at a quarter, half and three quarters of the tree's height.
fn stem(tree: &Specimen) -> (f64, [f64; 3]) {
    let skeleton = &tree.skeleton;
    let (places, radii) = (skeleton.positions(), skeleton.radii());
    let mut volume = 0.0;
    let mut course = vec![(0.0, f64::from(radii[0]))];
    for (node, parent) in skeleton.edges().filter(|(node, _)| skeleton.orders()[*node] == 0) {
        let length = f64::from(places[node].distance(places[parent]));
        let [a, b] = [parent, node].map(|node| f64::from(radii[node]));
        volume += std::f64::consts::PI * length * (a * a + a * b + b * b) / 3.0;
        course.push((f64::from(places[node].y), b));
    }
    let at = |height: f64| {
        let above = course.iter().position(|(y, _)| *y >= height).filter(|index| *index > 0);
        above.map_or(f64::NAN, |index| {
            let (low, high) = (course[index - 1], course[index]);
            2.0 * (low.1 + (high.1 - low.1) * (height - low.0) / (high.0 - low.0).max(1e-9))
        })
    };
    (volume, [0.25, 0.5, 0.75].map(|part| at(part * f64::from(tree.numbers.height))))
}

/// The median angle between limbs and the stem below them, over the first two internodes, degrees.
fn limb_angle(tree: &Specimen) -> f64 {
    let skeleton = &tree.skeleton;
    let places = skeleton.positions();
    let mut angles = Vec::new();
    for branch in skeleton.branches().iter() {
        let nodes = branch.nodes();
        let Some(&first) = nodes.get(1) else { continue };
        if skeleton.stages()[first as usize] != 1 {
            continue;
        }
        let base = nodes[0] as usize;
        let end = nodes[2.min(nodes.len() - 1)] as usize;
        let stem = skeleton.parent(base).map_or(Vec3::Y, |below| places[base] - places[below]);
        angles.push(f64::from(math::angle_between(stem, places[end] - places[base]).to_degrees()));
    }
    median(angles)
}

/// Mean radius of tips, metres, and its coefficient of variation.
fn twigs(tree: &Specimen) -> (f64, f64) {
    let radii: Vec<f64> = tree.skeleton.tips().map(|tip| f64::from(tree.skeleton.radii()[tip])).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let variance = radii.iter().map(|radius| (radius - mean).powi(2)).sum::<f64>() / radii.len() as f64;
    (mean, variance.sqrt() / mean)
}

/// The mean angle between blades and the level, degrees.
fn inclination(tree: &Specimen) -> f64 {
    let leaves = tree.leaves.as_ref().map_or(&[][..], |leaves| &leaves.instances);
    let angles = leaves.iter().map(|leaf| {
        let up = leaf.rotation_matrix() * Vec3::Z;
        f64::from(math::acos(up.y.abs()).to_degrees())
    });
    angles.sum::<f64>() / leaves.len() as f64
}
