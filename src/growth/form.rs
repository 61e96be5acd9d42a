//! The tree at an age: every branch laid out along its heading, in one pass from the trunk outwards.

use super::equation as eq;
use super::structure::{Axis, Draw, FORK_ANGLE, Shoot};
use super::{Architecture, Growth, GrowthError, Phenology};
use crate::math::{self, UP, parallel_transport};
use crate::observer::{Cancelled, Observer, Watch, Work, report};
use crate::random::{Purpose, unit};
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;

/// Metamers laid out from one report to the next.
const METAMERS: usize = 4096;

/// Share of its random turn that a branch keeps from one shoot to the next.
const KEPT: f32 = 0.7;
/// Random turn of the trunk, as a share of that of branches.
const TRUNK: f32 = 1.0 / 3.0;
/// Share of its lean from its twin that a branch keeps at its tip.
const RIGHTED: f32 = 0.3;
/// Number of groups in which leaves change colour, and the time from one group to the next, in years.
const TONES: u32 = 5;
const TONE_STEP: f32 = 0.015;

/// A tree at one age; see [`Growth::at`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TreeAtAge {
    /// Positions, radii, branch orders; `stages` are the years in which the nodes grew, from 1, `hops` their distances
    /// from the root in nodes. A branch is as old as the tree less the stage of its first node, plus one.
    pub skeleton: Skeleton,
    /// The number of each node, 0 for the root: the same at every age, and smaller for nodes of earlier years.
    pub ids: Vec<u32>,
    /// The leaves that hang, branch by branch.
    pub leaves: Vec<Leaf>,
    /// The buds of the latest shoots: one in each leaf's axil, and one at each tip.
    pub buds: Vec<Bud>,
    /// For each node of the skeleton, `true` if it is dead wood: its branch has died, is bare, and will break
    /// off.
    pub dead: Vec<bool>,
}

impl TreeAtAge {
    /// The place in the skeleton of the node with this number; `None` if it does not stand. O(n).
    pub fn node(&self, id: u32) -> Option<usize> {
        self.ids.iter().position(|&other| other == id)
    }
}

/// A leaf of a [`TreeAtAge`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Leaf {
    /// The node of the skeleton that bears it.
    pub node: u32,
    /// Its base, on the bark, metres.
    pub position: Vec3,
    /// Direction of its midrib; of length 1.
    pub midrib: Vec3,
    /// Direction of its upper side, at right angles to the midrib; of length 1.
    pub normal: Vec3,
    /// Its length, metres.
    pub length: f32,
    /// The colour of the season: linear red, green and blue, 0 to 1. Few different ones occur at one age.
    pub color: [f32; 3],
}

/// A bud of a [`TreeAtAge`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Bud {
    /// The node of the skeleton that bears it.
    pub node: u32,
    /// Its base, metres.
    pub position: Vec3,
    /// Its direction; of length 1.
    pub direction: Vec3,
    /// Its length, metres.
    pub length: f32,
}

/// Place and direction in which a branch begins.
#[derive(Debug, Clone, Copy)]
struct Base {
    /// The node of the skeleton that bears it.
    node: u32,
    position: Vec3,
    heading: Vec3,
    /// Direction at right angles to the heading, towards the parent branch.
    inwards: Vec3,
}

/// The part of a shoot that has unfolded when the season has come so far: for each of its metamers the sum up to it.
#[derive(Debug, Default)]
struct Unfolded {
    sums: Vec<f32>,
}

impl Unfolded {
    fn new(phenology: &Phenology, progress: f32, metamers: u32) -> Self {
        let mut sum = 0.0;
        let sums = (0..metamers).map(|k| {
            sum += phenology.internode_growth.at(phenology.development(progress, k, metamers));
            sum / metamers as f32
        });
        Self { sums: sums.collect() }
    }
}

pub(super) fn at(growth: &Growth, age: f32, observer: &dyn Observer) -> Result<TreeAtAge, GrowthError> {
    let mut layout = Layout::new(growth, age);
    if layout.year > 0 {
        layout.run(&Watch::new(observer, Work::Age, growth.structure.nodes as usize, METAMERS))?;
    }
    let tree = layout.finish()?;
    report(observer, Work::Age, 1.0)?;
    Ok(tree)
}

struct Layout<'a> {
    growth: &'a Growth,
    architecture: &'a Architecture,
    age: f32,
    /// The year at hand, from 1; 0 for a seed.
    year: u16,
    /// Share of it that is over, 0 to 1.
    time: f32,
    /// Progress of its season, 0 to 1.
    progress: f32,
    /// Indexed by the number of metamers.
    unfolded: Vec<Option<Unfolded>>,
    /// For each branch the pipes through its base; see [`Structure::pipes`](super::structure::Structure::pipes).
    pipes: Vec<f64>,
    /// Bases of the branches that stand.
    bases: Vec<Option<Base>>,
    positions: Vec<Vec3>,
    parents: Vec<Option<u32>>,
    radii: Vec<f32>,
    stages: Vec<u16>,
    orders: Vec<u16>,
    hops: Vec<u32>,
    ids: Vec<u32>,
    leaves: Vec<Leaf>,
    buds: Vec<Bud>,
    dead: Vec<bool>,
    colors: [[f32; 3]; TONES as usize],
    leaf_share: f32,
}

impl<'a> Layout<'a> {
    fn new(growth: &'a Growth, age: f32) -> Self {
        let architecture = &growth.architecture;
        let phenology = &architecture.phenology;
        let year = age.ceil() as u16;
        let time = age - (f32::from(year) - 1.0);
        let colors = std::array::from_fn(|tone| {
            let shifted = time + (tone as f32 - 0.5 * (TONES - 1) as f32) * TONE_STEP;
            [0, 1, 2].map(|channel: usize| phenology.leaf_colors[channel].at(shifted))
        });
        Self {
            growth,
            architecture,
            age,
            year,
            time,
            progress: phenology.progress(time),
            unfolded: Vec::new(),
            pipes: Vec::new(),
            bases: Vec::new(),
            positions: vec![Vec3::ZERO],
            parents: vec![None],
            radii: vec![0.0],
            stages: vec![0],
            orders: vec![0],
            hops: vec![0],
            ids: vec![0],
            leaves: Vec::new(),
            buds: Vec::new(),
            dead: vec![false],
            colors,
            leaf_share: phenology.least_share(time),
        }
    }

    fn run(&mut self, watch: &Watch<'_>) -> Result<(), Cancelled> {
        let structure = &self.growth.structure;
        self.pipes = structure.pipes(self.year, self.progress);
        self.bases = vec![None; structure.axes.len()];
        self.bases[0] = Some(Base { node: 0, position: Vec3::ZERO, heading: UP, inwards: Vec3::X });
        for (number, axis) in structure.axes.iter().enumerate() {
            if axis.first_year > self.year {
                // Branches are in the order of their years.
                break;
            }
            if let Some(base) = self.bases[number].filter(|_| axis.lost > self.age) {
                let before = self.positions.len();
                self.lay_out(number, axis, base);
                watch.pass(1 + self.positions.len() - before)?;
            }
        }
        Ok(())
    }

    /// One branch from its base to its tip.
    fn lay_out(&mut self, number: usize, axis: &Axis, base: Base) {
        let growth = self.growth;
        let architecture = self.architecture;
        let is_dead = axis.died <= self.age;
        let shoots = growth.structure.shoots_until(axis, axis.last_year(self.year));
        let last = shoots.len() - 1;
        let before =
            if last > 0 { shoots[last - 1] } else { Shoot { length: 0.0, metamers: 0, first_node: 0 } };
        let unfolding = shoots[last].metamers - before.metamers;
        let sums = if is_dead {
            let progress = 1.0;
            Unfolded::new(&architecture.phenology, progress, unfolding)
        } else {
            std::mem::take(self.unfolded(unfolding))
        };
        let length =
            before.length + (shoots[last].length - before.length) * sums.sums[unfolding as usize - 1];
        if length > 0.0 {
            let mut path = Path::new(growth, number, axis, base, length);
            let (year, progress) = (self.year, self.progress);
            let grown = growth.structure.metamers(axis, year, progress);
            // Pipes of the laterals above the current node.
            let mut lateral_pipes = self.pipes[number] - grown;
            if number == 0 {
                self.radii[0] = growth.thickness.radius(self.pipes[0].max(1.0));
            }
            let mut at = Place { node: base.node, along: 0.0, position: base.position };
            let borne = growth.structure.borne_starts[number] as usize
                ..growth.structure.borne_starts[number + 1] as usize;
            let mut borne = growth.structure.borne[borne].iter().copied().peekable();
            let (mut from, mut count) = (0.0, 0);
            for (i, shoot) in shoots.iter().enumerate() {
                let year = axis.first_year + i as u16;
                let metamers = shoot.metamers - count;
                path.stray(year);
                let step = (shoot.length - from) / metamers as f32;
                for k in 0..metamers {
                    let along = if i < last {
                        from + step * (k + 1) as f32
                    } else {
                        from + (shoot.length - from) * sums.sums[k as usize]
                    };
                    // Asked of the parts and not of the lengths: internodes may be shorter than a float's step.
                    let unfolds =
                        |k: u32| sums.sums[k as usize] > if k > 0 { sums.sums[k as usize - 1] } else { 0.0 };
                    if i == last && !unfolds(k) {
                        // This metamer and those above it have not unfolded yet.
                        break;
                    }
                    let part = (k + 1) as f32 / metamers as f32;
                    let direction = path.direction(0.5 * (at.along + along), part);
                    at.position += direction * (along - at.along);
                    at.along = along;
                    let bearer = count + k;
                    // In the shoot that unfolds each metamer's pipe does so too.
                    let own = if i == last && !is_dead {
                        let unfolded = (grown - f64::from(count)) / f64::from(metamers);
                        f64::from(metamers - k) * unfolded
                    } else {
                        grown - f64::from(bearer)
                    };
                    let radius = growth.thickness.radius(own + lateral_pipes.max(0.0));
                    at.node = self.push(at, radius, year, axis.order, shoot.first_node + k);
                    self.dead.push(is_dead);
                    while let Some(branch) =
                        borne.next_if(|&b| growth.structure.axes[b as usize].bearer == bearer)
                    {
                        lateral_pipes -= self.pipes[branch as usize];
                        let lateral = &growth.structure.axes[branch as usize];
                        if lateral.is_twin && lateral.first_year <= self.year {
                            path.forks.push((along, path.outward(direction, path.azimuth(bearer, 0))));
                        }
                        if lateral.first_year <= self.year && lateral.lost > self.age {
                            self.bases[branch as usize] = Some(path.lateral(lateral, direction, at));
                        }
                    }
                    let is_young = !is_dead && self.year - year < architecture.phenology.leaf_years.max(2);
                    if is_young {
                        for place in 0..architecture.whorl {
                            self.organs(&path, at, direction, radius, year, (bearer, place), k, metamers);
                        }
                    }
                }
                (from, count) = (shoot.length, shoot.metamers);
            }
            if at.along > 0.0 && !is_dead {
                self.apical_bud(at, path.direction(length, 1.0), last);
            }
        }
        if !is_dead {
            *self.unfolded(unfolding) = sums;
        }
    }

    /// Unfolded share of a shoot with this number of metamers.
    fn unfolded(&mut self, metamers: u32) -> &mut Unfolded {
        let number = metamers as usize;
        if self.unfolded.len() <= number {
            self.unfolded.resize_with(number + 1, || None);
        }
        let (phenology, progress) = (&self.architecture.phenology, self.progress);
        self.unfolded[number].get_or_insert_with(|| Unfolded::new(phenology, progress, metamers))
    }

    fn push(&mut self, at: Place, radius: f32, year: u16, order: u16, id: u32) -> u32 {
        let node = self.positions.len() as u32;
        self.positions.push(at.position);
        self.parents.push(Some(at.node));
        self.radii.push(radius);
        self.stages.push(year);
        self.orders.push(order);
        self.hops.push(self.hops[at.node as usize] + 1);
        self.ids.push(id);
        node
    }

    /// The leaf of a metamer and the bud in its axil, where they are.
    #[allow(clippy::too_many_arguments, reason = "all that is known of a metamer")]
    fn organs(
        &mut self,
        path: &Path<'_>,
        at: Place,
        direction: Vec3,
        radius: f32,
        year: u16,
        (bearer, place): (u32, u16),
        number: u32,
        of: u32,
    ) {
        let phenology = &self.architecture.phenology;
        let winters = self.year - year;
        let outward = path.outward(direction, path.azimuth(bearer, place));
        let position = at.position + outward * radius;
        let started = self.progress > 0.0;
        let id = u64::from(self.ids[at.node as usize]) | u64::from(place) << 32;
        let draw = |draw: Draw| unit(self.growth.seed, draw as u32, Purpose::GROWTH, id);
        let bud = match winters {
            0 => phenology.bud(self.time, number, of),
            1 if !started => phenology.bud_growth.at(1.0),
            _ => 0.0,
        } * phenology.bud_size;
        if bud > 0.0 {
            let direction = (direction + outward).normalize_or(direction);
            self.buds.push(Bud { node: at.node, position, direction, length: bud });
        }
        let falling = winters + 1 == phenology.leaf_years;
        if winters >= phenology.leaf_years || (falling && draw(Draw::Fall) >= self.leaf_share) {
            return;
        }
        let development = if winters > 0 { 1.0 } else { phenology.development(self.progress, number, of) };
        let on_shoot = (number + 1) as f32 / of as f32;
        let length = phenology.leaf_size.at(on_shoot) * phenology.leaf_growth.at(development);
        if length <= 0.0 {
            return;
        }
        let (sin, cos) = math::sin_cos(phenology.leaf_angle);
        let midrib = direction * cos + outward * sin;
        // The upper side looks to the light, as far as the midrib lets it.
        let adaxial = direction * sin - outward * cos;
        let towards = adaxial + UP * phenology.light_turn;
        let normal = (towards - midrib * towards.dot(midrib)).normalize_or(adaxial);
        let tone = (draw(Draw::Tone) * TONES as f32) as usize;
        let color = self.colors[tone];
        self.leaves.push(Leaf { node: at.node, position, midrib, normal, length, color });
    }

    fn apical_bud(&mut self, at: Place, direction: Vec3, last: usize) {
        let started = self.progress > 0.0;
        let phenology = &self.architecture.phenology;
        let growth = if started {
            phenology.bud(self.time, 1, 1)
        } else if last > 0 {
            phenology.bud_growth.at(1.0)
        } else {
            0.0
        };
        let length = growth * 1.5 * phenology.bud_size;
        if length > 0.0 {
            self.buds.push(Bud { node: at.node, position: at.position, direction, length });
        }
    }

    fn finish(self) -> Result<TreeAtAge, SkeletonError> {
        let skeleton = Skeleton::new(self.positions, self.parents)?
            .with_radii(self.radii)?
            .with_stages(self.stages)?
            .with_orders(self.orders)?
            .with_hops(self.hops)?;
        Ok(TreeAtAge { skeleton, ids: self.ids, leaves: self.leaves, buds: self.buds, dead: self.dead })
    }
}

/// The place up to which a branch has been laid out.
#[derive(Debug, Clone, Copy)]
struct Place {
    node: u32,
    along: f32,
    position: Vec3,
}

/// The course of one branch.
struct Path<'a> {
    architecture: &'a Architecture,
    seed: u64,
    number: u64,
    order: u16,
    base: Base,
    /// Direction at right angles to heading and `inwards`.
    aside: Vec3,
    length: f32,
    /// `s_θ` of equation 8.
    share: f32,
    /// Angle about the branch from which laterals count, radians.
    turn: f64,
    /// Random turn inwards and aside before and after the shoot at hand.
    strays: [[f32; 2]; 2],
    /// Its forks: the distance from the base, metres, and the direction of the twin there, at right angles to
    /// the branch.
    forks: Vec<(f32, Vec3)>,
}

impl<'a> Path<'a> {
    fn new(growth: &'a Growth, number: usize, axis: &Axis, base: Base, length: f32) -> Self {
        let architecture = &growth.architecture;
        let number = number as u64;
        // The azimuth of the trunk's first lateral is fixed, so that drawings of flat trees are seen from the
        // front.
        let turn =
            if number == 0 { 0.0 } else { unit(growth.seed, Draw::Azimuth as u32, Purpose::GROWTH, number) };
        Self {
            architecture,
            seed: growth.seed,
            number,
            order: axis.order,
            base,
            aside: base.heading.cross(base.inwards),
            length,
            share: eq::length_share(length, architecture.longest_branch),
            turn: f64::from(turn) * std::f64::consts::TAU,
            strays: [[0.0; 2]; 2],
            forks: Vec::new(),
        }
    }

    /// Goes on to the shoot of a year.
    fn stray(&mut self, year: u16) {
        let index = self.number << 16 | u64::from(year);
        let breadth = self.architecture.variation * if self.order == 0 { TRUNK } else { 1.0 };
        let [_, before] = self.strays;
        let draw = |draw: Draw| 2.0 * unit(self.seed, draw as u32, Purpose::GROWTH, index) - 1.0;
        let next = [Draw::Stray, Draw::Aside].map(|kind| breadth * draw(kind));
        self.strays = [before, [KEPT * before[0] + next[0], KEPT * before[1] + next[1]]];
    }

    /// The direction `along` metres from the base, the fraction `part` of the current shoot; of length 1.
    fn direction(&self, along: f32, part: f32) -> Vec3 {
        let mut direction = self.unforked(along, part);
        for &(place, twin) in &self.forks {
            // It rights itself again on its way.
            let left = 1.0
                - (1.0 - RIGHTED)
                    * ((along - place) / (self.length - place).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            let (sin, cos) = math::sin_cos(FORK_ANGLE * left);
            direction = (direction * cos - twin * sin).normalize_or(direction);
        }
        direction
    }

    fn unforked(&self, along: f32, part: f32) -> Vec3 {
        let place = along / self.length;
        let Base { heading, inwards, .. } = self.base;
        let [before, after] = self.strays;
        let stray = |side: usize| before[side] + (after[side] - before[side]) * part;
        let strayed = inwards * stray(0) + self.aside * stray(1);
        if self.order == 0 {
            return (heading + strayed).normalize_or(heading);
        }
        let (short, long) =
            (self.architecture.short_heading.at(place), self.architecture.long_heading.at(place));
        let (sin, cos) = math::sin_cos(eq::heading(self.share, short, long));
        let turned = heading * cos + inwards * sin;
        (turned + strayed + UP * (self.architecture.tropism * place)).normalize_or(turned)
    }

    /// Azimuth about the branch of one of the whorl that a metamer bears, radians.
    fn azimuth(&self, bearer: u32, place: u16) -> f32 {
        let around = std::f64::consts::TAU * f64::from(place) / f64::from(self.architecture.whorl);
        let turned = f64::from(self.architecture.divergence) * f64::from(bearer) + self.turn + around;
        (turned % std::f64::consts::TAU) as f32
    }

    /// The direction at right angles to the branch that an azimuth means where the branch has `direction`.
    fn outward(&self, direction: Vec3, azimuth: f32) -> Vec3 {
        // Carried from the base at once and not along the branch, so that it does not wind with every bend.
        let normal = parallel_transport(self.base.heading, direction, self.base.inwards);
        let (sin, cos) = math::sin_cos(azimuth);
        normal * cos + direction.cross(normal) * sin
    }

    fn lateral(&self, lateral: &Axis, direction: Vec3, at: Place) -> Base {
        let outward = self.outward(direction, self.azimuth(lateral.bearer, lateral.place));
        let (sin, cos) = math::sin_cos(lateral.angle);
        let heading = (direction * cos + outward * sin).normalize_or(outward);
        let inwards = direction * sin - outward * cos;
        let inwards = (inwards - heading * inwards.dot(heading)).normalize_or(math::perpendicular(heading));
        Base { node: at.node, position: at.position, heading, inwards }
    }
}
