//! Pixels, and what can be drawn on them without a third dimension.

use super::{PreviewError, font};
use crate::ParameterError;
use glam::Vec2;
use std::borrow::Cow;
use std::io::{self, Write};

/// Longest side of a picture, pixels.
pub(super) const LONGEST_SIDE: u32 = 16_384;
/// Most pixels of a picture: 192 MiB.
pub(super) const MOST_PIXELS: u64 = 1 << 26;

/// An RGB picture with 8 bits per channel, sRGB, opaque unless it is drawn otherwise. x goes right, y goes
/// down, (0, 0) is the upper left corner of the upper left pixel.
///
/// Whatever is drawn outside is cut off.
///
/// ```
/// use treesynth::{glam::Vec2, preview::Picture};
///
/// let mut figure = Picture::new(64, 48, [255; 3])?;
/// figure.line(Vec2::new(4.0, 4.0), Vec2::new(60.0, 40.0), 1.5, [30, 90, 200]);
/// figure.label("edge", 4, 36, 1, [0; 3]);
/// let mut png = Vec::new();
/// figure.write_png(&mut png)?;
/// assert_eq!(&png[1..4], b"PNG");
/// # Ok::<(), treesynth::preview::PreviewError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
    /// One per pixel; none at all if everything is opaque.
    alpha: Vec<u8>,
}

impl Picture {
    /// A picture of one colour.
    ///
    /// # Errors
    /// Sides not within 1 to 16,384 pixels, or more than 2²⁶ pixels.
    pub fn new(width: u32, height: u32, color: [u8; 3]) -> Result<Self, PreviewError> {
        check_size("Picture", width, height)?;
        let pixels = vec![color; width as usize * height as usize];
        Ok(Self { width, height, pixels, alpha: Vec::new() })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// Opacity of each pixel, row by row from the top, 0 to 255; empty if all are opaque.
    pub fn alpha(&self) -> &[u8] {
        &self.alpha
    }

    /// Lets `paint` fill the pixels, and how opaque they are if the picture is to be `transparent`.
    pub(super) fn paint<T>(
        &mut self,
        transparent: bool,
        paint: impl FnOnce(&mut [[u8; 3]], &mut [u8]) -> T,
    ) -> T {
        if transparent {
            self.alpha.resize(self.pixels.len(), 0);
        }
        paint(&mut self.pixels, &mut self.alpha)
    }

    /// The pixel in column `x` and row `y`; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        (x < self.width && y < self.height)
            .then(|| self.pixels[y as usize * self.width as usize + x as usize])
    }

    /// Lays `other` over this picture, its upper left corner at (`x`, `y`). The result is opaque
    /// where `other` is; elsewhere this picture's opacity stays.
    pub fn blit(&mut self, other: &Self, x: i32, y: i32) {
        let columns = clip(x, other.width, self.width);
        if columns.is_empty() {
            return;
        }
        for row in clip(y, other.height, self.height) {
            let from = (i64::from(row) - i64::from(y)) as usize * other.width as usize;
            let skipped = (i64::from(columns.start) - i64::from(x)) as usize;
            for column in 0..columns.len() {
                let source = from + skipped + column;
                let opacity = other.alpha.get(source).map_or(1.0, |alpha| f32::from(*alpha) / 255.0);
                self.blend(columns.start + column as u32, row, other.pixels[source], opacity);
            }
        }
    }

    /// Several pictures in one, row by row: every cell as large as the largest picture, each picture in the middle
    /// of its cell, `gap` pixels between the cells and around them.
    ///
    /// # Errors
    /// No pictures, no columns, or a sheet larger than a picture [may be](Self::new).
    pub fn sheet(pictures: &[Self], columns: u32, gap: u32, color: [u8; 3]) -> Result<Self, PreviewError> {
        ParameterError::unless(!pictures.is_empty(), "Picture.sheet.pictures", 0, "at least 1")?;
        ParameterError::unless(columns > 0, "Picture.sheet.columns", columns, "at least 1")?;
        let columns = columns.min(pictures.len() as u32);
        let rows = (pictures.len() as u32).div_ceil(columns);
        let width = pictures.iter().map(Self::width).max().unwrap_or(1);
        let height = pictures.iter().map(Self::height).max().unwrap_or(1);
        let total = |cell: u32, cells: u32| {
            (u64::from(cell) + u64::from(gap)).saturating_mul(u64::from(cells)) + u64::from(gap)
        };
        let side = |total: u64| u32::try_from(total).unwrap_or(u32::MAX);
        let mut sheet = Self::new(side(total(width, columns)), side(total(height, rows)), color)?;
        for (i, picture) in pictures.iter().enumerate() {
            let (column, row) = (i as u32 % columns, i as u32 / columns);
            let x = gap + column * (width + gap) + (width - picture.width) / 2;
            let y = gap + row * (height + gap) + (height - picture.height) / 2;
            sheet.blit(picture, x.cast_signed(), y.cast_signed());
        }
        Ok(sheet)
    }

    /// Writes `text` with its upper left corner at (`x`, `y`), each dot of the 5 by 8 font `scale` pixels wide.
    ///
    /// A character takes 6 dots, a line 10; `\n` starts a new line. Other than printable ASCII, characters
    /// become boxes.
    pub fn label(&mut self, text: &str, x: i32, y: i32, scale: u32, color: [u8; 3]) {
        for (column, row) in font::cells(text) {
            let at = |start: i32, cells: u32| {
                let at = i64::from(start) + i64::from(cells) * i64::from(scale);
                i32::try_from(at).unwrap_or(i32::MAX)
            };
            self.rectangle(at(x, column), at(y, row), scale, scale, color);
        }
    }

    /// Width in pixels of the longest line of `text` at `scale`, for centring labels.
    pub fn label_width(text: &str, scale: u32) -> u32 {
        let longest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0) as u32;
        longest.saturating_mul(font::ADVANCE).saturating_sub(1).saturating_mul(scale)
    }

    /// Fills a rectangle with its upper left corner at (`x`, `y`).
    pub fn rectangle(&mut self, x: i32, y: i32, width: u32, height: u32, color: [u8; 3]) {
        let columns = clip(x, width, self.width);
        for row in clip(y, height, self.height) {
            let start = row as usize * self.width as usize;
            let pixels = start + columns.start as usize..start + columns.end as usize;
            self.pixels[pixels.clone()].fill(color);
            if let Some(alpha) = self.alpha.get_mut(pixels) {
                alpha.fill(255);
            }
        }
    }

    /// Draws a straight line with round ends, `width` pixels wide, smoothly; below one pixel it fades instead of
    /// getting narrower. Coordinates or a width
    /// that are not finite, or too large to square, draw nothing.
    pub fn line(&mut self, from: Vec2, to: Vec2, width: f32, color: [u8; 3]) {
        if !(from.is_finite() && to.is_finite() && width > 0.0 && width.is_finite()) {
            return;
        }
        let (reach, strength) = (width.max(1.0) * 0.5 + 0.5, width.min(1.0));
        let way = to - from;
        let length_squared = way.length_squared();
        if !length_squared.is_finite() {
            return;
        }
        let (low, high) = (from.min(to) - reach, from.max(to) + reach);
        for row in span(low.y, high.y, self.height) {
            let y = row as f32 + 0.5;
            // The part of the line that comes near this row, and the columns it can reach.
            let (mut left, mut right) = (low.x, high.x);
            if way.y.abs() > 1e-3 {
                let at = |y: f32| from.x + way.x * ((y - from.y) / way.y).clamp(0.0, 1.0);
                let (a, b) = (at(y - reach), at(y + reach));
                (left, right) = (a.min(b) - reach, a.max(b) + reach);
            }
            for column in span(left, right, self.width) {
                let point = Vec2::new(column as f32 + 0.5, y);
                let t = if length_squared > 0.0 {
                    ((point - from).dot(way) / length_squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = point.distance(from + way * t);
                self.blend(column, row, color, (reach - distance).clamp(0.0, 1.0) * strength);
            }
        }
    }

    /// Fills a disc, smoothly. A centre or radius that is not finite draws nothing.
    pub fn disc(&mut self, center: Vec2, radius: f32, color: [u8; 3]) {
        self.line(center, center, radius * 2.0, color);
    }

    fn blend(&mut self, x: u32, y: u32, color: [u8; 3], strength: f32) {
        let at = y as usize * self.width as usize + x as usize;
        // Over nothing, the new colour is the colour.
        let mut share = strength;
        if let Some(alpha) = self.alpha.get_mut(at) {
            let below = f32::from(*alpha) / 255.0;
            let opacity = strength + below * (1.0 - strength);
            share = if opacity > 0.0 { strength / opacity } else { 0.0 };
            *alpha = (opacity * 255.0 + 0.5) as u8;
        }
        for (channel, new) in self.pixels[at].iter_mut().zip(color) {
            let mixed = f32::from(*channel) + (f32::from(new) - f32::from(*channel)) * share;
            *channel = (mixed + 0.5) as u8;
        }
    }

    /// Writes the picture as a PNG file, with an alpha channel if it is not opaque.
    ///
    /// # Errors
    /// Whatever the writer returns.
    pub fn write_png(&self, writer: impl Write) -> Result<(), PreviewError> {
        write_frames(std::slice::from_ref(self), None, writer)
    }

    /// Writes pictures of one size as one PNG file that shows them in turn for ever (APNG), each
    /// for this number of milliseconds. A program that knows no animation shows the first.
    ///
    /// # Errors
    /// No pictures, or such as differ in size or of which only some are transparent; whatever the writer returns.
    pub fn write_animation(
        pictures: &[Self],
        milliseconds: u16,
        writer: impl Write,
    ) -> Result<(), PreviewError> {
        let alike = |a: &Self, b: &Self| {
            (a.width, a.height, a.alpha.is_empty()) == (b.width, b.height, b.alpha.is_empty())
        };
        let holds = !pictures.is_empty() && pictures.iter().all(|picture| alike(picture, &pictures[0]));
        let range = "at least one, all of one size and all transparent or none";
        ParameterError::unless(holds, "Picture.write_animation.pictures", pictures.len(), range)?;
        write_frames(pictures, Some(milliseconds), writer)
    }

    /// The bytes of a PNG's rows.
    fn bytes(&self) -> Cow<'_, [u8]> {
        if self.alpha.is_empty() {
            return Cow::Borrowed(self.pixels.as_flattened());
        }
        let rgba = self.pixels.iter().zip(&self.alpha);
        Cow::Owned(rgba.flat_map(|(&[red, green, blue], &alpha)| [red, green, blue, alpha]).collect())
    }
}

/// Writes at least one picture; all are alike in size and kind.
fn write_frames(pictures: &[Picture], delay: Option<u16>, writer: impl Write) -> Result<(), PreviewError> {
    let first = &pictures[0];
    let mut encoder = png::Encoder::new(writer, first.width, first.height);
    encoder.set_compression(png::Compression::High);
    encoder.set_color(if first.alpha.is_empty() { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let write = || {
        if let Some(milliseconds) = delay {
            encoder.set_animated(pictures.len() as u32, 0)?;
            encoder.set_frame_delay(milliseconds, 1000)?;
        }
        let mut writer = encoder.write_header()?;
        for picture in pictures {
            writer.write_image_data(&picture.bytes())?;
        }
        writer.finish()
    };
    write().map_err(|error| match error {
        png::EncodingError::IoError(error) => PreviewError::Io(error),
        other => PreviewError::Io(io::Error::other(other)),
    })
}

pub(super) fn check_size(of: &str, width: u32, height: u32) -> Result<(), ParameterError> {
    let sides = 1..=LONGEST_SIDE;
    let holds = sides.contains(&width)
        && sides.contains(&height)
        && u64::from(width) * u64::from(height) <= MOST_PIXELS;
    let range = "1 to 16384 pixels per side and at most 67108864 pixels";
    ParameterError::unless(holds, &format!("{of}.size"), (width, height), range)
}

/// The pixels of `size` from `start` on that are within `limit`.
fn clip(start: i32, size: u32, limit: u32) -> std::ops::Range<u32> {
    let end = (i64::from(start) + i64::from(size)).clamp(0, i64::from(limit));
    let start = i64::from(start).clamp(0, end);
    start as u32..end as u32
}

/// The pixels between two coordinates that are within `limit`.
fn span(low: f32, high: f32, limit: u32) -> std::ops::Range<u32> {
    let end = high.ceil().clamp(0.0, limit as f32) as u32;
    (low.floor().max(0.0) as u32).min(end)..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WHITE: [u8; 3] = [255; 3];
    const BLACK: [u8; 3] = [0; 3];

    fn white(width: u32, height: u32) -> Picture {
        Picture::new(width, height, WHITE).expect("a sound size")
    }

    fn dark(picture: &Picture) -> f32 {
        picture.pixels().iter().map(|p| 1.0 - f32::from(p[0]) / 255.0).sum()
    }

    #[test]
    fn sizes_are_checked() {
        for (width, height) in [(0, 5), (5, 0), (u32::MAX, 1), (16_384, 16_384)] {
            assert!(matches!(Picture::new(width, height, WHITE), Err(PreviewError::Parameter(_))));
        }
    }

    #[test]
    fn a_png_reads_back() {
        let mut picture = white(7, 3);
        picture.rectangle(2, 1, 3, 1, [10, 20, 30]);
        let mut bytes = Vec::new();
        picture.write_png(&mut bytes).expect("a vector takes everything");
        let mut reader = png::Decoder::new(io::Cursor::new(bytes)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        let info = reader.next_frame(&mut pixels).expect("a PNG");
        assert_eq!((info.width, info.height, info.color_type), (7, 3, png::ColorType::Rgb));
        assert_eq!(pixels, picture.pixels().as_flattened());
    }

    #[test]
    fn an_animation_reads_back() {
        let frames = [white(5, 4), Picture::new(5, 4, BLACK).expect("a sound size")];
        let mut bytes = Vec::new();
        Picture::write_animation(&frames, 250, &mut bytes).expect("a vector takes everything");
        let mut reader = png::Decoder::new(io::Cursor::new(bytes)).read_info().expect("a PNG");
        assert_eq!(reader.info().animation_control().map(|control| control.num_frames), Some(2));
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        for frame in &frames {
            reader.next_frame(&mut pixels).expect("a frame");
            assert_eq!(pixels, frame.pixels().as_flattened());
        }
        assert!(Picture::write_animation(&[], 1, io::sink()).is_err());
        assert!(Picture::write_animation(&[white(1, 2), white(2, 1)], 1, io::sink()).is_err());
    }

    #[test]
    fn a_full_disk_is_reported() {
        let mut room = [0u8; 40];
        assert!(matches!(white(50, 50).write_png(&mut room[..]), Err(PreviewError::Io(_))));
    }

    #[test]
    fn lines_cover_their_area() {
        for width in [0.25, 1.0, 3.0] {
            let mut picture = white(60, 60);
            picture.line(Vec2::new(10.3, 10.8), Vec2::new(46.3, 37.8), width, BLACK);
            let area = 45.0 * width;
            assert!(
                (dark(&picture) - area).abs() < 0.1 * area + width * 2.0,
                "{} for {area}",
                dark(&picture)
            );
        }
        let mut picture = white(60, 60);
        picture.disc(Vec2::new(30.0, 30.0), 10.0, BLACK);
        assert!((dark(&picture) - 314.16).abs() < 3.0);
    }

    #[test]
    fn sheets_hold_every_picture() {
        let black = |w, h| Picture::new(w, h, BLACK).expect("a sound size");
        let sheet = Picture::sheet(&[black(4, 4), black(2, 2), black(4, 2)], 2, 1, WHITE).expect("fits");
        assert_eq!((sheet.width(), sheet.height()), (11, 11));
        assert!((dark(&sheet) - 28.0).abs() < 1e-3);
        assert_eq!(sheet.pixel(7, 2), Some(BLACK));
        assert!(Picture::sheet(&[], 2, 1, WHITE).is_err());
        assert!(Picture::sheet(&[black(1, 1)], 0, 1, WHITE).is_err());
        assert!(Picture::sheet(&[black(1, 1)], 1, u32::MAX, WHITE).is_err());
    }

    #[test]
    fn labels_are_as_wide_as_said() {
        let mut picture = white(100, 40);
        picture.label("MW|\nH", 0, 0, 2, BLACK);
        assert_eq!(Picture::label_width("MW|\nH", 2), 34);
        let right = (0..100).filter(|&x| (0..40).any(|y| picture.pixel(x, y) == Some(BLACK))).max();
        assert_eq!(right, Some(29), "the bar is in the middle of its cell");
    }

    proptest! {
        #[test]
        fn nothing_drawn_outside_is_trouble(
            x in any::<i32>(), y in any::<i32>(), w in any::<u32>(), h in any::<u32>(), scale in any::<u32>(),
            a in prop::array::uniform4(prop::num::f32::ANY), b in prop::array::uniform4(-50.0f32..50.0),
            width in prop::num::f32::ANY,
        ) {
            let mut picture = white(20, 10);
            picture.rectangle(x, y, w, h, BLACK);
            picture.label("any text", x, y, scale, BLACK);
            picture.blit(&white(30, 3), x % 40, y);
            picture.blit(&white(3, 30), x, y % 40);
            picture.line(Vec2::new(a[0], a[1]), Vec2::new(a[2], a[3]), width, BLACK);
            picture.line(Vec2::new(b[0], b[1]), Vec2::new(b[2], a[3]), 2.0, BLACK);
            picture.disc(Vec2::new(b[0], a[1]), width, BLACK);
        }
    }
}
