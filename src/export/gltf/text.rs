//! JSON as text.

use std::fmt::Write as _;

pub(super) fn push(text: &mut String, more: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = text.write_fmt(more);
}

/// The items' texts with commas between them.
pub(in crate::export) fn list<T>(
    items: impl IntoIterator<Item = T>,
    text: impl FnMut(T) -> String,
) -> String {
    items.into_iter().map(text).collect::<Vec<_>>().join(",")
}

/// `"key":[items],`, or nothing if there are none.
pub(super) fn entry<T>(
    key: &str,
    items: impl IntoIterator<Item = T>,
    text: impl FnMut(T) -> String,
) -> String {
    let items = list(items, text);
    if items.is_empty() { items } else { format!(r#""{key}":[{items}],"#) }
}

/// As doubles: their shortest text reads back as the same value in either precision.
pub(in crate::export) fn numbers(floats: &[f32]) -> String {
    let mut text = String::from("[");
    for (i, float) in floats.iter().enumerate() {
        push(&mut text, format_args!("{}{}", if i > 0 { "," } else { "" }, f64::from(*float)));
    }
    text + "]"
}

/// `text` as a JSON string, quotes included.
pub(in crate::export) fn escaped(text: &str) -> String {
    let mut out = String::from('"');
    for char in text.chars() {
        match char {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            control if control < ' ' => push(&mut out, format_args!("\\u{:04x}", control as u32)),
            other => out.push(other),
        }
    }
    out.push('"');
    out
}
