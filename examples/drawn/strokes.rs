//! Strokes: built in, or from an SVG file.

use std::path::Path;
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{Canvas, Stroke};

use crate::Failure;

const SVG: &str = "http://www.w3.org/2000/svg";

/// A leaning pine in ten strokes, in metres, as an SVG path each; y points down.
const PINE: &[&str] = &[
    "M 0 0 C 0.5 -0.9 0.1 -1.6 0.7 -2.5 C 1.2 -3.3 1.1 -3.8 0.8 -4.6",
    "M 0.42 -1.75 C 0 -1.9 -0.8 -1.7 -1.5 -2.0 C -2.0 -2.2 -2.4 -2.0 -2.8 -2.1",
    "M -1.2 -1.88 C -1.5 -2.2 -1.9 -2.5 -2.5 -2.6",
    "M 0.6 -2.3 C 1.2 -2.4 1.7 -2.2 2.3 -2.5 C 2.8 -2.7 3.2 -2.6 3.6 -2.7",
    "M 1.9 -2.35 C 2.3 -2.7 2.6 -3.0 3.1 -3.1",
    "M 0.95 -3.05 C 0.3 -3.2 -0.2 -3.1 -0.8 -3.4 C -1.2 -3.6 -1.5 -3.5 -1.8 -3.5",
    "M 1.1 -3.5 C 1.6 -3.7 2.0 -3.6 2.5 -3.8 C 2.7 -3.9 2.9 -3.85 3.0 -3.9",
    "M 0.98 -4.15 C 0.6 -4.3 0.3 -4.3 -0.2 -4.5",
    "M 1.0 -4.0 C 1.3 -4.3 1.6 -4.4 1.9 -4.5",
    "M 0.8 -4.6 C 0.7 -4.9 0.8 -5.1 0.9 -5.3",
];

/// The pine, with its thickness.
pub(crate) fn built_in() -> Result<Vec<Stroke>, Failure> {
    let mut strokes = Vec::new();
    for (number, data) in PINE.iter().enumerate() {
        let (base, tip) = match number {
            0 => (0.42, 0.12),
            9 => (0.12, 0.03),
            _ => (0.11, 0.02),
        };
        let drawn = Stroke::from_svg_path(Canvas::front(), data)?;
        strokes.extend(drawn.into_iter().map(|stroke| stroke.with_diameters(base, tip)));
    }
    Ok(strokes)
}

/// Each part of each `<path>`, the lowest point of the first stroke at the origin and the whole so many metres tall;
/// `stroke-width` is thickness at the base.
pub(crate) fn read(path: &Path, height: f32) -> Result<Vec<Stroke>, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let document = roxmltree::Document::parse(&text)?;
    let paths: Vec<(&str, Option<f32>)> = document
        .descendants()
        .filter(|node| node.has_tag_name((SVG, "path")))
        .filter_map(|node| {
            let width = node.attribute("stroke-width").and_then(|width| width.parse().ok());
            Some((node.attribute("d")?, width))
        })
        .collect();
    let mut points = Vec::new();
    for (data, _) in &paths {
        for stroke in Stroke::from_svg_path(Canvas::front(), data)? {
            points.extend(stroke.places());
        }
    }
    let first = *points.first().ok_or("there is no <path> in the file")?;
    let low = points.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let high = points.iter().map(|point| point.y).fold(f32::NEG_INFINITY, f32::max);
    let scale = height / (high - low).max(f32::MIN_POSITIVE);
    let base = Vec3::new(-first.x * scale, -first.y * scale, 0.0);
    let canvas = Canvas::new(base, Vec3::X * scale, Vec3::Y * scale);
    let mut strokes = Vec::new();
    for (data, width) in paths {
        for stroke in Stroke::from_svg_path(canvas, data)? {
            strokes.push(match width {
                Some(width) => stroke.with_diameters(width * scale, width * scale * 0.3),
                None => stroke,
            });
        }
    }
    Ok(strokes)
}

/// The drawing alone, on a white ground, as the picture of the tree is framed.
pub(crate) fn lines(strokes: &[Stroke]) -> Vec<Vec<Vec2>> {
    strokes.iter().map(|stroke| stroke.places().iter().map(|place| place.truncate()).collect()).collect()
}
