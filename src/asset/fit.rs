//! Cards as large, as dense and in such colours that a level looks like the dense model.

use super::atlas::{self, Grid};
use super::bake::{Baked, Sample, Wanted};
use super::card::{self, Kind};
use super::cluster::Cluster;
use super::measure::{self, Frame, Tally, draw, drawn, lit, skins};
use super::skin::Skin;
use super::{Asset, AssetError};
use crate::observer::Watch;
use crate::parallel;
use crate::surface::Part;
use std::f32::consts::TAU;
use std::sync::Arc;

/// The least and the greatest height of the pictures in which cover and colour are measured, pixels.
const MEASURED: (f32, f32) = (8.0, 240.0);
/// Points along each side of one.
const POINTS: usize = measure::SAMPLES;
/// Directions from which they are measured: turned about the vertical, lifted.
const VIEWS: [(f32, f32); 4] =
    [(0.2, 0.1), (0.2 + 0.25 * TAU, 0.1), (0.2 + 0.5 * TAU, 0.1), (0.2 + 0.75 * TAU, 0.1)];
/// Range of a card's size relative to the twigs it stands for.
const LARGER: (f32, f32) = (0.6, 1.8);
/// Range of the factor on the alpha of cards, if their size is not enough.
pub(super) const THICKER: (f32, f32) = (0.2, 4.0);
/// The same of cards of bare twigs, whose lines would become dashes.
pub(super) const TWIGS_THICKER: (f32, f32) = (1.0, 4.0);
/// Range of the factor on the colours of cards.
const GAIN: (f32, f32) = (0.6, 1.6);
/// Slowest growth of the cover with the size of cards that a step reckons with.
const SLOWEST: f32 = 0.2;
/// Cover that is no more off than this is right.
const NEAR: f64 = 0.004;

/// The look of a model, at every size.
#[derive(Debug)]
pub(super) struct Look {
    frame: Frame,
    /// Square metres that are hidden, all directions together.
    cover: f64,
    /// The mean of them, linear.
    color: [f32; 3],
}

impl Look {
    /// The look of a model of triangles without holes, whose cover is the same at every size.
    pub(super) fn of(parts: &[Part<'_>], watch: &Watch<'_>) -> Result<Self, AssetError> {
        let frame = Frame::of(parts, MEASURED.1 as usize)?;
        let [seen] = seen(parts, &skins(parts), frame, Wanted::Surface, [&lit], watch);
        watch.pass(0)?;
        Ok(Self { frame, cover: seen.cover * area(frame), color: seen.color() })
    }

    /// The area that a model covers more than this look's, as a share of that, in pictures in which the look's
    /// model is `pixels` pixels high.
    fn excess(
        &self,
        parts: &[Part<'_>],
        skins: &[Option<Skin>],
        pixels: usize,
        watch: &Watch<'_>,
    ) -> Result<f64, AssetError> {
        let frame = self.frame.at(pixels);
        let [seen] = seen(parts, skins, frame, Wanted::Cover, [&lit], watch);
        watch.pass(0)?;
        Ok(seen.cover * area(frame) / self.cover.max(1e-12) - 1.0)
    }

    /// The factor on the colours of the last `cards` parts of a model, within [`GAIN`], that takes its colour to this
    /// look's, in pictures in which the look's model is `pixels` pixels high.
    fn gain(
        &self,
        parts: &[Part<'_>],
        cards: usize,
        pixels: usize,
        watch: &Watch<'_>,
    ) -> Result<[f32; 3], AssetError> {
        let first = parts.len() - cards;
        let of_cards = |sample: &Sample| if sample.drawn as usize >= first { lit(sample) } else { [0.0; 3] };
        let frame = self.frame.at(pixels);
        let seen = seen(parts, &skins(parts), frame, Wanted::Surface, [&lit, &of_cards], watch);
        watch.pass(0)?;
        let [all, of_cards] = seen.map(|tally| tally.color());
        // Cards alone change colour, not what else is seen: so once more. The whole way would make cards that are seen
        // less from farther off stand for the colour of wood.
        let toward = |i: usize, gain: f32| {
            let now = all[i] + (gain - 1.0) * of_cards[i];
            (gain * self.color[i] / now.max(1e-6)).clamp(GAIN.0, GAIN.1)
        };
        Ok([0, 1, 2].map(|i| toward(i, toward(i, 1.0))))
    }
}

/// Square metres of a covered pixel in one direction, where small pictures are drawn several times.
fn area(frame: Frame) -> f64 {
    let side = f64::from(frame.pixel());
    side * side / frame.times() as f64
}

/// Makes the colour of a sample.
type Shade<'a> = &'a (dyn Fn(&Sample) -> [f32; 3] + Sync);

/// Cover and colours of a model from all directions together, with the colours that each of `shades` makes.
fn seen<const N: usize>(
    parts: &[Part<'_>],
    skins: &[Option<Skin>],
    frame: Frame,
    wanted: Wanted,
    shades: [Shade<'_>; N],
    watch: &Watch<'_>,
) -> [Tally; N] {
    let (drawn, times) = (drawn(parts, skins), frame.times());
    let each = parallel::map(VIEWS.len() * times, |i| {
        let (yaw, lift) = VIEWS[i / times];
        let view = frame.view_beside(yaw, lift, i % times);
        let raster = draw(&drawn, view, [frame.width, frame.height], POINTS, wanted, watch);
        shades.map(|shade| Tally::of(&raster.finish(shade)))
    });
    let mut sums = [Tally::default(); N];
    for tallies in &each {
        sums.iter_mut().zip(tallies).for_each(|(sum, tally)| sum.add(tally));
    }
    sums
}

/// Cards before it is known how large they are.
#[derive(Clone, Copy)]
pub(super) struct Cards<'a> {
    pub(super) clusters: &'a [&'a Cluster],
    pub(super) kind_of: &'a [u32],
    pub(super) kinds: &'a [Kind],
    pub(super) grid: Grid,
    /// Range of the factor on their alpha.
    pub(super) thicker: (f32, f32),
    pub(super) watch: &'a Watch<'a>,
}

impl Cards<'_> {
    /// Places them in an asset that has their meshes, as large as keeps the cover of the dense model's `look` at the size at which
    /// the asset of a tree of this `height` is to be used; if they would have to be larger than [`LARGER`], their alpha grows too. Colours keep the mean.
    pub(super) fn fit<'l>(
        &self,
        asset: &mut Asset,
        height: f32,
        look: impl FnOnce() -> Result<Option<&'l Look>, AssetError>,
    ) -> Result<(), AssetError> {
        self.place(asset, 1.0);
        self.dress(asset, 1.0, [1.0; 3])?;
        let Some(look) = look()? else { return Ok(()) };
        // The size at which it is to be used: there the error of the bark is a pixel.
        let pixels = asset.pixels(height).clamp(MEASURED.0, MEASURED.1) as usize;
        // Images stay while sizes change.
        let worn = skins(&asset.parts());
        let excess = |asset: &Asset| look.excess(&asset.parts(), &worn, pixels, self.watch);
        let (mut larger, (mut low, mut high)) = (1.0f32, LARGER);
        let mut off = excess(asset)?;
        let mut best = (off, larger);
        // Growth of the cover with the size: about even, for cards hide each other; then as the last step found it.
        let mut slope = 1.0;
        for _ in 0..7 {
            if off.abs() < NEAR {
                break;
            }
            if off > 0.0 {
                high = larger;
            } else {
                low = larger;
            }
            let before = (off, larger);
            let next = larger - off as f32 / slope;
            larger = if next > low && next < high { next } else { 0.5 * (low + high) };
            self.place(asset, larger);
            off = excess(asset)?;
            slope = ((off - before.0) as f32 / (larger - before.1)).max(SLOWEST);
            if off.abs() < best.0.abs() {
                best = (off, larger);
            }
        }
        (off, larger) = best;
        self.place(asset, larger);
        let (mut thicker, (mut low, mut high)) = (1.0f32, self.thicker);
        let mut best = (off, thicker);
        for _ in 0..6 {
            if off.abs() < 3.0 * NEAR {
                break;
            }
            if off > 0.0 {
                high = thicker;
            } else {
                low = thicker;
            }
            if low >= high {
                break;
            }
            thicker = (low * high).sqrt();
            self.dress(asset, thicker, [1.0; 3])?;
            off = look.excess(&asset.parts(), &skins(&asset.parts()), pixels, self.watch)?;
            if off.abs() < best.0.abs() {
                best = (off, thicker);
            }
        }
        if (best.1 - thicker).abs() > 0.0 {
            self.dress(asset, best.1, [1.0; 3])?;
        }
        let cards = asset.cards.iter().filter(|piece| !piece.instances.is_empty()).count();
        let gain = look.gain(&asset.parts(), cards, pixels, self.watch)?;
        self.dress(asset, best.1, gain)
    }

    fn place(&self, asset: &mut Asset, larger: f32) {
        asset.cards.iter_mut().for_each(|piece| piece.instances.clear());
        for (cluster, &kind) in self.clusters.iter().zip(self.kind_of) {
            let copy = card::instance(cluster, &self.kinds[kind as usize], larger);
            asset.cards[kind as usize].instances.push(copy);
        }
    }

    fn dress(&self, asset: &mut Asset, thicker: f32, gain: [f32; 3]) -> Result<(), AssetError> {
        let pictures = self.kinds.iter().flat_map(|kind| &kind.pictures);
        let pictures: Vec<Baked> = pictures.map(|picture| picture.thickened(thicker)).collect();
        let textures =
            Arc::new(atlas::textures(self.grid, &pictures, gain, Some(atlas::CUTOFF), self.watch)?);
        asset.cards.iter_mut().for_each(|piece| piece.textures = Some(Arc::clone(&textures)));
        Ok(())
    }
}
