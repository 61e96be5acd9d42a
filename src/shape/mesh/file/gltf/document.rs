//! The JSON of a glTF file, as far as shapes need it.

use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;

use super::fault;
use crate::shape::TriangleMeshError;

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    extensions_required: Vec<String>,
    scene: Option<usize>,
    scenes: Vec<SceneNodes>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<View>,
    pub(super) buffers: Vec<Buffer>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Asset {
    version: String,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct SceneNodes {
    nodes: Vec<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Node {
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    pub(super) extensions: Option<NodeExtensions>,
}

#[derive(Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
}

#[derive(Deserialize)]
pub(super) struct Instancing {
    pub(super) attributes: InstanceAttributes,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstanceAttributes {
    pub(super) translation: Option<usize>,
    pub(super) rotation: Option<usize>,
    pub(super) scale: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u64>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct Attributes {
    pub(super) position: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    #[serde(default)]
    pub(super) component_type: u32,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: usize,
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: usize,
}

impl Document {
    /// Refuses what cannot be read at all.
    pub(super) fn check(&self) -> Result<(), TriangleMeshError> {
        let version = &self.asset.version;
        if !version.starts_with("2.") && !version.is_empty() {
            let version: String = version.chars().take(20).collect();
            return Err(fault("asset", format!("the version is {version:?}, but must be 2.0")));
        }
        let compressed =
            self.extensions_required.iter().find(|name| name.contains("draco") || name.contains("meshopt"));
        match compressed {
            Some(name) => {
                let name: String = name.chars().take(60).collect();
                Err(fault(
                    "extensionsRequired",
                    format!("its meshes are compressed by {name}; save it without"),
                ))
            }
            None => Ok(()),
        }
    }

    /// The nodes that a scene begins with.
    pub(super) fn roots(&self) -> Result<Vec<usize>, TriangleMeshError> {
        let number = self.scene.unwrap_or(0);
        match self.scenes.get(number) {
            Some(scene) => Ok(scene.nodes.clone()),
            None if self.scenes.is_empty() => {
                let mut is_child = vec![false; self.nodes.len()];
                for &child in self.nodes.iter().flat_map(|node| &node.children) {
                    is_child.get_mut(child).into_iter().for_each(|is_child| *is_child = true);
                }
                Ok((0..self.nodes.len()).filter(|&node| !is_child[node]).collect())
            }
            None => {
                Err(fault(format_args!("scene {number}"), format!("there are {} scenes", self.scenes.len())))
            }
        }
    }
}

impl Node {
    pub(super) fn matrix(&self) -> DMat4 {
        if let Some(matrix) = &self.matrix {
            return DMat4::from_cols_array(matrix);
        }
        DMat4::from_scale_rotation_translation(
            self.scale.map_or(DVec3::ONE, DVec3::from_array),
            self.rotation.map_or(DQuat::IDENTITY, |rotation| self::rotation(&rotation)),
            self.translation.map_or(DVec3::ZERO, DVec3::from_array),
        )
    }
}

/// A quaternion x, y, z, w of length 1, made so if it is not.
pub(super) fn rotation(values: &[f64]) -> DQuat {
    let quaternion = DQuat::from_slice(values);
    let length = (quaternion.x * quaternion.x
        + quaternion.y * quaternion.y
        + quaternion.z * quaternion.z
        + quaternion.w * quaternion.w)
        .sqrt();
    if length > 0.0 && length.is_finite() { quaternion * (1.0 / length) } else { DQuat::IDENTITY }
}
