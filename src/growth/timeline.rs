//! Years for trees that have none: any skeleton, grown from its root.

use crate::ParameterError;
use crate::skeleton::{Skeleton, SkeletonError};

use super::GrowthError;

/// Birth times for a skeleton of any origin, so that it is available at any age.
///
/// A node's age at the end comes from two things that grow with time. Distance: along the path from the root
/// through a node to the farthest tip beyond, growth is steady, so that every tip is reached in the end.
/// Radius: wood grows in rings of one breadth, so that a node is as old as it is thick. The
/// [share](Self::with_radius_share) weighs one against the other. No node is older than its parent.
///
/// An internode grows from its lower to its upper node in the time between their births. Branches therefore
/// grow at their tips only, nothing that stands ever moves, and no tip moves faster than `longest way /
/// (years · (1 - share))`.
///
/// ```
/// use treesynth::growth::Timeline;
/// use treesynth::presets;
///
/// let elm = presets::by_name("figure-07").unwrap().guided().unwrap().synth(3000).synthesize(1)?;
/// let timeline = Timeline::new(elm.clone(), 40.0)?;
/// let young = timeline.at(10.0)?;
/// assert!(young.len() > 1 && young.len() < elm.len());
/// assert_eq!(timeline.at(40.0)?.positions(), elm.positions());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    skeleton: Skeleton,
    years: f32,
    radius_share: f32,
    births: Vec<f32>,
}

crate::recipe::readable!(Timeline { radius_share: f32 });

impl Timeline {
    /// A tree that takes `years` years, 0.01 to 10,000, to grow to its present form; half by distance, half
    /// by radius. O(n).
    ///
    /// # Errors
    /// Years out of range.
    pub fn new(skeleton: Skeleton, years: f32) -> Result<Self, ParameterError> {
        let holds = (0.01..=1e4).contains(&years);
        ParameterError::unless(holds, "Timeline.years", years, "0.01 to 10000")?;
        let mut timeline = Self { skeleton, years, radius_share: 0.5, births: Vec::new() };
        timeline.births = timeline.work_out();
        Ok(timeline)
    }

    /// Sets the weight of radii against distances, 0 to 0.95; default 0.5. If all radii are alike, only
    /// distances count.
    ///
    /// # Errors
    /// A share out of range.
    pub fn with_radius_share(mut self, share: f32) -> Result<Self, ParameterError> {
        ParameterError::unless((0.0..=0.95).contains(&share), "Timeline.radius_share", share, "0 to 0.95")?;
        self.radius_share = share;
        self.births = self.work_out();
        Ok(self)
    }

    /// The age of the tree, years, at which growth reaches each node; 0 for the root.
    pub fn births(&self) -> &[f32] {
        &self.births
    }

    /// The whole tree.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// The years it takes.
    pub fn years(&self) -> f32 {
        self.years
    }

    /// The tree at an age, 0 to its years, bark only: leaves that [`Foliage`](crate::foliage::Foliage) places on two ages have
    /// nothing to do with each other.
    ///
    /// It has the nodes that [stand](Self::standing), tips on their way to the next node,
    /// radii as the rings are by then, orders as in the whole tree. `stages` are years: an internode's is the one in which it
    /// begins, from 1. O(n).
    ///
    /// # Errors
    /// An age out of range.
    pub fn at(&self, age: f32) -> Result<Skeleton, GrowthError> {
        let standing = self.standing(age)?;
        Ok(self.stand(age, &standing)?)
    }

    /// The nodes that stand at an age, ascending: those whose parent was born before then, and the root. Node i of the tree
    /// [at](Self::at) this age is the i-th of them. O(n).
    ///
    /// # Errors
    /// An age out of range.
    pub fn standing(&self, age: f32) -> Result<Vec<u32>, ParameterError> {
        let holds = age >= 0.0 && age <= self.years;
        ParameterError::unless(holds, "Timeline.age", age, &format!("0 to {:?} years", self.years))?;
        let stands = |&(node, parent): &(usize, usize)| {
            // A node born with its parent appears with it.
            self.births[parent] < age || self.births[node] <= age
        };
        let above = self.skeleton.edges().filter(stands).map(|(node, _)| node as u32);
        Ok(std::iter::once(0).chain(above).collect())
    }

    fn stand(&self, age: f32, standing: &[u32]) -> Result<Skeleton, SkeletonError> {
        let whole = &self.skeleton;
        let thinnest = whole.radii().iter().copied().fold(f32::INFINITY, f32::min);
        let mut places = vec![0; whole.len()];
        let (mut positions, mut parents, mut radii, mut stages) = (vec![], vec![], vec![], vec![]);
        for (place, &node) in standing.iter().enumerate() {
            let node = node as usize;
            places[node] = place as u32;
            let parent = whole.parent(node);
            let begun = parent.map_or(0.0, |parent| self.births[parent]);
            parents.push(parent.map(|parent| places[parent]));
            let end = whole.positions()[node];
            positions.push(match parent {
                Some(parent) if self.births[node] > age => {
                    let part = (age - begun) / (self.births[node] - begun);
                    whole.positions()[parent].lerp(end, part)
                }
                _ => end,
            });
            let ring = if self.years > begun { (age - begun) / (self.years - begun) } else { 1.0 };
            radii.push(thinnest + (whole.radii()[node] - thinnest) * ring.clamp(0.0, 1.0));
            // A node born at the very end has no year of its own.
            let year = begun.min(self.years.ceil() - 1.0).floor() as u16 + 1;
            stages.push(if node == 0 { 0 } else { year });
        }
        let of = |numbers: &[u16]| standing.iter().map(|&node| numbers[node as usize]).collect();
        let hops = standing.iter().map(|&node| whole.hops()[node as usize]).collect();
        Skeleton::new(positions, parents)?
            .with_radii(radii)?
            .with_stages(stages)?
            .with_orders(of(whole.orders()))?
            .with_hops(hops)
    }

    /// Births do not fall from a parent to its child, for neither part of the age rises.
    fn work_out(&self) -> Vec<f32> {
        let whole = &self.skeleton;
        let positions = whole.positions();
        // In double precision, which no sum of distances leaves.
        let length =
            |node: usize, parent: usize| positions[node].as_dvec3().distance(positions[parent].as_dvec3());
        let mut from_root = vec![0.0; whole.len()];
        for (node, parent) in whole.edges() {
            from_root[node] = from_root[parent] + length(node, parent);
        }
        let mut beyond = vec![0.0f64; whole.len()];
        let mut thickest: Vec<f32> = whole.radii().to_vec();
        for (node, parent) in whole.edges().rev() {
            beyond[parent] = beyond[parent].max(beyond[node] + length(node, parent));
            thickest[parent] = thickest[parent].max(thickest[node]);
        }
        let thinnest = f64::from(whole.radii().iter().copied().fold(f32::INFINITY, f32::min));
        let breadth = f64::from(thickest[0]) - thinnest;
        let share = if breadth > 0.0 { f64::from(self.radius_share) } else { 0.0 };
        let born = |node: usize| {
            let way = from_root[node] + beyond[node];
            let by_distance = if way > 0.0 { from_root[node] / way } else { 1.0 };
            let by_radius =
                if share > 0.0 { 1.0 - (f64::from(thickest[node]) - thinnest) / breadth } else { 0.0 };
            (1.0 - share) * by_distance + share * by_radius
        };
        let mut births = vec![0.0; whole.len()];
        for (node, parent) in whole.edges() {
            let birth = (born(node) * f64::from(self.years)) as f32;
            births[node] = birth.clamp(births[parent], self.years);
        }
        births
    }
}
