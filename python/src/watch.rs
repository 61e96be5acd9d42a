//! Long work beside Python: without its lock, with progress, and stopped by Ctrl-C.

use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;
use treesynth::{Observer, Progress, Work};

/// From one look at signals, and one call of `progress`, to the next.
const PAUSE: Duration = Duration::from_millis(50);

/// The latest progress, and whether the work is to stop.
struct Watch {
    latest: Mutex<Option<Progress>>,
    is_stopped: AtomicBool,
}

impl Observer for Watch {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
        if self.is_stopped.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Does `work` on another thread while this one looks after signals and calls `progress(what, fraction)`. What either
/// raises stops the work and is the result.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&dyn Observer) -> PyResult<T> + Send,
) -> PyResult<T> {
    let watch = Watch { latest: Mutex::new(None), is_stopped: AtomicBool::new(false) };
    let raised = Mutex::new(None);
    let result = py.detach(|| {
        thread::scope(|scope| {
            let (done, end) = mpsc::channel();
            let watch = &watch;
            let worker = scope.spawn(move || {
                let result = work(watch);
                let _ = done.send(());
                result
            });
            while end.recv_timeout(PAUSE) == Err(mpsc::RecvTimeoutError::Timeout) {
                if watch.is_stopped.load(Ordering::Relaxed) {
                    continue;
                }
                if let Err(error) = Python::attach(|py| tell(py, watch, progress.as_ref())) {
                    *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    watch.is_stopped.store(true, Ordering::Relaxed);
                }
            }
            worker.join()
        })
    });
    if let Some(error) = raised.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let result = result.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
    tell(py, &watch, progress.as_ref())?;
    Ok(result)
}

fn tell(py: Python<'_>, watch: &Watch, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    py.check_signals()?;
    let latest = watch.latest.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let (Some(progress), Some(latest)) = (progress, latest) {
        progress.call1(py, (name(latest.work), latest.fraction))?;
    }
    Ok(())
}

/// A kind of work in words.
fn name(work: Work) -> String {
    match work {
        Work::Nodes => "nodes".into(),
        Work::Edges => "edges".into(),
        Work::Stage { index, of } => format!("stage {} of {of}", index + 1),
        Work::Season { index, of } => format!("season {} of {of}", index + 1),
        Work::Radii => "radii".into(),
        Work::Optimization => "optimization".into(),
        Work::Picture => "picture".into(),
        Work::Surface => "surface".into(),
        Work::Leaves => "leaves".into(),
        Work::Years => "years".into(),
        Work::Age => "age".into(),
        Work::Asset => "asset".into(),
        Work::File => "file".into(),
        _ => "work".into(),
    }
}
