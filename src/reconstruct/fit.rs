//! Cylinders through points, least squares that outliers do not pull.

use glam::{DVec3, Vec3};

/// A cylinder through some points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cylinder {
    /// A place on the axis, nearest to the points' middle.
    pub(super) center: Vec3,
    pub(super) axis: Vec3,
    pub(super) radius: f32,
    /// Spread of the points about its surface, outliers left out, metres.
    pub(super) spread: f32,
    /// The share of the way around the axis where points are, 0 to 1.
    pub(super) around: f32,
    /// The share of the points that are no outliers.
    pub(super) kept: f32,
}

/// Sectors in which points are looked for.
const SECTORS: usize = 24;

/// Gauss and Newton's method on distances from the surface, with Tukey's weights (Beaton and Tukey 1974), begun with the circle
/// that Kåsa's method (1976) gives across `axis`. `None` where the points do not tell.
pub(super) fn cylinder(points: &[Vec3], axis: Vec3) -> Option<Cylinder> {
    if points.len() < 8 {
        return None;
    }
    let count = points.len() as f64;
    let middle = points.iter().map(|point| point.as_dvec3()).sum::<DVec3>() / count;
    let mut axis = axis.as_dvec3().try_normalize()?;
    let u0 = axis.any_orthonormal_vector();
    let v0 = axis.cross(u0);
    let (mut center, mut radius) = circle(points, middle, [u0, v0])?;
    let mut errors = vec![0.0; points.len()];
    let mut scale = f64::INFINITY;
    for round in 0..12 {
        let (u, v) = {
            let u = axis.any_orthonormal_vector();
            (u, axis.cross(u))
        };
        let residual = |point: &Vec3| {
            let from = point.as_dvec3() - center;
            let along = from.dot(axis);
            let across = from - axis * along;
            let far = across.length();
            (far - radius, along, across / far.max(1e-9))
        };
        for (error, point) in errors.iter_mut().zip(points) {
            *error = residual(point).0.abs();
        }
        let half = errors.len() / 2;
        let median = *errors.select_nth_unstable_by(half, f64::total_cmp).1;
        // 1.4826 times the median is the deviation of a Gaussian; beyond 4.685 of them nothing counts.
        scale = (1.4826 * median).max(2e-4);
        let bound = 4.685 * scale;
        let tilted = round > 2;
        let (mut a, mut b) = ([[0.0; 5]; 5], [0.0; 5]);
        for point in points {
            let (error, along, out) = residual(point);
            let part = error / bound;
            if part.abs() >= 1.0 {
                continue;
            }
            let weight = {
                let w = 1.0 - part * part;
                w * w
            };
            let (ou, ov) = (out.dot(u), out.dot(v));
            let row = [-ou, -ov, -1.0, -along * ou, -along * ov];
            for i in 0..5 {
                for j in 0..5 {
                    a[i][j] += weight * row[i] * row[j];
                }
                b[i] -= weight * row[i] * error;
            }
        }
        for i in 0..5 {
            a[i][i] *= 1.0 + 1e-6;
            if i > 2 && !tilted {
                a[i] = [0.0; 5];
                (a[i][i], b[i]) = (1.0, 0.0);
            }
        }
        if !tilted {
            for row in &mut a[..3] {
                (row[3], row[4]) = (0.0, 0.0);
            }
        }
        let [du, dv, dr, tu, tv] = solve(a, b)?;
        let most = 0.5 * radius.max(0.01);
        let (du, dv, dr) = (du.clamp(-most, most), dv.clamp(-most, most), dr.clamp(-most, most));
        center += u * du + v * dv;
        radius = (radius + dr).abs();
        axis = (axis + u * tu.clamp(-0.2, 0.2) + v * tv.clamp(-0.2, 0.2)).try_normalize()?;
        if round > 3 && du.abs() + dv.abs() + dr.abs() < 1e-6 {
            break;
        }
    }
    center += axis * (middle - center).dot(axis);
    judged(points, center, axis, radius, scale)
}

/// Kåsa's circle across two directions.
fn circle(points: &[Vec3], middle: DVec3, [u0, v0]: [DVec3; 2]) -> Option<(DVec3, f64)> {
    let (mut a, mut b) = ([[0.0; 3]; 3], [0.0; 3]);
    for point in points {
        let from = point.as_dvec3() - middle;
        let (x, y) = (from.dot(u0), from.dot(v0));
        let row = [x, y, 1.0];
        let square = x * x + y * y;
        for i in 0..3 {
            for j in 0..3 {
                a[i][j] += row[i] * row[j];
            }
            b[i] += row[i] * square;
        }
    }
    let [x, y, rest] = solve(a, b)?;
    let (x, y) = (0.5 * x, 0.5 * y);
    Some((middle + u0 * x + v0 * y, (rest + x * x + y * y).max(0.0).sqrt()))
}

/// A cylinder with measures of how well the points support it; nothing if it is not finite.
fn judged(points: &[Vec3], center: DVec3, axis: DVec3, radius: f64, scale: f64) -> Option<Cylinder> {
    let mut sectors = [false; SECTORS];
    let (u, v) = {
        let u = axis.any_orthonormal_vector();
        (u, axis.cross(u))
    };
    let (mut kept, mut squares) = (0.0, 0.0);
    for point in points {
        let from = point.as_dvec3() - center;
        let across = from - axis * from.dot(axis);
        let error = across.length() - radius;
        if error.abs() > 3.0 * scale {
            continue;
        }
        kept += 1.0;
        squares += error * error;
        let turn = libm::atan2(across.dot(v), across.dot(u)) / std::f64::consts::TAU + 0.5;
        sectors[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
    }
    let around = sectors.iter().filter(|seen| **seen).count() as f32 / SECTORS as f32;
    let fit = Cylinder {
        center: center.as_vec3(),
        axis: axis.as_vec3(),
        radius: radius as f32,
        spread: (squares / f64::max(kept, 1.0)).sqrt() as f32,
        around,
        kept: (kept / points.len() as f64) as f32,
    };
    (fit.center.is_finite() && fit.radius.is_finite()).then_some(fit)
}

/// Gauss's elimination with the largest pivot; `None` where there is none.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    for column in 0..N {
        let pivot = (column..N).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs()))?;
        a.swap(column, pivot);
        b.swap(column, pivot);
        let top = a[column];
        if top[column].abs() < 1e-18 || !top[column].is_finite() {
            return None;
        }
        for row in column + 1..N {
            let part = a[row][column] / top[column];
            for (to, from) in a[row].iter_mut().zip(top).skip(column) {
                *to -= part * from;
            }
            b[row] -= part * b[column];
        }
    }
    for row in (0..N).rev() {
        let rest: f64 = (row + 1..N).map(|at| a[row][at] * b[at]).sum();
        b[row] = (b[row] - rest) / a[row][row];
    }
    Some(b)
}
