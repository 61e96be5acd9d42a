//! The part of a tree that does not depend on its age: the branches that it ever has, the length of
//! each in each year, the number of metamers of its shoots, and the age at which it is lost.
//!
//! Branches are numbered by the year in which they sprout, so that a parent branch comes before its laterals;
//! nodes are numbered year by year. Neither number ever changes.

/// Uses of a branch's random numbers; the stages of its streams.
#[derive(Debug, Clone, Copy)]
pub(super) enum Draw {
    Azimuth = 0,
    Scale = 1,
    Lifespan = 2,
    Stray = 3,
    Aside = 4,
    Fall = 5,
    Tone = 6,
    Break = 7,
    Fork = 8,
}

/// Angle of each of a fork's two to their parent branch, radians.
pub(super) const FORK_ANGLE: f32 = 0.4;

/// A branch, the trunk included.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Its parent branch; the trunk's is itself.
    pub(super) parent: u32,
    /// The metamer of that branch at whose upper end it springs.
    pub(super) bearer: u32,
    /// Number within the whorl at that metamer, from 0.
    pub(super) place: u16,
    /// `true` if it is half of a fork: as long as the rest of its parent branch, which leans the
    /// other way.
    pub(super) is_twin: bool,
    pub(super) order: u16,
    /// Its order without the forks on the way: a twin has its parent branch's.
    pub(super) rank: u16,
    /// The year of its first shoot, from 1.
    pub(super) first_year: u16,
    /// The tree's age at which it dies with all it bears, at the end of a year; infinite for the trunk. From then on it does
    /// not grow, and no leaf comes.
    pub(super) died: f32,
    /// The tree's age at which it breaks off with all it bears, some time after its death; infinite for the trunk.
    pub(super) lost: f32,
    /// `s_b` of equation 15.
    pub(super) scale: f32,
    /// Angle to its parent branch, radians.
    pub(super) angle: f32,
    /// Index of its years in the arrays of [`Structure`].
    pub(super) start: u32,
}

/// One year of one branch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shoot {
    /// Length of the branch at the year's end, metres.
    pub(super) length: f32,
    /// Metamers of the branch at the year's end.
    pub(super) metamers: u32,
    /// The number of the shoot's first node.
    pub(super) first_node: u32,
}

/// All branches of a tree.
#[derive(Debug, Clone)]
pub(super) struct Structure {
    pub(super) axes: Vec<Axis>,
    /// The years of each branch up to the greatest age.
    pub(super) shoots: Vec<Shoot>,
    /// The branches that each branch bears, from its base to its tip.
    pub(super) borne: Vec<u32>,
    pub(super) borne_starts: Vec<u32>,
    /// Years that have been worked out completely.
    pub(super) years: u16,
    /// Nodes the next year would have led to, if there was a next one.
    pub(super) refused: Option<u64>,
    /// Nodes that ever are, the root included.
    pub(super) nodes: u32,
}

impl Axis {
    /// The last year, up to `year`, in which it grows.
    pub(super) fn last_year(&self, year: u16) -> u16 {
        if f32::from(year) > self.died { self.died as u16 } else { year }
    }
}

impl Structure {
    /// For each branch the pipes that run through its base when `progress` of the season of `year` is over: one for each
    /// metamer that it or what it bears has ever had, also where that is lost, for rings stay. One pass from the tips
    /// to the root, O(branches).
    pub(super) fn pipes(&self, year: u16, progress: f32) -> Vec<f64> {
        let mut pipes = vec![0.0; self.axes.len()];
        let sprouted = self.axes.partition_point(|axis| axis.first_year <= year);
        for number in (0..sprouted).rev() {
            let axis = &self.axes[number];
            pipes[number] += self.metamers(axis, year, progress);
            if number > 0 {
                pipes[axis.parent as usize] += pipes[number];
            }
        }
        pipes
    }

    /// The length of the trunk at the greatest age, metres.
    pub(super) fn trunk_length(&self) -> f32 {
        let next = self.axes.get(1).map_or(self.shoots.len(), |axis| axis.start as usize);
        self.shoots[next - 1].length
    }

    /// The pipes at the trunk base in the last year there is.
    pub(super) fn all_pipes(&self) -> f64 {
        if self.years > 0 { self.pipes(self.years, 1.0)[0] } else { 1.0 }
    }

    /// The metamers of a branch when `progress` of the season of `year` is over.
    pub(super) fn metamers(&self, axis: &Axis, year: u16, progress: f32) -> f64 {
        let last = axis.last_year(year);
        let shoots = self.shoots_until(axis, last);
        let now = f64::from(shoots[shoots.len() - 1].metamers);
        let before = if shoots.len() > 1 { f64::from(shoots[shoots.len() - 2].metamers) } else { 0.0 };
        if last < year { now } else { before + (now - before) * f64::from(progress) }
    }

    /// The years of a branch from its first to `year`.
    pub(super) fn shoots_until(&self, axis: &Axis, year: u16) -> &[Shoot] {
        let start = axis.start as usize;
        &self.shoots[start..start + usize::from(year + 1 - axis.first_year)]
    }
}
