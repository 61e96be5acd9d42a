//! A forester's measures on a grown tree.

use treesynth::foliage::Leaves;
use treesynth::glam::Vec3;
use treesynth::metrics::CrownRadii;
use treesynth::species::Specimen;
use treesynth::{Metrics, ParameterError, math};

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
pub(crate) fn all(tree: &Specimen) -> Result<[f64; COUNT], ParameterError> {
    let numbers = &tree.numbers;
    let (height, dbh) = (f64::from(numbers.height), f64::from(numbers.dbh));
    let metrics = Metrics::of(&tree.skeleton);
    let four = CrownRadii::of(&tree.skeleton, 4)?;
    let width = 2.0 * CrownRadii::of(&tree.skeleton, 8)?.mean();
    let projection = std::f64::consts::PI / 4.0 * width * width;
    let measured = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let [quarter, half, three_quarters] = metrics.stem_taper.map(measured);
    Ok([
        height / dbh,
        width / height,
        f64::NAN,
        f64::NAN,
        f64::from(numbers.leaf_area) / projection,
        limb_angle(tree),
        metrics.mean_tip_radius * 1000.0,
        metrics.tip_radius_variation,
        measured(metrics.form_factor),
        quarter,
        half,
        three_quarters,
        four.variation(),
        four.offset(),
        inclination(tree),
    ])
}

/// Measures beside these that tell species apart: length of the median leaf, length of shoots,
/// height of the crown's base, limbs.
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

/// The median angle between limbs of the first order and the stem below them, over the first two internodes, degrees.
fn limb_angle(tree: &Specimen) -> f64 {
    let skeleton = &tree.skeleton;
    let places = skeleton.positions();
    let mut angles = Vec::new();
    for branch in skeleton.branches().iter() {
        let nodes = branch.nodes();
        let Some(&first) = nodes.get(1) else { continue };
        if skeleton.stages()[first as usize] != 1 || skeleton.stages()[nodes[0] as usize] != 0 {
            continue;
        }
        let base = nodes[0] as usize;
        let end = nodes[2.min(nodes.len() - 1)] as usize;
        let stem = skeleton.parent(base).map_or(Vec3::Y, |below| places[base] - places[below]);
        angles.push(f64::from(math::angle_between(stem, places[end] - places[base]).to_degrees()));
    }
    median(angles)
}

/// The mean angle between blades and the level, degrees.
fn inclination(tree: &Specimen) -> f64 {
    let angles: Vec<f64> = tree
        .leaves
        .iter()
        .flat_map(Leaves::inclinations)
        .map(|angle| f64::from(angle.to_degrees()))
        .collect();
    angles.iter().sum::<f64>() / angles.len() as f64
}
