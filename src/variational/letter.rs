//! Solid letters, for figure 13.

use std::f32::consts::PI;

use glam::Vec2;

use crate::math::sin_cos;
use crate::shape::Outline;

/// Metres: how wide a letter is, how high, and how thick its strokes are.
const WIDE: f32 = 5.0;
const HIGH: f32 = 6.5;
const STROKE: f32 = 1.2;
/// Distance of the strokes' middle lines from the letter's box, metres.
const EDGE: f32 = 0.5 * STROKE;

/// The outline of one of the letters of GRAPHICS, standing on y = `base`, in the middle of x = 0; each stroke a polygon of
/// its own.
pub(super) fn letter(letter: char, base: f32) -> Outline {
    let (left, right, middle) = (EDGE, WIDE - EDGE, 0.5 * WIDE);
    let (top, half) = (HIGH - EDGE, 0.5 * HIGH);
    let bowl = || {
        let mut line = vec![(left, top), (2.8, top)];
        line.extend(arc((2.8, 0.5 * (top + 2.9)), (1.6, 0.5 * (top - 2.9)), 80.0, -80.0));
        line.extend([(2.8, 2.9), (left, 2.9)]);
        line
    };
    let stem = |x: f32| vec![(x, 0.0), (x, HIGH)];
    let ring = |from: f32, to: f32| arc((middle, half), (middle - EDGE, half - EDGE), from, to);
    let strokes: Vec<Vec<(f32, f32)>> = match letter {
        'G' => vec![ring(48.0, 322.0), vec![(right, 0.9), (right, 3.2)], vec![(2.6, 2.7), (WIDE, 2.7)]],
        'R' => vec![stem(left), bowl(), vec![(2.2, 3.0), (right, 0.0)]],
        'A' => vec![
            vec![(left, 0.0), (middle, HIGH)],
            vec![(right, 0.0), (middle, HIGH)],
            vec![(1.2, 1.7), (3.8, 1.7)],
        ],
        'P' => vec![stem(left), bowl()],
        'H' => vec![stem(left), stem(right), vec![(left, half), (right, half)]],
        'C' => vec![ring(48.0, 312.0)],
        'S' => {
            let radii = (middle - EDGE, 0.5 * (half - EDGE));
            let mut line = arc((middle, half + radii.1), radii, 35.0, 270.0);
            line.extend(arc((middle, half - radii.1), radii, 80.0, -145.0));
            vec![line]
        }
        _ => vec![stem(middle)],
    };
    let shift = Vec2::new(-middle, base);
    let mut bands = strokes.iter().map(|line| {
        let line: Vec<Vec2> = line.iter().map(|&point| Vec2::from(point) + shift).collect();
        // The counter of the A is small.
        band(&line, if letter == 'A' { 0.42 } else { EDGE })
    });
    let first = Outline::new(bands.next().unwrap_or_default());
    bands.fold(first, Outline::and)
}

/// Points on a part of an ellipse, degrees.
fn arc(center: (f32, f32), radii: (f32, f32), from: f32, to: f32) -> Vec<(f32, f32)> {
    const PIECES: u32 = 24;
    (0..=PIECES)
        .map(|i| {
            let (sin, cos) = sin_cos((from + (to - from) * i as f32 / PIECES as f32) / 180.0 * PI);
            (center.0 + radii.0 * cos, center.1 + radii.1 * sin)
        })
        .collect()
}

/// The polygon around a line, `half` to each side, counter-clockwise.
fn band(line: &[Vec2], half: f32) -> Vec<Vec2> {
    let along =
        |i: usize| (line[(i + 1).min(line.len() - 1)] - line[i.min(line.len() - 2)]).normalize_or_zero();
    let side = |i: usize| {
        let (before, after) = (along(i.saturating_sub(1)), along(i));
        let across = (before + after).normalize_or_zero().perp();
        // A mitre.
        across * (half / across.dot(after.perp()).max(0.5))
    };
    let right = (0..line.len()).map(|i| line[i] - side(i));
    let left = (0..line.len()).rev().map(|i| line[i] + side(i));
    right.chain(left).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_outlines_of_one_size() {
        for name in "GRAPHICS".chars() {
            let outline = letter(name, 2.0);
            assert_eq!(outline.check(), Ok(()), "{name}");
            let (min, max) = (outline.min(), outline.max());
            assert!((min.y - 2.0).abs() < 0.5 && (max.y - 2.0 - HIGH).abs() < 0.5, "{name} {min} {max}");
            assert!(min.x > -0.5 * WIDE - 0.3 && max.x < 0.5 * WIDE + 0.3, "{name} {min} {max}");
        }
        // Their holes are holes.
        let inside = |name, x: f32, y: f32| letter(name, 0.0).contains(Vec2::new(x, y));
        assert!(!inside('A', 0.0, 3.2) && inside('A', 0.0, 2.0) && !inside('A', 0.0, 0.5));
        assert!(
            !inside('P', 0.0, 4.4)
                && inside('P', -1.9, 1.0)
                && !inside('P', 1.0, 1.0)
                && inside('R', 1.5, 0.6)
        );
        assert!(!inside('G', 0.0, 4.0) && inside('G', 1.0, 2.7) && !inside('C', 1.0, 2.7));
    }
}
