//! The look of a leaf.

use super::sketch::{self, Blade, Sketch};
use crate::math;
use crate::surface::{Material, Mesh};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// One leaf, or a twig with its leaves: a mesh and how it looks.
///
/// The mesh stands as it would on a twig that grows at its origin: the base at the origin, the midrib along
/// +Y, the upper side towards +Z. The leaves built in are 1 long from the base of the blade to its tip,
/// without the petiole; their triangles are seen from both sides through their [`Material`], so that none is
/// doubled.
///
/// ```
/// use treesynth::foliage::Leaf;
///
/// let leaf = Leaf::ovate().with_petiole(0.3);
/// let top = leaf.mesh().bounds().unwrap().max.y;
/// assert!((top - 1.3).abs() < 1e-6);
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[doc(alias = "needle")]
pub struct Leaf {
    mesh: Mesh,
    material: Material,
}

impl Leaf {
    /// A leaf, twig or flower of your own, in the green of [`Material::leaf`]; its base at the origin, the
    /// midrib along +Y, the upper side towards +Z.
    pub fn new(mesh: Mesh) -> Self {
        Self { mesh, material: Material::leaf() }
    }

    /// Broadest below the middle, short tip: elm, beech, cherry, hazel. 8 triangles.
    pub fn ovate() -> Self {
        Self::of(&[Blade::along(&[(0.0, 0.0), (0.28, 0.3), (0.66, 0.23), (1.0, 0.0)])])
    }

    /// As broad as long, with a drawn-out tip: birch, poplar, linden. 8 triangles.
    pub fn deltoid() -> Self {
        Self::of(&[Blade::along(&[(0.0, 0.0), (0.2, 0.41), (0.5, 0.3), (1.0, 0.0)])])
    }

    /// Long and narrow: willow, olive. 8 triangles.
    pub fn lanceolate() -> Self {
        Self::of(&[Blade::along(&[(0.0, 0.0), (0.3, 0.085), (0.65, 0.075), (1.0, 0.0)]).curled(0.14)])
    }

    /// Five pointed lobes that spread from the base: maple, plane, sweet gum. 13 triangles.
    pub fn lobed() -> Self {
        let mut sketch = Sketch::default();
        sketch.star(
            Vec3::new(0.0, 0.34, 0.0),
            &[(0.0, 1.0), (0.1, 0.62), (0.48, 0.76), (0.3, 0.42), (0.5, 0.28), (0.26, 0.12), (0.08, 0.0)],
        );
        Self::new(sketch.finish())
    }

    /// Round lobes on both sides of the midrib, broadest above the middle: oak. 20 triangles.
    pub fn sinuate() -> Self {
        let profile =
            [(0.0, 0.0), (0.22, 0.17), (0.34, 0.1), (0.5, 0.27), (0.6, 0.17), (0.76, 0.29), (1.0, 0.0)];
        Self::of(&[Blade::along(&profile)])
    }

    /// Leaflets in five pairs along a rachis and one at its end: ash, rowan, walnut. 46 triangles.
    pub fn pinnate() -> Self {
        Self::new(sketch::pinnate(5))
    }

    /// Seven leaflets that spread from one point: horse chestnut. 28 triangles.
    pub fn palmate() -> Self {
        Self::new(sketch::palmate(7))
    }

    /// One needle, a sixteenth as wide as long: pine, larch. 2 triangles.
    pub fn needle() -> Self {
        Self::of(&[Blade { fold: 0.0, ..Blade::along(&[(0.0, 0.0), (0.4, 0.03), (1.0, 0.0)]) }])
    }

    /// A shoot with 36 needles in a spiral about it: spruce, fir, yew. 74 triangles; to be placed with the angle 0.
    pub fn needles() -> Self {
        Self::new(sketch::shoot(36))
    }

    /// A bud, pointed, a third as thick as long, in the brown of its scales. 15 triangles.
    pub fn bud() -> Self {
        const SIDES: u32 = 5;
        // Distance along the axis and radius of each ring; the tip follows.
        let rings = [(0.0, 0.07), (0.35, 0.165)];
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for (along, radius) in rings {
            for side in 0..SIDES {
                let (sin, cos) = math::sin_cos(side as f32 / SIDES as f32 * TAU);
                positions.push(Vec3::new(radius * cos, along, radius * sin));
                normals.push(Vec3::new(cos, 0.3, sin).normalize());
            }
        }
        positions.push(Vec3::Y);
        normals.push(Vec3::Y);
        let mut indices = Vec::new();
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let (low, high, tip) = ([side, next], [SIDES + side, SIDES + next], 2 * SIDES);
            indices.extend([low[0], high[0], low[1], low[1], high[0], high[1], high[0], tip, high[1]]);
        }
        let uvs = positions.iter().map(|p| Vec2::new(0.5 + p.x, p.y)).collect();
        let mesh = Mesh { uvs, ..Mesh::new(positions, normals, indices) };
        Self::new(mesh).with_material(Material::bark().with_srgb([128, 92, 58]))
    }

    fn of(blades: &[Blade<'_>]) -> Self {
        let mut sketch = Sketch::default();
        for blade in blades {
            sketch.blade(blade);
        }
        Self::new(sketch.finish())
    }

    /// Moves the mesh by `length` along +Y and puts a stalk under it, a thirtieth of the mesh's length wide;
    /// 2 triangles. In the mesh's own unit, so 0.3 on a built-in leaf is 0.3 of the blade's length. Nothing
    /// happens if `length` is not positive and finite, or there is no mesh.
    pub fn with_petiole(mut self, length: f32) -> Self {
        if let Some(bounds) = self.mesh.bounds().filter(|_| length > 0.0 && length.is_finite()) {
            sketch::add_petiole(&mut self.mesh, length, bounds.size().y / 60.0);
        }
        self
    }

    /// Material; default [`Material::leaf`].
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// Its triangles.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Material.
    pub fn material(&self) -> Material {
        self.material
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every leaf built in, and the triangles its documentation promises.
    fn all() -> [(Leaf, usize); 9] {
        [
            (Leaf::ovate(), 8),
            (Leaf::deltoid(), 8),
            (Leaf::lanceolate(), 8),
            (Leaf::lobed(), 13),
            (Leaf::sinuate(), 20),
            (Leaf::pinnate(), 46),
            (Leaf::palmate(), 28),
            (Leaf::needle(), 2),
            (Leaf::needles(), 74),
        ]
    }

    #[test]
    fn built_in_leaves_are_sound_and_one_long() {
        for (leaf, triangles) in all() {
            let mesh = leaf.mesh();
            assert_eq!(mesh.check(), Ok(()));
            assert_eq!((mesh.triangles().len(), mesh.uvs.len()), (triangles, mesh.positions.len()));
            let bounds = mesh.bounds().expect("there are vertices");
            assert!((bounds.max.y - 1.0).abs() < 1e-6 && bounds.min.y > -0.4, "{bounds:?}");
            assert!(mesh.uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()));
            assert!(leaf.material().is_double_sided());
        }
    }

    #[test]
    fn blades_face_up_and_are_symmetric() {
        for (leaf, _) in all().into_iter().take(8) {
            let mesh = leaf.mesh();
            assert!(mesh.normals.iter().all(|normal| normal.z > 0.5));
            let lean: f32 = mesh.positions.iter().map(|p| p.x).sum();
            assert!(lean.abs() < 1e-4, "{lean}");
        }
    }

    #[test]
    fn needles_stand_all_around() {
        let mesh = Leaf::needles().mesh;
        let bounds = mesh.bounds().expect("there are vertices");
        assert!(bounds.min.x < -0.2 && bounds.max.x > 0.2 && bounds.min.z < -0.2 && bounds.max.z > 0.2);
    }

    #[test]
    fn a_petiole_lifts_any_mesh() {
        let blade = Leaf::lobed();
        let stalked = blade.clone().with_petiole(0.5);
        assert_eq!(stalked.mesh.check(), Ok(()));
        assert_eq!(stalked.mesh.triangles().len(), blade.mesh.triangles().len() + 2);
        for (before, after) in blade.mesh.positions.iter().zip(&stalked.mesh.positions) {
            assert_eq!(*after, *before + Vec3::Y * 0.5);
        }
        for none in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(blade.clone().with_petiole(none), blade);
        }
        assert_eq!(Leaf::new(Mesh::default()).with_petiole(1.0).mesh, Mesh::default());
        let own = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
        assert_eq!(
            Leaf::new(own).with_petiole(1.0).mesh.check(),
            Ok(()),
            "a mesh without texture coordinates"
        );
    }
}
