//! Several trees in one cloud.

use glam::Vec3;

use super::ground::Ground;
use super::nodes::Nodes;
use super::{
    MOST_NODES, PointKind, Reconstruct, ReconstructError, Reconstruction, Start, base, contacts, limbs, net,
};
use crate::cloud::Cloud;
use crate::guided::Search;
use crate::{ParameterError, Silent};

/// The trees of a cloud.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ReconstructedStand {
    /// The trees, each where its points are. Ground is counted in the stand alone; points that a tree has been given and left out
    /// are counted in the tree.
    pub trees: Vec<Reconstruction>,
    /// For each point of the cloud the number of the tree that it was given to; `None` for ground, and for what is too far from
    /// all trees.
    pub owners: Vec<Option<u32>>,
    /// What each point of the cloud was taken for.
    pub kinds: Vec<PointKind>,
    /// Points set aside as ground.
    pub ground: usize,
    /// Points set aside as leaves.
    pub leaves: usize,
}

/// Bases of one cloud at most.
const MOST_TREES: usize = 1000;
/// Length over which a path forgets its earlier direction, metres, and the price of turning: as where crowns touch paths would turn
/// from one tree into another, both are far more than within a tree.
const MEMORY: f32 = 0.2;
const TURN: f32 = 20.0;

impl Reconstruct {
    /// The bases of the trunks in a cloud, the one of most points first: of what stands on the ground, if there is ground in the
    /// cloud, else of what stands where the cloud is lowest; and goes on above it. Trunks that touch there are one, and what has less
    /// than a tenth of the points of the largest is none.
    ///
    /// # Errors
    /// Options out of range; too few points or too many.
    pub fn trunk_bases(&self, cloud: &Cloud) -> Result<Vec<Vec3>, ReconstructError> {
        let ground = self.wood(cloud)?;
        let nodes = self.nodes(cloud.points(), &ground.above, 2 * MOST_NODES)?;
        Ok(base::trunks(&nodes, &net::edges(&nodes), &ground))
    }

    /// All trees of a cloud, one for each of its [trunks](Self::trunk_bases), in their order. A base that was
    /// [given](Self::with_base) is not looked at.
    ///
    /// All trees grow in one graph and compete for its nodes, by least-cost paths that hardly turn; then each is made of the points
    /// that it was given, as a tree of a cloud of its own. Time and memory: as for one tree of all the points, twice.
    ///
    /// ```
    /// use treesynth::{Skeleton, glam::{Quat, Vec3}, reconstruct::Reconstruct, scan::Scanner, surface::{Part, Tubes}};
    ///
    /// let nodes = vec![Vec3::ZERO, Vec3::Y * 2.0, Vec3::new(0.8, 3.0, 0.0), Vec3::new(-0.8, 3.0, 0.0)];
    /// let tree = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1)])?.with_radii(vec![0.1, 0.1, 0.04, 0.04])?;
    /// let mesh = Tubes::default().with_root_flare(0.0).mesh(&tree)?;
    /// let parts = [Part::new(&mesh), Part::new(&mesh).at(Vec3::X * 1.6, Quat::IDENTITY, 1.0)];
    /// let scan = Scanner::around(Vec3::Y * 1.5, 6.0, 3).with_step(0.002).scan(&parts, 1)?;
    /// let stand = Reconstruct::default().reconstruct_stand(&scan.cloud)?;
    /// assert_eq!(stand.trees.len(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Options out of range; too few points or too many, in the cloud or of a tree; no trunk, more than 1000, or one that is thin compared
    /// with its limbs.
    pub fn reconstruct_stand(&self, cloud: &Cloud) -> Result<ReconstructedStand, ReconstructError> {
        let ground = self.wood(cloud)?;
        let nodes = self.nodes(cloud.points(), &ground.above, 2 * MOST_NODES)?;
        let edges = net::edges(&nodes);
        let bases = base::trunks(&nodes, &edges, &ground);
        if bases.is_empty() {
            return Err(ReconstructError::NoTrunk);
        }
        let starts: Vec<Start> = bases.into_iter().map(|base| Start::found(base, &ground)).collect();
        self.stand(cloud, &ground, nodes, &edges, &starts)
    }

    /// The trees that begin at these bases, metres, 1 to 1000, as [`reconstruct_stand`](Self::reconstruct_stand) makes them.
    ///
    /// # Errors
    /// As there; and a base twice, or one that is farther from the points than a metre or, if that is wider, the gap.
    pub fn reconstruct_stand_at(
        &self,
        cloud: &Cloud,
        bases: &[Vec3],
    ) -> Result<ReconstructedStand, ReconstructError> {
        let holds = (1..=MOST_TREES).contains(&bases.len());
        ParameterError::unless(holds, "number of bases", bases.len(), "1 to 1000")?;
        for (i, base) in bases.iter().enumerate() {
            if let Some(other) = bases[..i].iter().find(|other| other.distance(*base) <= 1e-3) {
                let range = "at places more than a millimetre apart";
                return Err(ParameterError::new(
                    "two of the bases",
                    format_args!("{other} and {base}"),
                    range,
                )
                .into());
            }
        }
        let ground = self.wood(cloud)?;
        let nodes = self.nodes(cloud.points(), &ground.above, 2 * MOST_NODES)?;
        let given = |&base: &Vec3| {
            let base = self.checked_base(&nodes, base, "one of the bases")?;
            Ok(Start { base, foot: base, is_found: false })
        };
        let starts = bases.iter().map(given).collect::<Result<Vec<Start>, ReconstructError>>()?;
        let edges = net::edges(&nodes);
        self.stand(cloud, &ground, nodes, &edges, &starts)
    }

    fn stand(
        &self,
        cloud: &Cloud,
        ground: &Ground,
        nodes: Nodes,
        edges: &[(u32, u32)],
        starts: &[Start],
    ) -> Result<ReconstructedStand, ReconstructError> {
        ParameterError::unless(
            starts.len() <= MOST_TREES,
            "trunks in the cloud",
            starts.len(),
            "at most 1000",
        )?;
        let bases: Vec<Vec3> = starts.iter().map(|start| start.base).collect();
        let owners = self.owners(cloud.len(), &nodes, edges, &bases)?;
        drop(nodes);
        let mut points: Vec<Vec<u32>> = vec![Vec::new(); starts.len()];
        for (point, owner) in (0_u32..).zip(&owners) {
            if let Some(owner) = owner {
                points[*owner as usize].push(point);
            }
        }
        let mut kinds = vec![PointKind::Ground; cloud.len()];
        ground.above.iter().for_each(|&point| kinds[point as usize] = PointKind::Stray);
        let count = |kinds: &[PointKind], own: &[u32]| {
            own.iter().filter(|&&point| kinds[point as usize] == PointKind::Leaf).count()
        };
        let mut trees = Vec::with_capacity(starts.len());
        let mut leaves = 0;
        for (&start, own) in starts.iter().zip(points) {
            let of_base = |error| ReconstructError::OfBase { base: start.base, error: Box::new(error) };
            let wood = if self.sets_leaves_aside {
                self.without_leaves(cloud.points(), &own, start, &mut kinds).map_err(of_base)?
            } else {
                own.clone()
            };
            let nodes = self.nodes(cloud.points(), &wood, MOST_NODES).map_err(of_base)?;
            let edges = net::edges(&nodes);
            let made = self.tree(cloud, ground, &nodes, &edges, start, &mut kinds)?;
            let own = count(&kinds, &own);
            leaves += own;
            trees.push(Reconstruction { leaves: own, ..made });
        }
        Ok(ReconstructedStand { trees, owners, kinds, ground: cloud.len() - ground.above.len(), leaves })
    }

    /// The tree of each point.
    fn owners(
        &self,
        points: usize,
        nodes: &Nodes,
        edges: &[(u32, u32)],
        bases: &[Vec3],
    ) -> Result<Vec<Option<u32>>, ReconstructError> {
        let from = net::nearest_of(&nodes.positions, bases);
        let bridges = net::bridges(nodes, edges, self.gap, &from);
        let graph = net::graph(nodes, edges, &bridges, bases)?;
        let mut search = Search::new(&graph);
        let rule = net::Along { along: &nodes.along, memory: MEMORY };
        let weight = net::Dear { gap: 3.0 * nodes.side, turn: TURN };
        search.explore(&rule, &weight, 0, &Silent)?;
        let rings = limbs::rings(nodes, &search, edges, bases, 3.0 * nodes.side);
        let rings = contacts::mended(rings, edges, nodes.len());
        let mut owners = vec![None; points];
        let mut trees: Vec<u32> = Vec::with_capacity(rings.len());
        for (number, ring) in rings.iter().enumerate() {
            // The bases come first.
            let tree = ring.parent.map_or(number as u32, |parent| trees[parent as usize]);
            trees.push(tree);
            for &point in ring.nodes.iter().flat_map(|&node| nodes.of(node as usize)) {
                owners[point as usize] = Some(tree);
            }
        }
        Ok(owners)
    }
}
