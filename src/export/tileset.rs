//! 3D Tiles 1.1: `tileset.json`, which says where the models of a landscape stand and when each is fine enough.

use super::ExportError;
use super::gltf::text::{escaped, list};
use crate::ParameterError;
use crate::shape::Bounds;
use glam::{DMat4, DVec3, DVec4};
use std::io::Write;

/// Tiles below one group.
const GROUP: usize = 8;
/// WGS 84: half the equator's diameter in metres, and the flattening.
const EQUATOR: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// A model of a [`Tileset`]: a GLB file, in metres, +Y up.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct TileModel {
    uri: String,
    bounds: Bounds,
    origin: DVec3,
    error: f64,
    finer: Option<Box<Self>>,
}

impl TileModel {
    /// `uri` as written from the directory of `tileset.json`, forward slashes between; `bounds` in the model's own frame; `error`, how
    /// far the model is off the truth at most, metres, 0 or more: viewers take a finer model where that is more than some
    /// pixels.
    pub fn new(uri: impl Into<String>, bounds: Bounds, error: f64) -> Self {
        Self { uri: uri.into(), bounds, origin: DVec3::ZERO, error, finer: None }
    }

    /// Sets the place of the model's origin in the tileset, metres; default 0.
    pub fn with_origin(mut self, origin: DVec3) -> Self {
        self.origin = origin;
        self
    }

    /// Sets the model that takes its place from near by: of a smaller error, in the same frame; its own origin does not count.
    pub fn with_finer(mut self, finer: Self) -> Self {
        self.finer = Some(Box::new(finer));
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let (uri, bounds, error) = (&self.uri, self.bounds, self.error);
        ParameterError::unless(!uri.is_empty(), "TileModel.uri", "an empty text", "the name of a file")?;
        let holds = bounds.min.is_finite() && bounds.max.is_finite() && bounds.min.cmple(bounds.max).all();
        ParameterError::unless(
            holds,
            "TileModel.bounds",
            format_args!("{bounds:?}"),
            "finite, min below max",
        )?;
        let holds = self.origin.is_finite() && self.origin.abs().max_element() <= 1e9;
        ParameterError::unless(holds, "TileModel.origin", self.origin, "within 1e9 metres")?;
        let holds = (0.0..=1e9).contains(&error);
        ParameterError::unless(holds, "TileModel.error", error, "0 to 1e9 metres")?;
        let Some(finer) = &self.finer else { return Ok(()) };
        let holds = finer.error < error;
        ParameterError::unless(
            holds,
            "TileModel.finer",
            finer.error,
            "an error below that of the coarser model",
        )?;
        finer.check()
    }

    /// Lowest and highest corner of it and what is finer, +Z up, in its own frame.
    fn corners(&self) -> [DVec3; 2] {
        let [low, high] = [self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3()];
        let own = [DVec3::new(low.x, -high.z, low.y), DVec3::new(high.x, -low.z, high.y)];
        self.finer.as_ref().map_or(own, |finer| joined(own, finer.corners()))
    }

    fn middle(&self) -> DVec3 {
        z_up(self.origin)
    }

    /// Corners in the tileset.
    fn reach(&self) -> [DVec3; 2] {
        self.corners().map(|corner| corner + self.middle())
    }

    fn json(&self, transform: &str) -> String {
        let (volume, error, uri) = (volume(self.corners()), self.error, escaped(&self.uri));
        let children = match &self.finer {
            Some(finer) => format!(r#","children":[{}]"#, finer.json("")),
            None => String::new(),
        };
        format!(
            r#"{{{transform}{volume},"geometricError":{error},"refine":"REPLACE","content":{{"uri":{uri}}}{children}}}"#
        )
    }
}

/// A landscape of models for [`write_tileset`].
#[derive(Debug, Clone, PartialEq, Default)]
#[must_use]
pub struct Tileset {
    models: Vec<TileModel>,
    position: Option<[f64; 3]>,
}

impl Tileset {
    /// Of these models, at least one; their order does not matter to viewers.
    pub fn new(models: Vec<TileModel>) -> Self {
        Self { models, position: None }
    }

    /// Puts the origin on the globe: longitude in [-180, 180] and latitude in [-90, 90], degrees, and metres above the ellipsoid of WGS 84,
    /// within 1e5. +X of the models is east there, -Z north. By default the tileset is nowhere on it, its +Z up.
    pub fn with_position(mut self, longitude: f64, latitude: f64, height: f64) -> Self {
        self.position = Some([longitude, latitude, height]);
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(!self.models.is_empty(), "Tileset.models", 0, "at least one")?;
        self.models.iter().try_for_each(TileModel::check)?;
        let Some([longitude, latitude, height]) = self.position else { return Ok(()) };
        let holds = longitude.abs() <= 180.0;
        ParameterError::unless(holds, "Tileset.position.longitude", longitude, "-180 to 180 degrees")?;
        let holds = latitude.abs() <= 90.0;
        ParameterError::unless(holds, "Tileset.position.latitude", latitude, "-90 to 90 degrees")?;
        let holds = height.abs() <= 1e5;
        ParameterError::unless(holds, "Tileset.position.height", height, "-1e5 to 1e5 metres")
    }
}

fn z_up(place: DVec3) -> DVec3 {
    DVec3::new(place.x, -place.z, place.y)
}

fn joined(one: [DVec3; 2], other: [DVec3; 2]) -> [DVec3; 2] {
    [one[0].min(other[0]), one[1].max(other[1])]
}

/// Its middle and half its axes.
fn volume([low, high]: [DVec3; 2]) -> String {
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let numbers = [middle, DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z];
    let numbers = list(numbers.iter().flat_map(DVec3::to_array), |number| number.to_string());
    format!(r#""boundingVolume":{{"box":[{numbers}]}}"#)
}

fn transform(matrix: DMat4) -> String {
    format!(r#""transform":[{}],"#, list(matrix.to_cols_array(), |number| number.to_string()))
}

/// East, north and up at a place on the globe, as the frame of its centre has them.
fn on_globe([longitude, latitude, height]: [f64; 3]) -> DMat4 {
    let [(sin_long, cos_long), (sin_lat, cos_lat)] =
        [longitude, latitude].map(|degrees| libm::sincos(degrees.to_radians()));
    let square = FLATTENING * (2.0 - FLATTENING);
    let radius = EQUATOR / (1.0 - square * sin_lat * sin_lat).sqrt();
    let up = DVec3::new(cos_lat * cos_long, cos_lat * sin_long, sin_lat);
    let east = DVec3::new(-sin_long, cos_long, 0.0);
    let north = up.cross(east);
    let place = DVec3::new(
        (radius + height) * up.x,
        (radius + height) * up.y,
        (radius * (1.0 - square) + height) * up.z,
    );
    DMat4::from_cols(east.extend(0.0), north.extend(0.0), up.extend(0.0), DVec4::from((place, 1.0)))
}

/// A group of models, halved along its longer side until few are left.
fn group(models: &mut [&TileModel]) -> (String, [DVec3; 2], f64) {
    let reach = models.iter().map(|model| model.reach()).reduce(joined).unwrap_or_default();
    let size = reach[1] - reach[0];
    let mut error = size.length();
    let children = if models.len() <= GROUP {
        list(models.iter(), |model| {
            error = error.max(model.error);
            let moved = DMat4::from_translation(model.middle());
            model.json(&transform(moved))
        })
    } else {
        let along = |model: &&TileModel| if size.x > size.y { model.middle().x } else { model.middle().y };
        models.sort_by(|one, other| along(one).total_cmp(&along(other)));
        let (low, high) = models.split_at_mut(models.len() / 2);
        list([low, high], |half| {
            let (text, _, own) = group(half);
            error = error.max(own);
            text
        })
    };
    let volume = volume(reach);
    let text = format!(r#"{{{volume},"geometricError":{error},"refine":"ADD","children":[{children}]}}"#);
    (text, reach, error)
}

/// Writes the `tileset.json` of a landscape: a tree of boxes, halved until eight models are left in each, so that viewers pass over what they
/// do not see. The models are files of their own ([`write_glb_scene`](super::write_glb_scene)). O(n log² n).
///
/// ```
/// use treesynth::export::{TileModel, Tileset, write_tileset};
/// use treesynth::glam::{DVec3, Vec3};
/// use treesynth::shape::Bounds;
///
/// let bounds = Bounds::new(Vec3::ZERO, Vec3::new(32.0, 12.0, 32.0));
/// let tile = |x: i32| {
///     let near = TileModel::new(format!("near/{x}.glb"), bounds, 0.05);
///     let far = TileModel::new(format!("far/{x}.glb"), bounds, 1.0).with_finer(near);
///     far.with_origin(DVec3::new(32.0 * f64::from(x), 0.0, 0.0))
/// };
/// let mut text = Vec::new();
/// let tileset = Tileset::new((0..4).map(tile).collect()).with_position(9.93, 51.53, 200.0);
/// write_tileset(&tileset, &mut text)?;
/// assert!(String::from_utf8(text)?.contains(r#""uri":"far/3.glb""#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No model, an option out of range, a finer model of no smaller error; and the writer's own.
pub fn write_tileset(tileset: &Tileset, mut writer: impl Write) -> Result<(), ExportError> {
    tileset.check()?;
    let mut models: Vec<&TileModel> = tileset.models.iter().collect();
    let (root, _, error) = group(&mut models);
    let place = tileset.position.map_or(String::new(), |position| transform(on_globe(position)));
    let version = env!("CARGO_PKG_VERSION");
    let asset = format!(r#"{{"version":"1.1","generator":"treesynth {version}"}}"#);
    let root = root.replacen('{', &format!("{{{place}"), 1);
    writeln!(writer, r#"{{"asset":{asset},"geometricError":{error},"root":{root}}}"#)?;
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equator and the north pole, half axes of WGS 84 from the middle; east, north and up elsewhere.
    #[test]
    fn places_on_the_globe() {
        let at = |longitude, latitude, height| on_globe([longitude, latitude, height]).w_axis.truncate();
        assert!((at(0.0, 0.0, 0.0) - DVec3::X * EQUATOR).length() < 1e-6);
        assert!((at(90.0, 0.0, 10.0) - DVec3::Y * (EQUATOR + 10.0)).length() < 1e-6);
        assert!((at(12.0, 90.0, 0.0) - DVec3::Z * 6_356_752.314_245).length() < 1e-5);
        let frame = on_globe([9.93, 51.53, 200.0]);
        let [east, north, up] = [frame.x_axis, frame.y_axis, frame.z_axis].map(DVec4::truncate);
        assert!(east.z.abs() < 1e-12 && north.z > 0.0 && up.dot(frame.w_axis.truncate()) > 6.3e6);
        assert!((east.cross(north) - up).length() < 1e-12);
    }
}
