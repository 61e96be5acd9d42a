//! A graph on a surface of triangles, for climbers such as ivy, or roots on a rock.

mod nodes;
mod triangles;
mod walk;

use super::{Graph, GraphBuilder, GraphError};
use crate::math::{UP, perpendicular};
use crate::observer::{Observer, Work, report};
use crate::parallel;
use crate::parameter::ParameterError;
use crate::shape::TriangleMesh;
use glam::Vec3;
use nodes::Cells;
use std::sync::{Arc, OnceLock};
use triangles::Triangles;
use walk::{Place, Walk};

/// Longest edge, in spacings.
const REACH: f32 = 3.0;
/// Sectors of the tangent plane, as many as the paper's graph has.
const SECTORS: usize = 8;
/// Nodes on a square of the spacing's side: disks of half the spacing, dropped at random until none fits, cover 0.547 of
/// a plane (Feder 1980, "Random sequential adsorption").
const DENSITY: f32 = 0.697;
const MAX_NODES: f32 = 2e7;

/// A graph on a surface of triangles: Poisson-disc nodes on it, edges along it.
///
/// No two nodes on one side of the surface are nearer than the spacing. (Nodes whose normals differ by more than 120°
/// lie on different sides, of a wall for example, and do not mind each other.) Hardly a point of the surface is more than one
/// spacing from a node: 1.05 was the worst of 20,000 measured. A node's edges lead to the nearest node in each
/// of 8 sectors of its tangent plane, and back.
///
/// Each edge is at most 3 spacings long, and a path on the surface from one end to the other keeps
/// within the [tolerance](Self::with_tolerance) of it and is at most 1.5 times as long. So no edge
/// tunnels through a wall to its other side, however thin it is, except around its rim, and none
/// bridges a gap. The path is the cut of the surface with the plane through the edge and its ends'
/// mean normal.
///
/// Surfaces may be open, or in several pieces; vertices in one place are one. Where more than two triangles meet in a
/// side, no edge crosses that side. Normals look to where the corners of a triangle run counter-clockwise. [`nodes`](Self::nodes) gives the normals of the graph's nodes to rules and to leaves.
/// No branch reaches beyond the root's piece of the surface.
///
/// O(n + t) memory for n nodes and t triangles; O(t log t + n (1 + k) log n) time, with k the triangles that an edge crosses. Edges
/// are found on all threads with the feature `parallel`, nodes on one.
///
/// ```
/// use treesynth::{Silent, glam::Vec3, guided::{GraphBuilder, PoissonSurface}};
///
/// // Two walls in a corner.
/// let corners = vec![
///     Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::Y + Vec3::Z, Vec3::Z,
/// ];
/// let triangles = vec![[0, 1, 2], [0, 2, 3], [5, 0, 3], [5, 3, 4]];
/// let walls = PoissonSurface::new(corners, triangles).with_spacing(0.08);
/// let graph = walls.build(1, &Silent)?;
/// assert_eq!(graph.position(graph.root()), Vec3::ZERO);
/// assert!(graph.hops_from_root().iter().all(|&hops| hops < 40));
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[must_use]
#[derive(Debug, Clone)]
pub struct PoissonSurface {
    positions: Arc<[Vec3]>,
    triangles: Arc<[[u32; 3]]>,
    size: Size,
    tolerance: f32,
    root: Vec3,
    /// Made when first asked for.
    welded: Arc<OnceLock<Triangles>>,
}

crate::recipe::readable!(PoissonSurface { tolerance: f32, root: Vec3 });

#[derive(Debug, Clone, Copy)]
enum Size {
    Nodes(usize),
    Spacing(f32),
}

/// Positions of the nodes of a [`PoissonSurface`] and the surface's normals there.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SurfaceNodes {
    /// Metres; in the order of the graph's nodes, the root first.
    pub positions: Vec<Vec3>,
    /// Unit normals of the triangles that the nodes lie on.
    pub normals: Vec<Vec3>,
    /// The triangles that they lie on, by their numbers in the mesh.
    pub triangles: Vec<u32>,
}

impl PoissonSurface {
    /// 20,000 nodes on a mesh: positions in metres, three numbers of positions per triangle. The root is the
    /// point of the surface nearest to the origin.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            positions: positions.into(),
            triangles: triangles.into(),
            size: Size::Nodes(20_000),
            tolerance: 0.5,
            root: Vec3::ZERO,
            welded: Arc::default(),
        }
    }

    /// The same on the surface of a solid.
    pub fn of(solid: &TriangleMesh) -> Self {
        let corners = solid.triangles().as_flattened().to_vec();
        let triangles = (0..solid.triangles().len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        Self::new(corners, triangles.collect())
    }

    /// Approximate number of nodes, in [1, 20000000]; the spacing follows from the surface's area.
    pub fn with_nodes(mut self, nodes: usize) -> Self {
        self.size = Size::Nodes(nodes);
        self
    }

    /// The least distance between two nodes, metres, above 0 and coarse enough for at most 2e7 nodes.
    pub fn with_spacing(mut self, spacing: f32) -> Self {
        self.size = Size::Spacing(spacing);
        self
    }

    /// Largest distance of an edge from the surface, in spacings, in (0, 1]; default 0.5. Smaller
    /// values keep edges from cutting corners, and leave fewer ways around them.
    pub fn with_tolerance(mut self, spacings: f32) -> Self {
        self.tolerance = spacings;
        self
    }

    /// The root is the point of the surface nearest to this, metres.
    pub fn with_root(mut self, root: Vec3) -> Self {
        self.root = root;
        self
    }

    /// The spacing in metres, given or from the number of nodes and the surface's area.
    ///
    /// # Errors
    /// When an option is out of range, or the mesh has no area.
    pub fn spacing(&self) -> Result<f32, ParameterError> {
        self.check_mesh()?;
        let area = self.welded().area();
        let range = "triangles with an area above 0 and finite, square metres";
        ParameterError::unless(area > 0.0 && area.is_finite(), "PoissonSurface.triangles", area, range)?;
        match self.size {
            Size::Nodes(nodes) => {
                let holds = (1..=MAX_NODES as usize).contains(&nodes);
                ParameterError::unless(holds, "PoissonSurface.nodes", nodes, "in [1, 20000000]")?;
                Ok((DENSITY * area / nodes as f32).sqrt())
            }
            Size::Spacing(spacing) => {
                let holds =
                    spacing > 0.0 && spacing.is_finite() && DENSITY * area / (spacing * spacing) <= MAX_NODES;
                let range = "finite, above 0 m and coarse enough for at most 20000000 nodes";
                ParameterError::unless(holds, "PoissonSurface.spacing", spacing, range)?;
                Ok(spacing)
            }
        }
    }

    /// The nodes that [`build`](GraphBuilder::build) makes of this seed, in the order of the graph's.
    ///
    /// # Errors
    /// As of `build`.
    pub fn nodes(&self, seed: u64, observer: &dyn Observer) -> Result<SurfaceNodes, GraphError> {
        self.check()?;
        let (surface, spacing) = (self.welded(), self.spacing()?);
        let extent = surface.extent();
        let holds = spacing > extent * 1e-6;
        ParameterError::unless(
            holds,
            "PoissonSurface.spacing",
            spacing,
            "above a millionth of the mesh's size",
        )?;
        let places = nodes::darts(surface, spacing, self.root, seed, observer)?;
        Ok(SurfaceNodes {
            positions: places.iter().map(|place| place.position).collect(),
            normals: places.iter().map(|place| surface.normal(place.triangle)).collect(),
            triangles: places.iter().map(|place| surface.number(place.triangle)).collect(),
        })
    }

    fn welded(&self) -> &Triangles {
        self.welded.get_or_init(|| Triangles::new(&self.positions, &self.triangles))
    }

    fn check_mesh(&self) -> Result<(), ParameterError> {
        let most = 1e6;
        if let Some(position) = self.positions.iter().find(|p| !p.abs().cmple(Vec3::splat(most)).all()) {
            let range = "from -1e6 to 1e6 metres on every axis";
            return Err(ParameterError::new("PoissonSurface.positions", position, range));
        }
        let corners = self.triangles.as_flattened();
        if let Some(corner) = corners.iter().find(|&&corner| corner as usize >= self.positions.len()) {
            let range = format!("below the number of positions, {}", self.positions.len());
            return Err(ParameterError::new("PoissonSurface.triangles", corner, range));
        }
        Ok(())
    }
}

impl GraphBuilder for PoissonSurface {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        let nodes = self.nodes(seed, observer)?;
        let (surface, spacing) = (self.welded(), self.spacing()?);
        report(observer, Work::Edges, 0.0)?;
        let reach = REACH * spacing;
        let mut cells = Cells::new(reach, nodes.positions.len());
        nodes.positions.iter().for_each(|&position| cells.insert(position));
        let place = |node: u32| Place {
            position: nodes.positions[node as usize],
            triangle: surface.place_of(nodes.triangles[node as usize]),
        };
        let walk = Walk { surface, tolerance: self.tolerance * spacing };
        let lists = parallel::map(nodes.positions.len(), |node| {
            let here = place(node as u32);
            let normal = nodes.normals[node];
            // Any direction of the tangent plane will do, but the same for equal normals.
            let east = UP.cross(normal).try_normalize().unwrap_or_else(|| perpendicular(normal));
            let north = normal.cross(east);
            let mut near: Vec<(f32, u32)> = cells
                .around(here.position)
                .filter(|&other| other as usize != node)
                .map(|other| (nodes.positions[other as usize].distance_squared(here.position), other))
                .filter(|&(distance, _)| distance <= reach * reach)
                .collect();
            near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let mut taken = [false; SECTORS];
            let mut links = Vec::new();
            for (_, other) in near {
                let way = nodes.positions[other as usize] - here.position;
                let sector = sector(way.dot(east), way.dot(north));
                if !taken[sector] && walk.leads(here, place(other), normal + nodes.normals[other as usize]) {
                    taken[sector] = true;
                    links.push(other);
                }
            }
            links
        });
        let mut edges: Vec<(u32, u32)> = (0..)
            .zip(lists)
            .flat_map(|(from, list)| list.into_iter().flat_map(move |to| [(from, to), (to, from)]))
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let graph = Graph::new(nodes.positions, &edges, 0)?;
        report(observer, Work::Edges, 1.0)?;
        Ok(graph)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let holds = self.tolerance > 0.0 && self.tolerance <= 1.0;
        ParameterError::unless(holds, "PoissonSurface.tolerance", self.tolerance, "in (0, 1] spacings")?;
        ParameterError::unless(self.root.is_finite(), "PoissonSurface.root", self.root, "finite")?;
        self.spacing().map(drop)
    }
}

/// One of eight equal wedges.
fn sector(x: f32, y: f32) -> usize {
    usize::from(x < 0.0) << 2 | usize::from(y < 0.0) << 1 | usize::from(x.abs() < y.abs())
}
