//! Division of the directions around a node for a Yao graph.

use crate::math;
use crate::parameter::ParameterError;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// The sectors around a node.
#[derive(Debug, Clone)]
pub(in crate::guided) enum Sectors {
    /// The eight octants, by the signs of the coordinates; zero counts as positive.
    Octants,
    /// Equal wedges of the plane z = 0, counter-clockwise from +X.
    Wedges(usize),
    /// Each direction belongs to the nearest of these unit vectors.
    Nearest(Vec<Vec3>),
}

impl Sectors {
    pub(in crate::guided) fn new(count: usize, planar: bool) -> Self {
        match (planar, count) {
            (true, _) => Self::Wedges(count),
            (false, 8) => Self::Octants,
            (false, _) => Self::Nearest(fibonacci_sphere(count)),
        }
    }

    pub(in crate::guided) fn are_planar(&self) -> bool {
        matches!(self, Self::Wedges(_))
    }

    pub(super) fn check(parameter: &str, count: usize) -> Result<(), ParameterError> {
        ParameterError::unless((3..=64).contains(&count), parameter, count, "in [3, 64]")
    }

    pub(super) fn count(&self) -> usize {
        match self {
            Self::Octants => 8,
            Self::Wedges(count) => *count,
            Self::Nearest(directions) => directions.len(),
        }
    }

    /// The sector that a vector points into.
    #[inline]
    pub(super) fn of(&self, d: Vec3) -> usize {
        match self {
            Self::Octants => octant(d),
            Self::Wedges(8) => wedge_of_eight(d),
            Self::Wedges(count) => {
                let angle = math::atan2(d.y, d.x);
                let turn = if angle < 0.0 { angle + TAU } else { angle } / TAU;
                ((turn * *count as f32) as usize).min(count - 1)
            }
            Self::Nearest(directions) => {
                let mut best = (f32::NEG_INFINITY, 0);
                for (i, direction) in directions.iter().enumerate() {
                    let cosine = direction.dot(d);
                    if cosine > best.0 {
                        best = (cosine, i);
                    }
                }
                best.1
            }
        }
    }

    /// Half-spaces through the origin whose intersection holds the sector: normals that point inwards.
    pub(super) fn half_spaces(&self, sector: usize) -> Vec<Vec3> {
        match self {
            Self::Octants => [Vec3::X, Vec3::Y, Vec3::Z]
                .into_iter()
                .enumerate()
                .map(|(axis, normal)| if sector >> axis & 1 == 1 { -normal } else { normal })
                .collect(),
            Self::Wedges(count) => {
                let edge = |i: usize| {
                    let (sin, cos) = math::sin_cos(i as f32 * TAU / *count as f32);
                    Vec3::new(-sin, cos, 0.0)
                };
                vec![edge(sector), -edge(sector + 1)]
            }
            Self::Nearest(directions) => directions
                .iter()
                .enumerate()
                .filter(|&(i, _)| i != sector)
                .map(|(_, other)| (directions[sector] - other).normalize_or_zero())
                .collect(),
        }
    }
}

#[inline]
fn octant(d: Vec3) -> usize {
    usize::from(d.x < 0.0) | usize::from(d.y < 0.0) << 1 | usize::from(d.z < 0.0) << 2
}

/// The 45° wedge by comparisons alone: exact on the borders.
#[inline]
fn wedge_of_eight(d: Vec3) -> usize {
    let (x, y, half) = if d.y > 0.0 || (d.y == 0.0 && d.x >= 0.0) { (d.x, d.y, 0) } else { (-d.x, -d.y, 4) };
    let (x, y, quarter) = if x > 0.0 { (x, y, 0) } else { (y, -x, 2) };
    half + quarter + usize::from(y >= x)
}

/// `count` unit vectors spread evenly over the sphere along a spiral of golden angles.
fn fibonacci_sphere(count: usize) -> Vec<Vec3> {
    let golden_angle = PI * (3.0 - 5f32.sqrt());
    (0..count)
        .map(|i| {
            let y = 1.0 - (2 * i + 1) as f32 / count as f32;
            let (sin, cos) = math::sin_cos(golden_angle * i as f32);
            let across = (1.0 - y * y).max(0.0).sqrt();
            Vec3::new(across * cos, y, across * sin).normalize()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_wedges_are_45_degrees_from_plus_x() {
        let sectors = Sectors::new(8, true);
        for i in 0..360 {
            let (sin, cos) = math::sin_cos((i as f32 + 0.5).to_radians());
            assert_eq!(sectors.of(Vec3::new(cos, sin, 0.0)), i / 45, "{i}.5°");
        }
        let borders = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        for (i, (x, y)) in borders.into_iter().enumerate() {
            assert_eq!(sectors.of(Vec3::new(x as f32, y as f32, 0.0)), i);
        }
    }

    #[test]
    fn half_spaces_hold_their_sector() {
        for sectors in
            [Sectors::new(8, false), Sectors::new(8, true), Sectors::new(5, true), Sectors::new(14, false)]
        {
            let planar = matches!(sectors, Sectors::Wedges(_));
            for d in fibonacci_sphere(501) {
                let d = if planar { Vec3::new(d.x, d.y, 0.0) } else { d };
                for normal in sectors.half_spaces(sectors.of(d)) {
                    assert!(normal.dot(d) > -1e-5, "{sectors:?} {d}");
                }
            }
        }
    }

    #[test]
    fn every_sector_is_used() {
        for count in [6, 12, 20, 64] {
            let sectors = Sectors::new(count, false);
            let mut used = vec![0; count];
            for d in fibonacci_sphere(4000) {
                used[sectors.of(d)] += 1;
            }
            let fair = 4000 / count;
            assert!(used.iter().all(|&n| n > fair / 2 && n < fair * 2), "{count}: {used:?}");
        }
    }
}
