//! One line of a drawing, in space or on a plane.

use crate::guided::curve::centripetal;
use crate::parameter::ParameterError;
#[cfg(feature = "import")]
use crate::shape::path_lines;
#[cfg(feature = "import")]
use glam::DVec2;
use glam::{Vec2, Vec3};

/// A plane to draw on, seen from a side.
///
/// ```
/// use treesynth::{glam::{Vec2, Vec3}, guided::Canvas};
///
/// // A picture of 100 units per metre, seen from the east, with the trunk base at (400, 0).
/// let side = Canvas::new(Vec3::Z * -4.0, Vec3::Z * 0.01, Vec3::Y * 0.01);
/// assert!(side.point(Vec2::new(400.0, 150.0)).abs_diff_eq(Vec3::Y * 1.5, 1e-5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Canvas {
    base: Vec3,
    right: Vec3,
    up: Vec3,
}

impl Canvas {
    /// The point (0, 0) of the drawing is at `base`, metres; a unit to the right and a unit upwards are the vectors
    /// `right` and `up`, whose lengths are metres per unit. They are finite and not parallel.
    pub fn new(base: Vec3, right: Vec3, up: Vec3) -> Self {
        Self { base, right, up }
    }

    /// The plane z = 0 seen from the front: x to the right, y upwards, in metres.
    pub fn front() -> Self {
        Self::new(Vec3::ZERO, Vec3::X, Vec3::Y)
    }

    /// The plane x = 0 seen from the right: z to the left, y upwards, in metres.
    pub fn side() -> Self {
        Self::new(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y)
    }

    /// Position of a point of the drawing, metres.
    pub fn point(&self, point: Vec2) -> Vec3 {
        self.base + self.right * point.x + self.up * point.y
    }

    /// Unit vector towards the viewer.
    pub fn normal(&self) -> Vec3 {
        self.right.cross(self.up).normalize_or(Vec3::Z)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.base.is_finite(), "Canvas.base", self.base, "finite, in metres")?;
        for (name, vector) in [("Canvas.right", self.right), ("Canvas.up", self.up)] {
            let fits = vector.is_finite() && vector.length_squared() > f32::MIN_POSITIVE;
            ParameterError::unless(fits, name, vector, "finite and not zero, in metres per unit")?;
        }
        let area = self.right.normalize().cross(self.up.normalize()).length();
        ParameterError::unless(area > 1e-3, "Canvas.up", self.up, "not parallel to Canvas.right")
    }
}

/// A line drawn from the base of a limb to its tip.
///
/// Thickness is optional: what is given is the least that the limb has in the end.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Stroke {
    line: Line,
    diameters: Option<[f32; 2]>,
    smooth: bool,
}

crate::recipe::readable!(Stroke { diameters: Option<[f32; 2]> });

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
enum Line {
    Space(Vec<Vec3>),
    Flat(Canvas, Vec<Vec2>),
}

/// The points of a stroke in space, metres, with those that are added between the given ones.
#[derive(Debug)]
pub(super) struct Course {
    pub(super) points: Vec<Vec3>,
    /// The number of the given point, for those that are one.
    pub(super) given: Vec<Option<usize>>,
    /// Towards the viewer, if the stroke is drawn on a plane.
    pub(super) normal: Option<Vec3>,
}

/// Coordinates, metres: squares of distances stay finite.
const LARGEST: f32 = 1e9;

impl Stroke {
    /// Through points in space, metres: at least two, finite, each away from the one before.
    pub fn new(points: impl Into<Vec<Vec3>>) -> Self {
        Self { line: Line::Space(points.into()), diameters: None, smooth: false }
    }

    /// Through points of a plane, in its units: at least two, finite, each away from the one before.
    pub fn on(canvas: Canvas, points: impl Into<Vec<Vec2>>) -> Self {
        Self { line: Line::Flat(canvas, points.into()), diameters: None, smooth: false }
    }

    /// The strokes of SVG path data (the `d` of a `<path>`): one for each part that begins with a move. Curves become
    /// 16 lines each, and what closes a part is not drawn; y points down in SVG, and up on the canvas.
    ///
    /// # Errors
    /// Text that is no path data, or draws nothing.
    #[cfg(feature = "import")]
    #[cfg_attr(docsrs, doc(cfg(feature = "import")))]
    pub fn from_svg_path(canvas: Canvas, data: &str) -> Result<Vec<Self>, ParameterError> {
        let wrong = |why: String| ParameterError::new("Stroke.data", format!("{data:.40}"), why);
        let lines = path_lines(data).map_err(|reason| wrong(format!("SVG path data ({reason})")))?;
        let flat = |line: Vec<DVec2>| {
            let mut points: Vec<Vec2> =
                line.into_iter().map(|p| Vec2::new(p.x as f32, -p.y as f32)).collect();
            points.dedup();
            points
        };
        let lines: Vec<Vec<Vec2>> = lines.into_iter().map(flat).filter(|line| line.len() > 1).collect();
        if lines.is_empty() {
            return Err(wrong("path data with at least one line".to_owned()));
        }
        Ok(lines.into_iter().map(|line| Self::on(canvas, line)).collect())
    }

    /// Diameters at the base and at the tip, metres, finite and at least 0; in between they change evenly.
    pub fn with_diameters(mut self, base: f32, tip: f32) -> Self {
        self.diameters = Some([base, tip]);
        self
    }

    /// A smooth curve through the points, instead of straight lines between them: the centripetal Catmull-Rom curve
    /// (Yuksel, Schaefer and Keyser 2011), which makes no loops and stays near the lines.
    pub fn smoothed(mut self) -> Self {
        self.smooth = true;
        self
    }

    /// Positions of its points, metres.
    pub fn places(&self) -> Vec<Vec3> {
        match &self.line {
            Line::Space(points) => points.clone(),
            Line::Flat(canvas, points) => points.iter().map(|&point| canvas.point(point)).collect(),
        }
    }

    /// Radius at a share of the way from base to tip; 0 where none is given.
    pub(super) fn radius(&self, share: f32) -> f32 {
        self.diameters.map_or(0.0, |[base, tip]| (base + (tip - base) * share) * 0.5)
    }

    /// The given points in space. `name` is what errors call the stroke.
    pub(super) fn points(&self, name: &str) -> Result<Vec<Vec3>, ParameterError> {
        if let Line::Flat(canvas, _) = &self.line {
            canvas.check()?;
        }
        let points = self.places();
        let count = points.len();
        ParameterError::unless(count >= 2, &format!("{name}.points"), count, "at least 2 points")?;
        for (number, &point) in points.iter().enumerate() {
            let name = format!("{name}.points[{number}]");
            let fits = point.is_finite() && point.abs().max_element() <= LARGEST;
            ParameterError::unless(fits, &name, point, "finite and within 1e9 m of 0")?;
            let moves = number == 0 || points[number - 1].distance_squared(point) > f32::MIN_POSITIVE;
            ParameterError::unless(moves, &name, point, "away from the point before")?;
        }
        for diameter in self.diameters.into_iter().flatten() {
            let fits = diameter >= 0.0 && diameter.is_finite();
            ParameterError::unless(fits, &format!("{name}.diameters"), diameter, "finite and at least 0 m")?;
        }
        Ok(points)
    }

    /// The whole line, in parts of at most `detail` metres.
    pub(super) fn course(&self, points: &[Vec3], detail: f32) -> Course {
        let normal = match &self.line {
            Line::Space(_) => None,
            Line::Flat(canvas, _) => Some(canvas.normal()),
        };
        let mut course = Course { points: vec![points[0]], given: vec![Some(0)], normal };
        let last = points.len() - 1;
        for i in 0..last {
            let (from, to) = (points[i], points[i + 1]);
            let parts = (from.distance(to) / detail).ceil().max(1.0) as usize;
            let before = if i > 0 { points[i - 1] } else { from * 2.0 - to };
            let after = if i + 2 <= last { points[i + 2] } else { to * 2.0 - from };
            for part in 1..parts {
                let t = part as f32 / parts as f32;
                let point =
                    if self.smooth { centripetal([before, from, to, after], t) } else { from.lerp(to, t) };
                course.points.push(point);
                course.given.push(None);
            }
            course.points.push(to);
            course.given.push(Some(i + 1));
        }
        course
    }
}
