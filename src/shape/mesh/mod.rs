//! Solids bounded by triangles.

mod cells;
#[cfg(feature = "import")]
mod file;
mod prepare;
mod sheet;
#[cfg(test)]
mod tests;
mod winding;

use std::fmt;
use std::sync::Arc;

use glam::Vec3;
use rand::RngExt;

use self::cells::Cells;
#[cfg(feature = "import")]
pub use self::file::{Import, MeshFormat};
use self::prepare::prepare;
use self::winding::{Winding, area_vector};
use super::{Bounds, Shape, check_fit};
use crate::ParameterError;

/// Volume inside a surface of triangles: a model as the shape of a crown.
///
/// A point is inside where the surface winds around it, by the generalized winding number of Jacobson and others 2013
/// above a half. On the surface itself either answer may come. Unlike the other shapes it is checked where it is made,
/// and [`check`](Shape::check) has nothing left to say. Cloning shares the triangles.
///
/// Small flaws do not matter: vertices in one place are one, triangles without area are left out, triangles that look
/// the other way than their neighbours are turned, those that lie on one another count once, flat sheets that enclose
/// nothing are left out beside a closed surface, and holes are closed by what is around them. [`flaws`](Self::flaws)
/// says what there was. A wall between two solids that share a face is no flaw. Refused is a surface that leaves in doubt
/// what is inside of it.
///
/// Memory: about 120 bytes per triangle, up to 350 if they are long and thin. [`contains`](Shape::contains)
/// takes O(1) in a closed surface of triangles that are about as large everywhere, however thin they are, and
/// O(log n) in one with holes, if its triangles are not thin.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::TriangleMesh};
///
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let tetrahedron = TriangleMesh::new(&corners, &faces)?;
/// assert!(tetrahedron.flaws().is_none() && (tetrahedron.volume() - 1.0 / 6.0).abs() < 1e-6);
/// assert!(tetrahedron.contains(Vec3::splat(0.2)) && !tetrahedron.contains(Vec3::splat(0.4)));
///
/// let open = TriangleMesh::new(&corners, &faces[1..])?;
/// assert_eq!(open.flaws().to_string(), "3 open sides, and 37% of what it encloses is in doubt");
/// # Ok::<(), treesynth::shape::TriangleMeshError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    solid: Arc<Solid>,
}

#[derive(Debug, PartialEq)]
struct Solid {
    winding: Winding,
    /// Cells of a closed surface.
    cells: Option<Cells>,
    bounds: Bounds,
    volume: f32,
    flaws: Flaws,
    /// The area of the triangles up to each, square metres.
    areas: Vec<f64>,
}

/// Flaw of a surface that can be used all the same.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Flaws {
    /// Triangles without area, left out.
    pub without_area: usize,
    /// Triangles that looked inward, or the other way than those beside them, and were turned.
    pub turned: usize,
    /// Triangles that lay on others, and were left out.
    pub doubled: usize,
    /// Triangles of flat sheets that enclose nothing, left out beside a surface that is closed without them.
    pub loose: usize,
    /// Sides of triangles with no other triangle at them: the edges of holes.
    pub open_sides: usize,
    /// The volume in which the winding number is nearer to a half than to 0 or 1, over the volume enclosed; 0 for a
    /// surface without holes.
    pub doubt: f32,
}

impl Flaws {
    /// `true` if there are no flaws.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for Flaws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_none() {
            return f.write_str("no flaws");
        }
        let holes = format!(
            "{} open sides, and {:.0}% of what it encloses is in doubt",
            self.open_sides,
            100.0 * self.doubt
        );
        let parts = [
            (self.without_area, format!("{} triangles without area", self.without_area)),
            (self.turned, format!("{} triangles that looked the wrong way", self.turned)),
            (self.doubled, format!("{} triangles that lay on others", self.doubled)),
            (self.loose, format!("{} triangles of loose sheets", self.loose)),
            (self.open_sides, holes),
        ];
        let there: Vec<String> = parts.into_iter().filter(|part| part.0 > 0).map(|part| part.1).collect();
        f.write_str(&there.join("; "))
    }
}

/// Error of making a solid of triangles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TriangleMeshError {
    /// A position out of range.
    #[error(
        "vertex {vertex} has the position {position}, but positions must be from -1e6 to 1e6 metres on every axis"
    )]
    Position {
        /// The vertex.
        vertex: usize,
        /// Its position, metres.
        position: Vec3,
    },
    /// An index with no vertex.
    #[error("triangle {triangle} names the vertex {index}, but there are {vertices}")]
    Index {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// No triangle with an area.
    #[error("there is no triangle with an area")]
    Empty,
    /// More triangles than 32-bit numbers can name.
    #[error("there are {count} triangles, but at most 500,000,000 are allowed")]
    TooMany {
        /// The number of triangles.
        count: usize,
    },
    /// The surface encloses nothing.
    #[error("the surface encloses nothing: it is flat, or open with {open_sides} open sides")]
    Nothing {
        /// Sides of triangles with no other triangle at them.
        open_sides: usize,
    },
    /// Inside and outside cannot be distinguished.
    #[error(
        "the surface has {open_sides} open sides, and its winding number leaves {doubt:.1} times the volume that it encloses in doubt; at most 1 is allowed"
    )]
    InDoubt {
        /// Sides of triangles with no other triangle at them.
        open_sides: usize,
        /// As [`Flaws::doubt`].
        doubt: f32,
    },
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A file that cannot be read: its kind, the place in it, what was found and what is required.
    #[cfg(feature = "import")]
    #[error("{0}")]
    File(String),
}

/// The most triangles.
const MOST: usize = 500_000_000;

/// Cells per axis of the lattice on which the volume of a surface with holes is found.
const CELLS: u16 = 16;

impl TriangleMesh {
    /// The body that the `triangles` enclose, each of three of the `positions` (metres, at most 1e6 from 0 on
    /// every axis). Corners are counter-clockwise seen from outside; triangles where they are not are turned.
    /// O(n log n).
    ///
    /// # Errors
    /// Positions out of range, indices without a vertex, nothing enclosed, and a surface with holes so large that
    /// the volume in doubt is larger than what is enclosed.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, TriangleMeshError> {
        if triangles.len() > MOST {
            return Err(TriangleMeshError::TooMany { count: triangles.len() });
        }
        let prepared = prepare(positions, triangles)?;
        let winding = Winding::new(prepared.triangles);
        let bounds = Bounds::of(winding.triangles().iter().flatten().copied());
        let mut flaws = prepared.flaws;
        let open_sides = flaws.open_sides;
        let cells = (open_sides == 0).then(|| Cells::new(winding.triangles(), bounds));
        let mut solid = Solid { winding, cells, bounds, volume: 0.0, flaws, areas: Vec::new() };
        let survey = Survey::of(|point| solid.number(point), bounds);
        let mut volume = prepared.volume as f32;
        if open_sides > 0 {
            flaws.doubt = survey.doubtful as f32 / survey.inside.max(1) as f32;
            if survey.inside == 0 {
                return Err(TriangleMeshError::Nothing { open_sides });
            }
            if flaws.doubt > 1.0 {
                return Err(TriangleMeshError::InDoubt { open_sides, doubt: flaws.doubt });
            }
        }
        if open_sides > 0 || survey.overlaps {
            let lattice = bounds.volume() * survey.inside as f32 / survey.points as f32;
            // A lattice may miss what is thin.
            volume = if survey.inside == 0 { volume } else { lattice };
        }
        let areas: Vec<f64> = solid
            .winding
            .triangles()
            .iter()
            .scan(0.0, |sum, triangle| {
                *sum += f64::from(area_vector(triangle).length());
                Some(*sum)
            })
            .collect();
        // Rounding of corners moves each triangle by about the longest side times epsilon.
        let size = f64::from(bounds.size().max_element());
        let rounding = areas.last().map_or(0.0, |area| area * size * f64::from(f32::EPSILON));
        // Sheets that lie on one another and look both ways.
        let cancels = open_sides == 0 && prepared.volume <= rounding && survey.inside < survey.points / 100;
        if f64::from(volume) <= rounding || volume <= 0.0 || cancels {
            return Err(TriangleMeshError::Nothing { open_sides });
        }
        (solid.volume, solid.flaws, solid.areas) = (volume, flaws, areas);
        Ok(Self { solid: Arc::new(solid) })
    }

    /// Enlarged and moved to stand on the height `base` (-1e6 to 1e6) and to be `height` metres high (1e-6 to 1e6), its
    /// box's middle above the origin.
    ///
    /// # Errors
    /// A base or a height out of range, or a result.
    pub fn fitted(&self, base: f32, height: f32) -> Result<Self, TriangleMeshError> {
        check_fit("TriangleMesh", base, height)?;
        let bounds = self.solid.bounds;
        let scale = height / bounds.size().y;
        let bottom = bounds.center().with_y(bounds.min.y);
        let place = |&corner: &Vec3| (corner - bottom) * scale + Vec3::Y * base;
        let positions: Vec<Vec3> = self.triangles().iter().flatten().map(place).collect();
        let triangles: Vec<[u32; 3]> =
            (0..self.triangles().len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut fitted = Self::new(&positions, &triangles)?;
        // Nobody else holds it yet.
        if let Some(solid) = Arc::get_mut(&mut fitted.solid) {
            solid.flaws = self.flaws();
        }
        Ok(fitted)
    }

    /// Flaws of the triangles that were mended or tolerated.
    pub fn flaws(&self) -> Flaws {
        self.solid.flaws
    }

    /// The triangles, turned to look outward, in an order of their own.
    pub fn triangles(&self) -> &[[Vec3; 3]] {
        self.solid.winding.triangles()
    }

    /// The generalized winding number at `point`: about 1 inside, about 0 outside; exact if the surface is closed, else
    /// within 0.03 of the exact one. NaN for a point that is not finite. As fast as [`contains`](Shape::contains).
    pub fn winding_number(&self, point: Vec3) -> f32 {
        self.solid.number(point)
    }
}

impl Solid {
    fn number(&self, point: Vec3) -> f32 {
        match &self.cells {
            Some(cells) if point.is_finite() => cells.winding(self.winding.triangles(), point) as f32,
            _ => self.winding.number(point),
        }
    }
}

/// Winding numbers at points spread over the bounds.
struct Survey {
    points: u32,
    inside: u32,
    doubtful: u32,
    /// `true` if the surface somewhere winds twice, or backwards.
    overlaps: bool,
}

impl Survey {
    fn of(number: impl Fn(Vec3) -> f32, bounds: Bounds) -> Self {
        let mut survey = Self { points: 0, inside: 0, doubtful: 0, overlaps: false };
        super::lattice(bounds, CELLS, |point| {
            let number = number(point);
            survey.points += 1;
            survey.inside += u32::from(number > 0.5);
            survey.doubtful += u32::from((number - 0.5).abs() < 0.25);
            survey.overlaps |= !(-0.5..1.5).contains(&number);
        });
        survey
    }
}

impl Shape for TriangleMesh {
    fn contains(&self, point: Vec3) -> bool {
        self.solid.bounds.contains(point) && self.solid.number(point) > 0.5
    }

    fn bounds(&self) -> Bounds {
        self.solid.bounds
    }

    fn volume(&self) -> f32 {
        self.solid.volume
    }

    fn surface_area(&self) -> Option<f32> {
        self.solid.areas.last().map(|&area| area as f32)
    }

    fn sample_surface(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        let area = self.solid.areas.last()? * random.random::<f64>();
        let triangle = self.solid.areas.partition_point(|&sum| sum <= area);
        let [a, b, c] = *self.triangles().get(triangle)?;
        // Osada and others 2002, "Shape distributions", equation 1.
        let (root, share) = (random.random::<f32>().sqrt(), random.random::<f32>());
        Some(a * (1.0 - root) + b * (root * (1.0 - share)) + c * (root * share))
    }
}
