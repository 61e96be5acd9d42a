//! Images as a rasterizer reads them.

use crate::math;
use crate::surface::Mesh;
use crate::texture::{self, Image, Textures};
use glam::{Vec2, Vec3, Vec4};

/// The colours and normals of some textures, in all sizes.
#[derive(Debug)]
pub(super) struct Skin {
    color: Vec<Image>,
    normal: Vec<Image>,
    cutoff: Option<f32>,
    /// Linear values of the 256 tones.
    linear: Vec<f32>,
}

/// Look of a skin at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texel {
    pub(super) color: [f32; 3],
    /// Normal in tangent space.
    pub(super) normal: Vec3,
    /// The tangent at the triangle's first corner, if there is a normal map.
    pub(super) tangent: Option<Vec4>,
}

/// A skin on a triangle, at the size at which it is seen.
#[derive(Debug)]
pub(super) struct SkinOn<'a> {
    skin: &'a Skin,
    uvs: [Vec2; 3],
    level: usize,
    tangent: Option<Vec4>,
}

impl Skin {
    pub(super) fn new(textures: &Textures) -> Self {
        let cutoff = textures.alpha_cutoff().filter(|_| textures.is_masked());
        Self {
            color: textures.base_color().map(|image| texture::mips(image, cutoff)).unwrap_or_default(),
            normal: textures.normal().map(texture::normal_mips).unwrap_or_default(),
            cutoff,
            linear: (0..256).map(|tone| math::linear(tone as f32 / 255.0)).collect(),
        }
    }

    /// The skin on a triangle; `area` is twice the triangle's area in the picture, in points.
    pub(super) fn on(&self, mesh: &Mesh, triangle: [u32; 3], area: f32) -> SkinOn<'_> {
        let uvs = triangle.map(|corner| mesh.uvs.get(corner as usize).copied().unwrap_or_default());
        let tangent = mesh.tangents.get(triangle[0] as usize).copied().filter(|_| !self.normal.is_empty());
        let size = self
            .color
            .first()
            .map_or(Vec2::ONE, |image| Vec2::new(image.width() as f32, image.height() as f32));
        // Texels per point, then halved in both directions until there is about one.
        let mut texels = ((uvs[1] - uvs[0]) * size).perp_dot((uvs[2] - uvs[0]) * size).abs() / area;
        let mut level = 0;
        while texels > 2.0 && level + 1 < self.color.len() {
            texels *= 0.25;
            level += 1;
        }
        SkinOn { skin: self, uvs, level, tangent }
    }
}

impl SkinOn<'_> {
    /// The place on the images with these barycentric coordinates.
    #[inline]
    pub(super) fn place(&self, u: f32, v: f32, w: f32) -> Place {
        let uv = self.uvs[0] * u + self.uvs[1] * v + self.uvs[2] * w;
        Place { uv, near: self.skin.color.get(self.level).map(|image| Near::new(image, uv)) }
    }

    /// `true` if there is a hole.
    #[inline]
    pub(super) fn is_hole(&self, place: &Place) -> bool {
        let (Some(cutoff), Some(near)) = (self.skin.cutoff, &place.near) else { return false };
        let bytes = self.skin.color[self.level].bytes();
        near.mean(|at| f32::from(bytes[at + 3])) < cutoff * 255.0
    }

    /// The surface there.
    #[inline]
    pub(super) fn texel(&self, place: &Place) -> Texel {
        let mut texel = Texel { color: [1.0; 3], normal: Vec3::Z, tangent: self.tangent };
        if let Some(near) = &place.near {
            let (linear, bytes) = (&self.skin.linear, self.skin.color[self.level].bytes());
            texel.color = [0, 1, 2].map(|i| near.mean(|at| linear[usize::from(bytes[at + i])]));
        }
        if let Some(image) = self.skin.normal.get(self.level.min(self.skin.normal.len().max(1) - 1)) {
            let (near, bytes) = (Near::new(image, place.uv), image.bytes());
            let mean = [0, 1, 2].map(|i| near.mean(|at| f32::from(bytes[at + i])) / 127.5 - 1.0);
            texel.normal = Vec3::from_array(mean);
        }
        texel
    }
}

/// A place on the images of a skin.
pub(super) struct Place {
    uv: Vec2,
    /// Among the colours, if there are any.
    near: Option<Near>,
}

/// The four texels about a point, where each begins among the image's bytes, and how near it is.
struct Near {
    starts: [usize; 4],
    weights: [f32; 4],
}

impl Near {
    #[inline]
    fn new(image: &Image, uv: Vec2) -> Self {
        let (width, height) = (image.width(), image.height());
        let at = uv * Vec2::new(width as f32, height as f32) - Vec2::splat(0.5);
        let low = Vec2::new(math::floor(at.x), math::floor(at.y));
        let Vec2 { x, y } = at - low;
        let wrap = |i: f32, count: u32| {
            let whole = i as i64;
            // Mostly it is in the image, and needs no division.
            if (0..i64::from(count)).contains(&whole) {
                whole as usize
            } else {
                whole.rem_euclid(i64::from(count)) as usize
            }
        };
        let (left, right) = (wrap(low.x, width), wrap(low.x + 1.0, width));
        let (top, bottom) = (wrap(low.y, height), wrap(low.y + 1.0, height));
        let [top, bottom] = [top, bottom].map(|row| row * width as usize);
        let channels = usize::from(image.channels());
        Self {
            starts: [top + left, top + right, bottom + left, bottom + right].map(|at| at * channels),
            weights: [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y],
        }
    }

    #[inline]
    fn mean(&self, of: impl Fn(usize) -> f32) -> f32 {
        let texel = |i: usize| of(self.starts[i]) * self.weights[i];
        texel(0) + texel(1) + texel(2) + texel(3)
    }
}
