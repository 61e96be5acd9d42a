//! Values of options.

use lexopt::Parser;
use std::fmt::Display;
use std::io::Write;
use std::ops::RangeInclusive;
use std::str::FromStr;

pub(crate) type Failure = Box<dyn std::error::Error>;

/// The value of an option: a number in a range. An error names the option, what it was and what it may be.
pub(crate) fn number<T: FromStr + PartialOrd + Display>(
    arguments: &mut Parser,
    name: &str,
    range: RangeInclusive<T>,
    unit: &str,
) -> Result<T, Failure> {
    let word = text(arguments, name)?;
    let number = word.parse().ok().filter(|number| range.contains(number));
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let wrong =
        || format!("{name} is {word:?}, but must be {} to {}{unit}", range.start(), range.end()).into();
    number.ok_or_else(wrong)
}

/// The value of an option, which may not be empty.
pub(crate) fn text(arguments: &mut Parser, name: &str) -> Result<String, Failure> {
    let word = arguments.value()?;
    match word.to_str() {
        Some("") => Err(format!("{name} is empty").into()),
        Some(word) => Ok(word.to_owned()),
        None => Err(format!("{name} is \"{}\", but must be UTF-8", word.display()).into()),
    }
}

/// Prints lines, so far as anybody reads them: `--list | head` closes the pipe.
pub(crate) fn print(lines: impl IntoIterator<Item = impl Display>) {
    let mut out = std::io::stdout().lock();
    for line in lines {
        if writeln!(out, "{line}").is_err() {
            return;
        }
    }
}
