//! A tree in leaf within a budget of triangles.

use super::atlas::{self, Grid};
use super::card::{self, Kind, Source};
use super::cluster::{self, Cluster, Leaf};
use super::leaf::Dress;
use super::measure::{Frame, Tally, draw, drawn, lit, skins};
use super::tangents::with_tangents;
use super::young::{self, Young};
use super::{Asset, AssetError, Piece};
use crate::foliage::{Foliage, Leaves};
use crate::random::{self, Purpose};
use crate::surface::{Instance, Material, Mesh, Part, SurfaceError, Tubes};
use crate::texture::{Bark, Image, Textures};
use crate::{ParameterError, Skeleton, parallel};
use glam::Vec3;
use std::f32::consts::TAU;
use std::sync::Arc;

/// Leaves that one card stands for at the least, at their mean size.
const FEWEST: f32 = 6.0;
/// Images of one leaf.
const VARIANTS: u32 = 4;
/// The least and the greatest height of the pictures in which cover and colour are measured, pixels.
const MEASURED: (f32, f32) = (48.0, 240.0);
/// Points along each side of one.
const POINTS: usize = super::measure::SAMPLES;
/// Directions from which they are measured: turned about the vertical, lifted.
const VIEWS: [(f32, f32); 3] = [(0.2, 0.1), (0.2 + TAU / 3.0, 0.1), (0.2 + 2.0 * TAU / 3.0, 0.1)];
/// By how much cards may be smaller or larger than the twigs they stand for.
const LARGER: (f32, f32) = (0.6, 1.8);
/// By how much the colours of cards may be changed.
const GAIN: (f32, f32) = (0.6, 1.6);

/// Makes [`Asset`]s: a tree's bark and leaves within a budget of triangles.
#[must_use]
#[derive(Debug, Clone)]
pub struct AssetBuilder {
    bark: Material,
    bark_textures: Option<Arc<Textures>>,
    young: Option<Young>,
    twigs: Option<Material>,
    tubes: Tubes,
    /// Whether vertices have wind only to tell their nodes.
    still: bool,
    foliage: Option<Foliage>,
    triangles: Option<usize>,
    bark_share: f32,
    kinds: u32,
    texture_size: u32,
    leaf_size: Option<u32>,
}

impl Default for AssetBuilder {
    /// 10,000 triangles, of which bark gets at most 35%; the default bark without images; no leaves; 8 kinds of cards in
    /// images of 1024 x 1024 pixels.
    fn default() -> Self {
        Self {
            bark: Material::bark(),
            bark_textures: None,
            young: None,
            twigs: None,
            tubes: Tubes::default(),
            still: true,
            foliage: None,
            triangles: Some(10_000),
            bark_share: 0.35,
            kinds: 8,
            texture_size: 1024,
            leaf_size: Some(128),
        }
    }
}

impl AssetBuilder {
    /// How the bark looks; default [`Material::bark`].
    pub fn with_bark(mut self, material: Material) -> Self {
        self.bark = material;
        self
    }

    /// The images that the bark wears; default none. They are multiplied by the [material](Self::with_bark), so that goes with
    /// [`Material::white`] of roughness 1; the size of a tile is that of the [tubes](Self::with_tubes).
    pub fn with_bark_textures(mut self, textures: Textures) -> Self {
        self.bark_textures = Some(Arc::new(textures));
        self
    }

    /// The images that wood thinner than `radius` metres wears, with a tile of `tile` metres; default none, so that all wears the
    /// [same](Self::with_bark_textures). They are multiplied by the same material.
    ///
    /// Thin is what is thinner than 40% of the trunk, too, whatever the radius. Bark changes at forks alone: where a lateral
    /// thinner than that begins, or at the first fork of a branch after it has become thinner; all that it bears is thin. Towards that
    /// place the mean colours of both fade to one within twice the radius, by vertex colours. It costs no triangles, and one more
    /// part, `young bark`.
    pub fn with_young_bark(mut self, textures: Textures, tile: f32, radius: f32) -> Self {
        self.young = Some(Young { textures: Arc::new(textures), tile, radius });
        self.tubes = self.tubes.with_wind(true);
        self
    }

    /// Old bark and young of one kind: `bark` on thick wood, and on wood thinner than 3 cm ([`THIN`](Self::THIN)) the same
    /// [`young`](Bark::young), in images a quarter as wide, 64 pixels at the least. The material is white, and the size of a tile that of
    /// the bark; tubes that are set later need [`Tubes::with_tile`] again.
    ///
    /// # Errors
    /// As [`Bark::bake`].
    pub fn with_bark_of(self, bark: &Bark) -> Result<Self, AssetError> {
        self.with_bark_in_colors(bark, &bark.clone().young())
    }

    /// As [`with_bark_of`](Self::with_bark_of), the young bark given.
    pub(crate) fn with_bark_in_colors(mut self, bark: &Bark, young: &Bark) -> Result<Self, AssetError> {
        let young = young.clone().with_resolution((bark.resolution() / 4).max(64)).bake()?;
        let old = bark.bake()?;
        self.tubes = self.tubes.with_tile(old.size);
        let own = self.with_bark(Material::white().with_roughness(1.0)).with_bark_textures(old.textures);
        Ok(own.with_young_bark(young.textures, young.size, Self::THIN))
    }

    /// The radius below which wood wears young bark by default, metres.
    pub const THIN: f32 = 0.03;

    /// How the wood on cards looks; by default as the bark in the mean colour of its images, those of thin wood if there are any.
    pub fn with_twigs(mut self, material: Material) -> Self {
        self.twigs = Some(material);
        self
    }

    /// How the bark is made: collars, root flare, squares of bark, wind. Within a budget its sides and turn do not matter.
    pub fn with_tubes(mut self, tubes: Tubes) -> Self {
        self.still = !tubes.has_wind();
        self.tubes = if self.young.is_some() { tubes.with_wind(true) } else { tubes };
        self
    }

    /// The leaves that [`build`](Self::build) places; default none.
    pub fn with_foliage(mut self, foliage: Foliage) -> Self {
        self.foliage = Some(foliage);
        self
    }

    /// The most triangles of bark, leaves and cards together; `None` for all there are. Default 10,000.
    pub fn with_triangles(mut self, triangles: Option<usize>) -> Self {
        self.triangles = triangles;
        self
    }

    /// The part of the triangles that bark may take if there are leaves, 0.05 to 0.95; default 0.35. What it does not take
    /// goes to the leaves, and what they do not take goes to the bark.
    pub fn with_bark_share(mut self, share: f32) -> Self {
        self.bark_share = share;
        self
    }

    /// How many kinds of cards there are at the most, 1 to 16; default 8.
    pub fn with_kinds(mut self, kinds: u32) -> Self {
        self.kinds = kinds;
        self
    }

    /// The longest side of the cards' images, pixels: a power of two, 128 to 8192; default 1024.
    pub fn with_texture_size(mut self, side: u32) -> Self {
        self.texture_size = side;
        self
    }

    /// The side of the image of one leaf, of which there are four variants: a power of two, 32 to 2048; `None` for leaves
    /// in one colour. Default 128. Cards show the same images.
    pub fn with_leaf_size(mut self, side: Option<u32>) -> Self {
        self.leaf_size = side;
        self
    }

    /// The wood on cards, which has no images.
    fn wood(&self) -> Material {
        if let Some(twigs) = self.twigs {
            return twigs;
        }
        if let Some(young) = &self.young {
            return young::on_cards(young, self.bark);
        }
        let image = self.bark_textures.as_ref().and_then(|textures| textures.base_color());
        let mean = image.map_or([1.0; 3], Image::mean_color);
        let own = self.bark.color();
        self.bark.with_color([own[0] * mean[0], own[1] * mean[1], own[2] * mean[2]])
    }

    /// The asset of a tree, its leaves placed with this seed.
    ///
    /// # Errors
    /// An option out of range; a budget too small for the trunk and one card, [`AssetError::TooFewTriangles`]; whatever
    /// [`Foliage::place`] and [`Tubes::mesh`] refuse.
    pub fn build(&self, skeleton: &Skeleton, seed: u64) -> Result<Asset, AssetError> {
        let leaves = match &self.foliage {
            Some(foliage) => vec![foliage.place(skeleton, seed)?],
            None => Vec::new(),
        };
        self.build_with(skeleton, &leaves)
    }

    /// The asset of a tree with these leaves, such as those of a tree that grows over the years
    /// ([`Leaves::grown`]); the foliage is not asked.
    ///
    /// # Errors
    /// As [`build`](Self::build); leaves at nodes that do not exist.
    pub fn build_with(&self, skeleton: &Skeleton, leaves: &[Leaves]) -> Result<Asset, AssetError> {
        let tree = Tree::new(self, skeleton, leaves)?;
        Ok(tree.level(self.triangles, self.texture_size, None)?.0)
    }

    pub(super) fn check(&self) -> Result<(), AssetError> {
        let share = self.bark_share;
        ParameterError::unless(
            (0.05..=0.95).contains(&share),
            "AssetBuilder.bark_share",
            share,
            "0.05 to 0.95",
        )?;
        ParameterError::unless((1..=16).contains(&self.kinds), "AssetBuilder.kinds", self.kinds, "1 to 16")?;
        check_side("AssetBuilder.texture_size", self.texture_size)?;
        if let Some(textures) = &self.bark_textures {
            textures.check()?;
        }
        if let Some(young) = &self.young {
            young.textures.check()?;
            let holds = (1e-4..=1e4).contains(&young.tile);
            ParameterError::unless(holds, "AssetBuilder.young_bark.tile", young.tile, "1e-4 to 1e4 m")?;
            let holds = young.radius >= 0.0 && young.radius.is_finite();
            ParameterError::unless(
                holds,
                "AssetBuilder.young_bark.radius",
                young.radius,
                "at least 0 m and finite",
            )?;
        }
        self.bark.check()?;
        self.wood().check()?;
        Ok(())
    }

    pub(super) fn triangles(&self) -> Option<usize> {
        self.triangles
    }

    pub(super) fn texture_size(&self) -> u32 {
        self.texture_size
    }

    /// Takes thin wood out of the bark, and from both the wind that nobody asked for.
    pub(super) fn split(&self, bark: &mut Piece, skeleton: &Skeleton) -> Option<Piece> {
        let mut young = self.young.as_ref()?.split(bark, skeleton, self.tubes.has_even_texels());
        if self.still {
            bark.mesh.wind = Vec::new();
            young.mesh.wind = Vec::new();
        }
        Some(young)
    }

    pub(super) fn foliage(&self) -> Option<&Foliage> {
        self.foliage.as_ref()
    }
}

/// Sides of images that are baked.
pub(super) fn check_side(name: &str, side: u32) -> Result<(), ParameterError> {
    let holds = side.is_power_of_two() && (128..=Image::LONGEST_SIDE).contains(&side);
    ParameterError::unless(holds, name, side, "a power of two, 128 to 8192 pixels")
}

/// All that the levels of one tree share.
pub(super) struct Tree<'a> {
    builder: &'a AssetBuilder,
    skeleton: &'a Skeleton,
    dresses: Vec<Dress>,
    all: Vec<Leaf>,
    /// The bark of the dense model.
    pub(super) bark: Mesh,
    /// Triangles of all leaves.
    leaf_triangles: usize,
}

/// What the dense model looks like.
struct Reference {
    frame: Frame,
    tally: Tally,
}

/// Leaves in groups: the lowest node of each, and each leaf's group.
pub(super) struct Grouping {
    roots: Vec<u32>,
    of: Vec<u32>,
}

impl<'a> Tree<'a> {
    pub(super) fn new(
        builder: &'a AssetBuilder,
        skeleton: &'a Skeleton,
        leaves: &'a [Leaves],
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
        let bark = match builder.tubes.mesh(skeleton) {
            Ok(mesh) => mesh,
            // A tree whose wood is not thick at all still has leaves.
            Err(SurfaceError::NoRadii { .. }) if copies().next().is_some() => Mesh::default(),
            Err(error) => return Err(error.into()),
        };
        let mut dresses = Vec::new();
        let mut firsts = Vec::new();
        for leaves in leaves {
            let of_leaf = Dress::of(&leaves.leaf, builder.leaf_size, VARIANTS)?;
            firsts.push((dresses.len(), of_leaf.len()));
            dresses.extend(of_leaf);
        }
        let variant = |count: usize, leaf: usize| {
            (random::unit(0, 4, Purpose::CARDS, leaf as u64) * count as f32) as usize
        };
        let all = Leaf::all(leaves, |number, leaf| {
            let (first, count) = firsts[number];
            (first + variant(count, leaf)) as u32
        });
        let leaf_triangles = leaves.iter().map(|leaves| leaves.part().triangles() as usize).sum();
        Ok(Self { builder, skeleton, dresses, all, bark, leaf_triangles })
    }

    pub(super) fn dense_triangles(&self) -> usize {
        self.bark.triangles().len() + self.leaf_triangles
    }

    /// The dense model.
    pub(super) fn dense(&self) -> Asset {
        let whole = (0..self.all.len()).collect::<Vec<_>>();
        self.assemble(self.bark.clone(), 0.0, &whole, Vec::new(), None)
    }

    /// What the dense model looks like in pictures of so many pixels' height.
    fn look_at_it(&self, pixels: usize) -> Result<Option<Reference>, AssetError> {
        let dense = self.dense();
        let parts = dense.parts();
        let frame = match Frame::of(&parts, pixels) {
            Ok(frame) => frame,
            Err(AssetError::Nothing) => return Ok(None),
            Err(error) => return Err(error),
        };
        Ok(Some(Reference { frame, tally: tally(&parts, frame) }))
    }

    /// One level: the asset within so many triangles, and its groups of leaves, made of those of a finer one.
    pub(super) fn level(
        &self,
        triangles: Option<usize>,
        side: u32,
        finer: Option<&Grouping>,
    ) -> Result<(Asset, Grouping), AssetError> {
        let dense = self.dense_triangles();
        let most = triangles.unwrap_or(dense).min(dense);
        if most == dense {
            return Ok((self.dense(), self.regroup(usize::MAX, finer)?));
        }
        let (bark, error, kept) = self.bark_within(most)?;
        let room = most - bark.triangles().len();
        if self.leaf_triangles <= room {
            let whole = (0..self.all.len()).collect::<Vec<_>>();
            let asset = self.assemble(bark, error, &whole, Vec::new(), None);
            return Ok((asset, self.regroup(usize::MAX, finer)?));
        }
        let grouping = self.regroup(room / card::TRIANGLES, finer)?;
        let clusters = Cluster::all(self.skeleton, &self.all, &grouping.roots, &grouping.of);
        let (whole, carded) = self.share(&clusters, room);
        let (bare, cluster_of) = (self.bare(&kept), self.cluster_of(&grouping.roots));
        let source = Source {
            skeleton: self.skeleton,
            dresses: &self.dresses,
            all: &self.all,
            bark: self.builder.wood(),
            bare: &bare,
            cluster_of: &cluster_of,
        };
        let chosen: Vec<Cluster> = carded.iter().map(|&i| clusters[i].clone()).collect();
        let (kind_of, models) = cluster::kinds(&chosen, self.builder.kinds as usize);
        let mut grid = Grid::of(2 * models.len(), 1);
        grid.cell = (side as usize / grid.columns.max(grid.rows)).max(4 * atlas::PADDING);
        let models: Vec<(u32, &Cluster)> =
            models.iter().map(|&i| (carded[i as usize] as u32, &chosen[i as usize])).collect();
        let kinds = source.kinds(&models, grid);
        let whole: Vec<usize> =
            whole.iter().flat_map(|&i| clusters[i].leaves.iter().map(|&leaf| leaf as usize)).collect();
        let asset = self.fit(bark, error, &whole, &chosen, &kind_of, &kinds, grid)?;
        Ok((asset, grouping))
    }

    /// Cards as large as keeps the crown's cover, in colours that keep its mean.
    #[expect(clippy::too_many_arguments, reason = "called once")]
    fn fit(
        &self,
        bark: Mesh,
        error: f32,
        whole: &[usize],
        clusters: &[Cluster],
        kind_of: &[u32],
        kinds: &[Kind],
        grid: Grid,
    ) -> Result<Asset, AssetError> {
        let pictures: Vec<_> = kinds.iter().flat_map(|kind| kind.pictures.iter().cloned()).collect();
        let cards = |larger: f32| {
            let mut copies = vec![Vec::new(); kinds.len()];
            for (cluster, &kind) in clusters.iter().zip(kind_of) {
                copies[kind as usize].push(card::instance(cluster, &kinds[kind as usize], larger));
            }
            copies
        };
        let meshes: Vec<Mesh> = kinds.iter().map(|kind| kind.mesh.clone()).collect();
        let with = |asset: &mut Asset, larger: f32| {
            for (piece, copies) in asset.cards.iter_mut().zip(cards(larger)) {
                piece.instances = copies;
            }
        };
        let textures = atlas::textures(grid, &pictures, [1.0; 3], Some(atlas::CUTOFF))?;
        let mut asset = self.assemble(bark, error, whole, meshes, Some(textures));
        with(&mut asset, 1.0);
        // The size at which it is to be used: there the error of the bark is a pixel.
        let height = self.bark.bounds().map_or(0.0, |bounds| bounds.size().y);
        let pixels = (height / error.max(1e-9)).clamp(MEASURED.0, MEASURED.1) as usize;
        let Some(reference) = self.look_at_it(pixels)? else { return Ok(asset) };
        let wanted = reference.tally.cover;
        let measured = |asset: &Asset| tally(&asset.parts(), reference.frame);
        let (mut low, mut high) = LARGER;
        let mut larger = 1.0f32;
        let mut now = measured(&asset);
        for _ in 0..6 {
            let off = now.cover / wanted - 1.0;
            if off.abs() < 0.004 {
                break;
            }
            if off > 0.0 {
                high = larger;
            } else {
                low = larger;
            }
            // Cover grows about as the size does, for cards hide each other.
            let next = larger * (1.0 - off as f32);
            larger = if next > low && next < high { next } else { 0.5 * (low + high) };
            with(&mut asset, larger);
            now = measured(&asset);
        }
        // What is to be changed is only the colour of the cards; bark has its own already.
        let (now, wanted) = (now.color(), reference.tally.color());
        let gain = [0, 1, 2].map(|i| (wanted[i] / now[i].max(1e-6)).clamp(GAIN.0, GAIN.1));
        let textures = Arc::new(atlas::textures(grid, &pictures, gain, Some(atlas::CUTOFF))?);
        asset.cards.iter_mut().for_each(|piece| piece.textures = Some(Arc::clone(&textures)));
        Ok(asset)
    }

    /// Bark of at most its share of so many triangles, its error, and for each branch whether it is there.
    fn bark_within(&self, most: usize) -> Result<(Mesh, f32, Vec<bool>), AssetError> {
        let branches = self.skeleton.branches().len();
        if self.bark.is_empty() {
            return Ok((Mesh::default(), 0.0, vec![false; branches]));
        }
        let has_leaves = self.leaf_triangles > 0;
        // What leaves do not need is the bark's.
        let spare = most.saturating_sub(self.leaf_triangles);
        let share = if has_leaves { (most as f32 * self.builder.bark_share) as usize } else { most };
        let card = if has_leaves { card::TRIANGLES } else { 0 };
        let share = share.max(spare).min(most.saturating_sub(card));
        if self.bark.triangles().len() <= share {
            return Ok((self.bark.clone(), 0.0, vec![true; branches]));
        }
        let tubes = &self.builder.tubes;
        let within = match tubes.within_keeping(self.skeleton, share) {
            Err(SurfaceError::TooFewTriangles { least, .. }) if least + card <= most => {
                tubes.within_keeping(self.skeleton, least)
            }
            Err(SurfaceError::TooFewTriangles { least, .. }) => {
                return Err(AssetError::TooFewTriangles { triangles: most, least: least + card });
            }
            other => other,
        };
        let (level, kept) = within?;
        Ok((level.mesh, level.error, kept))
    }

    /// Groups of leaves for at most so many cards, of leaves or of the groups of a finer level.
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

    /// Which clusters are shown leaf by leaf, and which as cards: first come those farthest out, whose leaves make the
    /// crown's outline.
    fn share(&self, clusters: &[Cluster], room: usize) -> (Vec<usize>, Vec<usize>) {
        let bounds = crate::Bounds::of(clusters.iter().map(|cluster| cluster.middle));
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
            let more = cost.saturating_sub(card::TRIANGLES);
            if more > left {
                break;
            }
            left -= more;
            whole += 1;
        }
        let mut cards = order.split_off(whole);
        order.sort_unstable();
        cards.sort_unstable();
        (order, cards)
    }

    /// For each node whether no bark is about its internode.
    fn bare(&self, kept: &[bool]) -> Vec<bool> {
        let mut bare = vec![false; self.skeleton.len()];
        for (branch, kept) in self.skeleton.branches().iter().zip(kept) {
            branch.nodes().iter().skip(1).for_each(|&node| bare[node as usize] = !kept);
        }
        bare
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

    /// The asset of this bark, these leaves whole, and cards of these meshes that stand nowhere yet.
    fn assemble(
        &self,
        bark: Mesh,
        error: f32,
        whole: &[usize],
        cards: Vec<Mesh>,
        textures: Option<Textures>,
    ) -> Asset {
        let mut instances: Vec<Vec<Instance>> = vec![Vec::new(); self.dresses.len()];
        for &leaf in whole {
            instances[self.all[leaf].dress as usize].push(self.all[leaf].copy);
        }
        let leaves = self.dresses.iter().zip(instances).filter(|(_, instances)| !instances.is_empty());
        let leaves = leaves.map(|(dress, instances)| Piece {
            name: "leaves",
            mesh: with_tangents(dress.mesh.clone(), dress.textures.as_deref()),
            material: dress.material,
            textures: dress.textures.clone(),
            instances,
        });
        // Materials are multiplied with the images, which have all the colour.
        let material = Material::leaf().with_color([1.0; 3]);
        let textures = textures.map(Arc::new);
        let cards = cards.into_iter().map(|mesh| Piece {
            name: "cards",
            mesh,
            material,
            textures: textures.clone(),
            instances: Vec::new(),
        });
        let mut bark = Piece {
            name: "bark",
            mesh: bark,
            material: self.builder.bark,
            textures: self.builder.bark_textures.clone(),
            instances: vec![Instance::IDENTITY],
        };
        let young = self.builder.split(&mut bark, self.skeleton);
        Asset { bark, young, coats: Vec::new(), leaves: leaves.collect(), cards: cards.collect(), error }
    }
}

/// Cover and colour of a model from all directions in which it is measured.
fn tally(parts: &[Part<'_>], frame: Frame) -> Tally {
    let skins = skins(parts);
    let drawn = drawn(parts, &skins);
    let each = parallel::map(VIEWS.len(), |i| {
        let (yaw, lift) = VIEWS[i];
        Tally::of(&draw(&drawn, frame.view(yaw, lift), frame.width, frame.height, POINTS).finish(lit))
    });
    let mut sum = Tally::default();
    for tally in &each {
        sum.add(tally);
    }
    sum
}
