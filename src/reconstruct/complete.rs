//! Twigs too thin for the scanner, grown onto measured limbs.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;

use super::{Reconstruction, net};
use crate::guided::{
    AroundTree, Bend, EndpointError, EndpointPolicy, LimbSurface, Refinement, Stage, StageView,
    SynthesisError, TreeSynth,
};
use crate::shape::{Bounds, Cuboid};
use crate::{ParameterError, Skeleton};

/// Twigs that [`Reconstruction::completed`] grows.
///
/// By default one stage of twigs of about 25 cm, one for every 15 cm of limb, on limbs of branch order 1 and more that are at most
/// 4 cm thick.
#[must_use]
#[derive(Debug, Clone)]
pub struct Twigs {
    spacing: f32,
    reach: u32,
    thickest: f32,
    tip: f32,
    stages: Vec<Stage>,
}

impl Default for Twigs {
    fn default() -> Self {
        let twigs = LimbSurface::new(3, 0.15).with_least_order(1);
        Self {
            spacing: 0.08,
            reach: 6,
            thickest: 0.02,
            tip: 0.0015,
            stages: vec![Stage::new(Bend::piecewise(0.7, 0.1, 1), twigs)],
        }
    }
}

impl Twigs {
    /// Metres between the nodes of the graph in which twigs grow, 0.001 to 10; default 0.08. Half of it makes eight times as many nodes.
    pub fn with_spacing(mut self, metres: f32) -> Self {
        self.spacing = metres;
        self
    }

    /// Hops of the graph that it reaches from the limbs, 1 to 24; default 6.
    pub fn with_reach(mut self, hops: u32) -> Self {
        self.reach = hops;
        self
    }

    /// The radius of the thickest measured limb that bears twigs, metres, above 0; default 0.02.
    pub fn with_thickest(mut self, radius: f32) -> Self {
        self.thickest = radius;
        self
    }

    /// The radius of twigs at their tips, metres, 0 to 1; default 0.0015.
    pub fn with_tip_radius(mut self, metres: f32) -> Self {
        self.tip = metres;
        self
    }

    /// Other stages, at least one. Endpoints whose paths leave limbs that are too thick are left out of each.
    pub fn with_stages(mut self, stages: impl Into<Vec<Stage>>) -> Self {
        self.stages = stages.into();
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let fits = (1e-3..=10.0).contains(&self.spacing);
        ParameterError::unless(fits, "Twigs.spacing", self.spacing, "0.001 to 10 m")?;
        ParameterError::unless((1..=24).contains(&self.reach), "Twigs.reach", self.reach, "1 to 24 hops")?;
        let fits = self.thickest > 0.0 && self.thickest.is_finite();
        ParameterError::unless(fits, "Twigs.thickest", self.thickest, "finite and above 0 m")?;
        ParameterError::unless((0.0..=1.0).contains(&self.tip), "Twigs.tip_radius", self.tip, "0 to 1 m")
    }
}

/// A measured tree with twigs that are made up.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Completed {
    /// The tree. Its first nodes are those of the [`Reconstruction`], bit for bit; twigs follow, each with the
    /// [stage](Skeleton::stages) it grew in, from 1.
    pub skeleton: Skeleton,
    /// The number of nodes that were measured: the first ones.
    pub measured: usize,
}

impl Completed {
    /// `true` for nodes of the reconstruction, `false` for those of twigs that are made up.
    pub fn is_measured(&self, node: usize) -> bool {
        node < self.measured
    }
}

impl Reconstruction {
    /// Grows twigs that the scanner was too coarse for onto the limbs that it has measured, by the stages of
    /// [`guided`](crate::guided) in a graph [around the tree](AroundTree).
    ///
    /// Measured nodes, their radii and orders stay as they are. Twigs are hung on the measured node that is nearest to where their
    /// path leaves the limb; their radii follow from the tips they bear (the pipe model) and are nowhere thicker than their limb. Same
    /// seed, same bits. Time and memory: as [`AroundTree`].
    ///
    /// ```
    /// use treesynth::{Skeleton, glam::Vec3, reconstruct::{Reconstruct, Twigs}, scan::Scanner, surface::{Part, Tubes}};
    ///
    /// let nodes = vec![Vec3::ZERO, Vec3::Y * 2.0, Vec3::new(0.8, 3.0, 0.0), Vec3::new(-0.6, 3.0, 0.4)];
    /// let tree = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1)])?.with_radii(vec![0.1, 0.1, 0.02, 0.02])?;
    /// let mesh = Tubes::default().with_root_flare(0.0).mesh(&tree)?;
    /// let scan = Scanner::around(Vec3::Y * 1.5, 6.0, 3).with_step(0.002).scan(&[Part::new(&mesh)], 1)?;
    /// let measured = Reconstruct::default().reconstruct(&scan.cloud)?;
    /// let whole = measured.completed(&Twigs::default(), 1)?;
    /// assert_eq!(whole.skeleton.positions()[..whole.measured], *measured.skeleton.positions());
    /// assert_eq!(whole.skeleton.radii()[..whole.measured], *measured.skeleton.radii());
    /// assert!(whole.skeleton.tips().count() > measured.skeleton.tips().count() + 5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Options out of range, and whatever [`TreeSynth::synthesize`] says: stages that find no endpoints, for one, as where all limbs
    /// are too thick.
    pub fn completed(&self, twigs: &Twigs, seed: u64) -> Result<Completed, SynthesisError> {
        twigs.check()?;
        let tree = &self.skeleton;
        let reach = 1.5 * twigs.spacing * twigs.reach as f32;
        let region = Cuboid::from(Bounds::of(tree.positions().iter().copied()).grown(reach));
        let refinement = Refinement::new(region, twigs.spacing).with_reach(twigs.reach);
        let limbs = Arc::new(tree.clone());
        let stages = twigs.stages.iter().map(|stage| {
            let (inner, limbs) = (stage.clone(), limbs.clone());
            stage.clone().with_endpoints(OnThin { inner, limbs, thickest: twigs.thickest })
        });
        let synth = TreeSynth::new(AroundTree::new(tree.clone(), refinement))
            .with_stages(stages.collect::<Vec<Stage>>());
        let grown = synth.synthesize(seed)?;
        joined(tree, &grown, twigs.tip)
    }
}

/// The endpoints of a stage whose paths leave a limb that is thin enough, or another twig.
struct OnThin {
    inner: Stage,
    limbs: Arc<Skeleton>,
    thickest: f32,
}

impl EndpointPolicy for OnThin {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let search = view.search();
        let asked = self.inner.endpoints().select(view)?;
        let with_source = |&node: &u32| Some((node, view.graph().position(search.source(node)?)));
        let (asked, sources): (Vec<u32>, Vec<Vec3>) = asked.iter().filter_map(with_source).unzip();
        let near = net::nearest_of(self.limbs.positions(), &sources);
        let is_thin = |limb: u32| self.limbs.radii()[limb as usize] <= self.thickest;
        let kept: Vec<u32> =
            asked.into_iter().zip(near).filter(|&(_, limb)| is_thin(limb)).map(|(node, _)| node).collect();
        if kept.is_empty() {
            let place = "where a limb is thin enough for twigs";
            return Err(EndpointError::TooFew { wanted: 1, available: 0, place });
        }
        Ok(kept)
    }

    fn needs_search(&self) -> bool {
        true
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.inner.endpoints().check()
    }
}

/// The measured tree with the twigs of another that has grown around it.
fn joined(tree: &Skeleton, grown: &Skeleton, tip: f32) -> Result<Completed, SynthesisError> {
    let measured = tree.len();
    let bits = |place: Vec3| (place + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut at = BTreeMap::new();
    for (node, &place) in (0_u32..).zip(tree.positions()) {
        at.entry(bits(place)).or_insert(node);
    }
    let children = tree.children();
    let last = tree.stages().iter().copied().max().unwrap_or(0);
    let (mut positions, mut stages) = (tree.positions().to_vec(), tree.stages().to_vec());
    let (mut orders, mut radii) = (tree.orders().to_vec(), tree.radii().to_vec());
    let mut parents: Vec<Option<u32>> =
        (0..measured).map(|node| tree.parent(node).map(|parent| parent as u32)).collect();
    // The node of the whole tree that each grown one is, or hangs on.
    let mut place_of = vec![0_u32; grown.len()];
    for node in 0..grown.len() {
        let place = grown.positions()[node];
        let Some(parent) = grown.parent(node) else { continue };
        let before = place_of[parent];
        if grown.stages()[node] <= last {
            // A limb's node, or one put between two of them.
            let near = children.of(before as usize).iter().copied().chain([before]);
            let far = |node: &u32| tree.positions()[*node as usize].distance_squared(place);
            let nearest = near.min_by(|a, b| far(a).total_cmp(&far(b)).then(a.cmp(b)));
            place_of[node] = at.get(&bits(place)).copied().or(nearest).unwrap_or(before);
            continue;
        }
        place_of[node] = positions.len() as u32;
        let step = if grown.stages()[parent] <= last {
            1
        } else {
            grown.orders()[node].saturating_sub(grown.orders()[parent])
        };
        positions.push(place);
        parents.push(Some(before));
        stages.push(grown.stages()[node]);
        orders.push(orders[before as usize].saturating_add(step));
    }
    // Cross-sections of twigs add up, as far as their limb lets them.
    let mut squares = vec![0.0_f32; positions.len()];
    for node in (measured..positions.len()).rev() {
        squares[node] = squares[node].max(tip * tip);
        let parent = parents[node].unwrap_or(0) as usize;
        squares[parent] += squares[node];
    }
    for node in measured..positions.len() {
        let parent = parents[node].unwrap_or(0) as usize;
        radii.push(squares[node].sqrt().min(radii[parent]));
    }
    let skeleton = Skeleton::new(positions, parents)?.with_stages(stages)?.with_radii(radii)?;
    Ok(Completed { skeleton: skeleton.with_orders(orders)?, measured })
}
