//! Text on standard output.

use crate::Failure;
use crate::arguments::Common;
use serde_json::Value;
use std::io::Write;

/// Prints a text, so far as anybody reads it: `treesynth list | head` closes the pipe.
pub(crate) fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let end = if text.ends_with('\n') { "" } else { "\n" };
    drop(write!(out, "{text}{end}").and_then(|()| out.flush()));
}

/// Prints a value as JSON, or the text of it.
pub(crate) fn tell(common: &Common, value: &Value, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if common.json {
        print(&serde_json::to_string_pretty(value)?);
    } else {
        print(&text());
    }
    Ok(())
}
