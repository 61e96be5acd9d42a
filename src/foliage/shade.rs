//! Shade of leaves within the crown.

use super::Leaves;
use crate::ParameterError;
use crate::math::exp;
use crate::shape::Bounds;
use glam::{IVec3, Vec3};

/// The most cells along the crown's longest side.
const CELLS: f32 = 24.0;
/// The share of their area that leaves turned every way show to a ray.
const SHOWN: f32 = 0.5;
/// Light from straight below, as a share of that from straight above.
const FROM_BELOW: f32 = 0.25;

impl Leaves {
    /// Darkens leaves by how deep they are in the crown: their [tint](crate::surface::Instance::tint) is
    /// multiplied by `1 - strength·(1 - light)`, where `light` is the light that reaches them through the
    /// other leaves, as a share of that of the brightest leaf. `strength` is 0 (nothing changes) to 1.
    ///
    /// Light comes from 14 directions, from above four times as much as from below, and is absorbed by Beer
    /// and Lambert's law, as exp(-area / 2) for `area` square metres of leaves per square metre, on a grid of
    /// at most 24 cells per side. O(leaves + cells) time. It is occlusion of the sky, not a shadow of the
    /// sun.
    ///
    /// ```
    /// use treesynth::foliage::{Foliage, Leaf};
    /// use treesynth::presets;
    ///
    /// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(1000).synthesize(1)?;
    /// let leaves = Foliage::new(Leaf::ovate()).place(&tree, 1)?.shaded(0.7)?;
    /// let green = |leaf: &treesynth::surface::Instance| leaf.tint[1];
    /// assert!(leaves.instances.iter().map(green).fold(1.0, f32::min) >= 0.3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A strength that is not 0 to 1.
    pub fn shaded(mut self, strength: f32) -> Result<Self, ParameterError> {
        let holds = (0.0..=1.0).contains(&strength);
        ParameterError::unless(holds, "Leaves.shaded", strength, "0 to 1")?;
        let canopy = if strength > 0.0 { Canopy::of(std::slice::from_ref(&self)) } else { None };
        let Some(canopy) = canopy else { return Ok(self) };
        for leaf in &mut self.instances {
            let factor = canopy.factor(leaf.position, strength);
            leaf.tint = leaf.tint.map(|channel| channel * factor);
        }
        Ok(self)
    }
}

/// The light in each cell of a crown.
#[derive(Debug)]
pub(crate) struct Canopy {
    low: Vec3,
    cell: f32,
    size: IVec3,
    lights: Vec<f32>,
    /// The light that reaches the brightest leaf.
    brightest: f32,
}

impl Canopy {
    /// The canopy of leaves of all kinds; `None` if there is no crown, or one without extent.
    pub(crate) fn of(all: &[Leaves]) -> Option<Self> {
        let positions = || all.iter().flat_map(|leaves| &leaves.instances).map(|leaf| leaf.position);
        let bounds = Bounds::of(positions());
        let cell = bounds.size().max_element() / CELLS;
        if positions().next().is_none() || !(cell > 0.0 && cell.is_finite()) {
            return None;
        }
        let size = (bounds.size() / cell).as_ivec3() + IVec3::ONE;
        let cells = (size.x * size.y * size.z) as usize;
        let mut canopy = Self { low: bounds.min, cell, size, lights: vec![0.0; cells], brightest: 0.0 };
        // Square metres of leaves per cubic metre.
        let mut densities = vec![0.0f32; cells];
        for leaves in all {
            let area = leaves.leaf.mesh().area();
            for leaf in &leaves.instances {
                let at =
                    ((leaf.position - bounds.min) / cell).as_ivec3().clamp(IVec3::ZERO, size - IVec3::ONE);
                densities[canopy.index(at)] += area * leaf.scale * leaf.scale / (cell * cell * cell);
            }
        }
        let directions = directions();
        for z in 0..size.z {
            for y in 0..size.y {
                for x in 0..size.x {
                    let at = IVec3::new(x, y, z);
                    let index = canopy.index(at);
                    canopy.lights[index] = canopy.reaches(at, &directions, &densities);
                }
            }
        }
        canopy.brightest = positions().map(|point| canopy.light(point)).fold(0.0, f32::max);
        Some(canopy)
    }

    /// Factor on the colours at a point: 1 where it is brightest, down to `1 - strength` where no light
    /// comes.
    pub(crate) fn factor(&self, point: Vec3, strength: f32) -> f32 {
        let light = if self.brightest > 0.0 { (self.light(point) / self.brightest).min(1.0) } else { 1.0 };
        1.0 - strength * (1.0 - light)
    }

    fn index(&self, at: IVec3) -> usize {
        (at.x + self.size.x * (at.y + self.size.y * at.z)) as usize
    }

    fn reaches(&self, at: IVec3, directions: &[(IVec3, f32)], densities: &[f32]) -> f32 {
        let mut light = 0.0;
        for &(way, weight) in directions {
            let step = self.cell * (way.length_squared() as f32).sqrt();
            // The cell itself hides half of what it would.
            let mut hidden = 0.5 * densities[self.index(at)] * step;
            let mut next = at + way;
            while next.cmpge(IVec3::ZERO).all() && next.cmplt(self.size).all() {
                hidden += densities[self.index(next)] * step;
                next += way;
            }
            light += weight * exp(-SHOWN * hidden);
        }
        light
    }

    /// Light at a point, interpolated between the middles of cells.
    fn light(&self, point: Vec3) -> f32 {
        let at = (point - self.low) / self.cell - 0.5;
        let (first, part) = (at.floor(), at - at.floor());
        let mut light = 0.0;
        for corner in 0..8 {
            let offset = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let weights = [(offset.x, part.x), (offset.y, part.y), (offset.z, part.z)]
                .map(|(above, part)| if above == 1 { part } else { 1.0 - part });
            let cell = (first.as_ivec3() + offset).clamp(IVec3::ZERO, self.size - IVec3::ONE);
            light += weights[0] * weights[1] * weights[2] * self.lights[self.index(cell)];
        }
        light
    }
}

/// The ways to the neighbours of a cell across its sides and corners, and the part of the light from there.
fn directions() -> Vec<(IVec3, f32)> {
    let mut ways = Vec::new();
    for x in -1..=1 {
        for y in -1..=1 {
            for z in -1i32..=1 {
                let way = IVec3::new(x, y, z);
                if matches!(way.length_squared(), 1 | 3) {
                    let height = 0.5 + 0.5 * y as f32 / (way.length_squared() as f32).sqrt();
                    ways.push((way, FROM_BELOW + (1.0 - FROM_BELOW) * height));
                }
            }
        }
    }
    let sum: f32 = ways.iter().map(|way| way.1).sum();
    ways.into_iter().map(|(way, weight)| (way, weight / sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foliage::Leaf;
    use crate::surface::Instance;

    /// A ball of leaves, 4 m wide.
    fn ball(count: u32) -> Leaves {
        let mut instances = Vec::new();
        for i in 0..count {
            let at = |k: u32| (i.wrapping_mul(2_654_435_761).rotate_left(7 * k) % 1000) as f32 / 250.0 - 2.0;
            let position = Vec3::new(at(1), at(2), at(3));
            if position.length() <= 2.0 {
                instances.push(Instance { position, scale: 0.08, ..Instance::IDENTITY });
            }
        }
        Leaves { leaf: Leaf::ovate(), instances }
    }

    #[test]
    fn the_inside_is_darker_than_the_rim_and_below_than_above() {
        let leaves = ball(40_000).shaded(0.8).expect("in range");
        let mean = |keep: &dyn Fn(Vec3) -> bool| {
            let kept: Vec<f32> =
                leaves.instances.iter().filter(|leaf| keep(leaf.position)).map(|leaf| leaf.tint[0]).collect();
            kept.iter().sum::<f32>() / kept.len() as f32
        };
        let (inside, rim) = (mean(&|p| p.length() < 0.7), mean(&|p| p.length() > 1.7));
        let (top, bottom) = (mean(&|p| p.y > 1.6), mean(&|p| p.y < -1.6));
        println!("inside {inside}, rim {rim}, top {top}, bottom {bottom}");
        assert!(inside < 0.7 * rim && bottom < 0.9 * top);
        assert!(leaves.instances.iter().all(|leaf| leaf.tint[0] >= 0.199 && leaf.tint[0] <= 1.0));
        assert!(leaves.instances.iter().any(|leaf| leaf.tint[0] > 0.99));
    }

    #[test]
    fn what_is_no_crown_stays_as_it_is() {
        let few = ball(3000);
        assert_eq!(few.clone().shaded(0.0), Ok(few.clone()));
        let one = Leaves { instances: few.instances[..1].to_vec(), ..few.clone() };
        assert_eq!(one.clone().shaded(1.0), Ok(one.clone()));
        let none = Leaves { instances: Vec::new(), ..few.clone() };
        assert_eq!(none.clone().shaded(1.0), Ok(none));
        for wrong in [-0.1, 1.1, f32::NAN] {
            assert!(few.clone().shaded(wrong).is_err());
        }
    }
}
