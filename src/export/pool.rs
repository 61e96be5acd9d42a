//! Equal meshes and images are written once.

use super::worn::Image;
use crate::surface::{Instance, Mesh};
use std::collections::BTreeMap;

/// Things that are compared by content, not by their place in memory.
#[derive(Debug)]
pub(super) struct Pool<'a, T: ?Sized> {
    items: Vec<&'a T>,
    /// Items with the same gist, usually one.
    gists: BTreeMap<Gist, Vec<usize>>,
}

/// Sizes and a few numbers: items that differ in these are different.
type Gist = [u32; 8];

/// Key that is compared by a few bytes first, and then in full.
pub(super) trait Content: PartialEq {
    fn gist(&self) -> Gist;
}

impl<'a, T: Content + ?Sized> Pool<'a, T> {
    pub(super) fn new() -> Self {
        Self { items: Vec::new(), gists: BTreeMap::new() }
    }

    /// The number of a thing, which is the next one if there is none like it. O(size) if there may be one.
    pub(super) fn index(&mut self, item: &'a T) -> usize {
        let like = self.gists.entry(item.gist()).or_default();
        let same = |&&index: &&usize| std::ptr::eq(self.items[index], item) || *self.items[index] == *item;
        if let Some(&index) = like.iter().find(same) {
            return index;
        }
        like.push(self.items.len());
        self.items.push(item);
        self.items.len() - 1
    }

    pub(super) fn items(&self) -> &[&'a T] {
        &self.items
    }
}

impl Content for Mesh {
    fn gist(&self) -> Gist {
        let [x, y, z] = self.positions.last().map_or([0.0; 3], glam::Vec3::to_array).map(f32::to_bits);
        let counts = [self.positions.len(), self.indices.len(), self.uvs.len(), self.colors.len()];
        let [vertices, indices, uvs, colors] = counts.map(|count| count as u32);
        [vertices, indices, uvs, colors, self.tangents.len() as u32, x, y, z]
    }
}

impl Content for [Instance] {
    fn gist(&self) -> Gist {
        let place = |copy: Option<&Instance>| copy.map_or([0.0; 3], |copy| copy.position.to_array());
        let ([a, b, c], [d, e, f]) = (place(self.first()), place(self.last()));
        let [a, b, c, d, e, f] = [a, b, c, d, e, f].map(f32::to_bits);
        [self.len() as u32, a, b, c, d, e, f, 0]
    }
}

impl Content for Image {
    fn gist(&self) -> Gist {
        let bytes = self.bytes();
        let word = |part: usize| u32::from(bytes[(bytes.len() - 1) * part / 4]);
        let sizes = [self.width(), self.height(), u32::from(self.channels())];
        [sizes[0], sizes[1], sizes[2], word(0), word(1), word(2), word(3), word(4)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn content_counts() {
        let triangle =
            |x: f32| Mesh::new(vec![Vec3::X * x, Vec3::Y, Vec3::Z], vec![Vec3::X; 3], vec![0, 1, 2]);
        let (a, b, c) = (triangle(1.0), triangle(1.0), triangle(2.0));
        let mut pool = Pool::new();
        assert_eq!([&a, &b, &c, &a, &c].map(|mesh| pool.index(mesh)), [0, 0, 1, 0, 1]);
        assert_eq!(pool.items().len(), 2);
        let mut pool = Pool::<[Instance]>::new();
        let (two, again) = ([Instance::IDENTITY; 2], [Instance::IDENTITY; 2]);
        let found = [&two[..], &two[..1], &again[..], &again[..1], &[]].map(|copies| pool.index(copies));
        assert_eq!(found, [0, 1, 0, 1, 2]);
    }
}
