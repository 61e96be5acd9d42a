//! Watching long work, and stopping it.

use std::ops::ControlFlow;

/// Told how far the work is; may stop it.
///
/// Any `Fn(Progress) -> ControlFlow<()> + Sync` is one. Calls come from the thread that started the work, a few
/// hundred a second at the most.
///
/// Contract: return quickly, for the work waits. After `Break` the work ends with its error `Cancelled`, and
/// what it was given can be used again: a graph is unchanged, a search has its tree of before the stage.
///
/// ```
/// use std::{ops::ControlFlow, sync::Mutex};
/// use treesynth::{Progress, presets};
///
/// let last = Mutex::new(0.0);
/// let watch = |progress: Progress| {
///     *last.lock().unwrap() = progress.fraction;
///     ControlFlow::Continue(())
/// };
/// presets::by_name("figure-05-left").unwrap().guided().unwrap().synth(2_000).synthesize_observed(7, &watch)?;
/// assert_eq!(*last.lock().unwrap(), 1.0);
/// # Ok::<(), treesynth::SynthesisError>(())
/// ```
pub trait Observer: Sync {
    /// Work has come to `progress`. `Break` cancels it.
    fn report(&self, progress: Progress) -> ControlFlow<()>;
}

/// Progress of some work.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Work in progress.
    pub work: Work,
    /// How much of that is done, in [0, 1]. Each kind of work ends with exactly 1.
    pub fraction: f32,
}

/// The kinds of work that are reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Work {
    /// The nodes of a graph are being placed.
    Nodes,
    /// The edges of a graph are being found.
    Edges,
    /// Paths are being searched.
    Stage {
        /// The stage, from 0.
        index: usize,
        /// The number of stages.
        of: usize,
    },
    /// A season of a forest.
    Season {
        /// The season, from 0, of those that were asked for.
        index: u32,
        /// The number of seasons asked for.
        of: u32,
    },
    /// The radii are being worked out.
    Radii,
    /// Branches are being optimized to fill a shape.
    Optimization,
    /// A picture is being drawn by casting rays.
    Picture,
}

impl<F: Fn(Progress) -> ControlFlow<()> + Sync> Observer for F {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        self(progress)
    }
}

/// Watches nothing and never stops anything.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn report(&self, _: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The observer broke off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cancelled;

/// Reports, and turns a `Break` into an error for `?`.
pub(crate) fn report(observer: &dyn Observer, work: Work, fraction: f32) -> Result<(), Cancelled> {
    match observer.report(Progress { work, fraction }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Cancelled),
    }
}
