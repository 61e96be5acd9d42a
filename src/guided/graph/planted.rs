//! A tree that stands in a graph from the beginning.

use crate::guided::curve::catmull_rom;
use crate::math::UP;
use crate::skeleton::Skeleton;
use glam::Vec3;

/// A tree that stands in a graph. Its nodes are the graph's first, in this order, each after its parent.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::guided) struct Planted {
    /// A root's is itself.
    pub(in crate::guided) parents: Vec<u32>,
    pub(in crate::guided) stages: Vec<u16>,
    pub(in crate::guided) vectors: Vec<Vec3>,
    /// Edges and metres from the node that its stage started from.
    pub(in crate::guided) hops: Vec<u32>,
    pub(in crate::guided) lengths: Vec<f32>,
    /// The least radius of each internode, metres.
    pub(in crate::guided) radii: Vec<f32>,
}

/// A tree divided anew, to be planted.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::guided) struct Carried {
    pub(in crate::guided) positions: Vec<Vec3>,
    pub(in crate::guided) tree: Planted,
    /// The new node of each old one.
    pub(in crate::guided) places: Vec<u32>,
}

/// Length of the parts a tree is divided into, in spacings.
const PART: f32 = 1.2;

impl Carried {
    /// A root that no tree stands on yet.
    pub(in crate::guided) fn add_root(&mut self, position: Vec3) {
        let root = self.positions.len() as u32;
        self.places.push(root);
        self.positions.push(position);
        self.tree.push(root, 0, UP, 0, 0.0, 0.0);
    }

    /// Divides one more tree, of another method's: its vectors are the directions in which it comes to its nodes.
    pub(in crate::guided) fn add_skeleton(&mut self, tree: &Skeleton, spacing: f32) {
        let mut vectors = vec![UP; tree.len()];
        for (node, parent) in tree.edges() {
            let way = tree.positions()[node] - tree.positions()[parent];
            vectors[node] = way.normalize_or(vectors[parent]);
        }
        self.add_tree(tree, &vectors, spacing);
    }

    /// Positions of the roots, metres.
    pub(in crate::guided) fn roots(&self) -> Vec<Vec3> {
        let is_root = |&(node, parent): &(u32, &u32)| node == *parent;
        let roots = (0u32..).zip(&self.tree.parents).filter(is_root);
        roots.map(|(node, _)| self.positions[node as usize]).collect()
    }

    /// Divides one more tree, whose nodes have these guiding vectors, along its smooth curve at a spacing.
    pub(in crate::guided) fn add_tree(&mut self, tree: &Skeleton, vectors: &[Vec3], spacing: f32) {
        let root = self.positions.len() as u32;
        let first = self.places.len();
        self.places.resize(first + tree.len(), root);
        self.positions.push(tree.positions()[0]);
        self.tree.push(root, 0, vectors[0], 0, 0.0, tree.radii()[0]);
        for branch in tree.branches().iter() {
            let nodes = branch.nodes();
            let at = |i: isize| {
                let last = nodes.len() as isize - 1;
                let node = |i: isize| tree.positions()[nodes[i.clamp(0, last) as usize] as usize];
                // Beyond its ends the curve goes straight on.
                match i {
                    _ if i < 0 => node(0) * 2.0 - node(1),
                    _ if i > last => node(last) * 2.0 - node(last - 1),
                    _ => node(i),
                }
            };
            for i in 0..nodes.len() as isize - 1 {
                let (from, to) = (nodes[i as usize] as usize, nodes[i as usize + 1] as usize);
                // A tree of others may have nodes in one place.
                if at(i).distance_squared(at(i + 1)) < f32::MIN_POSITIVE {
                    self.places[first + to] = self.places[first + from];
                    continue;
                }
                let parts = (at(i).distance(at(i + 1)) / (PART * spacing)).round().max(1.0) as u32;
                for part in 1..=parts {
                    let t = part as f32 / parts as f32;
                    let parent = match part {
                        1 => self.places[first + from],
                        _ => self.positions.len() as u32 - 1,
                    };
                    let position = if part == parts {
                        at(i + 1)
                    } else {
                        catmull_rom([at(i - 1), at(i), at(i + 1), at(i + 2)], t)
                    };
                    let vector = vectors[from].lerp(vectors[to], t);
                    self.add_node(parent, position, tree.stages()[to], vector, tree.radii()[to]);
                }
                self.places[first + to] = self.positions.len() as u32 - 1;
            }
        }
    }

    fn add_node(&mut self, parent: u32, position: Vec3, stage: u16, vector: Vec3, radius: f32) {
        let before = parent as usize;
        let goes_on = self.tree.parents[before] != parent && self.tree.stages[before] == stage;
        let (hops, length) =
            if goes_on { (self.tree.hops[before], self.tree.lengths[before]) } else { (0, 0.0) };
        let length = length + position.distance(self.positions[before]);
        let vector = vector.normalize_or(self.tree.vectors[before]);
        self.positions.push(position);
        self.tree.push(parent, stage, vector, hops + 1, length, radius);
    }
}

impl Planted {
    fn push(&mut self, parent: u32, stage: u16, vector: Vec3, hops: u32, length: f32, radius: f32) {
        self.parents.push(parent);
        self.stages.push(stage);
        self.vectors.push(vector);
        self.hops.push(hops);
        self.lengths.push(length);
        self.radii.push(radius);
    }
}
