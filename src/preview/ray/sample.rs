//! Solids for tests: shapes whose roots are known, and unions of many.

use crate::Bounds;
use crate::surface::solid::{Coverage, Part, Solid};
use glam::{Vec2, Vec3, Vec3Swizzles};
use std::sync::Arc;

/// A shape by its distance, below 0 inside.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    Sphere(Vec3, f32),
    /// About the z axis: its middle, the radius of the ring and that of the tube.
    Torus(Vec3, f32, f32),
    Capsule(Vec3, Vec3, f32),
}

impl Shape {
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        match *self {
            Self::Sphere(middle, radius) => p.distance(middle) - radius,
            Self::Torus(middle, ring, tube) => {
                let p = p - middle;
                Vec2::new(p.xy().length() - ring, p.z).length() - tube
            }
            Self::Capsule(from, to, radius) => {
                let way = to - from;
                let t = ((p - from).dot(way) / way.length_squared().max(1e-30)).clamp(0.0, 1.0);
                p.distance(from + way * t) - radius
            }
        }
    }

    fn bounds(&self) -> Bounds {
        match *self {
            Self::Sphere(middle, radius) => Bounds::around(middle, Vec3::splat(radius)),
            Self::Torus(middle, ring, tube) => Bounds::around(middle, Vec3::splat(ring + tube)),
            Self::Capsule(from, to, radius) => {
                let reach = Vec3::splat(radius);
                Bounds::around(from, reach).union(Bounds::around(to, reach))
            }
        }
    }

    fn detail(&self) -> f32 {
        match *self {
            Self::Sphere(_, radius) | Self::Torus(.., radius) | Self::Capsule(.., radius) => radius,
        }
    }
}

/// A union of shapes with a colour each, which keeps only those that count.
#[derive(Debug, Clone)]
pub(super) struct Union(pub(super) Vec<(Shape, [f32; 3])>);

pub(super) fn one(shape: Shape) -> Union {
    Union(vec![(shape, [0.2, 0.15, 0.1])])
}

#[derive(Debug)]
pub(super) struct Near {
    all: Arc<[(Shape, [f32; 3])]>,
    near: Vec<u32>,
}

impl Near {
    fn nearest(&self, point: Vec3) -> (f32, u32) {
        let each = self.near.iter().map(|&i| (self.all[i as usize].0.distance(point), i));
        each.fold((f32::INFINITY, u32::MAX), |best, next| if next.0 < best.0 { next } else { best })
    }
}

impl Solid for Union {
    type Part = Near;

    fn bounds(&self) -> Bounds {
        self.0.iter().fold(Bounds::EMPTY, |bounds, (shape, _)| bounds.union(shape.bounds()))
    }

    fn part(&self, of: Option<&Near>, cube: Bounds) -> Coverage<Near> {
        let (middle, reach) = (cube.center(), 0.8661 * cube.size().x);
        let all = of.map_or_else(|| Arc::from(&self.0[..]), |near| Arc::clone(&near.all));
        let every: Vec<u32>;
        let list = if let Some(near) = of {
            &near.near
        } else {
            every = (0..all.len() as u32).collect();
            &every
        };
        let distances: Vec<f32> = list.iter().map(|&i| all[i as usize].0.distance(middle)).collect();
        let least = distances.iter().copied().fold(f32::INFINITY, f32::min);
        if least > reach {
            return Coverage::Outside;
        }
        if least < -reach {
            return Coverage::Inside;
        }
        let near = list.iter().zip(&distances).filter(|(_, d)| **d <= least + 2.0 * reach);
        Coverage::Crossed(Near { near: near.map(|(&i, _)| i).collect(), all })
    }
}

impl Part for Near {
    fn value(&self, point: Vec3) -> f32 {
        -self.nearest(point).0
    }

    fn gradient(&self, point: Vec3) -> (f32, Vec3) {
        let step = 1e-3 * self.detail();
        let slope = Vec3::AXES.map(|axis| self.value(point + axis * step) - self.value(point - axis * step));
        (self.value(point), Vec3::from_array(slope) / (2.0 * step))
    }

    fn color(&self, point: Vec3) -> [f32; 3] {
        self.all[self.nearest(point).1 as usize].1
    }

    fn detail(&self) -> f32 {
        self.near.iter().map(|&i| self.all[i as usize].0.detail()).fold(f32::INFINITY, f32::min)
    }

    fn lipschitz(&self) -> f32 {
        1.0
    }
}
