//! Watching long work, and stopping it.

use std::ops::{ControlFlow, Range};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Told how far the work is; may stop it.
///
/// Any `Fn(Progress) -> ControlFlow<()> + Sync` is one. Calls come one after another, from the thread that started the work
/// or from one that works for it, up to some thousand a second.
///
/// Contract: return quickly, for the work waits. After `Break` no other call comes and the work ends with its error `Cancelled`;
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
    /// Fraction of that work that is done, in [0, 1]. Each kind of work ends with exactly 1.
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
        /// The season's number among those requested, from 0.
        index: u32,
        /// The number of seasons requested.
        of: u32,
    },
    /// The radii are being worked out.
    Radii,
    /// Branches are being optimized to fill a shape.
    Optimization,
    /// A picture is being drawn by casting rays.
    Picture,
    /// A surface is being made, or several levels of one.
    Surface,
    /// Leaves are being placed.
    Leaves,
    /// The years of a tree are being worked out.
    Years,
    /// A tree at an age is being laid out.
    Age,
    /// Bark, leaves and cards are being made to keep a budget.
    Asset,
    /// A file is being written.
    File,
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled by the observer")]
pub(crate) struct Cancelled;

/// Reports, and turns a `Break` into an error for `?`.
pub(crate) fn report(observer: &dyn Observer, work: Work, fraction: f32) -> Result<(), Cancelled> {
    match observer.report(Progress { work, fraction }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Cancelled),
    }
}

/// Counts the steps of some work, whatever thread takes them, reports now and then, and remembers a `Break`.
pub(crate) struct Watch<'a> {
    observer: &'a dyn Observer,
    work: Work,
    /// Fractions of the work at the first and the last step.
    part: Range<f32>,
    /// Number of steps, or an estimate.
    of: usize,
    /// Steps from one report to the next.
    every: usize,
    done: AtomicUsize,
    next: AtomicUsize,
    is_cancelled: AtomicBool,
    /// Held by the thread that reports.
    reporting: Mutex<()>,
}

impl<'a> Watch<'a> {
    /// Watches the whole of some work, which takes about `of` steps.
    pub(crate) fn new(observer: &'a dyn Observer, work: Work, of: usize, every: usize) -> Self {
        Self::part(observer, work, 0.0..1.0, of, every)
    }

    /// A watch without an observer.
    pub(crate) fn silent() -> Watch<'static> {
        Watch::new(&Silent, Work::Surface, 1, usize::MAX)
    }

    /// Watches a part of some work.
    pub(crate) fn part(
        observer: &'a dyn Observer,
        work: Work,
        part: Range<f32>,
        of: usize,
        every: usize,
    ) -> Self {
        Self {
            observer,
            work,
            part,
            of,
            every,
            done: AtomicUsize::new(0),
            next: AtomicUsize::new(every),
            is_cancelled: AtomicBool::new(false),
            reporting: Mutex::new(()),
        }
    }

    /// Counts steps; says whether to go on.
    pub(crate) fn steps(&self, steps: usize) -> bool {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        if done >= self.next.load(Ordering::Relaxed) {
            self.tell();
        }
        self.goes_on()
    }

    /// `true` as long as nobody has cancelled the work.
    pub(crate) fn goes_on(&self) -> bool {
        !self.is_cancelled.load(Ordering::Relaxed)
    }

    /// [`steps`](Self::steps) for `?`.
    pub(crate) fn pass(&self, steps: usize) -> Result<(), Cancelled> {
        if self.steps(steps) { Ok(()) } else { Err(Cancelled) }
    }

    /// Reports that all is done.
    pub(crate) fn finish(&self) -> Result<(), Cancelled> {
        if self.goes_on() { report(self.observer, self.work, self.part.end) } else { Err(Cancelled) }
    }

    fn tell(&self) {
        // Another thread is just telling.
        let Ok(_only) = self.reporting.try_lock() else { return };
        let done = self.done.load(Ordering::Relaxed);
        if done < self.next.load(Ordering::Relaxed) || !self.goes_on() {
            return;
        }
        self.next.store(done + self.every, Ordering::Relaxed);
        // If there are more steps than estimated, the fraction only comes nearer to the end.
        let (done, of) = (done as f32, self.of.max(1) as f32);
        let share = if done < 0.9 * of { done / of } else { 1.0 - 0.1 * (0.9 * of) / done };
        let fraction = (self.part.start + (self.part.end - self.part.start) * share).min(0.999_9);
        if report(self.observer, self.work, fraction).is_err() {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_grow_to_one_and_a_break_is_the_last() {
        let told = Mutex::new(Vec::new());
        let most = AtomicUsize::new(usize::MAX);
        let observer = |progress: Progress| {
            let mut told = told.lock().expect("nobody panics");
            told.push(progress.fraction);
            if told.len() >= most.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        for of in [1, 50, 1000, 100_000] {
            let watch = Watch::new(&observer, Work::Surface, of, 10);
            assert!((0..1000).all(|_| watch.steps(1)) && watch.finish().is_ok());
            let told = std::mem::take(&mut *told.lock().expect("nobody panics"));
            assert_eq!(told.len(), 101);
            assert!(told.windows(2).all(|pair| pair[0] <= pair[1]) && told[0] > 0.0, "{told:?}");
            assert!(told[100].to_bits() == 1f32.to_bits() && told[99] < 1.0);
        }
        most.store(3, Ordering::Relaxed);
        let watch = Watch::new(&observer, Work::Surface, 1000, 10);
        assert_eq!((0..1000).take_while(|_| watch.steps(1)).count(), 29);
        assert_eq!(watch.finish(), Err(Cancelled));
        assert_eq!(told.lock().expect("nobody panics").len(), 3);
    }
}
