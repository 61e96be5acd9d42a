//! A skeleton read by nodes' children and by branches.

use super::{Skeleton, SkeletonError};

/// The children of every node; see [`Skeleton::children`].
#[derive(Debug, Clone)]
pub struct Children {
    starts: Vec<u32>,
    nodes: Vec<u32>,
}

impl Children {
    pub(super) fn new(parents: &[u32]) -> Self {
        let mut starts = vec![0; parents.len() + 1];
        for &parent in parents.iter().skip(1) {
            starts[parent as usize + 1] += 1;
        }
        for node in 0..parents.len() {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut nodes = vec![0; parents.len().saturating_sub(1)];
        for (child, &parent) in parents.iter().enumerate().skip(1) {
            let slot = &mut next[parent as usize];
            nodes[*slot as usize] = child as u32;
            *slot += 1;
        }
        Self { starts, nodes }
    }

    /// The children of `node`, ascending.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn of(&self, node: usize) -> &[u32] {
        &self.nodes[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}

/// For each node the child in which its axis goes on by stages, tips and indices; itself at a tip.
fn dominant_children(skeleton: &Skeleton) -> Vec<u32> {
    let mut tips = vec![0u32; skeleton.len()];
    let mut axis: Vec<u32> = (0..skeleton.len() as u32).collect();
    // Backwards, so that a child's tips are counted before its parent compares it; ties go to the lower index
    // because it comes last and wins on equality.
    for (node, parent) in skeleton.edges().rev() {
        tips[node] = tips[node].max(1);
        tips[parent] += tips[node];
        let best = axis[parent] as usize;
        let rank = |n: usize| (std::cmp::Reverse(skeleton.stages[n]), tips[n]);
        if best == parent || rank(node) >= rank(best) {
            axis[parent] = node as u32;
        }
    }
    axis
}

pub(super) fn orders(skeleton: &Skeleton) -> Vec<u16> {
    let axis = dominant_children(skeleton);
    let mut orders = vec![0u16; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        let off_axis = axis[parent] as usize != node;
        orders[node] = orders[parent].saturating_add(u16::from(off_axis));
    }
    orders
}

/// For each node the child of its own order; itself where there is none.
///
/// Beyond 65,535 orders, which cannot be distinguished, the last such child is as good as any.
fn axis_children(skeleton: &Skeleton) -> Vec<u32> {
    let mut axis: Vec<u32> = (0..skeleton.len() as u32).collect();
    for (node, parent) in skeleton.edges() {
        if skeleton.orders[node] == skeleton.orders[parent] {
            axis[parent] = node as u32;
        }
    }
    axis
}

pub(super) fn check_orders(skeleton: &Skeleton, orders: &[u16]) -> Result<(), SkeletonError> {
    let wrong = |node: usize, parent: u16| SkeletonError::Order { node, order: orders[node], parent };
    if orders[0] != 0 {
        return Err(wrong(0, 0));
    }
    let mut goes_on = vec![false; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        let (order, parent_order) = (orders[node], orders[parent]);
        let branches_off = order == parent_order.saturating_add(1);
        // The highest number stands for all beyond it.
        let is_axis = order == parent_order && order < u16::MAX;
        if !branches_off && (!is_axis || goes_on[parent]) {
            return Err(wrong(node, parent_order));
        }
        goes_on[parent] |= is_axis;
    }
    Ok(())
}

/// One branch: a chain of nodes along one axis.
#[derive(Debug, Clone, Copy)]
pub struct Branch<'a> {
    nodes: &'a [u32],
    order: u16,
}

impl<'a> Branch<'a> {
    /// The nodes from where the branch springs (a node of its parent axis; the root for the trunk) to its
    /// tip.
    pub fn nodes(&self) -> &'a [u32] {
        self.nodes
    }

    /// 0 for the trunk; see [`Skeleton::orders`].
    pub fn order(&self) -> u16 {
        self.order
    }
}

/// The branches of a skeleton, to be iterated over; see [`Skeleton::branches`].
#[derive(Debug, Clone)]
pub struct Branches {
    nodes: Vec<u32>,
    starts: Vec<u32>,
    orders: Vec<u16>,
}

impl Branches {
    pub(super) fn new(skeleton: &Skeleton) -> Self {
        let axis = axis_children(skeleton);
        let mut branches = Self { nodes: Vec::new(), starts: vec![0], orders: Vec::new() };
        let mut follow = |from: Option<u32>, first: u32| {
            branches.nodes.extend(from);
            let mut node = first;
            branches.nodes.push(node);
            while axis[node as usize] != node {
                node = axis[node as usize];
                branches.nodes.push(node);
            }
            branches.starts.push(branches.nodes.len() as u32);
            branches.orders.push(skeleton.orders[first as usize]);
        };
        follow(None, 0);
        for (node, parent) in skeleton.edges() {
            if axis[parent] as usize != node {
                follow(Some(parent as u32), node as u32);
            }
        }
        branches
    }

    /// Number of branches, the trunk included.
    pub fn len(&self) -> usize {
        self.orders.len()
    }

    /// Always false: there is a trunk, if only the root.
    pub fn is_empty(&self) -> bool {
        self.orders.is_empty()
    }

    /// Every branch, its parent axis before it.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Branch<'_>> {
        self.orders.iter().enumerate().map(|(i, &order)| Branch {
            nodes: &self.nodes[self.starts[i] as usize..self.starts[i + 1] as usize],
            order,
        })
    }
}

impl<'a> IntoIterator for &'a Branches {
    type Item = Branch<'a>;
    type IntoIter = Box<dyn Iterator<Item = Branch<'a>> + 'a>;

    fn into_iter(self) -> Self::IntoIter {
        Box::new(self.iter())
    }
}
