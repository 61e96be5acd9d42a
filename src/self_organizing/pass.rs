//! One season of a forest: turns, limits, burials and seeds.

use super::environment::Environment;
use super::forest::{Forest, ForestError};
use super::habit::Habit;
use super::room::Room;
use super::season::{Change, Part, Plan, Setting};
use super::tree::Tree;
use crate::observer::{Observer, Work, report};
use crate::parallel;

/// Trees take turns in a season: those whose numbers leave the same remainder grow at once.
pub(super) const TURNS: u32 = 4;

/// The environment is told of about so many nodes at once.
const TOLD: usize = 1 << 18;

impl<E: Environment> Forest<E> {
    /// The season that has begun, or the next.
    pub(super) fn pass(&mut self, work: Work, observer: &dyn Observer) -> Result<(), ForestError> {
        self.check()?;
        report(observer, work, 0.0)?;
        loop {
            self.take_turn()?;
            report(observer, work, if self.turn == 0 { 1.0 } else { self.turn as f32 / TURNS as f32 })?;
            if self.turn == 0 {
                return Ok(());
            }
        }
    }

    /// Turns of a season.
    fn turns(&self) -> u32 {
        // Buds that share out markers must all be there at once.
        if self.environment.surveys() { 1 } else { TURNS }
    }

    /// The latest season of the tree of a number: that which has begun, once the tree has had its turn.
    pub(super) fn season_of(&self, number: u32) -> u16 {
        self.season + u16::from(number % self.turns() < self.turn)
    }

    /// The season of the trees whose turn it is: they look, all at once, then grow, then the environment is told.
    fn take_turn(&mut self) -> Result<(), ForestError> {
        let season =
            self.season.checked_add(1).ok_or(ForestError::Numbers { what: "seasons", most: 65_535 })?;
        self.tell_shades();
        let standing = self.metamers() as u64;
        let (habits, seed, turn) = (&self.habits, self.seed, self.turn);
        let turns = self.turns();
        let mut trees: Vec<&mut Tree> =
            self.trees.iter_mut().filter(|tree| tree.number % turns == turn).collect();
        let mut firsts = Vec::new();
        if self.environment.surveys() {
            let sites =
                parallel::each_mut(&mut trees, |_, tree| tree.sites(&habits[tree.habit as usize], seed));
            self.environment.prepare(&sites.concat());
            firsts.extend(sites.iter().scan(0, |next, sites| {
                *next += sites.len() as u32;
                Some(*next - sites.len() as u32)
            }));
        }
        let plans = {
            let setting = settings(&self.environment, &self.room, habits, seed, season);
            parallel::each_mut(&mut trees, |i, tree| {
                tree.plan(&setting(tree), firsts.get(i).copied().unwrap_or(0), self.parts)
            })
        };
        check_limits(season, &trees, &plans, standing, self.most_metamers)?;
        let mut planned: Vec<(&mut Tree, Plan)> = trees.into_iter().zip(plans).collect();
        for part in 0..self.parts {
            let part = Part { index: part, of: self.parts };
            let changes = {
                let setting = settings(&self.environment, &self.room, habits, seed, season);
                parallel::each_mut(&mut planned, |_, (tree, plan)| {
                    (tree.class(), tree.carry_out(part, plan, &setting(tree)))
                })
            };
            tell(&mut self.environment, &self.told, changes);
        }
        self.turn = (turn + 1) % turns;
        if self.turn == 0 {
            self.season = season;
            let changes = self.bury_and_sow();
            tell(&mut self.environment, &self.told, changes);
        }
        Ok(())
    }

    /// Takes away what is left of dead trees and sows new ones where there is room for them. What that changes, by class.
    fn bury_and_sow(&mut self) -> Vec<(usize, Change)> {
        let mut changes: Vec<(usize, Change)> =
            (0..self.told.len()).map(|class| (class, Change::default())).collect();
        let (habits, season) = (&self.habits, self.season);
        self.trees.retain(|tree| {
            let gone = tree.is_gone(&habits[tree.habit as usize], season);
            if gone {
                changes[tree.class()].1.fallen.extend(tree.positions());
            }
            !gone
        });
        for index in 0..self.trees.len() {
            let tree = &self.trees[index];
            let (habit, generation) = (tree.habit, tree.generation.saturating_add(1));
            let Some(offspring) = self.habits[habit as usize].offspring else { continue };
            let age = season - tree.born();
            for foot in offspring.sow(tree.foot(), tree.vigor, age, self.seed, tree.number) {
                let foot = self.room.grounded(foot);
                if self.trees.len() < self.most_trees && self.next_tree < u32::MAX && self.has_room(foot) {
                    self.root(foot, habit, generation);
                    changes[2 * habit as usize].1.appeared.push(foot);
                }
            }
        }
        changes
    }

    /// Makes sure that the environment knows how much shade the living and the dead of each species cast. Their nodes are
    /// told anew if that has changed.
    pub(super) fn tell_shades(&mut self) {
        let environment = &self.environment;
        let shades = self.habits.iter().flat_map(|habit| {
            let living = environment.shade_of(habit);
            [living, living * habit.dead_wood.map_or(1.0, |dead| dead.shade)]
        });
        for (class, shade) in shades.collect::<Vec<f32>>().into_iter().enumerate() {
            match self.told.get_mut(class) {
                None => self.told.push(shade),
                Some(told) if told.to_bits() != shade.to_bits() => {
                    let of_it = self.trees.iter().filter(|tree| tree.class() == class);
                    let nodes: Vec<_> = of_it.flat_map(Tree::positions).collect();
                    self.environment.update_shaded(*told, &[], &nodes);
                    self.environment.update_shaded(shade, &nodes, &[]);
                    *told = shade;
                }
                Some(_) => {}
            }
        }
    }
}

/// Region in which each tree grows.
fn settings<'a, E>(
    environment: &'a E,
    room: &'a Room,
    habits: &'a [Habit],
    seed: u64,
    season: u16,
) -> impl Fn(&Tree) -> Setting<'a, E> {
    move |tree| Setting { environment, room, habit: &habits[tree.habit as usize], seed, season }
}

/// Tells the environment, class by class and of so many nodes at once that the lists take little memory.
pub(super) fn tell(environment: &mut impl Environment, told: &[f32], mut changes: Vec<(usize, Change)>) {
    for (class, &shade) in told.iter().enumerate() {
        let mut now = Change::default();
        let mut update = |now: &mut Change, least: usize| {
            if now.appeared.len() + now.fallen.len() >= least {
                environment.update_shaded(shade, &now.appeared, &now.fallen);
                now.appeared.clear();
                now.fallen.clear();
            }
        };
        for (_, change) in changes.iter_mut().filter(|(of, _)| *of == class) {
            now.appeared.extend(std::mem::take(&mut change.appeared));
            now.fallen.extend(std::mem::take(&mut change.fallen));
            update(&mut now, TOLD);
        }
        update(&mut now, 1);
        // Nodes that have moved may have appeared in this very turn, so the environment knows of them by now.
        for (_, change) in changes.iter_mut().filter(|(of, _)| *of == class) {
            let (from, to): (Vec<_>, Vec<_>) = std::mem::take(&mut change.moved).into_iter().unzip();
            if !from.is_empty() {
                environment.update_moved(shade, &from, &to);
            }
            // Classes come in pairs, the dead of a species after its living.
            if !change.died.is_empty() {
                environment.update_shaded(shade, &[], &change.died);
                environment.update_shaded(told[class + 1], &change.died, &[]);
            }
        }
    }
}

fn check_limits(
    season: u16,
    trees: &[&mut Tree],
    plans: &[Plan],
    standing: u64,
    limit: usize,
) -> Result<(), ForestError> {
    let metamers = plans.iter().fold(standing, |sum, plan| sum.saturating_add(plan.metamers));
    if metamers > limit as u64 {
        return Err(ForestError::Limit { season, metamers, limit });
    }
    let numbers = trees.iter().zip(plans).map(|(tree, plan)| u64::from(tree.next_number) + plan.metamers);
    if numbers.max() > Some(u64::from(u32::MAX)) {
        return Err(ForestError::Numbers { what: "the nodes of a tree", most: u32::MAX });
    }
    Ok(())
}
