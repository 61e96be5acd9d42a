//! Parts that the example programs share: files that are whole or not there, options that are named
//! when they are wrong.
#![allow(dead_code, unused_imports, reason = "each program uses a part")]

#[path = "../../cli/src/files.rs"]
mod files;
mod options;

pub(crate) use files::Outputs;
pub(crate) use options::{Failure, number, print, text};

/// Runs a program; an error is printed, and the exit status says so.
pub(crate) fn run(program: impl FnOnce() -> Result<(), Failure>) {
    // Ctrl-C and termination leave the old files as they were, and no new ones.
    let handled = ctrlc::set_handler(|| {
        files::abandon();
        std::process::exit(130);
    });
    let done = handled.map_err(Into::into).and_then(|()| program());
    if let Err(error) = done {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}
