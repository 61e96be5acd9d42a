//! The camera of a picture.

use super::PreviewError;
use super::ray::Ray;
use crate::ParameterError;
use crate::math;
use crate::shape::Bounds;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Projection.
///
/// ```
/// use treesynth::preview::{Camera, Projection};
///
/// // An elevation, as an architect draws it.
/// let camera = Camera::default().with_projection(Projection::Orthographic).with_elevation(0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Projection {
    /// As an eye sees: what is farther is smaller.
    Perspective {
        /// The angle between the picture's upper and lower edge, radians, 0.01 to 2.5.
        field_of_view: f32,
    },
    /// As a plan shows: one scale at every depth.
    Orthographic,
}

/// A camera that looks from a direction and stands where everything fits into the picture.
///
/// The default frame fits the meshes shown, exactly; [`with_frame`](Self::with_frame) fixes the
/// frame, so that several pictures have one scale.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Camera {
    azimuth: f32,
    elevation: f32,
    projection: Projection,
    margin: f32,
    frame: Option<Bounds>,
}

crate::recipe::readable!(Camera {
    azimuth: f32, elevation: f32, projection: Projection, margin: f32, frame: Option<Bounds>,
});

impl Default for Camera {
    /// From the front (+Z), 0.12 rad (7°) above the horizon, a perspective of 0.5 rad (29°), a margin of 0.04.
    fn default() -> Self {
        Self {
            azimuth: 0.0,
            elevation: 0.12,
            projection: Projection::Perspective { field_of_view: 0.5 },
            margin: 0.04,
            frame: None,
        }
    }
}

impl Camera {
    /// The direction it stands in, radians about the up axis: 0 is +Z, π/2 is +X; default 0.
    pub fn with_azimuth(mut self, azimuth: f32) -> Self {
        self.azimuth = azimuth;
        self
    }

    /// The angle at which it looks down, radians, -π/2 to π/2; default 0.12.
    pub fn with_elevation(mut self, elevation: f32) -> Self {
        self.elevation = elevation;
        self
    }

    /// Projection; default a perspective of 0.5 rad.
    pub fn with_projection(mut self, projection: Projection) -> Self {
        self.projection = projection;
        self
    }

    /// The empty border on each side, as a part of the picture's width or height, 0 to 0.45; default 0.04.
    pub fn with_margin(mut self, margin: f32) -> Self {
        self.margin = margin;
        self
    }

    /// Frames a box instead of what it is shown. Triangles that reach behind the camera are left out.
    pub fn with_frame(mut self, bounds: Bounds) -> Self {
        self.frame = Some(bounds);
        self
    }

    /// Turned on by this angle about the up axis, radians.
    pub(super) fn turned(self, angle: f32) -> Self {
        let azimuth = self.azimuth + angle;
        self.with_azimuth(azimuth)
    }

    pub(super) fn check(&self) -> Result<(), PreviewError> {
        ParameterError::unless(
            self.azimuth.abs() <= 1e4,
            "Camera.azimuth",
            self.azimuth,
            "within ±10000 rad",
        )?;
        let holds = self.elevation.abs() <= FRAC_PI_2 + 1e-6;
        ParameterError::unless(holds, "Camera.elevation", self.elevation, "-π/2 to π/2 rad")?;
        ParameterError::unless(
            (0.0..=0.45).contains(&self.margin),
            "Camera.margin",
            self.margin,
            "0 to 0.45",
        )?;
        if let Projection::Perspective { field_of_view } = self.projection {
            let holds = (0.01..=2.5).contains(&field_of_view);
            ParameterError::unless(holds, "Camera.field_of_view", field_of_view, "0.01 to 2.5 rad")?;
        }
        if let Some(Bounds { min: low, max: high }) = self.frame {
            let reach = low.abs().max(high.abs()).max_element();
            let holds =
                low.is_finite() && high.is_finite() && low.cmple(high).all() && reach <= super::FARTHEST;
            ParameterError::unless(holds, "Camera.frame", (low, high), "a box within a million kilometres")?;
        }
        Ok(())
    }

    fn axes(&self) -> Axes {
        let (azimuth_sin, azimuth_cos) = math::sin_cos(self.azimuth % (2.0 * PI));
        let (elevation_sin, elevation_cos) = math::sin_cos(self.elevation.clamp(-FRAC_PI_2, FRAC_PI_2));
        let back = Vec3::new(azimuth_sin * elevation_cos, elevation_sin, azimuth_cos * elevation_cos);
        let right = Vec3::new(azimuth_cos, 0.0, -azimuth_sin);
        Axes { right, up: back.cross(right), back }
    }

    /// The directions whose farthest points decide where it stands for a picture `width` by `height` samples.
    pub(super) fn directions(&self, width: f32, height: f32) -> [Vec3; 5] {
        let Axes { right, up, back } = self.axes();
        let usable = 0.5 - self.margin;
        let [across, along] = match self.projection {
            Projection::Perspective { field_of_view } => {
                [width, height].map(|side| back * (side * usable / focal(field_of_view, height)))
            }
            Projection::Orthographic => [Vec3::ZERO; 2],
        };
        [right + across, across - right, up + along, along - up, back]
    }

    /// The view of a picture `width` by `height` samples that holds all `points`, of which there is at least one.
    pub(super) fn view(&self, points: impl Iterator<Item = Vec3>, width: f32, height: f32) -> View {
        let axes = self.axes();
        let usable = 1.0 - 2.0 * self.margin;
        let (half_width, half_height) = (0.5 * width * usable, 0.5 * height * usable);
        let middle = (0.5 * width, 0.5 * height);
        let corners = self.frame.map(Bounds::corners);
        let mut fit = Fit::default();
        match self.projection {
            Projection::Perspective { field_of_view } => {
                let focal = focal(field_of_view, height);
                fit.slope = (half_width / focal, half_height / focal);
                corners.iter().flatten().for_each(|&p| fit.add(&axes, p));
                if corners.is_none() {
                    points.for_each(|p| fit.add(&axes, p));
                }
                let (x, y, z) = fit.eye();
                let eye = axes.right * x + axes.up * y + axes.back * z;
                View {
                    axes,
                    eye,
                    scale: focal,
                    middle,
                    perspective: true,
                    nearest: (z - fit.nearest).max(1e-6) * 1e-3,
                }
            }
            Projection::Orthographic => {
                corners.iter().flatten().for_each(|&p| fit.add(&axes, p));
                if corners.is_none() {
                    points.for_each(|p| fit.add(&axes, p));
                }
                let (x, y) = (0.5 * (fit.right - fit.left), 0.5 * (fit.top - fit.bottom));
                let (wide, high) = (0.5 * (fit.right + fit.left), 0.5 * (fit.top + fit.bottom));
                let scale = (half_width / wide.max(1e-6)).min(half_height / high.max(1e-6));
                let eye = axes.right * x + axes.up * y + axes.back * fit.nearest;
                View { axes, eye, scale, middle, perspective: false, nearest: f32::NEG_INFINITY }
            }
        }
    }
}

/// Samples per unit of slope.
fn focal(field_of_view: f32, height: f32) -> f32 {
    let (sin, cos) = math::sin_cos(0.5 * field_of_view);
    0.5 * height * cos / sin
}

/// The camera's axes in the world.
#[derive(Debug, Clone, Copy)]
struct Axes {
    right: Vec3,
    up: Vec3,
    back: Vec3,
}

/// The tightest wedges around the points: how far each reaches beyond the planes through the origin that bound
/// the view (planes along the axis in an orthographic one, whose slope is zero).
#[derive(Debug)]
struct Fit {
    slope: (f32, f32),
    right: f32,
    left: f32,
    top: f32,
    bottom: f32,
    nearest: f32,
}

impl Default for Fit {
    fn default() -> Self {
        let least = f32::NEG_INFINITY;
        Self { slope: (0.0, 0.0), right: least, left: least, top: least, bottom: least, nearest: least }
    }
}

impl Fit {
    fn add(&mut self, axes: &Axes, p: Vec3) {
        let (x, y, z) = (p.dot(axes.right), p.dot(axes.up), p.dot(axes.back));
        self.right = self.right.max(x + z * self.slope.0);
        self.left = self.left.max(-x + z * self.slope.0);
        self.top = self.top.max(y + z * self.slope.1);
        self.bottom = self.bottom.max(-y + z * self.slope.1);
        self.nearest = self.nearest.max(z);
    }

    /// The nearest place from where everything is seen, along the axes.
    fn eye(&self) -> (f32, f32, f32) {
        let across = (self.right + self.left) / (2.0 * self.slope.0);
        let along = (self.top + self.bottom) / (2.0 * self.slope.1);
        let back = across.max(along).max(self.nearest + 1e-3);
        (0.5 * (self.right - self.left), 0.5 * (self.top - self.bottom), back)
    }
}

/// A camera put in its place: between the world and the samples of a picture.
#[derive(Debug, Clone)]
pub(super) struct View {
    axes: Axes,
    eye: Vec3,
    /// Samples per unit of slope (perspective) or per metre (orthographic).
    scale: f32,
    middle: (f32, f32),
    perspective: bool,
    /// Depth from which on things are drawn, metres.
    nearest: f32,
}

impl View {
    /// Column, row and nearness of a point, of which all three are linear along a line in the world; `None` behind
    /// the camera. Larger is nearer.
    #[inline]
    pub(super) fn project(&self, point: Vec3) -> Option<Vec3> {
        let v = point - self.eye;
        let (x, y, depth) = (v.dot(self.axes.right), v.dot(self.axes.up), -v.dot(self.axes.back));
        if depth < self.nearest {
            return None;
        }
        let (scale, nearness) =
            if self.perspective { (self.scale / depth, 1.0 / depth) } else { (self.scale, -depth) };
        Some(Vec3::new(self.middle.0 + x * scale, self.middle.1 - y * scale, nearness))
    }

    /// The point of the world that is seen at a place of the picture with a nearness.
    #[inline]
    pub(super) fn position(&self, x: f32, y: f32, nearness: f32) -> Vec3 {
        let (dx, dy) = ((x - self.middle.0) / self.scale, (self.middle.1 - y) / self.scale);
        let Axes { right, up, back } = self.axes;
        if self.perspective {
            self.eye + (right * dx + up * dy - back) / nearness
        } else {
            self.eye + right * dx + up * dy + back * nearness
        }
    }

    /// `true` if nearness is one over the depth, so that only values divided by the depth are linear
    /// over the picture.
    pub(super) fn is_perspective(&self) -> bool {
        self.perspective
    }

    /// The unit vector from a point to the camera.
    pub(super) fn towards(&self, point: Vec3) -> Vec3 {
        if self.perspective { (self.eye - point).normalize_or(self.axes.back) } else { self.axes.back }
    }

    /// Nearness of a point in front of the camera, as in [`project`](Self::project).
    #[inline]
    pub(super) fn nearness(&self, point: Vec3) -> f32 {
        let depth = (self.eye - point).dot(self.axes.back);
        if self.perspective { 1.0 / depth.max(self.nearest) } else { -depth }
    }

    /// The line of sight through a place of the picture.
    pub(super) fn ray(&self, x: f32, y: f32) -> Ray {
        let (dx, dy) = ((x - self.middle.0) / self.scale, (self.middle.1 - y) / self.scale);
        let Axes { right, up, back } = self.axes;
        if self.perspective {
            let way = right * dx + up * dy - back;
            let length = way.length();
            Ray { origin: self.eye, way: way / length, from: self.nearest * length, to: f32::MAX }
        } else {
            let origin = self.eye + right * dx + up * dy;
            Ray { origin, way: -back, from: -f32::MAX, to: f32::MAX }
        }
    }

    /// The side of a sample, metres: at the eye, and its growth per metre.
    pub(super) fn sample_size(&self) -> [f32; 2] {
        if self.perspective { [0.0, 1.0 / self.scale] } else { [1.0 / self.scale, 0.0] }
    }

    /// The side of a sample, metres, at a point's distance.
    pub(super) fn sample(&self, point: Vec3) -> f32 {
        let [near, growth] = self.sample_size();
        near + growth * point.distance(self.eye)
    }

    /// Change of nearness by a step of one sample.
    #[inline]
    pub(super) fn step(&self, nearness: f32) -> f32 {
        if self.perspective { nearness / self.scale } else { 1.0 / self.scale }
    }

    /// Point where the line of sight through a place of the picture meets the horizontal plane at
    /// `height`; `None` if it does not.
    pub(super) fn ground(&self, x: f32, y: f32, height: f32) -> Option<Vec3> {
        let (dx, dy) = ((x - self.middle.0) / self.scale, (self.middle.1 - y) / self.scale);
        let Axes { right, up, back } = self.axes;
        let (from, along) = if self.perspective {
            (self.eye, right * dx + up * dy - back)
        } else {
            (self.eye + right * dx + up * dy, -back)
        };
        let way = (height - from.y) / along.y;
        (along.y < 0.0 && way > 0.0 && way.is_finite()).then(|| from + along * way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOX: Bounds = Bounds { min: Vec3::new(-2.0, 0.0, -1.0), max: Vec3::new(3.0, 7.0, 2.0) };

    fn corners_fit(camera: &Camera, width: f32, height: f32) {
        let view = camera.view(BOX.corners().into_iter(), width, height);
        let seen = BOX.corners().map(|corner| view.project(corner).expect("in front of the camera"));
        let low = seen.into_iter().reduce(Vec3::min).expect("eight");
        let high = seen.into_iter().reduce(Vec3::max).expect("eight");
        let (x, y) = (width * 0.04, height * 0.04);
        assert!(low.x > x - 0.1 && high.x < width - x + 0.1 && low.y > y - 0.1 && high.y < height - y + 0.1);
        let spare = ((high.x - low.x) / (width - 2.0 * x)).max((high.y - low.y) / (height - 2.0 * y));
        assert!(spare > 0.85, "{spare}");
        for (corner, seen) in BOX.corners().into_iter().zip(seen) {
            assert!(view.position(seen.x, seen.y, seen.z).abs_diff_eq(corner, 1e-2));
        }
    }

    proptest! {
        #[test]
        fn everything_fits_and_comes_back(
            azimuth in -10.0f32..10.0, elevation in -1.57f32..1.57, fov in 0.1f32..1.2, width in 100.0f32..900.0,
        ) {
            let camera = Camera::default().with_azimuth(azimuth).with_elevation(elevation);
            corners_fit(&camera.clone().with_projection(Projection::Orthographic), width, 400.0);
            corners_fit(&camera.with_projection(Projection::Perspective { field_of_view: fov }), width, 400.0);
        }
    }

    #[test]
    fn axes_are_where_the_docs_say() {
        let right_of = |azimuth: f32| {
            let view = Camera::default().with_azimuth(azimuth).view(BOX.corners().into_iter(), 400.0, 400.0);
            let x = |p: Vec3| view.project(p).expect("in front").x;
            (x(Vec3::X) - x(Vec3::ZERO), x(Vec3::NEG_Z) - x(Vec3::ZERO))
        };
        assert!(right_of(0.0).0 > 10.0, "seen from +Z, +X is right");
        assert!(right_of(FRAC_PI_2).1 > 10.0, "seen from +X, -Z is right");
    }

    #[test]
    fn the_ground_is_below() {
        let view = Camera::default().with_elevation(0.5).view(BOX.corners().into_iter(), 400.0, 400.0);
        let seen = view.project(Vec3::new(1.0, 0.0, 1.0)).expect("in front");
        let ground = view.ground(seen.x, seen.y, 0.0).expect("below the horizon");
        assert!(ground.abs_diff_eq(Vec3::new(1.0, 0.0, 1.0), 1e-2));
        assert!(view.ground(200.0, 200.0, 1e6).is_none());
    }
}
