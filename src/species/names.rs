//! Finding species by name.

use super::data::Species;
use std::sync::OnceLock;

/// There is no species of this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no species {name:?}; near names: {}", near.join(", "))]
#[non_exhaustive]
pub struct UnknownSpecies {
    /// The name asked for.
    pub name: String,
    /// The nearest names there are, nearest first.
    pub near: Vec<String>,
}

macro_rules! texts {
    ($($file:literal),* $(,)?) => { &[$(($file, include_str!(concat!("data/", $file, ".toml")))),*] };
}

/// The text of each species built in.
pub(super) const TEXTS: &[(&str, &str)] = texts![
    "english_oak",
    "scots_pine",
    "norway_spruce",
    "silver_birch",
    "beech",
    "norway_maple",
    "sycamore",
    "ash",
    "small_leaved_lime",
    "douglas_fir",
    "horse_chestnut",
    "london_plane",
    "weeping_willow",
    "lombardy_poplar",
    "cottonwood",
    "wild_cherry",
    "american_elm",
    "apple",
    "walnut",
    "eucalyptus",
    "umbrella_thorn",
    "coconut_palm",
    "italian_cypress",
    "hazel",
    "orchard_apple",
];

/// All species built in, in a fixed order.
pub fn all() -> &'static [Species] {
    static ALL: OnceLock<Vec<Species>> = OnceLock::new();
    // Every text built in is read by a test; one that were wrong would be left out.
    ALL.get_or_init(|| TEXTS.iter().filter_map(|(_, text)| Species::parse(text).ok()).collect())
}

/// The species of this English or Latin name, or one of its other names; upper and lower case are one, and so are
/// blanks, hyphens and underscores.
///
/// ```
/// use treesynth::species;
///
/// assert_eq!(species::by_name("Betula pendula")?.name, "silver birch");
/// let error = species::by_name("silver brich").unwrap_err();
/// assert_eq!(error.near[0], "silver birch");
/// # Ok::<(), species::UnknownSpecies>(())
/// ```
///
/// # Errors
/// No species of that name; the error lists near ones.
#[doc(alias(
    "acacia",
    "apple",
    "ash",
    "beech",
    "birch",
    "cherry",
    "chestnut",
    "cypress",
    "elm",
    "eucalyptus",
    "fir",
    "hazel",
    "linden",
    "maple",
    "oak",
    "palm",
    "pine",
    "poplar",
    "spruce",
    "sycamore",
    "walnut",
    "willow"
))]
pub fn by_name(name: &str) -> Result<&'static Species, UnknownSpecies> {
    let wanted = plain(name);
    let found = all().iter().find(|species| names(species).any(|known| plain(known) == wanted));
    found.ok_or_else(|| {
        let known = all().iter().flat_map(names);
        UnknownSpecies { name: name.to_owned(), near: nearest(name, known, 4) }
    })
}

/// Every name of a species.
pub(crate) fn names(species: &Species) -> impl Iterator<Item = &str> {
    let others = species.aliases.split(',').map(str::trim).filter(|name| !name.is_empty());
    [species.name.as_str(), species.latin.as_str()].into_iter().chain(others)
}

/// A name as it is compared: lower case, words with one blank between them.
pub(crate) fn plain(name: &str) -> String {
    let words =
        name.split(|c: char| c.is_whitespace() || c == '-' || c == '_').filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join(" ")
}

/// Those with the fewest changes to `name`, nearest first, each once.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>, count: usize) -> Vec<String> {
    let wanted = plain(name);
    let mut near: Vec<(usize, &str)> = known
        .map(|known| {
            let candidate = plain(known);
            let part = !wanted.is_empty() && candidate.contains(&wanted);
            (if part { 0 } else { changes(&wanted, &candidate) }, known)
        })
        .collect();
    near.sort_by_key(|(changes, _)| *changes);
    near.dedup_by_key(|(_, known)| *known);
    near.into_iter().take(count).map(|(_, known)| known.to_owned()).collect()
}

/// Levenshtein's distance; names longer than 100 letters are cut.
fn changes(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(100).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().take(100).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &cb) in b.iter().enumerate() {
            let kept = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = kept.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
