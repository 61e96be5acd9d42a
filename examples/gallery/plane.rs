//! Trees in the plane, over their graph and its guiding vectors.

use super::common::Failure;
use treesynth::Skeleton;
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::Search;
use treesynth::preview::Picture;

/// The edges of the graph, the guiding vectors of the last stage, and the tree.
pub(crate) fn draw(search: &Search<'_>, skeleton: &Skeleton, size: u32) -> Result<Picture, Failure> {
    let graph = search.graph();
    let (min, max) = graph
        .positions()
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
    let scale = size as f32 * 0.96 / (max - min).max_element();
    let at = |p: Vec3| {
        let offset = (p - (min + max) * 0.5) * scale;
        Vec2::new(offset.x, -offset.y) + size as f32 * 0.5
    };
    let spacing = (max - min).max_element() / (graph.nodes() as f32).sqrt();
    let mut picture = Picture::new(size, size, [255, 255, 255])?;
    for node in 0..graph.nodes() as u32 {
        for &to in graph.neighbours(node) {
            picture.line(at(graph.position(node)), at(graph.position(to)), 0.6, [232, 234, 238]);
        }
    }
    for node in 0..graph.nodes() as u32 {
        if let Some(vector) = search.vector(node) {
            let from = graph.position(node);
            picture.line(at(from), at(from + vector * spacing * 0.7), 1.0, [120, 165, 215]);
            picture.disc(at(from), 1.2, [120, 165, 215]);
        }
    }
    for (child, parent) in skeleton.edges() {
        let [from, to] = [parent, child].map(|node| at(skeleton.positions()[node]));
        let width = (skeleton.radii()[child] * 2.0 * scale).max(1.6);
        picture.line(from, to, width, [92, 62, 40]);
        picture.disc(to, width * 0.5, [92, 62, 40]);
    }
    Ok(picture)
}
