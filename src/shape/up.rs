//! Which way is up in a file.

/// The axis that points up in a model file. In this crate it is always +Y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum UpAxis {
    /// +Y, as in glTF, OBJ and this crate.
    #[default]
    Y,
    /// +Z, as in Blender, in most STL and PLY files, for printers and point clouds. What is +Y here is +Z there, and
    /// what is +Z here is -Y there.
    Z,
}
