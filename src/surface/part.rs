//! A mesh, how it looks and where it stands: what files and pictures are made of.

use super::{Material, Mesh, MeshError, SurfaceError, Transform};
use crate::ParameterError;
#[cfg(feature = "texture")]
use crate::texture::{TextureError, Textures};
use glam::{Mat3, Quat, Vec3};
use std::borrow::Cow;

/// Transform of one copy of a mesh: scaled, then rotated, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// New position of the mesh's origin, metres.
    pub position: Vec3,
    /// Rotation of the mesh; of length 1.
    pub rotation: Quat,
    /// Scale in all directions.
    pub scale: f32,
    /// The node of the skeleton whose internode bears it.
    pub node: u32,
    /// Factors on the colour of this copy: linear red, green and blue, each 0 to 1.
    pub tint: [f32; 3],
}

impl Instance {
    /// The mesh as it is, at the root.
    pub const IDENTITY: Self =
        Self { position: Vec3::ZERO, rotation: Quat::IDENTITY, scale: 1.0, node: 0, tint: [1.0; 3] };

    /// Rotation and scale: `matrix * point + self.position` is the copy of a point of the mesh.
    pub fn matrix(&self) -> Mat3 {
        self.rotation_matrix() * self.scale
    }

    /// The rotation as a matrix. Applying it takes the same steps on every platform, which a quaternion's own
    /// product does not.
    pub fn rotation_matrix(&self) -> Mat3 {
        Mat3::from_quat(self.rotation)
    }

    /// `true` if its colour differs from that of the mesh.
    pub fn is_tinted(&self) -> bool {
        self.tint.map(f32::to_bits) != [1.0_f32; 3].map(f32::to_bits)
    }

    /// The place alone.
    pub fn transform(&self) -> Transform {
        Transform { position: self.position, rotation: self.rotation, scale: self.scale }
    }

    /// `true` if the values are sound and a mesh that reaches `reach` metres from its origin has finite
    /// copies here.
    fn is_sound(&self, reach: f32) -> bool {
        let [x, y, z, w] = self.rotation.to_array();
        let length = x * x + y * y + z * z + w * w;
        let farthest = self.position.abs().max_element() + 2.0 * self.scale * reach;
        let tinted = self.tint.iter().all(|channel| (0.0..=1.0).contains(channel));
        tinted
            && (length - 1.0).abs() <= 2e-3
            && self.scale > 0.0
            && self.scale.is_finite()
            && farthest.is_finite()
    }
}

/// A mesh with a material and a name, once, or as often as there are instances.
///
/// Instances are never multiplied out in memory: files without instances get their copies one by one.
///
/// ```
/// use treesynth::surface::{Instance, Material, Mesh, Part};
///
/// let leaf = Mesh::default();
/// let twice = [Instance::IDENTITY; 2];
/// let part = Part::new(&leaf).with_name("leaves").with_material(Material::leaf()).with_instances(&twice);
/// assert_eq!(part.copies().len(), 2);
/// ```
#[must_use]
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    name: &'a str,
    mesh: &'a Mesh,
    material: Material,
    instances: Option<&'a [Instance]>,
    transform: Transform,
    #[cfg(feature = "texture")]
    textures: Option<&'a Textures>,
}

impl Mesh {
    /// All copies of it as one mesh, tints in its colours; wind is left out. O(vertices of all copies).
    pub(crate) fn merged(&self, copies: &[Instance]) -> Result<Self, SurfaceError> {
        let vertices = self.positions.len() * copies.len();
        if vertices > u32::MAX as usize {
            return Err(SurfaceError::TooLarge { vertices, most: u32::MAX as usize });
        }
        let mut mesh = Self::default();
        mesh.positions.reserve(vertices);
        mesh.normals.reserve(vertices);
        let colored = !self.colors.is_empty() || copies.iter().any(Instance::is_tinted);
        for copy in copies {
            let first = mesh.positions.len() as u32;
            let (matrix, rotation) = (copy.matrix(), copy.rotation_matrix());
            mesh.positions.extend(self.positions.iter().map(|&position| matrix * position + copy.position));
            mesh.normals.extend(self.normals.iter().map(|&normal| rotation * normal));
            let tangents = self.tangents.iter().map(|&t| (rotation * t.truncate()).extend(t.w));
            mesh.tangents.extend(tangents);
            mesh.uvs.extend_from_slice(&self.uvs);
            if colored {
                let color = |i: usize| self.colors.get(i).copied().unwrap_or([1.0; 3]);
                let tint = |i: usize| std::array::from_fn(|channel| color(i)[channel] * copy.tint[channel]);
                mesh.colors.extend((0..self.positions.len()).map(tint));
            }
            mesh.indices.extend(self.indices.iter().map(|index| first + index));
        }
        Ok(mesh)
    }
}

impl<'a> Part<'a> {
    /// A mesh once, with the default bark, named `bark`.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self {
            name: "bark",
            mesh,
            material: Material::default(),
            instances: None,
            transform: Transform::IDENTITY,
            #[cfg(feature = "texture")]
            textures: None,
        }
    }

    /// Name in files; default `bark`.
    pub fn with_name(mut self, name: &'a str) -> Self {
        self.name = name;
        self
    }

    /// Material; default [`Material::bark`].
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// The images that the mesh wears by its texture coordinates; default none.
    #[cfg(feature = "texture")]
    pub fn with_textures(mut self, textures: &'a Textures) -> Self {
        self.textures = Some(textures);
        self
    }

    /// A copy of the mesh at each of these places, instead of one at the root. May be empty.
    pub fn with_instances(mut self, instances: &'a [Instance]) -> Self {
        self.instances = Some(instances);
        self
    }

    /// Moves the whole part, its instances too; default [`Transform::IDENTITY`].
    pub fn with_transform(mut self, transform: Transform) -> Self {
        self.transform = transform;
        self
    }

    /// The same as [`with_transform`](Self::with_transform): scaled, then turned, then moved.
    pub fn at(self, position: Vec3, rotation: Quat, scale: f32) -> Self {
        self.with_transform(Transform { position, rotation, scale })
    }

    /// Its name.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// The mesh of one copy.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Material.
    pub fn material(&self) -> Material {
        self.material
    }

    /// The images that it wears, if any.
    #[cfg(feature = "texture")]
    pub fn textures(&self) -> Option<&'a Textures> {
        self.textures
    }

    /// Its instances, if it has been given any.
    pub fn instances(&self) -> Option<&'a [Instance]> {
        self.instances
    }

    /// Transform of the whole part.
    pub fn transform(&self) -> Transform {
        self.transform
    }

    /// Transforms of its copies, the part's own included. O(1) without a transform, else O(copies).
    pub fn placed(&self) -> Cow<'a, [Instance]> {
        if self.transform.is_identity() {
            return Cow::Borrowed(self.copies());
        }
        Cow::Owned(self.copies().iter().map(|copy| self.transform.instance(copy)).collect())
    }

    /// Transforms of its copies within the part: the instances, or the identity once.
    pub fn copies(&self) -> &'a [Instance] {
        self.instances.unwrap_or(&[Instance::IDENTITY])
    }

    /// Vertices of all copies.
    pub fn vertices(&self) -> u64 {
        self.mesh.positions.len() as u64 * self.copies().len() as u64
    }

    /// Triangles of all copies.
    pub fn triangles(&self) -> u64 {
        self.mesh.triangles().len() as u64 * self.copies().len() as u64
    }

    /// No vertex of any copy is farther from the origin along an axis, metres. O(vertices + instances).
    pub(crate) fn reach(&self) -> f32 {
        let mesh = self.mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
        let copies = self.placed();
        let reaches = copies.iter().map(|copy| copy.position.abs().max_element() + copy.scale * mesh);
        reaches.fold(0.0, f32::max)
    }

    /// Checks that the part can be written and drawn. O(vertices + triangles + instances).
    pub(crate) fn check<E: From<ParameterError> + From<MeshError>>(&self) -> Result<(), E> {
        self.material.check()?;
        self.transform.check("Part.transform")?;
        self.mesh.check_arrays()?;
        #[cfg(feature = "texture")]
        if let Some(textures) = self.textures {
            if let Err(TextureError::Parameter(error)) = textures.check() {
                return Err(error.into());
            }
            if self.mesh.uvs.is_empty() && !self.mesh.positions.is_empty() {
                return Err(MeshError::NoUvs { vertices: self.mesh.positions.len() }.into());
            }
        }
        let reach = self.mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        let unsound = |copies: &[Instance]| copies.iter().position(|copy| !copy.is_sound(2.0 * reach));
        let found = unsound(self.copies());
        let placed = || (!self.transform.is_identity()).then(|| unsound(&self.placed())).flatten();
        if let Some(index) = found.or_else(placed) {
            return Err(MeshError::Instance { index, instance: self.copies()[index] }.into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn instances_scale_turn_and_move() {
        let quarter = Quat::from_rotation_z(FRAC_PI_2);
        let instance = Instance { position: Vec3::Z, rotation: quarter, scale: 2.0, ..Instance::IDENTITY };
        let at = |point: Vec3| instance.matrix() * point + instance.position;
        assert!(at(Vec3::X).abs_diff_eq(Vec3::new(0.0, 2.0, 1.0), 1e-6));
        assert!(at(Vec3::Y).abs_diff_eq(Vec3::new(-2.0, 0.0, 1.0), 1e-6));
        assert_eq!(Instance::IDENTITY.matrix(), Mat3::IDENTITY);
    }

    #[test]
    fn unsound_instances_are_named() {
        let fine = Instance::IDENTITY;
        let mesh = Mesh::new(vec![Vec3::X * 10.0], vec![Vec3::X], Vec::new());
        let check = |instance: Instance| {
            let pair = [fine, instance];
            Part::new(&mesh).with_instances(&pair).check::<crate::export::ExportError>()
        };
        assert!(check(fine).is_ok());
        for wrong in [
            Instance { position: Vec3::NAN, ..fine },
            Instance { scale: 3e38, ..fine },
            Instance { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.5), ..fine },
            Instance { rotation: Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0), ..fine },
            Instance { scale: 0.0, ..fine },
            Instance { scale: f32::INFINITY, ..fine },
            Instance { tint: [1.0, f32::NAN, 1.0], ..fine },
        ] {
            let error = check(wrong).expect_err("not sound").to_string();
            assert!(error.contains("instance 1"), "{error}");
        }
    }
}
