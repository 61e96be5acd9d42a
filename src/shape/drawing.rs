//! Outlines from SVG: path data, and what a document draws. Specification: <https://www.w3.org/TR/SVG2/>.

use glam::{DVec2, Vec2};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::solver::Solver;
use i_overlay::float::overlay::OverlayOptions;
use i_overlay::float::simplify::SimplifyShape;
use svgtypes::{PathParser, PathSegment};
use usvg::roxmltree;
use usvg::tiny_skia_path;

use super::outline::{MOST, meeting};
use super::{LARGEST, Outline};
use crate::ParameterError;

/// Straight pieces of a Bézier curve, and of a quarter of an arc.
const PIECES: u32 = 16;

/// The most shapes of a document.
const MOST_SHAPES: usize = 10_000;

impl Outline {
    /// SVG path data, such as the `d` of a `<path>`, with SVG's y turned up; curves and quarters of arcs in
    /// 16 straight pieces each, open pieces closed. A path that crosses itself becomes the polygons around
    /// the area that SVG fills by its non-zero rule. [`fitted`](Self::fitted) brings it to size.
    ///
    /// # Errors
    /// Text that is not path data from its first to its last character, by the place of what is wrong; numbers that are not
    /// finite; data that draws nothing.
    pub fn from_svg_path(data: &str) -> Result<Self, ParameterError> {
        let refused = |reason: String| {
            let start: String = data.chars().take(40).collect();
            ParameterError::new(
                "Outline.path",
                format_args!("{start:?}"),
                format!("SVG path data ({reason})"),
            )
        };
        let contours = path_lines(data).map_err(refused)?;
        Ok(mended(contours, FillRule::NonZero))
    }

    /// The shapes that an SVG document draws, one after the other in the order of drawing, with SVG's y
    /// turned up, in the document's user units (96 per inch).
    ///
    /// Paths and the basic shapes are read with their transforms, units, styles and fill rules; what SVG does
    /// not draw, such as hidden elements and the content of `<defs>`, `<clipPath>`, `<mask>`, `<marker>` and
    /// `<symbol>`, is not read; strokes count as the line they follow, closed. Texts and images are left out.
    ///
    /// ```
    /// use treesynth::{glam::Vec2, shape::Outline};
    ///
    /// let frame = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4">
    ///     <path fill-rule="evenodd" d="M0 0h4v4h-4zM1 1h2v2h-2z"/></svg>"#;
    /// let shapes = Outline::from_svg(frame)?;
    /// let fitted = shapes[0].fitted(0.0, 4.0);
    /// assert!(fitted.contains(Vec2::new(0.0, 0.5)) && !fitted.contains(Vec2::new(0.0, 2.0)));
    /// # Ok::<(), treesynth::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// Text that is not XML or not SVG; a path that is drawn and is not path data to its end, by its line; a document that
    /// draws nothing; more than 10,000 shapes.
    pub fn from_svg(text: &str) -> Result<Vec<Self>, ParameterError> {
        let refused = |value: String, range: &str| ParameterError::new("Outline.svg", value, range);
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
        let document = roxmltree::Document::parse_with_options(text, options)
            .map_err(|error| refused(format!("no XML: {error}"), "an SVG document"))?;
        // The conversion below draws a path up to what is wrong in it, as the specification asks of viewers.
        for node in document.descendants().filter(|node| node.tag_name().name() == "path" && is_drawn(*node))
        {
            if let Some(error) = node.attribute("d").and_then(|data| path_lines(data).err()) {
                let line = document.text_pos_at(node.range().start);
                return Err(refused(
                    format!("a path at line {line} with {error}"),
                    "of paths that can be read",
                ));
            }
        }
        let options = usvg::Options {
            image_href_resolver: usvg::ImageHrefResolver {
                resolve_data: Box::new(|_, _, _| None),
                resolve_string: Box::new(|_, _| None),
            },
            ..usvg::Options::default()
        };
        let tree = usvg::Tree::from_xmltree(&document, &options)
            .map_err(|error| refused(format!("no SVG: {error}"), "an SVG document"))?;
        let mut shapes = Vec::new();
        let mut waiting: Vec<&usvg::Node> = tree.root().children().iter().rev().collect();
        while let Some(node) = waiting.pop() {
            match node {
                usvg::Node::Group(group) => waiting.extend(group.children().iter().rev()),
                usvg::Node::Path(path) if path.is_visible() => {
                    let rule = path.fill().map_or(usvg::FillRule::NonZero, usvg::Fill::rule);
                    let rule = match rule {
                        usvg::FillRule::NonZero => FillRule::NonZero,
                        usvg::FillRule::EvenOdd => FillRule::EvenOdd,
                    };
                    let outline = mended(drawn(path), rule);
                    // A line has nothing within.
                    if (outline.max() - outline.min()).min_element() > 0.0 {
                        shapes.push(outline);
                    }
                }
                _ => {}
            }
            if shapes.len() > MOST_SHAPES {
                return Err(refused(format!("more than {MOST_SHAPES} shapes"), "at most 10,000 shapes"));
            }
        }
        if shapes.is_empty() {
            return Err(refused(
                "a document that draws no shape".into(),
                "an SVG document with a path or a basic shape that is drawn",
            ));
        }
        Ok(shapes)
    }
}

/// `false` if an element is within one whose content SVG does not draw.
fn is_drawn(node: roxmltree::Node<'_, '_>) -> bool {
    let hidden = ["defs", "clipPath", "mask", "marker", "symbol", "pattern", "metadata"];
    !node.ancestors().any(|node| hidden.contains(&node.tag_name().name()))
}

/// Polygons with curves made straight; y goes down.
#[derive(Default)]
struct Pen {
    contours: Vec<Vec<DVec2>>,
    start: DVec2,
    at: DVec2,
    /// `true` while the latest contour is unfinished.
    open: bool,
}

impl Pen {
    fn move_to(&mut self, to: DVec2) {
        (self.start, self.at, self.open) = (to, to, false);
    }

    fn line_to(&mut self, to: DVec2) {
        if !self.open {
            self.contours.push(vec![self.at]);
            self.open = true;
        }
        self.contours.iter_mut().last().into_iter().for_each(|contour| contour.push(to));
        self.at = to;
    }

    fn cubic_to(&mut self, a: DVec2, b: DVec2, to: DVec2) {
        let from = self.at;
        for step in 1..=PIECES {
            let t = f64::from(step) / f64::from(PIECES);
            let s = 1.0 - t;
            self.line_to(
                from * (s * s * s) + a * (3.0 * s * s * t) + b * (3.0 * s * t * t) + to * (t * t * t),
            );
        }
    }

    fn quadratic_to(&mut self, a: DVec2, to: DVec2) {
        let from = self.at;
        for step in 1..=PIECES {
            let t = f64::from(step) / f64::from(PIECES);
            let s = 1.0 - t;
            self.line_to(from * (s * s) + a * (2.0 * s * t) + to * (t * t));
        }
    }

    /// SVG 2, appendix B.2: an arc from its ends to its centre.
    fn arc_to(&mut self, radii: DVec2, rotation: f64, large: bool, sweep: bool, to: DVec2) {
        let (from, mut radii) = (self.at, radii.abs());
        if from == to {
            return;
        }
        if radii.min_element() == 0.0 {
            return self.line_to(to);
        }
        let (sin, cos) = libm::sincos(rotation.to_radians());
        let turned = |v: DVec2| DVec2::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x);
        let half = turned((from - to) * 0.5);
        let stretch = (half / radii).length_squared();
        if stretch > 1.0 {
            radii *= stretch.sqrt();
        }
        // On a unit circle; the middle of the ends is 0.
        let end = half / radii;
        let square = end.length_squared();
        let off = ((1.0 - square).max(0.0) / square).sqrt() * if large == sweep { -1.0 } else { 1.0 };
        let center = DVec2::new(end.y, -end.x) * off;
        let angle = |v: DVec2| libm::atan2(v.y, v.x);
        let (first, mut span) = (angle(end - center), angle(-end - center) - angle(end - center));
        if sweep && span < 0.0 {
            span += std::f64::consts::TAU;
        } else if !sweep && span > 0.0 {
            span -= std::f64::consts::TAU;
        }
        let pieces = (span.abs() / std::f64::consts::FRAC_PI_2 - 1e-9).ceil().clamp(1.0, 4.0) as u32 * PIECES;
        for step in 1..pieces {
            let (sin_at, cos_at) = libm::sincos(first + span * f64::from(step) / f64::from(pieces));
            let place = (DVec2::new(cos_at, sin_at) + center) * radii;
            self.line_to(
                DVec2::new(cos * place.x - sin * place.y, sin * place.x + cos * place.y) + (from + to) * 0.5,
            );
        }
        self.line_to(to);
    }

    fn close(&mut self) {
        (self.at, self.open) = (self.start, false);
    }
}

/// The lines of path data, all of it, curves made straight, y down; what closes them is not among them.
pub(crate) fn path_lines(data: &str) -> Result<Vec<Vec<DVec2>>, String> {
    let mut pen = Pen::default();
    // The latest control point, of a cubic and of a quadratic curve.
    let (mut cubic, mut quadratic) = (None, None);
    // SVG 2 counts a form feed as white space, as HTML does; the parser keeps to SVG 1.1. Places stay what they are.
    let data = data.replace('\u{c}', " ");
    for segment in PathParser::from(data.as_str()) {
        let segment = segment.map_err(|error| error.to_string())?;
        let at = |x: f64, y: f64| if segment.is_abs() { DVec2::new(x, y) } else { pen.at + DVec2::new(x, y) };
        let (last_cubic, last_quadratic) = (cubic.take(), quadratic.take());
        match segment {
            PathSegment::MoveTo { x, y, .. } => {
                let to = at(x, y);
                pen.move_to(to);
            }
            PathSegment::LineTo { x, y, .. } => {
                let to = at(x, y);
                pen.line_to(to);
            }
            PathSegment::HorizontalLineTo { abs, x } => {
                let x = if abs { x } else { pen.at.x + x };
                pen.line_to(pen.at.with_x(x));
            }
            PathSegment::VerticalLineTo { abs, y } => {
                let y = if abs { y } else { pen.at.y + y };
                pen.line_to(pen.at.with_y(y));
            }
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => {
                let [a, b, to] = [at(x1, y1), at(x2, y2), at(x, y)];
                pen.cubic_to(a, b, to);
                cubic = Some(b);
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                let [b, to] = [at(x2, y2), at(x, y)];
                pen.cubic_to(last_cubic.map_or(pen.at, |last: DVec2| pen.at * 2.0 - last), b, to);
                cubic = Some(b);
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                let [a, to] = [at(x1, y1), at(x, y)];
                pen.quadratic_to(a, to);
                quadratic = Some(a);
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                let to = at(x, y);
                let a = last_quadratic.map_or(pen.at, |last: DVec2| pen.at * 2.0 - last);
                pen.quadratic_to(a, to);
                quadratic = Some(a);
            }
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                let to = at(x, y);
                pen.arc_to(DVec2::new(rx, ry), x_axis_rotation, large_arc, sweep, to);
            }
            PathSegment::ClosePath { .. } => pen.close(),
        }
        if !pen.at.is_finite() {
            return Err("a number is too large".into());
        }
    }
    if pen.contours.is_empty() {
        return Err("it draws no line".into());
    }
    if pen.contours.iter().flatten().any(|corner| !corner.is_finite()) {
        return Err("a number is too large".into());
    }
    Ok(pen.contours)
}

/// The polygons of a path of a document, where it stands.
fn drawn(path: &usvg::Path) -> Vec<Vec<DVec2>> {
    let transform = path.abs_transform();
    let at = |point: tiny_skia_path::Point| {
        let [sx, kx, ky, sy] = [transform.sx, transform.kx, transform.ky, transform.sy].map(f64::from);
        let (x, y) = (f64::from(point.x), f64::from(point.y));
        DVec2::new(sx * x + kx * y + f64::from(transform.tx), ky * x + sy * y + f64::from(transform.ty))
    };
    let mut pen = Pen::default();
    for segment in path.data().segments() {
        match segment {
            tiny_skia_path::PathSegment::MoveTo(to) => pen.move_to(at(to)),
            tiny_skia_path::PathSegment::LineTo(to) => pen.line_to(at(to)),
            tiny_skia_path::PathSegment::QuadTo(a, to) => pen.quadratic_to(at(a), at(to)),
            tiny_skia_path::PathSegment::CubicTo(a, b, to) => pen.cubic_to(at(a), at(b), at(to)),
            tiny_skia_path::PathSegment::Close => pen.close(),
        }
    }
    pen.contours
}

/// An outline, y up, of polygons that do not cross themselves; those that there are, if they do not.
fn mended(mut contours: Vec<Vec<DVec2>>, rule: FillRule) -> Outline {
    // Points and lines have nothing within.
    let encloses = |contour: &Vec<DVec2>| {
        let (first, mut others) = (contour[0], contour.iter().filter(|&&corner| corner != contour[0]));
        let second = others.next();
        second.is_some_and(|second| others.any(|corner| (*second - first).perp_dot(*corner - first) != 0.0))
    };
    if contours.iter().any(encloses) {
        contours.retain(encloses);
    }
    let narrow = |contours: &[Vec<DVec2>]| {
        let place = |corner: &DVec2| Vec2::new(corner.x as f32, -corner.y as f32);
        Outline::of(contours.iter().map(|contour| contour.iter().map(place).collect()).collect())
    };
    let plain = narrow(&contours);
    let crosses = || plain.contours().iter().any(|contour| contour.len() > 2 && meeting(contour).is_some());
    let count = contours.iter().map(Vec::len).sum::<usize>();
    let large = !plain.min().abs().max(plain.max().abs()).cmple(Vec2::splat(LARGEST)).all();
    // Polygons that the outline's check refuses anyway are left as they are.
    if large || count > MOST || !(crosses() || rule == FillRule::EvenOdd && contours.len() > 1) {
        return plain;
    }
    let points: Vec<Vec<[f64; 2]>> =
        contours.iter().map(|contour| contour.iter().map(DVec2::to_array).collect()).collect();
    let shapes = points.simplify_shape_custom(rule, OverlayOptions::ogc(), Solver::default());
    let simple: Vec<Vec<DVec2>> =
        shapes.into_iter().flatten().map(|contour| contour.into_iter().map(DVec2::from).collect()).collect();
    if simple.is_empty() { plain } else { narrow(&simple) }
}

#[cfg(test)]
mod tests;
