//! Closed polygons in the plane, and the solids they are the cross section of.

use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3, Vec3Swizzles};
use smallvec::SmallVec;

use super::{Bounds, LARGEST, SMALLEST, Shape, check_fit, check_length};
use crate::ParameterError;

/// The most points of an outline.
pub(super) const MOST: usize = 20_000;

/// Closed polygons in the plane, metres, x to the right and y up: a silhouette, a letter.
///
/// A point is inside where the polygons wind around it, whichever way: those that run the same way are united, and one
/// within another that runs the other way is a hole (the non-zero rule of SVG). No polygon may cross or touch itself.
/// Constructors accept anything; [`check`](Self::check) says what is wrong. Cloning shares the points.
///
/// ```
/// use treesynth::{glam::Vec2, shape::Outline};
///
/// let points = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(Vec2::from);
/// let plate = Outline::new(points);
/// assert!(plate.contains(Vec2::new(1.9, 0.5)) && !plate.contains(Vec2::new(1.0, 1.5)));
/// let bow_tie = Outline::new([points[0], points[1], points[3], points[2]]);
/// assert!(bow_tie.check().is_err());
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    inner: Arc<Inner>,
}

#[derive(Debug, PartialEq)]
struct Inner {
    contours: Vec<Vec<Vec2>>,
    min: Vec2,
    max: Vec2,
    /// The sides that cross each of some rows of equal height.
    rows: Vec<Vec<[Vec2; 2]>>,
    /// Error of the height it was fitted to.
    fit: Result<(), ParameterError>,
}

/// The most rows that sides are sorted into.
const ROWS: usize = 256;

impl Outline {
    /// One polygon, from its corners in either direction; corners that follow each other in one place count once.
    pub fn new(corners: impl Into<Vec<Vec2>>) -> Self {
        Self::of(vec![corners.into()])
    }

    /// A smooth closed curve through the points, Catmull and Rom's, in eight straight pieces from each point to the next.
    pub fn smooth(points: impl Into<Vec<Vec2>>) -> Self {
        const PIECES: usize = 8;
        let points = points.into();
        let at = |i: usize| points[i % points.len()];
        let piece = |i: usize| {
            let (from, t) = (i / PIECES + points.len(), (i % PIECES) as f32 / PIECES as f32);
            let [a, b, c, d] = [from - 1, from, from + 1, from + 2].map(at);
            let bend = (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t);
            (b * 2.0 + (c - a) * t + bend + (b * 3.0 - a - c * 3.0 + d) * (t * t * t)) * 0.5
        };
        let corners: Vec<Vec2> = (0..PIECES * points.len()).map(piece).collect();
        Self::new(corners)
    }

    /// Another polygon beside, over or within those there are.
    pub fn and(self, corners: impl Into<Vec<Vec2>>) -> Self {
        let mut contours = self.inner.contours.clone();
        contours.push(corners.into());
        Self::of(contours)
    }

    pub(super) fn of(mut contours: Vec<Vec<Vec2>>) -> Self {
        for contour in &mut contours {
            contour.dedup();
            while contour.len() > 1 && contour.first() == contour.last() {
                contour.pop();
            }
        }
        let points = || contours.iter().flatten().copied();
        let min = points().fold(Vec2::INFINITY, Vec2::min);
        let max = points().fold(Vec2::NEG_INFINITY, Vec2::max);
        let count = points().count().clamp(1, ROWS);
        let mut inner = Inner { contours, min, max, rows: vec![Vec::new(); count], fit: Ok(()) };
        if inner.is_finite() && inner.contours.iter().map(Vec::len).sum::<usize>() <= MOST {
            for [from, to] in inner.contours.iter().flat_map(|contour| sides(contour)) {
                let (low, high) = (inner.row(from.y.min(to.y)), inner.row(from.y.max(to.y)));
                inner.rows[low..=high].iter_mut().for_each(|row| row.push([from, to]));
            }
        }
        Self { inner: Arc::new(inner) }
    }

    /// The polygons.
    pub fn contours(&self) -> &[Vec<Vec2>] {
        &self.inner.contours
    }

    /// The corner of the box around it with the smallest coordinates, metres.
    pub fn min(&self) -> Vec2 {
        self.inner.min
    }

    /// The corner of the box around it with the largest coordinates, metres.
    pub fn max(&self) -> Vec2 {
        self.inner.max
    }

    /// Enlarged and moved to stand on the height `base` (-1e6 to 1e6) and to be `height` metres high (1e-6 to 1e6), its box
    /// centred on x = 0.
    pub fn fitted(&self, base: f32, height: f32) -> Self {
        let (min, max) = (self.inner.min, self.inner.max);
        let bottom = Vec2::new(0.5 * min.x + 0.5 * max.x, min.y);
        let scale = height / (max.y - min.y);
        let place = |&point: &Vec2| (point - bottom) * scale + Vec2::Y * base;
        let mut fitted =
            Self::of(self.inner.contours.iter().map(|contour| contour.iter().map(place).collect()).collect());
        // Nobody else holds it yet.
        if let Some(inner) = Arc::get_mut(&mut fitted.inner) {
            inner.fit = check_fit("Outline", base, height).and_then(|()| self.inner.fit.clone());
        }
        fitted
    }

    /// `true` if `point` is inside. O(1) for outlines with sides of like length.
    pub fn contains(&self, point: Vec2) -> bool {
        let winding = |[from, to]: &[Vec2; 2]| match crossing([*from, *to], point.y) {
            Some((x, way)) if x <= point.x => way,
            _ => 0,
        };
        point.is_finite() && self.inner.near(point.y).iter().map(winding).sum::<i32>() != 0
    }

    /// Intervals of x in which the horizontal line at height `y` is inside, ascending.
    pub fn spans(&self, y: f32) -> SmallVec<[(f32, f32); 4]> {
        let mut crossings: SmallVec<[(f32, i32); 8]> =
            self.inner.near(y).iter().filter_map(|&side| crossing(side, y)).collect();
        crossings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut spans = SmallVec::new();
        let (mut winding, mut start) = (0, 0.0);
        for (x, way) in crossings {
            if winding == 0 {
                start = x;
            }
            winding += way;
            if winding == 0 && x > start {
                spans.push((start, x));
            }
        }
        spans
    }

    /// Checks that this is an outline: polygons of three corners or more, 20,000 in all, at most 1e6 from 0,
    /// none of which crosses or touches itself. O(n log n) for polygons of short sides.
    ///
    /// # Errors
    /// The first of these that does not hold.
    pub fn check(&self) -> Result<(), ParameterError> {
        let Inner { contours, min, max, .. } = &*self.inner;
        self.inner.fit.clone()?;
        let count = contours.iter().map(Vec::len).sum::<usize>();
        ParameterError::unless((3..=MOST).contains(&count), "Outline.corners", count, "from 3 to 20,000")?;
        let holds = min.is_finite() && min.abs().max(max.abs()).max_element() <= LARGEST;
        let holds = holds && contours.iter().flatten().all(|corner| corner.is_finite());
        ParameterError::unless(holds, "Outline.corners", (min, max), "from -1e6 to 1e6 metres on both axes")?;
        let size = *max - *min;
        ParameterError::unless(size.min_element() >= SMALLEST, "Outline.size", size, "at least 1e-6 metres")?;
        for (number, contour) in contours.iter().enumerate() {
            let name = format!("Outline.contours[{number}]");
            ParameterError::unless(contour.len() >= 3, &name, contour.len(), "three corners or more")?;
            if let Some((first, second)) = meeting(contour) {
                return Err(ParameterError::new(
                    name,
                    format_args!("a polygon whose sides from corners {first} and {second} meet"),
                    "one that does not cross or touch itself",
                ));
            }
        }
        Ok(())
    }
}

impl Inner {
    fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.contours.iter().flatten().all(|p| p.is_finite())
    }

    fn row(&self, y: f32) -> usize {
        let share = (y - self.min.y) / (self.max.y - self.min.y);
        // NaN, of a flat outline, becomes 0.
        ((share * self.rows.len() as f32) as usize).min(self.rows.len() - 1)
    }

    fn near(&self, y: f32) -> &[[Vec2; 2]] {
        if y >= self.min.y && y <= self.max.y { &self.rows[self.row(y)] } else { &[] }
    }
}

fn sides(contour: &[Vec2]) -> impl Iterator<Item = [Vec2; 2]> + '_ {
    (0..contour.len()).map(|i| [contour[i], contour[(i + 1) % contour.len()]])
}

/// Crossing of a side with the line at height `y`, and its sense: downward (1) or upward (-1).
fn crossing([from, to]: [Vec2; 2], y: f32) -> Option<(f32, i32)> {
    let (below, ends_below) = (from.y <= y, to.y <= y);
    (below != ends_below).then(|| {
        let share = (y - from.y) / (to.y - from.y);
        (from.x + (to.x - from.x) * share, if below { -1 } else { 1 })
    })
}

/// Two sides of a polygon that meet elsewhere than in the corner they share, named by their first corners.
pub(super) fn meeting(contour: &[Vec2]) -> Option<(usize, usize)> {
    let count = contour.len();
    let side = |i: usize| [contour[i], contour[(i + 1) % count]];
    let mut order: Vec<usize> = (0..count).collect();
    let left = |i: usize| side(i)[0].x.min(side(i)[1].x);
    order.sort_by(|&a, &b| left(a).total_cmp(&left(b)).then(a.cmp(&b)));
    for (place, &i) in order.iter().enumerate() {
        let [a, b] = side(i);
        let (right, low, high) = (a.x.max(b.x), a.y.min(b.y), a.y.max(b.y));
        for &j in order[place + 1..].iter().take_while(|&&j| left(j) <= right) {
            let [c, d] = side(j);
            if c.y.max(d.y) < low || c.y.min(d.y) > high {
                continue;
            }
            let meets = match (j + count - i) % count {
                1 => turns_back(a, b, d),
                last if last == count - 1 => turns_back(c, d, b),
                _ => segments_meet([a, b], [c, d]),
            };
            if meets {
                return Some((i.min(j), i.max(j)));
            }
        }
    }
    None
}

/// Side of the line from a to b on which the point c lies.
fn turn(a: Vec2, b: Vec2, c: Vec2) -> f64 {
    let [a, b, c]: [DVec2; 3] = [a, b, c].map(Vec2::as_dvec2);
    (b - a).perp_dot(c - a)
}

/// `true` if the path from a through b to c doubles back on itself.
fn turns_back(a: Vec2, b: Vec2, c: Vec2) -> bool {
    turn(a, b, c) == 0.0 && (b - a).as_dvec2().dot((c - b).as_dvec2()) < 0.0
}

fn segments_meet([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> bool {
    let sides = [turn(c, d, a), turn(c, d, b), turn(a, b, c), turn(a, b, d)];
    let [at_a, at_b, at_c, at_d] = sides;
    if at_a * at_b < 0.0 && at_c * at_d < 0.0 {
        return true;
    }
    let within = |p: Vec2, a: Vec2, b: Vec2| p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all();
    let touches = [(at_a, a, [c, d]), (at_b, b, [c, d]), (at_c, c, [a, b]), (at_d, d, [a, b])];
    touches.iter().any(|&(side, point, [from, to])| side == 0.0 && within(point, from, to))
}

/// An [`Outline`] given a depth, in the plane z = 0: a solid letter.
///
/// ```
/// use treesynth::{Shape, glam::{Vec2, Vec3}, shape::{Extrusion, Outline}};
///
/// let corners = [(-2.0, 0.0), (2.0, 0.0), (2.0, 3.0), (-2.0, 3.0)].map(Vec2::from);
/// let hole = [(-1.0, 1.0), (-1.0, 2.0), (1.0, 2.0), (1.0, 1.0)].map(Vec2::from);
/// let frame = Extrusion::new(Outline::new(corners).and(hole), 0.5);
/// assert!(frame.contains(Vec3::new(0.0, 0.5, 0.2)) && !frame.contains(Vec3::new(0.0, 1.5, 0.0)));
/// assert!((frame.volume() - 5.0).abs() < 0.1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Extrusion {
    outline: Outline,
    depth: f32,
}

impl Extrusion {
    /// Solid within `depth / 2` metres of the outline's inside; `depth` from 1e-6 to 1e6.
    pub fn new(outline: Outline, depth: f32) -> Self {
        Self { outline, depth }
    }

    /// The outline.
    pub fn outline(&self) -> &Outline {
        &self.outline
    }

    /// The depth, metres.
    pub fn depth(&self) -> f32 {
        self.depth
    }
}

impl Shape for Extrusion {
    fn contains(&self, point: Vec3) -> bool {
        self.bounds().contains(point) && self.outline.contains(point.xy())
    }

    fn bounds(&self) -> Bounds {
        let half = 0.5 * self.depth;
        Bounds::new(self.outline.min().extend(-half), self.outline.max().extend(half))
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.outline.check()?;
        check_length("Extrusion.depth", self.depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points<const N: usize>(points: [(f32, f32); N]) -> Vec<Vec2> {
        points.map(Vec2::from).to_vec()
    }

    fn named(outline: &Outline) -> Result<(), String> {
        outline.check().map_err(|error| error.parameter)
    }

    #[test]
    fn a_polygon_that_meets_itself_is_an_error() {
        let crossing = [
            points([(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)]),
            // A corner on a side, a corner on a corner, a side that comes back.
            points([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 0.0), (0.0, 4.0)]),
            points([(0.0, 0.0), (1.0, 1.0), (0.0, 2.0), (2.0, 2.0), (1.0, 1.0), (2.0, 0.0)]),
            points([(0.0, 0.0), (4.0, 0.0), (2.0, 0.0), (2.0, 3.0)]),
        ];
        for polygon in crossing {
            for start in 0..polygon.len() {
                let mut polygon = polygon.clone();
                polygon.rotate_left(start);
                assert_eq!(
                    named(&Outline::new(polygon.clone())),
                    Err("Outline.contours[0]".into()),
                    "{polygon:?}"
                );
                polygon.reverse();
                assert_eq!(named(&Outline::new(polygon)), Err("Outline.contours[0]".into()));
            }
        }
        let message =
            Outline::new(points([(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)])).check().unwrap_err();
        assert_eq!(
            message.to_string(),
            "Outline.contours[0] is a polygon whose sides from corners 0 and 2 meet, but must be one that does not \
             cross or touch itself"
        );
    }

    #[test]
    fn what_is_no_polygon_is_named() {
        assert_eq!(named(&Outline::new([])), Err("Outline.corners".into()));
        assert_eq!(named(&Outline::smooth([])), Err("Outline.corners".into()));
        assert_eq!(named(&Outline::new(points([(0.0, 0.0), (1.0, 0.0)]))), Err("Outline.corners".into()));
        let triangle = points([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)]);
        assert_eq!(named(&Outline::new(triangle.clone())), Ok(()), "closed by hand");
        assert_eq!(
            named(&Outline::new(triangle.clone()).and(points([(5.0, 5.0)]))),
            Err("Outline.contours[1]".into())
        );
        assert_eq!(
            named(&Outline::new(points([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]))),
            Err("Outline.size".into())
        );
        for bad in [f32::NAN, f32::INFINITY, -2e6] {
            let mut polygon = triangle.clone();
            polygon[1].y = bad;
            let outline = Outline::new(polygon);
            assert_eq!(named(&outline), Err("Outline.corners".into()));
            assert!(!outline.contains(Vec2::splat(0.1)) || bad < 0.0);
        }
        assert_eq!(named(&Outline::new(vec![Vec2::ONE; 50_000])), Err("Outline.corners".into()));
    }

    #[test]
    fn spans_and_holes() {
        let square = |low: f32, high: f32| points([(low, low), (high, low), (high, high), (low, high)]);
        let mut inner = square(1.0, 2.0);
        let united = Outline::new(square(0.0, 3.0)).and(inner.clone()).and(square(2.5, 5.0));
        assert_eq!(united.spans(1.5).as_slice(), [(0.0, 3.0)]);
        assert_eq!(united.spans(2.7).as_slice(), [(0.0, 5.0)]);
        inner.reverse();
        let frame = Outline::new(square(0.0, 3.0)).and(inner);
        assert_eq!(frame.spans(1.5).as_slice(), [(0.0, 1.0), (2.0, 3.0)]);
        assert!(frame.spans(-0.1).is_empty() && frame.spans(f32::NAN).is_empty());
        assert!(!frame.contains(Vec2::splat(1.5)) && frame.contains(Vec2::new(0.5, 1.5)));
        let fitted = frame.fitted(2.0, 6.0);
        assert_eq!((fitted.min(), fitted.max()), (Vec2::new(-3.0, 2.0), Vec2::new(3.0, 8.0)));
    }

    proptest! {
        /// Inside by spans, by crossings, and by the sum of angles are the same.
        #[test]
        fn inside_is_where_it_winds(
            corners in prop::collection::vec([-4_i32..5, -4_i32..5], 3..12),
            places in prop::collection::vec([-5.0_f32..5.0, -5.0_f32..5.0], 20),
        ) {
            let corners: Vec<Vec2> = corners.into_iter().map(|c| Vec2::from_array(c.map(|x| x as f32))).collect();
            let outline = Outline::new(corners);
            for place in places.into_iter().map(Vec2::from_array) {
                let angles = outline.contours().iter().flat_map(|contour| sides(contour));
                let turned: f32 = angles.map(|[from, to]| (from - place).angle_to(to - place)).sum();
                let near = outline.contours().iter().flat_map(|contour| sides(contour)).any(|[from, to]| {
                    turn(from, to, place).abs() < 1e-3
                });
                if near {
                    continue;
                }
                let winds = (turned / std::f32::consts::TAU).round() != 0.0;
                prop_assert_eq!(outline.contains(place), winds, "{}", place);
                let spans = outline.spans(place.y);
                prop_assert_eq!(spans.iter().any(|&(from, to)| from <= place.x && place.x <= to), winds);
            }
        }

        /// The sweep finds what comparing all pairs finds.
        #[test]
        fn meetings_equal_brute_force(corners in prop::collection::vec([-4_i32..5, -4_i32..5], 3..9)) {
            let mut corners: Vec<Vec2> =
                corners.into_iter().map(|c| Vec2::from_array(c.map(|x| x as f32))).collect();
            corners.dedup();
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            prop_assume!(corners.len() >= 3);
            let count = corners.len();
            let side = |i: usize| [corners[i % count], corners[(i + 1) % count]];
            let any = (0..count).any(|i| {
                turns_back(side(i)[0], side(i)[1], side(i + 1)[1])
                    || (i + 2..count).any(|j| (i, j) != (0, count - 1) && segments_meet(side(i), side(j)))
            });
            prop_assert_eq!(meeting(&corners).is_some(), any);
        }
    }
}
