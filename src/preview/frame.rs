//! From triangles to pixels, a strip of rows at a time.
//!
//! Each strip holds for every sample the nearest triangle and its nearness. Only when all are in is anything
//! shaded, once per pixel and triangle. Thin triangles (see [`raster`]) are laid over the pixels by their
//! area.

mod cast;
mod soft;
mod strip;
mod tone;
mod worn;

use super::camera::View;
use super::light::{Light, Lit, Seen};
use super::raster;
use super::ray::{Cast, Sunbeams};
use super::wear::Cutout;
use super::{Placed, Preview};
use crate::math;
use crate::observer::{Cancelled, Observer, Work, report};
use crate::parallel;
use cast::{Glimpse, Sun};
use glam::{Vec2, Vec3, Vec3Swizzles};
use soft::{Rows, Texel};
use std::ops::Range;
use strip::{Crack, NOTHING, POINTS, SOLID, Strip};
use tone::Tones;

/// Rows of pixels in a strip: its samples stay in the cache.
const STRIP: usize = 24;
/// The same where rays are cast, which takes longer: whoever watches wants to hear of it.
const CAST_STRIP: usize = 8;
/// Strips that a group draws before the pixels are taken from it.
const TURNS: usize = 4;
/// Groups of strips that are drawn side by side. Each remembers shades of its own.
const GROUPS: usize = 4;
/// Rays to the sun from a pixel of the ground; its neighbours' add to them.
const GROUND_BEAMS: usize = 4;
/// Rays to the sun from the middle of a triangle.
const FACET_BEAMS: usize = 4;
/// Triangles lower than this many samples are thin.
const THIN: f32 = 1.5;
/// The same for leaves: their triangles lie side by side, so that what one misses the next one meets.
const THIN_LEAF: f32 = 0.4;
/// A facet smaller than this many pixels is shaded once and not at every pixel.
const SMALL: f32 = 4.0;
/// The same of a facet with images, which are not of one colour.
const SMALL_WORN: f32 = 1.0;

/// The weights of a triangle's corners in its middle.
const MIDDLE: [f32; 3] = [1.0 / 3.0; 3];

/// A triangle turned towards the camera.
#[derive(Debug, Clone, Copy)]
struct Facet {
    part: u32,
    corners: [u32; 3],
    flipped: bool,
    thin: bool,
    small: bool,
}

/// Everything that is to be seen, projected.
pub(super) struct Frame<'a> {
    preview: &'a Preview,
    parts: &'a [Placed<'a>],
    view: &'a View,
    light: Light<'a>,
    solid: Option<&'a dyn Cast>,
    /// Height of the ground, and the middle and radius of the disc of it that is drawn.
    ground: Option<(Vec3, f32)>,
    /// `true` if something is below the ground.
    buries: bool,
    projected: Vec<Vec<Vec3>>,
    facets: Vec<Facet>,
    /// The facets of each strip, and where they start.
    members: Vec<u32>,
    starts: Vec<usize>,
    columns: usize,
    samples: usize,
    /// Rows of pixels in a strip.
    strip: usize,
}

impl<'a> Frame<'a> {
    pub(super) fn new(
        preview: &'a Preview,
        parts: &'a [Placed<'a>],
        view: &'a View,
        light: Light<'a>,
        solid: Option<&'a dyn Cast>,
        ground: Option<(Vec3, f32)>,
    ) -> Self {
        let samples = preview.supersampling as usize;
        let below = |height: f32| {
            let low = parts.iter().flat_map(|part| part.positions.iter()).map(|place| place.y);
            low.fold(f32::INFINITY, f32::min) < height
        };
        let buries = ground.is_some_and(|(middle, _)| below(middle.y));
        let mut frame = Self {
            preview,
            parts,
            view,
            light,
            solid,
            ground,
            buries,
            projected: Vec::new(),
            facets: Vec::new(),
            members: Vec::new(),
            starts: Vec::new(),
            columns: preview.width as usize * samples,
            samples,
            strip: if solid.is_some() { CAST_STRIP } else { STRIP },
        };
        frame.project();
        frame.sort();
        frame
    }

    fn project(&mut self) {
        let behind = Vec3::NAN;
        for (number, part) in self.parts.iter().enumerate() {
            let project = |&position: &Vec3| self.view.project(position).unwrap_or(behind);
            let seen: Vec<_> = part.positions.iter().map(project).collect();
            for corners in part.triangles() {
                let places = corners.map(|corner| seen[corner as usize]);
                let area = raster::double_area(places);
                // A NaN fails this too: what reaches behind the camera is left out.
                if area < 0.0 || (area > 0.0 && part.two_sided()) {
                    let thin = raster::is_thin(places, if part.two_sided() { THIN_LEAF } else { THIN });
                    let [a, b, c] = places.map(Vec3::xy);
                    let extent = (a.max(b).max(c) - a.min(b).min(c)).max_element();
                    let small =
                        extent < if part.wear().is_some() { SMALL_WORN } else { SMALL } * self.samples as f32;
                    self.facets.push(Facet {
                        part: number as u32,
                        corners,
                        flipped: area > 0.0,
                        thin,
                        small,
                    });
                }
            }
            self.projected.push(seen);
        }
    }

    fn places(&self, facet: Facet) -> [Vec3; 3] {
        let seen = &self.projected[facet.part as usize];
        facet.corners.map(|corner| seen[corner as usize])
    }

    /// The strips a facet reaches.
    fn strips(&self, facet: Facet, strips: usize) -> Range<usize> {
        let margin = if facet.thin { 2.0 * self.samples as f32 } else { 0.0 };
        let (first, last) = raster::rows(self.places(facet), margin);
        let height = (self.strip * self.samples) as f32;
        if last < 0.0 || first >= height * strips as f32 {
            return 0..0;
        }
        (first / height).max(0.0) as usize..((last / height) as usize + 1).min(strips)
    }

    /// A counting sort of the facets by strip.
    fn sort(&mut self) {
        let strips = (self.preview.height as usize).div_ceil(self.strip);
        let mut starts = vec![0usize; strips + 1];
        for &facet in &self.facets {
            for strip in self.strips(facet, strips) {
                starts[strip + 1] += 1;
            }
        }
        for strip in 0..strips {
            starts[strip + 1] += starts[strip];
        }
        let mut next = starts.clone();
        let mut members = vec![0; starts[strips]];
        for (index, &facet) in self.facets.iter().enumerate() {
            for strip in self.strips(facet, strips) {
                members[next[strip]] = index as u32;
                next[strip] += 1;
            }
        }
        (self.starts, self.members) = (starts, members);
    }

    /// Draws everything; `pixels` are the rows of a picture, `alpha` too if it has any. On several threads, with the
    /// feature `parallel`, each of which draws every fourth strip.
    pub(super) fn draw(
        &self,
        pixels: &mut [[u8; 3]],
        alpha: &mut [u8],
        observer: &dyn Observer,
    ) -> Result<(), Cancelled> {
        let strips = (self.preview.height as usize).div_ceil(self.strip);
        let mut groups: Vec<_> = (0..GROUPS).map(|_| Group::new(self)).collect();
        // Strips that each group draws at a time; triangles are fast.
        let turns = if self.solid.is_some() { 1 } else { TURNS };
        let (width, tones) = (self.preview.width as usize, Tones::new());
        let mut rows = Rows::new(width);
        for start in (0..strips).step_by(GROUPS * turns) {
            let end = (start + GROUPS * turns).min(strips);
            let drawn = parallel::each_mut(&mut groups, |first, group| {
                let mine = (start + first..end).step_by(GROUPS);
                mine.map(|index| self.draw_strip(index, group)).collect::<Vec<_>>()
            });
            let mut drawn: Vec<_> = drawn.into_iter().map(Vec::into_iter).collect();
            for index in start..end {
                rows.extend(drawn[(index - start) % GROUPS].next().unwrap_or_default());
            }
            let (first, finished) = rows.finished(end == strips);
            for (row, finished) in (first..).zip(finished) {
                for (column, (color, covered)) in finished.into_iter().enumerate() {
                    let at = row * width + column;
                    pixels[at] = tones.of(color / covered.max(1e-6), (column, row));
                    if let Some(alpha) = alpha.get_mut(at) {
                        *alpha = (covered.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
                    }
                }
            }
            if self.solid.is_some_and(Cast::is_full) {
                break;
            }
            report(observer, Work::Picture, end as f32 / strips as f32)?;
        }
        Ok(())
    }

    fn draw_strip(&self, index: usize, group: &mut Group) -> Vec<Texel> {
        let (width, height) = (self.preview.width as usize, self.preview.height as usize);
        let Group { strip, shades } = group;
        let rows = self.strip.min(height - index * self.strip);
        strip.clear(index * self.strip * self.samples, rows * self.samples);
        self.bury(strip);
        let members = &self.members[self.starts[index]..self.starts[index + 1]];
        self.fill(members, strip);
        self.cast(strip);
        self.strew(members, strip, shades);
        let pixel = |i: usize| {
            let place = (i % width, i / width);
            self.pixel(strip, shades, place, index * self.strip)
        };
        (0..width * rows).map(pixel).collect()
    }

    /// Hides everything below the ground.
    fn bury(&self, strip: &mut Strip) {
        let Some((middle, _)) = self.ground.filter(|_| self.buries) else { return };
        for row in 0..strip.rows {
            for column in 0..self.columns {
                let (x, y) = (column as f32 + 0.5, (strip.top + row) as f32 + 0.5);
                let place = self.view.ground(x, y, middle.y).and_then(|point| self.view.project(point));
                if let Some(place) = place {
                    strip.solid[row * self.columns + column] = place.z;
                }
            }
        }
    }

    fn fill(&self, members: &[u32], strip: &mut Strip) {
        let rows = strip.top..strip.top + strip.rows;
        for &member in members {
            let facet = self.facets[member as usize];
            if facet.thin {
                continue;
            }
            let places = self.places(facet);
            let mut put = |x: usize, y: usize, nearness: f32| {
                let at = (y - strip.top) * self.columns + x;
                if nearness > strip.solid[at] {
                    strip.solid[at] = nearness;
                    strip.facets[at] = member;
                }
            };
            let Some(cutout) = self.cutout(facet) else {
                raster::fill(places, self.columns, rows.clone(), put);
                continue;
            };
            raster::fill(places, self.columns, rows.clone(), |x, y, nearness| {
                if cutout.is_there(x as f32 + 0.5, y as f32 + 0.5) {
                    put(x, y, nearness);
                }
            });
        }
    }

    fn strew(&self, members: &[u32], strip: &mut Strip, shades: &mut Shades) {
        let thin = || members.iter().map(|&m| (m, self.facets[m as usize])).filter(|(_, facet)| facet.thin);
        // Surfaces of many small triangles hide what is behind them, although none of them is solid.
        strip.nearest.copy_from_slice(&strip.solid);
        let rows = strip.top..strip.top + strip.rows;
        let mut cracks = Vec::new();
        for (member, facet) in thin() {
            let cutout = self.cutout(facet);
            raster::fill(self.places(facet), self.columns, rows.clone(), |x, y, nearness| {
                if cutout.as_ref().is_some_and(|cutout| !cutout.is_there(x as f32 + 0.5, y as f32 + 0.5)) {
                    return;
                }
                let at = (y - strip.top) * self.columns + x;
                strip.nearest[at] = strip.nearest[at].max(nearness);
                if strip.facets[at] == NOTHING && nearness > strip.solid[at] {
                    cracks.push(Crack { column: x, row: y - strip.top, member, nearness });
                }
            });
        }
        let margin = self.samples as f32;
        strip.close(cracks, self.columns, |nearness| self.view.step(nearness) * 2.0 * margin);
        let low = Vec2::new(-margin, strip.top as f32 - margin);
        let high = Vec2::new(self.columns as f32, (strip.top + strip.rows) as f32) + margin;
        for (member, facet) in thin() {
            let cutout = self.cutout(facet);
            raster::strew(self.places(facet), low, high, |place, area| {
                if cutout.as_ref().is_some_and(|cutout| !cutout.is_there(place.x, place.y)) {
                    return;
                }
                let at = strip.sample(place, self.columns);
                let limit = place.z + self.view.step(place.z) * 2.0 * margin;
                if strip.solid[at] <= limit {
                    let seen = strip.nearest[at] <= limit;
                    let color = seen.then(|| self.shade_middle(member, shades));
                    strip.lay(place, area, color, self.samples);
                }
            });
            self.count(facet, cutout.as_ref(), strip);
        }
    }

    /// Counts the points of each pixel that lie in a thin facet and behind nothing solid.
    fn count(&self, facet: Facet, cutout: Option<&Cutout<'_>>, strip: &mut Strip) {
        let finer = POINTS as f32 / self.samples as f32;
        let places = self.places(facet).map(|place| place * Vec3::new(finer, finer, 1.0));
        let (top, rows) = (strip.top / self.samples, strip.rows / self.samples);
        raster::fill(places, strip.width * POINTS, top * POINTS..(top + rows) * POINTS, |x, y, nearness| {
            let place = Vec3::new((x as f32 + 0.5) / finer, (y as f32 + 0.5) / finer, nearness);
            if cutout.is_some_and(|cutout| !cutout.is_there(place.x, place.y)) {
                return;
            }
            let bias = self.view.step(nearness) * 2.0 * self.samples as f32;
            let at = strip.sample(place, self.columns);
            if strip.solid[at] <= nearness + bias {
                let pixel = (y / POINTS - top) * strip.width + x / POINTS;
                strip.over[pixel].hit(x % POINTS, y % POINTS, strip.facets[at] == NOTHING);
            }
        });
    }

    /// The colour of a facet at its middle, worked out no more than once. A leaf as small as that sees the same of sun
    /// and sky all over.
    fn shade_middle(&self, member: u32, shades: &mut Shades) -> Vec3 {
        let facet = self.facets[member as usize];
        let Shades { facets, copies } = shades;
        *facets[member as usize].get_or_insert_with(|| {
            let part = &self.parts[facet.part as usize];
            if let Some((copy, middle)) = part.copy_of(facet.corners[0]).filter(|_| facet.small) {
                let seen = &mut copies[facet.part as usize][copy];
                let seen = *seen.get_or_insert_with(|| self.light.seen(middle));
                let normal = self.normal(facet, MIDDLE);
                if let Some(surface) = self.worn_middle(facet, middle) {
                    return self.light.falling_on(seen, normal, part.two_sided(), &surface);
                }
                part.color(facet.corners, MIDDLE) * self.light.falling(seen, normal, part.two_sided())
            } else {
                let corners = facet.corners.map(|corner| part.positions[corner as usize]);
                let middle = corners.iter().sum::<Vec3>() / 3.0;
                if let Some(surface) = self.worn_middle(facet, middle) {
                    let (normal, beams) = (self.normal(facet, MIDDLE), Sunbeams::all(FACET_BEAMS, 0, 0));
                    return self.light.shaded(middle, normal, part.two_sided(), &surface, beams);
                }
                self.shade(facet, MIDDLE, middle, Sunbeams::all(FACET_BEAMS, 0, 0))
            }
        })
    }

    /// The normal of a facet, on the side that is seen, at a point with these weights of its corners.
    fn normal(&self, facet: Facet, weights: [f32; 3]) -> Vec3 {
        let normals = self.parts[facet.part as usize].normals(facet.corners);
        let normal = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
        let normal = normal.normalize_or(normals[0]);
        if facet.flipped { -normal } else { normal }
    }

    /// The colour of a facet at a point with these weights of its corners.
    fn shade(&self, facet: Facet, weights: [f32; 3], point: Vec3, beams: Sunbeams) -> Vec3 {
        let part = &self.parts[facet.part as usize];
        let light = self.light.on(point, self.normal(facet, weights), part.two_sided(), beams);
        part.color(facet.corners, weights) * light
    }

    fn shade_sample(&self, facet: Facet, x: f32, y: f32, nearness: f32) -> Vec3 {
        let places = self.places(facet);
        let place = Vec3::new(x, y, 0.0);
        let whole = raster::double_area(places);
        let share = |a: Vec3, b: Vec3| (raster::double_area([a, b, place]) / whole).clamp(0.0, 1.0);
        let (second, third) = (share(places[2], places[0]), share(places[0], places[1]));
        let beams = Sunbeams::all(FACET_BEAMS, x as usize, y as usize);
        let (weights, point) = ([1.0 - second - third, second, third], self.view.position(x, y, nearness));
        if let Some(surface) = self.worn(facet, weights, point, (x, y)) {
            let part = &self.parts[facet.part as usize];
            return self.light.shaded(point, self.normal(facet, weights), part.two_sided(), &surface, beams);
        }
        self.shade(facet, weights, point, beams)
    }

    /// A pixel, its sunlight from solids apart.
    fn pixel(&self, strip: &Strip, shades: &mut Shades, (column, row): (usize, usize), top: usize) -> Texel {
        let n = self.samples;
        let (mut color, mut holes) = (Vec3::ZERO, 0u32);
        let mut sun = Sun::default();
        let mut last = (NOTHING, Vec3::ZERO);
        for sample in 0..n * n {
            let (x, y) = (column * n + sample % n, row * n + sample / n);
            let at = y * self.columns + x;
            let member = strip.facets[at];
            if member == NOTHING {
                holes += 1;
                continue;
            }
            if member == SOLID {
                color += strip.seen[at].sky;
                sun.add(&strip.seen[at]);
                continue;
            }
            if member != last.0 {
                let facet = self.facets[member as usize];
                let (x, y) = (x as f32 + 0.5, (y + strip.top) as f32 + 0.5);
                let color = if facet.small {
                    self.shade_middle(member, shades)
                } else {
                    self.shade_sample(facet, x, y, strip.solid[at])
                };
                last = (member, color);
            }
            color += last.1;
        }
        let whole = (n * n) as f32;
        let mut covered = whole;
        if holes > 0 {
            let (ground, opacity) = self.backdrop(column, top + row);
            color += ground.sky * holes as f32;
            sun.add(&Glimpse { sun: ground.sun * holes as f32, ..ground });
            covered -= holes as f32 * (1.0 - opacity);
        }
        let (mut color, mut covered) = (color / whole, covered / whole);
        let mut lit = sun.color / whole;
        if let Some((thin, share)) = strip.over[row * strip.width + column].cover(holes as f32 / whole) {
            color = color.lerp(thin, share);
            covered += (1.0 - covered) * share;
            lit *= 1.0 - share;
        }
        let Glimpse { point, normal, .. } = sun.first;
        let pixel = self.view.sample(point) * n as f32;
        Texel { color, covered, sun: lit, light: sun.light(), point, normal, pixel }
    }

    /// Background where there is no tree, times its opacity, and the opacity.
    fn backdrop(&self, column: usize, row: usize) -> (Glimpse, f32) {
        if !self.preview.transparent {
            return (self.ground_or_sky(column, row), 1.0);
        }
        // A shadow is black that lets the rest of the light through; the eye judges that in sRGB, where pictures are
        // laid over each other.
        let shadow = self
            .ground(column, row)
            .map_or(0.0, |(lit, fade, _)| fade * (1.0 - math::srgb(lit.sky.y + lit.sun.y * lit.light.seen)));
        (Glimpse::default(), shadow)
    }

    /// The background, and the shadow on the ground.
    fn ground_or_sky(&self, column: usize, row: usize) -> Glimpse {
        let down = (row as f32 + 0.5) / self.preview.height as f32;
        let [top, bottom] = self.preview.background.map(Vec3::from_array);
        let background = top.lerp(bottom, down);
        let Some((lit, fade, point)) = self.ground(column, row) else {
            return Glimpse { sky: background, ..Glimpse::default() };
        };
        let color = self.preview.ground.map_or(background, Vec3::from_array);
        let sky = background.lerp(color * lit.sky, fade);
        Glimpse { sky, sun: color * lit.sun * fade, light: lit.light, point, normal: Vec3::Y }
    }

    /// Light on the ground that is seen there, its weight (falling to 0 at the ground's edge), and
    /// the point; `None` beyond the edge.
    fn ground(&self, column: usize, row: usize) -> Option<(Lit, f32, Vec3)> {
        let (middle, radius) = self.ground?;
        let scale = self.samples as f32;
        let (x, y) = ((column as f32 + 0.5) * scale, (row as f32 + 0.5) * scale);
        let point = self.view.ground(x, y, middle.y)?;
        let outward = point.distance(middle) / radius;
        let fade = ((1.0 - outward) * 2.0).min(1.0);
        let beams = Sunbeams::all(GROUND_BEAMS, column, row);
        (outward < 1.0).then(|| (self.light.on_ground(point, beams), fade * fade * (3.0 - 2.0 * fade), point))
    }
}

/// State that strips drawn one after the other share.
struct Group {
    strip: Strip,
    shades: Shades,
}

impl Group {
    fn new(frame: &Frame<'_>) -> Self {
        let strip = Strip::new(frame.columns, frame.strip * frame.samples, frame.samples);
        Self { strip, shades: Shades::new(frame.facets.len(), frame.parts) }
    }
}

/// Results that are asked for again.
struct Shades {
    /// The colour of each facet at its middle.
    facets: Vec<Option<Vec3>>,
    /// View of each copy of each part.
    copies: Vec<Vec<Option<Seen>>>,
}

impl Shades {
    fn new(facets: usize, parts: &[Placed<'_>]) -> Self {
        let copies = parts.iter().map(|part| vec![None; part.copies()]).collect();
        Self { facets: vec![None; facets], copies }
    }
}
