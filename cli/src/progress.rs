//! Progress on a terminal, and nothing on a pipe.

use indicatif::{ProgressBar, ProgressStyle};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use treesynth::{Observer, Progress, Work};

/// A bar for work whose progress is known, a spinner for work whose is not.
pub(crate) struct Bar {
    bar: ProgressBar,
    start: Instant,
}

impl Bar {
    pub(crate) fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        bar.enable_steady_tick(Duration::from_millis(120));
        Self { bar, start: Instant::now() }
    }

    /// Begins work of unknown length.
    pub(crate) fn step(&self, name: impl Into<String>) {
        self.bar.unset_length();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_msg} {elapsed_precise}") {
            self.bar.set_style(style);
        }
        self.bar.set_message(name.into());
    }

    /// Begins work of so many parts.
    pub(crate) fn parts(&self, name: impl Into<String>, count: u64) {
        if let Ok(style) =
            ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3}% {elapsed_precise}")
        {
            self.bar.set_style(style.progress_chars("=> "));
        }
        self.bar.set_length(count.max(1));
        self.bar.set_position(0);
        self.bar.set_message(name.into());
    }

    /// Sets the number of parts that are done.
    pub(crate) fn done(&self, parts: u64) {
        self.bar.set_position(parts);
    }

    pub(crate) fn message(&self, text: impl Into<String>) {
        self.bar.set_message(text.into());
    }

    /// Takes the bar away; milliseconds since it came.
    pub(crate) fn finish(self) -> f64 {
        self.bar.finish_and_clear();
        self.start.elapsed().as_secs_f64() * 1e3
    }
}

/// Shows the progress of a guided or variational tree; before it, `parts` of 1000.
impl Observer for Bar {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        // Shares of the whole as they are on a graph of typical size.
        let (from, to) = match progress.work {
            Work::Nodes => (0.0, 0.45),
            Work::Edges => (0.45, 0.7),
            Work::Stage { index, of } => {
                let part = |i: usize| 0.7 + 0.29 * i as f32 / of as f32;
                (part(index), part(index + 1))
            }
            Work::Radii => (0.99, 1.0),
            _ => (0.0, 1.0),
        };
        self.bar.set_position(((from + (to - from) * progress.fraction) * 1000.0) as u64);
        ControlFlow::Continue(())
    }
}
