//! The polygonizer on solids whose surfaces are known.

use super::solid::{Coverage, Part, Solid};
use super::tests::{euler, volume};
use super::{Finish, Voxels};
use crate::surface::{Mesh, SurfaceError};
use crate::{Bounds, math};
use glam::Vec3;
use proptest::prelude::*;

/// The surface in voxels as fine as the details.
pub(super) fn polygonize(
    solid: &impl Solid,
    side: f32,
    most_blocks: usize,
    finish: Finish,
) -> Result<Mesh, SurfaceError> {
    super::polygonize(solid, &Voxels { side, per_detail: 1.0, most_blocks }, finish, &crate::Silent)
}

/// Solids whose value is the distance from their surface, at least near to it, in metres.
#[derive(Debug, Clone)]
enum Form {
    /// The union of balls: middles and radii. Each is to be seen in voxels of an eighth of its radius.
    Balls(Vec<(Vec3, f32)>),
    /// A torus about the y axis.
    Torus { radius: f32, thickness: f32 },
    /// A cuboid of that half size: the least of six planes.
    Cuboid(Vec3),
}

impl Form {
    /// The value, and the gradient where there is one.
    fn at(&self, point: Vec3) -> (f32, Vec3) {
        match self {
            Self::Balls(balls) => {
                let values =
                    balls.iter().map(|&(middle, radius)| (radius - point.distance(middle), middle - point));
                let (value, way) =
                    values.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f32::NEG_INFINITY, Vec3::ZERO));
                (value, way.normalize_or_zero())
            }
            Self::Torus { radius, thickness } => {
                let flat = point.with_y(0.0);
                let away = point - flat.normalize_or_zero() * *radius;
                (thickness - away.length(), -away.normalize_or_zero())
            }
            Self::Cuboid(half) => {
                let planes = *half - point.abs();
                let axis = (0..3).min_by(|&a, &b| planes[a].total_cmp(&planes[b])).unwrap_or(0);
                (planes[axis], -Vec3::AXES[axis] * point[axis].signum())
            }
        }
    }
}

/// A form within a cube: of balls, those that may be the nearest.
#[derive(Debug, Clone)]
struct Piece {
    form: Form,
    detail: f32,
}

impl Solid for Form {
    type Part = Piece;

    fn bounds(&self) -> Bounds {
        match self {
            Self::Balls(balls) => balls.iter().fold(Bounds::EMPTY, |all, &(middle, radius)| {
                all.union(Bounds::around(middle, Vec3::splat(radius)))
            }),
            Self::Torus { radius, thickness } => {
                Bounds::around(Vec3::ZERO, Vec3::new(radius + thickness, *thickness, radius + thickness))
            }
            Self::Cuboid(half) => Bounds::around(Vec3::ZERO, *half),
        }
    }

    fn part(&self, of: Option<&Piece>, cube: Bounds) -> Coverage<Piece> {
        let form = of.map_or(self, |part| &part.form);
        let (value, half) = (form.at(cube.center()).0, cube.size().length() * 0.5 + 1e-6);
        match form {
            _ if value > half => Coverage::Inside,
            _ if value < -half => Coverage::Outside,
            Self::Balls(balls) => {
                let near = |&&(middle, radius): &&(Vec3, f32)| {
                    radius - cube.center().distance(middle) >= value - 2.0 * half
                };
                let balls: Vec<_> = balls.iter().filter(near).copied().collect();
                let detail = balls.iter().map(|ball| ball.1 / 8.0).fold(f32::INFINITY, f32::min);
                Coverage::Crossed(Piece { form: Self::Balls(balls), detail })
            }
            other => Coverage::Crossed(Piece { form: other.clone(), detail: 0.0 }),
        }
    }
}

impl Part for Piece {
    fn value(&self, point: Vec3) -> f32 {
        self.form.at(point).0
    }

    fn gradient(&self, point: Vec3) -> (f32, Vec3) {
        self.form.at(point)
    }

    fn color(&self, point: Vec3) -> [f32; 3] {
        [if point.x > 0.0 { 1.0 } else { 0.0 }, 0.5, 0.25]
    }

    fn detail(&self) -> f32 {
        self.detail
    }

    fn lipschitz(&self) -> f32 {
        1.0
    }
}

/// The mesh, after a check that it is closed, a manifold of that Euler characteristic, and its vertices within half a
/// voxel of the surface.
fn sound(form: &Form, voxel: f32, characteristic: i64) -> Mesh {
    let mesh = polygonize(form, voxel, 100_000, Finish::Colored).expect("a surface");
    assert_eq!(euler(&mesh), Ok(characteristic), "{form:?}");
    for (&position, &normal) in mesh.positions.iter().zip(&mesh.normals) {
        let (value, slope) = form.at(position);
        assert!(value.abs() < 0.5 * voxel, "{value} at {position}");
        assert!(normal.dot(-slope) > 0.999, "{normal} {slope} at {position}");
    }
    assert!(mesh.positions.iter().zip(&mesh.colors).all(|(p, color)| (color[0] > 0.5) == (p.x > 0.0)));
    mesh
}

#[test]
fn a_ball_a_torus_and_a_cuboid_are_closed() {
    let pi = std::f64::consts::PI;
    let ball = sound(&Form::Balls(vec![(Vec3::new(0.3, -0.2, 0.1), 0.5)]), 0.02, 2);
    assert!((volume(&ball) / (pi * 4.0 / 3.0 * 0.125) - 1.0).abs() < 0.005);
    let torus = sound(&Form::Torus { radius: 0.7, thickness: 0.2 }, 0.02, 0);
    assert!((volume(&torus) / (2.0 * pi * pi * 0.7 * 0.04) - 1.0).abs() < 0.005);
    // Marching cubes cut edges off by a part of a voxel.
    let cuboid = sound(&Form::Cuboid(Vec3::new(0.5, 0.3, 0.2)), 0.01, 2);
    assert!((volume(&cuboid) / 0.24 - 1.0).abs() < 0.01);
}

#[test]
fn what_stands_apart_is_closed_each() {
    let balls = (0..5).map(|i| (Vec3::new(i as f32, 0.0, 0.0), 0.3)).collect();
    sound(&Form::Balls(balls), 0.05, 10);
}

/// Voxels grow with the balls: as many vertices on each.
#[test]
fn voxels_are_as_fine_as_the_detail() {
    let balls: Vec<_> = (0..6)
        .map(|i| (Vec3::new(0.0, 3.0 * math::powf(0.25, i as f32), 0.0), 0.5 * math::powf(0.25, i as f32)))
        .collect();
    let finest = balls[5].1 / 8.0;
    let form = Form::Balls(balls.clone());
    let mesh = polygonize(&form, finest, 100_000, Finish::Plain).expect("a surface");
    assert_eq!(euler(&mesh), Ok(12));
    assert!(mesh.colors.is_empty());
    for (middle, radius) in balls {
        let own = mesh.positions.iter().filter(|p| p.distance(middle) < 1.5 * radius).count();
        assert!((500..2500).contains(&own), "{own} vertices on the ball of radius {radius}");
    }
}

#[test]
fn limits_and_nothing() {
    let ball = Form::Balls(vec![(Vec3::ZERO, 1.0)]);
    let error = polygonize(&ball, 0.01, 50, Finish::Plain).expect_err("fifty are not enough");
    assert_eq!(error, SurfaceError::TooManyBlocks { voxel: 0.01, most: 50 });
    assert!(polygonize(&Form::Balls(Vec::new()), 0.1, 50, Finish::Plain).expect("nothing").is_empty());
}

#[cfg(feature = "parallel")]
#[test]
fn threads_change_nothing() {
    let form = Form::Torus { radius: 0.7, thickness: 0.2 };
    let [one, two, five] = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| polygonize(&form, 0.03, 10_000, Finish::Colored)).expect("a surface")
    });
    assert!(one == two && two == five);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// Balls of any sizes, in and through each other: sizes of voxels meet everywhere.
    #[test]
    fn any_balls_are_closed(
        balls in prop::collection::vec(
            ((-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(Vec3::from), 0.03f32..0.6), 1..8),
        voxel in 0.004f32..0.05,
    ) {
        let form = Form::Balls(balls);
        let mesh = polygonize(&form, voxel, 200_000, Finish::Plain).expect("a surface");
        prop_assert!(euler(&mesh).map_err(TestCaseError::fail)? % 2 == 0);
        for &position in &mesh.positions {
            prop_assert!(form.at(position).0.abs() < 0.05, "{}", position);
        }
    }
}
