//! Tables of text with a header: fields between commas, semicolons, tabs or blanks.

use std::io::BufRead;

use super::FormatError;
use crate::text::{Lines, number, quoted, stranger, words};

/// A finite number.
pub(super) fn finite(format: &'static str, line: u64, column: &str, word: &[u8]) -> Result<f64, FormatError> {
    number(word).filter(|value| value.is_finite()).ok_or_else(|| {
        FormatError::line(
            format,
            line,
            column,
            format!("{} stands there, but must be a finite number", quoted(word)),
        )
    })
}

/// A whole number, perhaps written as a fraction.
pub(super) fn whole(format: &'static str, line: u64, column: &str, word: &[u8]) -> Result<i64, FormatError> {
    whole_of(word).ok_or_else(|| {
        FormatError::line(
            format,
            line,
            column,
            format!("{} stands there, but must be a whole number", quoted(word)),
        )
    })
}

pub(super) fn whole_of(word: &[u8]) -> Option<i64> {
    let plain = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    let exact = |value: &f64| value.abs() < 9_007_199_254_740_992.0 && value.fract() == 0.0;
    plain.or_else(|| number(word).filter(exact).map(|value| value as i64))
}

/// Separator between fields.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Delimiter {
    Byte(u8),
    Blanks,
}

/// A table, row by row.
pub(super) struct Table<R> {
    format: &'static str,
    lines: Lines<R>,
    delimiter: Delimiter,
    /// The names of the columns as they stand in the file.
    names: Vec<String>,
    fields: Vec<Vec<u8>>,
}

impl<R: BufRead> Table<R> {
    /// Reads the header. `wide` are names, as [`plain`] has them, that stand for several columns.
    pub(super) fn new(
        format: &'static str,
        reader: R,
        wide: &[(&str, [&str; 3])],
    ) -> Result<Self, FormatError> {
        let mut lines = Lines::new(reader);
        while lines.read()? {
            if let Some(what) = stranger(lines.line()).filter(|_| lines.number() == 1) {
                return Err(FormatError::line(format, 1, "", what));
            }
            if !is_passed_over(lines.line()) {
                break;
            }
        }
        let line = lines.line();
        let count = |byte: u8| line.split(|&other| other == byte).count() - 1;
        let most = [b',', b';', b'\t'].into_iter().max_by_key(|&byte| count(byte)).unwrap_or(b',');
        let delimiter = if count(most) > 0 { Delimiter::Byte(most) } else { Delimiter::Blanks };
        let mut names = Vec::new();
        for field in split(line, delimiter) {
            let name: String = String::from_utf8_lossy(&field).trim().chars().take(80).collect();
            match wide.iter().find(|(wide, _)| *wide == plain(&name)) {
                Some((_, columns)) => names.extend(columns.iter().map(ToString::to_string)),
                None => names.push(name),
            }
        }
        if names.is_empty() {
            return Err(FormatError::file(
                format,
                "the file is empty, but must begin with the columns' names",
            ));
        }
        Ok(Self { format, lines, delimiter, names, fields: Vec::new() })
    }

    /// The first column of one of these names, as [`plain`] has them.
    pub(super) fn column(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| self.names.iter().position(|column| plain(column) == *name))
    }

    /// The columns that there are, for errors.
    pub(super) fn listed(&self) -> String {
        let mut names: Vec<&str> = self.names.iter().take(24).map(String::as_str).collect();
        if self.names.len() > 24 {
            names.push("others");
        }
        names.join(", ")
    }

    pub(super) fn name(&self, column: usize) -> &str {
        &self.names[column]
    }

    /// The next row that is not blank; false at the end.
    pub(super) fn read(&mut self) -> Result<bool, FormatError> {
        while self.lines.read()? {
            if is_passed_over(self.lines.line()) {
                continue;
            }
            self.fields = split(self.lines.line(), self.delimiter);
            let (fields, names) = (self.fields.len(), self.names.len());
            if fields == names + 1 && self.fields[names].is_empty() {
                // A delimiter at the end of the row.
                self.fields.pop();
            } else if fields == names + 1 && !self.fields[0].is_empty() {
                // R names rows, and has no name for that column.
                self.fields.remove(0);
            } else if fields < names {
                let problem = format!("the row has {fields} fields, but the header has {names}");
                return Err(FormatError::line(self.format, self.lines.number(), "", problem));
            }
            return Ok(true);
        }
        Ok(false)
    }

    pub(super) fn line(&self) -> u64 {
        self.lines.number()
    }

    pub(super) fn field(&self, column: usize) -> &[u8] {
        &self.fields[column]
    }

    /// A finite number; a comma may stand for the point where it does not stand between fields.
    pub(super) fn finite(&self, column: usize) -> Result<f64, FormatError> {
        let word = self.field(column);
        if self.delimiter != Delimiter::Byte(b',') && word.contains(&b',') {
            let word: Vec<u8> = word.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect();
            return finite(self.format, self.line(), &self.names[column], &word);
        }
        finite(self.format, self.line(), &self.names[column], word)
    }

    pub(super) fn whole(&self, column: usize) -> Result<i64, FormatError> {
        whole(self.format, self.line(), &self.names[column], self.field(column))
    }

    pub(super) fn fault(&self, column: usize, problem: impl Into<String>) -> FormatError {
        FormatError::line(self.format, self.line(), &*self.names[column], problem)
    }
}

/// A column's name in small letters, without points, blanks, lines and brackets.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

fn is_passed_over(line: &[u8]) -> bool {
    let text = line.trim_ascii_start();
    text.is_empty() || text[0] == b'#'
}

/// The fields of a line, without the quotes around them.
fn split(line: &[u8], delimiter: Delimiter) -> Vec<Vec<u8>> {
    let Delimiter::Byte(delimiter) = delimiter else {
        return words(line).map(|word| word.trim_ascii().to_vec()).collect();
    };
    let mut fields = Vec::new();
    let (mut field, mut quoted) = (Vec::new(), false);
    for &byte in line {
        match byte {
            b'"' => quoted = !quoted,
            _ if byte == delimiter && !quoted => fields.push(std::mem::take(&mut field)),
            _ => field.push(byte),
        }
    }
    fields.push(field);
    for field in &mut fields {
        *field = field.trim_ascii().to_vec();
    }
    fields
}
