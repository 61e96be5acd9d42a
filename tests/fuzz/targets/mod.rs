//! What is run on bytes of any kind: readers of files, and builders whose options the bytes are. None may panic, hang or
//! take memory that the bytes do not call for; what comes out must be sound.

mod example;
mod files;
mod landscape;
mod numbers;
mod options;
mod pipelines;
mod saved;
mod stand;

pub(crate) struct Target {
    pub(crate) name: &'static str,
    /// Sound files, to be bent.
    pub(crate) seeds: Vec<Vec<u8>>,
    /// Says whether the bytes were taken.
    pub(crate) run: fn(&[u8]) -> bool,
}

pub(crate) fn all() -> Vec<Target> {
    let mut all = files::all();
    all.extend(saved::all());
    all.extend(options::all());
    all.extend(pipelines::all());
    all.extend(example::all());
    all.extend(landscape::all());
    all.extend(stand::all());
    all
}
