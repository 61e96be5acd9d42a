//! Published figures of the species, as ranges that medians should lie in.
//!
//! Slenderness and crown width of amenity trees: `OpenBARD` (Fennell 2024), p10, p50, p90, from which quartiles are worked out
//! as of a log-normal distribution; where only a median is known, of street trees (`McPherson` et al. 2016), 15% to
//! either side. Leaf area and its index: street trees, quartiles of the index; for the area, a third to either side.
//! Twig radii: `rTwig`, with the usual spread of twigs. Leaf inclination: Chianucci et al. 2018, mean and standard
//! deviation. Stems: lmfor (pine, spruce, birch), forestmangr (eucalypt). Angles: Lignum's pines, Fabrika et al. 2019
//! (spruce), openalea's apples and walnut. Some figures are of a relative: see docs/species.md.

use crate::measure::COUNT;
use treesynth::math;

/// Published measures of a species; zeros where there are none.
#[derive(Clone, Copy)]
pub(crate) struct Known {
    pub(crate) name: &'static str,
    /// Height over trunk diameter: p10, p50, p90; or p50 alone in the middle.
    slenderness: [f64; 3],
    /// Crown width over height, likewise.
    width: [f64; 3],
    leaf_area: [f64; 2],
    leaf_area_index: [f64; 2],
    angle: [f64; 2],
    twig: f64,
    inclination: [f64; 2],
}

const NONE: Known = Known {
    name: "",
    slenderness: [0.0; 3],
    width: [0.0; 3],
    leaf_area: [0.0; 2],
    leaf_area_index: [0.0; 2],
    angle: [0.0; 2],
    twig: 0.0,
    inclination: [0.0; 2],
};

#[rustfmt::skip]
pub(crate) const KNOWN: [Known; 24] = [
    Known { name: "English oak", slenderness: [14.0, 25.0, 43.0], width: [0.49, 0.83, 1.25], leaf_area: [65.0, 267.0], leaf_area_index: [1.9, 4.5], twig: 1.39, inclination: [35.0, 19.0], ..NONE },
    Known { name: "Scots pine", slenderness: [19.0, 31.0, 45.0], width: [0.27, 0.50, 0.80], leaf_area: [21.0, 83.0], leaf_area_index: [0.8, 3.2], angle: [61.0, 72.0], twig: 1.93, ..NONE },
    Known { name: "Norway spruce", leaf_area: [67.0, 209.0], leaf_area_index: [3.4, 7.5], angle: [40.0, 70.0], twig: 1.46, ..NONE },
    Known { name: "silver birch", slenderness: [28.0, 42.0, 69.0], width: [0.33, 0.59, 0.88], leaf_area: [110.0, 380.0], leaf_area_index: [3.4, 6.3], twig: 0.85, inclination: [56.0, 20.0], ..NONE },
    Known { name: "beech", slenderness: [15.0, 27.0, 44.0], width: [0.53, 0.81, 1.15], leaf_area: [127.0, 466.0], leaf_area_index: [3.5, 5.4], twig: 1.14, inclination: [18.0, 15.0], ..NONE },
    Known { name: "Norway maple", slenderness: [19.0, 30.0, 50.0], width: [0.50, 0.77, 1.14], leaf_area: [67.0, 247.0], leaf_area_index: [2.2, 4.8], twig: 1.39, inclination: [27.0, 17.0], ..NONE },
    Known { name: "sycamore", slenderness: [20.0, 33.0, 60.0], width: [0.43, 0.71, 1.03], inclination: [34.0, 17.0], ..NONE },
    Known { name: "ash", slenderness: [20.0, 36.0, 61.0], width: [0.38, 0.69, 1.04], leaf_area: [58.0, 245.0], leaf_area_index: [1.3, 4.0], twig: 2.45, inclination: [36.0, 21.0], ..NONE },
    Known { name: "small-leaved lime", slenderness: [23.0, 33.0, 45.0], width: [0.51, 0.80, 1.00], leaf_area: [49.0, 213.0], leaf_area_index: [2.1, 5.1], twig: 1.32, ..NONE },
    Known { name: "Douglas fir", slenderness: [0.0, 44.0, 0.0], width: [0.0, 0.57, 0.0], leaf_area: [110.0, 336.0], leaf_area_index: [3.6, 8.0], ..NONE },
    Known { name: "horse chestnut", slenderness: [15.0, 25.0, 37.0], width: [0.47, 0.73, 1.10], leaf_area: [40.0, 137.0], leaf_area_index: [2.2, 4.3], twig: 2.96, inclination: [36.0, 17.0], ..NONE },
    Known { name: "London plane", slenderness: [22.0, 34.0, 53.0], width: [0.54, 0.76, 1.07], leaf_area: [64.0, 249.0], leaf_area_index: [1.8, 3.9], twig: 1.19, inclination: [44.0, 16.0], ..NONE },
    Known { name: "weeping willow", slenderness: [11.0, 23.0, 51.0], width: [0.50, 0.90, 1.33], inclination: [31.0, 19.0], ..NONE },
    Known { name: "Lombardy poplar", slenderness: [24.0, 32.0, 44.0], width: [0.08, 0.14, 0.52], inclination: [44.0, 20.0], ..NONE },
    Known { name: "cottonwood", slenderness: [0.0, 40.0, 0.0], width: [0.0, 0.53, 0.0], leaf_area: [100.0, 304.0], leaf_area_index: [3.6, 6.5], twig: 1.21, ..NONE },
    Known { name: "cherry", slenderness: [12.0, 23.0, 38.0], width: [0.58, 1.00, 1.44], leaf_area: [31.0, 105.0], leaf_area_index: [1.5, 2.7], twig: 0.74, inclination: [50.0, 13.0], ..NONE },
    Known { name: "American elm", slenderness: [0.0, 29.0, 0.0], width: [0.0, 0.81, 0.0], leaf_area: [90.0, 288.0], leaf_area_index: [2.3, 5.3], twig: 0.85, inclination: [34.0, 18.0], ..NONE },
    Known { name: "apple", slenderness: [14.0, 26.0, 47.0], width: [0.62, 1.00, 1.50], leaf_area: [23.0, 106.0], leaf_area_index: [0.6, 2.2], angle: [67.0, 85.0], twig: 1.35, inclination: [29.0, 15.0] },
    Known { name: "walnut", slenderness: [0.0, 32.0, 0.0], width: [0.0, 0.80, 0.0], leaf_area: [118.0, 293.0], leaf_area_index: [2.4, 4.4], angle: [35.7, 48.3], twig: 2.58, inclination: [30.0, 17.0] },
    Known { name: "eucalyptus", slenderness: [0.0, 44.0, 0.0], width: [0.0, 0.44, 0.0], leaf_area: [66.0, 193.0], leaf_area_index: [1.6, 4.2], ..NONE },
    Known { name: "umbrella thorn", ..NONE },
    Known { name: "coconut palm", slenderness: [0.0, 53.0, 0.0], width: [0.0, 0.34, 0.0], ..NONE },
    Known { name: "Italian cypress", ..NONE },
    Known { name: "hazel", ..NONE },
];

/// Trees of 10 m in a stand of 2 m: slenderness p10, p50, p90, and the stem's form factor likewise.
pub(crate) const STANDS: [(&str, [f64; 3], [f64; 3]); 3] = [
    ("Scots pine", [53.0, 73.0, 96.0], [0.44, 0.49, 0.56]),
    ("Norway spruce", [63.0, 80.0, 100.0], [0.43, 0.48, 0.54]),
    ("silver birch", [72.0, 96.0, 127.0], [0.41, 0.46, 0.50]),
];

/// From the median to a quartile, where the 10th and 90th percentile are 1.
const QUARTILE: f32 = 0.674_49 / 1.281_55;

/// Quartiles of a log-normal distribution of which p10, p50 and p90 are known; 15% to either side of a median alone.
pub(crate) fn quartiles([p10, p50, p90]: [f64; 3]) -> Option<[f64; 2]> {
    if p50 <= 0.0 {
        return None;
    }
    if p10 <= 0.0 {
        return Some([p50 * 0.85, p50 * 1.15]);
    }
    let power = |ratio: f64| f64::from(math::powf(ratio as f32, QUARTILE));
    Some([p50 * power(p10 / p50), p50 * power(p90 / p50)])
}

impl Known {
    /// The range of each measure.
    pub(crate) fn ranges(&self) -> [Option<[f64; 2]>; COUNT] {
        let given = |range: [f64; 2]| (range[1] > 0.0).then_some(range);
        let about =
            |value: f64, part: f64| (value > 0.0).then_some([value * (1.0 - part), value * (1.0 + part)]);
        let level = self.inclination[0];
        let is_palm = self.name == "coconut palm";
        let at = match self.name {
            "eucalyptus" => [0.85, 0.66, 0.43],
            "Norway spruce" => [0.80, 0.64, 0.41],
            _ => [0.0; 3],
        };
        let at = at.map(|share: f64| (share > 0.0).then_some([share - 0.05, share + 0.05]));
        [
            quartiles(self.slenderness),
            quartiles(self.width),
            about(self.leaf_area[0], 1.0 / 3.0),
            about(self.leaf_area[1], 1.0 / 3.0),
            given(self.leaf_area_index),
            given(self.angle),
            about(self.twig, 0.135),
            (!is_palm).then_some([0.14, 0.26]),
            None,
            at[0],
            at[1],
            at[2],
            // A single leaning stem has no crown that grows to one side.
            (!is_palm).then_some([0.14, 0.35]),
            (!is_palm).then_some([0.13, 0.35]),
            (level > 0.0).then(|| [-1.0, 1.0].map(|side| level + side * 0.674_49 * self.inclination[1])),
        ]
    }
}
