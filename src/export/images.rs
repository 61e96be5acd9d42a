//! Images that are stored next to a file, or in an archive with it, under names of their own.

use super::pool::Pool;
use super::worn::{self, Image, Textures};
use crate::surface::Part;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// An image that a file names, to be written next to it.
#[cfg_attr(not(feature = "texture"), allow(dead_code, unreachable_pub, reason = "there are none"))]
#[derive(Debug, Clone)]
pub struct ImageFile<'a> {
    name: String,
    image: Cow<'a, Image>,
}

#[cfg_attr(not(feature = "texture"), allow(unreachable_pub, reason = "there are none"))]
impl ImageFile<'_> {
    /// The name by which the file knows it: letters, digits, `_`, and `.png`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The bytes of a PNG file.
    pub fn png(&self) -> Vec<u8> {
        self.image.png()
    }
}

/// Property of a surface that an image gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Map {
    Color,
    Normal,
    /// Occlusion, roughness and metal.
    Surface,
    /// Roughness alone.
    Roughness,
}

impl Map {
    fn of<'a>(self, part: &Part<'a>) -> Option<&'a Image> {
        let worn = worn::textures(part)?;
        match self {
            Self::Color => worn.base_color(),
            Self::Normal => worn.normal(),
            Self::Surface | Self::Roughness => worn.occlusion_roughness_metallic(),
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Color => "color",
            Self::Normal => "normal",
            Self::Surface => "surface",
            Self::Roughness => "roughness",
        }
    }
}

/// Image of each part.
#[derive(Debug)]
pub(super) struct Uses<'a> {
    images: Pool<'a, Image>,
    /// Indexed by part and map: the image and its name.
    names: BTreeMap<(usize, Map), String>,
    files: Vec<(String, Map, &'a Image)>,
}

impl<'a> Uses<'a> {
    pub(super) fn of<'p>(parts: impl IntoIterator<Item = &'p Part<'a>>, maps: &[Map]) -> Self
    where
        'a: 'p,
    {
        let mut all = Self { images: Pool::new(), names: BTreeMap::new(), files: Vec::new() };
        let mut names = BTreeMap::new();
        for (index, part) in parts.into_iter().enumerate() {
            for &map in maps {
                let Some(image) = map.of(part) else { continue };
                let key = (all.images.index(image), map == Map::Roughness);
                let name = names.entry(key).or_insert_with(|| {
                    let name = all.fresh(part.name(), map);
                    all.files.push((name.clone(), map, image));
                    name
                });
                all.names.insert((index, map), name.clone());
            }
        }
        all
    }

    /// A file's name that no other image has.
    fn fresh(&self, part: &str, map: Map) -> String {
        let mut word = part.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
        word.truncate(60);
        let word = if word.is_empty() { "part" } else { &word };
        let mut name = format!("{word}_{}.png", map.word());
        let mut number = 2;
        // Some file systems do not tell capitals from small letters.
        while self.files.iter().any(|(other, ..)| other.eq_ignore_ascii_case(&name)) {
            name = format!("{word}_{}_{number}.png", map.word());
            number += 1;
        }
        name
    }

    /// The file of a part's map, if it has one.
    pub(super) fn name(&self, part: usize, map: Map) -> Option<&str> {
        self.names.get(&(part, map)).map(String::as_str)
    }

    /// All files, each image once.
    pub(super) fn files(&self) -> Vec<ImageFile<'a>> {
        let file = |(name, map, image): &(String, Map, &'a Image)| ImageFile {
            name: name.clone(),
            image: if *map == Map::Roughness { green(image) } else { Cow::Borrowed(*image) },
        };
        self.files.iter().map(file).collect()
    }
}

/// `true` if the colour image cuts holes into a part.
pub(super) fn is_masked(part: &Part<'_>) -> bool {
    worn::textures(part).is_some_and(Textures::is_masked)
}

/// The second channel as a grey image.
#[cfg(feature = "texture")]
fn green(image: &Image) -> Cow<'_, Image> {
    let channels = usize::from(image.channels());
    let bytes = image.bytes().chunks_exact(channels).map(|pixel| pixel[channels.min(2) - 1]).collect();
    // The sizes are those of an image, so that there is one.
    Image::new(image.width(), image.height(), 1, bytes).map_or(Cow::Borrowed(image), Cow::Owned)
}

#[cfg(not(feature = "texture"))]
fn green(image: &Image) -> Cow<'_, Image> {
    Cow::Borrowed(image)
}
