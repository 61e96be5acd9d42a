//! Polygons as they are read, before they are a solid.

use glam::{DVec3, Vec3};

use super::polygon::triangulate;
use super::{Import, MeshFormat, unreadable};
use crate::shape::{LARGEST, TriangleMesh, TriangleMeshError};

/// Largest move of a corner by rounding to `f32`, as a part of the model's longest side; more would
/// make another model of it.
const MOST_ROUNDING: f64 = 1.0 / 256.0;

/// Vertices and polygons of them.
#[derive(Default)]
pub(super) struct Soup {
    pub(super) positions: Vec<DVec3>,
    /// The corners of all polygons, one after the other.
    corners: Vec<u32>,
    /// End of each polygon's corners.
    ends: Vec<u32>,
}

impl Soup {
    /// A polygon of vertices that are there, or will be in the end.
    pub(super) fn polygon(&mut self, corners: impl IntoIterator<Item = u32>) {
        self.corners.extend(corners);
        self.close();
    }

    /// One more corner of the latest polygon.
    pub(super) fn corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Ends the latest polygon; with fewer than three corners it is none.
    pub(super) fn close(&mut self) {
        let start = self.ends.last().map_or(0, |&end| end as usize);
        if self.corners.len() < start + 3 {
            self.corners.truncate(start);
        } else {
            self.ends.push(self.corners.len() as u32);
        }
    }

    /// Corners of all polygons.
    pub(super) fn corners(&self) -> usize {
        self.corners.len()
    }

    /// Area that the polygons enclose, upright, in metres, near the origin.
    pub(super) fn solid(
        mut self,
        format: MeshFormat,
        import: &Import,
    ) -> Result<TriangleMesh, TriangleMeshError> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for position in &mut self.positions {
            *position = import.up.upright((*position + import.offset) * import.unit);
            (low, high) = (low.min(*position), high.max(*position));
        }
        let hint = "Import::with_offset moves a model nearer, Import::with_unit scales it";
        let (mut rounding, mut positions) = (0.0_f64, Vec::with_capacity(self.positions.len()));
        for (vertex, &position) in self.positions.iter().enumerate() {
            if !position.abs().cmple(DVec3::splat(LARGEST.into())).all() {
                let problem = format!(
                    "{position}, but positions must be from -1e6 to 1e6 metres on every axis; {hint}"
                );
                return Err(unreadable(format, format_args!("vertex {vertex}"), problem));
            }
            let rounded: Vec3 = position.as_vec3();
            rounding = rounding.max((rounded.as_dvec3() - position).abs().max_element());
            positions.push(rounded);
        }
        if rounding > 0.0 && rounding > MOST_ROUNDING * (high - low).max_element() {
            let problem = format!(
                "the model is {} metres long at {low}, where 32-bit floats would move its corners by {rounding}; {hint}",
                (high - low).max_element()
            );
            return Err(unreadable(format, "positions", problem));
        }
        let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(self.ends.len());
        let (mut start, mut places, mut distinct) = (0, Vec::new(), Vec::new());
        for &end in &self.ends {
            let all = &self.corners[start..end as usize];
            start = end as usize;
            let mut corners = all;
            if all.len() > 3 {
                // Corners that follow each other in one place are one.
                let place = |corner: &u32| self.positions.get(*corner as usize);
                distinct.clear();
                distinct.extend_from_slice(all);
                distinct.dedup_by(|a, b| place(a) == place(b));
                while distinct.len() > 1
                    && distinct.first().and_then(place) == distinct.last().and_then(place)
                {
                    distinct.pop();
                }
                corners = &distinct;
            }
            if let &[a, b, c] = corners {
                triangles.push([a, b, c]);
                continue;
            }
            places.clear();
            places.extend(corners.iter().filter_map(|&corner| self.positions.get(corner as usize)));
            let whole = places.len() == corners.len();
            if !whole || !triangulate(&places, |t| triangles.push(t.map(|corner| corners[corner]))) {
                let problem = "a polygon too intricate to be cut into triangles; cut it before";
                return Err(unreadable(format, format_args!("{} corners", corners.len()), problem));
            }
        }
        drop(self);
        TriangleMesh::new(&positions, &triangles)
    }
}
