//! Why a run fails.

use std::fmt;

pub(crate) type Failure = Box<dyn std::error::Error>;

/// A command line that asks for something impossible. Nothing was done: exit status 2. All other failures have 1.
#[derive(Debug)]
pub(crate) struct Refused(String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refused {}

/// A failure that is [`Refused`].
pub(crate) fn refused(text: impl fmt::Display) -> Failure {
    Box::new(Refused(text.to_string()))
}
