//! Numbers of options, each in its range.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Reads a number in a range; clap names the option and the text before what must be.
pub(crate) fn number<T>(
    range: RangeInclusive<T>,
    unit: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            format!("must be {} to {}{unit}", range.start(), range.end())
        })
    }
}

/// A count of triangles, or `none`.
pub(crate) fn budget(text: &str) -> Result<Budget, String> {
    if text == "none" {
        return Ok(Budget(None));
    }
    let number = text.parse().ok().filter(|triangles| (100..=100_000_000).contains(triangles));
    number
        .map(|triangles| Budget(Some(triangles)))
        .ok_or_else(|| "must be 100 to 100000000 triangles, or none for the dense model".to_owned())
}

/// The side of images, or `none`.
pub(crate) fn side(text: &str) -> Result<Side, String> {
    if text == "none" {
        return Ok(Side(None));
    }
    let fits = |side: &u32| side.is_power_of_two() && (128..=8192).contains(side);
    let number = text.parse().ok().filter(fits);
    number
        .map(|side| Side(Some(side)))
        .ok_or_else(|| "must be a power of two, 128 to 8192 pixels, or none".to_owned())
}

/// Triangles of the finest level; the dense model without.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Budget(pub(crate) Option<usize>);

/// Side of the images, pixels; no images without.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side(pub(crate) Option<u32>);

/// The name of files, without folder and ending.
pub(crate) fn name(text: &str) -> Result<String, String> {
    let plain = !text.is_empty()
        && text.len() <= 200
        && !text.starts_with('.')
        && !text.chars().any(|c| c.is_control() || "/\\:*?\"<>|".contains(c));
    if plain {
        Ok(text.to_owned())
    } else {
        Err("must be a file's name, without folder and ending".to_owned())
    }
}

/// A text that may not be empty.
pub(crate) fn text(text: &str) -> Result<String, String> {
    if text.is_empty() { Err("must not be empty".to_owned()) } else { Ok(text.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_told_their_range() {
        let height = number(0.01_f32..=1000.0, "m");
        assert_eq!(height("5"), Ok(5.0));
        for wrong in ["", "-1", "0", "NaN", "inf", "1001", "5m", "1e9"] {
            assert_eq!(height(wrong), Err("must be 0.01 to 1000 m".to_owned()), "{wrong}");
        }
        for (text, is) in
            [("none", Some(None)), ("100", Some(Some(100))), ("99", None), ("-5", None), ("1e9", None)]
        {
            assert_eq!(budget(text).ok().map(|budget| budget.0), is, "{text}");
        }
        for (text, is) in
            [("none", Some(None)), ("512", Some(Some(512))), ("500", None), ("64", None), ("16384", None)]
        {
            assert_eq!(side(text).ok().map(|side| side.0), is, "{text}");
        }
        for (text, is) in [("oak", true), ("", false), ("../oak", false), ("a/b", false), (".oak", false)] {
            assert_eq!(name(text).is_ok(), is, "{text}");
        }
    }
}
