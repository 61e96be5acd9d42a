//! The text form of a species: a small part of TOML, read and written by one list of fields.

use super::data::Species;
use std::fmt::Write as _;
use std::ops::RangeInclusive;

/// Error of reading a species from text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {field}: {reason}")]
#[non_exhaustive]
pub struct SpeciesTextError {
    /// The line, from 1; the last one for what is missing.
    pub line: usize,
    /// The field, as `section.name`.
    pub field: String,
    /// Fault found, and what would be right.
    pub reason: String,
}

/// A field with few values that have names.
pub(super) trait Choice: Copy + PartialEq + 'static {
    const NAMES: &'static [(&'static str, Self)];
}

/// Goes over all fields of a species, to read or to write them.
pub(super) trait Fields {
    /// Starts a section, to which the next fields belong.
    fn section(&mut self, name: &'static str);
    /// A text.
    fn text(&mut self, name: &'static str, value: &mut String);
    /// Numbers in a range, as many as there are; one alone without brackets.
    fn numbers(&mut self, name: &'static str, values: &mut [f32], range: [f32; 2]);
    /// A list of numbers, as many as `count` allows.
    fn list(
        &mut self,
        name: &'static str,
        values: &mut Vec<f32>,
        range: [f32; 2],
        count: RangeInclusive<usize>,
    );
    /// Yes or no.
    fn flag(&mut self, name: &'static str, value: &mut bool);
    /// One of several names.
    fn choice<T: Choice>(&mut self, name: &'static str, value: &mut T);

    /// Any number of tables of this name up to `most`, each with the fields that `each` goes over.
    fn tables<T: Default>(
        &mut self,
        name: &'static str,
        items: &mut Vec<T>,
        most: usize,
        each: impl Fn(&mut T, &mut Self),
    ) where
        Self: Sized;

    /// Numbers that do not fall from one to the next.
    fn ascending(&mut self, name: &'static str, values: &mut [f32], range: [f32; 2]);

    /// One number.
    fn number(&mut self, name: &'static str, value: &mut f32, range: [f32; 2]) {
        self.numbers(name, std::slice::from_mut(value), range);
    }
}

/// A line `name = value`.
struct Entry<'a> {
    line: usize,
    section: &'a str,
    /// Number among the tables of that name, from 1; 0 in a section.
    table: usize,
    name: &'a str,
    value: &'a str,
    used: bool,
}

/// A line `[section]` or `[[table]]`.
struct Header<'a> {
    line: usize,
    name: &'a str,
    table: usize,
}

struct Reader<'a> {
    entries: Vec<Entry<'a>>,
    headers: Vec<Header<'a>>,
    lines: usize,
    section: &'static str,
    table: usize,
    /// Every section there is, and whether it is a list of tables.
    sections: Vec<(&'static str, bool)>,
    /// Every field there is, for what is said of unknown ones.
    known: Vec<String>,
    error: Option<SpeciesTextError>,
}

fn path(section: &str, name: &str) -> String {
    if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") }
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Result<Self, SpeciesTextError> {
        let (mut entries, mut headers) = (Vec::<Entry<'a>>::new(), Vec::<Header<'a>>::new());
        let (mut section, mut table, mut lines) = ("", 0, 0);
        for (index, raw) in text.lines().enumerate() {
            lines = index + 1;
            let wrong = |field: String, reason: &str| SpeciesTextError {
                line: index + 1,
                field,
                reason: reason.to_owned(),
            };
            let line = without_comment(raw).trim();
            if line.is_empty() {
                continue;
            }
            let inner = |open: &str, close: &str| line.strip_prefix(open)?.strip_suffix(close);
            if let Some(name) = inner("[[", "]]").or_else(|| inner("[", "]")) {
                section = name.trim();
                let before = headers.iter().filter(|header| header.name == section);
                table = if line.starts_with("[[") {
                    before.map(|header| header.table).max().unwrap_or(0) + 1
                } else {
                    0
                };
                if table == 0 && headers.iter().any(|header| header.name == section && header.table == 0) {
                    return Err(wrong(section.to_owned(), "is given twice"));
                }
                headers.push(Header { line: index + 1, name: section, table });
                continue;
            }
            let Some((name, value)) = line.split_once('=') else {
                return Err(wrong(line.to_owned(), "expected `name = value` or `[section]`"));
            };
            let (name, value) = (name.trim(), value.trim());
            let same = |entry: &Entry<'_>| (entry.section, entry.table, entry.name) == (section, table, name);
            if entries.iter().any(same) {
                return Err(wrong(path(section, name), "is given twice"));
            }
            entries.push(Entry { line: index + 1, section, table, name, value, used: false });
        }
        Ok(Self {
            entries,
            headers,
            lines,
            section: "",
            table: 0,
            sections: Vec::new(),
            known: Vec::new(),
            error: None,
        })
    }

    /// Reports faults of the headers: unknown sections, lists that are not written as lists.
    fn check_headers(&mut self) {
        for header in std::mem::take(&mut self.headers) {
            let known = self.sections.iter().find(|(name, _)| *name == header.name);
            let reason = match (known, header.table > 0) {
                (Some((_, true)), false) => format!("is a list: write [[{}]]", header.name),
                (Some((_, false)), true) => format!("is no list: write [{}]", header.name),
                (Some(_), _) => continue,
                (None, _) => {
                    let names = self.sections.iter().map(|(name, _)| *name);
                    let near = super::names::nearest(header.name, names, 1);
                    format!("there is no such section; did you mean {}?", near.join(", "))
                }
            };
            if self.error.as_ref().is_none_or(|error| header.line <= error.line) {
                self.error = Some(SpeciesTextError { line: header.line, field: header.name.into(), reason });
            }
        }
    }

    fn take(&mut self, name: &'static str) -> Option<(usize, &'a str)> {
        self.known.push(path(self.section, name));
        let wanted = (self.section, self.table, name);
        let entry =
            self.entries.iter_mut().find(|entry| (entry.section, entry.table, entry.name) == wanted)?;
        entry.used = true;
        Some((entry.line, entry.value))
    }

    fn fail(&mut self, line: usize, name: &str, reason: String) {
        let field = path(self.section, name);
        // Fields come in their own order; what stands first in the text is told first.
        if self.error.as_ref().is_none_or(|error| line < error.line) {
            self.error = Some(SpeciesTextError { line, field, reason });
        }
    }

    fn parse_list(&mut self, line: usize, name: &str, value: &str, range: [f32; 2]) -> Option<Vec<f32>> {
        let inner = value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(value);
        let mut numbers = Vec::new();
        let inner = inner.trim().trim_end_matches(',');
        for word in inner.split(',').map(str::trim) {
            match word.parse::<f32>() {
                Ok(number) if number >= range[0] && number <= range[1] => numbers.push(number),
                Ok(_) => {
                    self.fail(line, name, format!("is {word}, but must be {} to {}", range[0], range[1]));
                    return None;
                }
                Err(_) => {
                    self.fail(line, name, format!("is {word:?}, but must be a number"));
                    return None;
                }
            }
        }
        Some(numbers)
    }
}

/// The line up to a `#` outside of quotes.
fn without_comment(line: &str) -> &str {
    let mut quoted = false;
    for (at, c) in line.char_indices() {
        match c {
            '"' => quoted = !quoted,
            '#' if !quoted => return &line[..at],
            _ => {}
        }
    }
    line
}

fn unquoted(value: &str) -> Option<&str> {
    let inner = value.strip_prefix('"')?.strip_suffix('"')?;
    (!inner.contains('"')).then_some(inner)
}

impl Fields for Reader<'_> {
    fn section(&mut self, name: &'static str) {
        (self.section, self.table) = (name, 0);
        self.sections.push((name, false));
    }

    fn tables<T: Default>(
        &mut self,
        name: &'static str,
        items: &mut Vec<T>,
        most: usize,
        each: impl Fn(&mut T, &mut Self),
    ) {
        self.section = name;
        self.sections.push((name, true));
        let found = self.headers.iter().filter(|header| header.name == name && header.table > 0);
        let lines: Vec<usize> = found.map(|header| header.line).collect();
        if let Some(line) = lines.get(most) {
            self.section = "";
            self.fail(*line, name, format!("there are {} of them, but at most {most}", lines.len()));
            self.section = name;
        }
        // Without any the fields are gone over too, for what is said of unknown ones.
        self.table = usize::MAX;
        each(&mut T::default(), self);
        let known = self.known.len();
        for number in 1..=lines.len().min(most) {
            self.table = number;
            let mut item = T::default();
            each(&mut item, self);
            self.known.truncate(known);
            items.push(item);
        }
        // Those too many are told as such, not field by field.
        for entry in self.entries.iter_mut().filter(|entry| entry.section == name && entry.table > most) {
            entry.used = true;
        }
    }

    fn ascending(&mut self, name: &'static str, values: &mut [f32], range: [f32; 2]) {
        let line = self.take(name).map(|(line, _)| line);
        self.known.pop();
        self.numbers(name, values, range);
        if let Some(line) = line.filter(|_| values.windows(2).any(|pair| pair[0] > pair[1])) {
            self.fail(line, name, "must be in ascending order".into());
        }
    }

    fn text(&mut self, name: &'static str, value: &mut String) {
        if let Some((line, raw)) = self.take(name) {
            match unquoted(raw) {
                // `to_text` writes a space for a carriage return.
                Some(text) => *value = text.replace('\r', " "),
                None => self.fail(line, name, format!("is {raw}, but must be a text in double quotes")),
            }
        }
    }

    fn numbers(&mut self, name: &'static str, values: &mut [f32], range: [f32; 2]) {
        if let Some((line, raw)) = self.take(name)
            && let Some(numbers) = self.parse_list(line, name, raw, range)
        {
            if numbers.len() == values.len() {
                values.copy_from_slice(&numbers);
            } else {
                let reason = format!("has {} numbers, but must have {}", numbers.len(), values.len());
                self.fail(line, name, reason);
            }
        }
    }

    fn list(
        &mut self,
        name: &'static str,
        values: &mut Vec<f32>,
        range: [f32; 2],
        count: RangeInclusive<usize>,
    ) {
        if let Some((line, raw)) = self.take(name)
            && let Some(numbers) = self.parse_list(line, name, raw, range)
        {
            if count.contains(&numbers.len()) {
                *values = numbers;
            } else {
                let reason = format!(
                    "has {} numbers, but must have {} to {}",
                    numbers.len(),
                    count.start(),
                    count.end()
                );
                self.fail(line, name, reason);
            }
        }
    }

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        if let Some((line, raw)) = self.take(name) {
            match raw {
                "true" => *value = true,
                "false" => *value = false,
                _ => self.fail(line, name, format!("is {raw}, but must be true or false")),
            }
        }
    }

    fn choice<T: Choice>(&mut self, name: &'static str, value: &mut T) {
        if let Some((line, raw)) = self.take(name) {
            if let Some((_, choice)) = T::NAMES.iter().find(|(known, _)| unquoted(raw) == Some(*known)) {
                *value = *choice;
            } else {
                let names: Vec<_> = T::NAMES.iter().map(|(known, _)| format!("\"{known}\"")).collect();
                self.fail(line, name, format!("is {raw}, but must be one of {}", names.join(", ")));
            }
        }
    }
}

struct Writer {
    text: String,
}

impl Writer {
    fn line(&mut self, name: &str, value: std::fmt::Arguments<'_>) {
        // Writing to a String never fails.
        let _ = writeln!(self.text, "{name} = {value}");
    }

    fn bracketed(values: &[f32]) -> String {
        format!("[{}]", values.iter().map(f32::to_string).collect::<Vec<_>>().join(", "))
    }
}

impl Fields for Writer {
    fn section(&mut self, name: &'static str) {
        let _ = writeln!(self.text, "\n[{name}]");
    }

    fn tables<T: Default>(
        &mut self,
        name: &'static str,
        items: &mut Vec<T>,
        _: usize,
        each: impl Fn(&mut T, &mut Self),
    ) {
        for item in items {
            let _ = writeln!(self.text, "\n[[{name}]]");
            each(item, self);
        }
    }

    fn ascending(&mut self, name: &'static str, values: &mut [f32], range: [f32; 2]) {
        self.numbers(name, values, range);
    }

    fn text(&mut self, name: &'static str, value: &mut String) {
        // A quote or a line break has no form here.
        self.line(name, format_args!("\"{}\"", value.replace('"', "'").replace(['\n', '\r'], " ")));
    }

    fn numbers(&mut self, name: &'static str, values: &mut [f32], _: [f32; 2]) {
        match values {
            [one] => self.line(name, format_args!("{one}")),
            _ => self.line(name, format_args!("{}", Self::bracketed(values))),
        }
    }

    fn list(&mut self, name: &'static str, values: &mut Vec<f32>, _: [f32; 2], _: RangeInclusive<usize>) {
        self.line(name, format_args!("{}", Self::bracketed(values)));
    }

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        self.line(name, format_args!("{value}"));
    }

    fn choice<T: Choice>(&mut self, name: &'static str, value: &mut T) {
        let known = T::NAMES.iter().find(|(_, choice)| choice == value).map_or("", |(known, _)| known);
        self.line(name, format_args!("\"{known}\""));
    }
}

impl Species {
    /// Reads a species from its text form: lines `name = value` under `[section]`s, comments after `#`. Fields that are
    /// not given have the default of their part; `name` is needed. The parts document their fields
    /// ([`Size`](super::Size), [`Trunk`](super::Trunk), ...); texts of this form are valid TOML.
    ///
    /// ```
    /// use treesynth::species::Species;
    ///
    /// let mine = Species::parse("name = \"my thorn\"\n[size]\nheight = [1.5, 9]\nusual_diameter = 0.2\n")?;
    /// assert_eq!(mine.size.height, [1.5, 9.0]);
    /// let wrong = Species::parse("name = \"my thorn\"\n[size]\nheigth = [1.5, 9]\n").unwrap_err();
    /// assert_eq!(wrong.to_string(), "line 3: size.heigth: there is no such field; did you mean size.height?");
    /// # Ok::<(), treesynth::species::SpeciesTextError>(())
    /// ```
    ///
    /// # Errors
    /// A line that is none, an unknown field, a field given twice, a value of the wrong kind or out of its range, no name; with line
    /// and field.
    pub fn parse(text: &str) -> Result<Self, SpeciesTextError> {
        let mut reader = Reader::new(text)?;
        let mut species = Self::default();
        species.fields(&mut reader);
        reader.check_headers();
        for entry in reader.entries.iter().filter(|entry| !entry.used) {
            if reader.error.as_ref().is_none_or(|error| entry.line < error.line) {
                let field = path(entry.section, entry.name);
                let near = super::names::nearest(&field, reader.known.iter().map(String::as_str), 1);
                let reason = format!("there is no such field; did you mean {}?", near.join(", "));
                reader.error = Some(SpeciesTextError { line: entry.line, field, reason });
            }
        }
        if let Some(error) = reader.error {
            return Err(error);
        }
        let wrong = |field: &str, reason: &str| {
            let name = field.rsplit('.').next().unwrap_or(field);
            let section = field.strip_suffix(name).unwrap_or("").trim_end_matches('.');
            let given = reader.entries.iter().find(|entry| entry.section == section && entry.name == name);
            Err(SpeciesTextError {
                line: given.map_or(reader.lines.max(1), |entry| entry.line),
                field: field.into(),
                reason: reason.into(),
            })
        };
        if species.name.is_empty() {
            return wrong("name", "is missing or empty");
        }
        let size = &species.size;
        let trunk = &species.trunk;
        let pairs = [
            ("size.height", size.height),
            ("size.diameter", size.diameter),
            ("size.slenderness", size.slenderness),
            ("size.height_at", size.height_at),
            ("size.width_at", size.width_at),
            ("size.leaf_area_at", size.leaf_area_at),
            ("trunk.stems", trunk.stems),
            ("trunk.forks", trunk.forks),
            ("limbs.whorl", species.limbs.whorl),
            ("crown.eccentricity", species.crown.eccentricity),
            ("branches.length", species.branches.length),
            ("twigs.length", species.twigs.length),
        ];
        for (field, [low, high]) in pairs {
            if low > high {
                return wrong(field, &format!("is [{low}, {high}], but the first may not be greater"));
            }
        }
        if size.height_at[0] >= size.height_at[1] {
            return wrong("size.height_at", "must grow from the first to the second");
        }
        if !(size.diameter[0]..=size.diameter[1]).contains(&size.usual_diameter) {
            return wrong("size.usual_diameter", "must lie within size.diameter");
        }
        Ok(species)
    }

    /// Its text form; [`parse`](Self::parse) reads the same species from it, if its texts have no double quotes or line breaks.
    pub fn to_text(&self) -> String {
        let mut writer = Writer { text: String::new() };
        self.clone().fields(&mut writer);
        writer.text
    }
}
