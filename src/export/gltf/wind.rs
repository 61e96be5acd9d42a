//! The wind of vertices as glTF attributes.

use crate::surface::{Mesh, Wind};
use glam::Vec3;

/// Encoding of the vertices' [`Wind`] in a glTF file.
///
/// ```
/// use treesynth::export::{GlbOptions, WindEncoding};
///
/// // For engines that drop attributes they do not know.
/// let options = GlbOptions::default().with_wind(WindEncoding::TexCoords);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum WindEncoding {
    /// Attributes of our own, 64 bytes per vertex: `_WIND_TRUNK`, `_WIND_LIMB` and `_WIND_TWIG` (VEC3, the
    /// moments), `_WIND_LIMB_AXIS` and `_WIND_TWIG_AXIS` (VEC3) and `_WIND_FLUTTER` (SCALAR, metres).
    /// three.js has them under their names in lower case.
    #[default]
    Attributes,
    /// `TEXCOORD_1` to `TEXCOORD_7`, 56 bytes per vertex, which engines read that drop unknown attributes. In
    /// this order: trunk x and y; trunk z and flutter; limb x and y; limb z and twig z; twig x and y; limb
    /// axis; twig axis. An axis is two numbers by the octahedral map (Cigolle et al. 2014), -1 to 1.
    TexCoords,
    /// No wind in the file.
    None,
}

/// Part of the wind that an attribute holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Column {
    Moment(usize),
    Axis(usize),
    Flutter,
    /// One of the pairs above; pair 0 is zero.
    Pair(usize),
}

impl Column {
    /// Numbers per vertex.
    pub(super) fn words(self) -> usize {
        match self {
            Self::Moment(_) | Self::Axis(_) => 3,
            Self::Pair(_) => 2,
            Self::Flutter => 1,
        }
    }

    /// The numbers of this column; only the first [`words`](Self::words) of them count.
    pub(super) fn of(self, wind: &Wind) -> [f32; 3] {
        let [trunk, limb, twig] = wind.moments;
        let pair = |[x, y]: [f32; 2]| [x, y, 0.0];
        match self {
            Self::Moment(level) => wind.moments[level].to_array(),
            Self::Axis(level) => wind.axes[level].to_array(),
            Self::Flutter => [wind.flutter, 0.0, 0.0],
            Self::Pair(1) => [trunk.x, trunk.y, 0.0],
            Self::Pair(2) => [trunk.z, wind.flutter, 0.0],
            Self::Pair(3) => [limb.x, limb.y, 0.0],
            Self::Pair(4) => [limb.z, twig.z, 0.0],
            Self::Pair(5) => [twig.x, twig.y, 0.0],
            Self::Pair(6) => pair(octahedral(wind.axes[0])),
            Self::Pair(7) => pair(octahedral(wind.axes[1])),
            Self::Pair(_) => [0.0; 3],
        }
    }
}

/// The attributes that carry a mesh's wind.
pub(super) fn columns(mesh: &Mesh, encoding: WindEncoding) -> Vec<(&'static str, Column)> {
    const SETS: [&str; 8] = [
        "TEXCOORD_0",
        "TEXCOORD_1",
        "TEXCOORD_2",
        "TEXCOORD_3",
        "TEXCOORD_4",
        "TEXCOORD_5",
        "TEXCOORD_6",
        "TEXCOORD_7",
    ];
    match encoding {
        _ if mesh.wind.is_empty() => Vec::new(),
        WindEncoding::None => Vec::new(),
        WindEncoding::Attributes => vec![
            ("_WIND_TRUNK", Column::Moment(0)),
            ("_WIND_LIMB", Column::Moment(1)),
            ("_WIND_TWIG", Column::Moment(2)),
            ("_WIND_LIMB_AXIS", Column::Axis(0)),
            ("_WIND_TWIG_AXIS", Column::Axis(1)),
            ("_WIND_FLUTTER", Column::Flutter),
        ],
        // Sets are to be numbered without a gap.
        WindEncoding::TexCoords => {
            (usize::from(!mesh.uvs.is_empty())..8).map(|set| (SETS[set], Column::Pair(set))).collect()
        }
    }
}

/// A unit vector as a point of the square from -1 to 1; zero as zero.
fn octahedral(axis: Vec3) -> [f32; 2] {
    let sum = axis.abs().element_sum();
    if sum == 0.0 {
        return [0.0; 2];
    }
    let [x, y] = [axis.x / sum, axis.y / sum];
    if axis.z >= 0.0 { [x, y] } else { [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_come_back_as_shaders_decode_them() {
        for i in 0..1000u32 {
            let coordinate = |k: u32| (i * (7 * k + 3) % 101) as f32 - 50.0;
            let axis = Vec3::new(coordinate(1), coordinate(2), coordinate(5)).normalize_or(-Vec3::Z);
            let [x, y] = octahedral(axis);
            let mut back = Vec3::new(x, y, 1.0 - x.abs() - y.abs());
            let folded = (-back.z).max(0.0);
            back.x -= folded.copysign(back.x);
            back.y -= folded.copysign(back.y);
            assert!(back.normalize().distance(axis) < 1e-6, "{axis} {back}");
        }
        assert_eq!(octahedral(Vec3::ZERO).map(f32::to_bits), [0; 2]);
    }
}
