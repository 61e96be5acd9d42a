//! From points to a tree: the skeleton of a scanned tree, and its radii.

mod base;
mod complete;
mod contacts;
mod fit;
mod ground;
mod leaves;
mod limbs;
mod net;
mod nodes;
mod orders;
mod prune;
mod radii;
mod stand;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

pub use self::complete::{Completed, Twigs};
use self::fit::Cylinder;
use self::ground::Ground;
pub use self::leaves::PointKind;
use self::limbs::Ring;
use self::nodes::Nodes;
pub use self::stand::ReconstructedStand;
use crate::cloud::Cloud;
use crate::guided::{GraphError, Search, SearchError};
use crate::{ParameterError, Silent, Skeleton, SkeletonError};

/// Makes a skeleton of the points of one tree.
///
/// 1. Ground is set aside if it is there; the trunk is found where the cloud is lowest, or begins where it is said to.
/// 2. Points in one cube of a [side](Self::with_side) become one node. Nodes are linked to their neighbours within a reach that
///    follows their density; parts that do not hang together are joined by edges over gaps, at a price.
/// 3. The search of [`guided`](crate::guided) finds least-cost paths from the base to all nodes. Guiding vectors follow the way so
///    far and the principal direction of the nodes around, so that paths stay in their limb and cross gaps straight on.
/// 4. Nodes at one distance along their paths that hang together are a ring; its middle is a node of the skeleton, after Verroust and
///    Lazarus 2000, "Extracting skeletal curves from 3D scattered data". Rings that go nowhere are left out.
///    Where two paths meet within a limb, one of them has come in from another limb that touches it; the limb is hung at its thicker
///    end.
/// 5. Cylinders are fitted robustly to the points of neighbouring rings; they put axes into the middle of
///    limbs and give radii. Where points are few, radii follow from the length of wood borne, by a relation
///    fitted to this tree's measured limbs. No radius grows towards the tips.
///
/// One cloud, one tree; [`reconstruct_stand`](Self::reconstruct_stand) makes one of each trunk. Told the
/// [base](Self::with_base) of one of two trees that touch, `reconstruct` makes one tree of both.
///
/// Of trees in leaf points on leaves are taken for twigs, unless they are [set aside](Self::with_leaves_set_aside). The same
/// cloud gives the same bits at any number of threads. O(n log n) for n points; about 100 bytes per point and
/// 500 bytes per node.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, reconstruct::Reconstruct, scan::Scanner, surface::{Part, Tubes}};
///
/// let nodes = vec![Vec3::ZERO, Vec3::Y * 2.0, Vec3::new(0.8, 3.0, 0.0), Vec3::new(-0.6, 3.0, 0.4)];
/// let tree = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1)])?.with_radii(vec![0.1, 0.1, 0.04, 0.04])?;
/// let mesh = Tubes::default().with_root_flare(0.0).mesh(&tree)?;
/// let scan = Scanner::around(Vec3::Y * 1.5, 6.0, 3).with_step(0.002).scan(&[Part::new(&mesh)], 1)?;
/// let again = Reconstruct::default().reconstruct(&scan.cloud)?.skeleton;
/// assert_eq!(again.tips().count(), 2);
/// assert!((treesynth::metrics::diameter_at(&again, 1.3).unwrap_or(0.0) - 0.2).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reconstruct {
    base: Option<Vec3>,
    side: Option<f32>,
    gap: f32,
    tip: f32,
    most_points: usize,
    has_ground: bool,
    sets_leaves_aside: bool,
}

impl Default for Reconstruct {
    /// The base found, ground set aside, leaves not looked for, sides by the tree's height, gaps up to 0.5 m, tips of 1.5 mm radius,
    /// up to 20 million points.
    fn default() -> Self {
        Self {
            base: None,
            side: None,
            gap: 0.5,
            tip: 0.0015,
            most_points: 20_000_000,
            has_ground: true,
            sets_leaves_aside: false,
        }
    }
}

/// A reconstructed tree.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Reconstruction {
    /// The tree, where the cloud's points are. Its root is the base of the trunk: on the ground, if ground was found, or the base
    /// that was given. Branch [orders](Skeleton::orders) follow the limb that goes on straightest at each fork.
    pub skeleton: Skeleton,
    /// The offset that was subtracted from the coordinates in the cloud's file.
    pub offset: DVec3,
    /// For each node, `true` if a cylinder was found for its points. Its radius is that of the cylinder,
    /// unless that differs from those of the limbs around; all other radii follow from the length that their
    /// limb bears.
    pub is_measured: Vec<bool>,
    /// What each point of the cloud was taken for; empty for a tree of a stand, which has this itself.
    pub kinds: Vec<PointKind>,
    /// Points set aside as ground.
    pub ground: usize,
    /// Points set aside as leaves.
    pub leaves: usize,
    /// Points that nothing of the tree was made of: too far from the rest, or too few together.
    pub left_out: usize,
    /// The side of the cubes, metres, after it was widened to keep memory bounded.
    pub side: f32,
}

/// Error of reconstructing a tree.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReconstructError {
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Too few points, or all in one place.
    #[error(
        "{points} points in {nodes} places, ground set aside, are too few: a tree needs 10 places at least"
    )]
    TooFew {
        /// Points that are not ground.
        points: usize,
        /// Different places.
        nodes: usize,
    },
    /// More points than are allowed.
    #[error(
        "the cloud has {points} points, but may have {most}; Cloud::thinned makes them fewer, Reconstruct::with_most_points allows more"
    )]
    TooMany {
        /// The points.
        points: usize,
        /// The greatest number allowed.
        most: usize,
    },
    /// No trunk, or several, where the cloud is lowest.
    #[error(
        "where the cloud is lowest, up to {high} m, {trunks} things stand apart, the largest at {first} and {second}, but there must be one trunk; cut the cloud, choose the trunk by Reconstruct::with_base, or make all trees by Reconstruct::reconstruct_stand"
    )]
    Trunks {
        /// The upper end of what was looked at, metres.
        high: f32,
        /// The number of things that stand there.
        trunks: usize,
        /// The position of the one of most points, metres.
        first: Vec3,
        /// The position of the next, metres.
        second: Vec3,
    },
    /// Nothing that stands where the cloud is lowest goes on above as a trunk does.
    #[error(
        "nothing that stands where the cloud is lowest goes on above it as a trunk does; cut or turn the cloud, or say where trunks begin by Reconstruct::reconstruct_stand_at"
    )]
    NoTrunk,
    /// Too little of a stand's cloud was given to the tree of one base: another tree, or another base in the same trunk, has it.
    #[error(
        "the tree at {base}: {error}; leave its base out, or name others by Reconstruct::reconstruct_stand_at"
    )]
    OfBase {
        /// The base, metres.
        base: Vec3,
        /// The problem.
        error: Box<ReconstructError>,
    },
    /// So far from 0 that the coordinates are too coarse for the cubes.
    #[error(
        "so far from 0 coordinates are in steps of {step} m, wider than the cubes' side of {side} m; Cloud::from_places and the readers of files take an offset off first, Reconstruct::with_side makes cubes wider"
    )]
    TooFar {
        /// The distance from one number to the next, metres.
        step: f32,
        /// The side of the cubes, metres.
        side: f32,
    },
    /// The limb at the base is thin compared with others: the cloud stands on its head, or the trunk is not
    /// in it.
    #[error(
        "the limb at the base, {base}, has a radius of {radius} m, but others have {thickest} m; turn or cut the cloud, or set the trunk base by Reconstruct::with_base"
    )]
    ThinBase {
        /// The position at which the base was found, metres.
        base: Vec3,
        /// Its radius, metres.
        radius: f32,
        /// The radius that ten rings have at least, metres.
        thickest: f32,
    },
    /// The search failed.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// The graph is not valid.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The result is not a valid skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
}

/// Where a tree begins.
#[derive(Debug, Clone, Copy)]
struct Start {
    /// The middle of the lowest points of its trunk.
    base: Vec3,
    /// The place on the ground below, which is the root of the skeleton.
    foot: Vec3,
    /// `true` if the base was looked for, not given.
    is_found: bool,
}

impl Start {
    fn found(base: Vec3, ground: &Ground) -> Self {
        // Points near the ground are set aside with it.
        let far = ground.below(base).filter(|far| (0.0..1.0).contains(far)).unwrap_or(0.0);
        Self { base, foot: base - Vec3::Y * far, is_found: true }
    }
}

/// Nodes at most; the side of cubes grows until they are so few.
const MOST_NODES: usize = 600_000;

impl Reconstruct {
    /// The trunk begins at this place, metres; by default where the cloud is lowest.
    pub fn with_base(mut self, base: Vec3) -> Self {
        self.base = Some(base);
        self
    }

    /// The side of the cubes whose points are one node, metres, 1e-4 to 1; by default a thousandth of the cloud's height, 2 mm to 5
    /// cm, or more where points are farther apart. Twigs nearer to each other than about three sides are one.
    pub fn with_side(mut self, metres: f32) -> Self {
        self.side = Some(metres);
        self
    }

    /// The widest gap that a limb may have, metres, 0 to 100; default 0.5. Parts farther off are left out.
    pub fn with_gap(mut self, metres: f32) -> Self {
        self.gap = metres;
        self
    }

    /// The radius of the thinnest twigs, metres, 0 to 1; default 0.0015.
    pub fn with_tip_radius(mut self, metres: f32) -> Self {
        self.tip = metres;
        self
    }

    /// Points that a cloud may have; default 20 million.
    pub fn with_most_points(mut self, points: usize) -> Self {
        self.most_points = points;
        self
    }

    /// Searches for points of the ground and leaves them out; default true.
    pub fn with_ground(mut self, is_looked_for: bool) -> Self {
        self.has_ground = is_looked_for;
        self
    }

    /// Tells points on wood from those on leaves, by their shape and by the paths that run through them, and makes the tree of wood alone;
    /// default false. Needs no colours or intensities. Points on twigs of a few millimetres go with the leaves, also where there are
    /// none: leave it off for leafless trees. Takes two to three times as long.
    ///
    /// After Wang et al. 2020, "`LeWoS`: a universal leaf-wood classification method", and Vicari et al. 2019, "Leaf and wood
    /// classification framework for terrestrial `LiDAR` point clouds": shape, evidence smoothed over neighbours, and paths. Evidence is
    /// then summed along paths: wood is the part of the tree of paths, connected with the base, for which most speaks.
    pub fn with_leaves_set_aside(mut self, is_wanted: bool) -> Self {
        self.sets_leaves_aside = is_wanted;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let base = self.base.unwrap_or_default();
        ParameterError::unless(base.is_finite(), "Reconstruct.base", base, "finite, metres")?;
        let side = self.side.unwrap_or(0.01);
        ParameterError::unless((1e-4..=1.0).contains(&side), "Reconstruct.side", side, "1e-4 to 1 m")?;
        ParameterError::unless((0.0..=100.0).contains(&self.gap), "Reconstruct.gap", self.gap, "0 to 100 m")?;
        ParameterError::unless(
            (0.0..=1.0).contains(&self.tip),
            "Reconstruct.tip_radius",
            self.tip,
            "0 to 1 m",
        )
    }

    /// The tree of a cloud.
    ///
    /// # Errors
    /// Options out of range; too few points or too many; no trunk, or several, where the cloud is lowest:
    /// [`reconstruct_stand`](Self::reconstruct_stand) is for those.
    pub fn reconstruct(&self, cloud: &Cloud) -> Result<Reconstruction, ReconstructError> {
        let wood = self.wood(cloud)?;
        let nodes = self.nodes(cloud.points(), &wood.above, MOST_NODES)?;
        let edges = net::edges(&nodes);
        let start = match self.base {
            Some(base) => {
                let base = self.checked_base(&nodes, base, "Reconstruct.base")?;
                Start { base, foot: base, is_found: false }
            }
            None => Start::found(base::lowest_trunk(&nodes, &edges)?, &wood),
        };
        let mut kinds = vec![PointKind::Ground; cloud.len()];
        wood.above.iter().for_each(|&point| kinds[point as usize] = PointKind::Stray);
        let ground = cloud.len() - wood.above.len();
        let made = if self.sets_leaves_aside {
            let own = self.without_leaves(cloud.points(), &wood.above, start, &mut kinds)?;
            let nodes = self.nodes(cloud.points(), &own, MOST_NODES)?;
            self.tree(cloud, &wood, &nodes, &net::edges(&nodes), start, &mut kinds)?
        } else {
            self.tree(cloud, &wood, &nodes, &edges, start, &mut kinds)?
        };
        let leaves = kinds.iter().filter(|&&kind| kind == PointKind::Leaf).count();
        Ok(Reconstruction { kinds, ground, leaves, ..made })
    }

    /// The points that are not ground.
    fn wood(&self, cloud: &Cloud) -> Result<Ground, ReconstructError> {
        self.check()?;
        if cloud.len() > self.most_points {
            return Err(ReconstructError::TooMany { points: cloud.len(), most: self.most_points });
        }
        Ok(if self.has_ground { Ground::found(cloud.points()) } else { Ground::none(cloud.points()) })
    }

    /// The nodes of some points, with their neighbours.
    fn nodes(&self, points: &[Vec3], which: &[u32], most: usize) -> Result<Nodes, ReconstructError> {
        let height = height(points, which);
        let side = self.side.unwrap_or((height / 1000.0).clamp(0.002, 0.05));
        let step = coarsest_step(points, which);
        if step > side {
            return Err(ReconstructError::TooFar { step, side });
        }
        let mut nodes = Nodes::new(points, which, side, most);
        if nodes.len() < 10 {
            return Err(ReconstructError::TooFew { points: which.len(), nodes: nodes.len() });
        }
        nodes.survey();
        // Cubes smaller than the way from point to point hold no surface together.
        let wide = nodes.spacing() / 1.2;
        if self.side.is_none() && wide > 1.25 * nodes.side {
            nodes = Nodes::new(points, which, wide.min(0.02 * height), most);
            nodes.survey();
        }
        Ok(nodes)
    }

    /// The tree that begins at a place; the kind of the points that it is made of becomes `Wood`.
    fn tree(
        &self,
        cloud: &Cloud,
        ground: &Ground,
        nodes: &Nodes,
        edges: &[(u32, u32)],
        start: Start,
        kinds: &mut [PointKind],
    ) -> Result<Reconstruction, ReconstructError> {
        let bridges = net::bridges(nodes, edges, self.gap, &[]);
        let graph = net::graph(nodes, edges, &bridges, &[start.base])?;
        let mut search = Search::new(&graph);
        search.explore(&net::along(nodes), &net::dear(nodes), 0, &Silent)?;
        let step = 3.0 * nodes.side;
        let rings = limbs::rings(nodes, &search, edges, &[start.foot], step);
        drop(search);
        let rings = contacts::mended(rings, edges, nodes.len());
        let rings = prune::pruned(prune::without_undergrowth(rings, ground), step);
        let heir = heirs(&rings);
        let fits = radii::fits(cloud.points(), nodes, &rings, &heir, step);
        if start.is_found {
            check_base(&rings, &heir, &fits)?;
        }
        let mut positions = Vec::with_capacity(rings.len());
        for (ring, fit) in rings.iter().zip(&fits) {
            let center = fit.map_or(ring.center, |fit| {
                // The place on the axis that is nearest to the middle of the ring.
                fit.center + fit.axis * (ring.center - fit.center).dot(fit.axis)
            });
            positions.push(center);
        }
        let positions = smooth(&positions, &rings, &heir, &fits);
        let parents: Vec<Option<u32>> = rings.iter().map(|ring| ring.parent).collect();
        let skeleton = Skeleton::new(positions, parents)?;
        let measured: Vec<Option<(f32, f32)>> = fits
            .iter()
            .map(|fit| {
                fit.map(|fit| {
                    (fit.radius, fit.around * fit.kept * (fit.radius / (fit.spread + 0.001)).min(10.0))
                })
            })
            .collect();
        // Where axes go on depends on thickness, and thickness is carried along axes.
        let radii = radii::radii(&skeleton, &measured, self.tip);
        let skeleton = skeleton.with_radii(radii)?;
        let orders = orders::orders(&skeleton);
        let skeleton = skeleton.with_orders(orders)?;
        let radii = radii::radii(&skeleton, &measured, self.tip);
        let mut used = 0;
        for &point in rings.iter().flat_map(|ring| &ring.nodes).flat_map(|&node| nodes.of(node as usize)) {
            kinds[point as usize] = PointKind::Wood;
            used += 1;
        }
        Ok(Reconstruction {
            skeleton: skeleton.with_radii(radii)?,
            offset: cloud.offset(),
            is_measured: measured.iter().map(Option::is_some).collect(),
            kinds: Vec::new(),
            ground: 0,
            leaves: 0,
            left_out: nodes.points.len() - used,
            side: nodes.side,
        })
    }

    fn checked_base(&self, nodes: &Nodes, base: Vec3, name: &str) -> Result<Vec3, ReconstructError> {
        let far = nodes.positions.iter().map(|place| place.distance(base)).fold(f32::INFINITY, f32::min);
        let range =
            "within a metre of the points, or within the gap if that is wider, as they lie in the cloud";
        if far <= self.gap.max(1.0) { Ok(base) } else { Err(ParameterError::new(name, base, range).into()) }
    }
}

/// Checks that the limb at a base that was found is about as thick as any other limb.
fn check_base(
    rings: &[Ring],
    heir: &[Option<u32>],
    fits: &[Option<Cylinder>],
) -> Result<(), ReconstructError> {
    let mut radii: Vec<f32> = fits.iter().flatten().map(|fit| fit.radius).collect();
    radii.sort_unstable_by(|a, b| b.total_cmp(a));
    let mut at_base = None;
    let mut ring = 0_usize;
    for _ in 0..20 {
        at_base = at_base.max(fits[ring].map(|fit| fit.radius.to_bits()));
        let Some(next) = heir[ring] else { break };
        ring = next as usize;
    }
    // Bits of positive numbers are in their order.
    let (Some(radius), Some(&thickest)) = (at_base.map(f32::from_bits), radii.get(9)) else {
        return Ok(());
    };
    if thickest <= 3.0 * radius {
        return Ok(());
    }
    Err(ReconstructError::ThinBase { base: rings[0].center, radius, thickest })
}

/// Height from the lowest to the highest of some points, leaving out a thousandth at either end.
fn height(points: &[Vec3], which: &[u32]) -> f32 {
    let mut heights: Vec<f32> = which.iter().map(|&point| points[point as usize].y).collect();
    if heights.is_empty() {
        return 0.0;
    }
    let cut = heights.len() / 1000;
    let last = heights.len() - 1 - cut;
    let high = *heights.select_nth_unstable_by(last, f32::total_cmp).1;
    high - *heights.select_nth_unstable_by(cut, f32::total_cmp).1
}

/// Distance from the largest coordinate of some points to the next number.
fn coarsest_step(points: &[Vec3], which: &[u32]) -> f32 {
    let largest = which.iter().map(|&point| points[point as usize].abs().max_element()).fold(0.0, f32::max);
    f32::from_bits(largest.to_bits() + 1) - largest
}

/// The child of each ring that goes on: the one with most nodes in and behind it.
fn heirs(rings: &[Ring]) -> Vec<Option<u32>> {
    let mut heavy: Vec<usize> = rings.iter().map(|ring| ring.nodes.len()).collect();
    let mut heir: Vec<Option<u32>> = vec![None; rings.len()];
    for ring in (1..rings.len()).rev() {
        let parent = rings[ring].parent.unwrap_or(0) as usize;
        heavy[parent] += heavy[ring];
        if heir[parent].is_none_or(|other| heavy[ring] >= heavy[other as usize]) {
            heir[parent] = Some(ring as u32);
        }
    }
    heir
}

/// Each ring without a cylinder halfway to the middle of its neighbours along its limb.
fn smooth(positions: &[Vec3], rings: &[Ring], heir: &[Option<u32>], fits: &[Option<Cylinder>]) -> Vec<Vec3> {
    let at = |ring: u32| positions[ring as usize];
    (0..positions.len())
        .map(|ring| {
            let own = positions[ring];
            let (Some(parent), Some(next)) = (rings[ring].parent, heir[ring]) else { return own };
            if heir[parent as usize] != Some(ring as u32) {
                return own;
            }
            let share = if fits[ring].is_some() { 0.25 } else { 0.5 };
            own + ((at(parent) + at(next)) * 0.5 - own) * share
        })
        .collect()
}
