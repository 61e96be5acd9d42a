//! The same map on one thread or, with the feature `parallel`, on rayon's.

/// `f(0), f(1), ..., f(count - 1)`, in that order whatever the threads did.
#[cfg(feature = "parallel")]
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    use rayon::iter::{IntoParallelIterator, ParallelIterator};
    if !is_worth_it(count) {
        return (0..count).map(f).collect();
    }
    (0..count).into_par_iter().map(f).collect()
}

/// `f(0), f(1), ..., f(count - 1)`.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map<T>(count: usize, f: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(f).collect()
}

/// `f(i, item i)` for each item; the results in that order whatever the threads did.
#[cfg(feature = "parallel")]
pub(crate) fn each_mut<I: Send, T: Send>(
    items: &mut [I],
    f: impl Fn(usize, &mut I) -> T + Sync + Send,
) -> Vec<T> {
    use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
    if !is_worth_it(items.len()) {
        return items.iter_mut().enumerate().map(|(i, item)| f(i, item)).collect();
    }
    items.par_iter_mut().enumerate().map(|(i, item)| f(i, item)).collect()
}

/// `f(i, item i)` for each item.
#[cfg(not(feature = "parallel"))]
pub(crate) fn each_mut<I, T>(items: &mut [I], f: impl Fn(usize, &mut I) -> T) -> Vec<T> {
    items.iter_mut().enumerate().map(|(i, item)| f(i, item)).collect()
}

/// Results of both, made at once if there are threads for it.
#[cfg(feature = "parallel")]
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Sum of both.
#[cfg(not(feature = "parallel"))]
pub(crate) fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Handing work to the pool costs some ten microseconds.
#[cfg(feature = "parallel")]
fn is_worth_it(tasks: usize) -> bool {
    tasks > 1 && rayon::current_num_threads() > 1
}

/// Number of tasks into which work of unequal parts is cut, so that all threads have something to
/// do until the end.
#[cfg(feature = "parallel")]
pub(crate) fn tasks() -> usize {
    match rayon::current_num_threads() {
        1 => 1,
        threads => 4 * threads,
    }
}

/// One.
#[cfg(not(feature = "parallel"))]
pub(crate) fn tasks() -> usize {
    1
}
