//! Cards as large, as dense and in such colours that a level looks like the dense model.

use super::atlas::{self, Grid};
use super::bake::Baked;
use super::card::{self, Kind};
use super::cluster::Cluster;
use super::measure::{self, Frame, Tally, draw, drawn, lit, skins};
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
        let look = Self::at(parts, Frame::of(parts, MEASURED.1 as usize)?, watch);
        watch.pass(0)?;
        Ok(look)
    }

    /// The look in pictures of this size.
    fn at(parts: &[Part<'_>], frame: Frame, watch: &Watch<'_>) -> Self {
        let skins = skins(parts);
        let drawn = drawn(parts, &skins);
        let times = frame.times();
        let each = parallel::map(VIEWS.len() * times, |i| {
            let (yaw, lift) = VIEWS[i / times];
            let view = frame.view_beside(yaw, lift, i % times);
            Tally::of(&draw(&drawn, view, [frame.width, frame.height], POINTS, watch).finish(lit))
        });
        let mut sum = Tally::default();
        for tally in &each {
            sum.add(tally);
        }
        let side = f64::from(frame.pixel());
        let area = side * side / times as f64;
        Self { frame, cover: sum.cover * area, color: sum.color() }
    }

    /// Compares a model, `parts`, with this look in pictures in which the look's model is `pixels` pixels
    /// high: the area that it covers more, as a share of this look's, and the factor that takes its colour to
    /// this look's.
    fn beside(&self, parts: &[Part<'_>], pixels: usize, watch: &Watch<'_>) -> (f64, [f32; 3]) {
        let now = Self::at(parts, self.frame.at(pixels), watch);
        let gain = [0, 1, 2].map(|i| self.color[i] / now.color[i].max(1e-6));
        (now.cover / self.cover.max(1e-12) - 1.0, gain)
    }
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
        let beside = |asset: &Asset| -> Result<(f64, [f32; 3]), AssetError> {
            let found = look.beside(&asset.parts(), pixels, self.watch);
            self.watch.pass(0)?;
            Ok(found)
        };
        let (mut larger, (mut low, mut high)) = (1.0f32, LARGER);
        let (mut off, mut gain) = beside(asset)?;
        let mut best = (off, gain, larger);
        for _ in 0..7 {
            if off.abs() < NEAR {
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
            self.place(asset, larger);
            (off, gain) = beside(asset)?;
            if off.abs() < best.0.abs() {
                best = (off, gain, larger);
            }
        }
        (off, gain, larger) = best;
        self.place(asset, larger);
        let (mut thicker, (mut low, mut high)) = (1.0f32, self.thicker);
        let mut best = (off, gain, thicker);
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
            (off, gain) = beside(asset)?;
            if off.abs() < best.0.abs() {
                best = (off, gain, thicker);
            }
        }
        (_, gain, thicker) = best;
        // Cards alone change colour, not what else is seen: so once more.
        let mut all = [1.0f32; 3];
        for round in 0..2 {
            all = [0, 1, 2].map(|i| (all[i] * gain[i]).clamp(GAIN.0, GAIN.1));
            self.dress(asset, thicker, all)?;
            if round == 0 {
                (_, gain) = beside(asset)?;
            }
        }
        Ok(())
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
