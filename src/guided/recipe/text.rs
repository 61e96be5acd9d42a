//! Recipes as JSON text.

use super::Recipe;
use crate::parameter::ParameterError;

/// Error of reading a recipe from text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RecipeError {
    /// No JSON, an unknown field or strategy, one that is missing, a value of the wrong kind.
    #[error("line {line}: {field}: {reason}")]
    Text {
        /// The line, from 1.
        line: usize,
        /// The field, as `stages[1].rule.bend.angle`; `recipe` for the whole.
        field: String,
        /// Fault found, and what would be right.
        reason: String,
    },
    /// A value out of its range, as the strategy itself says it.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl Recipe {
    /// A recipe from its JSON text. Its parameters are in range: they have been checked.
    ///
    /// ```
    /// use treesynth::{guided::Recipe, presets};
    ///
    /// let recipe = presets::by_name("figure-07")?.guided()?.recipe(5_000);
    /// let text = recipe.to_json()?;
    /// assert_eq!(Recipe::from_json(&text)?, recipe);
    /// let error = Recipe::from_json(&text.replace("\"outermost\"", "\"outmost\"")).unwrap_err();
    /// assert!(error.to_string().contains("stages[1].endpoints.hop_surface.surface.outmost: unknown field"), "{error}");
    /// let error = Recipe::from_json(&text.replace("0.6", "1.6")).unwrap_err();
    /// assert_eq!(error.to_string(), "HopSurface.outermost is 1.6, but must be in (0, 1] (stage 1)");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Text that is no recipe, with line and field; parameters out of range, with what
    /// [`TreeSynth::check`](crate::TreeSynth::check) says.
    pub fn from_json(text: &str) -> Result<Self, RecipeError> {
        let recipe: Self = serde_json::from_str(text).map_err(|error| {
            let reason = error.to_string();
            let place = format!(" at line {} column {}", error.line(), error.column());
            RecipeError::Text {
                line: error.line().max(1),
                field: field_at(text, error.line(), error.column()),
                reason: reason.strip_suffix(&place).unwrap_or(&reason).to_owned(),
            }
        })?;
        recipe.check()?;
        Ok(recipe)
    }

    /// The JSON text, every parameter on a line of its own. [`from_json`](Self::from_json) reads an equal recipe from it.
    ///
    /// # Errors
    /// A parameter out of range: what is saved can be read.
    pub fn to_json(&self) -> Result<String, RecipeError> {
        self.check()?;
        serde_json::to_string_pretty(self).map_err(|error| RecipeError::Text {
            line: 1,
            field: "recipe".to_owned(),
            reason: error.to_string(),
        })
    }
}

/// An object with the field that is being read, or an array with the number of its element.
enum Level {
    Object(String),
    Array(usize),
}

/// The path of what is read at a place of a JSON text: line and column as serde tells them, bytes from 1.
fn field_at(text: &str, line: usize, column: usize) -> String {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let mut levels: Vec<Level> = Vec::new();
    let (mut is_key, mut string) = (false, None::<String>);
    let mut escaped = false;
    let until = start + column;
    for c in text.char_indices().take_while(|&(at, _)| at < until).map(|(_, c)| c) {
        if let Some(word) = &mut string {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => {
                    let word = std::mem::take(word);
                    string = None;
                    if let (true, Some(Level::Object(key))) = (is_key, levels.last_mut()) {
                        *key = word;
                    }
                }
                _ => word.push(c),
            }
            continue;
        }
        match c {
            '"' => string = Some(String::new()),
            '{' => {
                levels.push(Level::Object(String::new()));
                is_key = true;
            }
            '[' => levels.push(Level::Array(0)),
            '}' | ']' => {
                levels.pop();
            }
            ':' => is_key = false,
            ',' => match levels.last_mut() {
                Some(Level::Array(number)) => *number += 1,
                _ => is_key = true,
            },
            _ => {}
        }
    }
    let mut path = String::new();
    for level in levels {
        match level {
            Level::Array(number) => path = format!("{path}[{number}]"),
            Level::Object(key) if key.is_empty() => {}
            Level::Object(key) if path.is_empty() => path = key,
            Level::Object(key) => path = format!("{path}.{key}"),
        }
    }
    if path.is_empty() { "recipe".to_owned() } else { path }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_told_by_their_place() {
        let text = "{\n \"a\": [1, {\"b\\\"c\": 2}],\n \"d\": {\"e\": [[], [3, 4]]}\n}";
        let at = |needle: &str| {
            let offset = text.find(needle).unwrap();
            let line = text[..offset].matches('\n').count() + 1;
            let column = offset - text[..offset].rfind('\n').map_or(0, |at| at + 1) + 1;
            field_at(text, line, column)
        };
        assert_eq!(at("1,"), "a[0]");
        assert_eq!(at("2}"), "a[1].bc");
        assert_eq!(at("4]"), "d.e[1][1]");
        assert_eq!(field_at(text, 4, 1), "recipe");
        assert_eq!(field_at("", 0, 0), "recipe");
        assert_eq!(field_at("{\"ä\": ", 9, 9), "ä", "a place that is none, and no panic");
    }
}
