//! Positional information: a number for each place from one end to the other.

use crate::ParameterError;
use std::fmt::Write as _;

/// Most points of a curve.
const MOST_POINTS: usize = 10_000;
/// Points that stand for each cubic of a Bézier curve.
const STEPS: u32 = 16;
/// Values farther from zero than this are refused, so that sums and products stay finite.
const LARGEST: f32 = 1e12;

/// A function over [0, 1] through given points: what the paper's users draw by hand.
///
/// Between points it is a monotone cubic (Steffen 1990, "A simple method for monotonic interpolation in one
/// dimension"): continuous with its slope, through every point, and never above or below the two points it runs between,
/// so that no length overshoots. Before the first point and after the last it is level.
///
/// ```
/// use treesynth::growth::Curve;
///
/// let height = Curve::new([[0.0, 0.0], [0.4, 15.0], [1.0, 25.0]])?;
/// assert_eq!(height.at(0.4), 15.0);
/// assert!(height.at(0.2) > 6.0 && height.at(0.2) < 9.0);
/// assert!(Curve::new([[0.4, 1.0], [0.1, 2.0]]).is_err());
/// # Ok::<(), treesynth::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<[f32; 2]>", into = "Vec<[f32; 2]>"))]
pub struct Curve {
    points: Vec<[f32; 2]>,
    slopes: Vec<f32>,
}

impl Curve {
    /// The curve through these points, each a place and the value there. O(points).
    ///
    /// # Errors
    /// No points or more than 10,000; places outside of [0, 1], not ascending, not finite; values beyond ±10¹² or not
    /// finite.
    pub fn new(points: impl IntoIterator<Item = [f32; 2]>) -> Result<Self, ParameterError> {
        let points: Vec<_> = points.into_iter().take(MOST_POINTS + 1).collect();
        let count = points.len();
        let holds = (1..=MOST_POINTS).contains(&count);
        ParameterError::unless(holds, "Curve.points", count, "1 to 10000 points")?;
        for (i, &[place, value]) in points.iter().enumerate() {
            let named = |what: &str| format!("Curve.points[{i}].{what}");
            ParameterError::unless((0.0..=1.0).contains(&place), &named("place"), place, "in [0, 1]")?;
            ParameterError::unless(value.abs() <= LARGEST, &named("value"), value, "finite, within ±1e12")?;
            if let Some(before) = i.checked_sub(1).map(|before| points[before][0]) {
                // Closer places would make slopes overflow.
                let holds = place - before >= 1e-6;
                let range = format!("at least 1e-6 above the place before, {before:?}");
                ParameterError::unless(holds, &named("place"), place, &range)?;
            }
        }
        Ok(Self { slopes: slopes(&points), points })
    }

    /// The curve through points that this crate itself gives, in degrees.
    pub(super) fn degrees<const N: usize>(points: [[f32; 2]; N]) -> Self {
        Self::of(points.map(|[place, value]| [place, value.to_radians()]))
    }

    /// The curve through points that this crate itself gives.
    pub(super) fn of<const N: usize>(points: [[f32; 2]; N]) -> Self {
        let points = points.to_vec();
        Self { slopes: slopes(&points), points }
    }

    /// The same value everywhere, which this crate itself gives.
    pub(super) fn constant_of(value: f32) -> Self {
        Self::of([[0.0, value]])
    }

    /// The same value everywhere.
    ///
    /// # Errors
    /// A value beyond ±10¹² or not finite.
    pub fn constant(value: f32) -> Result<Self, ParameterError> {
        Self::new([[0.0, value]])
    }

    /// A Bézier curve of cubics joined at every third control point, as drawing programs have them: 4, 7, 10, ...
    /// points, places in ascending order, so that there is one value at each place.
    ///
    /// Each cubic becomes 16 pieces of a monotone one, which is within some thousandth of its rise, or where the cubic
    /// stands nearly upright within a fifteenth.
    ///
    /// # Errors
    /// Another number of points; places that descend; and as of [`new`](Self::new).
    pub fn bezier(control: &[[f32; 2]]) -> Result<Self, ParameterError> {
        let count = control.len();
        let holds = count >= 4 && count % 3 == 1 && count <= 1000;
        ParameterError::unless(holds, "Curve.bezier", count, "4, 7, 10, ... control points, at most 1000")?;
        for (i, pair) in control.windows(2).enumerate() {
            let place = pair[1][0];
            let range = format!("at least the place before, {:?}", pair[0][0]);
            let name = format!("Curve.bezier[{}].place", i + 1);
            ParameterError::unless(place >= pair[0][0], &name, place, &range)?;
        }
        let mut points = vec![control[0]];
        for cubic in control.windows(4).step_by(3) {
            for step in 1..=STEPS {
                let t = step as f32 / STEPS as f32;
                let u = 1.0 - t;
                let weights = [u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t];
                let sum = |axis: usize| (0..4).map(|i| weights[i] * cubic[i][axis]).sum::<f32>();
                let point = if step == STEPS { cubic[3] } else { [sum(0), sum(1)] };
                // Places coincide where the curve stands upright.
                if point[0] - points[points.len() - 1][0] >= 1e-6 {
                    points.push(point);
                }
            }
        }
        Self::new(points)
    }

    /// The points it goes through, places ascending.
    pub fn points(&self) -> &[[f32; 2]] {
        &self.points
    }

    /// The value at `place`; at the nearer end for places outside of [0, 1]. O(log points).
    #[inline]
    pub fn at(&self, place: f32) -> f32 {
        let after = self.points.partition_point(|point| point[0] <= place);
        let (Some(&[to, end]), true) = (self.points.get(after), after > 0) else {
            return self.points[after.saturating_sub(1)][1];
        };
        let [from, start] = self.points[after - 1];
        let width = to - from;
        let t = (place - from) / width;
        let (first, last) = (self.slopes[after - 1] * width, self.slopes[after] * width);
        let rise = end - start;
        let value =
            start + t * (first + t * (3.0 * rise - 2.0 * first - last + t * (first + last - 2.0 * rise)));
        // Rounding must not lead beyond what the points allow.
        value.clamp(start.min(end), start.max(end))
    }

    /// The least and the greatest value, which points have.
    pub fn range(&self) -> [f32; 2] {
        let values = self.points.iter().map(|point| point[1]);
        values.fold([f32::INFINITY, f32::NEG_INFINITY], |[least, most], y| [least.min(y), most.max(y)])
    }

    /// The same curve with every value multiplied.
    ///
    /// # Errors
    /// Values that leave ±10¹².
    pub fn scaled(&self, factor: f32) -> Result<Self, ParameterError> {
        Self::new(self.points.iter().map(|&[place, value]| [place, value * factor]))
    }

    /// A plot of the curve as an SVG document of 320 by 220 units: its line, its points, the frame with the values at
    /// its edges, and `title` above. For looking at, not for reading back.
    pub fn svg(&self, title: &str) -> String {
        let [low, high] = self.range();
        let span = if high > low { high - low } else { 1.0 };
        let at = |place: f32, value: f32| [50.0 + 250.0 * place, 190.0 - 160.0 * (value - low) / span];
        let mut svg = String::from(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 320 220\" font-family=\"sans-serif\" \
             font-size=\"10\">\n<rect x=\"50\" y=\"30\" width=\"250\" height=\"160\" fill=\"none\" \
             stroke=\"#999\"/>\n<polyline fill=\"none\" stroke=\"#1e5ac8\" stroke-width=\"1.5\" points=\"",
        );
        for step in 0..=200 {
            let place = step as f32 / 200.0;
            let [x, y] = at(place, self.at(place));
            let _ = write!(svg, "{x:.2},{y:.2} ");
        }
        svg.push_str("\"/>\n");
        for &[place, value] in &self.points {
            let [x, y] = at(place, value);
            let _ = writeln!(svg, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2.5\" fill=\"#c82d2d\"/>");
        }
        let escaped = title.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(svg, "<text x=\"50\" y=\"20\">{escaped}</text>");
        for (value, y) in [(high, 34.0), (low, 194.0)] {
            let _ = writeln!(svg, "<text x=\"46\" y=\"{y}\" text-anchor=\"end\">{value:.4}</text>");
        }
        for (place, x) in [("0", 50), ("1", 300)] {
            let _ = writeln!(svg, "<text x=\"{x}\" y=\"204\" text-anchor=\"middle\">{place}</text>");
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// As [`ParameterError::unless`], for all values of a curve.
    pub(super) fn check(&self, parameter: &str, least: f32, most: f32) -> Result<(), ParameterError> {
        let [low, high] = self.range();
        let range = format!("from {least:?} to {most:?} everywhere");
        ParameterError::unless(low >= least && high <= most, parameter, [low, high], &range)
    }
}

/// The slope at each point: Steffen's equations 11 and, at the ends, 24 to 27.
fn slopes(points: &[[f32; 2]]) -> Vec<f32> {
    let secant = |i: usize| (points[i + 1][1] - points[i][1]) / (points[i + 1][0] - points[i][0]);
    let width = |i: usize| points[i + 1][0] - points[i][0];
    let last = points.len() - 1;
    if last < 2 {
        return if last == 1 { vec![secant(0); 2] } else { vec![0.0] };
    }
    let end = |near: f32, far: f32, h: f32, k: f32| {
        let slope = near * (1.0 + h / (h + k)) - far * h / (h + k);
        if slope * near <= 0.0 { 0.0 } else { near.signum() * slope.abs().min(2.0 * near.abs()) }
    };
    let middle = |i: usize| {
        let (before, after, h, k) = (secant(i - 1), secant(i), width(i - 1), width(i));
        if before * after <= 0.0 {
            return 0.0;
        }
        let slope = (before * k + after * h) / (h + k);
        before.signum() * slope.abs().min(2.0 * before.abs().min(after.abs()))
    };
    let mut slopes = vec![end(secant(0), secant(1), width(0), width(1))];
    slopes.extend((1..last).map(middle));
    slopes.push(end(secant(last - 1), secant(last - 2), width(last - 1), width(last - 2)));
    slopes
}

impl TryFrom<Vec<[f32; 2]>> for Curve {
    type Error = ParameterError;

    fn try_from(points: Vec<[f32; 2]>) -> Result<Self, ParameterError> {
        Self::new(points)
    }
}

impl From<Curve> for Vec<[f32; 2]> {
    fn from(curve: Curve) -> Self {
        curve.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_through_its_points_and_is_level_outside() {
        let curve = Curve::new([[0.2, 1.0], [0.5, 3.0], [0.8, 2.0]]).unwrap();
        for (place, value) in [(0.2, 1.0), (0.5, 3.0), (0.8, 2.0), (0.0, 1.0), (1.0, 2.0), (-5.0, 1.0)] {
            assert!((curve.at(place) - value).abs() < 1e-6, "{place}");
        }
        assert!((Curve::constant(4.0).unwrap().at(0.3) - 4.0).abs() < 1e-9);
        assert!((Curve::new([[0.0, 0.0], [1.0, 2.0]]).unwrap().at(0.25) - 0.5).abs() < 1e-6);
    }

    /// Computed by hand: secants 4 and 2, widths 0.25 and 0.75; p = (4·0.75 + 2·0.25) / 1 = 3.5, below 2·2;
    /// at the start 4·1.25 - 2·0.25 = 4.5. At a half of the first piece: (4.5 - 3.5)·0.25/8 above the middle
    /// of 0 and 1.
    #[test]
    fn slopes_are_steffens() {
        let curve = Curve::new([[0.0, 0.0], [0.25, 1.0], [1.0, 2.5]]).unwrap();
        assert!((curve.slopes[0] - 4.5).abs() < 1e-6 && (curve.slopes[1] - 3.5).abs() < 1e-6);
        assert!((curve.at(0.125) - 0.531_25).abs() < 1e-6);
    }

    #[test]
    fn a_bezier_curve_is_followed() {
        // Places are 0, 1/3, 2/3, 1, so that the parameter is the place: 3·u·u·t·0 + 3·u·t·t·1 + t·t·t·1.
        let third = 1.0 / 3.0;
        let curve = Curve::bezier(&[[0.0, 0.0], [third, 0.0], [2.0 * third, 1.0], [1.0, 1.0]]).unwrap();
        for i in 0..=50 {
            let t = i as f32 / 50.0;
            assert!((curve.at(t) - (3.0 * (1.0 - t) * t * t + t * t * t)).abs() < 2e-3, "{t}");
        }
        assert!(Curve::bezier(&[[0.0, 0.0]; 5]).is_err());
        assert!(Curve::bezier(&[[0.0, 0.0], [0.5, 0.0], [0.4, 1.0], [1.0, 1.0]]).is_err());
    }
}
