//! The branches that a tree ever has, worked out a year at a time: laterals sprout from the shoots of the year before, and
//! each gets its lengths and metamers in all years.

use super::architecture::Architecture;
use super::equation as eq;
use super::structure::{Axis, Draw, FORK_ANGLE, Shoot, Structure};
use crate::observer::{Cancelled, Observer, Watch, Work};
use crate::random::{Purpose, unit};

/// The least angle between the longest laterals of successive shoots, radians: the paper's 40°.
const LEAST_ANGLE: f32 = 0.698_131_7;

/// Shoots worked out from one report to the next.
const SHOOTS: usize = 4096;

/// Least number of years that a dead branch stands, and the mean number beyond that for a branch of
/// one metre, in proportion to the root of the length; and the most of these.
const LEAST_BARE: f32 = 0.2;
const BARE_YEARS: f32 = 1.6;
const MOST_BARE_YEARS: f32 = 6.0;

impl Structure {
    #[cfg(test)]
    pub(super) fn new(architecture: &Architecture, seed: u64, most_nodes: u32) -> Self {
        Self::observed(architecture, seed, most_nodes, &crate::Silent).expect("nobody cancels it")
    }

    pub(super) fn observed(
        architecture: &Architecture,
        seed: u64,
        most_nodes: u32,
        observer: &dyn Observer,
    ) -> Result<Self, Cancelled> {
        let watch = Watch::new(observer, Work::Years, 1 << 20, SHOOTS);
        let mut builder = Builder::new(architecture, seed, most_nodes, &watch);
        let mut refused = None;
        let mut years = 0;
        for year in 1..=architecture.years {
            match builder.year(year) {
                Ok(()) => years = year,
                Err(Stop::Cancelled) => return Err(Cancelled),
                Err(Stop::Limit(nodes)) => {
                    refused = Some(nodes);
                    break;
                }
            }
        }
        let structure = builder.finish(years, refused);
        watch.finish()?;
        Ok(structure)
    }
}

/// A structure as far as it has been worked out.
struct Builder<'a> {
    architecture: &'a Architecture,
    seed: u64,
    most_nodes: u32,
    /// `l_smax`: the longest shoot of the trunk.
    longest_shoot: f32,
    axes: Vec<Axis>,
    shoots: Vec<Shoot>,
    nodes: u32,
    /// For each number of metamers which two of them bear the longest laterals.
    longest: Vec<Option<[u32; 2]>>,
    /// Length that the silhouette asks of a branch in each year from the one at hand on.
    wanted: Vec<f32>,
    watch: &'a Watch<'a>,
}

/// Reason why a year does not come.
enum Stop {
    Cancelled,
    /// More nodes than are allowed.
    Limit(u64),
}

impl<'a> Builder<'a> {
    fn new(architecture: &'a Architecture, seed: u64, most_nodes: u32, watch: &'a Watch<'a>) -> Self {
        let mut builder = Self {
            architecture,
            seed,
            most_nodes,
            longest_shoot: 0.0,
            axes: Vec::new(),
            shoots: Vec::new(),
            nodes: 1,
            longest: Vec::new(),
            wanted: Vec::new(),
            watch,
        };
        let height = |year: u16| architecture.height.at(builder.time(year));
        builder.wanted = (1..=architecture.years).map(height).collect();
        let mut before = 0.0;
        for &wanted in &builder.wanted {
            let length = eq::enforced_length(wanted, before, architecture.least_shoot);
            builder.longest_shoot = builder.longest_shoot.max(length - before);
            before = length;
        }
        let trunk = Axis {
            parent: 0,
            bearer: 0,
            place: 0,
            is_twin: false,
            order: 0,
            rank: 0,
            first_year: 1,
            died: f32::INFINITY,
            lost: f32::INFINITY,
            scale: 1.0,
            angle: 0.0,
            start: 0,
        };
        builder.extend(trunk);
        builder
    }

    /// `t_y`: the year as a part of the greatest age.
    fn time(&self, year: u16) -> f32 {
        f32::from(year) / f32::from(self.architecture.years)
    }

    /// One more year: laterals of the shoots of the year before, then a shoot of every living branch.
    fn year(&mut self, year: u16) -> Result<(), Stop> {
        // A branch takes three times the memory of a node, and each of its years up to the greatest age half of it.
        let most = self.most_nodes as usize;
        for axis in 0..self.axes.len() {
            if year > 1 && self.is_living(axis, year) && self.axes[axis].rank < self.architecture.most_order {
                let before = self.shoots.len();
                self.branch(axis, year);
                if !self.watch.steps(1 + self.shoots.len() - before) {
                    return Err(Stop::Cancelled);
                }
            }
            if self.axes.len() > most || self.shoots.len() / 8 > most {
                return Err(Stop::Limit(self.axes.len().max(self.shoots.len() / 8) as u64));
            }
        }
        let mut nodes = u64::from(self.nodes);
        for axis in 0..self.axes.len() {
            if !self.is_living(axis, year) {
                continue;
            }
            let Axis { start, first_year, .. } = self.axes[axis];
            let at = start as usize + usize::from(year - first_year);
            let before = if year > first_year { self.shoots[at - 1].metamers } else { 0 };
            self.shoots[at].first_node = nodes.min(u64::from(u32::MAX)) as u32;
            nodes += u64::from(self.shoots[at].metamers - before);
        }
        if nodes > u64::from(self.most_nodes) {
            return Err(Stop::Limit(nodes));
        }
        self.nodes = nodes as u32;
        Ok(())
    }

    /// `true` if a branch lives in a year, if only at its beginning.
    fn is_living(&self, axis: usize, year: u16) -> bool {
        self.axes[axis].died > f32::from(year - 1)
    }

    /// The laterals that sprout in `year` from the shoot of the year before.
    fn branch(&mut self, parent: usize, year: u16) {
        let architecture = self.architecture;
        let bearing = self.axes[parent].clone();
        let Axis { start, first_year, .. } = bearing;
        if first_year >= year {
            return;
        }
        let at = start as usize + usize::from(year - 1 - first_year);
        let shoot = self.shoots[at];
        let (length_before, metamers_before) = if year - 1 > first_year {
            (self.shoots[at - 1].length, self.shoots[at - 1].metamers)
        } else {
            (0.0, 0)
        };
        let metamers = shoot.metamers - metamers_before;
        // Section 4.3: all laterals of a shoot use the shoot's position on the branch.
        let position = f32::midpoint(length_before, shoot.length);
        let final_length = self.shoots[start as usize + usize::from(architecture.years - first_year)].length;
        let at_end = position / final_length;
        self.wanted.clear();
        for later in year..=architecture.years {
            let length = self.shoots[start as usize + usize::from(later - first_year)].length;
            let now = position / length;
            let (young, mature) =
                (architecture.young_silhouette.at(now), architecture.mature_silhouette.at(now));
            self.wanted.push(eq::wanted_length(length, self.time(later), young, mature));
        }
        let forks = self.forks(parent, year);
        for number in 0..metamers * u32::from(architecture.whorl) {
            let (number, place) =
                (number / u32::from(architecture.whorl), number % u32::from(architecture.whorl));
            if place == 0 && number + 1 == metamers && forks {
                continue;
            }
            let on_shoot = (number + 1) as f32 / metamers as f32;
            let bearer = metamers_before + number;
            let id = u64::from(shoot.first_node + number) | u64::from(place) << 32;
            let seed = self.seed;
            let draw = |draw: Draw| unit(seed, draw as u32, Purpose::GROWTH, id);
            let scale = eq::lateral_scale(
                &architecture.shoot_scale,
                &architecture.branch_scale,
                bearing.scale,
                on_shoot,
                at_end,
            );
            let scale = scale * (1.0 - architecture.scale_variation * draw(Draw::Scale));
            if scale < architecture.least_scale || scale <= 0.0 {
                continue;
            }
            let lifespan = eq::lost_at(&architecture.lifespan, scale)
                * (1.0 - architecture.scale_variation * draw(Draw::Lifespan));
            let died = (f32::from(year - 1) + lifespan.max(1.0)).ceil().min(bearing.died);
            let number = self.extend(Axis {
                parent: parent as u32,
                bearer,
                place: place as u16,
                is_twin: false,
                order: bearing.order + 1,
                rank: bearing.rank + 1,
                first_year: year,
                died,
                lost: died,
                scale,
                angle: 0.0,
                start: 0,
            });
            if died < f32::from(architecture.years) {
                // A bare branch stands longer the larger it is.
                let last = usize::from(died as u16 - year);
                let length = self.shoots[self.axes[number].start as usize + last].length;
                let bare = (BARE_YEARS * length.sqrt() * (0.5 + draw(Draw::Break))).min(MOST_BARE_YEARS);
                self.axes[number].lost = (died + LEAST_BARE + bare).min(bearing.lost);
            } else {
                self.axes[number].lost = (died + LEAST_BARE).min(bearing.lost);
            }
        }
        if forks {
            self.twin(parent, year, metamers_before + metamers - 1);
        }
    }

    /// `true` if a branch forks at the end of the shoot before `year`.
    fn forks(&self, parent: usize, year: u16) -> bool {
        let id = (parent as u64) << 16 | u64::from(year);
        unit(self.seed, Draw::Fork as u32, Purpose::GROWTH, id) < self.architecture.forking
    }

    /// Lets a branch fork at the end of its shoot: at that metamer springs a twin that is in all years as long as the branch
    /// beyond it.
    fn twin(&mut self, parent: usize, year: u16, bearer: u32) {
        let architecture = self.architecture;
        let bearing = self.axes[parent].clone();
        let start = bearing.start as usize;
        let place = self.shoots[start + usize::from(year - 1 - bearing.first_year)].length;
        let wanted = (year..=architecture.years)
            .map(|later| self.shoots[start + usize::from(later - bearing.first_year)].length - place);
        // `extend` scales what is wanted and divides it by the order; a twin is to be as long as it says here.
        let divided = eq::order_divisor(bearing.rank) / bearing.scale;
        let wanted: Vec<f32> = wanted.map(|length| length * divided).collect();
        let before = std::mem::replace(&mut self.wanted, wanted);
        self.extend(Axis {
            parent: parent as u32,
            bearer,
            place: 0,
            is_twin: true,
            order: bearing.order + 1,
            rank: bearing.rank,
            first_year: year,
            died: bearing.died,
            lost: bearing.lost,
            scale: bearing.scale,
            angle: 0.0,
            start: 0,
        });
        self.wanted = before;
    }

    /// Adds a branch with its lengths and metamers in all years, of which `wanted` has the lengths at scale 1.
    fn extend(&mut self, mut axis: Axis) -> usize {
        let architecture = self.architecture;
        axis.start = self.shoots.len() as u32;
        let (mut length, mut metamers, mut longest_before) = (0.0, 0, None);
        for i in 0..self.wanted.len() {
            let wanted = self.wanted[i] * axis.scale;
            let before = length;
            length = eq::higher_order_length(wanted, before, architecture.least_shoot, axis.rank);
            if i == 0 && !self.axes.is_empty() {
                let share = (length / self.longest_shoot).min(1.0);
                axis.angle = if axis.is_twin { FORK_ANGLE } else { architecture.branching_angle.at(share) };
            }
            let wanted = eq::metamers(&architecture.metamers, length - before, self.longest_shoot);
            let count = self.turned(wanted, metamers, longest_before);
            let [longest, _] = self.longest(count);
            longest_before = Some(metamers + longest);
            metamers += count;
            self.shoots.push(Shoot { length, metamers, first_node: 0 });
        }
        self.axes.push(axis);
        self.axes.len() - 1
    }

    /// The number of metamers nearest to `wanted` with which both of the longest laterals of the shoot stand at least
    /// 40° from the longest of the shoot before; `wanted` if there is none near. The longest by `G_ss`, that is; chance
    /// ([`scale_variation`](Architecture::with_scale_variation)) may have it otherwise.
    fn turned(&mut self, wanted: u32, before: u32, longest_before: Option<u32>) -> u32 {
        let Some(longest_before) = longest_before else { return wanted };
        // A spiral by the golden angle has one within two; other divergences may have none at all.
        let farthest = 2 + wanted / 3;
        let offsets =
            (0..=2 * farthest).map(|i| if i % 2 == 1 { i.div_ceil(2) as i32 } else { -((i / 2) as i32) });
        for offset in offsets {
            let Some(count) = wanted.checked_add_signed(offset).filter(|&count| count > 0) else { continue };
            let (divergence, whorl) = (self.architecture.divergence, self.architecture.whorl);
            let longest = self.longest(count);
            if longest.iter().all(|&k| apart(before + k - longest_before, divergence, whorl) >= LEAST_ANGLE) {
                return count;
            }
        }
        wanted
    }

    /// The metamers that bear the longest and the second longest lateral: those of the greatest `G_ss`.
    fn longest(&mut self, metamers: u32) -> [u32; 2] {
        let known = metamers as usize;
        if self.longest.len() <= known {
            self.longest.resize(known + 1, None);
        }
        let curve = &self.architecture.shoot_scale;
        *self.longest[known].get_or_insert_with(|| {
            let scale = |k: u32| curve.at((k + 1) as f32 / metamers as f32);
            // The upper one of equals.
            let best = |except: Option<u32>| {
                let others = (0..metamers).filter(|&k| Some(k) != except);
                others.max_by(|&a, &b| scale(a).total_cmp(&scale(b))).unwrap_or_default()
            };
            let first = best(None);
            [first, if metamers > 1 { best(Some(first)) } else { first }]
        })
    }

    fn finish(self, years: u16, refused: Option<u64>) -> Structure {
        let Self { axes, shoots, nodes, .. } = self;
        let mut starts = vec![0u32; axes.len() + 1];
        for axis in axes.iter().skip(1) {
            starts[axis.parent as usize + 1] += 1;
        }
        for axis in 0..axes.len() {
            starts[axis + 1] += starts[axis];
        }
        let mut next = starts.clone();
        let mut borne = vec![0; axes.len() - 1];
        for (number, axis) in axes.iter().enumerate().skip(1) {
            let slot = &mut next[axis.parent as usize];
            borne[*slot as usize] = number as u32;
            *slot += 1;
        }
        Structure { axes, shoots, borne, borne_starts: starts, years, refused, nodes }
    }
}
/// The least angle about the axis between two metamers' laterals, radians, 0 to π: `steps` metamers
/// apart, with `whorl` laterals at each.
fn apart(steps: u32, divergence: f32, whorl: u16) -> f32 {
    let turn = std::f64::consts::TAU / f64::from(whorl);
    let angle = (f64::from(steps) * f64::from(divergence)).rem_euclid(turn);
    angle.min(turn - angle) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::growth::Curve;

    fn cottonwood() -> (Architecture, Structure) {
        let architecture = Architecture::default().with_years(14);
        let structure = Structure::new(&architecture, 3, 1 << 24);
        (architecture, structure)
    }

    #[test]
    fn golden_steps_by_hand() {
        let golden = 137.5f32.to_radians();
        // 2·137.5 = 275, which is 85 from a full turn; 3·137.5 = 412.5, 52.5 beyond one; 8·137.5 = 1100, 20 beyond three.
        for (steps, degrees) in [(1, 137.5f32), (2, 85.0), (3, 52.5), (8, 20.0)] {
            assert!((apart(steps, golden, 1).to_degrees() - degrees).abs() < 1e-3, "{steps}");
        }
    }

    #[test]
    fn lengths_keep_equation_5() {
        let (architecture, structure) = cottonwood();
        assert_eq!(structure.years, 14);
        for axis in &structure.axes {
            let shoots = structure.shoots_until(axis, 14);
            assert!(shoots[0].length >= architecture.least_shoot);
            for pair in shoots.windows(2) {
                let rounding = 1e-6 * pair[1].length;
                assert!(eq::grows_enough(
                    pair[0].length,
                    pair[1].length + rounding,
                    architecture.least_shoot
                ));
                assert!(pair[1].metamers > pair[0].metamers);
            }
        }
    }

    /// Each lateral by hand, from the finished structure.
    #[test]
    fn laterals_keep_equations_6_11_12_and_15() {
        let (architecture, structure) = cottonwood();
        let least = 1.0 - architecture.scale_variation;
        for axis in &structure.axes[1..] {
            let parent = &structure.axes[axis.parent as usize];
            let bearing = structure.shoots_until(parent, 14);
            let at = usize::from(axis.first_year - 1 - parent.first_year);
            let (from, below) =
                if at > 0 { (bearing[at - 1].length, bearing[at - 1].metamers) } else { (0.0, 0) };
            let place = 0.5 * (from + bearing[at].length);
            let on_shoot = (axis.bearer - below + 1) as f32 / (bearing[at].metamers - below) as f32;
            let at_end = place / bearing[bearing.len() - 1].length;
            let scale =
                architecture.shoot_scale.at(on_shoot) * parent.scale * architecture.branch_scale.at(at_end);
            assert!((least * scale - 1e-5..=scale + 1e-5).contains(&axis.scale), "{} of {scale}", axis.scale);
            let [soonest, latest] =
                [least, 1.0].map(|part| (part * architecture.lifespan.at(axis.scale)).max(1.0));
            // Branches die at the end of a year.
            let lived = axis.died - f32::from(axis.first_year - 1);
            assert!(lived < latest + 1.0 && (lived >= soonest - 1e-4 || axis.died >= parent.died));
            let mut before = 0.0f32;
            for (year, shoot) in (axis.first_year..).zip(structure.shoots_until(axis, 14)) {
                let whole = bearing[usize::from(year - parent.first_year)].length;
                let (time, now) = (f32::from(year) / 14.0, place / whole);
                let silhouettes =
                    [&architecture.young_silhouette, &architecture.mature_silhouette].map(|g| g.at(now));
                let wanted = whole * ((1.0 - time) * silhouettes[0] + time * silhouettes[1]);
                let divided = wanted * axis.scale / (1.0 + 0.5 * f32::from(axis.order));
                let expected = divided.max(before + architecture.least_shoot);
                assert!((shoot.length - expected).abs() <= 1e-5 * expected, "{} {expected}", shoot.length);
                before = shoot.length;
            }
        }
    }

    /// Section 4.3's rule of 40°, looked up in the finished structure.
    #[test]
    fn longest_laterals_turn_away_from_those_of_the_year_before() {
        let (architecture, structure) = cottonwood();
        let mut shoots = 0;
        for axis in &structure.axes {
            let counts: Vec<u32> =
                structure.shoots_until(axis, 14).iter().map(|shoot| shoot.metamers).collect();
            for i in 1..counts.len() {
                // G_ss rises to the tip: the two uppermost are the longest.
                let longest_before = counts[i - 1] - 1;
                for k in 1..=(counts[i] - counts[i - 1]).min(2) {
                    let angle =
                        apart(counts[i] - k - longest_before, architecture.divergence, 1).to_degrees();
                    assert!(angle >= 39.999, "{angle}°");
                    shoots += 1;
                }
            }
        }
        assert!(shoots > 1000);
    }

    #[test]
    fn nothing_outlives_what_bears_it() {
        let (_, structure) = cottonwood();
        for (number, axis) in structure.axes.iter().enumerate().skip(1) {
            let parent = &structure.axes[axis.parent as usize];
            assert!((axis.parent as usize) < number && axis.lost <= parent.lost && axis.died <= parent.died);
            assert!(axis.lost >= axis.died + LEAST_BARE && axis.died.fract() == 0.0);
            assert!(axis.lost >= f32::from(axis.first_year).min(parent.lost));
            assert!(axis.first_year > parent.first_year && axis.scale <= parent.scale);
        }
    }

    #[test]
    fn runaway_branching_stops_and_keeps_whole_years() {
        let one = || Curve::constant(1.0).unwrap();
        let architecture = Architecture::default()
            .with_branch_scale(one())
            .with_shoot_scale(one())
            .with_scale_variation(0.0)
            .with_least_scale(0.0)
            .with_most_order(16)
            .with_lifespan(Curve::constant(1e4).unwrap());
        let structure = Structure::new(&architecture, 1, 100_000);
        assert!(structure.refused.is_some_and(|nodes| nodes > 100_000));
        assert!(structure.years > 2 && structure.years < 10 && structure.nodes <= 100_000);
        let smaller = Structure::new(&architecture, 1, structure.nodes);
        assert_eq!((smaller.years, smaller.nodes), (structure.years, structure.nodes));
    }
}
