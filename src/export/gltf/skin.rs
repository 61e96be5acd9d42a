//! A breeze in a glTF file: bones, skin weights and a looping animation, for viewers without a shader.

use super::array::Array;
use super::text::{list, numbers, push};
use crate::surface::{Air, Mesh, Part, Rig, SurfaceError, Sway, Transform, Wind};
use crate::{ParameterError, Skeleton};
use glam::{Quat, Vec3, Vec4};

/// Keys of the animation, the last like the first: eight for each swing of a twig.
const KEYS: usize = 81;

/// A breeze as an animation: a skeleton of few bones that sways for 8 seconds and begins again without a seam.
///
/// Meshes with [`Wind`] move: tubes, closed meshes, and leaves through
/// [`Leaves::mesh_in_wind`](crate::foliage::Leaves::mesh_in_wind). Instances, and parts with a
/// [transform](Part::with_transform), stand still, since glTF cannot bend them. Small branches go with the
/// bone of their parent branch, and every branch base has the weights of the place on its parent branch, so
/// that both move together. 24 bytes per vertex and 1.3 KB per bone.
///
/// ```
/// use treesynth::export::{self, Breeze, GlbOptions};
/// use treesynth::{presets, surface::Tubes};
///
/// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(1000).synthesize(1)?.relaxed(0.5, 3)?;
/// let mesh = Tubes::default().with_wind(true).mesh(&tree)?;
/// let options = GlbOptions::default().with_breeze(Breeze::of(&tree)?.with_bones(24));
/// export::write_glb(&mesh, &options, std::io::sink())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "Saved"))]
pub struct Breeze {
    skeleton: Skeleton,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    sway: Sway,
    gust: Vec3,
    bones: usize,
}

/// Form of a [`Breeze`] in files.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    skeleton: Skeleton,
    gust: Vec3,
    bones: usize,
}

#[cfg(feature = "serde")]
impl TryFrom<Saved> for Breeze {
    type Error = SurfaceError;

    fn try_from(Saved { skeleton, gust, bones }: Saved) -> Result<Self, SurfaceError> {
        Ok(Self { gust, bones, ..Self::of(&skeleton)? })
    }
}

crate::recipe::readable!(Breeze { gust: Vec3, bones: usize });

impl Breeze {
    /// A breeze along +X of 0.4 of the strongest gust, by at most 64 bones.
    ///
    /// # Errors
    /// Radii that are all zero; a node more than a million kilometres out or thick.
    pub fn of(skeleton: &Skeleton) -> Result<Self, SurfaceError> {
        let sway = Sway::of(skeleton)?;
        Ok(Self { skeleton: skeleton.clone(), sway, gust: Vec3::X * 0.4, bones: 64 })
    }

    /// Direction in which the wind blows; its length is the strength, at most 1 for the strongest
    /// [gust](Wind::blown). Default 0.4 along +X.
    pub fn with_gust(mut self, gust: Vec3) -> Self {
        self.gust = gust;
        self
    }

    /// Greatest number of bones, 2 to 1024; default 64: the trunk has up to five, the largest limbs and twigs
    /// one each.
    pub fn with_bones(mut self, most: usize) -> Self {
        self.bones = most;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let holds = (2..=1024).contains(&self.bones);
        ParameterError::unless(holds, "Breeze.bones", self.bones, "2 to 1024")?;
        let holds = self.gust.is_finite() && self.gust.length() <= 1.0 + 1e-6;
        ParameterError::unless(holds, "Breeze.gust", self.gust, "finite and at most 1 long")
    }
}

/// A mesh, and its vertices' bones and weights.
type Skinned<'a> = (&'a Mesh, Vec<[u16; 4]>, Vec<Vec4>);

/// All that a file has of a breeze.
#[derive(Debug)]
pub(super) struct Skins<'a> {
    pub(super) rig: Rig,
    /// All that move.
    meshes: Vec<Skinned<'a>>,
    pub(super) inverses: Vec<[f32; 16]>,
    pub(super) times: Vec<f32>,
    /// Rotations of each bone but the first, which stands still.
    pub(super) turns: Vec<Vec<Vec4>>,
}

impl<'a> Skins<'a> {
    pub(super) fn new(breeze: &Breeze, parts: &[Part<'a>]) -> Result<Self, ParameterError> {
        breeze.check()?;
        let nodes = breeze.skeleton.len();
        let rig = Rig::of(&breeze.skeleton, &breeze.sway, breeze.bones);
        let mut meshes: Vec<Skinned<'_>> = Vec::new();
        for part in parts.iter().filter(|part| moves(part)) {
            let mesh = part.mesh();
            let last = mesh.wind.iter().map(|wind| wind.node).max().unwrap_or(0);
            let range = "wind of the skeleton that the breeze is of";
            ParameterError::unless((last as usize) < nodes, "GlbOptions.breeze", breeze.gust, range)?;
            if !meshes.iter().any(|other| std::ptr::eq(other.0, mesh)) {
                let (bones, weights) = rig.skin(mesh);
                meshes.push((mesh, bones, weights));
            }
        }
        let inverse = |at: Vec3| {
            let [x, y, z] = (-at).to_array();
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
        };
        let inverses = rig.joints.iter().map(|joint| inverse(joint.position)).collect();
        let times: Vec<f32> = (0..KEYS).map(|key| key as f32 / (KEYS - 1) as f32 * Wind::PERIOD).collect();
        let turn = |bone: usize, key: usize| {
            let time = if key + 1 < KEYS { times[key] } else { 0.0 };
            let turn = Air::new(time, breeze.gust).map_or(Quat::IDENTITY, |air| rig.rotation(bone, &air));
            Vec4::from_array(turn.to_array())
        };
        let turns =
            (1..rig.joints.len()).map(|bone| (0..KEYS).map(|key| turn(bone, key)).collect()).collect();
        Ok(Self { rig, meshes, inverses, times, turns })
    }

    /// The attributes of a mesh in addition to its own; none if it stands still.
    pub(super) fn attributes(&self, mesh: &Mesh) -> Option<[(&'static str, Array<'_>); 2]> {
        let (_, bones, weights) = self.meshes.iter().find(|other| std::ptr::eq(other.0, mesh))?;
        Some([("JOINTS_0", Array::Bones(bones)), ("WEIGHTS_0", Array::Weights(weights))])
    }

    /// The nodes of the bones, the first of which has the number `first`.
    pub(super) fn nodes(&self, first: usize) -> impl Iterator<Item = String> {
        let joints = &self.rig.joints;
        joints.iter().enumerate().map(move |(number, joint)| {
            let parent = joint.parent.map_or(Vec3::ZERO, |parent| joints[usize::from(parent)].position);
            let at = numbers(&(joint.position - parent).to_array());
            let mut node = format!(r#"{{"name":"bone {number}","translation":{at}"#);
            let borne = (0..joints.len()).filter(|&i| joints[i].parent.map(usize::from) == Some(number));
            let children = list(borne, |child| (first + child).to_string());
            if !children.is_empty() {
                push(&mut node, format_args!(r#","children":[{children}]"#));
            }
            node + "}"
        })
    }
}

/// The skin and the animation in a file.
#[derive(Debug)]
pub(super) struct Animation {
    /// The node of the first bone, and how many there are.
    pub(super) first: usize,
    pub(super) bones: usize,
    /// Accessors.
    pub(super) inverses: usize,
    pub(super) times: usize,
    pub(super) turns: Vec<usize>,
}

impl Animation {
    pub(super) fn text(&self) -> String {
        let Self { first, bones, inverses, times, turns } = self;
        let joints = list(*first..first + bones, |joint| joint.to_string());
        let channels = list(1..*bones, |bone| {
            format!(r#"{{"sampler":{},"target":{{"node":{},"path":"rotation"}}}}"#, bone - 1, first + bone)
        });
        let samplers =
            list(turns, |turns| format!(r#"{{"input":{times},"interpolation":"LINEAR","output":{turns}}}"#));
        format!(
            concat!(
                r#""skins":[{{"inverseBindMatrices":{inverses},"skeleton":{first},"joints":[{joints}]}}],"#,
                r#""animations":[{{"name":"breeze","channels":[{channels}],"samplers":[{samplers}]}}],"#,
            ),
            inverses = inverses,
            first = first,
            joints = joints,
            channels = channels,
            samplers = samplers,
        )
    }
}

/// `true` if a part can move: it stands in one place, which is its own, and has wind.
pub(super) fn moves(part: &Part<'_>) -> bool {
    part.instances().is_none() && part.transform() == Transform::IDENTITY && !part.mesh().wind.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::{GlbOptions, write_glb, write_glb_levels, write_glb_parts};
    use crate::foliage::{Foliage, Leaf};
    use crate::presets;
    use crate::surface::{Material, Tubes};

    #[test]
    fn a_breeze_is_whole() {
        let preset = presets::by_name("figure-06b").expect("a preset").guided().unwrap();
        let tree = preset.synth(1500).synthesize(1).expect("a tree").relaxed(0.5, 3).expect("sound options");
        let mesh = Tubes::default().with_wind(true).mesh(&tree).expect("a mesh");
        let leaves = Foliage::new(Leaf::ovate()).place(&tree, 1).expect("leaves");
        let breeze = Breeze::of(&tree).expect("radii").with_bones(20);
        let merged = leaves.mesh_in_wind(&breeze.sway).expect("few leaves");
        let parts = [
            Part::new(&mesh),
            Part::new(&merged).with_name("leaves").with_material(Material::leaf()),
            leaves.part(),
        ];
        let options = GlbOptions::default().with_breeze(breeze.clone());
        let mut glb = Vec::new();
        write_glb_parts(&parts, &options, &mut glb).expect("sound");
        let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
        let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).expect("valid JSON");
        let joints = json["skins"][0]["joints"].as_array().expect("joints");
        assert_eq!(joints.len(), 20);
        assert_eq!(json["animations"][0]["channels"].as_array().map(Vec::len), Some(19));
        let nodes = json["nodes"].as_array().expect("nodes");
        let skinned = nodes.iter().filter(|node| node["skin"] == 0 && node["mesh"].is_u64());
        assert_eq!(skinned.count(), 2);
        // Every node but the scene's is a child once.
        let roots = json["scenes"][0]["nodes"].as_array().expect("roots").clone();
        let children = nodes.iter().filter_map(|node| node["children"].as_array()).flatten().cloned();
        let mut all: Vec<u64> =
            roots.into_iter().chain(children).map(|node| node.as_u64().expect("a number")).collect();
        all.sort_unstable();
        assert_eq!(all, (0..nodes.len() as u64).collect::<Vec<_>>());

        let write =
            |breeze: Breeze| write_glb(&mesh, &GlbOptions::default().with_breeze(breeze), std::io::sink());
        for wrong in [
            breeze.clone().with_bones(1),
            breeze.clone().with_gust(Vec3::X * 2.0),
            breeze.clone().with_gust(Vec3::NAN),
        ] {
            assert!(write(wrong).expect_err("out of range").to_string().contains("Breeze."));
        }
        let levels = [[Part::new(&mesh)], [Part::new(&mesh)]];
        assert!(write_glb_levels(&levels, &options, std::io::sink()).is_err());
        let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])
            .and_then(|s| s.with_radii(vec![0.1; 2]));
        let other = Breeze::of(&pole.expect("sound")).expect("radii");
        assert!(write(other).expect_err("of another tree").to_string().contains("GlbOptions.breeze"));
    }
}
