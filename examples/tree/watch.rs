//! A progress bar that also keeps the time of each step.

use indicatif::{ProgressBar, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::{Duration, Instant};
use treesynth::{Observer, Progress, Work};

/// Steps of work, in order, and how long they took.
pub(crate) type Steps = Vec<(String, Duration)>;

pub(crate) struct Watch {
    bar: ProgressBar,
    state: Mutex<(Instant, Steps)>,
}

impl Watch {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(1000);
        if let Ok(style) =
            ProgressStyle::with_template("{msg:>14} [{bar:40}] {percent:>3}% {elapsed_precise}")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, state: Mutex::new((Instant::now(), Vec::new())) }
    }

    pub(crate) fn finish(self) -> Steps {
        self.bar.finish_and_clear();
        self.state.into_inner().map(|(_, steps)| steps).unwrap_or_default()
    }
}

impl Observer for Watch {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        // Shares of the whole as they are on a graph of typical size.
        let (name, from, to) = match progress.work {
            Work::Nodes => ("nodes".into(), 0.0, 0.45),
            Work::Edges => ("edges".into(), 0.45, 0.7),
            Work::Stage { index, of } => {
                let part = |i: usize| 0.7 + 0.29 * i as f32 / of as f32;
                (format!("stage {}", index + 1), part(index), part(index + 1))
            }
            _ => ("radii".into(), 0.99, 1.0),
        };
        self.bar.set_position(((from + (to - from) * progress.fraction) * 1000.0) as u64);
        self.bar.set_message(name.clone());
        if progress.fraction >= 1.0
            && let Ok(mut state) = self.state.lock()
        {
            let (since, steps) = &mut *state;
            // A stage that refines places nodes and edges again.
            match steps.iter_mut().find(|(step, _)| *step == name) {
                Some((_, time)) => *time += since.elapsed(),
                None => steps.push((name, since.elapsed())),
            }
            *since = Instant::now();
        }
        ControlFlow::Continue(())
    }
}
