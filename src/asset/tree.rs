//! The data that all levels of one tree share, and the division of a budget into bark, leaves and cards.

use super::atlas::{self, Grid};
use super::card::{self, Kind, Source};
use super::cluster::{self, Cluster, Leaf};
use super::fit::{Cards, Look};
use super::leaf::Dress;
use super::light::{Crown, in_bytes};
use super::tangents::with_tangents;
use super::{Asset, AssetBuilder, AssetError, Piece, fit, twig};
use crate::foliage::{Canopy, Leaves};
use crate::observer::Watch;
use crate::random::{self, Purpose};
use crate::surface::{Instance, Material, Mesh, SurfaceError};
use crate::{Bounds, ParameterError, Skeleton};
use glam::Vec3;
use std::cell::OnceCell;

/// Leaves that one card stands for at the least, at their mean size.
const FEWEST: f32 = 6.0;
/// The part of the triangles that bark gets where leaves do not need the rest, and twigs are too many for all of it.
const BARK_OF_BARE: f32 = 0.6;
/// Kinds of cards for the twigs of whole leaves.
const TWIG_KINDS: usize = 2;
/// Steps from one report to the next.
pub(super) const DRAWN: usize = 2048;
/// Images of one leaf.
const VARIANTS: u32 = 4;
/// Pixels per side of the smallest cards with a normal map: in smaller ones a leaf is a pixel or two.
const NORMALS: usize = 48;

/// All that the levels of one tree share.
pub(super) struct Tree<'a> {
    builder: &'a AssetBuilder,
    skeleton: &'a Skeleton,
    canopy: Option<Canopy>,
    dresses: Vec<Dress>,
    all: Vec<Leaf>,
    /// The bark of the dense model.
    pub(super) bark: Mesh,
    /// Triangles of all leaves.
    leaf_triangles: usize,
    look: OnceCell<Option<Look>>,
    watch: &'a Watch<'a>,
}

/// Leaves in groups: the lowest node of each, and each leaf's group.
pub(super) struct Grouping {
    roots: Vec<u32>,
    of: Vec<u32>,
}

/// Clusters, each with its number, that cards stand for.
struct Carded<'a> {
    clusters: Vec<(u32, Cluster)>,
    source: Source<'a>,
}

impl Carded<'_> {
    fn is_bare(&self) -> bool {
        self.source.all.first().is_some_and(|first| first.dress == twig::NO_DRESS)
    }
}

impl<'a> Tree<'a> {
    pub(super) fn new(
        builder: &'a AssetBuilder,
        skeleton: &'a Skeleton,
        leaves: &'a [Leaves],
        watch: &'a Watch<'a>,
    ) -> Result<Self, AssetError> {
        builder.check()?;
        let copies = || leaves.iter().flat_map(|leaves| &leaves.instances);
        if let Some(copy) = copies().find(|copy| copy.node as usize >= skeleton.len()) {
            let range = format!("less than {}, the nodes of the skeleton", skeleton.len());
            return Err(ParameterError::new("Instance.node", copy.node, range).into());
        }
        for leaves in leaves {
            leaves.part().check::<AssetError>()?;
        }
        let bark = match builder.own_tubes().mesh_watched(skeleton, watch) {
            Ok(mesh) => mesh,
            // A tree whose wood is not thick at all still has leaves.
            Err(SurfaceError::NoRadii { .. }) if copies().next().is_some() => Mesh::default(),
            Err(error) => return Err(error.into()),
        };
        let mut dresses = Vec::new();
        let mut firsts = Vec::new();
        for leaves in leaves {
            watch.pass(DRAWN)?;
            let of_leaf = Dress::of(&leaves.leaf, builder.leaf_size, VARIANTS, watch)?;
            firsts.push((dresses.len(), of_leaf.len()));
            dresses.extend(of_leaf);
        }
        let variant = |count: usize, leaf: usize| {
            (random::unit(0, 4, Purpose::CARDS, leaf as u64) * count as f32) as usize
        };
        let mut all = Leaf::all(leaves, |number, leaf| {
            let (first, count) = firsts[number];
            (first + variant(count, leaf)) as u32
        });
        let canopy = if builder.canopy_shade > 0.0 { Canopy::of(leaves) } else { None };
        if let Some(canopy) = &canopy {
            for leaf in &mut all {
                let factor = canopy.factor(leaf.copy.position, builder.canopy_shade);
                leaf.copy.tint = leaf.copy.tint.map(|channel| channel * factor);
            }
        }
        let leaf_triangles = leaves.iter().map(|leaves| leaves.part().triangles() as usize).sum();
        Ok(Self {
            builder,
            skeleton,
            canopy,
            dresses,
            all,
            bark,
            leaf_triangles,
            look: OnceCell::new(),
            watch,
        })
    }

    pub(super) fn dense_triangles(&self) -> usize {
        self.bark.triangles().len() + self.leaf_triangles
    }

    /// The dense model.
    pub(super) fn dense(&self) -> Asset {
        let whole = (0..self.all.len()).collect::<Vec<_>>();
        self.assemble(self.bark.clone(), 0.0, &self.standing(&whole, &[]))
    }

    /// The look of the dense model; nothing if there is nothing to be seen. It is drawn once for all levels.
    pub(super) fn look(&self) -> Result<Option<&Look>, AssetError> {
        if self.look.get().is_none() {
            let look = match Look::of(&self.dense().parts(), self.watch) {
                Ok(look) => Some(look),
                Err(AssetError::Nothing) => None,
                Err(error) => return Err(error),
            };
            // There is none yet: nobody else is here.
            let _ = self.look.set(look);
        }
        Ok(self.look.get().and_then(Option::as_ref))
    }

    /// One level: the asset of at most `triangles` triangles, and its groups of leaves, made of those of the
    /// `finer` level.
    pub(super) fn level(
        &self,
        triangles: Option<usize>,
        side: u32,
        finer: Option<&Grouping>,
    ) -> Result<(Asset, Grouping), AssetError> {
        let dense = self.dense_triangles();
        let most = triangles.unwrap_or(dense).min(dense);
        if most == dense {
            return Ok((self.bent(self.dense())?, self.regroup(usize::MAX, finer)?));
        }
        let (bark, error, kept) = self.bark_within(most)?;
        let bare = self.bare(&kept);
        let room = most - bark.triangles().len();
        if self.leaf_triangles <= room {
            let whole = (0..self.all.len()).collect::<Vec<_>>();
            let asset = self.assemble(bark, error, &self.standing(&whole, &bare));
            let twigs = twig::all(self.skeleton, &bare);
            let cards = (room - self.leaf_triangles) / card::TRIANGLES;
            let asset = match self.twigs_in_groups(&twigs, &bare, cards) {
                Some(twigs) => self.with_cards(asset, &[twigs], side)?,
                None => asset,
            };
            return Ok((self.bent(asset)?, self.regroup(usize::MAX, finer)?));
        }
        if room < card::TRIANGLES {
            let least = bark.triangles().len() + card::TRIANGLES.min(self.leaf_triangles);
            return Err(AssetError::TooFewTriangles { triangles: most, least });
        }
        let grouping = self.regroup(room / card::TRIANGLES, finer)?;
        let clusters = Cluster::all(self.skeleton, &self.all, &grouping.roots, &grouping.of);
        let (whole, carded) = self.share(&clusters, room);
        let leaves: Vec<usize> =
            whole.iter().flat_map(|&i| clusters[i].leaves.iter().map(|&leaf| leaf as usize)).collect();
        let asset = self.assemble(bark, error, &self.standing(&leaves, &bare));
        let cluster_of = self.cluster_of(&grouping.roots);
        // Whole leaves do not stand in the air: their twigs are on cards.
        let twigs = twig::all(self.skeleton, &bare);
        let of = |twig: &Leaf| cluster_of[twig.copy.node as usize] as usize;
        let twigs: Vec<Leaf> =
            twigs.into_iter().filter(|twig| whole.binary_search(&of(twig)).is_ok()).collect();
        let mut members = vec![Vec::new(); clusters.len()];
        twigs.iter().enumerate().for_each(|(i, twig)| members[of(twig)].push(i as u32));
        let twiggy = members.into_iter().enumerate().filter(|(_, members)| !members.is_empty());
        let twiggy = twiggy.map(|(id, members)| {
            (id as u32, Cluster::new(self.skeleton, &twigs, grouping.roots[id], members))
        });
        let twiggy =
            Carded { clusters: twiggy.collect(), source: self.source(&twigs, &bare, cluster_of.clone()) };
        let leafy = Carded {
            clusters: carded.into_iter().map(|id| (id as u32, clusters[id].clone())).collect(),
            source: self.source(&self.all, &bare, cluster_of),
        };
        let asset = self.with_cards(asset, &[leafy, twiggy], side)?;
        Ok((self.bent(asset)?, grouping))
    }

    /// The twigs that no bark is about, for at most `most` cards, if there are any.
    fn twigs_in_groups<'b>(&'b self, twigs: &'b [Leaf], bare: &'b [bool], most: usize) -> Option<Carded<'b>> {
        if twigs.is_empty() {
            return None;
        }
        let weights: Vec<_> = twigs.iter().map(|twig| (twig.copy.node, twig.area)).collect();
        let area: f32 = weights.iter().map(|(_, area)| area).sum();
        let least = FEWEST * area / twigs.len() as f32;
        let (roots, of) = cluster::group(self.skeleton, &weights, most, least)?;
        let clusters = Cluster::all(self.skeleton, twigs, &roots, &of);
        let clusters = (0..).zip(clusters).collect();
        Some(Carded { clusters, source: self.source(twigs, bare, self.cluster_of(&roots)) })
    }

    fn source<'b>(&'b self, all: &'b [Leaf], bare: &'b [bool], cluster_of: Vec<u32>) -> Source<'b> {
        let (skeleton, dresses, bark) = (self.skeleton, &self.dresses[..], self.builder.wood());
        Source { skeleton, dresses, all, bark, bare, cluster_of }
    }

    /// The asset with cards in the place of these clusters, their images at most `side` pixels wide.
    fn with_cards(&self, mut asset: Asset, carded: &[Carded<'_>], side: u32) -> Result<Asset, AssetError> {
        let carded = || carded.iter().filter(|carded| !carded.clusters.is_empty());
        let has_leaves = carded().any(|carded| !carded.is_bare());
        let kinds = self.builder.kinds as usize;
        let of_leaves = if carded().count() > 1 { kinds.saturating_sub(TWIG_KINDS).max(1) } else { kinds };
        let sorted: Vec<_> = carded()
            .map(|carded| {
                let most = if carded.is_bare() && has_leaves { TWIG_KINDS } else { of_leaves };
                cluster::kinds(&carded.clusters, most)
            })
            .collect();
        let mut grid = Grid::of(2 * sorted.iter().map(|(_, models)| models.len()).sum::<usize>(), 1);
        grid.cell = (side as usize / grid.columns.max(grid.rows)).max(4 * atlas::PADDING);
        grid.normals = grid.cell >= NORMALS;
        let (mut clusters, mut kind_of, mut kinds) = (Vec::new(), Vec::new(), Vec::<Kind>::new());
        for (carded, (of, models)) in carded().zip(sorted) {
            let first = kinds.len() as u32;
            kind_of.extend(of.into_iter().map(|kind| first + kind));
            clusters.extend(carded.clusters.iter().map(|(_, cluster)| cluster));
            let models: Vec<_> = models.iter().map(|&i| &carded.clusters[i as usize]).collect();
            kinds.extend(carded.source.kinds(&models, grid, kinds.len(), self.watch)?);
        }
        if kinds.is_empty() {
            return Ok(asset);
        }
        // Materials are multiplied with the images, which have all the colour.
        let material = if has_leaves { Material::leaf() } else { self.builder.wood() };
        asset.cards.extend(kinds.iter().map(|kind| Piece {
            name: "cards",
            mesh: kind.mesh.clone(),
            material: material.with_color([1.0; 3]),
            textures: None,
            instances: Vec::new(),
            bent: None,
        }));
        let thicker = if has_leaves { fit::THICKER } else { fit::TWIGS_THICKER };
        Cards { clusters: &clusters, kind_of: &kind_of, kinds: &kinds, grid, thicker, watch: self.watch }
            .fit(&mut asset, self.bark.bounds().map_or(0.0, |bounds| bounds.size().y), || self.look())?;
        Ok(asset)
    }

    /// The bark within its share of a budget of `most` triangles, its error, and for each branch whether it
    /// is there.
    fn bark_within(&self, most: usize) -> Result<(Mesh, f32, Vec<bool>), AssetError> {
        let branches = self.skeleton.branches().len();
        if self.bark.is_empty() {
            return Ok((Mesh::default(), 0.0, vec![false; branches]));
        }
        let has_leaves = self.leaf_triangles > 0;
        // Triangles that leaves do not need go to the bark.
        let spare = most.saturating_sub(self.leaf_triangles);
        let share = if has_leaves { (most as f32 * self.builder.bark_share) as usize } else { most };
        let card = if has_leaves { card::TRIANGLES } else { 0 };
        let share = share.max(spare).min(most.saturating_sub(card));
        if self.bark.triangles().len() <= share {
            return Ok((self.bark.clone(), 0.0, vec![true; branches]));
        }
        let tubes = &self.builder.own_tubes();
        let within = match tubes.within_keeping(self.skeleton, share, self.watch) {
            Err(SurfaceError::TooFewTriangles { least, .. }) if least + card <= most => {
                tubes.within_keeping(self.skeleton, least, self.watch)
            }
            Err(SurfaceError::TooFewTriangles { least, .. }) => {
                return Err(AssetError::TooFewTriangles { triangles: most, least: least + card });
            }
            other => other,
        };
        let (mut level, mut kept) = within?;
        if kept.contains(&false) && level.mesh.triangles().len() <= spare {
            // Leaves have all that they need: thin twigs go on cards, and what these do not need comes back to the bark.
            let mut thick = (spare as f32 * BARK_OF_BARE) as usize;
            for _ in 0..2 {
                match tubes.within_keeping(self.skeleton, thick, self.watch) {
                    Ok(found) => (level, kept) = found,
                    Err(SurfaceError::TooFewTriangles { .. }) => break,
                    Err(error) => return Err(error.into()),
                }
                let bare = self.bare(&kept).into_iter().filter(|bare| *bare).count();
                let cards = bare / FEWEST as usize * card::TRIANGLES;
                if spare.saturating_sub(cards) <= thick {
                    break;
                }
                thick = spare - cards;
            }
        }
        Ok((level.mesh, level.error, kept))
    }

    /// Groups of leaves for at most `most` cards, made of leaves or of the groups of a finer level.
    fn regroup(&self, most: usize, finer: Option<&Grouping>) -> Result<Grouping, AssetError> {
        let area: f32 = self.all.iter().map(|leaf| leaf.area).sum();
        let least = FEWEST * area / self.all.len().max(1) as f32;
        if self.all.is_empty() {
            return Ok(Grouping { roots: Vec::new(), of: Vec::new() });
        }
        let Some(finer) = finer else {
            let weights: Vec<_> = self.all.iter().map(|leaf| (leaf.copy.node, leaf.area)).collect();
            let (roots, of) =
                cluster::group(self.skeleton, &weights, most, least).ok_or(AssetError::Nothing)?;
            return Ok(Grouping { roots, of });
        };
        let mut weights: Vec<(u32, f32)> = finer.roots.iter().map(|&root| (root, 0.0)).collect();
        for (leaf, &group) in self.all.iter().zip(&finer.of) {
            weights[group as usize].1 += leaf.area;
        }
        let (roots, groups) =
            cluster::group(self.skeleton, &weights, most, least).ok_or(AssetError::Nothing)?;
        let of = finer.of.iter().map(|&group| groups[group as usize]).collect();
        Ok(Grouping { roots, of })
    }

    /// Divides clusters into those shown leaf by leaf and those shown as cards. Those farthest out get their
    /// leaves first, since they make the crown's outline.
    fn share(&self, clusters: &[Cluster], room: usize) -> (Vec<usize>, Vec<usize>) {
        let bounds = Bounds::of(clusters.iter().map(|cluster| cluster.middle));
        let half = (bounds.size() * 0.5).max(Vec3::splat(1e-6));
        let out: Vec<f32> = clusters
            .iter()
            .map(|cluster| ((cluster.middle - bounds.center()) / half).length_squared())
            .collect();
        let mut order: Vec<usize> = (0..clusters.len()).collect();
        order.sort_by(|&i, &j| out[j].total_cmp(&out[i]).then(i.cmp(&j)));
        let mut left = room - clusters.len() * card::TRIANGLES;
        let mut whole = 0;
        for &i in &order {
            let cost: usize = clusters[i]
                .leaves
                .iter()
                .map(|&leaf| self.dresses[self.all[leaf as usize].dress as usize].mesh.triangles().len())
                .sum();
            // The card stays, for the twigs.
            if cost > left {
                break;
            }
            left -= cost;
            whole += 1;
        }
        let mut cards = order.split_off(whole);
        order.sort_unstable();
        cards.sort_unstable();
        (order, cards)
    }

    /// For each node, `true` if no bark is about its internode.
    fn bare(&self, kept: &[bool]) -> Vec<bool> {
        let mut bare = vec![false; self.skeleton.len()];
        for (branch, kept) in self.skeleton.branches().iter().zip(kept) {
            branch.nodes().iter().skip(1).for_each(|&node| bare[node as usize] = !kept);
        }
        bare
    }

    /// The dress and the place of each of these leaves; where there is no bark and that matters, on the nearest that there is.
    fn standing(&self, leaves: &[usize], bare: &[bool]) -> Vec<(u32, Instance)> {
        let positions = self.skeleton.positions();
        let stand = |&leaf: &usize| {
            let Leaf { dress, copy, .. } = self.all[leaf];
            let mut node = copy.node as usize;
            while let Some(parent) = self.skeleton.parent(node).filter(|_| self.builder.on_bark) {
                if !bare.get(node).is_some_and(|bare| *bare) {
                    break;
                }
                node = parent;
            }
            let position = copy.position + (positions[node] - positions[copy.node as usize]);
            let moved = Instance { position, node: node as u32, ..copy };
            (dress, if node == copy.node as usize { copy } else { moved })
        };
        leaves.iter().map(stand).collect()
    }

    /// For each node the number of the group that it is in.
    fn cluster_of(&self, roots: &[u32]) -> Vec<u32> {
        let mut of = vec![u32::MAX; self.skeleton.len()];
        for (number, &root) in roots.iter().enumerate() {
            of[root as usize] = number as u32;
        }
        for (node, parent) in self.skeleton.edges() {
            if of[node] == u32::MAX {
                of[node] = of[parent];
            }
        }
        of
    }

    /// The asset of this bark and these leaves.
    fn assemble(&self, bark: Mesh, error: f32, whole: &[(u32, Instance)]) -> Asset {
        let mut instances: Vec<Vec<Instance>> = vec![Vec::new(); self.dresses.len()];
        for &(dress, copy) in whole {
            instances[dress as usize].push(copy);
        }
        let leaves = self.dresses.iter().zip(instances).filter(|(_, instances)| !instances.is_empty());
        let leaves = leaves.map(|(dress, instances)| Piece {
            name: "leaves",
            mesh: with_tangents(dress.mesh.clone(), dress.textures.as_deref()),
            material: dress.material,
            textures: dress.textures.clone(),
            instances,
            bent: None,
        });
        let mut bark = Piece {
            name: "bark",
            mesh: self.shaded(bark),
            material: self.builder.bark,
            textures: self.builder.bark_textures.clone(),
            instances: vec![Instance::IDENTITY],
            bent: None,
        };
        let young = self.builder.split(&mut bark, self.skeleton);
        Asset {
            bark,
            young,
            coats: Vec::new(),
            leaves: leaves.collect(),
            cards: Vec::new(),
            error,
            crown: None,
        }
    }

    /// Bark that is darker within the crown.
    fn shaded(&self, mut bark: Mesh) -> Mesh {
        if let Some(canopy) = &self.canopy {
            let factor = |position: &Vec3| canopy.factor(*position, self.builder.canopy_shade);
            bark.colors = bark.positions.iter().map(|position| [factor(position); 3]).collect();
            in_bytes(&mut bark.colors);
        }
        bark
    }

    /// The asset with the normals of leaves and cards bent, if there is a budget: dense models keep their instances.
    fn bent(&self, mut asset: Asset) -> Result<Asset, AssetError> {
        let share = self.builder.bent_normals;
        if share > 0.0 && self.builder.triangles.is_some() && !self.all.is_empty() {
            asset.bend(Crown { bounds: Bounds::of(self.all.iter().map(|leaf| leaf.middle)), share })?;
        }
        Ok(asset)
    }
}
