//! Bending of a skeleton in the wind.

use super::axis::thickest;
use super::internodes::Internodes;
use super::{Mesh, SurfaceError, Wind};
use crate::Skeleton;
use crate::math::UP;
use crate::observer::{Cancelled, Watch};
use crate::parallel;
use glam::Vec3;

/// The most that the trunk, a limb and a twig turn what they bear, radians at the strongest gust.
const MOST: [f32; 3] = [0.12, 0.2, 0.25];
/// The strain of the bark at the strongest gust: a branch bends by this over its radius, radians per metre.
/// One strain for all, since trees grow so that thick and thin are equally safe (Metzger 1893).
const STRAIN: f32 = 0.004;
/// The thinnest radius, in the thickest.
const THINNEST: f32 = 1e-3;
/// Vertices of one task.
const CHUNK: usize = 4096;

/// Motion of a skeleton in the wind; gives [`Wind`] to a mesh, whatever made it.
///
/// A branch bends by a [strain](https://en.wikipedia.org/wiki/Bending) of 0.4% at the strongest gust: by
/// 0.004 over its radius, radians per metre, so that thin wood bends more than thick. The turn that adds up
/// along a limb approaches a bound: a turn x becomes x·m / (x + m), with m = 0.12 rad for the trunk, 0.2 for
/// a limb and 0.25 for a twig with all it bears. A branch begins to bend where it is out of its parent
/// branch.
///
/// O(nodes) time; 76 bytes of memory per node, 28 per branch.
///
/// ```
/// use treesynth::surface::{Sway, Tubes};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.02; 2])?;
/// // Tubes know where they are on the skeleton; for any other mesh it is found.
/// let mut mesh = Tubes::default().mesh(&pole)?;
/// Sway::of(&pole)?.clothe(&mut mesh);
/// assert_eq!(mesh.wind.len(), mesh.positions.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sway {
    /// Bend of each node.
    bends: Vec<Bend>,
    parents: Vec<u32>,
    /// The branch of each node.
    branches: Vec<u32>,
    /// For each branch the directions of its limb and twig.
    axes: Vec<[Vec3; 2]>,
    /// The nodes of all branches, and where each branch's begin.
    nodes: Vec<u32>,
    starts: Vec<u32>,
    radii: Vec<f32>,
}

/// Rotation of a place of a branch, level by level, and its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bend {
    pub(crate) at: Vec3,
    pub(crate) angles: [f32; 3],
    pub(crate) moments: [Vec3; 3],
}

impl Bend {
    const NONE: Self = Self { at: Vec3::ZERO, angles: [0.0; 3], moments: [Vec3::ZERO; 3] };

    /// The moments of a point that moves with this place.
    pub(crate) fn moments_of(&self, point: Vec3) -> [Vec3; 3] {
        let way = point - self.at;
        std::array::from_fn(|level| self.moments[level] + way * self.angles[level])
    }

    /// The same bend, expressed for another point that moves with it.
    pub(crate) fn moved_to(&self, point: Vec3) -> Self {
        Self { at: point, angles: self.angles, moments: self.moments_of(point) }
    }

    pub(crate) fn lerp(&self, next: &Self, part: f32) -> Self {
        Self {
            at: self.at.lerp(next.at, part),
            angles: std::array::from_fn(|i| self.angles[i] + (next.angles[i] - self.angles[i]) * part),
            moments: std::array::from_fn(|i| self.moments[i].lerp(next.moments[i], part)),
        }
    }
}

impl Sway {
    /// The bending of a skeleton.
    ///
    /// # Errors
    /// Radii that are all zero; a node more than a million kilometres out or thick.
    pub fn of(skeleton: &Skeleton) -> Result<Self, SurfaceError> {
        let thinnest = thickest(skeleton)? * THINNEST;
        let positions = skeleton.positions();
        let mut sway = Self {
            bends: vec![Bend { at: positions[0], ..Bend::NONE }; skeleton.len()],
            parents: (0..skeleton.len()).map(|node| skeleton.parent(node).unwrap_or(0) as u32).collect(),
            branches: vec![0; skeleton.len()],
            axes: Vec::new(),
            nodes: Vec::new(),
            starts: vec![0],
            radii: skeleton.radii().to_vec(),
        };
        // The sum of the bending of the node's level, unbounded.
        let mut turns = vec![0.0f32; skeleton.len()];
        for (number, branch) in skeleton.branches().iter().enumerate() {
            let nodes = branch.nodes();
            let (base, tip) = (nodes[0] as usize, nodes[nodes.len() - 1] as usize);
            let own = (positions[tip] - positions[base]).normalize_or(UP);
            sway.axes.push(match (branch.order(), sway.axes.get(sway.branches[base] as usize)) {
                (1, _) => [own, Vec3::ZERO],
                (2, Some([limb, _])) => [*limb, own],
                (3.., Some(axes)) => *axes,
                _ => [Vec3::ZERO; 2],
            });
            sway.nodes.extend_from_slice(nodes);
            sway.starts.push(sway.nodes.len() as u32);
            let level = branch.order().min(2) as usize;
            let mut turn = if branch.order() > 2 { turns[base] } else { 0.0 };
            // The length over which it is within its parent branch.
            let mut within = match nodes.get(1) {
                Some(&first) if number > 0 => skeleton.radii()[base] + 2.0 * skeleton.radii()[first as usize],
                _ => 0.0,
            };
            for pair in nodes.windows(2) {
                let [before, node] = [pair[0] as usize, pair[1] as usize];
                let way = positions[node] - positions[before];
                let length = way.length();
                let free = (length - within).max(0.0);
                // Rounding is to leave no wood that is less than not there.
                within = (within - (length - free)).max(0.0);
                let bounded = |turn: f32| turn * MOST[level] / (turn + MOST[level]);
                let earlier = bounded(turn);
                // Bounded, for radii so small that the quotient is infinite or none.
                turn = (turn + free * STRAIN / skeleton.radii()[node].max(thinnest)).min(1e6);
                let mut bend = sway.bends[before].moved_to(positions[node]);
                if free > 0.0 {
                    let more = bounded(turn) - earlier;
                    bend.angles[level] += more;
                    // It turns about the middle of what bends.
                    bend.moments[level] += way * (0.5 * free / length * more);
                }
                sway.bends[node] = bend;
                sway.branches[node] = number as u32;
                turns[node] = turn;
            }
        }
        Ok(sway)
    }

    /// Motion in the wind of a point that moves with the internode of a node, at the place next to the point.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn wind(&self, node: u32, point: Vec3) -> Wind {
        let bend = self.bend(node, point);
        self.wind_of(self.branches[node as usize], node, bend.moments_of(point))
    }

    /// Gives each vertex of a mesh the [`Wind`] of the internode with the nearest surface, in place of what it had. With the feature `parallel`, on rayon's threads. O(vertices · log nodes).
    pub fn clothe(&self, mesh: &mut Mesh) {
        let silent = Watch::silent();
        // Nobody cancels it.
        let _ = self.clothe_watched(mesh, &silent);
    }

    /// As [`clothe`](Self::clothe), with one step per vertex.
    pub(crate) fn clothe_watched(&self, mesh: &mut Mesh, watch: &Watch<'_>) -> Result<(), Cancelled> {
        let ends: Vec<Vec3> = self.bends.iter().map(|bend| bend.at).collect();
        let internodes = Internodes::new(&ends, &self.parents, &self.radii);
        let chunks: Vec<&[Vec3]> = mesh.positions.chunks(CHUNK).collect();
        let of = |position: &Vec3| self.wind(internodes.nearest(*position), *position);
        let wind = parallel::map(chunks.len(), |i| {
            if watch.steps(chunks[i].len()) { chunks[i].iter().map(of).collect() } else { Vec::new() }
        });
        watch.pass(0)?;
        mesh.wind = wind.concat();
        Ok(())
    }

    /// Gives each vertex the [`Wind`] of the trunk at its height, or of its end above that: the mesh leans as one.
    #[cfg(feature = "texture")]
    pub(crate) fn lean(&self, mesh: &mut Mesh) {
        let trunk = self.starts.get(1).map_or(&[][..], |&end| &self.nodes[..end as usize]);
        let wind = |&place: &Vec3| {
            let above = trunk.iter().find(|&&node| self.bends[node as usize].at.y >= place.y);
            above.or(trunk.last()).map_or(Wind::default(), |&node| self.wind(node, place))
        };
        mesh.wind = mesh.positions.iter().map(wind).collect();
    }

    /// Angles by which trunk, limb and twig turn an internode at the place next to a point, radians at the strongest gust.
    pub(crate) fn angles(&self, node: u32, point: Vec3) -> [f32; 3] {
        self.bend(node, point).angles
    }

    /// Motion in the wind of a point of a thing that is attached to an internode next to another point.
    pub(crate) fn carried(&self, node: u32, attached: Vec3, point: Vec3) -> Wind {
        let moments = self.bend(node, attached).moments_of(point);
        self.wind_of(self.branches[node as usize], node, moments)
    }

    fn bend(&self, node: u32, point: Vec3) -> Bend {
        let (from, to) = (&self.bends[self.parents[node as usize] as usize], &self.bends[node as usize]);
        from.lerp(to, part(point, from.at, to.at))
    }

    /// The bend at a fractional number of a node of a branch.
    pub(super) fn bend_at(&self, branch: usize, at: f32) -> Bend {
        let nodes = &self.nodes[self.starts[branch] as usize..self.starts[branch + 1] as usize];
        let number = (at as usize).min(nodes.len() - 1);
        let next = (number + 1).min(nodes.len() - 1);
        let bend = |number: usize| &self.bends[nodes[number] as usize];
        bend(number).lerp(bend(next), at - number as f32)
    }

    /// The node whose internode has that fractional number.
    pub(super) fn node_at(&self, branch: usize, at: f32) -> u32 {
        let nodes = &self.nodes[self.starts[branch] as usize..self.starts[branch + 1] as usize];
        nodes[(at.ceil() as usize).clamp(nodes.len().min(2) - 1, nodes.len() - 1)]
    }

    pub(super) fn wind_of(&self, branch: u32, node: u32, moments: [Vec3; 3]) -> Wind {
        Wind { moments, axes: self.axes[branch as usize], flutter: 0.0, node }
    }
}

/// The part of the way between two points that is next to a third.
pub(super) fn part(point: Vec3, from: Vec3, to: Vec3) -> f32 {
    let way = to - from;
    let square = way.length_squared();
    if square > 0.0 { ((point - from).dot(way) / square).clamp(0.0, 1.0) } else { 1.0 }
}
