//! Leaves, or bare twigs, in groups along the branches: what one card stands for.

use crate::Skeleton;
use crate::foliage::Leaves;
use crate::random::{self, Purpose};
use crate::surface::Instance;
use glam::{Mat3, Vec3};

/// State of one leaf of the tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    /// The number of its [`Dress`](super::leaf::Dress); a bare twig has [none](super::twig::NO_DRESS).
    pub(super) dress: u32,
    pub(super) copy: Instance,
    /// The middle of its mesh, metres.
    pub(super) middle: Vec3,
    /// Area of its triangles, square metres.
    pub(super) area: f32,
}

impl Leaf {
    /// The area that a leaf counts as at the least, square metres.
    pub(super) const LEAST_AREA: f32 = 1e-12;

    /// All leaves of a tree; `dress` says what a leaf of a number in its [`Leaves`] wears.
    pub(super) fn all(leaves: &[Leaves], dress: impl Fn(usize, usize) -> u32) -> Vec<Self> {
        let mut all = Vec::with_capacity(leaves.iter().map(|leaves| leaves.instances.len()).sum());
        for (number, leaves) in leaves.iter().enumerate() {
            let mesh = leaves.leaf.mesh();
            let Some(bounds) = mesh.bounds() else { continue };
            let area = mesh.area();
            all.extend(leaves.instances.iter().enumerate().map(|(i, &copy)| Self {
                dress: dress(number, i),
                copy,
                middle: copy.matrix() * bounds.center() + copy.position,
                // A leaf without area is still one to be grouped.
                area: (area * copy.scale * copy.scale).max(Self::LEAST_AREA),
            }));
        }
        all
    }
}

/// Puts `weights` at nodes into groups, each of at least `target` and one connected piece of the
/// tree; what is left goes to a last group at the root. A metre of branch adds `a_metre` to the
/// weight, so that things far apart do not form one group. For each group its lowest node, and for
/// each weight its group. O(nodes + weights).
fn gather(skeleton: &Skeleton, weights: &[(u32, f32)], a_metre: f32, target: f32) -> (Vec<u32>, Vec<u32>) {
    let (nodes, positions) = (skeleton.len(), skeleton.positions());
    let mut pending = vec![0.0f32; nodes];
    for &(node, weight) in weights {
        pending[node as usize] += weight;
    }
    // The group that begins at a node; later: that its weights belong to.
    let mut group = vec![u32::MAX; nodes];
    let mut roots = Vec::new();
    for node in (0..nodes).rev() {
        if pending[node] >= target || node == 0 && pending[node] > 0.0 {
            group[node] = roots.len() as u32;
            roots.push(node as u32);
        } else if let Some(parent) = skeleton.parent(node).filter(|_| pending[node] > 0.0) {
            pending[parent] += pending[node] + a_metre * positions[node].distance(positions[parent]);
        }
    }
    for (node, parent) in skeleton.edges() {
        if group[node] == u32::MAX {
            group[node] = group[parent];
        }
    }
    let of = weights.iter().map(|&(node, _)| group[node as usize]).collect();
    (roots, of)
}

/// The length of all branches that lead to a weight, the trunk's too, metres.
fn leafy_length(skeleton: &Skeleton, weights: &[(u32, f32)]) -> f32 {
    let mut leads = vec![false; skeleton.len()];
    for (node, _) in weights {
        leads[*node as usize] = true;
    }
    let mut length = 0.0;
    for (node, parent) in skeleton.edges().rev().filter(|(node, _)| *node > 0) {
        if leads[node] {
            leads[parent] = true;
            length += skeleton.positions()[node].distance(skeleton.positions()[parent]);
        }
    }
    length
}

/// The finest groups of which there are at most `most`, at least `least` in weight each; `None` if that cannot be.
pub(super) fn group(
    skeleton: &Skeleton,
    weights: &[(u32, f32)],
    most: usize,
    least: f32,
) -> Option<(Vec<u32>, Vec<u32>)> {
    let total: f32 = weights.iter().map(|(_, weight)| weight).sum();
    let a_metre = total / leafy_length(skeleton, weights).max(1e-9);
    let mut target = (0.4 * total / most.max(1) as f32).max(least);
    if most == 0 || !total.is_finite() {
        return None;
    }
    loop {
        let found = gather(skeleton, weights, a_metre, target);
        if found.0.len() <= most {
            return Some(found);
        }
        // One group of all comes at the latest when the target is more than the whole.
        target *= 1.04;
    }
}

/// Leaves that one card stands for.
#[derive(Debug, Clone)]
pub(super) struct Cluster {
    /// The lowest node.
    pub(super) root: u32,
    /// Numbers of leaves, ascending.
    pub(super) leaves: Vec<u32>,
    /// The mean of the leaves' middles by area, metres.
    pub(super) middle: Vec3,
    /// Square metres.
    pub(super) area: f32,
    /// X across, Y from the base outward, Z to the upper side, in which it is flattest.
    pub(super) frame: Mat3,
    /// Extent of the leaves along these, standard deviations, metres.
    pub(super) spread: Vec3,
    /// The mean of the leaves' tints by area.
    pub(super) tint: [f32; 3],
}

impl Cluster {
    /// Groups of leaves as clusters.
    pub(super) fn all(skeleton: &Skeleton, leaves: &[Leaf], roots: &[u32], of: &[u32]) -> Vec<Self> {
        let mut members = vec![Vec::new(); roots.len()];
        for (leaf, &group) in of.iter().enumerate() {
            members[group as usize].push(leaf as u32);
        }
        roots.iter().zip(members).map(|(&root, members)| Self::new(skeleton, leaves, root, members)).collect()
    }

    pub(super) fn new(skeleton: &Skeleton, all: &[Leaf], root: u32, members: Vec<u32>) -> Self {
        let leaves = || members.iter().map(|&leaf| &all[leaf as usize]);
        let area: f32 = leaves().map(|leaf| leaf.area).sum();
        let whole = 1.0 / area.max(f32::MIN_POSITIVE);
        // About the first leaf, so that far from the origin nothing is lost.
        let origin = all[members[0] as usize].middle;
        let middle = origin + leaves().map(|leaf| (leaf.middle - origin) * (leaf.area * whole)).sum::<Vec3>();
        let upper: Vec3 = leaves().map(|leaf| leaf.copy.rotation_matrix().z_axis * leaf.area).sum();
        let mut tint = [0.0; 3];
        let mut moments = [[0.0f64; 3]; 3];
        for leaf in leaves() {
            let (share, offset) = (leaf.area * whole, leaf.middle - middle);
            for i in 0..3 {
                tint[i] += leaf.copy.tint[i] * share;
                for j in 0..3 {
                    // Leaves are no points.
                    let own = if i == j { leaf.area / 12.0 } else { 0.0 };
                    moments[i][j] += f64::from(share * (offset[i] * offset[j] + own));
                }
            }
        }
        let base = skeleton.positions()[skeleton.parent(root as usize).unwrap_or(0)];
        let axes = principal(moments);
        let flattest = axes[0];
        let toward = if upper.length() > 0.1 * area { upper.dot(flattest) } else { flattest.y };
        let z = if toward < 0.0 { -flattest } else { flattest };
        let outward = middle - base;
        let outward = outward - z * outward.dot(z);
        let y = if outward.length_squared() > 1e-4 * moments[0][0].max(1e-12) as f32 {
            outward.normalize_or(axes[2])
        } else {
            axes[2]
        };
        let x = y.cross(z).normalize_or(axes[1]);
        let y = z.cross(x);
        let along = |axis: Vec3| {
            let variance: f32 = leaves()
                .map(|leaf| {
                    let offset = (leaf.middle - middle).dot(axis);
                    leaf.area * whole * (offset * offset + leaf.area / 12.0)
                })
                .sum();
            variance.sqrt()
        };
        let spread = Vec3::new(along(x), along(y), along(z));
        Self {
            root,
            leaves: members,
            middle,
            area,
            frame: Mat3::from_cols(x, y, z),
            spread,
            tint: tint.map(|channel| channel.clamp(0.0, 1.0)),
        }
    }

    /// Its size: the standard deviation in all directions together, metres.
    pub(super) fn size(&self) -> f32 {
        self.spread.length().max(1e-6)
    }
}

/// The directions of least, middle and most variance, by Jacobi's rotations; right-handed.
fn principal(mut a: [[f64; 3]; 3]) -> [Vec3; 3] {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q].abs() <= 1e-14 * (a[p][p].abs() + a[q][q].abs()) {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for k in 0..3 {
                (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                (v[k][p], v[k][q]) = (c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    let axis = |i: usize| Vec3::new(v[0][i] as f32, v[1][i] as f32, v[2][i] as f32).normalize_or(Vec3::Y);
    let (least, middle) = (axis(order[0]), axis(order[1]));
    [least, middle, least.cross(middle).normalize_or(Vec3::Y)]
}

/// Sorts clusters into kinds that look alike: the kind of each cluster, and for each kind the cluster that
/// stands for it. At most `kinds` kinds, none empty. Lloyd's algorithm from the start of Arthur and
/// Vassilvitskii 2007, over the shape of the clusters and, with less weight, their density and size.
/// O(clusters · kinds).
pub(super) fn kinds(clusters: &[(u32, Cluster)], kinds: usize) -> (Vec<u32>, Vec<u32>) {
    type Traits = [f32; 5];
    let traits: Vec<Traits> = clusters
        .iter()
        .map(|(_, cluster)| {
            let (size, spread) = (cluster.size(), cluster.spread / cluster.size());
            let crowded = crate::math::ln(cluster.area.max(1e-12) / (size * size));
            [spread.x, spread.y, spread.z, 0.35 * crowded, 0.35 * crate::math::ln(size)]
        })
        .collect();
    let distance = |a: &Traits, b: &Traits| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
    let mean = |members: &mut dyn Iterator<Item = &Traits>| {
        let (mut sum, mut count) = ([0.0f32; 5], 0.0f32);
        for traits in members {
            (0..5).for_each(|i| sum[i] += traits[i]);
            count += 1.0;
        }
        (count > 0.0).then(|| sum.map(|trait_| trait_ / count))
    };
    let nearest = |centers: &[Traits], traits: &Traits| {
        let by =
            |i: &usize, j: &usize| distance(&centers[*i], traits).total_cmp(&distance(&centers[*j], traits));
        (0..centers.len()).min_by(by).unwrap_or(0)
    };
    let Some(first) = mean(&mut traits.iter()) else { return (Vec::new(), Vec::new()) };
    let mut centers = vec![first];
    while centers.len() < kinds.min(clusters.len()) {
        // Far from the others, and large: odd twigs of few leaves are no kind.
        let off: Vec<f32> = traits
            .iter()
            .zip(clusters)
            .map(|(traits, (_, cluster))| {
                distance(&centers[nearest(&centers, traits)], traits) * cluster.area
            })
            .collect();
        let total: f32 = off.iter().sum();
        let mut rest = total * random::unit(0, 0, Purpose::CARDS, centers.len() as u64);
        let next = off.iter().position(|off| {
            rest -= off;
            rest < 0.0
        });
        let Some(next) = next.filter(|next| off[*next] > 0.0) else { break };
        centers.push(traits[next]);
    }
    let mut of = Vec::new();
    for _ in 0..8 {
        of = traits.iter().map(|traits| nearest(&centers, traits)).collect::<Vec<_>>();
        for (kind, center) in centers.iter_mut().enumerate() {
            let mut members = of.iter().zip(&traits).filter(|(of, _)| **of == kind).map(|(_, traits)| traits);
            *center = mean(&mut members).unwrap_or(*center);
        }
    }
    // Only kinds that have clusters; the one nearest to the mean stands for the others.
    let (mut number, mut models) = (vec![u32::MAX; centers.len()], Vec::new());
    for (kind, center) in centers.iter().enumerate() {
        let off = |i: &usize| distance(center, &traits[*i]);
        let model = (0..of.len()).filter(|i| of[*i] == kind).min_by(|i, j| off(i).total_cmp(&off(j)));
        if let Some(model) = model {
            number[kind] = models.len() as u32;
            models.push(model as u32);
        }
    }
    (of.iter().map(|kind| number[*kind]).collect(), models)
}
