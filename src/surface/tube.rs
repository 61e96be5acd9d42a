//! Generalized cylinders along the branches.

use super::axis::Axes;
use super::plan::Plan;
use super::{Mesh, SurfaceError, Sway, far};
use crate::math;
use crate::observer::{Observer, Silent, Watch, Work};
use crate::skeleton::Branches;
use crate::{ParameterError, Skeleton};
use std::f32::consts::PI;

/// Nodes planned from one report to the next, of each twice; or rings of up to 16 vertices made.
pub(super) const PLANNING: usize = 1024;
/// Vertices of one mesh at the most: with its triangles 11 GB. A million branches need less.
const MOST_VERTICES: usize = 150_000_000;
/// The most that an axis turns from ring to ring where branches have collars, radians: rings that are more oblique to each
/// other leave too little wood between them for a collar to begin in. Of 29,000 tubes of random skeletons 55 float at 2, 23 at
/// 1.5 and one at 1.2; of 230,000 the same 6 at 0.8 as at 20°.
const MOST_TURN: f32 = 0.8;
/// Greatest factor by which branches are wider to make up for those left out.
const MOST_WIDENING: f32 = 1.3;

/// A smooth tube along every branch, with a collar where it leaves its parent branch, and a round tip.
///
/// Guaranteed: triangles face outward and have an area; normals are of unit length, tangents too and
/// perpendicular to them; the same skeleton gives the same bits; axes go through the nodes, and the radius at
/// a node is the skeleton's, but for the [root flare](Self::with_root_flare) and within an
/// [error](Self::with_error) that was asked for; every tube but the trunk touches the wood that bears it. Not
/// guaranteed: the collar lies on the parent branch and is not cut out of it, so that triangles within cross,
/// and the mesh is not watertight; where a branch bends more tightly than it is thick, its own rings may
/// cross.
///
/// **Axes** are cubic Hermite curves with Catmull-Rom tangents. They follow every kink of a path through a
/// graph; relax these first, as by [`Skeleton::relaxed`]`(0.5, 3)`. Frames are carried along without twist.
/// Internodes shorter than floats can tell (4·2⁻²³ of the coordinates, or 1 nm) are passed over, and a radius
/// smaller than that makes a single vertex in place of a ring. At turns of more than 120° the tube ends and
/// another begins. The trunk's first ring is level, so that a leaning trunk does not gape at the ground.
///
/// **Collars**: a branch flares into its parent branch in a round fillet that shares that branch's normals. Each tube
/// begins on the triangles of its parent branch or within it, whatever way that bends, tapers or flares; where its base
/// lies within what bears the parent branch, it comes out of that instead. A branch that runs on beside its parent
/// branch for more than eight times their radii, or bends as it leaves, has no collar, and begins within that branch,
/// thinner by 40%.
///
/// **Texture coordinates** count squares of bark of one [size](Self::with_tile): v is metres from the root
/// along the axes, over that size, and runs on from a branch to what it bears; u is metres around the
/// branch's first ring, over that size and rounded to a whole number, for a texture must end where it began.
/// Texels are therefore equally long everywhere, and but for the rounding equally wide, down to branches one
/// square around; thinner ones squeeze one square. [`with_square_tiles`](Self::with_square_tiles) shortens
/// squares where they are narrow. Caps of bases continue in metres. [Tangents](Mesh::tangents) are exact, not
/// averaged over triangles.
///
/// **Far from the origin** a tree has the tubes that it has at the origin, with vertices rounded to what 32-bit floats have there:
/// 1 mm at 10 km. Where that turns over or flattens more than 2% of the surface there is an error.
///
/// O(nodes · sides) time and memory: 48 bytes per vertex, 24 bytes per quad.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::Tubes};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.1, 0.1])?;
/// let mesh = Tubes::default().with_sides(6).with_root_flare(0.0).mesh(&pole)?;
/// assert_eq!(mesh.triangles().len(), 6 * 2 + 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
#[doc(alias("branch", "trunk", "cylinder"))]
pub struct Tubes {
    sides: u32,
    least_sides: u32,
    turn: f32,
    pub(super) error: Option<f32>,
    /// Factor on the error that limits the size of branches that are left out.
    unseen: f32,
    pub(super) root_flare: f32,
    pub(super) collars: bool,
    pub(super) closed_base: bool,
    pub(super) tile: f32,
    pub(super) square_tiles: bool,
    pub(super) even_texels: bool,
    pub(super) wind: bool,
}

crate::recipe::readable!(Tubes {
    sides: u32, least_sides: u32, turn: f32, error: Option<f32>, root_flare: f32, collars: bool,
    closed_base: bool, tile: f32, square_tiles: bool, wind: bool,
});

impl Default for Tubes {
    /// 12 sides on the thickest branch, 4 on the thinnest, a ring every 20°, no error asked for; collars, a root flare
    /// of 0.5, open at the base; squares of bark of 0.25 m, of that length everywhere; no wind.
    fn default() -> Self {
        Self {
            sides: 12,
            least_sides: 4,
            turn: 20f32.to_radians(),
            error: None,
            unseen: 1.0,
            root_flare: 0.5,
            collars: true,
            closed_base: false,
            tile: 0.25,
            square_tiles: false,
            even_texels: false,
            wind: false,
        }
    }
}

impl Tubes {
    /// Sides of the thickest branch, 3 to 1024; default 12.
    ///
    /// A branch whose thickest internode has the radius r gets `sides·√(r / r_max)` of them, rounded up, so that
    /// the edges of limbs and twigs look about equally fine.
    pub fn with_sides(mut self, sides: u32) -> Self {
        self.sides = sides;
        self
    }

    /// Sides of the thinnest branches, 3 to 1024; default 4. Larger than [`sides`](Self::with_sides) means the
    /// same as equal.
    pub fn with_least_sides(mut self, sides: u32) -> Self {
        self.least_sides = sides;
        self
    }

    /// The angle by which an axis may turn from one ring to the next, on the average of an internode; radians, 0.05 (3°)
    /// up; default 20°. Every node has a ring anyway, so that from 2π up there are no more; with
    /// [collars](Self::with_collars) any angle above 0.8 (46°) is the same as 0.8, or branches would come off where
    /// their parent branch bends.
    pub fn with_turn(mut self, angle: f32) -> Self {
        self.turn = angle;
        self
    }

    /// Makes rings and sides as few as keep the chords along an axis within `error` metres of the axis, and
    /// the edges around it within `error` of the circle, instead of asking for sides and a turn. Parts too
    /// small to be seen at that error are left out: collars thinner than it, and branches that show, with all
    /// they bear, an area of less than 4 `error`². Other branches thinner than it are wider instead, up to
    /// it, so that the crown stays as dense. At least 1e-6 m; default none.
    ///
    /// Polygons are as wide as their tubes on the average of all directions. For several errors of one tree, see
    /// [`Levels`](super::Levels).
    pub fn with_error(mut self, error: f32) -> Self {
        self.error = Some(error);
        self
    }

    /// Leaves out branches that show, with all they bear, an area of less than 4 (`factor` `error`)².
    pub(super) fn with_unseen(mut self, factor: f32) -> Self {
        self.unseen = factor;
        self
    }

    /// Widening of the trunk at its base, as a share of its radius there, 0 to 3; default 0.5. It narrows
    /// to nothing within four radii.
    pub fn with_root_flare(mut self, flare: f32) -> Self {
        self.root_flare = flare;
        self
    }

    /// Makes branches blend into their parent branch by a collar; default true. Without, they are stuck into
    /// it, which saves a ring or more per branch.
    pub fn with_collars(mut self, collars: bool) -> Self {
        self.collars = collars;
        self
    }

    /// Closes the base of each tube with a flat cap, so that each is a closed body; default false, since the
    /// trunk base is in the ground and the other bases are inside the parent branch.
    pub fn with_closed_base(mut self, closed: bool) -> Self {
        self.closed_base = closed;
        self
    }

    /// The side of the square of bark that a texture shows, metres, 1e-4 to 1e4; default 0.25, two palms.
    pub fn with_tile(mut self, side: f32) -> Self {
        self.tile = side;
        self
    }

    /// Keeps squares of bark square as branches grow thin; default false.
    ///
    /// The number of squares around a branch is whole and the same all along it, so that nothing jumps; where
    /// a branch is half as thick as at its base, a square is half as wide. By default it is as long there as
    /// at the base, and ridges are drawn out; with this it is half as long too, as bark is finer where it is
    /// younger. Branches thinner than one square around wear one that is smaller, instead of one squeezed. v
    /// is continuous along each branch, and begins with metres from the root over the size. Bark does not
    /// continue from a branch to its parent branch: collars end in the bark of their parent branch with a
    /// seam.
    pub fn with_square_tiles(mut self, square: bool) -> Self {
        self.square_tiles = square;
        self
    }

    /// Gives branches that taper fewer and fewer squares around, so that texels stay about as large; default
    /// false.
    ///
    /// The default number of squares around a branch is the same all along it, and texels shrink in
    /// proportion to its radius: by a factor of ten and more along a trunk. With even texels a new
    /// section begins at the first fork where the branch is thinner by a factor of 1.6 than at the
    /// start of the last one; its number of squares is that of its mean radius. There bark does not
    /// continue: v does, u does not, which a ring of doubled vertices makes possible. That seam
    /// lies at a fork, but it may be seen on smooth trunks with strongly drawn bark.
    pub fn with_even_texels(mut self, even: bool) -> Self {
        self.even_texels = even;
        self
    }

    /// Gives vertices [`Wind`](super::Wind), so that they move with the skeleton's [`Sway`]; default false.
    /// Junctions stay closed at every gust, in every [level](super::Levels).
    pub fn with_wind(mut self, wind: bool) -> Self {
        self.wind = wind;
        self
    }

    /// `true` if the number of squares changes along branches.
    #[cfg_attr(not(feature = "texture"), allow(dead_code, reason = "only assets ask"))]
    pub(crate) fn has_even_texels(&self) -> bool {
        self.even_texels
    }

    /// `true` if vertices have wind.
    #[cfg_attr(not(feature = "texture"), allow(dead_code, reason = "only assets ask"))]
    pub(crate) fn has_wind(&self) -> bool {
        self.wind
    }

    /// The tubes of all branches as one mesh. A skeleton that is only a root, or whose internodes all have no
    /// length, gives an empty mesh.
    ///
    /// # Errors
    /// An option out of range; radii that are all zero though there are internodes; more than 150 million
    /// vertices; a node more than a million kilometres out or thick; a tree so far out that floats cannot tell its
    /// vertices apart, [`SurfaceError::Shapeless`].
    pub fn mesh(&self, skeleton: &Skeleton) -> Result<Mesh, SurfaceError> {
        self.mesh_observed(skeleton, &Silent)
    }

    /// As [`mesh`](Self::mesh), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh), and [`SurfaceError::Cancelled`].
    pub fn mesh_observed(&self, skeleton: &Skeleton, observer: &dyn Observer) -> Result<Mesh, SurfaceError> {
        let watch = Watch::new(observer, Work::Surface, 4 * skeleton.len(), PLANNING);
        let mesh = self.mesh_watched(skeleton, &watch)?;
        watch.finish()?;
        Ok(mesh)
    }

    /// As [`mesh`](Self::mesh), with about four steps per node.
    pub(crate) fn mesh_watched(&self, skeleton: &Skeleton, watch: &Watch<'_>) -> Result<Mesh, SurfaceError> {
        let offset = far::offset_of(skeleton);
        let plan = self.plan_watched(&far::near(skeleton, offset), watch)?;
        far::back_open(plan.weave_watched(self, watch)?, offset)
    }

    #[cfg(test)]
    pub(super) fn plan(&self, skeleton: &Skeleton) -> Result<Plan, SurfaceError> {
        self.plan_watched(skeleton, &Watch::silent())
    }

    /// As `plan`, with two steps per node.
    pub(super) fn plan_watched(&self, skeleton: &Skeleton, watch: &Watch<'_>) -> Result<Plan, SurfaceError> {
        self.check()?;
        let axes = if skeleton.segments() == 0 { Axes::default() } else { Axes::of(skeleton, self, watch)? };
        let sway = if self.wind && skeleton.segments() > 0 { Some(Sway::of(skeleton)?) } else { None };
        let plan = Plan::new(axes, sway, self, watch)?;
        let vertices = plan.vertices;
        let most = MOST_VERTICES;
        if vertices > most { Err(SurfaceError::TooLarge { vertices, most }) } else { Ok(plan) }
    }

    fn check(&self) -> Result<(), ParameterError> {
        let range = "3 to 1024";
        let holds = |sides: u32| (3..=1024).contains(&sides);
        ParameterError::unless(holds(self.sides), "Tubes.sides", self.sides, range)?;
        ParameterError::unless(holds(self.least_sides), "Tubes.least_sides", self.least_sides, range)?;
        ParameterError::unless(self.turn >= 0.05, "Tubes.turn", self.turn, "at least 0.05 rad")?;
        let error = self.error.unwrap_or(1.0);
        let holds = error >= 1e-6 && error.is_finite();
        ParameterError::unless(holds, "Tubes.error", error, "at least 1e-6 m and finite")?;
        let holds = (0.0..=3.0).contains(&self.root_flare);
        ParameterError::unless(holds, "Tubes.root_flare", self.root_flare, "0 to 3")?;
        ParameterError::unless((1e-4..=1e4).contains(&self.tile), "Tubes.tile", self.tile, "1e-4 to 1e4 m")
    }

    /// Number of sides of a branch of this radius.
    pub(super) fn sides_of(&self, radius: f32, thickest: f32) -> u32 {
        if let Some(error) = self.error {
            // The polygon's sides are `radius·(1 - cos(π / sides))` off.
            return ((PI / math::acos(1.0 - error / radius)).ceil() as u32).clamp(3, 1024);
        }
        let sides = (self.sides as f32 * (radius / thickest).sqrt()).ceil() as u32;
        sides.max(self.least_sides).min(self.sides)
    }

    /// Ratio of a polygon's width to its tube's: without an error its corners lie on the tube; with one, so few
    /// sides may do that both are to be of one circumference, and so of one width on the average (Cauchy).
    pub(super) fn swelling(&self, sides: u32) -> f32 {
        let half = PI / sides as f32;
        if self.error.is_some() { half / math::sin(half) } else { 1.0 }
    }

    /// Parts of an internode of this turn in radians and length in metres.
    pub(super) fn parts(&self, turn: f32, length: f32) -> f32 {
        match self.error {
            // The sagitta of an arc; the other half of the error is for simplifying.
            Some(error) => (turn * length / (4.0 * error)).sqrt().ceil(),
            None if self.collars => (turn / self.turn.min(MOST_TURN)).ceil(),
            None => (turn / self.turn).ceil(),
        }
        .max(1.0)
    }

    /// `true` if a branch of this radius has a collar.
    pub(super) fn blends(&self, radius: f32) -> bool {
        self.collars && radius > self.error.unwrap_or(0.0)
    }

    /// The branches too small to be seen, and what makes up for them.
    pub(super) fn dropped(&self, skeleton: &Skeleton, branches: &Branches) -> Dropped {
        let Some(error) = self.error else {
            return Dropped { branches: Vec::new(), widening: 1.0, widest: 0.0 };
        };
        let area = |node: usize, parent: usize| {
            2.0 * skeleton.radii()[node] * skeleton.positions()[node].distance(skeleton.positions()[parent])
        };
        // Area of each node's internode and all that it bears.
        let mut areas = vec![0.0f32; skeleton.len()];
        for (node, parent) in skeleton.edges().rev() {
            areas[node] += area(node, parent);
            areas[parent] += areas[node];
        }
        let least = 4.0 * (self.unseen * error) * (self.unseen * error);
        let seen = |nodes: &[u32]| nodes.len() < 2 || areas[nodes[1] as usize] >= least;
        let unseen = branches.iter().enumerate().map(|(i, branch)| i > 0 && !seen(branch.nodes()));
        let unseen: Vec<bool> = unseen.collect();
        let (mut lost, mut thin) = (0.0, 0.0);
        for (branch, unseen) in branches.iter().zip(&unseen) {
            for pair in branch.nodes().windows(2) {
                let [parent, node] = [pair[0] as usize, pair[1] as usize];
                let sum = if *unseen { &mut lost } else { &mut thin };
                *sum += if *unseen || skeleton.radii()[node] < error { area(node, parent) } else { 0.0 };
            }
        }
        let widening = if thin > 0.0 { (1.0 + lost / thin).min(MOST_WIDENING) } else { 1.0 };
        Dropped { branches: unseen, widening, widest: error }
    }
}

/// Branches that are not seen at some error.
pub(super) struct Dropped {
    /// For each branch, `true` if it is dropped; empty if all are seen.
    branches: Vec<bool>,
    widening: f32,
    widest: f32,
}

impl Dropped {
    pub(super) fn contains(&self, branch: usize) -> bool {
        self.branches.get(branch) == Some(&true)
    }

    /// The radius of what is kept: thin branches are as much wider as others are missing, so that the crown stays as
    /// dense (Cook et al. 2007), but by no more than can be seen, and never so much that limbs swell.
    pub(super) fn widened(&self, radius: f32) -> f32 {
        radius.max((radius * self.widening).min(self.widest))
    }
}

#[cfg(test)]
mod tests;
